//! Medians, ranges and slopes that single wild values do not move.

use crate::statistics::{self, Rank};

/// Median of the finite values; `None` if there is none.
pub(super) fn median_of_finite(values: impl Iterator<Item = f64>) -> Option<f64> {
    let mut finite: Vec<f64> = values.filter(|value| value.is_finite()).collect();
    statistics::median(&mut finite)
}

/// The 5 and 95 % quantiles of the finite values: the range of the signal without its outliers.
pub(super) fn span(values: &[f64]) -> Option<(f64, f64)> {
    let mut finite: Vec<f64> = values.iter().copied().filter(|value| value.is_finite()).collect();
    let mut at = |fraction| statistics::quantile(&mut finite, fraction, Rank::Nearest);
    Some((at(0.05)?, at(0.95)?))
}

/// The [`span`] of values whose [`largest_size`] is above a limit; `None` if it is not. That of most channels is not, which the
/// largest value of all tells without any order of the values.
pub(super) fn span_beyond(values: &[f64], limit: f64) -> Option<(f64, f64)> {
    let largest = values.iter().map(|value| value.abs()).filter(|size| size.is_finite()).fold(0.0, f64::max);
    (largest > limit).then(|| span(values)).flatten().filter(|span| largest_size(*span) > limit)
}

/// The absolute value that 98 % of the finite values do not exceed; `None` if there is none.
pub(super) fn magnitude(values: &[f64]) -> Option<f64> {
    let mut sizes: Vec<f64> = values.iter().map(|value| value.abs()).filter(|value| value.is_finite()).collect();
    statistics::quantile(&mut sizes, 0.98, Rank::Nearest)
}

/// The larger absolute value of the two ends of a range.
pub(super) fn largest_size((low, high): (f64, f64)) -> f64 {
    low.abs().max(high.abs())
}

/// The regression of a signal on what should cause it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Fit {
    /// Change of the signal per change of the cause.
    pub(super) slope: f64,
    /// Correlation coefficient of the two, from -1 to 1.
    pub(super) correlation: f64,
    /// Number of windows.
    pub(super) windows: usize,
}

impl Fit {
    /// The correlation from which on the two move together: `least`, and in a record of few windows what noise does not make by chance
    /// (three standard errors of the correlation of noise).
    pub(super) fn together(&self, least: f64) -> bool {
        self.correlation > least.max(3.0 / (self.windows as f64).sqrt())
    }
}

/// Regression of the changes of a signal over windows of about `width` seconds on the integrals of `rate` over the same
/// windows. `None` for fewer than ten whole windows, or if one of the two does not move.
pub(super) fn fit(time: &[f64], signal: &[f64], rate: impl Fn(usize) -> f64, width: f64) -> Option<Fit> {
    regress(&windows(time, signal, rate, width))
}

/// The change of the signal and the integral of the rate (trapezoidal rule) for each window; windows across a gap are
/// left out.
pub(super) fn windows(time: &[f64], signal: &[f64], rate: impl Fn(usize) -> f64, width: f64) -> Vec<(f64, f64)> {
    let mut pairs = Vec::new();
    let mut start = 0;
    // The rate at the end of what was integrated last: it begins the next interval, and a rate may cost a few sines.
    let mut known: Option<(usize, f64)> = None;
    while start + 1 < time.len() {
        let mut end = start;
        let mut integral = 0.0;
        while end + 1 < time.len() && time[end] - time[start] < width - 1e-9 {
            let before = known.filter(|(at, _)| *at == end).map_or_else(|| rate(end), |(_, rate)| rate);
            let after = rate(end + 1);
            integral += 0.5 * (before + after) * (time[end + 1] - time[end]);
            end += 1;
            known = Some((end, after));
        }
        // A window that is much too long lies across a gap.
        if time[end] - time[start] < 1.5 * width {
            pairs.push((signal[end] - signal[start], integral));
        }
        start = end.max(start + 1);
    }
    pairs
}

/// Regression of the first of each pair on the second; pairs that are not finite are left out. `None` for fewer than
/// ten pairs, or if one of the two is constant.
pub(super) fn regress(pairs: &[(f64, f64)]) -> Option<Fit> {
    let pairs: Vec<(f64, f64)> = pairs.iter().copied().filter(|(a, b)| a.is_finite() && b.is_finite()).collect();
    if pairs.len() < 10 {
        return None;
    }
    let windows = pairs.len();
    let n = windows as f64;
    let (mean_a, mean_b) = pairs.iter().fold((0.0, 0.0), |(a, b), pair| (a + pair.0 / n, b + pair.1 / n));
    let (mut aa, mut bb, mut ab) = (0.0, 0.0, 0.0);
    for (a, b) in pairs {
        aa += (a - mean_a) * (a - mean_a);
        bb += (b - mean_b) * (b - mean_b);
        ab += (a - mean_a) * (b - mean_b);
    }
    (aa > 0.0 && bb > 0.0).then(|| Fit { slope: ab / bb, correlation: ab / (aa.sqrt() * bb.sqrt()), windows })
}
