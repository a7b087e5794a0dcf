//! The embedded font: widths of text for the layout, and outlines for pictures.

use ab_glyph::{Font, FontRef, OutlineCurve};

use crate::error::ReportError;

const REGULAR: &[u8] = include_bytes!("../assets/Inter-Regular.otf");
const SEMI_BOLD: &[u8] = include_bytes!("../assets/Inter-SemiBold.otf");

/// The two weights of the font of the figures, Inter.
pub(crate) struct Fonts {
    regular: FontRef<'static>,
    semi_bold: FontRef<'static>,
}

impl Fonts {
    /// Reads the embedded font.
    pub(crate) fn load() -> Result<Self, ReportError> {
        let read = |name, bytes| {
            FontRef::try_from_slice(bytes).map_err(|error| ReportError::Font { name, reason: error.to_string() })
        };
        Ok(Self { regular: read("Inter-Regular.otf", REGULAR)?, semi_bold: read("Inter-SemiBold.otf", SEMI_BOLD)? })
    }

    fn face(&self, bold: bool) -> &FontRef<'static> {
        if bold { &self.semi_bold } else { &self.regular }
    }

    /// Outlines of a text in units of the font size (em): baseline at 0, y up, starting at x = 0.
    pub(crate) fn outline(&self, text: &str, bold: bool) -> Vec<OutlineCurve> {
        let face = self.face(bold);
        let em = face.units_per_em().unwrap_or(2048.0);
        let mut advance = 0.0;
        let mut curves = Vec::new();
        for character in text.chars() {
            let glyph = face.glyph_id(character);
            if let Some(outline) = face.outline(glyph) {
                let place = |p: ab_glyph::Point| ab_glyph::point((p.x + advance) / em, p.y / em);
                curves.extend(outline.curves.into_iter().map(|curve| match curve {
                    OutlineCurve::Line(a, b) => OutlineCurve::Line(place(a), place(b)),
                    OutlineCurve::Quad(a, b, c) => OutlineCurve::Quad(place(a), place(b), place(c)),
                    OutlineCurve::Cubic(a, b, c, d) => OutlineCurve::Cubic(place(a), place(b), place(c), place(d)),
                }));
            }
            advance += face.h_advance_unscaled(glyph);
        }
        curves
    }

    /// Width of a text in units of the font size (em).
    pub(crate) fn width_in_em(&self, text: &str, bold: bool) -> f64 {
        let face = self.face(bold);
        let em = face.units_per_em().unwrap_or(2048.0);
        let advance: f32 = text.chars().map(|c| face.h_advance_unscaled(face.glyph_id(c))).sum();
        f64::from(advance / em)
    }
}

/// Width that the layout reserves for a text of this font size, px. It is 4 % more than the font needs, because a
/// reader of the SVG may not have the font and use a wider one.
pub(crate) fn reserved_width(fonts: Option<&Fonts>, text: &str, size: f64, bold: bool) -> f64 {
    // Without a font, which happens only in a damaged build, a mean width of 0.6 em is assumed.
    let em = fonts.map_or_else(|| 0.6 * text.chars().count() as f64, |fonts| fonts.width_in_em(text, bold));
    1.04 * em * size
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_embedded_font_has_what_figures_print() {
        let fonts = Fonts::load().unwrap();
        for bold in [false, true] {
            for character in "aZ09 −–±·×°²³⁻⁰¹⁴⁵⁶⁷⁸⁹αβθφψδσΔ→≤≥/().,:é".chars()
            {
                assert_ne!(fonts.face(bold).glyph_id(character).0, 0, "{character} is missing");
            }
        }
    }

    #[test]
    fn widths_follow_the_text() {
        let fonts = Fonts::load().unwrap();
        let one = fonts.width_in_em("0", false);
        assert!((fonts.width_in_em("00", false) - 2.0 * one).abs() < 1e-6);
        // Inter's figures are a little wider than half an em.
        assert!(one > 0.5 && one < 0.75, "{one}");
    }
}
