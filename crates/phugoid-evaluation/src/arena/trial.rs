//! One flight and what every contestant makes of it.

use std::time::Instant;

use phugoid_flight_data::record::Record;
use phugoid_identification::axes::Axes;
use phugoid_identification::estimate::{EstimateError, EstimateOptions, Method, estimate};
use phugoid_identification::estimation::{Estimation, EventKind};
use phugoid_identification::model_file::{ModelFile, Uncertainty};
use serde::{Deserialize, Serialize};

use super::criteria::{CYCLES, TOLERANCE};
use super::entry::Entry;
use crate::accuracy::{StudyError, bound_of_flight, in_order_of_bound};
use crate::settling::settled_at;
use phugoid_simulation::flight::{Flight, fly};
use phugoid_simulation::scenario::Scenario;

/// An estimation of a record, as a contestant does it.
type Run = dyn Fn(&Record, &ModelFile) -> Result<Estimation, EstimateError> + Sync + Send;

/// A method that takes part.
pub struct Contestant {
    /// Its name in the results.
    pub name: String,
    /// Whether its estimate at any time uses no later sample. One that is not causal is given the record up to each time
    /// that is looked at.
    pub causal: bool,
    run: Box<Run>,
}

impl Contestant {
    /// A method of this project, with its settings as the model file says.
    pub fn of(method: Method) -> Self {
        let run = move |record: &Record, model: &ModelFile| {
            let options = EstimateOptions { method: Some(method), ..EstimateOptions::causal() };
            estimate(record, model, &options, &mut |_| {})
        };
        Self::new(method.name(), !method.is_batch(), run)
    }

    /// Any estimator under a name of its own. `causal` says whether an estimate uses only the samples before it, `run`
    /// estimates one record.
    pub fn new(
        name: impl Into<String>,
        causal: bool,
        run: impl Fn(&Record, &ModelFile) -> Result<Estimation, EstimateError> + Sync + Send + 'static,
    ) -> Self {
        Self { name: name.into(), causal, run: Box::new(run) }
    }
}

/// One parameter at one time: truth, estimate, claim.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Point {
    #[serde(with = "crate::exact")]
    pub(super) truth: f64,
    #[serde(with = "crate::exact")]
    pub(super) value: f64,
    /// Claimed standard error; NaN for a method that claims none.
    #[serde(with = "crate::exact")]
    pub(super) std_error: f64,
}

/// What one contestant made of a flight.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct Track {
    /// By checkpoint and parameter.
    pub(super) points: Vec<Vec<Point>>,
    /// The same by a model file that declares no uncertainty, of flights into which errors were put; else empty.
    #[serde(default)]
    pub(super) undeclared: Vec<Vec<Point>>,
    /// Time from the reference to within the tolerance for good, by parameter, s; infinite if never.
    #[serde(with = "crate::exact")]
    pub(super) settled_s: Vec<f64>,
    /// Times at which a change of the parameters was suspected, s.
    pub(super) doubts_s: Vec<f64>,
    /// Times at which a change was adopted, s.
    pub(super) changes_s: Vec<f64>,
    /// Of computing, per sample.
    pub(super) microseconds: f64,
}

/// A flight with everything that was made of it.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct Trial {
    /// Time from which cycles are counted, s.
    pub(super) from_s: f64,
    /// Seed flown.
    pub(super) seed: u64,
    /// What an error is measured in, by checkpoint and parameter: the Cramer-Rao bound, or the prior's deviation.
    #[serde(with = "crate::exact")]
    pub(super) unit: Vec<Vec<f64>>,
    /// Whether the unit is the Cramer-Rao bound.
    pub(super) bounded: bool,
    /// By contestant; in words what went wrong.
    pub(super) tracks: Vec<Result<Track, String>>,
}

/// Names of the parameters that are judged, in the model's order: those of the aircraft, not of its sensors.
pub(super) fn judged(model: &ModelFile) -> Vec<&str> {
    model.estimated().filter(|p| !p.is_nuisance()).map(|p| p.name.as_str()).collect()
}

/// Flies one seed of an entry and lets every contestant estimate it.
///
/// # Errors
/// [`StudyError`]: the flight, or its bound.
pub(super) fn fly_and_estimate(entry: &Entry, contestants: &[Contestant], k: u64) -> Result<Trial, StudyError> {
    let seed = entry.scenario.seed.wrapping_add(k);
    let flight = fly(&Scenario { seed, ..entry.scenario.clone() })?;
    let from_s = reference_time(&flight);
    let at: Vec<f64> = CYCLES.iter().map(|cycles| from_s + cycles * entry.cycle_s).collect();
    if let (Some(end), Some(last)) = (flight.truth.time.last(), at.last())
        && end + 1e-9 < *last
    {
        return Err(StudyError::Unsuitable(format!(
            "{}: the flight ends at {end:.2} s, and {} cycles of {:.2} s from {from_s:.2} s need {last:.2} s: lengthen `duration`",
            entry.id,
            CYCLES[CYCLES.len() - 1],
            entry.cycle_s
        )));
    }
    let names = judged(&entry.model);
    // Bounds and truth are those of the flight as it was, before anything is put in.
    let bounds = bounds(&flight, entry, &at)?;
    let bounded = bounds.is_some();
    let unit = bounds.unwrap_or_else(|| {
        let prior = entry.model.estimated().filter(|p| !p.is_nuisance()).map(|p| p.prior_std).collect();
        vec![prior; at.len()]
    });
    let mut truths: Vec<Vec<f64>> = at.iter().map(|t| truth_at(&flight, &names, *t)).collect();
    let (mut record, mut model) = (flight.measured.clone(), entry.model.clone());
    if let Some(errors) = &entry.errors {
        let sizes = errors.of_flight(seed);
        sizes.put_in(&mut record, &mut model);
        for truths in &mut truths {
            let before = truths.clone();
            let of = |name: &str| names.iter().position(|known| *known == name).map(|j| before[j]);
            let shift = |name: &str| sizes.shift_of_truth(&entry.model, name, of);
            truths.iter_mut().zip(&names).for_each(|(truth, name)| *truth += shift(name));
        }
    }
    let seen = Seen { record, model, names, truths, at };
    let tracks = contestants.iter().map(|contestant| track(contestant, entry, &flight, &seen, from_s)).collect();
    Ok(Trial { from_s, seed, unit, bounded, tracks })
}

/// The last damage, or else the instant at which a surface leaves its trim; else the start.
fn reference_time(flight: &Flight) -> f64 {
    if let Some(damage) = flight.scenario.damage.last() {
        return damage.at.si();
    }
    let trim = flight.trim.controls();
    let surfaces = [("elevator", trim.elevator), ("aileron", trim.aileron), ("rudder", trim.rudder)];
    let moves = surfaces.into_iter().filter_map(|(name, at_rest)| {
        flight.truth.channel(name)?.values.iter().position(|v| (v - at_rest).abs() > 1e-12)
    });
    moves.min().and_then(|k| flight.truth.time.get(k)).copied().unwrap_or(0.0)
}

fn truth_at(flight: &Flight, names: &[&str], time: f64) -> Vec<f64> {
    let truth = flight.true_parameters_at(time);
    names.iter().map(|name| truth.get(*name).copied().unwrap_or(f64::NAN)).collect()
}

/// Cramer-Rao bounds of the judged parameters from the data since the last damage, with the noise that there really is, no
/// process noise, and of sensor biases and offsets what the model file expects of them. None where parameters change slowly, or where the data say less of one of them than was known before.
fn bounds(flight: &Flight, entry: &Entry, at: &[f64]) -> Result<Option<Vec<Vec<f64>>>, StudyError> {
    let drifts = flight.scenario.damage.iter().any(|damage| damage.over.si() > 0.0);
    if drifts || entry.model.axes != Axes::Longitudinal {
        return Ok(None);
    }
    let model = &entry.model;
    let of_bound: Vec<&str> = in_order_of_bound(model).iter().map(|p| p.name.as_str()).collect();
    let places: Vec<Option<usize>> =
        judged(model).iter().map(|name| of_bound.iter().position(|known| known == name)).collect();
    let found = bound_of_flight(flight, model, at)?;
    let chosen = |std_error: &[f64]| -> Vec<f64> {
        places.iter().map(|place| place.and_then(|k| std_error.get(k)).copied().unwrap_or(f64::NAN)).collect()
    };
    let units: Vec<Vec<f64>> = found.iter().map(|b| chosen(&b.std_error)).collect();
    let prior = model.estimated().filter(|p| !p.is_nuisance()).map(|p| p.prior_std);
    let told = units.last().is_some_and(|last| last.iter().zip(prior).all(|(unit, prior)| *unit < prior));
    Ok((told && units.iter().flatten().all(|u| u.is_finite())).then_some(units))
}

/// What the contestants are given of a flight, and what is then true at the times that are looked at.
struct Seen<'a> {
    record: Record,
    model: ModelFile,
    /// The judged parameters.
    names: Vec<&'a str>,
    /// By time and parameter.
    truths: Vec<Vec<f64>>,
    /// The times, s.
    at: Vec<f64>,
}

fn track(
    contestant: &Contestant,
    entry: &Entry,
    flight: &Flight,
    seen: &Seen<'_>,
    from_s: f64,
) -> Result<Track, String> {
    let (points, whole, microseconds) = looked_at(contestant, seen, &seen.model)?;
    let undeclared = match entry.errors {
        None => Vec::new(),
        Some(_) => {
            let model = ModelFile { uncertainty: Uncertainty::NONE, ..seen.model.clone() };
            looked_at(contestant, seen, &model)?.0
        }
    };
    let settled_s = seen.names.iter().map(|name| settled(contestant, &whole, flight, name, from_s)).collect();
    let times = |kind: EventKind| whole.events.iter().filter(|e| e.kind == kind).map(|e| e.time_s).collect();
    Ok(Track {
        points,
        undeclared,
        settled_s,
        doubts_s: times(EventKind::InDoubt),
        changes_s: times(EventKind::Adopted),
        microseconds,
    })
}

/// By time and parameter, the last estimation and its computing time per sample, microseconds.
type LookedAt = (Vec<Vec<Point>>, Estimation, f64);

/// Estimates with this model and looks at the parameters at each of the times.
fn looked_at(contestant: &Contestant, seen: &Seen<'_>, model: &ModelFile) -> Result<LookedAt, String> {
    let timed = |record: &Record| {
        let start = Instant::now();
        let estimation = (contestant.run)(record, model).map_err(|error| error.to_string())?;
        let microseconds = start.elapsed().as_secs_f64() * 1e6 / record.time.len().max(1) as f64;
        Ok::<_, String>((estimation, microseconds))
    };
    // A causal method needs to run once, another one once for each time that is looked at.
    let mut run = if contestant.causal { Some(timed(&seen.record)?) } else { None };
    let mut points = Vec::with_capacity(seen.at.len());
    for (t, truths) in seen.at.iter().zip(&seen.truths) {
        if !contestant.causal {
            run = Some(timed(&until(&seen.record, *t))?);
        }
        let estimation = run.as_ref().map(|(estimation, _)| estimation);
        let row: Option<Vec<Point>> = seen
            .names
            .iter()
            .zip(truths)
            .map(|(name, truth)| {
                let (value, std_error) = claim(estimation?, name, *t, contestant.causal)?;
                Some(Point { truth: *truth, value, std_error })
            })
            .collect();
        let Some(row) = row else { return Err(format!("it gives no estimate at {t:.2} s")) };
        if let Some((point, name)) = row.iter().zip(&seen.names).find(|(point, _)| !point.value.is_finite()) {
            return Err(format!("`{name}` is {} at {t:.2} s", point.value));
        }
        points.push(row);
    }
    let Some((whole, microseconds)) = run else { return Err("there is no time to look at".to_owned()) };
    Ok((points, whole, microseconds))
}

/// Estimate and claimed standard error of a parameter: at a time, or at the end of a record that ends there.
fn claim(estimation: &Estimation, name: &str, time: f64, causal: bool) -> Option<(f64, f64)> {
    if !causal {
        let last = estimation.parameters.iter().find(|p| p.name == name)?;
        return Some((last.value, last.corrected_std_error));
    }
    let k = estimation.history.time_s.partition_point(|s| *s <= time + 1e-9).checked_sub(1)?;
    let history = estimation.history.parameters.iter().find(|p| p.name == name)?;
    Some((*history.value.get(k)?, *history.std_error.get(k)?))
}

/// When a parameter came within the tolerance of its final truth for good, counted from the reference time.
fn settled(contestant: &Contestant, whole: &Estimation, flight: &Flight, name: &str, from_s: f64) -> f64 {
    let truth = flight.true_parameters.get(name).copied().unwrap_or(f64::NAN);
    let Some(history) = whole.history.parameters.iter().find(|p| p.name == name) else { return f64::INFINITY };
    if !contestant.causal {
        return f64::NAN;
    }
    // What it was before the reference time does not count: a guess that happens to be right, or the former truth.
    settled_at(&whole.history.time_s, &history.value, truth, TOLERANCE).map_or(f64::INFINITY, |t| (t - from_s).max(0.0))
}

/// The record up to a time.
fn until(record: &Record, time: f64) -> Record {
    let samples = record.time.partition_point(|t| *t <= time + 1e-9);
    let mut part = record.clone();
    part.time.truncate(samples);
    for channel in &mut part.channels {
        channel.values.truncate(samples);
    }
    (part.quality.rows_read, part.quality.rows_kept) = (samples, samples);
    part
}
