//! Whether a filter that has learnt its noise levels explains what the aircraft does.
//!
//! Levels that follow the residuals make room for any model: a wrong one has large levels and contradicts nothing. But a
//! model that is right explains most of what the accelerometers measure while the aircraft moves.

use crate::core::estimation::{EstimationStatus, History, ReasonCode, Signal, VerdictReason};
use crate::preparation::noise::measure_noise;
use phugoid_flight_data::statistics::{median, robust_std};

/// Share of an output's motion that the residual may have.
const UNEXPLAINED: f64 = 0.5;
/// The same of the forward acceleration, which the wind and the engine move as well as the manoeuvre: with true values
/// it was up to 1.4 on sound flights in turbulence.
const FORWARD_UNEXPLAINED: f64 = 2.0;
/// A residual that is no larger than this many times the white noise of the channel is noise, whatever the motion.
const NOISE: f64 = 4.0;
/// Outputs that the coefficients make directly; the others are states, which a filter follows whatever the model.
const FORCES: [&str; 3] = ["ax", "ay", "az"];

/// The residual and the motion of an output, one sigma each, about the median.
fn sizes(measured: &Signal, predicted: &Signal) -> Option<(f64, f64)> {
    let residual = robust_std(measured.values.iter().zip(&predicted.values).map(|(y, p)| y - p))?;
    let mut values: Vec<f64> = measured.values.iter().copied().filter(|v| v.is_finite()).collect();
    let middle = median(&mut values)?;
    // The motion is what the largest tenth does: a manoeuvre may be a short part of a record.
    let mut departures: Vec<f64> = values.iter().map(|v| (v - middle).abs()).collect();
    departures.sort_by(f64::total_cmp);
    let motion = departures.get(departures.len() * 9 / 10).copied()? / 1.645;
    Some((residual, motion))
}

/// Names the forces of which the model explains too little.
pub(super) fn reason(history: &History) -> Option<VerdictReason> {
    let mut named = Vec::new();
    for measured in history.measured.iter().filter(|signal| FORCES.contains(&signal.name.as_str())) {
        let Some(predicted) = history.predicted.iter().find(|signal| signal.name == measured.name) else { continue };
        let Some((residual, motion)) = sizes(measured, predicted) else { continue };
        let white = measure_noise(&measured.values).map_or(0.0, |noise| noise.std);
        let limit = if measured.name == "ax" { FORWARD_UNEXPLAINED } else { UNEXPLAINED };
        if residual > NOISE * white && residual * residual > limit * motion * motion {
            named.push((measured.name.clone(), 100.0 * (residual / motion).powi(2)));
        }
    }
    if named.is_empty() {
        return None;
    }
    let list: Vec<String> = named.iter().map(|(name, share)| format!("{name} ({share:.0} %)")).collect();
    Some(VerdictReason {
        code: ReasonCode::FitWorseThanMean,
        status: EstimationStatus::Doubtful,
        concerns: named.into_iter().map(|(name, _)| name).collect(),
        sentence: format!(
            "The model leaves too much of the motion unexplained of: {}. Look for a wrong unit, sign or delay, a \
             wrong mass or thrust, or terms that the model lacks.",
            list.join(", ")
        ),
    })
}
