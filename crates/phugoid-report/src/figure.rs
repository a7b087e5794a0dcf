//! What a figure shows, as plain data: panels, axes, curves and colours. How it is drawn is decided elsewhere.

use std::sync::Arc;

/// A figure: panels in rows and columns under one title. SVG and PNG show the same.
///
/// ```
/// use std::sync::Arc;
///
/// use phugoid_report::Figure;
/// use phugoid_report::figure::{Axis, Colour, EventMark, SeriesKind, Panel, Series};
///
/// let time_s: Arc<[f64]> = Arc::from([0.0, 1.0, 2.0]);
/// let elevator = Series::new("commanded", Colour::Blue, &time_s, SeriesKind::Step(vec![0.0, -2.0, 0.0]));
/// let figure = Figure {
///     title: "Pull-up <1>".to_owned(),
///     x: Axis::new("Time", "s"),
///     panels: vec![Panel::plot(Axis::new("Elevator", "deg"), vec![elevator])],
///     columns: 1,
///     events: vec![EventMark { x: 1.0, label: "gust".to_owned(), colour: Colour::Orange }],
///     ..Figure::default()
/// };
/// let svg = figure.to_svg();
/// // Text is escaped, and every label appears.
/// assert!(svg.contains(">Pull-up &lt;1&gt;</text>") && svg.contains(">gust</text>"));
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Figure {
    /// Title, drawn above the legend.
    pub title: String,
    /// What the reader should see in the figure, in a sentence or two. It stands below the figure in a page and is not
    /// drawn.
    pub caption: String,
    /// Abscissa of all panels that have no abscissa of their own.
    pub x: Axis,
    /// Panels, row by row from the top, each row from the left.
    pub panels: Vec<Panel>,
    /// Number of panels in a row; 0 counts as 1.
    pub columns: usize,
    /// Instants that are marked by a vertical line through every panel with the common abscissa.
    pub events: Vec<EventMark>,
}

/// A quantity along an axis.
///
/// Tick labels are at multiples of 1, 2 or 5 times a power of ten, and have as many decimals as the step needs:
///
/// ```
/// use std::sync::Arc;
///
/// use phugoid_report::Figure;
/// use phugoid_report::figure::{Axis, Colour, SeriesKind, Panel, Series};
///
/// let x: Arc<[f64]> = Arc::from([0.0, 10.0]);
/// let line = Series::new("", Colour::Ink, &x, SeriesKind::Line(vec![-0.31, 0.12]));
/// let y = Axis::new("Cm", "–").with_range(-0.31, 0.12);
/// let figure = Figure { panels: vec![Panel::plot(y, vec![line])], ..Figure::default() };
/// let svg = figure.to_svg();
/// assert!(svg.contains(">−0.2</text>") && svg.contains(">0.1</text>") && !svg.contains(">−0.4</text>"));
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Axis {
    /// Name of the quantity, such as `Time`.
    pub label: String,
    /// Unit as it is printed, such as `s`; `–` for a pure number; empty for none.
    pub unit: String,
    /// Lower and upper limit; `None` takes them from the data.
    pub range: Option<[f64; 2]>,
}

impl Axis {
    /// An axis whose limits follow from the data.
    pub fn new(label: impl Into<String>, unit: impl Into<String>) -> Self {
        Self { label: label.into(), unit: unit.into(), range: None }
    }

    /// The same axis with fixed limits. Curves are cut off there. Limits that are not finite or not ascending are
    /// ignored.
    pub fn with_range(mut self, lower: f64, upper: f64) -> Self {
        self.range = (lower.is_finite() && upper.is_finite() && lower < upper).then_some([lower, upper]);
        self
    }
}

/// One panel of a figure.
#[derive(Clone, Debug, PartialEq)]
pub struct Panel {
    /// Ordinate. Its label and unit are printed above the panel, where there is room for long names.
    pub y: Axis,
    /// Abscissa of this panel; `None` takes that of the figure.
    pub x: Option<Axis>,
    /// Height of the plot area, px. A figure is 960 px wide.
    pub height: f64,
    /// What is drawn in the plot area.
    pub body: Body,
}

/// What is drawn in the plot area of a panel.
#[derive(Clone, Debug, PartialEq)]
pub enum Body {
    /// Curves and reference lines against the abscissa.
    Plot {
        /// Curves; later ones are drawn over earlier ones, but bands are always drawn first.
        series: Vec<Series>,
        /// Reference lines, which are drawn under the curves unless they ask for the top.
        references: Vec<Reference>,
    },
    /// A coloured bar along the abscissa that shows which of a few states holds at each sample.
    Strip {
        /// Abscissa of each sample; it has to increase.
        x: Arc<[f64]>,
        /// For each sample the index of its state in `states`.
        state: Vec<usize>,
        /// Name and colour of each state. Later ones are drawn over earlier ones, so rare states should come last.
        states: Vec<(String, Colour)>,
    },
    /// A symmetric matrix with entries between -1 and 1 as coloured cells. It has to be the only panel of its figure.
    Matrix {
        /// Names of the rows, which are those of the columns too.
        labels: Vec<String>,
        /// Entries, row by row. The diagonal is not shown; an entry that is not finite is a dash.
        values: Vec<Vec<f64>>,
    },
    /// A quantity over two others, as coloured cells.
    HeatMap(HeatMap),
    /// A table of coloured cells with words. It has to be the only panel of its figure.
    Grid(Grid),
}

/// A table of coloured cells with words in them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Grid {
    /// Names of the rows, from the top.
    pub rows: Vec<String>,
    /// Names of the columns, from the left.
    pub columns: Vec<String>,
    /// Cells: one row for each row name, and in it one cell for each column name. A missing cell is drawn empty.
    pub cells: Vec<Vec<Cell>>,
}

/// A cell of a [`Grid`].
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Cell {
    /// Text in the middle of the cell.
    pub words: String,
    /// Colour: -1 is orange (bad), 0 is plain, 1 is blue (good); between them the colour is fainter. NaN is a cell
    /// without a value.
    pub tone: f64,
    /// Whether the text is bold.
    pub strong: bool,
}

/// A quantity over two others, as coloured cells of equal size with a colour bar. The labels of abscissa and ordinate
/// are those of the panel.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct HeatMap {
    /// Abscissa of each column of cells, which is printed below it.
    pub x: Vec<f64>,
    /// Ordinate of each row of cells from the bottom, which is printed beside it.
    pub y: Vec<f64>,
    /// The quantity that the colours show; its limits are those of the colour bar.
    pub value: Axis,
    /// Values: one row for each `y`, and in it one value for each `x`. Cells with a value that is not finite are
    /// hatched.
    pub values: Vec<Vec<f64>>,
    /// Whether the colours follow the logarithm of the value. Cells with a value that is not positive are then hatched.
    pub logarithmic: bool,
    /// Legend entry of the hatched cells.
    pub absent: String,
    /// A cell to be framed: its legend entry, and abscissa and ordinate of the place. The nearest cell is taken.
    pub marked: Option<(String, [f64; 2])>,
}

impl Panel {
    /// A panel with curves, 120 px high, without reference lines.
    pub fn plot(y: Axis, series: Vec<Series>) -> Self {
        Self { y, x: None, height: 120.0, body: Body::Plot { series, references: Vec::new() } }
    }

    /// The same panel with another height of its plot area, px.
    pub fn with_height(mut self, height: f64) -> Self {
        self.height = height;
        self
    }

    /// The same panel with an abscissa of its own.
    pub fn with_x(mut self, x: Axis) -> Self {
        self.x = Some(x);
        self
    }

    /// The same panel with one more reference line. A panel that is no plot stays as it is.
    pub fn with_reference(mut self, reference: Reference) -> Self {
        if let Body::Plot { references, .. } = &mut self.body {
            references.push(reference);
        }
        self
    }
}

/// A curve with its entry in the legend.
///
/// Long records are thinned out when they are drawn, but every spike stays visible:
///
/// ```
/// use std::sync::Arc;
///
/// use phugoid_report::Figure;
/// use phugoid_report::figure::{Axis, Colour, SeriesKind, Panel, Series};
///
/// let x: Arc<[f64]> = (0..200_000).map(f64::from).collect();
/// let draw = |spike: f64| {
///     let mut y = vec![0.0; x.len()];
///     y[123_456] = spike;
///     let line = Series::new("", Colour::Blue, &x, SeriesKind::Line(y));
///     let panel = Panel::plot(Axis::new("y", "").with_range(-1.0, 1.0), vec![line]);
///     Figure { panels: vec![panel], ..Figure::default() }.to_svg()
/// };
/// let (flat, spiked) = (draw(0.0), draw(0.9));
/// assert!(spiked.len() < 10_000, "{} bytes for 200,000 samples", spiked.len());
/// assert_ne!(flat, spiked);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Series {
    /// Legend entry; empty for none. Entries with equal label, colour and kind appear only once in a figure.
    pub label: String,
    /// Colour of line, dots or area.
    pub colour: Colour,
    /// Stroke of the line, if the kind has one.
    pub stroke: Stroke,
    /// Whether a line goes on over a gap in the abscissa. If false, it is interrupted where a step is longer than six
    /// median steps, as in a record with missing data.
    pub joined: bool,
    /// Abscissa. It has to ascend, except for curves and trajectories.
    pub x: Arc<[f64]>,
    /// How the series is drawn, with its ordinates.
    pub kind: SeriesKind,
}

/// How a series is drawn, with its ordinates, one for each abscissa. Ordinates that are not finite interrupt it.
#[derive(Clone, Debug, PartialEq)]
pub enum SeriesKind {
    /// Straight lines from sample to sample.
    Line(Vec<f64>),
    /// Steps: each value is valid until the next sample.
    Step(Vec<f64>),
    /// One small dot for each sample.
    Points(Vec<f64>),
    /// One large dot for each sample, where there are only a few.
    Marks(Vec<f64>),
    /// A vertical bar from zero for each sample.
    Bars(Vec<f64>),
    /// The area between two curves, such as a 2-sigma band.
    Band {
        /// Ordinates of the lower curve.
        lower: Vec<f64>,
        /// Ordinates of the upper curve.
        upper: Vec<f64>,
    },
    /// Straight lines between samples whose abscissas may have any order.
    Curve(Vec<f64>),
    /// As [`SeriesKind::Curve`], but thinner and with a dot at the end, such as the path of an estimate in the plane of two
    /// parameters.
    Trajectory(Vec<f64>),
}

impl Series {
    /// A series with a solid stroke. If abscissa and ordinates differ in length, the samples beyond the shorter one are
    /// not drawn.
    pub fn new(label: impl Into<String>, colour: Colour, x: &Arc<[f64]>, kind: SeriesKind) -> Self {
        Self { label: label.into(), colour, stroke: Stroke::Solid, joined: false, x: Arc::clone(x), kind }
    }

    /// The same series with another stroke.
    pub fn with_stroke(mut self, stroke: Stroke) -> Self {
        self.stroke = stroke;
        self
    }

    /// The same series with lines that go on where samples are far apart.
    pub fn joined(mut self) -> Self {
        self.joined = true;
        self
    }
}

/// How a line is drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Stroke {
    /// An uninterrupted line, without dashes.
    #[default]
    Solid,
    /// A line of dashes only.
    Dashed,
    /// A line of dots only.
    Dotted,
    /// A line of dashes and dots in turn.
    DashDotted,
}

/// A straight reference line, such as a limit or the true value.
#[derive(Clone, Debug, PartialEq)]
pub struct Reference {
    /// Legend entry; empty for none.
    pub label: String,
    /// Colour of line and legend entry.
    pub colour: Colour,
    /// Whether the line is solid, dashed or dotted.
    pub stroke: Stroke,
    /// Whether the line is horizontal or vertical, and where.
    pub at: At,
    /// Whether the line is drawn over the curves instead of under them. It should be dashed then, so that they stay
    /// visible.
    pub on_top: bool,
}

/// Direction and place of a reference line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum At {
    /// A horizontal line at this ordinate. Limits that follow from the data are widened to show it.
    Horizontal(f64),
    /// A horizontal line at this ordinate, which is drawn only if it lies within the limits of everything else.
    HorizontalIfVisible(f64),
    /// A vertical line at this abscissa, which is drawn only if it lies within the limits.
    Vertical(f64),
}

/// An instant that is marked across the whole figure.
#[derive(Clone, Debug, PartialEq)]
pub struct EventMark {
    /// Abscissa of the instant, in the unit of the axis.
    pub x: f64,
    /// Legend entry; equal ones appear only once.
    pub label: String,
    /// Colour of the vertical line.
    pub colour: Colour,
}

/// Colours by role: eight that people with any kind of colour vision can tell apart (Okabe and Ito 2008, Color
/// Universal Design), and two greys.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Colour {
    /// Near black: text and measured data.
    Ink,
    /// Grey: secondary text, axes, plain reference lines.
    Muted,
    /// Blue of Okabe and Ito.
    Blue,
    /// Orange of Okabe and Ito.
    Orange,
    /// Bluish green of Okabe and Ito.
    Green,
    /// Vermillion of Okabe and Ito.
    Vermillion,
    /// Reddish purple of Okabe and Ito.
    Purple,
    /// Sky blue of Okabe and Ito.
    Sky,
    /// Yellow of Okabe and Ito. It is too faint for lines; use it for areas.
    Yellow,
    /// Light grey: grid lines and empty cells.
    Grid,
    /// Dark text on strongly coloured areas, also in a dark page.
    OnColour,
    /// White text on dark areas.
    OnDark,
    /// A step of the colour scale of heat maps, from 0 (dark) to 255 (light), the same in light and dark pages. The
    /// scale is Cividis, whose steps look equal with any kind of colour vision (Nuñez, Anderton and Renslow 2018, PLoS
    /// ONE 13(7)).
    Scale(u8),
}

/// Colours for several curves in one panel, in the order in which they are to be used.
pub const LINE_COLOURS: [Colour; 6] =
    [Colour::Blue, Colour::Vermillion, Colour::Green, Colour::Purple, Colour::Orange, Colour::Sky];
