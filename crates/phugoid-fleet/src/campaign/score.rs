//! How good the estimates of a campaign are, by scenario, model, method and parameter.

use std::collections::BTreeMap;

use phugoid_evaluation::statistics::{clopper_pearson, median};
use serde::Serialize;

use super::question::CRAMER_RAO;
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
    /// Root mean square error, in the unit of the parameter; of those that are not refused. NaN without any. Of `cramer-rao` the root
    /// mean square of the bound: the smallest error that an unbiased method can have; infinite where a flight does not determine the
    /// parameter.
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

/// What a campaign asks for without any score: by scenario, model and method.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Unscored {
    /// Name of the scenario.
    pub scenario: String,
    /// Name of the model.
    pub model: String,
    /// Name of the method.
    pub method: String,
    /// Estimations without any numbers.
    pub refused: usize,
    /// The word of the most frequent reason (column `refusal`); empty without refusals.
    pub refusal: String,
    /// The first message that gives it; empty without refusals.
    pub message: String,
    /// Estimates of parameters whose truth is not known: of a parameter that the scenario does not have.
    pub without_truth: usize,
}

/// The columns of the store that are scored.
pub const COLUMNS: [&str; 13] = [
    "kind",
    "scenario",
    "model",
    "method",
    "status",
    "refusal",
    "message",
    "parameter",
    "value",
    "std_error",
    "converged_at_s",
    "truth",
    "covered",
];

/// Scenario, model and method.
type Name = (String, String, String);

/// The scores of rows that come one after another. Of each estimate two numbers are kept, 16 bytes, because medians need all.
#[derive(Clone, Debug, Default)]
pub struct Scoring {
    /// By name, and by parameter.
    groups: BTreeMap<Name, BTreeMap<String, Group>>,
    /// What has no score, by name.
    without: BTreeMap<Name, Without>,
}

#[derive(Clone, Debug, Default)]
struct Without {
    /// Estimations without any numbers, by the word of the reason, with the first message of it.
    refused: BTreeMap<String, (usize, String)>,
    /// Estimates of parameters whose truth is not known.
    truth: usize,
}

impl Without {
    fn count(&self) -> usize {
        self.refused.values().map(|(count, _)| count).sum()
    }
}

/// What is kept of the estimates of one parameter.
#[derive(Clone, Debug, Default)]
struct Group {
    rows: usize,
    used: usize,
    /// Estimates with a claim that may be wrong.
    judged: usize,
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
                (None, _) => {
                    let refused = &mut self.without.entry(name()).or_default().refused;
                    let word = row.refusal.clone().unwrap_or_default();
                    refused.entry(word).or_insert_with(|| (0, row.message.clone().unwrap_or_default())).0 += 1;
                }
                (Some(_), None) => self.without.entry(name()).or_default().truth += 1,
            }
        }
    }

    /// What has no score, by scenario, model and method.
    pub fn unscored(&self) -> Vec<Unscored> {
        let unscored = |(name, without): (&Name, &Without)| {
            let (scenario, model, method) = name.clone();
            let most = without.refused.iter().max_by_key(|(_, (count, _))| *count);
            let (refusal, message) =
                most.map(|(word, (_, message))| (word.clone(), message.clone())).unwrap_or_default();
            let (refused, without_truth) = (without.count(), without.truth);
            Unscored { scenario, model, method, refused, refusal, message, without_truth }
        };
        self.without.iter().map(unscored).collect()
    }

    /// The scores by scenario, model, method and parameter.
    pub fn scores(self) -> Vec<Score> {
        let Self { groups, without } = self;
        let score = |(name, parameters): (Name, BTreeMap<String, Group>)| {
            let none = without.get(&name).map_or(0, Without::count);
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
        if row.method == CRAMER_RAO {
            // What a flight does not determine has no bound: any error is possible.
            self.errors += 1;
            self.squares += row.std_error.map_or(f64::INFINITY, |bound| bound * bound);
            return;
        }
        self.judged += 1;
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
            coverage: self.covered as f64 / self.judged as f64,
            interval: if self.judged > 0 { clopper_pearson(self.covered, self.judged) } else { [f64::NAN; 2] },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(method: &str, std_error: Option<f64>) -> Row {
        Row {
            kind: "campaign".to_owned(),
            method: method.to_owned(),
            status: "sound".to_owned(),
            parameter: Some("Cm_q".to_owned()),
            value: (method != CRAMER_RAO).then_some(-11.0),
            std_error,
            truth: Some(-10.0),
            covered: (method != CRAMER_RAO).then_some(true),
            ..Row::default()
        }
    }

    /// A bound claims no estimate that may be wrong; where there is none, it is not taken for an estimate that missed.
    #[test]
    fn a_bound_is_no_estimate() {
        let scores = |rows: &[Row]| {
            let mut scoring = Scoring::default();
            scoring.add(rows);
            scoring.scores().remove(0)
        };
        let bound = scores(&[row(CRAMER_RAO, Some(3.0)), row(CRAMER_RAO, Some(4.0))]);
        assert_eq!((bound.rmse, bound.estimations), (12.5_f64.sqrt(), 2));
        assert!(bound.coverage.is_nan() && bound.interval[0].is_nan() && bound.median_error.is_nan());
        let none = scores(&[row(CRAMER_RAO, Some(3.0)), row(CRAMER_RAO, None)]);
        assert!(none.rmse.is_infinite() && none.coverage.is_nan());
        let estimated = scores(&[row("smpe", Some(3.0))]);
        assert_eq!((estimated.rmse, estimated.coverage), (1.0, 1.0));
    }
}
