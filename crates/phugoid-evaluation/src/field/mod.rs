//! The field: flights of foreign aircraft from another simulator, recorded as a stranger would, with the truth beside them.
//!
//! `scripts/field/make.py` flies them; docs/field.md says what they are. Every flight goes the path of `phugoid estimate`
//! with its default settings; what comes out is counted against the truth of that very flight.

pub mod drawn;
mod error;
pub mod standing;
pub mod structure;
pub mod summary;
pub mod trial;
pub mod truth;
pub mod watch;

use std::path::{Path, PathBuf};

use phugoid_identification::estimate::EstimateOptions;
use phugoid_identification::method::Method;
use phugoid_identification::model_file::ModelFile;
use phugoid_identification::options::{FlowAngles, Likelihood};
use serde::Serialize;

pub use error::FieldError;

use drawn::DrawnStudy;
use structure::StructureStudy;
use summary::{ChangeSummary, ConsistencySummary, GroupSummary, WatchSummary};
use trial::{Flight, RealChange, Trial};
use truth::{Kind, Split, Truth};

use crate::monte_carlo::monte_carlo;
use crate::put_in::declared::Sizes;
use crate::put_in::fault::{Corruption, Fault, draw_below};

/// What to run.
#[derive(Clone, Debug, PartialEq)]
pub struct FieldOptions {
    /// The part of the field.
    pub split: Split,
    /// The methods; each runs on every flight.
    pub methods: Vec<Method>,
    /// Only flights whose aircraft, group or name contains one of these; all if it is empty.
    pub only: Vec<String>,
    /// Number of flights with an error put in. They go to the first method.
    pub faults: usize,
    /// Whether the health monitor watches the sound flights.
    pub monitor: bool,
    /// What batch methods take the noise of the measurements for.
    pub likelihood: Likelihood,
    /// Where output error has the flow angles from.
    pub flow_angles: FlowAngles,
    /// Whether values and bounds of SMPE and the joint filter contain what a flight itself says of declared errors, whatever the model file says.
    pub learning: bool,
    /// Whether every flight gets all errors that its model file declares, and from which seed they are drawn: flight `k` has this seed
    /// plus `k`.
    pub drawn: Option<u64>,
}

/// The result: every trial, and what they come to.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FieldStudy {
    /// The part of the field.
    pub split: Split,
    /// The seed of the errors that were put into every flight ([`FieldOptions::drawn`]); none where the flights are as they were flown.
    pub drawn: Option<u64>,
    /// By method: all flights together, sound and faulty ones apart.
    pub all: Vec<GroupSummary>,
    /// By group of flights.
    pub groups: Vec<GroupSummary>,
    /// By aircraft.
    pub aircraft: Vec<GroupSummary>,
    /// Whether claims are of the size of errors, and what gates locked out, by method; not of batch methods.
    pub consistency: Vec<ConsistencySummary>,
    /// Sudden changes, by method.
    pub changes: Vec<ChangeSummary>,
    /// The health monitor on healthy, damaged and shifted flights; empty if it was not run.
    pub watched: Vec<WatchSummary>,
    /// Flights with errors put in: all together first, then by kind of error; empty if there are none.
    pub faults: Vec<FaultSummary>,
    /// Every trial, flights with errors put in last.
    pub trials: Vec<Trial>,
}

/// Flights with one kind of error put in.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FaultSummary {
    /// The numbers of these flights.
    pub summary: GroupSummary,
    /// Median relative error over that of the same flights without the error; NaN where all are refused.
    pub error_ratio: f64,
}

/// A flight to run: which one, by which method, with which error, watched or not.
type Task = (usize, Method, Option<Corruption>, bool);

/// Runs the field below `folder`. `done` is called after each flight, from any thread, with the number of all.
///
/// # Errors
/// [`FieldError`]: the field cannot be read, or no flight is left to run. A flight that cannot be estimated is a result.
pub fn run(folder: &Path, options: &FieldOptions, done: &(dyn Fn(usize) + Sync)) -> Result<FieldStudy, FieldError> {
    let flights = flights(folder, options)?;
    let mut tasks: Vec<Task> = Vec::new();
    for (number, method) in options.methods.iter().enumerate() {
        // The monitor has a method of its own: once is enough.
        let watched = |f: &Flight| options.monitor && number == 0 && f.truth.kind == Kind::Sound;
        tasks.extend(flights.iter().enumerate().map(|(i, f)| (i, *method, None, watched(f))));
    }
    let healthy: Vec<usize> = (0..flights.len()).filter(|i| may_be_corrupted(&flights[*i].truth)).collect();
    if let (Some(method), false) = (options.methods.first(), healthy.is_empty()) {
        tasks.extend((0..options.faults).map(|k| {
            let flight = healthy[draw_below(k, healthy.len())];
            (flight, *method, Some(Corruption::draw(k)), false)
        }));
    }
    let run = |k: usize| -> Result<Trial, FieldError> {
        let (flight, method, corruption, watched) = tasks[k];
        let options = EstimateOptions {
            method: Some(method),
            likelihood: options.likelihood,
            flow_angles: options.flow_angles,
            ..EstimateOptions::default()
        };
        Ok(flights[flight].trial(&options, corruption, watched))
    };
    let trials = monte_carlo(tasks.len(), run, || done(tasks.len()))?;
    Ok(summarise(options, trials))
}

/// The flights that are asked for.
fn flights(folder: &Path, options: &FieldOptions) -> Result<Vec<Flight>, FieldError> {
    let wanted = |truth: &Truth| {
        let has =
            |word: &String| [&truth.aircraft, &truth.group, &truth.flight].iter().any(|t| t.contains(word.as_str()));
        options.only.is_empty() || options.only.iter().any(has)
    };
    let truths: Vec<Truth> = truth::find(folder, options.split)?.into_iter().filter(wanted).collect();
    if truths.is_empty() {
        return Err(FieldError::NoSuch(options.only.join(" or ")));
    }
    let mut flights: Vec<Flight> = truths.into_iter().map(open).collect::<Result<_, _>>()?;
    for (flight, number) in flights.iter_mut().zip(0..) {
        flight.model.uncertainty.learns |= options.learning;
        if let Some(seed) = options.drawn {
            let seed = seed.wrapping_add(number);
            *flight = flight.with(&Sizes::drawn(&flight.model.uncertainty, seed, |_| true));
        }
    }
    Ok(flights)
}

/// Looks for missing terms on the healthy flights below `folder`: with the model of the field, and with each term taken out
/// of it of which the flight has a true value. Of the options the faults, the monitor and what concerns batch methods are not used.
///
/// # Errors
/// [`FieldError`]: the field cannot be read, or was not made with what happened without instruments.
pub fn run_structure(
    folder: &Path,
    options: &FieldOptions,
    done: &(dyn Fn(usize) + Sync),
) -> Result<StructureStudy, FieldError> {
    let mut flights = flights(folder, options)?;
    flights.retain(|f| f.truth.is_healthy());
    let mut tasks: Vec<(usize, Method, Option<String>)> = Vec::new();
    for method in &options.methods {
        for (i, flight) in flights.iter().enumerate() {
            tasks.push((i, *method, None));
            // Nothing is taken out of a model that lacks a term already, or that stands beside such ones.
            if flight.truth.missing.is_empty() && !flight.truth.flight.starts_with("st-") {
                tasks.extend(structure::removable(flight).into_iter().map(|name| (i, *method, Some(name))));
            }
        }
    }
    let run = |k: usize| {
        let (flight, method, removed) = &tasks[k];
        structure::trial(&flights[*flight], *method, removed.as_deref())
    };
    let trials = monte_carlo(tasks.len(), run, || done(tasks.len()))?;
    Ok(StructureStudy::new(trials, &options.methods))
}

/// Draws errors from what the model files declare, puts them into healthy flights below `folder`, and asks whether the bounds
/// hold them: `per_row` flights without errors, with all at once, and with those of each quantity, by the first method. On
/// `ranked` flights each error is tried by itself, to see whether the largest contributor is named. Of the options the
/// faults, the monitor and the likelihood are not used.
///
/// # Errors
/// [`FieldError`]: the field cannot be read, or no flight is left to run.
pub fn run_drawn(
    folder: &Path,
    options: &FieldOptions,
    per_row: usize,
    ranked: usize,
    done: &(dyn Fn(usize) + Sync),
) -> Result<DrawnStudy, FieldError> {
    let mut flights = flights(folder, options)?;
    flights.retain(|f| may_be_corrupted(&f.truth));
    let Some(method) = options.methods.first().copied().filter(|_| !flights.is_empty()) else {
        return Err(FieldError::NoSuch("a healthy flight".to_owned()));
    };
    let tasks = drawn::tasks(per_row, flights.len());
    let all = tasks.len() + ranked;
    let run = |k: usize| -> Result<_, FieldError> {
        let (draw, flight, number) = tasks[k];
        Ok(drawn::trial(&flights[flight], method, draw, number))
    };
    let trials = monte_carlo(tasks.len(), run, || done(all))?;
    let rank = |k: usize| -> Result<_, FieldError> { Ok(drawn::rank(&flights[draw_below(k, flights.len())], method)) };
    let found = monte_carlo(ranked, rank, || done(all))?;
    let ranking = (ranked > 0).then(|| drawn::ranking(found.into_iter().flatten().collect()));
    let learns = options.learning && matches!(method, Method::Smpe | Method::Ekf);
    Ok(drawn::study(method, learns, trials, ranking))
}

/// Short flights of healthy aircraft: a long one adds nothing but time.
fn may_be_corrupted(truth: &Truth) -> bool {
    truth.is_healthy() && !truth.group.starts_with("long")
}

fn open(truth: Truth) -> Result<Flight, FieldError> {
    let path = |name: &str| -> PathBuf { truth.folder.join(name) };
    let model = ModelFile::find(&path(&truth.model).to_string_lossy()).map_err(|e| FieldError::Model(e.to_string()))?;
    let record = model.open_record(path(&truth.record)).map_err(|error| error.to_string());
    Ok(Flight { truth, model, record })
}

fn summarise(options: &FieldOptions, trials: Vec<Trial>) -> FieldStudy {
    let plain: Vec<&Trial> = trials.iter().filter(|t| t.corruption.is_none()).collect();
    let by = |method: Method, kind: Kind| -> Vec<&Trial> {
        plain.iter().copied().filter(|t| t.method == method && t.kind == kind).collect()
    };
    let pairs = || options.methods.iter().flat_map(|m| [Kind::Sound, Kind::Faulty].map(|k| (*m, k)));
    let grouped = |key: &dyn Fn(&Trial) -> String| -> Vec<GroupSummary> {
        let mut summaries = Vec::new();
        for (method, kind) in pairs() {
            let trials = by(method, kind);
            let mut names: Vec<String> = Vec::new();
            for trial in &trials {
                let name = key(trial);
                if !names.contains(&name) {
                    names.push(name);
                }
            }
            for name in names {
                let own: Vec<&Trial> = trials.iter().copied().filter(|t| key(t) == name).collect();
                summaries.push(GroupSummary::of(&name, kind, method, &own));
            }
        }
        summaries
    };
    let all = pairs()
        .map(|(method, kind)| (method, kind, by(method, kind)))
        .filter(|(_, _, own)| !own.is_empty())
        .map(|(method, kind, own)| GroupSummary::of("all", kind, method, &own))
        .collect();
    let of_method = |m: Method| -> Vec<&Trial> { plain.iter().copied().filter(|t| t.method == m).collect() };
    let watched: Vec<WatchSummary> = [("healthy", false, false), ("damaged", true, false), ("trim shift", true, true)]
        .into_iter()
        .map(|(name, changed, shifted)| {
            let own: Vec<&Trial> = plain
                .iter()
                .copied()
                .filter(|t| t.watched.is_some() && t.change.is_some() == changed)
                .filter(|t| t.change.as_ref().is_some_and(RealChange::is_trim_shift) == shifted)
                .collect();
            WatchSummary::of(name, &own)
        })
        .filter(|summary| summary.flights > 0)
        .collect();
    FieldStudy {
        split: options.split,
        drawn: options.drawn,
        all,
        groups: grouped(&|t| format!("{} {}", t.axes, t.group)),
        aircraft: grouped(&|t| t.aircraft.clone()),
        consistency: options
            .methods
            .iter()
            .filter(|m| !m.is_batch())
            .map(|m| ConsistencySummary::of(*m, &of_method(*m)))
            .collect(),
        changes: options.methods.iter().map(|m| ChangeSummary::of(*m, &of_method(*m))).collect(),
        watched,
        faults: faults(&trials),
        trials,
    }
}

/// Flights with errors put in, all together and by kind of error.
fn faults(trials: &[Trial]) -> Vec<FaultSummary> {
    let corrupted: Vec<&Trial> = trials.iter().filter(|t| t.corruption.is_some()).collect();
    let Some(method) = corrupted.first().map(|t| t.method) else { return Vec::new() };
    let of = |name: &str, own: &[&Trial]| {
        let same =
            |t: &&Trial| own.iter().any(|o| o.aircraft == t.aircraft && o.flight == t.flight && t.method == o.method);
        let clean: Vec<&Trial> = trials.iter().filter(|t| t.corruption.is_none()).filter(same).collect();
        let summary = GroupSummary::of(name, Kind::Faulty, method, own);
        let base = GroupSummary::of(name, Kind::Sound, method, &clean).error_median;
        FaultSummary { error_ratio: summary.error_median / base, summary }
    };
    let mut summaries = vec![of("all", &corrupted)];
    for fault in Fault::ALL {
        let own: Vec<&Trial> =
            corrupted.iter().copied().filter(|t| t.corruption.is_some_and(|c| c.fault == fault)).collect();
        if !own.is_empty() {
            summaries.push(of(fault.words(), &own));
        }
    }
    summaries
}
