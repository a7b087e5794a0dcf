//! `phugoid live`.

use std::fs::File;
use std::io::{self, Read, Write};
use std::path::PathBuf;
use std::sync::Arc;
use std::time::{SystemTime, UNIX_EPOCH};

use phugoid_flight_data::printable;
use phugoid_identification::model_file::ModelFile;
use phugoid_live::mavlink::{DebugMessages, Key};
use phugoid_live::publish::WhenSlow;
use phugoid_live::recording::{Header, Reader};
use phugoid_live::run::{Audience, Live, LiveError};
use phugoid_live::source::{Pace, Replay, Source, SourceSpec};
use phugoid_live::stop::{Stop, Why};

use super::flight::{Flight, recording};
use super::screen;
use crate::arguments::live::{Live as Arguments, Speed};
use crate::failure::Failure;

pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let recording = arguments.replay.as_deref().map(recording).transpose()?.flatten();
    let mut flight = Flight::of(&settings(arguments, recording.as_ref().map(Reader::header))?)?;
    if let Some(recording) = &recording {
        say_whose_mapping(recording.header(), &flight.model);
    }
    flight.receiver.mavlink.key = key(arguments, recording.as_ref().map(Reader::header))?;
    let started_wall_ns = recording.as_ref().map(|recording| recording.header().started_wall_ns);
    let stop = Arc::new(Stop::default());
    let source = source(arguments, recording, &flight)?;
    let record = record(arguments);
    if let Some(file) = &record {
        say(&format!("recording to {}", file.display()));
    }
    // What comes from a pipe waits in the pipe; a flight does not wait for anybody.
    let piped = arguments.source == Some(SourceSpec::StandardInput);
    let waits = piped || (arguments.replay.is_some() && arguments.speed == Speed::Max);
    let live = Live {
        model: &flight.model,
        model_text: &flight.text,
        options: &flight.options,
        receiver: &flight.receiver,
        record,
        record_limit: arguments.record_limit,
        all: arguments.all,
        when_slow: if waits { WhenSlow::Wait } else { WhenSlow::LeaveOut },
        replayed: arguments.replay.is_some(),
        started_wall_ns,
    };
    let out: Box<dyn Write + Send> = match &arguments.out {
        Some(file) => Box::new(File::create(file).map_err(|e| Failure::writing(file, e))?),
        None if arguments.tui => Box::new(io::sink()),
        None => Box::new(io::stdout()),
    };
    let mut audience: Vec<Box<dyn Audience>> = Vec::new();
    if let Some(address) = &arguments.mavlink_out {
        audience.push(Box::new(DebugMessages::to(address).map_err(Failure::input)?));
    }
    #[cfg(feature = "live")]
    audience.extend(page(&arguments.page)?);
    // A second Ctrl-C, or a system without signals: the recording survives it.
    let ended = Arc::clone(&stop);
    let _ = ctrlc::set_handler(move || {
        if !ended.ask(Why::Signal) {
            std::process::exit(130);
        }
    });
    let estimate = |shown: Option<Box<dyn Audience>>| {
        audience.extend(shown);
        let mut listeners: Vec<&mut dyn Audience> = Vec::new();
        listeners.extend(audience.iter_mut().map(|listener| &mut **listener as &mut dyn Audience));
        live.run(source, out, &mut listeners, &stop)
    };
    let summary = match arguments.tui {
        true => screen::run(|listener| estimate(Some(listener)), &stop)?,
        false => estimate(None),
    };
    let summary = summary.map_err(failure)?;
    say(&format!("{} samples, {} estimates", summary.samples, summary.estimates));
    match summary.missing {
        Some(missing) if summary.samples == 0 => Err(Failure::input(missing)),
        // Whoever ends a flight before it has begun knows that; a recorded flight, and one that is piped in, has been seen to its
        // end.
        Some(missing) if (piped || arguments.replay.is_some()) && stop.asked() == Some(Why::Over) => {
            Err(Failure::impossible(format!("no estimate could be made: {missing}")))
        }
        Some(missing) => {
            say(&format!("no estimate was made: {missing}"));
            Ok(())
        }
        None => Ok(()),
    }
}

/// Says so if a recording has rows that another model file has mapped than the one that is asked for.
fn say_whose_mapping(recorded: &Header, model: &ModelFile) {
    let as_recorded = || {
        let recorded = ModelFile::parse(&recorded.model_name, &recorded.model_text);
        recorded.is_ok_and(|recorded| recorded.channels == model.channels)
    };
    if recorded.mapped && !as_recorded() {
        say(&format!(
            "the channels of this recording are as the [channels] of `{}` gave them when a flight was replayed; \
             those of `{}` are not applied",
            recorded.model_name, model.source
        ));
    }
}

/// The key with which MAVLink has to be signed. A recording does not hold the one that it was made with.
fn key(arguments: &Arguments, recorded: Option<&Header>) -> Result<Option<Key>, Failure> {
    let Some(file) = &arguments.mavlink_key else {
        if recorded.is_some_and(|recorded| recorded.signed) {
            say("signatures were verified when this was recorded; without --mavlink-key they are not verified now");
        }
        return Ok(None);
    };
    let wrong = |why: String| Failure::input(format!("--mavlink-key {}: {why}", file.display()));
    // No key is longer, whatever the file is.
    let mut bytes = Vec::new();
    let read = File::open(file).and_then(|file| file.take(1024).read_to_end(&mut bytes));
    read.map_err(|error| wrong(error.to_string()))?;
    Key::parse(&bytes).map(Some).map_err(|error| wrong(error.to_string()))
}

/// Starts the server of the page and prints its address.
#[cfg(feature = "live")]
fn page(page: &crate::arguments::live::Page) -> Result<Option<Box<dyn Audience>>, Failure> {
    use phugoid_live::server::Hub;

    if page.no_page {
        return Ok(None);
    }
    let server = super::server::listen(&page.address)?;
    let hub = Hub::default();
    server.spawn(hub.clone()).map_err(|error| super::server::no_page(&page.address, &error))?;
    Ok(Some(Box::new(hub)))
}

/// The settings of the command line; those that are not given are taken from the recording.
fn settings(arguments: &Arguments, recorded: Option<&Header>) -> Result<Header, Failure> {
    let (model_name, model_text) = match (&arguments.model, recorded) {
        (Some(wanted), _) => ModelFile::find_text(wanted).map_err(Failure::input)?,
        (None, Some(recorded)) => (recorded.model_name.clone(), recorded.model_text.clone()),
        (None, None) => {
            let message = "--replay of a flight needs --model: only a recording of `phugoid live` has a model in it";
            return Err(Failure::input(message));
        }
    };
    let change_detection = match (arguments.change_detection, arguments.no_change_detection) {
        (true, _) => Some(true),
        (_, true) => Some(false),
        _ => recorded.and_then(|recorded| recorded.change_detection),
    };
    let method = arguments.method.map(|method| method.name().to_owned());
    let sender = arguments.sender.as_ref().map(ToString::to_string);
    Ok(Header {
        model_name,
        model_text,
        method: method.or(recorded.and_then(|recorded| recorded.method.clone())),
        change_detection,
        // The same samples again: the window with which it was recorded.
        reorder_ns: recorded.map_or((arguments.reorder_ms * 1e6) as u64, |recorded| recorded.reorder_ns),
        system: arguments.system.or(recorded.and_then(|recorded| recorded.system)),
        base: arguments.base.clone().or(recorded.and_then(|recorded| recorded.base.clone())),
        sender: sender.or(recorded.and_then(|recorded| recorded.sender.clone())),
        ..Header::default()
    })
}

fn source(arguments: &Arguments, recording: Option<Reader>, flight: &Flight) -> Result<Source, Failure> {
    let pace = match arguments.speed {
        Speed::Times(times) => Pace::Times(times),
        Speed::Max => Pace::Unlimited,
    };
    match (&arguments.source, &arguments.replay, recording) {
        (Some(spec), ..) => {
            let opened = Source::open_for(spec, flight.receiver.sender.as_ref());
            opened.map_err(|error| Failure::input(format!("cannot receive from {spec}: {error}")))
        }
        (None, Some(path), Some(reader)) => Ok(Replay::recording(reader, &path.display().to_string(), pace).into()),
        (None, Some(path), None) => {
            let record =
                flight.model.open_record_with(path, &arguments.reading.options(path)?).map_err(Failure::input)?;
            Ok(Replay::flight(record, pace).map_err(Failure::input)?.into())
        }
        (None, None, _) => Err(Failure::input("a source is needed, as in udp://14550, or --replay FILE")),
    }
}

/// File to record to: the one of `--record`, else a file with the time in its name. A replay is not recorded by
/// default.
fn record(arguments: &Arguments) -> Option<PathBuf> {
    if arguments.no_record {
        return None;
    }
    let named = || {
        let seconds = SystemTime::now().duration_since(UNIX_EPOCH).map(|since| since.as_secs()).unwrap_or_default();
        // Another one may have begun in this second.
        let names = std::iter::once(String::new()).chain((2..1000).map(|number| format!("-{number}")));
        let mut files = names.map(|more| PathBuf::from(format!("phugoid-{seconds}{more}.phugoid-live")));
        files.find(|file| !file.exists()).unwrap_or_else(|| PathBuf::from("phugoid.phugoid-live"))
    };
    arguments.record.clone().or_else(|| arguments.source.as_ref().map(|_| named()))
}

pub(super) fn failure(error: LiveError) -> Failure {
    match error {
        LiveError::Recording { file, error } => Failure::writing_of("--record", &file, error),
        LiveError::Documents(error) => Failure::standard_output(&error),
        LiveError::Estimate(_) | LiveError::Thread(_) => Failure::input(error),
    }
}

/// Prints a message to standard error; standard output is reserved for the JSON documents.
pub(super) fn say(text: &str) {
    // Nobody is left to tell when standard error is closed.
    let _ = writeln!(io::stderr(), "{}", printable::lines(&printable::brief(text)));
}
