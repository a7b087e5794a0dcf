//! What a figure says, without a word on how it is drawn.

use std::sync::Arc;

/// A figure: panels in rows and columns under one title, drawn as SVG or PNG with the same result.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Figure {
    /// Title, drawn above the legend.
    pub title: String,
    /// What to see in it, in a sentence or two; goes beside the figure in a page, and is not drawn.
    pub caption: String,
    /// Abscissa of all panels that do not have their own.
    pub x: Axis,
    /// Panels, filled row by row.
    pub panels: Vec<Panel>,
    /// Panels per row; 0 counts as 1.
    pub columns: usize,
    /// Instants marked by a vertical line through every plot panel on the common abscissa.
    pub events: Vec<EventMark>,
}

/// A quantity along an axis.
#[derive(Clone, Debug, Default, PartialEq)]
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
        self.range = (lower.is_finite() && upper.is_finite() && lower < upper).then_some([lower, upper]);
        self
    }
}

/// One panel of a figure.
#[derive(Clone, Debug, PartialEq)]
pub struct Panel {
    /// Ordinate. Its label and unit stand above the panel, where long names have room.
    pub y: Axis,
    /// Abscissa of this panel alone; the figure's where none.
    pub x: Option<Axis>,
    /// Height of the plot area, in px at a figure width of 960 px.
    pub height: f64,
    /// What is drawn.
    pub body: Body,
}

/// The content of a panel.
#[derive(Clone, Debug, PartialEq)]
pub enum Body {
    /// Curves and reference lines.
    Plot {
        /// Curves, first one lowest.
        series: Vec<Series>,
        /// Reference lines, beneath the curves.
        references: Vec<Reference>,
    },
    /// A coloured bar along the abscissa that shows which of a few states holds at each sample.
    Strip {
        /// Abscissa of each sample, increasing.
        x: Arc<[f64]>,
        /// Index into `states` for each sample.
        state: Vec<usize>,
        /// Names and colours; a later one is drawn over an earlier one, so that a single sample of it stays visible.
        states: Vec<(String, Colour)>,
    },
    /// A symmetric matrix with entries between -1 and 1 as coloured cells.
    Matrix {
        /// Names of rows and columns.
        labels: Vec<String>,
        /// Entries, row by row.
        values: Vec<Vec<f64>>,
    },
    /// A quantity over a grid.
    HeatMap(HeatMap),
    /// Named rows and columns as coloured cells with words in them: the only panel of its figure.
    Grid(Grid),
}

/// Named rows and columns as coloured cells with words in them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Grid {
    /// Names of the rows, from above.
    pub rows: Vec<String>,
    /// Names of the columns.
    pub columns: Vec<String>,
    /// Cells, one row per row name, one per column name in it.
    pub cells: Vec<Vec<Cell>>,
}

/// A cell of a grid.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Cell {
    /// What stands in it.
    pub words: String,
    /// From -1, orange and bad, over 0, plain, to 1, blue and good; NaN for a cell without a value.
    pub tone: f64,
    /// Whether the words are bold.
    pub strong: bool,
}

/// A quantity over a grid, as coloured cells of equal size beside a colour bar. Abscissa and ordinate are the panel's.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct HeatMap {
    /// Abscissa of each column of cells, printed below it.
    pub x: Vec<f64>,
    /// Ordinate of each row of cells from below, printed beside it.
    pub y: Vec<f64>,
    /// The quantity shown; its limits are those of the colours.
    pub value: Axis,
    /// Values, one row per `y`, one per `x` in it. Those that are not finite are hatched.
    pub values: Vec<Vec<f64>>,
    /// Colours in the logarithm of the value; values that are not positive are hatched then.
    pub logarithmic: bool,
    /// Legend entry of the hatched cells.
    pub absent: String,
    /// A cell to frame: its legend entry and its place, the nearest cell if it is not on the grid.
    pub marked: Option<(String, [f64; 2])>,
}

impl Panel {
    /// A plot panel of the usual height.
    pub fn plot(y: Axis, series: Vec<Series>) -> Self {
        Self { y, x: None, height: 120.0, body: Body::Plot { series, references: Vec::new() } }
    }

    /// The same panel with another height, px.
    pub fn with_height(mut self, height: f64) -> Self {
        self.height = height;
        self
    }

    /// The same panel with an abscissa of its own.
    pub fn with_x(mut self, x: Axis) -> Self {
        self.x = Some(x);
        self
    }

    /// The same panel with one more reference line (plots only; other panels stay as they are).
    pub fn with_reference(mut self, reference: Reference) -> Self {
        if let Body::Plot { references, .. } = &mut self.body {
            references.push(reference);
        }
        self
    }
}

/// A curve with its entry in the legend.
#[derive(Clone, Debug, PartialEq)]
pub struct Series {
    /// Legend entry; empty for none. Equal entries (label, colour, kind) of several panels appear once.
    pub label: String,
    /// Colour.
    pub colour: Colour,
    /// How its line is drawn, where it has one.
    pub stroke: Stroke,
    /// Whether a line runs on over an abscissa without samples; else it breaks there, as in a record with a gap.
    pub joined: bool,
    /// Abscissa, ascending except for curves and trajectories.
    pub x: Arc<[f64]>,
    /// Shape and ordinates.
    pub kind: Kind,
}

/// How a series is drawn. Ordinates that are not finite interrupt it.
#[derive(Clone, Debug, PartialEq)]
pub enum Kind {
    /// Straight lines between samples.
    Line(Vec<f64>),
    /// Each value holds until the next sample.
    Step(Vec<f64>),
    /// One dot per sample.
    Points(Vec<f64>),
    /// One large dot per sample, for the few that deserve a look.
    Marks(Vec<f64>),
    /// Vertical bars from zero.
    Bars(Vec<f64>),
    /// The area between two curves.
    Band {
        /// Lower curve.
        lower: Vec<f64>,
        /// Upper curve.
        upper: Vec<f64>,
    },
    /// Straight lines between samples in any order of abscissa.
    Curve(Vec<f64>),
    /// As [`Kind::Curve`], thinner, with a dot at the end: the path of something.
    Trajectory(Vec<f64>),
}

impl Series {
    /// A series; samples beyond the shorter of abscissa and ordinates are not drawn.
    pub fn new(label: impl Into<String>, colour: Colour, x: &Arc<[f64]>, kind: Kind) -> Self {
        Self { label: label.into(), colour, stroke: Stroke::Solid, joined: false, x: Arc::clone(x), kind }
    }

    /// The same series with another stroke.
    pub fn with_stroke(mut self, stroke: Stroke) -> Self {
        self.stroke = stroke;
        self
    }

    /// The same series with lines that run on where samples are far apart.
    pub fn joined(mut self) -> Self {
        self.joined = true;
        self
    }
}

/// How a line is drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Stroke {
    /// Without gaps.
    #[default]
    Solid,
    /// Dashes.
    Dashed,
    /// Dots.
    Dotted,
    /// A dash and a dot in turn.
    DashDotted,
}

/// A straight reference line.
#[derive(Clone, Debug, PartialEq)]
pub struct Reference {
    /// Legend entry; empty for none.
    pub label: String,
    /// Colour.
    pub colour: Colour,
    /// Stroke.
    pub stroke: Stroke,
    /// Where.
    pub at: At,
    /// Drawn over the curves instead of under them; a dashed one lets them shine through.
    pub on_top: bool,
}

/// Position of a reference line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum At {
    /// A horizontal line at this ordinate; the ordinate's limits are widened to show it.
    Horizontal(f64),
    /// A horizontal line that is drawn only if it lies within limits set by everything else.
    HorizontalIfVisible(f64),
    /// A vertical line at this abscissa.
    Vertical(f64),
}

/// An instant marked across the whole figure.
#[derive(Clone, Debug, PartialEq)]
pub struct EventMark {
    /// Abscissa.
    pub x: f64,
    /// Legend entry; equal ones appear once.
    pub label: String,
    /// Colour.
    pub colour: Colour,
}

/// Colours by role: eight that people with any kind of colour vision can tell apart (Okabe and Ito 2008, Color
/// Universal Design), and two greys.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Colour {
    /// Text and measured data.
    Ink,
    /// Secondary text, axes, plain reference lines.
    Muted,
    /// Blue.
    Blue,
    /// Orange.
    Orange,
    /// Bluish green.
    Green,
    /// Vermillion.
    Vermillion,
    /// Reddish purple.
    Purple,
    /// Sky blue.
    Sky,
    /// Yellow; for areas, too faint for lines.
    Yellow,
    /// Grid lines.
    Grid,
    /// Text on strongly coloured areas.
    OnColour,
    /// Text on dark areas.
    OnDark,
    /// A step of the scale of heat maps, dark to light, the same in light and dark pages: Cividis, in equal steps for the
    /// eye with any kind of colour vision (Nuñez, Anderton and Renslow 2018, PLoS ONE 13(7)).
    Scale(u8),
}

/// Colours for several curves of equal rank in one panel, in this order; repeats after the last.
pub const LINE_COLOURS: [Colour; 6] =
    [Colour::Blue, Colour::Vermillion, Colour::Green, Colour::Purple, Colour::Orange, Colour::Sky];
