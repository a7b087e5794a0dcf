//! Outliers: measurements far from what the model predicts.

use crate::bounded::limited;
use crate::statistics::median;

/// A channel that has been refused for this long, s, is used again: it is not an outlier but a new level.
const BELIEVED_AGAIN_S: f64 = 0.25;
/// ... and at least this many frames.
const BELIEVED_AGAIN_FRAMES: u32 = 5;
/// Frames in succession that are refused whatever the other channels show: single outliers.
const REFUSED_IN_SUCCESSION: u32 = 2;
/// Memory of the mean squares of the prediction errors, frames, and the largest that counts.
const MEMORY_FRAMES: f64 = 10.0;
const LARGEST_SQUARE: f64 = 9.0;
/// Median of the other channels' mean squares below which they are undisturbed.
const UNDISTURBED: f64 = 2.0;
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
    /// A channel that is used again is used until its prediction fits. Otherwise it is refused again at once, and one
    /// value in a quarter of a second is used.
    stays_open: bool,
    /// Bounded mean square of each channel's normalised prediction error.
    mean_square: [f64; R],
}

impl<const R: usize> Gate<R> {
    pub(crate) fn new(limit: f64, noise_std: &[f64; R], stays_open: bool) -> Self {
        let floor = noise_std.map(|std| if std.is_finite() { std * std } else { 0.0 });
        // The prediction carries the noise of the last frame as well.
        Self {
            limit,
            floor,
            variance: floor.map(|v| 2.0 * v),
            refused: [0; R],
            refused_since_s: [0.0; R],
            stays_open,
            mean_square: [0.0; R],
        }
    }

    /// True if there are other channels and they are not predicted well either: by their median, so that two bursts that
    /// overlap do not confirm each other.
    fn others_show_it(&self, channel: usize) -> bool {
        let mut others = [0.0; R];
        let mut count = 0;
        for (i, (square, floor)) in self.mean_square.iter().zip(&self.floor).enumerate() {
            if i != channel
                && *floor > 0.0
                && let Some(place) = others.get_mut(count)
            {
                *place = *square;
                count += 1;
            }
        }
        count > 0 && median(&mut others[..count.min(R)]) >= UNDISTURBED
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
            if self.stays_open {
                let normalised = (squared / (self.variance[i] + spread)).min(LARGEST_SQUARE);
                self.mean_square[i] += (normalised - self.mean_square[i]) / MEMORY_FRAMES;
            }
            if squared > self.limit * self.limit * (self.variance[i] + spread) {
                if self.refused[i] == 0 {
                    self.refused_since_s[i] = time_s;
                }
                self.refused[i] = self.refused[i].saturating_add(1);
                let long = time_s - self.refused_since_s[i] >= BELIEVED_AGAIN_S;
                // What the others show as well is not a burst of outliers of this channel, but the aircraft.
                let shared = self.stays_open && self.refused[i] > REFUSED_IN_SUCCESSION && self.others_show_it(i);
                if !(shared || long && self.refused[i] >= BELIEVED_AGAIN_FRAMES) {
                    passed[i] = f64::NAN;
                    continue;
                }
                if self.stays_open {
                    // Predictions are as wrong as that: the next ones may be.
                    self.variance[i] = self.variance[i].max(squared / 9.0);
                } else {
                    self.refused[i] = 0;
                }
            } else {
                self.refused[i] = 0;
            }
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
        let mut gate = Gate::new(6.0, &[0.1], false);
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

    /// What was believed again is believed until the prediction fits, and a spike after that is refused.
    #[test]
    fn a_channel_that_is_used_again_stays_open_until_its_prediction_fits() {
        let mut gate = Gate::new(6.0, &[0.1], true);
        let mut at = |k: u32, y: f64, prediction: f64| gate.pass(f64::from(k) * 0.01, &[y], &[prediction], |_| 0.0)[0];
        let believed = (0..100).filter(|&k| at(k, 20.0, 0.0).is_finite()).count();
        assert_eq!(believed, 100 - 25);
        assert!((100..200).all(|k| at(k, 20.0, 20.0).is_finite()));
        assert!(at(200, 90.0, 20.0).is_nan());
    }

    /// First parameters that are far off: all channels leave their predictions, and are refused for two frames and not for
    /// most of the manoeuvre. A burst in one of them is refused as before.
    #[test]
    fn what_all_channels_show_is_believed() {
        let pass = |gate: &mut Gate<3>, k: u32, y: [f64; 3]| {
            gate.pass(f64::from(k) * 0.02, &y, &[0.0; 3], |_| 0.0).map(|y| y.is_finite())
        };
        let all = |stays_open: bool| {
            let mut gate = Gate::new(6.0, &[0.1; 3], stays_open);
            // Growing, so that a level that has been learnt is soon too small again.
            (0..100).filter(|&k| pass(&mut gate, k, [2.0 + f64::from(k); 3])[0]).count()
        };
        assert!(all(true) >= 95 && all(false) <= 10, "{} {}", all(true), all(false));
        let mut gate = Gate::new(6.0, &[0.1; 3], true);
        assert!((0..12).all(|k| pass(&mut gate, k, [20.0, 0.1, -0.1]) == [false, true, true]));
    }

    #[test]
    fn what_the_parameters_do_not_know_is_no_outlier() {
        let mut gate = Gate::new(6.0, &[0.1], false);
        assert_eq!(gate.pass(0.0, &[2.0], &[0.0], |_| 1.0)[0], 2.0);
        assert!(gate.pass(0.01, &[f64::NAN], &[0.0], |_| 1.0)[0].is_nan());
    }
}
