//! Checks of a record before an estimation: its contents, and the errors of its sensors.

use phugoid::CompatibilityOptions;
use phugoid_identification::compatibility::{Group, HeldError};
use pyo3::prelude::*;

use crate::error::raise;
use crate::model::Model;
use crate::record::Record;

/// Contents of a flight and the derivatives that it can determine: a JSON document with the names of `phugoid inspect
/// --json`.
#[pyfunction]
#[pyo3(signature = (record, model=None))]
pub(crate) fn inspect(py: Python<'_>, record: &Record, model: Option<&Model>) -> PyResult<String> {
    let found = py.detach(|| phugoid::inspect(&record.inner, model.map(|model| &*model.inner)));
    serde_json::to_string(&found).map_err(raise)
}

/// The errors of the sensors from the kinematics alone: a JSON document with the names of `phugoid compatibility
/// --json`, and the record without those that are offered as corrections.
#[pyfunction]
#[pyo3(signature = (record, groups=None, vanes_x_m=[0.0, 0.0], gravity_m_s2=None, flat_earth=false, unknowns=None, without=Vec::new(), held=Vec::new()))]
#[allow(clippy::too_many_arguments, reason = "the arguments of the function of Python")]
pub(crate) fn compatibility(
    py: Python<'_>,
    record: &Record,
    groups: Option<Vec<String>>,
    vanes_x_m: [f64; 2],
    gravity_m_s2: Option<f64>,
    flat_earth: bool,
    unknowns: Option<Vec<String>>,
    without: Vec<String>,
    held: Vec<(String, f64)>,
) -> PyResult<(String, Record)> {
    let standard = CompatibilityOptions::default();
    let options = CompatibilityOptions {
        groups: match groups {
            Some(words) => words.iter().map(|word| group(word)).collect::<PyResult<_>>()?,
            None => standard.groups.clone(),
        },
        unknowns,
        without,
        held: held.into_iter().map(|(name, value)| HeldError { name, value, unit: String::new() }).collect(),
        vanes_x: vanes_x_m,
        gravity: gravity_m_s2,
        flat_earth,
        ..standard
    };
    let found = py.detach(|| phugoid::compatibility(&record.inner, &options)).map_err(raise)?;
    let corrected = found.corrections.apply(&record.inner);
    Ok((serde_json::to_string(&found).map_err(raise)?, corrected.into()))
}

/// A group by its word in documents, `air-data-scales` or `air_data_scales`.
fn group(word: &str) -> PyResult<Group> {
    let known = serde_json::from_value(serde_json::Value::String(word.replace('_', "-")));
    known.map_err(|_| {
        let words = Group::ALL.iter().filter_map(|group| serde_json::to_string(group).ok());
        raise(format!(
            "there is no group of errors '{word}'; there are {}",
            words.map(|word| word.trim_matches('"').to_owned()).collect::<Vec<_>>().join(", ")
        ))
    })
}
