//! The measured noise level against known noise on a moving signal.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use crate::plants;

use phugoid_estimators::noise::{NoiseMonitor, third_difference_std};
use plants::*;

/// A 0.5 Hz motion a hundred times larger than the noise, at 100 Hz, with 5 % outliers and gaps.
fn signal(n: usize, std: f64, seed: u64) -> Vec<f64> {
    let mut rng = seeded(seed);
    (0..n)
        .map(|k| {
            let t = k as f64 * 0.01;
            let clean = 100.0 * std * (3.1 * t).sin() + std * normal(&mut rng);
            match k {
                _ if k % 20 == 7 => clean + 30.0 * std,
                _ if k % 33 == 5 => f64::NAN,
                _ => clean,
            }
        })
        .collect()
}

#[test]
fn the_noise_level_is_read_within_its_own_scatter() {
    let mut scratch = [0.0; 4000];
    for std in [1e-4, 1.0, 300.0] {
        // Outliers touch four differences each: a fifth of all. The median of the contaminated sizes reads high by
        // about a quarter.
        let dirty = third_difference_std(&signal(4000, std, 1), &mut scratch).unwrap();
        assert!((0.9..1.45).contains(&(dirty / std)), "{}", dirty / std);
        let clean: Vec<f64> = {
            let mut rng = seeded(2);
            (0..4000).map(|k| 100.0 * std * (0.031 * k as f64).sin() + std * normal(&mut rng)).collect()
        };
        let read = third_difference_std(&clean, &mut scratch).unwrap();
        assert!((0.95..1.05).contains(&(read / std)), "{}", read / std);
    }
}

#[test]
fn the_monitor_agrees_with_the_batch_form_over_its_window() {
    let a = signal(500, 0.5, 3);
    let mut monitor = NoiseMonitor::<2, 100>::new();
    assert_eq!(monitor.std(), [None, None]);
    for (k, y) in a.iter().enumerate() {
        monitor.push(&[*y, 7.0]);
        let [read, constant] = monitor.std();
        if k >= 8 {
            assert_eq!(constant, Some(0.0));
        }
        if k == 499 {
            // The last 100 third differences that exist.
            let mut sizes: Vec<f64> =
                a.windows(4).map(|w| (w[3] - 3.0 * w[2] + 3.0 * w[1] - w[0]).abs()).filter(|d| d.is_finite()).collect();
            sizes.drain(..sizes.len() - 100);
            sizes.sort_by(f64::total_cmp);
            let expected = 1.4826 * 0.5 * (sizes[49] + sizes[50]) / 20.0_f64.sqrt();
            assert!((read.unwrap() - expected).abs() < 1e-12 * expected);
        }
    }
}

#[test]
fn too_little_data_gives_no_level() {
    let mut scratch = [0.0; 10];
    assert_eq!(third_difference_std(&[1.0, 2.0, 1.0, 2.0, 1.0], &mut scratch), None);
    assert_eq!(third_difference_std(&[f64::NAN; 50], &mut scratch), None);
    assert_eq!(third_difference_std(&[], &mut []), None);
}
