//! What a flight itself says of a declared error that is really in it: a flight of another simulator whose elevator is stamped late.

use std::path::Path;

use phugoid_evaluation::field::truth::{Split, find};
use phugoid_flight_data::record::Record;
use phugoid_identification::estimate::{EstimateOptions, StructureSearch, estimate};
use phugoid_identification::estimation::{Estimation, LearntQuantity, UncertainQuantity};
use phugoid_identification::model_file::ModelFile;

use crate::input_timing::stamped_late;

/// As much as is declared of the timing of surfaces by default, and a fifth more, s.
const LATE_S: f64 = 0.012;
/// Two standard uncertainties of what the flight leaves of it, s; `C_m_q` changes by five per cent with as much.
const NEAR_S: f64 = 0.0075;

fn timing(estimation: &Estimation) -> &LearntQuantity {
    estimation.learnt.iter().find(|one| one.quantity == UncertainQuantity::SurfaceSkew).expect("the flight tells it")
}

/// The time is told in both; with `learn = true` the derivative of the elevator is nearer to the truth for it, with a smaller bound that
/// still holds the truth, and what the residuals are judged by stays as it is.
#[test]
fn a_late_elevator_is_told_and_taken_in() {
    let field = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/field");
    let truths = find(&field, Split::Develop).unwrap();
    let truth = truths.iter().find(|truth| truth.aircraft == "pc7" && truth.flight == "light-stick").unwrap();
    let folder = field.join("develop/pc7");
    let record = Record::open(folder.join("light-stick.csv")).unwrap();
    let text = std::fs::read_to_string(folder.join("longitudinal.toml")).unwrap();
    let run = |record: &Record, learn: bool| {
        let text = format!("{text}\n[uncertainty]\nclass = \"unstated\"\nlearn = {learn}\n");
        let options = EstimateOptions { structure: StructureSearch::Never, ..EstimateOptions::default() };
        estimate(record, &ModelFile::parse("mine.toml", &text).unwrap(), &options, &mut |_| {}).unwrap()
    };
    let late = stamped_late(&record, LATE_S);
    let (told, learnt, healthy) = (run(&late, false), run(&late, true), run(&record, false));
    assert_eq!(timing(&told), timing(&learnt));
    let found = timing(&told).value - timing(&healthy).value;
    println!(
        "put in {LATE_S}, found {found:.4}, healthy {:.4} +- {:.4} s",
        timing(&healthy).value,
        timing(&healthy).std_error
    );
    assert!((found - LATE_S).abs() < NEAR_S && timing(&told).std_error < 0.4 * 0.01, "{found}");
    assert!(timing(&healthy).value.abs() < 2.0 * timing(&healthy).std_error);
    assert_eq!(timing(&told).of, "elevator");

    let name = "Cm_elevator";
    let is = truth.at_end()[name].value;
    let [without, with] = [&told, &learnt].map(|estimation| estimation.parameter(name).unwrap());
    println!(
        "{name}: true {is:.4}, {:.4} +- {:.4}, with what the flight says {:.4} +- {:.4}",
        without.value,
        2.0 * without.corrected_std_error,
        with.value,
        2.0 * with.corrected_std_error
    );
    assert!((with.value - is).abs() < 0.5 * (without.value - is).abs());
    assert!(with.corrected_std_error < 0.75 * without.corrected_std_error && (with.lower..with.upper).contains(&is));
    assert!(without.learnt_shift == 0.0 && ((with.value - with.learnt_shift) / without.value - 1.0).abs() < 1e-12);
    let bits = |estimation: &Estimation| -> Vec<u64> {
        estimation.history.residuals.iter().flat_map(|signal| &signal.values).map(|value| value.to_bits()).collect()
    };
    assert!(bits(&told) == bits(&learnt));
    let says =
        |estimation: &Estimation, words: &str| estimation.verdict.iter().any(|sentence| sentence.contains(words));
    assert!(says(&told, "do not contain that (learn = true") && says(&learnt, "values and bounds contain that"));
}
