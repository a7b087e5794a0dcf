//! What a session and an estimation take of the stack of the thread that they are called on.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)] // tests may

use phugoid::{EstimateOptions, Model, Scenario, Session, estimate, simulate};

/// A first thread has 1 MiB on some systems. Beyond its stack the process ends.
#[test]
fn the_largest_motion_runs_on_a_small_thread() {
    let model = Model::named("f16-six").unwrap();
    let scenario = Scenario { duration: "8 s".parse().unwrap(), ..Scenario::named("f16-six").unwrap() };
    let record = simulate(&scenario).unwrap().measured;
    let work = move || {
        let whole = estimate(&record, &model, &EstimateOptions::default()).unwrap();
        let mut session = Session::new(&model, &EstimateOptions::default()).unwrap();
        for (k, time_s) in record.time.iter().enumerate() {
            let values: Vec<f64> = session.channels().iter().map(|c| record.require(c).unwrap().values[k]).collect();
            session.update(*time_s, &values).unwrap();
        }
        let last = session.snapshot().unwrap();
        let same = last.parameters.iter().zip(&whole.parameters).all(|(a, b)| a.value.to_bits() == b.value.to_bits());
        (last.parameters.len(), same)
    };
    let found = std::thread::Builder::new().stack_size(1 << 20).spawn(work).unwrap().join().unwrap();
    assert_eq!(found, (24, true));
}
