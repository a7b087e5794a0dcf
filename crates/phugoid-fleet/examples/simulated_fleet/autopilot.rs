//! What the simulated logs of both autopilots have in common.
//!
//! Rates and sizes of what no estimation reads are those of a PX4 log of a small aircraft (1.36 MB for a minute) and of an
//! ArduPilot log (0.74 MB for a minute) that the tests of this project read. Its numbers are drawn, so that nothing about
//! them is easier to read than in life.

use phugoid_flight_data::record::Record;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

/// Deflection of the elevator at full command, rad: 10 degrees.
pub(crate) const FULL_ELEVATOR: f64 = 10.0 * std::f64::consts::PI / 180.0;
/// Density of the air of these flights, kg/m^3.
pub(crate) const AIR_DENSITY: f64 = 0.792;
/// True over equivalent airspeed at this density.
pub(crate) fn true_over_equivalent() -> f64 {
    (1.225 / AIR_DENSITY).sqrt()
}
/// The clock of an autopilot at the first sample, microseconds since it was switched on.
const START_US: u64 = 31_415_926;

/// A sample of a record for the topics of a log: its time and its channels by name.
pub(crate) struct Sample<'a> {
    record: &'a Record,
    /// Number of the sample.
    pub(crate) row: usize,
}

impl<'a> Sample<'a> {
    /// All samples of a record in the order of time.
    pub(crate) fn all(record: &'a Record) -> impl Iterator<Item = Self> {
        (0..record.len()).map(move |row| Self { record, row })
    }

    /// Microseconds since the autopilot was switched on.
    pub(crate) fn stamp(&self) -> u64 {
        START_US + (self.record.time.get(self.row).copied().unwrap_or(0.0) * 1e6).round() as u64
    }

    /// A channel in SI units; NaN where the record does not have it.
    pub(crate) fn value(&self, channel: &str) -> f64 {
        self.record.channel(channel).and_then(|channel| channel.values.get(self.row)).copied().unwrap_or(f64::NAN)
    }

    /// The elevator as a part of its full command, from -1 to 1.
    pub(crate) fn elevator_command(&self) -> f64 {
        (self.value("elevator") / FULL_ELEVATOR).clamp(-1.0, 1.0)
    }

    /// Whether a topic of `rate` samples per second is due at this sample of a record, and how often: a topic that is
    /// faster than the record comes several times.
    pub(crate) fn due(&self, rate: f64) -> u64 {
        let start = self.record.time.first().copied().unwrap_or(0.0);
        let until = |row: usize| {
            let time = self.record.time.get(row).map_or(start, |time| time - start);
            (time * rate + 1e-9).floor() as u64
        };
        if self.row == 0 { 1 } else { until(self.row) - until(self.row - 1) }
    }
}

/// Numbers of topics that no estimation reads.
pub(crate) struct Ballast(Pcg64Mcg);

impl Ballast {
    pub(crate) fn new() -> Self {
        Self(Pcg64Mcg::seed_from_u64(7))
    }

    /// The bytes of a number of single precision between -1 and 1.
    pub(crate) fn number(&mut self) -> [u8; 4] {
        (2.0 * self.0.random::<f32>() - 1.0).to_le_bytes()
    }
}
