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

mod moments;

use phugoid_estimators::{ChangeState, ParameterStatus};

use self::moments::{Moments, nats, onsets};
use crate::core::error::EstimateError;
use crate::core::estimation::{ChangeOutcome, Event, EventKind, without_part};
use crate::core::options::{EstimateOptions, KnownChange, Opens};
use crate::core::term::Coefficient;
use crate::judge::both_sides::BothSides;
use crate::methods::{ColumnRun, Disputed, EveryRoom, ModelError, Run, RunChange, Task, run};
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
/// The ends of the interval in which the change lies are looked for to within this, s.
const RESOLUTION_S: f64 = 0.2;
/// Evidence that a moment may have less than the best one, so that the change may have happened there as well: nats, and a part of
/// what the change gains. The part is for models that are wrong, whose evidence counts the same error with every sample; it was chosen on
/// the damages of `develop` (docs/methods.md, looking back).
const AS_GOOD: f64 = 10.0;
const AS_GOOD_PART: f64 = 0.1;
/// Most changes that are looked for in one record.
const CHANGES: usize = 3;
/// Evidence from which a change is believed, nats. Of 172 real changes of foreign flights that were found three gain less, which were dated three to seven seconds
/// wrongly; of 24 that were found in healthy flights in air that turns 20 do (docs/methods.md, looking back).
const EVIDENCE: f64 = 1000.0;
/// The same from which on a change that is believed but for that is held against the result, and from which one stays that was adopted in flight.
const EVIDENCE_OF_DOUBT: f64 = 100.0;
/// The same where, with the change, a further one still gains this part as much: then the parameters wander, as those of a
/// model do that is wrong. Behind real changes of foreign flights it gains a quarter as much at most, with few exceptions that
/// have far more evidence.
const EVIDENCE_WANDERING: f64 = 3000.0;
const WANDERS: f64 = 0.35;
/// A further change has to gain this part of what the first one gains: behind a real change a model that is
/// wrong gains up to that by being opened once more.
const FURTHER: f64 = 0.25;
/// Standard errors by which a derivative has to change.
const SIGMAS: f64 = 5.0;
/// A trim shift: with the constants alone opened the record is predicted better by so many nats, and by this part of what it gains with
/// everything opened. No derivative is called another one where a constant explains as much (docs/methods.md, looking back). The
/// second part is that where no derivative differs by enough with everything opened.
const EVIDENCE_OF_CONSTANTS: f64 = 250.0;
const AS_MUCH: f64 = 0.96;
const MOST_OF: f64 = 0.9;
/// This part is enough where the moment is sharp: what a record says of its time, s. Of foreign flights two trim shifts that gain 88 and 89 %
/// lie within 0.8 and 1.2 s, and what another trim and missing terms make of a healthy one (86 %) within 3.6 s.
const MOST_OF_SHARP: f64 = 0.85;
const SHARP_S: f64 = 2.0;
/// Evidence of a change that is not believed, from which on the result is held against the values with it, nats: of 483 healthy flights of
/// foreign aircraft one has more and another value with it, and it was doubtful before (docs/methods.md, looking back).
const EVIDENCE_OF_DISPUTED: f64 = 500.0;

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
    let searched = searched(task, first, progress)?;
    let run = settled(task, searched)?;
    progress(1.0);
    Ok(run)
}

/// Once the changes are known, what the model lacks may be learnt as fast as the data say ([`ModelError::Free`]), and the record
/// is run once more so. That run stands if it predicts the record better. Where a change stands that was adopted in flight, the
/// run stands in which it was: another one would not open the parameters as that did.
fn settled<M: EveryRoom<N, R>, const N: usize, const R: usize>(
    task: &Task<M, N, R>,
    searched: Run<R>,
) -> Result<Run<R>, EstimateError> {
    if searched.status.change == ChangeState::InDoubt {
        return Ok(searched);
    }
    let mut known = task.options.known_changes.clone();
    let found = searched.changes.iter().filter(|change| change.outcome == ChangeOutcome::FoundAfterwards);
    for RunChange { time_s, opens, .. } in found {
        known = added(&known, KnownChange { time_s: *time_s, opens: *opens });
    }
    let free = Again { task, model_error: ModelError::Free }.with(&known)?;
    let again = |change: &RunChange| free.changes.iter().find(|own| own.time_s == change.time_s);
    let is_repeated = searched.changes.iter().all(|change| !change.outcome.stands() || again(change).is_some());
    if !is_repeated || free.evidence() <= searched.evidence() {
        return Ok(searched);
    }
    let mut changes = searched.changes;
    for change in changes.iter_mut().filter(|change| change.outcome.stands()) {
        if let Some(own) = again(change) {
            (change.before, change.after) = (own.before.clone(), own.after.clone());
        }
    }
    // What was said of changes is what the search said.
    let of_changes = searched.events.into_iter().filter(|event| event.kind.is_of_detector());
    let others = free.events.into_iter().filter(|event| !event.kind.is_of_detector());
    let mut events: Vec<Event> = others.chain(of_changes).collect();
    events.sort_by(|a, b| a.time_s.total_cmp(&b.time_s));
    Ok(Run { changes, events, detector: searched.detector, disputed: searched.disputed, ..free })
}

/// The run with the changes that the record shows.
fn searched<M: EveryRoom<N, R>, const N: usize, const R: usize>(
    task: &Task<M, N, R>,
    first: Run<R>,
    progress: &mut dyn FnMut(f64),
) -> Result<Run<R>, EstimateError> {
    let Some(end_s) = task.prepared.time.last().copied() else { return Ok(first) };
    let window = window(task, &first);
    if window.is_none() && !first.changes.iter().any(|change| change.outcome.stands()) {
        return Ok(first);
    }
    let again = Again { task, model_error: ModelError::Slow };
    let without = again.with(&task.options.known_changes)?;
    let Searched { found, disputed } = match window {
        Some(window) => search(&again, window, &without, progress)?,
        None => Searched { found: None, disputed: None },
    };
    progress(1.0);
    let run = match found {
        Some((found, evidence_with)) if evidence_with > needed(&found, &first, without.evidence()) => found,
        _ if is_unsupported(&first, &without, &task.prepared.time) => withdrawn(&first, without, end_s),
        _ => first,
    };
    Ok(Run { disputed, ..run })
}

/// Evidence that a run with changes that were found afterwards has to have, so that it stands in place of the first one, nats: that of
/// the first one, or, where it has trim shifts alone, what explains as much.
fn needed<const R: usize>(found: &Run<R>, first: &Run<R>, without: f64) -> f64 {
    let shifts_alone = found.changes.iter().all(|change| change.opens == Opens::Constants);
    let gain = first.evidence() - without;
    without + if shifts_alone && gain > 0.0 { AS_MUCH * gain } else { gain }
}

/// Whether the run has adopted changes with which the whole record is not predicted better than without them. Of a change shortly
/// before the end there is not yet much to predict: with that, it must not have become worse. Nor must what comes after a doubt
/// that is not decided at the end.
fn is_unsupported<const R: usize>(first: &Run<R>, without: &Run<R>, time_s: &[f64]) -> bool {
    let adopted = in_flight(first, without).filter(|change| change.outcome.stands());
    let last_s = adopted.map(|change| change.time_s).reduce(f64::max);
    let (Some(last_s), Some(end_s)) = (last_s, time_s.last()) else { return false };
    let needed = if last_s > end_s - AFTER_S { 0.0 } else { EVIDENCE_OF_DOUBT };
    let open = first.status.change == ChangeState::InDoubt;
    let doubted = first.events.iter().rfind(|event| open && event.kind == EventKind::InDoubt);
    let gain_from = |sample: usize| first.evidence_from(sample) - without.evidence_from(sample);
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

/// What a search for changes came to.
struct Searched<const R: usize> {
    /// The best run of those that are opened where the record says that the parameters changed, with its evidence; none where
    /// nothing is believed.
    found: Option<(Run<R>, f64)>,
    /// What is not believed, and has much evidence; none where something is.
    disputed: Option<Disputed>,
}

/// A moment that is not believed, with what it gains, nats; none if that is less than `enough`.
fn disputed<const R: usize>(tried: &Tried<R>, gain: f64, enough: f64) -> Option<Disputed> {
    // Without a value where a parameter is not settled: that says nothing.
    let value = |column: &ColumnRun| {
        (column.status == ParameterStatus::Converged).then_some([column.value, column.corrected_std_error])
    };
    let opened = tried.run.columns.iter().map(value).collect();
    (gain >= enough).then_some(Disputed { time_s: tried.change.time_s, gain, opened })
}

/// The changes that a record shows. `without` is the run without a change.
fn search<M: EveryRoom<N, R>, const N: usize, const R: usize>(
    again: &Again<M, N, R>,
    window: [f64; 2],
    without: &Run<R>,
    progress: &mut dyn FnMut(f64),
) -> Result<Searched<R>, EstimateError> {
    let task = again.task;
    let searches = CHANGES as f64 + 1.0;
    let mut known = task.options.known_changes.clone();
    let mut standing = without.evidence();
    let mut found: Option<Run<R>> = None;
    let mut best = again.best(&known, window, without, &mut |done| progress(done / searches))?;
    let (mut accepted, mut first_gain) = (0, 0.0);
    let mut unbelieved: Option<Disputed> = None;
    while accepted < CHANGES {
        let gain = best.evidence - standing;
        // So close to one that is known it is no other one: within seconds nothing tells the values before and after.
        let is_further = found.is_none() || gain >= EVIDENCE.max(FURTHER * first_gain);
        if is_close(&known, best.change.time_s) || !is_further {
            break;
        }
        let is_believed = gain >= EVIDENCE_OF_DOUBT && is_believed(task, &best, &known);
        if gain < EVIDENCE || !is_believed {
            unbelieved = disputed(&best, gain, if is_believed { EVIDENCE_OF_DOUBT } else { EVIDENCE_OF_DISPUTED });
            break;
        }
        let Tried { change, evidence: evidence_with, run: with } = best;
        let opened = added(&known, change);
        let mut done = |done: f64| progress((accepted as f64 + 1.0 + done) / searches);
        best = again.best(&opened, window, &with, &mut done)?;
        let further = best.evidence - evidence_with;
        if let Some(together) = again.together(&known, change, &best, evidence_with, standing)? {
            best = together;
            continue;
        }
        // What wanders goes on to gain by being opened elsewhere; one sudden change explains the whole record.
        let wanders = further > WANDERS * gain;
        if wanders && gain < EVIDENCE_WANDERING {
            let tried = Tried { change, evidence: evidence_with, run: with };
            unbelieved = disputed(&tried, gain, EVIDENCE_OF_DISPUTED);
            break;
        }
        first_gain = f64::max(first_gain, gain);
        (known, standing) = (opened, evidence_with);
        found = Some(with);
        accepted += 1;
    }
    let Some(mut found) = found else { return Ok(Searched { found: None, disputed: unbelieved }) };
    say_found_afterwards(again, &mut found, &known, window, standing)?;
    Ok(Searched { found: Some((found, standing)), disputed: None })
}

/// Marks the changes of a run that were not given but found by looking at the whole record, and says between which times they
/// lie. `evidence` is that of the run.
fn say_found_afterwards<M: EveryRoom<N, R>, const N: usize, const R: usize>(
    again: &Again<M, N, R>,
    found: &mut Run<R>,
    known: &[KnownChange],
    window: [f64; 2],
    evidence: f64,
) -> Result<(), EstimateError> {
    let given = &again.task.options.known_changes;
    let time = &again.task.prepared.time;
    // A change is dated by the first sample that it holds for.
    let sample = |t: f64| time.get(time.partition_point(|s| *s + 1e-9 < t)).copied();
    for opened in known.iter().copied().filter(|change| !given.contains(change)) {
        let Some(time_s) = sample(opened.time_s) else { continue };
        let interval_s = again.interval(known, opened, window, evidence)?;
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

/// Whether a moment is too close to one of the changes to be another one.
fn is_close(changes: &[KnownChange], time_s: f64) -> bool {
    changes.iter().any(|change| (change.time_s - time_s).abs() < CLOSEST_S)
}

/// The changes with one more, in order of time.
fn added(known: &[KnownChange], change: KnownChange) -> Vec<KnownChange> {
    let mut changes = known.to_vec();
    changes.push(change);
    changes.sort_by(|a, b| a.time_s.total_cmp(&b.time_s));
    changes
}

/// Runs of the same method with the parameters opened at given times.
struct Again<'a, 'b, M: EveryRoom<N, R>, const N: usize, const R: usize> {
    task: &'a Task<'b, M, N, R>,
    model_error: ModelError,
}

/// A change that was asked about, and the run that was opened there.
struct Tried<const R: usize> {
    change: KnownChange,
    evidence: f64,
    run: Run<R>,
}

impl<M: EveryRoom<N, R>, const N: usize, const R: usize> Again<'_, '_, M, N, R> {
    fn with(&self, known_changes: &[KnownChange]) -> Result<Run<R>, EstimateError> {
        let options = EstimateOptions {
            change_detection: Some(false),
            known_changes: known_changes.to_vec(),
            ..self.task.options.clone()
        };
        let Task { prepared, file, noise, .. } = *self.task;
        run(&Task { model_error: self.model_error, ..Task::new(prepared, file, &options, noise) }, &mut |_| {})
    }

    fn at(&self, known: &[KnownChange], change: KnownChange) -> Result<Tried<R>, EstimateError> {
        let run = self.with(&added(known, change))?;
        Ok(Tried { change, evidence: run.evidence(), run })
    }

    /// The best moment to open everything; or the constants alone there, where that explains as much. `without` is the run without
    /// one.
    fn best(
        &self,
        known: &[KnownChange],
        window: [f64; 2],
        without: &Run<R>,
        progress: &mut dyn FnMut(f64),
    ) -> Result<Tried<R>, EstimateError> {
        let [from_s, to_s] = window;
        let standing = without.evidence();
        let moments = (((to_s - from_s) / CLOSEST_S).ceil() as usize).clamp(1, MOST);
        let step_s = (to_s - from_s) / moments as f64;
        let mut everything = Moments::at(self, known, Opens::Everything, window, from_s + 0.5 * step_s)?;
        for k in 1..moments {
            progress(k as f64 / moments as f64);
            everything.try_at(from_s + (k as f64 + 0.5) * step_s)?;
        }
        for onset_s in onsets(&nats(without), &self.task.prepared.time, window) {
            everything.try_at(onset_s)?;
        }
        if everything.best.evidence - standing <= WORTH * EVIDENCE_OF_DOUBT {
            return Ok(everything.best);
        }
        everything.narrow(step_s, without)?;
        let best = everything.best;
        // With a change that is known close by the constants are opened already.
        if !is_close(known, best.change.time_s) {
            let mut constants = Moments::at(self, known, Opens::Constants, window, best.change.time_s)?;
            constants.try_sudden(without)?;
            constants.fine()?;
            let shifted = constants.best;
            let gain = shifted.evidence - standing;
            let part = gain / (best.evidence - standing);
            let is_shift = gain >= EVIDENCE_OF_CONSTANTS && is_trim_shift(self.task, &shifted, known);
            if is_shift
                && (part >= AS_MUCH
                    || !is_believed_by_itself(self.task, &best, known)
                        && self.is_most(known, &shifted, part, window)?)
            {
                return Ok(shifted);
            }
        }
        Ok(best)
    }

    /// One change of everything in place of a trim shift, `shift`, and a further change, `next`, of everything, where it explains the record as well:
    /// derivatives that change together with a constant are no trim shift, also where nothing shows it until the next manoeuvre. `with_shift` is the evidence with
    /// the trim shift alone, `standing` that without it.
    fn together(
        &self,
        known: &[KnownChange],
        shift: KnownChange,
        next: &Tried<R>,
        with_shift: f64,
        standing: f64,
    ) -> Result<Option<Tried<R>>, EstimateError> {
        let is_followed = shift.opens == Opens::Constants
            && next.change.opens == Opens::Everything
            && next.evidence - with_shift >= EVIDENCE_OF_DOUBT
            && is_believed_by_itself(self.task, next, &added(known, shift));
        if !is_followed {
            return Ok(None);
        }
        let everything = |time_s: f64| self.at(known, KnownChange { time_s, opens: Opens::Everything });
        let mut one = everything(shift.time_s)?;
        if is_close(&[shift], next.change.time_s) {
            let other = everything(next.change.time_s)?;
            one = if other.evidence > one.evidence { other } else { one };
        }
        let is_as_much = one.evidence - standing >= AS_MUCH * (next.evidence - standing);
        Ok((is_as_much && is_believed_by_itself(self.task, &one, known)).then_some(one))
    }

    /// Whether the part of the evidence that the constants alone gain is enough where no derivative is another one.
    fn is_most(
        &self,
        known: &[KnownChange],
        shifted: &Tried<R>,
        part: f64,
        window: [f64; 2],
    ) -> Result<bool, EstimateError> {
        if !(MOST_OF_SHARP..MOST_OF).contains(&part) {
            return Ok(part >= MOST_OF);
        }
        let opened = added(known, shifted.change);
        let [from_s, to_s] = self.interval(&opened, shifted.change, window, shifted.evidence)?;
        Ok(to_s - from_s <= SHARP_S)
    }

    /// The times between which the change may have happened that is opened at `opened_s`, one of `known`, s: with the others
    /// where they are, the record is predicted as well, but for [`AS_GOOD`] and [`AS_GOOD_PART`] of what the change gains. In seconds
    /// in which nothing moves all moments are as good.
    fn interval(
        &self,
        known: &[KnownChange],
        opened: KnownChange,
        [from_s, to_s]: [f64; 2],
        evidence: f64,
    ) -> Result<[f64; 2], EstimateError> {
        let opened_s = opened.time_s;
        let others: Vec<KnownChange> = known.iter().copied().filter(|change| change.time_s != opened_s).collect();
        // Changes do not pass each other.
        let times = || others.iter().map(|change| change.time_s);
        let from_s = times().filter(|t| *t < opened_s).fold(from_s, f64::max);
        let to_s = times().filter(|t| *t > opened_s).fold(to_s, f64::min);
        let gain = evidence - self.with(&others)?.evidence();
        let is_as_good = |time_s: f64| {
            self.at(&others, KnownChange { time_s, ..opened })
                .map(|tried| tried.evidence >= evidence - AS_GOOD - AS_GOOD_PART * gain)
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

/// Whether a parameter is another one before the change and after it, until the next known change; or, where none shows that by itself, all
/// of a coefficient together ([`BothSides::moves_otherwise`]). The drag alone does not say so: what the engine does looks like it.
fn is_believed<M: EveryRoom<N, R>, const N: usize, const R: usize>(
    task: &Task<M, N, R>,
    tried: &Tried<R>,
    known: &[KnownChange],
) -> bool {
    is_another(task, tried, known, |differs| {
        differs.by_itself(&tried.run.columns) || differs.together(&tried.run.columns)
    })
}

/// Whether a parameter is another one by itself: what is asked against a trim shift, which the derivatives together imitate.
fn is_believed_by_itself<M: EveryRoom<N, R>, const N: usize, const R: usize>(
    task: &Task<M, N, R>,
    tried: &Tried<R>,
    known: &[KnownChange],
) -> bool {
    is_another(task, tried, known, |differs| differs.by_itself(&tried.run.columns))
}

/// Whether the aircraft is another one: by its constants where they alone were opened, else by what is asked of everything.
fn is_another<M: EveryRoom<N, R>, const N: usize, const R: usize>(
    task: &Task<M, N, R>,
    tried: &Tried<R>,
    known: &[KnownChange],
    with_everything: impl Fn(&Differs) -> bool,
) -> bool {
    match tried.change.opens {
        Opens::Constants => is_trim_shift(task, tried, known),
        Opens::Everything => Differs::of(task, tried, known).is_some_and(|differs| with_everything(&differs)),
    }
}

/// Whether a constant is another one, with everything else as it was. How sure that is says the evidence: the standard errors of a constant before and
/// after are mostly those of the derivatives, which are the same.
fn is_trim_shift<M: EveryRoom<N, R>, const N: usize, const R: usize>(
    task: &Task<M, N, R>,
    tried: &Tried<R>,
    known: &[KnownChange],
) -> bool {
    Differs::of(task, tried, known).is_some_and(|differs| {
        differs.any(|role, j| {
            let [before, after] = differs.values(&tried.run.columns[j]);
            role.is_constant_term() && differs.sides.is_trim_shift(j, before, after)
        })
    })
}

/// What can be said of the parameters but those of the drag before a change and after it.
struct Differs<'a> {
    sides: BothSides,
    /// The samples before the change and before the next known one.
    samples: [usize; 2],
    roles: Vec<&'a Role>,
}

impl<'a> Differs<'a> {
    /// `None` where nothing can be said, or the values run into their bounds and explain nothing.
    fn of<M: EveryRoom<N, R>, const N: usize, const R: usize>(
        task: &Task<'a, M, N, R>,
        Tried { change, run, .. }: &Tried<R>,
        known: &[KnownChange],
    ) -> Option<Self> {
        if run.columns.iter().any(|column| column.status == ParameterStatus::AtLimit) {
            return None;
        }
        let time = &task.prepared.time;
        let before = |time_s: f64| time.partition_point(|t| *t < time_s).checked_sub(1);
        let next_s = known.iter().map(|other| other.time_s).find(|t| *t > change.time_s);
        let samples = [before(change.time_s)?, before(next_s.unwrap_or(f64::INFINITY))?];
        let roles = task.file.estimated().take(run.columns.len()).map(|p| &p.role).collect();
        Some(Self { sides: BothSides::of(task, run, change.time_s)?, samples, roles })
    }

    fn is_of_drag(&self, j: usize) -> bool {
        self.roles.get(j).is_none_or(|role| matches!(role, Role::Term(Coefficient::Drag, _)))
    }

    /// The values of a column before and after.
    fn values(&self, column: &ColumnRun) -> [f64; 2] {
        self.samples.map(|sample| column.values[sample])
    }

    /// Whether any parameter is another one.
    fn any(&self, is_another: impl Fn(&Role, usize) -> bool) -> bool {
        self.roles.iter().enumerate().any(|(j, role)| !self.is_of_drag(j) && is_another(role, j))
    }

    /// Whether any parameter is another one by more than its errors and more than missing terms make.
    fn by_itself(&self, columns: &[ColumnRun]) -> bool {
        self.any(|_, j| {
            let ([before, after], [from, to]) = (self.values(&columns[j]), self.samples);
            self.sides.tells(j, before, after) && sigmas(&columns[j], from, to) > SIGMAS
        })
    }

    /// Whether all of them together move the aircraft otherwise. The drag stays as it is in the end.
    fn together(&self, columns: &[ColumnRun]) -> bool {
        self.sides.moves_otherwise(&|j| {
            let [before, after] = columns.get(j).map_or([0.0; 2], |column| self.values(column));
            if self.is_of_drag(j) { [after; 2] } else { [before, after] }
        })
    }
}

/// Standard errors by which a column differs between two samples, without the part of the errors that the model file declares:
/// that is the same at both.
fn sigmas(column: &ColumnRun, from: usize, to: usize) -> f64 {
    let declared = if column.value == 0.0 { 0.0 } else { column.systematic_std / column.value.abs() };
    let std = |sample: usize| without_part(column.std_errors[sample], declared * column.values[sample].abs());
    (column.values[to] - column.values[from]).abs() / std(from).hypot(std(to))
}
