//! Damage study: whether a sudden change of the coefficients is found, how soon, and whether the claimed bounds hold
//! again afterwards.

use phugoid_identification::estimate::{EstimateOptions, estimate};
use phugoid_identification::estimation::EventKind;
use phugoid_identification::model_file::ModelFile;
use serde::{Deserialize, Serialize};

use crate::accuracy::StudyError;
use crate::ledger::{Ledger, recorded};
use crate::statistics::quantile;
use phugoid_simulation::flight::fly;
use phugoid_simulation::scenario::Scenario;

/// Accuracy of one parameter some time after the damage.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Recovery {
    /// Name of the parameter, as in the model file.
    pub name: String,
    /// True value after the damage.
    pub truth: f64,
    /// Root mean square error over the runs.
    pub rmse: f64,
    /// Median of the absolute error over the runs.
    pub median_error: f64,
    /// Fraction of the runs with the truth within two claimed standard errors.
    pub coverage: f64,
}

/// All parameters some time after the damage.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RecoveryAt {
    /// Time after the damage, s.
    pub after_s: f64,
    /// Parameters in the model's order.
    pub parameters: Vec<Recovery>,
}

/// Result of a damage study.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct DamageStudy {
    /// Name of the scenario that was flown.
    pub scenario: String,
    /// Name of the model file.
    pub model: String,
    /// Number of runs; run `i` has the scenario's seed plus `i`, for the sensors and the pilot.
    pub runs: usize,
    /// When the damage happens, s.
    pub damage_at_s: f64,
    /// Runs in which it was never found.
    pub missed: usize,
    /// Changes believed to have happened before the damage, over all runs.
    pub false_alarms: usize,
    /// Changes believed to have happened after the first one that followed the damage, over all runs.
    pub extra_changes: usize,
    /// Time from the damage to the adoption of the changed parameters, s: half of the runs are faster.
    pub latency_median_s: f64,
    /// The same for nine runs of ten.
    pub latency_90_percent_s: f64,
    /// How good the estimates are afterwards, all runs, those that missed it too.
    pub recovery: Vec<RecoveryAt>,
}

/// What one run says.
#[derive(Serialize, Deserialize)]
struct Run {
    latency_s: Option<f64>,
    false_alarms: usize,
    extra_changes: usize,
    /// Error and claimed standard error per time and parameter.
    #[serde(with = "crate::exact")]
    errors: Vec<Vec<(f64, f64)>>,
}

/// Flies `scenario`, whose last damage is the one in question, `runs` times with other sensor noise and another pilot, and
/// estimates each flight. The accuracy is given at the times `after` the damage (s). `ledger` is told of each run, from any thread, and
/// may keep what it says; it has to know the scenario and the model.
///
/// # Errors
/// [`StudyError`]: the scenario has no damage, cannot be flown, or the model does not fit it.
pub fn damage(
    scenario: &Scenario,
    model: &ModelFile,
    runs: usize,
    after: &[f64],
    ledger: &dyn Ledger,
) -> Result<DamageStudy, StudyError> {
    let Some(damage_at_s) = scenario.damage.last().map(|d| d.at.si()) else {
        return Err(StudyError::Unsuitable(format!("{}: no [[damage]] in this scenario", scenario.name)));
    };
    let truth = fly(scenario)?.true_parameters;
    let names: Vec<&str> = model.estimated().filter(|p| !p.is_nuisance()).map(|p| p.name.as_str()).collect();
    let seed = |run: usize| scenario.seed.wrapping_add(run as u64);
    let one_run = |run: usize| -> Result<Run, StudyError> {
        let scenario = Scenario { seed: seed(run), ..scenario.clone() };
        let flight = fly(&scenario)?;
        let estimation = estimate(&flight.measured, model, &EstimateOptions::causal(), &mut |_| {})?;
        let adopted: Vec<f64> =
            estimation.events.iter().filter(|e| e.kind == EventKind::Adopted).map(|e| e.time_s).collect();
        let false_alarms = adopted.iter().filter(|t| **t < damage_at_s).count();
        let latency_s = adopted.get(false_alarms).map(|t| t - damage_at_s);
        let time = &estimation.history.time_s;
        let errors = after
            .iter()
            .map(|a| {
                let k = time.partition_point(|t| *t <= damage_at_s + a + 1e-9).saturating_sub(1);
                let at = |values: &[f64]| values.get(k).copied().unwrap_or(f64::NAN);
                let history = |name: &str| estimation.history.parameters.iter().find(|p| p.name == name);
                names
                    .iter()
                    .map(|name| {
                        let truth = truth.get(*name).copied().unwrap_or(f64::NAN);
                        history(name).map_or((f64::NAN, f64::NAN), |p| (at(&p.value) - truth, at(&p.std_error)))
                    })
                    .collect()
            })
            .collect();
        let extra_changes = adopted.len().saturating_sub(false_alarms + 1);
        Ok(Run { latency_s, false_alarms, extra_changes, errors })
    };
    let inputs = format!("damage, {after:?} s after it");
    let results = recorded(runs, &inputs, |run| format!("seed {}", seed(run)), one_run, ledger)?;
    let latencies: Vec<f64> = results.iter().map(|r| r.latency_s.unwrap_or(f64::INFINITY)).collect();
    let recovery = after
        .iter()
        .enumerate()
        .map(|(k, &after_s)| {
            let parameters = names.iter().enumerate().map(|(j, name)| {
                let errors: Vec<(f64, f64)> = results.iter().map(|r| r.errors[k][j]).collect();
                let mean = |f: &dyn Fn(&(f64, f64)) -> f64| errors.iter().map(f).sum::<f64>() / runs.max(1) as f64;
                Recovery {
                    name: (*name).to_owned(),
                    truth: truth.get(*name).copied().unwrap_or(f64::NAN),
                    rmse: mean(&|(error, _)| error * error).sqrt(),
                    median_error: quantile(errors.iter().map(|(error, _)| error.abs()).collect(), 0.5),
                    coverage: mean(&|(error, sigma)| f64::from(error.abs() <= 2.0 * sigma)),
                }
            });
            RecoveryAt { after_s, parameters: parameters.collect() }
        })
        .collect();
    Ok(DamageStudy {
        scenario: scenario.name.clone(),
        model: model.name.clone(),
        runs,
        damage_at_s,
        missed: results.iter().filter(|r| r.latency_s.is_none()).count(),
        false_alarms: results.iter().map(|r| r.false_alarms).sum(),
        extra_changes: results.iter().map(|r| r.extra_changes).sum(),
        latency_median_s: quantile(latencies.clone(), 0.5),
        latency_90_percent_s: quantile(latencies, 0.9),
        recovery,
    })
}
