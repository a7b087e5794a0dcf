//! The replay: a filter that has learnt its noise levels runs once again through what it has seen.
//!
//! What a filter believed in its first seconds, with noise levels that were wrong, stays in its covariance for ever. So
//! after 2, 4, 8, 16 and 32 s, and 4 s after the first motion, a second one starts again from the first sample with the
//! levels that the first has learnt by then, works off what has been flown some samples at a time, and takes its place
//! when it has caught up. No future data are used. Looking more often made the estimates of foreign flights worse.

use phugoid_estimators::levels::{LearntLevels, NoiseReport};
use phugoid_estimators::settings::EstimatorSettings;
use phugoid_estimators::{ChangeState, Estimate, Input, Sample};

use super::table::Boxed;
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

    /// Takes the sample that `estimator` has just taken, with the estimate that it gave. Gives the filter that takes its
    /// place, and its estimate, when that has caught up. `set_up` makes one with these settings.
    ///
    /// # Errors
    /// Those of `set_up`.
    #[allow(clippy::type_complexity)] // an estimator and its estimate: a name would not say more
    pub(super) fn take(
        &mut self,
        sample: &Sample<I, R>,
        estimate: &Estimate<P>,
        noise: impl FnOnce() -> Option<NoiseReport<R>>,
        settings: &EstimatorSettings<N, R, P>,
        set_up: impl FnOnce(&EstimatorSettings<N, R, P>) -> Result<Boxed<I, R, P>, EstimateError>,
    ) -> Result<Option<(Boxed<I, R, P>, Estimate<P>)>, EstimateError> {
        if self.looks_s.is_empty() && self.catching_up.is_none() {
            return Ok(None);
        }
        if self.samples.last().is_none_or(|last| sample.time_s > last.time_s) {
            self.samples.push(*sample);
        }
        let elapsed_s = sample.time_s - self.samples[0].time_s;
        let in_doubt = estimate.status.change == ChangeState::InDoubt;
        if self.catching_up.is_none() && !in_doubt && self.looks_s.first().is_some_and(|look_s| elapsed_s >= *look_s) {
            self.looks_s.retain(|look_s| elapsed_s < *look_s);
            let noise = noise();
            if let Some((report, learnt)) = noise.and_then(|report| Some((report, report.learnt?)))
                && self.last.as_ref().is_none_or(|last| has_moved(last, &report))
            {
                self.last = Some(report);
                let estimator = set_up(&with_known(settings, &report, learnt, sample.time_s))?;
                self.catching_up = Some(CatchingUp { estimator, next: 0, estimate: None });
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
            }
            let caught_up = second.next == self.samples.len() && !in_doubt;
            let estimate = second.estimate.filter(|e| caught_up && e.status.change != ChangeState::InDoubt);
            if let Some(estimate) = estimate
                && let Some(second) = self.catching_up.take()
            {
                self.done = true;
                if self.looks_s.is_empty() {
                    // Nothing will be worked off again.
                    self.samples = Vec::new();
                }
                return Ok(Some((second.estimator, estimate)));
            }
        }
        Ok(None)
    }
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
