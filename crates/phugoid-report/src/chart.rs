//! Charts of a reproduction as figures: what a curve means decides how it looks.

use phugoid_evaluation::chart::{self, Chart, Content, Curve, Level, Meaning};

use crate::figure::{At, Axis, Body, Figure, HeatMap, Kind, Panel, Reference, Series};

mod limits;
mod looks;

use looks::{Form, Looks};

/// Most points of a series whose dots are drawn large.
const FEW: usize = 150;

/// The figure of a chart. Equal meanings have equal colours in every chart; where several legend entries of one chart mean
/// the same, their strokes differ.
pub fn chart_figure(chart: &Chart) -> Figure {
    let mut looks = Looks::default();
    let columns = chart.columns.max(1);
    let rows = chart.panels.len().div_ceil(columns);
    let mut cut = false;
    let panels = chart.panels.iter().map(|panel| {
        let (body, y) = match &panel.content {
            Content::Curves { curves, levels, instants } => {
                let range = limits::ordinate(chart, panel);
                cut |= range.is_some_and(|range| limits::leaves(curves, range));
                (plot(&mut looks, curves, levels, instants), Axis { range, ..axis(&panel.y) })
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

fn plot(looks: &mut Looks, curves: &[Curve], levels: &[Level], instants: &[Level]) -> Body {
    // The truth lies on top: it is dashed, and what has reached it shines through.
    let truth = |curve: &&Curve| curve.meaning == Meaning::Truth;
    let ordered = curves.iter().filter(|c| !truth(c)).chain(curves.iter().filter(truth));
    let series = ordered.map(|curve| series(looks, curve)).collect();
    let mut references: Vec<Reference> =
        levels.iter().map(|level| reference(looks, level, Form::Level, At::Horizontal(level.at))).collect();
    references.extend(instants.iter().map(|level| reference(looks, level, Form::Instant, At::Vertical(level.at))));
    Body::Plot { series, references }
}

fn series(looks: &mut Looks, curve: &Curve) -> Series {
    let (form, kind) = match &curve.shape {
        chart::Shape::Line(y) if limits::ascending(&curve.x) => (Form::Line, Kind::Line(y.clone())),
        chart::Shape::Line(y) => (Form::Line, Kind::Curve(y.clone())),
        chart::Shape::Step(y) => (Form::Line, Kind::Step(y.clone())),
        // Few points are looked at one by one.
        chart::Shape::Points(y) if y.len() <= FEW => (Form::Points, Kind::Marks(y.clone())),
        chart::Shape::Points(y) => (Form::Points, Kind::Points(y.clone())),
        chart::Shape::Band { lower, upper } => (Form::Band, Kind::Band { lower: lower.clone(), upper: upper.clone() }),
    };
    let (colour, stroke) = looks.of(&curve.label, curve.meaning, form);
    Series::new(curve.label.clone(), colour, &curve.x, kind).with_stroke(stroke).joined()
}

fn reference(looks: &mut Looks, level: &Level, form: Form, at: At) -> Reference {
    let (colour, stroke) = looks.of(&level.label, level.meaning, form);
    // An instant is no truth to be compared with.
    let on_top = level.meaning == Meaning::Truth && form == Form::Level;
    Reference { label: level.label.clone(), colour, stroke, at, on_top }
}
