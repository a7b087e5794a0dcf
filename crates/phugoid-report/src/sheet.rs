//! What grids and matrices have in common: a title, and column names that rise at 45 degrees.

use crate::figure::Colour;
use crate::font::{Fonts, reserved_width};
use crate::lettering::text;
use crate::scene::{Anchor, Scene, Shape};

/// Font size of the names of rows and columns, px.
pub(crate) const LABEL: f64 = 12.0;
const TITLE: f64 = 17.0;

/// A sheet with a title only, as wide as the title needs, and the lower edge of the title, px.
pub(crate) fn titled(fonts: Option<&Fonts>, title: Option<&str>) -> (Scene, f64) {
    let mut scene = Scene { width: 0.0, height: 0.0, ..Scene::default() };
    let mut top = 8.0;
    if let Some(title) = title {
        top += TITLE;
        scene.shapes.push(text(title, [8.0, top], TITLE, Anchor::Start, true, Colour::Ink));
        top += 6.0;
        scene.width = 16.0 + reserved_width(fonts, title, TITLE, true);
    }
    (scene, top)
}

/// Width of the widest name, px.
pub(crate) fn widest(fonts: Option<&Fonts>, names: &[String]) -> f64 {
    names.iter().map(|name| reserved_width(fonts, name, LABEL, false)).fold(0.0, f64::max)
}

/// Height of the column names, px, if the widest of them is so wide. They reach as far to the right of the last column.
pub(crate) fn slanted_extent(widest: f64) -> f64 {
    (widest + LABEL) * std::f64::consts::FRAC_1_SQRT_2
}

/// The name of a column, rising at 45 degrees from a point.
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
