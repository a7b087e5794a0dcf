//! Published check cases, read from the project's shared data.

#![allow(dead_code, clippy::unwrap_used)] // not every test file needs everything; helpers of tests may stop

#[path = "../../../../tests/shared_data.rs"]
mod shared_data;

use serde_json::Value;

/// m per ft.
pub(crate) const FOOT: f64 = 0.3048;
/// N per lbf.
pub(crate) const POUND_FORCE: f64 = 4.448_221_615_260_5;

/// A JSON file of the shared data.
pub(crate) fn shared(file: &str) -> Option<Value> {
    let text = std::fs::read_to_string(shared_data::shared_file(file)?).unwrap();
    Some(serde_json::from_str(&text).unwrap())
}

/// The published cases of Stevens, Lewis & Johnson.
pub(crate) fn published() -> Option<Value> {
    shared("checks/stevens_lewis/stevens_lewis_published.json")
}

/// A list of numbers in the reference file.
pub(crate) fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().unwrap().iter().map(|v| v.as_f64().unwrap()).collect()
}
