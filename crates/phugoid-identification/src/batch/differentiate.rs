//! Smoothing and differentiation of measured signals by local polynomials.
//!
//! A cubic is fitted by least squares to the samples within half a window of each sample, and its value and slope there
//! are taken (Savitzky & Golay, Analytical Chemistry 36, 1964; Klein & Morelli, Aircraft System Identification, section
//! 11.3), for any sample times and with missing values. Centred windows have no phase lag. Near the ends a window would be
//! one-sided and the slope's error several times larger: there is no value there.

use nalgebra::{Matrix4, Vector4};

/// A smoothed signal; NaN near the ends, at long gaps and where nothing was measured.
#[derive(Clone, Debug)]
pub(crate) struct Smoothed {
    pub(crate) value: Vec<f64>,
    /// Per second.
    pub(crate) slope: Vec<f64>,
}

/// Fewest samples on each side of a window.
const SIDE: usize = 2;

/// Smooths `values` at `time_s` with windows of `half_window_s` to each side.
pub(crate) fn smooth(time_s: &[f64], values: &[f64], half_window_s: f64) -> Smoothed {
    let samples = time_s.len().min(values.len());
    let mut smoothed = Smoothed { value: vec![f64::NAN; samples], slope: vec![f64::NAN; samples] };
    let half = half_window_s * (1.0 + 1e-9);
    let (mut from, mut to) = (0, 0);
    for k in 0..samples {
        let centre = time_s[k];
        while time_s[from] < centre - half {
            from += 1;
        }
        while to < samples && time_s[to] <= centre + half {
            to += 1;
        }
        let whole = time_s[0] <= centre - half_window_s * (1.0 - 1e-9)
            && time_s[samples - 1] >= centre + half_window_s * (1.0 - 1e-9);
        let present = |range: std::ops::Range<usize>| values[range].iter().filter(|v| v.is_finite()).count();
        if !whole || present(from..k) < SIDE || present(k + 1..to) < SIDE {
            continue;
        }
        let (mut normal, mut right) = (Matrix4::<f64>::zeros(), Vector4::<f64>::zeros());
        for i in (from..to).filter(|&i| values[i].is_finite()) {
            let s = (time_s[i] - centre) / half_window_s;
            let powers = Vector4::new(1.0, s, s * s, s * s * s);
            normal += powers * powers.transpose();
            // About the centre value, so that a large constant costs no digits.
            right += powers * (values[i] - reference(values, from, to));
        }
        if let Some(coefficients) = normal.cholesky().map(|c| c.solve(&right)) {
            smoothed.value[k] = coefficients[0] + reference(values, from, to);
            smoothed.slope[k] = coefficients[1] / half_window_s;
        }
    }
    smoothed
}

fn reference(values: &[f64], from: usize, to: usize) -> f64 {
    values[from..to].iter().copied().find(|v| v.is_finite()).unwrap_or(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cubic_is_exact_at_uneven_times_and_the_ends_have_no_value() {
        let time: Vec<f64> = (0..60).map(|k| 0.05 * f64::from(k) + 0.01 * f64::from(k % 3)).collect();
        let cubic = |t: f64| 200.0 + 2.0 * t - 3.0 * t * t + 0.5 * t * t * t;
        let slope = |t: f64| 2.0 - 6.0 * t + 1.5 * t * t;
        let mut values: Vec<f64> = time.iter().map(|t| cubic(*t)).collect();
        values[30] = f64::NAN;
        let smoothed = smooth(&time, &values, 0.25);
        for (k, t) in time.iter().enumerate() {
            let inside = *t >= 0.25 && *t <= time[59] - 0.25;
            assert_eq!(smoothed.value[k].is_finite(), inside, "{t}");
            if inside {
                assert!((smoothed.value[k] - cubic(*t)).abs() < 1e-10 && (smoothed.slope[k] - slope(*t)).abs() < 1e-9);
            }
        }
    }

    #[test]
    fn a_gap_longer_than_half_a_window_has_no_value() {
        let time: Vec<f64> = (0..40).map(|k| 0.1 * f64::from(k)).collect();
        let mut values = time.clone();
        values[15..22].fill(f64::NAN);
        let smoothed = smooth(&time, &values, 0.3);
        assert!(smoothed.value[18].is_nan() && smoothed.value[10].is_finite() && smoothed.value[26].is_finite());
    }
}
