//! Median and quantiles of samples, with one definition each for the whole project.
//!
//! Both give a value that is really among the samples (nothing is interpolated), order values by [`f64::total_cmp`] and
//! so count NaN and infinities as values: a positive NaN counts as larger than everything. Filter with
//! [`f64::is_finite`] first where such samples mean "missing".

/// The middle value: of `n` values the one with `n / 2` smaller ones in front, so that of an even number it is the
/// larger of the two in the middle. `None` for an empty slice. The slice is reordered.
///
/// NaN and infinities count as values, see the [module](self). Takes time in proportion to `n`.
///
/// ```
/// use phugoid_flight_data::statistics::median;
/// assert_eq!(median(&mut [3.0, 1.0, 2.0]), Some(2.0));
/// assert_eq!(median(&mut [4.0, 1.0, 2.0, 3.0]), Some(3.0)); // the larger of 2 and 3, not 2.5
/// assert_eq!(median(&mut []), None);
/// ```
pub fn median(values: &mut [f64]) -> Option<f64> {
    nth(values, values.len() / 2)
}

/// Which sample stands for a quantile that lies between two of them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rank {
    /// The sample nearest to the position `(n - 1) fraction`, counted from 0; of two equally near the upper one.
    Nearest,
    /// The sample at or below the position `(n - 1) fraction`, counted from 0.
    Lower,
    /// The smallest sample that at least this fraction of all samples do not exceed: the inverse of the empirical
    /// distribution (R. J. Hyndman, Y. Fan, *The American Statistician* 50, 1996, definition 1).
    InverseDistribution,
}

/// The quantile of a fraction from 0 (the smallest value) to 1 (the largest); a fraction outside is taken as the nearer
/// end, a NaN as 0. `None` for an empty slice. The slice is reordered.
///
/// NaN and infinities count as values, see the [module](self). Takes time in proportion to the number of values.
///
/// ```
/// use phugoid_flight_data::statistics::{Rank, quantile};
/// let mut values = [5.0, 1.0, 4.0, 2.0, 3.0];
/// assert_eq!(quantile(&mut values, 0.9, Rank::Nearest), Some(5.0)); // position 3.6
/// assert_eq!(quantile(&mut values, 0.9, Rank::Lower), Some(4.0));
/// assert_eq!(quantile(&mut values, 0.2, Rank::InverseDistribution), Some(1.0)); // one of five is not larger
/// assert_eq!(quantile(&mut [], 0.5, Rank::Nearest), None);
/// ```
pub fn quantile(values: &mut [f64], fraction: f64, rank: Rank) -> Option<f64> {
    let last = values.len().checked_sub(1)?;
    let index = match rank {
        Rank::Nearest => (last as f64 * fraction).round() as usize,
        Rank::Lower => (last as f64 * fraction).floor() as usize,
        Rank::InverseDistribution => ((fraction * values.len() as f64).ceil() as usize).saturating_sub(1),
    };
    nth(values, index.min(last))
}

/// One sigma of a normal distribution with the same median of the absolute values, in the unit of the values: outliers
/// hardly count. Take the middle away first where it is not zero. Values that are not finite are left out; `None` without
/// any other. (P. J. Huber, *Robust Statistics*, 1981: the median absolute deviation of a normal variable is 0.6745 sigma.)
///
/// ```
/// use phugoid_flight_data::statistics::robust_std;
/// assert_eq!(robust_std([1.0, -1.0, 1.0, f64::NAN, -500.0].into_iter()), Some(1.4826));
/// assert_eq!(robust_std([].into_iter()), None);
/// ```
pub fn robust_std(values: impl Iterator<Item = f64>) -> Option<f64> {
    let mut sizes: Vec<f64> = values.map(f64::abs).filter(|v| v.is_finite()).collect();
    median(&mut sizes).map(|m| 1.4826 * m)
}

/// The median of the finite steps from one time to the next, in the unit of the times; `None` if there is no finite
/// step.
///
/// ```
/// use phugoid_flight_data::statistics::median_step;
/// assert_eq!(median_step(&[0.0, 0.5, 1.0, 4.0]), Some(0.5)); // a gap does not move it
/// assert_eq!(median_step(&[0.0]), None);
/// ```
pub fn median_step(time: &[f64]) -> Option<f64> {
    let mut steps: Vec<f64> = time.windows(2).map(|pair| pair[1] - pair[0]).filter(|step| step.is_finite()).collect();
    median(&mut steps)
}

/// The value with `index` values before it in order.
fn nth(values: &mut [f64], index: usize) -> Option<f64> {
    (index < values.len()).then(|| *values.select_nth_unstable_by(index, f64::total_cmp).1)
}

/// The one value of values that are all the same; `None` of others and where there is none. NaN is left out.
pub fn constant(values: &[f64]) -> Option<f64> {
    let mut present = values.iter().copied().filter(|value| !value.is_nan());
    let first = present.next()?;
    present.all(|value| value == first).then_some(first)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn descending(n: usize) -> Vec<f64> {
        (0..n).rev().map(|i| i as f64).collect()
    }

    #[test]
    fn ranks_agree_with_their_definitions_in_whole_numbers() {
        for n in 1..400_usize {
            let mut values = descending(n);
            assert_eq!(median(&mut values), Some((n / 2) as f64));
            // Percentages, so that the definition can be computed in integers.
            for percent in [5_usize, 10, 25, 50, 75, 90, 95] {
                let fraction = percent as f64 / 100.0;
                let lower = (n - 1) * percent / 100;
                assert_eq!(quantile(&mut values, fraction, Rank::Lower), Some(lower as f64), "{n} {percent}");
                let inverse = (n * percent).div_ceil(100) - 1;
                // Where n * fraction is a whole number, the product in floating point may be one ulp too large.
                let found = quantile(&mut values, fraction, Rank::InverseDistribution).unwrap_or(f64::NAN);
                let exact = (n * percent).is_multiple_of(100);
                assert!(found == inverse as f64 || exact && found == inverse as f64 + 1.0, "{n} {percent} {found}");
            }
        }
    }

    #[test]
    fn ends_and_values_that_are_not_finite() {
        let values = [2.0, f64::INFINITY, 1.0];
        for rank in [Rank::Nearest, Rank::Lower, Rank::InverseDistribution] {
            for (fraction, expected) in [(-1.0, 1.0), (0.0, 1.0), (f64::NAN, 1.0), (1.0, f64::INFINITY)] {
                assert_eq!(quantile(&mut values.clone(), fraction, rank), Some(expected), "{rank:?} {fraction}");
            }
            assert_eq!(quantile(&mut values.clone(), 7.0, rank), Some(f64::INFINITY), "{rank:?}");
        }
        assert_eq!(median(&mut values.clone()), Some(2.0));
        assert!(quantile(&mut [1.0, f64::NAN], 1.0, Rank::Nearest).is_some_and(f64::is_nan));
        assert_eq!(median_step(&[f64::NAN, 0.0, 0.1]), Some(0.1));
    }
}
