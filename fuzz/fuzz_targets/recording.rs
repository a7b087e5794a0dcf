//! Any bytes as a recording of `phugoid live`: every byte is either in an arrival or counted, or it is no recording.
#![no_main]

use std::path::PathBuf;
use std::sync::LazyLock;

use libfuzzer_sys::fuzz_target;
use phugoid_live::recording::Reader;

/// The reader takes a file, as a kill leaves it.
static PATH: LazyLock<PathBuf> =
    LazyLock::new(|| std::env::temp_dir().join(format!("phugoid-fuzz-{}.phgl", std::process::id())));

fuzz_target!(|bytes: &[u8]| {
    std::fs::write(&*PATH, bytes).expect("the temporary folder can be written");
    let mut reader = match Reader::open(&PATH) {
        Ok(reader) => reader,
        Err(error) => return assert!(error.to_string().len() < 8000, "an error fits on a screen"),
    };
    while let Ok(Some(_)) = reader.next_arrival() {}
    let damage = reader.damage();
    assert!(damage.skipped_bytes + damage.cut_off_bytes < bytes.len() as u64, "the header at least was read");
});
