//! What is flown and what every method is told of it.

use phugoid_identification::model_file::ModelFile;

use phugoid_simulation::scenario::{Scenario, ScenarioError};

/// One scenario of the arena.
#[derive(Clone, Debug, PartialEq)]
pub struct Entry {
    /// Its name on the command line.
    pub id: String,
    /// Title of the scenario for tables, a few words.
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
    /// An entry from a scenario and a model file; `cycle_s` (s) is the period in which times are counted, for instance
    /// that of the short period. The title is the name of the scenario.
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

/// A built-in entry by its name in [`BUILT_IN`]; `None` for any other name.
///
/// ```
/// use phugoid_evaluation::arena::{BUILT_IN, built_in};
///
/// let calm = built_in("calm").expect("it is built in")?;
/// assert_eq!(calm.id, "calm");
/// assert!(calm.cycle_s > 3.0 && calm.cycle_s < 6.0); // the short period of the F-16, s
/// assert!(built_in("stormy").is_none());
/// assert_eq!(BUILT_IN[0].0, "calm");
/// # Ok::<(), phugoid_simulation::scenario::ScenarioError>(())
/// ```
pub fn built_in(id: &str) -> Option<Result<Entry, ScenarioError>> {
    BUILT_IN.iter().find(|(known, _)| *known == id).map(|(known, text)| Entry::parse(text, known))
}
