//! The arena: every method on the same flights; one that is broken on purpose has to be seen to be.
#![allow(clippy::unwrap_used, clippy::panic)] // helpers of tests are tests

use phugoid_evaluation::arena::{Arena, Contestant, Entry, Unit, built_in, compare, csv};
use phugoid_identification::estimate::{EstimateError, EstimateOptions, Method, estimate};
use phugoid_identification::estimation::Estimation;

fn entry(id: &str) -> Entry {
    built_in(id).unwrap().unwrap()
}

/// The flagship, spoilt.
fn spoilt(name: &str, causal: bool, spoil: fn(&mut Estimation)) -> Contestant {
    Contestant::new(name, causal, move |record, model| {
        let mut estimation = estimate(record, model, &EstimateOptions::default(), &mut |_| {})?;
        spoil(&mut estimation);
        Ok(estimation)
    })
}

fn biased(estimation: &mut Estimation) {
    for parameter in &mut estimation.history.parameters {
        for (value, sigma) in parameter.value.iter_mut().zip(&parameter.std_error) {
            *value += 6.0 * sigma;
        }
    }
}

/// Without what no two runs share.
fn timeless(mut arena: Arena) -> Arena {
    for method in arena.entries.iter_mut().flat_map(|e| &mut e.methods) {
        (method.microseconds, method.relative_time) = (0.0, 0.0);
    }
    arena
}

#[test]
fn flights_are_shared_results_repeat_and_the_truth_is_found() {
    let entries = [entry("calm"), entry("damage")];
    let contestants = || [Contestant::of(Method::Smpe), spoilt("twin", true, |_| ())];
    let arena = timeless(compare(&entries, &contestants(), 2, &|| ()).unwrap());
    // As text: a number that is absent, as the time to 5 % of a parameter that never comes there, equals itself there.
    let text = |arena: &Arena| format!("{arena:?}");
    assert_eq!(text(&arena), text(&timeless(compare(&entries, &contestants(), 2, &|| ()).unwrap())));
    let [calm, damage] = arena.entries.as_slice() else { panic!("two entries") };
    assert_eq!((calm.unit, calm.counted_from_s, damage.counted_from_s), (Unit::CramerRao, 0.5, 10.0));
    let [ours, twin] = calm.methods.as_slice() else { panic!("two methods") };
    assert_eq!(ours.checkpoints, twin.checkpoints, "the same samples, the same method");
    assert!(ours.failed == 0 && ours.without_bounds == 0 && ours.detection.false_alarms.count == 0);
    for checkpoint in &ours.checkpoints {
        // The geometric mean of five root mean squares of two values each: within a factor of two and a half of one, as
        // 2 runs times 5 parameters with 10 degrees of freedom nearly always are (chi-square 10: 2.2 to 25 at 99.5 %).
        let accuracy = checkpoint.accuracy.unwrap();
        assert!((0.3..2.0).contains(&accuracy), "{accuracy}");
        for p in &checkpoint.parameters {
            assert!(p.rmse_over_unit < 4.0 && p.rmse < 0.05 * 3.0, "{} {}", p.name, p.rmse_over_unit);
        }
    }
    assert!(calm.methods[0].settled_median_s.is_some_and(|t| t < 10.0));
    let found = &damage.methods[0].detection;
    assert_eq!((found.damaged, found.found), (2, 2));
    assert!(found.latency_median_s.unwrap() < 1.5, "{found:?}");
    assert!(damage.methods[0].checkpoints[2].accuracy.unwrap() < 3.0);
    assert_eq!(arena.findings.best[0].methods, ["smpe", "twin"], "equals share the first place");
    assert!(arena.findings.ours_loses.is_empty(), "{:?}", arena.findings.ours_loses);
    // Every judged number: entries x flights x methods x checkpoints x parameters.
    assert_eq!(arena.rows.len(), 2 * 2 * 2 * 3 * 5);
    let text = csv(&arena.rows).unwrap();
    assert!(text.starts_with("entry,method,seed,cycles,parameter,truth,estimate,std_error,unit\ncalm,smpe,1000,1"));
}

#[test]
fn a_broken_method_is_seen_to_be_broken() {
    let refuses = Contestant::new("refuses", true, |_, _| Err(EstimateError::Model("out of order".to_owned())));
    let diverges = spoilt("diverges", true, |e| e.history.parameters[0].value.iter_mut().for_each(|v| *v = f64::NAN));
    let silent = spoilt("silent", true, |e| {
        e.history.parameters.iter_mut().for_each(|p| p.std_error.iter_mut().for_each(|s| *s = f64::NAN));
    });
    let contestants = [spoilt("biased", true, biased), Contestant::of(Method::Smpe), refuses, diverges, silent];
    let arena = compare(&[entry("calm")], &contestants, 3, &|| ()).unwrap();
    let methods = &arena.entries[0].methods;
    let coverage = methods[0].checkpoints[2].coverage.unwrap();
    assert!(coverage.fraction < 0.1 && coverage.interval[1] < 0.9, "{coverage:?}");
    assert!(methods[1].checkpoints[2].coverage.unwrap().fraction > 0.5);
    assert_eq!((methods[2].failed, methods[2].failure.as_deref()), (3, Some("out of order")));
    assert!(methods[2].checkpoints[0].accuracy.is_none());
    let why = methods[3].failure.as_deref().unwrap();
    assert!(methods[3].failed == 3 && why.contains("is NaN at 4.67 s"), "{why}");
    assert!(methods[4].without_bounds == 3 && methods[4].checkpoints[1].coverage.is_none());
    let findings = &arena.findings;
    assert_eq!(findings.best[0].methods, ["smpe"]);
    for (sentence, reason) in findings.methods.iter().zip([
        "bounds cover 0 %",
        "nothing speaks against its bounds in 3 flights",
        "fails in 3 of 3 flights",
        "fails in 3 of 3 flights",
        "claims no bounds, and cannot win",
    ]) {
        assert!(sentence.contains(reason), "{sentence}");
    }
    let [loss] = findings.ours_loses.as_slice() else { panic!("{:?}", findings.ours_loses) };
    assert!(loss.contains("bounds cover 0 %") && loss.contains("`smpe` is more accurate"), "{loss}");
}

/// A method that needs the whole record is given the record up to each time that is looked at, and no more.
#[test]
fn a_batch_method_sees_nothing_of_the_future() {
    let contestants = [Contestant::of(Method::Smpe), spoilt("replayed", false, |_| ())];
    let arena = compare(&[entry("outliers")], &contestants, 1, &|| ()).unwrap();
    let [causal, replayed] = arena.entries[0].methods.as_slice() else { panic!("two methods") };
    for (a, b) in causal.checkpoints.iter().zip(&replayed.checkpoints) {
        for (a, b) in a.parameters.iter().zip(&b.parameters) {
            assert_eq!((a.bias, a.claimed), (b.bias, b.claimed), "{}", a.name);
        }
    }
}

/// Where nothing moves nothing is learnt: the prior's deviations measure the error, and the bounds stay open.
#[test]
fn without_excitation_errors_are_told_against_the_prior() {
    let arena = compare(&[entry("no-excitation")], &[Contestant::of(Method::Smpe)], 2, &|| ()).unwrap();
    let result = &arena.entries[0];
    assert_eq!((result.unit, result.counted_from_s), (Unit::Prior, 0.0));
    let last = &result.methods[0].checkpoints[2];
    assert_eq!(last.coverage.unwrap().fraction, 1.0, "{last:?}");
    assert!(last.parameters.iter().all(|p| p.rmse_over_unit < 2.0));
}

#[test]
fn a_flight_that_is_too_short_is_refused_in_words() {
    let mut short = entry("calm");
    short.scenario.duration = "10 s".parse().unwrap();
    let message = compare(&[short], &[Contestant::of(Method::Smpe)], 1, &|| ()).map(|_| ()).unwrap_err().to_string();
    assert!(message.contains("lengthen `duration`") && message.contains("21.35 s"), "{message}");
}
