//! Equation error, and output error with measured air data, with a filter beside them, on a real flight: HFB-320, whose angle of attack comes about 0.2 s late by its
//! kinematics (docs/methods.md).

use crate::common;

use phugoid_flight_data::csv::{self, CsvOptions};
use phugoid_flight_data::record::Record;
use phugoid_identification::estimate::{EstimateOptions, estimate};
use phugoid_identification::estimation::{Estimation, EstimationStatus, FinalStatus, ReasonCode};
use phugoid_identification::method::Method;
use phugoid_identification::model_file::ModelFile;

/// Standard errors that two methods may be apart without a word.
const SILENT: f64 = 4.0;

fn flight() -> Option<Record> {
    Some(csv::read_path(&common::shared_file("flight/hfb320.csv")?, &CsvOptions::default()).unwrap())
}

fn by(method: Method, record: &Record) -> Estimation {
    let options = EstimateOptions { method: Some(method), ..EstimateOptions::default() };
    estimate(record, &ModelFile::named("hfb320").unwrap(), &options, &mut |_| {}).unwrap()
}

/// The parameters that a result calls converged and another one has elsewhere, with the distance in the random errors of
/// both: what the model file declares is the same for both.
fn elsewhere(found: &Estimation, other: &Estimation) -> Vec<(String, f64)> {
    let converged = found.parameters.iter().filter(|p| p.status == FinalStatus::Converged && !p.nuisance);
    let apart = converged.filter_map(|p| {
        let q = other.parameter(&p.name)?;
        Some((p.name.clone(), (p.value - q.value).abs() / p.random_std().hypot(q.random_std())))
    });
    apart.filter(|(_, apart)| *apart > SILENT).collect()
}

#[test]
fn no_number_of_equation_error_differs_from_filter_error_without_a_word() {
    let Some(record) = flight() else { return };
    let filter = by(Method::FilterError, &record);
    for method in [Method::EquationError, Method::EquationErrorFrequency] {
        let found = by(method, &record);
        let damping = found.parameter("Cm_q").unwrap();
        println!("{method}: Cm_q {} +- {}, {:?}", damping.value, damping.random_std(), damping.status);
        // Neither what the lift lacks nor how the rates are differentiated moves it: the flight gives it.
        assert!((-45.0..-41.0).contains(&damping.value), "{}", damping.value);
        assert_eq!(elsewhere(&found, &filter), [], "{method}");
        assert_eq!(found.status, EstimationStatus::Doubtful);
        let reason = found.reasons.iter().find(|reason| reason.code == ReasonCode::MethodsDisagree).unwrap();
        assert_eq!(reason.concerns, ["Cm_q"], "{}", reason.sentence);
        let second = found.second_answer.as_ref().unwrap();
        assert_eq!(second.method, Method::Smpe);
        assert!(reason.sentence.contains("by smpe"), "{}", reason.sentence);
    }
}

/// Output error takes the measured angle of attack, whose delay looks like gusts, and is bent by it as equation error is.
#[test]
fn output_error_with_a_late_vane_is_held_against_the_filter() {
    let Some(record) = flight() else { return };
    let found = by(Method::OutputError, &record);
    assert!(found.batch.as_ref().unwrap().measured_angles);
    let reason = found.reasons.iter().find(|reason| reason.code == ReasonCode::MethodsDisagree).unwrap();
    assert!(reason.concerns == ["Cm_q"] && reason.sentence.contains("by smpe"), "{}", reason.sentence);
    assert_eq!(found.status, EstimationStatus::Doubtful);
    assert_eq!(elsewhere(&found, &by(Method::FilterError, &record)), []);
}

/// The record with its angle of attack so many samples earlier.
fn earlier(record: &Record, samples: usize) -> Record {
    let mut record = record.clone();
    let alpha = record.channels.iter_mut().find(|channel| channel.name == "alpha").unwrap();
    alpha.values.rotate_left(samples);
    let kept = alpha.values.len() - samples;
    alpha.values[kept..].fill(f64::NAN);
    record
}

/// The probable cause of the difference: the earlier the angle of attack, the nearer are the methods to one another, and with
/// 0.2 s they agree.
#[test]
fn with_the_angle_of_attack_in_time_the_methods_agree() {
    let Some(record) = flight() else { return };
    for samples in [1, 2] {
        let record = earlier(&record, samples);
        let methods = [
            Method::FilterError,
            Method::EquationError,
            Method::EquationErrorFrequency,
            Method::Smpe,
            Method::OutputError,
        ];
        let all = methods.map(|method| (method, by(method, &record)));
        let (_, filter) = &all[0];
        for (method, found) in &all {
            let damping = found.parameter("Cm_q").unwrap();
            println!("{samples} {method}: Cm_q {:.2} +- {:.2}", damping.value, damping.random_std());
            if samples == 2 && *method != Method::OutputError {
                assert!((-26.0..-21.0).contains(&damping.value), "{method}: {}", damping.value);
                assert_eq!(damping.status, FinalStatus::Converged, "{method}");
                assert_eq!(elsewhere(found, filter), [], "{method}");
                let disagree = found.reasons.iter().find(|reason| reason.code == ReasonCode::MethodsDisagree);
                assert_eq!(disagree, None, "{method}");
            }
        }
    }
}
