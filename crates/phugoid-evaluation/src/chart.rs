//! A figure of results: plain data, without a word on how it is drawn.

use std::sync::Arc;

use serde::Serialize;

/// A figure: panels below one another (or in `columns`) under one title.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Chart {
    /// Name for files, unique within the entry, e.g. `estimates`.
    pub name: String,
    /// Title of the figure, printed above its panels.
    pub title: String,
    /// What to see in it, in a sentence or two.
    pub caption: String,
    /// The horizontal axis, which all panels share.
    pub x: Axis,
    /// The panels, row by row from the top left.
    pub panels: Vec<Panel>,
    /// Panels per row; 0 counts as 1.
    pub columns: usize,
}

/// A quantity along an axis.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Axis {
    /// Name of the quantity without its unit, for instance `Time`.
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

/// One panel of a figure: a vertical axis and what is drawn above the shared horizontal one.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Panel {
    /// The vertical axis of the panel.
    pub y: Axis,
    /// The curves or the map that the panel shows.
    pub content: Content,
}

/// What a panel shows: curves, or a map of coloured cells.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Content {
    /// Curves over the chart's abscissa.
    Curves {
        /// The curves; each is drawn over those before it.
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

/// A curve with its legend entry.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Curve {
    /// Text of the curve in the legend.
    pub label: String,
    /// What it is; decides colour and stroke.
    pub meaning: Meaning,
    /// Values along the horizontal axis, one per sample, in the unit of [`Chart::x`].
    pub x: Arc<[f64]>,
    /// How the samples are joined, with their values along the vertical axis.
    pub shape: Shape,
}

/// What a curve stands for; the drawing chooses colour and stroke by it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Meaning {
    /// The truth: a true parameter, the reference aircraft.
    Truth,
    /// A measured signal, as it comes from a sensor.
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

/// Shape and ordinates of a curve. Ordinates that are not finite interrupt it.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Shape {
    /// Values at the samples, joined by straight lines.
    Line(Vec<f64>),
    /// Each value holds until the next sample.
    Step(Vec<f64>),
    /// Values at the samples, one dot each, not joined.
    Points(Vec<f64>),
    /// The area between two curves.
    Band {
        /// Values of the lower curve at the samples.
        lower: Vec<f64>,
        /// Values of the upper curve at the samples.
        upper: Vec<f64>,
    },
}

/// A straight line across a panel.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Level {
    /// Legend entry; empty for none.
    pub label: String,
    /// Position of the line, in the unit of the axis that it crosses.
    pub at: f64,
    /// What it is; decides colour and stroke.
    pub meaning: Meaning,
}

impl Level {
    /// A line at `at` (unit of the axis that it crosses) with this legend entry; an empty one is not listed.
    pub fn new(label: impl Into<String>, at: f64, meaning: Meaning) -> Self {
        Self { label: label.into(), at, meaning }
    }
}
