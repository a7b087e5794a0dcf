//! Charts of a reproduction as figures. The meaning of a curve decides its colour and stroke.

use phugoid_evaluation::chart::{self, Chart, Content, Curve, Level, Meaning};

use crate::figure::{At, Axis, Body, Figure, HeatMap, Panel, Reference, Series, SeriesKind};

mod limits;
mod styles;

use styles::{Form, Styles};

/// Series with at most so many points are drawn with large dots.
const LARGE_DOTS: usize = 150;

/// The figure of a chart. Equal meanings have equal colours in every chart. If several legend entries of one chart have
/// the same meaning, their strokes differ. A panel in which a method leaves the range of all others by far is cut off,
/// and the caption says so.
///
/// ```
/// use phugoid_report::chart_figure;
/// use phugoid_evaluation::chart::{Axis, Chart, Content, Curve, Meaning, Panel, Shape};
///
/// let truth = Curve {
///     label: "truth".to_owned(),
///     meaning: Meaning::Truth,
///     x: [0.0, 1.0].into(),
///     shape: Shape::Line(vec![8.0, 8.0]),
/// };
/// let content = Content::Curves { curves: vec![truth], levels: vec![], instants: vec![] };
/// let chart = Chart {
///     name: "estimate".to_owned(),
///     title: "Estimate of a1".to_owned(),
///     caption: String::new(),
///     x: Axis::new("Time", "s"),
///     panels: vec![Panel { y: Axis::new("a1", "1/s²"), content }],
///     columns: 1,
/// };
/// assert!(chart_figure(&chart).to_svg().contains(">a1 (1/s²)</text>"));
/// ```
pub fn chart_figure(chart: &Chart) -> Figure {
    let mut styles = Styles::default();
    let columns = chart.columns.max(1);
    let rows = chart.panels.len().div_ceil(columns);
    let mut cut = false;
    let panels = chart.panels.iter().map(|panel| {
        let (body, y) = match &panel.content {
            Content::Curves { curves, levels, instants } => {
                let range = limits::ordinate(chart, panel);
                cut |= range.is_some_and(|range| limits::leaves(curves, range));
                (plot(&mut styles, curves, levels, instants), Axis { range, ..axis(&panel.y) })
            }
            Content::Map { x, y, value, values, logarithmic, absent, marked } => {
                let map = HeatMap {
                    x: x.clone(),
                    y: y.clone(),
                    value: axis(value),
                    values: values.clone(),
                    logarithmic: *logarithmic,
                    absent: absent.clone(),
                    marked: marked.map(|place| ("settings of the case".to_owned(), place)),
                };
                (Body::HeatMap(map), axis(&panel.y))
            }
        };
        let height = match &body {
            Body::HeatMap(map) => (30.0 * map.y.len() as f64).clamp(150.0, 380.0),
            _ => [240.0, 170.0, 140.0].get(rows.saturating_sub(1)).copied().unwrap_or(120.0),
        };
        Panel { y, x: None, height, body }
    });
    let panels = panels.collect();
    let mut caption = chart.caption.clone();
    if cut {
        caption.push_str(" Curves that leave a panel are cut off there.");
    }
    Figure { title: chart.title.clone(), caption, x: axis(&chart.x), panels, columns, events: Vec::new() }
}

fn axis(axis: &chart::Axis) -> Axis {
    let plain = Axis::new(axis.label.clone(), axis.unit.clone());
    match axis.range {
        Some([lower, upper]) => plain.with_range(lower, upper),
        None => plain,
    }
}

fn plot(styles: &mut Styles, curves: &[Curve], levels: &[Level], instants: &[Level]) -> Body {
    // The truth is drawn last. It is dashed, so that curves that have reached it stay visible.
    let truth = |curve: &&Curve| curve.meaning == Meaning::Truth;
    let ordered = curves.iter().filter(|c| !truth(c)).chain(curves.iter().filter(truth));
    let series = ordered.map(|curve| series(styles, curve)).collect();
    let mut references: Vec<Reference> =
        levels.iter().map(|level| reference(styles, level, Form::Level, At::Horizontal(level.at))).collect();
    references.extend(instants.iter().map(|level| reference(styles, level, Form::Instant, At::Vertical(level.at))));
    Body::Plot { series, references }
}

fn series(styles: &mut Styles, curve: &Curve) -> Series {
    let (form, kind) = match &curve.shape {
        chart::Shape::Line(y) if limits::ascending(&curve.x) => (Form::Line, SeriesKind::Line(y.clone())),
        chart::Shape::Line(y) => (Form::Line, SeriesKind::Curve(y.clone())),
        chart::Shape::Step(y) => (Form::Line, SeriesKind::Step(y.clone())),
        // A few points are read one by one.
        chart::Shape::Points(y) if y.len() <= LARGE_DOTS => (Form::Points, SeriesKind::Marks(y.clone())),
        chart::Shape::Points(y) => (Form::Points, SeriesKind::Points(y.clone())),
        chart::Shape::Band { lower, upper } => {
            (Form::Band, SeriesKind::Band { lower: lower.clone(), upper: upper.clone() })
        }
    };
    let (colour, stroke) = styles.of(&curve.label, curve.meaning, form);
    Series::new(curve.label.clone(), colour, &curve.x, kind).with_stroke(stroke).joined()
}

fn reference(styles: &mut Styles, level: &Level, form: Form, at: At) -> Reference {
    let (colour, stroke) = styles.of(&level.label, level.meaning, form);
    // Only a level can be the truth with which curves are compared; an instant cannot.
    let on_top = level.meaning == Meaning::Truth && form == Form::Level;
    Reference { label: level.label.clone(), colour, stroke, at, on_top }
}
