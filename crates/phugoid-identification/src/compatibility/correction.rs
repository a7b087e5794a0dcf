//! Corrections of sensor errors, and how they are applied to a record.

use std::collections::BTreeMap;

use phugoid_flight_data::record::Record;
use serde::{Deserialize, Serialize};

use super::kinematics::place;
use super::solve::Solution;
use super::unknowns::UNKNOWNS;
use super::{InputSkew, SensorError, differentiated};

/// Errors of one channel: measured = (1 + scale) true(one delay ago) + bias.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ChannelCorrection {
    /// Constant error that the sensor adds, in the SI unit of the channel.
    pub bias: f64,
    /// Relative error of the scale: 0.02 where the sensor shows 2 % too much.
    pub scale: f64,
    /// Delay of the channel, s: positive if its values come too late.
    pub delay_s: f64,
}

/// Errors of the sensors of an installation, to be taken out of its records.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Corrections {
    /// By canonical channel name. A file of corrections must have this table, empty where nothing was found, so that
    /// another file is not read as one by mistake.
    pub channels: BTreeMap<String, ChannelCorrection>,
    /// Distance of the vane of the angle of attack ahead of the centre of gravity, m.
    #[serde(default)]
    pub vane_alpha_x: f64,
    /// Distance of the vane of the sideslip ahead of the centre of gravity, m.
    #[serde(default)]
    pub vane_beta_x: f64,
    /// Position of the accelerometers ahead of the centre of gravity, m.
    #[serde(default)]
    pub accelerometer_x: f64,
    /// Position of the accelerometers below the centre of gravity, m.
    #[serde(default)]
    pub accelerometer_z: f64,
    /// Upwash at the vane of the angle of attack: the vane shows `upwash_alpha (-az) / V^2` too much, m.
    #[serde(default)]
    pub upwash_alpha: f64,
    /// How well these corrections are known; none where nobody said.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub uncertainty: Option<CorrectionUncertainty>,
}

/// The estimates that corrections were made of, with the covariance of their errors.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CorrectionUncertainty {
    /// Names of the unknowns, e.g. `bias_alpha` or `delay_attitude`.
    pub names: Vec<String>,
    /// Their estimates, SI.
    pub values: Vec<f64>,
    /// Covariance of their errors, row and column in the order of the names.
    pub covariance: Vec<Vec<f64>>,
}

/// Channels that can have corrections of their own.
const CHANNELS: [&str; 12] = ["ax", "ay", "az", "p", "q", "r", "true_airspeed", "alpha", "beta", "phi", "theta", "psi"];

impl Corrections {
    /// The errors that are offered as corrections, and those that are known.
    pub(super) fn of(errors: &[SensorError], solution: &Solution, held: &[(&str, f64)]) -> Self {
        let offered: Vec<&SensorError> = errors.iter().filter(|e| e.offered).collect();
        let mut corrections = Self::default();
        // Zero where they are estimated.
        (corrections.vane_alpha_x, corrections.vane_beta_x) =
            (solution.fixed[place::VANE_ALPHA], solution.fixed[place::VANE_BETA]);
        let values: Vec<(&str, f64)> =
            offered.iter().map(|e| (e.name.as_str(), e.value)).chain(held.iter().copied()).collect();
        corrections.set(&values);
        if !offered.is_empty() {
            let column =
                |name: &str| solution.columns.iter().position(|c| UNKNOWNS[c.place].name == name && c.flight.is_none());
            let columns: Vec<Option<usize>> = offered.iter().map(|e| column(&e.name)).collect();
            let entry = |a: &Option<usize>, b: &Option<usize>| match (a, b) {
                (Some(a), Some(b)) => solution.corrected[(*a, *b)],
                _ => 0.0,
            };
            corrections.uncertainty = Some(CorrectionUncertainty {
                names: offered.iter().map(|e| e.name.clone()).collect(),
                values: offered.iter().map(|e| e.value).collect(),
                covariance: columns.iter().map(|a| columns.iter().map(|b| entry(a, b)).collect()).collect(),
            });
        }
        corrections
    }

    /// Distances and upwash by their names, m.
    pub(super) fn places(&self) -> [(&'static str, f64); 5] {
        self.clone().places_mut().map(|(name, place)| (name, *place))
    }

    fn places_mut(&mut self) -> [(&'static str, &mut f64); 5] {
        [
            ("vane_alpha_x", &mut self.vane_alpha_x),
            ("vane_beta_x", &mut self.vane_beta_x),
            ("accelerometer_x", &mut self.accelerometer_x),
            ("accelerometer_z", &mut self.accelerometer_z),
            ("upwash_alpha", &mut self.upwash_alpha),
        ]
    }

    /// Whether no error of a sensor is named, so that a record stays as it is.
    pub fn is_empty(&self) -> bool {
        let none = ChannelCorrection::default();
        self.channels.values().all(|channel| *channel == none) && self.places().iter().all(|(_, place)| *place == 0.0)
    }

    /// Adds the delay of an input channel, with its error, which has nothing to do with the others.
    pub fn add_skew(&mut self, skew: &InputSkew) {
        self.channels.entry(skew.channel.clone()).or_default().delay_s = skew.delay_s;
        let known = self.uncertainty.get_or_insert_default();
        known.names.push(format!("delay_{}", skew.channel));
        known.values.push(skew.delay_s);
        for row in &mut known.covariance {
            row.push(0.0);
        }
        let mut row = vec![0.0; known.names.len()];
        if let Some(last) = row.last_mut() {
            *last = skew.std_error_s * skew.std_error_s;
        }
        known.covariance.push(row);
    }

    /// Puts estimates of unknowns into the fields that they belong to; all others stay as they are.
    pub(super) fn set(&mut self, values: &[(&str, f64)]) {
        let value = |name: &str| values.iter().find(|(n, _)| *n == name).map(|(_, v)| *v);
        for (name, field) in self.places_mut() {
            if let Some(value) = value(name) {
                *field = value;
            }
        }
        let mut channels: Vec<&str> = CHANNELS.to_vec();
        // The delay of a surface is found by itself.
        channels.extend(
            values
                .iter()
                .filter_map(|(name, _)| name.strip_prefix("delay_"))
                .filter(|c| !CHANNELS.contains(c) && *c != "attitude"),
        );
        for channel in channels {
            let delay = match channel {
                "phi" | "theta" | "psi" => "delay_attitude".to_owned(),
                other => format!("delay_{other}"),
            };
            let (bias, scale) = (value(&format!("bias_{channel}")), value(&format!("scale_{channel}")));
            let delay = value(&delay);
            if bias.is_none() && scale.is_none() && delay.is_none() {
                continue;
            }
            let mut known = self.channels.get(channel).copied().unwrap_or_default();
            let inertial = ["ax", "ay", "az", "p", "q", "r"].contains(&channel);
            if inertial {
                let scale = 1.0 - 1.0 / (1.0 + known.scale);
                (known.bias, known.scale) = (known.bias * (1.0 - scale), scale);
            }
            let mut c = ChannelCorrection {
                bias: bias.unwrap_or(known.bias),
                scale: scale.unwrap_or(known.scale),
                delay_s: delay.unwrap_or(known.delay_s),
            };
            if inertial {
                // True = (1 - scale) measured - bias there: the same in this form.
                (c.bias, c.scale) = (c.bias / (1.0 - c.scale), 1.0 / (1.0 - c.scale) - 1.0);
            }
            self.channels.insert(channel.to_owned(), c);
        }
    }

    /// The record as perfect sensors at the centre of gravity would have written it, as far as these corrections say.
    /// Channels that they do not name stay as they are. Late channels are moved along a straight line between samples;
    /// where that needs a sample beyond the end, the value is missing.
    pub fn apply(&self, record: &Record) -> Record {
        let mut corrected = record.clone();
        for channel in &mut corrected.channels {
            let Some(c) = self.channels.get(&channel.name) else { continue };
            for value in &mut channel.values {
                *value = (*value - c.bias) / (1.0 + c.scale);
            }
            if c.delay_s != 0.0 {
                channel.values = moved(&record.time, &channel.values, c.delay_s);
            }
        }
        let get = |record: &Record, name: &str| record.channel(name).map(|c| c.values.clone());
        let length = record.time.len();
        let rates: [Vec<f64>; 3] =
            ["p", "q", "r"].map(|name| get(&corrected, name).unwrap_or_else(|| vec![0.0; length]));
        let speed = get(&corrected, "true_airspeed");
        if self.accelerometer_x != 0.0 || self.accelerometer_z != 0.0 {
            let accelerations = rates.each_ref().map(|rate| differentiated(&record.time, rate));
            let (x, z) = (self.accelerometer_x, self.accelerometer_z);
            for channel in &mut corrected.channels {
                for (k, value) in channel.values.iter_mut().enumerate() {
                    let [p, q, r] = [rates[0][k], rates[1][k], rates[2][k]];
                    let [pd, qd, rd] = [accelerations[0][k], accelerations[1][k], accelerations[2][k]];
                    *value -= match channel.name.as_str() {
                        "ax" => -(q * q + r * r) * x + (p * r + qd) * z,
                        "ay" => (p * q + rd) * x + (q * r - pd) * z,
                        "az" => (p * r - qd) * x - (p * p + q * q) * z,
                        _ => 0.0,
                    };
                }
            }
        }
        if let (Some(speed), Some(az)) = (&speed, get(&corrected, "az").filter(|_| self.upwash_alpha != 0.0))
            && let Some(alpha) = corrected.channels.iter_mut().find(|c| c.name == "alpha")
        {
            for (k, value) in alpha.values.iter_mut().enumerate() {
                *value += self.upwash_alpha * az[k] / (speed[k] * speed[k]);
            }
        }
        if let Some(speed) = speed {
            for (name, rate, arm) in [("alpha", &rates[1], self.vane_alpha_x), ("beta", &rates[2], -self.vane_beta_x)] {
                let Some(channel) = corrected.channels.iter_mut().find(|c| c.name == name).filter(|_| arm != 0.0)
                else {
                    continue;
                };
                for (k, value) in channel.values.iter_mut().enumerate() {
                    *value += rate[k] * arm / speed[k];
                }
            }
        }
        corrected
    }
}

/// The signal at a time `delay` (s) later, interpolated linearly between its samples; NaN where it has none.
pub(crate) fn moved(time: &[f64], values: &[f64], delay: f64) -> Vec<f64> {
    time.iter()
        .map(|t| {
            let wanted = t + delay;
            let after = time.partition_point(|s| *s < wanted - 1e-9);
            match (after.checked_sub(1), time.get(after)) {
                (_, Some(s)) if (s - wanted).abs() <= 1e-9 => values[after],
                (Some(before), Some(s)) => {
                    let part = (wanted - time[before]) / (s - time[before]);
                    values[before] + part * (values[after] - values[before])
                }
                _ => f64::NAN,
            }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use phugoid_flight_data::record::{Channel, Quantity};

    /// A record spoilt by known errors comes back: a straight line is moved without loss.
    #[test]
    fn corrections_undo_the_errors_they_name() {
        let time: Vec<f64> = (0..50).map(|k| 0.02 * f64::from(k)).collect();
        let q: Vec<f64> = time.iter().map(|t| 0.1 * t).collect();
        let alpha: Vec<f64> = time.iter().map(|t| 0.05 + 0.2 * t).collect();
        let speed = vec![50.0; 50];
        let az: Vec<f64> = vec![-9.8; 50];
        let spoilt_alpha = (0..50).map(|k| 1.1 * (alpha[k] - 0.2 * 0.013 - q[k] * 2.0 / 50.0) + 0.01).collect();
        // q' = 0.1 rad/s^2: az at x is az - q' x.
        let spoilt_az = az.iter().map(|a| a - 0.1 * 1.5 + 0.2).collect();
        let channel = |name: &str, quantity, values| Channel { name: name.to_owned(), quantity, values };
        let record = Record {
            time,
            channels: vec![
                channel("q", Quantity::AngularRate, q),
                channel("true_airspeed", Quantity::Speed, speed),
                channel("alpha", Quantity::Angle, spoilt_alpha),
                channel("az", Quantity::Acceleration, spoilt_az),
            ],
            ..Record::default()
        };
        let mut corrections = Corrections { vane_alpha_x: 2.0, accelerometer_x: 1.5, ..Corrections::default() };
        corrections.channels.insert("alpha".to_owned(), ChannelCorrection { bias: 0.01, scale: 0.1, delay_s: 0.013 });
        corrections.channels.insert("az".to_owned(), ChannelCorrection { bias: 0.2, ..ChannelCorrection::default() });
        let corrected = corrections.apply(&record);
        // The vane's own arm is seen one delay late: q moves by 0.1 * 0.013 in that time, 5e-5 rad of angle at 2 m and
        // 50 m/s.
        for (found, truth) in corrected.channel("alpha").unwrap().values.iter().zip(&alpha).take(49) {
            assert!((found - truth).abs() < 6e-5, "{found} {truth}");
        }
        // The rate's square makes 1.5 q^2 <= 0 in az at z = 0: nothing.
        for found in &corrected.channel("az").unwrap().values {
            assert!((found + 9.8).abs() < 1e-9, "{found}");
        }
        assert!(corrected.channel("alpha").unwrap().values[49].is_nan());
    }
}
