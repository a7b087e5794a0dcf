//! A case of the thesis as a file: title, `[published]`, and one of three kinds.
//!
//! | table | kind | format |
//! |---|---|---|
//! | `[plant]` | one of the four proof-of-concept plants | [`PlantCase`] |
//! | `[scenario]` | a flight of the F-16 | [`AircraftCase`] |
//! | `[scenario]` and `[comparison]` | a flight of the F-16, several methods on it | [`ComparisonCase`] |
//!
//! The published cases lie in `scenarios/thesis/`; a copy with other numbers runs in the same way.

use std::path::Path;

use serde::Deserialize;
use serde::de::IgnoredAny;

use super::aircraft_case::AircraftCase;
use super::comparison::ComparisonCase;
use super::plant_case::PlantCase;
use super::{Reproduction, changed_from};
use phugoid_evaluation::accuracy::StudyError;
use phugoid_simulation::scenario::{ScenarioError, parse_toml};

/// A case, ready to run.
#[derive(Clone, Debug, PartialEq)]
pub enum Case {
    /// A case of a proof-of-concept plant.
    Plant(Box<PlantCase>),
    /// A flight of the F-16.
    Aircraft(Box<AircraftCase>),
    /// A flight of the F-16 on which several methods are compared.
    Comparison(Box<ComparisonCase>),
}

/// Which kind of case a file holds.
#[derive(Deserialize)]
struct Kind {
    plant: Option<IgnoredAny>,
    scenario: Option<IgnoredAny>,
    comparison: Option<IgnoredAny>,
}

impl Case {
    /// Reads a case file.
    ///
    /// # Errors
    /// [`ScenarioError`]: the file cannot be read, is not TOML, names something that does not exist, or has a value out
    /// of range; with file, line and what to write.
    pub fn read(file: &Path) -> Result<Self, ScenarioError> {
        Self::of_file(&text_of(file)?, file)
    }

    /// The case whose text a file has; the files that it names are looked for beside it.
    fn of_file(text: &str, file: &Path) -> Result<Self, ScenarioError> {
        let mut case = Self::parse(text, &file.display().to_string())?;
        let scenario = match &mut case {
            Self::Plant(_) => return Ok(case),
            Self::Aircraft(case) => &mut case.scenario,
            Self::Comparison(case) => &mut case.scenario,
        };
        scenario.folder = file.parent().map(Path::to_owned).unwrap_or_default();
        Ok(case)
    }

    /// Parses the text of a case; `place` is its name in messages.
    ///
    /// # Errors
    /// As [`Case::read`].
    pub fn parse(text: &str, place: &str) -> Result<Self, ScenarioError> {
        let kind: Kind = parse_toml(text, place)?;
        match (kind.plant.is_some(), kind.scenario.is_some()) {
            (true, false) => PlantCase::parse(text, place).map(Box::new).map(Self::Plant),
            (false, true) if kind.comparison.is_some() => {
                ComparisonCase::parse(text, place).map(Box::new).map(Self::Comparison)
            }
            (false, true) => AircraftCase::parse(text, place).map(Box::new).map(Self::Aircraft),
            (plant, _) => Err(ScenarioError::OutOfRange {
                place: place.to_owned(),
                message: format!(
                    "a case needs one table that says what is simulated, `[plant]` or `[scenario]`: it has {}",
                    if plant { "both" } else { "neither" }
                ),
            }),
        }
    }

    /// Runs the case; `id` is the name its result bears.
    ///
    /// # Errors
    /// [`StudyError`]: a method refuses the settings, or the simulation leaves the range of numbers.
    pub fn run(&self, id: &str) -> Result<Reproduction, StudyError> {
        match self {
            Self::Plant(case) => case.run(id),
            Self::Aircraft(case) => case.run(id),
            Self::Comparison(case) => case.run(id, &|_| ()),
        }
    }
}

fn text_of(file: &Path) -> Result<String, ScenarioError> {
    std::fs::read_to_string(file).map_err(|source| ScenarioError::Unreadable { file: file.to_owned(), source })
}

/// A case that is not one of the built-in entries: a file or a text of a user. Its result says so where it bears the title of a case
/// of the thesis with another text.
#[derive(Clone, Debug)]
pub struct OwnCase {
    /// The name of its result: that of the file, without the ending.
    pub id: String,
    /// The text of the case.
    pub text: String,
    case: Case,
    /// The id of the built-in case whose title it bears.
    changed: Option<&'static str>,
}

impl OwnCase {
    /// Reads a case file.
    ///
    /// # Errors
    /// As [`Case::read`].
    pub fn read(file: &Path) -> Result<Self, ScenarioError> {
        let text = text_of(file)?;
        let case = Case::of_file(&text, file)?;
        let id = file.file_stem().unwrap_or(file.as_os_str()).to_string_lossy().into_owned();
        Ok(Self { id, changed: changed_from(&text), case, text })
    }

    /// Parses the text of a case; `id` is its name in messages and that of its result.
    ///
    /// # Errors
    /// As [`Case::parse`].
    pub fn parse(text: &str, id: &str) -> Result<Self, ScenarioError> {
        let case = Case::parse(text, id)?;
        Ok(Self { id: id.to_owned(), text: text.to_owned(), changed: changed_from(text), case })
    }

    /// Runs the case.
    ///
    /// # Errors
    /// As [`Case::run`].
    pub fn run(&self) -> Result<Reproduction, StudyError> {
        let mut result = self.case.run(&self.id)?;
        if let Some(of) = self.changed {
            result.title = format!("{} (changed: not the case {of} of the thesis)", result.title);
        }
        Ok(result)
    }
}
