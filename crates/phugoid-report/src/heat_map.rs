//! Drawing of a heat map: coloured cells with a colour bar.

use crate::clip::Frame;
use crate::figure::{Colour, HeatMap, Stroke};
use crate::font::{Fonts, reserved_width};
use crate::lettering::{NORMAL, SMALL, axis_text, fitted, text};
use crate::scene::{Anchor, Scene, Shape};
use crate::ticks::{Ticks, compact, fixed, logarithmic_ticks, significant, ticks};

/// Number of the last step of the colour scale; see [`Colour::Scale`].
const STEPS: f64 = 255.0;
/// Width of the panel that the colour bar with its ticks and label needs, px.
pub(crate) const BAR_ROOM: f64 = 104.0;
const BAR_GAP: f64 = 20.0;
const BAR_WIDTH: f64 = 14.0;
/// Distance of the lines in a hatched cell, px.
const HATCH: f64 = 6.0;

/// Draws the cells within `frame` and the colour bar to its right.
pub(crate) fn draw(scene: &mut Scene, fonts: Option<&Fonts>, map: &HeatMap, frame: Frame) {
    let scale = ColourScale::of(map);
    cells(scene, fonts, map, &scale, frame);
    bar(scene, fonts, map, &scale, frame);
}

/// Ticks in the middle of cells, in numbers of cells from 0. There are as many as fit into `room`, px; `needed` gives
/// the room for a label.
pub(crate) fn grid_ticks(grid: &[f64], room: f64, needed: impl Fn(&str) -> f64) -> Ticks {
    let labels: Vec<String> = grid.iter().map(|v| compact(*v, 3)).collect();
    let widest = labels.iter().map(|l| needed(l)).fold(1.0, f64::max);
    let every = ((widest * grid.len() as f64 / room.max(1.0)).ceil() as usize).max(1);
    let (values, labels) =
        labels.into_iter().enumerate().step_by(every).map(|(k, label)| (k as f64 + 0.5, label)).unzip();
    Ticks { values, labels, exponent: 0 }
}

/// From values to steps of the colour scale.
struct ColourScale {
    limits: [f64; 2],
    logarithmic: bool,
    /// Whether a value lies below and whether one lies above the limits.
    beyond: [bool; 2],
}

impl ColourScale {
    fn of(map: &HeatMap) -> Self {
        let drawable = |v: &&f64| v.is_finite() && (!map.logarithmic || **v > 0.0);
        let (low, high) = map
            .values
            .iter()
            .flatten()
            .filter(drawable)
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(*v), high.max(*v)));
        let found = if low > high { [0.0, 1.0] } else { [low, high] };
        let [mut lower, mut upper] = map.value.range.unwrap_or(found);
        if map.logarithmic && lower <= 0.0 {
            [lower, upper] = [found[0].max(f64::MIN_POSITIVE), upper.max(found[1])];
        }
        // If all values are equal, they have the middle of the scale.
        if upper <= lower {
            [lower, upper] = if map.logarithmic { [0.5 * lower, 2.0 * lower] } else { [lower - 0.5, lower + 0.5] };
        }
        let slack = 1e-9 * (upper - lower);
        Self {
            limits: [lower, upper],
            logarithmic: map.logarithmic,
            beyond: [low < lower - slack, high > upper + slack && low <= high],
        }
    }

    /// Place on the scale, 0 to 1; `None` for a value that is not finite or has no logarithm.
    fn share(&self, value: f64) -> Option<f64> {
        let along = |v: f64| if self.logarithmic { v.ln() } else { v };
        let [low, high] = self.limits.map(along);
        let share = (along(value) - low) / (high - low);
        share.is_finite().then(|| share.clamp(0.0, 1.0))
    }

    fn step(&self, value: f64) -> Option<u8> {
        self.share(value).map(|share| (STEPS * share).round() as u8)
    }
}

/// Draws the cells, the values in them if there is room, and the frame of the marked cell.
fn cells(scene: &mut Scene, fonts: Option<&Fonts>, map: &HeatMap, scale: &ColourScale, frame: Frame) {
    let (columns, rows) = (map.x.len(), map.y.len());
    if columns == 0 || rows == 0 {
        let middle = [(frame.left + frame.right) / 2.0, (frame.top + frame.bottom) / 2.0];
        scene.shapes.push(text("no data", middle, NORMAL, Anchor::Middle, false, Colour::Muted));
        return;
    }
    let [width, height] = [(frame.right - frame.left) / columns as f64, (frame.bottom - frame.top) / rows as f64];
    let cell = |column: usize, row: usize| Frame {
        left: frame.left + width * column as f64,
        right: frame.left + width * (column + 1) as f64,
        top: frame.bottom - height * (row + 1) as f64,
        bottom: frame.bottom - height * row as f64,
    };
    // One shape for each colour, because a fine map has thousands of cells.
    let mut by_step: Vec<Vec<Vec<[f64; 2]>>> = vec![Vec::new(); STEPS as usize + 1];
    let mut absent: Vec<Frame> = Vec::new();
    let mut words = Vec::new();
    let mut widest = 0.0_f64;
    for row in 0..rows {
        for column in 0..columns {
            let value = map.values.get(row).and_then(|r| r.get(column)).copied().unwrap_or(f64::NAN);
            let place = cell(column, row);
            let Some(step) = scale.step(value) else {
                absent.push(place);
                continue;
            };
            by_step[usize::from(step)].push(outline(&place));
            let label = short(value);
            widest = widest.max(reserved_width(fonts, &label, 11.0, false));
            let at = [(place.left + place.right) / 2.0, (place.top + place.bottom) / 2.0 + 4.0];
            words.push(text(&label, at, 11.0, Anchor::Middle, false, Colour::on_scale(step)));
        }
    }
    for (step, outlines) in by_step.into_iter().enumerate().filter(|(_, outlines)| !outlines.is_empty()) {
        let colour = Colour::Scale(u8::try_from(step).unwrap_or(u8::MAX));
        scene.shapes.push(Shape::Areas { outlines, colour, opacity: 1.0 });
    }
    // Values are printed in all cells or in none, because a cell without a number would look as if it had no value.
    if height >= 17.0 && widest + 4.0 <= width {
        scene.shapes.extend(words);
    }
    scene.shapes.extend(hatched(&absent));
    if let Some((_, marked)) = &map.marked
        && let (Some(column), Some(row)) = (nearest(&map.x, marked[0]), nearest(&map.y, marked[1]))
    {
        scene.shapes.extend(frame_mark(&cell(column, row)));
    }
}

/// The shapes of cells without a value: grey with oblique lines, which continue from cell to cell.
pub(crate) fn hatched(cells: &[Frame]) -> Vec<Shape> {
    if cells.is_empty() {
        return Vec::new();
    }
    let mut lines = Vec::new();
    for cell in cells {
        let first = ((cell.left + cell.top) / HATCH).ceil() as i64;
        let last = ((cell.right + cell.bottom) / HATCH).floor() as i64;
        for k in first..=last {
            let sum = k as f64 * HATCH;
            lines.extend(cell.clip(&[[sum - cell.bottom, cell.bottom], [sum - cell.top, cell.top]]));
        }
    }
    let outlines = cells.iter().map(outline).collect();
    vec![
        Shape::Areas { outlines, colour: Colour::Grid, opacity: 1.0 },
        Shape::Lines { lines, colour: Colour::Muted, width: 0.7, stroke: Stroke::Solid, opacity: 0.8 },
    ]
}

/// The frame around a marked cell: a coloured line on a wider white one, so that it is visible on any colour.
pub(crate) fn frame_mark(cell: &Frame) -> [Shape; 2] {
    let inside =
        Frame { left: cell.left + 2.0, right: cell.right - 2.0, top: cell.top + 2.0, bottom: cell.bottom - 2.0 };
    let mut line = outline(&inside);
    line.push(line[0]);
    [(Colour::OnDark, 4.5), (Colour::Vermillion, 2.2)].map(|(colour, width)| Shape::Lines {
        lines: vec![line.clone()],
        colour,
        width,
        stroke: Stroke::Solid,
        opacity: 1.0,
    })
}

/// Draws the colour bar with its ticks and label.
fn bar(scene: &mut Scene, fonts: Option<&Fonts>, map: &HeatMap, scale: &ColourScale, frame: Frame) {
    let (left, right) = (frame.right + BAR_GAP, frame.right + BAR_GAP + BAR_WIDTH);
    // The bar has a pointed end if values lie beyond its limit.
    let point = |beyond: bool| if beyond { 12.0 } else { 0.0 };
    let [top, bottom] = [frame.top + point(scale.beyond[1]), frame.bottom - point(scale.beyond[0])];
    const PIECES: usize = 64;
    for piece in 0..PIECES {
        let at = |k: usize| bottom - (bottom - top) * k as f64 / PIECES as f64;
        // Each piece overlaps the next one, so that there is no visible line between them.
        let upper = if piece + 1 == PIECES { at(piece + 1) } else { at(piece + 1) - 0.6 };
        let place = Frame { left, right, top: upper, bottom: at(piece) };
        let step = (STEPS * (piece as f64 + 0.5) / PIECES as f64).round() as u8;
        scene.shapes.push(Shape::Areas { outlines: vec![outline(&place)], colour: Colour::Scale(step), opacity: 1.0 });
    }
    for (beyond, colour, foot, tip) in [
        (scale.beyond[0], Colour::Scale(0), bottom, frame.bottom),
        (scale.beyond[1], Colour::Scale(u8::MAX), top, frame.top),
    ] {
        if beyond {
            let outlines = vec![vec![[left, foot], [right, foot], [(left + right) / 2.0, tip]]];
            scene.shapes.push(Shape::Areas { outlines, colour, opacity: 1.0 });
        }
    }
    let wanted = ((bottom - top) / 34.0).round().clamp(2.0, 8.0) as usize;
    let marks = if scale.logarithmic { logarithmic_ticks(scale.limits, wanted) } else { ticks(scale.limits, wanted) };
    let mut widest = 0.0_f64;
    for (value, label) in marks.values.iter().zip(&marks.labels) {
        let Some(share) = scale.share(*value) else { continue };
        let y = bottom - share * (bottom - top);
        scene.shapes.push(Shape::Lines {
            lines: vec![vec![[right, y], [right + 4.0, y]]],
            colour: Colour::Muted,
            width: 1.0,
            stroke: Stroke::Solid,
            opacity: 1.0,
        });
        scene.shapes.push(text(label, [right + 7.0, y + 4.0], SMALL, Anchor::Start, false, Colour::Muted));
        widest = widest.max(reserved_width(fonts, label, SMALL, false));
    }
    let room = frame.bottom - frame.top + 24.0;
    let (label, size) = fitted(fonts, axis_text(&map.value, marks.exponent), [SMALL, 11.0, 10.0], false, room);
    scene.shapes.push(Shape::Text {
        text: label,
        at: [right + 7.0 + widest + 18.0, (frame.top + frame.bottom) / 2.0],
        size,
        anchor: Anchor::Middle,
        bold: false,
        colour: Colour::Ink,
        rotation: -90.0,
    });
}

/// A value with two or three digits, for which a cell has room.
fn short(value: f64) -> String {
    match value.abs() {
        size if (0.1..99.5).contains(&size) => significant(value, 2),
        size if (99.5..1e5).contains(&size) => fixed(value, 0),
        _ => compact(value, 2),
    }
}

/// Index of the nearest value of a grid.
fn nearest(grid: &[f64], value: f64) -> Option<usize> {
    let distance = |k: &usize| (grid[*k] - value).abs();
    (0..grid.len()).filter(|k| distance(k).is_finite()).min_by(|a, b| distance(a).total_cmp(&distance(b)))
}

fn outline(cell: &Frame) -> Vec<[f64; 2]> {
    vec![[cell.left, cell.top], [cell.right, cell.top], [cell.right, cell.bottom], [cell.left, cell.bottom]]
}

impl HeatMap {
    /// Whether any cell has no value that can be drawn.
    pub(crate) fn has_absent(&self) -> bool {
        let scale = ColourScale::of(self);
        let value = |row: usize, column: usize| self.values.get(row).and_then(|r| r.get(column)).copied();
        (0..self.y.len())
            .any(|row| (0..self.x.len()).any(|column| value(row, column).and_then(|v| scale.step(v)).is_none()))
    }
}

/// Limits of an axis of a heat map, in numbers of cells.
pub(crate) fn extent(grid: &[f64]) -> [f64; 2] {
    [0.0, grid.len().max(1) as f64]
}
