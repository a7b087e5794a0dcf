//! A scene as a PNG picture, with the same shapes and the same text widths as the SVG.

use ab_glyph::OutlineCurve;
use tiny_skia::{FillRule, LineCap, LineJoin, Paint, Path, PathBuilder, Pixmap, Stroke, StrokeDash, Transform};

use crate::error::ReportError;
use crate::figure::Colour;
use crate::font::Fonts;
use crate::scene::{Anchor, Scene, Shape};

/// Pixels of the picture for each px of the layout: 960 px become 1920 pixels, which is sharp in print on half a page.
const SCALE: f64 = 2.0;

/// The scene on white as the bytes of a PNG file; `title` names the figure in an error.
pub(crate) fn encode(scene: &Scene, title: &str) -> Result<Vec<u8>, ReportError> {
    let (width, height) = ((scene.width * SCALE).ceil() as u32, (scene.height * SCALE).ceil() as u32);
    let fail = |reason: String| ReportError::Raster { figure: title.to_owned(), width, height, reason };
    let fonts = Fonts::load()?;
    let mut pixmap =
        Pixmap::new(width, height).ok_or_else(|| fail("a side is zero or the picture is too large".to_owned()))?;
    pixmap.fill(tiny_skia::Color::WHITE);
    for shape in &scene.shapes {
        draw(&mut pixmap, shape, &fonts);
    }
    pixmap.encode_png().map_err(|error| fail(error.to_string()))
}

fn draw(pixmap: &mut Pixmap, shape: &Shape, fonts: &Fonts) {
    let scale = Transform::from_scale(SCALE as f32, SCALE as f32);
    match shape {
        Shape::Lines { lines, colour, width, stroke, opacity } => {
            let pattern: Vec<f32> = stroke.pattern().iter().map(|length| *length as f32).collect();
            let stroke = Stroke {
                width: *width as f32,
                line_cap: if pattern.is_empty() { LineCap::Round } else { LineCap::Butt },
                line_join: LineJoin::Round,
                // Without lengths this is `None`, and the line is solid.
                dash: StrokeDash::new(pattern, 0.0),
                ..Stroke::default()
            };
            if let Some(path) = path(lines, false) {
                pixmap.stroke_path(&path, &paint(*colour, *opacity), &stroke, scale, None);
            }
        }
        Shape::Dots { centres, colour, diameter, opacity } => {
            let mut builder = PathBuilder::new();
            for centre in centres {
                builder.push_circle(centre[0] as f32, centre[1] as f32, (diameter / 2.0) as f32);
            }
            if let Some(path) = builder.finish() {
                pixmap.fill_path(&path, &paint(*colour, *opacity), FillRule::Winding, scale, None);
            }
        }
        Shape::Areas { outlines, colour, opacity } => {
            if let Some(path) = path(outlines, true) {
                pixmap.fill_path(&path, &paint(*colour, *opacity), FillRule::Winding, scale, None);
            }
        }
        Shape::Text { text, at, size, anchor, bold, colour, rotation } => {
            let Some(path) = text_path(fonts, text, *bold) else { return };
            let shift = match anchor {
                Anchor::Start => 0.0,
                Anchor::Middle => -0.5,
                Anchor::End => -1.0,
            } * fonts.width_in_em(text, *bold);
            let transform = Transform::from_translate(shift as f32, 0.0)
                .post_scale(*size as f32, -*size as f32)
                .post_concat(Transform::from_rotate(*rotation as f32))
                .post_translate(at[0] as f32, at[1] as f32)
                .post_concat(scale);
            pixmap.fill_path(&path, &paint(*colour, 1.0), FillRule::Winding, transform, None);
        }
    }
}

fn paint(colour: Colour, opacity: f64) -> Paint<'static> {
    let [r, g, b] = colour.rgb();
    let mut paint = Paint { anti_alias: true, ..Paint::default() };
    paint.set_color_rgba8(r, g, b, (opacity.clamp(0.0, 1.0) * 255.0).round() as u8);
    paint
}

fn path(lines: &[Vec<[f64; 2]>], closed: bool) -> Option<Path> {
    let mut builder = PathBuilder::new();
    for line in lines {
        let Some(first) = line.first() else { continue };
        builder.move_to(first[0] as f32, first[1] as f32);
        for point in &line[1..] {
            builder.line_to(point[0] as f32, point[1] as f32);
        }
        if closed {
            builder.close();
        } else if line.len() == 1 {
            // A very short line, because a rasteriser may leave out a line of no length.
            builder.line_to(first[0] as f32 + 0.01, first[1] as f32);
        }
    }
    builder.finish()
}

/// The outlines of a text in units of the font size, baseline at 0, y up.
fn text_path(fonts: &Fonts, text: &str, bold: bool) -> Option<Path> {
    let mut builder = PathBuilder::new();
    let mut here: Option<ab_glyph::Point> = None;
    for curve in fonts.outline(text, bold) {
        let start = match curve {
            OutlineCurve::Line(a, _) | OutlineCurve::Quad(a, ..) | OutlineCurve::Cubic(a, ..) => a,
        };
        if here != Some(start) {
            if here.is_some() {
                builder.close();
            }
            builder.move_to(start.x, start.y);
        }
        here = Some(match curve {
            OutlineCurve::Line(_, b) => {
                builder.line_to(b.x, b.y);
                b
            }
            OutlineCurve::Quad(_, b, c) => {
                builder.quad_to(b.x, b.y, c.x, c.y);
                c
            }
            OutlineCurve::Cubic(_, b, c, d) => {
                builder.cubic_to(b.x, b.y, c.x, c.y, d.x, d.y);
                d
            }
        });
    }
    if here.is_some() {
        builder.close();
    }
    builder.finish()
}
