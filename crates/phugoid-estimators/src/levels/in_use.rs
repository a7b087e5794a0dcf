//! The levels that the estimator uses, and when they follow what is learnt.

use super::NoiseReport;
use super::frame::Frame;
use super::likelihood::Likelihood;
use crate::settings::{LearntLevels, NoiseLearning};

/// The noise levels and the scales of the process noise in use, and how they are learnt.
#[derive(Clone, Copy, Debug)]
pub struct Levels<const N: usize, const R: usize> {
    /// One sigma per output, output units.
    pub(crate) std: [f64; R],
    /// Scale of each state's process noise; `None` where the filter adapts one of its own for all.
    scales: Option<[f64; N]>,
    likelihood: Option<Likelihood<N, R>>,
    /// Rows in succession beyond the limit of rejection, per output.
    beyond: [u8; R],
    /// Whether the next row of an output is borne with bounded influence where it lies beyond that limit.
    bears: [bool; R],
}

/// Rows of one output in succession that are rejected when they lie beyond the limit; from the next one on they have
/// bounded influence. A single outlier has none at all, and a level that is too small cannot reject a healthy sensor
/// for ever.
const REJECTED_IN_SUCCESSION: u8 = 2;

impl<const N: usize, const R: usize> Levels<N, R> {
    pub(crate) fn new(
        noise_std: [f64; R],
        learning: Option<&NoiseLearning<N, R>>,
        adapts_process_noise: bool,
        variance_per_s: &[f64; N],
        initial_scale: f64,
    ) -> Self {
        let likelihood = learning.map(|learning| {
            let scale = (!adapts_process_noise).then_some(initial_scale);
            Likelihood::new(&noise_std, learning, scale, *variance_per_s)
        });
        let mut levels = Self { std: noise_std, scales: None, likelihood, beyond: [0; R], bears: [false; R] };
        levels.take_over();
        levels
    }

    /// Takes the learnt levels into use.
    fn take_over(&mut self) {
        if let Some(likelihood) = &self.likelihood {
            let (std, scales) = likelihood.levels();
            for (to, from) in self.std.iter_mut().zip(std) {
                if *to > 0.0 && from.is_finite() {
                    *to = from;
                }
            }
            self.scales = Some(scales);
        }
    }

    /// Scale of each state's process noise: what is learnt, or the one that the filter adapts for all.
    pub(crate) fn scales(&self, own_scale: f64) -> [f64; N] {
        self.scales.unwrap_or([own_scale; N])
    }

    /// Variance that each state gains in `h` seconds.
    pub(crate) fn process_noise(&self, variance_per_s: &[f64; N], own_scale: f64, h: f64) -> [f64; N] {
        let scales = self.scales(own_scale);
        core::array::from_fn(|i| variance_per_s[i] * scales[i] * h)
    }

    /// True if the levels are learnt, and not as given.
    pub(crate) fn are_learnt(&self) -> bool {
        self.likelihood.is_some()
    }

    /// The state was started (again) with these variances.
    pub(crate) fn start_state(&mut self, variances: &[f64; N]) {
        self.beyond = [0; R];
        self.bears = [false; R];
        if let Some(likelihood) = &mut self.likelihood {
            likelihood.start_state(variances);
        }
    }

    /// The estimate is another one now: the learning filter's state goes on from its.
    pub(crate) fn forget_offsets(&mut self) {
        if let Some(likelihood) = &mut self.likelihood {
            likelihood.forget_offsets();
        }
    }

    /// Takes what the estimator has seen of a frame that ends an interval of this length, s. With `hold` the levels
    /// stay what they are and only the learning filter's state goes on. The limits are that of rejection, and that beyond which the
    /// filter does not use a row. `bursts` says of an output beyond the limit of rejection
    /// whether that is a short burst of outliers of its own.
    pub(crate) fn take(
        &mut self,
        frame: &Frame<N, R>,
        interval_s: f64,
        hold: bool,
        [rejection_limit, gate]: [f64; 2],
        bursts: impl Fn(usize) -> bool,
    ) {
        let Some(likelihood) = &mut self.likelihood else { return };
        for (i, xi) in frame.normalised.iter().enumerate() {
            if xi.is_finite() {
                self.beyond[i] = if xi.abs() > gate { self.beyond[i].saturating_add(1) } else { 0 };
            }
        }
        let bursts: [bool; R] = core::array::from_fn(|i| likelihood.is_calibrated() && bursts(i));
        self.bears = core::array::from_fn(|i| self.beyond[i] >= REJECTED_IN_SUCCESSION && !bursts[i]);
        let moved = likelihood.take(frame, interval_s, hold, rejection_limit, &bursts);
        if moved {
            self.take_over();
        }
    }

    /// Where levels are as given: opens the gate of the outputs that it has locked out.
    pub(crate) fn open(&mut self, locked_out: impl FnOnce() -> [bool; R]) {
        if self.likelihood.is_none() {
            self.bears = locked_out();
        }
    }

    /// Whether a row of an output beyond the limit of rejection is borne with bounded influence.
    pub(crate) fn bears(&self) -> [bool; R] {
        self.bears
    }

    /// What has been learnt, if anything is.
    pub(crate) fn learnt(&self) -> Option<LearntLevels<R>> {
        self.likelihood.as_ref().map(Likelihood::learnt)
    }

    /// Goes back to what was learnt at an earlier time.
    pub(crate) fn go_back(&mut self, learnt: &LearntLevels<R>) {
        if let Some(likelihood) = &mut self.likelihood {
            likelihood.go_back(learnt);
        }
        self.take_over();
    }

    pub(crate) fn report(&self) -> NoiseReport<R> {
        NoiseReport { std: self.std, learnt: self.learnt() }
    }
}
