//! Tuning on flights: resumed is uninterrupted, other problems are refused, and what is written can be used.

use std::path::PathBuf;
use std::sync::atomic::{AtomicUsize, Ordering};

use phugoid_identification::model_file::ModelFile;
use phugoid_studies::published::{CALM_MODEL, THESIS_MODEL};
use phugoid_studies::scenario::Scenario;
use phugoid_studies::tune::smpe::{Assignment, SmpeTuning};
use phugoid_studies::tune::state::fingerprint;
use phugoid_studies::tune::{Part, Tunable, TuneError, TuneOptions, tune};

fn assignment(name: &str, model: &str) -> Assignment {
    let scenario = phugoid_studies::scenario::built_in(name).unwrap().unwrap();
    Assignment {
        name: name.to_owned(),
        scenario,
        model: ModelFile::parse(name, model).unwrap(),
        fingerprint: fingerprint(model),
    }
}

#[test]
fn speed() {
    let t = std::time::Instant::now();
    let tuning = SmpeTuning::new(
        &[assignment("f16-calm", CALM_MODEL)],
        &[assignment("f16-thesis-sine", THESIS_MODEL)],
        6,
        &|| (),
    )
    .unwrap();
    println!("fly {:?}", t.elapsed());
    let t = std::time::Instant::now();
    let rule: Vec<f64> = tuning.settings().iter().map(|s| s.rule).collect();
    for k in 0..6 {
        println!("{:?} {:?}", tuning.score(&rule, Part::Training, k), tuning.score(&rule, Part::HeldOut, k));
    }
    println!("score {:?}", t.elapsed());
}
