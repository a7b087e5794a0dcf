//! The cases that the command line names: built-in entries by id or group, and case files.

use std::collections::BTreeSet;
use std::path::Path;

use phugoid_simulation::scenario::nearest;
use phugoid_thesis::Entry;
use phugoid_thesis::case_file::OwnCase;
use phugoid_thesis::result::Reproduction;

use crate::failure::Failure;

/// One case to run.
pub(super) enum Task {
    /// A built-in entry.
    Entry(Entry),
    /// A case file.
    File(Box<OwnCase>),
}

impl Task {
    pub(super) fn id(&self) -> &str {
        match self {
            Self::Entry(entry) => entry.id,
            Self::File(case) => &case.id,
        }
    }

    /// Runs the case.
    ///
    /// # Errors
    /// The reason in words, if the case cannot be run.
    pub(super) fn run(&self, done: &(dyn Fn(f64) + Sync)) -> Result<Reproduction, String> {
        match self {
            Self::Entry(entry) => (entry.run)(entry.id, done).map_err(|error| error.to_string()),
            Self::File(case) => case.run().map_err(|error| error.to_string()),
        }
    }

    /// The text of the case file; `None` for a study.
    pub(super) fn text(&self) -> Option<&str> {
        match self {
            Self::Entry(entry) => phugoid_thesis::case_text(entry.id),
            Self::File(case) => Some(&case.text),
        }
    }
}

/// The named cases in the given order, each once; all cases if none is named.
pub(super) fn select(wanted: &[String], entries: &[Entry]) -> Result<Vec<Task>, Failure> {
    if wanted.is_empty() {
        return Ok(entries.iter().copied().map(Task::Entry).collect());
    }
    let mut tasks: Vec<Task> = Vec::new();
    let mut seen: Vec<&str> = Vec::new();
    for word in wanted {
        if seen.contains(&word.as_str()) {
            continue;
        }
        seen.push(word);
        for task in matching(word, entries)? {
            if matches!(task, Task::File(_)) || !tasks.iter().any(|known| known.id() == task.id()) {
                tasks.push(task);
            }
        }
    }
    name_apart(&mut tasks);
    Ok(tasks)
}

/// Gives case files with the same name different ids (`mine`, `mine-2`), also different from those of entries, because
/// the ids name the files of the results (with a hyphen instead of the slash).
fn name_apart(tasks: &mut [Task]) {
    let mut taken: BTreeSet<String> =
        tasks.iter().filter(|t| matches!(t, Task::Entry(_))).map(|t| t.id().replace('/', "-")).collect();
    for task in tasks {
        if let Task::File(case) = task {
            let id = &case.id;
            let free = std::iter::once(id.clone()).chain((2..).map(|n: usize| format!("{id}-{n}")));
            if let Some(free) = free.into_iter().find(|name| !taken.contains(name)) {
                case.id = free;
            }
            taken.insert(case.id.clone());
        }
    }
}

fn matching(word: &str, entries: &[Entry]) -> Result<Vec<Task>, Failure> {
    let group = word.strip_suffix('/').unwrap_or(word);
    let found: Vec<Task> =
        entries.iter().filter(|e| e.id == word || e.group() == group).copied().map(Task::Entry).collect();
    if !found.is_empty() {
        return Ok(found);
    }
    let file = Path::new(word);
    if file.extension().is_some_and(|extension| extension == "toml") || file.is_file() {
        return Ok(vec![Task::File(Box::new(OwnCase::read(file).map_err(Failure::input)?))]);
    }
    Err(unknown(word, entries))
}

fn unknown(word: &str, entries: &[Entry]) -> Failure {
    let mut groups: Vec<&str> = Vec::new();
    for group in entries.iter().map(Entry::group) {
        if !groups.contains(&group) {
            groups.push(group);
        }
    }
    let names: Vec<&str> = entries.iter().map(|e| e.id).chain(groups.iter().copied()).collect();
    let hint = match nearest(word, names.into_iter()) {
        Some(near) => format!("Did you mean `{near}`?"),
        None => format!("Groups: {}. All ids: phugoid reproduce --list", groups.join(", ")),
    };
    Failure::input(format!("there is no case `{word}`\n{hint}"))
}
