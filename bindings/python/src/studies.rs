//! Simulated flights and the comparison of methods.

use std::sync::atomic::{AtomicUsize, Ordering};

use phugoid_identification::method::Method;
use phugoid_evaluation::arena::{self, Contestant, Entry};
use phugoid_simulation::flight::fly_with_progress;
use phugoid_simulation::{named, scenario};
use pyo3::prelude::*;

use crate::error::raise;
use crate::record::Record;

/// Flies a scenario: what the sensors measured, what was true, and the true parameters as a JSON document.
#[pyfunction]
#[pyo3(signature = (scenario, seed=None))]
pub(crate) fn simulate(py: Python<'_>, scenario: &str, seed: Option<u64>) -> PyResult<(Record, Record, String)> {
    let mut scenario = named::scenario(scenario).map_err(raise)?;
    scenario.seed = seed.unwrap_or(scenario.seed);
    let flight = py.detach(|| fly_with_progress(&scenario, &|_| ())).map_err(raise)?;
    let truth = serde_json::to_string(&flight.true_parameters).map_err(raise)?;
    Ok((flight.measured.into(), flight.truth.into(), truth))
}

/// Every method on the same flights, as a JSON document; `progress` is called with the fraction done.
#[pyfunction]
#[pyo3(signature = (scenarios, methods=Vec::new(), seeds=20, progress=None))]
pub(crate) fn compare(
    py: Python<'_>,
    scenarios: Vec<String>,
    methods: Vec<String>,
    seeds: usize,
    progress: Option<Py<PyAny>>,
) -> PyResult<String> {
    let mut entries: Vec<Entry> = Vec::new();
    for wanted in &scenarios {
        let known = || arena::BUILT_IN.iter().map(|(id, _)| *id);
        let none = || {
            let near =
                scenario::nearest(wanted, known()).map_or_else(String::new, |near| format!(": did you mean `{near}`?"));
            raise(format!(
                "there is no scenario `{wanted}` of the arena{near}; there are {}",
                known().collect::<Vec<_>>().join(", ")
            ))
        };
        entries.push(arena::built_in(wanted).ok_or_else(none)?.map_err(raise)?);
    }
    let methods: Vec<Method> = if methods.is_empty() {
        Method::ALL.to_vec()
    } else {
        methods.iter().map(|name| name.parse().map_err(raise)).collect::<PyResult<_>>()?
    };
    let contestants: Vec<Contestant> = methods.into_iter().map(Contestant::of).collect();
    let (done, all) = (AtomicUsize::new(0), (entries.len() * seeds).max(1) as f64);
    let step = || {
        let fraction = (1 + done.fetch_add(1, Ordering::Relaxed)) as f64 / all;
        if let Some(progress) = &progress {
            // A bar that cannot be drawn does not stop the flights.
            let _ = Python::attach(|py| progress.call1(py, (fraction,)).map(|_| ()));
        }
    };
    let result = py.detach(|| arena::compare(&entries, &contestants, seeds, step)).map_err(raise)?;
    serde_json::to_string(&result).map_err(raise)
}

/// What is built in: scenarios, scenarios of the arena, methods.
#[pyfunction]
pub(crate) fn names() -> (Vec<&'static str>, Vec<&'static str>, Vec<&'static str>) {
    (
        scenario::BUILT_IN.iter().map(|(name, _)| *name).collect(),
        arena::BUILT_IN.iter().map(|(name, _)| *name).collect(),
        Method::ALL.iter().map(|method| method.name()).collect(),
    )
}
