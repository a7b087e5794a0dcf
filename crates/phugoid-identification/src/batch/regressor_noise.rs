//! What noise in the regressors does to a regression, found by adding more of it (J. R. Cook & L. A. Stefanski,
//! Simulation-extrapolation estimation in parametric measurement error models, Journal of the American Statistical
//! Association 89, 1994).
//!
//! Noise of variance `v` in a regressor shrinks its derivative, in the first order by an amount proportional to `v`.
//! The same regression with noise of the same variance once more on top is shrunk by twice as much: the difference of
//! both is the bias, and is taken off. Noise is added with both signs, so that what it does by chance cancels and only
//! what its square does remains.

use super::result::{BatchFit, UnknownKind};
use crate::preparation::noise::measure_own_noise;

/// Pairs of regressions with added noise.
pub(super) const PAIRS: u64 = 2;
/// Relative error of a bias that comes from that of the noise level, which is measured from the record.
const LEVEL_UNCERTAIN: f64 = 0.1;
/// Part of a value that its bias cannot reach, however large the noise.
const MOST: f64 = 0.5;
/// Largest standard error that the bias makes, as a part of the value.
const UNKNOWN: f64 = 10.0;

/// The unknowns of the regression with these outputs by manoeuvre; none where they are not determined.
type Solve<'a, const R: usize> = &'a dyn Fn(&[Vec<[f64; R]>]) -> Option<Vec<f64>>;

/// Mean difference of the unknowns between the regression with noise added and the one without; none where that cannot
/// be solved. `solve` gives the unknowns for outputs by manoeuvre; `of_state` says whose noise gets into the regressors.
pub(crate) fn bias<const R: usize>(
    outputs: &[&[[f64; R]]],
    of_state: &[bool; R],
    found: &[f64],
    solve: Solve<'_, R>,
) -> Option<Vec<f64>> {
    let levels: Vec<[f64; R]> = outputs.iter().map(|samples| noise_of(samples, of_state)).collect();
    let mut sum = vec![0.0; found.len()];
    for (pair, sign) in signs() {
        let noisy = outputs.iter().zip(&levels).enumerate();
        let noisy = noisy.map(|(m, (samples, level))| with_noise(samples, level, pair, sign, m as u64));
        for ((sum, with), without) in sum.iter_mut().zip(solve(&noisy.collect::<Vec<_>>())?).zip(found) {
            *sum += (with - without) / (2 * PAIRS) as f64;
        }
    }
    sum.iter().all(|v| v.is_finite()).then_some(sum)
}

/// The noise of the outputs of one record whose noise gets into the regressors, one sigma; zero of the others.
pub(crate) fn noise_of<const R: usize>(samples: &[[f64; R]], of_state: &[bool; R]) -> [f64; R] {
    std::array::from_fn(|i| {
        let values: Vec<f64> = samples.iter().map(|y| y[i]).collect();
        let noise = if of_state[i] { measure_own_noise(&values) } else { None };
        // The steps of a recorder are no noise of their own beside that of the sensor.
        noise.filter(|noise| !noise.quantised).map_or(0.0, |noise| noise.std)
    })
}

/// One record with noise of these levels (one sigma) added, in pairs of opposite signs.
pub(crate) fn noisy<const R: usize>(samples: &[[f64; R]], levels: &[f64; R]) -> impl Iterator<Item = Vec<[f64; R]>> {
    signs().map(|(pair, sign)| with_noise(samples, levels, pair, sign, 0))
}

fn signs() -> impl Iterator<Item = (u64, f64)> {
    (0..PAIRS).flat_map(|pair| [(pair, -1.0), (pair, 1.0)])
}

fn with_noise<const R: usize>(
    samples: &[[f64; R]],
    level: &[f64; R],
    pair: u64,
    sign: f64,
    record: u64,
) -> Vec<[f64; R]> {
    let at = |(k, y): (usize, &[f64; R])| {
        let place = |i: usize| [pair, record, k as u64, i as u64];
        std::array::from_fn(|i| y[i] + sign * level[i] * either_sign(place(i)))
    };
    samples.iter().enumerate().map(at).collect()
}

/// Takes the bias off the parameters, and adds what is uncertain of it to their standard errors.
pub(crate) fn correct(fit: &mut BatchFit, bias: &[f64]) {
    let mut bent = Vec::new();
    for (unknown, bias) in fit.unknowns.iter_mut().zip(bias) {
        let UnknownKind::Parameter { index } = unknown.kind else { continue };
        if unknown.at_limit {
            continue;
        }
        if bias.abs() > unknown.corrected_std_error {
            bent.push(format!("{} by {:+.2e}", unknown.name, bias));
        }
        let before = unknown.value;
        unknown.value -= bias;
        fit.parameters[index] = unknown.value;
        let part = (bias / before).abs();
        // Noise that shrinks a derivative to theta/(1 + r) shrinks it to theta/(1 + 2 r) when it is doubled, which is a
        // bias of the part r/(1 + 2 r): taking that off leaves 2 part^2/(1 - 2 part). From a half on nothing is known.
        let left = if part < MOST { 2.0 * part * part / (1.0 - 2.0 * part) } else { UNKNOWN };
        let left = left.min(UNKNOWN) * before.abs();
        unknown.corrected_std_error = unknown.corrected_std_error.hypot(LEVEL_UNCERTAIN * bias).hypot(left);
    }
    if !bent.is_empty() {
        fit.notes.push(format!(
            "the noise of the measured states shrank derivatives by more than their standard errors: {}. That was taken \
             off, and the bounds allow for what is uncertain of it; output-error and filter-error have no such bias",
            bent.join(", ")
        ));
    }
}

/// One or minus one, white over all places (SplitMix64: G. L. Steele et al., OOPSLA 2014).
pub(super) fn either_sign(place: [u64; 4]) -> f64 {
    let mut hash = 0_u64;
    for part in place {
        hash = hash.wrapping_add(part).wrapping_add(0x9e37_79b9_7f4a_7c15);
        hash = (hash ^ (hash >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        hash = (hash ^ (hash >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        hash ^= hash >> 31;
    }
    if hash & 1 == 0 { 1.0 } else { -1.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_slope_of_a_line_is_shrunk_by_what_is_found() {
        // y = 2 x with noise of one tenth of the scatter of x in x: the slope shrinks by a part of 0.01.
        let truth: Vec<f64> = (0..4000).map(|k| (0.01 * f64::from(k)).sin()).collect();
        let level = 0.1 * 0.5_f64.sqrt();
        // Twelve signs together are nearly Gaussian, as the measurement of the level assumes.
        let normal = |k: u64| (0..12).map(|j| either_sign([9, j, k, 9])).sum::<f64>() / 12_f64.sqrt();
        let measured: Vec<[f64; 1]> = truth.iter().enumerate().map(|(k, x)| [x + level * normal(k as u64)]).collect();
        let slope = |x: &[[f64; 1]]| {
            let (xy, xx) = x.iter().zip(&truth).fold((0.0, 0.0), |(xy, xx), ([x], t)| (xy + x * 2.0 * t, xx + x * x));
            xy / xx
        };
        let solve = |outputs: &[Vec<[f64; 1]>]| Some(vec![slope(&outputs[0])]);
        let found = slope(&measured);
        let bias = bias(&[&measured], &[true], &[found], &solve).expect("it can be solved")[0];
        assert!((found - 1.98).abs() < 0.01, "{found}");
        assert!((bias + 0.02).abs() < 0.005, "{bias}");
        // What does not get into a regressor does nothing.
        let none = super::bias(&[&measured], &[false], &[found], &solve).expect("it can be solved")[0];
        assert_eq!(none, 0.0);
    }

    #[test]
    fn signs_are_white() {
        let signs: Vec<f64> = (0..10_000).map(|k| either_sign([1, 0, k, 2])).collect();
        let mean = signs.iter().sum::<f64>() / 10_000.0;
        let next = signs.windows(2).map(|w| w[0] * w[1]).sum::<f64>() / 10_000.0;
        assert!(mean.abs() < 0.03 && next.abs() < 0.03, "{mean} {next}");
    }
}
