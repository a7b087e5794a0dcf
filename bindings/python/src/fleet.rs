//! Fleets: the steps of a run, one by one, so that any engine can call them; and what a store tells.

use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;

use phugoid_fleet::analysis::documents;
use phugoid_fleet::campaign;
use phugoid_fleet::campaign::file::Campaign;
use phugoid_fleet::campaign::layout::{Block, Layout};
use phugoid_fleet::logs::{FlightTable, LogRow};
use phugoid_fleet::page;
use phugoid_fleet::row::Row;
use phugoid_fleet::run::{self, Hashed, Outcome, Share, Summary};
use phugoid_fleet::shard::Shard;
use phugoid_fleet::source;
use phugoid_fleet::statistics::tell::{Findings, Over, Question, tell};
use phugoid_fleet::store::Store;
use phugoid_fleet::unit::{Segments, Task};
use phugoid_identification::model_file::ModelFile;
use pyo3::prelude::*;

use crate::error::raise;

/// What decides on the rows of a log, and the store that they go to. It is made of text alone, so that each worker can make
/// its own.
#[pyclass(frozen)]
pub(crate) struct FleetTask {
    task: Task,
    flights: FlightTable,
    store: Store,
}

/// A log as Python has it: name, hash (empty where it cannot be read), bytes, and the reason where it cannot be read.
type Log = (String, String, u64, String);

fn log(log: Hashed) -> PyResult<Log> {
    let name = text(log.name)?;
    Ok(match log.content {
        Ok((hash, bytes)) => (name, hash, bytes, String::new()),
        Err(error) => (name, String::new(), 0, error),
    })
}

/// A path as text, which is what Python code compares.
fn text(path: PathBuf) -> PyResult<String> {
    let lost = |path: std::ffi::OsString| raise(format!("{}: the name is no text", path.display()));
    path.into_os_string().into_string().map_err(lost)
}

fn hashed((name, hash, bytes, error): Log) -> Hashed {
    let content = if hash.is_empty() { Err(error) } else { Ok((hash, bytes)) };
    Hashed { name: name.into(), content }
}

#[pymethods]
impl FleetTask {
    /// `begin` makes the store where there is none, and clears what killed programs have left in it; tasks on other machines
    /// open the one that is there, so that not each of them looks through all of it.
    #[new]
    #[pyo3(signature = (model_name, model_text, store, method=None, segments="manoeuvres", flights=None, begin=true))]
    fn new(
        model_name: &str,
        model_text: String,
        store: PathBuf,
        method: Option<&str>,
        segments: &str,
        flights: Option<PathBuf>,
        begin: bool,
    ) -> PyResult<Self> {
        let method = method.map(|name| name.parse().map_err(raise)).transpose()?;
        let segments = match segments {
            "manoeuvres" => Segments::Manoeuvres,
            "whole" => Segments::Whole,
            other => return Err(raise(format!("segments are \"manoeuvres\" or \"whole\", not \"{other}\""))),
        };
        let task = Task::parse(model_name, model_text, method, segments).map_err(raise)?;
        let flights = flights.as_deref().map(FlightTable::open).transpose().map_err(raise)?.unwrap_or_default();
        let store = if begin { Store::create(&store) } else { Store::open(&store) }.map_err(raise)?;
        if begin {
            store.write_model(task.model_sha256(), task.model_text()).map_err(raise)?;
        }
        Ok(Self { task, flights, store })
    }

    /// The logs that a shard has to do, and a summary (JSON) with what is left out.
    fn plan(&self, logs: Vec<Log>, shard: &str) -> PyResult<(Vec<Log>, String)> {
        let shard: Shard = shard.parse().map_err(raise)?;
        let (work, summary) = run::plan(logs.into_iter().map(hashed).collect(), &self.task, shard);
        let work = work.into_iter().map(log).collect::<PyResult<_>>()?;
        Ok((work, serde_json::to_string(&summary).map_err(raise)?))
    }

    /// Where a log stands in a store, as names of files below its folder: its rows, the note that it is tried again, and the same two
    /// of the row that says that the log cannot be read.
    fn places(&self, log: Log) -> PyResult<[String; 4]> {
        let log = hashed(log);
        let unread = self.task.key_of_unreadable(&log.name);
        let key = log.content.as_ref().map_or_else(|_| unread.clone(), |(hash, _)| self.task.key(hash));
        let rows = |key: &str| text(Store::place("log", self.task.model_sha256(), key));
        let note = |key: &str| text(Store::place_of_note(key));
        Ok([rows(&key)?, note(&key)?, rows(&unread)?, note(&unread)?])
    }

    /// Keeps what is known of a log that another store has rows of.
    fn note(&self, log: Log) -> PyResult<()> {
        let log = hashed(log);
        match &log.content {
            Ok((hash, bytes)) => self.store.write_log(&self.flights.log(&log.name, hash, *bytes)).map_err(raise),
            Err(_) => Ok(()),
        }
    }

    /// Does one log, whose content is in `file`: `None` where the store has it, else the number of rows and whether it was
    /// refused.
    fn one(&self, py: Python<'_>, log: Log, file: PathBuf) -> PyResult<Option<(usize, bool)>> {
        let log = hashed(log);
        let outcome = py.detach(|| run::one(&log, &file, &self.task, &self.flights, &self.store)).map_err(raise)?;
        Ok(match outcome {
            Outcome::Found => None,
            Outcome::Estimated { rows, refused } => Some((rows, refused)),
        })
    }

    /// Does all files on this machine; a summary (JSON). `progress` is called with the fraction done.
    #[pyo3(signature = (files, shard, workers, progress=None))]
    fn run(
        &self,
        py: Python<'_>,
        files: Vec<PathBuf>,
        shard: &str,
        workers: usize,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<String> {
        let share = Share { workers, shard: shard.parse().map_err(raise)? };
        let stop = AtomicBool::new(false);
        let step = |at: run::Progress| {
            // Ctrl-C, and an error of the progress bar, end the run after the logs that have begun.
            let is_stopped = Python::attach(|py| {
                let told = progress.as_ref().map(|progress| progress.call1(py, (at.done as f64 / at.all as f64,)));
                py.check_signals().is_err() || told.is_some_and(|told| told.is_err())
            });
            stop.fetch_or(is_stopped, std::sync::atomic::Ordering::Relaxed);
        };
        let summary: Summary = py
            .detach(|| run::run(&files, &self.task, &self.flights, &self.store, share, &step, &stop))
            .map_err(raise)?;
        serde_json::to_string(&summary).map_err(raise)
    }
}

/// A campaign, of which any process can do any block.
#[pyclass(frozen)]
pub(crate) struct CampaignTask {
    layout: Layout,
    blocks: Vec<Block>,
}

#[pymethods]
impl CampaignTask {
    /// Reads the file of a campaign and all that it names.
    #[new]
    fn new(py: Python<'_>, file: PathBuf) -> PyResult<Self> {
        py.detach(|| {
            let campaign = Campaign::open(&file).map_err(raise)?;
            let layout = Layout::new(&campaign).map_err(raise)?;
            let blocks = layout.blocks().map_err(raise)?;
            Ok(Self { layout, blocks })
        })
    }

    /// The blocks that a shard has to do, as their numbers with the estimations in each, and a summary (JSON) with what is left out.
    fn plan(&self, shard: &str) -> PyResult<(Vec<(usize, usize)>, String)> {
        let shard: Shard = shard.parse().map_err(raise)?;
        let (work, summary) = campaign::run::plan(&self.blocks, shard);
        let work = work.into_iter().map(|(number, block)| (number, block.units.len())).collect();
        Ok((work, serde_json::to_string(&summary).map_err(raise)?))
    }

    /// Where the rows of a block stand in a store, as the name of a file below its folder.
    fn place(&self, number: usize) -> PyResult<String> {
        let block = self.block(number)?;
        text(Store::place("campaign", &block.model_sha256, &block.key))
    }

    /// Does one block into a store, which has been begun, unless it is there: a summary (JSON).
    fn one(&self, py: Python<'_>, number: usize, store: PathBuf) -> PyResult<String> {
        let block = self.block(number)?;
        let store = Store::open(&store).map_err(raise)?;
        let summary = py.detach(|| campaign::run::one(&self.layout, block, &store)).map_err(raise)?;
        serde_json::to_string(&summary).map_err(raise)
    }
}

impl CampaignTask {
    fn block(&self, number: usize) -> PyResult<&Block> {
        self.blocks.get(number).ok_or_else(|| raise(format!("the campaign has no block {number}")))
    }
}

/// Begins a store in a new folder, or opens the one that is there.
#[pyfunction]
pub(crate) fn fleet_store(folder: PathBuf) -> PyResult<()> {
    Store::create(&folder).map(drop).map_err(raise)
}

/// The files that words mean, in the order of their paths.
#[pyfunction]
pub(crate) fn fleet_files(words: Vec<String>) -> PyResult<Vec<String>> {
    source::files(&words).map_err(raise)?.into_iter().map(text).collect()
}

/// Hash of a file, under a name.
#[pyfunction]
pub(crate) fn fleet_hash(py: Python<'_>, name: PathBuf, file: PathBuf) -> PyResult<Log> {
    log(Hashed { name, ..py.detach(|| Hashed::of(&file)) })
}

/// Name and text of a model: a file, or a built-in one.
#[pyfunction]
pub(crate) fn fleet_model(wanted: &str) -> PyResult<(String, String)> {
    ModelFile::find_text(wanted).map_err(raise)
}

/// What a store tells, as JSON, and as a page.
#[pyfunction]
#[pyo3(signature = (store, false_discoveries=0.05, only=Vec::new(), over="flights"))]
pub(crate) fn fleet_tell(
    py: Python<'_>,
    store: PathBuf,
    false_discoveries: f64,
    only: Vec<String>,
    over: &str,
) -> PyResult<(String, String)> {
    let question = question(false_discoveries, only, over)?;
    py.detach(|| {
        let (_, _, findings) = told(&store, &question)?;
        Ok((serde_json::to_string(&findings).map_err(raise)?, page::html(&findings, &page::Reports::new())))
    })
}

/// A document for each log of a store, as JSON.
#[pyfunction]
#[pyo3(signature = (store, false_discoveries=0.05, only=Vec::new(), over="flights"))]
pub(crate) fn fleet_analyses(
    py: Python<'_>,
    store: PathBuf,
    false_discoveries: f64,
    only: Vec<String>,
    over: &str,
) -> PyResult<String> {
    let question = question(false_discoveries, only, over)?;
    py.detach(|| {
        let (rows, logs, findings) = told(&store, &question)?;
        serde_json::to_string(&documents(&rows, &logs, &findings)).map_err(raise)
    })
}

fn question(false_discoveries: f64, only: Vec<String>, over: &str) -> PyResult<Question> {
    let over = match over {
        "flights" => Over::Flights,
        "hours" => Over::Hours,
        other => return Err(raise(format!("a course runs over \"flights\" or \"hours\", not \"{other}\""))),
    };
    Ok(Question { false_discoveries, only, over })
}

/// The rows and logs of a store, and what they tell.
fn told(folder: &Path, question: &Question) -> PyResult<(Vec<Row>, Vec<LogRow>, Findings)> {
    let store = Store::open(folder).map_err(raise)?;
    let (rows, logs) = (store.rows().map_err(raise)?, store.logs().map_err(raise)?);
    let findings = tell(&rows, &logs, question).map_err(raise)?;
    Ok((rows, logs, findings))
}
