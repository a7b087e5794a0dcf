//! Arguments of `phugoid live`.

use std::path::PathBuf;

use clap::Args;
use phugoid_identification::method::Method;
use phugoid_live::source::SourceSpec;

use super::help::examples_and_exit_codes;
use super::method::method;

/// Estimates while the aircraft flies, from telemetry, or from a recorded flight as if it were flying
#[derive(Debug, Args)]
#[command(after_help = examples_and_exit_codes(
    "  phugoid live udp://14550 --model jet.toml                MAVLink (or JSON lines, or CSV) sent to this port
  phugoid live serial:/dev/ttyUSB0:57600 --model jet.toml  a telemetry radio
  my-program | phugoid live - --model jet.toml             CSV with a header line, or JSON lines
  phugoid live --replay flight.csv --speed 10 --model f16  a recorded flight, ten times as fast
  phugoid live --replay flight.phugoid-live --speed max    a recording of `phugoid live`: the same estimates again"
))]
pub(crate) struct Live {
    /// Where the data come from: udp://HOST:PORT or udp://PORT, tcp://HOST:PORT, tcp-listen://PORT, serial:DEVICE:BAUD, or -
    /// (standard input)
    #[arg(value_name = "SOURCE", required_unless_present = "replay", conflicts_with = "replay")]
    pub(crate) source: Option<SourceSpec>,
    /// Play a recording of `phugoid live`, or any recorded flight, as if it were happening
    #[arg(long, value_name = "FILE")]
    pub(crate) replay: Option<PathBuf>,
    /// How fast the replay goes: a factor, or `max`
    #[arg(long, value_name = "FACTOR|max", default_value = "1", value_parser = speed, requires = "replay")]
    pub(crate) speed: Speed,
    /// The aircraft: a model file, or the name of a built-in one. A recording has its own
    #[arg(long, value_name = "AIRCRAFT.toml", required_unless_present = "replay")]
    pub(crate) model: Option<String>,
    /// Estimator; without it the model file's, or smpe
    #[arg(long, value_parser = method())]
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
    /// Show the estimates in the terminal; the JSON lines then go to --out alone
    #[arg(long)]
    pub(crate) tui: bool,
    /// Write every estimate, not fifty a second
    #[arg(long)]
    pub(crate) all: bool,
    /// Record everything that is received to this file [default: phugoid-TIME.phugoid-live; nothing in a replay]
    #[arg(long, value_name = "FILE", conflicts_with = "no_record")]
    pub(crate) record: Option<PathBuf>,
    /// Record nothing
    #[arg(long)]
    pub(crate) no_record: bool,
    /// How long a MAVLink sample waits for messages that were sent before it and have not come, in milliseconds; 0: not at all
    #[arg(long, value_name = "MS", default_value_t = 4.0, value_parser = window)]
    pub(crate) reorder_ms: f64,
    /// Listen to this MAVLink system only
    #[arg(long, value_name = "ID")]
    pub(crate) system: Option<u8>,
    /// The MAVLink message whose times the samples have, such as ATTITUDE
    #[arg(long, value_name = "MESSAGE")]
    pub(crate) base: Option<String>,
    /// Send the estimates on as MAVLink debug messages, five times a second, as in udp://127.0.0.1:14551
    #[arg(long, value_name = "udp://HOST:PORT")]
    pub(crate) mavlink_out: Option<String>,
    #[cfg(feature = "live")]
    #[command(flatten)]
    pub(crate) page: Page,
}

/// Where the page is served.
#[cfg(feature = "live")]
#[derive(Debug, Args)]
pub(crate) struct Page {
    #[command(flatten)]
    pub(crate) address: super::address::Address,
    /// Serve no page
    #[arg(long)]
    pub(crate) no_page: bool,
}

/// How fast a replay goes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Speed {
    /// This many times as fast as it happened.
    Times(f64),
    /// As fast as the machine can.
    Max,
}

fn speed(text: &str) -> Result<Speed, String> {
    match text.parse::<f64>() {
        _ if text == "max" => Ok(Speed::Max),
        Ok(times) if times > 0.0 && times <= 1e6 => Ok(Speed::Times(times)),
        _ => Err("write a factor, as in 1 or 10, or max".to_owned()),
    }
}

fn window(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(ms) if (0.0..=10_000.0).contains(&ms) => Ok(ms),
        _ => Err("write milliseconds between 0 and 10000, as in 4".to_owned()),
    }
}
