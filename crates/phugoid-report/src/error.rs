//! Errors of drawing figures and of writing files.

use std::path::PathBuf;

/// Why a figure or a page could not be drawn or written.
#[derive(Debug, thiserror::Error)]
pub enum ReportError {
    /// A file or folder could not be written.
    #[error(
        "cannot write {path}: {source}; check that the folder can be written to, or name another one",
        path = path.display()
    )]
    Write {
        /// The file or folder that could not be written.
        path: PathBuf,
        /// What the operating system said.
        source: std::io::Error,
    },
    /// A figure could not be turned into a picture of pixels.
    #[error(
        "cannot draw the figure \"{figure}\" as a PNG picture ({width} x {height} px): {reason}; use its SVG instead"
    )]
    Raster {
        /// Title of the figure that was drawn.
        figure: String,
        /// Width of the picture, pixels.
        width: u32,
        /// Height of the picture, pixels.
        height: u32,
        /// What the rasteriser or the encoder said.
        reason: String,
    },
    /// The embedded font could not be read: the program was built from damaged files.
    #[error("the embedded font {name} cannot be read: {reason}; build the program from an intact copy of its sources")]
    Font {
        /// File name of the font.
        name: &'static str,
        /// What the font reader said.
        reason: String,
    },
}
