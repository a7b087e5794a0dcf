//! What the sheets of grids and matrices have in common: a title, and column names that climb at 45 degrees.

use crate::figure::Colour;
use crate::font::{Fonts, reserved_width};
use crate::lettering::text;
use crate::scene::{Anchor, Scene, Shape};

/// Size of the names of rows and columns.
pub(crate) const LABEL: f64 = 12.0;
const TITLE: f64 = 17.0;

/// A sheet, empty but for its title and as wide as that needs, and where the title ends.
pub(crate) fn titled(fonts: Option<&Fonts>, title: Option<&str>) -> (Scene, f64) {
    let mut scene = Scene { width: 0.0, height: 0.0, shapes: Vec::new() };
    let mut top = 8.0;
    if let Some(title) = title {
        top += TITLE;
        scene.shapes.push(text(title, [8.0, top], TITLE, Anchor::Start, true, Colour::Ink));
        top += 6.0;
        scene.width = 16.0 + reserved_width(fonts, title, TITLE, true);
    }
    (scene, top)
}

/// Width of the widest name.
pub(crate) fn widest(fonts: Option<&Fonts>, names: &[String]) -> f64 {
    names.iter().map(|name| reserved_width(fonts, name, LABEL, false)).fold(0.0, f64::max)
}

/// Height and overhang of column names of which the widest is so wide.
pub(crate) fn climb(widest: f64) -> f64 {
    (widest + LABEL) * std::f64::consts::FRAC_1_SQRT_2
}

/// The name of a column, climbing from a point.
pub(crate) fn column_name(name: &str, at: [f64; 2]) -> Shape {
    Shape::Text {
        text: name.to_owned(),
        at,
        size: LABEL,
        anchor: Anchor::Start,
        bold: false,
        colour: Colour::Ink,
        rotation: -45.0,
    }
}
