//! Writes the workbook of a result in which is what a workbook can get wrong: a name that looks like a formula, values that are no
//! numbers, a sentence about a refused flight, an adopted change. `export_workbook OUT.xlsx`, for the check by openpyxl.

use phugoid_identification::estimate::Opens;
use phugoid_identification::estimation::{
    AdoptedChange, ChangeOutcome, ChangedParameter, Estimation, EstimationStatus, Event, EventKind, ParameterResult,
};
use phugoid_identification::export::xlsx;

fn parameter(name: &str, value: f64, std_error: f64) -> serde_json::Result<ParameterResult> {
    let text = format!(
        r#"{{"name": "{name}", "unit": "per rad", "value": {value}, "std_error": 0.01, "corrected_std_error": {std_error},
        "lower": -1.04, "upper": -0.96, "status": "converged", "converged_at_s": 4.0, "observability": 0.99, "initial": 0.0,
        "prior_std": 1.0, "bounds": null, "truth": null, "nuisance": false}}"#
    );
    serde_json::from_str(&text)
}

fn result() -> serde_json::Result<Estimation> {
    let mut unknown = parameter("=1+1", -0.1, 0.5)?;
    unknown.std_error = f64::NAN;
    unknown.value = f64::INFINITY;
    Ok(Estimation {
        source: "flight.csv".into(),
        status: EstimationStatus::Refused,
        verdict: vec!["The lift has the wrong sign.".into()],
        parameters: vec![parameter("Cm_alpha", -1.0, 0.02)?, unknown],
        correlation: vec![vec![1.0, 0.25], vec![0.25, 1.0]],
        events: vec![Event { time_s: 4.5, kind: EventKind::Adopted, message: "changed".into() }],
        changes: vec![AdoptedChange {
            time_s: 4.5,
            interval_s: Some([3.5, 4.75]),
            opens: Opens::Everything,
            outcome: ChangeOutcome::Confirmed,
            parameters: vec![ChangedParameter {
                name: "Cm_alpha".into(),
                before: -0.5,
                before_std: 0.1,
                after: -1.0,
                after_std: 0.02,
                difference_std: 0.08,
                random_std: 0.08,
            }],
        }],
        ..Estimation::default()
    })
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let Some(workbook) = std::env::args_os().nth(1) else {
        return Err("usage: export_workbook OUT.xlsx".into());
    };
    let bytes = xlsx(&result()?)?;
    if bytes != xlsx(&result()?)? {
        return Err("the same result makes other bytes the second time".into());
    }
    std::fs::write(workbook, bytes)?;
    Ok(())
}
