//! Corrections of sensor errors, and how they are applied to a record.

use std::collections::BTreeMap;

use phugoid_flight_data::record::Record;
use serde::{Deserialize, Serialize};

use super::differentiated;

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
}

impl Corrections {
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
