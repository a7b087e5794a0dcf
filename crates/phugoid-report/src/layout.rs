//! Layout: from what a figure shows to shapes at their places.

use crate::clip::Frame;
use crate::figure::{At, Axis, Body, Colour, Figure, HeatMap, Panel, Reference, Series, SeriesKind, Stroke};
use crate::font::{Fonts, reserved_width};
use crate::legend::{self, Entry, Swatch};
use crate::lettering::{NORMAL, SMALL, axis_text, fitted, text};
use crate::plot_area::PlotArea;
use crate::scene::{Anchor, Scene, Shape, TimePlot, WIDTH};
use crate::ticks::{Ticks, ticks};
use crate::{curves, grid, heat_map, matrix};

/// Font size of the title, px.
const TITLE: f64 = 17.0;
/// Room to the right of the panels, px.
const RIGHT_MARGIN: f64 = 18.0;
/// Room between two columns of panels, px.
const COLUMN_GAP: f64 = 22.0;
/// Room above a panel for the label of its ordinate, px.
const LABEL_ROOM: f64 = 26.0;
/// Room below a panel without labels of its abscissa, px.
const ROW_GAP: f64 = 12.0;

/// The shapes of a figure, with its title or, for a page that shows the title itself, without.
pub(crate) fn scene(figure: &Figure, with_title: bool) -> Scene {
    // Only a damaged build has no font. Widths are then estimated here, and the writer of PNG returns an error.
    let fonts = Fonts::load().ok();
    let fonts = fonts.as_ref();
    if let [Panel { body: Body::Matrix { labels, values }, .. }] = figure.panels.as_slice() {
        return matrix::scene(fonts, with_title.then_some(figure.title.as_str()), labels, values);
    }
    if let [Panel { body: Body::Grid(cells), .. }] = figure.panels.as_slice() {
        return grid::scene(fonts, with_title.then_some(figure.title.as_str()), cells);
    }

    let mut scene = Scene { width: WIDTH, ..Scene::default() };
    let columns = figure.columns.max(1);
    let x_shared = shared_limits(figure);
    let plans: Vec<Plan> = figure.panels.iter().map(|panel| Plan::new(panel, figure, x_shared, fonts)).collect();

    let lefts: Vec<f64> = (0..columns)
        .map(|c| plans.iter().skip(c).step_by(columns).fold(30.0_f64, |m, plan| m.max(plan.tick_width + 12.0)))
        .collect();
    let room = WIDTH - RIGHT_MARGIN - lefts.iter().sum::<f64>() - COLUMN_GAP * (columns - 1) as f64;
    let plot_width = room / columns as f64;

    let mut top = 8.0;
    if with_title && !figure.title.is_empty() {
        top += TITLE;
        scene.shapes.push(text(&figure.title, [lefts[0], top], TITLE, Anchor::Start, true, Colour::Ink));
        top += 8.0;
    }
    top = legend::draw(&mut scene, fonts, &entries(figure), [lefts[0], top], WIDTH - RIGHT_MARGIN);

    for (row, panels) in plans.chunks(columns).enumerate() {
        let height = panels.iter().map(|p| p.panel.height).fold(10.0, f64::max);
        let frame_top = top + LABEL_ROOM;
        let mut below: f64 = ROW_GAP;
        let mut left = 0.0;
        for (column, plan) in panels.iter().enumerate() {
            left += lefts[column] + if column > 0 { COLUMN_GAP } else { 0.0 };
            let frame = Frame { left, top: frame_top, right: left + plot_width, bottom: frame_top + height };
            left += plot_width;
            let last_of_column = (row + 1) * columns + column >= plans.len();
            let labelled = plan.panel.x.is_some() || plan.heat_map().is_some() || last_of_column;
            plan.draw(&mut scene, figure, frame, labelled, fonts);
            if labelled {
                below = below.max(46.0);
            }
        }
        top = frame_top + height + below;
    }
    scene.height = top + if plans.is_empty() { 20.0 } else { 0.0 };
    scene
}

/// A panel with its limits and the ticks of its ordinate.
struct Plan<'a> {
    panel: &'a Panel,
    x_axis: &'a Axis,
    x: [f64; 2],
    y: [f64; 2],
    y_ticks: Ticks,
    /// Width of the widest label of the ordinate, px.
    tick_width: f64,
    /// There is nothing to draw.
    empty: bool,
}

impl<'a> Plan<'a> {
    fn new(panel: &'a Panel, figure: &'a Figure, x_shared: [f64; 2], fonts: Option<&Fonts>) -> Self {
        let x_axis = panel.x.as_ref().unwrap_or(&figure.x);
        let x = if panel.x.is_some() { own_limits(panel, x_axis) } else { x_shared };
        let (y, empty) = match &panel.body {
            Body::Plot { series, references } => ordinate_limits(&panel.y, series, references, x),
            Body::Strip { x, .. } => ([0.0, 1.0], x.is_empty()),
            Body::Matrix { .. } | Body::Grid(_) => ([0.0, 1.0], true),
            Body::HeatMap(map) => (heat_map::extent(&map.y), false),
        };
        let x = if let Body::HeatMap(map) = &panel.body { heat_map::extent(&map.x) } else { x };
        let y_ticks = match &panel.body {
            Body::Plot { .. } if !empty => ticks(y, ((panel.height / 30.0).round() as usize).clamp(2, 8)),
            Body::HeatMap(map) => heat_map::grid_ticks(&map.y, panel.height, |_| SMALL + 2.0),
            _ => Ticks { values: Vec::new(), labels: Vec::new(), exponent: 0 },
        };
        let tick_width = y_ticks.labels.iter().map(|l| reserved_width(fonts, l, SMALL, false)).fold(0.0, f64::max);
        Self { panel, x_axis, x, y, y_ticks, tick_width, empty }
    }

    fn heat_map(&self) -> Option<&HeatMap> {
        match &self.panel.body {
            Body::HeatMap(map) => Some(map),
            _ => None,
        }
    }

    fn draw(&self, scene: &mut Scene, figure: &Figure, mut frame: Frame, labelled: bool, fonts: Option<&Fonts>) {
        let label = axis_text(&self.panel.y, self.y_ticks.exponent);
        let (label, size) = fitted(fonts, label, [NORMAL, 12.0, 11.0, 10.0], true, frame.right - frame.left);
        scene.shapes.push(text(&label, [frame.left, frame.top - 8.0], size, Anchor::Start, true, Colour::Ink));

        let x_ticks = if let Some(map) = self.heat_map() {
            frame.right -= heat_map::BAR_ROOM;
            let needed = |label: &str| reserved_width(fonts, label, SMALL, false) + 8.0;
            heat_map::grid_ticks(&map.x, frame.right - frame.left, needed)
        } else {
            ticks(self.x, (((frame.right - frame.left) / 85.0) as usize).clamp(2, 12))
        };
        let map = PlotArea { x: self.x, y: self.y, frame };
        let first = scene.shapes.len();
        let mut grid = None;
        if self.heat_map().is_none() {
            grid = self.draw_grid(scene, &map, &x_ticks);
        }
        match &self.panel.body {
            _ if self.empty => {
                let middle = [(frame.left + frame.right) / 2.0, (frame.top + frame.bottom) / 2.0 + 4.0];
                scene.shapes.push(text("no data", middle, NORMAL, Anchor::Middle, false, Colour::Muted));
            }
            Body::Plot { series, references } => {
                for series in series.iter().filter(|s| matches!(s.kind, SeriesKind::Band { .. })) {
                    curves::draw(scene, &map, series);
                }
                for reference in references.iter().filter(|r| !r.on_top) {
                    draw_reference(scene, &map, reference);
                }
                self.draw_events(scene, figure, &map);
                for series in series.iter().filter(|s| !matches!(s.kind, SeriesKind::Band { .. })) {
                    curves::draw(scene, &map, series);
                }
                for reference in references.iter().filter(|r| r.on_top) {
                    draw_reference(scene, &map, reference);
                }
            }
            Body::Strip { x, state, states } => {
                curves::draw_strip(scene, &map, x, state, states);
                self.draw_events(scene, figure, &map);
            }
            Body::HeatMap(map) => heat_map::draw(scene, fonts, map, frame),
            Body::Matrix { .. } | Body::Grid(_) => {}
        }
        let inside = first..scene.shapes.len();
        let border = vec![vec![[frame.left, frame.top], [frame.left, frame.bottom], [frame.right, frame.bottom]]];
        scene.shapes.push(line(border, Colour::Muted, 1.0));

        for (value, label) in self.y_ticks.values.iter().zip(&self.y_ticks.labels) {
            let y = map.at([self.x[0], *value])[1];
            scene.shapes.push(text(label, [frame.left - 6.0, y + 4.0], SMALL, Anchor::End, false, Colour::Muted));
        }
        let first_label = scene.shapes.len();
        let mut labels = first_label..first_label;
        if labelled {
            for (value, label) in x_ticks.values.iter().zip(&x_ticks.labels) {
                let x = map.at([*value, self.y[0]])[0];
                scene.shapes.push(text(label, [x, frame.bottom + 16.0], SMALL, Anchor::Middle, false, Colour::Muted));
            }
            labels = first_label..scene.shapes.len();
            let label = axis_text(self.x_axis, x_ticks.exponent);
            let (label, size) = fitted(fonts, label, [SMALL, 11.0, 10.0], false, frame.right - frame.left);
            let middle = (frame.left + frame.right) / 2.0;
            scene.shapes.push(text(&label, [middle, frame.bottom + 33.0], size, Anchor::Middle, false, Colour::Ink));
        }
        // Labels in powers of ten would need their factor changed with the part that is shown.
        if self.is_over_time(x_ticks.exponent) {
            scene.time_plots.push(TimePlot { frame, time: self.x, inside, grid, labels });
        }
    }

    /// Whether this panel shows curves or states over the time, with labels that are plain numbers.
    fn is_over_time(&self, exponent: i32) -> bool {
        let has_course = matches!(self.panel.body, Body::Plot { .. } | Body::Strip { .. });
        has_course && !self.empty && self.panel.x.is_none() && exponent == 0 && self.x_axis.label == "Time"
    }

    /// Draws the lines at the ticks; gives the shape of those of the abscissa.
    fn draw_grid(&self, scene: &mut Scene, map: &PlotArea, x_ticks: &Ticks) -> Option<usize> {
        let frame = map.frame;
        let upright = x_ticks.values.iter().map(|v| map.at([*v, self.y[0]])[0]);
        let upright: Vec<_> = upright.map(|x| vec![[x, frame.top], [x, frame.bottom]]).collect();
        let level = self.y_ticks.values.iter().map(|v| map.at([self.x[0], *v])[1]);
        let level: Vec<_> = level.map(|y| vec![[frame.left, y], [frame.right, y]]).collect();
        if !level.is_empty() {
            scene.shapes.push(line(level, Colour::Grid, 1.0));
        }
        (!upright.is_empty()).then(|| {
            scene.shapes.push(line(upright, Colour::Grid, 1.0));
            scene.shapes.len() - 1
        })
    }

    fn draw_events(&self, scene: &mut Scene, figure: &Figure, map: &PlotArea) {
        if self.panel.x.is_some() {
            return;
        }
        // One shape for each colour and one line for each pixel, because a record may have a thousand gaps.
        let mut groups: Vec<(Colour, Vec<Vec<[f64; 2]>>)> = Vec::new();
        for event in figure.events.iter().filter(|e| e.x >= self.x[0] && e.x <= self.x[1]) {
            let x = map.at([event.x, self.y[0]])[0];
            let whole = vec![[x, map.frame.top], [x, map.frame.bottom]];
            match groups.iter_mut().find(|(colour, _)| *colour == event.colour) {
                Some((_, lines)) if lines.iter().any(|l| (l[0][0] - x).abs() < 1.0) => {}
                Some((_, lines)) => lines.push(whole),
                None => groups.push((event.colour, vec![whole])),
            }
        }
        for (colour, lines) in groups {
            scene.shapes.push(line(lines, colour, 1.2));
        }
    }
}

fn draw_reference(scene: &mut Scene, map: &PlotArea, reference: &Reference) {
    let frame = map.frame;
    let ends = match reference.at {
        At::Horizontal(value) | At::HorizontalIfVisible(value) => {
            let y = map.at([map.x[0], value])[1];
            if !(y >= frame.top && y <= frame.bottom) {
                return;
            }
            [[frame.left, y], [frame.right, y]]
        }
        At::Vertical(value) => {
            let x = map.at([value, map.y[0]])[0];
            if !(x >= frame.left && x <= frame.right) {
                return;
            }
            [[x, frame.top], [x, frame.bottom]]
        }
    };
    scene.shapes.push(Shape::Lines {
        lines: vec![ends.to_vec()],
        colour: reference.colour,
        width: 1.3,
        stroke: reference.stroke,
        opacity: 1.0,
    });
}

/// The legend entries of a figure in the order in which they first appear.
fn entries(figure: &Figure) -> Vec<Entry> {
    let mut entries: Vec<Entry> = Vec::new();
    let mut add = |label: &str, colour: Colour, swatch: Swatch| {
        let entry = Entry { label: label.to_owned(), colour, swatch };
        if !label.is_empty() && !entries.contains(&entry) {
            entries.push(entry);
        }
    };
    for panel in &figure.panels {
        match &panel.body {
            Body::Plot { series, references } => {
                for series in series {
                    add(&series.label, series.colour, Swatch::of(series));
                }
                for reference in references {
                    let swatch = match reference.at {
                        At::Vertical(_) => Swatch::Event(reference.stroke),
                        At::Horizontal(_) | At::HorizontalIfVisible(_) => Swatch::Line(reference.stroke),
                    };
                    add(&reference.label, reference.colour, swatch);
                }
            }
            Body::Strip { states, state, .. } => {
                for (index, (label, colour)) in states.iter().enumerate() {
                    if state.contains(&index) {
                        add(label, *colour, Swatch::Strip);
                    }
                }
            }
            Body::Matrix { .. } | Body::Grid(_) => {}
            Body::HeatMap(map) => {
                if let Some((label, _)) = &map.marked {
                    add(label, Colour::Vermillion, Swatch::Framed);
                }
                if map.has_absent() {
                    add(&map.absent, Colour::Muted, Swatch::Hatched);
                }
            }
        }
    }
    for event in &figure.events {
        add(&event.label, event.colour, Swatch::Event(Stroke::Solid));
    }
    entries
}

/// Limits of the common abscissa: those of the figure, else those of the data.
fn shared_limits(figure: &Figure) -> [f64; 2] {
    if let Some(range) = figure.x.range {
        return range;
    }
    let mut limits = Limits::default();
    for panel in figure.panels.iter().filter(|p| p.x.is_none()) {
        match &panel.body {
            Body::Plot { series, .. } => {
                for series in series {
                    limits.add_all(&series.x);
                }
            }
            Body::Strip { x, .. } => limits.add_all(x),
            Body::Matrix { .. } | Body::HeatMap(_) | Body::Grid(_) => {}
        }
    }
    rounded_out(limits.or_unit())
}

/// Limits that are moved out to the next tick if that is within 1 % of the span. So the axis of a record of 2000
/// samples at 100 Hz, which ends at 19.99 s, ends at 20 s.
fn rounded_out([low, high]: [f64; 2]) -> [f64; 2] {
    let values = ticks([low - 0.01 * (high - low), high + 0.01 * (high - low)], 10).values;
    [values.first().map_or(low, |v| v.min(low)), values.last().map_or(high, |v| v.max(high))]
}

/// Limits of an abscissa that belongs to one panel only.
fn own_limits(panel: &Panel, axis: &Axis) -> [f64; 2] {
    if let Some(range) = axis.range {
        return range;
    }
    let mut limits = Limits::default();
    let mut pad = 0.0;
    if let Body::Plot { series, .. } = &panel.body {
        for series in series {
            limits.add_all(&series.x);
            if matches!(series.kind, SeriesKind::Curve(_) | SeriesKind::Trajectory(_) | SeriesKind::Bars(_)) {
                pad = 0.04;
            }
        }
    }
    let [low, high] = limits.or_unit();
    [low - pad * (high - low), high + pad * (high - low)]
}

/// Limits of the ordinate from the data within the limits of the abscissa, and whether there are no data.
fn ordinate_limits(axis: &Axis, series: &[Series], references: &[Reference], x: [f64; 2]) -> ([f64; 2], bool) {
    let mut limits = Limits::default();
    for series in series {
        let inside = |i: usize| series.x.get(i).is_some_and(|v| *v >= x[0] && *v <= x[1]);
        let mut add = |values: &[f64]| {
            values.iter().enumerate().filter(|(i, _)| inside(*i)).for_each(|(_, v)| limits.add(*v));
        };
        match &series.kind {
            SeriesKind::Line(y)
            | SeriesKind::Step(y)
            | SeriesKind::Points(y)
            | SeriesKind::Marks(y)
            | SeriesKind::Curve(y)
            | SeriesKind::Trajectory(y) => add(y),
            SeriesKind::Bars(y) => {
                add(y);
                if !y.is_empty() {
                    limits.add(0.0);
                }
            }
            SeriesKind::Band { lower, upper } => {
                add(lower);
                add(upper);
            }
        }
    }
    let empty = limits.none();
    if let Some(range) = axis.range {
        return (range, empty);
    }
    for reference in references {
        if let At::Horizontal(value) = reference.at {
            limits.add(value);
        }
    }
    let [low, high] = limits.or_unit();
    let pad = 0.06 * (high - low);
    ([low - pad, high + pad], empty)
}

/// The smallest and the largest finite value.
struct Limits {
    low: f64,
    high: f64,
}

impl Default for Limits {
    fn default() -> Self {
        Self { low: f64::INFINITY, high: f64::NEG_INFINITY }
    }
}

impl Limits {
    fn add(&mut self, value: f64) {
        if value.is_finite() {
            self.low = self.low.min(value);
            self.high = self.high.max(value);
        }
    }

    fn add_all(&mut self, values: &[f64]) {
        values.iter().for_each(|v| self.add(*v));
    }

    /// Whether there was no finite value.
    fn none(&self) -> bool {
        self.low > self.high
    }

    /// The limits; 0 to 1 if there was no value, and 5 % to both sides of a constant.
    fn or_unit(&self) -> [f64; 2] {
        let size = self.low.abs().max(self.high.abs());
        if self.none() {
            [0.0, 1.0]
        } else if self.high - self.low > 1e-9 * size {
            [self.low, self.high]
        } else {
            let half = if size > 0.0 { 0.05 * size } else { 1.0 };
            [self.low - half, self.high + half]
        }
    }
}

fn line(lines: Vec<Vec<[f64; 2]>>, colour: Colour, width: f64) -> Shape {
    Shape::Lines { lines, colour, width, stroke: Stroke::Solid, opacity: 1.0 }
}
