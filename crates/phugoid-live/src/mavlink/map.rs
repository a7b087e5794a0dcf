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
use super::signing::Key;
use crate::event::LiveEventKind;
use crate::link::Counts;
use crate::timing::SenderClock;
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
    /// The key with which every frame has to be signed. `None` verifies no signature.
    pub key: Option<Key>,
}

impl Default for MavlinkOptions {
    fn default() -> Self {
        Self { reorder_ns: 4_000_000, system: None, base: None, key: None }
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

/// Messages of one kind and component in a row whose stamps have to speak for it before they count as those of another
/// clock, or no longer, ...
const ANOTHER_CLOCK_IN_A_ROW: u8 = 5;
/// ... and the time of arrival over which they have to come, ns.
const ANOTHER_CLOCK_NS: u64 = 1_000_000_000;

/// Who sent a message: number of the sender among those of the source, system and component of MAVLink.
pub(crate) type Component = (u16, u8, u8);

/// The time of a sample that need not wait any more.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Ready {
    pub(crate) time_s: f64,
    pub(crate) arrival_ns: u64,
    /// Who sent the message of the time base.
    pub(crate) component: Component,
}

/// A message of the time base that waits for messages sent before it.
#[derive(Clone, Copy, Debug)]
struct Waiting {
    component: Component,
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
    sequences: HashMap<Component, Sequence>,
    /// Of which kinds of messages the stamps are of another clock, by component and message.
    clocks: HashMap<(Component, u32), StampClock>,
    /// Before there is a time base: who gave the values so far; `Err` if several did.
    gave: Option<Result<(u16, u8), ()>>,
    waiting: VecDeque<Waiting>,
    base: Base,
    /// Stamp of the newest message of the time base, s.
    newest_s: Option<f64>,
    /// Frames that looked like duplicates since the last one in order. If the sender turns out to have been restarted,
    /// they were none.
    provisional_duplicates: u64,
}

/// The clock of the stamps of one kind of messages.
#[derive(Clone, Copy, Debug, Default)]
struct StampClock {
    /// It is another one than that of the time base.
    another: bool,
    /// Messages in a row that spoke against that, and the arrival of the first of them, ns.
    contrary: u8,
    since_ns: u64,
}

/// What the stamp of a message that is not the time base means.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Stamp {
    /// It is a time of the time base's clock.
    Same(f64),
    /// It is one of another clock.
    Another,
    /// It is so far ahead of the time base.
    Leap(f64),
}

/// Which message is the time base. Each is a rank among the possible ones (0 is best) and who sends it.
#[derive(Clone, Copy, Debug, Default)]
struct Base {
    /// The time base, once it is decided.
    chosen: Option<(usize, Component)>,
    /// The best that has come so far, before it is decided.
    best: Option<(usize, Component)>,
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
            clocks: HashMap::new(),
            gave: None,
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

    /// Takes a frame. `clock` is that of the samples, by which the stamps are judged. Counts go to `counts`, events for
    /// people to `events`.
    pub(crate) fn take(
        &mut self,
        frame: &Frame<'_>,
        origin: u16,
        arrival_ns: u64,
        clock: &SenderClock,
        counts: &mut Counts,
        events: &mut Vec<(LiveEventKind, String)>,
    ) {
        let component: Component = (origin, frame.system, frame.component);
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
        let base = self.is_base(message, frame, component, arrival_ns, events);
        if !self.is_wanted(component) {
            return;
        }
        let stamp_s = rules::stamp_s(message, frame.payload);
        if base && let Some(time_s) = stamp_s {
            let ready = Ready { time_s, arrival_ns, component };
            self.queue(Waiting { component, index: place.index, ready });
            if !clock.admits(time_s, arrival_ns) {
                // Whether the leap is followed is decided when the sample need not wait any more. Until then neither
                // its time nor its values may mix with those of the others.
                return;
            }
            self.newest_s = Some(time_s);
        } else if !base && self.base.chosen.is_some_and(|(rank, _)| self.is_named(rank, message)) {
            counts.refused += 1;
            events.push((
                LiveEventKind::Refused,
                format!("{} of component {} too: only those of the time base are used", message.name, frame.component),
            ));
            return;
        }
        // A message without a time, or with the time of another clock, counts as sampled at the newest time base.
        let stamp_s = match (stamp_s, self.newest_s) {
            (Some(stamp), Some(newest)) if !base => {
                match self.stamp((component, frame.id), stamp, newest, clock.leads_by_s(stamp, arrival_ns), arrival_ns)
                {
                    Stamp::Same(stamp) => stamp,
                    Stamp::Another => newest,
                    Stamp::Leap(by_s) => {
                        counts.leaps += 1;
                        let text = format!("{} stamped {by_s:.3} s ahead of the samples: left out", message.name);
                        events.push((LiveEventKind::Leap, text));
                        return;
                    }
                }
            }
            (Some(stamp), _) => stamp,
            (None, Some(newest)) => newest,
            (None, None) => return,
        };
        if self.base.best.is_none() {
            let this = (origin, frame.system);
            self.gave = Some(match self.gave {
                None => Ok(this),
                Some(Ok(other)) if other == this => Ok(this),
                Some(_) => Err(()),
            });
        }
        let aligner = &mut self.aligner;
        self.rules.read(message, frame.payload, stamp_s, &mut |Reading { channel, value }| {
            aligner.put(channel, stamp_s, value);
        });
    }

    /// What a stamp means that is `lead_s` ahead of the latest time which a sample can have (`None`: it is not ahead).
    /// A kind of messages has another clock if its first stamp is far from the time base, and keeps it until several in
    /// a row say otherwise.
    fn stamp(
        &mut self,
        kind: (Component, u32),
        stamp_s: f64,
        newest_s: f64,
        lead_s: Option<f64>,
        arrival_ns: u64,
    ) -> Stamp {
        let another = (stamp_s - newest_s).abs() > ANOTHER_CLOCK_S;
        let is_full = self.clocks.len() >= MOST_COMPONENTS * 16 && !self.clocks.contains_key(&kind);
        let mut fresh = StampClock { another, contrary: 0, since_ns: arrival_ns };
        let clock = if is_full { &mut fresh } else { self.clocks.entry(kind).or_insert(fresh) };
        if clock.another == another {
            clock.contrary = 0;
        } else {
            clock.since_ns = if clock.contrary == 0 { arrival_ns } else { clock.since_ns };
            clock.contrary = clock.contrary.saturating_add(1);
        }
        let lasts = arrival_ns.saturating_sub(clock.since_ns) >= ANOTHER_CLOCK_NS;
        if clock.contrary >= ANOTHER_CLOCK_IN_A_ROW && lasts {
            *clock = StampClock { another, contrary: 0, since_ns: arrival_ns };
        }
        match (clock.another, lead_s) {
            (true, _) => Stamp::Another,
            (false, Some(by_s)) => Stamp::Leap(by_s),
            (false, None) => Stamp::Same(stamp_s),
        }
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

    /// Forgets the sequence numbers and values from before a restart of the sender's clock, which shows `time_s` now.
    /// Samples that wait have the new time and stay.
    pub(crate) fn restart(&mut self, time_s: f64, counts: &mut Counts) {
        self.aligner.restart();
        self.clocks.clear();
        self.newest_s = Some(time_s);
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

    /// Whether messages of this sender and vehicle are used.
    fn is_wanted(&self, (origin, system, _): Component) -> bool {
        let is_asked_for = self.options.system.is_none_or(|wanted| wanted == system);
        let base = self.base.chosen.or(self.base.best);
        is_asked_for && base.is_none_or(|(_, (from, vehicle, _))| (from, vehicle) == (origin, system))
    }

    /// Whether a message is that of this rank among the possible time bases.
    fn is_named(&self, rank: usize, message: &Message) -> bool {
        self.options.base.as_ref().or_else(|| self.bases.get(rank)).is_some_and(|base| base == message.name)
    }

    /// Whether this message is the time base. Chooses one where there is none.
    fn is_base(
        &mut self,
        message: &Message,
        frame: &Frame<'_>,
        component: Component,
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
        let this = (rank, component);
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
            // Values of others that came before are not those of this vehicle.
            let (origin, system, _) = component;
            if self.gave.take().is_some_and(|gave| gave != Ok((origin, system))) {
                self.aligner.restart();
            }
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
