//! `phugoid view`.

use phugoid_live::view::{Finished, ViewError};

use crate::arguments::View;
use crate::failure::Failure;
use crate::output::print;

pub(crate) fn run(arguments: &View) -> Result<(), Failure> {
    let named = |error: ViewError| Failure::input(format!("`{}`: {error}", arguments.result.display()));
    let finished = Finished::read_path(&arguments.result).map_err(named)?;
    let page = finished.html().map_err(named)?;
    std::fs::write(&arguments.html, page).map_err(|e| Failure::writing_of("--html", &arguments.html, e))?;
    print(&format!("{}: {} samples\n", arguments.html.display(), finished.rows()))
}
