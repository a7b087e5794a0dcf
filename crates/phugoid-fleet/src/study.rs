//! The runs of studies in a store: what each run of `phugoid study`, `compare` and `tune` has measured, so that one that was
//! stopped goes on, and several processes or machines do one together.

use std::sync::atomic::{AtomicUsize, Ordering};

use phugoid_evaluation::ledger::{Ledger, LedgerError};

use crate::key::{VERSION, key};
use crate::row::RunRow;
use crate::run::Progress;
use crate::shard::Shard;
use crate::store::{Store, StoreError};

/// The store as the ledger of one study. `told` hears how far it has come, from any thread.
pub struct StudyLedger<T: Fn(Progress) + Sync> {
    store: Store,
    study: String,
    sources: String,
    shard: Shard,
    runs: usize,
    done: AtomicUsize,
    found: AtomicUsize,
    told: T,
}

impl<T: Fn(Progress) + Sync> StudyLedger<T> {
    /// The ledger of a study with so many runs. `sources` are hashes of the files that it is made of, and names of what is built in.
    pub fn new(store: Store, study: &str, sources: &[String], shard: Shard, runs: usize, told: T) -> Self {
        let named: Vec<(&str, &str)> = sources.iter().map(|source| ("source", source.as_str())).collect();
        let (done, found) = (AtomicUsize::new(0), AtomicUsize::new(0));
        Self { store, study: study.to_owned(), sources: key(&named), shard, runs, done, found, told }
    }

    fn key(&self, inputs: &str, run: &str) -> String {
        key(&[("study", &self.study), ("sources", &self.sources), ("inputs", inputs), ("run", run)])
    }
}

impl From<StoreError> for LedgerError {
    fn from(error: StoreError) -> Self {
        Self(error.to_string())
    }
}

impl<T: Fn(Progress) + Sync> Ledger for StudyLedger<T> {
    fn done(&self) {
        let done = 1 + self.done.fetch_add(1, Ordering::Relaxed);
        (self.told)(Progress { done, all: self.runs.max(done), found: self.found.load(Ordering::Relaxed) });
    }

    fn keeps(&self) -> bool {
        true
    }

    fn find(&self, inputs: &str, run: &str) -> Result<Option<String>, LedgerError> {
        let found = self.store.run(&self.study, &self.key(inputs, run))?.map(|row| row.result);
        self.found.fetch_add(usize::from(found.is_some()), Ordering::Relaxed);
        Ok(found)
    }

    fn enter(&self, inputs: &str, run: &str, result: &str) -> Result<(), LedgerError> {
        let row = RunRow {
            key: self.key(inputs, run),
            study: self.study.clone(),
            version: VERSION.to_owned(),
            inputs: inputs.to_owned(),
            run: run.to_owned(),
            result: result.to_owned(),
        };
        Ok(self.store.write_run(&row)?)
    }

    fn is_ours(&self, inputs: &str, run: &str) -> bool {
        self.shard.has(&self.key(inputs, run))
    }
}

#[cfg(test)]
mod tests {
    use std::path::PathBuf;
    use std::sync::Mutex;

    use phugoid_evaluation::ledger::recorded;

    use super::*;

    fn folder(name: &str) -> PathBuf {
        let folder = std::env::temp_dir().join(format!("phugoid-study-{name}-{}", std::process::id()));
        let _ = std::fs::remove_dir_all(&folder);
        folder
    }

    fn squares(
        store: &Store,
        sources: &[&str],
        shard: &str,
        made: &Mutex<Vec<usize>>,
    ) -> Result<Vec<f64>, LedgerError> {
        let sources: Vec<String> = sources.iter().map(|word| (*word).to_owned()).collect();
        let ledger = StudyLedger::new(store.clone(), "squares", &sources, shard.parse().unwrap(), 12, |_| ());
        let square = |run: usize| {
            made.lock().unwrap().push(run);
            Ok(run as f64 / 3.0)
        };
        recorded(12, "of thirds", |run| format!("number {run}"), square, &ledger)
    }

    #[test]
    fn a_run_is_made_once_unless_its_sources_are_others() {
        let folder = folder("once");
        let store = Store::create(&folder).unwrap();
        let made = Mutex::new(Vec::new());
        let first = squares(&store, &["a"], "1/1", &made).unwrap();
        assert_eq!(squares(&store, &["a"], "1/1", &made).unwrap(), first);
        assert_eq!(made.lock().unwrap().len(), 12);
        squares(&store, &["b"], "1/1", &made).unwrap();
        assert_eq!(made.lock().unwrap().len(), 24);
        std::fs::remove_dir_all(&folder).unwrap();
    }

    /// Each of three processes that do one study together ends with all results, and begins with its own.
    #[test]
    fn shards_begin_with_their_own_runs_and_end_with_all() {
        let folder = folder("shards");
        let store = Store::create(&folder).unwrap();
        let made: Vec<Mutex<Vec<usize>>> = (0..3).map(|_| Mutex::new(Vec::new())).collect();
        let results = std::thread::scope(|scope| {
            let one = |i: usize| (format!("{}/3", i + 1), &store, &made[i]);
            let threads: Vec<_> = (0..3)
                .map(|i| {
                    let (shard, store, made) = one(i);
                    scope.spawn(move || squares(store, &["a"], &shard, made).unwrap())
                })
                .collect();
            threads.into_iter().map(|thread| thread.join().unwrap()).collect::<Vec<_>>()
        });
        assert!(results.iter().all(|result| *result == results[0] && result.len() == 12));
        std::fs::remove_dir_all(&folder).unwrap();
    }

    #[test]
    fn a_torn_file_is_named_with_what_to_do() {
        let folder = folder("torn");
        let store = Store::create(&folder).unwrap();
        let made = Mutex::new(Vec::new());
        squares(&store, &["a"], "1/1", &made).unwrap();
        let part = std::fs::read_dir(folder.join("runs/study=squares")).unwrap().next().unwrap().unwrap().path();
        let file = std::fs::read_dir(part).unwrap().next().unwrap().unwrap().path();
        let whole = std::fs::read(&file).unwrap();
        std::fs::write(&file, &whole[..whole.len() / 2]).unwrap();
        let message = squares(&store, &["a"], "1/1", &made).unwrap_err().0;
        assert!(message.contains(file.to_str().unwrap()) && message.contains("remove it"), "{message}");
        std::fs::remove_dir_all(&folder).unwrap();
    }
}
