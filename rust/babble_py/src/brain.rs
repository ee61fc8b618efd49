//! Maps, learning rule and pattern generators on their own, for studies and lessons.

use babble_brain::{CovarianceConfig, MapConfig, TimeBaseGenerator};
use numpy::{PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray1};
use pyo3::prelude::*;

use crate::guarded::Guarded;
use crate::{convert, errors};

/// The curve (n + 1, 2) of the time base generators (Eq. 5) from (0, 0) to (1, 1), at times kT/n.
#[pyfunction]
pub(crate) fn generator_curve(
    py: Python<'_>,
    b1: f64,
    b2: f64,
    n: usize,
) -> PyResult<Bound<'_, PyArray2<f64>>> {
    let generator = TimeBaseGenerator::new(b1, b2, 1.0).map_err(errors::brain)?;
    let mut curve = vec![[0.0; 2]; n + 1];
    generator.sample_into(&mut curve[1..]);
    convert::array2(py, &curve)
}

/// A grid of neurons with Gaussian tuning (Eq. 3).
#[pyclass(frozen, module = "gym_babble._core")]
#[derive(Debug)]
pub(crate) struct PopulationMap {
    map: babble_brain::PopulationMap,
}

#[pymethods]
impl PopulationMap {
    #[new]
    fn new(neurons: [usize; 2], low: [f64; 2], high: [f64; 2], sigma: f64) -> PyResult<Self> {
        let config = MapConfig {
            neurons,
            low,
            high,
            sigma,
        };
        Ok(Self {
            map: babble_brain::PopulationMap::new(&config).map_err(errors::brain)?,
        })
    }

    /// Activities g (n,) for a value, Eq. 3.
    fn encode<'py>(&self, py: Python<'py>, x: [f64; 2]) -> Bound<'py, PyArray1<f32>> {
        let mut g = vec![0.0; self.map.len()];
        self.map.encode(x, &mut g);
        PyArray1::from_vec(py, g)
    }

    /// Value read out from activities a (n,), Eq. 4.
    fn read_out(&self, a: PyReadonlyArray1<'_, f32>) -> PyResult<[f64; 2]> {
        let a = a.as_slice()?;
        if a.len() != self.map.len() {
            let problem = format!(
                "a holds {} activities, the map has {} neurons",
                a.len(),
                self.map.len()
            );
            return Err(errors::ConfigError::new_err(problem));
        }
        Ok(self.map.read_out(a))
    }
}

/// Weights between two maps and the covariance rule (Eq. 7).
#[pyclass(frozen, module = "gym_babble._core")]
#[derive(Debug)]
pub(crate) struct Association {
    weights: Guarded<babble_brain::Association>,
}

#[pymethods]
impl Association {
    #[new]
    #[pyo3(signature = (n_in, n_out, eta=1.0, w_max=0.2, xi=0.2))]
    fn new(n_in: usize, n_out: usize, eta: f32, w_max: f32, xi: f32) -> PyResult<Self> {
        let config = CovarianceConfig { eta, w_max, xi };
        let weights =
            babble_brain::Association::new(&config, n_in, n_out).map_err(errors::brain)?;
        Ok(Self {
            weights: Guarded::new("association", weights),
        })
    }

    /// One step of Eq. 7 for input activities g and output activities a.
    fn learn(
        &self,
        py: Python<'_>,
        g: PyReadonlyArray1<'_, f32>,
        a: PyReadonlyArray1<'_, f32>,
    ) -> PyResult<()> {
        let weights = &mut *self.weights.write()?;
        let (g, a) = (g.as_slice()?.to_vec(), a.as_slice()?.to_vec());
        py.detach(|| weights.learn(&g, &a)).map_err(errors::brain)
    }

    /// Activities of the output map for input activities g.
    fn recall<'py>(
        &self,
        py: Python<'py>,
        g: PyReadonlyArray1<'py, f32>,
    ) -> PyResult<Bound<'py, PyArray1<f32>>> {
        let weights = self.weights.read()?;
        let mut a = vec![0.0; weights.n_out()];
        weights
            .recall(g.as_slice()?, &mut a)
            .map_err(errors::brain)?;
        Ok(PyArray1::from_vec(py, a))
    }

    /// The weights `w_ji` (`n_out`, `n_in`), as a copy.
    #[getter]
    fn weights<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f32>>> {
        let weights = self.weights.read()?;
        PyArray1::from_slice(py, weights.weights()).reshape([weights.n_out(), weights.n_in()])
    }
}
