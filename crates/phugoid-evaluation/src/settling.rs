//! When an estimate has arrived.

/// First time from which on `values` stay within `tolerance` (a fraction of the truth) of `truth`; none if they never do.
///
/// A truth of zero has no fraction: give `tolerance` in parameter units times `1/|truth|`, or do not ask. Values that are
/// not finite are outside. `time` and `values` are of one length.
///
/// ```
/// use phugoid_evaluation::settling::settled_at;
///
/// let (time, estimate) = ([0.0, 1.0, 2.0, 3.0], [0.0, -2.0, -2.2, -2.05]);
/// assert_eq!(settled_at(&time, &estimate, -2.0, 0.05), Some(3.0)); // it was inside at 1 s, and left again
/// ```
pub fn settled_at(time: &[f64], values: &[f64], truth: f64, tolerance: f64) -> Option<f64> {
    let outside = |value: &f64| !value.is_finite() || (value - truth).abs() > tolerance * truth.abs();
    let first_inside = values.iter().rposition(outside).map_or(0, |last| last + 1);
    if first_inside >= values.len() { None } else { time.get(first_inside).copied() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_last_excursion_counts() {
        let time = [0.0, 1.0, 2.0, 3.0];
        assert_eq!(settled_at(&time, &[0.0, -2.0, -2.2, -2.05], -2.0, 0.05), Some(3.0));
        assert_eq!(settled_at(&time, &[-2.0, -2.0, -2.0, -2.0], -2.0, 0.05), Some(0.0));
        assert_eq!(settled_at(&time, &[-2.0, -2.0, -2.0, 0.0], -2.0, 0.05), None);
        assert_eq!(settled_at(&time, &[f64::NAN, -2.0, f64::NAN, -2.0], -2.0, 0.05), Some(3.0));
        assert_eq!(settled_at(&[], &[], 1.0, 0.05), None);
    }
}
