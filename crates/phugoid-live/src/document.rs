//! The documents that are published, one JSON object each. `docs/live.md` describes their fields.

use phugoid_flight_data::printable::brief;
use phugoid_identification::estimation::ParameterReadiness;
use phugoid_identification::session::{Layout, LiveParameter, Snapshot};
use serde::{Deserialize, Serialize, Serializer};
use serde_json::Value;

use crate::event::EventKind;
use crate::json::shown;
use crate::link::{Counts, LatencyMs};

/// A document. Later versions may add fields; no field is renamed.
///
/// ```
/// use phugoid_live::document::{Document, DocumentType};
/// use phugoid_live::event::LiveEventKind;
///
/// let document = Document::Event {
///     time_s: None,
///     arrival_s: 12.5,
///     kind: &LiveEventKind::Silent.into(),
///     message: "nothing has arrived for 2 s",
/// };
/// let json = document.text();
/// assert!(json.starts_with(r#"{"type":"event","time_s":null,"arrival_s":12.5,"kind":"silent","#));
/// let read: serde_json::Value = serde_json::from_str(&json)?;
/// assert_eq!(DocumentType::of(&read), DocumentType::Event);
/// # Ok::<(), serde_json::Error>(())
/// ```
#[derive(Clone, Debug, Serialize)]
#[serde(tag = "type", rename_all = "snake_case")]
pub enum Document<'a> {
    /// Says what the arrays of the estimates hold. It is the first document, and comes again after a restart of the
    /// sender.
    Hello {
        /// Version of this crate, such as `0.1.0`.
        version: &'static str,
        /// Where the data come from, as on the command line.
        source: &'a str,
        /// Start of the reception, UTC, ISO 8601; `None` if the clock of this machine was not set.
        started: Option<&'a str>,
        /// Number of times that the sender's clock has started again, from 0.
        flight: u64,
        /// Names and units of parameters, outputs and inputs, in the order of the arrays.
        layout: &'a Layout,
    },
    /// An estimate. Numbers that are not finite become `null`.
    Estimate {
        /// As in the last `hello`.
        flight: u64,
        /// Time of the sample by the sender's clock, s.
        time_s: f64,
        /// Phase of the estimator, as in [`Snapshot`].
        phase: &'a str,
        /// State of the change detection, as in [`Snapshot`].
        change: &'a str,
        /// Whether the estimate moved, as in [`Snapshot`].
        moved: bool,
        /// Parameters in the order of the layout.
        parameters: Parameters<'a>,
        /// Measured outputs in the order of the layout, SI.
        outputs: &'a [f64],
        /// Outputs that the model predicted one sample ahead, SI.
        predicted: &'a [f64],
        /// Whitened residuals, in standard deviations.
        residuals: &'a [f64],
        /// Inputs in the order of the layout, SI.
        inputs: &'a [f64],
    },
    /// Something happened that a person should know.
    Event {
        /// Time by the sender's clock, s; `None` for an event of the link.
        time_s: Option<f64>,
        /// Time since the start of the reception, s.
        arrival_s: f64,
        /// What it is about, one word.
        kind: &'a EventKind,
        /// What happened, as one sentence for people.
        message: &'a str,
    },
    /// What the link did since the start; published once a second.
    Link {
        /// Time since the start of the reception, s.
        arrival_s: f64,
        /// Counts of the link since the start; their fields stand in the document itself.
        #[serde(flatten)]
        counts: Counts,
        /// Quantiles of the time from arrival to estimate, ms.
        latency_ms: LatencyMs,
        /// Bytes of the recording so far.
        recorded_bytes: u64,
        /// Arrivals that could not be recorded.
        recording_dropped: u64,
        /// Estimates that were left out for a slow reader of the lines.
        published_dropped: u64,
        /// What the estimation waits for; `None` once it has begun.
        waiting: Option<&'a str>,
    },
    /// The last document of a stream.
    End {
        /// Why the estimation ended, for people.
        reason: &'a str,
        /// Counts of the link at the end; their fields stand in the document itself.
        #[serde(flatten)]
        counts: Counts,
        /// Number of estimates that were made; not all of them are published.
        estimates: u64,
        /// Quantiles of the time from arrival to estimate, ms.
        latency_ms: LatencyMs,
    },
}

/// The parameters of an estimate. Their readiness (verdict, reason, advice) seldom changes and is long, so it is
/// written only into the documents where it was renewed and holds until the next of them.
#[derive(Clone, Copy, Debug)]
pub struct Parameters<'a> {
    parameters: &'a [LiveParameter],
    with_readiness: bool,
}

#[derive(Serialize)]
struct Parameter<'a> {
    value: f64,
    std_error: f64,
    systematic_std: f64,
    status: &'a str,
    #[serde(skip_serializing_if = "Option::is_none")]
    readiness: Option<&'a ParameterReadiness>,
}

impl Serialize for Parameters<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_seq(self.parameters.iter().map(|parameter| Parameter {
            value: parameter.value,
            std_error: parameter.std_error,
            systematic_std: parameter.systematic_std,
            status: parameter.status.word(),
            readiness: parameter.readiness.as_ref().filter(|_| self.with_readiness),
        }))
    }
}

/// What kind of document a text is. Those who pass documents on decide by it, so that they need not read the JSON.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DocumentKind {
    /// Names and units. It has to be kept for readers that come later.
    Hello,
    /// An estimate. It may be left out for a slow reader.
    Estimate {
        /// True for the estimates that the page and the terminal view get, at most fifty a second.
        shown: bool,
        /// True if the readiness of the parameters is in it.
        readiness: bool,
    },
    /// An event. It must not be left out.
    Event,
    /// Counts of the link; a later one replaces it.
    Link,
    /// The last document of a stream.
    End,
}

impl DocumentKind {
    /// False only for estimates that the page and the terminal view do not get.
    pub fn is_shown(self) -> bool {
        !matches!(self, Self::Estimate { shown: false, .. })
    }
}

/// The `type` of a document that was read.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum DocumentType {
    /// `hello`: see [`Document::Hello`].
    Hello,
    /// `estimate`: see [`Document::Estimate`].
    Estimate,
    /// `event`: see [`Document::Event`].
    Event,
    /// `link`: see [`Document::Link`].
    Link,
    /// `end`: see [`Document::End`].
    End,
    /// No type, or one that a later version has added. Such a document is to be passed over.
    #[serde(other)]
    Unknown,
}

impl DocumentType {
    /// The type of a document as JSON.
    pub fn of(document: &Value) -> Self {
        document.get("type").and_then(|word| Self::deserialize(word).ok()).unwrap_or(Self::Unknown)
    }
}

/// A function that gets every document: its kind, and its JSON on one line without the line end.
pub type Publish<'a> = &'a mut dyn FnMut(DocumentKind, &str);

impl<'a> Document<'a> {
    /// The document of a snapshot. `flight` counts the restarts of the sender; the readiness of the parameters is
    /// written only if asked for.
    pub fn estimate(flight: u64, snapshot: &'a Snapshot, with_readiness: bool) -> Self {
        Self::Estimate {
            flight,
            time_s: snapshot.time_s,
            phase: snapshot.phase.word(),
            change: snapshot.change.word(),
            moved: snapshot.moved,
            parameters: Parameters { parameters: &snapshot.parameters, with_readiness },
            outputs: &snapshot.outputs,
            predicted: &snapshot.predicted,
            residuals: &snapshot.residuals,
            inputs: &snapshot.inputs,
        }
    }

    /// The document as one line of JSON, without a line end. Numbers that are not finite become `null`; in texts U+FFFD
    /// stands for control characters and those that change the direction of text.
    pub fn text(&self) -> String {
        // Plain data cannot fail to be serialised.
        shown(self).unwrap_or_default()
    }
}

/// Publishes an event that happened `now_ns` after the start of the reception; `time_s` is the sender's time where the
/// event has one.
pub(crate) fn publish_event(time_s: Option<f64>, now_ns: u64, kind: &EventKind, message: &str, publish: Publish<'_>) {
    // What somebody has sent may be in it.
    let message: &str = &brief(message);
    let document = Document::Event { time_s, arrival_s: seconds(now_ns), kind, message };
    publish(DocumentKind::Event, &document.text());
}

/// Nanoseconds as seconds.
pub(crate) fn seconds(ns: u64) -> f64 {
    ns as f64 / 1e9
}
