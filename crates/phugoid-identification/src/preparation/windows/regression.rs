//! Regression of a signal on its causes over short windows, from which constants and drifts are taken out.

use nalgebra::{DMatrix, DVector, SMatrix, SVector};

use crate::preparation::noise::measure_noise;

/// Length of a window, s: an offset and a drift over it hold biases, and a short-period motion is neither.
const WINDOW_S: f64 = 2.0;
/// Windows that a factor has to rest on.
const LEAST_WINDOWS: usize = 5;

/// The factors on the causes.
pub(crate) struct Factors<const C: usize> {
    pub(crate) value: SVector<f64, C>,
    /// One sigma, by leaving out one window at a time: turbulence and model error widen it too, and what rests on one
    /// window alone has a large one.
    pub(crate) std: SVector<f64, C>,
    /// Share of the motion of the signal that is left, without its white noise: what is left in still air is little.
    pub(crate) unexplained: f64,
    /// Sum of the squares that are left, in each window.
    pub(crate) left: Vec<f64>,
    /// The factors without one of the windows, for each of them.
    without_one: Vec<SVector<f64, C>>,
}

impl<const C: usize> Factors<C> {
    /// The factor on cause `i` over that on cause `j`, and one sigma of it, by leaving out one window at a time. None if
    /// one of them is not determined.
    pub(crate) fn ratio(&self, i: usize, j: usize) -> Option<(f64, f64)> {
        let of = |value: &SVector<f64, C>| value[i] / value[j];
        let ratio = of(&self.value);
        let n = self.without_one.len() as f64;
        let sum: f64 = self.without_one.iter().map(|value| (of(value) - ratio).powi(2)).sum();
        let std = (sum * ((n - 1.0) / n)).sqrt();
        (ratio.is_finite() && std.is_finite()).then_some((ratio, std))
    }
}

/// Integral of a rate over the time by the trapezoidal rule, from zero.
pub(crate) fn integral(time: &[f64], rate: &[f64]) -> Vec<f64> {
    let mut sum = 0.0;
    let mut out = Vec::with_capacity(rate.len());
    out.extend(rate.first().map(|_| 0.0));
    for (t, r) in time.windows(2).zip(rate.windows(2)) {
        sum += 0.5 * (r[0] + r[1]) * (t[1] - t[0]);
        out.push(sum);
    }
    out
}

/// Takes a straight line out of values over the times.
fn without_line(time: &[f64], values: &mut [f64]) {
    let n = values.len() as f64;
    let mean_t = time.iter().sum::<f64>() / n;
    let mean = values.iter().sum::<f64>() / n;
    let (mut tt, mut tv) = (0.0, 0.0);
    for (t, v) in time.iter().zip(values.iter()) {
        tt += (t - mean_t).powi(2);
        tv += (t - mean_t) * (v - mean);
    }
    let slope = if tt > 0.0 { tv / tt } else { 0.0 };
    for (t, v) in time.iter().zip(values.iter_mut()) {
        *v -= mean + slope * (t - mean_t);
    }
}

/// Fits the signal by the causes, all by sample. None if there are too few windows without a gap, or if the causes
/// cannot be told apart. A cause that is zero throughout, as a surface that nobody moved, gets the factor zero, of which
/// nothing is known; a ratio to it is none.
pub(crate) fn factors<const C: usize>(
    time: &[f64],
    signal: &[f64],
    causes: &[Vec<f64>; C],
    step_s: f64,
) -> Option<Factors<C>> {
    let mut windows: Vec<(SMatrix<f64, C, C>, SVector<f64, C>, f64)> = Vec::new();
    let white = measure_noise(signal).map_or(0.0, |noise| noise.std);
    let (mut motion, mut noise) = (0.0, 0.0);
    let mut begin = 0;
    while begin < time.len() {
        let mut end = begin + 1;
        while end < time.len() && time[end] - time[begin] < WINDOW_S && time[end] - time[end - 1] < 3.5 * step_s {
            end += 1;
        }
        if end - begin >= 10 && time[end - 1] - time[begin] > 0.7 * WINDOW_S {
            let t = &time[begin..end];
            let straight = |values: &[f64]| {
                let mut own = values[begin..end].to_vec();
                without_line(t, &mut own);
                own
            };
            let own: [Vec<f64>; C] = std::array::from_fn(|c| straight(&causes[c]));
            let mut normal = SMatrix::zeros();
            let mut right = SVector::zeros();
            let mut squares = 0.0;
            for (k, y) in straight(signal).into_iter().enumerate() {
                let row = SVector::<f64, C>::from_fn(|c, _| own[c][k]);
                normal += row * row.transpose();
                right += row * y;
                squares += y * y;
            }
            // Two of the values went into the line.
            noise += (end - begin - 2) as f64 * white * white;
            motion += squares;
            windows.push((normal, right, squares));
        }
        begin = end;
    }
    if windows.len() < LEAST_WINDOWS {
        return None;
    }
    let (mut normal, mut right) = (SMatrix::<f64, C, C>::zeros(), SVector::<f64, C>::zeros());
    for (n, r, _) in &windows {
        normal += n;
        right += r;
    }
    let value = solved(&normal, &right)?;
    let left = |(n, r, squares): &(SMatrix<f64, C, C>, SVector<f64, C>, f64)| {
        squares - 2.0 * value.dot(r) + value.dot(&(n * value))
    };
    let left: Vec<f64> = windows.iter().map(left).collect();
    let explained = motion - left.iter().sum::<f64>();
    let n = windows.len() as f64;
    // By taking one window away from the sums: summing the others anew for each would take the square of the length of the record.
    let without_one = windows.iter().map(|(n, r, _)| solved(&(normal - n), &(right - r)));
    let without_one: Vec<SVector<f64, C>> = without_one.collect::<Option<_>>()?;
    let mut sum = SVector::<f64, C>::zeros();
    for one in &without_one {
        let difference = one - value;
        sum += difference.component_mul(&difference);
    }
    let of = |c: usize, _| if normal[(c, c)] > 0.0 { (sum[c] * ((n - 1.0) / n)).sqrt() } else { f64::INFINITY };
    let std = SVector::<f64, C>::from_fn(of);
    let moved = motion - noise;
    let unexplained = |explained: f64| ((moved - explained) / moved).max(0.0);
    (moved > 0.0).then(|| Factors { value, std, unexplained: unexplained(explained), left, without_one })
}

/// Solves with causes of unit size.
fn solved<const C: usize>(normal: &SMatrix<f64, C, C>, right: &SVector<f64, C>) -> Option<SVector<f64, C>> {
    let (unit, inverse) = inverse_by_unit_size(C, |a, b| normal[(a, b)])?;
    let unit = SVector::<f64, C>::from_fn(|c, _| unit[c]);
    let inverse = SMatrix::<f64, C, C>::from_fn(|a, b| inverse[(a, b)]);
    let value = (inverse * right.component_mul(&unit)).component_mul(&unit);
    Some(value).filter(|value| value.iter().all(|v| v.is_finite()))
}

/// Of a normal matrix of so many causes: what makes each of unit size, and the inverse of the matrix of those, so that the units do
/// not decide what can be told apart. The inverse of the matrix itself is that times what makes row and column of unit size. A cause
/// that is zero stays zero: it takes nothing from what is known of the others, and its own factor comes out as zero.
///
/// Of dynamic size: the inverse of a fixed size is compiled anew for every number of causes, and is long.
pub(crate) fn inverse_by_unit_size(
    count: usize,
    normal: impl Fn(usize, usize) -> f64,
) -> Option<(DVector<f64>, DMatrix<f64>)> {
    let unit = DVector::from_fn(count, |c, _| if normal(c, c) > 0.0 { 1.0 / normal(c, c).sqrt() } else { 0.0 });
    let of = |a: usize, b: usize| if a == b && unit[a] == 0.0 { 1.0 } else { unit[a] * normal(a, b) * unit[b] };
    let inverse = DMatrix::from_fn(count, count, of).try_inverse()?;
    Some((unit, inverse))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cause_that_is_zero_takes_nothing_from_the_others() {
        let time: Vec<f64> = (0..1000).map(|k| 0.02 * f64::from(k)).collect();
        let of = |signal: &dyn Fn(f64) -> f64| time.iter().map(|t| signal(*t)).collect::<Vec<f64>>();
        let (a, b) = (of(&|t| (2.0 * t).sin()), of(&|t| (5.1 * t).cos()));
        let signal = of(&|t| 3.0 * (2.0 * t).sin() - 0.5 * (5.1 * t).cos() + 1e-3 * (977.0 * t).sin());
        let all = factors(&time, &signal, &[a.clone(), vec![0.0; 1000], b.clone()], 0.02).unwrap();
        let without = factors(&time, &signal, &[a, b], 0.02).unwrap();
        for (i, j) in [(0, 0), (2, 1)] {
            // The same sums in the same order, but for the elimination.
            assert!((all.value[i] - without.value[j]).abs() < 1e-12, "{} {}", all.value, without.value);
            assert!((all.std[i] - without.std[j]).abs() < 1e-12, "{} {}", all.std, without.std);
        }
        assert!(all.value[1] == 0.0 && all.std[1].is_infinite(), "{} {}", all.value, all.std);
        assert!(all.ratio(2, 0).is_some() && all.ratio(2, 1).is_none());
    }
}
