//! `gym_babble._core`: the Python face of the Rust crates. Conversions and nothing else.

// Methods of Python classes take owned arguments and plain `self`, as pyo3 hands them over.
#![allow(clippy::needless_pass_by_value, clippy::unused_self)]

mod batch;
mod brain;
mod config;
mod convert;
mod errors;
mod grasp;
mod guarded;
mod lab;
mod learner;
mod policy;
mod reach;
mod server;
mod signals;
mod task;
mod tensors;

use pyo3::prelude::*;

/// The Rust core of `gym_babble`.
// A free-threaded Python may leave its lock off: there is no unsafe code here, so the compiler has
// checked that what Python shares is Sync, and an object that one thread is changing refuses another.
#[pymodule(gil_used = false)]
mod _core {
    #[pymodule_export]
    use crate::batch::{Batch, stream_seed};
    #[pymodule_export]
    use crate::brain::{
        Association, ConjunctiveMap, PopulationMap, generator_curve, place_curve, rule_json,
    };
    #[pymodule_export]
    use crate::config::{
        complete_config, load_config, outcomes, processors, profile_config, profiles,
    };
    #[pymodule_export]
    use crate::grasp::{grasp_posture, hold, keeps};
    #[pymodule_export]
    use crate::lab::check_record;
    #[pymodule_export]
    use crate::learner::{Learner, babble, babble_steps, babble_to, brain_json, learnable_babbles};
    #[pymodule_export]
    use crate::policy::{Plans, PolicyNetwork, Reference, act_on, check_deciding};
    #[pymodule_export]
    use crate::reach::{movement, place, posture_at};
    #[pymodule_export]
    use crate::server::{serve, server_protocol};
    #[pymodule_export]
    use crate::task::{Task, check_fixed, registry_json};
    #[pymodule_export]
    use crate::tensors::{read_tensors, tensor_keys, write_tensors};
    use pyo3::prelude::*;

    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        module.add("__version__", env!("CARGO_PKG_VERSION"))?;
        module.add("debug_build", cfg!(debug_assertions))
    }
}
