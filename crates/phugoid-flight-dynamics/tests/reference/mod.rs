//! Published check cases, read from the project's shared data.

#![allow(dead_code, clippy::unwrap_used)] // not every test file needs everything; helpers of tests may stop

use serde_json::Value;

/// m per ft.
pub(crate) const FOOT: f64 = 0.3048;
/// N per lbf.
pub(crate) const POUND_FORCE: f64 = 4.448_221_615_260_5;

/// A JSON file of the shared data, or `None` (with a line that says so) when the data are absent. On CI their absence is
/// a failure.
pub(crate) fn shared(file: &str) -> Option<Value> {
    let folder = std::env::var("PHUGOID_SHARED_DATA")
        .unwrap_or_else(|_| concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/data").to_string());
    let path = format!("{folder}/{file}");
    match std::fs::read_to_string(&path) {
        Ok(text) => Some(serde_json::from_str(&text).unwrap()),
        Err(error) => {
            assert!(std::env::var_os("CI").is_none(), "{path}: {error}");
            println!("skipped: {path}: {error}; set PHUGOID_SHARED_DATA to the shared data folder");
            None
        }
    }
}

/// The published cases of Stevens, Lewis & Johnson.
pub(crate) fn published() -> Option<Value> {
    shared("checks/stevens_lewis/stevens_lewis_published.json")
}

/// A list of numbers in the reference file.
pub(crate) fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().unwrap().iter().map(|v| v.as_f64().unwrap()).collect()
}
