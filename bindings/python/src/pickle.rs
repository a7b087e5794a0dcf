//! Objects as bytes and back, for `pickle` and `copy`: CBOR, which keeps every bit of a number, NaN and infinities too.

use phugoid_flight_data::quality::QualityReport;
use phugoid_flight_data::record as library;
use phugoid_flight_data::units::Quantity;
use pyo3::prelude::*;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

use crate::error::raise;

/// A flight record as it is written.
#[derive(Serialize, Deserialize)]
pub(crate) struct Written {
    source: String,
    time: Vec<f64>,
    channels: Vec<(String, Quantity, Vec<f64>)>,
    quality: QualityReport,
}

impl From<&library::Record> for Written {
    fn from(record: &library::Record) -> Self {
        let channels = record.channels.iter().map(|c| (c.name.clone(), c.quantity, c.values.clone()));
        Self {
            source: record.source.clone(),
            time: record.time.clone(),
            channels: channels.collect(),
            quality: record.quality.clone(),
        }
    }
}

impl Written {
    /// The record, if it keeps the rules of records: later code counts on them.
    pub(crate) fn record(self) -> PyResult<library::Record> {
        let rows = self.time.len();
        let increasing = self.time.windows(2).all(|pair| matches!(pair, [a, b] if a < b));
        if !increasing || !self.time.iter().all(|t| t.is_finite()) {
            return Err(raise(
                "these bytes are no record: its times do not increase; make the record again from its file",
            ));
        }
        if let Some((name, _, values)) = self.channels.iter().find(|(_, _, values)| values.len() != rows) {
            return Err(raise(format!(
                "these bytes are no record: '{name}' has {} values for {rows} times; make the record again from its file",
                values.len()
            )));
        }
        let channel = |(name, quantity, values)| library::Channel { name, quantity, values };
        Ok(library::Record {
            source: self.source,
            time: self.time,
            channels: self.channels.into_iter().map(channel).collect(),
            quality: self.quality,
        })
    }
}

/// Writes a value as CBOR.
pub(crate) fn bytes(value: &impl Serialize) -> PyResult<Vec<u8>> {
    let mut bytes = Vec::new();
    ciborium::into_writer(value, &mut bytes).map_err(raise)?;
    Ok(bytes)
}

/// Reads a value that [`bytes`] wrote; `what` names it in the message.
pub(crate) fn value<T: DeserializeOwned>(bytes: &[u8], what: &str) -> PyResult<T> {
    ciborium::from_reader(bytes).map_err(|error| {
        raise(format!(
            "these bytes are no {what} of phugoid {}: {error}; make it again from its file",
            env!("CARGO_PKG_VERSION")
        ))
    })
}
