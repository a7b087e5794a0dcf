//! A live session gives the numbers of the run over the record, and bears what a telemetry stream does.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)] // tests and benches may

use crate::common;

use common::f16::{fly, model};
use phugoid_flight_data::record::Record;
use phugoid_identification::estimate::{EstimateOptions, estimate};
use phugoid_identification::estimation::{Event, EventKind, Readiness};
use phugoid_identification::method::Method;
use phugoid_identification::model_file::ModelFile;
use phugoid_identification::session::{Session, Snapshot, Step};

/// The values of one sample of a record in the order of the session's channels.
fn sample(record: &Record, session: &Session, k: usize) -> Vec<f64> {
    session.channels().iter().map(|name| record.channel(name).map_or(f64::NAN, |c| c.values[k])).collect()
}

fn replay(record: &Record, file: &ModelFile, options: &EstimateOptions) -> (Session, Vec<Snapshot>) {
    let mut session = Session::new(file, options).unwrap();
    let mut snapshots = Vec::new();
    for k in 0..record.time.len() {
        let values = sample(record, &session, k);
        if session.update(record.time[k], &values).unwrap() == Step::Estimated {
            snapshots.push(session.snapshot().unwrap().clone());
        }
    }
    (session, snapshots)
}

/// Missing values and outliers in an output, a surface that is not sampled at times.
fn damaged() -> Record {
    let mut record = fly(12.0, 0.026, 71);
    for channel in &mut record.channels {
        let (first, every) = match channel.name.as_str() {
            "q" => (11, 37),
            "elevator" => (150, 29),
            _ => continue,
        };
        channel.values.iter_mut().skip(first).step_by(every).for_each(|v| *v = f64::NAN);
    }
    record
}

#[test]
fn a_session_gives_the_bits_of_the_run_over_the_record() {
    let record = damaged();
    let file = model();
    for method in [Method::Smpe, Method::Ekf, Method::Rls, Method::Fourier] {
        let options = EstimateOptions { method: Some(method), ..EstimateOptions::default() };
        let whole = estimate(&record, &file, &options, &mut |_| {}).unwrap();
        let (mut session, snapshots) = replay(&record, &file, &options);
        let last = snapshots.last().unwrap();
        assert_eq!(session.layout().parameters.len(), last.parameters.len());
        for (layout, live) in session.layout().parameters.iter().zip(&last.parameters) {
            let result = whole.parameters.iter().find(|p| p.name == layout.name).unwrap();
            assert_eq!(live.value.to_bits(), result.value.to_bits(), "{method}: {}", layout.name);
            assert_eq!(live.std_error.to_bits(), result.corrected_std_error.to_bits(), "{method}: {}", layout.name);
            assert_eq!(live.status.word(), result.status.word(), "{method}: {}", layout.name);
        }
        // Also on the way: the estimate after every sample from the start of the course on.
        let first = record.time.len() - snapshots.len();
        let history = &whole.history.parameters[0];
        let at = session.layout().parameters.iter().position(|p| p.name == history.name).unwrap();
        for (k, snapshot) in snapshots.iter().enumerate() {
            assert_eq!(snapshot.parameters[at].value.to_bits(), history.value[first + k].to_bits(), "{method}, {k}");
        }
        let told = |events: &[phugoid_identification::estimation::Event]| -> Vec<(EventKind, u64)> {
            events.iter().map(|e| (e.kind, e.time_s.to_bits())).collect()
        };
        assert_eq!(told(&session.take_events()), told(&whole.events), "{method}");
        assert!(session.take_events().is_empty());
    }
}

/// The beginning is quiet, so that it says nothing of the sign of the pitch rate.
#[test]
fn a_wrong_sign_is_noticed_after_the_start_and_makes_every_parameter_doubtful() {
    let told = |from_s: f64| {
        let mut record = fly(25.0, 0.026, 73);
        // The manoeuvre once more.
        let again: Vec<f64> = record.time.iter().map(|time| time + 25.0).collect();
        record.time.extend(again);
        record.channels.iter_mut().for_each(|channel| channel.values.extend_from_within(..));
        let turned: Vec<bool> = record.time.iter().map(|time| *time >= from_s).collect();
        let q = record.channels.iter_mut().find(|channel| channel.name == "q").unwrap();
        q.values.iter_mut().zip(turned).filter(|(_, turned)| *turned).for_each(|(q, _)| *q = -*q);
        let (mut session, snapshots) = replay(&record, &model(), &EstimateOptions::default());
        let verdicts = |snapshot: &Snapshot| -> Vec<Readiness> {
            snapshot.parameters.iter().filter_map(|p| p.readiness.as_ref()).map(|r| r.verdict).collect()
        };
        let units: Vec<Event> = session.take_events().into_iter().filter(|e| e.kind == EventKind::Units).collect();
        let since_s = units.first().map_or(f64::INFINITY, |event| event.time_s);
        let ready = |from_s: f64| {
            snapshots.iter().filter(|s| s.time_s >= from_s).flat_map(verdicts).any(|v| v == Readiness::Ready)
        };
        (units, ready(0.0), ready(since_s))
    };
    let (units, ready, _) = told(f64::INFINITY);
    assert!(units.is_empty() && ready, "{units:?}");
    for from_s in [0.0, 25.0] {
        let (units, _, ready) = told(from_s);
        assert!(units.iter().any(|event| event.message.contains("`theta` and `q`")) && !ready, "{from_s}: {units:?}");
    }
}

#[test]
fn the_verdict_comes_with_the_estimate() {
    let record = fly(12.0, 0.026, 72);
    let (session, snapshots) = replay(&record, &model(), &EstimateOptions::default());
    let last = snapshots.last().unwrap();
    let ready = |name: &str| {
        let at = session.layout().parameters.iter().position(|p| p.name == name).unwrap();
        last.parameters[at].readiness.clone().unwrap()
    };
    assert_eq!(ready("dCm_alpha").verdict.word(), "ready");
    let document: serde_json::Value = serde_json::from_str(&serde_json::to_string(last).unwrap()).unwrap();
    assert_eq!(document["phase"], "sliding");
    assert_eq!(document["parameters"][0]["status"], last.parameters[0].status.word());
}

#[test]
fn what_an_estimation_needs_is_waited_for_and_named() {
    let record = fly(6.0, 0.026, 73);
    let mut session = Session::new(&model(), &EstimateOptions::default()).unwrap();
    let theta = session.channels().iter().position(|n| n == "theta").unwrap();
    let speed = session.channels().iter().position(|n| n == "true_airspeed").unwrap();
    let mut estimated_at = None;
    for k in 0..record.time.len() {
        let mut values = sample(&record, &session, k);
        // On the ground for a second, and no attitude for three.
        if k < 50 {
            values[speed] = 12.0;
        }
        if k < 150 {
            values[theta] = f64::NAN;
        }
        match session.update(record.time[k], &values).unwrap() {
            Step::Waiting { reason: Some(reason), .. } if k < 50 => {
                assert!(reason.contains("not flying yet"), "{reason}")
            }
            Step::Waiting { reason: Some(reason), .. } => assert!(reason.contains("theta"), "{k}: {reason}"),
            Step::Waiting { have_s, need_s, .. } => assert!(have_s <= need_s),
            Step::Estimated => {
                estimated_at.get_or_insert(record.time[k]);
            }
            Step::Refused(reason) => panic!("{reason}"),
        }
    }
    // From eleven values of the attitude on; whether the last of two seconds counts is a matter of rounding.
    assert!([record.time[160], record.time[161]].contains(&estimated_at.unwrap()), "{estimated_at:?}");
}

#[test]
fn time_that_does_not_increase_is_refused_and_changes_nothing() {
    let record = fly(6.0, 0.026, 74);
    let file = model();
    let (_, plain) = replay(&record, &file, &EstimateOptions::default());
    let mut session = Session::new(&file, &EstimateOptions::default()).unwrap();
    for k in 0..record.time.len() {
        let values = sample(&record, &session, k);
        session.update(record.time[k], &values).unwrap();
        for time_s in [record.time[k], record.time[k] - 1.0, f64::NAN] {
            assert!(matches!(session.update(time_s, &values).unwrap(), Step::Refused(_)));
        }
        assert!(matches!(session.update(record.time[k] + 1e-4, &values[1..]).unwrap(), Step::Refused(_)));
    }
    assert_eq!(session.snapshot(), plain.last());
}

#[test]
fn a_batch_method_and_wrong_units_are_refused() {
    let options = EstimateOptions { method: Some(Method::OutputError), ..EstimateOptions::default() };
    let Err(error) = Session::new(&model(), &options) else { panic!("a batch method cannot run live") };
    assert!(error.to_string().contains("causal"), "{error}");
    let mut record = fly(4.0, 0.026, 75);
    let degrees = |channel: &mut phugoid_flight_data::record::Channel| {
        channel.values.iter_mut().for_each(|v| *v = v.to_degrees());
    };
    record.channels.iter_mut().filter(|c| c.name == "alpha" || c.name == "theta").for_each(degrees);
    let mut session = Session::new(&model(), &EstimateOptions::default()).unwrap();
    let outcome = (0..record.time.len()).try_for_each(|k| {
        let values = sample(&record, &session, k);
        session.update(record.time[k], &values).map(|_| ())
    });
    assert!(outcome.unwrap_err().to_string().contains("deg"));
}

/// The sender was restarted in the middle of the flight: its clock counts from zero again.
#[test]
fn a_resumed_session_keeps_the_parameters_and_shows_the_new_clock() {
    let record = fly(12.0, 0.026, 71);
    for method in [Method::Smpe, Method::Ekf, Method::Rls, Method::Fourier] {
        let options = EstimateOptions { method: Some(method), ..EstimateOptions::default() };
        let mut session = Session::new(&model(), &options).unwrap();
        let (half, mut first) = (record.time.len() / 2, None);
        for k in 0..record.time.len() {
            let from_s = if k < half { 0.0 } else { record.time[half] };
            if k == half {
                assert!(matches!(session.update(0.0, &sample(&record, &session, k)).unwrap(), Step::Refused(_)));
                assert!(session.resume(0.0, 4.0));
                first = session.snapshot().cloned();
                session.take_events();
            }
            let time_s = record.time[k] - from_s;
            let step = session.update(time_s, &sample(&record, &session, k)).unwrap();
            if k < half {
                continue;
            }
            assert_eq!((step, session.snapshot().unwrap().time_s), (Step::Estimated, time_s), "{method}");
            if k == half {
                // The first sample of the new clock starts the states; nothing is learnt from it.
                let (before, after) = (first.as_ref().unwrap(), session.snapshot().unwrap());
                for (before, after) in before.parameters.iter().zip(&after.parameters) {
                    assert_eq!((before.value, before.std_error), (after.value, after.std_error), "{method}");
                }
                let events = session.take_events();
                assert!(events.iter().any(|event| event.kind == EventKind::Gap && event.time_s == 0.0), "{events:?}");
            }
        }
        let (before, after) = (first.unwrap(), session.snapshot().unwrap());
        let readiness_s = after.readiness_s.unwrap();
        assert!(readiness_s > 5.0 && readiness_s <= after.time_s, "{method}: {readiness_s}");
        // What is learnt after it is added to what was known.
        let narrower = before.parameters.iter().zip(&after.parameters).filter(|(b, a)| a.std_error < b.std_error);
        assert!(narrower.count() > 0, "{method}");
    }
}
