//! What uncertain tables and numbers of the base do to the increments: by estimating again with each of them moved.
//!
//! An increment counts from the tables as they are written. Where the aircraft really has other tables, by `e` standard
//! uncertainties of one element, its true increment is that to the right tables and the part `e s` that the right ones have more in the
//! place of the parameter ([`Flight::own`]). The estimate with the right tables has no error, so that
//!
//! ```text
//! estimate less truth = -e (shift + s)       shift: of the estimate, with the tables moved by one standard uncertainty
//! ```
//!
//! An error that the increment itself takes up has a shift of `-s`, and no part; one of other terms of the tables bends it.

mod flight;

use std::fmt::Write;
use std::sync::Arc;

use nalgebra::DMatrix;
use phugoid_aircraft::flown::AircraftFile;
use phugoid_flight_data::record::Record;

use self::flight::Flight;
use crate::core::error::EstimateError;
use crate::core::options::{EstimateOptions, FlowAngles, KnownChange, StructureSearch};
use crate::core::stack::on_large_stacks;
use crate::core::systematic::{ByQuantity, UncertainQuantity};
use crate::core::term::Coefficient;
use crate::methods::{EveryRoom, Run, Snapshot, Task, run_alone};
use crate::model_file::{BaseUncertainty, KnownAircraft, ModelFile, ReferenceValue, Uncertainty};
use crate::models::database::Database;
use crate::preparation::prepare::prepare;

/// Most elements that the estimate is made again with. Where a file has more, those that change the coefficients least are left out.
pub(crate) const MOST_ELEMENTS: usize = 32;
/// Names of elements in a sentence, at most.
const MOST_NAMES: usize = 4;
/// Part of the largest pivot of the correlations below which the others are nothing but rounding.
const ROUNDING: f64 = 1e-9;

/// Something of the base that is uncertain, moved by one standard uncertainty.
struct Element {
    name: String,
    /// Its place among those of the file.
    place: usize,
    aircraft: Arc<AircraftFile>,
    /// How much it changes the coefficients in flight ([`Flight::difference`]).
    difference: f64,
}

/// What was found of one run: one entry per column, or per adopted change.
struct Found {
    values: Vec<f64>,
    /// By column and sample.
    by_sample: Vec<Vec<f64>>,
    changes: Vec<(f64, Snapshot, Snapshot)>,
}

impl Found {
    fn of<const R: usize>(run: &Run<R>) -> Self {
        Self {
            values: run.columns.iter().map(|column| column.value).collect(),
            by_sample: run.columns.iter().map(|column| column.values.clone()).collect(),
            changes: run.changes.iter().map(|c| (c.time_s, c.before.clone(), c.after.clone())).collect(),
        }
    }
}

/// Puts what uncertain tables of the base do into the errors of a run, and says so in it. A run of which nothing of that kind
/// [is wanted](is_wanted) stays as it is.
pub(super) fn carry<M: EveryRoom<N, R>, const N: usize, const R: usize>(
    record: &Record,
    task: &Task<M, N, R>,
    run: &mut Run<R>,
) {
    if !run.excited || !is_wanted(task.file, task.options) {
        return;
    }
    let Some(known) = &task.file.known else { return };
    let written = Database::Aircraft(Arc::clone(known.aircraft()));
    let flight = Flight::of(task.prepared, task.file);
    let Elements { mut moved, correlations, mut left_out } = elements(known, task.file, &flight, &written);
    if moved.is_empty() {
        run.said_of_base = Some(said(task.file, &[], &left_out, &[], true));
        return;
    }
    if moved.len() > MOST_ELEMENTS {
        moved.sort_by(|a, b| b.difference.total_cmp(&a.difference));
        left_out.extend(moved.drain(MOST_ELEMENTS..).map(|element| element.name));
    }
    let (options, as_written) = (options(task, run), as_written(task));
    // Without a search for changes the run that there is is the one to compare with, unless what it says of changes has what the
    // flight tells of declared errors in it, which those with moved tables do not have.
    let method = task.method();
    let looks = task.options.change_detection.unwrap_or(task.file.change_detection);
    let is_again = (looks || task.file.uncertainty.learns) && !method.is_batch();
    let jobs = moved.len() + usize::from(is_again);
    let (noise, model_error) = (task.noise, task.model_error);
    let again = |job: usize| -> Result<Found, EstimateError> {
        let file = match moved.get(job) {
            Some(element) => with(&as_written, known, &element.aircraft),
            None => as_written.clone(),
        };
        let prepared = prepare::<M, N, R>(record, &file)?;
        let own = Task { model_error, ..Task::new(&prepared, &file, &options, noise) };
        run_alone(&own, &mut |_| {}).map(|run| Found::of(&run))
    };
    let mut found = on_large_stacks(jobs, again);
    let nominal = if is_again { found.pop().and_then(Result::ok) } else { Some(Found::of(run)) };
    let Some(nominal) = nominal else {
        let failed: Vec<String> = moved.iter().map(|element| element.name.clone()).collect();
        run.said_of_base = Some(said(task.file, &[], &left_out, &failed, true));
        return;
    };
    let own = flight.own(&written);
    let mut effects = Vec::new();
    let mut failed = Vec::new();
    let mut carried = Vec::new();
    for (element, found) in moved.iter().zip(found) {
        let database = Database::Aircraft(Arc::clone(&element.aircraft));
        let slopes: Vec<f64> = flight.own(&database).iter().zip(&own).map(|(moved, own)| moved - own).collect();
        match found.ok().and_then(|found| Effect::of(&nominal, &found, &slopes)) {
            Some(effect) => {
                effects.push(effect);
                carried.push(element);
            }
            None => failed.push(element.name.clone()),
        }
    }
    let places: Vec<usize> = carried.iter().map(|element| element.place).collect();
    let (mixing, is_sound) = independent(&correlations, &places);
    let names: Vec<String> = carried.iter().map(|element| element.name.clone()).collect();
    run.said_of_base = Some(said(task.file, &names, &left_out, &failed, is_sound));
    put(run, &nominal, &effects, &mixing);
}

/// Whether errors of the tables of the base are to be worked out: some may be declared, and not only what a live session would have had
/// is asked for.
pub(super) fn is_wanted(file: &ModelFile, options: &EstimateOptions) -> bool {
    let Some(known) = &file.known else { return false };
    let is_declared = match file.uncertainty.base {
        BaseUncertainty::None => false,
        BaseUncertainty::Elements => !known.aircraft().uncertain().is_empty(),
        BaseUncertainty::Part(part) => part > 0.0,
    };
    is_declared && !options.causal_only
}

/// What is uncertain of a base.
struct Elements {
    /// Those that change a coefficient of the motion in flight.
    moved: Vec<Element>,
    /// Of all elements of the file, or of the declared parts.
    correlations: Vec<Vec<f64>>,
    /// Names of those that cannot be moved, or have no number in flight.
    left_out: Vec<String>,
}

fn elements(known: &KnownAircraft, file: &ModelFile, flight: &Flight, written: &Database) -> Elements {
    let mut all = Elements { moved: Vec::new(), correlations: Vec::new(), left_out: Vec::new() };
    let mut take = |name: String, place: usize, aircraft: Option<AircraftFile>| {
        let Some(aircraft) = aircraft.map(Arc::new) else { return all.left_out.push(name) };
        let difference = flight.difference(written, &Database::Aircraft(Arc::clone(&aircraft)));
        if difference.is_nan() {
            all.left_out.push(name);
        } else if difference > 0.0 {
            all.moved.push(Element { name, place, aircraft, difference });
        }
    };
    match file.uncertainty.base {
        BaseUncertainty::None => {}
        BaseUncertainty::Elements => {
            for (place, name) in known.aircraft().uncertain().into_iter().enumerate() {
                let moved = known.aircraft().moved(place, 1.0);
                take(name, place, moved);
            }
            all.correlations = known.aircraft().correlations();
        }
        BaseUncertainty::Part(part) => {
            let reference = flight.at_reference(written);
            for coefficient in file.axes.coefficients() {
                let place = *coefficient as usize;
                let mut parts = [0.0; 6];
                parts[place] = part;
                let scaled = AircraftFile::scaled(Arc::clone(known.aircraft()), parts, reference);
                take(coefficient.symbol().to_owned(), place, Some(scaled));
            }
            let count = Coefficient::ALL.len();
            all.correlations = (0..count).map(|i| (0..count).map(|j| f64::from(i == j)).collect()).collect();
        }
    }
    all
}

/// The options of a run again: with the changes that stand in the run that there is opened where it opened them, and nothing looked for.
fn options<M: EveryRoom<N, R>, const N: usize, const R: usize>(task: &Task<M, N, R>, run: &Run<R>) -> EstimateOptions {
    let mut known_changes = task.options.known_changes.clone();
    for change in run.changes.iter().filter(|change| change.outcome.stands()) {
        let is_given = known_changes.iter().any(|known| (known.time_s - change.time_s).abs() < 1e-9);
        if !is_given {
            known_changes.push(KnownChange { time_s: change.time_s, opens: change.opens });
        }
    }
    known_changes.sort_by(|a, b| a.time_s.total_cmp(&b.time_s));
    // Where the flow angles come from is not to depend on what is moved.
    let measured = run.batch.as_ref().is_some_and(|report| report.measured_angles);
    EstimateOptions {
        method: Some(task.method()),
        change_detection: Some(false),
        known_changes,
        structure: StructureSearch::Never,
        predict: None,
        flow_angles: if measured { FlowAngles::Measured } else { FlowAngles::Simulated },
        ..task.options.clone()
    }
}

/// The model file with its reference point as it was found, so that a moved table does not move what the terms count from, and with
/// nothing else declared, which the method would follow for nothing.
fn as_written<M: EveryRoom<N, R>, const N: usize, const R: usize>(task: &Task<M, N, R>) -> ModelFile {
    let mut file = task.file.clone();
    let reference = task.prepared.reference;
    file.reference.alpha = ReferenceValue::Given(reference.alpha);
    file.reference.elevator = ReferenceValue::Given(reference.elevator);
    file.reference.aileron = ReferenceValue::Given(reference.aileron);
    file.reference.rudder = ReferenceValue::Given(reference.rudder);
    file.uncertainty = Uncertainty::NONE;
    file
}

fn with(file: &ModelFile, known: &KnownAircraft, aircraft: &Arc<AircraftFile>) -> ModelFile {
    ModelFile { known: Some(known.with(Arc::clone(aircraft))), ..file.clone() }
}

/// What one standard uncertainty of an element does: estimate less truth, one entry per column.
struct Effect {
    at_end: Vec<f64>,
    /// By column and sample.
    by_sample: Vec<Vec<f64>>,
    /// Of each change of the run that it is compared with, before it and after it; none where there is no such change.
    at_changes: Vec<Option<[Vec<f64>; 2]>>,
}

impl Effect {
    /// None where a number is lacking.
    fn of(nominal: &Found, moved: &Found, slopes: &[f64]) -> Option<Self> {
        let error = |written: f64, moved: f64, slope: f64| -(moved - written + slope);
        let columns = |written: &[f64], moved: &[f64]| -> Vec<f64> {
            written
                .iter()
                .zip(moved)
                .zip(slopes)
                .map(|((written, moved), slope)| error(*written, *moved, *slope))
                .collect()
        };
        let at_end = columns(&nominal.values, &moved.values);
        let samples = nominal.by_sample.iter().zip(&moved.by_sample).zip(slopes);
        let by_sample = samples.map(|((written, moved), slope)| {
            written.iter().zip(moved).map(|(written, moved)| error(*written, *moved, *slope)).collect()
        });
        let at_change = |(time_s, before, after): &(f64, Snapshot, Snapshot)| {
            let (_, its_before, its_after) = moved.changes.iter().find(|(own_s, ..)| own_s == time_s)?;
            let values =
                |snapshot: &Snapshot| (0..slopes.len()).map(|j| snapshot.value(j)).collect::<Option<Vec<f64>>>();
            Some([columns(&values(before)?, &values(its_before)?), columns(&values(after)?, &values(its_after)?)])
        };
        at_end.iter().all(|effect| effect.is_finite()).then(|| Self {
            by_sample: by_sample.collect(),
            at_changes: nominal.changes.iter().map(at_change).collect(),
            at_end,
        })
    }
}

/// A matrix `L` with `L L^T` the correlations of the elements at these places, so that `L^T d` are the effects of independent errors
/// where `d` are those of the elements; and whether there is one. Correlations that contradict each other have none: the
/// elements count as independent then.
fn independent(correlations: &[Vec<f64>], places: &[usize]) -> (DMatrix<f64>, bool) {
    let count = places.len();
    let at = |i: usize, j: usize| correlations.get(places[i]).and_then(|row| row.get(places[j])).copied();
    let whole = DMatrix::from_fn(count, count, |i, j| if i == j { 1.0 } else { at(i, j).unwrap_or(0.0) });
    // Elements that go wholly together leave a pivot of zero, which the factors of Cholesky do not allow.
    let decomposed = whole.symmetric_eigen();
    let (least, most) = (decomposed.eigenvalues.min(), decomposed.eigenvalues.max());
    if least < -ROUNDING * most || !most.is_finite() {
        return (DMatrix::identity(count, count), false);
    }
    let roots = decomposed.eigenvalues.map(|value| value.max(0.0).sqrt());
    (decomposed.eigenvectors * DMatrix::from_diagonal(&roots), true)
}

/// Effects of independent errors, from those of the elements.
fn mixed<'a>(mixing: &DMatrix<f64>, effects: impl Iterator<Item = f64> + Clone + 'a) -> Vec<f64> {
    let one = |k: usize| effects.clone().enumerate().map(|(i, effect)| mixing[(i, k)] * effect).sum();
    (0..mixing.ncols()).map(one).collect()
}

/// Root of the sum of the squares.
fn size(effects: &[f64]) -> f64 {
    effects.iter().map(|effect| effect * effect).sum::<f64>().sqrt()
}

/// Puts the effects into the errors of a run: at its end, by sample since something has moved, and of its changes.
fn put<const R: usize>(run: &mut Run<R>, nominal: &Found, effects: &[Effect], mixing: &DMatrix<f64>) {
    let moved = run.first_moved();
    for (j, column) in run.columns.iter_mut().enumerate() {
        let at_end = || effects.iter().map(|effect| effect.at_end[j]);
        let std = size(&mixed(mixing, at_end()));
        if std == 0.0 {
            continue;
        }
        let largest = at_end().reduce(|a, b| if b.abs() > a.abs() { b } else { a }).unwrap_or(std);
        let mut parts = ByQuantity::of_parts(&column.systematic_parts);
        parts.add(UncertainQuantity::BaseTables, std.copysign(largest));
        column.systematic_parts = parts.parts();
        column.systematic_std = column.systematic_std.hypot(std);
        column.corrected_std_error = column.corrected_std_error.hypot(std);
        for (k, whole) in column.std_errors.iter_mut().enumerate().skip(moved) {
            let of_sample = effects.iter().map(|effect| effect.by_sample[j].get(k).copied().unwrap_or(0.0));
            *whole = whole.hypot(size(&mixed(mixing, of_sample)));
        }
    }
    for change in &mut run.changes {
        let Some(place) = nominal.changes.iter().position(|(time_s, ..)| *time_s == change.time_s) else { continue };
        let all: Option<Vec<&[Vec<f64>; 2]>> = effects.iter().map(|effect| effect.at_changes[place].as_ref()).collect();
        let Some(all) = all else { continue };
        for j in 0..run.columns.len() {
            let of = |side: usize| mixed(mixing, all.iter().map(|effects| effects[side][j]));
            change.before.set_by_base(j, of(0));
            change.after.set_by_base(j, of(1));
        }
    }
}

/// The sentence on what is in the bounds.
fn said(file: &ModelFile, carried: &[String], left_out: &[String], failed: &[String], is_sound: bool) -> String {
    let base = file.known.as_ref().map(KnownAircraft::name).unwrap_or_default();
    let some = |names: &[String]| -> String {
        let named = names.iter().take(MOST_NAMES).cloned().collect::<Vec<_>>().join(", ");
        match names.len().saturating_sub(MOST_NAMES) {
            0 => named,
            more => format!("{named} and {more} more"),
        }
    };
    let mut text = match (carried, file.uncertainty.base) {
        ([], _) if left_out.is_empty() && failed.is_empty() => {
            format!("What is declared uncertain of the base {base} changes no coefficient of this flight.")
        }
        ([], _) => format!("The bounds contain nothing of what is declared uncertain of the base {base}."),
        (_, BaseUncertainty::Part(part)) => format!(
            "The bounds contain errors of the base {base}, one sigma {}: {:.1} % of what each coefficient changes from the reference \
             condition, each by itself.",
            if carried.len() == 1 { "of one coefficient" } else { "of each coefficient" },
            100.0 * part
        ),
        _ => format!(
            "The bounds contain the uncertainty that {base} states of its tables and numbers, {} of them: {}.",
            carried.len(),
            some(carried)
        ),
    };
    if !left_out.is_empty() {
        let _ = write!(
            text,
            " Left out: {}; at most {MOST_ELEMENTS} are worked out, those that change the coefficients most, and none whose bounds do not \
             belong to its table or that has no number in this flight.",
            some(left_out)
        );
    }
    if !failed.is_empty() {
        let _ = write!(
            text,
            " With these moved by their uncertainty there was no estimate to compare with, so that they are not in the bounds: {}.",
            some(failed)
        );
    }
    if !is_sound {
        text.push_str(" The correlations that it states contradict each other: its elements count as independent.");
    }
    text
}
