//! Did tuning gain anything? Rule and tuned settings on the same held-out runs, pair by pair.

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use serde::Serialize;

use super::objective::Score;

/// Bootstrap resamples.
const RESAMPLES: usize = 10_000;
/// Seed of the resampling, so that a report is the same each time.
const SEED: u64 = 20_101_016;
/// Fewer held-out runs than this say nothing about spread.
const FEWEST: usize = 5;

/// One held-out run with both settings.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Pair {
    /// Name of the scenario or plant case.
    pub scenario: String,
    /// Number of the run in it.
    pub run: u64,
    /// Score of the run with the settings that the rule gives.
    pub rule: Score,
    /// Score of the run with the settings that the search found.
    pub tuned: Score,
}

/// What tuning did to the held-out runs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// The whole interval of the difference lies below zero.
    Gained,
    /// The whole interval lies above zero.
    Lost,
    /// The interval contains zero: the runs do not show a difference.
    NoDifference,
    /// The search found nothing better than the rule even on the training runs: both are the same.
    Kept,
    /// There are too few held-out runs to tell.
    TooFew,
}

/// Difference of the objective on the runs of one scenario.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ScenarioDifference {
    /// Name of the scenario or plant case.
    pub scenario: String,
    /// Number of held-out runs of this scenario.
    pub runs: usize,
    /// Mean difference of the objective, tuned less rule.
    pub mean_difference: f64,
    /// 95 % bootstrap interval of the mean difference over the runs; for a single run both ends are equal to it.
    pub interval: [f64; 2],
}

/// Differences of the objective, tuned less rule: negative is better.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Comparison {
    /// Every held-out run with both scores.
    pub pairs: Vec<Pair>,
    /// The differences scenario by scenario: they show whether the mean over all comes from a single one.
    pub scenarios: Vec<ScenarioDifference>,
    /// Mean difference of the objective.
    pub mean_difference: f64,
    /// 95 % confidence interval of the mean difference: percentiles of a bootstrap that draws runs anew within each scenario.
    /// It speaks of further runs of these scenarios, not of scenarios that are not among them.
    pub interval: [f64; 2],
    /// Number of runs with a smaller objective with the tuned settings than with the rule's.
    pub better: usize,
    /// Number of runs with a larger objective with the tuned settings than with the rule's.
    pub worse: usize,
    /// What the interval of the mean difference says of the tuned settings.
    pub verdict: Verdict,
}

impl Comparison {
    /// Compares the scores of held-out runs: mean difference, its bootstrap interval, and the verdict.
    pub fn of(pairs: Vec<Pair>) -> Self {
        let differences: Vec<f64> = pairs.iter().map(|p| p.tuned.objective - p.rule.objective).collect();
        let strata = strata(&pairs, &differences);
        let scenarios = strata
            .iter()
            .map(|(name, values)| ScenarioDifference {
                scenario: (*name).to_owned(),
                runs: values.len(),
                mean_difference: mean(values),
                interval: bootstrap(std::slice::from_ref(values)),
            })
            .collect();
        // Cases of which there is but one run have no spread of their own: they are drawn among one another.
        let (single, mut groups): (Vec<_>, Vec<_>) =
            strata.into_iter().map(|(_, values)| values).partition(|values| values.len() == 1);
        if !single.is_empty() {
            groups.push(single.concat());
        }
        let interval = bootstrap(&groups);
        let verdict = match interval {
            _ if !differences.is_empty() && differences.iter().all(|d| *d == 0.0) => Verdict::Kept,
            _ if pairs.len() < FEWEST => Verdict::TooFew,
            [_, upper] if upper < 0.0 => Verdict::Gained,
            [lower, _] if lower > 0.0 => Verdict::Lost,
            _ => Verdict::NoDifference,
        };
        Self {
            scenarios,
            mean_difference: mean(&differences),
            interval,
            better: differences.iter().filter(|d| **d < 0.0).count(),
            worse: differences.iter().filter(|d| **d > 0.0).count(),
            verdict,
            pairs,
        }
    }

    /// The verdict as a sentence with its numbers.
    pub fn sentence(&self) -> String {
        let n = self.pairs.len();
        let [lower, upper] = self.interval;
        let numbers = format!(
            "objective {:+.3} on {n} held-out runs, 95 % interval {lower:+.3} to {upper:+.3}; {} better, {} worse",
            self.mean_difference, self.better, self.worse
        );
        match self.verdict {
            Verdict::Gained => format!("Tuning gained: {numbers}."),
            Verdict::Lost => format!("Tuning LOST on what it had not seen: {numbers}. Keep the rule."),
            Verdict::NoDifference => format!("Tuning gained nothing that can be told from chance: {numbers}."),
            Verdict::Kept => {
                format!("Tuning gained nothing: the tuned settings do as the rule does on all {n} held-out runs.")
            }
            Verdict::TooFew => {
                format!("Too few held-out runs to tell: {numbers}. Give more with --hold-out or --runs.")
            }
        }
    }
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

/// Differences by scenario, in the order of first appearance.
fn strata<'a>(pairs: &'a [Pair], differences: &[f64]) -> Vec<(&'a str, Vec<f64>)> {
    let mut strata: Vec<(&str, Vec<f64>)> = Vec::new();
    for (pair, difference) in pairs.iter().zip(differences) {
        match strata.iter_mut().find(|(name, _)| *name == pair.scenario) {
            Some((_, values)) => values.push(*difference),
            None => strata.push((&pair.scenario, vec![*difference])),
        }
    }
    strata
}

/// 95 % interval of the mean over all groups, values drawn with replacement within each.
fn bootstrap(groups: &[Vec<f64>]) -> [f64; 2] {
    let count: usize = groups.iter().map(Vec::len).sum();
    if count == 0 {
        return [f64::NAN; 2];
    }
    let mut random = Pcg64Mcg::seed_from_u64(SEED);
    let mut means: Vec<f64> = (0..RESAMPLES)
        .map(|_| {
            let mut sum = 0.0;
            for group in groups {
                for _ in 0..group.len() {
                    sum += group[random.random_range(0..group.len())];
                }
            }
            sum / count as f64
        })
        .collect();
    means.sort_by(f64::total_cmp);
    [means[RESAMPLES / 40], means[RESAMPLES - 1 - RESAMPLES / 40]]
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand_distr::{Distribution, StandardNormal};

    fn pairs(differences: &[f64], scenarios: usize) -> Vec<Pair> {
        let score = |objective| Score { objective, ..Score::FAILURE };
        let pair = |(k, d): (usize, &f64)| Pair {
            scenario: format!("s{}", k % scenarios),
            run: (k / scenarios) as u64,
            rule: score(1.0),
            tuned: score(1.0 + d),
        };
        differences.iter().enumerate().map(pair).collect()
    }

    #[test]
    fn the_interval_holds_the_mean_as_often_as_it_says() {
        let mut random = Pcg64Mcg::seed_from_u64(1);
        let mut held = 0;
        const TRIALS: usize = 200;
        for _ in 0..TRIALS {
            let differences: Vec<f64> =
                (0..40).map(|_| -0.3 + Distribution::<f64>::sample(&StandardNormal, &mut random)).collect();
            let [lower, upper] = Comparison::of(pairs(&differences, 2)).interval;
            held += usize::from((lower..=upper).contains(&-0.3));
        }
        // 95 % of 200 is 190, four standard deviations 12; a percentile bootstrap of 40 is a little narrow (about 93 %).
        assert!((174..=200).contains(&held), "{held}");
    }

    #[test]
    fn a_difference_between_scenarios_is_not_taken_for_spread() {
        let differences: Vec<f64> = (0..40).map(|k| if k % 2 == 0 { -2.0 } else { -0.1 }).collect();
        let comparison = Comparison::of(pairs(&differences, 2));
        assert_eq!(comparison.verdict, Verdict::Gained);
        assert!((comparison.interval[1] - comparison.interval[0]).abs() < 1e-12);
        let means: Vec<f64> = comparison.scenarios.iter().map(|s| s.mean_difference).collect();
        assert!((means[0] + 2.0).abs() < 1e-12 && (means[1] + 0.1).abs() < 1e-12, "{means:?}");
    }

    #[test]
    fn verdicts_say_what_happened() {
        let verdict = |differences: &[f64]| Comparison::of(pairs(differences, 1)).verdict;
        assert_eq!(verdict(&[-1.0, -1.1, -0.9, -1.0, -1.2, -0.8]), Verdict::Gained);
        assert_eq!(verdict(&[1.0, 1.1, 0.9, 1.0, 1.2, 0.8]), Verdict::Lost);
        assert_eq!(verdict(&[1.0, -1.1, 0.9, -1.0, 1.2, -0.8]), Verdict::NoDifference);
        assert_eq!(verdict(&[0.0; 6]), Verdict::Kept);
        assert_eq!(verdict(&[-1.0, -2.0]), Verdict::TooFew);
        let lost = Comparison::of(pairs(&[1.0, 1.1, 0.9, 1.0, 1.2, 0.8], 1));
        assert!(
            lost.sentence().contains("LOST") && lost.sentence().contains("0 better, 6 worse"),
            "{}",
            lost.sentence()
        );
    }
}
