//! The noise of the recorded positions of the surfaces, and the motion below it.
//!
//! The methods take the known inputs as exact. White noise on a recorded position is taken for motion to which the
//! aircraft does not answer: the derivative by the surface comes out too small by about the share of the noise in the
//! scatter of the signal (errors in variables; W. A. Fuller, *Measurement Error Models*, 1987, ch. 1), and those whose
//! regressors move with the surface are wrong by as much of its part. A record shows what comes after as well as what
//! came before, so that the noise can be smoothed away.
//!
//! The motion of the surface is a rate that jumps between samples. A surface rests or follows its actuator most of the
//! time and moves suddenly now and then, so that the jumps are distributed as Student's t with one degree of freedom: the
//! smoother of Rauch, Tung and Striebel is run again with the weights `2/(1 + E[jump^2]/q)`, which that distribution
//! gives them, and with the scale `q` that the record makes most likely (expectation and maximisation; K. L. Lange, R. J.
//! A. Little, J. M. G. Taylor, *Robust Statistical Modeling Using the t Distribution*, J. Am. Stat. Assoc. 84, 1989). At
//! rest it averages over seconds, and at an edge it follows the samples.

use nalgebra::{Matrix2, Vector2};
use phugoid_flight_data::statistics::{median, median_step};

use crate::preparation::noise::{measure_noise, without_outliers};

/// Share of the noise in the scatter from which a surface is smoothed: the bias of less is a quarter of what the bounds
/// allow for the scale of a surface by default, and a slow recorder shows as much where there is motion between samples.
const SMOOTHED: f64 = 0.005;
/// Fewer samples do not show what is noise and what is motion.
const FEWEST: usize = 100;
/// Most runs of the smoother, and the change of the logarithm of the scale from which on none is worth it. The share that
/// is left changes by less than a tenth of itself after a dozen of them.
const MOST_RUNS: usize = 20;
const SETTLED: f64 = 0.02;

/// What the noise of one surface was and is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct SurfaceNoise {
    /// One sigma of the white noise of the record, rad.
    pub(crate) std: f64,
    /// Its share in the scatter of the signal, 0 to 1.
    pub(crate) share: f64,
    /// The share that is left: that of the variance of the smoothed signal. Equal to `share` where it is as recorded; zero of a
    /// surface that stands still, whose scatter is noise alone.
    pub(crate) left: f64,
}

impl SurfaceNoise {
    /// Whether the surface does not move beyond its noise.
    pub(crate) fn stands_still(self) -> bool {
        self.left == 0.0
    }
}

/// A surface stands still if its noise is this part of its scatter or more, and it never is farther from its median, smoothed,
/// than so many sigmas of the noise.
const MOSTLY_NOISE: f64 = 0.5;
const STILL: f64 = 2.0;

/// The noise of a surface of a record; none for noise below the step of the recorder, and for a signal that stands still.
pub(crate) fn noise_of(values: &[f64]) -> Option<SurfaceNoise> {
    let noise = measure_noise(values).filter(|noise| !noise.quantised)?;
    let (variance, _) = scatter(values);
    let share = (noise.std * noise.std / variance).min(1.0);
    (variance > 0.0).then_some(SurfaceNoise { std: noise.std, share, left: share })
}

/// Variance of the values that are there, and how many these are.
fn scatter(values: &[f64]) -> (f64, f64) {
    let present: Vec<f64> = values.iter().copied().filter(|v| v.is_finite()).collect();
    let n = present.len() as f64;
    let mean = present.iter().sum::<f64>() / n;
    (present.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / n, n)
}

/// Replaces a recorded position (rad, NaN where missing) by the motion below its noise, if it is noisy enough. Gives what
/// the noise was and is; none where there is none.
pub(crate) fn smooth(time_s: &[f64], values: &mut [f64]) -> Option<SurfaceNoise> {
    let noise = noise_of(values)?;
    if noise.share < SMOOTHED || values.len() < FEWEST {
        return Some(noise);
    }
    let Some(smoothed) = smoothed(time_s, values, noise.std) else { return Some(noise) };
    if let Some(rest) = median(&mut smoothed.values.clone()).filter(|_| noise.share > MOSTLY_NOISE)
        && smoothed.values.iter().all(|value| (value - rest).abs() < STILL * noise.std)
    {
        values.iter_mut().filter(|value| value.is_finite()).for_each(|value| *value = rest);
        return Some(SurfaceNoise { left: 0.0, ..noise });
    }
    for (value, smoothed) in values.iter_mut().zip(&smoothed.values) {
        // What is missing is held by the caller, who says so.
        if value.is_finite() {
            *value = *smoothed;
        }
    }
    Some(SurfaceNoise { left: noise.share * smoothed.variance, ..noise })
}

/// Longest step of a record, s, of which a single value that stands alone is none of the surface: to go there and back within two
/// of them takes hundreds of degrees per second for a few degrees. Slower records may miss all of a pulse but one sample: up to a
/// second limit, s, it has to be faster than this, rad/s, which no surface is with a load on it.
const SPIKE_STEP_S: f64 = 0.05;
const SLOWEST_SPIKE_STEP_S: f64 = 0.11;
const SPIKE_RATE: f64 = 1.0;
/// A single value stands alone if it is farther from both neighbours than so many sigmas of the noise, ...
const SPIKE_SIGMAS: f64 = 8.0;
/// ... and than so many times what the values around it move from one to the next, of which the middle one of three counts, ...
const SPIKE_MOVES: f64 = 4.0;
/// ... while the neighbours are no farther from each other than this part of it: an edge does not come back.
const SPIKE_RETURN: f64 = 0.5;

/// Puts single values that no surface has (rad, NaN where missing) on the straight line between their neighbours, and gives their
/// number.
///
/// A method takes the known inputs as exact: to a wild value the aircraft does not answer, and the derivative by the surface is
/// estimated from such values alone, since they are by far the largest motion in the record.
pub(crate) fn take_spikes(time_s: &[f64], values: &mut [f64]) -> usize {
    let Some(step) = median_step(time_s).filter(|step| *step <= SLOWEST_SPIKE_STEP_S) else { return 0 };
    let least = if step > SPIKE_STEP_S { SPIKE_RATE * step } else { 0.0 };
    let found = excursions::<5>(values, least);
    for k in &found {
        let part = (time_s[*k] - time_s[k - 1]) / (time_s[k + 1] - time_s[k - 1]);
        values[*k] = values[k - 1] + part * (values[k + 1] - values[k - 1]);
    }
    found.len()
}

/// Where values (rad, NaN where missing) leave those before them by more than `least` and come back: of `WIDTH` values in a row, the
/// first two and the last two are where the surface is, and those between them are not. The first of these.
fn excursions<const WIDTH: usize>(values: &[f64], least: f64) -> Vec<usize> {
    let noise_std = measure_noise(values).map_or(0.0, |noise| noise.std);
    let is_excursion = |x: &[f64]| {
        let (before, after) = (x[1], x[WIDTH - 2]);
        let back = (after - before).abs();
        let apart = x[2..WIDTH - 2].iter().map(|out| {
            let (from, to) = (out - before, out - after);
            if from * to > 0.0 { from.abs().min(to.abs()) } else { 0.0 }
        });
        let apart = apart.fold(f64::INFINITY, f64::min);
        let mut moves = [(before - x[0]).abs(), (x[WIDTH - 1] - after).abs(), back];
        moves.sort_by(f64::total_cmp);
        apart > least.max(SPIKE_SIGMAS * noise_std) && apart > SPIKE_MOVES * moves[1] && back < SPIKE_RETURN * apart
    };
    let found = values.windows(WIDTH).enumerate().filter(|(_, x)| is_excursion(x)).map(|(k, _)| k + 2);
    found.collect()
}

/// Values of a recorded surface that may be wild, and count as motion: one or two in a row far from where the surface was before
/// and is afterwards, which a pulse of that length could be as well.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct WildValues {
    pub(crate) surface: String,
    /// How often the surface seems to go away and come back.
    pub(crate) count: usize,
    /// Their share in the scatter of the signal, 0 to 1.
    pub(crate) share: f64,
}

impl WildValues {
    /// Those of one surface of a record (s, rad); none where there are none, and for records that are too slow to tell.
    pub(crate) fn of(surface: &str, time_s: &[f64], values: &[f64]) -> Option<Self> {
        let step = median_step(time_s).filter(|step| *step <= SLOWEST_SPIKE_STEP_S)?;
        let single = excursions::<5>(values, 0.0);
        // Of a slower record two values are a pulse of two tenths of a second, which pilots fly.
        let double = if step <= SPIKE_STEP_S { excursions::<6>(values, 0.0) } else { Vec::new() };
        let count = single.len() + double.len();
        let (variance, n) = scatter(values);
        let out = single.iter().map(|k| (*k, 1)).chain(double.iter().map(|k| (*k, 2)));
        let power: f64 = out.flat_map(|(k, n)| (k..k + n).map(move |i| (values[i] - values[k - 1]).powi(2))).sum();
        (count > 0 && variance > 0.0).then(|| Self {
            surface: surface.to_owned(),
            count,
            share: (power / (n * variance)).min(1.0),
        })
    }
}

struct Smoothed {
    values: Vec<f64>,
    /// Mean variance of the values, as a part of that of the noise.
    variance: f64,
}

/// One forward step: predicted and updated state (position, rate) and covariance.
#[derive(Clone, Copy)]
struct Step {
    predicted: (Vector2<f64>, Matrix2<f64>),
    updated: (Vector2<f64>, Matrix2<f64>),
}

/// Values in units of the noise, time in units of the median step. None where the arithmetic does not hold.
fn smoothed(time_s: &[f64], values: &[f64], noise_std: f64) -> Option<Smoothed> {
    let unit = median_step(time_s)?;
    let measured: Vec<f64> = without_outliers(values, noise_std).iter().map(|v| v / noise_std).collect();
    let first = *measured.iter().find(|v| v.is_finite())?;
    let steps: Vec<f64> = time_s.windows(2).map(|t| (t[1] - t[0]) / unit).collect();
    if !steps.iter().all(|step| *step > 0.0 && step.is_finite()) {
        return None;
    }
    let n = values.len();
    // The scatter of the second differences is that of the noise and of the jumps: a start that is too large.
    let mut scale = 1.0;
    let mut weights = vec![1.0; n];
    let mut forward: Vec<Step> = Vec::with_capacity(n);
    let mut found = vec![(0.0, 0.0); n];
    for _ in 0..MOST_RUNS {
        forward.clear();
        let start = (Vector2::new(first, 0.0), Matrix2::from_diagonal(&Vector2::new(1e4, 1e2)));
        for k in 0..n {
            let predicted = match forward.last() {
                None => start,
                Some(last) => {
                    let motion = motion(steps[k - 1]);
                    let (x, p) = last.updated;
                    let q = jump(steps[k - 1]) * (scale / weights[k]);
                    (motion * x, motion * p * motion.transpose() + q)
                }
            };
            let (x, p) = predicted;
            let updated = if measured[k].is_finite() {
                let gain = p.column(0) / (p[(0, 0)] + 1.0);
                (x + gain * (measured[k] - x[0]), p - gain * p.row(0))
            } else {
                predicted
            };
            forward.push(Step { predicted, updated });
        }
        let (mut x, mut p) = forward.last()?.updated;
        found[n - 1] = (x[0], p[(0, 0)]);
        let mut jumps = 0.0;
        for k in (0..n - 1).rev() {
            let motion = motion(steps[k]);
            let next = forward[k + 1].predicted;
            let (own_x, own_p) = forward[k].updated;
            let gain = own_p * motion.transpose() * next.1.try_inverse()?;
            let own = (own_x + gain * (x - next.0), own_p + gain * (p - next.1) * gain.transpose());
            // E[(rate after - rate before)^2], with the covariance of the two.
            let cross = (gain * p)[(1, 1)];
            let power = (x[1] - own.0[1]).powi(2) + (p[(1, 1)] + own.1[(1, 1)] - 2.0 * cross).max(0.0);
            weights[k + 1] = 2.0 / (1.0 + power / scale);
            jumps += weights[k + 1] * power;
            (x, p) = own;
            found[k] = (x[0], p[(0, 0)]);
        }
        let next = jumps / (n - 1) as f64;
        if !(next > 0.0 && next.is_finite()) {
            return None;
        }
        let moved = (next / scale).ln().abs();
        scale = next;
        if moved < SETTLED {
            break;
        }
    }
    let variance = found.iter().map(|(_, p)| p).sum::<f64>() / n as f64;
    let values: Vec<f64> = found.iter().map(|(x, _)| x * noise_std).collect();
    (values.iter().all(|v| v.is_finite()) && (0.0..1.0).contains(&variance)).then_some(Smoothed { values, variance })
}

fn motion(step: f64) -> Matrix2<f64> {
    Matrix2::new(1.0, step, 0.0, 1.0)
}

/// Covariance of a unit jump of the rate in the middle of a step.
fn jump(step: f64) -> Matrix2<f64> {
    Matrix2::new(0.25 * step * step, 0.5 * step, 0.5 * step, 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Uniform numbers of variance one, from a congruential generator.
    fn noise() -> impl FnMut() -> f64 {
        let mut seed = 7_u64;
        move || {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            ((seed >> 11) as f64 / (1_u64 << 53) as f64 - 0.5) * 12_f64.sqrt()
        }
    }

    /// A square wave of one degree behind an actuator of 20 rad/s, 50 times per second: time, motion.
    fn motion() -> (Vec<f64>, Vec<f64>) {
        let mut position = 0.0;
        (0..2000)
            .map(|k| {
                let command = if (k / 100) % 2 == 0 { 0.0175 } else { -0.0175 };
                position += (command - position) * (1.0 - (-0.4_f64).exp());
                (0.02 * f64::from(k), position)
            })
            .unzip()
    }

    fn mean_square(a: &[f64], b: &[f64]) -> f64 {
        a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>() / a.len() as f64
    }

    #[test]
    fn noise_is_measured_smoothed_away_and_what_is_left_is_said() {
        let (time, truth) = motion();
        let mut random = noise();
        let mut values: Vec<f64> = truth.iter().map(|v| v + 0.00175 * random()).collect();
        let found = smooth(&time, &mut values).unwrap();
        assert!((found.std / 0.00175 - 1.0).abs() < 0.25, "{found:?}");
        assert!((found.share / 0.01 - 1.0).abs() < 0.5, "{found:?}");
        // What is left is what is claimed to be left, within a factor of two, and less than a quarter of the noise.
        let left = mean_square(&values, &truth) / 0.0175_f64.powi(2);
        assert!(left < 0.25 * 0.01, "{left}");
        assert!((0.5..2.0).contains(&(left / found.left)), "{left} {found:?}");
    }

    #[test]
    fn a_clean_surface_is_left_as_it_was_recorded() {
        let (time, truth) = motion();
        let mut values = truth.clone();
        let found = smooth(&time, &mut values);
        assert_eq!(values, truth);
        assert!(found.is_none_or(|noise| noise.share < SMOOTHED), "{found:?}");
        let mut still = vec![0.01; 500];
        assert_eq!(smooth(&time[..500], &mut still), None);
    }

    #[test]
    fn a_surface_with_noise_alone_stands_still_and_one_that_moves_once_does_not() {
        let (time, _) = motion();
        let mut random = noise();
        let noisy: Vec<f64> = time.iter().map(|_| -0.01 + 0.0002 * random()).collect();
        let mut values = noisy.clone();
        assert!(smooth(&time, &mut values).unwrap().stands_still());
        assert!(values.iter().all(|v| *v == values[0]) && (values[0] + 0.01).abs() < 1e-4, "{}", values[0]);
        // A pulse of a tenth of a degree, of one second in forty.
        let mut pulse: Vec<f64> =
            noisy.iter().enumerate().map(|(k, v)| if (500..550).contains(&k) { v + 0.0017 } else { *v }).collect();
        assert!(!smooth(&time, &mut pulse).unwrap().stands_still());
        assert!(pulse[525] - pulse[400] > 0.001);
    }

    #[test]
    fn outliers_and_missing_values_do_not_move_their_neighbours() {
        let (time, truth) = motion();
        let mut random = noise();
        let mut values: Vec<f64> = truth.iter().map(|v| v + 0.00175 * random()).collect();
        for k in (50..1950).step_by(97) {
            values[k] += 0.2;
            values[k + 3] = f64::NAN;
        }
        smooth(&time, &mut values).unwrap();
        let (kept, of): (Vec<f64>, Vec<f64>) = values.iter().zip(&truth).filter(|(v, _)| v.is_finite()).unzip();
        assert!(values[53].is_nan());
        assert!(mean_square(&kept, &of) < 0.3 * 0.00175_f64.powi(2));
    }

    #[test]
    fn single_values_that_no_surface_has_go_and_motion_stays() {
        let (time, truth) = motion();
        let mut random = noise();
        for noise_std in [0.0, 0.0002] {
            let clean: Vec<f64> = truth.iter().map(|v| v + noise_std * random()).collect();
            let mut untouched = clean.clone();
            assert_eq!(take_spikes(&time, &mut untouched), 0);
            assert_eq!(untouched, clean);
            // Some far, some by a quarter of what the surface moves, near to one another and alone.
            let mut values = clean.clone();
            let places = [60, 150, 152, 290, 333, 950, 1260, 1550];
            for (number, place) in places.into_iter().enumerate() {
                values[place] += [0.35, -0.35, 0.02, -0.01][number % 4];
            }
            assert_eq!(take_spikes(&time, &mut values), places.len(), "{noise_std}");
            assert!(places.iter().all(|k| (values[*k] - truth[*k]).abs() < 0.002), "{noise_std}");
        }
        // Steps that are held, a pulse of two samples, one step of a coarse recorder, and a record too slow to tell.
        let shape = |pulse: &dyn Fn(usize) -> f64| (0..400).map(pulse).collect::<Vec<f64>>();
        let steps = shape(&|k| if (k / 20) % 2 == 0 { 0.02 } else { -0.02 });
        let pulses = shape(&|k| if k % 50 < 2 { 0.05 } else { 0.0 });
        let flicker = shape(&|k| if k % 37 == 5 { 0.001 } else { 0.0 });
        for mut values in [steps, pulses, flicker] {
            assert_eq!(take_spikes(&time[..400], &mut values), 0);
        }
        let times = |factor: f64| time.iter().map(|t| factor * t).collect::<Vec<f64>>();
        // A pulse of two samples and one that is slow enough for a surface are not taken, and are told.
        let wild = |times: &[f64], step: usize, width: usize, size: f64| {
            let mut values = truth.clone();
            for k in (55..1950).step_by(step) {
                values[k..k + width].iter_mut().for_each(|value| *value += size);
            }
            take_spikes(times, &mut values);
            WildValues::of("elevator", times, &values).map(|wild| (wild.count, wild.share > 0.05))
        };
        assert_eq!((wild(&time, 200, 2, 0.1), wild(&times(5.0), 200, 1, 0.06)), (Some((10, true)), Some((10, true))));
        // Pulses that pilots fly, and what was taken.
        assert_eq!(
            (wild(&time, 200, 1, 0.1), wild(&time, 200, 5, 0.1), wild(&times(5.0), 200, 2, 0.06)),
            (None, None, None)
        );
        let of = |times: &[f64], size: f64| {
            let mut values = truth.clone();
            values[700] += size;
            take_spikes(times, &mut values)
        };
        assert_eq!((of(&times(5.0), 0.3), of(&times(5.0), 0.06), of(&times(10.0), 0.3)), (1, 0, 0));
    }
}
