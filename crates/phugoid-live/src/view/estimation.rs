//! A result from the JSON document of `phugoid estimate --json --history`.

use std::io::Read;

use phugoid_identification::estimation::{EstimationStatus, ParameterResult};
use phugoid_identification::method::Method;
use phugoid_identification::session::{Layout, ParameterLayout, SignalLayout};
use serde::Deserialize;

use super::finished::{Event, FinalParameter, Finished, Hello, ViewError};
use super::thinned::{Row, Thinned};

#[derive(Deserialize)]
struct Document {
    source: String,
    model: String,
    method: Method,
    parameters: Vec<ParameterResult>,
    #[serde(default)]
    status: Option<EstimationStatus>,
    #[serde(default)]
    verdict: Vec<String>,
    #[serde(default)]
    events: Vec<Event>,
    history: Option<History>,
}

/// As [`phugoid_identification::estimation::History`], but with `null` in place of NaN.
#[derive(Deserialize)]
struct History {
    time_s: Vec<f64>,
    inputs: Vec<Signal>,
    measured: Vec<Signal>,
    predicted: Vec<Signal>,
    residuals: Vec<Signal>,
    parameters: Vec<ParameterHistory>,
}

#[derive(Deserialize)]
struct Signal {
    name: String,
    unit: String,
    values: Vec<Option<f64>>,
}

#[derive(Deserialize)]
struct ParameterHistory {
    name: String,
    value: Vec<Option<f64>>,
    std_error: Vec<Option<f64>>,
}

/// Reads the whole document.
pub(super) fn read(file: impl Read) -> Result<Finished, ViewError> {
    let document: Document = serde_json::from_reader(file).map_err(|error| ViewError::NoResult(error.to_string()))?;
    let history = document.history.ok_or(ViewError::NoHistory)?;
    let result = |name: &str| document.parameters.iter().find(|parameter| parameter.name == name);
    let layout = Layout {
        model: document.model,
        method: document.method,
        axes: Vec::new(),
        parameters: history.parameters.iter().map(|course| parameter(&course.name, result(&course.name))).collect(),
        outputs: history.measured.iter().map(signal).collect(),
        inputs: history.inputs.iter().map(signal).collect(),
    };
    let mut columns = Thinned::new(history.parameters.len(), history.measured.len(), history.inputs.len());
    for (k, time_s) in history.time_s.iter().enumerate() {
        let at = |values: &[Option<f64>]| values.get(k).copied().flatten().unwrap_or(f64::NAN);
        let outputs = history.measured.iter().zip(&history.predicted).zip(&history.residuals);
        let row = Row::new(
            history.parameters.iter().map(|course| [at(&course.value), at(&course.std_error)]),
            outputs.map(|((measured, predicted), residual)| [measured, predicted, residual].map(|s| at(&s.values))),
            history.inputs.iter().map(|input| at(&input.values)),
        );
        columns.push(*time_s, &row);
    }
    let last = |course: &ParameterHistory| {
        let known = result(&course.name);
        FinalParameter {
            value: known.map(|p| p.value),
            std_error: known.map(|p| p.corrected_std_error),
            systematic_std: known.map(|p| p.systematic_std),
            status: known.map(|p| p.status.word().to_owned()).unwrap_or_default(),
            readiness: known.and_then(|p| p.readiness.clone()),
            truth: known.and_then(|p| p.truth),
        }
    };
    Ok(Finished {
        parameters: history.parameters.iter().map(last).collect(),
        hello: Hello { source: document.source, layout },
        history: columns.finish(),
        events: document.events,
        status: document.status,
        verdict: document.verdict,
        link: None,
    })
}

fn signal(signal: &Signal) -> SignalLayout {
    SignalLayout { name: signal.name.clone(), unit: signal.unit.clone() }
}

fn parameter(name: &str, result: Option<&ParameterResult>) -> ParameterLayout {
    let Some(result) = result else {
        return ParameterLayout { name: name.to_owned(), ..ParameterLayout::default() };
    };
    ParameterLayout {
        name: name.to_owned(),
        unit: result.unit.clone(),
        initial: result.initial,
        prior_std: result.prior_std,
        nuisance: result.nuisance,
    }
}
