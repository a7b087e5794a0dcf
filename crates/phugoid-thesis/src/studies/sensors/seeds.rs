//! The same flight with other sensor noise: how often are the increments found in one short-period cycle?

use phugoid_identification::estimate::{EstimateOptions, estimate};

use super::information::{INCREMENTS, Information};
use super::input::{CYCLE_S, START_S};
use crate::aircraft_case::{AircraftCase, model_file};
use crate::plant_case::verdict::TOLERANCE;
use phugoid_evaluation::accuracy::StudyError;
use phugoid_evaluation::monte_carlo::monte_carlo;
use phugoid_evaluation::settling::settled_at;
use phugoid_simulation::flight::{Flight, sense};

/// Runs: seeds of the sensor noise, from that of the case on.
pub(super) const RUNS: usize = 40;

/// What the runs say of one increment.
#[derive(Clone, Debug)]
pub(super) struct Repeated {
    /// Increment.
    pub(super) name: String,
    /// Cramer-Rao bound after one cycle with the case's increments looked for, percent of the truth.
    pub(super) bound_percent: f64,
    /// Root mean square error over the runs after one cycle, percent of the truth.
    pub(super) rmse_percent: f64,
    /// Runs in which the estimate is within 5 % to stay after one cycle.
    pub(super) settled: usize,
}

impl Repeated {
    /// Runs that would be within 5 % after one cycle if the errors were normal with the bound as standard deviation.
    pub(super) fn expected(&self) -> f64 {
        RUNS as f64 * within(self.bound_percent)
    }
}

/// All increments of a case over the runs.
#[derive(Clone, Debug)]
pub(super) struct Seeds {
    /// By increment.
    pub(super) increments: Vec<Repeated>,
    /// Runs in which all of them are within 5 % to stay after one cycle.
    pub(super) all_settled: usize,
}

impl Seeds {
    /// Runs in which all would be, by the bounds, were their errors independent.
    pub(super) fn all_expected(&self) -> f64 {
        RUNS as f64 * self.increments.iter().map(|increment| within(increment.bound_percent)).product::<f64>()
    }

    /// Measures a flown case [`RUNS`] times and lets the flagship estimate each of them.
    pub(super) fn of(case: &AircraftCase, flight: &Flight) -> Result<Self, StudyError> {
        let model = model_file(case)?;
        let names: Vec<&str> = case.unknowns().into_iter().map(|(name, _)| name).collect();
        let end = START_S + CYCLE_S;
        let bounds = Information::of(flight, &names, &names, &[end])?;
        let options = EstimateOptions { truth: flight.true_parameters.clone(), ..EstimateOptions::causal() };
        let runs = monte_carlo(
            RUNS,
            |run| {
                let measured = sense(&flight.truth, &case.scenario, case.scenario.seed.wrapping_add(run as u64))?;
                let history = estimate(&measured, &model, &options, &mut |_| {})?.history;
                let k = history.time_s.partition_point(|t| *t <= end + 1e-9).saturating_sub(1);
                let of = |name: &&str| {
                    let truth = case.truth(name);
                    let values = history.parameters.iter().find(|p| p.name == **name).map(|p| p.value.as_slice());
                    let values = values.unwrap_or_default();
                    let error = values.get(k).map_or(f64::NAN, |value| 100.0 * (value / truth - 1.0));
                    let settled =
                        settled_at(&history.time_s, values, truth, TOLERANCE).is_some_and(|t| t <= end + 1e-9);
                    (error, settled)
                };
                Ok::<_, StudyError>(names.iter().map(of).collect::<Vec<(f64, bool)>>())
            },
            || (),
        )?;
        let increments = names.iter().enumerate().map(|(j, name)| {
            let square = runs.iter().map(|run| run[j].0 * run[j].0).sum::<f64>() / RUNS as f64;
            Repeated {
                name: (*name).to_owned(),
                bound_percent: bounds.percent[j].first().copied().unwrap_or(f64::NAN),
                rmse_percent: square.sqrt(),
                settled: runs.iter().filter(|run| run[j].1).count(),
            }
        });
        Ok(Self {
            increments: increments.collect(),
            all_settled: runs.iter().filter(|run| run.iter().all(|(_, settled)| *settled)).count(),
        })
    }
}

/// Probability that a normal error with this standard deviation (percent of the truth) is below 5 %.
fn within(percent: f64) -> f64 {
    libm::erf(100.0 * TOLERANCE / (percent * std::f64::consts::SQRT_2))
}

/// The case with its increments, bounds and start values scaled to other increments.
pub(super) fn scaled(case: &AircraftCase, to: [f64; 4]) -> AircraftCase {
    let mut scaled = case.clone();
    for (name, value) in INCREMENTS.into_iter().zip(to) {
        let Some(settings) = scaled.parameters.get_mut(name) else { continue };
        let factor = value / case.truth(name);
        let start = settings.start();
        settings.lower *= factor;
        settings.upper *= factor;
        settings.start = Some(factor * start);
        if let Some(increment) = scaled.scenario.increments.longitudinal_mut(name) {
            *increment = value;
        }
    }
    scaled
}
