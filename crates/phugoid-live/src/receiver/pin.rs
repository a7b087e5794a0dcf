//! Whose samples are used: the first sender that gave a valid one, as long as it is not silent.

use crate::source::{FURTHER_SENDERS, SenderSpec};

/// A pinned sender that has been silent for this long, ns, may be replaced by another one.
pub(super) const SILENT_NS: u64 = 5_000_000_000;

/// What a sender is to the estimation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Standing {
    /// It is the pinned one.
    Pinned,
    /// Its next sample makes it the pinned one: there is none yet, or that has been silent.
    Candidate,
    /// Another one is pinned, or was asked for.
    Stranger,
}

/// The sender that is pinned, and the one that was asked for.
#[derive(Debug, Default)]
pub(super) struct Pin {
    /// The sender that alone is used, if one was named.
    wanted: Option<SenderSpec>,
    pinned: Option<Pinned>,
}

/// The sender whose samples are used.
#[derive(Clone, Debug)]
struct Pinned {
    origin: u16,
    /// Address or name.
    peer: String,
    /// System and component of MAVLink that give the times of the samples.
    ids: Option<(u8, u8)>,
    /// Arrival of its last data, ns.
    heard_ns: u64,
}

impl Pin {
    pub(super) fn new(wanted: Option<SenderSpec>) -> Self {
        Self { wanted, pinned: None }
    }

    /// The number of the pinned sender.
    pub(super) fn origin(&self) -> Option<u16> {
        self.pinned.as_ref().map(|pinned| pinned.origin)
    }

    /// Name of the pinned sender, or of the one that was asked for.
    pub(super) fn name(&self) -> String {
        let pinned = self.pinned.as_ref().map(|pinned| pinned.peer.clone());
        pinned.or_else(|| self.wanted.as_ref().map(|wanted| format!("--sender {wanted}"))).unwrap_or_default()
    }

    /// What the sender with this number and name is at this time of arrival, ns.
    pub(super) fn standing(&self, origin: u16, peer: &str, now_ns: u64) -> Standing {
        match &self.pinned {
            Some(pinned) if pinned.origin == origin => Standing::Pinned,
            _ if peer == FURTHER_SENDERS => Standing::Stranger,
            _ if self.wanted.as_ref().is_some_and(|wanted| !wanted.is_peer(peer)) => Standing::Stranger,
            Some(pinned) if now_ns.saturating_sub(pinned.heard_ns) < SILENT_NS => Standing::Stranger,
            _ => Standing::Candidate,
        }
    }

    /// Data of this sender came.
    pub(super) fn heard(&mut self, origin: u16, now_ns: u64) {
        if let Some(pinned) = self.pinned.as_mut().filter(|pinned| pinned.origin == origin) {
            pinned.heard_ns = now_ns;
        }
    }

    /// Whether a MAVLink message of another sender has the numbers of the pinned one.
    pub(super) fn has_ids(&self, system: u8, component: u8) -> bool {
        self.pinned.as_ref().is_some_and(|pinned| pinned.ids == Some((system, component)))
    }

    /// Whether the pinned sender gives rows of text.
    pub(super) fn is_text(&self) -> bool {
        self.pinned.as_ref().is_some_and(|pinned| pinned.ids.is_none())
    }

    /// A sample of this sender is used: it is pinned from now on. Gives a sentence for people if that is new.
    pub(super) fn gave(&mut self, origin: u16, peer: &str, ids: Option<(u8, u8)>, now_ns: u64) -> Option<String> {
        if let Some(pinned) = self.pinned.as_mut().filter(|pinned| pinned.origin == origin) {
            pinned.ids = ids;
            return None;
        }
        let before = self.pinned.replace(Pinned { origin, peer: peer.to_owned(), ids, heard_ns: now_ns });
        let numbers =
            ids.map(|(system, component)| format!(" (system {system}, component {component})")).unwrap_or_default();
        match before {
            None if peer.starts_with("udp ") || peer.starts_with("tcp ") => {
                Some(format!("the samples come from {peer}{numbers}; others are not used while it sends"))
            }
            // There is only one.
            None => None,
            Some(before) => Some(format!(
                "the samples come from {peer}{numbers} from now on: {} has been silent for {:.1} s",
                before.peer,
                now_ns.saturating_sub(before.heard_ns) as f64 / 1e9
            )),
        }
    }

    /// The connection of this sender has ended, so that another one may be pinned at once.
    pub(super) fn release(&mut self, origin: u16) {
        if self.origin() == Some(origin) {
            self.pinned = None;
        }
    }
}
