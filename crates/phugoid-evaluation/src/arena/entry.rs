//! What is flown and what every method is told of it.

use phugoid_identification::model_file::ModelFile;

use phugoid_simulation::scenario::{Scenario, ScenarioError};

/// One scenario of the arena.
#[derive(Clone, Debug, PartialEq)]
pub struct Entry {
    /// Its name on the command line.
    pub id: String,
    /// A few words.
    pub title: String,
    /// What is to be seen in it, in a sentence.
    pub shows: String,
    /// What is flown; flight `k` has its seed plus `k`.
    pub scenario: Scenario,
    /// What every method is told of the aircraft.
    pub model: ModelFile,
    /// Period in which times are counted, s: the short period.
    pub cycle_s: f64,
}

impl Entry {
    /// A scenario and a model of a user's own.
    pub fn new(id: impl Into<String>, scenario: Scenario, model: ModelFile, cycle_s: f64) -> Self {
        let title = scenario.name.clone();
        Self { id: id.into(), title, shows: String::new(), scenario, model, cycle_s }
    }

    /// Parses the text of an arena file: `[scenario]` and `[model]` with a `title`, what it `shows` and the `cycle` in which
    /// times are counted; or what differs from the built-in entry that it `extends`. `id` is its name, in messages too.
    ///
    /// # Errors
    /// [`ScenarioError`] with the line, or with the name of what is missing.
    pub fn parse(text: &str, id: &str) -> Result<Self, ScenarioError> {
        super::parse::parse(text, id)
    }
}

macro_rules! built_in {
    ($($id:literal),* $(,)?) => {
        &[$(($id, include_str!(concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenarios/arena/", $id, ".toml")))),*]
    };
}

/// The entries that are built in, in the order in which they are shown: name and text.
pub const BUILT_IN: &[(&str, &str)] = built_in![
    "calm",
    "doublet",
    "pilot",
    "calm-50hz",
    "outliers",
    "bursts",
    "drops",
    "turbulence-light",
    "turbulence-moderate",
    "biases",
    "biases-untold",
    "delay",
    "noise-underrated",
    "noise-overrated",
    "tables-5",
    "tables-10",
    "actuator",
    "damage",
    "damage-321",
    "drift",
    "no-excitation",
    "everything",
];

/// A built-in entry by name.
pub fn built_in(id: &str) -> Option<Result<Entry, ScenarioError>> {
    BUILT_IN.iter().find(|(known, _)| *known == id).map(|(known, text)| Entry::parse(text, known))
}
