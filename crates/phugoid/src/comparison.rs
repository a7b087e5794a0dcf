//! Comparison of estimators on the same simulated flights.

use std::sync::atomic::{AtomicUsize, Ordering};

use phugoid_identification::method::Method;

use crate::Error;
use crate::studies::{self, ARENA, Arena, Contestant, Entry, arena_entry, nearest};

/// Lets methods estimate the same samples of the same simulated flights, and counts their errors against the Cramer-Rao
/// bound, how often the claimed bounds hold, and the time to 5 %. It uses all cores.
///
/// `scenarios` are built-in ones by name (`calm`, `turbulence-light`, `everything`, ...); each is flown `seeds` times,
/// every time with other sensor noise. All numbers but the computing times are the same on every machine.
///
/// ```
/// use phugoid::{Method, compare};
/// let arena = compare(&["calm"], &[Method::Smpe, Method::Rls], 1)?;
/// assert_eq!(arena.methods, ["smpe", "rls"]);
/// assert_eq!(arena.entries[0].id, "calm");
/// # Ok::<(), phugoid::Error>(())
/// ```
///
/// # Errors
/// [`Error::NoEntry`] for an unknown name; [`Error::Study`] for a flight that cannot be flown. A method that fails on a
/// flight is counted as failed there, which is no error.
pub fn compare(scenarios: &[&str], methods: &[Method], seeds: usize) -> Result<Arena, Error> {
    let entries = scenarios.iter().map(|name| entry(name)).collect::<Result<Vec<_>, _>>()?;
    compare_entries(&entries, methods, seeds, &|_| ())
}

/// As [`compare`], for scenarios and models of one's own; `progress` is called from any thread with the fraction done,
/// from 0 to 1.
///
/// ```
/// use phugoid::{Entry, Method, Model, Scenario, compare_entries};
/// let short_period_s = 3.5; // the period in which times are counted
/// let entry = Entry::new("mine", Scenario::named("f16-calm")?, Model::named("f16-model")?, short_period_s);
/// let arena = compare_entries(&[entry], &[Method::Smpe], 1, &|_| ())?;
/// assert_eq!(arena.entries[0].id, "mine");
/// # Ok::<(), phugoid::Error>(())
/// ```
///
/// # Errors
/// As [`compare`].
pub fn compare_entries(
    entries: &[Entry],
    methods: &[Method],
    seeds: usize,
    progress: &(dyn Fn(f64) + Sync),
) -> Result<Arena, Error> {
    let contestants: Vec<Contestant> = methods.iter().map(|method| Contestant::of(*method)).collect();
    let (done, all) = (AtomicUsize::new(0), (entries.len() * seeds).max(1) as f64);
    let step = || progress((1 + done.fetch_add(1, Ordering::Relaxed)) as f64 / all);
    Ok(studies::compare(entries, &contestants, seeds, &step)?)
}

/// A built-in scenario of the comparison by name, with what the methods are told of the aircraft: to be compared as it
/// is, or changed first.
///
/// ```
/// use phugoid::{Error, entry};
/// assert_eq!(entry("calm")?.model.estimated().count(), 5);
/// assert!(matches!(entry("clam"), Err(Error::NoEntry { nearest: Some("calm"), .. })));
/// # Ok::<(), Error>(())
/// ```
///
/// # Errors
/// [`Error::NoEntry`] with the nearest name.
pub fn entry(name: &str) -> Result<Entry, Error> {
    let known = || ARENA.iter().map(|(id, _)| *id);
    match arena_entry(name) {
        Some(found) => Ok(found?),
        None => {
            Err(Error::NoEntry { name: name.to_owned(), nearest: nearest(name, known()), known: known().collect() })
        }
    }
}
