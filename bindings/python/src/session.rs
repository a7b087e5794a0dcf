//! Live estimation, sample by sample.

use std::sync::{Mutex, MutexGuard, PoisonError};

use numpy::{PyArray1, PyReadonlyArray1};
use phugoid_identification::estimate::EstimateOptions;
use phugoid_identification::method::Method;
use phugoid_identification::session::{self as library, Step};
use pyo3::prelude::*;

use crate::error::raise;
use crate::estimation::line;
use crate::model::Model;

/// A live estimation, sample by sample, with the same code and the same results as an estimation over a record.
#[pyclass(module = "phugoid")]
pub(crate) struct Session {
    /// Several Python threads may use the object at the same time.
    inner: Mutex<library::Session>,
    message: Option<String>,
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
        Ok(Self { inner: Mutex::new(inner), message: None })
    }

    /// Names of the channels whose values `update` takes, in order, SI.
    #[getter]
    fn channels(&self) -> Vec<String> {
        self.session().channels().to_vec()
    }

    /// Names of the parameters, in the order of `values` and `std_errors`.
    #[getter]
    fn parameters(&self) -> Vec<String> {
        self.session().layout().parameters.iter().map(|p| p.name.clone()).collect()
    }

    /// Takes a sample: time in s, one value per channel, NaN where missing. True if there is an estimate after it; if
    /// not, `message` says why (waiting for the start, a time that does not increase).
    fn update(&mut self, py: Python<'_>, time_s: f64, values: PyReadonlyArray1<'_, f64>) -> PyResult<bool> {
        let values =
            values.as_slice().map_err(|_| raise("the values must lie one after the other: numpy.ascontiguousarray"))?;
        let inner = self.inner.get_mut().unwrap_or_else(PoisonError::into_inner);
        let step = py.detach(|| inner.update(time_s, values)).map_err(raise)?;
        self.message = match step {
            Step::Estimated => None,
            Step::Waiting { have_s, need_s, reason: None } => {
                Some(format!("measuring the noise: {have_s:.2} s of {need_s} s"))
            }
            Step::Waiting { reason, .. } => reason,
            Step::Refused(reason) => Some(reason),
        };
        Ok(self.message.is_none())
    }

    /// Why the last sample gave no estimate; None if it gave one.
    #[getter]
    fn message(&self) -> Option<&str> {
        self.message.as_deref()
    }

    /// Estimates after the last sample; None before the first estimate.
    #[getter]
    fn values<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyArray1<f64>>> {
        let session = self.session();
        let snapshot = session.snapshot()?;
        Some(PyArray1::from_iter(py, snapshot.parameters.iter().map(|p| p.value)))
    }

    /// Standard errors (one sigma), corrected for the correlation of the residuals from sample to sample; None before
    /// the first estimate.
    #[getter]
    fn std_errors<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyArray1<f64>>> {
        let session = self.session();
        let snapshot = session.snapshot()?;
        Some(PyArray1::from_iter(py, snapshot.parameters.iter().map(|p| p.std_error)))
    }

    /// The parts of the standard errors that declared uncertainties make (one sigma): a longer flight does not make them
    /// smaller; None before the first estimate.
    #[getter]
    fn systematic_std_errors<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyArray1<f64>>> {
        let session = self.session();
        let snapshot = session.snapshot()?;
        Some(PyArray1::from_iter(py, snapshot.parameters.iter().map(|p| p.systematic_std)))
    }

    /// All results after the last sample as a JSON document, as in the live protocol; None before the first estimate.
    fn snapshot_json(&self) -> PyResult<Option<String>> {
        self.session().snapshot().map(serde_json::to_string).transpose().map_err(raise)
    }

    /// Names and units of the entries of a snapshot, as a JSON document.
    fn layout_json(&self) -> PyResult<String> {
        serde_json::to_string(self.session().layout()).map_err(raise)
    }

    /// Events since the last call, as a JSON document.
    fn take_events_json(&mut self) -> PyResult<String> {
        serde_json::to_string(&self.session().take_events()).map_err(raise)
    }

    fn __repr__(&self) -> String {
        let session = self.session();
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
    fn session(&self) -> MutexGuard<'_, library::Session> {
        self.inner.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
