//! Columns whose names are probably misspelt names of channels.

use std::fmt;

use super::header::{self, Doubt, Meaning};
use crate::channels;
use crate::record::{Quantity, Record};
use crate::units::Unit;

/// A column that was kept as a signal of its own and that may be a known channel.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Misspelt {
    /// The header of the column.
    pub header: String,
    /// The canonical name of the channel that may be meant.
    pub channel: &'static str,
    /// Why it was not taken for the channel, and how to say that the channel is meant.
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
    let of = if like == channel { String::new() } else { format!(" ({channel})") };
    format!("no known channel, kept as it is; its name is like '{like}'{of}. {}", if_it_is(header, channel, unit))
}

/// What is to be done if a column is this channel, as a sentence without its stop.
fn if_it_is(header: &str, channel: &str, unit: Option<Unit>) -> String {
    let quantity = channels::by_name(channel).map_or(Quantity::Number, |spec| spec.quantity);
    let unit = unit.filter(|unit| unit.quantity == quantity && quantity != Quantity::Number);
    let suffix = unit.map_or(quantity.si_suffix(), |unit| unit.symbol);
    let example = if suffix.is_empty() { channel.to_owned() } else { format!("{channel}_{suffix}") };
    let header_value = toml::Value::String(header.to_owned());
    let unit_value = if suffix.is_empty() { String::new() } else { format!(", unit = \"{suffix}\"") };
    let other = if unit.is_none() && !suffix.is_empty() {
        format!(", with the unit that it is in where that is not {}", quantity.si_unit())
    } else {
        String::new()
    };
    format!(
        "If it is {channel}, write {example} as its header, or map it in the model file: [channels] {channel} = {{ header = \
         {header_value}{unit_value} }}{other}"
    )
}

/// What a column could be whose name has several meanings, or whose unit is not one of the channel that it looks like.
fn other_message(header: &str, channel: &str, doubt: &Doubt, unit: Option<Unit>) -> Option<String> {
    let why = match doubt {
        Doubt::Near { .. } => return None,
        Doubt::Ambiguous(meanings) if meanings.len() == 1 => {
            "this name can also mean something else, and is not guessed without a unit".to_owned()
        }
        Doubt::Ambiguous(meanings) => format!("it could be {}, and is not guessed", meanings.join(" or ")),
        Doubt::Unit { spec, text, found } => {
            let quantity = spec.quantity;
            let what = match found {
                Some(found) => format!("is {} and no unit of {}", found.in_words(), quantity.in_words()),
                None => "is no unit that is understood".to_owned(),
            };
            format!("it looks like {}, but '{text}' {what}", spec.name)
        }
    };
    Some(format!("{why}. {}", if_it_is(header, channel, unit)))
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
        self.doubts()
            .filter_map(|(header, doubt, unit)| {
                let Doubt::Near { name, like, unit: near } = doubt else { return None };
                let is_lacking = self.channel(name).is_none() && can_be(name, unit);
                is_lacking.then(|| Misspelt {
                    header: header.to_owned(),
                    channel: name,
                    message: message(header, name, like, unit.or(near)),
                })
            })
            .collect()
    }

    /// The columns that were kept as signals of their own and that may be this channel, which the record lacks: the misspelt ones,
    /// those whose names can mean several channels, and those in a unit that the channel cannot have.
    ///
    /// ```
    /// use phugoid_flight_data::csv::{self, CsvOptions};
    /// let text = "time_s,airspeed_m_s,alpha_kt\n0,80,2\n1,81,2\n";
    /// let record = csv::read(text.as_bytes(), "flight.csv", &CsvOptions::default())?;
    /// let airspeed = &record.columns_for("true_airspeed")[0];
    /// assert!(airspeed.message.contains("could be true_airspeed or calibrated_airspeed"));
    /// let alpha = &record.columns_for("alpha")[0];
    /// assert!(alpha.message.contains("'kt' is a speed and no unit of an angle"));
    /// assert!(record.columns_for("q").is_empty());
    /// # Ok::<(), csv::ReadError>(())
    /// ```
    pub fn columns_for(&self, channel: &str) -> Vec<Misspelt> {
        let mut found = self.misspelt();
        found.retain(|column| column.channel == channel);
        let Some(spec) = channels::by_name(channel).filter(|_| self.channel(channel).is_none()) else { return found };
        found.extend(self.doubts().filter_map(|(header, doubt, unit)| {
            let is_meant = match &doubt {
                Doubt::Near { .. } => false,
                Doubt::Ambiguous(meanings) => meanings.contains(&spec.name) && can_be(spec.name, unit),
                Doubt::Unit { spec: looks_like, .. } => looks_like.name == spec.name,
            };
            let message = is_meant.then(|| other_message(header, spec.name, &doubt, unit)).flatten()?;
            Some(Misspelt { header: header.to_owned(), channel: spec.name, message })
        }));
        found
    }

    /// The columns that were not taken for a known channel although they look like one: header, why, and unit.
    fn doubts(&self) -> impl Iterator<Item = (&str, Doubt, Option<Unit>)> {
        let unknown = self.quality.channels.iter().filter(|column| channels::by_name(&column.name).is_none());
        unknown.filter_map(|column| {
            let below = (column.unit != "-").then_some(column.unit.as_str());
            let meaning = header::interpret(&column.header, None).ok()?;
            let Meaning::Unknown { unit, doubt: Some(doubt), .. } = meaning else { return None };
            let unit = unit.or_else(|| below.and_then(|text| crate::units::find(text).first().copied()));
            Some((column.header.as_str(), doubt, unit))
        })
    }
}
