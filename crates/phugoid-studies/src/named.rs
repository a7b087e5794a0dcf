//! Models and scenarios by what a user calls them: a file, or the name of one that is built in.

use std::path::Path;

use phugoid_identification::model_file::{ModelFile, ModelFileError};

use crate::published;
use crate::scenario::{self, Scenario, ScenarioError, nearest};

/// Why there is nothing under this name.
#[derive(Debug, thiserror::Error)]
pub enum NamedError {
    /// Neither a file that can be read nor a built-in model.
    #[error("cannot read the model file `{wanted}`: {error}\n{hint}")]
    NoModel {
        /// What was asked for.
        wanted: String,
        /// What the system says.
        error: std::io::Error,
        /// The nearest name, or all of them.
        hint: String,
    },
    /// A model file that is wrong.
    #[error(transparent)]
    Model(#[from] ModelFileError),
    /// Neither a file that can be read nor a built-in scenario.
    #[error("{error}\n{hint}")]
    NoScenario {
        /// What the reader says.
        error: ScenarioError,
        /// The nearest name, or all of them.
        hint: String,
    },
    /// A scenario that is wrong.
    #[error(transparent)]
    Scenario(#[from] ScenarioError),
}

/// The model files that are built in: name and text.
pub fn models() -> impl Iterator<Item = (&'static str, &'static str)> + Clone {
    ModelFile::BUILT_IN.into_iter().chain(published::MODELS.iter().copied())
}

/// A model file, or a built-in one by name.
///
/// # Errors
/// [`NamedError`] with the nearest name.
pub fn model(wanted: &str) -> Result<ModelFile, NamedError> {
    let (name, text) = model_text(wanted)?;
    Ok(ModelFile::parse(&name, &text)?)
}

/// Name and text of a model file, or of a built-in one by name.
///
/// # Errors
/// [`NamedError::NoModel`].
pub fn model_text(wanted: &str) -> Result<(String, String), NamedError> {
    let path = Path::new(wanted);
    if !path.exists()
        && let Some((name, text)) = models().find(|(name, _)| *name == wanted)
    {
        return Ok((name.to_owned(), text.to_owned()));
    }
    let text = std::fs::read_to_string(path).map_err(|error| no_model(wanted, error))?;
    Ok((wanted.to_owned(), text))
}

/// What is said where there is no model of this name.
pub fn no_model(wanted: &str, error: std::io::Error) -> NamedError {
    let names = || models().map(|(name, _)| name);
    let hint = match nearest(wanted, names()) {
        Some(near) => format!("Did you mean the built-in model `{near}`?"),
        None => format!(
            "Built-in models: {}. Start your own from one: phugoid estimate --show-model f16 > mine.toml",
            names().collect::<Vec<_>>().join(", ")
        ),
    };
    NamedError::NoModel { wanted: wanted.to_owned(), error, hint }
}

/// A scenario file, or a built-in scenario by name.
///
/// # Errors
/// [`NamedError`] with the nearest name.
pub fn scenario(wanted: &str) -> Result<Scenario, NamedError> {
    let file = Path::new(wanted);
    match scenario::built_in(wanted) {
        Some(result) if !file.exists() => Ok(result?),
        _ => Scenario::read(file).map_err(|error| no_scenario(wanted, error)),
    }
}

/// The text of a scenario file, or of a built-in scenario.
///
/// # Errors
/// [`NamedError`] with the nearest name.
pub fn scenario_text(wanted: &str) -> Result<String, NamedError> {
    match scenario::BUILT_IN.iter().find(|(name, _)| *name == wanted) {
        Some((_, text)) => Ok((*text).to_owned()),
        None => std::fs::read_to_string(wanted)
            .map_err(|source| no_scenario(wanted, ScenarioError::Unreadable { file: wanted.into(), source })),
    }
}

fn no_scenario(wanted: &str, error: ScenarioError) -> NamedError {
    if !matches!(error, ScenarioError::Unreadable { .. }) {
        return NamedError::Scenario(error);
    }
    let names = scenario::BUILT_IN.iter().map(|(name, _)| *name);
    let hint = match nearest(wanted, names.clone()) {
        Some(near) => format!("Did you mean the built-in scenario `{near}`?"),
        None => format!("Built-in scenarios: {}", names.collect::<Vec<_>>().join(", ")),
    };
    NamedError::NoScenario { error, hint }
}
