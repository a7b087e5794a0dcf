//! The levels that the estimator uses, and when they follow what the shadows learn.

use super::NoiseReport;
use super::bank::{Bank, Frame};
use crate::settings::{LearntLevels, NoiseLearning};

/// The noise levels and the scale of the process noise in use, and how they are learnt.
#[derive(Clone, Copy, Debug)]
pub struct Levels<const N: usize, const R: usize> {
    /// One sigma per output, output units.
    pub(crate) std: [f64; R],
    /// Scale of the process noise; `None` where the filter adapts its own.
    pub(crate) scale: Option<f64>,
    bank: Option<Bank<N, R>>,
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
        learning: Option<&NoiseLearning<R>>,
        adapts_process_noise: bool,
        variance_per_s: &[f64; N],
        initial_scale: f64,
    ) -> Self {
        let bank = learning.map(|learning| {
            let scale = (!adapts_process_noise).then_some(initial_scale);
            Bank::new(&noise_std, learning, scale, *variance_per_s)
        });
        let mut levels = Self { std: noise_std, scale: None, bank, beyond: [0; R], bears: [false; R] };
        levels.take_over();
        levels
    }

    /// Takes the weighted levels of the bank into use.
    fn take_over(&mut self) {
        if let Some(bank) = &self.bank {
            let (std, scale) = bank.weighted();
            for (to, from) in self.std.iter_mut().zip(std) {
                if *to > 0.0 && from.is_finite() {
                    *to = from;
                }
            }
            self.scale = Some(scale);
        }
    }

    /// True if the levels are learnt, and not as given.
    pub(crate) fn are_learnt(&self) -> bool {
        self.bank.is_some()
    }

    /// The state was started (again) with these variances.
    pub(crate) fn start_state(&mut self, variances: &[f64; N]) {
        self.beyond = [0; R];
        self.bears = [false; R];
        if let Some(bank) = &mut self.bank {
            bank.start_state(variances);
        }
    }

    /// The estimate is another one now: the shadows' states start from its.
    pub(crate) fn forget_offsets(&mut self) {
        if let Some(bank) = &mut self.bank {
            bank.forget_offsets();
        }
    }

    /// Takes what the estimator has seen of a frame that ends an interval of this length, s. With `hold` the levels
    /// stay what they are and only the shadows' states go on. The limits are that of rejection, and that beyond which the
    /// filter does not use a row. `bursts` says of an output beyond the limit of rejection
    /// whether that is a short burst of outliers of its own. `state_covariance` gives the estimator's own covariance of
    /// the state given the parameters: shadows that begin now start from it.
    pub(crate) fn take(
        &mut self,
        frame: &Frame<N, R>,
        interval_s: f64,
        hold: bool,
        [rejection_limit, gate]: [f64; 2],
        bursts: impl Fn(usize) -> bool,
        state_covariance: impl FnOnce() -> [[f64; N]; N],
    ) {
        let Some(bank) = &mut self.bank else { return };
        for (i, xi) in frame.normalised.iter().enumerate() {
            if xi.is_finite() {
                self.beyond[i] = if xi.abs() > gate { self.beyond[i].saturating_add(1) } else { 0 };
            }
        }
        let bursts: [bool; R] = core::array::from_fn(|i| bank.is_calibrated() && bursts(i));
        self.bears = core::array::from_fn(|i| self.beyond[i] >= REJECTED_IN_SUCCESSION && !bursts[i]);
        let moved = bank.take(frame, interval_s, hold, rejection_limit, &bursts, state_covariance);
        if moved && !hold {
            self.take_over();
        }
    }

    /// Where levels are as given: opens the gate of the outputs that it has locked out.
    pub(crate) fn open(&mut self, locked_out: impl FnOnce() -> [bool; R]) {
        if self.bank.is_none() {
            self.bears = locked_out();
        }
    }

    /// Whether a row of an output beyond the limit of rejection is borne with bounded influence.
    pub(crate) fn bears(&self) -> [bool; R] {
        self.bears
    }

    /// What has been learnt, if anything is.
    pub(crate) fn learnt(&self) -> Option<LearntLevels<R>> {
        self.bank.as_ref().map(Bank::learnt)
    }

    /// Goes back to what was learnt at an earlier time.
    pub(crate) fn go_back(&mut self, learnt: &LearntLevels<R>) {
        if let Some(bank) = &mut self.bank {
            bank.go_back(learnt);
        }
        self.take_over();
    }

    pub(crate) fn report(&self, own_scale: f64) -> NoiseReport<R> {
        NoiseReport { std: self.std, process_noise_scale: self.scale.unwrap_or(own_scale), learnt: self.learnt() }
    }
}
