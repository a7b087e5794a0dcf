//! A finished result as the page takes it.

use std::io;

use phugoid_identification::estimation::ParameterReadiness;
use phugoid_identification::session::Layout;
use serde::{Deserialize, Serialize};
use serde_json::Value;

use crate::page;

/// Why a file cannot be shown.
#[derive(Debug, thiserror::Error)]
pub enum ViewError {
    /// It cannot be read.
    #[error("cannot read the result: {0}")]
    Read(#[from] io::Error),
    /// It is no result.
    #[error(
        "this is no result that can be shown: {0}. Make one with `phugoid estimate FLIGHT --model MODEL --json --history > \
         result.json`, or keep what `phugoid live` publishes or records"
    )]
    NoResult(String),
    /// It is a result without the course over time.
    #[error("this result holds no histories: make it with `phugoid estimate ... --json --history`")]
    NoHistory,
    /// The page cannot be written as JSON.
    #[error("the result cannot be put into the page: {0}")]
    Page(#[from] serde_json::Error),
}

/// A result as the page takes it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Finished {
    pub(super) hello: Hello,
    pub(super) history: Columns,
    /// What is known of the parameters at the end.
    pub(super) parameters: Vec<FinalParameter>,
    pub(super) events: Vec<Event>,
    /// Sentences: the verdict, and what was left out of a damaged file.
    pub(super) verdict: Vec<String>,
    /// The last report about the link.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) link: Option<Value>,
}

#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub(super) struct Hello {
    pub(super) source: String,
    pub(super) layout: Layout,
}

/// Columns over time: for each parameter its value and the edges of its band, for each output what was measured, what was
/// predicted and the residual, then the inputs. NaN (in JSON `null`) where missing.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub(super) struct Columns {
    pub(super) time_s: Vec<f64>,
    pub(super) columns: Vec<Vec<f32>>,
    /// How many samples stand behind two rows, where there were too many to keep each: their least and greatest values.
    pub(super) samples_per_group: usize,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Event {
    /// Time of the sender, s; none if it is about the link.
    pub(super) time_s: Option<f64>,
    pub(super) kind: String,
    pub(super) message: String,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub(super) struct FinalParameter {
    pub(super) value: Option<f64>,
    pub(super) std_error: Option<f64>,
    pub(super) status: String,
    pub(super) readiness: Option<ParameterReadiness>,
    /// The true value, where the flight was simulated.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) truth: Option<f64>,
}

impl Finished {
    /// The page with the result inside: one file that needs nothing else.
    ///
    /// # Errors
    /// [`ViewError::Page`].
    pub fn html(&self) -> Result<String, ViewError> {
        Ok(page::with_result(self)?)
    }

    /// How many estimates it holds, or how many were thinned to the rows that it holds.
    pub fn rows(&self) -> usize {
        self.history.time_s.len()
    }
}
