//! Champion and challenger: a suspected change never touches the running estimate until the changed one has explained
//! fresh data better.

use super::settings::ChangeDetection;
use super::slot::Innovations;
use crate::dense::Cholesky;

/// Time constant with which the caution after a false alarm decays, s.
const CAUTION_DECAY_S: f64 = 60.0;
const LARGEST_CAUTION: f64 = 15.0;
/// Adoptions closer than this look like a chain, s.
const CHAIN_S: f64 = 30.0;

/// What is to be done with a challenger.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Verdict {
    Undecided,
    Adopt,
    Drop,
}

/// The book-keeping of the contest.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Challenge {
    pub(crate) settings: ChangeDetection,
    /// `D`, nats in favour of the challenger.
    pub(crate) score: f64,
    opened_at_s: f64,
    /// `pen`: thresholds are `1 + pen` times the settings'.
    pub(crate) caution: f64,
    pub(crate) adoptions: u32,
    pub(crate) dropped: u32,
    last_adoption_s: f64,
    /// The model itself is wrong: changes are no longer believed.
    pub(crate) model_error: bool,
}

impl Challenge {
    pub(crate) fn new(settings: ChangeDetection) -> Self {
        Self {
            settings,
            score: 0.0,
            opened_at_s: 0.0,
            caution: 0.0,
            adoptions: 0,
            dropped: 0,
            last_adoption_s: f64::NEG_INFINITY,
            model_error: false,
        }
    }

    pub(crate) fn pass_time(&mut self, interval_s: f64) {
        if self.caution > 0.0 {
            self.caution *= libm::exp(-interval_s / CAUTION_DECAY_S);
        }
    }

    pub(crate) fn is_triggered(&self, bayes_factor: f64, since_start_s: f64) -> bool {
        !self.model_error
            && since_start_s > self.settings.arming_s
            && bayes_factor > self.settings.trigger * (1.0 + self.caution)
    }

    pub(crate) fn open(&mut self, time_s: f64) {
        self.score = 0.0;
        self.opened_at_s = time_s;
    }

    /// Adds one frame: `D += sum 1/2 [(min(xi_A^2, 9) - min(xi_B^2, 9))/lev + ln(s_A (1+v_A)) - ln(s_B (1+v_B))]`.
    /// One outlier moves it by at most 4.5.
    pub(crate) fn add_frame<const R: usize>(
        &mut self,
        champion: &Innovations<R>,
        challenger: &Innovations<R>,
        leverage: f64,
    ) {
        let mut squares = 0.0;
        let mut ratio = 1.0;
        for i in 0..R {
            let (a, b) = (champion.normalised[i], challenger.normalised[i]);
            if a.is_finite() && b.is_finite() {
                squares += (a * a).min(9.0) - (b * b).min(9.0);
                ratio *= champion.variance[i] / challenger.variance[i];
            }
        }
        self.score += 0.5 * (squares / leverage + libm::log(ratio));
    }

    /// Decides. `maturity` is `T`; `sound` whether the challenger is still finite with positive variances.
    pub(crate) fn decide(&self, time_s: f64, maturity: f64, needed_maturity: f64, sound: bool) -> Verdict {
        let expired = time_s - self.opened_at_s >= self.settings.doubt_limit_s;
        let caution = 1.0 + self.caution;
        let mature = self.score > self.settings.adoption * caution && maturity > needed_maturity;
        let overwhelming = expired && self.score > self.settings.adoption_at_limit * caution;
        if !sound || !self.score.is_finite() || self.model_error {
            Verdict::Drop
        } else if mature || overwhelming {
            Verdict::Adopt
        } else if self.score < self.settings.dropping || expired {
            Verdict::Drop
        } else {
            Verdict::Undecided
        }
    }

    /// Notes an adoption; gives the factor by which the wander is widened.
    pub(crate) fn adopted(&mut self, time_s: f64) -> f64 {
        let chained = time_s - self.last_adoption_s < CHAIN_S;
        self.last_adoption_s = time_s;
        self.adoptions = self.adoptions.saturating_add(1);
        self.grow_caution();
        if chained { 4.0 } else { 1.0 }
    }

    /// Notes a dropped challenger; gives the factor by which the wander is widened.
    pub(crate) fn was_dropped(&mut self) -> f64 {
        self.dropped = self.dropped.saturating_add(1);
        // A NaN score is a failed challenger: it counts as lost.
        if self.score >= 0.0 {
            return 1.0;
        }
        self.grow_caution();
        2.0
    }

    fn grow_caution(&mut self) {
        self.caution = (2.0 * self.caution + 1.0).min(LARGEST_CAUTION);
    }
}

/// `T = dtheta^T (C_B + w^2 diag d^2)^-1 dtheta` over the tested columns, all in scaled columns: is the change larger
/// than what the challenger does not know yet and than the wander? Zero if it cannot be computed.
pub(crate) fn maturity<const P: usize>(
    difference: &[f64; P],
    covariance: &[[f64; P]; P],
    change: &[f64; P],
    wander_squared: f64,
    tested: &[usize],
) -> f64 {
    let mut a = [[0.0; P]; P];
    let mut left = [0.0; P];
    for (i, &row) in tested.iter().enumerate() {
        for (j, &column) in tested[..=i].iter().enumerate() {
            a[i][j] = covariance[row][column];
        }
        a[i][i] += wander_squared * change[row] * change[row];
        left[i] = difference[row];
    }
    let Some(cholesky) = Cholesky::new(&mut a, tested.len()) else { return 0.0 };
    cholesky.solve_lower(&mut left);
    left[..tested.len()].iter().map(|x| x * x).sum()
}

/// Chi-square quantile at `1 - 1.4e-4` (Wilson and Hilferty 1931; within 2 % for 2 degrees of freedom and more).
pub(crate) fn needed_maturity(settings: &ChangeDetection, tested: usize) -> f64 {
    settings.maturity.unwrap_or_else(|| {
        let k = (tested as f64).max(1.0);
        let normal_quantile = 3.634;
        let root = 1.0 - 2.0 / (9.0 * k) + normal_quantile * libm::sqrt(2.0 / (9.0 * k));
        k * root * root * root
    })
}
