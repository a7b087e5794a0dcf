//! Model files: the aircraft and the parameters that are estimated.

use std::path::PathBuf;
use std::sync::Arc;

use phugoid_identification::model_file::Parameter;
use pyo3::exceptions::PyDeprecationWarning;
use pyo3::prelude::*;

use crate::error::raise;

/// An aircraft, its coefficient build-up and the prior knowledge of its parameters: `Model.named`, `Model.open`,
/// `Model.parse`.
#[pyclass(module = "phugoid", frozen, from_py_object)]
#[derive(Clone)]
pub(crate) struct Model {
    pub(crate) inner: Arc<phugoid::Model>,
    /// What it was read from: models are saved, and sent to other processes, as their text.
    text: Arc<str>,
}

impl Model {
    fn read(name: &str, text: &str) -> PyResult<Self> {
        let model = phugoid::Model::parse(name, text).map_err(raise)?;
        Ok(Self { inner: Arc::new(model), text: text.into() })
    }
}

#[pymethods]
impl Model {
    /// The former way in: the file at this path, or the built-in model of this name.
    #[new]
    fn new(py: Python<'_>, name: &str) -> PyResult<Self> {
        let text =
            c"phugoid.Model(...) is now phugoid.Model.open(path), or phugoid.Model.named(name) for a built-in model";
        PyErr::warn(py, &py.get_type::<PyDeprecationWarning>(), text, 1)?;
        let (name, text) = phugoid::Model::find_text(name).map_err(raise)?;
        Self::read(&name, &text)
    }

    /// The built-in model with this name.
    #[staticmethod]
    fn named(name: &str) -> PyResult<Self> {
        Self::read(name, phugoid::Model::text(name).map_err(raise)?)
    }

    /// Reads and checks the model file at this path.
    #[staticmethod]
    fn open(path: PathBuf) -> PyResult<Self> {
        let text = phugoid::Model::read_text(&path).map_err(raise)?;
        Self::read(&path.display().to_string(), &text)
    }

    /// Reads and checks the text (TOML) of a model file; error messages use `name` for it.
    #[staticmethod]
    #[pyo3(signature = (text, name="model"))]
    fn parse(text: &str, name: &str) -> PyResult<Self> {
        Self::read(name, text)
    }

    /// Names of the built-in models.
    #[staticmethod]
    fn built_in() -> Vec<&'static str> {
        phugoid::Model::BUILT_IN.iter().map(|(name, _)| *name).collect()
    }

    /// The text (TOML) of a built-in model, as a start for your own model file.
    #[staticmethod]
    fn text(name: &str) -> PyResult<&'static str> {
        phugoid::Model::text(name).map_err(raise)
    }

    /// The text (TOML) that it was read from.
    #[getter]
    fn toml(&self) -> &str {
        &self.text
    }

    /// Of each parameter: name, unit, start value, one sigma of what is known beforehand, lower and upper limit (None
    /// without), whether it is fixed, and whether it only supports the others (an offset or a sensor bias).
    #[getter]
    fn table(&self) -> Vec<(String, String, f64, f64, Option<[f64; 2]>, bool, bool)> {
        let row = |p: &Parameter| (p.name.clone(), p.unit(), p.start, p.prior_std, p.bounds, p.fixed, p.is_nuisance());
        self.inner.parameters.iter().map(row).collect()
    }

    /// The model as a table for notebooks.
    fn _repr_html_(slf: Bound<'_, Self>) -> PyResult<String> {
        slf.py().import("phugoid._show")?.getattr("model_html")?.call1((slf,))?.extract()
    }

    /// The file that it was read from, or the name of the built-in model.
    #[getter]
    fn source(&self) -> &str {
        &self.inner.source
    }

    /// The title that the model file states for the aircraft.
    #[getter]
    fn name(&self) -> &str {
        &self.inner.name
    }

    /// Names of the estimated parameters, in the order of the results.
    #[getter]
    fn parameters(&self) -> Vec<&str> {
        self.inner.estimated().map(|parameter| parameter.name.as_str()).collect()
    }

    /// Canonical names of the channels that a record must have for this model.
    #[getter]
    fn channels(&self) -> Vec<&str> {
        let mut names: Vec<&str> = Vec::new();
        for name in self.inner.channels_used() {
            if !names.contains(&name) {
                names.push(name);
            }
        }
        names
    }

    /// Axes of the motion that the model describes: `longitudinal`, `lateral`, or both.
    #[getter]
    fn axes(&self) -> Vec<&'static str> {
        self.inner.axes.words().to_vec()
    }

    fn __repr__(&self) -> String {
        format!("<Model '{}': {}; needs {}>", self.name(), self.parameters().join(", "), self.channels().join(", "))
    }
}
