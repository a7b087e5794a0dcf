//! How often chance alone makes a ratio of mean squares as large: the F distribution.

use std::f64::consts::FRAC_2_PI;

/// Probability that a ratio of two independent mean squares of the same noise, the first of `above` and the second of `below` degrees
/// of freedom, is larger than `ratio`; one where either has none, since nothing is then known. NaN stays NaN.
///
/// It is the regularised incomplete beta function `I_x(below/2, above/2)` at `x = below/(below + above ratio)`, which is elementary at
/// halves and ones and goes from there by steps of one (M. Abramowitz, I. A. Stegun, *Handbook of Mathematical Functions*, 26.5.15,
/// 26.5.16 and 26.6.2).
pub(super) fn ratio_above(ratio: f64, above: usize, below: usize) -> f64 {
    if above == 0 || below == 0 {
        return 1.0;
    }
    let (wanted_a, wanted_b) = (0.5 * below as f64, 0.5 * above as f64);
    let x = wanted_a / (wanted_a + wanted_b * ratio);
    // The value, and what a step changes: x^a (1 - x)^b / B(a, b).
    let (mut a, mut b, mut value, mut step) = match (below % 2, above % 2) {
        (1, 1) => (0.5, 0.5, FRAC_2_PI * x.sqrt().asin(), 0.5 * FRAC_2_PI * (x * (1.0 - x)).sqrt()),
        (1, _) => (0.5, 1.0, x.sqrt(), 0.5 * x.sqrt() * (1.0 - x)),
        (_, 1) => (1.0, 0.5, 1.0 - (1.0 - x).sqrt(), 0.5 * x * (1.0 - x).sqrt()),
        _ => (1.0, 1.0, x, x * (1.0 - x)),
    };
    while a < wanted_a {
        value -= step / a;
        step *= x * (a + b) / a;
        a += 1.0;
    }
    while b < wanted_b {
        value += step / b;
        step *= (1.0 - x) * (a + b) / b;
        b += 1.0;
    }
    // Differences of numbers near one leave their rounding.
    value.clamp(0.0, 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_of_the_tables_are_passed_as_often_as_they_say() {
        // Abramowitz & Stegun, table 26.9: 1 and 0.1 % points.
        for (above, below, ratio, chance) in [
            (1, 1, 4052.2, 0.01),
            (2, 2, 999.0, 0.001),
            (2, 7, 9.547, 0.01),
            (3, 10, 12.55, 0.001),
            (4, 5, 31.09, 0.001),
            (5, 30, 5.534, 0.001),
            (8, 60, 3.865, 0.001),
        ] {
            let found = ratio_above(ratio, above, below);
            assert!((found / chance - 1.0).abs() < 2e-3, "{above} {below} {ratio}: {found}");
        }
    }

    #[test]
    fn what_is_not_known_is_chance_and_the_ends_are_reached() {
        assert_eq!((ratio_above(9.0, 2, 0), ratio_above(9.0, 0, 5)), (1.0, 1.0));
        for (above, below) in [(1, 1), (2, 3), (3, 2), (4, 6)] {
            assert_eq!((ratio_above(0.0, above, below), ratio_above(f64::INFINITY, above, below)), (1.0, 0.0));
        }
        // With many degrees of freedom below it is chi squared: 10.828 is its 0.1 % point for one.
        assert!((ratio_above(10.828, 1, 100_000) / 0.001 - 1.0).abs() < 2e-3);
        assert!(ratio_above(f64::NAN, 2, 5).is_nan());
    }
}
