//! Sensors: their statistics, timing and reproducibility.
#![allow(clippy::unwrap_used, clippy::panic)] // helpers of tests are tests

use phugoid_flight_dynamics::sensors::{Sensor, SensorError, SensorSpecification, SensorSuite};
use proptest::prelude::*;

fn times(n: usize, step: f64) -> Vec<f64> {
    (0..n).map(|k| k as f64 * step).collect()
}

fn record(specification: SensorSpecification, seed: u64, channel: usize, times: &[f64], values: &[f64]) -> Vec<f64> {
    Sensor::new(specification, seed, channel).unwrap().record(times, values).unwrap()
}

fn mean(x: &[f64]) -> f64 {
    x.iter().sum::<f64>() / x.len() as f64
}

#[test]
fn noise_is_white_gaussian_with_its_deviation_and_bias() {
    let n = 100_000;
    let specification = SensorSpecification { noise: 0.3, bias: 1.5, ..Default::default() };
    let x: Vec<f64> = record(specification, 1, 0, &times(n, 0.01), &vec![0.0; n]).iter().map(|v| v - 1.5).collect();
    let deviation = mean(&x.iter().map(|v| v * v).collect::<Vec<_>>()).sqrt();
    // Four standard errors each: std/sqrt(n), std/sqrt(2n), 1/sqrt(n), sqrt(24/n).
    assert!(mean(&x).abs() < 4.0 * 0.3 / (n as f64).sqrt());
    assert!((deviation / 0.3 - 1.0).abs() < 4.0 / (2.0 * n as f64).sqrt());
    let lag_one = x.windows(2).map(|w| w[0] * w[1]).sum::<f64>() / (n as f64 * 0.09);
    assert!(lag_one.abs() < 4.0 / (n as f64).sqrt(), "{lag_one}");
    let kurtosis = mean(&x.iter().map(|v| v.powi(4)).collect::<Vec<_>>()) / deviation.powi(4);
    assert!((kurtosis - 3.0).abs() < 4.0 * (24.0 / n as f64).sqrt(), "{kurtosis}");
}

#[test]
fn channels_and_seeds_are_independent() {
    let n = 20_000;
    let (t, zero) = (times(n, 0.01), vec![0.0; n]);
    let noisy = SensorSpecification { noise: 1.0, ..Default::default() };
    let all: Vec<Vec<f64>> =
        [(1, 0), (1, 1), (2, 0), (2, 1), (0, 0)].iter().map(|&(s, c)| record(noisy, s, c, &t, &zero)).collect();
    for i in 0..all.len() {
        for j in 0..i {
            let correlation = all[i].iter().zip(&all[j]).map(|(a, b)| a * b).sum::<f64>() / n as f64;
            assert!(correlation.abs() < 4.5 / (n as f64).sqrt(), "{i} {j}: {correlation}");
        }
    }
}

/// The numbers themselves: a change of generator, hash or distribution would silently change every seeded study.
#[test]
fn the_noise_of_a_seed_does_not_change() {
    let noisy = SensorSpecification { noise: 1.0, ..Default::default() };
    let first = record(noisy, 20_260_101, 3, &times(3, 0.01), &[0.0; 3]);
    assert_eq!(first, [0.23433734959196945, -0.08919951298998542, 0.34350819382948916]);
}

#[test]
fn adding_a_channel_or_a_disturbance_changes_no_other_number() {
    let noisy = SensorSpecification { noise: 1.0, ..Default::default() };
    let mut two = SensorSuite::new(&[noisy; 2], 7).unwrap();
    let mut three = SensorSuite::new(&[noisy; 3], 7).unwrap();
    let troubled = SensorSpecification { outlier_probability: 0.2, outlier_size: 50.0, drop_probability: 0.2, ..noisy };
    let mut alone = Sensor::new(troubled, 7, 1).unwrap();
    let (mut outliers, mut drops) = (0, 0);
    for t in times(1000, 0.01) {
        let a = two.measure(t, &[0.0; 2]).unwrap();
        let b = three.measure(t, &[0.0; 3]).unwrap();
        assert_eq!(a[..], b[..2]);
        let c = alone.measure(t, 0.0).unwrap();
        if c.is_nan() {
            drops += 1;
        } else if c != a[1] {
            assert!(((c - a[1]).abs() - 50.0).abs() < 1e-12);
            outliers += 1;
        }
    }
    // Binomial(1000, 0.2) and Binomial(1000, 0.16), within four standard deviations.
    assert!((150..=250).contains(&drops) && (114..=206).contains(&outliers), "{drops} {outliers}");
}

/// Bursts are as frequent as independent outliers, of the mean length asked for, and of one sign each.
#[test]
fn outliers_come_in_bursts_when_asked_to() {
    let n = 400_000;
    let (t, zero) = (times(n, 0.01), vec![0.0; n]);
    let bursts =
        SensorSpecification { outlier_probability: 0.05, outlier_size: 1.0, outlier_burst: 12.0, ..Default::default() };
    let x = record(bursts, 5, 0, &t, &zero);
    let outliers = x.iter().filter(|v| **v != 0.0).count();
    let begun = x.windows(2).filter(|w| w[0] == 0.0 && w[1] != 0.0).count();
    // 1667 bursts: their number and mean length are known to 1/sqrt(1667) = 2.4 % each, the product to some 3.5 %.
    assert!((outliers as f64 / (0.05 * n as f64) - 1.0).abs() < 0.14, "{outliers}");
    assert!((outliers as f64 / begun as f64 / 12.0 - 1.0).abs() < 0.1, "{outliers} in {begun}");
    assert!(x.windows(2).all(|w| w[0] * w[1] >= 0.0), "one burst, one sign");
    let positive = x.windows(2).filter(|w| w[0] == 0.0 && w[1] > 0.0).count();
    assert!((positive as f64 / begun as f64 - 0.5).abs() < 0.05, "{positive} of {begun}");
    // A mean length of one sample: none is followed by another one of the same burst.
    let short = SensorSpecification { outlier_burst: 1.0, ..bursts };
    let x = record(short, 5, 0, &t, &zero);
    assert!(x.windows(2).all(|w| w[0] == 0.0 || w[1] == 0.0));
    let impossible = SensorSpecification { outlier_burst: 0.5, ..bursts };
    assert!(Sensor::new(impossible, 0, 0).unwrap_err().to_string().contains("outlier_burst is 0.5"));
}

#[test]
fn a_slower_channel_is_nan_between_its_samples() {
    let slow = SensorSpecification { sample_interval: 0.05, ..Default::default() };
    let t = times(1001, 0.01);
    let x = record(slow, 0, 0, &t, &t);
    for (k, x) in x.iter().enumerate() {
        assert_eq!(x.is_nan(), k % 5 != 0, "sample {k}");
    }
    // 30 Hz asked at 100 Hz: as many samples as at 30 Hz, each at the first question after it is due.
    let odd = SensorSpecification { sample_interval: 1.0 / 30.0, ..Default::default() };
    let x = record(odd, 0, 0, &t, &t);
    assert_eq!(x.iter().filter(|v| !v.is_nan()).count(), 301);
}

#[test]
fn a_delay_shifts_and_interpolates() {
    let late = SensorSpecification { delay: 0.025, ..Default::default() };
    let t = times(200, 0.01);
    let truth: Vec<f64> = t.iter().map(|t| 3.0 + 2.0 * t).collect();
    let x = record(late, 0, 0, &t, &truth);
    for (k, &x) in x.iter().enumerate() {
        let expected = 3.0 + 2.0 * (t[k] - 0.025).max(0.0);
        assert!((x - expected).abs() < 1e-12, "sample {k}: {x} {expected}");
    }
}

#[test]
fn quantisation_gives_multiples_of_its_step_within_half_of_it() {
    let coarse = SensorSpecification { quantisation: 0.1, ..Default::default() };
    let t = times(500, 0.01);
    let truth: Vec<f64> = t.iter().map(|t| (7.0 * t).sin()).collect();
    for (x, truth) in record(coarse, 0, 0, &t, &truth).iter().zip(&truth) {
        assert!((x / 0.1 - (x / 0.1).round()).abs() < 1e-9 && (x - truth).abs() <= 0.05 + 1e-12);
    }
}

#[test]
fn wrong_specifications_and_times_are_refused_by_name() {
    let wrong = SensorSpecification { outlier_probability: 2.0, ..Default::default() };
    let error = Sensor::new(wrong, 0, 4).unwrap_err();
    assert_eq!(error.to_string(), "sensor channel 4: outlier_probability is 2, expected a probability, 0 to 1");
    let mut sensor = Sensor::new(SensorSpecification::default(), 0, 1).unwrap();
    sensor.measure(1.0, 0.0).unwrap();
    assert_eq!(sensor.measure(0.5, 0.0), Err(SensorError::TimeBackwards { channel: 1, time: 0.5, previous: 1.0 }));
    assert_eq!(sensor.record(&[2.0], &[]), Err(SensorError::Length { values: 0, expected: 1 }));
}

proptest! {
    /// Causality: what comes later does not change a reading.
    #[test]
    fn readings_do_not_depend_on_the_future(
        delay in 0.0..0.1_f64, interval in 0.0..0.05_f64, cut in 1..99_usize, seed: u64,
    ) {
        let specification = SensorSpecification {
            noise: 0.1, delay, sample_interval: interval, quantisation: 0.01, ..Default::default()
        };
        let t = times(100, 0.013);
        let truth: Vec<f64> = t.iter().map(|t| (3.0 * t).cos()).collect();
        let whole = record(specification, seed, 0, &t, &truth);
        let part = record(specification, seed, 0, &t[..cut], &truth[..cut]);
        for (a, b) in whole.iter().zip(&part) {
            prop_assert!(a.to_bits() == b.to_bits());
        }
    }
}
