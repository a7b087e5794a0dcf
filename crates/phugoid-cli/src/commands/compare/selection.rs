//! The scenarios and methods that the command line names.

use std::path::Path;

use phugoid_evaluation::arena::{BUILT_IN, Entry, built_in};
use phugoid_identification::estimate::Method;
use phugoid_simulation::scenario::{self, nearest};

use crate::arguments::Compare;
use crate::commands::{estimate, simulate};
use crate::failure::Failure;

/// The word for all entries with errors that residuals are silent about.
const SILENT: &str = "silent";

/// The named methods in the given order, or all methods if none is named.
pub(super) fn methods(names: &[String]) -> Result<Vec<Method>, Failure> {
    if names.is_empty() {
        return Ok(Method::ALL.to_vec());
    }
    let mut chosen: Vec<Method> = Vec::new();
    for name in names {
        let method = name.trim().parse::<Method>().map_err(Failure::input)?;
        if chosen.contains(&method) {
            return Err(Failure::input(format!("the method `{method}` is named twice")));
        }
        chosen.push(method);
    }
    Ok(chosen)
}

/// The named scenarios, or all built-in entries if none is named.
pub(super) fn entries(arguments: &Compare) -> Result<Vec<Entry>, Failure> {
    if arguments.scenarios.is_empty() {
        return BUILT_IN.iter().map(|(id, text)| Entry::parse(text, id).map_err(Failure::input)).collect();
    }
    let mut entries: Vec<Entry> = Vec::new();
    let all_silent = |wanted: &String| wanted == SILENT && !Path::new(wanted).exists();
    let silent = BUILT_IN.iter().map(|(id, _)| *id).filter(|id| id.starts_with("silent-"));
    let named = arguments
        .scenarios
        .iter()
        .flat_map(|wanted| if all_silent(wanted) { silent.clone().collect() } else { vec![wanted.as_str()] });
    for wanted in named {
        let entry = entry(wanted, arguments)?;
        if entries.iter().any(|known| known.id == entry.id) {
            return Err(Failure::input(format!("two scenarios are called `{}`: rename one", entry.id)));
        }
        entries.push(entry);
    }
    Ok(entries)
}

fn entry(wanted: &str, arguments: &Compare) -> Result<Entry, Failure> {
    let path = Path::new(wanted);
    if !path.exists() {
        if let Some(entry) = built_in(wanted) {
            return entry.map_err(Failure::input);
        }
        if scenario::built_in(wanted).is_none() {
            return Err(Failure::input(unknown(wanted)));
        }
    }
    let id = path.file_stem().map_or_else(|| wanted.to_owned(), |stem| stem.to_string_lossy().into_owned());
    if path.exists() {
        let text = std::fs::read_to_string(path).map_err(|e| Failure::input(format!("cannot read `{wanted}`: {e}")))?;
        // A file of the arena has a model of its own; nothing else in a scenario has these names.
        let of_arena = |line: &str| {
            let line = line.trim_start();
            line.starts_with("extends") || line.starts_with("[scenario") || line.starts_with("[[scenario")
        };
        if text.lines().any(of_arena) {
            return Entry::parse(&text, &id).map_err(Failure::input);
        }
    }
    // First, so that a mistake in the file is told before a missing option.
    let flown = simulate::scenario(wanted)?;
    let Some(model) = &arguments.model else {
        return Err(Failure::input(format!(
            "`{wanted}` is a scenario without a model: say with --model what the methods are told of the aircraft"
        )));
    };
    Ok(Entry::new(id, flown, estimate::model(model)?, arguments.cycle.si()))
}

fn unknown(wanted: &str) -> String {
    let known = || BUILT_IN.iter().map(|(id, _)| *id).chain(scenario::BUILT_IN.iter().map(|(id, _)| *id));
    match nearest(wanted, known()) {
        Some(near) => format!("there is no scenario `{wanted}`: did you mean `{near}`?"),
        None => format!("there is no scenario `{wanted}`: see `phugoid compare --list`, or name a file"),
    }
}
