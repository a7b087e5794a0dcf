//! Scenarios by what a user calls them: a file, or the name of one that is built in.

use std::path::Path;

use crate::scenario::{self, Scenario, ScenarioError, nearest};

/// Why there is no scenario under a name or in a file.
#[derive(Debug, thiserror::Error)]
pub enum NamedError {
    /// No scenario of this name is built in.
    #[error("there is no built-in scenario `{name}`\n{hint}")]
    Unknown {
        /// The name that was asked for and is not known.
        name: String,
        /// The nearest name, or all of them, in a sentence.
        hint: String,
    },
    /// Neither a file that can be read nor a built-in scenario.
    #[error("{error}\n{hint}")]
    NoScenario {
        /// Why the file cannot be read or parsed.
        error: ScenarioError,
        /// The nearest name, or all of them, in a sentence.
        hint: String,
    },
    /// The text is not a scenario.
    #[error(transparent)]
    Scenario(#[from] ScenarioError),
}

impl Scenario {
    /// The built-in scenario with this name, for example `f16-calm`.
    ///
    /// ```
    /// use phugoid_simulation::scenario::Scenario;
    /// assert_eq!(Scenario::named("f16-calm")?.samples(), 2001); // 20 s at 100 Hz
    /// assert!(Scenario::named("f16-clam").unwrap_err().to_string().contains("`f16-calm`"));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`NamedError::Unknown`] with the nearest name.
    pub fn named(name: &str) -> Result<Self, NamedError> {
        match scenario::built_in(name) {
            Some(found) => Ok(found?),
            None => Err(NamedError::Unknown { name: name.to_owned(), hint: hint(name) }),
        }
    }

    /// The scenario file at this path, or, where there is no such file, the built-in scenario of this name: what the command
    /// line takes as a scenario.
    ///
    /// ```
    /// use phugoid_simulation::scenario::Scenario;
    /// assert_eq!(Scenario::find("f16-calm")?, Scenario::named("f16-calm")?);
    /// assert!(Scenario::find("no-such-file.toml").is_err());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`NamedError`] with the nearest name.
    pub fn find(wanted: &str) -> Result<Self, NamedError> {
        let file = Path::new(wanted);
        match scenario::built_in(wanted) {
            Some(result) if !file.exists() => Ok(result?),
            _ => Self::open(file).map_err(|error| no_scenario(wanted, error)),
        }
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
    NamedError::NoScenario { error, hint: hint(wanted) }
}

fn hint(wanted: &str) -> String {
    let names = scenario::BUILT_IN.iter().map(|(name, _)| *name);
    match nearest(wanted, names.clone()) {
        Some(near) => format!("Did you mean the built-in scenario `{near}`?"),
        None => format!("Built-in scenarios: {}", names.collect::<Vec<_>>().join(", ")),
    }
}
