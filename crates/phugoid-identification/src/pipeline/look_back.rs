//! A second look at a whole record for a sudden change of the aircraft.
//!
//! A method that runs sample by sample has to decide within seconds whether what it sees is a change, and where its
//! residuals are coloured it asks for so much that it misses a third of the damages that foreign flights have. A record can be
//! asked more: how much better would everything after a moment have been predicted, had the parameters been opened there?
//! The method is run again with the parameters opened at moments all over the flight, and the sum of the logarithms of the
//! densities that it gave to each sample before it saw it is compared (prequential evidence: A. P. Dawid, *Statistical
//! Theory: The Prequential Approach*, J. R. Statist. Soc. A 147, 1984). A model that is wrong everywhere gains by being
//! opened anywhere, so evidence alone is not enough: a derivative has to be another one before and after, by more than its
//! errors and more than missing terms make of it, and the flight has to move it alike on both sides
//! ([`BothSides`]). The same evidence is asked for of what was adopted in flight: where the whole record is not predicted better
//! with it, it is taken back.

use phugoid_estimators::{ChangeState, ParameterStatus};

use crate::core::error::EstimateError;
use crate::core::estimation::{ChangeOutcome, Event, EventKind, without_part};
use crate::core::options::EstimateOptions;
use crate::core::term::Coefficient;
use crate::judge::both_sides::BothSides;
use crate::methods::{ColumnRun, EveryRoom, Run, RunChange, Task, run};
use crate::model_file::{Base, Role};

/// Flight from the first motion to the first moment that is asked about, s: until then the estimates are still being found, and
/// a filter whose model is wrong gains by being opened once more.
const BEFORE_S: f64 = 15.0;
/// Flight from the last moment to the end, s: there has to be a manoeuvre in it.
const AFTER_S: f64 = 8.0;
/// Moments that are asked about at first: not closer than this, s, and not more than so many.
const CLOSEST_S: f64 = 3.0;
const MOST: usize = 9;
/// Part of the evidence for a change that the best of them has to have, so that its neighbourhood is looked at.
const WORTH: f64 = 0.25;
/// The best moment, and the ends of the interval in which the change lies, are then looked for to within this, s.
const RESOLUTION_S: f64 = 0.2;
/// Evidence that a moment may have less than the best one, so that the change may have happened there as well: nats, and a part of
/// what the change gains. The part is for models that are wrong, whose evidence counts the same error with every sample; it was chosen on
/// the damages of `develop` (docs/methods.md, looking back).
const AS_GOOD: f64 = 10.0;
const AS_GOOD_PART: f64 = 0.1;
/// Most changes that are looked for in one record.
const CHANGES: usize = 3;
/// Evidence from which a change is believed, nats.
const EVIDENCE: f64 = 100.0;
/// The same where the aircraft flies at another speed afterwards, and that speed: the difference of the logarithms of the means.
/// Terms that the model lacks make other derivatives of another flight condition.
const EVIDENCE_ELSEWHERE: f64 = 1000.0;
const ELSEWHERE: f64 = 0.05;
/// The same where, with the change, a further one still gains this part as much: then the parameters wander, as those of a
/// model do that is wrong. Behind real changes of foreign flights it gains a quarter as much at most, with few exceptions that
/// have far more evidence.
const EVIDENCE_WANDERING: f64 = 3000.0;
const WANDERS: f64 = 0.35;
/// Standard errors by which a derivative has to change.
const SIGMAS: f64 = 5.0;

/// What is said of the moment.
const AFTERWARDS: &str =
    "the parameters changed: not noticed in flight, found when the whole record was looked at again";

/// What is said of changes that were adopted in flight, and with which the record is not predicted better.
const WITHDRAWN: &str = "what was adopted in flight was taken back when the whole record was looked at again: it is not predicted better with it";

/// Whether a record is looked at again by this method with these options. Increments to a database are not: with a scale of the
/// surfaces that is off by 3 % a moment of the `f16-six` was taken for a change, and what is asked was measured on
/// foreign flights in absolute form alone.
pub(super) fn looks_back<M: EveryRoom<N, R>, const N: usize, const R: usize>(task: &Task<M, N, R>) -> bool {
    let options = task.options;
    let looks = options.change_detection.unwrap_or(task.file.change_detection) && !options.causal_only;
    looks && task.file.base == Base::None && task.method().learns_noise() && task.health.is_none()
}

/// The run of a causal method over a whole record; or the better one in which the parameters were opened where the record
/// says that they changed; or the one without a change, where the record is not predicted better with what was adopted in flight.
///
/// # Errors
/// Those of the method.
pub(super) fn look_back<M: EveryRoom<N, R>, const N: usize, const R: usize>(
    task: &Task<M, N, R>,
    first: Run<R>,
    progress: &mut dyn FnMut(f64),
) -> Result<Run<R>, EstimateError> {
    if !looks_back(task) || !first.excited {
        return Ok(first);
    }
    let Some(end_s) = task.prepared.time.last().copied() else { return Ok(first) };
    let window = window(task, &first);
    if window.is_none() && !first.changes.iter().any(|change| change.outcome.stands()) {
        return Ok(first);
    }
    let again = Again { task };
    let without = again.with(&task.options.known_changes_s)?;
    let found = match window {
        Some(window) => search(&again, window, evidence(&without), progress)?,
        None => None,
    };
    progress(1.0);
    Ok(match found {
        Some((found, evidence_with)) if evidence_with > evidence(&first) => found,
        _ if is_unsupported(&first, &without, &task.prepared.time) => withdrawn(&first, without, end_s),
        _ => first,
    })
}

/// Whether the run has adopted changes with which the whole record is not predicted better than without them. Of a change shortly
/// before the end there is not yet much to predict: with that, it must not have become worse. Nor must what comes after a doubt
/// that is not decided at the end.
fn is_unsupported<const R: usize>(first: &Run<R>, without: &Run<R>, time_s: &[f64]) -> bool {
    let adopted = in_flight(first, without).filter(|change| change.outcome.stands());
    let last_s = adopted.map(|change| change.time_s).reduce(f64::max);
    let (Some(last_s), Some(end_s)) = (last_s, time_s.last()) else { return false };
    let needed = if last_s > end_s - AFTER_S { 0.0 } else { EVIDENCE };
    let open = first.status.change == ChangeState::InDoubt;
    let doubted = first.events.iter().rfind(|event| open && event.kind == EventKind::InDoubt);
    let gain_from = |sample: usize| evidence_from(first, sample) - evidence_from(without, sample);
    gain_from(0) < needed && doubted.is_none_or(|event| gain_from(time_s.partition_point(|t| *t < event.time_s)) < 0.0)
}

/// The changes that a run found itself: those of the same run without a search for changes are given ones.
fn in_flight<'a, const R: usize>(first: &'a Run<R>, without: &'a Run<R>) -> impl Iterator<Item = &'a RunChange> {
    first.changes.iter().filter(|change| without.changes.iter().all(|given| given.time_s != change.time_s))
}

/// The run without the changes that were adopted in flight, with word of what happened to them.
fn withdrawn<const R: usize>(first: &Run<R>, mut without: Run<R>, end_s: f64) -> Run<R> {
    let taken_back = in_flight(first, &without).map(|change| {
        let outcome = if change.outcome.stands() { ChangeOutcome::WithdrawnAfterwards } else { change.outcome };
        RunChange { outcome, ..change.clone() }
    });
    let taken_back: Vec<RunChange> = taken_back.collect();
    without.changes.extend(taken_back);
    without.changes.sort_by(|a, b| a.time_s.total_cmp(&b.time_s));
    // What the search for changes said in flight, and its end.
    let is_known = |event: &Event| without.events.iter().any(|e| (e.time_s, e.kind) == (event.time_s, event.kind));
    let said: Vec<Event> =
        first.events.iter().filter(|event| event.kind.is_of_detector() && !is_known(event)).cloned().collect();
    without.events.extend(said);
    let message = WITHDRAWN.to_owned();
    without.events.push(Event { time_s: end_s, kind: EventKind::RolledBack, message });
    without.events.sort_by(|a, b| a.time_s.total_cmp(&b.time_s));
    without
}

/// The best run of those that are opened where the record says that the parameters changed, with its evidence; none where
/// nothing is believed. `standing` is the evidence without a change.
fn search<M: EveryRoom<N, R>, const N: usize, const R: usize>(
    again: &Again<M, N, R>,
    [from_s, to_s]: [f64; 2],
    mut standing: f64,
    progress: &mut dyn FnMut(f64),
) -> Result<Option<(Run<R>, f64)>, EstimateError> {
    let task = again.task;
    let searches = CHANGES as f64 + 1.0;
    let mut known = task.options.known_changes_s.clone();
    let mut found: Option<Run<R>> = None;
    let mut best = again.best(&known, [from_s, to_s], standing, &mut |done| progress(done / searches))?;
    for search in 1..=CHANGES {
        let Tried { time_s, evidence: evidence_with, run: with } = best;
        let gain = evidence_with - standing;
        if gain < EVIDENCE || !is_believed(task, &with, time_s, &known) {
            break;
        }
        let opened = added(&known, time_s);
        let mut done = |done: f64| progress((search as f64 + done) / searches);
        best = again.best(&opened, [from_s, to_s], evidence_with, &mut done)?;
        // What wanders goes on to gain by being opened elsewhere; one sudden change explains the whole record.
        let further = best.evidence - evidence_with;
        let needed = if further > WANDERS * gain {
            EVIDENCE_WANDERING
        } else if is_elsewhere(task, time_s) {
            EVIDENCE_ELSEWHERE
        } else {
            EVIDENCE
        };
        if gain < needed {
            break;
        }
        (known, standing) = (opened, evidence_with);
        found = Some(with);
    }
    let Some(mut found) = found else { return Ok(None) };
    say_found_afterwards(again, &mut found, &known, [from_s, to_s], standing)?;
    Ok(Some((found, standing)))
}

/// Marks the changes of a run that were not given but found by looking at the whole record, and says between which times they
/// lie. `evidence` is that of the run.
fn say_found_afterwards<M: EveryRoom<N, R>, const N: usize, const R: usize>(
    again: &Again<M, N, R>,
    found: &mut Run<R>,
    known: &[f64],
    window: [f64; 2],
    evidence: f64,
) -> Result<(), EstimateError> {
    let given = &again.task.options.known_changes_s;
    let time = &again.task.prepared.time;
    // A change is dated by the first sample that it holds for.
    let sample = |t: f64| time.get(time.partition_point(|s| *s + 1e-9 < t)).copied();
    for opened_s in known.iter().copied().filter(|t| !given.contains(t)) {
        let Some(time_s) = sample(opened_s) else { continue };
        let interval_s = again.interval(known, opened_s, window, evidence)?;
        for change in found.changes.iter_mut().filter(|change| change.time_s == time_s) {
            change.outcome = ChangeOutcome::FoundAfterwards;
            change.interval_s = Some(interval_s);
        }
        let of_here = |event: &&mut Event| event.kind == EventKind::Adopted && event.time_s == time_s;
        found.events.iter_mut().filter(of_here).for_each(|event| AFTERWARDS.clone_into(&mut event.message));
    }
    Ok(())
}

/// The times between which a change is looked for, s; none where nothing is to be looked for.
fn window<M: EveryRoom<N, R>, const N: usize, const R: usize>(
    task: &Task<M, N, R>,
    first: &Run<R>,
) -> Option<[f64; 2]> {
    let moved = first.log_density.iter().position(|row| row.iter().any(|v| v.is_finite()))?;
    let (moved_s, end_s) = (*task.prepared.time.get(moved)?, *task.prepared.time.last()?);
    let window = [moved_s + BEFORE_S, end_s - AFTER_S];
    (window[0] < window[1]).then_some(window)
}

/// The times with one more, in order.
fn added(known: &[f64], time_s: f64) -> Vec<f64> {
    let mut times = known.to_vec();
    times.push(time_s);
    times.sort_by(f64::total_cmp);
    times
}

/// Logarithm of the density that a run gave to the record, sample by sample before it saw it, nats.
fn evidence<const R: usize>(run: &Run<R>) -> f64 {
    evidence_from(run, 0)
}

/// The same of the samples from this one on.
fn evidence_from<const R: usize>(run: &Run<R>, sample: usize) -> f64 {
    run.log_density.iter().skip(sample).flatten().filter(|nats| nats.is_finite()).sum()
}

/// Runs of the same method with the parameters opened at given times.
struct Again<'a, 'b, M: EveryRoom<N, R>, const N: usize, const R: usize> {
    task: &'a Task<'b, M, N, R>,
}

/// A moment that was asked about, and the run that was opened there.
struct Tried<const R: usize> {
    time_s: f64,
    evidence: f64,
    run: Run<R>,
}

impl<M: EveryRoom<N, R>, const N: usize, const R: usize> Again<'_, '_, M, N, R> {
    fn with(&self, known_changes_s: &[f64]) -> Result<Run<R>, EstimateError> {
        let options = EstimateOptions {
            change_detection: Some(false),
            known_changes_s: known_changes_s.to_vec(),
            ..self.task.options.clone()
        };
        let Task { prepared, file, noise, .. } = *self.task;
        run(&Task { prepared, file, options: &options, noise, health: None }, &mut |_| {})
    }

    fn at(&self, known: &[f64], time_s: f64) -> Result<Tried<R>, EstimateError> {
        let run = self.with(&added(known, time_s))?;
        Ok(Tried { time_s, evidence: evidence(&run), run })
    }

    /// The best moment. `standing` is the evidence without one.
    fn best(
        &self,
        known: &[f64],
        [from_s, to_s]: [f64; 2],
        standing: f64,
        progress: &mut dyn FnMut(f64),
    ) -> Result<Tried<R>, EstimateError> {
        let moments = (((to_s - from_s) / CLOSEST_S).ceil() as usize).clamp(1, MOST);
        let step_s = (to_s - from_s) / moments as f64;
        let mut best = self.at(known, from_s + 0.5 * step_s)?;
        let keep_better = |time_s: f64, best: &mut Tried<R>| -> Result<(), EstimateError> {
            let tried = self.at(known, time_s)?;
            if tried.evidence >= best.evidence {
                *best = tried;
            }
            Ok(())
        };
        for k in 1..moments {
            progress(k as f64 / moments as f64);
            keep_better(from_s + (k as f64 + 0.5) * step_s, &mut best)?;
        }
        let mut half_s = step_s / 2.0;
        while half_s > RESOLUTION_S && best.evidence - standing > WORTH * EVIDENCE {
            let middle_s = best.time_s;
            for beside_s in [middle_s - half_s, middle_s + half_s] {
                if (from_s..to_s).contains(&beside_s) {
                    keep_better(beside_s, &mut best)?;
                }
            }
            half_s /= 2.0;
        }
        Ok(best)
    }

    /// The times between which the change may have happened that is opened at `opened_s`, one of `known`, s: with the others
    /// where they are, the record is predicted as well, but for [`AS_GOOD`] and [`AS_GOOD_PART`] of what the change gains. In seconds
    /// in which nothing moves all moments are as good.
    fn interval(
        &self,
        known: &[f64],
        opened_s: f64,
        [from_s, to_s]: [f64; 2],
        evidence: f64,
    ) -> Result<[f64; 2], EstimateError> {
        let others: Vec<f64> = known.iter().copied().filter(|t| *t != opened_s).collect();
        // Changes do not pass each other.
        let from_s = others.iter().copied().filter(|t| *t < opened_s).fold(from_s, f64::max);
        let to_s = others.iter().copied().filter(|t| *t > opened_s).fold(to_s, f64::min);
        let gain = evidence - self.with(&others).map(|run| self::evidence(&run))?;
        let is_as_good = |time_s: f64| {
            self.at(&others, time_s).map(|tried| tried.evidence >= evidence - AS_GOOD - AS_GOOD_PART * gain)
        };
        let end = |limit_s: f64| -> Result<f64, EstimateError> {
            let (mut good_s, mut step_s) = (opened_s, RESOLUTION_S.copysign(limit_s - opened_s));
            // Outwards in steps that double, then to and fro between the last that is as good and the first that is not.
            let mut worse_s = loop {
                let next_s = good_s + step_s;
                if (limit_s - next_s) * step_s <= 0.0 {
                    return Ok(limit_s);
                }
                if !is_as_good(next_s)? {
                    break next_s;
                }
                (good_s, step_s) = (next_s, 2.0 * step_s);
            };
            while (worse_s - good_s).abs() > RESOLUTION_S {
                let middle_s = 0.5 * (good_s + worse_s);
                if is_as_good(middle_s)? {
                    good_s = middle_s;
                } else {
                    worse_s = middle_s;
                }
            }
            Ok(worse_s)
        };
        Ok([end(from_s)?, end(to_s)?])
    }
}

/// Whether the flight goes on at another speed.
fn is_elsewhere<M: EveryRoom<N, R>, const N: usize, const R: usize>(task: &Task<M, N, R>, time_s: f64) -> bool {
    let speeds = task.prepared.speeds();
    let (before, after) = speeds.split_at(task.prepared.time.partition_point(|t| *t < time_s).min(speeds.len()));
    let mean = |speeds: &[f64]| {
        let (sum, count) = speeds.iter().filter(|v| v.is_finite()).fold((0.0, 0.0), |(s, n), v| (s + v, n + 1.0));
        sum / count
    };
    let differs = (mean(after) / mean(before)).ln().abs();
    // Without an airspeed nothing says that it is the same.
    differs.is_nan() || differs > ELSEWHERE
}

/// Whether a parameter is another one before the time and after it, until the next known change. The drag alone does not say
/// so: what the engine does looks like it.
fn is_believed<M: EveryRoom<N, R>, const N: usize, const R: usize>(
    task: &Task<M, N, R>,
    run: &Run<R>,
    time_s: f64,
    known: &[f64],
) -> bool {
    // Values that run into their bounds explain nothing.
    if run.columns.iter().any(|column| column.status == ParameterStatus::AtLimit) {
        return false;
    }
    let Some(sides) = BothSides::of(task, run, time_s) else { return false };
    let time = &task.prepared.time;
    let before = |time_s: f64| time.partition_point(|t| *t < time_s).checked_sub(1);
    let next_s = known.iter().copied().find(|t| *t > time_s);
    let (Some(from), Some(to)) = (before(time_s), before(next_s.unwrap_or(f64::INFINITY))) else { return false };
    let of_drag = |role: &Role| matches!(role, Role::Term(Coefficient::Drag, _));
    task.file.estimated().zip(&run.columns).enumerate().any(|(j, (parameter, column))| {
        !of_drag(&parameter.role)
            && sides.tells(j, column.values[from], column.values[to])
            && sigmas(column, from, to) > SIGMAS
    })
}

/// Standard errors by which a column differs between two samples, without the part of the errors that the model file declares:
/// that is the same at both.
fn sigmas(column: &ColumnRun, from: usize, to: usize) -> f64 {
    let declared = if column.value == 0.0 { 0.0 } else { column.systematic_std / column.value.abs() };
    let std = |sample: usize| without_part(column.std_errors[sample], declared * column.values[sample].abs());
    (column.values[to] - column.values[from]).abs() / std(from).hypot(std(to))
}
