//! Reports of segments: the rows of a segment estimated again, and written as a page to which that of the fleet leads.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};

use phugoid_flight_data::output_file;
use phugoid_identification::estimation::Estimation;
use phugoid_identification::method::Method;
use phugoid_identification::model_file::{ModelError, ModelFile};
use rayon::prelude::*;

use crate::key::VERSION;
use crate::page::Reports;
use crate::run::pool;
use crate::statistics::tell::{Course, Findings, Point, Set, Shape};
use crate::store::Store;
use crate::unit::{Segments, Task};

/// Which segments get a report.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Which {
    /// Those of flights that disagree with their airframe; the first and the last of a course with a finding; those before and
    /// after a step.
    Findings,
    /// All that are in a course.
    All,
}

/// What was made.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Made {
    /// The addresses of all reports that are there, seen from the page.
    pub reports: Reports,
    /// How many of them were made now.
    pub new: usize,
    /// Why some are missing, in sentences.
    pub missing: Vec<String>,
}

/// Why no report can be made.
#[derive(Debug, thiserror::Error)]
pub enum ReportsError {
    /// Another version would give other numbers than those on the page.
    #[error(
        "the results in the store are of version {found}, this program is version {VERSION} and might give other numbers: estimate the logs again, or make the page with that version"
    )]
    OtherVersion {
        /// The version that estimated.
        found: String,
    },
    /// The model cannot be read.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// The model is another one.
    #[error(
        "{name} with the files that it names is not the model of these results: name the model file that was estimated with, by --model"
    )]
    OtherModel {
        /// What was read.
        name: String,
    },
    /// The method is none of this program.
    #[error("the results in the store are of the method `{0}`, which this program does not have")]
    OtherMethod(String),
    /// The folder or a report cannot be written.
    #[error("{}: cannot be written: {source}", file.display())]
    Write {
        /// The file.
        file: PathBuf,
        /// What the operating system says.
        source: std::io::Error,
    },
    /// The system gives no threads.
    #[error("no threads to work with: {0}")]
    Threads(#[from] rayon::ThreadPoolBuildError),
}

/// The task that gave the results of a set: with the model whose text the store keeps, or with `model`.
///
/// # Errors
/// [`ReportsError`]: another version, model or method.
pub fn task_of(set: &Set, store: &Store, model: Option<&str>) -> Result<Task, ReportsError> {
    if set.version != VERSION {
        return Err(ReportsError::OtherVersion { found: set.version.clone() });
    }
    let kept = store.model_file(&set.model_sha256).display().to_string();
    let (name, text) = ModelFile::find_text(model.unwrap_or(&kept))?;
    // A report says what the model is called, not where the store keeps it.
    let name = if model.is_some() { name } else { set.model.clone() };
    let method: Method = set.method.parse().map_err(|_| ReportsError::OtherMethod(set.method.clone()))?;
    let segments = if set.segments == Segments::Whole.word() { Segments::Whole } else { Segments::Manoeuvres };
    let other = |name: String| ReportsError::OtherModel { name };
    match Task::parse(&name, text, Some(method), segments) {
        Ok(task) if task.model_sha256() == set.model_sha256 => Ok(task),
        // The text in the store may name files that are not beside it.
        Err(_) if model.is_none() => Err(other(name)),
        Ok(_) => Err(other(name)),
        Err(error) => Err(ModelError::from(error).into()),
    }
}

/// Makes the reports that are not in `folder` yet, which the page reaches under `address`. Reports are named by the key of their unit,
/// so that one that is there is of the same log, model, method and version. A log that has gone or changed makes no error but a
/// sentence. `render` writes a page; `progress` is given the part that is done, from any thread.
///
/// # Errors
/// [`ReportsError::Write`], [`ReportsError::Threads`].
pub fn make(
    findings: &Findings,
    which: Which,
    task: &Task,
    (folder, address): (&Path, &str),
    render: &(dyn Fn(&Estimation) -> String + Sync),
    progress: &(dyn Fn(f64) + Sync),
) -> Result<Made, ReportsError> {
    let failed = |file: &Path, source| ReportsError::Write { file: file.to_owned(), source };
    std::fs::create_dir_all(folder).map_err(|error| failed(folder, error))?;
    output_file::remove_abandoned(folder);
    let wanted: Vec<(&str, i64, &str)> = wanted(findings, which).into_iter().collect();
    let done = AtomicUsize::new(0);
    let one = |&(log_sha256, segment, path): &(&str, i64, &str)| {
        let name = format!("{}-{segment}.html", task.key(log_sha256));
        let file = folder.join(&name);
        let is_new = !file.exists();
        let estimation = if is_new { Some(task.estimation(Path::new(path), log_sha256, segment)) } else { None };
        progress((done.fetch_add(1, Ordering::Relaxed) + 1) as f64 / wanted.len() as f64);
        match estimation.transpose() {
            Ok(estimation) => {
                if let Some(estimation) = estimation {
                    output_file::write(&file, render(&estimation)).map_err(|error| failed(&file, error))?;
                }
                Ok(Ok(((log_sha256.to_owned(), segment), format!("{address}/{name}"), is_new)))
            }
            Err(why) => Ok(Err(why)),
        }
    };
    let all: Vec<Result<_, String>> =
        pool(0)?.install(|| wanted.par_iter().map(one).collect::<Result<_, ReportsError>>())?;
    let mut made = Made::default();
    for one in all {
        match one {
            Ok((of, address, is_new)) => {
                made.new += usize::from(is_new);
                made.reports.insert(of, address);
            }
            Err(why) => made.missing.push(why),
        }
    }
    Ok(made)
}

/// The segments that get a report, by hash, number and path.
fn wanted(findings: &Findings, which: Which) -> BTreeSet<(&str, i64, &str)> {
    let courses = findings.airframes.iter().flat_map(|airframe| &airframe.courses);
    let points = courses.flat_map(|course| {
        let is_wanted = move |(place, _): &(usize, &Point)| which == Which::All || is_found(course, *place);
        course.points.iter().enumerate().filter(is_wanted).map(|(_, point)| point)
    });
    points.map(|point| (point.log_sha256.as_str(), point.segment, point.path.as_str())).collect()
}

/// Whether a point of a course is one that a finding speaks of.
fn is_found(course: &Course, place: usize) -> bool {
    let Some(point) = course.points.get(place) else { return false };
    let has_finding = course.is_outlier || matches!(course.shape, Shape::Drift | Shape::Step);
    let is_end = place == 0 || place + 1 == course.points.len();
    let step = course.step.filter(|_| course.shape == Shape::Step);
    let first_after = step.and_then(|step| course.points.iter().position(|point| point.at >= step.at));
    let is_at_step = first_after.is_some_and(|first| place == first || place + 1 == first);
    point.disagrees || (has_finding && is_end) || is_at_step
}
