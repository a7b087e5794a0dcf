//! From a record to what the filter over the kinematics takes.

use phugoid_estimators::noise::third_difference_std;
use phugoid_flight_data::record::Record;
use phugoid_flight_data::statistics::median;

use super::filter::Levels;
use super::gravity::Gravity;
use super::kinematics::{BODY, CURVATURE, Inertial, OUTPUTS, SENSORS, STATES};
use crate::core::error::EstimateError;
use crate::preparation::noise::{measure_own_noise, without_outliers};
use crate::preparation::prepare::channel;

/// Channels of the outputs, in their order.
pub(super) const OUTPUT_CHANNELS: [&str; OUTPUTS] =
    ["true_airspeed", "alpha", "beta", "phi", "theta", "psi", "north", "east", "altitude"];

/// Inertial channels: accelerometers, then gyroscopes.
const INERTIAL: [&str; SENSORS] = ["ax", "ay", "az", "p", "q", "r"];

/// Samples that are closer together are averaged in groups of up to this length, s: sensor errors show in motions of a
/// few hertz at most, and the work goes with the number of samples.
const GROUP_S: f64 = 0.0201;

/// Without samples, or without a value of an inertial sensor, for longer than this, s, the motion begins anew.
const GAP_S: f64 = 0.25;

/// One record as the filter needs it.
pub(super) struct Flight {
    pub(super) time: Vec<f64>,
    pub(super) inputs: Vec<Inertial>,
    /// NaN where nothing was measured, and for outputs that are not used.
    pub(super) outputs: Vec<[f64; OUTPUTS]>,
    /// True where the motion begins: at the first sample, and after gaps.
    pub(super) fresh: Vec<bool>,
    /// The states that move; the others stay what they are at the beginning.
    pub(super) active: Vec<usize>,
    /// Channels that the record has values of.
    pub(super) present: Vec<String>,
    /// Noise of the inertial sensors, one sigma of a sample.
    pub(super) inertial_noise: [f64; SENSORS],
    /// Noise levels to start from.
    pub(super) levels: Levels,
    /// Median airspeed, m/s.
    pub(super) speed: f64,
    pub(super) gravity: Gravity,
    /// Curvature of the Earth, 1/m.
    pub(super) curvature: f64,
    pub(super) notes: Vec<String>,
    /// Times of the record itself, s.
    pub(super) record_time: Vec<f64>,
}

impl Flight {
    pub(super) fn has(&self, name: &str) -> bool {
        self.present.iter().any(|p| p == name)
    }

    /// From sample to sample, the root mean square change of a gust of 1 m/s with this scale length (m), over that of the
    /// specific force along the same axis, s.
    pub(super) fn gust_over_force(&self, axis: usize, length: f64) -> f64 {
        let (mut gust, mut force) = (0.0, 0.0);
        for k in (1..self.time.len()).filter(|k| !self.fresh[*k]) {
            let part = (self.time[k] - self.time[k - 1]) * self.speed / length;
            gust += if axis == 0 { 2.0 * part } else { 3.0 * part };
            force += (self.inputs[k].force[axis] - self.inputs[k - 1].force[axis]).powi(2);
        }
        // The noise of the accelerometer goes with nothing.
        let intervals = self.fresh.iter().filter(|fresh| !**fresh).count() as f64;
        let noise = 2.0 * intervals * self.inertial_noise[axis].powi(2);
        let moved = (force - noise).max(0.1 * force);
        if moved > 0.0 { (gust / moved).sqrt() } else { 0.0 }
    }

    /// Collects the signals of a record. Missing values of inertial channels are bridged by straight lines.
    pub(super) fn of(record: &Record, gravity: Option<f64>, flat_earth: bool) -> Result<Self, EstimateError> {
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
        let has = |name: &str| present.iter().any(|p| p == name);
        let mut missing = vec![false; samples];
        let mut inertial_noise = [0.0; SENSORS];
        let mut inertial: Vec<Vec<f64>> = Vec::with_capacity(SENSORS);
        for (sensor, name) in INERTIAL.into_iter().enumerate() {
            let Some(values) = channel(record, name).ok().filter(|_| has(name)) else {
                notes.push(format!("there is no channel `{name}`: it is taken for zero"));
                inertial.push(vec![0.0; samples]);
                continue;
            };
            let noise = measure_own_noise(values).map_or(0.0, |n| n.std);
            inertial_noise[sensor] = noise;
            let clean = without_outliers(values, noise);
            let outliers = clean.iter().zip(values).filter(|(c, v)| c.is_nan() && v.is_finite()).count();
            let (filled, bridged) = bridged(&record.time, &clean);
            if bridged > 0 {
                let stand_out = if outliers > 0 { format!(", {outliers} of them outliers") } else { String::new() };
                notes.push(format!("`{name}` has no value in {bridged} samples{stand_out}: straight lines there"));
            }
            for (m, c) in missing.iter_mut().zip(&clean) {
                *m |= c.is_nan();
            }
            inertial.push(filled);
        }
        let measured: [Vec<f64>; OUTPUTS] = OUTPUT_CHANNELS.map(|name| match channel(record, name) {
            Ok(values) if name == "psi" || name == "phi" => unwrapped(values),
            Ok(values) => values.to_vec(),
            Err(_) => vec![f64::NAN; samples],
        });
        // A lateral motion is followed where all of it was recorded.
        let rolls = has("phi") && has("p") && has("r");
        let slips = rolls && has("beta") && has("ay");
        let used: [bool; OUTPUTS] = std::array::from_fn(|i| match OUTPUT_CHANNELS[i] {
            "beta" => slips,
            "phi" => rolls,
            // Over ground the heading is needed.
            "psi" => has("psi") && rolls,
            "north" | "east" => has("north") && has("east") && has("psi") && rolls,
            name => has(name),
        });
        if has("beta") && !slips {
            notes.push("the sideslip is not checked: that needs phi, p, r and ay as well".to_owned());
        }
        if !has("alpha") {
            notes.push(
                "there is no angle of attack: it is reconstructed from airspeed, attitude and accelerations".to_owned(),
            );
        }
        let step = record.sample_time_s();
        let group = if step > 0.0 { ((GROUP_S / step) as usize).clamp(1, samples / 20) } else { 1 };
        let levels = Levels::start(std::array::from_fn(|i| {
            let mut scratch = vec![0.0; samples];
            let noise = third_difference_std(&measured[i], &mut scratch).unwrap_or(0.0);
            used[i].then(|| (noise / (group as f64).sqrt()).max(LEAST_NOISE[i]))
        }));
        let accelerations: Vec<Vec<f64>> =
            inertial[3..].iter().map(|rate| differentiated(&record.time, rate)).collect();
        // Groups of samples that follow each other without a gap.
        let mut flight = Self {
            time: Vec::new(),
            inputs: Vec::new(),
            outputs: Vec::new(),
            fresh: Vec::new(),
            active: Vec::new(),
            inertial_noise: std::array::from_fn(|i| {
                (inertial_noise[i] / (group as f64).sqrt()).max(LEAST_INERTIAL[i / 3])
            }),
            levels,
            speed: 0.0,
            gravity: Gravity { value: 9.80665, std: 0.0 },
            curvature: if flat_earth { 0.0 } else { CURVATURE },
            notes,
            present: Vec::new(),
            record_time: record.time.clone(),
        };
        let gap = GAP_S.max(6.0 * step);
        let (mut k, mut last) = (0, f64::NEG_INFINITY);
        while k < samples {
            if missing[k] && longest(&missing[k..], &record.time[k..]) > gap {
                k += missing[k..].iter().take_while(|m| **m).count();
                continue;
            }
            let whole = (1..group)
                .take_while(|i| record.time.get(k + i).is_some_and(|t| t - record.time[k] < 1.5 * group as f64 * step));
            let count = 1 + whole.count();
            let mean = |values: &[f64]| values[k..k + count].iter().sum::<f64>() / count as f64;
            let time = mean(&record.time);
            flight.fresh.push(record.time[k] - last > gap);
            last = record.time[k + count - 1];
            flight.time.push(time);
            flight.inputs.push(Inertial {
                force: std::array::from_fn(|i| mean(&inertial[i])),
                rate: std::array::from_fn(|i| mean(&inertial[3 + i])),
                acceleration: std::array::from_fn(|i| mean(&accelerations[i])),
            });
            flight.outputs.push(std::array::from_fn(|i| if used[i] { mean(&measured[i]) } else { f64::NAN }));
            k += count;
        }
        if flight.time.len() < 20 {
            return Err(EstimateError::TooShort { samples: flight.time.len() });
        }
        let mut speeds: Vec<f64> = measured[0].iter().copied().filter(|v| v.is_finite()).collect();
        flight.speed = median(&mut speeds).unwrap_or(0.0);
        if flight.speed.is_nan() || flight.speed < 1.0 {
            return Err(EstimateError::Model(format!(
                "data compatibility: the aircraft does not fly: the median airspeed is {:.2} m/s",
                flight.speed
            )));
        }
        flight.gravity = Gravity::of(record, flight.speed, gravity);
        flight.active = (0..STATES)
            .filter(|state| match *state {
                0 | 2 | 4 | BODY => true,
                1 | 10 => slips,
                3 => rolls,
                11 | 13 => used[1],
                12 => slips,
                14 => !rolls,
                other => used[other],
            })
            .collect();
        flight.present = present;
        Ok(flight)
    }

    /// The state at a beginning, from the next few values of each output.
    pub(super) fn beginning(&self, at: usize) -> [f64; STATES] {
        let first = |i: usize| {
            let values = self.outputs[at..].iter().map(|y| y[i]).filter(|v| v.is_finite());
            median(&mut values.take(5).collect::<Vec<f64>>())
        };
        let or_zero = |i: usize| first(i).unwrap_or(0.0);
        let (speed, pitch, beta) = (first(0).unwrap_or(self.speed), or_zero(4), or_zero(2));
        // Without a vane the path is taken for level at first: the filter moves it.
        let alpha = first(1).unwrap_or(pitch);
        let mut state = [0.0; STATES];
        state[..BODY].copy_from_slice(&[
            speed * alpha.cos() * beta.cos(),
            speed * beta.sin(),
            speed * alpha.sin() * beta.cos(),
            or_zero(3),
            pitch,
            or_zero(5),
            or_zero(6),
            or_zero(7),
            or_zero(8),
        ]);
        state
    }
}

/// How long the values at the beginning are missing, s.
fn longest(missing: &[bool], time: &[f64]) -> f64 {
    let count = missing.iter().take_while(|m| **m).count();
    let end = time.get(count).or(time.last());
    end.zip(time.first()).map_or(0.0, |(end, start)| end - start)
}

/// Smallest standard deviation of the noise that is accepted for each output, m/s, rad and m: a channel that is cleaner
/// than a sensor can be (a simulation, a filtered signal) must not get all the weight.
pub(super) const LEAST_NOISE: [f64; OUTPUTS] = [0.02, 2e-4, 2e-4, 2e-4, 2e-4, 2e-4, 0.3, 0.3, 0.3];
/// The same for accelerometers, m/s^2, and gyroscopes, rad/s: what straight lines between samples leave.
const LEAST_INERTIAL: [f64; 2] = [2e-3, 2e-5];

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
