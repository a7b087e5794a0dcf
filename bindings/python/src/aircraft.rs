//! Trim and linearisation of an aircraft: the built-in F-16, or that of a file.

use phugoid::{
    AircraftName, AnyAircraft, BuiltInAircraft, F16Tables, FlownOptions, Linearization, Trim, TrimCondition,
};
use pyo3::prelude::*;

use crate::error::raise;

fn trimmed(
    altitude_m: f64,
    speed_m_s: f64,
    cg: f64,
    flight_path_rad: f64,
    turn_rate_rad_s: f64,
    aircraft: &str,
) -> PyResult<(AnyAircraft, Trim)> {
    let aircraft = if aircraft == AircraftName::F16.word() {
        AnyAircraft::BuiltIn(BuiltInAircraft::new(AircraftName::F16, F16Tables::Book, cg).map_err(raise)?)
    } else {
        AnyAircraft::open(aircraft, &FlownOptions::default()).map_err(raise)?
    };
    let wanted = TrimCondition::steady(&aircraft, speed_m_s, altitude_m, flight_path_rad, turn_rate_rad_s);
    let trim = phugoid::trim(&aircraft, &wanted).map_err(raise)?;
    Ok((aircraft, trim))
}

/// Controls and attitude of steady flight, as a JSON document.
#[pyfunction]
#[pyo3(signature = (altitude_m, speed_m_s, cg=0.35, flight_path_rad=0.0, turn_rate_rad_s=0.0, aircraft="f16"))]
pub(crate) fn trim(
    altitude_m: f64,
    speed_m_s: f64,
    cg: f64,
    flight_path_rad: f64,
    turn_rate_rad_s: f64,
    aircraft: &str,
) -> PyResult<String> {
    let (_, trim) = trimmed(altitude_m, speed_m_s, cg, flight_path_rad, turn_rate_rad_s, aircraft)?;
    serde_json::to_string(&trim).map_err(raise)
}

/// The linear model about a trim, with its longitudinal and lateral parts and their modes, as a JSON document.
#[pyfunction]
#[pyo3(signature = (altitude_m, speed_m_s, cg=0.35, flight_path_rad=0.0, turn_rate_rad_s=0.0, aircraft="f16"))]
pub(crate) fn linearize(
    altitude_m: f64,
    speed_m_s: f64,
    cg: f64,
    flight_path_rad: f64,
    turn_rate_rad_s: f64,
    aircraft: &str,
) -> PyResult<String> {
    let (aircraft, trim) = trimmed(altitude_m, speed_m_s, cg, flight_path_rad, turn_rate_rad_s, aircraft)?;
    let Linearization { model, longitudinal, lateral } = phugoid::linearize(&aircraft, &trim).map_err(raise)?;
    let document =
        serde_json::json!({ "trim": trim, "longitudinal": longitudinal, "lateral": lateral, "model": model });
    Ok(document.to_string())
}
