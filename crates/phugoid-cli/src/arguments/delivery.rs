//! Where results go, and in which form.

use std::path::PathBuf;

use clap::{Args, ValueEnum};

/// Where results go, for commands whose result is one document.
#[derive(Debug, Args)]
pub(crate) struct Delivery {
    /// Print one JSON document (SI units and radians) instead of text
    #[arg(long)]
    pub(crate) json: bool,
    /// Write the JSON document to this file too
    #[arg(long, value_name = "FILE")]
    pub(crate) out: Option<PathBuf>,
}

/// Formats of figures.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum PictureFormat {
    /// Drawing, text as text
    Svg,
    /// Picture, 1920 px wide
    Png,
}
