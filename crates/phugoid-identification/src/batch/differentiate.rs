//! Smoothing and differentiation of measured signals by local polynomials.
//!
//! A cubic is fitted by least squares to the samples within half a window of each sample, and its value and slope there
//! are taken (Savitzky & Golay, Analytical Chemistry 36, 1964; Klein & Morelli, Aircraft System Identification, section
//! 11.3), for any sample times and with missing values. Centred windows have no phase lag. Near the ends a window would
//! be one-sided and the slope's error several times larger: there is no value there.

use nalgebra::{Matrix4, Vector4};

/// Local cubics over one set of sample times: both value and slope are weighted sums of the samples in a window.
#[derive(Clone, Debug)]
pub(crate) struct LocalCubics {
    /// One entry per sample; `None` near the ends and where too few values were measured.
    windows: std::rc::Rc<[Option<Window>]>,
}

#[derive(Clone, Debug)]
struct Window {
    /// First sample of the window.
    from: usize,
    /// Weights of the value and of the slope (1/s), by sample from there; zero for a missing one.
    weights: Vec<[f64; 2]>,
}

/// Half of the window over which a regression smooths, s: 0.2 s, or three sample times where those are longer.
pub(crate) fn half_window_s(sample_time_s: f64) -> f64 {
    f64::max(0.2, 3.0 * sample_time_s)
}

/// Fewest samples on each side of a window.
const SIDE: usize = 2;

impl LocalCubics {
    /// Windows of `half_window_s` to each side, over the samples at which `values` are finite.
    pub(crate) fn new(time_s: &[f64], values: &[f64], half_window_s: f64) -> Self {
        let samples = time_s.len().min(values.len());
        let (inner, outer) = (half_window_s * (1.0 - 1e-9), half_window_s * (1.0 + 1e-9));
        let window = |k: usize| {
            let centre = time_s[k];
            if time_s[0] > centre - inner || time_s[samples - 1] < centre + inner {
                return None;
            }
            let from = time_s.partition_point(|t| *t < centre - outer);
            let to = time_s[..samples].partition_point(|t| *t <= centre + outer);
            let present = |range: std::ops::Range<usize>| values[range].iter().filter(|v| v.is_finite()).count();
            if present(from..k) < SIDE || present(k + 1..to) < SIDE {
                return None;
            }
            let powers = |i: usize| {
                let s = (time_s[i] - centre) / half_window_s;
                Vector4::new(1.0, s, s * s, s * s * s)
            };
            let normal: Matrix4<f64> =
                (from..to).filter(|&i| values[i].is_finite()).map(|i| powers(i) * powers(i).transpose()).sum();
            let inverse = normal.cholesky()?.inverse();
            let weight = |i: usize| {
                let w = if values[i].is_finite() { inverse * powers(i) } else { Vector4::zeros() };
                [w[0], w[1] / half_window_s]
            };
            Some(Window { from, weights: (from..to).map(weight).collect() })
        };
        Self { windows: (0..samples).map(window).collect() }
    }

    /// Most samples that a window has to one side.
    pub(crate) fn reach(&self) -> usize {
        let side =
            |(k, w): (usize, &Option<Window>)| w.as_ref().map(|w| (k - w.from).max(w.from + w.weights.len() - 1 - k));
        self.windows.iter().enumerate().filter_map(side).max().unwrap_or(0)
    }

    /// The smoothed values; NaN where there is no window.
    pub(crate) fn values(&self, signal: &[f64]) -> Vec<f64> {
        self.apply(signal, 0)
    }

    /// The slopes, per second; NaN where there is no window.
    pub(crate) fn slopes(&self, signal: &[f64]) -> Vec<f64> {
        self.apply(signal, 1)
    }

    fn apply(&self, signal: &[f64], which: usize) -> Vec<f64> {
        let at = |(k, window): (usize, &Option<Window>)| {
            let Some(window) = window else { return f64::NAN };
            // The sum is taken about a nearby value, so that a large constant offset does not cost digits.
            let level = if signal[k].is_finite() { signal[k] } else { 0.0 };
            let pairs = window.weights.iter().zip(&signal[window.from..]).filter(|(w, _)| **w != [0.0; 2]);
            let sum: f64 = pairs.map(|(w, v)| w[which] * (v - level)).sum();
            if which == 0 { level + sum } else { sum }
        };
        self.windows.iter().enumerate().map(at).collect()
    }
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
        let cubics = LocalCubics::new(&time, &values, 0.25);
        let (smoothed, slopes) = (cubics.values(&values), cubics.slopes(&values));
        for (k, t) in time.iter().enumerate() {
            let inside = *t >= 0.25 && *t <= time[59] - 0.25;
            assert_eq!(smoothed[k].is_finite(), inside, "{t}");
            if inside {
                assert!((smoothed[k] - cubic(*t)).abs() < 1e-10 && (slopes[k] - slope(*t)).abs() < 1e-9);
            }
        }
    }

    #[test]
    fn a_gap_longer_than_half_a_window_has_no_value() {
        let time: Vec<f64> = (0..40).map(|k| 0.1 * f64::from(k)).collect();
        let mut values = time.clone();
        values[15..22].fill(f64::NAN);
        let smoothed = LocalCubics::new(&time, &values, 0.3).values(&values);
        assert!(smoothed[18].is_nan() && smoothed[10].is_finite() && smoothed[26].is_finite());
    }
}
