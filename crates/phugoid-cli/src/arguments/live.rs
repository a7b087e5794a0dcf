//! `phugoid live`.

use std::path::PathBuf;

use clap::Args;
use phugoid_flight_data::memory::Memory;
use phugoid_identification::method::Method;
use phugoid_live::source::{SenderSpec, SourceSpec};

use super::help::examples_and_exit_codes;
use super::method::causal_method;
use super::reading::Reading;

/// Estimates while the aircraft flies, from telemetry, or replays a recorded flight in the same way
#[derive(Debug, Args)]
#[command(after_help = examples_and_exit_codes(
    "  phugoid live udp://14550 --model jet.toml                MAVLink, JSON lines or CSV at this port
  phugoid live serial:/dev/ttyUSB0:57600 --model jet.toml  a telemetry radio
  my-program | phugoid live - --model jet.toml             CSV with a header line, or JSON lines
  phugoid live --replay flight.csv --speed 10 --model f16  a recorded flight, ten times as fast
  phugoid live --replay flight.phugoid-live --speed max    a recording: the same estimates again"
))]
pub(crate) struct Live {
    /// Where the data come from: udp://HOST:PORT or udp://PORT, tcp://HOST:PORT, tcp-listen://PORT, serial:DEVICE:BAUD,
    /// or - (standard input)
    #[arg(value_name = "SOURCE", required_unless_present = "replay", conflicts_with = "replay")]
    pub(crate) source: Option<SourceSpec>,
    /// Replay a recording of `phugoid live`, or any other recorded flight, instead of receiving data
    #[arg(long, value_name = "FILE")]
    pub(crate) replay: Option<PathBuf>,
    /// Speed of the replay: a factor of real time, or `max` for as fast as the computer can
    #[arg(long, value_name = "FACTOR|max", default_value = "1", allow_negative_numbers = true, value_parser = speed, requires = "replay")]
    pub(crate) speed: Speed,
    #[command(flatten)]
    pub(crate) reading: Reading,
    /// The aircraft: a model file, or the name of a built-in one. A recording of `phugoid live` contains its model
    #[arg(long, value_name = "AIRCRAFT.toml", required_unless_present = "replay")]
    pub(crate) model: Option<String>,
    /// Estimator [default: the one that the model file names, or smpe]
    #[arg(long, value_parser = causal_method())]
    pub(crate) method: Option<Method>,
    /// Do not look for sudden changes of the coefficients
    #[arg(long)]
    pub(crate) no_change_detection: bool,
    /// Look for sudden changes even where the model file says not to
    #[arg(long, conflicts_with = "no_change_detection")]
    pub(crate) change_detection: bool,
    /// Write the JSON lines to this file instead of standard output
    #[arg(long, value_name = "FILE")]
    pub(crate) out: Option<PathBuf>,
    /// Show the estimates in the terminal; the JSON lines are then written only to the file of --out
    #[arg(long)]
    pub(crate) tui: bool,
    /// Write every estimate instead of at most fifty per second
    #[arg(long)]
    pub(crate) all: bool,
    /// Record all received data to this file [default: phugoid-TIME.phugoid-live; a replay records nothing]
    #[arg(long, value_name = "FILE", conflicts_with = "no_record")]
    pub(crate) record: Option<PathBuf>,
    /// Most that the recording may take, as in 500MB or 2GB, at least 4MB: it is written in parts, and the oldest are
    /// removed [default: no limit]
    #[arg(long, value_name = "SIZE", conflicts_with = "no_record", allow_hyphen_values = true, value_parser = size)]
    pub(crate) record_limit: Option<u64>,
    /// Do not record the received data
    #[arg(long)]
    pub(crate) no_record: bool,
    /// How long a MAVLink sample waits for earlier messages that are still missing, in milliseconds; 0 does not wait
    #[arg(long, value_name = "MS", default_value_t = 4.0, allow_negative_numbers = true, value_parser = window)]
    pub(crate) reorder_ms: f64,
    /// Use this sender only: its address, as in 10.0.0.7 or 10.0.0.7:14550 [default: the first that gives a sample]
    #[arg(long, value_name = "HOST[:PORT]")]
    pub(crate) sender: Option<SenderSpec>,
    /// Use only MAVLink messages that are signed with the key in this file: 32 bytes, or 64 hexadecimal digits
    #[arg(long, value_name = "FILE")]
    pub(crate) mavlink_key: Option<PathBuf>,
    /// Listen to this MAVLink system only
    #[arg(long, value_name = "ID", allow_negative_numbers = true)]
    pub(crate) system: Option<u8>,
    /// The MAVLink message that gives the samples their times, for example ATTITUDE
    #[arg(long, value_name = "MESSAGE")]
    pub(crate) base: Option<String>,
    /// Send the estimates as MAVLink debug messages to this address, five times per second, for example
    /// udp://127.0.0.1:14551
    #[arg(long, value_name = "udp://HOST:PORT")]
    pub(crate) mavlink_out: Option<String>,
    #[cfg(feature = "live")]
    #[command(flatten)]
    pub(crate) page: Page,
}

/// The web page that shows the estimates.
#[cfg(feature = "live")]
#[derive(Debug, Args)]
pub(crate) struct Page {
    #[command(flatten)]
    pub(crate) address: super::address::Address,
    /// Do not serve the web page
    #[arg(long)]
    pub(crate) no_page: bool,
}

/// Speed of a replay.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Speed {
    /// A factor of real time: 2 replays a flight of 10 s in 5 s.
    Times(f64),
    /// As fast as the computer can, without waiting between samples.
    Max,
}

fn speed(text: &str) -> Result<Speed, String> {
    match text.parse::<f64>() {
        _ if text == "max" => Ok(Speed::Max),
        Ok(times) if times > 0.0 && times <= 1e6 => Ok(Speed::Times(times)),
        _ => Err("write a factor, as in 1 or 10, or max".to_owned()),
    }
}

fn size(text: &str) -> Result<u64, String> {
    match text.parse::<Memory>() {
        Ok(size) if size.bytes() >= 4_000_000 => Ok(size.bytes()),
        _ => Err("write a number of MB or GB, as in 500MB or 2GB, at least 4MB".to_owned()),
    }
}

fn window(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(ms) if (0.0..=10_000.0).contains(&ms) => Ok(ms),
        _ => Err("write milliseconds between 0 and 10000, as in 4".to_owned()),
    }
}
