//! The Hebb agent's network and its babbling.

use babble_agent::store::{self, Metadata};
use babble_agent::{AgentError, Babbling, HebbConfig, Variant};
use babble_env::{Config, Executor};
use numpy::{PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray2};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};

use crate::guarded::Guarded;
use crate::reach::fidelity;
use crate::task::Task;
use crate::{convert, errors, reach, signals};

/// Experiences that are learnt together.
const CHUNK: usize = 256;

/// A network that learns by babbling. In `with hebb:` no other thread can use it.
#[pyclass(frozen, module = "gym_babble._core")]
#[derive(Debug)]
pub(crate) struct Hebb {
    learner: Guarded<Learner>,
    seed: u64,
    quasi_static: bool,
}

/// What learning changes.
#[derive(Debug)]
struct Learner {
    network: babble_agent::Hebb,
    babbling: Babbling,
    pool: Executor,
}

impl Learner {
    /// All of it or, after an error of the babbling, none.
    fn learn(&mut self, task: &babble_env::ReachTask, legal: usize) -> Result<(), AgentError> {
        let experiences = self.babbling.experience(task, legal, &mut self.pool)?;
        let network = &mut self.network;
        self.pool.run(|| {
            experiences
                .chunks(CHUNK)
                .try_for_each(|chunk| network.learn(chunk))
        })?
    }
}

#[pymethods]
impl Hebb {
    /// A network that has learnt nothing; `config` is JSON, complete.
    #[new]
    fn new(config: &str, seed: u64, quasi_static: bool, threads: usize) -> PyResult<Self> {
        let config: HebbConfig = serde_json::from_str(config)
            .map_err(|error| errors::ConfigError::new_err(format!("agent config: {error}")))?;
        let learner = Learner {
            network: babble_agent::Hebb::new(config).map_err(errors::agent)?,
            babbling: Babbling::new(seed, fidelity(quasi_static)),
            pool: signals::executor(threads).map_err(errors::env)?,
        };
        Ok(Self {
            learner: Guarded::new("agent", learner),
            seed,
            quasi_static,
        })
    }

    /// The numbers of a variant, as JSON.
    #[staticmethod]
    fn variant_config(variant: &str) -> PyResult<String> {
        let variant: Variant = variant.parse().map_err(errors::agent)?;
        convert::json(&HebbConfig::variant(variant))
    }

    /// Its numbers, as JSON.
    fn config(&self) -> PyResult<String> {
        convert::json(self.learner.read()?.network.config())
    }

    fn __enter__(&self) -> PyResult<()> {
        self.learner.enter()
    }

    fn __exit__(
        &self,
        _type: &Bound<'_, PyAny>,
        _raised: &Bound<'_, PyAny>,
        _at: &Bound<'_, PyAny>,
    ) {
        self.learner.leave();
    }

    /// Babbles on `task` until `legal` more movements were legal, and learns from them; interrupted,
    /// it has done neither.
    fn learn(&self, py: Python<'_>, task: &Task, legal: usize) -> PyResult<()> {
        let learner = &mut *self.learner.write()?;
        let task = task.downcast::<babble_env::ReachTask>()?;
        py.detach(|| learner.learn(&task, legal))
            .map_err(errors::agent)
    }

    /// Parameters b (n, 2) for senses (n, 11).
    fn decide<'py>(
        &self,
        py: Python<'py>,
        senses: PyReadonlyArray2<'py, f32>,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let senses = reach::rows_of_senses(&senses)?;
        let network = &self.learner.read()?.network;
        let decide = |s: &[f32; 11]| network.decide([s[0], s[1]], [s[2], s[3]]);
        let b: Vec<[f64; 2]> = py
            .detach(|| senses.iter().map(decide).collect::<Result<_, _>>())
            .map_err(errors::agent)?;
        convert::array2(py, &b)
    }

    /// Activity of the output map (ny, nx) for senses (11,).
    fn recall<'py>(
        &self,
        py: Python<'py>,
        senses: [f32; 11],
    ) -> PyResult<Bound<'py, PyArray2<f32>>> {
        let [e0, e1, o0, o1, ..] = senses;
        let network = &self.learner.read()?.network;
        let a = network.recall([e0, e1], [o0, o1]).map_err(errors::agent)?;
        let side = network.config().output_neurons;
        PyArray1::from_vec(py, a).reshape([side, side])
    }

    /// The weights `w_ji` (`n_out`, `n_in`) and the running averages, as copies.
    fn weights<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let learner = self.learner.read()?;
        let w = learner.network.weights();
        let dict = PyDict::new(py);
        let weights = PyArray1::from_slice(py, w.weights()).reshape([w.n_out(), w.n_in()])?;
        dict.set_item("weights", weights)?;
        dict.set_item("a_bar", PyArray1::from_slice(py, w.a_bar()))?;
        dict.set_item("g_bar", PyArray1::from_slice(py, w.g_bar()))?;
        Ok(dict)
    }

    /// Neurons along the axes of the input map.
    fn input_shape(&self) -> PyResult<Vec<usize>> {
        Ok(self.learner.read()?.network.input_shape())
    }

    /// Movements babbled.
    #[getter]
    fn movements(&self) -> PyResult<u64> {
        Ok(self.learner.read()?.babbling.movements())
    }

    /// How many of them were legal.
    #[getter]
    fn legal(&self) -> PyResult<u64> {
        Ok(self.learner.read()?.babbling.legal())
    }

    /// Seed of the babbling.
    #[getter]
    fn seed(&self) -> u64 {
        self.seed
    }

    /// Whether movements are simulated without the muscles' lag.
    #[getter]
    fn quasi_static(&self) -> bool {
        self.quasi_static
    }

    /// The agent as the bytes of a safetensors file; `config` is the JSON of body and task.
    fn save<'py>(&self, py: Python<'py>, config: &str) -> PyResult<Bound<'py, PyBytes>> {
        let Learner {
            network, babbling, ..
        } = &*self.learner.read()?;
        let metadata = Metadata::new(
            network.config().clone(),
            Config::from_json(config).map_err(errors::env)?,
            self.seed,
            fidelity(self.quasi_static),
            babbling.movements(),
            babbling.legal(),
        );
        let bytes = store::save(network, &metadata).map_err(errors::agent)?;
        Ok(PyBytes::new(py, &bytes))
    }

    /// The agent in the bytes of a safetensors file, and the JSON of the body and task it learnt on.
    #[staticmethod]
    fn load(bytes: &[u8], threads: usize) -> PyResult<(Self, String)> {
        let (network, metadata) = store::load(bytes).map_err(errors::agent)?;
        let Metadata {
            seed,
            quasi_static,
            movements,
            legal,
            ..
        } = metadata;
        let learner = Learner {
            network,
            babbling: Babbling::resume(seed, fidelity(quasi_static), movements, legal),
            pool: signals::executor(threads).map_err(errors::env)?,
        };
        let agent = Self {
            learner: Guarded::new("agent", learner),
            seed,
            quasi_static,
        };
        Ok((agent, metadata.config.to_json().map_err(errors::env)?))
    }
}
