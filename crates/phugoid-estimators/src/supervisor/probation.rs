//! After a change was adopted: the former estimate goes on as a rival until the new one has been excited and has
//! predicted better, and a re-opened parameter is unknown until something has excited it.

use crate::bounded::at;

/// Nats in favour of the adopted estimate, since the suspicion, from which on the former one is given up once every
/// re-opened parameter is known again.
const CONFIRMED: f64 = 30.0;
/// Nats in favour of the former estimate, since the suspicion, at which it takes its place again.
const ROLLED_BACK: f64 = 5.0;
/// Most nats in favour of the adopted estimate that are remembered: an advantage from before can be lost again.
const REMEMBERED: f64 = 60.0;
/// Part of the variance of a plausible change that has to have gone before a re-opened parameter is known again: its
/// bound has shrunk by 30 %, as for a parameter that counts as excited at all.
const EXCITED: f64 = 0.5;

pub(super) enum Outcome {
    Undecided,
    Confirmed,
    RolledBack,
}

/// The contest between an adopted estimate and the former one.
#[derive(Clone, Copy, Debug)]
pub(super) struct Probation {
    /// Nats in favour of the former estimate.
    score: f64,
}

impl Probation {
    /// `evidence`: nats for which the new estimate was adopted.
    pub(super) fn new(evidence: f64) -> Self {
        Self { score: -evidence.min(REMEMBERED) }
    }

    /// Takes the nats by which the former estimate has predicted a frame better. `known`: every re-opened parameter is
    /// known again; `lives`: the former estimate is still finite with positive variances.
    pub(super) fn judge(&mut self, nats: f64, known: bool, lives: bool) -> Outcome {
        if !lives || !nats.is_finite() {
            return Outcome::Confirmed;
        }
        self.score = (self.score + nats).max(-REMEMBERED);
        if self.score > ROLLED_BACK {
            Outcome::RolledBack
        } else if known && self.score < -CONFIRMED {
            Outcome::Confirmed
        } else {
            Outcome::Undecided
        }
    }
}

/// Parameters that were re-opened by a change and that nothing has excited since.
#[derive(Clone, Copy, Debug)]
pub(super) struct Reopened<const P: usize> {
    /// When, s.
    pub(super) since_s: f64,
    /// Scaled variance below which a parameter is known again; zero for one that is known.
    limit: [f64; P],
}

impl<const P: usize> Reopened<P> {
    pub(super) const NONE: Self = Self { since_s: f64::NAN, limit: [0.0; P] };

    /// `former`: scaled variances before the change; `change_over_prior`: one sigma of the change that was allowed for, zero
    /// for what was not opened.
    pub(super) fn new(since_s: f64, former: &[f64; P], change_over_prior: &[f64; P]) -> Self {
        let limit = core::array::from_fn(|j| {
            let change = change_over_prior[j] * change_over_prior[j];
            if change > 0.0 { former[j] + EXCITED * change } else { 0.0 }
        });
        Self { since_s, limit }
    }

    /// The same with what an earlier change has opened and this one does not: it stays unknown until it is excited.
    pub(super) fn with(mut self, earlier: &Self) -> Self {
        for (limit, earlier) in self.limit.iter_mut().zip(&earlier.limit) {
            *limit = limit.max(*earlier);
        }
        self
    }

    /// Notes the present scaled variances: what has become known stays so.
    pub(super) fn note(&mut self, variances: &[f64; P]) {
        for (limit, variance) in self.limit.iter_mut().zip(variances) {
            if *variance < *limit {
                *limit = 0.0;
            }
        }
    }

    pub(super) fn is_unknown(&self, column: usize) -> bool {
        at(&self.limit, column) > 0.0
    }

    pub(super) fn any(&self) -> bool {
        self.limit.iter().any(|limit| *limit > 0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::{Outcome, Probation, Reopened};

    #[test]
    fn the_former_estimate_returns_when_it_predicts_better_and_is_given_up_when_all_is_known() {
        let mut probation = Probation::new(12.0);
        for _ in 0..16 {
            assert!(matches!(probation.judge(1.0, false, true), Outcome::Undecided));
        }
        assert!(matches!(probation.judge(1.5, false, true), Outcome::RolledBack));
        let mut probation = Probation::new(12.0);
        for _ in 0..100 {
            // However well it predicts: nothing has excited what was opened.
            assert!(matches!(probation.judge(-1.0, false, true), Outcome::Undecided));
        }
        assert!(matches!(probation.judge(-1.0, true, true), Outcome::Confirmed));
        // A former estimate that is no number is no rival.
        assert!(matches!(Probation::new(12.0).judge(f64::NAN, false, true), Outcome::Confirmed));
    }

    #[test]
    fn a_parameter_is_unknown_until_its_bound_has_shrunk() {
        let mut reopened = Reopened::new(3.0, &[0.01, 0.02, 0.5], &[1.0, 0.4, 0.0]);
        reopened.note(&[1.0, 0.09, 0.5]);
        assert!(reopened.is_unknown(0) && !reopened.is_unknown(1) && !reopened.is_unknown(2));
        // Known once: it stays so, whatever a later doubt adds.
        reopened.note(&[0.4, 0.2, 0.5]);
        assert!(!reopened.any());
        // What an earlier change has opened stays unknown if this one does not open it.
        let earlier = Reopened::new(3.0, &[0.01, 0.02, 0.5], &[1.0, 0.0, 0.0]);
        let both = Reopened::new(4.0, &[1.0, 0.02, 0.5], &[0.0, 0.4, 0.0]).with(&earlier);
        assert!(both.is_unknown(0) && both.is_unknown(1) && !both.is_unknown(2));
    }
}
