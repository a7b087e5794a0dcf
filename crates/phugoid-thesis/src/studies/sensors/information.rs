//! What a flight can say about its increments: the Cramer-Rao bound over time.

use phugoid_identification::model_file::ModelFile;

use phugoid_evaluation::accuracy::{StudyError, bound};
use phugoid_evaluation::published::CALM_MODEL;
use phugoid_simulation::flight::{Flight, fly};
use phugoid_simulation::scenario::Scenario;

/// Increments, in the order of the model's parameters.
pub(super) const INCREMENTS: [&str; 4] = ["dCm_alpha", "dCm_q", "dCL_alpha", "dCD_alpha"];

/// The Cramer-Rao bound of the increments looked for.
#[derive(Clone, Debug)]
pub(super) struct Information {
    /// Time, s.
    pub(super) time_s: Vec<f64>,
    /// Smallest possible standard error in percent of the truth, one history per increment looked for.
    pub(super) percent: Vec<Vec<f64>>,
}

impl Information {
    /// Of a flight, at the times `at` (s), with the increments `unknown` looked for together and the others known. The percent
    /// are given for `wanted`, which must be among them.
    pub(super) fn of(flight: &Flight, unknown: &[&str], wanted: &[&str], at: &[f64]) -> Result<Self, StudyError> {
        let model = model(flight, unknown)?;
        let bounds = bound(flight, &model, at)?;
        let column = |name: &str| model.estimated().position(|parameter| parameter.name == name);
        let percent = wanted.iter().map(|name| {
            let truth = flight.true_parameters.get(*name).copied().unwrap_or(f64::NAN);
            let of =
                |errors: &[f64]| column(name).and_then(|j| errors.get(j)).map_or(f64::NAN, |e| 100.0 * e / truth.abs());
            bounds.iter().map(|bound| of(&bound.std_error)).collect()
        });
        Ok(Self { time_s: bounds.iter().map(|bound| bound.time_s).collect(), percent: percent.collect() })
    }
}

/// The model with realistic sensors, `unknown` looked for and the other increments known.
fn model(flight: &Flight, unknown: &[&str]) -> Result<ModelFile, StudyError> {
    let mut model = ModelFile::parse("f16-model", CALM_MODEL).map_err(StudyError::unsuitable)?;
    for parameter in &mut model.parameters {
        if !unknown.contains(&parameter.name.as_str()) {
            parameter.fixed = true;
            parameter.start = flight.true_parameters.get(&parameter.name).copied().unwrap_or(0.0);
        }
    }
    Ok(model)
}

/// The largest bound, in percent of the truth, of the increments `unknown` of a scenario at one time (s): that of the
/// coefficient which is hardest to find.
pub(super) fn hardest(scenario: &Scenario, unknown: &[&str], at: f64) -> Result<(f64, Flight), StudyError> {
    let flight = fly(scenario)?;
    let information = Information::of(&flight, unknown, unknown, &[at])?;
    let worst = information.percent.iter().filter_map(|history| history.first().copied()).fold(0.0, f64::max);
    Ok((worst, flight))
}
