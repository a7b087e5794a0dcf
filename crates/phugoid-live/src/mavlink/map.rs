//! From messages to samples: which message is the time base, and which field is which channel.

mod conversion;
mod rules;

use std::collections::{HashMap, VecDeque};

use phugoid_flight_data::align::{Aligner, Hold};
use phugoid_flight_data::csv::ColumnMapping;
use phugoid_flight_data::profile::Profile;

use super::definitions::{self, Message};
use super::frame::Frame;
use super::sequence::{Order, Sequence};
use crate::link::Counts;
use rules::{Reading, Rules};

/// What is particular to MAVLink.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MavlinkOptions {
    /// How long a message of the time base waits for messages that were sent before it and have not come, ns; 0: not at all.
    pub reorder_ns: u64,
    /// The vehicle that is listened to; none: the first that sends a time base.
    pub system: Option<u8>,
    /// The message whose times are the samples'; none: the first of the profile's that comes.
    pub base: Option<String>,
}

impl Default for MavlinkOptions {
    fn default() -> Self {
        Self { reorder_ns: 4_000_000, system: None, base: None }
    }
}

/// A better base is waited for this long, ns, and a base that is silent for this long is given up.
const CHOICE_NS: u64 = 1_000_000_000;
/// A stamp this far, s, from the base's is of another clock: the message counts as sampled when it came.
const ANOTHER_CLOCK_S: f64 = 3600.0;
/// Messages of the base that may wait; with the default window at 400 Hz there are two.
const MOST_WAITING: usize = 4096;
/// Components whose sequence is followed.
const MOST_COMPONENTS: usize = 256;

/// A sample's time that is ready.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Ready {
    pub(crate) time_s: f64,
    pub(crate) arrival_ns: u64,
}

/// A message of the base that waits for earlier ones.
#[derive(Clone, Copy, Debug)]
struct Waiting {
    component: (u16, u8, u8),
    index: u64,
    ready: Ready,
}

/// Puts messages together to samples.
pub(crate) struct Assembler {
    options: MavlinkOptions,
    /// Messages that can be the time base, the best first.
    bases: Vec<String>,
    rules: Rules,
    aligner: Aligner,
    sequences: HashMap<(u16, u8, u8), Sequence>,
    waiting: VecDeque<Waiting>,
    base: Base,
    /// Stamp of the newest base message, s.
    newest_s: Option<f64>,
    /// Frames that looked like duplicates since the last in order: after a restart of the sender they were none.
    provisional: u64,
}

/// Which message is the base.
#[derive(Clone, Copy, Debug, Default)]
struct Base {
    /// Rank among the bases, and the vehicle.
    chosen: Option<(usize, u8)>,
    /// The best that came so far, and when the first came.
    best: Option<(usize, u8)>,
    since_ns: u64,
    heard_ns: u64,
}

impl Assembler {
    /// The first `asked` of the channels are those of the samples; others are computed of the rest.
    ///
    /// # Errors
    /// A field that the message does not have, a unit that does not suit, a base that is no message.
    pub(crate) fn new(
        channels: &[String],
        asked: usize,
        columns: &[ColumnMapping],
        options: &MavlinkOptions,
    ) -> Result<Self, String> {
        if let Some(base) = &options.base
            && definitions::by_name(base).and_then(rules::time_field).is_none()
        {
            return Err(format!("`{base}` cannot be the time base: it is no MAVLink message with a time of its own"));
        }
        let profile = Profile::mavlink().map_err(|error| error.to_string())?;
        let hold = |channel: &String| profile.channel(channel).map_or(Hold::Sampled, |entry| entry.hold);
        let holds: Vec<Hold> = channels.iter().map(hold).collect();
        Ok(Self {
            options: options.clone(),
            rules: Rules::new(channels, asked, columns, &profile)?,
            bases: profile.time_base,
            aligner: Aligner::new(&holds),
            sequences: HashMap::new(),
            waiting: VecDeque::new(),
            base: Base::default(),
            newest_s: None,
            provisional: 0,
        })
    }

    /// What a user has to know of the mappings of the model file.
    pub(crate) fn doubts(&self) -> Vec<String> {
        self.rules.doubts.clone()
    }

    /// Takes a frame; what is worth saying goes to `events`.
    pub(crate) fn take(
        &mut self,
        frame: &Frame<'_>,
        origin: u16,
        arrival_ns: u64,
        counts: &mut Counts,
        events: &mut Vec<(&'static str, String)>,
    ) {
        let component = (origin, frame.system, frame.component);
        if !self.sequences.contains_key(&component) && self.sequences.len() >= MOST_COMPONENTS {
            return;
        }
        let place = self.sequences.entry(component).or_default().take(frame.sequence, arrival_ns);
        match place.order {
            Order::Next => self.provisional = 0,
            Order::After(missing) => {
                counts.lost += missing;
                self.provisional = 0;
            }
            Order::Reordered => {
                counts.lost = counts.lost.saturating_sub(1);
                counts.reordered += 1;
            }
            Order::Duplicate => {
                counts.duplicated += 1;
                self.provisional += 1;
            }
        }
        let Some(message) = definitions::messages().get(&frame.id) else { return };
        let base = self.is_base(message, frame, arrival_ns, events);
        if !self.is_heard(frame.system) {
            return;
        }
        let stamp_s = rules::stamp_s(message, frame.payload);
        if base && let Some(time_s) = stamp_s {
            self.newest_s = Some(time_s);
            self.queue(Waiting { component, index: place.index, ready: Ready { time_s, arrival_ns } });
        }
        // A message without a time, or with one of another clock, was sampled when it came, as far as anyone knows.
        let stamp_s = match (stamp_s, self.newest_s) {
            (Some(stamp), Some(newest)) if (stamp - newest).abs() > ANOTHER_CLOCK_S => newest,
            (Some(stamp), _) => stamp,
            (None, Some(newest)) => newest,
            (None, None) => return,
        };
        let aligner = &mut self.aligner;
        self.rules.read(message, frame.payload, stamp_s, &mut |Reading { channel, value }| {
            aligner.put(channel, stamp_s, value);
        });
    }

    /// The next sample whose turn it is at this time, ns.
    pub(crate) fn ready(&mut self, now_ns: u64) -> Option<Ready> {
        let first = self.waiting.front()?;
        let since_ns = now_ns.saturating_sub(self.options.reorder_ns).saturating_add(1);
        let sequence = self.sequences.get(&first.component);
        if sequence.is_some_and(|sequence| sequence.latest_gap(first.index, since_ns).is_some()) {
            return None;
        }
        self.waiting.pop_front().map(|waiting| waiting.ready)
    }

    /// When [`Assembler::ready`] has an answer if nothing arrives before, ns.
    pub(crate) fn deadline_ns(&self) -> Option<u64> {
        let first = self.waiting.front()?;
        let shown = self.sequences.get(&first.component)?.latest_gap(first.index, 0)?;
        Some(shown.saturating_add(self.options.reorder_ns))
    }

    /// The values of a sample.
    pub(crate) fn frame(&mut self, time_s: f64, values: &mut [f64]) {
        self.aligner.frame(time_s, values);
    }

    /// The sender's clock has begun anew. What waits stays: it is of the new time.
    pub(crate) fn restart(&mut self, counts: &mut Counts) {
        self.aligner.restart();
        counts.duplicated = counts.duplicated.saturating_sub(self.provisional);
        self.provisional = 0;
        let waiting: Vec<_> = self.waiting.iter().map(|waiting| waiting.component).collect();
        self.sequences.retain(|component, _| waiting.contains(component));
    }

    /// A peer has come anew: its numbers begin anew.
    pub(crate) fn forget(&mut self, origin: u16) {
        self.sequences.retain(|(from, ..), _| *from != origin);
    }

    fn queue(&mut self, new: Waiting) {
        let same = |other: &Waiting| other.component == new.component && other.index > new.index;
        let behind = self.waiting.iter().rev().take_while(|other| same(other)).count();
        self.waiting.insert(self.waiting.len() - behind, new);
        if self.waiting.len() > MOST_WAITING {
            self.waiting.pop_front();
        }
    }

    fn is_heard(&self, system: u8) -> bool {
        match (self.options.system, self.base.chosen.or(self.base.best)) {
            (Some(wanted), _) => system == wanted,
            (None, Some((_, vehicle))) => system == vehicle,
            (None, None) => true,
        }
    }

    /// Is this message the time base? Chooses one where there is none.
    fn is_base(
        &mut self,
        message: &Message,
        frame: &Frame<'_>,
        arrival_ns: u64,
        events: &mut Vec<(&'static str, String)>,
    ) -> bool {
        let rank = match &self.options.base {
            Some(base) => (message.name == base).then_some(0),
            None => self.bases.iter().position(|base| base == message.name),
        };
        let Some(rank) = rank.filter(|_| self.options.system.is_none_or(|system| system == frame.system)) else {
            return false;
        };
        let this = (rank, frame.system);
        if self.base.chosen == Some(this) {
            self.base.heard_ns = arrival_ns;
            return true;
        }
        if self.base.chosen.is_some() {
            if arrival_ns.saturating_sub(self.base.heard_ns) <= CHOICE_NS {
                return false;
            }
            self.base = Base::default();
        }
        if self.base.best.is_none() {
            self.base.since_ns = arrival_ns;
        }
        if self.base.best.is_none_or(|(best, _)| rank < best) {
            self.base.best = Some(this);
        }
        let waited = arrival_ns.saturating_sub(self.base.since_ns) >= CHOICE_NS;
        if self.base.best != Some(this) || (rank > 0 && !waited) {
            return false;
        }
        (self.base.chosen, self.base.heard_ns) = (Some(this), arrival_ns);
        events.push(("base", format!("the samples have the times of {} of system {}", message.name, frame.system)));
        true
    }
}
