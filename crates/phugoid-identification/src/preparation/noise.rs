//! Measurement noise of a channel, from the channel itself.

use phugoid_flight_data::statistics::median;

/// The measured noise of one channel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeasuredNoise {
    /// Standard deviation of the noise, in the channel's unit.
    pub std: f64,
    /// True if the noise is below the step of the recorder: `std` is then that of rounding, the step over the root of
    /// 12.
    pub quantised: bool,
}

/// One sigma of the white noise on a channel, from its third differences.
///
/// `sigma = 1.4826 median|x_k - 3 x_(k-1) + 3 x_(k-2) - x_(k-3)| / sqrt(20)`: the third difference removes any motion
/// that is a parabola over four samples, its noise has the variance `(1 + 9 + 9 + 1) sigma^2`, and 1.4826 makes a sigma
/// of a median, which outliers cannot move. NaN counts as missing, and every difference with a missing value is left
/// out. `None` if there are fewer than eight third differences, or if the channel is constant.
///
/// Motion that is not smooth over four samples counts as noise: the value is then too large, never too small.
///
/// ```
/// use phugoid_identification::noise::measure_noise;
/// // Smooth motion, recorded in steps of 0.1.
/// let values: Vec<f64> = (0..400).map(|k| (10.0 * (0.01 * f64::from(k)).sin() * 10.0).round() / 10.0).collect();
/// let noise = measure_noise(&values).ok_or("too short")?;
/// assert!(noise.std < 0.1, "{noise:?}");
/// assert_eq!(measure_noise(&[2.0; 400]), None); // a constant channel says nothing of its noise
/// # Ok::<(), &str>(())
/// ```
pub fn measure_noise(values: &[f64]) -> Option<MeasuredNoise> {
    let mut third: Vec<f64> =
        values.windows(4).map(|w| (w[3] - 3.0 * w[2] + 3.0 * w[1] - w[0]).abs()).filter(|d| d.is_finite()).collect();
    if third.len() < 8 {
        return None;
    }
    let std = 1.4826 * median(&mut third)? / 20.0_f64.sqrt();
    // A recorder with few bits gives runs of equal values: its step bounds the noise from below.
    let step = values
        .windows(2)
        .map(|w| (w[1] - w[0]).abs())
        .filter(|d| *d > 0.0)
        .min_by(f64::total_cmp)
        .filter(|s| s.is_finite())?;
    let floor = step / 12.0_f64.sqrt();
    Some(if std < floor {
        MeasuredNoise { std: floor, quantised: true }
    } else {
        MeasuredNoise { std, quantised: false }
    })
}

/// Values this many sigmas of the noise from the median of the five around them are outliers.
const OUTLIER: f64 = 8.0;

/// The values of a channel with noise of one sigma `noise_std`, and NaN in the place of outliers: samples that stand out
/// of the median of the five around them, and of both neighbours, by more than eight sigmas. A step is none.
pub(crate) fn without_outliers(values: &[f64], noise_std: f64) -> Vec<f64> {
    let mut clean = values.to_vec();
    for (k, around) in values.windows(5).enumerate() {
        let mut present: Vec<f64> = around.iter().copied().filter(|v| v.is_finite()).collect();
        let alone = [1, 3].iter().all(|i| {
            let distance = around[2] - around[*i];
            !distance.is_finite() || distance.abs() > OUTLIER * noise_std
        });
        if alone && median(&mut present).is_some_and(|middle| (around[2] - middle).abs() > OUTLIER * noise_std) {
            clean[k + 2] = f64::NAN;
        }
    }
    clean
}

/// One sigma of an output, and where it comes from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct NoiseLevel {
    /// As the model file gives it, else measured from the record.
    pub(crate) std: f64,
    pub(crate) measured: bool,
    /// The white noise of the beginning of the record, whatever the model file gives; zero where it cannot be measured.
    pub(crate) white: f64,
}

impl NoiseLevel {
    /// An output that is not used.
    pub(crate) const NONE: Self = Self { std: 0.0, measured: false, white: 0.0 };

    /// A level that the model file gives, of an output whose white noise is not known.
    #[cfg(test)]
    pub(crate) const fn given(std: f64) -> Self {
        Self { std, measured: false, white: 0.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A reproducible unit-variance sequence: the sum of twelve uniform numbers from a linear congruential generator.
    fn noise(seed: &mut u64) -> f64 {
        let mut sum = -6.0;
        for _ in 0..12 {
            *seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            sum += (*seed >> 11) as f64 / (1_u64 << 53) as f64;
        }
        sum
    }

    #[test]
    fn noise_is_found_under_motion_and_outliers() {
        let mut seed = 1;
        let values: Vec<f64> = (0..400)
            .map(|k| {
                let t = 0.01 * f64::from(k);
                let outlier = if k % 20 == 7 { 20.0 * 0.01 } else { 0.0 };
                (2.0 * t).sin() + 0.01 * noise(&mut seed) + outlier
            })
            .collect();
        let found = measure_noise(&values).unwrap();
        // 5 % outliers touch a fifth of the third differences; the median then lies 25 % high.
        assert!((0.009..0.0145).contains(&found.std), "{found:?}");
        assert!(!found.quantised);
    }

    #[test]
    fn a_coarse_recorder_bounds_the_noise_and_a_dead_channel_has_none() {
        let steps: Vec<f64> = (0..200).map(|k| f64::from(k / 50) * 0.1).collect();
        let found = measure_noise(&steps).unwrap();
        assert!(found.quantised && (found.std - 0.1 / 12.0_f64.sqrt()).abs() < 1e-9);
        assert_eq!(measure_noise(&[1.0; 100]), None);
        assert_eq!(measure_noise(&[1.0, 2.0, 3.0]), None);
        assert_eq!(measure_noise(&[f64::NAN; 100]), None);
    }
}
