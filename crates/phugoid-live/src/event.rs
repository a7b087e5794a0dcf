//! Kinds of the events that are published.

use phugoid_identification::estimation;
use serde::{Deserialize, Serialize};

/// What an event is about. In JSON it is one word, such as `refused` or `in_doubt`.
///
/// ```
/// use phugoid_live::event::{EventKind, LiveEventKind};
///
/// let kind: EventKind = serde_json::from_str(r#""silent""#)?;
/// assert_eq!(kind, EventKind::Live(LiveEventKind::Silent));
/// // A word that this crate does not publish itself is one of the estimator's events.
/// let kind: EventKind = serde_json::from_str(r#""in_doubt""#)?;
/// assert_eq!(kind, EventKind::Estimation(phugoid_identification::estimation::EventKind::InDoubt));
/// assert_eq!(serde_json::to_string(&kind)?, r#""in_doubt""#);
/// # Ok::<(), serde_json::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum EventKind {
    /// An event of the reception or of the live estimation as a whole.
    Live(LiveEventKind),
    /// An event of the estimator.
    Estimation(estimation::EventKind),
}

/// Events that this crate itself reports.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum LiveEventKind {
    /// A sender appeared, or its connection ended.
    Origin,
    /// It is known now whether a sender gives MAVLink or text.
    Payload,
    /// The columns of a text stream, with what was found about their names and units.
    Columns,
    /// How the true airspeed is obtained, or what is missing for it.
    Airspeed,
    /// The MAVLink message was chosen whose times are those of the samples.
    Base,
    /// A row, a message or a sample was left out because of its content.
    Refused,
    /// Samples arrive, but their time has not moved for a second.
    Stalled,
    /// Nothing has arrived for two seconds, or data arrive again.
    Silent,
    /// The sender whose samples are used: the first one, or another because it was silent.
    Sender,
    /// Data of another sender came, which are not used.
    Stranger,
    /// Another sender uses the numbers of the one whose samples are used, or a frame is not signed as it should be.
    /// Somebody may be sending false data.
    Alarm,
    /// A time leapt against its arrival: it was left out, or data are missing.
    Leap,
    /// The clock of the sender was set; what is known is kept, and the states start again.
    Restart,
    /// What arrives cannot be estimated with this model; the next flight is tried again.
    Impossible,
    /// The stream ended before an estimation could begin.
    Waiting,
    /// What is declared uncertain and is not in the bounds, since it is not worked out in flight.
    Bounds,
    /// The recording cannot be written, goes on, or has reached its limit.
    Recording,
}

impl EventKind {
    /// The word that stands in JSON, such as `refused` or `in_doubt`.
    pub fn name(&self) -> &str {
        match self {
            Self::Live(kind) => kind.name(),
            Self::Estimation(kind) => kind.word(),
        }
    }
}

impl LiveEventKind {
    /// The word that stands in JSON, such as `refused`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Origin => "origin",
            Self::Payload => "payload",
            Self::Columns => "columns",
            Self::Airspeed => "airspeed",
            Self::Base => "base",
            Self::Refused => "refused",
            Self::Stalled => "stalled",
            Self::Silent => "silent",
            Self::Sender => "sender",
            Self::Stranger => "stranger",
            Self::Alarm => "alarm",
            Self::Leap => "leap",
            Self::Restart => "restart",
            Self::Impossible => "impossible",
            Self::Waiting => "waiting",
            Self::Bounds => "bounds",
            Self::Recording => "recording",
        }
    }
}

impl From<LiveEventKind> for EventKind {
    fn from(kind: LiveEventKind) -> Self {
        Self::Live(kind)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_name_is_the_word_in_json() {
        use LiveEventKind::{
            Airspeed, Alarm, Base, Bounds, Columns, Impossible, Leap, Origin, Payload, Recording, Refused, Restart,
            Sender, Silent, Stalled, Stranger, Waiting,
        };
        for kind in [
            Origin, Payload, Columns, Airspeed, Base, Refused, Stalled, Silent, Sender, Stranger, Alarm, Leap, Restart,
            Impossible, Waiting, Bounds, Recording,
        ] {
            let kind = EventKind::from(kind);
            let json = serde_json::to_string(&kind).unwrap();
            assert_eq!(json, format!("\"{}\"", kind.name()));
            assert_eq!(serde_json::from_str::<EventKind>(&json).unwrap(), kind);
        }
    }
}
