//! The runs of a command: a bar while they are made, and with `--store` the store in which they are kept.

use std::sync::atomic::{AtomicUsize, Ordering};

use phugoid_evaluation::ledger::Ledger;

use crate::arguments::Keeping;
use crate::failure::Failure;
use crate::output::print;
use crate::progress::Progress;

/// What a command makes runs of.
#[cfg_attr(not(feature = "fleet"), expect(dead_code, reason = "only a store files runs"))]
pub(super) struct Runs<'a> {
    /// Stands before the bar.
    pub(super) what: &'static str,
    /// The study, as its runs are filed.
    pub(super) study: &'a str,
    /// Number of runs.
    pub(super) count: usize,
    /// The files and the names of built-in ones that decide on the runs.
    pub(super) sources: Vec<&'a str>,
}

impl Runs<'_> {
    /// Where each run is entered once it is made: a bar, and the store if one is named.
    pub(super) fn ledger(&self, keeping: &Keeping) -> Result<Box<dyn Ledger>, Failure> {
        match self.kept(keeping)? {
            Some(kept) => Ok(kept),
            None => Ok(Box::new(bar(self.what, self.count))),
        }
    }

    #[cfg(not(feature = "fleet"))]
    fn kept(&self, _: &Keeping) -> Result<Option<Box<dyn Ledger>>, Failure> {
        Ok(None)
    }

    #[cfg(feature = "fleet")]
    fn kept(&self, keeping: &Keeping) -> Result<Option<Box<dyn Ledger>>, Failure> {
        use std::path::Path;

        use phugoid_fleet::{content::source_of, store::Store, study::StudyLedger};

        use crate::arguments::fleet::Engine;

        let Some(folder) = &keeping.store else { return Ok(None) };
        super::fleet::refuse_address(folder, "which has no studies: name a folder that all machines see")?;
        let source = |word: &&str| match Path::new(word).is_file() {
            true => {
                source_of(Path::new(word)).map_err(|error| Failure::input(format!("cannot read `{word}`: {error}")))
            }
            false => Ok((*word).to_owned()),
        };
        let sources = self.sources.iter().map(source).collect::<Result<Vec<String>, Failure>>()?;
        let store = Store::create(folder)?;
        if let Some(Engine::Ray(address)) = &keeping.engine {
            super::on_ray::shards(address.as_deref())?;
        }
        let bar = super::fleet::Bar::new("runs");
        let told = move |progress| bar.set(progress);
        let shard = keeping.shard.unwrap_or_default();
        Ok(Some(Box::new(StudyLedger::new(store, self.study, &sources, shard, self.count, told))))
    }
}

/// A bar that is told of each of so many runs.
pub(super) fn bar(what: &'static str, count: usize) -> impl Fn() + Sync {
    let (progress, done) = (Progress::new(what), AtomicUsize::new(0));
    move || progress.set((1 + done.fetch_add(1, Ordering::Relaxed)) as f64 / count.max(1) as f64)
}

/// What a process prints that has helped others.
pub(super) fn helped() -> Result<(), Failure> {
    print("All runs are in the store: the same command without --shard prints the result.\n")
}
