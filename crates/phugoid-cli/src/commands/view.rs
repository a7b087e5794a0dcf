//! `phugoid view`.

use phugoid_flight_data::output_file;
use std::io;
use std::sync::Arc;

use phugoid_live::publish::WhenSlow;
use phugoid_live::recording::Reader;
use phugoid_live::run::Live;
use phugoid_live::source::{Pace, Replay};
use phugoid_live::stop::Stop;
use phugoid_live::view::{Collector, Finished, ViewError};

use super::flight::{Flight, recording};
use super::live::{failure, say};
use crate::arguments::View;
use crate::failure::Failure;
use crate::output::print;

pub(crate) fn run(arguments: &View) -> Result<(), Failure> {
    let named = |error: ViewError| Failure::input(format!("`{}`: {error}", arguments.result.display()));
    let finished = match recording(&arguments.result)? {
        Some(reader) => replayed(reader, &arguments.result.display().to_string())?.finish().map_err(named)?,
        None => Finished::read_path(&arguments.result).map_err(named)?,
    };
    let page = finished.html().map_err(named)?;
    let Some(file) = &arguments.html else { return serve(arguments, page) };
    output_file::write(file, page).map_err(|e| Failure::writing_of("--html", file, e))?;
    print(&format!("{}: {} samples\n", file.display(), finished.rows()))
}

/// The documents that `phugoid live --replay` would publish for a recording.
fn replayed(reader: Reader, name: &str) -> Result<Collector, Failure> {
    say(&format!("{name} is a recording: what was received is estimated again"));
    let flight = Flight::of(reader.header())?;
    let live = Live {
        model: &flight.model,
        model_text: &flight.text,
        options: &flight.options,
        receiver: &flight.receiver,
        record: None,
        record_limit: None,
        all: true,
        when_slow: WhenSlow::Wait,
        replayed: true,
        started_wall_ns: Some(reader.header().started_wall_ns),
    };
    let mut collector = Collector::default();
    let source = Replay::recording(reader, name, Pace::Unlimited).into();
    live.run(source, io::sink(), &mut [&mut collector], &Arc::new(Stop::default())).map_err(failure)?;
    Ok(collector)
}

/// Serves the page until the program is ended.
#[cfg(feature = "live")]
fn serve(arguments: &View, page: String) -> Result<(), Failure> {
    let server = super::server::listen(&arguments.address)?;
    say("Ctrl-C ends");
    server.serve_page(page).map_err(|error| super::server::no_page(&arguments.address, &error))
}

/// The failure of a build without the server, where the command line requires `--html`.
#[cfg(not(feature = "live"))]
fn serve(_: &View, _: String) -> Result<(), Failure> {
    Err(Failure::input("this program was built without the server of pages: name a file with --html"))
}
