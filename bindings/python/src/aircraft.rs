//! Trim and linearisation of an aircraft: the built-in F-16, or that of a file.

use std::path::PathBuf;

use phugoid::{AircraftName, AnyAircraft, FlownOptions, Linearization, Trim, TrimCondition};
use pyo3::prelude::*;
use serde_json::json;

use crate::error::raise;

#[allow(clippy::too_many_arguments)] // those of the Python function
fn trimmed(
    altitude_m: f64,
    speed_m_s: f64,
    cg: Option<f64>,
    flight_path_rad: f64,
    turn_rate_rad_s: f64,
    aircraft: &str,
    with_files: Vec<PathBuf>,
    properties: Vec<(String, f64)>,
) -> PyResult<(AnyAircraft, Trim)> {
    let aircraft = if aircraft == AircraftName::F16.word() {
        if !(with_files.is_empty() && properties.is_empty()) {
            return Err(raise(
                "with_files and properties are for aircraft of files, and the aircraft is `f16`: leave them out",
            ));
        }
        AnyAircraft::f16(None, cg).map_err(raise)?
    } else if cg.is_some() {
        return Err(raise(format!("cg is that of the F-16, and the aircraft is `{aircraft}`: leave it out")));
    } else {
        let options = FlownOptions { with: with_files, properties, ..FlownOptions::default() };
        AnyAircraft::open(aircraft, &options).map_err(raise)?
    };
    let wanted = TrimCondition::steady(&aircraft, speed_m_s, altitude_m, flight_path_rad, turn_rate_rad_s);
    let trim = phugoid::trim(&aircraft, &wanted).map_err(raise)?;
    Ok((aircraft, trim))
}

/// What documents say of an aircraft beside its trim: its name, and what its file leaves out and what is assumed.
fn described(document: &mut serde_json::Value, aircraft: &AnyAircraft) {
    document["aircraft"] = json!(aircraft.name());
    document["notes"] = json!(aircraft.notes());
}

/// Controls and attitude of steady flight, as a JSON document.
#[pyfunction]
#[allow(clippy::too_many_arguments)] // those of the Python function
#[pyo3(signature = (altitude_m, speed_m_s, cg=None, flight_path_rad=0.0, turn_rate_rad_s=0.0, aircraft="f16", with_files=vec![], properties=vec![]))]
pub(crate) fn trim(
    py: Python<'_>,
    altitude_m: f64,
    speed_m_s: f64,
    cg: Option<f64>,
    flight_path_rad: f64,
    turn_rate_rad_s: f64,
    aircraft: &str,
    with_files: Vec<PathBuf>,
    properties: Vec<(String, f64)>,
) -> PyResult<String> {
    let (aircraft, trim) = py.detach(|| {
        trimmed(altitude_m, speed_m_s, cg, flight_path_rad, turn_rate_rad_s, aircraft, with_files, properties)
    })?;
    let mut document = serde_json::to_value(&trim).map_err(raise)?;
    described(&mut document, &aircraft);
    Ok(document.to_string())
}

/// The linear model about a trim, with its longitudinal and lateral parts and their modes, as a JSON document.
#[pyfunction]
#[allow(clippy::too_many_arguments)] // those of the Python function
#[pyo3(signature = (altitude_m, speed_m_s, cg=None, flight_path_rad=0.0, turn_rate_rad_s=0.0, aircraft="f16", with_files=vec![], properties=vec![]))]
pub(crate) fn linearize(
    py: Python<'_>,
    altitude_m: f64,
    speed_m_s: f64,
    cg: Option<f64>,
    flight_path_rad: f64,
    turn_rate_rad_s: f64,
    aircraft: &str,
    with_files: Vec<PathBuf>,
    properties: Vec<(String, f64)>,
) -> PyResult<String> {
    let (aircraft, trim, Linearization { model, longitudinal, lateral }) = py.detach(|| {
        let (aircraft, trim) =
            trimmed(altitude_m, speed_m_s, cg, flight_path_rad, turn_rate_rad_s, aircraft, with_files, properties)?;
        let linear = phugoid::linearize(&aircraft, &trim).map_err(raise)?;
        PyResult::Ok((aircraft, trim, linear))
    })?;
    let mut document = json!({ "trim": trim, "longitudinal": longitudinal, "lateral": lateral, "model": model });
    described(&mut document, &aircraft);
    Ok(document.to_string())
}
