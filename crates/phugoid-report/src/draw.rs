//! A figure as SVG or PNG: layout first, then one of the writers.

use crate::error::ReportError;
use crate::figure::Figure;
use crate::scene::Theme;
use crate::{layout, png, svg};

impl Figure {
    /// The figure as a free-standing SVG document with its title, on white, text as text.
    pub fn to_svg(&self) -> String {
        svg::document(&layout::scene(self, true), &self.title, Theme::Paper)
    }

    /// The figure as an `<svg>` element for a page that defines the colours of [`Colour`] as style variables
    /// (`--ink`, `--blue`, ...) and shows title and caption itself.
    pub fn to_inline_svg(&self) -> String {
        svg::document(&layout::scene(self, false), &self.title, Theme::Variables)
    }

    /// The figure as a PNG file, 1920 px wide.
    ///
    /// # Errors
    /// [`ReportError::Raster`] if the figure is too large for a picture or the encoder fails.
    pub fn to_png(&self) -> Result<Vec<u8>, ReportError> {
        png::encode(&layout::scene(self, true), &self.title)
    }
}
