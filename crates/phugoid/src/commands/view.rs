//! `phugoid view`.

use phugoid_live::view::{Finished, ViewError};

use crate::arguments::View;
use crate::failure::Failure;
use crate::output::print;

pub(crate) fn run(arguments: &View) -> Result<(), Failure> {
    let named = |error: ViewError| Failure::input(format!("`{}`: {error}", arguments.result.display()));
    let finished = Finished::read_path(&arguments.result).map_err(named)?;
    let page = finished.html().map_err(named)?;
    let Some(file) = &arguments.html else { return serve(arguments, page) };
    std::fs::write(file, page).map_err(|e| Failure::writing_of("--html", file, e))?;
    print(&format!("{}: {} samples\n", file.display(), finished.rows()))
}

/// Serves the page until the program is ended.
#[cfg(feature = "live")]
fn serve(arguments: &View, page: String) -> Result<(), Failure> {
    let server = super::server::listen(&arguments.address)?;
    super::live::say("Ctrl-C ends");
    server.serve_page(page).map_err(|error| super::server::no_page(&arguments.address, &error))
}

/// The command line asks for a file where there is no server.
#[cfg(not(feature = "live"))]
fn serve(_: &View, _: String) -> Result<(), Failure> {
    Err(Failure::input("this program was built without the server of pages: name a file with --html"))
}
