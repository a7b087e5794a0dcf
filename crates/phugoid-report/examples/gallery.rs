//! Draws made-up estimations, to look at: `cargo run -p phugoid-report --example gallery -- FOLDER`.

#[path = "../tests/synthetic/mod.rs"]
mod synthetic;

use std::path::PathBuf;

use phugoid_report::{ReportError, write_figures};

fn main() -> Result<(), ReportError> {
    let folder = PathBuf::from(std::env::args().nth(1).unwrap_or_else(|| "gallery".to_owned()));
    for case in [synthetic::fighter(), synthetic::jet()] {
        let estimation = synthetic::estimation(&case);
        let written = write_figures(&folder.join(case.source), &estimation)?;
        println!("{}: {} files", case.source, written.len());
    }
    Ok(())
}
