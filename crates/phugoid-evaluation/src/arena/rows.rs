//! Every judged number of every flight, one row each: for programs that want more than the summary.

use phugoid_flight_data::printable::cell;
use serde::Serialize;

use super::criteria::CYCLES;
use super::entry::Entry;
use super::trial::{Trial, judged};

/// The estimate of one parameter by one method, some cycles into one flight.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Row {
    /// Name of the entry.
    pub entry: String,
    /// Name of the method.
    pub method: String,
    /// Seed of the flight: that of the entry's scenario plus the number of the flight.
    pub seed: u64,
    /// Time of this row after the instant from which the flight is counted, in cycles of the entry.
    pub cycles: f64,
    /// Name of the parameter, as in the model file.
    pub parameter: String,
    /// True value of the parameter at this time, in its unit.
    pub truth: f64,
    /// Estimate; NaN where the method failed.
    pub estimate: f64,
    /// Claimed standard error; NaN where none is claimed or the method failed.
    pub std_error: f64,
    /// What the error is measured in: the Cramer-Rao bound, or the prior's deviation where there is none.
    pub unit: f64,
}

pub(super) fn rows(entry: &Entry, methods: &[String], flights: &[Trial]) -> Vec<Row> {
    let names = judged(&entry.model);
    let mut rows = Vec::new();
    for flight in flights {
        for (method, track) in methods.iter().zip(&flight.tracks) {
            for (c, cycles) in CYCLES.iter().enumerate() {
                for (j, name) in names.iter().enumerate() {
                    let point = track.as_ref().ok().and_then(|t| t.points.get(c)?.get(j));
                    rows.push(Row {
                        entry: entry.id.clone(),
                        method: method.clone(),
                        seed: flight.seed,
                        cycles: *cycles,
                        parameter: (*name).to_owned(),
                        truth: point.map_or(f64::NAN, |p| p.truth),
                        estimate: point.map_or(f64::NAN, |p| p.value),
                        std_error: point.map_or(f64::NAN, |p| p.std_error),
                        unit: flight.unit.get(c).and_then(|u| u.get(j)).copied().unwrap_or(f64::NAN),
                    });
                }
            }
        }
    }
    rows
}

/// The rows as CSV with a header.
///
/// # Errors
/// What the writer says.
pub fn csv(rows: &[Row]) -> Result<String, csv::Error> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    for row in rows {
        // The entry is named after a file, and a parameter after a channel.
        let [entry, parameter] = [&row.entry, &row.parameter].map(|text| cell(text).into_owned());
        writer.serialize(Row { entry, parameter, ..row.clone() })?;
    }
    let bytes = writer.into_inner().map_err(|error| csv::Error::from(error.into_error()))?;
    Ok(String::from_utf8_lossy(&bytes).into_owned())
}
