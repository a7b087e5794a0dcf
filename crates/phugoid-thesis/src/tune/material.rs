//! What can be tuned on: built-in scenarios, published cases, and the user's own files of both kinds.

use std::path::Path;

use phugoid_identification::model_file::ModelFile;
use serde::Deserialize;
use serde::de::IgnoredAny;

use super::cases::{CaseMethod, CaseTuning, NamedCase};
use crate::aircraft_case::{self, model_file};
use crate::case_file::Case;
use crate::plant_case::{published_case, published_ids};
use phugoid_evaluation::published;
use phugoid_evaluation::tune::smpe::{Assignment, SmpeTuning};
use phugoid_evaluation::tune::{Tunable, TuneError};
use phugoid_simulation::scenario::{BUILT_IN, Scenario, ScenarioError, built_in, nearest, parse_toml};

/// Methods that can be tuned.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Method {
    /// The flagship, tuned on simulated flights of aircraft.
    Smpe,
    /// The one-parameter sliding law of the thesis, on cases with one unknown.
    ThesisLaw,
    /// The model-reference law, on plants.
    ModelReference,
}

impl Method {
    /// What is tuned on if nothing is named, and what is held out.
    pub fn standard(self) -> [&'static [&'static str]; 2] {
        match self {
            Self::Smpe => [
                &["f16-calm", "f16-gust-actuators", "f16-thesis-sine"],
                &["f16-calm", "f16-damage", "f16-thesis-doublet"],
            ],
            Self::ThesisLaw => [
                &[
                    "first-order/1",
                    "first-order/5",
                    "first-order-nonlinear/1",
                    "dcm-alpha/1",
                    "dcm-q/1",
                    "dcl-alpha/1",
                    "dcd-alpha/1",
                ],
                &["first-order/4", "first-order-nonlinear/2", "dcm-alpha/4", "dcm-q/3", "dcl-alpha/3", "dcd-alpha/2"],
            ],
            Self::ModelReference => [
                &[
                    "first-order/1",
                    "first-order/5",
                    "second-order/1",
                    "second-order/3",
                    "second-order-nonlinear/1",
                    "noise/1",
                ],
                &["first-order/4", "second-order/2", "second-order/4", "second-order-nonlinear/2", "noise/3"],
            ],
        }
    }
}

/// The model file of each built-in scenario.
const MODELS: &[(&str, &str)] = &[
    ("f16-calm", published::CALM_MODEL),
    ("f16-thesis-doublet", published::THESIS_MODEL),
    ("f16-thesis-sine", published::THESIS_MODEL),
    ("f16-damage", published::DAMAGE_MODEL),
    ("f16-gust-actuators", published::GUST_MODEL),
];

/// A scenario or a case that has been read.
#[derive(Clone, Debug)]
pub enum Material {
    /// A flight, and what the estimator is told of it.
    Flight(Box<Assignment>),
    /// A case of the thesis, or one in its format.
    Case(Box<NamedCase>),
}

/// Why something cannot be tuned on.
#[derive(Debug, thiserror::Error)]
pub enum MaterialError {
    /// The scenario or case cannot be read; the message says why and where.
    #[error("{0}")]
    Scenario(#[from] ScenarioError),
    /// There is neither a file nor anything built in of this name.
    #[error("cannot read `{wanted}`: {source}\n{hint}")]
    Unknown {
        /// The name or path that was asked for.
        wanted: String,
        /// What the system says of it as a file.
        source: std::io::Error,
        /// The names that would have been understood.
        hint: String,
    },
    /// What the estimator is told is not given, or wrong.
    #[error("{0}")]
    Model(String),
}

/// Which kind a file is of.
#[derive(Deserialize)]
struct Kind {
    plant: Option<IgnoredAny>,
    scenario: Option<IgnoredAny>,
}

/// Reads a file, or what is built in under this name. A scenario of the user's own needs a `model`, which is also used in
/// place of the one of a built-in scenario.
///
/// # Errors
/// [`MaterialError`].
pub fn read(wanted: &str, model: Option<&ModelFile>) -> Result<Material, MaterialError> {
    let file = Path::new(wanted);
    if !file.exists() {
        if let Some(scenario) = built_in(wanted) {
            return flight(wanted, scenario?, model);
        }
        let published = published_case(wanted).map(|case| Case::Plant(Box::new(case)));
        let published =
            published.or_else(|_| aircraft_case::published_case(wanted).map(|c| Case::Aircraft(Box::new(c))));
        if let Ok(case) = published {
            return Ok(Material::Case(Box::new(NamedCase::new(wanted, case))));
        }
    }
    let text = std::fs::read_to_string(file).map_err(|source| MaterialError::Unknown {
        wanted: wanted.to_owned(),
        source,
        hint: hint(wanted),
    })?;
    let kind: Kind = parse_toml(&text, wanted)?;
    if kind.plant.is_some() || kind.scenario.is_some() {
        return Ok(Material::Case(Box::new(NamedCase::new(wanted, Case::read(file)?))));
    }
    flight(wanted, Scenario::open(file)?, model)
}

fn flight(name: &str, scenario: Scenario, model: Option<&ModelFile>) -> Result<Material, MaterialError> {
    let model = match (model, MODELS.iter().find(|(known, _)| *known == name)) {
        (Some(model), _) => model.clone(),
        (None, Some((_, text))) => {
            ModelFile::parse(name, text).map_err(|error| MaterialError::Model(error.to_string()))?
        }
        (None, None) => {
            return Err(MaterialError::Model(format!(
                "`{name}` is a scenario: give with --model what the estimator is told of its aircraft"
            )));
        }
    };
    Ok(Material::Flight(Box::new(Assignment::new(name, scenario, model))))
}

fn hint(wanted: &str) -> String {
    let names = || BUILT_IN.iter().map(|(name, _)| *name).chain(published_ids()).chain(aircraft_case::published_ids());
    match nearest(wanted, names()) {
        Some(near) => format!("Did you mean the built-in `{near}`?"),
        None => format!("Built-in: {}", names().collect::<Vec<_>>().join(", ")),
    }
}

/// Makes a method ready to be tuned: runs everything `runs` times for each part. `done` is called after each run.
///
/// # Errors
/// [`TuneError`]: a scenario or case cannot be run, or the method cannot be tuned on it.
pub fn prepare(
    method: Method,
    training: &[Material],
    held_out: &[Material],
    runs: usize,
    done: &(dyn Fn() + Sync),
) -> Result<Box<dyn Tunable>, TuneError> {
    let cases = |materials: &[Material]| -> Result<Vec<NamedCase>, TuneError> { materials.iter().map(case).collect() };
    let on_cases = |law: CaseMethod| -> Result<Box<dyn Tunable>, TuneError> {
        Ok(Box::new(CaseTuning::new(law, &cases(training)?, &cases(held_out)?, runs, done)?))
    };
    match method {
        Method::Smpe => {
            let flights = |materials: &[Material]| -> Result<Vec<Assignment>, TuneError> {
                materials.iter().map(assignment).collect()
            };
            Ok(Box::new(SmpeTuning::new(&flights(training)?, &flights(held_out)?, runs, done)?))
        }
        Method::ThesisLaw => on_cases(CaseMethod::ThesisLaw),
        Method::ModelReference => on_cases(CaseMethod::ModelReference),
    }
}

fn assignment(material: &Material) -> Result<Assignment, TuneError> {
    let named = match material {
        Material::Flight(assignment) => return Ok(assignment.as_ref().clone()),
        Material::Case(named) => named,
    };
    match &named.case {
        Case::Aircraft(case) => Ok(Assignment::new(&named.name, case.scenario.clone(), model_file(case)?)),
        Case::Comparison(_) => Err(TuneError::NoRuns(format!(
            "{}: a comparison of methods has settings of its own and is not tuned on",
            named.name
        ))),
        Case::Plant(_) => Err(TuneError::NoRuns(format!(
            "{}: smpe is tuned on flights (scenarios, cases with a [scenario]), this is a plant",
            named.name
        ))),
    }
}

fn case(material: &Material) -> Result<NamedCase, TuneError> {
    match material {
        Material::Case(named) => Ok(named.as_ref().clone()),
        Material::Flight(assignment) => Err(TuneError::NoRuns(format!(
            "{}: this method is tuned on case files, which say its bounds and start values (scenarios/thesis/*.toml); this \
             is a scenario",
            assignment.name
        ))),
    }
}
