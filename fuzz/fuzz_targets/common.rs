//! What every reader of a table promises of its record.

use phugoid_flight_data::record::Record;

/// Bound on the values of a table, so that a run needs little memory; whatever a file says, no more is taken.
#[allow(dead_code, reason = "not every target is bounded by it")]
pub const MAX_VALUES: usize = 1 << 16;

/// Whatever was read, it is a record, and what is said of it fits on some screens.
pub fn keeps_its_promises(record: &Record) {
    assert!(record.len() >= 2);
    assert!(record.time.windows(2).all(|pair| pair[0] < pair[1]), "time increases");
    assert!(record.time.iter().all(|time| time.is_finite()));
    assert!(record.channels.iter().all(|channel| channel.values.len() == record.len()));
    assert!(record.channels.iter().all(|channel| channel.values.iter().all(|value| !value.is_infinite())));
    assert!(record.quality.rows_read >= record.quality.rows_kept);
    let _ = record.quality.to_string();
}
