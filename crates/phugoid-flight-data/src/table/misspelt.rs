//! Columns whose names are probably misspelt names of channels.

use std::fmt;

use super::header::{self, Doubt, Meaning};
use crate::channels;
use crate::record::{Quantity, Record};
use crate::units::Unit;

/// A column that was kept as a signal of its own and whose name is like that of a known channel.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Misspelt {
    /// The header of the column.
    pub header: String,
    /// The canonical name of the channel that may be meant.
    pub channel: &'static str,
    /// Which known name it is like, and how to say that the channel is meant.
    pub message: String,
}

impl fmt::Display for Misspelt {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "column '{}': {}", self.header, self.message)
    }
}

/// What the reader says of a column whose name is like `like`, a name of a channel. `unit` is the one that is written, if one is
/// understood.
pub(super) fn message(header: &str, channel: &str, like: &str, unit: Option<Unit>) -> String {
    let quantity = channels::by_name(channel).map_or(Quantity::Number, |spec| spec.quantity);
    let unit = unit.filter(|unit| unit.quantity == quantity && quantity != Quantity::Number);
    let suffix = unit.map_or(quantity.si_suffix(), |unit| unit.symbol);
    let example = if suffix.is_empty() { channel.to_owned() } else { format!("{channel}_{suffix}") };
    let of = if like == channel { String::new() } else { format!(" ({channel})") };
    let header_value = toml::Value::String(header.to_owned());
    let unit_value = if suffix.is_empty() { String::new() } else { format!(", unit = \"{suffix}\"") };
    let or_unit = if unit.is_none() && !suffix.is_empty() { " (or its unit)" } else { "" };
    format!(
        "no known channel, kept as it is; its name is like '{like}'{of}. If it is {channel}, write {example}{or_unit} \
         as its header, or map it in the model file: [channels] {channel} = {{ header = {header_value}{unit_value} }}"
    )
}

/// Whether a column in this unit can be the channel: one in metres is no misspelt elevator.
pub(super) fn can_be(channel: &str, unit: Option<Unit>) -> bool {
    unit.is_none_or(|unit| channels::by_name(channel).is_some_and(|spec| spec.quantity == unit.quantity))
}

impl Record {
    /// The columns that were kept as signals of their own and whose names are like those of channels that the record lacks.
    ///
    /// ```
    /// use phugoid_flight_data::csv::{self, CsvOptions};
    /// let text = "time_s,alpha_deg,elevatr_deg\n0,1,2\n1,1,2\n";
    /// let record = csv::read(text.as_bytes(), "flight.csv", &CsvOptions::default())?;
    /// let misspelt = record.misspelt();
    /// assert_eq!((misspelt[0].header.as_str(), misspelt[0].channel), ("elevatr_deg", "elevator"));
    /// # Ok::<(), csv::ReadError>(())
    /// ```
    pub fn misspelt(&self) -> Vec<Misspelt> {
        let unknown = self.quality.channels.iter().filter(|column| channels::by_name(&column.name).is_none());
        unknown
            .filter_map(|column| {
                let below = (column.unit != "-").then_some(column.unit.as_str());
                let meaning = header::interpret(&column.header, None).ok()?;
                let Meaning::Unknown { unit, doubt: Some(Doubt::Near { name, like }), .. } = meaning else {
                    return None;
                };
                let unit = unit.or_else(|| below.and_then(|text| crate::units::find(text).first().copied()));
                let is_lacking = self.channel(name).is_none() && can_be(name, unit);
                is_lacking.then(|| Misspelt {
                    header: column.header.clone(),
                    channel: name,
                    message: message(&column.header, name, like, unit),
                })
            })
            .collect()
    }
}
