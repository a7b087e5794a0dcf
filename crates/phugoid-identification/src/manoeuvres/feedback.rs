//! What a control loop moves a surface by, taken out of its position: an input is what is left.
//!
//! A damper or an autopilot answers the motion of the aircraft, so that the position of the surface follows the rates and
//! angles all the time and an input begins and ends where nobody moved the stick. The gains of such a loop show in the
//! differences over a fifth of a second, in which trims cancel and steps are rare:
//!
//! ```text
//! d u = K1 d x(t) + K2 d x(t - 0.06 s) + what was asked for,      d u = u(t) - u(t - 0.2 s)
//! ```
//!
//! with the rates and angles `x` of the surface's axes; the earlier ones stand for the lag of the actuator. Steps and
//! doublets are rare among the samples and far from what the loop does: Cauchy's weights leave them out (P. W. Holland, R.
//! E. Welsch, *Robust regression using iteratively reweighted least-squares*, Commun. Stat. 6, 1977). Without a loop the
//! gains come out as zero, because the free motion after an input moves no surface. A stick that moves all the time leaves
//! much more than noise; then nothing is taken out, because the gains might be those of the aircraft's answer turned round.
//! Nor is it where the surface moves at one frequency: the aircraft answers with the same frequency, and two signals of one
//! frequency explain any third.

use nalgebra::{DMatrix, DVector};
use phugoid_flight_data::statistics::{median_step, robust_std};

use super::activity::medians;
use super::record::{Sampled, Signals};
use crate::preparation::noise::measure_noise;
use crate::preparation::resample::at_times;

/// Time over which differences are taken, s.
const OVER_S: f64 = 0.2;
/// Earlier rates and angles that stand for the lag of an actuator, and the mean that is taken of each signal, s.
const LAG_S: f64 = 0.06;
/// Fewest differences, and about how many are taken of a long record.
const FEWEST: usize = 200;
const MOST: usize = 20_000;
/// Most rounds of new weights, and the change of the scale from which on there is none.
const MOST_ROUNDS: usize = 50;
const SETTLED: f64 = 1e-3;
/// Residuals of so many robust sigmas have half the weight.
const HALF_WEIGHT: f64 = 2.0;
/// A loop leaves at most this part of the differences.
const HELPS: f64 = 0.85;
/// What is left is that of a loop if its differences are at most this many times those of the noise of the position, ...
const NOISE: f64 = 3.0;
/// ... or at most this part of what they were.
const PART: f64 = 0.35;
/// A position moves at one frequency if its second differences over this time, s, are its own negative but for this part
/// of their squares. A short period with a damping of 0.3 leaves more than a tenth.
const TONE_S: f64 = 0.1;
const TONE_LEAVES: f64 = 0.05;
/// Noise below this, rad, is rounding.
const SMALLEST: f64 = 1e-4;

/// Rates and angles that move a surface.
fn motions(surface: &str) -> &'static [&'static str] {
    match surface {
        "elevator" => &["q", "theta", "alpha"],
        "aileron" => &["p", "phi", "r", "beta"],
        _ => &["r", "p", "beta", "phi"],
    }
}

/// The position of a surface less what a control loop moves it by. The position as it was recorded where there is no loop,
/// or where it cannot be told from a stick that moves all the time. `None` if the surface was not recorded.
pub(super) fn commanded(signals: &Signals<'_>, surface: &str) -> Option<Sampled> {
    let recorded = signals.channel(surface)?;
    Some(without_loop(signals, surface, recorded).unwrap_or_else(|| recorded.clone()))
}

fn without_loop(signals: &Signals<'_>, surface: &str, recorded: &Sampled) -> Option<Sampled> {
    let time = &recorded.time;
    let of = |name: &&str| {
        signals.channel(name).map(|motion| at_times(time.iter().copied(), &motion.time, &medians(&motion.values)))
    };
    let columns: Vec<Vec<f64>> = motions(surface).iter().filter_map(of).collect();
    let step = median_step(time)?;
    if columns.is_empty() || time.len() < FEWEST || step > LAG_S {
        return None;
    }
    let samples = |seconds: f64| ((seconds / step).round() as usize).max(1);
    let (over, lag, half) = (samples(OVER_S).max(3), samples(LAG_S), samples(LAG_S) / 2);
    let smooth: Vec<Vec<f64>> = columns.iter().map(|values| means(values, half)).collect();
    let position = means(&medians(&recorded.values), half);
    if is_tone(&position, samples(TONE_S)) {
        return None;
    }
    let at = |k: usize| smooth.iter().map(move |x| x[k]).chain(smooth.iter().map(move |x| x[k.saturating_sub(lag)]));
    // Differences over a gap are none.
    let whole = |k: &usize| time[*k] - time[k - over] < 1.5 * over as f64 * step;
    let rows: Vec<usize> = (over..time.len()).step_by(time.len().div_ceil(MOST)).filter(whole).collect();
    let count = 2 * smooth.len();
    if rows.len() < FEWEST {
        return None;
    }
    let mut regressors = DMatrix::zeros(rows.len(), count);
    for (row, &k) in rows.iter().enumerate() {
        for (column, (now, before)) in at(k).zip(at(k - over)).enumerate() {
            regressors[(row, column)] = now - before;
        }
    }
    let target = DVector::from_iterator(rows.len(), rows.iter().map(|&k| position[k] - position[k - over]));
    let (gains, left) = robust(&regressors, &target)?;
    let before = robust_std(target.iter().copied()).unwrap_or(0.0);
    let noise = recorded.noise.max(SMALLEST) * std::f64::consts::SQRT_2;
    if left > HELPS * before || left > (NOISE * noise).max(PART * before) {
        return None;
    }
    let values: Vec<f64> = recorded
        .values
        .iter()
        .enumerate()
        .map(|(k, value)| value - at(k).zip(gains.iter()).map(|(x, gain)| x * gain).sum::<f64>())
        .collect();
    let noise = measure_noise(&values).map_or(recorded.noise, |noise| noise.std).max(recorded.noise);
    Some(Sampled { time: time.clone(), values, noise })
}

/// True if `x'' = -w^2 x + c` describes the position.
fn is_tone(position: &[f64], lag: usize) -> bool {
    let pairs: Vec<(f64, f64)> = position
        .windows(2 * lag + 1)
        .map(|window| (window[lag], window[0] - 2.0 * window[lag] + window[2 * lag]))
        .filter(|(x, curve)| x.is_finite() && curve.is_finite())
        .collect();
    let count = pairs.len() as f64;
    let mean = |of: &dyn Fn(&(f64, f64)) -> f64| pairs.iter().map(of).sum::<f64>() / count;
    let (x0, curve0) = (mean(&|p| p.0), mean(&|p| p.1));
    let (xx, xc, cc) =
        (mean(&|p| (p.0 - x0).powi(2)), mean(&|p| (p.0 - x0) * (p.1 - curve0)), mean(&|p| (p.1 - curve0).powi(2)));
    xc < 0.0 && cc * xx - xc * xc < TONE_LEAVES * cc * xx
}

/// The gains and the robust sigma of what they leave. `None` if the regressors do not move.
fn robust(regressors: &DMatrix<f64>, target: &DVector<f64>) -> Option<(DVector<f64>, f64)> {
    // In units of their own size, with a little of a prior on zero: neighbours in time are nearly equal.
    let scale: Vec<f64> = regressors.column_iter().map(|c| (c.norm_squared() / c.len() as f64).sqrt()).collect();
    if scale.iter().any(|s| *s <= 0.0 || !s.is_finite()) {
        return None;
    }
    let mut scaled = regressors.clone();
    scaled.column_iter_mut().zip(&scale).for_each(|(mut c, s)| c /= *s);
    // From no loop at all: all that moves together with the aircraft, such as its own answers, stands out of it.
    let weigh =
        |residuals: &DVector<f64>, sigma: f64| residuals.map(|r| 1.0 / (1.0 + (r / (HALF_WEIGHT * sigma)).powi(2)));
    let mut left = robust_std(target.iter().copied()).unwrap_or(0.0).max(1e-9);
    let mut weights = weigh(target, left);
    let mut gains = DVector::zeros(scale.len());
    for _ in 0..MOST_ROUNDS {
        let mut weighted = scaled.clone();
        weighted.row_iter_mut().zip(weights.iter()).for_each(|(mut row, w)| row *= *w);
        let mut normal = weighted.transpose() * &scaled;
        let ridge = 1e-6 * target.len() as f64;
        (0..normal.nrows()).for_each(|i| normal[(i, i)] += ridge);
        gains = normal.cholesky()?.solve(&(weighted.transpose() * target));
        let residuals = target - &scaled * &gains;
        let now = robust_std(residuals.iter().copied()).unwrap_or(0.0).max(1e-9);
        weights = weigh(&residuals, now);
        let settled = (now - left).abs() < SETTLED * now;
        left = now;
        if settled {
            break;
        }
    }
    Some((DVector::from_iterator(scale.len(), gains.iter().zip(&scale).map(|(g, s)| g / s)), left))
}

/// Running means over `half` samples to each side; shorter at the ends.
fn means(values: &[f64], half: usize) -> Vec<f64> {
    let mut sums = Vec::with_capacity(values.len() + 1);
    let mut sum = 0.0;
    sums.push(sum);
    for value in values {
        sum += value;
        sums.push(sum);
    }
    (0..values.len())
        .map(|k| {
            let (from, to) = (k.saturating_sub(half), (k + half + 1).min(values.len()));
            (sums[to] - sums[from]) / (to - from) as f64
        })
        .collect()
}
