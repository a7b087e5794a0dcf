//! Measurement noise of a channel, from the channel itself.

use phugoid_flight_data::statistics::{Rank, median, median_step, quantile};

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
    let third = values.windows(4).map(|w| (w[3] - 3.0 * w[2] + 3.0 * w[1] - w[0]).abs());
    of_differences(third, values.windows(2).map(|w| (w[1] - w[0]).abs()))
}

/// The noise from third differences and from first ones, both without sign; what is not finite is left out.
fn of_differences(third: impl Iterator<Item = f64>, first: impl Iterator<Item = f64>) -> Option<MeasuredNoise> {
    let mut third: Vec<f64> = third.filter(|d| d.is_finite()).collect();
    if third.len() < 8 {
        return None;
    }
    let std = 1.4826 * median(&mut third)? / 20.0_f64.sqrt();
    // A recorder with few bits gives runs of equal values: its step bounds the noise from below.
    let step = first.filter(|d| *d > 0.0).min_by(f64::total_cmp).filter(|s| s.is_finite())?;
    let floor = step / 12.0_f64.sqrt();
    Some(if std < floor {
        MeasuredNoise { std: floor, quantised: true }
    } else {
        MeasuredNoise { std, quantised: false }
    })
}

/// The samples of a channel that is slower than the record it is in.
///
/// A slow instrument gives one value, and then none until its next one (NaN), or the same one again and again, because
/// somebody has put all channels on the times of the fastest. What stands between its own samples is no measurement, and
/// the noise of the channel is that of its own samples alone.
pub(crate) struct OwnSamples {
    /// Rows of the record with a sample of the channel's own.
    rows: Vec<usize>,
    /// Rows from one to the next, the median.
    every: usize,
}

/// Two of five rows at the least lie on a straight line (of a channel of half the rate of the record every second one does): what their
/// second differences are is the rounding of the file, and this part at most of the large ones, which nineteen of twenty rows do not
/// reach.
const STRAIGHT: f64 = 0.4;
const LARGE: f64 = 0.95;
const MOST_ROUNDING: f64 = 0.01;
/// A line bends in a row if its second difference is this part or more of the large ones, and so many times what rounding makes. Where
/// nothing moves, the noise of the slow channel bends it a thousandth as much as a manoeuvre does.
const BEND: f64 = 1e-4;
const BEYOND_ROUNDING: f64 = 10.0;
/// At most one of so many bends may be one of three on end.
const MOST_CURVED: usize = 20;
/// Fewer values of its own do not show that a channel is slow.
const FEWEST_OWN: usize = 12;

impl OwnSamples {
    /// The samples of a slow channel; `None` if the channel is as fast as the record, or no such rhythm is in it.
    pub(crate) fn of(values: &[f64]) -> Option<Self> {
        let finite: Vec<usize> = (0..values.len()).filter(|row| values[*row].is_finite()).collect();
        let mut changes = finite.clone();
        changes.dedup_by(|row, before| values[*row].to_bits() == values[*before].to_bits());
        [changes, finite].into_iter().find_map(Self::in_rhythm)
    }

    /// The samples of a slow channel that somebody has put on the times of a faster one by straight lines between them; `None` if
    /// most rows are no such lines. Second differences are then zero, but for the rounding of the file, in all rows but those
    /// with a sample of the channel's own; where none of them falls on a row, the row after it stands for it.
    pub(crate) fn on_straight_lines(values: &[f64]) -> Option<Self> {
        let bends: Vec<f64> = values.windows(3).map(|w| (w[2] - 2.0 * w[1] + w[0]).abs()).collect();
        let mut known: Vec<f64> = bends.iter().copied().filter(|bend| bend.is_finite()).collect();
        let large = quantile(&mut known, LARGE, Rank::Nearest)?;
        let rounding = quantile(&mut known, STRAIGHT, Rank::Nearest)?;
        if large <= 0.0 || rounding > MOST_ROUNDING * large {
            return None;
        }
        let least = (BEND * large).max(BEYOND_ROUNDING * rounding);
        let mut rows: Vec<usize> = (0..bends.len()).filter(|k| bends[*k] > least).map(|k| k + 1).collect();
        // A line never bends in three rows on end: a motion without noise does, behind a rest without any.
        let curved = rows.windows(3).filter(|w| w[2] == w[0] + 2).count();
        if MOST_CURVED * curved > rows.len() {
            return None;
        }
        // A sample between two rows bends the line at both.
        rows.dedup_by(|row, before| *row == *before + 1);
        Self::in_rhythm(rows)
    }

    /// Median time between the samples, s, of a channel whose rows are at the times given.
    pub(crate) fn step_s(&self, time_s: &[f64]) -> Option<f64> {
        median_step(&self.rows.iter().map(|row| time_s[*row]).collect::<Vec<_>>())
    }

    /// These rows, if they come in a rhythm that is slower than the record: nine of ten follow the one before by the same
    /// number of rows, or by one of two neighbouring numbers. The steps of a coarse recorder come whenever the signal
    /// has moved by one of them, and are in no rhythm.
    fn in_rhythm(rows: Vec<usize>) -> Option<Self> {
        if rows.len() < FEWEST_OWN {
            return None;
        }
        let gaps: Vec<f64> = rows.windows(2).map(|w| (w[1] - w[0]) as f64).collect();
        let middle = median(&mut gaps.clone())?;
        let short: Vec<f64> = gaps.iter().copied().filter(|gap| *gap <= 1.5 * middle).collect();
        let mean = short.iter().sum::<f64>() / short.len() as f64;
        let regular = gaps.iter().filter(|gap| (*gap - mean).abs() < f64::max(1.0, 0.05 * mean)).count();
        (middle >= 2.0 && 10 * regular >= 9 * gaps.len()).then_some(Self { rows, every: middle as usize })
    }

    /// The rows of the record that hold them.
    pub(crate) fn rows(&self) -> &[usize] {
        &self.rows
    }

    /// How many of them are in the first rows of the record.
    pub(crate) fn up_to(&self, rows: usize) -> usize {
        self.rows.partition_point(|row| *row < rows)
    }

    /// The noise of the first `most` samples of the channel's own, as [`measure_noise`] gives that of a fast one: motion
    /// that is no parabola over four of these samples counts as noise.
    pub(crate) fn noise(&self, values: &[f64], most: usize) -> Option<MeasuredNoise> {
        let rows = &self.rows[..most.min(self.rows.len())];
        let near = |w: &[usize]| (w[1] - w[0]).abs_diff(self.every) <= (self.every / 10).max(1);
        let pairs = rows.windows(2).filter(|w| near(w)).map(|w| (values[w[1]] - values[w[0]]).abs());
        let third = rows.windows(4).filter(|w| w.windows(2).all(near));
        let third = third.map(|w| (values[w[3]] - 3.0 * values[w[2]] + 3.0 * values[w[1]] - values[w[0]]).abs());
        of_differences(third, pairs)
    }
}

/// As [`measure_noise`], and of a channel that is slower than the record from its own samples, whether the rows between
/// them are missing (NaN), repeat the last value or lie on the straight line to the next one.
///
/// ```
/// use phugoid_identification::noise::{measure_noise, measure_own_noise};
/// // One value in ten rows, off by 0.5 to either side, and repeated.
/// let values: Vec<f64> = (0..400).map(|row| if row / 10 * 7 % 5 < 2 { 20.5 } else { 19.5 + 1e-9 * f64::from(row / 10) }).collect();
/// let (own, rows) = (measure_own_noise(&values).ok_or("too short")?, measure_noise(&values).ok_or("too short")?);
/// assert!(own.std > 0.1 && rows.std < 1e-6, "{own:?} {rows:?}");
/// # Ok::<(), &str>(())
/// ```
pub fn measure_own_noise(values: &[f64]) -> Option<MeasuredNoise> {
    match OwnSamples::of(values).or_else(|| OwnSamples::on_straight_lines(values)) {
        Some(own) => own.noise(values, usize::MAX),
        None => measure_noise(values),
    }
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

    /// A channel of one value per second in a record of a hundred rows per second, of which the rows between are missing,
    /// hold the last value, or come now one row early and now one late.
    #[test]
    fn the_noise_of_a_slow_channel_is_that_of_its_own_samples() {
        let mut seed = 5;
        let own: Vec<f64> = (0..200).map(|k| 100.0 + (0.05 * f64::from(k)).sin() + 0.3 * noise(&mut seed)).collect();
        let sparse: Vec<f64> = (0..20_000).map(|row| if row % 100 == 0 { own[row / 100] } else { f64::NAN }).collect();
        let held: Vec<f64> = (0..20_000).map(|row| own[row / 100]).collect();
        let uneven: Vec<f64> = (0..660).map(|row| own[row * 3 / 10]).collect();
        // Neither is what the rows of the record say.
        assert_eq!(measure_noise(&sparse), None);
        assert!(measure_noise(&held).unwrap().std < 0.01);
        for values in [&sparse, &held, &uneven] {
            let found = measure_own_noise(values).unwrap();
            assert!((0.24..0.36).contains(&found.std) && !found.quantised, "{found:?}");
        }
    }

    /// A channel of 5 or 7 values per second that was put on 50 rows per second by straight lines, written with nine digits.
    #[test]
    fn a_slow_channel_on_straight_lines_is_known_by_its_bends() {
        let mut seed = 3;
        for every in [2.0, 5.0, 10.0, 50.0 / 7.0] {
            let own: Vec<f64> =
                (0..2000).map(|k| -9.8 + (0.4 * f64::from(k)).sin() + 0.02 * noise(&mut seed)).collect();
            let values: Vec<f64> = (0..2000)
                .map(|row| {
                    let at = f64::from(row) / every;
                    let (k, part) = (at as usize, at.fract());
                    ((own[k] + part * (own[k + 1] - own[k])) * 1e8).round() / 1e8
                })
                .collect();
            let found = OwnSamples::on_straight_lines(&values).unwrap_or_else(|| panic!("{every}"));
            assert!(
                (found.rows.len() as f64 - 2000.0 / every).abs() < 0.05 * 2000.0 / every,
                "{every}: {}",
                found.rows.len()
            );
            assert!(OwnSamples::of(&values).is_none());
            let [as_rows, as_own] =
                [measure_noise(&values), measure_own_noise(&values)].map(|found| found.unwrap().std);
            assert!(as_own > 0.01 && (every < 3.0 || as_rows < 0.2 * as_own), "{every}: {as_rows} {as_own}");
        }
    }

    #[test]
    fn a_fast_channel_and_a_coarse_recorder_are_in_no_rhythm() {
        let mut seed = 9;
        let fast: Vec<f64> = (0..400).map(|k| (0.02 * f64::from(k)).sin() + 0.01 * noise(&mut seed)).collect();
        let coarse: Vec<f64> = (0..400).map(|k| ((0.02 * f64::from(k)).sin() * 20.0).round() / 20.0).collect();
        let noisy_and_coarse: Vec<f64> = fast.iter().map(|v| (v * 50.0).round() / 50.0).collect();
        let lossy: Vec<f64> = fast.iter().enumerate().map(|(k, v)| if k % 7 == 3 { f64::NAN } else { *v }).collect();
        // A motion without any noise, behind a rest.
        let clean: Vec<f64> = (0..400).map(|k| if k < 250 { 1.0 } else { (0.02 * f64::from(k - 250)).cos() }).collect();
        assert!(OwnSamples::on_straight_lines(&clean).is_none());
        for values in [&fast, &coarse, &noisy_and_coarse, &lossy] {
            assert!(OwnSamples::of(values).is_none() && OwnSamples::on_straight_lines(values).is_none());
            assert_eq!(measure_own_noise(values), measure_noise(values));
        }
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
