//! The documents that are published, one JSON object each (`docs/live.md`).

use phugoid_identification::session::{Layout, Snapshot};
use serde::Serialize;

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
        /// Counts the starts of the sender's clock, from 0.
        flight: u64,
        /// Names and units.
        layout: &'a Layout,
    },
    /// An estimate.
    Estimate {
        /// As in the last `hello`.
        flight: u64,
        /// The estimate.
        #[serde(flatten)]
        snapshot: &'a Snapshot,
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

/// What kind of document a text is, for those who pass it on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Is kept for newcomers.
    Hello,
    /// May be left out where a reader is slow; `shown` for those that a page gets.
    Estimate {
        /// One of the at most fifty a second for pages.
        shown: bool,
    },
    /// Is never left out.
    Event,
    /// The latest counts.
    Link,
    /// The last.
    End,
}

impl Document<'_> {
    /// The document as one line of JSON, without a line end. Numbers that are not finite become `null`.
    pub fn text(&self) -> String {
        // Plain data: nothing in it can fail to be written.
        serde_json::to_string(self).unwrap_or_default()
    }
}
