//! A finished result as the page takes it.

use std::io;

use phugoid_identification::estimation::{EstimationStatus, ParameterReadiness};
use phugoid_identification::session::Layout;
use serde::{Deserialize, Serialize};
use serde_json::Value;

use crate::event::EventKind;
use crate::page;

/// Why a result cannot be shown.
#[derive(Debug, thiserror::Error)]
pub enum ViewError {
    /// The file cannot be read.
    #[error("cannot read the result: {0}")]
    Read(#[from] io::Error),
    /// The file is not a result, or has no estimate in it; the sentence says why.
    #[error(
        "this is no result that can be shown: {0}. Make one with `phugoid estimate FLIGHT --model MODEL --json --history > \
         result.json`, or keep what `phugoid live` publishes or records"
    )]
    NoResult(String),
    /// The result has no histories over time.
    #[error("this result holds no histories: make it with `phugoid estimate ... --json --history`")]
    NoHistory,
    /// The result cannot be written as JSON.
    #[error("the result cannot be put into the page: {0}")]
    Page(#[from] serde_json::Error),
}

/// A result in the form that the page reads.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Finished {
    pub(super) hello: Hello,
    pub(super) history: Columns,
    /// The parameters at the end.
    pub(super) parameters: Vec<FinalParameter>,
    pub(super) events: Vec<Event>,
    /// What the result as a whole is worth; `None` for what a live estimation published, which ends without a verdict.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) status: Option<EstimationStatus>,
    /// Sentences for people: the verdict, and what was left out of a damaged file.
    pub(super) verdict: Vec<String>,
    /// The last document about the link.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) link: Option<Value>,
}

#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub(super) struct Hello {
    pub(super) source: String,
    pub(super) layout: Layout,
}

/// Columns over time, in this order: for each parameter its value and the lower and upper edge of its 2-sigma band; for
/// each output the measured and predicted value and the residual; then the inputs. A missing value is NaN (in JSON
/// `null`).
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub(super) struct Columns {
    pub(super) time_s: Vec<f64>,
    pub(super) columns: Vec<Vec<f32>>,
    /// 1 if every sample is kept. Else two rows hold the least and greatest values of so many samples.
    pub(super) samples_per_group: usize,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Event {
    /// Time by the sender's clock, s; `None` for an event of the link.
    pub(super) time_s: Option<f64>,
    pub(super) kind: EventKind,
    pub(super) message: String,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub(super) struct FinalParameter {
    pub(super) value: Option<f64>,
    pub(super) std_error: Option<f64>,
    /// The part of it that declared uncertainties make.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) systematic_std: Option<f64>,
    pub(super) status: String,
    pub(super) readiness: Option<ParameterReadiness>,
    /// The true value, if the flight was simulated.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) truth: Option<f64>,
}

impl Finished {
    /// The page with the result inside, as one file that needs nothing else.
    ///
    /// # Errors
    /// [`ViewError::Page`] if the result cannot be written as JSON.
    pub fn html(&self) -> Result<String, ViewError> {
        Ok(page::with_result(self)?)
    }

    /// Number of rows over time. It is the number of estimates, or less if there were too many to keep each.
    pub fn rows(&self) -> usize {
        self.history.time_s.len()
    }
}
