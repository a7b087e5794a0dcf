//! What an estimation takes of the stack of the thread that it is called on.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)] // tests may

use phugoid_identification::estimate::{EstimateOptions, Method, estimate};
use phugoid_identification::health::HealthOptions;
use phugoid_identification::model_file::ModelFile;
use phugoid_identification::monitor::monitor;
use phugoid_simulation::flight::fly;
use phugoid_simulation::scenario::built_in;

/// A user's own thread has 2 MiB; half of it is enough for every method, with the largest motion. Beyond it the process ends.
#[test]
fn every_method_runs_on_a_common_thread() {
    let text = ModelFile::BUILT_IN.iter().find(|(name, _)| *name == "f16-six").unwrap().1;
    let model = ModelFile::parse("f16-six", text).unwrap();
    let mut scenario = built_in("f16-six").unwrap().unwrap();
    // The first input of each surface.
    scenario.duration = "14 s".parse().unwrap();
    let record = fly(&scenario).unwrap().measured;
    for method in [Method::Smpe, Method::Ekf, Method::Rls, Method::Fourier, Method::EquationError] {
        let (record, model) = (record.clone(), model.clone());
        let run = move || {
            let options = EstimateOptions { method: Some(method), ..EstimateOptions::default() };
            let mut seen = Vec::new();
            let estimation = estimate(&record, &model, &options, &mut |done| seen.push(done)).unwrap();
            (estimation.parameters.len(), seen)
        };
        let (parameters, seen) = std::thread::Builder::new().stack_size(1 << 20).spawn(run).unwrap().join().unwrap();
        assert_eq!(parameters, 24);
        assert!(seen.is_sorted() && seen.last() == Some(&1.0), "{method}: {seen:?}");
    }
}

/// A monitor beside the estimator takes more than all of it; twelve columns, so that there is room for 24 in both.
#[test]
fn the_monitor_runs_on_a_common_thread() {
    let text = ModelFile::BUILT_IN.iter().find(|(name, _)| *name == "f16").unwrap().1;
    let text = text
        .replace("CD = [\"alpha\"]", "CD = [\"alpha\", \"elevator\"]")
        .replace("[parameters]", "[parameters]\ndCD_elevator = { bounds = [-0.4, 0.4] }\n#");
    let model = ModelFile::parse("f16", &text).unwrap();
    assert_eq!(model.estimated().count(), 12);
    let mut scenario = built_in("f16-calm").unwrap().unwrap();
    scenario.duration = "6 s".parse().unwrap();
    let record = fly(&scenario).unwrap().measured;
    let run = move || {
        let options = HealthOptions { expected: model.expectations(), false_alarms_per_hour: 0.1 };
        let (estimation, report) =
            monitor(&record, &model, &EstimateOptions::default(), &options, &mut |_| {}).unwrap();
        (estimation.parameters.len(), report.parameters.len())
    };
    let found = std::thread::Builder::new().stack_size(1 << 20).spawn(run).unwrap().join().unwrap();
    assert_eq!(found, (12, 6));
}
