//! The rules: settings in closed form from bounds, noise, sample time and expected input.

use serde::Serialize;

/// What is known of a case before it is run: of the plant with the nominal parameters (the start values) under the expected
/// input, of the noise, and of the sampling. Channel units are those of the surface's channel divided by its scale.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Expected {
    /// Time `h` between two samples, s.
    pub sample_time_s: f64,
    /// Length of the record `T`, s.
    pub duration_s: f64,
    /// Root mean square of the channel, `x`.
    pub signal: f64,
    /// Root mean square of its rate, `x'`, 1/s.
    pub rate: f64,
    /// Median of `|z|`, `z = x dx'/dtheta`, where it is excited (above a thousandth of its largest value), per unit of the
    /// parameter and second.
    pub slope: f64,
    /// Root mean square of `|Phi R|`, regressors times half widths of the bounds, 1/s.
    pub regressor: f64,
    /// Largest `|Phi R|` of the plant with the nominal parameters, and with all at their lower or upper bounds, 1/s.
    pub largest_regressor: f64,
    /// One-sigma noise of the channel; 0 for none.
    pub noise: f64,
    /// Smallest nominal parameter, as a fraction of its half width.
    pub nominal: f64,
    /// Half width of its bounds, parameter unit.
    pub half_width: f64,
}

/// The error that noise may leave, one sigma, as a fraction of the nominal parameter: a quarter of the 5 % that count as
/// converged, so that an estimate that has arrived stays.
const NOISE_ERROR: f64 = 0.0125;
/// Smallest `eta` as a part of the median `|z|`: the law then moves by nine tenths of the error at each sample. Less gains
/// little where `z` is large, and where `z` passes through zero the law divides the error of the integration by it. (A
/// thousandth, tried first, was too little: the search on the published flights asked for a hundred times as much.)
const SMALLEST_ETA: f64 = 0.1;

/// `lambda` (1/s) and `eta` (units of `z`) of the damped thesis law.
///
/// With `D + lambda E = z (theta - truth) + n` the damped law moves by `a = |z|/(eta + |z|)` of the error at each sample, and
/// white `n` of standard deviation `sigma_n` leaves an error of variance `(sigma_n/z)^2 a/(2 - a)` (an exponential average).
/// From the measured channel, with an exact rate, `sigma_n^2 = sigma^2 (x'^2 + lambda^2 x^2)`.
///
/// * `lambda h = 0.5` without noise: beyond 1 the law overshoots, beyond 2 it diverges (docs/theory.md section 10). With
///   noise no more than where `lambda E` is as noisy as `D`, `lambda = x'/x`, but at least ten time constants per record.
/// * `eta`: the error that noise leaves equals 1.25 % of the nominal parameter: `eta = |z| (1 - rho)/(2 rho)` with
///   `rho = (1.25 % theta |z| / sigma_n)^2`, and at least a tenth of the median `|z|`.
pub fn thesis_law(expected: &Expected) -> [f64; 2] {
    let Expected { sample_time_s: h, duration_s, signal, rate, slope, noise, .. } = *expected;
    let fastest = 0.5 / h;
    let lambda = if noise > 0.0 { (rate / signal).max(10.0 / duration_s).min(fastest) } else { fastest };
    let noise_of_law = noise * rate.hypot(lambda * signal);
    let allowed = NOISE_ERROR * expected.nominal * expected.half_width;
    let rho = (allowed * slope / noise_of_law).powi(2);
    let eta = if rho < 1.0 { slope * (1.0 - rho) / (2.0 * rho) } else { 0.0 };
    [lambda, eta.max(SMALLEST_ETA * slope)]
}

/// `g` (a pure number) and `k` (1/s) of the state-error form of the model-reference law.
///
/// Error `e` and parameter error obey `e' = Phi R w - k e`, `w' = -g Phi R e` (in units of the half widths): critically damped
/// at `g = k^2/(4 |Phi R|^2)`, and then both settle with `k/2`. Sampled, that is stable while `g h |Phi R|^2 <= 2 k`
/// (docs of [`crate::model_reference`]), here `k h <= 8`. White noise of standard deviation `sigma` leaves
/// `w^2 = k^3 h sigma^2 / (32 |Phi R|^2)` (the variance of `g Phi R s/(s^2 + k s + k^2/4)` times noise of density
/// `sigma^2 h`).
///
/// * `k h = 1` without noise, an eighth of the limit; with noise so slow that it leaves 1.25 % of the nominal parameter, but at
///   least ten time constants per record.
/// * `g` by critical damping at the root mean square of the regressor, but at most half of the stability limit at the largest
///   regressor that a truth inside the bounds can make.
pub fn model_reference(expected: &Expected) -> [f64; 2] {
    let Expected { sample_time_s: h, duration_s, regressor, noise, nominal, .. } = *expected;
    let fastest = 1.0 / h;
    let quiet = (32.0 * (NOISE_ERROR * nominal * regressor / noise).powi(2) / h).cbrt();
    let decay = if noise > 0.0 { quiet.clamp((20.0 / duration_s).min(fastest), fastest) } else { fastest };
    let damped = 0.25 * (decay / regressor).powi(2);
    [damped.min(decay / (h * expected.largest_regressor.powi(2))), decay]
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;
    use rand_distr::{Distribution, StandardNormal};
    use rand_pcg::Pcg64Mcg;

    const QUIET: Expected = Expected {
        sample_time_s: 0.01,
        duration_s: 100.0,
        signal: 0.5,
        rate: 2.0,
        slope: 0.3,
        regressor: 0.8,
        largest_regressor: 1.1,
        noise: 0.0,
        nominal: 1.0,
        half_width: 2.0,
    };

    fn spread(mut next: impl FnMut(f64) -> f64) -> f64 {
        let mut random = Pcg64Mcg::seed_from_u64(7);
        let mut sum = 0.0;
        const SAMPLES: usize = 400_000;
        for k in 0..SAMPLES + 10_000 {
            let value = next(StandardNormal.sample(&mut random));
            sum += if k < 10_000 { 0.0 } else { value * value };
        }
        (sum / SAMPLES as f64).sqrt()
    }

    #[test]
    fn without_noise_the_sample_time_decides() {
        let [lambda, eta] = thesis_law(&QUIET);
        assert_eq!((lambda, eta), (50.0, 0.1 * 0.3));
        let [gain, decay] = model_reference(&QUIET);
        assert_eq!(decay, 100.0);
        // Critically damped, and a plant that is excited far more than expected is still stable.
        assert!((gain * 0.8_f64.powi(2) - 0.25 * decay * decay).abs() < 1e-9);
        let wild = Expected { largest_regressor: 8.0, ..QUIET };
        let [gain, decay] = model_reference(&wild);
        assert!((gain * 0.01 * 64.0 - decay).abs() < 1e-9, "half of 2 k");
    }

    /// The law's own recursion with noise of the assumed size leaves the error that the rule allows.
    #[test]
    fn noise_leaves_the_error_that_the_rule_allows() {
        let noisy = Expected { noise: 0.05, ..QUIET };
        let allowed = NOISE_ERROR * noisy.nominal * noisy.half_width;
        let [lambda, eta] = thesis_law(&noisy);
        assert_eq!(lambda, 4.0);
        let (z, sigma) = (noisy.slope, noisy.noise * noisy.rate.hypot(lambda * noisy.signal));
        let mut theta = 0.0;
        let found = spread(|n| {
            theta += (-z * theta + sigma * n) / (eta + z);
            theta
        });
        // An average over some 350 samples leaves 1100 independent ones: 2 % of a standard deviation, five of which are allowed.
        assert!((found / allowed - 1.0).abs() < 0.1, "{found} {allowed}");

        let [gain, decay] = model_reference(&noisy);
        let h = noisy.sample_time_s;
        let phi = noisy.regressor;
        let (mut e, mut w) = (0.0, 0.0);
        let found = spread(|n| {
            let measured = e + noisy.noise * n;
            (e, w) = (e + h * (phi * w - decay * measured), w - h * gain * phi * measured);
            w
        });
        let allowed = NOISE_ERROR * noisy.nominal;
        assert!(decay < 30.0, "slow enough for the sums to be integrals: {decay}");
        assert!((found / allowed - 1.0).abs() < 0.15, "{found} {allowed}");
    }
}
