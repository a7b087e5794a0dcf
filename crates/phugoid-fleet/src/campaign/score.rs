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

/// The columns of the store that are scored.
pub const COLUMNS: [&str; 10] =
    ["kind", "scenario", "model", "method", "status", "parameter", "value", "converged_at_s", "truth", "covered"];

/// Scenario, model and method.
type Name = (String, String, String);

/// The scores of rows that come one after another. Of each estimate two numbers are kept, 16 bytes, because medians need all.
#[derive(Clone, Debug, Default)]
pub struct Scoring {
    /// By name, and by parameter.
    groups: BTreeMap<Name, BTreeMap<String, Group>>,
    /// Number of estimations without any numbers, by name.
    without: BTreeMap<Name, usize>,
}

/// What is kept of the estimates of one parameter.
#[derive(Clone, Debug, Default)]
struct Group {
    rows: usize,
    used: usize,
    covered: usize,
    errors: usize,
    squares: f64,
    /// Absolute errors as parts of the truth.
    parts: Vec<f64>,
    converged_s: Vec<f64>,
}

impl Scoring {
    /// Adds the rows of campaigns; rows of logs and parameters without a truth are left out. Of a row the [`COLUMNS`] are needed.
    pub fn add(&mut self, rows: &[Row]) {
        for row in rows.iter().filter(|row| row.kind == "campaign") {
            let name = || (row.scenario.clone().unwrap_or_default(), row.model.clone(), row.method.clone());
            match (&row.parameter, row.truth) {
                (Some(parameter), Some(truth)) => {
                    let parameters = self.groups.entry(name()).or_default();
                    if !parameters.contains_key(parameter) {
                        parameters.insert(parameter.clone(), Group::default());
                    }
                    if let Some(group) = parameters.get_mut(parameter) {
                        group.add(row, truth);
                    }
                }
                (None, _) => *self.without.entry(name()).or_default() += 1,
                _ => {}
            }
        }
    }

    /// The scores by scenario, model, method and parameter.
    pub fn scores(self) -> Vec<Score> {
        let Self { groups, without } = self;
        let score = |(name, parameters): (Name, BTreeMap<String, Group>)| {
            let none = without.get(&name).copied().unwrap_or(0);
            parameters.into_iter().map(move |(parameter, group)| group.score(name.clone(), parameter, none))
        };
        groups.into_iter().flat_map(score).collect()
    }
}

impl Group {
    fn add(&mut self, row: &Row, truth: f64) {
        self.rows += 1;
        if row.status == "refused" {
            return;
        }
        self.used += 1;
        self.covered += usize::from(row.covered == Some(true));
        self.converged_s.push(row.converged_at_s.unwrap_or(f64::INFINITY));
        if let Some(value) = row.value {
            let error = value - truth;
            self.errors += 1;
            self.squares += error * error;
            if truth != 0.0 {
                self.parts.push((error / truth).abs());
            }
        }
    }

    /// `none` is the number of estimations that have no numbers at all.
    fn score(self, (scenario, model, method): Name, parameter: String, none: usize) -> Score {
        Score {
            scenario,
            model,
            method,
            parameter,
            estimations: self.rows + none,
            refused: self.rows - self.used + none,
            rmse: (self.squares / self.errors as f64).sqrt(),
            median_error: median(self.parts),
            converged_s: median(self.converged_s),
            coverage: self.covered as f64 / self.used as f64,
            interval: clopper_pearson(self.covered, self.used),
        }
    }
}
