//! Sensors: what a recorder gets of a true signal. Seeded per channel and reproducible on every machine.
//!
//! A reading is `quantise(true value one delay ago + bias + noise [+ outlier])`, taken at the channel's own rate; between
//! its samples, and where a sample is dropped, a channel gives NaN.
//!
//! Randomness comes from `rand_pcg::Pcg64Mcg`, one generator each for noise, outliers and drops of each channel, started
//! from a SplitMix64 hash of (seed, channel index, purpose): another channel, or a drop more, changes no other number.

use std::collections::VecDeque;

use rand::RngExt;
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64Mcg;
use serde::{Deserialize, Serialize};

/// One channel's sensor. The unit is the channel's own throughout. The default is a perfect sensor.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct SensorSpecification {
    /// Standard deviation of the white Gaussian noise of each sample.
    pub noise: f64,
    /// Constant offset that is added to every sample.
    pub bias: f64,
    /// Error of the scale, a part of the value: 0.02 for a sensor that shows two per cent too much.
    pub scale_error: f64,
    /// Time between the channel's own samples, s; zero for a sample whenever it is asked.
    pub sample_interval: f64,
    /// Age of the true value in a sample, s, linearly interpolated between the times at which the channel was asked. The
    /// true value before the first of them is taken to have been the first one.
    pub delay: f64,
    /// Step between the values that the sensor can give, multiples of it; zero for none.
    pub quantisation: f64,
    /// Chance of an outlier, per sample, 0 to 1.
    pub outlier_probability: f64,
    /// Size of an outlier, added to the sample with either sign.
    pub outlier_size: f64,
    /// Mean length of a burst, samples: outliers come in runs of one sign and of geometrically distributed length, with the
    /// same chance per sample in the long run. Zero for outliers that are independent of one another.
    pub outlier_burst: f64,
    /// Chance that a sample is lost, 0 to 1.
    pub drop_probability: f64,
}

/// A sensor that cannot be, or a history that it cannot measure.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum SensorError {
    /// A number of the specification is out of its range.
    #[error("sensor channel {channel}: {field} is {value}, expected {expected}")]
    Specification {
        /// Index of the channel in its run, from zero.
        channel: usize,
        /// Name of the field of [`SensorSpecification`] that is out of its range.
        field: &'static str,
        /// The number that was given, in the unit of the field.
        value: f64,
        /// The numbers that are allowed, in words.
        expected: &'static str,
    },
    /// Sensors are causal: they are asked in order of time.
    #[error("sensor channel {channel}: asked at {time} s after {previous} s; sort the history by time")]
    TimeBackwards {
        /// Index of the channel in its run, from zero.
        channel: usize,
        /// The time asked for, s.
        time: f64,
        /// The time before it, s.
        previous: f64,
    },
    /// Times and values do not pair up, or values and channels.
    #[error("sensor: {values} values for {expected}")]
    Length {
        /// Number of values that were given.
        values: usize,
        /// Number of times or channels that they are for.
        expected: usize,
    },
}

/// The sensor of one channel, with its memory: ask it in order of time.
///
/// ```
/// use phugoid_flight_dynamics::sensors::{Sensor, SensorSpecification};
///
/// // Angle of attack in rad: 0.1 deg of noise, an offset of 0.2 deg, 50 samples per second.
/// let degree = 1.0_f64.to_radians();
/// let vane =
///     SensorSpecification { noise: 0.1 * degree, bias: 0.2 * degree, sample_interval: 0.02, ..Default::default() };
/// let times: Vec<f64> = (0..1000).map(|k| 0.01 * f64::from(k)).collect();
/// let readings = Sensor::new(vane, 7, 0)?.record(&times, &[0.05; 1000])?;
/// assert!(readings[1].is_nan()); // no sample of its own at 0.01 s
/// let taken: Vec<f64> = readings.into_iter().filter(|y| y.is_finite()).collect();
/// let mean = taken.iter().sum::<f64>() / taken.len() as f64;
/// assert!((mean - 0.05 - 0.2 * degree).abs() < 0.03 * degree);
/// # Ok::<(), phugoid_flight_dynamics::sensors::SensorError>(())
/// ```
#[derive(Clone, Debug)]
pub struct Sensor {
    specification: SensorSpecification,
    channel: usize,
    noise: Pcg64Mcg,
    outliers: Pcg64Mcg,
    drops: Pcg64Mcg,
    /// True values not older than the delay, and one that is.
    past: VecDeque<(f64, f64)>,
    start: Option<f64>,
    /// Number of the next sample since the start.
    next_sample: u64,
    /// Sign of the outliers of the burst that the last sample was in; zero outside of one, NaN before the first sample.
    burst: f64,
}

impl Sensor {
    /// The sensor number `channel` of a run.
    ///
    /// # Errors
    /// [`SensorError::Specification`] names the field that is out of range.
    pub fn new(specification: SensorSpecification, seed: u64, channel: usize) -> Result<Self, SensorError> {
        let s = &specification;
        let positive = "a finite number, not negative";
        let probability = "a probability, 0 to 1";
        for (field, value, valid, expected) in [
            ("noise", s.noise, s.noise >= 0.0, positive),
            ("bias", s.bias, true, "a finite number"),
            ("scale_error", s.scale_error, true, "a finite number"),
            ("sample_interval", s.sample_interval, s.sample_interval >= 0.0, positive),
            ("delay", s.delay, s.delay >= 0.0, positive),
            ("quantisation", s.quantisation, s.quantisation >= 0.0, positive),
            ("outlier_probability", s.outlier_probability, (0.0..=1.0).contains(&s.outlier_probability), probability),
            ("outlier_size", s.outlier_size, true, "a finite number"),
            ("outlier_burst", s.outlier_burst, valid_burst(s), "zero, or a mean length of one sample or more"),
            ("drop_probability", s.drop_probability, (0.0..=1.0).contains(&s.drop_probability), probability),
        ] {
            if !valid || !value.is_finite() {
                return Err(SensorError::Specification { channel, field, value, expected });
            }
        }
        Ok(Self {
            specification,
            channel,
            noise: generator(seed, channel, 0),
            outliers: generator(seed, channel, 1),
            drops: generator(seed, channel, 2),
            past: VecDeque::new(),
            start: None,
            next_sample: 0,
            burst: f64::NAN,
        })
    }

    /// The reading at `time` (s) when the true value is `value`: NaN when the channel has no sample for this time. A true
    /// value that is NaN makes the readings it enters NaN.
    ///
    /// # Errors
    /// [`SensorError::TimeBackwards`] when the time lies before the last one, or is not a number.
    pub fn measure(&mut self, time: f64, value: f64) -> Result<f64, SensorError> {
        let previous = self.past.back().map_or(f64::NEG_INFINITY, |last| last.0);
        if time.is_nan() || time < previous {
            return Err(SensorError::TimeBackwards { channel: self.channel, time, previous });
        }
        self.past.push_back((time, value));
        let truth = self.delayed(time);
        if !self.due(time) {
            return Ok(f64::NAN);
        }
        let s = &self.specification;
        let noise: f64 = StandardNormal.sample(&mut self.noise);
        let mut reading = truth * (1.0 + s.scale_error) + s.bias + s.noise * noise;
        let (chance, negative) = (self.outliers.random::<f64>(), self.outliers.random::<bool>());
        let sign = if negative { -1.0 } else { 1.0 };
        self.burst = match s.outlier_probability {
            p if s.outlier_burst > 0.0 => {
                // A chain of two states that is in bursts a part p of the time; a burst goes on with chance 1 - 1/length.
                let begins = p / (s.outlier_burst * (1.0 - p));
                match self.burst {
                    before if before.is_nan() => f64::from(chance < p) * sign,
                    0.0 => f64::from(chance < begins) * sign,
                    before => f64::from(chance >= s.outlier_burst.recip()) * before,
                }
            }
            p => f64::from(chance < p) * sign,
        };
        if self.burst != 0.0 {
            reading += self.burst * s.outlier_size;
        }
        if s.quantisation > 0.0 {
            reading = (reading / s.quantisation).round() * s.quantisation;
        }
        let lost = self.drops.random::<f64>() < s.drop_probability;
        Ok(if lost { f64::NAN } else { reading })
    }

    /// The readings of a whole history.
    ///
    /// # Errors
    /// [`SensorError`] when the times are not in order or do not pair up with the values.
    pub fn record(&mut self, times: &[f64], values: &[f64]) -> Result<Vec<f64>, SensorError> {
        if times.len() != values.len() {
            return Err(SensorError::Length { values: values.len(), expected: times.len() });
        }
        times.iter().zip(values).map(|(&time, &value)| self.measure(time, value)).collect()
    }

    /// The true value one delay ago.
    fn delayed(&mut self, time: f64) -> f64 {
        let asked = time - self.specification.delay;
        // Keep the latest value that is old enough in front.
        while self.past.get(1).is_some_and(|second| second.0 <= asked) {
            self.past.pop_front();
        }
        match (self.past.front(), self.past.get(1)) {
            (Some(&(t0, v0)), Some(&(t1, v1))) if asked > t0 => v0 + (v1 - v0) * (asked - t0) / (t1 - t0),
            (Some(&(_, v0)), _) => v0,
            (None, _) => f64::NAN,
        }
    }

    /// Whether a sample is due at this time. Late questions do not move the later samples.
    fn due(&mut self, time: f64) -> bool {
        let start = *self.start.get_or_insert(time);
        let interval = self.specification.sample_interval;
        if interval <= 0.0 {
            return true;
        }
        // Rounding of decimal times must not put a sample off to the next question.
        let reached = ((time - start) / interval + 1e-6).floor();
        if reached < self.next_sample as f64 {
            return false;
        }
        self.next_sample = reached as u64 + 1;
        true
    }
}

/// A burst cannot be shorter than a sample, nor so long between so many others that no sample lies between two of them.
fn valid_burst(s: &SensorSpecification) -> bool {
    let p = s.outlier_probability;
    s.outlier_burst == 0.0 || (s.outlier_burst >= 1.0 && p < 1.0 && p <= s.outlier_burst * (1.0 - p))
}

/// The sensors of all channels of a run.
#[derive(Clone, Debug)]
pub struct SensorSuite {
    sensors: Vec<Sensor>,
}

impl SensorSuite {
    /// One sensor per specification; the channel's index is its place.
    ///
    /// # Errors
    /// [`SensorError::Specification`] names channel and field that are out of range.
    pub fn new(specifications: &[SensorSpecification], seed: u64) -> Result<Self, SensorError> {
        let sensors = specifications.iter().enumerate().map(|(channel, &s)| Sensor::new(s, seed, channel));
        Ok(Self { sensors: sensors.collect::<Result<_, _>>()? })
    }

    /// One frame: the reading of every channel at `time` (s), NaN where there is none.
    ///
    /// # Errors
    /// [`SensorError`] when time goes backwards or there is not one value per channel.
    pub fn measure(&mut self, time: f64, values: &[f64]) -> Result<Vec<f64>, SensorError> {
        if values.len() != self.sensors.len() {
            return Err(SensorError::Length { values: values.len(), expected: self.sensors.len() });
        }
        self.sensors.iter_mut().zip(values).map(|(sensor, &value)| sensor.measure(time, value)).collect()
    }
}

/// A generator for one purpose of one channel.
fn generator(seed: u64, channel: usize, purpose: u64) -> Pcg64Mcg {
    let stream = split_mix(split_mix(seed) ^ split_mix(4 * channel as u64 + purpose + 1).rotate_left(32));
    Pcg64Mcg::new((u128::from(stream) << 64) | u128::from(split_mix(stream)))
}

/// The finaliser of SplitMix64: G. L. Steele, D. Lea, C. H. Flood, OOPSLA 2014.
fn split_mix(x: u64) -> u64 {
    let z = x.wrapping_add(0x9E37_79B9_7F4A_7C15);
    let z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    let z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    z ^ (z >> 31)
}
