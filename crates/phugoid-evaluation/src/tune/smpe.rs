//! The flagship on flights: its settings in the `[estimator]` section of the model file.

use std::collections::BTreeMap;
use std::path::PathBuf;

use phugoid_flight_data::record::Record;
use phugoid_flight_dynamics::increments::Increments;
use phugoid_identification::estimate::{EstimateOptions, estimate};
use phugoid_identification::model_file::{EstimatorTuning, ModelFile};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

use super::objective::{Score, Trace, score};
use super::setting::{Range, Setting};
use super::state::fingerprint;
use super::{HELD_OUT_RUNS, Part, RunName, Tunable};
use crate::accuracy::StudyError;
use crate::monte_carlo::monte_carlo;
use phugoid_simulation::flight::fly;
use phugoid_simulation::scenario::Scenario;

/// A scenario with what the estimator is told of it.
#[derive(Clone, Debug)]
pub struct Assignment {
    /// Name of the assignment in results and state files, for instance `f16-calm`.
    pub name: String,
    /// The scenario that is flown.
    pub scenario: Scenario,
    /// The model file with which the flight is estimated.
    pub model: ModelFile,
    /// Fingerprint of the scenario and the model file: it differs if one of them has been changed.
    pub fingerprint: String,
}

impl Assignment {
    /// A scenario and what the estimator is told of it.
    pub fn new(name: &str, scenario: Scenario, model: ModelFile) -> Self {
        // Of what they say, wherever the files lie.
        let said = (
            Scenario { folder: PathBuf::new(), ..scenario.clone() },
            ModelFile { source: String::new(), ..model.clone() },
        );
        Self { name: name.to_owned(), scenario, model, fingerprint: fingerprint(&format!("{said:?}")) }
    }
}

/// The flagship with flights to tune on and flights to judge by.
pub struct SmpeTuning {
    settings: Vec<Setting>,
    training: Runs,
    held_out: Runs,
}

#[derive(Default)]
struct Runs {
    /// Fingerprints of the scenarios with their models.
    sources: BTreeMap<String, String>,
    names: Vec<RunName>,
    runs: Vec<Run>,
}

struct Run {
    record: Record,
    model: ModelFile,
    truth: BTreeMap<String, f64>,
    /// When the truth can first be seen, s.
    from: f64,
}

impl SmpeTuning {
    /// Flies every assignment `runs` times for each part. The first training run of a scenario has its own truth and seed;
    /// in all others every increment is up to twice or half as large, within the bounds of the model file, and the noise is
    /// another. `done` is called after each flight.
    ///
    /// # Errors
    /// [`StudyError`]: a scenario cannot be flown, or has no unknown increment that the model looks for.
    pub fn new(
        training: &[Assignment],
        held_out: &[Assignment],
        runs: usize,
        done: &(dyn Fn() + Sync),
    ) -> Result<Self, StudyError> {
        let process_noise = training.iter().any(|a| a.model.process_noise.density.iter().any(|density| *density > 0.0));
        let adaptive = training.iter().any(|a| a.model.process_noise.adaptive);
        Ok(Self {
            settings: settings(process_noise, adaptive),
            training: fly_all(training, runs, 0, done)?,
            held_out: fly_all(held_out, runs, HELD_OUT_RUNS, done)?,
        })
    }

    fn part(&self, part: Part) -> &Runs {
        match part {
            Part::Training => &self.training,
            Part::HeldOut => &self.held_out,
        }
    }

    fn estimator(&self, values: &[f64]) -> EstimatorTuning {
        let value = |name: &str| self.settings.iter().zip(values).find(|(s, _)| s.name == name).map(|(_, v)| *v);
        EstimatorTuning {
            reaching_limit: value("reaching_limit"),
            rejection_scale: value("rejection_scale").unwrap_or(1.0),
            prior_scale: value("prior_scale").unwrap_or(1.0),
            process_noise_scale: value("process_noise_scale").unwrap_or(1.0),
            adaptation_gain: value("adaptation_gain"),
            start_window_s: value("start_window"),
            ..EstimatorTuning::default()
        }
    }
}

/// Settings that can matter: those of process noise only where there is any.
fn settings(process_noise: bool, adaptive: bool) -> Vec<Setting> {
    let number = |name, unit, meaning, [lower, upper]: [f64; 2], rule, origin| Setting {
        name,
        unit,
        meaning,
        range: Range::Logarithmic { lower, upper },
        rule,
        origin,
    };
    let mut settings = vec![
        number(
            "reaching_limit",
            "-",
            "kappa: up to this normalised innovation a measurement counts fully",
            [1.0, 12.0],
            3.0,
            "three sigma: costs clean data nothing visible, one sigma costs 3 to 10 % (docs/theory.md)",
        ),
        number(
            "rejection_scale",
            "-",
            "factor on kappa2, beyond which a measurement does not count",
            [0.5, 8.0],
            1.0,
            "kappa2 = max(6, 2 sqrt(p) + 2): with C0 = (R/2)^2 no truth inside the bounds explains more, plus 2 sigma of noise",
        ),
        number(
            "prior_scale",
            "-",
            "factor on the start priors",
            [0.1, 10.0],
            1.0,
            "C0 = (R/2)^2 from the half width R of the bounds: the bounds decide the gain",
        ),
        number(
            "start_window",
            "s",
            "length of the median that starts the state",
            [0.02, 1.0],
            0.2,
            "20 samples at 100 Hz: an outlier in the first sample does no harm",
        ),
    ];
    if process_noise {
        settings.push(number(
            "process_noise_scale",
            "-",
            "factor on the process noise at the start",
            [1e-3, 1e3],
            1.0,
            "the model file's, by default light Dryden turbulence",
        ));
    }
    if adaptive {
        settings.push(number(
            "adaptation_gain",
            "-",
            "part of the information about the scale of the process noise that is forgotten per sample",
            [1e-4, 1e-1],
            0.003,
            "a memory of 3 s at 100 Hz (docs/theory.md)",
        ));
    }
    settings
}

fn fly_all(assignments: &[Assignment], runs: usize, first: u64, done: &(dyn Fn() + Sync)) -> Result<Runs, StudyError> {
    let names: Vec<RunName> = assignments
        .iter()
        .flat_map(|a| (0..runs as u64).map(|run| RunName { scenario: a.name.clone(), run: first + run }))
        .collect();
    let runs = monte_carlo(
        names.len(),
        |k| {
            let assignment = &assignments[k / runs.max(1)];
            let scenario = variant(&assignment.scenario, &assignment.model, names[k].run);
            let flight = fly(&scenario)?;
            let truth: BTreeMap<String, f64> = assignment
                .model
                .estimated()
                .filter(|p| !p.is_nuisance())
                .filter_map(|p| Some((p.name.clone(), *flight.true_parameters.get(&p.name)?)))
                .filter(|(_, truth)| *truth != 0.0)
                .collect();
            let elevator = flight.truth.channel("elevator").map(|c| c.values.as_slice()).unwrap_or_default();
            let moved = elevator.iter().position(|e| (e - elevator[0]).abs() > 1e-12);
            let Some(moved) = moved.filter(|_| !truth.is_empty()) else {
                return Err(StudyError::Unsuitable(format!(
                    "{}: nothing to tune on: the elevator has to move, and the scenario to have an increment that the \
                     model `{}` estimates",
                    assignment.name, assignment.model.source
                )));
            };
            let damage = scenario.damage.last().map_or(f64::NEG_INFINITY, |d| d.at.si());
            let from = flight.truth.time[moved].max(damage);
            Ok(Run { record: flight.measured, model: assignment.model.clone(), truth, from })
        },
        done,
    )?;
    let sources = assignments.iter().map(|a| (format!("scenario {}", a.name), a.fingerprint.clone())).collect();
    Ok(Runs { sources, names, runs })
}

/// The scenario of a run: another seed, and from the second run on another truth.
fn variant(scenario: &Scenario, model: &ModelFile, run: u64) -> Scenario {
    if run == 0 {
        return scenario.clone();
    }
    let mut random = Pcg64Mcg::seed_from_u64(scenario.seed ^ run.wrapping_mul(0x9e37_79b9_7f4a_7c15));
    // One factor per name, the same before and after a damage.
    let factors: [f64; 9] = std::array::from_fn(|_| (random.random::<f64>() * 2.0 - 1.0).exp2());
    let scaled = |i: &Increments| {
        let mut values = i.named_longitudinal();
        for ((name, value), factor) in values.iter_mut().zip(factors) {
            *value *= factor;
            let bounds = model.parameters.iter().find(|p| p.name == *name).and_then(|p| p.bounds);
            if let Some([lower, upper]) = bounds {
                *value = value.clamp(lower, upper);
            }
        }
        let of = |name: &str| values.iter().find(|(n, _)| *n == name).map_or(0.0, |(_, value)| *value);
        Increments {
            dCm_alpha: of("dCm_alpha"),
            dCm_q: of("dCm_q"),
            dCm_elevator: of("dCm_elevator"),
            dCL_alpha: of("dCL_alpha"),
            dCL_q: of("dCL_q"),
            dCL_elevator: of("dCL_elevator"),
            dCD_alpha: of("dCD_alpha"),
            dCD_q: of("dCD_q"),
            dCD_elevator: of("dCD_elevator"),
            ..*i
        }
    };
    let mut scenario = scenario.clone();
    scenario.seed = scenario.seed.wrapping_add(run);
    scenario.increments = scaled(&scenario.increments);
    for damage in &mut scenario.damage {
        damage.increments = scaled(&damage.increments);
    }
    scenario
}

impl Tunable for SmpeTuning {
    fn method(&self) -> &'static str {
        "smpe"
    }

    fn settings(&self) -> &[Setting] {
        &self.settings
    }

    fn runs(&self, part: Part) -> &[RunName] {
        &self.part(part).names
    }

    fn score(&self, values: &[f64], part: Part, run: usize) -> Score {
        let Some(run) = self.part(part).runs.get(run) else { return Score::FAILURE };
        let model = ModelFile { estimator: self.estimator(values), ..run.model.clone() };
        let Ok(estimation) = estimate(&run.record, &model, &EstimateOptions::causal(), &mut |_| {}) else {
            return Score::FAILURE;
        };
        let traces: Vec<Trace> = estimation
            .history
            .parameters
            .into_iter()
            .filter_map(|history| {
                let truth = *run.truth.get(&history.name)?;
                Some(Trace { truth, values: history.value, std_errors: Some(history.std_error) })
            })
            .collect();
        score(&estimation.history.time_s, &traces, run.from)
    }

    fn sources(&self, part: Part) -> BTreeMap<String, String> {
        self.part(part).sources.clone()
    }

    fn settings_file(&self, values: &[f64]) -> String {
        let mut text = String::from(
            "# Settings of the estimator, written by `phugoid tune smpe`. Append this section to a model file.\n[estimator]\n",
        );
        for (setting, value) in self.settings.iter().zip(values) {
            text.push_str(&format!(
                "{} = {}  # {}; by rule {}\n",
                setting.name,
                setting.in_toml(*value),
                setting.meaning,
                setting.rule
            ));
        }
        text
    }
}
