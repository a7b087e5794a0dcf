//! A case flown once and measured many times, as a table and requirements.

use phugoid_identification::estimate::EstimateOptions;
use phugoid_identification::model_file::ModelFile;

use super::aircraft_case::AircraftCase;
use super::result::Requirement;
use phugoid_evaluation::accuracy::{AccuracyStudy, StudyError, accuracy};
use phugoid_evaluation::table::{Column, Table};

/// Runs, each with its own sensor noise.
pub(super) const RUNS: usize = 40;

/// The accuracy of a case's flagship with `model` at the times `at` (s), over [`RUNS`] seeds from that of the case on.
///
/// # Errors
/// As [`accuracy`].
pub(super) fn repeated(case: &AircraftCase, model: &ModelFile, at: &[f64]) -> Result<AccuracyStudy, StudyError> {
    accuracy(&case.scenario, model, &EstimateOptions::causal(), RUNS, at, &|| ())
}

/// Errors over the runs beside the Cramer-Rao bound, in percent of the truth.
pub(super) fn table(title: &str, studies: &[(&str, &AccuracyStudy)]) -> Table {
    let rows = studies.iter().flat_map(|(what, study)| {
        study.checkpoints.iter().flat_map(move |checkpoint| {
            checkpoint.parameters.iter().map(move |p| {
                let percent = 100.0 / p.truth.abs();
                vec![
                    (*what).into(),
                    checkpoint.time_s.into(),
                    p.name.clone().into(),
                    (percent * p.cramer_rao).into(),
                    (percent * p.rmse).into(),
                    (percent * p.bias).into(),
                    (percent * p.claimed).into(),
                    p.rmse_over_cramer_rao.into(),
                    (100.0 * p.coverage).into(),
                ]
            })
        })
    });
    Table {
        title: format!("{title}, {RUNS} runs each with its own sensor noise"),
        columns: vec![
            Column::new("flagship", ""),
            Column::new("at", "s"),
            Column::new("coefficient", ""),
            Column::new("Cramer-Rao bound, calm air", "% of truth"),
            Column::new("root mean square error", "% of truth"),
            Column::new("mean error", "% of truth"),
            Column::new("claimed error", "% of truth"),
            Column::new("error over bound", "–"),
            Column::new("truth within two claimed", "% of runs"),
        ],
        rows: rows.collect(),
    }
}

/// The largest ratio of error and bound at the last checkpoint.
pub(super) fn worst_ratio(study: &AccuracyStudy) -> f64 {
    let last = study.checkpoints.last().map(|checkpoint| checkpoint.parameters.as_slice()).unwrap_or_default();
    last.iter().fold(0.0, |worst: f64, p| worst.max(p.rmse_over_cramer_rao))
}

/// The truth within two claimed standard errors at the last checkpoint, of all runs and coefficients, percent.
pub(super) fn coverage(study: &AccuracyStudy) -> f64 {
    let last = study.checkpoints.last().map(|checkpoint| checkpoint.parameters.as_slice()).unwrap_or_default();
    100.0 * last.iter().map(|p| p.coverage).sum::<f64>() / last.len().max(1) as f64
}

/// That two claimed standard errors hold the truth as often as they should. Of `4 RUNS` values (not independent) between
/// 88 and 100 % are as expected of 95.4 %.
pub(super) fn believable(study: &AccuracyStudy, what: &str) -> Requirement {
    let found = coverage(study);
    Requirement {
        what: format!(
            "truth within two claimed standard errors at the end{what}, over {RUNS} runs and all coefficients"
        ),
        limit: "at least 88 % (95.4 % expected)".into(),
        found: format!("{found:.1} %"),
        met: found >= 88.0,
    }
}
