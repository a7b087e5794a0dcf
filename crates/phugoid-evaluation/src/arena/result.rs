//! What an arena gives: plain data.

use serde::Serialize;

use super::findings::Findings;
use super::rows::Row;

/// Every method on every entry.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Arena {
    /// Number of flights per entry; each has its own seed.
    pub seeds: usize,
    /// Methods, in the order of every list here; the first one is ours.
    pub methods: Vec<String>,
    /// Results of all entries, in the order in which they were flown.
    pub entries: Vec<EntryResult>,
    /// Sentences on where each method is best and where it fails, made from the numbers alone.
    pub findings: Findings,
    /// Every judged number of every flight.
    #[serde(skip)]
    pub rows: Vec<Row>,
}

/// Results of all methods on one entry.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct EntryResult {
    /// Name of the entry on the command line.
    pub id: String,
    /// Title of the entry for tables.
    pub title: String,
    /// What is to be seen in it.
    pub shows: String,
    /// Number of flights.
    pub flights: usize,
    /// Duration of each flight, s.
    pub duration_s: f64,
    /// Period in which times are counted, s.
    pub cycle_s: f64,
    /// When counting begins in each flight, s: at the last damage, else when a surface first moves; the median flight's.
    pub counted_from_s: f64,
    /// Whether it has damage: a change to be found.
    pub damaged: bool,
    /// Whether errors were put in that residuals are silent about, and that model files declare.
    pub silent: bool,
    /// What errors are measured in.
    pub unit: Unit,
    /// Results of each method, in the order of [`Arena::methods`].
    pub methods: Vec<MethodResult>,
}

/// What an error is divided by.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Unit {
    /// The Cramer-Rao bound of the flight.
    CramerRao,
    /// The Cramer-Rao bound that the flight would have without gusts. With gusts no method can reach it.
    CalmCramerRao,
    /// The deviation that the model file expects beforehand: the flight has no bound.
    Prior,
}

impl Unit {
    /// The unit in words, as tables print it.
    pub fn words(self) -> &'static str {
        match self {
            Self::CramerRao => "Cramer-Rao bound",
            Self::CalmCramerRao => "Cramer-Rao bound without gusts",
            Self::Prior => "prior deviation",
        }
    }
}

/// One method on one entry.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct MethodResult {
    /// Name of the method.
    pub method: String,
    /// Flights in which it ended without an estimate, or with one that is not finite; they are left out below.
    pub failed: usize,
    /// Message of the first flight in which it failed; none if it never failed.
    pub failure: Option<String>,
    /// Flights in which it claims no bound for some parameter: a coverage cannot be told.
    pub without_bounds: usize,
    /// After 1, 2 and 5 cycles.
    pub checkpoints: Vec<Checkpoint>,
    /// When the parameters came within 5 % of the truth for good.
    pub settled: Vec<Settled>,
    /// Time at which the slowest parameter has settled, median over the flights, s after the reference; none if it
    /// never settles in half of them or more.
    pub settled_median_s: Option<f64>,
    /// How many changes the method found, missed, or reported although there were none.
    pub detection: Detection,
    /// Time of computing per sample, the whole pipeline around the method included, microseconds; median over the flights.
    /// Not reproducible.
    pub microseconds: f64,
    /// Computing time per sample divided by that of the first method.
    pub relative_time: f64,
}

/// All parameters after some cycles.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Checkpoint {
    /// Time of the checkpoint after the instant from which the flight is counted, in cycles of the entry.
    pub cycles: f64,
    /// Time of the checkpoint after the instant from which the flight is counted, s.
    pub after_s: f64,
    /// Geometric mean over the parameters of root mean square error over unit.
    pub accuracy: Option<f64>,
    /// Parameters within two claimed standard errors of the truth, all together.
    pub coverage: Option<Coverage>,
    /// Claimed over actual: root mean square of the claimed standard errors over that of the errors, geometric mean over the parameters.
    pub claimed_over_actual: Option<f64>,
    /// `coverage` by a model file that declares no uncertainty, of entries with errors put in.
    pub undeclared_coverage: Option<Coverage>,
    /// `claimed_over_actual` likewise.
    pub undeclared_over_actual: Option<f64>,
    /// Scores of each parameter, in the model's order.
    pub parameters: Vec<ParameterScore>,
}

/// One parameter after some cycles, over all flights.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ParameterScore {
    /// Name of the parameter, as in the model file.
    pub name: String,
    /// Mean error, the parameter's unit.
    pub bias: f64,
    /// Root mean square error over the flights, the parameter's unit.
    pub rmse: f64,
    /// Root mean square of the error over the unit of its flight.
    pub rmse_over_unit: f64,
    /// Median of the absolute error over the unit, over that of a normal error of one unit (0.6745): as the root mean square
    /// where errors are normal, untouched by a few flights gone wrong.
    pub median_over_unit: f64,
    /// Root mean square of the claimed standard errors.
    pub claimed: f64,
    /// Flights with the truth within two claimed standard errors.
    pub coverage: Option<Coverage>,
}

/// How often the truth lies within two claimed standard errors.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Coverage {
    /// Fraction of the cases, 0 to 1, in which the truth lies within two claimed standard errors.
    pub fraction: f64,
    /// 95 % interval of the probability (Clopper and Pearson); where several parameters of one flight are counted, as if
    /// there were as many independent cases as the spread between the flights tells.
    pub interval: [f64; 2],
}

/// When one parameter came within 5 % of the truth for good.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Settled {
    /// Name of the parameter, as in the model file.
    pub name: String,
    /// Median over the flights, s after the reference; none if it never does in half of them.
    pub median_s: Option<f64>,
    /// Flights in which it never does.
    pub never: usize,
}

/// A count over a time.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Counted {
    /// Number of events that were counted.
    pub count: usize,
    /// Per ten minutes of flight.
    pub per_ten_minutes: f64,
}

/// How well a method detects sudden changes of the parameters.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Detection {
    /// Number of flights in which the scenario has damage.
    pub damaged: usize,
    /// Of these, those in which a change was adopted after it.
    pub found: usize,
    /// Median time from the damage to the adoption, s; none if more than half were missed.
    pub latency_median_s: Option<f64>,
    /// The same to the first doubt after the damage.
    pub doubt_median_s: Option<f64>,
    /// Changes adopted where there was none: before the damage, or in a flight without.
    pub false_alarms: Counted,
    /// Changes adopted after the first one that followed the damage.
    pub further: usize,
}
