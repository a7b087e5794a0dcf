//! `phugoid fleet view`.

use std::path::Path;

use phugoid_fleet::page::{self, Reports};
use phugoid_fleet::reports::{Made, ReportsError, Which, make, task_of};
use phugoid_fleet::statistics::tell::Findings;
use phugoid_fleet::store::Store;
use phugoid_flight_data::output_file;
use phugoid_report::HtmlOptions;

use crate::arguments::fleet::{ReportsWord, View};
use crate::failure::Failure;
use crate::output::print;
use crate::progress::Progress;

/// Writes the page, and the reports to which it leads.
pub(super) fn run(arguments: &View) -> Result<(), Failure> {
    let findings = super::fleet_tell::findings(&arguments.store, &arguments.asking)?;
    let made = match arguments.reports {
        ReportsWord::None => None,
        ReportsWord::Findings => Some(reports(arguments, &findings, Which::Findings)?),
        ReportsWord::All => Some(reports(arguments, &findings, Which::All)?),
    };
    let page = page::html(&findings, made.as_ref().map_or(&Reports::new(), |made| &made.reports));
    output_file::write(&arguments.html, page).map_err(|e| Failure::writing_of("--html", &arguments.html, e))?;
    let mut text = format!("Page: {}\n", arguments.html.display());
    if let Some(Made { reports, new, missing }) = &made {
        text += &format!("Reports: {} ({new} of them new)\n", reports.len());
        if let Some(first) = missing.first() {
            text += &format!(
                "Without a report: {} ({first}{})\n",
                missing.len(),
                if missing.len() > 1 { "; ..." } else { "" }
            );
        }
    }
    print(&text)
}

/// The reports in the folder beside the page that is called as the page.
fn reports(arguments: &View, findings: &Findings, which: Which) -> Result<Made, Failure> {
    let failed = |error: ReportsError| match error {
        ReportsError::Write { file, source } => Failure::writing_of("--reports", &file, source),
        other => Failure::input(format!("--reports: {other}")),
    };
    let store = Store::open(&arguments.store)?;
    let task = task_of(&findings.set, &store, arguments.model.as_deref()).map_err(failed)?;
    let stem = arguments.html.file_stem().and_then(|stem| stem.to_str()).unwrap_or("fleet");
    let name = format!("{stem}-reports");
    let folder = arguments.html.parent().unwrap_or(Path::new("")).join(&name);
    let progress = Progress::new("reports");
    let render = |estimation: &_| phugoid_report::html(estimation, &HtmlOptions::default());
    make(findings, which, &task, (&folder, &name), &render, &|done| progress.set(done)).map_err(failed)
}
