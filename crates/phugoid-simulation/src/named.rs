//! Scenarios by what a user calls them: a file, or the name of one that is built in.

use std::path::Path;

use crate::scenario::{self, Scenario, ScenarioError, nearest};

/// Why there is no scenario under this name.
#[derive(Debug, thiserror::Error)]
pub enum NamedError {
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
