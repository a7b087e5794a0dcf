//! Output options that several commands share: JSON or text, the output file, and the format of figures.

use std::path::PathBuf;

use clap::{Args, ValueEnum};

/// Output options of the commands whose result is one document.
#[derive(Debug, Args)]
pub(crate) struct Delivery {
    /// Print one JSON document (SI units and radians) instead of text
    #[arg(long)]
    pub(crate) json: bool,
    /// Also write the JSON document (SI units and radians) to this file
    #[arg(long, value_name = "FILE")]
    pub(crate) out: Option<PathBuf>,
}

/// File formats of figures.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum PictureFormat {
    /// Vector drawing; its text can be searched and edited
    Svg,
    /// Raster picture, 1920 pixels wide
    Png,
}
