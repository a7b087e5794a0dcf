//! `phugoid live`.

use std::fs::File;
use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{SystemTime, UNIX_EPOCH};

use phugoid_flight_data::reader::{self, ReadOptions};
use phugoid_identification::estimate::EstimateOptions;
use phugoid_identification::method::Method;
use phugoid_identification::model_file::ModelFile;
use phugoid_live::mavlink::{DebugMessages, MavlinkOptions};
use phugoid_live::publish::WhenSlow;
use phugoid_live::receiver::ReceiverOptions;
use phugoid_live::recording::Reader;
use phugoid_live::run::{Audience, Live, LiveError};
use phugoid_live::source::{Pace, Replay, Source, SourceSpec};
use phugoid_studies::named;

use super::screen;
use crate::arguments::live::{Live as Arguments, Speed};
use crate::failure::Failure;

pub(crate) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let recording = arguments.replay.as_deref().map(recording).transpose()?.flatten();
    let (name, text) = match (&arguments.model, &recording) {
        (Some(wanted), _) => named::model_text(wanted).map_err(Failure::input)?,
        (None, Some(recording)) => (recording.header().model_name.clone(), recording.header().model_text.clone()),
        (None, None) => {
            let message = "--replay of a flight needs --model: only a recording of `phugoid live` has a model in it";
            return Err(Failure::input(message));
        }
    };
    let model = ModelFile::parse(&name, &text).map_err(Failure::input)?;
    let options = options(arguments, recording.as_ref())?;
    let receiver = ReceiverOptions { columns: model.columns(), mavlink: mavlink(arguments, recording.as_ref()) };
    let stop = Arc::new(AtomicBool::new(false));
    let source = source(arguments, recording, &model)?;
    let record = record(arguments);
    if let Some(file) = &record {
        say(&format!("recording to {}", file.display()));
    }
    // What comes from a pipe waits in the pipe; a flight does not wait for anybody.
    let piped = arguments.source == Some(SourceSpec::StandardInput);
    let waits = piped || (arguments.replay.is_some() && arguments.speed == Speed::Max);
    let live = Live {
        model: &model,
        model_text: &text,
        options: &options,
        receiver: &receiver,
        record,
        all: arguments.all,
        when_slow: if waits { WhenSlow::Wait } else { WhenSlow::LeaveOut },
        replayed: arguments.replay.is_some(),
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
        if ended.swap(true, Ordering::Relaxed) {
            std::process::exit(130);
        }
    });
    let estimate = |shown: Option<Box<dyn Audience>>| {
        audience.extend(shown);
        live.run(source, out, &mut audience, &stop)
    };
    let summary = match arguments.tui {
        true => screen::run(|listener| estimate(Some(listener)), &stop)?,
        false => estimate(None),
    };
    let summary = summary.map_err(failure)?;
    say(&format!("{} samples, {} estimates", summary.samples, summary.estimates));
    Ok(())
}

/// Starts the server of the page and says where it is.
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

/// A recording of this command, if the file is one.
fn recording(path: &Path) -> Result<Option<Reader>, Failure> {
    let mut start = [0; 4];
    let read = File::open(path).and_then(|file| file.take(4).read(&mut start));
    let read = read.map_err(|error| Failure::input(format!("cannot read `{}`: {error}", path.display())))?;
    match Reader::is_recording(start.get(..read).unwrap_or_default()) {
        true => Reader::open(path).map(Some).map_err(Failure::input),
        false => Ok(None),
    }
}

/// The choices of the command line, else those with which it was recorded.
fn options(arguments: &Arguments, recording: Option<&Reader>) -> Result<EstimateOptions, Failure> {
    let header = recording.map(Reader::header);
    let recorded = header.and_then(|header| header.method.as_deref()).map(str::parse::<Method>).transpose();
    let re_reaching = match (arguments.change_detection, arguments.no_change_detection) {
        (true, _) => Some(true),
        (_, true) => Some(false),
        _ => header.and_then(|header| header.change_detection),
    };
    let method = arguments.method.or(recorded.map_err(Failure::input)?);
    Ok(EstimateOptions { method, re_reaching, ..EstimateOptions::default() })
}

fn mavlink(arguments: &Arguments, recording: Option<&Reader>) -> MavlinkOptions {
    // The same samples again: the window with which it was recorded.
    let reorder_ns = recording.map(|recording| recording.header().reorder_ns);
    MavlinkOptions {
        reorder_ns: reorder_ns.unwrap_or((arguments.reorder_ms * 1e6) as u64),
        system: arguments.system.or(recording.and_then(|recording| recording.header().system)),
        base: arguments.base.clone().or(recording.and_then(|recording| recording.header().base.clone())),
    }
}

fn source(arguments: &Arguments, recording: Option<Reader>, model: &ModelFile) -> Result<Source, Failure> {
    let pace = match arguments.speed {
        Speed::Times(times) => Pace::Times(times),
        Speed::Max => Pace::Unlimited,
    };
    match (&arguments.source, &arguments.replay, recording) {
        (Some(spec), ..) => {
            Source::open(spec).map_err(|error| Failure::input(format!("cannot receive from {spec}: {error}")))
        }
        (None, Some(path), Some(reader)) => Ok(Replay::recording(reader, &path.display().to_string(), pace).into()),
        (None, Some(path), None) => {
            let options = ReadOptions::with_columns(model.columns());
            let record = reader::read_path(path, &options).map_err(Failure::input)?;
            Ok(Replay::flight(record, pace).map_err(Failure::input)?.into())
        }
        (None, None, _) => Err(Failure::input("a source is needed, as in udp://14550, or --replay FILE")),
    }
}

/// Where to record: what was asked for; else, what is received and not replayed goes to a file named after the time.
fn record(arguments: &Arguments) -> Option<PathBuf> {
    if arguments.no_record {
        return None;
    }
    let named = || {
        let seconds = SystemTime::now().duration_since(UNIX_EPOCH).map(|since| since.as_secs()).unwrap_or_default();
        PathBuf::from(format!("phugoid-{seconds}.phugoid-live"))
    };
    arguments.record.clone().or_else(|| arguments.source.as_ref().map(|_| named()))
}

fn failure(error: LiveError) -> Failure {
    match error {
        LiveError::Recording { file, error } => Failure::writing_of("--record", &file, error),
        LiveError::Documents(error) => Failure::standard_output(&error),
        LiveError::Estimate(_) | LiveError::Thread(_) => Failure::input(error),
    }
}

/// A sentence for people, beside the documents.
pub(super) fn say(text: &str) {
    // Nobody is left to tell when standard error is closed.
    let _ = writeln!(io::stderr(), "{text}");
}
