//! The runs of a study and where their results are kept, so that one that was stopped goes on, and several processes do one
//! together.

use std::sync::atomic::{AtomicU64, Ordering};

use rand::SeedableRng;
use rand::seq::SliceRandom;
use rand_pcg::Pcg64Mcg;
use serde::Serialize;
use serde::de::DeserializeOwned;

use crate::monte_carlo::monte_carlo;

/// What is told of each run of a study, and where its result is kept.
///
/// A closure is a ledger that keeps nothing: it is called after each run, from any thread.
pub trait Ledger: Sync {
    /// A run has been made, or its result was found.
    fn done(&self);

    /// Whether results are kept at all.
    fn keeps(&self) -> bool {
        false
    }

    /// The result of a run as JSON, if it is kept. `inputs` is a text with all that decides on it beside the ledger's own
    /// files, `run` names it among those of these inputs.
    ///
    /// # Errors
    /// [`LedgerError`]: what is kept cannot be read.
    fn find(&self, inputs: &str, run: &str) -> Result<Option<String>, LedgerError> {
        let _ = (inputs, run);
        Ok(None)
    }

    /// Keeps the result of a run. It is there whole or not at all.
    ///
    /// # Errors
    /// [`LedgerError`]: it cannot be written.
    fn enter(&self, inputs: &str, run: &str, result: &str) -> Result<(), LedgerError> {
        let _ = (inputs, run, result);
        Ok(())
    }

    /// Whether this process makes the run before those that are left to others.
    fn is_ours(&self, inputs: &str, run: &str) -> bool {
        let _ = (inputs, run);
        true
    }
}

impl<F: Fn() + Sync> Ledger for F {
    fn done(&self) {
        self();
    }
}

/// Why a result cannot be kept or read.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct LedgerError(pub String);

/// As [`monte_carlo`], with each result kept in the ledger: a run whose result is there is not made again.
///
/// `inputs` is a text with all that decides on the results beside the number of the run and the files that the ledger knows,
/// `name` gives a run its name among them. Where several processes have one ledger, each makes the runs that are its own and
/// then, in an order of its own, those that are still missing; so it ends with all results, and one that dies delays the
/// others without failing them.
///
/// # Errors
/// As [`monte_carlo`]; [`LedgerError`].
pub fn recorded<T, E>(
    runs: usize,
    inputs: &str,
    name: impl Fn(usize) -> String + Sync,
    experiment: impl Fn(usize) -> Result<T, E> + Sync,
    ledger: &dyn Ledger,
) -> Result<Vec<T>, E>
where
    T: Serialize + DeserializeOwned + Send,
    E: From<LedgerError> + Send,
{
    if !ledger.keeps() {
        return monte_carlo(runs, experiment, || ledger.done());
    }
    let one = |run: usize| -> Result<T, E> {
        let name = name(run);
        let wrong = |error| LedgerError(format!("{name}: what is kept of it is not the result of this run: {error}"));
        if let Some(kept) = ledger.find(inputs, &name)? {
            return Ok(serde_json::from_str(&kept).map_err(wrong)?);
        }
        let result = serde_json::to_string(&experiment(run)?).map_err(wrong)?;
        ledger.enter(inputs, &name, &result)?;
        // What is used is what is kept, whoever has made it.
        Ok(serde_json::from_str(&result).map_err(wrong)?)
    };
    let (ours, mut others): (Vec<usize>, Vec<usize>) = (0..runs).partition(|run| ledger.is_ours(inputs, &name(*run)));
    // Two processes that have done their own meet at few of the runs that are left.
    others.shuffle(&mut Pcg64Mcg::seed_from_u64(order()));
    let mut results: Vec<Option<T>> = (0..runs).map(|_| None).collect();
    for part in [ours, others] {
        let made = monte_carlo(part.len(), |k| one(part[k]), || ledger.done())?;
        part.iter().zip(made).for_each(|(run, result)| results[*run] = Some(result));
    }
    // Every run is in one of the two parts.
    Ok(results.into_iter().flatten().collect())
}

/// A number that differs between processes and between calls. It decides on the order of work alone, on no result.
fn order() -> u64 {
    static CALLS: AtomicU64 = AtomicU64::new(0);
    (u64::from(std::process::id()) << 32) + CALLS.fetch_add(1, Ordering::Relaxed)
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;
    use std::sync::Mutex;

    use super::*;

    #[derive(Default)]
    struct InMemory {
        kept: Mutex<BTreeMap<String, String>>,
        others: Vec<String>,
    }

    impl Ledger for InMemory {
        fn done(&self) {}

        fn keeps(&self) -> bool {
            true
        }

        fn find(&self, inputs: &str, run: &str) -> Result<Option<String>, LedgerError> {
            Ok(self.kept.lock().unwrap().get(&format!("{inputs} {run}")).cloned())
        }

        fn enter(&self, inputs: &str, run: &str, result: &str) -> Result<(), LedgerError> {
            self.kept.lock().unwrap().insert(format!("{inputs} {run}"), result.to_owned());
            Ok(())
        }

        fn is_ours(&self, _: &str, run: &str) -> bool {
            !self.others.iter().any(|other| other == run)
        }
    }

    fn squares(ledger: &dyn Ledger, fails_at: Option<usize>) -> (Result<Vec<usize>, LedgerError>, Vec<usize>) {
        let made = Mutex::new(Vec::new());
        let square = |run: usize| {
            if Some(run) == fails_at {
                return Err(LedgerError("stopped".to_owned()));
            }
            made.lock().unwrap().push(run);
            Ok(run * run)
        };
        let results = recorded(6, "squares", |run| format!("of {run}"), square, ledger);
        (results, made.into_inner().unwrap())
    }

    #[test]
    fn what_was_made_is_not_made_again() {
        let ledger = InMemory::default();
        let (stopped, first) = squares(&ledger, Some(3));
        assert_eq!((stopped, first.len()), (Err(LedgerError("stopped".to_owned())), 5));
        let (whole, second) = squares(&ledger, None);
        assert_eq!((whole, second), (Ok(vec![0, 1, 4, 9, 16, 25]), vec![3]));
        // Other inputs are other runs.
        let (others, made) = (Mutex::new(0), |run: usize| Ok::<_, LedgerError>(run));
        let made = |run| {
            *others.lock().unwrap() += 1;
            made(run)
        };
        assert_eq!(recorded(2, "themselves", |run| format!("of {run}"), made, &ledger), Ok(vec![0, 1]));
        assert_eq!(*others.lock().unwrap(), 2);
    }

    #[test]
    fn runs_of_others_are_made_last_and_all_results_come_in_their_order() {
        let ledger = InMemory { others: vec!["of 0".to_owned(), "of 4".to_owned()], ..InMemory::default() };
        let (whole, made) = squares(&ledger, None);
        assert_eq!(whole, Ok(vec![0, 1, 4, 9, 16, 25]));
        let mut last = made[4..].to_vec();
        last.sort_unstable();
        assert_eq!(last, [0, 4]);
    }

    #[test]
    fn a_result_that_is_none_of_the_run_is_told_with_its_name() {
        let ledger = InMemory::default();
        ledger.enter("squares", "of 2", "\"four\"").unwrap();
        let (result, _) = squares(&ledger, None);
        assert!(result.unwrap_err().0.starts_with("of 2: what is kept of it is not the result"));
    }

    #[test]
    fn a_closure_keeps_nothing_and_is_told_of_every_run() {
        let told = AtomicU64::new(0);
        let ledger = || {
            told.fetch_add(1, Ordering::Relaxed);
        };
        assert_eq!(squares(&ledger, None).0, Ok(vec![0, 1, 4, 9, 16, 25]));
        assert_eq!(squares(&ledger, None).1.len(), 6);
        assert_eq!(told.into_inner(), 12);
    }
}
