//! The outcome of one entry: plain data, without a word on how it is drawn.
//!
//! Numbers are SI and radians unless the unit beside them says otherwise. A number that does not exist is NaN (`null` in
//! JSON).

use std::sync::Arc;

use serde::Serialize;

/// One case or study, with everything that the report shows of it.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Reproduction {
    /// Id, e.g. `second-order/3`.
    pub id: String,
    /// What it is, in a few words.
    pub title: String,
    /// Where it was published, e.g. `table 4.3, case 3`.
    pub place: String,
    /// What was published.
    pub published: String,
    /// What of it is reconstructed.
    pub reconstruction: String,
    /// What differs in our result, and why.
    pub difference: String,
    /// What each method did, in the order to be shown.
    pub outcomes: Vec<Outcome>,
    /// What had to be shown, and whether it was.
    pub requirements: Vec<Requirement>,
    /// Tables.
    pub tables: Vec<Table>,
    /// Figures.
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

    /// In one word.
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
    /// True value.
    pub truth: f64,
    /// Start value.
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
pub(super) fn in_seconds(time_s: Option<f64>) -> String {
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
    /// Whether that is enough.
    pub met: bool,
}

/// A table.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Table {
    /// What it shows.
    pub title: String,
    /// Columns.
    pub columns: Vec<Column>,
    /// Rows, each with one cell per column.
    pub rows: Vec<Vec<Cell>>,
}

/// A column of a table.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Column {
    /// Name.
    pub name: String,
    /// Unit as printed; empty for words and pure numbers.
    pub unit: String,
}

impl Column {
    /// A column.
    pub fn new(name: impl Into<String>, unit: impl Into<String>) -> Self {
        Self { name: name.into(), unit: unit.into() }
    }
}

/// A cell of a table.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum Cell {
    /// A number, in the unit of its column; NaN prints as a dash.
    Number(f64),
    /// Words.
    Text(String),
}

impl From<f64> for Cell {
    fn from(value: f64) -> Self {
        Self::Number(value)
    }
}

impl From<Option<f64>> for Cell {
    fn from(value: Option<f64>) -> Self {
        Self::Number(value.unwrap_or(f64::NAN))
    }
}

impl From<&str> for Cell {
    fn from(text: &str) -> Self {
        Self::Text(text.to_owned())
    }
}

impl From<String> for Cell {
    fn from(text: String) -> Self {
        Self::Text(text)
    }
}

/// A figure: panels below one another (or in `columns`) under one title.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Chart {
    /// Name for files, unique within the entry, e.g. `estimates`.
    pub name: String,
    /// Title.
    pub title: String,
    /// What to see in it, in a sentence or two.
    pub caption: String,
    /// Abscissa of all panels.
    pub x: Axis,
    /// Panels.
    pub panels: Vec<Panel>,
    /// Panels per row; 0 counts as 1.
    pub columns: usize,
}

/// A quantity along an axis.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Axis {
    /// Quantity, e.g. `Time`.
    pub label: String,
    /// Unit as printed, e.g. `s`; `–` for a pure number.
    pub unit: String,
    /// Limits; from the data where none.
    pub range: Option<[f64; 2]>,
}

impl Axis {
    /// An axis whose limits follow from the data.
    pub fn new(label: impl Into<String>, unit: impl Into<String>) -> Self {
        Self { label: label.into(), unit: unit.into(), range: None }
    }

    /// The same axis with fixed limits; what lies outside is cut off.
    pub fn with_range(mut self, lower: f64, upper: f64) -> Self {
        self.range = Some([lower, upper]);
        self
    }
}

/// One panel.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Panel {
    /// Ordinate.
    pub y: Axis,
    /// What is drawn.
    pub content: Content,
}

/// What a panel shows.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Content {
    /// Curves over the chart's abscissa.
    Curves {
        /// Curves, first one lowest.
        curves: Vec<Curve>,
        /// Horizontal lines: a published value, a threshold.
        levels: Vec<Level>,
        /// Vertical lines: a published time, the start of the input, a failure.
        instants: Vec<Level>,
    },
    /// A quantity over a grid, as coloured cells. The panel's ordinate is that of the grid.
    Map {
        /// Grid along the chart's abscissa, increasing; cells are drawn of equal width, labelled by these values.
        x: Vec<f64>,
        /// Grid along the panel's ordinate, increasing.
        y: Vec<f64>,
        /// The quantity shown: label, unit, limits of the colour scale.
        value: Axis,
        /// Values, one row per `y`, one per `x` in it; NaN where it does not exist (`absent` says what that means).
        values: Vec<Vec<f64>>,
        /// Colour scale in the logarithm of the value.
        logarithmic: bool,
        /// Meaning of NaN in the legend, e.g. `not within 5 %`.
        absent: String,
        /// A point of the grid to mark: the settings of the case (reconstructed where the text has lost them).
        marked: Option<[f64; 2]>,
    },
}

/// A curve.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Curve {
    /// Legend entry.
    pub label: String,
    /// What it is; decides colour and stroke.
    pub meaning: Meaning,
    /// Abscissa.
    pub x: Arc<[f64]>,
    /// Shape and ordinates.
    pub shape: Shape,
}

/// What a curve is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Meaning {
    /// The truth: a true parameter, the reference aircraft.
    Truth,
    /// A measurement.
    Measured,
    /// A command or an input.
    Command,
    /// A bound or a limit.
    Bound,
    /// The flagship's estimate, or the aircraft that flies with it.
    Flagship,
    /// Another method's, counted from zero; equal numbers are equal methods throughout an entry.
    Method(usize),
}

impl Meaning {
    /// Of the curves of one of an entry's methods; `roles` are those of all of them in their order.
    pub fn of_method(mut roles: impl Iterator<Item = Role>, index: usize) -> Self {
        let before = roles.by_ref().take(index).filter(|role| *role != Role::Flagship).count();
        if roles.next() == Some(Role::Flagship) { Self::Flagship } else { Self::Method(before) }
    }
}

/// Shape and ordinates of a curve. Ordinates that are not finite interrupt it.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Shape {
    /// Straight lines between samples.
    Line(Vec<f64>),
    /// Each value holds until the next sample.
    Step(Vec<f64>),
    /// One dot per sample.
    Points(Vec<f64>),
    /// The area between two curves.
    Band {
        /// Lower curve.
        lower: Vec<f64>,
        /// Upper curve.
        upper: Vec<f64>,
    },
}

/// A straight line across a panel.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Level {
    /// Legend entry; empty for none.
    pub label: String,
    /// Where.
    pub at: f64,
    /// What it is; decides colour and stroke.
    pub meaning: Meaning,
}

impl Level {
    /// A line.
    pub fn new(label: impl Into<String>, at: f64, meaning: Meaning) -> Self {
        Self { label: label.into(), at, meaning }
    }
}
