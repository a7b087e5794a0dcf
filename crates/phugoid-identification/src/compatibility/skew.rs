//! The delay of an input channel against everything else, by the estimator's own model.

use phugoid_flight_data::record::Record;
use serde::Serialize;

use super::correction::moved;
use crate::core::error::EstimateError;
use crate::model_file::{InputHold, ModelFile};
use crate::pipeline::estimate::{EstimateOptions, estimate};

/// The delay of an input channel against the other channels.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct InputSkew {
    /// Canonical name of the channel, e.g. `elevator`.
    pub channel: String,
    /// How late its values are, s; negative: early.
    pub delay_s: f64,
    /// One-sigma error, s, from the curvature of the likelihood.
    pub std_error_s: f64,
    /// Delays tried, s, and half the sum of the squared normalised innovations (each at most 9) with each.
    pub tried: Vec<[f64; 2]>,
}

/// Finds the delay of an input channel with which the innovations of the estimator are smallest: the maximum of the
/// likelihood over the delay, all parameters at their estimates for it. Delays of up to three samples either way are
/// tried in half samples, and a parabola through the best three gives the rest.
///
/// # Errors
/// [`EstimateError`] from the estimation; [`EstimateError::Model`] if the smallest lies at the end of the range, or
/// nothing in the record depends on the delay.
pub fn input_skew(record: &Record, model: &ModelFile, channel: &str) -> Result<InputSkew, EstimateError> {
    const HALVES: i32 = 6;
    let step = 0.5 * record.sample_time_s();
    // The delay that is looked for is not to be taken out beforehand.
    let hold = if model.input == InputHold::Auto { InputHold::Interpolated } else { model.input };
    let model = &ModelFile { input: hold, ..model.clone() };
    let options = EstimateOptions { change_detection: Some(false), ..EstimateOptions::causal() };
    let mut tried = Vec::new();
    for k in -HALVES..=HALVES {
        let delay = f64::from(k) * step;
        let mut shifted = record.clone();
        if let Some(c) = shifted.channels.iter_mut().find(|c| c.name == channel) {
            c.values = moved(&record.time, &c.values, delay);
        }
        // The same samples for every delay: those that the largest ones leave.
        let margin = HALVES as usize;
        let end = shifted.time.len().saturating_sub(margin).max(margin);
        shifted.time = shifted.time[margin..end].to_vec();
        for c in &mut shifted.channels {
            c.values = c.values[margin..end].to_vec();
        }
        let estimation = estimate(&shifted, model, &options, &mut |_| ())?;
        let squares = estimation.history.residuals.iter().flat_map(|s| &s.values).filter(|v| v.is_finite());
        tried.push([delay, 0.5 * squares.map(|v| (v * v).min(9.0)).sum::<f64>()]);
    }
    let best = (0..tried.len()).min_by(|a, b| tried[*a][1].total_cmp(&tried[*b][1])).unwrap_or(0);
    let refused = |why: &str| Err(EstimateError::Model(format!("delay of `{channel}`: {why}")));
    let (Some(before), Some(after)) = (best.checked_sub(1).and_then(|k| tried.get(k)), tried.get(best + 1)) else {
        return refused(
            "the smallest innovations lie at the end of the range of three samples: shift the channel roughly first",
        );
    };
    let curvature = (before[1] - 2.0 * tried[best][1] + after[1]) / (step * step);
    if curvature.is_nan() || curvature <= 0.0 {
        return refused("no innovation depends on it: the channel does not move");
    }
    let delay_s = tried[best][0] - 0.5 * (after[1] - before[1]) / step / curvature;
    Ok(InputSkew { channel: channel.to_owned(), delay_s, std_error_s: curvature.recip().sqrt(), tried })
}
