//! Drawing of series and of bars of states inside a panel.

use crate::decimate;
use crate::figure::{Colour, Series, SeriesKind, Stroke};
use crate::plot_area::PlotArea;
use crate::scene::{Scene, Shape};

/// Width of a curve, px.
pub(crate) const LINE_WIDTH: f64 = 1.5;
/// Diameter of the dot of a sample, px.
pub(crate) const DOT: f64 = 2.6;
/// Diameter of a large dot, px.
pub(crate) const MARK: f64 = 6.0;
/// Opacity of the area of a band.
pub(crate) const BAND_OPACITY: f64 = 0.28;

/// Draws one series, cut off at the border of the panel.
pub(crate) fn draw(scene: &mut Scene, map: &PlotArea, series: &Series) {
    let gap = if series.joined { f64::INFINITY } else { longest_step(&series.x) };
    let points = |y: &[f64]| -> Vec<[f64; 2]> { broken(near(map, &series.x, y), gap).map(|p| place(map, p)).collect() };
    let colour = series.colour;
    match &series.kind {
        SeriesKind::Line(y) => draw_lines(scene, map, decimate::lines(&points(y)), colour, LINE_WIDTH, series.stroke),
        SeriesKind::Step(y) => {
            draw_lines(scene, map, decimate::lines(&steps(&points(y))), colour, LINE_WIDTH, series.stroke);
        }
        SeriesKind::Points(y) | SeriesKind::Marks(y) => {
            let mut centres = decimate::points(&points(y));
            centres.retain(|p| map.frame.contains(p));
            if !centres.is_empty() {
                let (diameter, opacity) =
                    if matches!(series.kind, SeriesKind::Marks(_)) { (MARK, 1.0) } else { (DOT, 0.75) };
                scene.shapes.push(Shape::Dots { centres, colour, diameter, opacity });
            }
        }
        SeriesKind::Bars(y) => {
            let foot = map.at([map.x[0], 0.0])[1];
            let bars = decimate::points(&points(y)).into_iter().map(|p| vec![[p[0], foot], p]).collect();
            draw_lines(scene, map, bars, colour, LINE_WIDTH, Stroke::Solid);
        }
        SeriesKind::Band { lower, upper } => {
            let samples: Vec<[f64; 3]> = broken(near(map, &series.x, lower), gap)
                .zip(broken(near(map, &series.x, upper), gap))
                .map(|(low, high)| {
                    if low[1].is_finite() && high[1].is_finite() {
                        let (low, high) = (map.frame.clamp(map.at(low)), map.frame.clamp(map.at(high)));
                        [low[0], low[1], high[1]]
                    } else {
                        [f64::NAN; 3]
                    }
                })
                .collect();
            let outlines: Vec<Vec<[f64; 2]>> = decimate::areas(&samples)
                .into_iter()
                .map(|outline| outline.into_iter().map(|p| map.frame.clamp(p)).collect())
                .collect();
            if !outlines.is_empty() {
                scene.shapes.push(Shape::Areas { outlines, colour, opacity: BAND_OPACITY });
            }
        }
        SeriesKind::Curve(y) => {
            let points: Vec<[f64; 2]> = series.x.iter().zip(y).map(|(x, y)| place(map, [*x, *y])).collect();
            draw_lines(scene, map, decimate::trajectory(&points), colour, LINE_WIDTH, series.stroke);
        }
        SeriesKind::Trajectory(y) => {
            let points: Vec<[f64; 2]> = series.x.iter().zip(y).map(|(x, y)| place(map, [*x, *y])).collect();
            draw_lines(scene, map, decimate::trajectory(&points), colour, 1.2, series.stroke);
            let end = points.iter().rev().find(|p| p[0].is_finite() && p[1].is_finite());
            if let Some(end) = end.filter(|p| map.frame.contains(p)) {
                let colour = Colour::Ink;
                scene.shapes.push(Shape::Dots { centres: vec![*end], colour, diameter: 7.0, opacity: 1.0 });
            }
        }
    }
}

/// Draws a bar of states. States later in the list are drawn over earlier ones, and none is narrower than a pixel.
pub(crate) fn draw_strip(scene: &mut Scene, map: &PlotArea, x: &[f64], state: &[usize], states: &[(String, Colour)]) {
    let count = x.len().min(state.len());
    for (index, (_, colour)) in states.iter().enumerate() {
        let mut outlines: Vec<Vec<[f64; 2]>> = Vec::new();
        let mut start = 0;
        while start < count {
            let mut end = start + 1;
            while end < count && state[end] == state[start] {
                end += 1;
            }
            if state[start] == index {
                // A state is valid until the next sample, the last one until the end of the axis.
                let from = map.at([x[start], 0.0])[0].max(map.frame.left);
                let to = map.at([x.get(end).copied().unwrap_or(map.x[1]), 0.0])[0].min(map.frame.right);
                let (from, to) =
                    if to - from < 1.0 { (from.min(map.frame.right - 1.0), from + 1.0) } else { (from, to) };
                let joins = outlines.last().is_some_and(|o| o[1][0] >= from);
                match outlines.last_mut() {
                    Some(outline) if joins => {
                        outline[1][0] = outline[1][0].max(to);
                        outline[2][0] = outline[2][0].max(to);
                    }
                    _ => outlines.push(vec![
                        [from, map.frame.top],
                        [to, map.frame.top],
                        [to, map.frame.bottom],
                        [from, map.frame.bottom],
                    ]),
                }
            }
            start = end;
        }
        if !outlines.is_empty() {
            scene.shapes.push(Shape::Areas { outlines, colour: *colour, opacity: 1.0 });
        }
    }
}

/// The samples within the limits of the abscissa and one neighbour on each side, so that lines reach the border.
fn near<'a>(map: &PlotArea, x: &'a [f64], y: &'a [f64]) -> impl Iterator<Item = [f64; 2]> + use<'a> {
    let limits = map.x;
    let count = x.len().min(y.len());
    let first = x.partition_point(|v| *v < limits[0]).saturating_sub(1);
    let last = (x.partition_point(|v| *v <= limits[1]) + 1).min(count);
    (first..last.max(first)).map(|i| [x[i], y[i]])
}

/// The longest step of the abscissa over which a line is drawn: six median steps. A longer step is a gap in the data.
fn longest_step(x: &[f64]) -> f64 {
    let mut steps: Vec<f64> = x.windows(2).map(|w| w[1] - w[0]).filter(|d| d.is_finite()).collect();
    if steps.len() < 2 {
        return f64::INFINITY;
    }
    let middle = steps.len() / 2;
    6.0 * *steps.select_nth_unstable_by(middle, f64::total_cmp).1
}

/// The samples, with a sample of NaN put into every gap.
fn broken(samples: impl Iterator<Item = [f64; 2]>, gap: f64) -> impl Iterator<Item = [f64; 2]> {
    let mut before = f64::NAN;
    samples.flat_map(move |sample| {
        let apart = sample[0] - before > gap;
        before = sample[0];
        apart.then_some([f64::NAN; 2]).into_iter().chain([sample])
    })
}

/// Position of a point, px; NaN if it is not finite.
fn place(map: &PlotArea, point: [f64; 2]) -> [f64; 2] {
    if point[0].is_finite() && point[1].is_finite() { map.at(point) } else { [f64::NAN; 2] }
}

/// The corners of a step curve through the points.
fn steps(points: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let mut out = Vec::with_capacity(2 * points.len());
    for (i, point) in points.iter().enumerate() {
        if i > 0 && point[0].is_finite() {
            out.push([point[0], points[i - 1][1]]);
        }
        out.push(*point);
    }
    out
}

/// Draws lines with few points, cut off at the border of the panel.
fn draw_lines(
    scene: &mut Scene,
    map: &PlotArea,
    lines: Vec<Vec<[f64; 2]>>,
    colour: Colour,
    width: f64,
    stroke: Stroke,
) {
    let mut inside: Vec<Vec<[f64; 2]>> = Vec::new();
    for line in lines {
        if let [only] = line.as_slice() {
            if map.frame.contains(only) {
                inside.push(line);
            }
        } else {
            inside.extend(map.frame.clip(&decimate::straightened(&line)));
        }
    }
    if !inside.is_empty() {
        scene.shapes.push(Shape::Lines { lines: inside, colour, width, stroke, opacity: 1.0 });
    }
}
