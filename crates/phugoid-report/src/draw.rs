//! A figure as SVG or PNG: layout first, then one of the writers.

use crate::error::ReportError;
use crate::figure::Figure;
use crate::scene::Theme;
use crate::{layout, png, svg};

impl Figure {
    /// The figure as an SVG document of its own: with its title, on white, with text as text.
    pub fn to_svg(&self) -> String {
        svg::document(&layout::scene(self, true), &self.title, Theme::Paper)
    }

    /// The figure as an `<svg>` element for a page that shows title and caption itself and defines the colours of
    /// [`Colour`](crate::figure::Colour) as style variables (`--ink`, `--blue`, ...).
    ///
    /// ```
    /// let figure = phugoid_report::Figure { title: "Inputs".to_owned(), ..Default::default() };
    /// assert!(!figure.to_inline_svg().contains(">Inputs</text>"));
    /// assert!(figure.to_svg().contains(">Inputs</text>"));
    /// ```
    pub fn to_inline_svg(&self) -> String {
        svg::document(&layout::scene(self, false), &self.title, Theme::Variables)
    }

    /// The bytes of a PNG file, on white, with two pixels for each px of the layout: 1920 pixels wide.
    ///
    /// # Errors
    /// [`ReportError::Raster`] if the figure is too large for a picture or the encoder fails, [`ReportError::Font`] if
    /// the embedded font is damaged.
    pub fn to_png(&self) -> Result<Vec<u8>, ReportError> {
        png::encode(&layout::scene(self, true), &self.title)
    }
}
