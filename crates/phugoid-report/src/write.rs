//! Writing figures as files.

use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};

use phugoid_flight_data::output_file;
use phugoid_identification::estimation::Estimation;

use crate::error::ReportError;
use crate::figure::Figure;
use crate::figures::figures;
use crate::svg;

/// Writes every figure of an estimation as `NAME.svg` and `NAME.png` into a folder, which is created if it does not
/// exist. Returns the paths in the order in which they were written. Each file is there whole or not at all.
///
/// # Errors
/// [`ReportError::Write`] with the path that could not be written, [`ReportError::Raster`] for a figure that could not
/// be drawn.
pub fn write_figures(dir: &Path, estimation: &Estimation) -> Result<Vec<PathBuf>, ReportError> {
    write_named_figures(dir, &figures(estimation))
}

/// Writes figures, each with its name, as `NAME.svg` and `NAME.png` into a folder, as [`write_figures`] does.
///
/// # Errors
/// As [`write_figures`].
pub fn write_named_figures(dir: &Path, figures: &[(String, Figure)]) -> Result<Vec<PathBuf>, ReportError> {
    let failed = |path: &Path| {
        let path = path.to_owned();
        move |source| ReportError::Write { path, source }
    };
    std::fs::create_dir_all(dir).map_err(failed(dir))?;
    let mut written = Vec::new();
    for (name, figure) in figures {
        let svg = dir.join(format!("{name}.svg"));
        output_file::write(&svg, figure.to_svg()).map_err(failed(&svg))?;
        written.push(svg);
        let png = dir.join(format!("{name}.png"));
        output_file::write(&png, figure.to_png()?).map_err(failed(&png))?;
        written.push(png);
    }
    Ok(written)
}

/// Whether a file is the drawing of a figure that this crate has written, of this or an earlier version. A picture in PNG shows
/// it by the drawing of the same name beside it.
pub fn is_figure(file: &Path) -> bool {
    // The style stands behind the title, which may be long.
    const BEGINNING: u64 = 16_384;
    let mut beginning = Vec::new();
    let read = File::open(file).and_then(|file| file.take(BEGINNING).read_to_end(&mut beginning));
    read.is_ok()
        && String::from_utf8_lossy(&beginning).split_once('>').is_some_and(|(tag, _)| tag.ends_with(svg::STYLE))
}
