//! Quantiles of runs, and what counts of runs tell of a probability.
//!
//! [`quantile`] and [`median`] are those of [`phugoid_flight_data::statistics`], for a vector that is no longer needed and with
//! NaN where there are no values.

use phugoid_flight_data::statistics::{self, Rank};

/// The smallest value that at least this fraction (0 to 1) of the values do not exceed ([`Rank::InverseDistribution`]); NaN for no
/// values. Infinite values are counted like any others, so that runs that never arrive can be given as infinity.
///
/// ```
/// use phugoid_evaluation::statistics::quantile;
///
/// let latencies_s = vec![0.4, 0.2, f64::INFINITY, 0.3];
/// assert_eq!(quantile(latencies_s.clone(), 0.5), 0.3);
/// assert_eq!(quantile(latencies_s, 0.9), f64::INFINITY);
/// ```
pub fn quantile(mut values: Vec<f64>, fraction: f64) -> f64 {
    statistics::quantile(&mut values, fraction, Rank::InverseDistribution).unwrap_or(f64::NAN)
}

/// The middle value, of an even number of values the larger one of the two in the middle; NaN for none.
pub fn median(mut values: Vec<f64>) -> f64 {
    statistics::median(&mut values).unwrap_or(f64::NAN)
}

/// 95 % interval of a probability of which `k` of `n` trials tell (C. J. Clopper, E. S. Pearson, *Biometrika* 26, 1934).
pub fn clopper_pearson(k: usize, n: usize) -> [f64; 2] {
    // P(X <= k) for probability p, in logarithms.
    let at_most = |k: usize, p: f64| -> f64 {
        let mut term = n as f64 * (-p).ln_1p();
        let mut sum = term.exp();
        for i in 0..k {
            term += ((n - i) as f64 / (i + 1) as f64).ln() + p.ln() - (-p).ln_1p();
            sum += term.exp();
        }
        sum
    };
    let solve = |above: &dyn Fn(f64) -> bool| {
        let (mut low, mut high) = (0.0, 1.0);
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if above(middle) { high = middle } else { low = middle }
        }
        0.5 * (low + high)
    };
    let lower = if k == 0 { 0.0 } else { solve(&|p| 1.0 - at_most(k - 1, p) > 0.025) };
    let upper = if k >= n { 1.0 } else { solve(&|p| at_most(k, p) < 0.025) };
    [lower, upper]
}

/// 95 % interval of the mean of a Poisson count (F. Garwood, *Biometrika* 28, 1936).
pub fn poisson(count: usize) -> [f64; 2] {
    // P(X <= k) for the mean m.
    let at_most = |k: usize, m: f64| -> f64 {
        let mut term = (-m).exp();
        let mut sum = term;
        for i in 1..=k {
            term *= m / i as f64;
            sum += term;
        }
        sum
    };
    let solve = |above: &dyn Fn(f64) -> bool| {
        let (mut low, mut high) = (0.0, 10.0 + 3.0 * count as f64);
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if above(middle) { high = middle } else { low = middle }
        }
        0.5 * (low + high)
    };
    let lower = if count == 0 { 0.0 } else { solve(&|m| 1.0 - at_most(count - 1, m) > 0.025) };
    [lower, solve(&|m| at_most(count, m) < 0.025)]
}

#[cfg(test)]
mod tests {
    use super::{clopper_pearson, median, poisson, quantile};

    #[test]
    fn quantiles_of_a_few_values() {
        let values = vec![3.0, 1.0, 2.0, f64::INFINITY];
        assert_eq!((quantile(values.clone(), 0.5), quantile(values.clone(), 0.75)), (2.0, 3.0));
        assert_eq!(median(values.clone()), 3.0);
        assert!(quantile(values, 0.9).is_infinite() && quantile(Vec::new(), 0.5).is_nan());
    }

    #[test]
    fn exact_intervals_of_textbook_counts() {
        // 0 of 10: 1 - 0.025^(1/10); 1 of 10: 0.0025 to 0.4450.
        let [low, high] = clopper_pearson(0, 10);
        assert!(low == 0.0 && (high - (1.0 - 0.025_f64.powf(0.1))).abs() < 1e-9);
        let [low, high] = clopper_pearson(1, 10);
        assert!((low - 0.002_529).abs() < 1e-6 && (high - 0.445_016).abs() < 1e-6, "{low} {high}");
        assert_eq!(clopper_pearson(10, 10)[1], 1.0);
    }

    #[test]
    fn exact_intervals_of_poisson_counts() {
        // -ln 0.025; the tables of Garwood (1936): 0.0253 to 5.572 for 1, 4.795 to 18.39 for 10.
        let [low, high] = poisson(0);
        assert!(low == 0.0 && (high + 0.025_f64.ln()).abs() < 1e-9);
        for (count, expected) in [(1, [0.025_318, 5.571_643]), (10, [4.795_389, 18.390_356])] {
            let found = poisson(count);
            assert!((found[0] - expected[0]).abs() < 1e-5 && (found[1] - expected[1]).abs() < 1e-5, "{found:?}");
        }
    }
}
