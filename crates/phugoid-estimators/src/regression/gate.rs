//! Outliers: measurements far from what the model predicts.

use crate::bounded::limited;

/// A channel that has been refused for this long, s, is used again: it is not an outlier but a new level.
const BELIEVED_AGAIN_S: f64 = 0.25;
/// ... and at least this many frames.
const BELIEVED_AGAIN_FRAMES: u32 = 5;
/// Frames over which the size of the prediction error is learnt.
const LEARNING_FRAMES: f64 = 50.0;

/// Refuses measurements that lie far from their prediction, by the learnt size of the prediction error of each channel.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Gate<const R: usize> {
    limit: f64,
    /// Smallest variance, that of the measurement noise.
    floor: [f64; R],
    variance: [f64; R],
    refused: [u32; R],
    refused_since_s: [f64; R],
}

impl<const R: usize> Gate<R> {
    pub(crate) fn new(limit: f64, noise_std: &[f64; R]) -> Self {
        let floor = noise_std.map(|std| if std.is_finite() { std * std } else { 0.0 });
        // The prediction carries the noise of the last frame as well.
        Self { limit, floor, variance: floor.map(|v| 2.0 * v), refused: [0; R], refused_since_s: [0.0; R] }
    }

    /// The measurements with NaN in place of outliers. `spread` is the part of the prediction's variance that comes
    /// from the uncertainty of the parameters.
    pub(crate) fn pass(
        &mut self,
        time_s: f64,
        measured: &[f64; R],
        predicted: &[f64; R],
        spread: impl Fn(usize) -> f64,
    ) -> [f64; R] {
        let mut passed = *measured;
        for i in 0..R {
            let squared = (measured[i] - predicted[i]) * (measured[i] - predicted[i]);
            if !squared.is_finite() || self.floor[i] <= 0.0 {
                continue;
            }
            let spread = spread(i).max(0.0);
            if squared > self.limit * self.limit * (self.variance[i] + spread) {
                if self.refused[i] == 0 {
                    self.refused_since_s[i] = time_s;
                }
                self.refused[i] = self.refused[i].saturating_add(1);
                let long = time_s - self.refused_since_s[i] >= BELIEVED_AGAIN_S;
                if !(long && self.refused[i] >= BELIEVED_AGAIN_FRAMES) {
                    passed[i] = f64::NAN;
                    continue;
                }
            }
            self.refused[i] = 0;
            let excess = limited(squared - spread, 0.0, 9.0 * self.variance[i]);
            self.variance[i] = (self.variance[i] + (excess - self.variance[i]) / LEARNING_FRAMES).max(self.floor[i]);
        }
        passed
    }
}

#[cfg(test)]
mod tests {
    use super::Gate;

    #[test]
    fn refuses_a_spike_and_believes_a_new_level_after_a_quarter_of_a_second() {
        let mut gate = Gate::new(6.0, &[0.1]);
        let mut at = |k: u32, y: f64| gate.pass(f64::from(k) * 0.01, &[y], &[0.0], |_| 0.0)[0];
        for k in 0..100 {
            let y = 0.1 * f64::from(k).sin();
            assert_eq!(at(k, y), y);
        }
        assert!(at(100, 2.0).is_nan());
        assert_eq!(at(101, 0.1), 0.1);
        let first_believed = (102..200).find(|&k| at(k, 2.0).is_finite());
        assert_eq!(first_believed, Some(102 + 25));
    }

    #[test]
    fn what_the_parameters_do_not_know_is_no_outlier() {
        let mut gate = Gate::new(6.0, &[0.1]);
        assert_eq!(gate.pass(0.0, &[2.0], &[0.0], |_| 1.0)[0], 2.0);
        assert!(gate.pass(0.01, &[f64::NAN], &[0.0], |_| 1.0)[0].is_nan());
    }
}
