//! `phugoid compare`.

use phugoid_flight_data::output_file;
use std::path::{Path, PathBuf};

use phugoid_evaluation::arena::{self, Arena, Contestant, Entry, compare};
use phugoid_identification::estimate::Method;
use phugoid_report::{Figure, arena_figures, arena_html};
use rayon::prelude::*;
use serde::Serialize;

use super::runs::Runs;
use crate::arguments::{self, PictureFormat};
use crate::failure::Failure;
use crate::output::{json, print};
use crate::progress::Progress;

mod selection;
mod text;

use selection::{entries, methods};

/// Default number of flights per scenario.
const SEEDS: u32 = 20;

/// Number of flights per scenario with `--quick`.
const FEW_SEEDS: u32 = 4;

pub(crate) fn run(arguments: &arguments::Compare) -> Result<(), Failure> {
    if arguments.list {
        return list(arguments.json);
    }
    let entries = entries(arguments)?;
    let methods = methods(&arguments.methods)?;
    let seeds = arguments.seeds.unwrap_or(if arguments.quick { FEW_SEEDS } else { SEEDS }) as usize;
    let is_part = arguments.keeping.is_part();
    if !is_part {
        // Before the minutes that it may take, not after.
        std::fs::create_dir_all(&arguments.out).map_err(|e| Failure::writing(&arguments.out, e))?;
    }
    let result = fly(arguments, &entries, &methods, seeds)?;
    if is_part {
        return super::runs::helped();
    }
    let written = {
        let _progress = Progress::spinner("drawing");
        write(arguments, &result)?
    };
    if arguments.json { print(&json(&result)?) } else { print(&text::text(&result, &written)) }
}

fn fly(arguments: &arguments::Compare, entries: &[Entry], methods: &[Method], seeds: usize) -> Result<Arena, Failure> {
    let contestants: Vec<Contestant> = methods.iter().map(|method| Contestant::of(*method)).collect();
    // Runs are named by their entry; of those that are built in the version of this program says all.
    let named = arguments.scenarios.iter().chain(&arguments.model).map(String::as_str);
    let sources = named.filter(|word| Path::new(word).exists() || Some(*word) == arguments.model.as_deref()).collect();
    let runs = Runs { what: "comparing", study: "compare", count: entries.len() * seeds, sources };
    let ledger = runs.ledger(&arguments.keeping)?;
    compare(entries, &contestants, seeds, ledger.as_ref()).map_err(super::study::failure)
}

#[derive(Serialize)]
struct Listed {
    name: String,
    description: String,
}

fn list(as_json: bool) -> Result<(), Failure> {
    let mut scenarios = Vec::new();
    for (id, text) in arena::BUILT_IN {
        let entry = Entry::parse(text, id).map_err(Failure::input)?;
        scenarios.push(Listed { name: entry.id, description: entry.shows });
    }
    let methods: Vec<Listed> = Method::ALL
        .iter()
        .map(|m| Listed { name: m.name().to_owned(), description: m.description().to_owned() })
        .collect();
    if as_json {
        return print(&json(&std::collections::BTreeMap::from([("methods", methods), ("scenarios", scenarios)]))?);
    }
    let width = scenarios.iter().chain(&methods).map(|l| l.name.len()).max().unwrap_or(0);
    let lines = |listed: &[Listed]| -> String {
        listed.iter().map(|l| format!("  {:width$}  {}\n", l.name, l.description)).collect()
    };
    print(&format!("Scenarios\n{}\nMethods\n{}", lines(&scenarios), lines(&methods)))
}

/// Paths of the files that were written.
struct Written {
    report: PathBuf,
    folder: PathBuf,
}

fn write(arguments: &arguments::Compare, result: &Arena) -> Result<Written, Failure> {
    let folder = arguments.out.as_path();
    let save = |path: &Path, bytes: &[u8]| output_file::write(path, bytes).map_err(|e| Failure::writing(path, e));
    let report = folder.join("report.html");
    save(&report, arena_html(result, &again(arguments)).as_bytes())?;
    save(&folder.join("comparison.json"), json(result)?.as_bytes())?;
    let table = folder.join("comparison.csv");
    let rows = arena::csv(&result.rows).map_err(|e| Failure::writing(&table, e))?;
    save(&table, rows.as_bytes())?;
    #[cfg(feature = "parquet")]
    {
        let table = folder.join("comparison.parquet");
        let bytes = arena::parquet(&result.rows).map_err(|e| Failure::writing(&table, e))?;
        save(&table, &bytes)?;
    }
    if let Some(format) = arguments.figures {
        write_figures(&folder.join("figures"), &arena_figures(result), format)?;
    }
    Ok(Written { report, folder: folder.to_owned() })
}

/// The command line that repeats this comparison; the report shows it.
fn again(arguments: &arguments::Compare) -> String {
    let mut words = vec!["phugoid compare".to_owned()];
    words.extend(arguments.scenarios.iter().cloned());
    if let Some(model) = &arguments.model {
        words.push(format!("--model {model}"));
    }
    if !arguments.methods.is_empty() {
        words.push(format!("--methods {}", arguments.methods.join(",")));
    }
    match arguments.seeds {
        Some(seeds) => words.push(format!("--seeds {seeds}")),
        None if arguments.quick => words.push("--quick".to_owned()),
        None => {}
    }
    words.join(" ")
}

fn write_figures(folder: &Path, figures: &[(String, Figure)], format: PictureFormat) -> Result<(), Failure> {
    std::fs::create_dir_all(folder).map_err(|e| Failure::writing(folder, e))?;
    figures.par_iter().try_for_each(|(name, figure)| {
        let (extension, bytes) = match format {
            PictureFormat::Svg => ("svg", figure.to_svg().into_bytes()),
            PictureFormat::Png => ("png", figure.to_png().map_err(|e| Failure::Output(e.to_string()))?),
        };
        let path = folder.join(format!("{name}.{extension}"));
        output_file::write(&path, bytes).map_err(|e| Failure::writing(&path, e))
    })
}
