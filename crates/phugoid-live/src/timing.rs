//! The sender's clock: whether the time of a sample goes on, goes back or stands still.

/// A time that is earlier than the last one by more than this, s, means that the sender was restarted; by less, that
/// the sample is late.
const RESTART_S: f64 = 1.0;
/// A time that is later than the last one by more than this, s, is taken for another time scale and not for a gap.
const AHEAD_S: f64 = 60.0;
/// Samples in a row that have to agree on another time scale before it is accepted, because a single time may be
/// damaged.
const AGREEING: u8 = 3;
/// The clock counts as standing still if the time is the same for this long, ns of arrival, while samples arrive.
const STALL_NS: u64 = 1_000_000_000;

/// What the time of a sample means.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Judgement {
    /// It is later than the last one. The sample is used.
    Forward,
    /// It equals the last one.
    Repeated,
    /// It has equalled the last one for so long that the clock stands still. Given once until the clock moves again.
    Stalled,
    /// It is a little earlier than the last one.
    Late,
    /// It is far from the last one, and not yet confirmed by further samples.
    Doubtful,
    /// Further samples have confirmed that the clock has another time than before. The sample is used.
    Restarted {
        /// Last time before the restart, s.
        from_s: f64,
    },
}

/// Follows the clock of a sender from sample to sample.
#[derive(Clone, Debug, Default)]
pub(crate) struct SenderClock {
    last_s: Option<f64>,
    /// Arrival of the last sample with a new time, ns.
    advanced_ns: u64,
    stalled: bool,
    /// Last time that is not yet confirmed, s, and how many samples agree with it.
    doubtful: Option<(f64, u8)>,
}

impl SenderClock {
    /// Judges the time of a sample (s, finite) that arrived at `arrival_ns`.
    pub(crate) fn judge(&mut self, time_s: f64, arrival_ns: u64) -> Judgement {
        let Some(last_s) = self.last_s else { return self.advance(time_s, arrival_ns) };
        let step = time_s - last_s;
        if step == 0.0 {
            if !self.stalled && arrival_ns.saturating_sub(self.advanced_ns) > STALL_NS {
                self.stalled = true;
                return Judgement::Stalled;
            }
            return Judgement::Repeated;
        }
        if (-RESTART_S..=AHEAD_S).contains(&step) {
            if step < 0.0 {
                return Judgement::Late;
            }
            return self.advance(time_s, arrival_ns);
        }
        let agreeing = match self.doubtful {
            Some((before, count)) if time_s > before && time_s - before <= AHEAD_S => count + 1,
            Some((before, count)) if time_s == before => count,
            _ => 1,
        };
        if agreeing < AGREEING {
            self.doubtful = Some((time_s, agreeing));
            return Judgement::Doubtful;
        }
        self.advance(time_s, arrival_ns);
        Judgement::Restarted { from_s: last_s }
    }

    fn advance(&mut self, time_s: f64, arrival_ns: u64) -> Judgement {
        *self = Self { last_s: Some(time_s), advanced_ns: arrival_ns, stalled: false, doubtful: None };
        Judgement::Forward
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_restart_is_believed_when_three_samples_agree() {
        let mut clock = SenderClock::default();
        for k in 0..100 {
            assert_eq!(clock.judge(0.01 * f64::from(k), 0), Judgement::Forward);
        }
        assert_eq!(clock.judge(1e9, 0), Judgement::Doubtful, "one damaged time");
        assert_eq!(clock.judge(1.0, 0), Judgement::Forward);
        assert_eq!(clock.judge(0.5, 0), Judgement::Late);
        assert_eq!(clock.judge(5.0, 0), Judgement::Forward, "a gap");
        assert_eq!(clock.judge(0.01, 0), Judgement::Doubtful);
        assert_eq!(clock.judge(0.02, 0), Judgement::Doubtful);
        assert_eq!(clock.judge(0.03, 0), Judgement::Restarted { from_s: 5.0 });
        assert_eq!(clock.judge(0.04, 0), Judgement::Forward);
    }

    #[test]
    fn a_clock_that_stands_still_is_said_once() {
        let mut clock = SenderClock::default();
        clock.judge(1.0, 0);
        let said: Vec<Judgement> = (1..40).map(|k| clock.judge(1.0, k * 100_000_000)).collect();
        assert_eq!(said.iter().filter(|judgement| **judgement == Judgement::Stalled).count(), 1);
        assert!(said.iter().all(|judgement| [Judgement::Stalled, Judgement::Repeated].contains(judgement)));
        assert_eq!(clock.judge(1.1, 5_000_000_000), Judgement::Forward);
    }
}
