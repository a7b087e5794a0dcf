//! What an arena gives: plain data.

use serde::Serialize;

use super::findings::Findings;
use super::rows::Row;

/// Every method on every entry.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Arena {
    /// Flights per entry.
    pub seeds: usize,
    /// Methods, in the order of every list here; the first one is ours.
    pub methods: Vec<String>,
    /// Entries.
    pub entries: Vec<EntryResult>,
    /// What follows, in words.
    pub findings: Findings,
    /// Every judged number of every flight.
    #[serde(skip)]
    pub rows: Vec<Row>,
}

/// One entry.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct EntryResult {
    /// Name.
    pub id: String,
    /// Title.
    pub title: String,
    /// What is to be seen in it.
    pub shows: String,
    /// Flights.
    pub flights: usize,
    /// Length of each, s.
    pub duration_s: f64,
    /// Period in which times are counted, s.
    pub cycle_s: f64,
    /// When counting begins in each flight, s: at the last damage, else when a surface first moves; the median flight's.
    pub counted_from_s: f64,
    /// Whether it has damage: a change to be found.
    pub damaged: bool,
    /// What errors are measured in.
    pub unit: Unit,
    /// By method.
    pub methods: Vec<MethodResult>,
}

/// What an error is divided by.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Unit {
    /// The Cramer-Rao bound of the flight.
    CramerRao,
    /// The Cramer-Rao bound that the flight would have without the gusts: the methods cannot reach it.
    CalmCramerRao,
    /// The deviation that the model file expects beforehand: the flight has no bound.
    Prior,
}

impl Unit {
    /// As it is printed.
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
    /// Method.
    pub method: String,
    /// Flights in which it ended without an estimate, or with one that is not finite; they are left out below.
    pub failed: usize,
    /// Why, the first time.
    pub failure: Option<String>,
    /// Flights in which it claims no bound for some parameter: a coverage cannot be told.
    pub without_bounds: usize,
    /// After 1, 2 and 5 cycles.
    pub checkpoints: Vec<Checkpoint>,
    /// When the parameters came within 5 % of the truth for good.
    pub settled: Vec<Settled>,
    /// When the slowest parameter came there, median over the flights, s after the reference; none if never in half of them.
    pub settled_median_s: Option<f64>,
    /// Changes found, missed, imagined.
    pub detection: Detection,
    /// Time of computing per sample, the whole pipeline around the method included, microseconds; median over the flights.
    /// Not reproducible.
    pub microseconds: f64,
    /// The same over that of the first method.
    pub relative_time: f64,
}

/// All parameters after some cycles.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Checkpoint {
    /// Cycles after the reference.
    pub cycles: f64,
    /// The same in seconds.
    pub after_s: f64,
    /// Geometric mean over the parameters of root mean square error over unit.
    pub accuracy: Option<f64>,
    /// Parameters within two claimed standard errors of the truth, all together.
    pub coverage: Option<Coverage>,
    /// By parameter.
    pub parameters: Vec<ParameterScore>,
}

/// One parameter after some cycles, over all flights.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ParameterScore {
    /// Name.
    pub name: String,
    /// Mean error, the parameter's unit.
    pub bias: f64,
    /// Root mean square error.
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
    /// Part of the cases.
    pub fraction: f64,
    /// 95 % interval of the probability (Clopper and Pearson); where several parameters of one flight are counted, as if
    /// there were as many independent cases as the spread between the flights tells.
    pub interval: [f64; 2],
}

/// When one parameter came within 5 % of the truth for good.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Settled {
    /// Name.
    pub name: String,
    /// Median over the flights, s after the reference; none if it never does in half of them.
    pub median_s: Option<f64>,
    /// Flights in which it never does.
    pub never: usize,
}

/// A count over a time.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Counted {
    /// How many.
    pub count: usize,
    /// Per ten minutes of flight.
    pub per_ten_minutes: f64,
}

/// Changes of the parameters.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Detection {
    /// Flights with damage.
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
