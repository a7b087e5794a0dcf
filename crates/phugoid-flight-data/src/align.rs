//! Puts signals of different rates on one time base, causally and without interpolation. Logs and live streams use the
//! same code.
//!
//! A value appears at the first base time at or after its own time stamp; values are not interpolated, and a sampled
//! value appears only once. The cost is a delay of at most one base step if the source delivers in time;
//! [`Aligner::statistics`] gives it.
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

/// Largest number of values of a channel that wait for their base time; the oldest is dropped beyond it. No base step
/// of a real flight holds nearly as many.
const MAX_WAITING: usize = 4096;

/// For how long a value of a channel is used.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Hold {
    /// A measurement: it appears once, at the first base time at or after its stamp; other base times get NaN.
    Sampled,
    /// A level that changes slowly or in steps (a surface position, a density): the last value is used until it is
    /// older than `stale_after_s`.
    Held {
        /// Largest age at which a value is still used, s.
        stale_after_s: f64,
    },
}

/// What alignment did to the values of one channel. Every finite value received is counted once: as shown, passed over,
/// too old, out of order or refused, unless it still waits for its base time.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Statistics {
    /// Finite values received by [`Aligner::put`].
    pub received: usize,
    /// Values that appeared at a base time; one that was held over several base times counts once.
    pub shown: usize,
    /// Values dropped because a newer one came within the same base step: the source is faster than the base.
    pub passed_over: usize,
    /// Values dropped because their stamp is not later than that of a value that had appeared already.
    pub out_of_order: usize,
    /// Values dropped because the next base time came too late: after the longest delay, or after they were stale.
    pub too_old: usize,
    /// Values that arrived after the base time at which they should have appeared. They are counted above as well:
    /// shown at the next base time, or dropped.
    pub late: usize,
    /// Values dropped because their stamp was NaN or infinite, or because too many values were waiting.
    pub refused: usize,
    /// Largest delay from the stamp of a value to the base time at which it appeared first, s.
    pub largest_delay_s: f64,
    /// Sum of these delays, s; divided by `shown` it is the mean delay.
    pub total_delay_s: f64,
}

/// Puts channels of different rates on the base times that the caller gives, usually those of the fastest channel.
#[derive(Clone, Debug)]
pub struct Aligner {
    channels: Vec<Channel>,
    base_s: f64,
    longest_delay_s: f64,
}

#[derive(Clone, Debug)]
struct Channel {
    hold: Hold,
    /// Stamps and values that no frame has taken yet, by rising stamp, all later than `shown_s`.
    waiting: VecDeque<(f64, f64)>,
    /// Stamp of the newest value that a frame has taken.
    shown_s: f64,
    held: f64,
    statistics: Statistics,
}

impl Aligner {
    /// An aligner with one channel per entry; channels are numbered in this order, from 0.
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

    /// Drops sampled values that would appear more than this time, s, after their stamp, because the base has a gap
    /// there. Without this call none is dropped for its age.
    pub fn with_longest_delay(mut self, longest_delay_s: f64) -> Self {
        self.longest_delay_s = longest_delay_s;
        self
    }

    /// Takes a value of the channel with this number and its time stamp, s. A value that is NaN or infinite means "no
    /// measurement" and ends a held value. An unknown channel number is ignored.
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
        // Nearly always 0: of a source that keeps the order no value has to be searched for.
        let behind = channel.waiting.iter().rev().take_while(|(stamp, _)| *stamp > time_s).count();
        channel.waiting.insert(channel.waiting.len() - behind, (time_s, value));
        if channel.waiting.len() > MAX_WAITING
            && let Some((_, lost)) = channel.waiting.pop_front()
        {
            channel.statistics.refused += usize::from(!lost.is_nan());
        }
    }

    /// Writes the values of all channels at a base time, s, into `out`, from values stamped at or before it; NaN where
    /// a channel has none.
    ///
    /// Base times have to rise. For one that does not, or is not finite, the aligner stays as it is, `out` is filled
    /// with NaN, and `false` is returned.
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

    /// Drops all waiting and held values and forgets the last base time, for a source whose clock has started again.
    /// The statistics are kept.
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

    /// The statistics of the channel with this number so far; `None` if there is no such channel.
    pub fn statistics(&self, channel: usize) -> Option<&Statistics> {
        self.channels.get(channel).map(|channel| &channel.statistics)
    }
}

impl Channel {
    fn at(&mut self, time_s: f64, longest_delay_s: f64) -> f64 {
        // The newest measurement appears; a NaN that follows it ends a held level only.
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
