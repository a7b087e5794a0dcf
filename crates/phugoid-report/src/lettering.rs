//! Text in figures: its sizes, labels of axes, and labels shortened to the room that they have.

use crate::figure::{Axis, Colour};
use crate::font::{Fonts, reserved_width};
use crate::scene::{Anchor, Shape};
use crate::ticks::superscript;

/// Font size of tick labels, px.
pub(crate) const SMALL: f64 = 12.0;
/// Font size of axis labels and legend, px.
pub(crate) const NORMAL: f64 = 13.0;

/// `label (unit)`; with the power of ten that was taken out of the tick labels, `label (10³ unit)`.
pub(crate) fn axis_text(axis: &Axis, exponent: i32) -> String {
    let power = if exponent == 0 { String::new() } else { format!("10{}", superscript(exponent)) };
    let unit = match (power.is_empty(), axis.unit.is_empty() || (axis.unit == "–" && !power.is_empty())) {
        (true, true) => String::new(),
        (true, false) => format!(" ({})", axis.unit),
        (false, true) => format!(" ({power})"),
        (false, false) => format!(" ({power} {})", axis.unit),
    };
    format!("{}{unit}", axis.label)
}

/// The text and the first of these sizes, px, in which it fits into `room`, px. If none fits, the text is shortened in
/// front of its unit and has the last size.
pub(crate) fn fitted<const N: usize>(
    fonts: Option<&Fonts>,
    label: String,
    sizes: [f64; N],
    bold: bool,
    room: f64,
) -> (String, f64) {
    let fits = |text: &str, size: f64| reserved_width(fonts, text, size, bold) <= room;
    let smallest = sizes.last().copied().unwrap_or(SMALL);
    if let Some(size) = sizes.into_iter().find(|size| fits(&label, *size)) {
        return (label, size);
    }
    let (name, unit) = match label.rfind(" (") {
        Some(at) => label.split_at(at),
        None => (label.as_str(), ""),
    };
    let mut kept: Vec<char> = name.chars().collect();
    loop {
        kept.pop();
        let shorter = format!("{}…{unit}", kept.iter().collect::<String>());
        if kept.is_empty() || fits(&shorter, smallest) {
            return (shorter, smallest);
        }
    }
}

/// One line of text, not rotated. `at` is a point on its baseline.
pub(crate) fn text(words: &str, at: [f64; 2], size: f64, anchor: Anchor, bold: bool, colour: Colour) -> Shape {
    Shape::Text { text: words.to_owned(), at, size, anchor, bold, colour, rotation: 0.0 }
}
