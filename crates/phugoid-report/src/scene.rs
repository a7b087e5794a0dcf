//! Shapes at their places: what the layout hands to the writers of SVG and PNG. Lengths are in px, x to the right, y
//! down.

use std::ops::Range;

use crate::clip::Frame;
use crate::figure::{Colour, Stroke};

/// Width of a figure, px; a matrix or a grid may be narrower.
pub(crate) const WIDTH: f64 = 960.0;

/// A sheet with its shapes in the order in which they are drawn.
#[derive(Clone, Debug, Default)]
pub(crate) struct Scene {
    pub(crate) width: f64,
    pub(crate) height: f64,
    pub(crate) shapes: Vec<Shape>,
    /// The panels over the time, in the order of their shapes.
    pub(crate) time_plots: Vec<TimePlot>,
}

/// A panel whose abscissa is the time: what a page needs to show a part of it.
#[derive(Clone, Debug)]
pub(crate) struct TimePlot {
    pub(crate) frame: Frame,
    /// First and last time of the abscissa, s.
    pub(crate) time: [f64; 2],
    /// The shapes that move with the time: grid, curves, lines of reference.
    pub(crate) inside: Range<usize>,
    /// Of these, the lines at the ticks of the abscissa.
    pub(crate) grid: Option<usize>,
    /// The labels of the ticks of the abscissa; empty where another panel has them.
    pub(crate) labels: Range<usize>,
}

/// A shape with colour and opacity (0 to 1).
#[derive(Clone, Debug)]
pub(crate) enum Shape {
    /// Open lines of straight pieces. A line of one point is drawn as a dot.
    Lines { lines: Vec<Vec<[f64; 2]>>, colour: Colour, width: f64, stroke: Stroke, opacity: f64 },
    /// Round dots of equal size.
    Dots { centres: Vec<[f64; 2]>, colour: Colour, diameter: f64, opacity: f64 },
    /// Filled areas inside closed outlines.
    Areas { outlines: Vec<Vec<[f64; 2]>>, colour: Colour, opacity: f64 },
    /// One line of text. `at` is a point on its baseline; the rotation about it is clockwise, deg.
    Text { text: String, at: [f64; 2], size: f64, anchor: Anchor, bold: bool, colour: Colour, rotation: f64 },
}

impl Stroke {
    /// Lengths of dashes and of the gaps after them in turn, px; empty for a line without gaps.
    pub(crate) fn pattern(self) -> &'static [f64] {
        match self {
            Stroke::Solid => &[],
            Stroke::Dashed => &[6.0, 4.0],
            Stroke::Dotted => &[1.6, 2.6],
            Stroke::DashDotted => &[9.0, 3.0, 1.6, 3.0],
        }
    }
}

/// Which point of a text is at its position.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Anchor {
    Start,
    Middle,
    End,
}

/// How colours are written into SVG.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Theme {
    /// As fixed colours for white paper.
    Paper,
    /// As style variables of the page around the figure, which may be light or dark.
    Variables,
}

impl Colour {
    /// Red, green and blue of the colour on white paper.
    pub(crate) fn rgb(self) -> [u8; 3] {
        match self {
            Colour::Ink => [0x1b, 0x1f, 0x24],
            Colour::Muted => [0x5f, 0x68, 0x73],
            Colour::Blue => [0x00, 0x72, 0xb2],
            Colour::Orange => [0xe6, 0x9f, 0x00],
            Colour::Green => [0x00, 0x9e, 0x73],
            Colour::Vermillion => [0xd5, 0x5e, 0x00],
            Colour::Purple => [0xcc, 0x79, 0xa7],
            Colour::Sky => [0x56, 0xb4, 0xe9],
            Colour::Yellow => [0xf0, 0xe4, 0x42],
            Colour::Grid => [0xe3, 0xe6, 0xea],
            Colour::OnColour => [0x1b, 0x1f, 0x24],
            Colour::OnDark => [0xff, 0xff, 0xff],
            Colour::Scale(step) => colorous::CIVIDIS.eval_continuous(f64::from(step) / 255.0).as_array(),
        }
    }

    /// The colour of text that can be read on this step of the colour scale.
    pub(crate) fn on_scale(step: u8) -> Self {
        if step < 128 { Self::OnDark } else { Self::OnColour }
    }

    /// Name of the style variable, without the two dashes; `None` for a colour that is the same in every page.
    pub(crate) fn variable(self) -> Option<&'static str> {
        Some(match self {
            Colour::Ink => "ink",
            Colour::Muted => "muted",
            Colour::Blue => "blue",
            Colour::Orange => "orange",
            Colour::Green => "green",
            Colour::Vermillion => "vermillion",
            Colour::Purple => "purple",
            Colour::Sky => "sky",
            Colour::Yellow => "yellow",
            Colour::Grid => "grid",
            Colour::OnColour => "on-colour",
            Colour::OnDark | Colour::Scale(_) => return None,
        })
    }

    /// The colour as the value of an SVG attribute.
    pub(crate) fn paint(self, theme: Theme) -> String {
        match self.variable().filter(|_| theme == Theme::Variables) {
            Some(name) => format!("var(--{name})"),
            None => {
                let [r, g, b] = self.rgb();
                format!("#{r:02x}{g:02x}{b:02x}")
            }
        }
    }
}
