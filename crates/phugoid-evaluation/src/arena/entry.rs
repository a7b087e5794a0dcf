//! What is flown and what every method is told of it.

use phugoid_identification::model_file::{ModelFile, Uncertainty};

use phugoid_simulation::scenario::{Scenario, ScenarioError};

use crate::put_in::declared::Sizes;

/// Errors that leave no trace in residuals: of sensors, of the aircraft's data, of times.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SilentErrors {
    /// How large, by quantity: each of its sites by itself (the accelerometers along x and z, for instance).
    pub sizes: Uncertainty,
    /// Whether the sizes are standard deviations of normal distributions from which each flight has its own; else every flight has errors of
    /// these sizes, of either sign.
    pub drawn: bool,
}

impl SilentErrors {
    /// Those of the flight with this seed.
    pub fn of_flight(&self, seed: u64) -> Sizes {
        if self.drawn { Sizes::drawn(&self.sizes, seed, |_| true) } else { Sizes::of_either_sign(&self.sizes, seed) }
    }
}

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
    /// Errors that residuals are silent about, put into each flight and what the methods are told; `None` for none.
    pub errors: Option<SilentErrors>,
    /// What every method is told of the aircraft; where there are errors, before they are put in.
    pub model: ModelFile,
    /// Period in which times are counted, s: the short period.
    pub cycle_s: f64,
}

impl Entry {
    /// An entry from a scenario and a model file; `cycle_s` (s) is the period in which times are counted, for instance
    /// that of the short period. The title is the name of the scenario.
    pub fn new(id: impl Into<String>, scenario: Scenario, model: ModelFile, cycle_s: f64) -> Self {
        let title = scenario.name.clone();
        Self { id: id.into(), title, shows: String::new(), scenario, errors: None, model, cycle_s }
    }

    /// Parses the text of an arena file: `[scenario]` and `[model]` with a `title`, what it `shows` and the `cycle` in which
    /// times are counted; or what differs from the built-in entry that it `extends`. `[errors]` has the sizes of [`SilentErrors`] under the
    /// keys of `[uncertainty]` in a model file, and `drawn`. `id` is its name, in messages too.
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
    "silent-none",
    "silent-airspeed",
    "silent-airspeed-per-alpha",
    "silent-density",
    "silent-vane",
    "silent-vane-zero",
    "silent-vane-lag",
    "silent-vane-position",
    "silent-surface",
    "silent-skew",
    "silent-play",
    "silent-accelerometers",
    "silent-accelerometers-position",
    "silent-mass",
    "silent-inertia",
    "silent-cg",
    "silent-geometry",
    "silent-thrust",
    "silent-all",
    "silent-drawn",
    "silent-damage",
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
