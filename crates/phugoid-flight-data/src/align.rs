//! Signals of different rates on one time base, without inventing data: causal, and by the same code in a log and in a live stream.
//!
//! A value is shown at a base time not before its own stamp, never earlier, never between two values, and a sampled one once
//! only. What this costs is a delay, at most one step of the base where the source is prompt; [`Aligner::statistics`] states it.
//!
//! ```
//! use phugoid_flight_data::align::{Aligner, Hold};
//! let mut aligner = Aligner::new(&[Hold::Sampled, Hold::Held { stale_after_s: 0.5 }]);
//! aligner.put(0, 0.008, 1.5);
//! aligner.put(1, 0.008, 20.0);
//! let mut values = [0.0; 2];
//! aligner.frame(0.01, &mut values);
//! assert_eq!(values, [1.5, 20.0]);
//! aligner.frame(0.02, &mut values);
//! assert!(values[0].is_nan() && values[1] == 20.0); // no new sample, but the held value is not stale yet
//! ```

use std::collections::VecDeque;

use serde::Serialize;

/// Values per channel that may wait for their base time; beyond it the oldest goes. Far more than any base step holds.
const MOST_WAITING: usize = 4096;

/// How long a value of a channel may stand for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Hold {
    /// A measurement: it appears once, at the first base time not before its stamp; NaN elsewhere.
    Sampled,
    /// A level that lasts (a surface position, a density): the last value until it is older than this.
    Held {
        /// Greatest age of a value that is shown, s.
        stale_after_s: f64,
    },
}

/// What alignment did to one channel. Every finite value put is shown, passed over, too old or out of order, or still waiting.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Statistics {
    /// Finite values that were put.
    pub received: usize,
    /// Values that were shown; a held one counts once.
    pub shown: usize,
    /// Values passed over for a newer one of the same base step: the source is faster than the base.
    pub passed_over: usize,
    /// Values dropped because they were older than one that had been shown.
    pub out_of_order: usize,
    /// Values dropped because no base time came within the longest delay after their stamp, or they were stale when it came.
    pub too_old: usize,
    /// Values that arrived after the base time at which they belonged; shown at the next one, unless out of order or too old.
    pub late: usize,
    /// Values without a usable time (NaN, infinite), and those that overflowed the bounded memory.
    pub refused: usize,
    /// Greatest time from a value's stamp to its first showing, s.
    pub largest_delay_s: f64,
    /// Sum of these times over all values shown, s: over `shown` it is the mean delay.
    pub total_delay_s: f64,
}

/// Puts channels of different rates on the times of one of them.
#[derive(Clone, Debug)]
pub struct Aligner {
    channels: Vec<Channel>,
    base_s: f64,
    longest_delay_s: f64,
}

#[derive(Clone, Debug)]
struct Channel {
    hold: Hold,
    /// Stamp and value, by rising stamp, all later than `shown_s`.
    waiting: VecDeque<(f64, f64)>,
    /// Stamp of the newest value that a frame has taken.
    shown_s: f64,
    held: f64,
    statistics: Statistics,
}

impl Aligner {
    /// One entry per channel; channels are numbered in this order.
    pub fn new(channels: &[Hold]) -> Self {
        let channel = |&hold| Channel {
            hold,
            waiting: VecDeque::new(),
            shown_s: f64::NEG_INFINITY,
            held: f64::NAN,
            statistics: Statistics::default(),
        };
        let channels = channels.iter().map(channel).collect();
        Self { channels, base_s: f64::NEG_INFINITY, longest_delay_s: f64::INFINITY }
    }

    /// Drops sampled values that would be shown more than this after their stamp, s (the base has a gap there). Without it
    /// none is too old.
    pub fn with_longest_delay(mut self, longest_delay_s: f64) -> Self {
        self.longest_delay_s = longest_delay_s;
        self
    }

    /// Takes a value of one channel with its own stamp. A NaN is no measurement, and ends a held value. A number that is no
    /// channel is ignored.
    pub fn put(&mut self, channel: usize, time_s: f64, value: f64) {
        let base_s = self.base_s;
        let Some(channel) = self.channels.get_mut(channel) else { return };
        let counts = value.is_finite();
        channel.statistics.received += usize::from(counts);
        if !time_s.is_finite() {
            channel.statistics.refused += usize::from(counts);
            return;
        }
        if time_s <= channel.shown_s {
            channel.statistics.out_of_order += usize::from(counts);
            return;
        }
        channel.statistics.late += usize::from(counts && time_s <= base_s);
        let value = if counts { value } else { f64::NAN };
        // Nearly always at the end: sources that keep order cost no search.
        let behind = channel.waiting.iter().rev().take_while(|(stamp, _)| *stamp > time_s).count();
        channel.waiting.insert(channel.waiting.len() - behind, (time_s, value));
        if channel.waiting.len() > MOST_WAITING
            && let Some((_, lost)) = channel.waiting.pop_front()
        {
            channel.statistics.refused += usize::from(!lost.is_nan());
        }
    }

    /// The values of all channels at a base time, from what is stamped at or before it; NaN where there is none.
    ///
    /// Base times have to rise: for one that does not, nothing changes, everything in `out` is NaN, and the answer is `false`.
    pub fn frame(&mut self, time_s: f64, out: &mut [f64]) -> bool {
        out.fill(f64::NAN);
        if !time_s.is_finite() || time_s <= self.base_s {
            return false;
        }
        self.base_s = time_s;
        for (index, channel) in self.channels.iter_mut().enumerate() {
            let value = channel.at(time_s, self.longest_delay_s);
            if let Some(out) = out.get_mut(index) {
                *out = value;
            }
        }
        true
    }

    /// Forgets all values and times, for a source whose clock began anew. The statistics go on.
    pub fn restart(&mut self) {
        self.base_s = f64::NEG_INFINITY;
        for channel in &mut self.channels {
            let waiting = channel.waiting.iter().filter(|(_, value)| !value.is_nan()).count();
            channel.statistics.too_old += waiting;
            channel.waiting.clear();
            channel.shown_s = f64::NEG_INFINITY;
            channel.held = f64::NAN;
        }
    }

    /// What alignment did to a channel so far.
    pub fn statistics(&self, channel: usize) -> Option<&Statistics> {
        self.channels.get(channel).map(|channel| &channel.statistics)
    }
}

impl Channel {
    fn at(&mut self, time_s: f64, longest_delay_s: f64) -> f64 {
        // The newest that is a measurement is shown; a NaN after it ends a held level only.
        let mut newest: Option<(f64, f64)> = None;
        let mut ended = false;
        while let Some(&(stamp, value)) = self.waiting.front()
            && stamp <= time_s
        {
            self.waiting.pop_front();
            self.shown_s = stamp;
            ended = value.is_nan();
            if !ended {
                self.statistics.passed_over += usize::from(newest.is_some());
                newest = Some((stamp, value));
            }
        }
        match self.hold {
            Hold::Sampled => {
                let Some((stamp, value)) = newest else { return f64::NAN };
                if time_s - stamp > longest_delay_s {
                    self.statistics.too_old += 1;
                    return f64::NAN;
                }
                self.count_shown(time_s - stamp);
                value
            }
            Hold::Held { stale_after_s } => {
                if let Some((stamp, value)) = newest {
                    match ended || time_s - stamp > stale_after_s {
                        true => self.statistics.too_old += 1,
                        false => self.count_shown(time_s - stamp),
                    }
                    self.held = value;
                }
                if ended {
                    self.held = f64::NAN;
                }
                if time_s - self.shown_s > stale_after_s { f64::NAN } else { self.held }
            }
        }
    }

    fn count_shown(&mut self, delay_s: f64) {
        self.statistics.shown += 1;
        self.statistics.largest_delay_s = self.statistics.largest_delay_s.max(delay_s);
        self.statistics.total_delay_s += delay_s;
    }
}
