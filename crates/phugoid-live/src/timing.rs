//! The sender's clock, judged against the arrival of the samples: whether a time goes on, goes back, leaps or stands
//! still.
//!
//! A sample cannot arrive before it was measured. So the difference of its time and its arrival cannot be larger than
//! that of the sample that travelled fastest so far, but for the drift of the two clocks and the jitter of the link. A
//! time that is further ahead, or that lies back, has leapt. It is left out, and only followed once samples that come
//! one after another agree with it for a while of arrival, with none of the former time between them.

use crate::document::seconds;

/// A time that is earlier than the last one by more than this, s, has leapt back; by less, the sample is late.
const RESTART_S: f64 = 1.0;
/// A leap ahead that is followed is a gap of the data up to this length, s; a longer one is another time scale.
const GAP_S: f64 = 60.0;
/// Samples in a row that have to agree on another time before it is followed.
const AGREEING: u32 = 3;
/// They have to come over this time of arrival, ns: packets of somebody else that come at once are not enough.
const AGREEING_NS: u64 = 250_000_000;
/// A sample may come earlier than the fastest before it by this, s: the jitter of a link.
const JITTER_S: f64 = 0.2;
/// ... or by so many intervals between samples, because a pipe gives many samples at once.
const JITTER_INTERVALS: f64 = 5.0;
/// Part by which the interval between samples is brought up to the newest one.
const INTERVAL_GAIN: f64 = 0.1;
/// By how much the clocks of sender and receiver may run apart; real clocks differ by less than a tenth of this.
const DRIFT: f64 = 1e-3;
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
    /// It has leapt against the arrival, and further samples have not confirmed it.
    Leap {
        /// How far it is from the time that was expected at its arrival, s; positive ahead.
        by_s: f64,
    },
    /// Further samples have confirmed a leap ahead of at most a minute: data are missing. The sample is used.
    Gap {
        /// Last time before the leap, s.
        from_s: f64,
    },
    /// Further samples have confirmed that the clock has another time than before. The sample is used.
    Restarted {
        /// Last time before the restart, s.
        from_s: f64,
        /// Time of arrival since the sample before the restart, ns.
        pause_ns: u64,
    },
}

/// Follows the clock of a sender from sample to sample.
#[derive(Clone, Debug, Default)]
pub(crate) struct SenderClock {
    followed: Option<Followed>,
    stalled: bool,
    leap: Option<Leap>,
}

/// The time that is followed.
#[derive(Clone, Copy, Debug)]
struct Followed {
    /// Time and arrival of the first sample since the start, or since the clock was set.
    first_s: f64,
    first_ns: u64,
    /// Time and arrival of the last sample with a new time.
    last_s: f64,
    last_ns: u64,
    /// Largest difference of time and arrival so far, s, less the drift that is possible since then.
    lead_s: f64,
    /// Usual interval between samples, s; unknown before the second sample.
    interval_s: Option<f64>,
}

/// A leap that is not confirmed yet.
#[derive(Clone, Copy, Debug)]
struct Leap {
    first_ns: u64,
    last_s: f64,
    last_ns: u64,
    count: u32,
}

impl Followed {
    fn begin(time_s: f64, arrival_ns: u64, interval_s: Option<f64>) -> Self {
        let lead_s = time_s - seconds(arrival_ns);
        Self { first_s: time_s, first_ns: arrival_ns, last_s: time_s, last_ns: arrival_ns, lead_s, interval_s }
    }

    /// How much earlier than the fastest before it a sample may come, s. Of the second sample nothing is known yet.
    fn jitter_s(&self) -> f64 {
        self.interval_s.map_or(GAP_S, |interval_s| JITTER_S.max(JITTER_INTERVALS * interval_s))
    }

    /// The latest time that a sample which comes now can have, s.
    fn latest_s(&self, arrival_ns: u64) -> f64 {
        seconds(arrival_ns) + self.lead_s + self.jitter_s()
    }

    /// The time that a sample has which comes now as fast as the last one did, s.
    fn expected_s(&self, arrival_ns: u64) -> f64 {
        self.last_s + seconds(arrival_ns.saturating_sub(self.last_ns))
    }

    fn advance(&mut self, time_s: f64, arrival_ns: u64) {
        let step_s = time_s - self.last_s;
        let drift_s = DRIFT * seconds(arrival_ns.saturating_sub(self.last_ns));
        self.lead_s = (self.lead_s - drift_s).max(time_s - seconds(arrival_ns));
        self.interval_s = Some(match self.interval_s {
            // A gap is no interval.
            Some(usual) => usual + INTERVAL_GAIN * (step_s.min(2.0 * usual) - usual),
            None => step_s,
        });
        (self.last_s, self.last_ns) = (time_s, arrival_ns);
    }

    /// Whether the samples come as they are measured. From a pipe they come as fast as they are read, and then their
    /// arrival says nothing about their time.
    fn keeps_pace(&self) -> bool {
        self.last_s - self.first_s <= 2.0 * seconds(self.last_ns.saturating_sub(self.first_ns)) + 1.0
    }
}

impl SenderClock {
    /// Whether a message with this time (s) that comes at `arrival_ns` can belong to the present samples: it has not
    /// leapt. True before the first sample.
    pub(crate) fn admits(&self, time_s: f64, arrival_ns: u64) -> bool {
        let within =
            |followed: &Followed| (followed.last_s - RESTART_S..=followed.latest_s(arrival_ns)).contains(&time_s);
        self.followed.as_ref().is_none_or(within)
    }

    /// By how much a time (s) is ahead of what a message that comes at `arrival_ns` can have, counted from the time that
    /// was expected, s; `None` if it is not.
    pub(crate) fn leads_by_s(&self, time_s: f64, arrival_ns: u64) -> Option<f64> {
        let followed = self.followed.as_ref().filter(|followed| time_s > followed.latest_s(arrival_ns))?;
        Some(time_s - followed.expected_s(arrival_ns))
    }

    /// Judges the time of a sample (s, finite) that arrived at `arrival_ns`.
    pub(crate) fn judge(&mut self, time_s: f64, arrival_ns: u64) -> Judgement {
        let Some(followed) = &mut self.followed else {
            self.followed = Some(Followed::begin(time_s, arrival_ns, None));
            return Judgement::Forward;
        };
        let step_s = time_s - followed.last_s;
        if step_s == 0.0 {
            if !self.stalled && arrival_ns.saturating_sub(followed.last_ns) > STALL_NS {
                self.stalled = true;
                return Judgement::Stalled;
            }
            return Judgement::Repeated;
        }
        if (-RESTART_S..0.0).contains(&step_s) {
            return Judgement::Late;
        }
        if step_s > 0.0 && time_s <= followed.latest_s(arrival_ns) {
            followed.advance(time_s, arrival_ns);
            (self.stalled, self.leap) = (false, None);
            return Judgement::Forward;
        }
        let by_s = time_s - followed.expected_s(arrival_ns);
        let leap = match self.leap {
            Some(leap) if time_s == leap.last_s => return Judgement::Leap { by_s },
            Some(leap) if leap.is_followed_by(time_s, arrival_ns, followed.jitter_s()) => {
                Leap { last_s: time_s, last_ns: arrival_ns, count: leap.count + 1, ..leap }
            }
            _ => Leap { first_ns: arrival_ns, last_s: time_s, last_ns: arrival_ns, count: 1 },
        };
        let lasts = arrival_ns.saturating_sub(leap.first_ns) >= AGREEING_NS || !followed.keeps_pace();
        if leap.count < AGREEING || !lasts {
            self.leap = Some(leap);
            return Judgement::Leap { by_s };
        }
        let before = *followed;
        *followed = Followed::begin(time_s, arrival_ns, before.interval_s);
        (self.stalled, self.leap) = (false, None);
        if (0.0..=GAP_S).contains(&step_s) {
            // How well it keeps pace is known from before.
            (followed.first_s, followed.first_ns) = (before.first_s, before.first_ns);
            return Judgement::Gap { from_s: before.last_s };
        }
        Judgement::Restarted { from_s: before.last_s, pause_ns: arrival_ns.saturating_sub(before.last_ns) }
    }
}

impl Leap {
    /// Whether a sample goes on from here, by the clock of the arrivals too.
    fn is_followed_by(&self, time_s: f64, arrival_ns: u64, jitter_s: f64) -> bool {
        let step_s = time_s - self.last_s;
        step_s > 0.0 && step_s <= seconds(arrival_ns.saturating_sub(self.last_ns)) + jitter_s
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A hundred samples a second whose time is their arrival and `from_s`.
    fn steady(clock: &mut SenderClock, from_s: f64, samples: std::ops::Range<u64>) -> Vec<Judgement> {
        samples.map(|k| clock.judge(from_s + 0.01 * k as f64, k * 10_000_000)).collect()
    }

    #[test]
    fn a_leap_alone_is_left_out_and_one_that_lasts_is_followed() {
        let mut clock = SenderClock::default();
        assert!(steady(&mut clock, 100.0, 0..200).iter().all(|judgement| *judgement == Judgement::Forward));
        for leap in [50.0, 0.5, 3.0, -3.0, -101.0, 1e9] {
            let judged = clock.judge(101.995 + leap, 1_995_000_000);
            let Judgement::Leap { by_s } = judged else { panic!("{leap}: {judged:?}") };
            assert!((by_s - leap).abs() < 0.02, "{by_s}");
            assert!(!clock.admits(101.995 + leap, 1_995_000_000) && clock.admits(101.995, 1_995_000_000));
        }
        assert_eq!(clock.judge(102.0, 2_000_000_000), Judgement::Forward);
        assert_eq!(clock.judge(101.5, 2_000_000_000), Judgement::Late);

        // The sender starts again.
        let judged = steady(&mut clock, -2.1, 210..300);
        let followed = judged.iter().position(|judgement| !matches!(judgement, Judgement::Leap { .. })).unwrap();
        assert_eq!(followed, 25, "{judged:?}");
        assert_eq!(judged[followed], Judgement::Restarted { from_s: 102.0, pause_ns: 350_000_000 });
        assert!(judged[followed + 1..].iter().all(|judgement| *judgement == Judgement::Forward));
    }

    #[test]
    fn packets_at_once_or_between_others_are_not_followed() {
        let mut clock = SenderClock::default();
        steady(&mut clock, 0.0, 0..200);
        // Ten at once, which agree with one another.
        for k in 0..10 {
            let judged = clock.judge(50.0 + 0.01 * f64::from(k), 1_995_000_000);
            assert!(matches!(judged, Judgement::Leap { .. }), "{judged:?}");
        }
        // One between any two samples.
        for k in 200..400_u64 {
            assert_eq!(clock.judge(0.01 * k as f64, k * 10_000_000), Judgement::Forward);
            let judged = clock.judge(30.0 + 0.01 * k as f64, k * 10_000_000 + 5_000_000);
            assert!(matches!(judged, Judgement::Leap { .. }), "{judged:?}");
        }
    }

    #[test]
    fn a_gap_that_the_arrivals_show_too_is_none_of_the_clock() {
        let mut clock = SenderClock::default();
        steady(&mut clock, 0.0, 0..200);
        // The link is lost for a minute and a half.
        assert_eq!(clock.judge(90.0, 90_000_000_000), Judgement::Forward);
        // A link that keeps its data back gives them late, all at once.
        let late: Vec<_> = (1..300_u32).map(|k| clock.judge(90.0 + 0.01 * f64::from(k), 93_000_000_000)).collect();
        assert!(late.iter().all(|judgement| *judgement == Judgement::Forward));
        // The clock of the sender runs a ten thousandth faster, for an hour.
        let drift = (0..3600_u64).map(|k| clock.judge(93.0 + 1.0001 * k as f64, 93_001_000_000 + k * 1_000_000_000));
        assert!(drift.skip(1).all(|judgement| judgement == Judgement::Forward));
    }

    #[test]
    fn a_pipe_keeps_no_pace() {
        let mut clock = SenderClock::default();
        for k in 0..1000 {
            assert_eq!(clock.judge(0.1 * f64::from(k), 7), Judgement::Forward);
        }
        let judged: Vec<_> = (0..4).map(|k| clock.judge(150.0 + 0.1 * f64::from(k), 7)).collect();
        assert!(matches!(judged[..2], [Judgement::Leap { .. }, Judgement::Leap { .. }]), "{judged:?}");
        assert_eq!(judged[2..], [Judgement::Gap { from_s: 99.9 }, Judgement::Forward]);
        // Seldom, and a few at a time.
        let mut clock = SenderClock::default();
        let seldom: Vec<_> = (0..50).map(|k| clock.judge(5.0 * f64::from(k), 7)).collect();
        assert!(seldom.iter().all(|judgement| *judgement == Judgement::Forward));
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
