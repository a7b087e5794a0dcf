//! The estimates as a table: CSV, and Parquet under the feature of that name.
//!
//! One row per parameter: value, one-sigma error of the covariance, the same corrected for the colour of the residuals,
//! bounds of two of these, status, whether it is a nuisance, and the truth where it is known. Derivatives per radian,
//! all else in SI units; the cell is empty where there is no finite value.

use crate::core::estimation::{Estimation, ParameterResult};

/// How one column of the table is made of a parameter.
enum Column {
    Words(fn(&ParameterResult) -> &str),
    Number(fn(&ParameterResult) -> Option<f64>),
    Flag(fn(&ParameterResult) -> bool),
}

const COLUMNS: [(&str, Column); 9] = [
    ("name", Column::Words(|p| &p.name)),
    ("value", Column::Number(|p| Some(p.value))),
    ("std_error", Column::Number(|p| Some(p.std_error))),
    ("corrected_std_error", Column::Number(|p| Some(p.corrected_std_error))),
    ("lower", Column::Number(|p| Some(p.lower))),
    ("upper", Column::Number(|p| Some(p.upper))),
    ("status", Column::Words(|p| p.status.word())),
    ("nuisance", Column::Flag(|p| p.nuisance)),
    ("truth", Column::Number(|p| p.truth)),
];

/// As CSV; empty where there is no finite number.
///
/// ```text
/// name,value,std_error,corrected_std_error,lower,upper,status,nuisance,truth
/// Cm_alpha,-0.99762,0.0101,0.0203,-1.0382,-0.957,converged,false,
/// ```
///
/// ```
/// use phugoid_identification::estimation::{Estimation, FinalStatus, ParameterResult};
/// use phugoid_identification::export::csv;
/// let result = r#"{"name": "Cm_alpha", "value": -1.0, "std_error": 0.01, "corrected_std_error": 0.02, "lower": -1.04,
///     "upper": -0.96, "status": "converged", "converged_at_s": 4.0, "observability": 0.99, "initial": 0.0,
///     "prior_std": 1.0, "bounds": null, "truth": null, "nuisance": false}"#;
/// let mut parameter: ParameterResult = serde_json::from_str(result)?;
/// parameter.std_error = f64::INFINITY; // a method that gives no bound
/// let estimation = Estimation { parameters: vec![parameter], ..Estimation::default() };
/// assert_eq!(csv(&estimation).lines().nth(1), Some("Cm_alpha,-1,,0.02,-1.04,-0.96,converged,false,"));
/// # Ok::<(), serde_json::Error>(())
/// ```
pub fn csv(estimation: &Estimation) -> String {
    // Names of parameters and statuses are words.
    let cell = |column: &Column, p: &ParameterResult| match column {
        Column::Words(of) => of(p).to_owned(),
        Column::Number(of) => {
            of(p).filter(|value| value.is_finite()).map_or_else(String::new, |value| value.to_string())
        }
        Column::Flag(of) => of(p).to_string(),
    };
    let mut text = COLUMNS.map(|(name, _)| name).join(",") + "\n";
    for p in &estimation.parameters {
        text.push_str(&COLUMNS.iter().map(|(_, column)| cell(column, p)).collect::<Vec<_>>().join(","));
        text.push('\n');
    }
    text
}

/// As a Parquet file; null where there is no finite number.
///
/// # Errors
/// The file cannot be written.
#[cfg(feature = "parquet")]
pub fn parquet(estimation: &Estimation, path: &std::path::Path) -> Result<(), phugoid_flight_data::csv::WriteError> {
    use phugoid_flight_data::parquet::{Values, write_columns};
    let parameters = || estimation.parameters.iter();
    let values = |column: &Column| match column {
        Column::Words(of) => Values::Words(parameters().map(|p| of(p).to_owned()).collect()),
        Column::Number(of) => Values::Numbers(parameters().map(|p| of(p).filter(|value| value.is_finite())).collect()),
        Column::Flag(of) => Values::Flags(parameters().map(of).collect()),
    };
    let columns: Vec<(&str, Values)> = COLUMNS.iter().map(|(name, column)| (*name, values(column))).collect();
    write_columns(&columns, path)
}
