//! Logs of autopilots and recorders: topics, each sampled at times of its own.
//!
//! A reader of a format gives a [`Log`]; a [`crate::record::Record`] on one time base is made of it afterwards, so that what is
//! said of rates, gaps and units is said of the log as it was written.

pub mod dataflash;
mod decode;
mod error;
#[cfg(feature = "mcap")]
pub mod mcap;
mod read;
mod selection;
mod sink;
mod skipped;
pub mod survey;
mod surveyed;
pub mod ulog;
pub mod utc;
mod window;

pub use error::LogError;
pub use read::{read, read_path, survey, survey_path};
pub(crate) use read::{read_as, survey_and_read_as, survey_as};
pub use selection::{Selection, Wanted};

use serde::Serialize;

use crate::quality::QualityReport;

/// What a log holds.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Log {
    /// Where it came from, for messages and reports.
    pub source: String,
    /// What the log says of itself (vehicle, firmware, start of recording), in its own words: name and value.
    pub information: Vec<(String, String)>,
    /// Parameters of the autopilot at the start of the log.
    pub parameters: Vec<(String, f64)>,
    /// What the autopilot said in words.
    pub messages: Vec<Message>,
    /// Topics in the order of their first appearance.
    pub topics: Vec<Topic>,
    /// Names of the topics that are in the log but were not asked for.
    pub others: Vec<String>,
    /// What the reader found, skipped and left out.
    pub quality: QualityReport,
}

/// A line of text in a log.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Message {
    /// When, s from the start of the log.
    pub time_s: f64,
    /// What was said, at most some hundred characters.
    pub text: String,
}

/// One kind of message: one time per sample, and fields of the same length.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Topic {
    /// The log's name of it: `vehicle_attitude`, `IMU`.
    pub name: String,
    /// Which of several equal sources, from 0.
    pub instance: u16,
    /// Time of each sample, s, in the order of the log.
    pub time_s: Vec<f64>,
    /// Numeric fields; arrays are one field per element, `xyz[0]`.
    pub fields: Vec<Field>,
}

/// One signal of a topic.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Field {
    /// Name within the topic: `GyrX`, `q[3]`.
    pub name: String,
    /// Unit as the log gives it (`rad/s`, `deg`), none if it does not say. Values are in this unit, multipliers applied.
    pub unit: Option<String>,
    /// One value per time of the topic; NaN where the log has none.
    pub values: Vec<f64>,
}

impl Log {
    /// The topic of this name and instance.
    pub fn topic(&self, name: &str, instance: u16) -> Option<&Topic> {
        self.topics.iter().find(|topic| topic.name == name && topic.instance == instance)
    }
}

impl Topic {
    /// The field of this name.
    pub fn field(&self, name: &str) -> Option<&Field> {
        self.fields.iter().find(|field| field.name == name)
    }
}
