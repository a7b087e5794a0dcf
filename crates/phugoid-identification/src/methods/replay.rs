//! The replay: a filter that has learnt its noise levels runs once again through what it has seen.
//!
//! What a filter believed in its first seconds, with noise levels that were wrong, stays in its covariance for ever. So
//! after 2, 4, 8, 16 and 32 s, and 4 s after the first motion, a second one starts again from the first sample with the
//! levels that the first has learnt by then, works off what has been flown some samples at a time, and takes its place
//! when it has caught up. No future data are used. Looking more often made the estimates of foreign flights worse.
//!
//! The second filter looks for changes of the aircraft by itself. Where it has found fewer than the running one has adopted, either those
//! were none, or it has missed one, and then its parameters are a mixture of before and after with bounds that know nothing of it. What
//! came after the last adoption tells which: the one that has predicted it better stays.

use phugoid_estimators::levels::{LearntLevels, NoiseReport};
use phugoid_estimators::settings::EstimatorSettings;
use phugoid_estimators::{ChangeState, Estimate, Innovations, Input, Sample};

use super::table::Boxed;
use super::task::log_density;
use crate::core::error::EstimateError;

/// Times since the first sample at which a replay is looked at, s.
const LOOKS_S: [f64; 5] = [2.0, 4.0, 8.0, 16.0, 32.0];
/// Time after the first visible motion at which it is looked at once more, s.
const AFTER_MOTION_S: f64 = 4.0;
/// No replay later than this, s: it would have to keep and to work off more than that.
const LATEST_S: f64 = 66.0;
/// Samples that a second filter works off per update.
const CATCH_UP: usize = 8;
/// Ratio of a standard deviation to that of the last replay from which another one is worth it (0.5 in the logarithm
/// of the variance), and of a scale of the process noise.
const LEVEL_RATIO: f64 = 1.28;
const SCALE_RATIO: f64 = std::f64::consts::E;

/// A second filter that works off what has been flown.
struct CatchingUp<I: Input, const R: usize, const P: usize> {
    estimator: Boxed<I, R, P>,
    next: usize,
    /// How well it has predicted what came after the running filter's last adoption, nats.
    merit: f64,
    /// The estimate after the last sample it has taken.
    estimate: Option<Estimate<P>>,
}

/// The samples since the first one, and what has been made of them.
pub(super) struct Replay<I: Input, const N: usize, const R: usize, const P: usize> {
    samples: Vec<Sample<I, R>>,
    /// Samples before which columns were opened for a known change, by number, and these columns.
    opened: Vec<(usize, Vec<usize>)>,
    looks_s: Vec<f64>,
    last: Option<NoiseReport<R>>,
    catching_up: Option<CatchingUp<I, R, P>>,
    /// When the running filter last adopted a change, s; before any at minus infinity.
    adopted_s: f64,
    /// How well it has predicted what came after that, nats.
    merit: f64,
    /// A replay has been made.
    done: bool,
}

impl<I: Input, const N: usize, const R: usize, const P: usize> Replay<I, N, R, P> {
    pub(super) fn new() -> Self {
        Self {
            samples: Vec::new(),
            opened: Vec::new(),
            looks_s: LOOKS_S.to_vec(),
            last: None,
            catching_up: None,
            adopted_s: f64::NEG_INFINITY,
            merit: 0.0,
            done: false,
        }
    }

    /// True once the levels have been learnt and used from the beginning.
    pub(super) fn is_done(&self) -> bool {
        self.done
    }

    /// The first motion is seen at this time, s.
    pub(super) fn first_motion(&mut self, time_s: f64) {
        let Some(first) = self.samples.first() else { return };
        let look_s = time_s - first.time_s + AFTER_MOTION_S;
        if look_s <= LATEST_S && look_s > 2.0 * LOOKS_S[0] {
            self.looks_s.push(look_s);
            self.looks_s.sort_by(f64::total_cmp);
        }
    }

    /// These columns are opened for a known change before the next sample.
    pub(super) fn open(&mut self, columns: Vec<usize>) {
        self.opened.push((self.samples.len(), columns));
    }

    /// Takes the sample that the `running` filter has just taken, with the estimate that it gave. Gives the filter that takes its
    /// place, and its estimate, when that has caught up. `set_up` makes one with these settings.
    ///
    /// # Errors
    /// Those of `set_up`.
    #[allow(clippy::type_complexity)] // an estimator and its estimate: a name would not say more
    pub(super) fn take(
        &mut self,
        sample: &Sample<I, R>,
        estimate: &Estimate<P>,
        running: &Boxed<I, R, P>,
        settings: &EstimatorSettings<N, R, P>,
        set_up: impl FnOnce(&EstimatorSettings<N, R, P>) -> Result<Boxed<I, R, P>, EstimateError>,
    ) -> Result<Option<(Boxed<I, R, P>, Estimate<P>)>, EstimateError> {
        if self.looks_s.is_empty() && self.catching_up.is_none() {
            return Ok(None);
        }
        if self.samples.last().is_none_or(|last| sample.time_s > last.time_s) {
            self.samples.push(*sample);
        }
        if estimate.status.change == ChangeState::Adopted {
            self.begin_comparison(sample.time_s);
        } else if sample.time_s > self.adopted_s {
            self.merit += merit(running.innovations());
        }
        let elapsed_s = sample.time_s - self.samples[0].time_s;
        let in_doubt = estimate.status.change == ChangeState::InDoubt;
        if self.catching_up.is_none() && !in_doubt && self.looks_s.first().is_some_and(|look_s| elapsed_s >= *look_s) {
            self.looks_s.retain(|look_s| elapsed_s < *look_s);
            if let Some((report, learnt)) = running.noise().and_then(|report| Some((report, report.learnt?)))
                && self.last.as_ref().is_none_or(|last| has_moved(last, &report))
            {
                self.last = Some(report);
                let estimator = set_up(&with_known(settings, &report, learnt, sample.time_s))?;
                self.catching_up = Some(CatchingUp { estimator, next: 0, merit: 0.0, estimate: None });
            }
        }
        if let Some(second) = &mut self.catching_up {
            for _ in 0..CATCH_UP {
                let Some(sample) = self.samples.get(second.next) else { break };
                for (_, columns) in self.opened.iter().filter(|(before, _)| *before == second.next) {
                    second.estimator.reopen_columns_now(columns);
                }
                second.estimate = Some(second.estimator.update(sample));
                second.next += 1;
                if sample.time_s > self.adopted_s {
                    second.merit += merit(second.estimator.innovations());
                }
            }
            let caught_up = second.next == self.samples.len() && !in_doubt;
            let estimate = second.estimate.filter(|e| caught_up && e.status.change != ChangeState::InDoubt);
            if let Some(estimate) = estimate
                && let Some(second) = self.catching_up.take()
            {
                if self.looks_s.is_empty() {
                    // Nothing will be worked off again.
                    self.samples = Vec::new();
                }
                if adoptions(&second.estimator) < adoptions(running) && second.merit < self.merit {
                    return Ok(None);
                }
                self.done = true;
                self.begin_comparison(sample.time_s);
                return Ok(Some((second.estimator, estimate)));
            }
        }
        Ok(None)
    }

    /// What came before this time (s) does not count in the comparison of two filters. A second one has not seen it yet.
    fn begin_comparison(&mut self, time_s: f64) {
        self.adopted_s = time_s;
        self.merit = 0.0;
        if let Some(second) = &mut self.catching_up {
            second.merit = 0.0;
        }
    }
}

/// Changes that a filter has adopted and not taken back.
pub(super) fn adoptions<I: Input, const R: usize, const P: usize>(of: &Boxed<I, R, P>) -> u32 {
    of.detector().map_or(0, |detector| detector.adoptions)
}

/// How well a frame was predicted, nats.
fn merit<const R: usize>(innovations: &Innovations<R>) -> f64 {
    log_density(innovations).iter().filter(|nats| nats.is_finite()).sum()
}

/// Settings for a filter that uses what was learnt until `until_s` as it is, and goes on learning from there.
fn with_known<const N: usize, const R: usize, const P: usize>(
    settings: &EstimatorSettings<N, R, P>,
    report: &NoiseReport<R>,
    learnt: LearntLevels<R>,
    until_s: f64,
) -> EstimatorSettings<N, R, P> {
    let mut own = *settings;
    for (own, learnt) in own.noise_std.iter_mut().zip(report.std) {
        if *own > 0.0 && learnt.is_finite() {
            *own = learnt;
        }
    }
    if let Some(learning) = &mut own.noise_learning {
        learning.known = Some((learnt, until_s));
    }
    own
}

fn has_moved<const R: usize>(last: &NoiseReport<R>, now: &NoiseReport<R>) -> bool {
    let beyond = |(a, b): (&f64, &f64)| *a > LEVEL_RATIO * b || *b > LEVEL_RATIO * a;
    let scales = last.learnt.zip(now.learnt).map_or(1.0, |(last, now)| last.largest_scale_ratio(&now));
    scales > SCALE_RATIO || last.std.iter().zip(&now.std).any(beyond)
}

#[cfg(test)]
mod tests {
    use phugoid_estimators::settings::ParameterPrior;
    use phugoid_estimators::{DetectorReport, Estimator, Inspect, Status};

    use super::*;

    /// A filter whose innovations are always these, and which has adopted so many changes.
    struct Filter {
        innovations: Innovations<1>,
        adoptions: u32,
        change: ChangeState,
    }

    impl Filter {
        fn boxed(innovation: f64, adoptions: u32) -> Boxed<[f64; 1], 1, 1> {
            let innovations = Innovations {
                predicted: [0.0],
                normalised: [innovation],
                whitened: [innovation],
                variance: [1.0],
                phase: [phugoid_estimators::RowPhase::Sliding],
            };
            Box::new(Self { innovations, adoptions, change: ChangeState::Steady })
        }
    }

    impl Estimator<1, 1> for Filter {
        type Input = [f64; 1];

        fn update(&mut self, sample: &Sample<[f64; 1], 1>) -> Estimate<1> {
            estimate(sample.time_s, self.change)
        }

        fn covariance(&self, _: &mut [[f64; 1]; 1]) {}
    }

    impl Inspect<1, 1> for Filter {
        fn column_count(&self) -> usize {
            1
        }

        fn prior_std(&self) -> &[f64; 1] {
            &[1.0]
        }

        fn innovations(&self) -> &Innovations<1> {
            &self.innovations
        }

        fn detector(&self) -> Option<DetectorReport> {
            Some(DetectorReport { adoptions: self.adoptions, ..DetectorReport::default() })
        }
    }

    fn estimate(time_s: f64, change: ChangeState) -> Estimate<1> {
        Estimate {
            time_s,
            parameters: [0.0],
            std_error: [1.0],
            corrected_std_error: [1.0],
            observability: [0.0],
            parameter_status: [phugoid_estimators::ParameterStatus::Improving],
            status: Status { change, ..Status::default() },
        }
    }

    /// Whether a second filter takes the place of a running one that has adopted a change at 1 s; each is given by its innovation and by
    /// the changes that it has found. Before the change the second one predicts worse, which does not count.
    fn takes_its_place(running: (f64, u32), second: (f64, u32)) -> bool {
        let mut replay = Replay::<[f64; 1], 1, 1, 1>::new();
        replay.looks_s.clear();
        let catching_up = |innovation| CatchingUp {
            estimator: Filter::boxed(innovation, second.1),
            next: 0,
            merit: 0.0,
            estimate: None,
        };
        let settings = EstimatorSettings::automatic(&[ParameterPrior::bounded(0.0, -1.0, 1.0)], [1.0], 0.1).unwrap();
        let running = Filter::boxed(running.0, running.1);
        for k in 0..40 {
            let sample = Sample { time_s: 0.1 * f64::from(k), input: [0.0], outputs: [0.0] };
            if k == 0 {
                replay.catching_up = Some(catching_up(3.0));
                // As if it had much to work off: it sees the present from the end on.
                replay.samples = vec![sample; 150];
                for (k, old) in replay.samples.iter_mut().enumerate() {
                    old.time_s = -15.0 + 0.1 * k as f64;
                }
            }
            let change = if k == 10 { ChangeState::Adopted } else { ChangeState::Steady };
            if k == 11
                && let Some(catching) = &mut replay.catching_up
            {
                catching.estimator = Filter::boxed(second.0, second.1);
            }
            let found = replay.take(&sample, &estimate(sample.time_s, change), &running, &settings, |_| unreachable!());
            if replay.catching_up.is_none() {
                assert!(k > 15, "caught up at {k}");
                return found.unwrap().is_some();
            }
        }
        panic!("it did not catch up");
    }

    /// A filter that has not found a change takes the place of one that has only where it predicts better without it.
    #[test]
    fn an_adopted_change_is_not_forgotten() {
        assert!(!takes_its_place((1.0, 1), (2.0, 0)));
        assert!(takes_its_place((2.0, 1), (1.0, 0)));
        // Of as many changes or more nothing is asked: noise levels that were learnt are the better ones.
        assert!(takes_its_place((1.0, 1), (2.0, 1)) && takes_its_place((1.0, 0), (2.0, 1)));
    }
}
