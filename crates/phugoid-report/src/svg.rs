//! A scene as SVG.
//!
//! Coordinates are written as whole tenths of a pixel and relative to the point before, which needs half as many bytes
//! as decimals. Rounding errors do not add up, because positions are rounded before they are subtracted.

use std::fmt::Write as _;

use crate::clip::Frame;
use crate::escape::escape;
use crate::scene::{Anchor, Scene, Shape, Theme, TimePlot};

/// Units of the SVG for each px: coordinates are in tenths of a pixel.
const UNITS: f64 = 10.0;

/// The style of every drawing, at the end of its first element, by which a drawing of ours is known.
pub(crate) const STYLE: &str =
    "font-family=\"Inter,system-ui,Helvetica,Arial,sans-serif\" stroke-linejoin=\"round\" stroke-linecap=\"round\"";

/// The `<svg>` element of a scene; `title` is its label for screen readers.
pub(crate) fn document(scene: &Scene, title: &str, theme: Theme) -> String {
    let mut out = String::new();
    let (w, h) = (tenths(scene.width), tenths(scene.height));
    let size = match theme {
        Theme::Paper => format!(" width=\"{}\" height=\"{}\"", scene.width, scene.height),
        // As wide as the page allows. On a narrow screen it can be scrolled sideways, so that the text stays readable.
        Theme::Variables => {
            format!(" style=\"max-width:{:.0}px;min-width:{:.0}px\"", scene.width, 0.74 * scene.width)
        }
    };
    // Writing into a String cannot fail, so the results of write! are ignored here and below.
    let _ = write!(
        out,
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {w} {h}\"{size} role=\"img\" aria-label=\"{}\" \
         {STYLE}>",
        escape(title)
    );
    if theme == Theme::Paper {
        let _ = write!(out, "<rect width=\"{w}\" height=\"{h}\" fill=\"#ffffff\"/>");
    }
    out.push('\n');
    // A figure of its own has no script beside it.
    let plots: &[TimePlot] = if theme == Theme::Variables { &scene.time_plots } else { &[] };
    for (index, shape) in scene.shapes.iter().enumerate() {
        for plot in plots {
            if index == plot.inside.end && !plot.inside.is_empty()
                || index == plot.labels.end && !plot.labels.is_empty()
            {
                out.push_str("</g>\n");
            }
        }
        for plot in plots {
            if index == plot.inside.start && !plot.inside.is_empty() {
                let Frame { left, top, right, bottom } = plot.frame;
                let [left, top, right, bottom] = [left, top, right, bottom].map(tenths);
                let [from, to] = plot.time;
                let _ = writeln!(
                    out,
                    "<g class=\"plot\" data-frame=\"{left} {top} {right} {bottom}\" data-time=\"{from} {to}\">"
                );
            }
            if index == plot.labels.start && !plot.labels.is_empty() {
                out.push_str("<g class=\"labels\">\n");
            }
        }
        let class = plots.iter().any(|plot| plot.grid == Some(index)).then_some("grid");
        write_shape(&mut out, shape, theme, class);
    }
    out.push_str("</svg>\n");
    out
}

fn write_shape(out: &mut String, shape: &Shape, theme: Theme, class: Option<&str>) {
    match shape {
        Shape::Lines { lines, colour, width, stroke, opacity } => {
            let class = class.map_or_else(String::new, |class| format!(" class=\"{class}\""));
            let _ = write!(
                out,
                "<path{class} fill=\"none\" stroke=\"{}\" stroke-width=\"{}\"",
                colour.paint(theme),
                tenths(*width)
            );
            let pattern: Vec<String> = stroke.pattern().iter().map(|length| tenths(*length).to_string()).collect();
            if !pattern.is_empty() {
                let _ = write!(out, " stroke-linecap=\"butt\" stroke-dasharray=\"{}\"", pattern.join(" "));
            }
            write_opacity(out, "stroke-opacity", *opacity);
            out.push_str(" d=\"");
            for line in lines {
                write_line(out, line);
            }
            out.push_str("\"/>\n");
        }
        Shape::Dots { centres, colour, diameter, opacity } => {
            // A line of no length with round ends is a dot; it needs a tenth of the bytes of a circle element.
            let _ = write!(
                out,
                "<path fill=\"none\" stroke=\"{}\" stroke-width=\"{}\"",
                colour.paint(theme),
                tenths(*diameter)
            );
            write_opacity(out, "stroke-opacity", *opacity);
            out.push_str(" d=\"");
            let mut last: Option<[i64; 2]> = None;
            for centre in centres {
                let here = [tenths(centre[0]), tenths(centre[1])];
                match last {
                    None => {
                        let _ = write!(out, "M{} {}h0", here[0], here[1]);
                    }
                    Some([x, y]) => {
                        out.push('m');
                        write_pair(out, here[0] - x, here[1] - y);
                        out.push_str("h0");
                    }
                }
                last = Some(here);
            }
            out.push_str("\"/>\n");
        }
        Shape::Areas { outlines, colour, opacity } => {
            let _ = write!(out, "<path stroke=\"none\" fill=\"{}\"", colour.paint(theme));
            write_opacity(out, "fill-opacity", *opacity);
            out.push_str(" d=\"");
            for outline in outlines {
                write_line(out, outline);
                out.push('z');
            }
            out.push_str("\"/>\n");
        }
        Shape::Text { text, at, size, anchor, bold, colour, rotation } => {
            let (x, y) = (tenths(at[0]), tenths(at[1]));
            let _ = write!(out, "<text x=\"{x}\" y=\"{y}\" font-size=\"{}\"", tenths(*size));
            let _ = write!(out, " fill=\"{}\"", colour.paint(theme));
            match anchor {
                Anchor::Start => {}
                Anchor::Middle => out.push_str(" text-anchor=\"middle\""),
                Anchor::End => out.push_str(" text-anchor=\"end\""),
            }
            if *bold {
                out.push_str(" font-weight=\"600\"");
            }
            if *rotation != 0.0 {
                let _ = write!(out, " transform=\"rotate({rotation} {x} {y})\"");
            }
            let _ = writeln!(out, ">{}</text>", escape(text));
        }
    }
}

fn write_opacity(out: &mut String, attribute: &str, opacity: f64) {
    if opacity < 1.0 {
        let _ = write!(out, " {attribute}=\"{opacity:.2}\"");
    }
}

/// Writes `M x y l dx dy dx dy ...`, with equal points and horizontal runs joined.
fn write_line(out: &mut String, line: &[[f64; 2]]) {
    let Some(first) = line.first() else { return };
    let mut here = [tenths(first[0]), tenths(first[1])];
    let _ = write!(out, "M{} {}l", here[0], here[1]);
    let mut level = 0;
    let mut written = false;
    for point in &line[1..] {
        let next = [tenths(point[0]), tenths(point[1])];
        let (dx, dy) = (next[0] - here[0], next[1] - here[1]);
        here = next;
        if dy == 0 && (level == 0 || (level > 0) == (dx > 0)) {
            level += dx;
            continue;
        }
        if level != 0 {
            write_pair_after(out, level, 0, &mut written);
            level = 0;
        }
        if dy == 0 {
            level = dx;
        } else {
            write_pair_after(out, dx, dy, &mut written);
        }
    }
    if level != 0 || !written {
        write_pair_after(out, level, 0, &mut written);
    }
}

fn write_pair_after(out: &mut String, dx: i64, dy: i64, written: &mut bool) {
    if *written && dx >= 0 {
        out.push(' ');
    }
    write_pair(out, dx, dy);
    *written = true;
}

fn write_pair(out: &mut String, dx: i64, dy: i64) {
    let gap = if dy < 0 { "" } else { " " };
    let _ = write!(out, "{dx}{gap}{dy}");
}

fn tenths(length: f64) -> i64 {
    (length * UNITS).round() as i64
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::figure::Colour;

    fn path(points: &[[f64; 2]]) -> String {
        let mut out = String::new();
        write_line(&mut out, points);
        out
    }

    #[test]
    fn paths_are_relative_and_join_level_runs() {
        assert_eq!(path(&[[1.0, 2.0], [1.5, 2.0], [2.0, 2.0], [2.1, 1.0], [2.0, 3.0]]), "M10 20l10 0 1-10-1 20");
        // A level run that turns back is not shortened.
        assert_eq!(path(&[[0.0, 0.0], [5.0, 0.0], [2.0, 0.0], [2.0, 1.0]]), "M0 0l50 0-30 0 0 10");
        // A single point is a dot.
        assert_eq!(path(&[[3.0, 4.0]]), "M30 40l0 0");
    }

    #[test]
    fn text_stays_text_and_is_escaped() {
        let scene = Scene {
            width: 10.0,
            height: 10.0,
            time_plots: Vec::new(),
            shapes: vec![Shape::Text {
                text: "a<b & \"c\"".into(),
                at: [1.0, 2.0],
                size: 12.0,
                anchor: Anchor::Middle,
                bold: true,
                colour: Colour::Ink,
                rotation: 0.0,
            }],
        };
        let svg = document(&scene, "t<", Theme::Paper);
        assert!(svg.contains(">a&lt;b &amp; &quot;c&quot;</text>"), "{svg}");
        assert!(svg.contains("aria-label=\"t&lt;\""));
        assert!(document(&scene, "t", Theme::Variables).contains("fill=\"var(--ink)\""));
    }
}
