//! Measurement noise, estimated from the measurements themselves.
//!
//! Third differences `y_k - 3 y_{k-1} + 3 y_{k-2} - y_{k-3}` remove any motion that is quadratic over three samples and
//! have `1 + 9 + 9 + 1 = 20` times the variance of white noise; the median of their size is not affected by single
//! outliers: `sigma = 1.4826 med|d3| / sqrt(20)`.
//!
//! It needs a sample rate well above the motion: where the signal bends within three samples (a 10 Hz record of a
//! 1 Hz manoeuvre) it reads motion as noise and comes out too large. A signal quantised more coarsely than its noise
//! may give zero: use a part of the quantum then.
//!
//! ```
//! # mod lag { include!(concat!(env!("CARGO_MANIFEST_DIR"), "/doc/lag.rs")); }
//! use lag::{NOISE, flight};
//! use phugoid_estimators::noise::{NoiseMonitor, third_difference_std};
//!
//! let measured: Vec<f64> = flight(10.0, |_| 3.0).iter().map(|sample| sample.outputs[0]).collect();
//! let mut scratch = [0.0; 1000];
//! let std = third_difference_std(&measured, &mut scratch).unwrap();
//! assert!((std / NOISE - 1.0).abs() < 0.15, "{std}");
//! // The same sample by sample, over the last 100 third differences.
//! let mut monitor = NoiseMonitor::<1, 100>::new();
//! for y in &measured {
//!     monitor.push(&[*y]);
//! }
//! assert!((monitor.std()[0].unwrap() / NOISE - 1.0).abs() < 0.3);
//! ```

use crate::statistics::median;

/// Noise standard deviation of a regularly sampled signal, in its units. Values that are not finite are missing.
/// `scratch` must be at least as long as `values`. `None` with fewer than five usable third differences.
pub fn third_difference_std(values: &[f64], scratch: &mut [f64]) -> Option<f64> {
    let mut count = 0;
    for window in values.windows(4) {
        let size = third_difference(window[3], window[2], window[1], window[0]).abs();
        if size.is_finite()
            && let Some(place) = scratch.get_mut(count)
        {
            *place = size;
            count += 1;
        }
    }
    from_sizes(scratch.get_mut(..count)?)
}

fn third_difference(y: f64, y1: f64, y2: f64, y3: f64) -> f64 {
    y - 3.0 * y1 + 3.0 * y2 - y3
}

fn from_sizes(sizes: &mut [f64]) -> Option<f64> {
    // 1.4826: ratio of standard deviation and median absolute deviation of a normal variable.
    (sizes.len() >= 5).then(|| 1.4826 * median(sizes) / libm::sqrt(20.0))
}

/// Noise of `R` outputs over the last `W` third differences, sample by sample. `W` = one second's worth is enough for
/// 10 to 20 % (100 Hz).
#[derive(Clone, Copy, Debug)]
pub struct NoiseMonitor<const R: usize, const W: usize> {
    recent: [[f64; 3]; R],
    sizes: [[f64; W]; R],
    count: [usize; R],
}

impl<const R: usize, const W: usize> NoiseMonitor<R, W> {
    /// A monitor that has not seen a sample.
    pub fn new() -> Self {
        Self { recent: [[f64::NAN; 3]; R], sizes: [[0.0; W]; R], count: [0; R] }
    }

    /// Takes the outputs of one sample; not finite is missing.
    pub fn push(&mut self, outputs: &[f64; R]) {
        for i in 0..R {
            let [y1, y2, y3] = self.recent[i];
            let size = third_difference(outputs[i], y1, y2, y3).abs();
            self.recent[i] = [outputs[i], y1, y2];
            if size.is_finite() && W > 0 {
                self.sizes[i][self.count[i] % W] = size;
                // Kept below 2 W: the position, and whether the ring has been filled.
                self.count[i] = if self.count[i] + 1 >= 2 * W { W } else { self.count[i] + 1 };
            }
        }
    }

    /// Standard deviation per output; `None` while fewer than five third differences are known.
    pub fn std(&self) -> [Option<f64>; R] {
        core::array::from_fn(|i| {
            let mut sizes = self.sizes[i];
            from_sizes(&mut sizes[..self.count[i].min(W)])
        })
    }
}

impl<const R: usize, const W: usize> Default for NoiseMonitor<R, W> {
    fn default() -> Self {
        Self::new()
    }
}
