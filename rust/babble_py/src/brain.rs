//! Maps, associations, learning rules and pattern generators on their own.

use babble_agent::Rule;
use babble_brain::{MapConfig, TimeBaseGenerator};
use numpy::{PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::prelude::*;

use crate::guarded::Guarded;
use crate::{convert, errors, signals};

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

/// A curve (n, 2) of the generators, placed between two points (Eq. 6).
#[pyfunction]
pub(crate) fn place_curve<'py>(
    py: Python<'py>,
    start: [f64; 2],
    target: [f64; 2],
    curve: PyReadonlyArray2<'py, f64>,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let curve = convert::rows::<f64, 2>(&curve, "curve")?;
    let placed: Vec<[f64; 2]> = curve
        .into_iter()
        .map(|c| babble_brain::place(start, target, c))
        .collect();
    convert::array2(py, &placed)
}

/// The numbers that a rule has unless others are given, as JSON; of a rule of one's own without a
/// name.
#[pyfunction]
#[pyo3(signature = (name=None))]
pub(crate) fn rule_json(name: Option<&str>) -> PyResult<String> {
    let rule = name.map_or_else(|| Ok(Rule::own()), str::parse);
    convert::json(&rule.map_err(errors::agent)?)
}

/// A rule from its name and numbers as JSON.
fn rule_of(json: &str) -> PyResult<Rule> {
    let rule: Rule = serde_json::from_str(json)
        .map_err(|error| errors::ConfigError::new_err(format!("rule: {error}")))?;
    rule.validate().map_err(errors::brain)?;
    Ok(rule)
}

/// Numbers of an array in the order of C.
fn flat<T: numpy::Element + Copy>(array: &PyReadonlyArray2<'_, T>) -> Vec<T> {
    array.as_array().iter().copied().collect()
}

/// A (n, width) array.
fn wide<T: numpy::Element>(
    py: Python<'_>,
    values: Vec<T>,
    width: usize,
) -> PyResult<Bound<'_, PyArray2<T>>> {
    let n = values.len() / width;
    PyArray1::from_vec(py, values).reshape([n, width])
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
    fn new(neurons: Vec<usize>, low: Vec<f64>, high: Vec<f64>, sigma: f64) -> PyResult<Self> {
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

    /// Number of neurons.
    fn __len__(&self) -> usize {
        self.map.len()
    }

    /// Preferred values (N, d).
    fn preferred<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let all = (0..self.map.len()).flat_map(|j| self.map.preferred(j));
        wide(py, all.collect(), self.map.axes())
    }

    /// Activities (n, N) for values (n, d), Eq. 3.
    fn encode<'py>(
        &self,
        py: Python<'py>,
        x: PyReadonlyArray2<'py, f64>,
    ) -> PyResult<Bound<'py, PyArray2<f32>>> {
        convert::check_width(x.as_array().shape(), self.map.axes(), "x")?;
        let x = flat(&x);
        let mut g = vec![0.0; x.len() / self.map.axes() * self.map.len()];
        py.detach(|| self.map.encode(&x, &mut g))
            .map_err(errors::brain)?;
        wide(py, g, self.map.len())
    }

    /// Values (n, d) read out from activities (n, N), Eq. 4; with a radius around the strongest neuron
    /// of each.
    #[pyo3(signature = (a, radius=None))]
    fn read_out<'py>(
        &self,
        py: Python<'py>,
        a: PyReadonlyArray2<'py, f32>,
        radius: Option<usize>,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        convert::check_width(a.as_array().shape(), self.map.len(), "a")?;
        let a = flat(&a);
        let mut x = vec![0.0; a.len() / self.map.len() * self.map.axes()];
        py.detach(|| match radius {
            None => self.map.read_out(&a, &mut x),
            Some(radius) => self.map.read_out_peak(&a, radius, &mut x),
        })
        .map_err(errors::brain)?;
        wide(py, x, self.map.axes())
    }
}

/// All pairs of the neurons of two maps.
#[pyclass(frozen, module = "gym_babble._core")]
#[derive(Debug)]
pub(crate) struct ConjunctiveMap {
    map: babble_brain::ConjunctiveMap,
}

#[pymethods]
impl ConjunctiveMap {
    #[new]
    fn new(inner: &PopulationMap, outer: &PopulationMap) -> Self {
        let map = babble_brain::ConjunctiveMap::new(inner.map.clone(), outer.map.clone());
        Self { map }
    }

    /// Number of pairs.
    fn __len__(&self) -> usize {
        self.map.len()
    }

    /// Activities (n, N) for values (n, d) of both maps.
    fn encode<'py>(
        &self,
        py: Python<'py>,
        inner: PyReadonlyArray2<'py, f64>,
        outer: PyReadonlyArray2<'py, f64>,
    ) -> PyResult<Bound<'py, PyArray2<f32>>> {
        let [map0, map1] = self.map.maps();
        convert::check_width(inner.as_array().shape(), map0.axes(), "inner")?;
        convert::check_width(outer.as_array().shape(), map1.axes(), "outer")?;
        let (inner, outer) = (flat(&inner), flat(&outer));
        let mut g = vec![0.0; inner.len() / map0.axes() * self.map.len()];
        py.detach(|| self.map.encode(&inner, &outer, &mut g))
            .map_err(errors::brain)?;
        wide(py, g, self.map.len())
    }
}

/// Weights between two maps, and running averages of their activities.
///
/// In `with association:` no other thread can use it.
#[pyclass(frozen, module = "gym_babble._core")]
#[derive(Debug)]
pub(crate) struct Association {
    association: Guarded<babble_brain::Association>,
}

#[pymethods]
impl Association {
    #[new]
    fn new(n_in: usize, n_out: usize) -> PyResult<Self> {
        let association = babble_brain::Association::new(n_in, n_out).map_err(errors::brain)?;
        Ok(Self {
            association: Guarded::new("association", association),
        })
    }

    fn __enter__(&self) -> PyResult<()> {
        self.association.enter()
    }

    fn __exit__(
        &self,
        _type: &Bound<'_, PyAny>,
        _raised: &Bound<'_, PyAny>,
        _at: &Bound<'_, PyAny>,
    ) {
        self.association.leave();
    }

    /// Learns from input activities g (m, `n_in`) and output activities a (m, `n_out`) in their order, by
    /// the rule of that name and numbers (JSON).
    fn learn(
        &self,
        py: Python<'_>,
        rule: &str,
        g: PyReadonlyArray2<'_, f32>,
        a: PyReadonlyArray2<'_, f32>,
        threads: usize,
    ) -> PyResult<()> {
        let rule = rule_of(rule)?;
        let association = &mut *self.association.write()?;
        convert::check_width(g.as_array().shape(), association.n_in(), "g")?;
        convert::check_width(a.as_array().shape(), association.n_out(), "a")?;
        let (g, a) = (flat(&g), flat(&a));
        py.detach(|| {
            let learn = || rule.learn(association, &g, &a);
            signals::executor(threads)?.run(learn)?
        })
        .map_err(errors::agent)
    }

    /// Activities (m, `n_out`) that input activities g (m, `n_in`) call up.
    fn recall<'py>(
        &self,
        py: Python<'py>,
        g: PyReadonlyArray2<'py, f32>,
    ) -> PyResult<Bound<'py, PyArray2<f32>>> {
        let association = &*self.association.read()?;
        convert::check_width(g.as_array().shape(), association.n_in(), "g")?;
        let g = flat(&g);
        let mut a = vec![0.0; g.len() / association.n_in() * association.n_out()];
        py.detach(|| association.recall(&g, &mut a))
            .map_err(errors::brain)?;
        wide(py, a, association.n_out())
    }

    /// The weights `w_ji` (`n_out`, `n_in`), as a copy.
    fn weights<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f32>>> {
        let association = self.association.read()?;
        wide(py, association.weights().to_vec(), association.n_in())
    }

    /// The running averages of output (`n_out`,) and input (`n_in`,), as copies.
    fn means<'py>(&self, py: Python<'py>) -> PyResult<[Bound<'py, PyArray1<f32>>; 2]> {
        let association = self.association.read()?;
        Ok([association.a_mean(), association.g_mean()].map(|mean| PyArray1::from_slice(py, mean)))
    }

    /// Sets the weights (`n_out`, `n_in`).
    fn set_weights(&self, weights: PyReadonlyArray2<'_, f32>) -> PyResult<()> {
        let association = &mut *self.association.write()?;
        convert::check_width(weights.as_array().shape(), association.n_in(), "weights")?;
        association
            .set_weights(&flat(&weights))
            .map_err(errors::brain)
    }

    /// Sets the running averages of output (`n_out`,) and input (`n_in`,).
    fn set_means(
        &self,
        a_mean: PyReadonlyArray1<'_, f32>,
        g_mean: PyReadonlyArray1<'_, f32>,
    ) -> PyResult<()> {
        let (a_mean, g_mean) = (a_mean.as_array().to_vec(), g_mean.as_array().to_vec());
        self.association
            .write()?
            .set_means(&a_mean, &g_mean)
            .map_err(errors::brain)
    }
}
