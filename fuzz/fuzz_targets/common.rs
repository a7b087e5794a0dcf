//! What every reader promises, whatever the bytes.
#![allow(dead_code, reason = "every target has this file as a module of its own, and needs some of it")]

use std::fmt::Display;

use phugoid_flight_data::log::survey::Survey;
use phugoid_flight_data::log::{Log, LogError, Selection};
use phugoid_flight_data::memory::Memory;
use phugoid_flight_data::profile::Profile;
use phugoid_flight_data::reader::{self, ReadOptions};
use phugoid_flight_data::record::Record;
use phugoid_flight_data::table::TableOptions;

/// Bound on the memory of a run; whatever a file says, no more is taken.
const MAX_MEMORY: Memory = Memory::from_bytes(8 << 20);

/// Options with the bound.
pub fn options() -> TableOptions {
    TableOptions { max_memory: MAX_MEMORY, ..TableOptions::default() }
}

/// A record that keeps its promises, or an error that fits on a screen.
pub fn table<E: Display>(result: Result<Record, E>) -> Option<Record> {
    let record = result.map_err(fits_on_a_screen).ok()?;
    assert!(record.len() >= 2);
    assert!(record.time.windows(2).all(|pair| pair[0] < pair[1]), "time increases");
    assert!(record.time.iter().all(|time| time.is_finite()));
    assert!(record.channels.iter().all(|channel| channel.values.len() == record.len()));
    assert!(record.channels.iter().all(|channel| channel.values.iter().all(|value| !value.is_infinite())));
    assert!(record.quality.rows_read >= record.quality.rows_kept);
    let _ = record.quality.to_string();
    Some(record)
}

/// A log whose topics are tables and of which a record can be made, and a survey of it, or errors that fit on a screen.
pub fn log<'b>(
    bytes: &'b [u8],
    read: impl Fn(&'b [u8], &str, &Selection) -> Result<Log, LogError>,
    survey: impl Fn(&'b [u8], &str) -> Result<Survey, LogError>,
    profile: &Profile,
) {
    match read(bytes, "fuzz", &Selection { max_memory: MAX_MEMORY, ..Selection::default() }) {
        Ok(log) => {
            for topic in &log.topics {
                assert!(!topic.time_s.is_empty());
                assert!(topic.fields.iter().all(|field| field.values.len() == topic.time_s.len()), "{}", topic.name);
            }
            let _ = log.quality.to_string();
            let options = ReadOptions { table: options(), ..ReadOptions::default() };
            table(reader::record(&log, profile, &options));
        }
        Err(error) => fits_on_a_screen(error),
    }
    match survey(bytes, "fuzz") {
        Ok(survey) => assert!(survey.topics.iter().all(|topic| topic.samples > 0)),
        Err(error) => fits_on_a_screen(error),
    }
}

fn fits_on_a_screen(error: impl Display) {
    assert!(error.to_string().len() < 8000, "an error fits on a screen");
}
