//! Control inputs of a scenario: what the surfaces are commanded to do, beside the trim.

use std::path::{Path, PathBuf};

use phugoid_flight_data::csv::{self, CsvOptions};
use phugoid_flight_data::record::Record;
use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64;
use serde::{Deserialize, Serialize};

use crate::quantity::{Angle, Frequency, Time};
use crate::text::{ScenarioError, nearest};

/// The surface that a manoeuvre moves.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Deserialize, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Surface {
    /// Elevator, positive trailing edge down.
    #[default]
    Elevator,
    /// The ailerons, which roll the aircraft.
    Aileron,
    /// The rudder, which yaws the aircraft.
    Rudder,
}

impl Surface {
    /// Its place wherever all surfaces stand together: elevator, aileron, rudder.
    pub fn index(self) -> usize {
        match self {
            Self::Elevator => 0,
            Self::Aileron => 1,
            Self::Rudder => 2,
        }
    }

    /// Name of the surface's channel in records and model files, for instance `elevator`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Elevator => "elevator",
            Self::Aileron => "aileron",
            Self::Rudder => "rudder",
        }
    }
}

/// A command added to the trim position of one surface; several add up. Commands change at the samples and are held
/// between them, as a flight-control computer does.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(tag = "type", rename_all = "kebab-case", deny_unknown_fields)]
pub enum Manoeuvre {
    /// Up and down: `+amplitude` for `width`, then `-amplitude` for `width`.
    Doublet {
        /// The surface that is moved; the elevator if none is given.
        #[serde(default)]
        surface: Surface,
        /// Time at which the command begins, from the start of the flight.
        start: Time,
        /// Duration of each of the two halves.
        width: Time,
        /// Deflection from trim in the first half; the second half has the opposite sign.
        amplitude: Angle,
    },
    /// The classical 3-2-1-1: steps of alternating sign, three, two, one and one units long.
    #[serde(rename = "3-2-1-1")]
    ThreeTwoOneOne {
        /// The surface that is moved; the elevator if none is given.
        #[serde(default)]
        surface: Surface,
        /// Time at which the command begins, from the start of the flight.
        start: Time,
        /// Duration of the unit; about a quarter of the period to excite.
        unit: Time,
        /// Deflection from trim; the first step has this sign.
        amplitude: Angle,
    },
    /// A sine about the trim position, beginning with zero deflection.
    Sine {
        /// The surface that is moved; the elevator if none is given.
        #[serde(default)]
        surface: Surface,
        /// Time at which the command begins, from the start of the flight.
        start: Time,
        /// Frequency of the sine, cycles per second.
        frequency: Frequency,
        /// Amplitude of the deflection about the trim position.
        amplitude: Angle,
        /// Duration; to the end of the flight if it is not given.
        duration: Option<Time>,
    },
    /// Steps of any length and size, one directly after the other; the surface then returns to trim.
    Multistep {
        /// The surface that is moved; the elevator if none is given.
        #[serde(default)]
        surface: Surface,
        /// Time at which the command begins, from the start of the flight.
        start: Time,
        /// Duration and deflection from trim of each step.
        steps: Vec<(Time, Angle)>,
    },
    /// A pilot's random stick: white noise through two equal first-order lags.
    Pilot {
        /// The surface that is moved; the elevator if none is given.
        #[serde(default)]
        surface: Surface,
        /// Time at which the command begins, from the start of the flight.
        #[serde(default)]
        start: Time,
        /// Standard deviation once it has settled.
        rms: Angle,
        /// Corner frequency of each lag.
        bandwidth: Frequency,
        /// Added to the seed of the scenario.
        #[serde(default)]
        seed: u64,
    },
    /// A recorded signal, taken as a deflection from its first value and held between its samples.
    Csv {
        /// The surface that is moved; the elevator if none is given.
        #[serde(default)]
        surface: Surface,
        /// The record; relative to the scenario file, or `built-in:` and the name of one of [`BUILT_IN_RECORDS`].
        file: PathBuf,
        /// Channel of the record; the surface's own name if it is not given.
        channel: Option<String>,
    },
    /// A signal in memory, held between its samples: a designed input. Not for scenario files, which name a `csv`.
    #[serde(skip)]
    Samples {
        /// The surface that is moved; the elevator if none is given.
        surface: Surface,
        /// Samples per second, the first one at time zero.
        rate: Frequency,
        /// Deflection from trim, rad; zero after the last.
        deflection: Vec<f64>,
    },
}

/// A pulse from `from` to `to`; the tolerance keeps a sample that was meant to lie on an edge on its right side.
fn within(t: f64, from: f64, to: f64) -> bool {
    const TOLERANCE: f64 = 1e-9;
    t >= from - TOLERANCE && t < to - TOLERANCE
}

fn multistep(time: &[f64], start: f64, steps: impl Iterator<Item = (f64, f64)> + Clone) -> Vec<f64> {
    time.iter()
        .map(|&t| {
            let mut from = start;
            for (duration, deflection) in steps.clone() {
                if within(t, from, from + duration) {
                    return deflection;
                }
                from += duration;
            }
            0.0
        })
        .collect()
}

/// White noise through two equal lags, exact for samples `step` apart, with a stationary standard deviation of one.
fn pilot(time: &[f64], start: f64, bandwidth_hz: f64, seed: u64) -> Vec<f64> {
    let step = if time.len() > 1 { time[1] - time[0] } else { 0.0 };
    let a = (-std::f64::consts::TAU * bandwidth_hz * step).exp();
    let r = a * a;
    // The impulse response of two lags is (k + 1) a^k; sum (k + 1)^2 r^k = (1 + r) / (1 - r)^3.
    let scale = ((1.0 - r).powi(3) / (1.0 + r)).sqrt();
    let mut random = Pcg64::seed_from_u64(seed);
    let (mut first, mut second) = (0.0, 0.0);
    time.iter()
        .map(|&t| {
            if !within(t, start, f64::INFINITY) {
                return 0.0;
            }
            let white: f64 = StandardNormal.sample(&mut random);
            first = a * first + white;
            second = a * second + first;
            scale * second
        })
        .collect()
}

impl Manoeuvre {
    /// The surface that this manoeuvre moves.
    pub fn surface(&self) -> Surface {
        match self {
            Self::Doublet { surface, .. }
            | Self::ThreeTwoOneOne { surface, .. }
            | Self::Sine { surface, .. }
            | Self::Multistep { surface, .. }
            | Self::Pilot { surface, .. }
            | Self::Csv { surface, .. }
            | Self::Samples { surface, .. } => *surface,
        }
    }

    /// Its `type` in a scenario file.
    pub fn kind(&self) -> &'static str {
        match self {
            Self::Doublet { .. } => "doublet",
            Self::ThreeTwoOneOne { .. } => "3-2-1-1",
            Self::Sine { .. } => "sine",
            Self::Multistep { .. } => "multistep",
            Self::Pilot { .. } => "pilot",
            Self::Csv { .. } => "csv",
            Self::Samples { .. } => "samples",
        }
    }

    /// Time at which the command begins, s from the start of the flight.
    pub fn start_s(&self) -> f64 {
        match self {
            Self::Doublet { start, .. }
            | Self::ThreeTwoOneOne { start, .. }
            | Self::Sine { start, .. }
            | Self::Multistep { start, .. }
            | Self::Pilot { start, .. } => start.si(),
            Self::Csv { .. } | Self::Samples { .. } => 0.0,
        }
    }

    /// Checks that each duration and frequency is positive: of a manoeuvre with another one nothing would be flown.
    ///
    /// # Errors
    /// A sentence that names the entry.
    pub(crate) fn check(&self) -> Result<(), String> {
        let positive = |key: &str, value: f64, unit: &str| match value > 0.0 {
            true => Ok(()),
            false => Err(format!("`{key}` is {value} {unit}, and has to be more than zero: nothing would be flown")),
        };
        match self {
            Self::Doublet { width, .. } => positive("width", width.si(), "s"),
            Self::ThreeTwoOneOne { unit, .. } => positive("unit", unit.si(), "s"),
            Self::Sine { frequency, duration, .. } => {
                positive("frequency", frequency.si(), "Hz")?;
                duration.map_or(Ok(()), |duration| positive("duration", duration.si(), "s"))
            }
            Self::Multistep { steps, .. } => {
                steps.iter().try_for_each(|(duration, _)| positive("the duration of a step", duration.si(), "s"))
            }
            Self::Pilot { bandwidth, .. } => positive("bandwidth", bandwidth.si(), "Hz"),
            Self::Csv { .. } | Self::Samples { .. } => Ok(()),
        }
    }

    /// Deflection from trim at each time (s, evenly spaced), rad. `folder` is where relative files are looked for.
    pub fn deflections(&self, time: &[f64], seed: u64, folder: &Path) -> Result<Vec<f64>, ScenarioError> {
        Ok(match self {
            Self::Doublet { start, width, amplitude, .. } => {
                let (w, a) = (width.si(), amplitude.si());
                multistep(time, start.si(), [(w, a), (w, -a)].into_iter())
            }
            Self::ThreeTwoOneOne { start, unit, amplitude, .. } => {
                let (u, a) = (unit.si(), amplitude.si());
                multistep(time, start.si(), [(3.0 * u, a), (2.0 * u, -a), (u, a), (u, -a)].into_iter())
            }
            Self::Sine { start, frequency, amplitude, duration, .. } => {
                let end = duration.map_or(f64::INFINITY, |d| start.si() + d.si());
                let omega = std::f64::consts::TAU * frequency.si();
                time.iter()
                    .map(|&t| {
                        if within(t, start.si(), end) { amplitude.si() * (omega * (t - start.si())).sin() } else { 0.0 }
                    })
                    .collect()
            }
            Self::Multistep { start, steps, .. } => {
                multistep(time, start.si(), steps.iter().map(|(duration, deflection)| (duration.si(), deflection.si())))
            }
            Self::Pilot { start, rms, bandwidth, seed: own, .. } => {
                pilot(time, start.si(), bandwidth.si(), seed.wrapping_add(*own))
                    .into_iter()
                    .map(|v| rms.si() * v)
                    .collect()
            }
            Self::Csv { surface, file, channel } => {
                recorded(file, folder, channel.as_deref().unwrap_or(surface.name()), time)?
            }
            Self::Samples { rate, deflection, .. } => {
                let at = |t: &f64| deflection.get((t * rate.si() + 1e-6) as usize).copied().unwrap_or(0.0);
                time.iter().map(at).collect()
            }
        })
    }
}

/// Records that are built in, for manoeuvres of type `csv`: name and text.
pub const BUILT_IN_RECORDS: &[(&str, &str)] =
    &[("pilot-elevator.csv", include_str!("../../../scenarios/thesis/pilot-elevator.csv"))];

/// A record of a manoeuvre: a built-in one, or a file relative to `folder`.
fn record(file: &Path, folder: &Path) -> Result<Record, ScenarioError> {
    const BUILT_IN: &str = "built-in:";
    let refused =
        |place: &Path, message: String| ScenarioError::OutOfRange { place: place.display().to_string(), message };
    let Some(name) = file.to_str().and_then(|file| file.strip_prefix(BUILT_IN)) else {
        let path = folder.join(file);
        return csv::read_path(&path, &CsvOptions::default()).map_err(|error| refused(&path, error.to_string()));
    };
    let Some((name, text)) = BUILT_IN_RECORDS.iter().find(|(known, _)| *known == name) else {
        let names: Vec<&str> = BUILT_IN_RECORDS.iter().map(|(known, _)| *known).collect();
        let message = format!("no record of this name is built in: there is {}", names.join(", "));
        return Err(refused(file, message));
    };
    csv::read(text.as_bytes(), name, &CsvOptions::default()).map_err(|error| refused(file, error.to_string()))
}

/// A channel of a recorded flight as deflection from its first value, held between its samples.
fn recorded(file: &Path, folder: &Path, channel: &str, time: &[f64]) -> Result<Vec<f64>, ScenarioError> {
    let place = || file.display().to_string();
    let record = record(file, folder)?;
    let Some(signal) = record.channel(channel) else {
        let names: Vec<&str> = record.channels.iter().map(|c| c.name.as_str()).collect();
        let near = nearest(channel, names.iter().copied());
        let hint = near.map_or_else(|| format!("it has {}", names.join(", ")), |n| format!("did you mean `{n}`?"));
        let message = format!("the record of a manoeuvre has no channel `{channel}`: {hint}");
        return Err(ScenarioError::OutOfRange { place: place(), message });
    };
    let known: Vec<(f64, f64)> =
        record.time.iter().copied().zip(signal.values.iter().copied()).filter(|(_, v)| v.is_finite()).collect();
    let Some(&(start, first)) = known.first() else {
        let message = format!("channel `{channel}` of the record of a manoeuvre has no values");
        return Err(ScenarioError::OutOfRange { place: place(), message });
    };
    Ok(time
        .iter()
        .map(|t| known[known.partition_point(|(s, _)| s - start <= t + 1e-9).saturating_sub(1)].1 - first)
        .collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn times() -> Vec<f64> {
        (0..2000).map(|k| f64::from(k) / 100.0).collect()
    }

    /// The 3-2-1-1 of the golden trace: steps at 0.5, 2.3, 3.5, 4.1 and 4.7 s.
    #[test]
    fn a_3211_switches_where_it_should() {
        let manoeuvre = Manoeuvre::ThreeTwoOneOne {
            surface: Surface::Elevator,
            start: Time::from_si(0.5),
            unit: Time::from_si(0.6),
            amplitude: Angle::from_si(1.5),
        };
        let time = times();
        let deflection = manoeuvre.deflections(&time, 0, Path::new("")).unwrap();
        let switches: Vec<(usize, f64)> =
            (1..time.len()).filter(|&k| deflection[k] != deflection[k - 1]).map(|k| (k, deflection[k])).collect();
        assert_eq!(switches, [(50, 1.5), (230, -1.5), (350, 1.5), (410, -1.5), (470, 0.0)]);
    }

    #[test]
    fn a_pilot_has_the_rms_asked_for_and_the_same_stick_for_the_same_seed() {
        let time: Vec<f64> = (0..200_000).map(|k| f64::from(k) / 100.0).collect();
        let stick = pilot(&time, 0.0, 0.5, 7);
        let rms = (stick.iter().map(|v| v * v).sum::<f64>() / stick.len() as f64).sqrt();
        // 2000 s at 0.5 Hz are some 3000 independent values: 1.3 % standard error of the rms, four of them allowed.
        assert!((rms - 1.0).abs() < 0.052, "{rms}");
        assert_eq!(stick[..100], pilot(&time[..100], 0.0, 0.5, 7)[..]);
        assert_ne!(stick[..100], pilot(&time[..100], 0.0, 0.5, 8)[..]);
    }

    #[test]
    fn a_recorded_stick_is_held_between_its_samples() {
        let folder = std::env::temp_dir().join(format!("phugoid-manoeuvre-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        std::fs::write(folder.join("stick.csv"), "time_s,elevator_deg\n5,-2\n5.5,-1\n6,\n6.5,-3\n").unwrap();
        let manoeuvre = |channel: &str| Manoeuvre::Csv {
            surface: Surface::Elevator,
            file: "stick.csv".into(),
            channel: (!channel.is_empty()).then(|| channel.to_owned()),
        };
        let deflection = manoeuvre("").deflections(&[0.0, 0.4, 0.5, 1.4, 1.5, 9.0], 0, &folder).unwrap();
        let degrees: Vec<f64> = deflection.iter().map(|d| (d.to_degrees() * 1e9).round() / 1e9).collect();
        assert_eq!(degrees, [0.0, 0.0, 1.0, 1.0, -1.0, -1.0]);
        let message = manoeuvre("elevater").deflections(&[0.0], 0, &folder).unwrap_err().to_string();
        assert!(message.contains("did you mean `elevator`"), "{message}");
        std::fs::remove_dir_all(&folder).unwrap();
    }

    /// The built-in record is what its own recipe says, to the rounding of the recorder.
    #[test]
    fn the_built_in_pilot_follows_his_recipe() {
        let manoeuvre = |file: &str| Manoeuvre::Csv { surface: Surface::Elevator, file: file.into(), channel: None };
        let time: Vec<f64> = (0..=400).map(|k| f64::from(k) / 20.0).collect();
        let deflection = manoeuvre("built-in:pilot-elevator.csv").deflections(&time, 0, Path::new("nowhere")).unwrap();
        for (t, found) in time.iter().zip(&deflection) {
            let sines = [2.0, 3.0, 5.0, 8.0, 13.0, 21.0].into_iter().enumerate().map(|(k, n)| {
                let (f, k) = (n / 20.0, k as f64);
                let phase = -std::f64::consts::PI * k * (k + 1.0) / 6.0;
                (std::f64::consts::TAU * f * t + phase).sin() / (1.0 + (f / 0.5).powi(2))
            });
            let wanted = t.min(1.0) * 1.1 * sines.sum::<f64>();
            assert!((found.to_degrees() - wanted).abs() < 0.0051, "{t} s: {} {wanted}", found.to_degrees());
        }
        let unknown = manoeuvre("built-in:pilot.csv").deflections(&time, 0, Path::new("")).unwrap_err().to_string();
        assert!(unknown.contains("there is pilot-elevator.csv"), "{unknown}");
    }

    #[test]
    fn a_sine_starts_at_zero_and_ends_on_time() {
        let manoeuvre = Manoeuvre::Sine {
            surface: Surface::Rudder,
            start: Time::from_si(1.0),
            frequency: Frequency::from_si(1.0),
            amplitude: Angle::from_si(2.0),
            duration: Some(Time::from_si(2.0)),
        };
        let deflection = manoeuvre.deflections(&times(), 0, Path::new("")).unwrap();
        assert_eq!((deflection[99], deflection[300]), (0.0, 0.0));
        assert!(deflection[100].abs() < 1e-12 && (deflection[125] - 2.0).abs() < 1e-9);
    }
}
