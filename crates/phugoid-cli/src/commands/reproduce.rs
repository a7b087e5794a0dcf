//! `phugoid reproduce`.

use phugoid_flight_data::output_file;
use std::path::{Path, PathBuf};

use phugoid_evaluation::chart::Chart;
use phugoid_evaluation::table::Table;
use phugoid_report::{Figure, NotRun, ReproductionOptions, chart_figure, reproduction_html};
use phugoid_thesis::golden;
use phugoid_thesis::result::{Outcome, Reproduction, Requirement};
use phugoid_thesis::{Entry, entries};
use rayon::prelude::*;
use serde::Serialize;

use crate::arguments::{self, PictureFormat};
use crate::failure::Failure;
use crate::output::{json, print};
use crate::progress::{Progress, Shares};

mod selection;
mod text;

use selection::{Task, select};

pub(crate) fn run(arguments: &arguments::Reproduce) -> Result<(), Failure> {
    if arguments.list {
        return list(&entries(), arguments.json);
    }
    let tasks = select(&arguments.cases, &entries())?;
    if arguments.show {
        return show(&tasks);
    }
    // Before the minutes that it may take, not after.
    std::fs::create_dir_all(&arguments.out).map_err(|e| Failure::writing(&arguments.out, e))?;
    let (reproductions, not_run) = run_all(&tasks);
    let written = {
        let _progress = Progress::spinner("drawing");
        write(arguments, &reproductions, &not_run)?
    };
    if arguments.json {
        print(&json(&Document::new(&reproductions, &not_run, arguments.charts))?)?;
    } else {
        print(&text::text(&reproductions, &not_run, &written))?;
    }
    match not_run.as_slice() {
        [] => Ok(()),
        [only] => Err(Failure::impossible(format!("{} has no result: {}", only.id, only.reason))),
        several => {
            let ids: Vec<&str> = several.iter().map(|n| n.id.as_str()).collect();
            Err(Failure::impossible(format!("{} cases have no result: {}", several.len(), ids.join(", "))))
        }
    }
}

/// Prints the files of the cases.
fn show(tasks: &[Task]) -> Result<(), Failure> {
    let texts: Vec<String> = tasks.iter().filter_map(|task| Some(task.text()?.trim_end().to_owned())).collect();
    if texts.is_empty() {
        let id = tasks.first().map_or("it", Task::id);
        return Err(Failure::input(format!(
            "`{id}` is a study, which the program computes: it has no case file. `phugoid reproduce --list` names the cases; \
             those of the groups first-order, second-order, noise, dcm-alpha, dcm-q, dcl-alpha, dcd-alpha and combined have one"
        )));
    }
    print(&(texts.join("\n\n# ----\n\n") + "\n"))
}

#[derive(Serialize)]
struct Listed {
    id: &'static str,
    title: &'static str,
}

fn list(entries: &[Entry], as_json: bool) -> Result<(), Failure> {
    if as_json {
        let listed: Vec<Listed> = entries.iter().map(|e| Listed { id: e.id, title: e.title }).collect();
        return print(&json(&listed)?);
    }
    let width = entries.iter().map(|e| e.id.len()).max().unwrap_or(0);
    print(&entries.iter().map(|e| format!("{:width$}  {}\n", e.id, e.title)).collect::<String>())
}

/// Runs all tasks in parallel. The results are in the order of the tasks; a task that fails does not stop the others.
fn run_all(tasks: &[Task]) -> (Vec<Reproduction>, Vec<NotRun>) {
    let progress = Progress::new("reproducing");
    let shares = Shares::new(&progress, tasks.len());
    let results: Vec<Result<Reproduction, NotRun>> = tasks
        .par_iter()
        .enumerate()
        .with_max_len(1)
        .map(|(index, task)| {
            let result = task.run(&|done| shares.set(index, done));
            shares.set(index, 1.0);
            result.map_err(|reason| NotRun { id: task.id().to_owned(), reason })
        })
        .collect();
    let mut reproductions = Vec::new();
    let mut not_run = Vec::new();
    for result in results {
        match result {
            Ok(reproduction) => reproductions.push(reproduction),
            Err(failed) => not_run.push(failed),
        }
    }
    (reproductions, not_run)
}

/// Paths of the files that were written.
struct Written {
    report: PathBuf,
    folder: PathBuf,
    figures: usize,
}

fn write(
    arguments: &arguments::Reproduce,
    reproductions: &[Reproduction],
    not_run: &[NotRun],
) -> Result<Written, Failure> {
    let folder = arguments.out.as_path();
    let save = |path: &Path, bytes: &[u8]| output_file::write(path, bytes).map_err(|e| Failure::writing(path, e));

    let report = folder.join("report.html");
    let options = ReproductionOptions { not_run: not_run.to_vec(), notes: notes(arguments), ..Default::default() };
    save(&report, reproduction_html(reproductions, &options).as_bytes())?;
    save(&folder.join("reproduction.json"), json(&Document::new(reproductions, not_run, false))?.as_bytes())?;
    for reproduction in reproductions.iter().filter(|r| !r.golden.columns.is_empty()) {
        let path = folder.join(golden::file_name(&reproduction.id));
        let text = golden::write(&reproduction.golden).map_err(|e| Failure::writing(&path, e))?;
        save(&path, text.as_bytes())?;
    }
    let figures = match arguments.figures {
        Some(format) => write_figures(&folder.join("figures"), reproductions, format)?,
        None => 0,
    };
    Ok(Written { report, folder: folder.to_owned(), figures })
}

fn notes(arguments: &arguments::Reproduce) -> Vec<String> {
    let again = match arguments.cases.join(" ") {
        cases if cases.is_empty() => "phugoid reproduce".to_owned(),
        cases => format!("phugoid reproduce {cases}"),
    };
    vec![
        "Cases, comparisons and figures of M. Gurbacki, Feasibility Study of a Novel Method for Real-Time Aerodynamic \
         Coefficient Estimation, Rochester Institute of Technology, 2010. For each: what was published, what of the text \
         had to be reconstructed, what we find, and what differs and why."
            .to_owned(),
        format!("Every run of `{again}` gives this page again, byte for byte."),
    ]
}

/// Writes `ID-CHART.svg` or `.png` for every chart, and returns their number.
fn write_figures(folder: &Path, reproductions: &[Reproduction], format: PictureFormat) -> Result<usize, Failure> {
    std::fs::create_dir_all(folder).map_err(|e| Failure::writing(folder, e))?;
    let charts: Vec<(String, Figure)> = reproductions
        .iter()
        .flat_map(|r| r.charts.iter().map(|c| (format!("{}-{}", r.id.replace('/', "-"), c.name), chart_figure(c))))
        .collect();
    charts.par_iter().try_for_each(|(name, figure)| {
        let (extension, bytes) = match format {
            PictureFormat::Svg => ("svg", figure.to_svg().into_bytes()),
            PictureFormat::Png => ("png", figure.to_png().map_err(|e| Failure::Output(e.to_string()))?),
        };
        let path = folder.join(format!("{name}.{extension}"));
        output_file::write(&path, bytes).map_err(|e| Failure::writing(&path, e))
    })?;
    Ok(charts.len())
}

/// The reproductions as a JSON document; it contains the curves of the figures with `--charts` only.
#[derive(Serialize)]
struct Document<'a> {
    requirements: usize,
    requirements_met: usize,
    requirements_not_met: usize,
    cases: Vec<Case<'a>>,
    not_run: Vec<Failed<'a>>,
}

#[derive(Serialize)]
struct Case<'a> {
    id: &'a str,
    title: &'a str,
    place: &'a str,
    published: &'a str,
    reconstruction: &'a str,
    difference: &'a str,
    outcomes: &'a [Outcome],
    requirements: &'a [Requirement],
    tables: &'a [Table],
    golden: &'a Table,
    #[serde(skip_serializing_if = "Option::is_none")]
    charts: Option<&'a [Chart]>,
}

#[derive(Serialize)]
struct Failed<'a> {
    id: &'a str,
    reason: &'a str,
}

impl<'a> Document<'a> {
    fn new(reproductions: &'a [Reproduction], not_run: &'a [NotRun], with_charts: bool) -> Self {
        let requirements = || reproductions.iter().flat_map(|r| &r.requirements);
        let met = requirements().filter(|r| r.met).count();
        Self {
            requirements: requirements().count(),
            requirements_met: met,
            requirements_not_met: requirements().count() - met,
            cases: reproductions.iter().map(|r| Case::new(r, with_charts)).collect(),
            not_run: not_run.iter().map(|n| Failed { id: &n.id, reason: &n.reason }).collect(),
        }
    }
}

impl<'a> Case<'a> {
    fn new(reproduction: &'a Reproduction, with_charts: bool) -> Self {
        let Reproduction { id, title, place, published, reconstruction, difference, .. } = reproduction;
        Self {
            id,
            title,
            place,
            published,
            reconstruction,
            difference,
            outcomes: &reproduction.outcomes,
            requirements: &reproduction.requirements,
            tables: &reproduction.tables,
            golden: &reproduction.golden,
            charts: with_charts.then_some(&reproduction.charts),
        }
    }
}
