//! Live estimation, sample by sample.

use std::sync::{Mutex, MutexGuard, PoisonError};

use numpy::{PyArray1, PyReadonlyArray1};
use phugoid_identification::estimate::{EstimateError, EstimateOptions};
use phugoid_identification::method::Method;
use phugoid_identification::session as library;
use pyo3::prelude::*;

use crate::error::raise;
use crate::estimation::line;
use crate::model::Model;

/// A live estimation, sample by sample, with the same code and the same results as an estimation over a record.
#[pyclass(module = "phugoid", frozen)]
pub(crate) struct Session {
    /// Several Python threads may use the object at the same time.
    inner: Mutex<Running>,
}

/// A session, and what has become of its last sample.
struct Running {
    session: library::Session,
    message: Option<String>,
}

/// What has become of a sample: true where there is an estimate after it.
#[pyclass(module = "phugoid", frozen)]
pub(crate) struct Step {
    /// `estimated`, `waiting` or `refused`.
    #[pyo3(get)]
    kind: &'static str,
    /// Why there is no estimate after the sample; None where there is one.
    #[pyo3(get)]
    reason: Option<String>,
}

#[pymethods]
impl Step {
    fn __bool__(&self) -> bool {
        self.reason.is_none()
    }

    fn __repr__(&self) -> String {
        match &self.reason {
            None => format!("<Step {}>", self.kind),
            Some(reason) => format!("<Step {}: {reason}>", self.kind),
        }
    }
}

#[pymethods]
impl Session {
    #[new]
    #[pyo3(signature = (model, method=None, change_detection=None))]
    fn new(model: &Model, method: Option<&str>, change_detection: Option<bool>) -> PyResult<Self> {
        let options = EstimateOptions {
            method: method.map(str::parse::<Method>).transpose().map_err(raise)?,
            change_detection,
            ..EstimateOptions::default()
        };
        let inner = library::Session::new(&model.inner, &options).map_err(raise)?;
        Ok(Self { inner: Mutex::new(Running { session: inner, message: None }) })
    }

    /// Names of the channels whose values `update` takes, in order, SI.
    #[getter]
    fn channels(&self) -> Vec<String> {
        self.lock().session.channels().to_vec()
    }

    /// Names of the parameters, in the order of `values` and `std_errors`.
    #[getter]
    fn parameters(&self) -> Vec<String> {
        self.lock().session.layout().parameters.iter().map(|p| p.name.clone()).collect()
    }

    /// Takes a sample: time in s, one value per channel, NaN where missing. The answer is true if there is an estimate
    /// after it; if not, its `kind` and `reason` say why: `waiting` for the start, or `refused`, as a time that does not
    /// increase is.
    fn update(&self, py: Python<'_>, time_s: f64, values: PyReadonlyArray1<'_, f64>) -> PyResult<Step> {
        let values =
            values.as_slice().map_err(|_| raise("the values must lie one after the other: numpy.ascontiguousarray"))?;
        // The lock is given back before the interpreter is taken again: whoever waits for one may hold the other.
        py.detach(|| {
            let mut running = self.lock();
            let step = running.session.update(time_s, values)?;
            let (kind, reason) = match step {
                library::Step::Estimated => ("estimated", None),
                library::Step::Waiting { have_s, need_s, reason } => {
                    let measuring = || format!("measuring the noise: {have_s:.2} s of {need_s} s");
                    ("waiting", Some(reason.unwrap_or_else(measuring)))
                }
                library::Step::Refused(reason) => ("refused", Some(reason)),
            };
            running.message.clone_from(&reason);
            Ok(Step { kind, reason })
        })
        .map_err(|error: EstimateError| raise(error))
    }

    /// Why the last sample gave no estimate; None if it gave one.
    #[getter]
    fn message(&self) -> Option<String> {
        self.lock().message.clone()
    }

    /// Estimates after the last sample; None before the first estimate.
    #[getter]
    fn values<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyArray1<f64>>> {
        let running = self.lock();
        let snapshot = running.session.snapshot()?;
        Some(PyArray1::from_iter(py, snapshot.parameters.iter().map(|p| p.value)))
    }

    /// Standard errors (one sigma), corrected for the correlation of the residuals from sample to sample; None before
    /// the first estimate.
    #[getter]
    fn std_errors<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyArray1<f64>>> {
        let running = self.lock();
        let snapshot = running.session.snapshot()?;
        Some(PyArray1::from_iter(py, snapshot.parameters.iter().map(|p| p.std_error)))
    }

    /// The parts of the standard errors that declared uncertainties make (one sigma): a longer flight does not make them
    /// smaller; None before the first estimate.
    #[getter]
    fn systematic_std_errors<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyArray1<f64>>> {
        let running = self.lock();
        let snapshot = running.session.snapshot()?;
        Some(PyArray1::from_iter(py, snapshot.parameters.iter().map(|p| p.systematic_std)))
    }

    /// All results after the last sample as a JSON document, as in the live protocol; None before the first estimate.
    fn snapshot_json(&self) -> PyResult<Option<String>> {
        self.lock().session.snapshot().map(serde_json::to_string).transpose().map_err(raise)
    }

    /// Names and units of the entries of a snapshot, as a JSON document.
    fn layout_json(&self) -> PyResult<String> {
        serde_json::to_string(self.lock().session.layout()).map_err(raise)
    }

    /// Events since the last call, as a JSON document.
    fn take_events_json(&self) -> PyResult<String> {
        serde_json::to_string(&self.lock().session.take_events()).map_err(raise)
    }

    fn __repr__(&self) -> String {
        let running = self.lock();
        let session = &running.session;
        let layout = session.layout();
        match session.snapshot() {
            None => format!("<Session of '{}' by {}: no estimate yet>", layout.model, layout.method),
            Some(snapshot) => {
                let mut text =
                    format!("<Session of '{}' by {} at {:.2} s", layout.model, layout.method, snapshot.time_s);
                let width = layout.parameters.iter().map(|p| p.name.len()).max().unwrap_or(0);
                for (name, p) in layout.parameters.iter().zip(&snapshot.parameters) {
                    text.push_str(&line(&name.name, width, p.value, p.std_error, p.status.word()));
                }
                text.push('>');
                text
            }
        }
    }
}

impl Session {
    fn lock(&self) -> MutexGuard<'_, Running> {
        self.inner.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
