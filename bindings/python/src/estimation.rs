//! Estimation over records.

use std::collections::BTreeMap;
use std::sync::Arc;

use numpy::PyArray1;
use phugoid::{EstimateOptions, Method, StructureSearch};
use phugoid_flight_data::record as flight;
use phugoid_identification::estimation as results;
use phugoid_identification::options::{Band, FlowAngles, Likelihood};
use pyo3::exceptions::PyKeyError;
use pyo3::prelude::*;
use pyo3::types::PyBytes;

use crate::error::raise;
use crate::model::Model;
use crate::pickle;
use crate::record::Record;

/// The result of an estimation.
#[pyclass(module = "phugoid", frozen)]
pub(crate) struct Estimation {
    inner: results::Estimation,
    /// Inputs, measured and predicted outputs, residuals, parameters and their errors by sample.
    history: Arc<flight::Record>,
}

#[pymethods]
impl Estimation {
    /// Everything but the histories as a JSON document, with the names of `phugoid estimate --json`.
    fn to_json(&self) -> PyResult<String> {
        let without = results::Estimation { history: results::History::default(), ..self.inner.clone() };
        serde_json::to_string(&without).map_err(raise)
    }

    /// Everything, histories too, as bytes, for `pickle`.
    fn to_bytes<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        let bytes = py.detach(|| pickle::bytes(&self.inner))?;
        Ok(PyBytes::new(py, &bytes))
    }

    /// The result that `to_bytes` wrote.
    #[staticmethod]
    fn from_bytes(py: Python<'_>, bytes: &[u8]) -> PyResult<Self> {
        py.detach(|| pickle::value(bytes, "result").map(Self::new))
    }

    /// Name of the record: its file, or the name of a scenario.
    #[getter]
    fn source(&self) -> &str {
        &self.inner.source
    }

    /// Correlation matrix of the errors, in the order of `names`, by rows.
    #[getter]
    fn correlation(&self) -> Vec<Vec<f64>> {
        self.inner.correlation.clone()
    }

    /// Names of the parameters, nuisance columns last.
    #[getter]
    fn names(&self) -> Vec<&str> {
        self.inner.parameters.iter().map(|p| p.name.as_str()).collect()
    }

    /// Estimates at the end, in the order of `names`.
    #[getter]
    fn values<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_iter(py, self.inner.parameters.iter().map(|p| p.value))
    }

    /// One-sigma errors at the end, corrected for the colour of the residuals; bounds are two of them.
    #[getter]
    fn std_errors<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_iter(py, self.inner.parameters.iter().map(|p| p.corrected_std_error))
    }

    /// The parts of the standard errors that declared uncertainties make (one sigma): a longer flight does not make them
    /// smaller. Zero where nothing is declared.
    #[getter]
    fn systematic_std_errors<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_iter(py, self.inner.parameters.iter().map(|p| p.systematic_std))
    }

    /// Of a longitudinal model of increments to a database, the total derivatives, which hold the slopes of the database: value
    /// and one-sigma error by name, such as `Cm_alpha`. Empty for any other model.
    #[getter]
    fn totals(&self) -> BTreeMap<&str, (f64, f64)> {
        self.inner.totals.iter().map(|total| (total.name.as_str(), (total.value, total.std_error))).collect()
    }

    /// Value and one-sigma error of a parameter.
    fn __getitem__(&self, name: &str) -> PyResult<(f64, f64)> {
        let found = self.inner.parameters.iter().find(|p| p.name == name);
        let none = || PyKeyError::new_err(format!("no parameter `{name}`; there are {}", self.names().join(", ")));
        found.map(|p| (p.value, p.corrected_std_error)).ok_or_else(none)
    }

    /// What the result as a whole is worth: `sound`, `provisional`, `doubtful` or `refused`.
    #[getter]
    fn status(&self) -> &str {
        self.inner.status.word()
    }

    /// Why it is not sound: code, status that it asks for, names that it is about, sentence.
    #[getter]
    fn reasons(&self) -> Vec<(&str, &str, Vec<String>, String)> {
        let reason =
            |r: &results::VerdictReason| (r.code.word(), r.status.word(), r.concerns.clone(), r.sentence.clone());
        self.inner.reasons.iter().map(reason).collect()
    }

    /// The verdict in sentences.
    #[getter]
    fn verdict(&self) -> Vec<String> {
        self.inner.verdict.clone()
    }

    /// Histories as a record: inputs, outputs, `<output>_predicted`, `<output>_residual`, each parameter and
    /// `<parameter>_std`.
    #[getter]
    fn history(&self) -> Record {
        Record { inner: Arc::clone(&self.history) }
    }

    /// Estimator used.
    #[getter]
    fn method(&self) -> &str {
        self.inner.method.name()
    }

    fn __repr__(&self) -> String {
        let estimation = &self.inner;
        let width = estimation.parameters.iter().map(|p| p.name.len()).max().unwrap_or(0);
        let mut text =
            format!("<Estimation of '{}' by {}: {}", estimation.source, estimation.method, estimation.status);
        for p in &estimation.parameters {
            text.push_str(&line(&p.name, width, p.value, p.corrected_std_error, p.status.word()));
        }
        text.push('>');
        text
    }
}

impl Estimation {
    fn new(inner: results::Estimation) -> Self {
        let mut history = inner.history.record(&inner.source);
        // Its times are those of the record, and so is their zero.
        history.quality.start = inner.quality.start;
        Self { inner, history: Arc::new(history) }
    }
}

/// Estimates the parameters of `model` from `record`.
#[pyfunction]
#[pyo3(signature = (record, model, method=None, change_detection=None, causal_only=false, structure="offer", truth=BTreeMap::new(),
                    further=Vec::new(), predict=None, progress=None, likelihood="robust", flow_angles="auto", band=None))]
#[allow(clippy::too_many_arguments)] // one per keyword of the Python function
pub(crate) fn estimate(
    py: Python<'_>,
    record: &Record,
    model: &Model,
    method: Option<&str>,
    change_detection: Option<bool>,
    causal_only: bool,
    structure: &str,
    truth: BTreeMap<String, f64>,
    further: Vec<Record>,
    predict: Option<Record>,
    progress: Option<Py<PyAny>>,
    likelihood: &str,
    flow_angles: &str,
    band: Option<(f64, f64)>,
) -> PyResult<Estimation> {
    let whole = |record: &Record| (*record.inner).clone();
    let options = EstimateOptions {
        method: method.map(str::parse::<Method>).transpose().map_err(raise)?,
        change_detection,
        causal_only,
        truth,
        structure: structure_search(structure)?,
        further: further.iter().map(whole).collect(),
        predict: predict.as_ref().map(whole),
        likelihood: match likelihood {
            "robust" => Likelihood::Robust,
            "gaussian" => Likelihood::Gaussian,
            other => return Err(raise(format!("likelihood = '{other}': expected 'robust' or 'gaussian'"))),
        },
        flow_angles: match flow_angles {
            "auto" => FlowAngles::Auto,
            "simulated" => FlowAngles::Simulated,
            "measured" => FlowAngles::Measured,
            other => {
                return Err(raise(format!("flow_angles = '{other}': expected 'auto', 'simulated' or 'measured'")));
            }
        },
        band: band.map(|(low_hz, high_hz)| Band { low_hz, high_hz }.check()).transpose().map_err(raise)?,
        ..EstimateOptions::default()
    };
    // A failure of the callback must not be lost; it is raised when the estimation is done.
    let mut failed: Option<PyErr> = None;
    let result = py.detach(|| {
        phugoid::estimate_with_progress(&record.inner, &model.inner, &options, &mut |done| {
            if let (Some(progress), None) = (&progress, &failed) {
                failed = Python::attach(|py| progress.call1(py, (done,)).err());
            }
        })
    });
    match failed {
        Some(error) => Err(error),
        None => Ok(Estimation::new(result.map_err(raise)?)),
    }
}

fn structure_search(word: &str) -> PyResult<StructureSearch> {
    match word {
        "offer" => Ok(StructureSearch::Offer),
        "never" => Ok(StructureSearch::Never),
        "auto" => Ok(StructureSearch::Auto),
        other => Err(raise(format!("structure = '{other}': expected 'offer', 'never' or 'auto'"))),
    }
}

/// One line about a parameter in a `repr`: name, estimate, two standard errors, status.
pub(crate) fn line(name: &str, width: usize, value: f64, std_error: f64, status: &str) -> String {
    format!("\n  {name:<width$}  {} +- {}  {status}", significant(value, 5), significant(2.0 * std_error, 3))
}

/// A number with so many significant digits, aligned to the right in 12 columns.
fn significant(value: f64, digits: usize) -> String {
    let exponent = if value == 0.0 || !value.is_finite() { 0 } else { value.abs().log10().floor() as i32 };
    let decimals = (digits as i32 - 1 - exponent).clamp(0, 12) as usize;
    format!("{value:>12.decimals$}")
}
