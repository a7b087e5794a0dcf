//! From messages to samples: which message gives the times of the samples, and which field is which channel.

mod conversion;
mod rules;

use std::collections::{HashMap, VecDeque};

use phugoid_flight_data::align::{Aligner, Hold};
use phugoid_flight_data::csv::ColumnMapping;
use phugoid_flight_data::profile::Profile;

use super::definitions::{self, Message};
use super::frame::Frame;
use super::sequence::{Order, Sequence};
use crate::event::LiveEventKind;
use crate::link::Counts;
use rules::{Reading, Rules};

/// Options of the reception of MAVLink.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MavlinkOptions {
    /// How long a sample waits for messages that were sent before its time base and have not come, ns; 0 switches
    /// waiting off.
    pub reorder_ns: u64,
    /// Number of the vehicle whose messages are used; `None` takes the first that sends a time base.
    pub system: Option<u8>,
    /// Name of the message whose times are those of the samples (the time base); `None` takes the best one of the
    /// profile that comes within a second.
    pub base: Option<String>,
}

impl Default for MavlinkOptions {
    fn default() -> Self {
        Self { reorder_ns: 4_000_000, system: None, base: None }
    }
}

/// A better time base is waited for this long, ns, and a time base that is silent for this long is replaced.
const CHOICE_NS: u64 = 1_000_000_000;
/// A stamp that differs from the time base by more than this, s, is of another clock; the message then counts as
/// sampled when it came.
const ANOTHER_CLOCK_S: f64 = 3600.0;
/// Samples that may wait at one time. With the default window and 400 samples per second there are two.
const MOST_WAITING: usize = 4096;
/// Components whose sequence numbers are followed; messages of further ones are ignored.
const MOST_COMPONENTS: usize = 256;

/// The time of a sample that need not wait any more.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Ready {
    pub(crate) time_s: f64,
    pub(crate) arrival_ns: u64,
}

/// A message of the time base that waits for messages sent before it.
#[derive(Clone, Copy, Debug)]
struct Waiting {
    component: (u16, u8, u8),
    index: u64,
    ready: Ready,
}

/// Puts messages together into samples.
pub(crate) struct Assembler {
    options: MavlinkOptions,
    /// Names of the messages that can be the time base, the best first.
    bases: Vec<String>,
    rules: Rules,
    aligner: Aligner,
    sequences: HashMap<(u16, u8, u8), Sequence>,
    waiting: VecDeque<Waiting>,
    base: Base,
    /// Stamp of the newest message of the time base, s.
    newest_s: Option<f64>,
    /// Frames that looked like duplicates since the last one in order. If the sender turns out to have been restarted,
    /// they were none.
    provisional_duplicates: u64,
}

/// Which message is the time base. Each is a rank among the possible ones (0 is best) and the number of the vehicle.
#[derive(Clone, Copy, Debug, Default)]
struct Base {
    /// The time base, once it is decided.
    chosen: Option<(usize, u8)>,
    /// The best that has come so far, before it is decided.
    best: Option<(usize, u8)>,
    /// Arrival of the first possible one, ns.
    since_ns: u64,
    /// Last arrival of the chosen one, ns.
    heard_ns: u64,
}

impl Assembler {
    /// An assembler for these channels. The first `asked` of them are those of the samples; the rest serve to compute
    /// the true airspeed.
    ///
    /// # Errors
    /// A sentence for people: a mapping to a field that the message does not have, a unit that does not suit the
    /// channel, or a time base that is no message with a time.
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
            provisional_duplicates: 0,
        })
    }

    /// Warnings for people about the column mappings of the model file.
    pub(crate) fn warnings(&self) -> Vec<String> {
        self.rules.warnings.clone()
    }

    /// Takes a frame. Counts go to `counts`, events for people to `events`.
    pub(crate) fn take(
        &mut self,
        frame: &Frame<'_>,
        origin: u16,
        arrival_ns: u64,
        counts: &mut Counts,
        events: &mut Vec<(LiveEventKind, String)>,
    ) {
        let component = (origin, frame.system, frame.component);
        if !self.sequences.contains_key(&component) && self.sequences.len() >= MOST_COMPONENTS {
            return;
        }
        let place = self.sequences.entry(component).or_default().take(frame.sequence, arrival_ns);
        match place.order {
            Order::Next => self.provisional_duplicates = 0,
            Order::After(missing) => {
                counts.lost += missing;
                self.provisional_duplicates = 0;
            }
            Order::Reordered => {
                counts.lost = counts.lost.saturating_sub(1);
                counts.reordered += 1;
            }
            Order::Duplicate => {
                counts.duplicated += 1;
                self.provisional_duplicates += 1;
            }
        }
        let Some(message) = definitions::messages().get(&frame.id) else { return };
        let base = self.is_base(message, frame, arrival_ns, events);
        if !self.is_wanted(frame.system) {
            return;
        }
        let stamp_s = rules::stamp_s(message, frame.payload);
        if base && let Some(time_s) = stamp_s {
            self.newest_s = Some(time_s);
            self.queue(Waiting { component, index: place.index, ready: Ready { time_s, arrival_ns } });
        }
        // A message without a time, or with the time of another clock, counts as sampled at the newest time base.
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

    /// The next sample that need not wait any longer at this time, ns; `None` if there is none.
    pub(crate) fn ready(&mut self, now_ns: u64) -> Option<Ready> {
        let first = self.waiting.front()?;
        let since_ns = now_ns.saturating_sub(self.options.reorder_ns).saturating_add(1);
        let sequence = self.sequences.get(&first.component);
        if sequence.is_some_and(|sequence| sequence.latest_gap(first.index, since_ns).is_some()) {
            return None;
        }
        self.waiting.pop_front().map(|waiting| waiting.ready)
    }

    /// The time at which [`Assembler::ready`] will give a sample if nothing arrives before, ns; `None` if no sample
    /// waits.
    pub(crate) fn deadline_ns(&self) -> Option<u64> {
        let first = self.waiting.front()?;
        let shown = self.sequences.get(&first.component)?.latest_gap(first.index, 0)?;
        Some(shown.saturating_add(self.options.reorder_ns))
    }

    /// Fills in the values of a sample, SI; NaN where a value is missing.
    pub(crate) fn frame(&mut self, time_s: f64, values: &mut [f64]) {
        self.aligner.frame(time_s, values);
    }

    /// Forgets the sequence numbers and values from before a restart of the sender's clock. Samples that wait have the
    /// new time and stay.
    pub(crate) fn restart(&mut self, counts: &mut Counts) {
        self.aligner.restart();
        counts.duplicated = counts.duplicated.saturating_sub(self.provisional_duplicates);
        self.provisional_duplicates = 0;
        let waiting: Vec<_> = self.waiting.iter().map(|waiting| waiting.component).collect();
        self.sequences.retain(|component, _| waiting.contains(component));
    }

    /// Forgets the sequence numbers of a sender whose connection begins again.
    pub(crate) fn forget(&mut self, origin: u16) {
        self.sequences.retain(|(from, ..), _| *from != origin);
    }

    /// Inserts a message of the time base in the order in which its component sent it.
    fn queue(&mut self, new: Waiting) {
        let same = |other: &Waiting| other.component == new.component && other.index > new.index;
        let behind = self.waiting.iter().rev().take_while(|other| same(other)).count();
        self.waiting.insert(self.waiting.len() - behind, new);
        if self.waiting.len() > MOST_WAITING {
            self.waiting.pop_front();
        }
    }

    /// Whether messages of this vehicle are used.
    fn is_wanted(&self, system: u8) -> bool {
        match (self.options.system, self.base.chosen.or(self.base.best)) {
            (Some(wanted), _) => system == wanted,
            (None, Some((_, vehicle))) => system == vehicle,
            (None, None) => true,
        }
    }

    /// Whether this message is the time base. Chooses one where there is none.
    fn is_base(
        &mut self,
        message: &Message,
        frame: &Frame<'_>,
        arrival_ns: u64,
        events: &mut Vec<(LiveEventKind, String)>,
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
        events.push((
            LiveEventKind::Base,
            format!("the samples have the times of {} of system {}", message.name, frame.system),
        ));
        true
    }
}
