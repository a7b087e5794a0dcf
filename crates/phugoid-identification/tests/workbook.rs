//! The workbook of a result, read back by calamine.
#![allow(clippy::unwrap_used, clippy::panic)]

use std::io::Cursor;

use calamine::{Data, Reader, Xlsx, open_workbook_from_rs};
use phugoid_identification::estimation::{
    AdoptedChange, ChangeOutcome, ChangedParameter, Estimation, EstimationStatus, Event, EventKind, ParameterResult,
};
use phugoid_identification::export::xlsx;

fn parameter(name: &str, value: f64, std_error: f64) -> ParameterResult {
    let text = format!(
        r#"{{"name": "{name}", "unit": "per rad", "value": {value}, "std_error": 0.01, "corrected_std_error": {std_error},
        "lower": -1.04, "upper": -0.96, "status": "converged", "converged_at_s": 4.0, "observability": 0.99, "initial": 0.0,
        "prior_std": 1.0, "bounds": null, "truth": null, "nuisance": false}}"#
    );
    serde_json::from_str(&text).unwrap()
}

fn result() -> Estimation {
    let mut unknown = parameter("=1+1", -0.1, 0.5);
    unknown.std_error = f64::NAN;
    unknown.value = f64::INFINITY;
    Estimation {
        source: "flight.csv".into(),
        status: EstimationStatus::Refused,
        verdict: vec!["The lift has the wrong sign.".into()],
        parameters: vec![parameter("Cm_alpha", -1.0, 0.02), unknown],
        correlation: vec![vec![1.0, 0.25], vec![0.25, 1.0]],
        events: vec![Event { time_s: 4.5, kind: EventKind::Adopted, message: "changed".into() }],
        changes: vec![AdoptedChange {
            time_s: 4.5,
            interval_s: Some([3.5, 4.75]),
            outcome: ChangeOutcome::Confirmed,
            parameters: vec![ChangedParameter {
                name: "Cm_alpha".into(),
                before: -0.5,
                before_std: 0.1,
                after: -1.0,
                after_std: 0.02,
            }],
        }],
        ..Estimation::default()
    }
}

#[test]
fn numbers_words_and_gaps_are_read_back() {
    let bytes = xlsx(&result()).unwrap();
    assert_eq!(bytes, xlsx(&result()).unwrap(), "the same bytes for the same result");
    let mut book: Xlsx<_> = open_workbook_from_rs(Cursor::new(bytes)).unwrap();
    assert_eq!(book.sheet_names(), ["Result", "Parameters", "Correlation", "Covariance", "Changes", "Events"]);
    let mut rows =
        |sheet: &str| -> Vec<Vec<Data>> { book.worksheet_range(sheet).unwrap().rows().map(<[Data]>::to_vec).collect() };
    let words = |text: &str| Data::String(text.to_owned());

    let told = rows("Result");
    assert_eq!(told[1], [words("status"), words("refused")]);
    assert!(told[2][1].to_string().contains("neither the numbers"), "{told:?}");
    assert!(told.iter().any(|row| row[1] == words("The lift has the wrong sign.")), "{told:?}");

    let table = rows("Parameters");
    let column = |name: &str| table[0].iter().position(|cell| *cell == words(name)).unwrap();
    assert_eq!(table[1][column("name")], words("Cm_alpha"));
    assert_eq!(table[1][column("value")], Data::Float(-1.0));
    assert_eq!(table[1][column("bound (2 sigma)")], Data::Float(0.04));
    assert_eq!(table[1][column("unit")], words("per rad"));
    // What looks like a formula is text, and what is no number is no cell.
    assert_eq!(table[2][column("name")], words("=1+1"));
    assert_eq!(table[2][column("value")], Data::Empty);
    assert_eq!(table[2][column("std_error")], Data::Empty);
    assert_eq!(table[1][column("truth")], Data::Empty);

    let covariance = rows("Covariance");
    assert_eq!(covariance[0][1..], [words("Cm_alpha"), words("=1+1")]);
    assert_eq!(covariance[1][2], Data::Float(0.25 * (0.02 * 0.5)));
    assert_eq!(rows("Correlation")[2][1], Data::Float(0.25));
    let changes = rows("Changes");
    let change = |name: &str| &changes[1][changes[0].iter().position(|cell| *cell == words(name)).unwrap()];
    assert_eq!(*change("not before (s)"), Data::Float(3.5));
    assert_eq!(*change("not after (s)"), Data::Float(4.75));
    assert_eq!(*change("after"), Data::Float(-1.0));
    assert_eq!(rows("Events")[1][1], words("adopted"));
}
