//! Damage: found or missed, how soon, and how good the estimates are afterwards.

use phugoid_identification::estimate::{EstimateOptions, KnownChange, Opens, estimate};
use phugoid_identification::estimation::{Estimation, EventKind};
use phugoid_identification::model_file::ModelFile;
use serde::{Deserialize, Serialize};

use super::conditions::{Air, Stick};
use super::draw::{Drawn, Order, flown};
use super::limit::informed_latency_s;
use crate::accuracy::StudyError;
use crate::ledger::{Ledger, recorded};
use crate::statistics::quantile;
use phugoid_simulation::scenario::Scenario;

/// Lines of the table.
pub(super) const LINES: usize = 8;

/// Times after the damage at which the estimates are looked at, s.
const AFTER_S: [f64; 4] = [1.0, 2.0, 4.2, 10.0];

/// Errors some time after the damage. An error is in parts of the half width of the parameter's bounds, quantiles are over runs and
/// parameters.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RecoveryLine {
    /// Time after the damage, s.
    pub after_s: f64,
    /// Median of the errors over that of the oracle, the same estimator told of the change at the instant of the damage.
    pub median_over_oracle: f64,
    /// The same with the 90 % quantile.
    pub ninety_over_oracle: f64,
    /// Median of the absolute errors, fraction of the half width of the parameter's bounds.
    pub median: f64,
    /// Part of the true values within two claimed standard errors.
    pub coverage: f64,
    /// The same of the oracle.
    pub oracle_coverage: f64,
}

/// One line of the table of damages.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct DamageLine {
    /// What moved the elevator in the flights of this line.
    pub stick: Stick,
    /// What disturbed the flights of this line beside the damage.
    pub air: Air,
    /// When the damage happened, s.
    pub damage_at_s: f64,
    /// Number of flights, each with a damage of its own.
    pub runs: usize,
    /// Time from the damage to the doubt, s: median and nine of ten (infinite: never).
    pub doubt_s: [f64; 2],
    /// Time from the damage to the adoption, s: median and nine of ten.
    pub adoption_s: [f64; 2],
    /// Time at which an observer who knows what to look for would know, s: median and nine of ten.
    pub informed_s: [f64; 2],
    /// Flights in which no change was adopted after the damage.
    pub missed: usize,
    /// Seeds of the flights in which the damage was missed, so that they can be flown again.
    pub missed_seeds: Vec<u64>,
    /// Adoptions before the damage, over all flights.
    pub false_before: usize,
    /// Adoptions beyond the first one after the damage, over all flights.
    pub extra: usize,
    /// Errors at several times after the damage, over all runs.
    pub recovery: Vec<RecoveryLine>,
}

#[derive(Serialize, Deserialize)]
struct Run {
    #[serde(with = "crate::exact")]
    doubt_s: f64,
    #[serde(with = "crate::exact")]
    adoption_s: f64,
    #[serde(with = "crate::exact")]
    informed_s: f64,
    false_before: usize,
    extra: usize,
    /// By time and parameter: error in half widths and in claimed standard errors, ours and the oracle's.
    #[serde(with = "crate::exact")]
    errors: Vec<Vec<[f64; 4]>>,
}

/// The eight lines: calm air and everything together, both sticks, damage at 10 s and at 20 s, `runs` flights each; the flights of a
/// line have the seeds `seed`, `seed + 1`, ...
///
/// # Errors
/// [`StudyError`]: a flight cannot be flown, or the model does not fit it.
pub fn damage_lines(
    base: &Scenario,
    model: &ModelFile,
    runs: usize,
    seed: u64,
    ledger: &dyn Ledger,
) -> Result<Vec<DamageLine>, StudyError> {
    let mut lines = Vec::new();
    for air in [Air::Calm, Air::Everything] {
        for stick in [Stick::Pilot, Stick::ThreeTwoOneOne] {
            for damage_at_s in [10.0, 20.0] {
                lines.push(line(base, model, stick, air, damage_at_s, runs, seed, ledger)?);
            }
        }
    }
    Ok(lines)
}

#[allow(clippy::too_many_arguments)] // what makes a line
fn line(
    base: &Scenario,
    model: &ModelFile,
    stick: Stick,
    air: Air,
    damage_at_s: f64,
    runs: usize,
    seed: u64,
    ledger: &dyn Ledger,
) -> Result<DamageLine, StudyError> {
    let order = Order {
        stick,
        air,
        biases: air == Air::Everything,
        duration_s: damage_at_s + AFTER_S[AFTER_S.len() - 1] + 0.1,
        damage_at_s: Some(damage_at_s),
    };
    let one = |run: usize| -> Result<Run, StudyError> {
        let drawn = flown(base, model, &order, seed.wrapping_add(run as u64), &|_| {})?;
        one_run(&drawn, model, damage_at_s)
    };
    let inputs = format!("detection of damage: {order:?}");
    let name = |run: usize| format!("seed {}", seed.wrapping_add(run as u64));
    let results = recorded(runs, &inputs, name, one, ledger)?;
    let quantiles = |of: &dyn Fn(&Run) -> f64| [0.5, 0.9].map(|f| quantile(results.iter().map(of).collect(), f));
    let missed: Vec<u64> =
        (seed..).zip(&results).filter(|(_, r)| r.adoption_s.is_infinite()).map(|(seed, _)| seed).collect();
    let recovery = AFTER_S
        .iter()
        .enumerate()
        .map(|(k, &after_s)| {
            let all: Vec<[f64; 4]> = results.iter().flat_map(|r| r.errors[k].iter().copied()).collect();
            let of = |i: usize, f: f64| quantile(all.iter().map(|e| e[i]).collect(), f);
            let covered = |i: usize| all.iter().filter(|e| e[i] <= 2.0).count() as f64 / all.len().max(1) as f64;
            RecoveryLine {
                after_s,
                median_over_oracle: of(0, 0.5) / of(2, 0.5),
                ninety_over_oracle: of(0, 0.9) / of(2, 0.9),
                median: of(0, 0.5),
                coverage: covered(1),
                oracle_coverage: covered(3),
            }
        })
        .collect();
    Ok(DamageLine {
        stick,
        air,
        damage_at_s,
        runs,
        doubt_s: quantiles(&|r| r.doubt_s),
        adoption_s: quantiles(&|r| r.adoption_s),
        informed_s: quantiles(&|r| r.informed_s),
        missed: missed.len(),
        missed_seeds: missed,
        false_before: results.iter().map(|r| r.false_before).sum(),
        extra: results.iter().map(|r| r.extra).sum(),
        recovery,
    })
}

fn one_run(drawn: &Drawn, model: &ModelFile, damage_at_s: f64) -> Result<Run, StudyError> {
    let measured = &drawn.flight.measured;
    let ours = estimate(measured, model, &EstimateOptions::causal(), &mut |_| {})?;
    let told = EstimateOptions {
        change_detection: Some(false),
        known_changes: vec![KnownChange { time_s: damage_at_s, opens: Opens::Everything }],
        ..EstimateOptions::causal()
    };
    let oracle = estimate(measured, model, &told, &mut |_| {})?;
    let after = |kind: EventKind| -> f64 {
        let found = ours.events.iter().find(|e| e.kind == kind && e.time_s >= damage_at_s);
        found.map_or(f64::INFINITY, |e| e.time_s - damage_at_s)
    };
    let adoptions = || ours.events.iter().filter(|e| e.kind == EventKind::Adopted);
    let false_before = adoptions().filter(|e| e.time_s < damage_at_s).count();
    let errors = AFTER_S
        .iter()
        .map(|after_s| {
            let at = |estimation| errors_at(estimation, model, &drawn.after, damage_at_s + after_s);
            at(&ours).iter().zip(&at(&oracle)).map(|(a, b)| [a[0], a[1], b[0], b[1]]).collect()
        })
        .collect();
    Ok(Run {
        // Damage may fall into a doubt that is already running.
        doubt_s: after(EventKind::InDoubt).min(after(EventKind::Adopted)),
        adoption_s: after(EventKind::Adopted),
        informed_s: informed_latency_s(drawn, model, damage_at_s)?,
        false_before,
        extra: adoptions().count().saturating_sub(false_before + 1),
        errors,
    })
}

/// By estimated term at a time: absolute error in half widths of the bounds and in claimed standard errors.
pub(super) fn errors_at(estimation: &Estimation, model: &ModelFile, truth: &[f64], time_s: f64) -> Vec<[f64; 2]> {
    let k = estimation.history.time_s.partition_point(|t| *t <= time_s + 1e-9).saturating_sub(1);
    let at = |values: &[f64]| values.get(k).copied().unwrap_or(f64::NAN);
    let terms = model.estimated().filter(|p| !p.is_nuisance());
    terms
        .zip(truth)
        .map(|(parameter, truth)| {
            let [low, high] = parameter.bounds.unwrap_or([f64::NAN; 2]);
            let history = estimation.history.parameters.iter().find(|p| p.name == parameter.name);
            let (value, std) = history.map_or((f64::NAN, f64::NAN), |p| (at(&p.value), at(&p.std_error)));
            let error = (value - truth).abs();
            [error / (0.5 * (high - low)), error / std]
        })
        .collect()
}
