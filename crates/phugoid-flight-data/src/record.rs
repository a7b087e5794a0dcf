//! A flight record in memory.

use serde::{Deserialize, Serialize};

use crate::quality::QualityReport;

/// The physical quantity of a channel: it decides which unit suffixes are understood and the SI unit kept inside.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Quantity {
    /// s
    Time,
    /// rad
    Angle,
    /// rad/s
    AngularRate,
    /// rad/s^2
    AngularAcceleration,
    /// m/s
    Speed,
    /// m/s^2
    Acceleration,
    /// m
    Length,
    /// Pa
    Pressure,
    /// kg/m^3
    Density,
    /// N
    Force,
    /// kg
    Mass,
    /// kg m^2
    Inertia,
    /// K
    Temperature,
    /// A pure number (throttle, Mach number, flags)
    Number,
}

/// One measured or computed signal on the record's time base.
#[derive(Clone, Debug, PartialEq)]
pub struct Channel {
    /// Canonical name without a unit, such as `alpha`, `q`, `true_airspeed`, `elevator`, `ax`.
    pub name: String,
    /// What it is; values are in the SI unit of this quantity.
    pub quantity: Quantity,
    /// One value per time, SI; NaN where the value is missing.
    pub values: Vec<f64>,
}

/// A flight record: strictly increasing time and channels of the same length.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Record {
    /// Where it came from (a file name or the name of a scenario), for messages and reports.
    pub source: String,
    /// Time, s, strictly increasing.
    pub time: Vec<f64>,
    /// Channels, in the order of the file.
    pub channels: Vec<Channel>,
    /// What the reader found, mended and left out.
    pub quality: QualityReport,
}

impl Record {
    /// The channel with this canonical name.
    pub fn channel(&self, name: &str) -> Option<&Channel> {
        self.channels.iter().find(|c| c.name == name)
    }
}
