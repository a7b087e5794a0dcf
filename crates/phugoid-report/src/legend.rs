//! The legend: one row or a few above the panels, where no curve can run through it.

use crate::clip::Frame;
use crate::curves::{BAND_OPACITY, DOT, LINE_WIDTH, MARK};
use crate::figure::{Colour, Kind, Series, Stroke};
use crate::font::{Fonts, reserved_width};
use crate::heat_map;
use crate::lettering::{NORMAL, text};
use crate::scene::{Anchor, Scene, Shape};

const SAMPLE: f64 = 24.0;
/// Width of the samples that are as high as wide or narrower.
const NARROW: f64 = 8.0;
const ROW: f64 = 20.0;

/// One entry.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Entry {
    pub(crate) label: String,
    pub(crate) colour: Colour,
    pub(crate) swatch: Swatch,
}

/// The sample drawn before an entry's label.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Swatch {
    Line(Stroke),
    Dots,
    Mark,
    Band,
    Strip,
    Event(Stroke),
    /// Cells without a value.
    Hatched,
    /// A framed cell.
    Framed,
}

impl Swatch {
    pub(crate) fn of(series: &Series) -> Self {
        match series.kind {
            Kind::Line(_) | Kind::Step(_) | Kind::Bars(_) | Kind::Curve(_) | Kind::Trajectory(_) => {
                Swatch::Line(series.stroke)
            }
            Kind::Points(_) => Swatch::Dots,
            Kind::Marks(_) => Swatch::Mark,
            Kind::Band { .. } => Swatch::Band,
        }
    }
}

/// Draws the entries from `at` (left, top) with line breaks before `right`; gives the bottom.
pub(crate) fn draw(scene: &mut Scene, fonts: Option<&Fonts>, entries: &[Entry], at: [f64; 2], right: f64) -> f64 {
    if entries.is_empty() {
        return at[1];
    }
    let [mut x, mut y] = [at[0], at[1] + 14.0];
    for entry in entries {
        let sample_width = match entry.swatch {
            Swatch::Event(_) | Swatch::Mark => NARROW,
            Swatch::Framed => 16.0,
            _ => SAMPLE,
        };
        let width = sample_width + 7.0 + reserved_width(fonts, &entry.label, NORMAL, false);
        if x + width > right && x > at[0] {
            x = at[0];
            y += ROW;
        }
        scene.shapes.extend(sample(entry, [x, y - 4.5]));
        scene.shapes.push(text(&entry.label, [x + sample_width + 7.0, y], NORMAL, Anchor::Start, false, Colour::Ink));
        x += width + 20.0;
    }
    y + 6.0
}

fn sample(entry: &Entry, [x, y]: [f64; 2]) -> Vec<Shape> {
    let colour = entry.colour;
    let lines = |stroke| Shape::Lines {
        lines: vec![vec![[x, y], [x + SAMPLE, y]]],
        colour,
        width: LINE_WIDTH + 0.4,
        stroke,
        opacity: 1.0,
    };
    let area = |opacity| Shape::Areas {
        outlines: vec![vec![[x, y - 5.0], [x + SAMPLE, y - 5.0], [x + SAMPLE, y + 5.0], [x, y + 5.0]]],
        colour,
        opacity,
    };
    let frame = |width| Frame { left: x, right: x + width, top: y - 6.5, bottom: y + 6.5 };
    let shape = match entry.swatch {
        Swatch::Hatched => return heat_map::hatched(&[frame(SAMPLE)]),
        Swatch::Framed => return heat_map::frame_mark(&frame(16.0)).to_vec(),
        Swatch::Line(stroke) => lines(stroke),
        Swatch::Dots => Shape::Dots {
            centres: [0.1, 0.37, 0.63, 0.9].map(|s| [x + s * SAMPLE, y]).to_vec(),
            colour,
            diameter: DOT + 0.4,
            opacity: 1.0,
        },
        Swatch::Mark => Shape::Dots { centres: vec![[x + NARROW / 2.0, y]], colour, diameter: MARK, opacity: 1.0 },
        Swatch::Band => area(BAND_OPACITY),
        Swatch::Strip => area(1.0),
        Swatch::Event(stroke) => Shape::Lines {
            lines: vec![vec![[x + NARROW / 2.0, y - 7.0], [x + NARROW / 2.0, y + 7.0]]],
            colour,
            width: 1.6,
            stroke,
            opacity: 1.0,
        },
    };
    vec![shape]
}
