//! The arena: every method estimates the same samples of the same flights, and the results say where each of them is
//! better or worse than the others.
//!
//! An [`Entry`] is a scenario and what every method is told of the aircraft; those in `scenarios/arena` are built in. Each
//! seed is flown once, and every [`Contestant`] sees the same measured record. [`compare`] counts, for each of them, errors
//! against the Cramer-Rao bound of that flight, coverage of the claimed bounds, time to 5 %, changes found, missed and
//! imagined, and time per sample; [`Arena::findings`] says in words what follows from the numbers.

mod criteria;
mod entry;
mod findings;
#[cfg(feature = "parquet")]
mod parquet;
mod parse;
mod result;
mod rows;
mod score;
mod trial;

pub use self::criteria::{CYCLES, TOLERANCE};
pub use self::entry::{BUILT_IN, Entry, SilentErrors, built_in};
pub use self::findings::{Best, Findings};
#[cfg(feature = "parquet")]
pub use self::parquet::parquet;
pub use self::result::{
    Arena, Checkpoint, Counted, Coverage, Detection, EntryResult, MethodResult, ParameterScore, Settled, Unit,
};
pub use self::rows::{Row, csv};
pub use self::trial::Contestant;

use crate::accuracy::StudyError;
use crate::ledger::{Ledger, recorded};

/// Flies each entry `seeds` times, lets every contestant estimate each flight, and compares. Flight `k` of an entry has the
/// seed of its scenario plus `k`. `ledger` is told of each flight with all its estimations, from any thread, and may keep them; it has
/// to know what the entries are made of and the settings of the contestants, which have one name each.
///
/// A contestant that fails on a flight is counted as failed there; the first contestant is the one that the findings speak
/// of as ours. All numbers but the times are the same on every machine and with any number of cores.
///
/// # Errors
/// [`StudyError`]: a scenario that cannot be flown, or a model that does not fit its flight, whatever the method.
pub fn compare(
    entries: &[Entry],
    contestants: &[Contestant],
    seeds: usize,
    ledger: &dyn Ledger,
) -> Result<Arena, StudyError> {
    let names: Vec<String> = contestants.iter().map(|c| c.name.clone()).collect();
    let flown = |run: usize| (entries.get(run / seeds.max(1)), (run % seeds.max(1)) as u64);
    let flights = recorded(
        entries.len() * seeds,
        &format!("arena: {names:?} after {CYCLES:?} cycles, within {TOLERANCE}"),
        |run| match flown(run) {
            (Some(entry), k) => format!("{}, cycles of {} s, flight {k}", entry.id, entry.cycle_s),
            (None, _) => String::new(),
        },
        |run| match flown(run) {
            (Some(entry), k) => trial::fly_and_estimate(entry, contestants, k),
            (None, _) => Err(StudyError::Unsuitable("there is no such entry".to_owned())),
        },
        ledger,
    )?;
    let mut rows = Vec::new();
    let mut results = Vec::new();
    for (entry, flights) in entries.iter().zip(flights.chunks(seeds.max(1))) {
        rows.extend(rows::rows(entry, &names, flights));
        results.push(score::score(entry, &names, flights));
    }
    let findings = Findings::of(&names, &results);
    Ok(Arena { seeds, methods: names, entries: results, findings, rows })
}
