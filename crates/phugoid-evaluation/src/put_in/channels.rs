//! What can be done to a channel of a record or to a number of a model file.

use phugoid_flight_data::record::{Quantity, Record};
use phugoid_identification::model_file::Source;

/// The record read again as a file would be, so that the reader sees what is wrong with it too.
///
/// # Errors
/// Why the reader does not take it any more.
pub(crate) fn reread(record: Record) -> Result<Record, String> {
    let header = |name: &str, quantity: Quantity| match quantity {
        Quantity::Number => name.to_owned(),
        other => format!("{name}_{}", other.si_suffix()),
    };
    let mut columns = vec![("time_s".to_owned(), record.time)];
    columns.extend(record.channels.into_iter().map(|c| (header(&c.name, c.quantity), c.values)));
    Record::from_columns(&record.source, columns).map_err(|error| error.to_string())
}

/// Multiplies a constant; what is recorded stays.
pub(super) fn constant(source: &mut Source, factor: f64) {
    if let Source::Constant(value) = source {
        *value *= factor;
    }
}

/// The values of a channel to be changed; none where the record lacks it.
pub(super) fn values<'a>(record: &'a mut Record, name: &str) -> &'a mut [f64] {
    record.channels.iter_mut().find(|c| c.name == name).map_or(&mut [], |c| &mut c.values)
}

/// Changes every value of a channel; a record without the channel stays as it is.
pub(super) fn each(record: &mut Record, name: &str, mut change: impl FnMut(f64) -> f64) {
    values(record, name).iter_mut().for_each(|v| *v = change(*v));
}

/// The values of a channel; of one that the record lacks, and for each sample that has none, NaN.
pub(super) fn recorded(record: &Record, name: &str) -> Vec<f64> {
    record.channel(name).map_or_else(|| vec![f64::NAN; record.time.len()], |channel| channel.values.clone())
}

/// Adds to the values of a channel what is a number.
pub(super) fn add(record: &mut Record, name: &str, moved: &[f64]) {
    let mut moved = moved.iter();
    each(record, name, |v| v + moved.next().copied().filter(|m| m.is_finite()).unwrap_or(0.0));
}

/// Shows at each time what was true `delay_s` before (of a negative delay, after), straight between the samples; beyond them
/// the first or the last value.
pub(super) fn delay(record: &mut Record, name: &str, delay_s: f64) {
    let time = record.time.clone();
    let values = values(record, name);
    let old: Vec<(f64, f64)> =
        time.iter().copied().zip(values.iter().copied()).filter(|(_, v)| v.is_finite()).collect();
    for (t, value) in time.iter().zip(values.iter_mut()).filter(|(_, v)| v.is_finite()) {
        let wanted = t - delay_s;
        let after = old.partition_point(|(known, _)| *known < wanted);
        *value = match (after.checked_sub(1).map(|i| old[i]), old.get(after)) {
            (Some((t0, v0)), Some((t1, v1))) => v0 + (v1 - v0) * (wanted - t0) / (t1 - t0),
            (None, Some((_, first))) => *first,
            (Some((_, last)), None) => last,
            (None, None) => *value,
        };
    }
}
