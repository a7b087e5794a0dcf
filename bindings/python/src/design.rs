//! Inputs for flight tests, and what they will tell.

use phugoid::Scenario;
use phugoid::parts::Surface;
use phugoid::parts::design::fit::{Excursions, Fitted, Limits, fitted, with_amplitudes};
use phugoid::parts::design::modes::ModeFrequencies;
use phugoid::parts::design::predict::{Prediction, predict};
use phugoid::parts::design::{Design, Kind, Request, files, shape};
use pyo3::prelude::*;
use serde::Serialize;

use crate::error::raise;
use crate::model::Model;
use crate::record::Record;

#[derive(Serialize)]
struct Document<'a> {
    scenario: &'a str,
    modes: ModeFrequencies,
    limits: Limits,
    design: &'a Design,
    /// Peak deflections, rad, and peak rates, rad/s, in the order of the inputs.
    peaks: Vec<[f64; 2]>,
    limited_by: &'a [&'static str],
    excursions: Excursions,
    prediction: Option<&'a Prediction>,
}

/// Designs an input: a JSON document with the names of `phugoid design --json`, the deflections from trim, and the flight
/// that they make, as the sensors of the scenario measure it. `limits` are those of the deflection and the rate of a surface
/// and of the changes of angle of attack, load factor, sideslip and bank, in SI units and g; NaN: the usual one.
#[pyfunction]
#[allow(clippy::too_many_arguments)] // one for each keyword of the Python function
pub(crate) fn design(
    py: Python<'_>,
    kind: &str,
    surfaces: Vec<String>,
    scenario: &str,
    model: Option<&Model>,
    duration_s: f64,
    lead_s: f64,
    band_hz: Option<[f64; 2]>,
    linear_sweep: bool,
    amplitudes_rad: Vec<f64>,
    limits: [f64; 6],
) -> PyResult<(String, Record, Record)> {
    let kind = Kind::ALL.into_iter().find(|known| known.name() == kind).ok_or_else(|| {
        raise(format!("there is no kind of input '{kind}'; there are {}", Kind::ALL.map(Kind::name).join(", ")))
    })?;
    let surfaces = surfaces.iter().map(|word| surface(word)).collect::<PyResult<Vec<Surface>>>()?;
    let base = Scenario::find(scenario).map_err(raise)?;
    let usual = Limits::default();
    let or = |given: f64, usual: f64| if given.is_nan() { usual } else { given };
    let [deflection, surface_rate, alpha, load_factor, beta, bank] = limits;
    let limits = Limits {
        deflection: or(deflection, usual.deflection),
        surface_rate: or(surface_rate, usual.surface_rate),
        alpha: or(alpha, usual.alpha),
        load_factor: or(load_factor, usual.load_factor),
        beta: or(beta, usual.beta),
        bank: or(bank, usual.bank),
    };
    let sample_rate_hz = base.sample_rate.si();
    let request = Request { surfaces, duration_s, lead_s, sample_rate_hz, band_hz, linear_sweep };
    let model = model.map(|model| &*model.inner);
    py.detach(|| {
        let modes = ModeFrequencies::of_scenario(&base).map_err(raise)?;
        let shape = shape(kind, &request, &modes).map_err(raise)?;
        let chosen = if amplitudes_rad.is_empty() {
            fitted(&shape, &base, &limits)
        } else {
            with_amplitudes(&shape, &base, &limits, &amplitudes_rad)
        };
        let chosen: Fitted = chosen.map_err(raise)?;
        let prediction = model.map(|model| predict(&chosen, model)).transpose().map_err(raise)?;
        let step_s = 1.0 / chosen.design.sample_rate_hz;
        let document = Document {
            scenario: &base.name,
            modes,
            limits,
            design: &chosen.design,
            peaks: chosen.design.inputs.iter().map(|input| [input.peak(), input.peak_rate(step_s)]).collect(),
            limited_by: &chosen.limited_by,
            excursions: chosen.excursions,
            prediction: prediction.as_ref(),
        };
        let text = serde_json::to_string(&document).map_err(raise)?;
        Ok((text, files::record(&chosen.design).into(), chosen.flight.measured.into()))
    })
}

fn surface(word: &str) -> PyResult<Surface> {
    match word {
        "elevator" => Ok(Surface::Elevator),
        "aileron" => Ok(Surface::Aileron),
        "rudder" => Ok(Surface::Rudder),
        other => Err(raise(format!("there is no surface '{other}'; there are elevator, aileron and rudder"))),
    }
}
