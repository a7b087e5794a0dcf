//! Model files.

use std::sync::Arc;

use phugoid_identification::model_file::ModelFile;
use phugoid_evaluation::named;
use pyo3::prelude::*;

use crate::error::raise;

/// An aircraft, its coefficient build-up and what is known beforehand: a model file, or a built-in one by name.
#[pyclass(module = "phugoid", frozen, from_py_object)]
#[derive(Clone)]
pub(crate) struct Model {
    pub(crate) inner: Arc<ModelFile>,
}

#[pymethods]
impl Model {
    /// The file at this path, or the built-in model of this name.
    #[new]
    fn new(name: &str) -> PyResult<Self> {
        named::model(name).map(|file| Self { inner: Arc::new(file) }).map_err(raise)
    }

    /// From the text of a model file; `name` is its name in messages.
    #[staticmethod]
    #[pyo3(signature = (text, name="model"))]
    fn parse(text: &str, name: &str) -> PyResult<Self> {
        ModelFile::parse(name, text).map(|file| Self { inner: Arc::new(file) }).map_err(raise)
    }

    /// Names of the built-in models.
    #[staticmethod]
    fn built_in() -> Vec<&'static str> {
        named::models().map(|(name, _)| name).collect()
    }

    /// The text of a built-in model, to start one's own from.
    #[staticmethod]
    fn text(name: &str) -> PyResult<&'static str> {
        let none = || raise(named::no_model(name, std::io::Error::other("there is no built-in model of this name")));
        named::models().find(|(known, _)| *known == name).map(|(_, text)| text).ok_or_else(none)
    }

    /// Where it came from.
    #[getter]
    fn source(&self) -> &str {
        &self.inner.source
    }

    /// The name that it gives itself.
    #[getter]
    fn name(&self) -> &str {
        &self.inner.name
    }

    /// Names of the parameters that are estimated, in order.
    #[getter]
    fn parameters(&self) -> Vec<&str> {
        self.inner.estimated().map(|parameter| parameter.name.as_str()).collect()
    }

    /// Canonical names of the channels that a record needs.
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

    /// Axes of the motion: `longitudinal`, `lateral`.
    #[getter]
    fn axes(&self) -> Vec<&'static str> {
        self.inner.axes.words().to_vec()
    }

    fn __repr__(&self) -> String {
        format!("<Model '{}': {}; needs {}>", self.name(), self.parameters().join(", "), self.channels().join(", "))
    }
}
