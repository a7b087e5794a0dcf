//! Dryden turbulence against the analytic spectra and variances of MIL-F-8785C.
#![allow(clippy::unwrap_used, clippy::panic)] // helpers of tests are tests

use phugoid_flight_dynamics::dryden::{Dryden, DrydenField};
use phugoid_flight_dynamics::gust::AirMotion;
use std::f64::consts::{PI, TAU};

const SPEED: f64 = 205.74;
const SPAN: f64 = 9.144;
const SIGMA: f64 = 1.11;

fn field() -> DrydenField {
    DrydenField::of_sigma(SIGMA, 6096.0)
}

fn flown(step: f64, samples: usize, seed: u64) -> Vec<AirMotion> {
    let mut air = Dryden::new(field(), SPEED, SPAN, step, seed).unwrap();
    (0..samples).map(|_| air.sample()).collect()
}

/// One-sided spectra over the angular frequency, `integral over 0..inf = variance`, as the standard prints them (with
/// `Omega = omega/V` and `Phi(omega) = Phi(Omega)/V`): u, v, w, p, q, r.
fn spectrum(omega: f64) -> [f64; 6] {
    let field = field();
    let [lu, lv, lw] = field.scale_length;
    let x = omega / SPEED;
    let s2 = SIGMA * SIGMA;
    let along = s2 * 2.0 * lu / PI / (1.0 + (lu * x).powi(2));
    let transverse = |l: f64| s2 * l / PI * (1.0 + 3.0 * (l * x).powi(2)) / (1.0 + (l * x).powi(2)).powi(2);
    let roll = s2 / lw * 0.8 * (PI * lw / (4.0 * SPAN)).cbrt() / (1.0 + (4.0 * SPAN * x / PI).powi(2));
    let pitch = x * x / (1.0 + (4.0 * SPAN * x / PI).powi(2)) * transverse(lw);
    let yaw = x * x / (1.0 + (3.0 * SPAN * x / PI).powi(2)) * transverse(lv);
    [along, transverse(lv), transverse(lw), roll, pitch, yaw].map(|phi| phi / SPEED)
}

fn channels(air: &AirMotion) -> [f64; 6] {
    let ([u, v, w], [p, q, r]) = (air.velocity, air.rates);
    [u, v, w, p, q, r]
}

/// Variance from the printed spectrum by quadrature in `omega = tan(angle)`, where the integrand stays finite.
fn variances() -> [f64; 6] {
    let n = 200_000;
    let mut sum = [0.0; 6];
    for k in 0..n {
        let angle = 0.5 * PI * (k as f64 + 0.5) / n as f64;
        let (omega, weight) = (angle.tan(), 0.5 * PI / n as f64 / angle.cos().powi(2));
        sum.iter_mut().zip(spectrum(omega)).for_each(|(s, phi)| *s += weight * phi);
    }
    sum
}

/// The rate filters have corners of some 20 rad/s: the pilot feels a small part of a transverse gust as a rotation.
#[test]
fn the_variance_is_that_of_the_spectrum() {
    let expected = variances();
    for (i, sigma) in [SIGMA; 3].into_iter().enumerate() {
        assert!((expected[i].sqrt() / sigma - 1.0).abs() < 1e-4, "the printed spectrum integrates to its own variance");
    }
    // 200 flights of 300 s: some 300 V/L / 2 = 58 independent values of the slowest gust each, 11,600 in all, so that a
    // variance is known to sqrt(2/11,600) = 1.3 %; four of these.
    let mut sum = [0.0; 6];
    let (flights, samples) = (200, 3000);
    for seed in 0..flights {
        for air in flown(0.1, samples, seed) {
            sum.iter_mut().zip(channels(&air)).for_each(|(s, x)| *s += x * x / (flights as f64 * samples as f64));
        }
    }
    for i in 0..6 {
        assert!((sum[i] / expected[i] - 1.0).abs() < 0.053, "channel {i}: {} of {}", sum[i], expected[i]);
    }
}

/// Averaged periodograms in three bands against the band's mean of the printed spectrum.
#[test]
fn the_power_lies_where_the_spectrum_has_it() {
    let (step, samples, flights) = (0.05, 4096, 60);
    // Frequency bands in cycles per second and the bins of the record that lie in them.
    let bands = [(0.02, 0.1), (0.1, 0.5), (0.5, 2.0)];
    let length = step * samples as f64;
    let bins = bands.map(|(from, to)| ((from * length) as usize, (to * length) as usize));
    let mut power = [[0.0; 3]; 6];
    for seed in 0..flights {
        let air = flown(step, samples, 1000 + seed);
        for (b, &(from, to)) in bins.iter().enumerate() {
            // Every third bin is enough: they are nearly independent.
            for bin in (from..to).step_by(3) {
                let omega = TAU * bin as f64 / length;
                let mut z = [[0.0; 2]; 6];
                for (k, air) in air.iter().enumerate() {
                    // A Hann window keeps the steep low end from leaking.
                    let window = 1.0 - (TAU * k as f64 / samples as f64).cos();
                    let (s, c) = (omega * step * k as f64).sin_cos();
                    for (z, x) in z.iter_mut().zip(channels(air)) {
                        z[0] += window * x * c;
                        z[1] += window * x * s;
                    }
                }
                // One-sided density over omega: |X|^2 h / (pi N mean window^2), mean window^2 = 1.5.
                let count = (from..to).step_by(3).count() as f64 * flights as f64;
                for i in 0..6 {
                    power[i][b] += (z[i][0].powi(2) + z[i][1].powi(2)) * step / (PI * 1.5 * samples as f64) / count;
                }
            }
        }
    }
    for (b, &(from, to)) in bins.iter().enumerate() {
        let every: Vec<f64> = (from..to).step_by(3).map(|bin| TAU * bin as f64 / length).collect();
        for i in 0..6 {
            // Sampling folds what lies above the Nyquist frequency back.
            let folded = |omega: f64| {
                let around = |m: i32| spectrum((omega + f64::from(m) * TAU / step).abs())[i];
                (-40..=40).map(around).sum::<f64>()
            };
            let expected = every.iter().map(|w| folded(*w)).sum::<f64>() / every.len() as f64;
            // Each bin of each flight has a relative deviation of one.
            let tolerance = 4.5 / ((every.len() * 60) as f64).sqrt() + 0.01;
            let ratio = power[i][b] / expected;
            assert!((ratio - 1.0).abs() < tolerance, "channel {i}, band {b}: {ratio}, tolerance {tolerance}");
        }
    }
}

/// Covariances at one and the same lag do not depend on how often the field is sampled.
#[test]
fn the_step_changes_no_statistics() {
    let lag = 0.2;
    let covariance = |step: f64| {
        let apart = (lag / step).round() as usize;
        let mut sum = [0.0; 6];
        let flights = 4000;
        for seed in 0..flights {
            let air = flown(step, apart + 1, 77_000 + seed);
            let (first, last) = (channels(&air[0]), channels(&air[apart]));
            for i in 0..6 {
                sum[i] += first[i] * last[i] / flights as f64;
            }
        }
        sum
    };
    let variances = variances();
    let (fine, coarse) = (covariance(0.0025), covariance(0.2));
    for i in 0..6 {
        // Deviation of a product of two normal numbers at most sqrt(2) of the variance; the difference of two means.
        let tolerance = 4.0 * 2.0 / 4000.0_f64.sqrt() * variances[i];
        assert!((fine[i] - coarse[i]).abs() < tolerance, "channel {i}: {} {}", fine[i], coarse[i]);
    }
    // The along gust is an Ornstein-Uhlenbeck process: its covariance is known.
    let tau = field().scale_length[0] / SPEED;
    let expected = SIGMA * SIGMA * (-lag / tau).exp();
    assert!((fine[0] - expected).abs() < 4.0 * 1.5 / 4000.0_f64.sqrt() * variances[0], "{} {expected}", fine[0]);
}

#[test]
fn a_seed_gives_the_same_gusts_and_another_one_others() {
    assert_eq!(flown(0.01, 50, 4), flown(0.01, 50, 4));
    assert_ne!(flown(0.01, 50, 4), flown(0.01, 50, 5));
    // A change of generator or filter would silently change every seeded study.
    let first = flown(0.01, 2, 4)[1];
    assert_eq!(first.velocity.map(|v| (v * 1e6).round()), [-1_831_394.0, 904_264.0, 1_020_314.0]);
}

/// Flying into an updraught: the nose meets it first, which is a rotation of the air nose-up as the body axes count.
#[test]
fn the_pitching_of_the_air_is_the_gradient_of_the_vertical_gust() {
    let step = 0.001;
    let air = flown(step, 20_000, 9);
    // Smooth the gust with the same lag as the standard smooths its gradient, then -dw/dx = -(1/V) dw/dt.
    let tau = 4.0 * SPAN / (PI * SPEED);
    let mut smooth = air[0].velocity[2] + 0.0;
    let (mut product, mut squares) = (0.0, 0.0);
    for pair in air.windows(2).skip(2000) {
        let before = smooth;
        smooth += (pair[1].velocity[2] - smooth) * (1.0 - (-step / tau).exp());
        let gradient = -(smooth - before) / step / SPEED;
        product += gradient * pair[1].rates[1];
        squares += gradient * gradient;
    }
    assert!((product / squares - 1.0).abs() < 0.05, "{}", product / squares);
}
