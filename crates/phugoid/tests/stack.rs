//! The stack that estimations and sessions take of the thread that calls them. If it overflows, the process ends.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)] // tests may

use phugoid::{EstimateOptions, Method, Model, Record, Scenario, Session, StructureSearch, estimate, simulate};

/// Runs `work` on a thread with 512 KiB, which is what a further thread has on macOS and half of a first thread on Windows.
fn on_a_small_thread<T: Send + 'static>(work: impl FnOnce() -> T + Send + 'static) -> T {
    std::thread::Builder::new().stack_size(512 << 10).spawn(work).unwrap().join().unwrap()
}

fn flown(scenario: &str, duration: &str) -> Record {
    let scenario = Scenario { duration: duration.parse().unwrap(), ..Scenario::named(scenario).unwrap() };
    simulate(&scenario).unwrap().measured
}

/// The last estimates of a session over the whole record, bit by bit.
fn live(record: &Record, model: &Model, options: &EstimateOptions) -> Vec<u64> {
    let mut session = Session::new(model, options).unwrap();
    for (k, time_s) in record.time.iter().enumerate() {
        let values: Vec<f64> = session.channels().iter().map(|c| record.require(c).unwrap().values[k]).collect();
        session.update(*time_s, &values).unwrap();
    }
    session.snapshot().unwrap().parameters.iter().map(|p| p.value.to_bits()).collect()
}

#[test]
fn the_largest_motion_runs_on_a_small_thread() {
    let model = Model::named("f16-six").unwrap();
    let record = flown("f16-six", "8 s");
    for method in [Method::Smpe, Method::Ekf] {
        let (record, model) = (record.clone(), model.clone());
        let options =
            EstimateOptions { method: Some(method), change_detection: Some(true), ..EstimateOptions::default() };
        let [whole, live] = on_a_small_thread(move || {
            let whole = estimate(&record, &model, &options).unwrap();
            [whole.parameters.iter().map(|p| p.value.to_bits()).collect(), live(&record, &model, &options)]
        });
        assert_eq!(live.len(), 24);
        assert_eq!(live, whole);
    }
}

/// Twelve columns, and one more for the terms that are tried: the largest room of the longitudinal motion. The aircraft is
/// damaged at 10 s, so that changes are adopted and a challenger is opened.
#[test]
fn the_largest_room_of_the_longitudinal_motion_runs_on_a_small_thread_with_an_offer() {
    let text = Model::text("f16").unwrap();
    let text = text
        .replace("CD = [\"alpha\"]", "CD = [\"alpha\", \"elevator\"]")
        .replace("[parameters]", "[parameters]\ndCD_elevator = { bounds = [-0.4, 0.4] }\n#");
    let model = Model::parse("f16", &text).unwrap();
    let record = flown("f16-damage", "12 s");
    let (parameters, live, tried) = on_a_small_thread(move || {
        let options = EstimateOptions { structure: StructureSearch::Offer, ..EstimateOptions::default() };
        let whole = estimate(&record, &model, &options).unwrap();
        (whole.parameters.len(), live(&record, &model, &options).len(), whole.offer.is_some())
    });
    assert_eq!((parameters, live), (12, 12));
    assert!(tried, "no term was tried");
}
