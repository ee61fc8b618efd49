//! The Hebb agent of grasping: its network and its babbling.

use babble_agent::AgentError;
use babble_agent::grasp::{self, GraspBabbling, GraspHebbConfig};
use babble_env::tasks::grasp::FOVEA_NEURONS;
use babble_env::{Config, EnvError, Executor};
use numpy::{PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};

use crate::guarded::Guarded;
use crate::task::Task;
use crate::{convert, errors, signals};

/// A network that learns by babbling with the object in the hand. In `with hebb:` no other thread
/// can use it.
#[pyclass(frozen, module = "gym_babble._core")]
#[derive(Debug)]
pub(crate) struct GraspHebb {
    learner: Guarded<Learner>,
}

/// What learning changes.
#[derive(Debug)]
struct Learner {
    network: grasp::GraspHebb,
    babbling: GraspBabbling,
    /// What this object's own babbling left behind.
    babbled: Vec<grasp::Experience>,
    pool: Executor,
}

impl Learner {
    fn new(
        network: grasp::GraspHebb,
        babbling: GraspBabbling,
        threads: usize,
    ) -> Result<Self, EnvError> {
        Ok(Self {
            network,
            babbling,
            babbled: Vec::new(),
            pool: signals::executor(threads)?,
        })
    }

    /// All of it or, after an error of the babbling, none.
    fn learn(&mut self, task: &babble_env::GraspTask, n: usize) -> Result<(), AgentError> {
        let found = self.babbling.experience(task, n, &mut self.pool)?;
        let network = &mut self.network;
        self.pool.run(|| network.learn(&found))??;
        self.babbled.extend(found);
        Ok(())
    }
}

#[pymethods]
impl GraspHebb {
    /// A network that has learnt nothing; `config` is JSON, complete.
    #[new]
    fn new(config: &str, seed: u64, threads: usize) -> PyResult<Self> {
        let config: GraspHebbConfig = serde_json::from_str(config)
            .map_err(|error| errors::ConfigError::new_err(format!("agent config: {error}")))?;
        let network = grasp::GraspHebb::new(config).map_err(errors::agent)?;
        Self::of(network, GraspBabbling::new(seed), threads)
    }

    /// The paper's numbers, as JSON.
    #[staticmethod]
    fn default_config() -> PyResult<String> {
        convert::json(&GraspHebbConfig::default())
    }

    /// Time that one babble takes \[s\].
    #[classattr]
    const BABBLE_S: f64 = grasp::babbling::BABBLE_S;

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

    /// Babbles on `task` until `n` more objects were kept, and learns from them; interrupted, it has
    /// done neither.
    fn learn(&self, py: Python<'_>, task: &Task, n: usize) -> PyResult<()> {
        let learner = &mut *self.learner.write()?;
        let task = task.downcast::<babble_env::GraspTask>()?;
        py.detach(|| learner.learn(&task, n)).map_err(errors::agent)
    }

    /// What this object's own babbling left behind: eye (n, 2), fovea (n, 441), arm (n, 2), hand
    /// (n, 2) and diameter (n,).
    fn babbled<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let babbled = &self.learner.read()?.babbled;
        let dict = PyDict::new(py);
        let pairs = |of: fn(&grasp::Experience) -> [f32; 2]| {
            convert::array2(py, &babbled.iter().map(of).collect::<Vec<_>>())
        };
        dict.set_item("eye", pairs(|e| e.eye)?)?;
        dict.set_item("arm", pairs(|e| e.arm)?)?;
        dict.set_item("hand", pairs(|e| e.hand)?)?;
        let fovea = babbled.iter().map(|e| &e.fovea[..]);
        dict.set_item("fovea", convert::table(py, FOVEA_NEURONS, fovea)?)?;
        let diameters = babbled.iter().map(|e| e.diameter);
        dict.set_item("diameter", PyArray1::from_iter(py, diameters))?;
        Ok(dict)
    }

    /// Postures (n, 4) for eyes (n, 2) and foveae (n, 441): shares of the ranges of shoulder and
    /// elbow, and equilibrium points of thumb and finger, EP = 90° − flexion \[deg\].
    fn decide<'py>(
        &self,
        py: Python<'py>,
        eyes: PyReadonlyArray2<'py, f32>,
        foveae: PyReadonlyArray2<'py, f32>,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let eyes = convert::rows::<f32, 2>(&eyes, "eye")?;
        let foveae = convert::rows::<f32, FOVEA_NEURONS>(&foveae, "fovea")?;
        let network = &self.learner.read()?.network;
        let decide = |(eye, fovea): (&[f32; 2], &[f32; FOVEA_NEURONS])| {
            let recalled = network.decide(*eye, fovea)?;
            let ([q1, q2], [thumb, finger]) = (recalled.arm, recalled.hand);
            Ok([q1, q2, thumb, finger])
        };
        let postures: Vec<[f64; 4]> = py
            .detach(|| {
                eyes.iter()
                    .zip(&foveae)
                    .map(decide)
                    .collect::<Result<_, _>>()
            })
            .map_err(errors::agent)?;
        convert::array2(py, &postures)
    }

    /// Activity of the arm's map (21, 21), rows elbow, columns shoulder, for an eye posture.
    fn recall_arm<'py>(
        &self,
        py: Python<'py>,
        eye: [f32; 2],
    ) -> PyResult<Bound<'py, PyArray2<f32>>> {
        let network = &self.learner.read()?.network;
        square(py, network, network.recall_arm(eye))
    }

    /// Activity of the hand's map (21, 21), rows finger, columns thumb, for a fovea (441,).
    fn recall_hand<'py>(
        &self,
        py: Python<'py>,
        fovea: PyReadonlyArray1<'py, f32>,
    ) -> PyResult<Bound<'py, PyArray2<f32>>> {
        let network = &self.learner.read()?.network;
        square(py, network, network.recall_hand(fovea.as_slice()?))
    }

    /// The weights `w_ji` (outputs, inputs) and the running averages, as copies.
    fn weights<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let network = &self.learner.read()?.network;
        let dict = PyDict::new(py);
        for (name, w) in [("reach", network.reach()), ("grasp", network.grasp())] {
            let weights = PyArray1::from_slice(py, w.weights()).reshape([w.n_out(), w.n_in()])?;
            dict.set_item(format!("{name}.weights"), weights)?;
            dict.set_item(format!("{name}.a_bar"), PyArray1::from_slice(py, w.a_bar()))?;
            dict.set_item(format!("{name}.g_bar"), PyArray1::from_slice(py, w.g_bar()))?;
        }
        Ok(dict)
    }

    /// Babbles made.
    #[getter]
    fn babbles(&self) -> PyResult<u64> {
        Ok(self.learner.read()?.babbling.babbles())
    }

    /// In how many of them the hand kept the object.
    #[getter]
    fn kept(&self) -> PyResult<u64> {
        Ok(self.learner.read()?.babbling.kept())
    }

    /// The agent as the bytes of a safetensors file; `config` is the JSON of body and task.
    fn save<'py>(&self, py: Python<'py>, config: &str) -> PyResult<Bound<'py, PyBytes>> {
        let config = Config::from_json(config).map_err(errors::env)?;
        let Learner {
            network, babbling, ..
        } = &*self.learner.read()?;
        let bytes = grasp::save(network, babbling, config).map_err(errors::agent)?;
        Ok(PyBytes::new(py, &bytes))
    }

    /// The agent in the bytes of a safetensors file, and the JSON of the body and task it learnt on.
    #[staticmethod]
    fn load(bytes: &[u8], threads: usize) -> PyResult<(Self, String)> {
        let (network, babbling, config) = grasp::load(bytes).map_err(errors::agent)?;
        let agent = Self::of(network, babbling, threads)?;
        Ok((agent, config.to_json().map_err(errors::env)?))
    }
}

impl GraspHebb {
    fn of(network: grasp::GraspHebb, babbling: GraspBabbling, threads: usize) -> PyResult<Self> {
        let learner = Learner::new(network, babbling, threads).map_err(errors::env)?;
        Ok(Self {
            learner: Guarded::new("agent", learner),
        })
    }
}

/// Activity of one of the network's maps, as rows and columns.
fn square<'py>(
    py: Python<'py>,
    network: &grasp::GraspHebb,
    activity: Result<Vec<f32>, AgentError>,
) -> PyResult<Bound<'py, PyArray2<f32>>> {
    let side = network.config().neurons;
    PyArray1::from_vec(py, activity.map_err(errors::agent)?).reshape([side, side])
}
