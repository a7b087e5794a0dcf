//! How soon the damage could be known at best.

use phugoid_identification::estimate::{EstimateOptions, estimate};
use phugoid_identification::model_file::{ModelFile, Role};
use phugoid_identification::output::Output;

use super::draw::Drawn;
use crate::accuracy::StudyError;
use phugoid_simulation::flight::fly;
use phugoid_simulation::scenario::Scenario;

/// Nats at which an observer is taken to know: odds of three million.
const NATS: f64 = 15.0;

/// Time after the damage at which an observer who knows the damage exactly and has only to decide *whether* it has happened would have
/// 15 nats in the mean: half the sum of the squared whitened innovations of a filter that knows the undamaged aircraft, on the
/// noise-free record in still air, is `Delta^T M Delta / 2`. Infinite if the record does not tell it.
pub(super) fn informed_latency_s(drawn: &Drawn, model: &ModelFile, damage_at_s: f64) -> Result<f64, StudyError> {
    let mut known = model.clone();
    known.parameters.retain(|p| !matches!(p.role, Role::Bias(_) | Role::Offset(_)));
    let terms = known.parameters.iter_mut().filter(|p| !p.fixed);
    for (parameter, value) in terms.zip(&drawn.before) {
        parameter.start = *value;
        parameter.fixed = true;
    }
    known.estimator.reaching_limit = Some(1e6);
    let sensors = &drawn.scenario.sensors;
    for (output, noise) in [
        (Output::TrueAirspeed, sensors.true_airspeed.noise.si()),
        (Output::Alpha, sensors.alpha.noise.si()),
        (Output::Theta, sensors.theta.noise.si()),
        (Output::PitchRate, sensors.q.noise.si()),
        (Output::Ax, sensors.ax.noise.si()),
        (Output::Az, sensors.az.noise.si()),
    ] {
        known.noise[output.index()] = Some(noise);
    }
    let still = Scenario { gust: Vec::new(), turbulence: None, ..drawn.scenario.clone() };
    let flight = fly(&still)?;
    let options = EstimateOptions { change_detection: Some(false), ..EstimateOptions::causal() };
    // Without its gusts the aircraft may stray where with them it did not.
    let Some(held) = flight.truth.between(f64::NEG_INFINITY, flight.held_until_s()) else { return Ok(f64::INFINITY) };
    let estimation = estimate(&held, &known, &options, &mut |_| {})?;
    let mut nats = 0.0;
    for (k, time_s) in estimation.history.time_s.iter().enumerate() {
        if *time_s < damage_at_s - 1e-9 {
            continue;
        }
        let squares = estimation.history.residuals.iter().map(|signal| signal.values[k]).filter(|x| x.is_finite());
        nats += 0.5 * squares.map(|x| x * x).sum::<f64>();
        if nats >= NATS {
            return Ok(time_s - damage_at_s);
        }
    }
    Ok(f64::INFINITY)
}
