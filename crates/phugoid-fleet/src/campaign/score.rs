//! How good the estimates of a campaign are, by scenario, model, method and parameter.

use std::collections::BTreeMap;

use phugoid_evaluation::statistics::{clopper_pearson, median};
use serde::Serialize;

use crate::row::Row;

/// The score of one method for one parameter.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Score {
    /// Name of the scenario.
    pub scenario: String,
    /// Name of the model.
    pub model: String,
    /// Name of the method.
    pub method: String,
    /// Name of the parameter.
    pub parameter: String,
    /// Estimations, refused ones included.
    pub estimations: usize,
    /// Of those, without numbers or with the word not to use them.
    pub refused: usize,
    /// Root mean square error, in the unit of the parameter; of those that are not refused. NaN without any.
    pub rmse: f64,
    /// Median of the absolute error as a part of the truth. NaN where the truth is zero or unknown.
    pub median_error: f64,
    /// Median of the time from which on the estimate stays near its end, s; infinite where most never arrive.
    pub converged_s: f64,
    /// Part of the estimates that has the truth within two standard errors. NaN without any.
    pub coverage: f64,
    /// 95 % interval of that.
    pub interval: [f64; 2],
}

/// Scores the rows of campaigns; rows of logs and parameters without a truth are left out.
pub fn scores(rows: &[Row]) -> Vec<Score> {
    let name = |row: &Row| {
        let scenario = row.scenario.clone().unwrap_or_default();
        (scenario, row.model.clone(), row.method.clone())
    };
    let (mut groups, mut without): (BTreeMap<_, Vec<&Row>>, BTreeMap<_, usize>) = (BTreeMap::new(), BTreeMap::new());
    for row in rows.iter().filter(|row| row.kind == "campaign") {
        match (&row.parameter, row.truth) {
            (Some(parameter), Some(_)) => groups.entry((name(row), parameter.clone())).or_default().push(row),
            (None, _) => *without.entry(name(row)).or_default() += 1,
            _ => {}
        }
    }
    let score = |((group, parameter), rows): ((_, String), Vec<&Row>)| {
        let none = without.get(&group).copied().unwrap_or(0);
        let used: Vec<&&Row> = rows.iter().filter(|row| row.status != "refused").collect();
        let errors: Vec<(f64, f64)> = used
            .iter()
            .filter_map(|row| row.value.zip(row.truth))
            .map(|(value, truth)| (value - truth, truth))
            .collect();
        let covered = used.iter().filter(|row| row.covered == Some(true)).count();
        let squares: f64 = errors.iter().map(|(error, _)| error * error).sum();
        let parts = errors.iter().filter(|(_, truth)| *truth != 0.0).map(|(error, truth)| (error / truth).abs());
        let (scenario, model, method) = group;
        Score {
            scenario,
            model,
            method,
            parameter,
            estimations: rows.len() + none,
            refused: rows.len() - used.len() + none,
            rmse: (squares / errors.len() as f64).sqrt(),
            median_error: median(parts.collect()),
            converged_s: median(used.iter().map(|row| row.converged_at_s.unwrap_or(f64::INFINITY)).collect()),
            coverage: covered as f64 / used.len() as f64,
            interval: clopper_pearson(covered, used.len()),
        }
    };
    groups.into_iter().map(score).collect()
}
