//! What a control loop moves a surface by, taken out of its position: an input is what is left.
//!
//! A damper or an autopilot answers the motion of the aircraft, so that the position of the surface follows the rates and
//! angles all the time and an input begins and ends where nobody moved the stick. The gains of such a loop show in the
//! differences over a fifth of a second, in which trims cancel and steps are rare:
//!
//! ```text
//! d u = K d x(t) + what was asked for,      d u = u(t) - u(t - 0.2 s)
//! ```
//!
//! with the rates and angles `x` of the surface's axes behind the lag of an actuator, of which a few are tried. Steps and
//! doublets are rare among the samples and far from what the loop does: Cauchy's weights leave them out (P. W. Holland, R.
//! E. Welsch, *Robust regression using iteratively reweighted least-squares*, Commun. Stat. 6, 1977). Without a loop the
//! gains come out as zero, because the free motion after an input moves no surface.
//!
//! A stick that moves all the time is followed by the aircraft, and the aircraft's own answer, turned round, gives the
//! position of the surface from the rates and angles as well as a loop does. Two things tell the two apart. A loop comes
//! after the motion and the aircraft comes after the surface: rates and angles are therefore never taken ahead of time, nor
//! differentiated. And a loop works against the motion, while the surface that makes a motion works with it: gains with the
//! sign of the latter are left out. A position that such gains do not explain stays as it was recorded. Whether they do is
//! asked where they move the surface visibly, so that a record that is mostly quiet says it too.
//!
//! Nothing is taken out where the surface moves at one frequency: the aircraft answers with the same frequency, and two
//! signals of one frequency explain any third.

use nalgebra::{DMatrix, DVector};
use phugoid_flight_data::statistics::{median_step, robust_std};

use super::activity::medians;
use super::record::{Sampled, Signals};
use crate::preparation::noise::measure_noise;
use crate::preparation::resample::at_times;

/// Time over which differences are taken, s.
const OVER_S: f64 = 0.2;
/// Mean that is taken of each signal, s, and the longest step of a record in which a loop can be seen.
const MEAN_S: f64 = 0.06;
/// Time constants of an actuator that are tried, s.
const LAGS_S: [f64; 4] = [0.005, 0.03, 0.06, 0.1];
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

/// Rates and angles that move a surface, with the sign that a stabilising gain has (docs/units-and-signs.md: a positive
/// surface makes a negative moment about its axis); `None` where either sign is usual. The aircraft's own answer, turned
/// round, has the other sign: there the surface holds the moment against which the aircraft moves.
fn motions(surface: &str) -> &'static [(&'static str, Option<f64>)] {
    match surface {
        "elevator" => &[("q", Some(1.0)), ("theta", Some(1.0)), ("alpha", Some(1.0))],
        "aileron" => &[("p", Some(1.0)), ("phi", Some(1.0)), ("r", None), ("beta", None)],
        _ => &[("r", Some(1.0)), ("p", None), ("beta", Some(-1.0)), ("phi", None)],
    }
}

/// A rate or an angle at the times of the surface.
struct Column {
    values: Vec<f64>,
    sign: Option<f64>,
}

/// The position of a surface less what a control loop moves it by. The position as it was recorded where there is no loop,
/// or where it cannot be told from a stick that moves all the time. `None` if the surface was not recorded.
pub(super) fn commanded(signals: &Signals<'_>, surface: &str) -> Option<Sampled> {
    let recorded = signals.channel(surface)?;
    Some(without_loop(signals, surface, recorded).unwrap_or_else(|| recorded.clone()))
}

fn without_loop(signals: &Signals<'_>, surface: &str, recorded: &Sampled) -> Option<Sampled> {
    let time = &recorded.time;
    let of = |(name, sign): &(&str, Option<f64>)| {
        let motion = signals.channel(name)?;
        Some(Column { values: at_times(time.iter().copied(), &motion.time, &medians(&motion.values)), sign: *sign })
    };
    let columns: Vec<Column> = motions(surface).iter().filter_map(of).collect();
    let step = median_step(time)?;
    if columns.is_empty() || time.len() < FEWEST || step > MEAN_S {
        return None;
    }
    let samples = |seconds: f64| ((seconds / step).round() as usize).max(1);
    let (over, half) = (samples(OVER_S).max(3), samples(MEAN_S) / 2);
    let smooth: Vec<Vec<f64>> = columns.iter().map(|column| means(&column.values, half)).collect();
    let position = means(&medians(&recorded.values), half);
    if is_tone(&position, samples(TONE_S)) {
        return None;
    }
    // Differences over a gap are none.
    let whole = |k: &usize| time[*k] - time[k - over] < 1.5 * over as f64 * step;
    let rows: Vec<usize> = (over..time.len()).step_by(time.len().div_ceil(MOST)).filter(whole).collect();
    if rows.len() < FEWEST {
        return None;
    }
    let target = DVector::from_iterator(rows.len(), rows.iter().map(|&k| position[k] - position[k - over]));
    let fitted = LAGS_S.iter().filter_map(|lag_s| {
        let late: Vec<Vec<f64>> = smooth.iter().map(|x| lagged(time, x, *lag_s)).collect();
        let regressors =
            DMatrix::from_fn(rows.len(), late.len(), |row, c| late[c][rows[row]] - late[c][rows[row] - over]);
        stabilising(regressors, &columns, &target).map(|(gains, left)| (left, gains, late))
    });
    let (_, gains, late) = fitted.min_by(|a, b| a.0.total_cmp(&b.0))?;
    // Whether there is a loop shows where it moves the surface visibly.
    let noise = recorded.noise.max(SMALLEST) * std::f64::consts::SQRT_2;
    let predicted = |k: usize| late.iter().zip(gains.iter()).map(|(x, gain)| (x[k] - x[k - over]) * gain).sum::<f64>();
    let visible: Vec<usize> = (0..rows.len()).filter(|row| predicted(rows[*row]).abs() > noise).collect();
    let before = robust_std(visible.iter().map(|row| target[*row])).unwrap_or(0.0);
    let after = robust_std(visible.iter().map(|row| target[*row] - predicted(rows[*row]))).unwrap_or(0.0);
    if visible.len() < FEWEST / 4 || after > HELPS * before || after > (NOISE * noise).max(PART * before) {
        return None;
    }
    let values: Vec<f64> = recorded
        .values
        .iter()
        .enumerate()
        .map(|(k, value)| value - late.iter().zip(gains.iter()).map(|(x, gain)| x[k] * gain).sum::<f64>())
        .collect();
    let noise = measure_noise(&values).map_or(recorded.noise, |noise| noise.std).max(recorded.noise);
    Some(Sampled { time: time.clone(), values, noise })
}

/// A signal behind a lag of the first order, whose time constant is `lag_s`.
fn lagged(time: &[f64], values: &[f64], lag_s: f64) -> Vec<f64> {
    let mut state = values.first().copied().unwrap_or(0.0);
    let mut before = time.first().copied().unwrap_or(0.0);
    let mut lagged = Vec::with_capacity(values.len());
    for (&t, &value) in time.iter().zip(values) {
        state += (1.0 - (-(t - before) / lag_s).exp()) * (value - state);
        before = t;
        lagged.push(state);
    }
    lagged
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

/// The gains with a stabilising sign, zero for those that would have the other one, and the robust sigma of what they leave.
/// `None` if no such gain is left.
fn stabilising(mut regressors: DMatrix<f64>, columns: &[Column], target: &DVector<f64>) -> Option<(DVector<f64>, f64)> {
    let mut used: Vec<usize> = (0..regressors.ncols()).collect();
    loop {
        let (gains, left) = robust(&regressors, target)?;
        let size = |i: usize| gains[i] * regressors.column(i).norm();
        let wrong = |i: &usize| columns[used[*i]].sign.is_some_and(|sign| gains[*i] * sign < 0.0);
        let Some(worst) = (0..used.len()).filter(wrong).max_by(|a, b| size(*a).abs().total_cmp(&size(*b).abs())) else {
            let mut all = DVector::zeros(columns.len());
            used.iter().zip(gains.iter()).for_each(|(column, gain)| all[*column] = *gain);
            return Some((all, left));
        };
        used.remove(worst);
        if used.is_empty() {
            return None;
        }
        regressors = regressors.remove_column(worst);
    }
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
pub(super) fn means(values: &[f64], half: usize) -> Vec<f64> {
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

#[cfg(test)]
mod tests {
    use super::*;
    use phugoid_flight_data::record::Record;

    const STEP_S: f64 = 0.02;

    /// Flights of an aircraft with a fast short period: `alpha' = q - 2 alpha`, `q' = -9 alpha - 4 q - 20 elevator`, and the
    /// elevator `asked(t) + gain q` behind an actuator of 20 rad/s. 40 s at 50 Hz, noise of 0.0003 rad and rad/s.
    fn flown(asked: impl Fn(f64) -> f64, gain: f64) -> Record {
        let mut seed = 7_u64;
        let mut noise = || {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            // Uniform, with a sigma of 0.0003.
            1.04e-3 * ((seed >> 11) as f64 / (1_u64 << 53) as f64 - 0.5)
        };
        let (mut alpha, mut q, mut elevator, mut theta) = (0.0, 0.0, 0.0, 0.0);
        let mut columns = vec![Vec::new(); 5];
        for k in 0..20_000 {
            let t = 0.1 * STEP_S * f64::from(k);
            if k % 10 == 0 {
                for (column, value) in columns.iter_mut().zip([t, elevator, q, alpha, theta]) {
                    column.push(value);
                }
            }
            let h = 0.1 * STEP_S;
            elevator += 20.0 * h * (asked(t) + gain * q - elevator);
            let turning = -9.0 * alpha - 4.0 * q - 20.0 * elevator;
            (alpha, q, theta) = (alpha + h * (q - 2.0 * alpha), q + h * turning, theta + h * q);
        }
        columns[1..].iter_mut().flatten().for_each(|value| *value += noise());
        let names = ["time_s", "elevator_rad", "q_rad_s", "alpha_rad", "theta_rad"];
        Record::from_columns("a flight", names.into_iter().zip(columns)).unwrap()
    }

    /// A hand: waves without a common period, from 3 s on.
    fn stick(t: f64) -> f64 {
        if t < 3.0 { 0.0 } else { 0.01 * ((2.3 * t).sin() + (3.7 * t + 1.0).sin() + (5.9 * t + 2.0).sin()) }
    }

    /// Largest difference of what was found and what was asked for, apart from the trim, rad.
    fn off(record: &Record, asked: impl Fn(f64) -> f64) -> f64 {
        let found = commanded(&Signals::of(record), "elevator").unwrap();
        let differences = found.time.iter().zip(&found.values).map(|(t, value)| value - asked(*t));
        let (low, high) = differences.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), d| (l.min(d), h.max(d)));
        0.5 * (high - low)
    }

    #[test]
    fn the_answer_of_the_aircraft_to_a_stick_is_no_loop() {
        let record = flown(stick, 0.0);
        let found = commanded(&Signals::of(&record), "elevator").unwrap();
        assert_eq!(found.values, record.channel("elevator").unwrap().values);
    }

    #[test]
    fn a_damper_is_taken_out_of_a_record_that_is_mostly_quiet() {
        // Two doublets of a second to each side in forty; the damper takes a quarter of them back.
        let asked = |t: f64| match t {
            t if (10.0..11.0).contains(&t) || (25.0..26.0).contains(&t) => 0.02,
            t if (11.0..12.0).contains(&t) || (26.0..27.0).contains(&t) => -0.02,
            _ => 0.0,
        };
        let record = flown(asked, 0.25);
        let worked: Vec<f64> = record.time.iter().map(|t| asked(*t)).collect();
        let quiet = |t: f64| [10.0, 11.0, 12.0, 25.0, 26.0, 27.0].iter().all(|edge| (t - edge).abs() > 0.25);
        let found = commanded(&Signals::of(&record), "elevator").unwrap();
        let worst = |values: &[f64]| {
            let pairs = values.iter().zip(&worked).zip(&record.time).filter(|(_, t)| quiet(**t));
            pairs.map(|((value, asked), _)| (value - asked).abs()).fold(0.0, f64::max)
        };
        let (recorded, left) = (worst(&record.channel("elevator").unwrap().values), worst(&found.values));
        assert!(recorded > 0.005 && left < 0.4 * recorded, "{recorded} {left}");
        assert!(off(&record, asked) < 0.03, "edges are those of an actuator");
    }
}
