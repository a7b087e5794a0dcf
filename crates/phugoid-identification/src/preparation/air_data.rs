//! Airspeed and flow angles without the noise of their sensors, gusts included.
//!
//! Accelerometers, gyroscopes and attitude say how the airspeed and the flow angles of an aircraft change in air that is
//! still ([`super::kinematics`]). A gust is the rest. It is taken for a random walk `w`, and an error of the sensors that make the rate `r` for a constant
//! `d`: `y' = r + d + w`, and `y` is measured with white noise. The ratio of both noises is the most likely one for the
//! innovations of a Kalman filter, and the smoother of Rauch, Tung and Striebel then has the signal as the aircraft felt it.
//! In calm air it is the integrated rate, in strong gusts nearly the measurement.
//!
//! Regressions of the aerodynamic model on states that are reconstructed so are the method of two steps (Mulder, Chu,
//! Sridhar, Breeman & Laban, Progress in Aerospace Sciences 35, 1999). Smoothing without the rates, by local polynomials,
//! takes the quick part of a manoeuvre away together with the noise.

use nalgebra::{Matrix2, Vector2};

use crate::core::output::{CHANNELS, Output};
use crate::motion::Motion;
use crate::preparation::kinematics::{INTEGRATED, rates};
use crate::preparation::noise::{measure_own_noise, without_outliers};
use crate::preparation::prepared::Prepared;

/// One sigma of the constant error of the rate of a signal that is smoothed: of an accelerometer that is 5 % of gravity off, m/s^2,
/// and of a gyroscope that is one degree per second off, rad/s. None of what is not smoothed.
fn drift_std(output: Output) -> Option<f64> {
    match output {
        Output::TrueAirspeed => Some(0.5),
        Output::Alpha | Output::Beta => Some(0.02),
        _ => None,
    }
}

/// Ratios of the variance of the random walk, per second, to that of the measurement, whose likelihoods are compared: powers
/// of the square root of ten from 1e-4 to 1e6.
const RATIOS: std::ops::RangeInclusive<i32> = -8..=12;

/// By how much gusts change a flow angle in a second, in sigmas of the noise of its vane, up to which the air counts as calm: in the
/// middle between the largest on the calm flights of the field's develop part, 0.18, and the smallest in light turbulence (0.8 m/s one
/// sigma), 1.75.
const CALM: f64 = 0.56;

/// The same in rad, likewise between 0.036 and 0.18 degrees: a record without noise is not in gusts because its angles are not quite
/// those that its samples of the rates add up to.
const CALM_RAD: f64 = 0.08 * std::f64::consts::PI / 180.0;

/// A record without the noise of airspeed and flow angles.
#[derive(Clone, Debug)]
pub(crate) struct AirData<const R: usize> {
    /// The outputs by sample, with airspeed and flow angles smoothed where they are outputs of the motion; all else is as
    /// measured. NaN where nothing has measured a signal for longer than the longest gap, before or after.
    pub(crate) outputs: Vec<[f64; R]>,
    /// By how much gusts change a flow angle in a second, in sigmas of the noise of its vane, the larger one; none in calm air.
    pub(crate) gusts: Option<f64>,
}

/// Smooths airspeed and flow angles. None where the kinematics miss a channel of the motion. `gravity` in m/s^2; across an
/// interval longer than `maximum_gap_s`, s, nothing is carried.
pub(crate) fn smoothed<M: Motion<N, R>, const N: usize, const R: usize>(
    prepared: &Prepared<M, N, R>,
    gravity: f64,
    maximum_gap_s: f64,
) -> Option<AirData<R>> {
    let mut channels = vec![[0.0; CHANNELS]; prepared.time.len()];
    let is_used = |output: &Output| {
        !matches!(output, Output::RollAcceleration | Output::PitchAcceleration | Output::YawAcceleration)
    };
    for output in Output::ALL.into_iter().filter(is_used) {
        for (channels, value) in channels.iter_mut().zip(channel(prepared, output)?) {
            channels[output.index()] = value;
        }
    }
    let rates: Vec<[f64; 5]> = channels.iter().map(|channels| rates(channels, gravity)).collect();
    let mut outputs = prepared.outputs.clone();
    let mut gusts: Option<f64> = None;
    for (i, output) in INTEGRATED.into_iter().enumerate() {
        let (Some(drift_std), Some(row)) = (drift_std(output), M::AXES.row(output)) else { continue };
        let rate: Vec<f64> = rates.iter().map(|rates| rates[i]).collect();
        let measured: Vec<f64> = prepared.outputs.iter().map(|y| y[row]).collect();
        // What has no noise needs no smoothing.
        let Some(noise) = measure_own_noise(&measured).filter(|noise| noise.std > 0.0) else { continue };
        let clean = without_outliers(&measured, noise.std);
        let filter = Filter { time_s: &prepared.time, rate: &filled(&rate)?, measured: &clean, maximum_gap_s };
        let drift_variance = (drift_std / noise.std).powi(2);
        let smoothed = filter.most_likely(noise.std, drift_variance);
        let sigmas = smoothed.ratio.sqrt();
        if output != Output::TrueAirspeed && sigmas > CALM && sigmas * smoothed.noise_std > CALM_RAD {
            gusts = Some(gusts.map_or(sigmas, |larger| larger.max(sigmas)));
        }
        for (output, value) in outputs.iter_mut().zip(smoothed.values) {
            output[row] = value;
        }
    }
    Some(AirData { outputs, gusts })
}

/// A channel by sample, SI, without outliers: measured, known beside the outputs, or zero of one that the motion does not have.
/// None where the motion has it and the record does not.
fn channel<M: Motion<N, R>, const N: usize, const R: usize>(
    prepared: &Prepared<M, N, R>,
    output: Output,
) -> Option<Vec<f64>> {
    let known = |input: &M::KnownInput| M::known_channel(input, output);
    let values: Vec<f64> = match M::AXES.row(output) {
        Some(row) => prepared.outputs.iter().map(|y| y[row]).collect(),
        None if prepared.inputs.first().and_then(known).is_some() => {
            prepared.inputs.iter().map(|input| known(input).unwrap_or(f64::NAN)).collect()
        }
        None => return Some(vec![0.0; prepared.inputs.len()]),
    };
    match measure_own_noise(&values) {
        Some(noise) => filled(&without_outliers(&values, noise.std)),
        None => filled(&values),
    }
}

/// The values with the last known one, at the beginning the first, in the place of missing ones; none without any.
fn filled(values: &[f64]) -> Option<Vec<f64>> {
    let mut last = *values.iter().find(|value| value.is_finite())?;
    let fill = |value: &f64| {
        if value.is_finite() {
            last = *value;
        }
        last
    };
    Some(values.iter().map(fill).collect())
}

/// One signal with its rate. The state is the signal and the constant error of the rate; variances count in units of the variance
/// of the measurement.
struct Filter<'a> {
    time_s: &'a [f64],
    rate: &'a [f64],
    measured: &'a [f64],
    maximum_gap_s: f64,
}

/// A signal without its noise.
struct Smoothed {
    values: Vec<f64>,
    /// The most likely ratio of the variance of the random walk, per second, to that of the measurement.
    ratio: f64,
    /// One sigma of the measurement with this ratio.
    noise_std: f64,
}

/// State and covariance before and after the measurement of a sample.
struct Step {
    /// From the sample before; none where the signal begins anew.
    transition: Option<Matrix2<f64>>,
    predicted: (Vector2<f64>, Matrix2<f64>),
    filtered: (Vector2<f64>, Matrix2<f64>),
}

/// Variance of the signal at a beginning, in units of that of its measurement: as good as unknown.
const UNKNOWN: f64 = 1e4;

impl Filter<'_> {
    /// The signal with the most likely ratio of the noises. `scale`: one sigma of the measurement, of which only the size matters.
    fn most_likely(&self, scale: f64, drift_variance: f64) -> Smoothed {
        let ratio = |power: i32| 10.0_f64.powf(0.5 * f64::from(power));
        let cost = |power: &i32| self.run(ratio(*power), scale, drift_variance, &mut |_| {}).0;
        let costs: Vec<(i32, f64)> = RATIOS.map(|power| (power, cost(&power))).collect();
        let best = costs.iter().min_by(|(_, a), (_, b)| a.total_cmp(b)).map_or(0, |(power, _)| *power);
        let mut steps = Vec::with_capacity(self.time_s.len());
        let (_, square) = self.run(ratio(best), scale, drift_variance, &mut |step| steps.push(step));
        let mut values = smooth(&steps);
        for (value, is_near) in values.iter_mut().zip(self.is_near_a_measurement()) {
            if !is_near {
                *value = f64::NAN;
            }
        }
        Smoothed { values, ratio: ratio(best), noise_std: scale * square.sqrt() }
    }

    /// By sample, whether something was measured within the longest gap, before or after: the rate alone knows no gusts.
    fn is_near_a_measurement(&self) -> Vec<bool> {
        let measured = self.time_s.iter().zip(self.measured).filter(|(_, value)| value.is_finite());
        let times: Vec<f64> = measured.map(|(time, _)| *time).collect();
        let is_near = |time: &f64| {
            let after = times.partition_point(|t| t < time);
            let neighbours = [after.checked_sub(1), Some(after)];
            let mut distances = neighbours.iter().flatten().filter_map(|k| times.get(*k)).map(|t| (t - time).abs());
            distances.any(|distance| distance <= self.maximum_gap_s)
        };
        self.time_s.iter().map(is_near).collect()
    }

    /// Runs the filter; gives twice the negative logarithm of the likelihood with the most likely size of both noises, and the variance
    /// of the measurement of that size, in units of `scale` squared.
    fn run(&self, ratio: f64, scale: f64, drift_variance: f64, each: &mut dyn FnMut(Step)) -> (f64, f64) {
        let (mut x, mut p) = (Vector2::zeros(), Matrix2::zeros());
        let (mut logarithms, mut squares, mut count) = (0.0, 0.0, 0.0);
        for k in 0..self.time_s.len() {
            let interval_s = if k == 0 { f64::INFINITY } else { self.time_s[k] - self.time_s[k - 1] };
            let transition = (interval_s <= self.maximum_gap_s).then(|| Matrix2::new(1.0, interval_s, 0.0, 1.0));
            match transition {
                Some(transition) => {
                    let moved = 0.5 * (self.rate[k - 1] + self.rate[k]) * interval_s;
                    x = transition * x + Vector2::new(moved, 0.0);
                    p = transition * p * transition.transpose();
                    p[(0, 0)] += ratio * interval_s;
                }
                None => {
                    let first = self.measured[k..].iter().find(|value| value.is_finite());
                    x = Vector2::new(first.copied().unwrap_or(f64::NAN), 0.0);
                    p = Matrix2::new(UNKNOWN, 0.0, 0.0, drift_variance);
                }
            }
            let predicted = (x, p);
            if self.measured[k].is_finite() {
                let s = p[(0, 0)] + 1.0;
                let innovation = self.measured[k] - x[0];
                let gain = p.column(0) / s;
                x += gain * innovation;
                p -= gain * gain.transpose() * s;
                logarithms += s.ln();
                squares += (innovation / scale).powi(2) / s;
                count += 1.0;
            }
            each(Step { transition, predicted, filtered: (x, p) });
        }
        (logarithms + count * (squares / count).ln(), squares / count)
    }
}

/// The signal of the steps of a filter, smoothed backwards.
fn smooth(steps: &[Step]) -> Vec<f64> {
    let mut states: Vec<Vector2<f64>> = steps.iter().map(|step| step.filtered.0).collect();
    for k in (1..steps.len()).rev() {
        let (before, after) = (&steps[k - 1], &steps[k]);
        let gain = after.transition.and_then(|transition| {
            let inverse = after.predicted.1.try_inverse()?;
            Some(before.filtered.1 * transition.transpose() * inverse)
        });
        if let Some(gain) = gain {
            states[k - 1] = before.filtered.0 + gain * (states[k] - after.predicted.0);
        }
    }
    states.iter().map(|state| state[0]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::core::random::Normal;

    /// Sample time, s, one sigma of the measurement, and the constant error of the rate, per second.
    const H: f64 = 0.02;
    const NOISE: f64 = 0.003;
    const DRIFT: f64 = 0.004;

    /// The signal, its rate without gusts, and the measurement.
    struct Signal {
        time_s: Vec<f64>,
        truth: Vec<f64>,
        rate: Vec<f64>,
        measured: Vec<f64>,
    }

    /// A manoeuvre of 40 s in gusts, the sigmas of whose noise per root of a second are given.
    fn signal(gusts: f64) -> Signal {
        let (mut random, mut gust) = (Normal(11), 0.0);
        let mut signal = Signal { time_s: Vec::new(), truth: Vec::new(), rate: Vec::new(), measured: Vec::new() };
        for k in 0..2000 {
            let t = H * f64::from(k);
            gust += gusts * NOISE * H.sqrt() * random.next();
            let truth = 0.05 * (1.5 * t).sin() + gust;
            signal.time_s.push(t);
            signal.truth.push(truth);
            signal.rate.push(0.075 * (1.5 * t).cos() - DRIFT);
            signal.measured.push(truth + NOISE * random.next());
        }
        signal
    }

    impl Signal {
        fn smoothed(&self) -> Smoothed {
            let filter =
                Filter { time_s: &self.time_s, rate: &self.rate, measured: &self.measured, maximum_gap_s: 1.0 };
            filter.most_likely(NOISE, (0.02 / NOISE).powi(2))
        }

        /// Root of the mean square of the error over the sigma of the measurement.
        fn error(&self, values: &[f64]) -> f64 {
            let squares: f64 = self.truth.iter().zip(values).map(|(truth, value)| (value - truth).powi(2)).sum();
            (squares / self.truth.len() as f64).sqrt() / NOISE
        }
    }

    /// Far from the ends the smoother of a random walk has the variance `sqrt(Q R h)/2` (Gelb, Applied Optimal Estimation, example
    /// 5.2-2, in continuous time), of the noise `sqrt(gusts sqrt(h)/2)` one sigma; without gusts a constant and a slope are fitted,
    /// `sqrt((1 + 1)/n)` (the rate's drift is as good as free). 20 % for one record.
    #[test]
    fn the_noise_is_told_from_gusts_and_a_drift_of_the_rate() {
        for gusts in [2.0, 5.0] {
            let signal = signal(gusts);
            let Smoothed { values, ratio, noise_std } = signal.smoothed();
            let (error, expected) = (signal.error(&values), (0.5 * gusts * H.sqrt()).sqrt());
            assert!((0.8..1.2).contains(&(error / expected)), "{gusts}: {error} {expected}");
            assert!((0.5..2.0).contains(&(ratio.sqrt() / gusts)), "{gusts}: {ratio}");
            assert!((0.9..1.1).contains(&(noise_std / NOISE)), "{gusts}: {noise_std}");
        }
        let calm = signal(0.0);
        let Smoothed { values, ratio, .. } = calm.smoothed();
        assert!(ratio.sqrt() < 0.2 && calm.error(&values) < 0.1, "{ratio} {}", calm.error(&values));
    }

    /// Missing measurements are bridged by the rate, a gap of the record is not, and an interval in which nothing is measured has
    /// no value.
    #[test]
    fn what_is_missing_is_bridged_and_a_gap_is_not() {
        let mut signal = signal(0.0);
        signal.measured[500..520].fill(f64::NAN);
        let values = signal.smoothed().values;
        assert!(signal.error(&values) < 0.1, "{}", signal.error(&values));
        // From a jump on, nothing is what it was before; between the two there is a gap.
        signal.time_s[1000..].iter_mut().for_each(|t| *t += 5.0);
        signal.measured[1000..].iter_mut().for_each(|y| *y += 1.0);
        let Smoothed { values, ratio, .. } = signal.smoothed();
        assert!(ratio.sqrt() < 0.2, "{ratio}");
        assert!(
            (values[999] - signal.truth[999]).abs() < NOISE && (values[1000] - signal.truth[1000] - 1.0).abs() < NOISE
        );
        signal.measured[1000..].fill(f64::NAN);
        let values = signal.smoothed().values;
        assert!(values[..1000].iter().all(|v| v.is_finite()) && values[1000..].iter().all(|v| v.is_nan()));
        // A part in which nothing is measured takes nothing from a later one, nor is a long time bridged within a part: the longest
        // gap is a second, 50 samples.
        let mut signal = super::tests::signal(0.0);
        signal.measured[..400].fill(f64::NAN);
        signal.measured[600..900].fill(f64::NAN);
        signal.time_s[200..].iter_mut().for_each(|t| *t += 5.0);
        let values = signal.smoothed().values;
        let unknown = |k: usize| k < 350 || (650..850).contains(&k);
        for (k, value) in values.iter().enumerate().filter(|(k, _)| ![349, 350, 649, 650, 849, 850].contains(k)) {
            assert_eq!(value.is_nan(), unknown(k), "{k}");
        }
    }
}
