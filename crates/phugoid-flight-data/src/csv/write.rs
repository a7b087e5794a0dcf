//! Writes a record as the text of a CSV file.

use std::io::Write;
use std::path::Path;

use super::{NameProblem, WriteError};
use crate::channels;
use crate::output_file::OutputFile;
use crate::printable;
use crate::record::{Channel, Quantity, Record};
use crate::table::header::{self, Meaning};

/// Writes a CSV file to the disk, whole or not at all ([`OutputFile`]); otherwise as [`write()`].
///
/// # Errors
/// As [`write()`], with the path as the target's name. Names and lengths are checked before the file is created.
pub fn write_path(record: &Record, path: &Path) -> Result<(), WriteError> {
    let target = printable::path(path);
    let headers = headers(record, &target)?;
    let failed = |error| WriteError::Io { target: target.clone(), error };
    let mut file = OutputFile::create(path).map_err(failed)?;
    write_rows(record, &headers, &mut file, &target)?;
    file.finish().map_err(failed)
}

/// Writes a record as CSV in SI units, `time_s` first, with the unit in every header (`alpha_rad`, `true_airspeed_m_s`)
/// and as many digits as are needed to read the same numbers back. Missing values are empty cells. The quality report
/// is not written.
///
/// # Errors
/// [`WriteError`] if a channel has another length than the time, a name that could not be read back, or the writer
/// fails.
pub fn write(record: &Record, writer: impl Write) -> Result<(), WriteError> {
    let target = if record.source.is_empty() { "record" } else { record.source.as_str() };
    let headers = headers(record, target)?;
    write_rows(record, &headers, writer, target)
}

/// The headers under which a record is written, time first.
pub(crate) fn headers(record: &Record, target: &str) -> Result<Vec<String>, WriteError> {
    let mut headers = vec!["time_s".to_owned()];
    for channel in &record.channels {
        if channel.values.len() != record.time.len() {
            return Err(WriteError::Length {
                target: target.to_owned(),
                channel: channel.name.clone(),
                found: channel.values.len(),
                expected: record.time.len(),
            });
        }
        let name = |problem| WriteError::Name { target: target.to_owned(), channel: channel.name.clone(), problem };
        if record.channels.iter().filter(|other| other.name == channel.name).count() > 1 {
            return Err(name(NameProblem::Twice));
        }
        let is_writable = |name: &str| {
            let is_shown = !name.contains(printable::is_command);
            !name.is_empty() && name.trim() == name && is_shown && !printable::is_formula(name)
        };
        if !is_writable(&channel.name) {
            return Err(name(NameProblem::Unwritable));
        }
        let header = header_of(channel).ok_or_else(|| name(NameProblem::Misread))?;
        headers.push(header);
    }
    Ok(headers)
}

/// A header that is read back as this channel: with the unit as a suffix, or in brackets where the suffix would be
/// misread. `None` if there is none.
fn header_of(channel: &Channel) -> Option<String> {
    let (name, quantity) = (&channel.name, channel.quantity);
    let with_suffix = |name: &str| match quantity {
        Quantity::Number => name.to_owned(),
        _ => format!("{name}_{}", quantity.si_suffix()),
    };
    let bracket = format!("{name} [{}]", if quantity == Quantity::Number { "-" } else { quantity.si_unit() });
    // `v` alone is ambiguous, its synonym `v_body` is not.
    let synonyms = channels::by_name(name).map(|spec| spec.synonyms).unwrap_or_default();
    let synonyms = synonyms.iter().map(|synonym| with_suffix(synonym));
    [with_suffix(name), bracket].into_iter().chain(synonyms).find(|header| match header::interpret(header, None) {
        Ok(Meaning::Known { spec, unit }) => {
            spec.name == name && spec.quantity == quantity && (unit.is_some() || quantity == Quantity::Number)
        }
        Ok(Meaning::Unknown { name: read, unit, .. }) => {
            read == *name
                && channels::by_name(name).is_none()
                && unit.map_or(Quantity::Number, |unit| unit.quantity) == quantity
        }
        Err(_) => false,
    })
}

fn write_rows(record: &Record, headers: &[String], writer: impl Write, target: &str) -> Result<(), WriteError> {
    let failed = |error: ::csv::Error| WriteError::Io { target: target.to_owned(), error: error.into() };
    let mut writer = ::csv::Writer::from_writer(writer);
    writer.write_record(headers).map_err(failed)?;
    let mut row = Vec::with_capacity(headers.len());
    for (index, time) in record.time.iter().enumerate() {
        row.clear();
        row.push(shortest(*time));
        for channel in &record.channels {
            row.push(match channel.values.get(index) {
                Some(value) if value.is_finite() => shortest(*value),
                _ => String::new(),
            });
        }
        writer.write_record(&row).map_err(failed)?;
    }
    writer.flush().map_err(|error| WriteError::Io { target: target.to_owned(), error })
}

/// The shortest text that reads back as the same number, with an exponent where there would be many zeros.
fn shortest(value: f64) -> String {
    let size = value.abs();
    if value == 0.0 || (1e-5..=1e15).contains(&size) { value.to_string() } else { format!("{value:e}") }
}

#[cfg(test)]
mod tests {
    use super::shortest;

    #[test]
    fn numbers_are_short_and_read_back_the_same() {
        for (value, text) in [
            (0.0, "0"),
            (-0.0, "-0"),
            (-2.77e-29, "-2.77e-29"),
            (9.999e-6, "9.999e-6"),
            (1e-5, "0.00001"),
            (0.1, "0.1"),
            (1e15, "1000000000000000"),
            (6.02e23, "6.02e23"),
            (f64::MIN_POSITIVE, "2.2250738585072014e-308"),
        ] {
            assert_eq!(shortest(value), text);
            assert_eq!(shortest(value).parse::<f64>().map(f64::to_bits), Ok(value.to_bits()));
        }
    }
}
