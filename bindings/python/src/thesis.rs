//! Cases of the thesis, its own and those of a user.

use std::path::Path;

use phugoid_simulation::scenario::nearest;
use phugoid_thesis::case_file::OwnCase;
use phugoid_thesis::{Reproduction, entries};
use pyo3::prelude::*;

use crate::error::{PhugoidError, raise};

/// Runs a case and gives its result as a JSON document: an entry by its id, a case file by its path, or the text of one under
/// the name `id`. `progress` is called with the fraction done, where the case knows it.
#[pyfunction]
#[pyo3(signature = (case, text=None, progress=None))]
pub(crate) fn reproduce(
    py: Python<'_>,
    case: &str,
    text: Option<String>,
    progress: Option<Py<PyAny>>,
) -> PyResult<String> {
    let step = |fraction: f64| {
        if let Some(progress) = &progress {
            // An error of the progress bar does not stop the case.
            let _ = Python::attach(|py| progress.call1(py, (fraction,)).map(|_| ()));
        }
    };
    let result = py.detach(|| match text {
        Some(text) => OwnCase::parse(&text, case).map_err(raise)?.run().map_err(raise),
        None => of_name(case, &step),
    })?;
    serde_json::to_string(&result).map_err(raise)
}

fn of_name(name: &str, progress: &(dyn Fn(f64) + Sync)) -> PyResult<Reproduction> {
    let entries = entries();
    if let Some(entry) = entries.iter().find(|entry| entry.id == name) {
        return (entry.run)(entry.id, progress).map_err(raise);
    }
    let file = Path::new(name);
    if file.extension().is_some_and(|extension| extension == "toml") || file.is_file() {
        return OwnCase::read(file).map_err(raise)?.run().map_err(raise);
    }
    let hint = match nearest(name, entries.iter().map(|entry| entry.id)) {
        Some(near) => format!("Did you mean `{near}`?"),
        None => "phugoid.cases() lists all; a file of your own ends in .toml".to_owned(),
    };
    Err(PhugoidError::new_err(format!("there is no case `{name}`\n{hint}")))
}

/// The text of a case file from a JSON document with the same tables and keys.
#[pyfunction]
pub(crate) fn case_toml(document: &str) -> PyResult<String> {
    let value: toml::Table = serde_json::from_str(document).map_err(raise)?;
    toml::to_string(&value).map_err(raise)
}

/// Id and title of every case and study, in the order of the report.
#[pyfunction]
pub(crate) fn cases() -> Vec<(&'static str, &'static str)> {
    entries().into_iter().map(|entry| (entry.id, entry.title)).collect()
}
