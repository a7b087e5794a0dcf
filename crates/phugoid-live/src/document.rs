//! The documents that are published, one JSON object each (`docs/live.md`).

use phugoid_identification::estimation::ParameterReadiness;
use phugoid_identification::session::{Layout, LiveParameter, Snapshot};
use serde::{Serialize, Serializer};

use crate::link::{Counts, LatencyMs};

/// A document. New fields may be added; none is renamed.
#[derive(Clone, Debug, Serialize)]
#[serde(tag = "type", rename_all = "snake_case")]
pub enum Document<'a> {
    /// What the arrays of the estimates are: first, and again after a restart of the sender.
    Hello {
        /// Version of this program.
        version: &'static str,
        /// Where the data come from.
        source: &'a str,
        /// Start of the reception, UTC, ISO 8601; none if the clock of this machine was not set.
        started: Option<&'a str>,
        /// Counts the starts of the sender's clock, from 0.
        flight: u64,
        /// Names and units.
        layout: &'a Layout,
    },
    /// An estimate.
    Estimate {
        /// As in the last `hello`.
        flight: u64,
        /// As in [`Snapshot`].
        time_s: f64,
        /// As in [`Snapshot`].
        phase: &'a str,
        /// As in [`Snapshot`].
        change: &'a str,
        /// As in [`Snapshot`].
        moved: bool,
        /// Parameters.
        parameters: Parameters<'a>,
        /// As in [`Snapshot`].
        outputs: &'a [f64],
        /// As in [`Snapshot`].
        predicted: &'a [f64],
        /// As in [`Snapshot`].
        residuals: &'a [f64],
        /// As in [`Snapshot`].
        inputs: &'a [f64],
    },
    /// Something that happened.
    Event {
        /// Time of the sender, s; none if it is about the link.
        time_s: Option<f64>,
        /// Time since the start of the reception, s.
        arrival_s: f64,
        /// One word.
        kind: &'a str,
        /// A sentence.
        message: &'a str,
    },
    /// What the link did, once a second.
    Link {
        /// Time since the start of the reception, s.
        arrival_s: f64,
        /// Counts.
        #[serde(flatten)]
        counts: Counts,
        /// From arrival to estimate, ms.
        latency_ms: LatencyMs,
        /// Bytes of the recording.
        recorded_bytes: u64,
        /// Arrivals that could not be recorded.
        recording_dropped: u64,
        /// Estimates that a reader of the documents was too slow for.
        published_dropped: u64,
        /// What the estimation waits for, if it has not begun.
        waiting: Option<&'a str>,
    },
    /// The last one.
    End {
        /// Why.
        reason: &'a str,
        /// Counts at the end.
        #[serde(flatten)]
        counts: Counts,
        /// Estimates made.
        estimates: u64,
        /// From arrival to estimate, ms.
        latency_ms: LatencyMs,
    },
}

/// Parameters of an estimate. Their readiness is a text that changes seldom: it is written where it was renewed, and stands until the
/// next.
#[derive(Clone, Copy, Debug)]
pub struct Parameters<'a> {
    parameters: &'a [LiveParameter],
    readiness: bool,
}

#[derive(Serialize)]
struct Parameter<'a> {
    value: f64,
    std_error: f64,
    status: &'a str,
    #[serde(skip_serializing_if = "Option::is_none")]
    readiness: Option<&'a ParameterReadiness>,
}

impl Serialize for Parameters<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_seq(self.parameters.iter().map(|parameter| Parameter {
            value: parameter.value,
            std_error: parameter.std_error,
            status: parameter.status.word(),
            readiness: parameter.readiness.as_ref().filter(|_| self.readiness),
        }))
    }
}

/// What kind of document a text is, for those who pass it on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Is kept for newcomers.
    Hello,
    /// May be left out where a reader is slow; `shown` for those that a page gets.
    Estimate {
        /// One of the at most fifty a second for pages.
        shown: bool,
        /// It has the readiness of the parameters.
        readiness: bool,
    },
    /// Is never left out.
    Event,
    /// The latest counts.
    Link,
    /// The last.
    End,
}

impl Kind {
    /// False for estimates beyond those for pages.
    pub fn is_shown(self) -> bool {
        !matches!(self, Self::Estimate { shown: false, .. })
    }
}

impl<'a> Document<'a> {
    /// The document of a snapshot, with the readiness of the parameters or without.
    pub fn estimate(flight: u64, snapshot: &'a Snapshot, readiness: bool) -> Self {
        Self::Estimate {
            flight,
            time_s: snapshot.time_s,
            phase: snapshot.phase.word(),
            change: snapshot.change.word(),
            moved: snapshot.moved,
            parameters: Parameters { parameters: &snapshot.parameters, readiness },
            outputs: &snapshot.outputs,
            predicted: &snapshot.predicted,
            residuals: &snapshot.residuals,
            inputs: &snapshot.inputs,
        }
    }

    /// The document as one line of JSON, without a line end. Numbers that are not finite become `null`.
    pub fn text(&self) -> String {
        // Plain data: nothing in it can fail to be written.
        serde_json::to_string(self).unwrap_or_default()
    }
}
