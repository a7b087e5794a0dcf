//! The outcome of one entry: plain data, without a word on how it is drawn.
//!
//! Numbers are SI and radians unless the unit beside them says otherwise. A number that does not exist is NaN (`null` in
//! JSON).

use phugoid_evaluation::chart::{Chart, Meaning};
use phugoid_evaluation::table::Table;
use serde::Serialize;

/// One case or study, with everything that the report shows of it.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Reproduction {
    /// Id of the case or study, for instance `second-order/3`.
    pub id: String,
    /// What it is, in a few words.
    pub title: String,
    /// Where it was published, e.g. `table 4.3, case 3`.
    pub place: String,
    /// What the thesis says came out of it.
    pub published: String,
    /// What of it is reconstructed.
    pub reconstruction: String,
    /// What differs in our result, and why.
    pub difference: String,
    /// What each method did, in the order to be shown.
    pub outcomes: Vec<Outcome>,
    /// What had to be shown, and whether it was.
    pub requirements: Vec<Requirement>,
    /// Tables, in the order in which they are shown.
    pub tables: Vec<Table>,
    /// Figures, in the order in which they are shown.
    pub charts: Vec<Chart>,
    /// The few numbers that are committed and compared, so that a change of behaviour is seen as a difference: for a case some
    /// forty instants of its estimates, for a study its result. Deterministic; nothing chaotic (of a law that chatters or
    /// diverges only its verdict).
    pub golden: Table,
}

/// What one method did with the case.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Outcome {
    /// Method as printed, e.g. `printed law, implicit`.
    pub method: String,
    /// What the method is to the reader.
    pub role: Role,
    /// What became of its estimates.
    pub behaviour: Behaviour,
    /// The condition that decides it, with its numbers: `lambda h = 0.01 < 2; rests at theta eta/lambda`.
    pub condition: String,
    /// Its parameters in the plant's order.
    pub parameters: Vec<ParameterOutcome>,
}

/// What a method is to the reader.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Role {
    /// The estimator that this project recommends.
    Flagship,
    /// A law as it was published.
    Published,
    /// A published law with its defect mended.
    Mended,
    /// Another method of the field, to compare.
    Comparison,
}

/// What became of the estimates, all parameters together (the worst counts).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Behaviour {
    /// Within 5 % of the truth to stay.
    Converges,
    /// At rest, but not within 5 % of the truth.
    Biased,
    /// Neither at rest nor away: it keeps jumping about.
    Chatters,
    /// It leaves every bound, or stops being a number.
    Diverges,
    /// Still moving towards the truth when the record ends.
    Unfinished,
}

impl Behaviour {
    /// All of them, best first.
    pub const ALL: [Self; 5] = [Self::Converges, Self::Unfinished, Self::Biased, Self::Chatters, Self::Diverges];

    /// The behaviour in one word, as tables print it.
    pub fn word(self) -> &'static str {
        match self {
            Self::Converges => "converges",
            Self::Biased => "biased",
            Self::Chatters => "chatters",
            Self::Diverges => "diverges",
            Self::Unfinished => "unfinished",
        }
    }
}

/// What a method said of one parameter.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ParameterOutcome {
    /// Name, e.g. `a1` or `dCm_alpha`.
    pub name: String,
    /// True value of the parameter, in its unit.
    pub truth: f64,
    /// Estimate before the first sample, in the parameter's unit.
    pub start: f64,
    /// Estimate at the end of the record.
    pub end: f64,
    /// One-sigma error that the method claims at the end; none if it claims none.
    pub std_error: Option<f64>,
    /// Published time to 5 %, s from the start of the record; none if nothing was published.
    pub published_s: Option<f64>,
    /// First time after which the estimate stays within 5 % of the truth, s from the start of the record.
    pub converged_s: Option<f64>,
}

/// A time to converge as requirements say it, or that there is none.
pub(crate) fn in_seconds(time_s: Option<f64>) -> String {
    time_s.map_or_else(|| "never".to_owned(), |t| format!("{t:.2} s"))
}

/// Something that had to be shown.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Requirement {
    /// What, as a sentence: `a1 within 5 % no later than published`.
    pub what: String,
    /// The limit with its unit.
    pub limit: String,
    /// What was found, with its unit.
    pub found: String,
    /// Whether what was found satisfies the limit.
    pub met: bool,
}

/// What the curves of one of an entry's methods mean: the flagship's, or those of another method by its number.
///
/// `roles` are the roles of all methods in their order, `index` is that of the method asked for.
pub(crate) fn meaning_of_method(mut roles: impl Iterator<Item = Role>, index: usize) -> Meaning {
    let before = roles.by_ref().take(index).filter(|role| *role != Role::Flagship).count();
    if roles.next() == Some(Role::Flagship) { Meaning::Flagship } else { Meaning::Method(before) }
}
