//! What can be checked of the assumptions behind the rate of false alarms.

/// Of the innovations of the reference up to now, or up to the flag. White noise of the right level has a level and a
/// scatter of about one and no correlation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Assumptions {
    /// Mean square of the normalised innovations, bounded at four sigmas, of the output where it is largest. NaN before
    /// there are any.
    pub level: f64,
    /// Correlation of successive normalised innovations, of the output where its size is largest. NaN before there are
    /// any.
    pub correlation: f64,
    /// Pairs of successive innovations of the output that has the fewest of those that have any.
    pub pairs: f64,
    /// Mean square of what blocks of two seconds say of the monitored parameters beside the healthy deviation, over what
    /// white noise would make of it. NaN before anything has moved.
    pub scatter: f64,
    /// Degrees of freedom that the scatter comes from.
    pub freedom: f64,
}

impl Assumptions {
    /// Largest level. The levels are never below what residuals have shown; with noise of the right level it is below
    /// one.
    pub const LARGEST_LEVEL: f64 = 1.3;
    /// Largest correlation, in size.
    pub const LARGEST_CORRELATION: f64 = 0.25;
    /// Pairs and degrees of freedom without which nothing is said.
    pub const FEWEST_PAIRS: f64 = 100.0;
    /// See [`Self::FEWEST_PAIRS`].
    pub const SMALLEST_FREEDOM: f64 = 3.0;

    pub(super) const NONE: Self =
        Self { level: f64::NAN, correlation: f64::NAN, pairs: 0.0, scatter: f64::NAN, freedom: 0.0 };

    pub(super) fn of([level, correlation, pairs]: [f64; 3], [scatter, freedom]: [f64; 2]) -> Self {
        Self { level, correlation, pairs, scatter, freedom }
    }

    /// Largest scatter: three standard deviations of the mean square of so many normal numbers above one.
    pub fn largest_scatter(&self) -> f64 {
        1.0 + 3.0 * libm::sqrt(2.0 / self.freedom)
    }

    /// Whether there is enough to check.
    pub fn are_checked(&self) -> bool {
        self.pairs >= Self::FEWEST_PAIRS && self.freedom >= Self::SMALLEST_FREEDOM
    }

    /// Whether enough was seen, and nothing speaks against the assumptions. False where anything is NaN.
    pub fn hold(&self) -> bool {
        self.are_checked()
            && self.level <= Self::LARGEST_LEVEL
            && self.correlation.abs() <= Self::LARGEST_CORRELATION
            && self.scatter <= self.largest_scatter()
    }
}

/// Level and correlation of the innovations of one output.
#[derive(Clone, Copy, Debug)]
pub(super) struct Whiteness {
    square: f64,
    product: f64,
    samples: f64,
    pairs: f64,
    last: f64,
}

impl Whiteness {
    pub(super) const NONE: Self = Self { square: 0.0, product: 0.0, samples: 0.0, pairs: 0.0, last: f64::NAN };

    /// Takes a normalised innovation of bounded size.
    pub(super) fn add(&mut self, innovation: f64) {
        self.square += innovation * innovation;
        self.samples += 1.0;
        if self.last.is_finite() {
            self.product += innovation * self.last;
            self.pairs += 1.0;
        }
        self.last = innovation;
    }

    /// Nothing was measured in this frame.
    pub(super) fn skip(&mut self) {
        self.last = f64::NAN;
    }

    /// Largest level and correlation of all outputs that have innovations, and the fewest pairs.
    pub(super) fn worst<const R: usize>(outputs: &[Self; R]) -> [f64; 3] {
        let [mut level, mut correlation, mut pairs] = [f64::NAN, f64::NAN, f64::INFINITY];
        for output in outputs.iter().filter(|output| output.samples > 0.0) {
            // NaN gives way to a number.
            level = level.max(output.square / output.samples);
            let own = output.product / output.pairs / (output.square / output.samples);
            if own.is_finite() && (correlation.is_nan() || own.abs() > correlation.abs()) {
                correlation = own;
            }
            pairs = pairs.min(output.pairs);
        }
        [level, correlation, if pairs.is_finite() { pairs } else { 0.0 }]
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::{Assumptions, Whiteness};

    #[test]
    fn level_and_correlation_are_those_of_the_worst_output() {
        let (mut quiet, mut loud) = (Whiteness::NONE, Whiteness::NONE);
        for k in 0..1000 {
            // Successive values of one sign each four times: correlation one half; and alternating ones.
            loud.add(if k / 4 % 2 == 0 { 2.0 } else { -2.0 });
            if k % 10 == 9 { quiet.skip() } else { quiet.add(if k % 2 == 0 { 0.1 } else { -0.1 }) }
        }
        let [level, correlation, pairs] = Whiteness::worst(&[quiet, loud, Whiteness::NONE]);
        assert!((level - 4.0).abs() < 1e-12 && (correlation + 1.0).abs() < 1e-12, "{level} {correlation}");
        assert!((pairs - 800.0).abs() < 1.0, "{pairs}");
        let [_, correlation, _] = Whiteness::worst(&[loud]);
        assert!((correlation - 0.5).abs() < 0.01, "{correlation}");
    }

    #[test]
    fn every_assumption_can_fail_and_what_is_not_seen_does_not_hold() {
        let good = Assumptions { level: 1.0, correlation: 0.05, pairs: 500.0, scatter: 1.2, freedom: 10.0 };
        assert!(good.hold());
        assert!(!Assumptions::NONE.hold());
        for bad in [
            Assumptions { level: 1.4, ..good },
            Assumptions { correlation: -0.3, ..good },
            Assumptions { correlation: f64::NAN, ..good },
            Assumptions { pairs: 99.0, ..good },
            Assumptions { scatter: 2.4, ..good },
            Assumptions { scatter: f64::NAN, ..good },
            Assumptions { freedom: 2.9, ..good },
        ] {
            assert!(!bad.hold(), "{bad:?}");
        }
    }
}
