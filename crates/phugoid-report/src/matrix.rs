//! Drawing of a matrix of correlations as coloured cells.

use crate::figure::Colour;
use crate::font::Fonts;
use crate::lettering::text;
use crate::scene::{Anchor, Scene, Shape, WIDTH};
use crate::sheet::{LABEL, column_name, slanted_extent, titled, widest};
use crate::ticks::fixed;

/// The shapes of a matrix, on a sheet as wide as it needs to be.
pub(crate) fn scene(fonts: Option<&Fonts>, title: Option<&str>, labels: &[String], values: &[Vec<f64>]) -> Scene {
    let count = labels.len();
    let label_width = widest(fonts, labels);
    let slanted = slanted_extent(label_width);
    let left = label_width + 16.0;
    let cell = ((WIDTH - left - slanted - 10.0) / count.max(1) as f64).clamp(14.0, 46.0);
    let (mut scene, mut top) = titled(fonts, title);
    top += slanted + 6.0;
    scene.width = scene.width.max(left + cell * count as f64 + slanted + 10.0);
    scene.height = top + cell * count as f64 + 10.0;

    for (row, name) in labels.iter().enumerate() {
        let y = top + cell * row as f64;
        scene.shapes.push(text(name, [left - 8.0, y + cell / 2.0 + 4.0], LABEL, Anchor::End, false, Colour::Ink));
        scene.shapes.push(column_name(name, [left + cell * (row as f64 + 0.5) + 4.0, top - 6.0]));
        for column in 0..count {
            let value = values.get(row).and_then(|r| r.get(column)).copied().unwrap_or(f64::NAN);
            draw_cell(&mut scene, [left + cell * column as f64, y], cell, value, row == column);
        }
    }
    scene
}

fn draw_cell(scene: &mut Scene, [x, y]: [f64; 2], cell: f64, value: f64, diagonal: bool) {
    let size = cell - 1.5;
    let square = vec![[x, y], [x + size, y], [x + size, y + size], [x, y + size]];
    let centre = [x + size / 2.0, y + size / 2.0 + 4.0];
    // The cell is drawn grey first, so that a small correlation has a visible place.
    scene.shapes.push(Shape::Areas { outlines: vec![square.clone()], colour: Colour::Grid, opacity: 0.5 });
    if diagonal {
        return;
    }
    if !value.is_finite() {
        scene.shapes.push(text("–", centre, 11.0, Anchor::Middle, false, Colour::Muted));
        return;
    }
    let colour = if value > 0.0 { Colour::Sky } else { Colour::Orange };
    let strength = value.abs().min(1.0);
    scene.shapes.push(Shape::Areas { outlines: vec![square], colour, opacity: 0.8 * strength });
    let (wide, narrow) = (cell >= 34.0, cell >= 24.0);
    if wide || (narrow && strength >= 0.3) {
        let size = if wide { 11.5 } else { 9.5 };
        // A narrow cell has no room for the zero before the decimal point.
        let words = if wide { fixed(value, 2) } else { fixed(value, 2).replace("0.", ".") };
        // On a stronger colour dark text is easier to read in a dark page, where the usual text is light.
        let dark_from = if value > 0.0 { 0.6 } else { 0.75 };
        let on = if strength >= dark_from { Colour::OnColour } else { Colour::Ink };
        scene.shapes.push(text(&words, centre, size, Anchor::Middle, strength >= 0.9, on));
    }
}
