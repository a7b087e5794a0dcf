//! Drawing of a table of coloured cells with words in them.

use crate::figure::{Cell, Colour, Grid};
use crate::font::{Fonts, reserved_width};
use crate::lettering::text;
use crate::scene::{Anchor, Scene, Shape, WIDTH};
use crate::sheet::{LABEL, column_name, slanted_extent, titled, widest};

/// Font size in the cells, px.
const WORDS: f64 = 11.5;
/// Height of a row, px.
const ROW: f64 = 24.0;
/// Width of a cell at most, px, so that a grid of two columns does not fill the page.
const WIDEST: f64 = 96.0;

/// The shapes of a grid, on a sheet as wide as it needs to be.
pub(crate) fn scene(fonts: Option<&Fonts>, title: Option<&str>, grid: &Grid) -> Scene {
    let slanted = slanted_extent(widest(fonts, &grid.columns));
    let left = widest(fonts, &grid.rows) + 16.0;
    let words = grid.cells.iter().flatten().map(|c| reserved_width(fonts, &c.words, WORDS, false)).fold(0.0, f64::max);
    let room = (WIDTH - left - slanted - 10.0) / grid.columns.len().max(1) as f64;
    let width = room.min(WIDEST).max(words + 8.0);
    let (mut scene, mut top) = titled(fonts, title);
    top += slanted + 6.0;
    scene.width = scene.width.max(left + width * grid.columns.len() as f64 + slanted + 10.0);
    scene.height = top + ROW * grid.rows.len() as f64 + 10.0;
    for (column, name) in grid.columns.iter().enumerate() {
        scene.shapes.push(column_name(name, [left + width * (column as f64 + 0.5) + 4.0, top - 6.0]));
    }
    for (row, name) in grid.rows.iter().enumerate() {
        let y = top + ROW * row as f64;
        scene.shapes.push(text(name, [left - 8.0, y + ROW / 2.0 + 4.0], LABEL, Anchor::End, false, Colour::Ink));
        for column in 0..grid.columns.len() {
            let cell = grid.cells.get(row).and_then(|cells| cells.get(column));
            let place = [left + width * column as f64, y];
            draw_cell(&mut scene, place, [width - 1.5, ROW - 1.5], cell);
        }
    }
    scene
}

fn draw_cell(scene: &mut Scene, [x, y]: [f64; 2], [width, height]: [f64; 2], cell: Option<&Cell>) {
    let outline = vec![[x, y], [x + width, y], [x + width, y + height], [x, y + height]];
    let centre = [x + width / 2.0, y + height / 2.0 + 4.0];
    scene.shapes.push(Shape::Areas { outlines: vec![outline.clone()], colour: Colour::Grid, opacity: 0.5 });
    let Some(cell) = cell else { return };
    let tone = if cell.tone.is_finite() { cell.tone.clamp(-1.0, 1.0) } else { 0.0 };
    let mut on = if cell.tone.is_finite() { Colour::Ink } else { Colour::Muted };
    if tone != 0.0 {
        let colour = if tone > 0.0 { Colour::Sky } else { Colour::Orange };
        scene.shapes.push(Shape::Areas { outlines: vec![outline], colour, opacity: 0.8 * tone.abs() });
        // On a stronger colour dark text is easier to read in a dark page, where the usual text is light.
        let dark_from = if tone > 0.0 { 0.6 } else { 0.75 };
        if tone.abs() >= dark_from {
            on = Colour::OnColour;
        }
    }
    scene.shapes.push(text(&cell.words, centre, WORDS, Anchor::Middle, cell.strong, on));
}
