//! `phugoid fleet`.

use std::path::PathBuf;

use clap::{Args, Subcommand, ValueEnum};
use phugoid_fleet::shard::Shard;
use phugoid_fleet::unit::Segments;
use phugoid_identification::method::Method;

use super::delivery::Delivery;
use super::help::examples_and_exit_codes;
use super::method::method;

/// Estimates every manoeuvre of every log, each once, and keeps the results in a store of Parquet files
///
/// What is in the store already is not estimated again, so that the same command goes on after a stop of any kind and adds
/// what is new. docs/fleet.md describes the store and has questions to ask of it in SQL.
#[derive(Debug, Args)]
#[command(args_conflicts_with_subcommands = true, after_help = examples_and_exit_codes(
    "  phugoid fleet logs --model jet.toml --store fleet              every log of a folder, on all cores
  phugoid fleet 'logs/*/*.ulg' --model jet.toml --store fleet --shard 3/8
  phugoid fleet tell fleet                                       drifts, steps, outliers
  phugoid fleet view fleet --html fleet.html --reports findings  the same as a page, with the reports of what it has found
  phugoid fleet analyses fleet --dir analyses                    a document for each log, for Flight Review"
))]
pub(crate) struct Fleet {
    #[command(flatten)]
    pub(crate) estimating: Estimating,
    #[command(subcommand)]
    pub(crate) question: Option<Question>,
}

/// Estimation of many logs.
#[derive(Debug, Args)]
pub(crate) struct Estimating {
    /// Logs: files, folders (all flights in them and below), patterns such as 'logs/*/*.ulg'
    #[arg(value_name = "LOG", required = true)]
    pub(crate) logs: Vec<String>,
    /// Model file, or name of a built-in model
    #[arg(long, value_name = "FILE.toml", required = true)]
    pub(crate) model: Option<String>,
    /// Folder of the store; a new one is made. With --engine ray also an address, such as s3://bucket/fleet
    #[arg(long, value_name = "DIR", required = true)]
    pub(crate) store: Option<PathBuf>,
    /// Estimator [default: the one that the model file names, smpe]
    #[arg(long, value_parser = method())]
    pub(crate) method: Option<Method>,
    /// What is estimated by itself
    #[arg(long, value_enum, default_value_t)]
    pub(crate) segments: SegmentsWord,
    /// Table of flights (CSV): the columns log, airframe, and if wanted flight and hours. Without it an airframe is called as
    /// the folder of its logs, and flights count in the order of their names
    #[arg(long, value_name = "FILE.csv")]
    pub(crate) flights: Option<PathBuf>,
    /// Number of threads; each holds one log in memory [default: one per core]
    #[arg(long, value_name = "N", allow_negative_numbers = true, value_parser = clap::value_parser!(u16).range(1..=4096))]
    pub(crate) workers: Option<u16>,
    /// The i-th of n parts of the logs, for arrays of jobs on several machines with one store
    #[arg(long, value_name = "i/n", default_value_t)]
    pub(crate) shard: Shard,
    /// What does the work: local, threads of this program; ray, tasks of Ray, on this machine or on the cluster at
    /// ray://HOST:PORT. Ray is called by the Python package (pip install "phugoid[fleet]"), with python3 or what PHUGOID_PYTHON
    /// names
    #[arg(long, value_name = "ENGINE", default_value_t)]
    pub(crate) engine: Engine,
    #[command(flatten)]
    pub(crate) delivery: Delivery,
}

/// What does the work.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) enum Engine {
    /// Threads of this program.
    #[default]
    Local,
    /// Tasks of Ray, on this machine or on the cluster at this address.
    Ray(Option<String>),
}

impl std::fmt::Display for Engine {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Local => "local",
            Self::Ray(None) => "ray",
            Self::Ray(Some(address)) => address,
        })
    }
}

impl std::str::FromStr for Engine {
    type Err = String;

    fn from_str(word: &str) -> Result<Self, String> {
        match word {
            "local" => Ok(Self::Local),
            "ray" => Ok(Self::Ray(None)),
            address if address.starts_with("ray://") && address.len() > 6 => Ok(Self::Ray(Some(address.to_owned()))),
            other => Err(format!("`{other}` is no engine: expected local, ray or ray://HOST:PORT")),
        }
    }
}

/// Segments on the command line.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub(crate) enum SegmentsWord {
    /// Each manoeuvre
    #[default]
    Manoeuvres,
    /// The whole flight
    Whole,
}

impl From<SegmentsWord> for Segments {
    fn from(word: SegmentsWord) -> Self {
        match word {
            SegmentsWord::Manoeuvres => Self::Manoeuvres,
            SegmentsWord::Whole => Self::Whole,
        }
    }
}

/// What is asked of a store.
#[derive(Debug, Subcommand)]
pub(crate) enum Question {
    Tell(Tell),
    View(View),
    Analyses(Analyses),
}

/// Tells of each airframe the course of its parameters: means with combined bounds, drifts, steps, outliers
#[derive(Debug, Args)]
pub(crate) struct Tell {
    /// Folder of the store
    #[arg(value_name = "STORE")]
    pub(crate) store: PathBuf,
    #[command(flatten)]
    pub(crate) asking: Asking,
    #[command(flatten)]
    pub(crate) delivery: Delivery,
}

/// Writes what the fleet tells as a page, with a sparkline for each parameter of each airframe
#[derive(Debug, Args)]
pub(crate) struct View {
    /// Folder of the store
    #[arg(value_name = "STORE")]
    pub(crate) store: PathBuf,
    #[command(flatten)]
    pub(crate) asking: Asking,
    /// The page
    #[arg(long, value_name = "FILE.html", default_value = "fleet.html")]
    pub(crate) html: PathBuf,
    /// Segments of which the page leads to the whole report. Reports stand in a folder beside the page, are made on all cores from the
    /// logs, where these are still as they were, and made once
    #[arg(long, value_enum, default_value_t)]
    pub(crate) reports: ReportsWord,
    /// The model file that was estimated with, where it names other files, so that its text alone is not enough [default: the text in
    /// the store]
    #[arg(long, value_name = "FILE.toml")]
    pub(crate) model: Option<String>,
}

/// Segments with a report.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub(crate) enum ReportsWord {
    /// None: a point leads to the line of its flight, which has the command for the report
    #[default]
    None,
    /// Those of flights that disagree with their airframe, and the first and last of a course with a finding, and those about a step
    Findings,
    /// All that are in a course
    All,
}

/// Writes what is known of each log as a document, in the form of the analyzers of Flight Review
///
/// A document has the estimates of the log's segments, or why there are none, what the other flights of its airframe say of them, and
/// what explains it. Times are those of the autopilot's clock. docs/fleet.md describes the fields.
#[derive(Debug, Args)]
pub(crate) struct Analyses {
    /// Folder of the store
    #[arg(value_name = "STORE")]
    pub(crate) store: PathBuf,
    #[command(flatten)]
    pub(crate) asking: Asking,
    /// Folder for the documents: of each log one, HASH.json, by the hash of its content
    #[arg(long, value_name = "DIR", default_value = "analyses")]
    pub(crate) dir: PathBuf,
}

/// How a store is judged.
#[derive(Debug, Args)]
pub(crate) struct Asking {
    /// Part of the findings that may be false, 0 to 1 (false-discovery rate)
    #[arg(long, value_name = "PART", allow_negative_numbers = true, value_parser = part, default_value_t = 0.05)]
    pub(crate) false_discoveries: f64,
    /// Only results of this model (its name, or the first digits of its hash), method or version; may be repeated
    #[arg(long, value_name = "WORD")]
    pub(crate) only: Vec<String>,
    /// What courses run over; hours have to stand in the table of flights
    #[arg(long, value_enum, default_value_t)]
    pub(crate) over: OverWord,
}

/// What courses run over, on the command line.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub(crate) enum OverWord {
    /// Flights of the airframe
    #[default]
    Flights,
    /// Hours flown
    Hours,
}

impl Question {
    /// The files that are written, with the options that name them.
    pub(crate) fn files(&self) -> impl Iterator<Item = (&'static str, Option<&PathBuf>)> {
        match self {
            Self::Tell(tell) => [("--out", tell.delivery.out.as_ref())].into_iter(),
            Self::View(view) => [("--html", Some(&view.html))].into_iter(),
            // A folder, which may be there.
            Self::Analyses(_) => [("--dir", None)].into_iter(),
        }
    }
}

impl Asking {
    /// The question to the store.
    pub(crate) fn question(&self) -> phugoid_fleet::statistics::tell::Question {
        use phugoid_fleet::statistics::tell::{Over, Question};
        let over = match self.over {
            OverWord::Flights => Over::Flights,
            OverWord::Hours => Over::Hours,
        };
        Question { false_discoveries: self.false_discoveries, only: self.only.clone(), over }
    }
}

fn part(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if (0.0..=1.0).contains(&value) => Ok(value),
        _ => Err("write a part between 0 and 1, as in 0.05".to_owned()),
    }
}
