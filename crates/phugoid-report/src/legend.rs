//! The legend, which stands in one or a few rows above the panels, where no curve can cross it.

use crate::clip::Frame;
use crate::curves::{BAND_OPACITY, DOT, LINE_WIDTH, MARK};
use crate::figure::{Colour, Series, SeriesKind, Stroke};
use crate::font::{Fonts, reserved_width};
use crate::heat_map;
use crate::lettering::{NORMAL, text};
use crate::scene::{Anchor, Scene, Shape};

/// Width of the sample of a line or an area, px.
const SAMPLE: f64 = 24.0;
/// Width of the sample of a dot or a vertical line, px.
const NARROW: f64 = 8.0;
/// Distance of the rows, px.
const ROW: f64 = 20.0;

/// One entry of the legend.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Entry {
    pub(crate) label: String,
    pub(crate) colour: Colour,
    pub(crate) swatch: Swatch,
}

/// The sample that is drawn in front of the label.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Swatch {
    Line(Stroke),
    Dots,
    Mark,
    Band,
    Strip,
    Event(Stroke),
    /// Hatched cells, which have no value.
    Hatched,
    /// A cell with a frame.
    Framed,
}

impl Swatch {
    /// The sample for a series.
    pub(crate) fn of(series: &Series) -> Self {
        match series.kind {
            SeriesKind::Line(_)
            | SeriesKind::Step(_)
            | SeriesKind::Bars(_)
            | SeriesKind::Curve(_)
            | SeriesKind::Trajectory(_) => Swatch::Line(series.stroke),
            SeriesKind::Points(_) => Swatch::Dots,
            SeriesKind::Marks(_) => Swatch::Mark,
            SeriesKind::Band { .. } => Swatch::Band,
        }
    }
}

/// Draws the entries from `at` (left, top), px, with line breaks before `right`. Returns the lower edge.
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
