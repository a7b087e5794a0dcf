//! Simulated flights and the comparison of methods.

use phugoid::{Method, Scenario};
use phugoid_evaluation::arena;
use phugoid_simulation::scenario;
use pyo3::prelude::*;

use crate::error::raise;
use crate::record::Record;

/// Simulates a scenario. Returns the measured record, the true record, and the true parameters as a JSON document.
#[pyfunction]
#[pyo3(signature = (scenario, seed=None))]
pub(crate) fn simulate(
    py: Python<'_>,
    scenario: &str,
    seed: Option<u64>,
) -> PyResult<(Record, Record, String, Vec<String>)> {
    let mut scenario = Scenario::find(scenario).map_err(raise)?;
    scenario.seed = seed.unwrap_or(scenario.seed);
    let flight = py.detach(|| phugoid::simulate(&scenario)).map_err(raise)?;
    let truth = serde_json::to_string(&flight.true_parameters).map_err(raise)?;
    let notes = scenario.notes().map_err(raise)?;
    Ok((flight.measured.into(), flight.truth.into(), truth, notes))
}

/// Compares methods on the same simulated flights; the result is a JSON document. `progress` is called with the
/// fraction done.
#[pyfunction]
#[pyo3(signature = (scenarios, methods=Vec::new(), seeds=20, progress=None))]
pub(crate) fn compare(
    py: Python<'_>,
    scenarios: Vec<String>,
    methods: Vec<String>,
    seeds: usize,
    progress: Option<Py<PyAny>>,
) -> PyResult<String> {
    let entries = scenarios.iter().map(|name| phugoid::entry(name)).collect::<Result<Vec<_>, _>>().map_err(raise)?;
    let methods: Vec<Method> = if methods.is_empty() {
        Method::ALL.to_vec()
    } else {
        methods.iter().map(|name| name.parse().map_err(raise)).collect::<PyResult<_>>()?
    };
    let step = |fraction: f64| {
        if let Some(progress) = &progress {
            // An error of the progress bar does not stop the comparison.
            let _ = Python::attach(|py| progress.call1(py, (fraction,)).map(|_| ()));
        }
    };
    let result = py.detach(|| phugoid::compare_entries(&entries, &methods, seeds, &step)).map_err(raise)?;
    serde_json::to_string(&result).map_err(raise)
}

/// Names of the built-in scenarios, of the scenarios of the comparison, and of the methods.
#[pyfunction]
pub(crate) fn names() -> (Vec<&'static str>, Vec<&'static str>, Vec<&'static str>) {
    (
        scenario::BUILT_IN.iter().map(|(name, _)| *name).collect(),
        arena::BUILT_IN.iter().map(|(name, _)| *name).collect(),
        Method::ALL.iter().map(|method| method.name()).collect(),
    )
}
