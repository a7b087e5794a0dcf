//! Logs that cannot be used, in the ways in which they come.

use std::path::Path;

use phugoid_flight_data::record::Record;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

/// What is wrong with a log, in turn.
const WAYS: usize = 6;

/// Spoils what is recorded, in the first three ways: the vane is not there, its transmitter stands still, the elevator never
/// moves.
pub(crate) fn record(record: &mut Record, number: usize) {
    match number % WAYS {
        0 => record.channels.iter_mut().filter(|c| c.name == "alpha").for_each(|c| c.values.fill(f64::NAN)),
        1 => record.channels.iter_mut().filter(|c| c.name == "alpha").for_each(|c| c.values.fill(0.11)),
        2 => record.channels.iter_mut().filter(|c| c.name == "elevator").for_each(|c| c.values.fill(-0.01)),
        _ => {}
    }
}

/// Spoils the file, in the others: nothing in it, cut off in its first twentieth, bytes without meaning.
///
/// # Errors
/// What the operating system says of the file.
pub(crate) fn file(path: &Path, number: usize) -> std::io::Result<()> {
    let bytes = match number % WAYS {
        3 => Vec::new(),
        4 => {
            let bytes = std::fs::read(path)?;
            bytes[..bytes.len() / 20].to_vec()
        }
        5 => {
            let mut noise = Pcg64Mcg::seed_from_u64(number as u64);
            (0..50_000).map(|_| noise.random()).collect()
        }
        _ => return Ok(()),
    };
    std::fs::write(path, bytes)
}
