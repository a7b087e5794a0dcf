//! Logs of autopilots and recorders as they were written: topics, each sampled at times of its own.
//!
//! A reader of a format gives a [`Log`], or a [`survey::Survey`] that keeps no values. A [`crate::record::Record`] on
//! one time base is made of a log by [`crate::reader`].
//!
//! ```
//! use phugoid_flight_data::log::{self, Selection};
//! let path = "examples/flight.ulg".as_ref();
//! for topic in &log::survey_path(path)?.topics {
//!     println!("{} #{}: {} samples every {} s", topic.name, topic.instance, topic.samples, topic.step_s);
//! }
//! let log = log::read_path(path, &Selection::topics(["vehicle_acceleration"]))?;
//! let topic = log.topic("vehicle_acceleration", 0).expect("it was selected");
//! let down = topic.field("xyz[2]").expect("it has three elements"); // m/s^2; ULog itself states no units
//! assert!(down.values.iter().all(|value| (-20.0..0.0).contains(value)));
//! # Ok::<(), log::LogError>(())
//! ```

pub mod dataflash;
mod decode;
mod error;
#[cfg(feature = "parquet")]
mod flight_review;
#[cfg(feature = "mcap")]
pub mod mcap;
mod read;
mod selection;
mod sink;
mod skipped;
pub mod survey;
mod survey_and_tables;

pub mod tlog;
pub mod ulog;
pub mod utc;
mod window;

pub use error::LogError;
pub use read::is_flight_review;
pub(crate) use read::{Input, read_as, survey_and_read_as, survey_as};
pub use read::{read, read_path, survey, survey_path};
pub use selection::{Selection, Wanted};

use serde::Serialize;

use crate::quality::QualityReport;

/// The content of a log, or of the part of it that was selected.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Log {
    /// Where it came from, for messages and reports.
    pub source: String,
    /// What the log states about itself (vehicle, firmware, start of recording), as pairs of name and value.
    pub information: Vec<(String, String)>,
    /// Parameters of the autopilot at the start of the log.
    pub parameters: Vec<(String, f64)>,
    /// Text messages of the autopilot.
    pub messages: Vec<Message>,
    /// Topics in the order of their first appearance.
    pub topics: Vec<Topic>,
    /// Names of the topics that are in the log but were not selected.
    pub others: Vec<String>,
    /// What the reader found, skipped and left out.
    pub quality: QualityReport,
}

/// A text message in a log.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Message {
    /// Time of the message, s from the start of the log.
    pub time_s: f64,
    /// The text, cut after some hundred characters.
    pub text: String,
}

/// One kind of data message in a log: times, and fields with one value per time.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Topic {
    /// Name of the topic in the log: `vehicle_attitude`, `IMU`.
    pub name: String,
    /// Number of the instance, from 0, where the aircraft has several equal sensors.
    pub instance: u16,
    /// Time of each sample, s from the start of the log, in the order of the log, which need not rise.
    pub time_s: Vec<f64>,
    /// The numeric fields; an array gives one field per element, `xyz[0]`.
    pub fields: Vec<Field>,
}

/// One signal of a topic.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Field {
    /// Name of the field within the topic: `GyrX`, `q[3]`.
    pub name: String,
    /// Unit as the log states it (`rad/s`, `deg`); `None` if it does not. Values are in this unit, with multipliers
    /// applied.
    pub unit: Option<String>,
    /// One value per time of the topic; NaN where the log has no value.
    pub values: Vec<f64>,
}

impl Log {
    /// The topic with this name and instance, or `None`.
    pub fn topic(&self, name: &str, instance: u16) -> Option<&Topic> {
        self.topics.iter().find(|topic| topic.name == name && topic.instance == instance)
    }
}

impl Topic {
    /// The field with this name, or `None`.
    pub fn field(&self, name: &str) -> Option<&Field> {
        self.fields.iter().find(|field| field.name == name)
    }
}
