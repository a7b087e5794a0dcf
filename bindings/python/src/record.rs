//! Flight records, with their channels as numpy arrays.

use std::path::PathBuf;
use std::sync::Arc;

use numpy::{PyArray1, PyReadonlyArray1};
use phugoid_flight_data::csv;
use phugoid_flight_data::deletion::{Deleted, Deletion};
use phugoid_flight_data::memory::Memory;
use phugoid_flight_data::quality::{QualityReport, Start};
use phugoid_flight_data::reader::{self, ReadOptions};
use phugoid_flight_data::record as library;
use phugoid_flight_data::table::{Column, ColumnMapping, TableOptions, from_columns};
use pyo3::exceptions::PyKeyError;
use pyo3::prelude::*;
use pyo3::types::PyBytes;

use crate::error::raise;
use crate::model::Model;
use crate::pickle::{self, Written};

/// A flight record: strictly increasing time and channels in SI units and radians.
#[pyclass(module = "phugoid", frozen, from_py_object)]
#[derive(Clone)]
pub(crate) struct Record {
    pub(crate) inner: Arc<library::Record>,
}

impl From<library::Record> for Record {
    fn from(record: library::Record) -> Self {
        Self { inner: Arc::new(record) }
    }
}

#[pymethods]
impl Record {
    /// Makes a record from columns: headers that contain their units (`time_s`, `alpha_deg`) or separate units, and
    /// arrays of equal length.
    #[staticmethod]
    fn from_columns(
        py: Python<'_>,
        source: &str,
        headers: Vec<String>,
        units: Vec<Option<String>>,
        values: Vec<PyReadonlyArray1<'_, f64>>,
        mappings: Vec<(String, String, Option<String>, f64)>,
    ) -> PyResult<Self> {
        let columns: Vec<Column> = headers
            .into_iter()
            .zip(units)
            .zip(values)
            .map(|((header, unit), values)| Column { header, unit, values: values.as_array().to_vec(), is_time: false })
            .collect();
        let options =
            TableOptions { columns: to_mappings(mappings), max_memory: Memory::UNBOUNDED, ..TableOptions::default() };
        let record = py.detach(|| from_columns(source, columns, &[], &options, QualityReport::default()));
        Ok(record.map_err(raise)?.into())
    }

    /// Reads a flight from a file.
    #[staticmethod]
    #[pyo3(signature = (path, model=None, mappings=Vec::new(), max_memory=None, names=Vec::new(), sample_time_s=None, variable=None))]
    #[allow(clippy::too_many_arguments)] // one for each keyword of the Python function
    fn open(
        py: Python<'_>,
        path: PathBuf,
        model: Option<&Model>,
        mappings: Vec<(String, String, Option<String>, f64)>,
        max_memory: Option<&str>,
        names: Vec<String>,
        sample_time_s: Option<f64>,
        variable: Option<String>,
    ) -> PyResult<Self> {
        let memory: Memory = max_memory.map(str::parse).transpose().map_err(raise)?.unwrap_or_default();
        let mut columns = model.map(|model| model.inner.columns()).unwrap_or_default();
        columns.extend(to_mappings(mappings));
        let mut options = ReadOptions::with_columns(columns).with_max_memory(memory);
        (options.table.column_names, options.table.sample_time_s, options.table.variable) =
            (names, sample_time_s, variable);
        py.detach(|| reader::read_path(&path, &options).map(Self::from).map_err(raise))
    }

    /// The file that it was read from, or the name that it was given.
    #[getter]
    fn source(&self) -> &str {
        &self.inner.source
    }

    /// Time of each sample, s, strictly increasing.
    #[getter]
    fn time<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, &self.inner.time)
    }

    /// Canonical names of the channels.
    #[getter]
    fn channels(&self) -> Vec<&str> {
        self.inner.channels.iter().map(|channel| channel.name.as_str()).collect()
    }

    /// The SI unit of a channel as text, for example `rad/s`.
    fn unit(&self, name: &str) -> PyResult<&'static str> {
        Ok(self.channel(name)?.quantity.si_unit())
    }

    /// The header with unit under which a channel is written to CSV, for example `alpha_rad`.
    fn header(&self, name: &str) -> PyResult<String> {
        let channel = self.channel(name)?;
        Ok(match channel.quantity.si_suffix() {
            "" => channel.name.clone(),
            suffix => format!("{}_{suffix}", channel.name),
        })
    }

    /// The values of a channel, SI; NaN where one is missing.
    fn __getitem__<'py>(&self, py: Python<'py>, name: &str) -> PyResult<Bound<'py, PyArray1<f64>>> {
        Ok(PyArray1::from_slice(py, &self.channel(name)?.values))
    }

    fn __contains__(&self, name: &str) -> bool {
        self.inner.channel(name).is_some()
    }

    fn __len__(&self) -> usize {
        self.inner.len()
    }

    /// When time zero was: seconds from 1970-01-01T00:00:00, and whether that is UTC; None where nobody wrote a date.
    #[getter]
    fn start(&self) -> Option<(f64, bool)> {
        self.inner.quality.start.map(|start| (start.unix_s, start.is_utc))
    }

    /// A copy whose time zero was then: seconds from 1970-01-01T00:00:00, and whether that is UTC; None: not known.
    fn starting(&self, start: Option<(f64, bool)>) -> PyResult<Self> {
        if let Some((unix_s, _)) = start.filter(|(unix_s, _)| !unix_s.is_finite()) {
            return Err(raise(format!("a record cannot start at {unix_s} s: write a date and a time")));
        }
        let mut record = (*self.inner).clone();
        record.quality.start = start.map(|(unix_s, is_utc)| Start { unix_s, is_utc });
        Ok(record.into())
    }

    /// Everything as bytes, for `pickle`.
    fn to_bytes<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        let bytes = py.detach(|| pickle::bytes(&Written::from(&*self.inner)))?;
        Ok(PyBytes::new(py, &bytes))
    }

    /// The record that `to_bytes` wrote.
    #[staticmethod]
    fn from_bytes(py: Python<'_>, bytes: &[u8]) -> PyResult<Self> {
        py.detach(|| pickle::value::<Written>(bytes, "record")?.record().map(Self::from))
    }

    /// What the reader found, converted, repaired and left out, as text.
    #[getter]
    fn quality(&self) -> String {
        self.inner.quality.to_string()
    }

    /// The part from one time (s) to another, both included.
    #[pyo3(signature = (start=None, end=None))]
    fn between(&self, start: Option<f64>, end: Option<f64>) -> PyResult<Self> {
        let (low, high) = (start.unwrap_or(f64::NEG_INFINITY), end.unwrap_or(f64::INFINITY));
        let none = || raise(format!("no sample lies between {low} s and {high} s: {}", self.__repr__()));
        self.inner.between(low, high).map(Self::from).ok_or_else(none)
    }

    /// A copy in which the values of some channels (of all where there is none) from one time (s) to another are missing,
    /// with the reason in its quality report.
    #[pyo3(signature = (channels, start, end, reason))]
    fn delete(&self, channels: Vec<String>, start: f64, end: f64, reason: &str) -> PyResult<Self> {
        let deletion = Deletion::new(channels, start, end, reason).map_err(raise)?;
        let mut record = (*self.inner).clone();
        record.delete(&deletion).map_err(raise)?;
        Ok(record.into())
    }

    /// What was deleted: first and last time, s, the reason, and the number of values by channel.
    #[getter]
    fn deletions(&self) -> Vec<(f64, f64, String, Vec<(String, usize)>)> {
        let counts = |deleted: &Deleted| deleted.channels.iter().map(|c| (c.channel.clone(), c.values)).collect();
        let deletions = self.inner.quality.deletions.iter();
        deletions.map(|d| (d.from_s, d.to_s, d.reason.clone(), counts(d))).collect()
    }

    /// Writes the record as CSV, in SI units and with the units in the headers.
    fn write_csv(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        py.detach(|| csv::write_path(&self.inner, &path)).map_err(raise)
    }

    fn __repr__(&self) -> String {
        let record = &self.inner;
        let span = record.time.first().zip(record.time.last()).map_or_else(String::new, |(a, b)| {
            format!(" from {a:.2} s to {b:.2} s, one per {:.4} s", record.sample_time_s())
        });
        format!("<Record '{}': {} samples{span}; {}>", record.source, record.len(), self.channels().join(", "))
    }
}

impl Record {
    fn channel(&self, name: &str) -> PyResult<&library::Channel> {
        self.inner.require(name).map_err(|error| PyKeyError::new_err(error.to_string()))
    }
}

/// Assignment of a column to a channel: channel, header, unit (none: from the header), factor.
fn to_mappings(mappings: Vec<(String, String, Option<String>, f64)>) -> Vec<ColumnMapping> {
    let mapping = |(channel, header, unit, scale): (String, String, _, _)| ColumnMapping {
        unit,
        scale,
        ..ColumnMapping::new(channel, header)
    };
    mappings.into_iter().map(mapping).collect()
}
