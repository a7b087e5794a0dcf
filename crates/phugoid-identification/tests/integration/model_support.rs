//! What `inspect` says in advance of a model's parameters, against what an estimation then gives.
#![allow(clippy::unwrap_used, clippy::panic)] // tests may

use crate::common;

use common::{f16, shared_file};
use phugoid_flight_data::csv::{self, CsvOptions};
use phugoid_flight_data::record::Record;
use phugoid_identification::estimate::{EstimateOptions, Method, estimate};
use phugoid_identification::inspect::{ModelSupport, model_support};
use phugoid_identification::manoeuvres::{Settings, Support, find};
use phugoid_identification::model_file::ModelFile;
use phugoid_identification::options::FlowAngles;

fn support(record: &Record, model: &ModelFile) -> ModelSupport {
    model_support(record, &find(record, &Settings::default()), model)
}

/// By parameter: expected error over that of output error on the same manoeuvres, whose air data are simulated, as those of the
/// bound are.
fn ratios(record: &Record, model: &ModelFile, support: &ModelSupport) -> Vec<(String, f64)> {
    let found = find(record, &Settings::default());
    let mut ratios = Vec::new();
    for segment in &support.segments {
        let part = |number: &usize| {
            let m = found.manoeuvres.iter().find(|m| m.number == *number).unwrap();
            record.between(m.from_s, m.to_s).unwrap()
        };
        let mut parts: Vec<Record> = segment.manoeuvres.iter().map(part).collect();
        let first = parts.remove(0);
        let options = EstimateOptions {
            method: Some(Method::OutputError),
            further: parts,
            flow_angles: FlowAngles::Simulated,
            ..EstimateOptions::default()
        };
        let estimation = estimate(&first, model, &options, &mut |_| {}).unwrap();
        for p in &segment.parameters {
            let given = estimation.parameters.iter().find(|e| e.name == p.bound.name).unwrap();
            println!(
                "{:?} {:12} at best {:8.4} expected {:8.4} output error {:8.4} ({:.4} of {:.4})",
                segment.manoeuvres,
                p.bound.name,
                2.0 * p.bound.std_error,
                2.0 * p.bound.expected_std_error,
                2.0 * given.corrected_std_error,
                p.bound.value,
                given.value
            );
            ratios.push((
                format!("{:?} {}", segment.manoeuvres, p.bound.name),
                p.bound.expected_std_error / given.corrected_std_error,
            ));
        }
    }
    ratios
}

#[test]
fn the_expected_error_is_that_of_output_error() {
    let Some(path) = shared_file("flight/hfb320.csv") else { return };
    let record = csv::read_path(&path, &CsvOptions::default()).unwrap();
    let model = ModelFile::named("hfb320").unwrap();
    let support = support(&record, &model);
    assert_eq!(support.segments.len(), 3, "two manoeuvres and both together: {:?}", support.reasons);
    for (name, ratio) in ratios(&record, &model, &support) {
        assert!((0.67..1.5).contains(&ratio), "{name}: {ratio}");
    }
    // With the noise of the sensors alone it would be ten times better; no estimation of this flight is.
    let (segment, lift) = support.best("CL_alpha").unwrap();
    // The 3-2-1-1 by itself and both manoeuvres differ by 1 %: what is declared makes most of either.
    assert!(segment.manoeuvres.contains(&1), "{:?}", segment.manoeuvres);
    assert_eq!(lift.support, Support::Told, "{lift:?}");
    assert!(lift.expected > 5.0 * lift.at_best, "{lift:?}");
    let offset = support.best("CL_0").unwrap().1;
    assert!(offset.support == Support::No && offset.reason.contains("goes with CL_V"), "{offset:?}");
}

#[test]
fn where_the_model_is_right_the_bound_is_what_is_expected() {
    let record = f16::fly(20.0, 0.035, 5);
    let model = f16::model();
    let support = support(&record, &model);
    let ratios = ratios(&record, &model, &support);
    assert!(!ratios.is_empty(), "{:?}", support.reasons);
    for (name, ratio) in ratios {
        // Both rest on the same samples; the noise is measured from forty of them here, and from all residuals there.
        assert!((0.7..1.4).contains(&ratio), "{name}: {ratio}");
    }
    for parameter in &support.segments[0].parameters {
        let excess = parameter.expected / parameter.at_best;
        assert!((1.0..1.6).contains(&excess), "{}: {excess}", parameter.bound.name);
    }
}

#[test]
fn a_model_without_its_channels_says_why_there_is_no_bound() {
    let mut record = f16::fly(20.0, 0.035, 5);
    record.channels.retain(|channel| channel.name != "altitude" && channel.name != "theta");
    let support = support(&record, &f16::model());
    let notes: Vec<&String> = support.segments.iter().flat_map(|segment| &segment.notes).collect();
    assert!(support.best("dCm_q").is_none());
    assert!(notes.iter().any(|note| note.contains("is missing")), "{notes:?} {:?}", support.reasons);
}
