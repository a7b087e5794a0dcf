//! Champion and challenger: a suspected change never touches the running estimate until the changed one has explained
//! fresh data better.

use super::settings::ChangeDetection;
use super::slot::{Faults, Innovations};
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

    /// Adds one frame: `D += sum 1/2 [(f_A min(xi_A^2, 9) - f_B min(xi_B^2, 9))/lev + ln(s_A (1+v_A)) - ln(s_B (1+v_B))]`, with the
    /// weights `f` of champion and challenger ([`Faults::weight`]). One outlier moves it by at most 4.5.
    pub(crate) fn add_frame<const R: usize>(
        &mut self,
        [champion, challenger]: [&Innovations<R>; 2],
        faults: &[Faults<R>; 2],
        rejection_limit: f64,
        leverage: f64,
    ) {
        let mut squares = 0.0;
        let mut ratio = 1.0;
        for i in 0..R {
            if champion.normalised[i].is_finite() && challenger.normalised[i].is_finite() {
                squares +=
                    faults[0].misfit(champion, i, rejection_limit) - faults[1].misfit(challenger, i, rejection_limit);
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

/// Part of the quantile that is asked for: real changes pass twice the quantile some hundredths of a second after it, challengers
/// that only follow a wandering model or coloured noise less often (docs/theory.md).
const MATURE: f64 = 2.0;

/// Twice the chi-square quantile at `1 - 1.4e-4` after Wilson and Hilferty (1931): 7 % too large, thus careful, for one degree of
/// freedom, 4 % for two, 2 % for five, less beyond.
pub(crate) fn needed_maturity(settings: &ChangeDetection, tested: usize) -> f64 {
    settings.maturity.unwrap_or_else(|| {
        let k = (tested as f64).max(1.0);
        let normal_quantile = 3.634;
        let root = 1.0 - 2.0 / (9.0 * k) + normal_quantile * libm::sqrt(2.0 / (9.0 * k));
        MATURE * k * root * root * root
    })
}

#[cfg(test)]
mod tests {
    use super::super::settings::ChangeDetection;
    use super::super::slot::{Faults, Innovations};
    use super::{Challenge, Verdict, maturity, needed_maturity};

    fn rows(normalised: [f64; 3], variance: [f64; 3]) -> Innovations<3> {
        Innovations { normalised, variance, ..Innovations::EMPTY }
    }

    /// Against the formula, row by row; a row that one of the two has not got does not count, a rejected one little.
    #[test]
    fn the_score_is_the_bounded_difference_of_the_log_likelihoods() {
        let mut challenge = Challenge::new(ChangeDetection::default());
        let champion = rows([2.0, 50.0, 1.0], [4.0, 2.0, 3.0]);
        let challenger = rows([0.5, 1.0, f64::NAN], [5.0, 2.5, f64::NAN]);
        let faults = [Faults::NONE; 2];
        challenge.add_frame([&champion, &challenger], &faults, 30.0, 2.0);
        let expected = 0.5 * ((4.0 - 0.25 + 0.05 * 9.0 - 1.0) / 2.0 + (4.0_f64 / 5.0).ln() + (2.0_f64 / 2.5).ln());
        assert!((challenge.score - expected).abs() < 1e-12, "{}", challenge.score);
        // The other way round takes it back.
        challenge.add_frame([&challenger, &champion], &faults, 30.0, 2.0);
        assert!(challenge.score.abs() < 1e-12);
        // What goes on for longer than a burst counts fully.
        let mut faults = faults;
        (0..51).for_each(|_| faults[0].note(&champion, 30.0, 0.01));
        challenge.add_frame([&champion, &challenger], &faults, 30.0, 2.0);
        assert!((challenge.score - expected - 0.5 * 0.95 * 9.0 / 2.0).abs() < 1e-12, "{}", challenge.score);
    }

    #[test]
    fn the_verdict_needs_score_and_maturity_in_time() {
        let settings = ChangeDetection { adoption_at_limit: 300.0, ..ChangeDetection::default() };
        let mut challenge = Challenge::new(settings);
        assert!(!challenge.is_triggered(12.1, 2.0) && challenge.is_triggered(12.1, 2.1));
        assert!(!challenge.is_triggered(11.9, 60.0));
        challenge.open(100.0);
        let verdict = |score: f64, time_s: f64, matured: f64, caution: f64| {
            Challenge { score, caution, ..challenge }.decide(time_s, matured, 25.0, true)
        };
        assert_eq!(verdict(10.1, 101.0, 25.1, 0.0), Verdict::Adopt);
        assert_eq!(verdict(9.9, 101.0, 25.1, 0.0), Verdict::Undecided);
        assert_eq!(verdict(10.1, 101.0, 24.9, 0.0), Verdict::Undecided);
        // Caution doubles what is needed.
        assert_eq!(verdict(19.9, 101.0, 25.1, 1.0), Verdict::Undecided);
        assert_eq!(verdict(20.1, 101.0, 25.1, 1.0), Verdict::Adopt);
        assert_eq!(verdict(-30.1, 101.0, 25.1, 0.0), Verdict::Drop);
        // At the time limit an overwhelming score is enough, and anything less is not.
        assert_eq!(verdict(1000.0, 105.9, 0.0, 0.0), Verdict::Undecided);
        assert_eq!(verdict(301.0, 106.0, 0.0, 0.0), Verdict::Adopt);
        assert_eq!(verdict(299.0, 106.0, 0.0, 0.0), Verdict::Drop);
        assert_eq!(verdict(f64::NAN, 101.0, 25.1, 0.0), Verdict::Drop);
        assert_eq!(Challenge { score: 1000.0, ..challenge }.decide(101.0, 100.0, 25.0, false), Verdict::Drop);
    }

    #[test]
    fn caution_grows_with_every_false_alarm_and_decays_in_a_minute() {
        let mut challenge = Challenge::new(ChangeDetection::default());
        challenge.score = -31.0;
        for expected in [1.0, 3.0, 7.0, 15.0, 15.0] {
            assert_eq!(challenge.was_dropped(), 2.0);
            assert_eq!(challenge.caution, expected);
        }
        challenge.pass_time(60.0);
        assert!((challenge.caution - 15.0 * (-1.0_f64).exp()).abs() < 1e-12);
        // One that was better and only ran out of time is no false alarm.
        challenge.score = 5.0;
        let before = challenge.caution;
        assert_eq!((challenge.was_dropped(), challenge.caution), (1.0, before));
        // The second adoption within half a minute looks like a chain.
        assert_eq!((challenge.adopted(100.0), challenge.adopted(129.0), challenge.adopted(160.0)), (1.0, 4.0, 1.0));
        assert_eq!((challenge.adoptions, challenge.dropped), (3, 6));
    }

    #[test]
    fn the_maturity_is_of_the_tested_columns_alone() {
        // Columns 0 and 2 of three: T = d^T (C + w^2 diag d_j^2)^-1 d by hand.
        let covariance = [[0.5, 9.0, 0.1], [9.0, 99.0, 9.0], [0.1, 9.0, 0.25]];
        let (difference, change, w2) = ([0.6, 77.0, -0.4], [1.0, 5.0, 2.0], 0.04);
        let (a, b, c): (f64, f64, f64) = (0.5 + 0.04, 0.1, 0.25 + 0.16);
        let expected = (c * 0.36 + 2.0 * b * 0.24 + a * 0.16) / (a * c - b * b);
        let found = maturity(&difference, &covariance, &change, w2, &[0, 2]);
        assert!((found / expected - 1.0).abs() < 1e-12, "{found} {expected}");
        // Exact quantiles at 1 - 1.4e-4, by numerical integration of the density.
        for (tested, exact, allowed) in [(1, 14.502, 0.07), (2, 17.748, 0.05), (5, 24.989, 0.025), (11, 36.494, 0.01)] {
            let excess = needed_maturity(&ChangeDetection::default(), tested) / (2.0 * exact) - 1.0;
            assert!((0.0..allowed).contains(&excess), "{tested}: {excess}");
        }
        assert_eq!(needed_maturity(&ChangeDetection { maturity: Some(7.0), ..ChangeDetection::default() }, 2), 7.0);
    }
}
