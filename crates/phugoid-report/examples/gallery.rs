//! Draws made-up estimations, to look at: `cargo run -p phugoid-report --example gallery -- FOLDER`.

#[path = "../tests/synthetic/mod.rs"]
mod synthetic;

use std::path::PathBuf;

use phugoid_report::{HtmlOptions, ReportError, html, write_figures};

fn main() -> Result<(), ReportError> {
    let folder = PathBuf::from(std::env::args().nth(1).unwrap_or_else(|| "gallery".to_owned()));
    for case in [synthetic::fighter(), synthetic::jet(), synthetic::many(24)] {
        let estimation = synthetic::estimation(&case);
        let written = write_figures(&folder.join(case.source), &estimation)?;
        let page = folder.join(format!("{}.html", case.source));
        let options = HtmlOptions {
            notes: vec![
                "A made-up estimation to look at the page with; no flight and no estimator is behind it.".to_owned(),
            ],
            settings: vec![("Window of the change test".to_owned(), "1 s".to_owned())],
            ..HtmlOptions::default()
        };
        std::fs::write(&page, html(&estimation, &options))
            .map_err(|source| ReportError::Write { path: page.clone(), source })?;
        println!("{}: {} files and {}", case.source, written.len(), page.display());
    }
    Ok(())
}
