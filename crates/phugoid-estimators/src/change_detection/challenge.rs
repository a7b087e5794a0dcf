//! Champion and challenger: a suspected change does not touch the running estimate (the champion). A second estimate
//! with opened parameters (the challenger) replaces it only after it has explained fresh data better.

use crate::bounded::at;
use crate::dense::Cholesky;
use crate::settings::ChangeDetection;

/// Time constant with which the caution after a false alarm decays, s.
const CAUTION_DECAY_S: f64 = 60.0;
const LARGEST_CAUTION: f64 = 15.0;
/// Adoptions closer than this look like a chain, s.
const CHAIN_S: f64 = 30.0;

/// How much more mature a change has to be for each unit by which the colour of the residuals inflates the variances:
/// where the residuals are white it is 1.0 to 1.3 before a change, where the tables are wrong 2.5 to 70
/// (docs/methods.md).
const COLOUR: f64 = 0.5;

/// Up to this inflation residuals are white: a model that is right so far has nothing to wander.
const WHITE: f64 = 1.1;
/// Then this many times the nats that an adoption asks for, held until the doubt runs out, ...
const DECISIVE: f64 = 10.0;
/// ... need this part of the maturity only: small damage, soon after little has been learnt of the wander
/// (docs/methods.md).
const WHITE_MATURE: f64 = 0.3;

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
    /// `D`, nats in favour of the challenger on fresh data.
    pub(crate) score: f64,
    /// The same on the data that it has caught up with: those that raised the suspicion.
    pub(crate) past: f64,
    /// Variance that the residuals' colour claims for the tested parameters over what white ones would, before the
    /// change: how far the model is known to be wrong.
    colour: f64,
    opened_at_s: f64,
    /// `pen`: thresholds are `1 + pen` times the settings'.
    pub(crate) caution: f64,
    pub(crate) adoptions: u32,
    pub(crate) dropped: u32,
    last_adoption_s: f64,
    /// The wander stayed large after an adoption: the model itself is wrong, and no further change is adopted.
    pub(crate) model_error: bool,
    /// Rows that are measured in the longest doubt.
    rows: f64,
}

impl Challenge {
    /// `rows_per_s`: rows that are measured in a second.
    pub(crate) fn new(settings: ChangeDetection, rows_per_s: f64) -> Self {
        Self {
            settings,
            score: 0.0,
            past: 0.0,
            colour: 1.0,
            opened_at_s: 0.0,
            caution: 0.0,
            adoptions: 0,
            dropped: 0,
            last_adoption_s: f64::NEG_INFINITY,
            model_error: false,
            rows: rows_per_s * settings.doubt_limit_s,
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

    pub(crate) fn open(&mut self, time_s: f64, colour: f64) {
        self.score = 0.0;
        self.past = 0.0;
        self.colour = colour.max(1.0);
        self.opened_at_s = time_s;
    }

    /// Decides. `maturity` is `T`, what is needed of it holds for white residuals; `sound` whether the challenger is
    /// still finite with positive variances.
    pub(crate) fn decide(&self, time_s: f64, maturity: f64, needed_maturity: f64, sound: bool) -> Verdict {
        let expired = time_s - self.opened_at_s >= self.settings.doubt_limit_s;
        let caution = 1.0 + self.caution;
        let needed_nats = self.settings.adoption * caution;
        // The past raised the suspicion and cannot confirm it, but it can refute it: a burst of outliers draws the
        // challenger away.
        let better = self.score > needed_nats && self.score + self.past > needed_nats;
        let asked = if expired && self.colour < WHITE && self.score > DECISIVE * needed_nats {
            WHITE_MATURE
        } else {
            1.0 + COLOUR * (self.colour - 1.0)
        };
        // The running estimate predicts next to nothing: no error of a model that has served until now does this.
        let overwhelming = self.score > self.settings.overwhelming * self.rows;
        if !sound || !self.score.is_finite() || self.model_error {
            Verdict::Drop
        } else if better && (overwhelming || maturity > needed_maturity * asked) {
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
            // Better all along, and yet no change: that is what wander is.
            return if self.score > self.settings.adoption { 2.0 } else { 1.0 };
        }
        self.grow_caution();
        2.0
    }

    /// Notes that an adopted change was taken back; gives the factor by which the wander is widened.
    pub(crate) fn was_rolled_back(&mut self) -> f64 {
        self.adoptions = self.adoptions.saturating_sub(1);
        self.dropped = self.dropped.saturating_add(1);
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
    for (i, ((a, left), &row)) in a.iter_mut().zip(&mut left).zip(tested).enumerate() {
        let Some(from) = covariance.get(row) else { return 0.0 };
        for (a, &column) in a.iter_mut().zip(tested).take(i + 1) {
            *a = at(from, column);
        }
        if let Some(diagonal) = a.get_mut(i) {
            *diagonal += wander_squared * at(change, row) * at(change, row);
        }
        *left = at(difference, row);
    }
    let Some(cholesky) = Cholesky::new(&mut a, tested.len()) else { return 0.0 };
    cholesky.solve_lower(&mut left);
    left.iter().take(tested.len()).map(|x| x * x).sum()
}

/// Part of the quantile that is asked for: real changes pass twice the quantile some hundredths of a second after it,
/// challengers that only follow a wandering model or coloured noise less often (docs/theory.md).
const MATURE: f64 = 2.0;

/// Twice the chi-square quantile at `1 - 1.4e-4` after Wilson and Hilferty (1931): 7 % too large, thus careful, for one
/// degree of freedom, 4 % for two, 2 % for five, less beyond.
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
    use super::{Challenge, Verdict, maturity, needed_maturity};
    use crate::settings::ChangeDetection;

    #[test]
    fn the_verdict_needs_score_and_maturity_in_time() {
        // Four rows at 100 Hz, in six seconds 2400.
        let mut challenge = Challenge::new(ChangeDetection::default(), 400.0);
        assert!(!challenge.is_triggered(6.1, 2.0) && challenge.is_triggered(6.1, 2.1));
        assert!(!challenge.is_triggered(5.9, 60.0));
        challenge.open(100.0, 1.0);
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
        // What is known of before can refute it, not confirm it.
        let past = |past: f64, score: f64| Challenge { score, past, ..challenge }.decide(101.0, 25.1, 25.0, true);
        assert_eq!((past(-5.0, 15.1), past(-5.0, 14.9)), (Verdict::Adopt, Verdict::Undecided));
        assert_eq!(past(1000.0, 9.9), Verdict::Undecided);
        // Coloured residuals ask for a larger change.
        let coloured = |colour: f64, matured: f64| {
            Challenge { score: 11.0, colour, ..challenge }.decide(101.0, matured, 25.0, true)
        };
        assert_eq!((coloured(5.0, 74.9), coloured(5.0, 75.1)), (Verdict::Undecided, Verdict::Adopt));
        // Unless the running estimate predicts next to nothing, by 0.6 nats a row.
        let lost = |score: f64| Challenge { score, colour: 50.0, ..challenge }.decide(103.0, 0.0, 25.0, true);
        assert_eq!((lost(1439.0), lost(1441.0)), (Verdict::Undecided, Verdict::Adopt));
        // At the time limit what is not adopted is dropped, if the residuals were not white or the gain is small.
        assert_eq!(verdict(1000.0, 105.9, 24.9, 0.0), Verdict::Undecided);
        let at_limit = |score: f64, colour: f64, matured: f64| {
            Challenge { score, colour, ..challenge }.decide(106.0, matured, 25.0, true)
        };
        assert_eq!((at_limit(101.0, 1.0, 7.6), at_limit(99.0, 1.0, 7.6)), (Verdict::Adopt, Verdict::Drop));
        assert_eq!((at_limit(101.0, 1.0, 7.4), at_limit(101.0, 1.2, 7.6)), (Verdict::Drop, Verdict::Drop));
        assert_eq!(verdict(f64::NAN, 101.0, 25.1, 0.0), Verdict::Drop);
        assert_eq!(Challenge { score: 1000.0, ..challenge }.decide(101.0, 100.0, 25.0, false), Verdict::Drop);
    }

    #[test]
    fn caution_grows_with_every_false_alarm_and_decays_in_a_minute() {
        let mut challenge = Challenge::new(ChangeDetection::default(), 400.0);
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
