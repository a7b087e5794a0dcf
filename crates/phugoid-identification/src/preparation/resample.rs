//! A signal at other times than those of its samples.

/// The signal at these times (s), straight between its samples and held at its ends. `own` are the times of its values, at
/// least two and rising; a NaN among the values is passed on to the times beside it.
pub(crate) fn at_times(times: impl Iterator<Item = f64>, own: &[f64], values: &[f64]) -> Vec<f64> {
    let at = |t: f64| {
        let after = own.partition_point(|known| *known < t).clamp(1, own.len() - 1);
        let part = ((t - own[after - 1]) / (own[after] - own[after - 1])).clamp(0.0, 1.0);
        values[after - 1] + part * (values[after] - values[after - 1])
    };
    times.map(at).collect()
}

/// A channel as it would be if it had been recorded so much earlier, s; straight between samples, held at the ends.
pub(crate) fn earlier(time_s: &[f64], values: &[f64], by_s: f64) -> Vec<f64> {
    at_times(time_s.iter().map(|t| t + by_s), time_s, values)
}
