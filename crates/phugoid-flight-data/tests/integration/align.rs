//! Alignment: nothing is shown before its stamp, twice, or without having been put.
#![allow(clippy::unwrap_used, clippy::panic)]

use phugoid_flight_data::align::{Aligner, Hold};
use proptest::prelude::*;
use proptest::test_runner::{Config, RngAlgorithm, RngSeed};

fn config() -> Config {
    Config {
        rng_algorithm: RngAlgorithm::ChaCha,
        rng_seed: RngSeed::Fixed(11),
        failure_persistence: None,
        ..Config::default()
    }
}

fn frames(hold: Hold, puts: &[(f64, f64)], base: &[f64]) -> Vec<f64> {
    let mut aligner = Aligner::new(&[hold]);
    puts.iter().for_each(|&(time, value)| aligner.put(0, time, value));
    let mut out = [0.0];
    base.iter()
        .map(|&time| {
            aligner.frame(time, &mut out);
            out[0]
        })
        .collect()
}

fn same(a: &[f64], b: &[f64]) -> bool {
    a.len() == b.len() && a.iter().zip(b).all(|(a, b)| a == b || a.is_nan() && b.is_nan())
}

const NAN: f64 = f64::NAN;

#[test]
fn a_sample_appears_once_at_the_first_base_time_not_before_it() {
    let shown = frames(Hold::Sampled, &[(0.0, 1.0), (0.1, 2.0), (0.15, 3.0), (0.31, 4.0)], &[0.0, 0.1, 0.2, 0.3, 0.4]);
    assert!(same(&shown, &[1.0, 2.0, 3.0, NAN, 4.0]), "{shown:?}");
}

#[test]
fn of_several_within_a_step_the_newest_is_shown_and_the_rest_counted() {
    let mut aligner = Aligner::new(&[Hold::Sampled]);
    for (time, value) in [(0.01, 1.0), (0.02, 2.0), (0.03, 3.0)] {
        aligner.put(0, time, value);
    }
    let mut out = [0.0];
    assert!(aligner.frame(0.05, &mut out));
    assert_eq!(out, [3.0]);
    let statistics = aligner.statistics(0).unwrap();
    assert_eq!((statistics.received, statistics.shown, statistics.passed_over), (3, 1, 2));
    assert!((statistics.largest_delay_s - 0.02).abs() < 1e-15);
}

#[test]
fn a_level_is_held_until_it_is_stale_or_declared_missing() {
    let hold = Hold::Held { stale_after_s: 0.25 };
    let base = [0.1, 0.2, 0.3, 0.4, 0.5];
    let shown = frames(hold, &[(0.1, 5.0)], &base);
    assert!(same(&shown, &[5.0, 5.0, 5.0, NAN, NAN]), "{shown:?}");
    let shown = frames(hold, &[(0.1, 5.0), (0.15, NAN), (0.45, 6.0)], &base);
    assert!(same(&shown, &[5.0, NAN, NAN, NAN, 6.0]), "{shown:?}");
}

#[test]
fn late_values_are_shown_next_and_older_ones_dropped() {
    let mut aligner = Aligner::new(&[Hold::Sampled]);
    let mut out = [0.0];
    aligner.put(0, 0.05, 1.0);
    aligner.frame(0.1, &mut out);
    aligner.put(0, 0.09, 2.0); // belonged to 0.1
    aligner.put(0, 0.04, 3.0); // older than what was shown
    aligner.frame(0.2, &mut out);
    assert_eq!(out, [2.0]);
    let statistics = aligner.statistics(0).unwrap();
    assert_eq!((statistics.late, statistics.out_of_order), (1, 1));
}

#[test]
fn base_times_that_do_not_rise_change_nothing() {
    let mut aligner = Aligner::new(&[Hold::Sampled]);
    let mut out = [0.0];
    aligner.put(0, 1.0, 1.0);
    for time in [NAN, f64::INFINITY, f64::NEG_INFINITY] {
        assert!(!aligner.frame(time, &mut out) && out[0].is_nan());
    }
    assert!(aligner.frame(0.5, &mut out) && out[0].is_nan(), "the value is stamped later");
    assert!(!aligner.frame(0.5, &mut out));
    assert!(aligner.frame(1.0, &mut out) && out == [1.0]);
}

#[test]
fn a_gap_of_the_base_makes_values_too_old() {
    let mut aligner = Aligner::new(&[Hold::Sampled]).with_longest_delay(0.2);
    let mut out = [0.0];
    aligner.put(0, 0.05, 1.0);
    aligner.frame(9.0, &mut out);
    assert!(out[0].is_nan());
    assert_eq!(aligner.statistics(0).unwrap().too_old, 1);
}

#[test]
fn a_restarted_clock_begins_anew() {
    let mut aligner = Aligner::new(&[Hold::Held { stale_after_s: 1e9 }]);
    let mut out = [0.0];
    aligner.put(0, 100.0, 1.0);
    aligner.frame(100.0, &mut out);
    aligner.restart();
    assert!(aligner.frame(0.5, &mut out) && out[0].is_nan(), "nothing of before is held");
    aligner.put(0, 0.6, 2.0);
    assert!(aligner.frame(0.7, &mut out) && out == [2.0]);
}

#[test]
fn what_waits_is_bounded() {
    let mut aligner = Aligner::new(&[Hold::Sampled]);
    (0..100_000).for_each(|i| aligner.put(0, 1e6 + f64::from(i), 1.0));
    assert_eq!(aligner.statistics(0).unwrap().refused, 100_000 - 4096);
}

/// What a stream does: values with stamps that may be anything, and base times that may be anything.
fn events() -> impl Strategy<Value = Vec<(bool, f64, f64)>> {
    let time = prop_oneof![20 => -1.0..10.0_f64, 1 => Just(NAN), 1 => Just(f64::INFINITY)];
    let value = prop_oneof![20 => -5.0..5.0_f64, 1 => Just(NAN)];
    prop::collection::vec((prop::bool::weighted(0.3), time, value), 0..200)
}

proptest! {
    #![proptest_config(config())]

    /// Every value shown was put, with a stamp at or before the base time, and no sampled value is shown twice.
    #[test]
    fn nothing_is_invented_or_known_beforehand(events in events(), stale in prop::option::of(0.0..2.0_f64)) {
        let hold = stale.map_or(Hold::Sampled, |stale_after_s| Hold::Held { stale_after_s });
        let mut aligner = Aligner::new(&[hold]);
        // Values are made distinct, so that a shown one tells its stamp.
        let mut put: Vec<(f64, f64)> = Vec::new();
        let (mut shown, mut last_stamp) = (0, f64::NEG_INFINITY);
        for (index, (is_frame, time, value)) in events.into_iter().enumerate() {
            if !is_frame {
                let value = value + 100.0 * index as f64;
                aligner.put(0, time, value);
                put.push((time, value));
                continue;
            }
            let mut out = [0.0];
            if aligner.frame(time, &mut out) && !out[0].is_nan() {
                let (stamp, _) = put.iter().find(|(_, value)| *value == out[0]).copied().unwrap();
                prop_assert!(stamp <= time);
                match stale {
                    None => prop_assert!(stamp > last_stamp),
                    Some(stale) => prop_assert!(stamp >= last_stamp && time - stamp <= stale),
                }
                last_stamp = stamp;
                shown += 1;
            }
        }
        let statistics = *aligner.statistics(0).unwrap();
        if stale.is_none() {
            prop_assert_eq!(statistics.shown, shown);
        }
        prop_assert_eq!(statistics.received, put.iter().filter(|(_, value)| value.is_finite()).count());
        // All accounted for once the clock has passed every stamp.
        aligner.restart();
        let s = aligner.statistics(0).unwrap();
        prop_assert_eq!(s.received, s.shown + s.passed_over + s.out_of_order + s.too_old + s.refused);
    }

    /// At its own times, a channel that keeps order is shown as it is.
    #[test]
    fn on_its_own_times_a_channel_is_unchanged(steps in prop::collection::vec((0.001..1.0_f64, -5.0..5.0_f64), 1..100)) {
        let mut time = 0.0;
        let series: Vec<(f64, f64)> = steps.into_iter().map(|(step, value)| { time += step; (time, value) }).collect();
        let base: Vec<f64> = series.iter().map(|(time, _)| *time).collect();
        let values: Vec<f64> = series.iter().map(|(_, value)| *value).collect();
        prop_assert_eq!(frames(Hold::Sampled, &series, &base), values);
    }

    /// Values that come as they are stamped give the same frames as values that were all put beforehand.
    #[test]
    fn a_stream_and_a_log_give_the_same(puts in prop::collection::vec((0.0..10.0_f64, -5.0..5.0_f64), 0..100), step in 0.05..1.0_f64) {
        let mut puts = puts;
        puts.sort_by(|a, b| a.0.total_cmp(&b.0));
        let base: Vec<f64> = (0..20).map(|i| f64::from(i) * step).collect();
        let at_once = frames(Hold::Sampled, &puts, &base);
        let mut aligner = Aligner::new(&[Hold::Sampled]);
        let (mut next, mut streamed) = (0, Vec::new());
        for &time in &base {
            while next < puts.len() && puts[next].0 <= time {
                aligner.put(0, puts[next].0, puts[next].1);
                next += 1;
            }
            let mut out = [0.0];
            aligner.frame(time, &mut out);
            streamed.push(out[0]);
        }
        prop_assert!(same(&at_once, &streamed));
    }
}
