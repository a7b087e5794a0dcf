//! From a record to the inputs and outputs of the kinematics.

use phugoid_flight_data::record::Record;
use phugoid_flight_data::statistics::median;

use super::kinematics::{Inertial, OUTPUTS, STATES};
use crate::batch::Noise;
use crate::core::error::EstimateError;
use crate::preparation::prepare::channel;

/// Channels of the outputs, in their order.
pub(super) const OUTPUT_CHANNELS: [&str; OUTPUTS] =
    ["true_airspeed", "alpha", "beta", "phi", "theta", "psi", "north", "east", "altitude"];

/// Inertial channels in the order of the inputs.
const FORCES: [&str; 3] = ["ax", "ay", "az"];
const RATES: [&str; 3] = ["p", "q", "r"];

/// The record as the kinematic model needs it: inertial inputs, measured outputs, and the start of the search.
pub(super) struct Signals {
    pub(super) time: Vec<f64>,
    pub(super) inputs: Vec<Inertial>,
    pub(super) outputs: Vec<[f64; OUTPUTS]>,
    /// Where the search for the initial state starts.
    pub(super) start: [f64; STATES],
    /// Channels that the record has values of.
    pub(super) present: Vec<String>,
    /// True if there is any lateral motion to reconstruct.
    pub(super) lateral: bool,
    pub(super) notes: Vec<String>,
}

/// Collects the signals of a record. Gaps of the inertial channels are bridged by straight lines.
pub(super) fn signals(record: &Record) -> Result<Signals, EstimateError> {
    for name in ["true_airspeed", "theta", "q", "ax", "az"] {
        let values = channel(record, name)?;
        if !values.iter().any(|v| v.is_finite()) {
            return Err(EstimateError::EmptyChannel(name.to_owned()));
        }
    }
    let samples = record.time.len();
    if samples < 20 {
        return Err(EstimateError::TooShort { samples });
    }
    let mut notes = Vec::new();
    let present: Vec<String> = record
        .channels
        .iter()
        .filter(|c| c.values.len() == samples && c.values.iter().any(|v| v.is_finite()))
        .map(|c| c.name.clone())
        .collect();
    let mut inertial = |name: &str| -> Vec<f64> {
        let Ok(values) = channel(record, name) else {
            notes.push(format!("there is no channel `{name}`: it is taken for zero"));
            return vec![0.0; samples];
        };
        let (filled, bridged) = bridged(&record.time, values);
        if bridged > 0 {
            notes.push(format!("`{name}` is missing in {bridged} samples: bridged by straight lines"));
        }
        filled
    };
    let forces = FORCES.map(&mut inertial);
    let rates = RATES.map(&mut inertial);
    let accelerations = rates.each_ref().map(|rate| differentiated(&record.time, rate));
    let inputs = (0..samples)
        .map(|k| Inertial {
            force: std::array::from_fn(|i| forces[i][k]),
            rate: std::array::from_fn(|i| rates[i][k]),
            acceleration: std::array::from_fn(|i| accelerations[i][k]),
        })
        .collect();
    let measured = OUTPUT_CHANNELS.map(|name| match channel(record, name) {
        Ok(values) if name == "psi" || name == "phi" => unwrapped(values),
        Ok(values) => values.to_vec(),
        Err(_) => vec![f64::NAN; samples],
    });
    let outputs = (0..samples).map(|k| std::array::from_fn(|i| measured[i][k])).collect();
    let first =
        |i: usize| median(&mut measured[i].iter().copied().filter(|v| v.is_finite()).take(5).collect::<Vec<f64>>());
    let has = |name: &str| present.iter().any(|p| p == name);
    let or_zero = |i: usize| first(i).unwrap_or(0.0);
    let (speed, pitch, beta) = (or_zero(0), or_zero(4), or_zero(2));
    // Without a vane the path is taken for level at first: the fit moves it.
    let alpha = first(1).unwrap_or(pitch);
    if !has("alpha") {
        notes.push(
            "there is no angle of attack: it is reconstructed from airspeed, attitude and accelerations".to_owned(),
        );
    }
    let start = [
        speed * alpha.cos() * beta.cos(),
        speed * beta.sin(),
        speed * alpha.sin() * beta.cos(),
        or_zero(3),
        pitch,
        or_zero(5),
        or_zero(6),
        or_zero(7),
        or_zero(8),
    ];
    let lateral = has("beta") && (has("ay") || has("p") || has("r"));
    Ok(Signals { time: record.time.clone(), inputs, outputs, start, present, lateral, notes })
}

/// Smallest standard deviation of the noise that is accepted for each output, m/s, rad and m: noise of the inertial
/// sensors, which is integrated and not modelled, leaves that much.
const LEAST_NOISE: [f64; OUTPUTS] = [0.02, 2e-4, 2e-4, 2e-4, 2e-4, 2e-4, 0.3, 0.3, 0.3];

/// Noise of an output: estimated with the unknowns, unless the channel is cleaner than a sensor can be (a simulation, a
/// filtered signal, a constant channel): an estimated noise would then give it all the weight.
pub(super) fn noise(outputs: &[[f64; OUTPUTS]], output: usize) -> Noise {
    let values: Vec<f64> = outputs.iter().map(|y| y[output]).collect();
    let mut scratch = vec![0.0; values.len()];
    match phugoid_estimators::noise::third_difference_std(&values, &mut scratch) {
        Some(std) if std < LEAST_NOISE[output] => Noise::Known(LEAST_NOISE[output]),
        _ => Noise::Estimated,
    }
}

/// Missing values on a straight line between their neighbours (at the ends: the neighbour), and how many.
fn bridged(time: &[f64], values: &[f64]) -> (Vec<f64>, usize) {
    let known: Vec<usize> = (0..values.len()).filter(|k| values[*k].is_finite()).collect();
    let filled = (0..values.len())
        .map(|k| {
            let after = known.partition_point(|i| *i < k);
            match (after.checked_sub(1).and_then(|b| known.get(b)), known.get(after)) {
                (_, Some(a)) if *a == k => values[k],
                (Some(b), Some(a)) => {
                    let part = (time[k] - time[*b]) / (time[*a] - time[*b]);
                    values[*b] + part * (values[*a] - values[*b])
                }
                (Some(b), None) => values[*b],
                (None, Some(a)) => values[*a],
                (None, None) => 0.0,
            }
        })
        .collect();
    (filled, values.len() - known.len())
}

/// The angle without jumps of 2 pi.
fn unwrapped(values: &[f64]) -> Vec<f64> {
    use std::f64::consts::TAU;
    let mut last = f64::NAN;
    values
        .iter()
        .map(|v| {
            let value = if last.is_finite() && v.is_finite() { v - TAU * ((v - last) / TAU).round() } else { *v };
            if value.is_finite() {
                last = value;
            }
            value
        })
        .collect()
}

/// Derivative: the slope of a straight line through five samples on either side (fewer at the ends). At 100 Hz that
/// lowers the noise of a rate gyroscope's derivative seven times against central differences, and reaches 1 % of a 1 Hz
/// motion.
pub(crate) fn differentiated(time: &[f64], values: &[f64]) -> Vec<f64> {
    const SIDE: usize = 5;
    (0..values.len())
        .map(|k| {
            let (from, to) = (k.saturating_sub(SIDE), (k + SIDE + 1).min(values.len()));
            let window = || (from..to).filter(|i| values[*i].is_finite());
            let count = window().count() as f64;
            let mean = |f: &dyn Fn(usize) -> f64| window().map(f).sum::<f64>() / count;
            let (t, y) = (mean(&|i| time[i]), mean(&|i| values[i]));
            let spread: f64 = window().map(|i| (time[i] - t).powi(2)).sum();
            if spread > 0.0 { window().map(|i| (time[i] - t) * (values[i] - y)).sum::<f64>() / spread } else { 0.0 }
        })
        .collect()
}
