//! A flight as telemetry, for tests of what arrives: as MAVLink, CSV and JSON lines. Used by `mod telemetry` with a path.

// Each test file uses a part; what goes wrong here fails the test.
#![allow(dead_code, clippy::unwrap_used)]

use phugoid_live::mavlink::definitions::{self, Kind};
use phugoid_live::mavlink::frame;
use serde_json::Value;

/// Samples per second.
pub(crate) const RATE: f64 = 100.0;

/// What is measured at a time, by the names of channels, SI. The numbers move as in flight; nothing here asks what is estimated
/// from them.
pub(crate) fn signals(t: f64) -> Vec<(&'static str, f64)> {
    let wiggle =
        |size: f64, rate: f64, phase: f64| size * (rate * t + phase).sin() + 0.02 * size * (977.0 * t + phase).sin();
    vec![
        ("tas", 205.9 + wiggle(0.5, 1.1, 0.0)),
        ("alpha", 0.041 + wiggle(0.01, 2.0, 0.3)),
        ("theta", 0.042 + wiggle(0.01, 2.0, 1.0)),
        ("q", wiggle(0.02, 2.0, 1.5)),
        ("ax", 0.29 + wiggle(0.1, 2.0, 0.4)),
        ("elevator", -0.034 + wiggle(0.01, 2.0, 2.0)),
        ("thrust", 9909.0),
        ("altitude", 6096.0),
        ("az", -9.7 + wiggle(0.6, 2.0, 0.2)),
    ]
}

/// The header of the text, in the order of [`signals`].
const HEADER: &str = "time_s,tas_m_s,alpha_rad,theta_rad,q_rad_s,ax_m_s2,elevator_rad,thrust_n,altitude_m,az_m_s2";

fn rows(samples: std::ops::Range<u32>) -> impl Iterator<Item = Vec<f64>> {
    samples
        .map(|k| f64::from(k) / RATE)
        .map(|t| std::iter::once(t).chain(signals(t).into_iter().map(|(_, value)| value)).collect())
}

/// The header line.
pub(crate) fn csv_header() -> String {
    format!("{HEADER}\n")
}

/// Lines below the header.
pub(crate) fn csv_rows(samples: std::ops::Range<u32>) -> String {
    rows(samples).map(|row| row.iter().map(f64::to_string).collect::<Vec<_>>().join(",") + "\n").collect()
}

/// The same, as objects.
pub(crate) fn json_lines(samples: std::ops::Range<u32>) -> String {
    let object = |row: Vec<f64>| {
        let object: serde_json::Map<String, Value> =
            HEADER.split(',').zip(row).map(|(name, value)| (name.to_owned(), value.into())).collect();
        Value::Object(object).to_string() + "\n"
    };
    rows(samples).map(object).collect()
}

/// A frame of a message with these fields, the others zero, and this name where it has one.
pub(crate) fn message(name: &str, sequence: u8, numbers: &[(&str, f64)], text: &str) -> Vec<u8> {
    let message = definitions::by_name(name).unwrap();
    let mut payload = vec![0; message.length()];
    for (field, value) in numbers {
        let field = message.field(field).unwrap();
        let bytes = match field.kind {
            Kind::Float => (*value as f32).to_le_bytes().to_vec(),
            _ => (*value as i64).to_le_bytes()[..field.kind.size()].to_vec(),
        };
        payload[field.offset..field.offset + bytes.len()].copy_from_slice(&bytes);
    }
    if let Some(field) = message.field("name") {
        payload[field.offset..field.offset + text.len()].copy_from_slice(text.as_bytes());
    }
    frame::encode(message.id, sequence, 1, 1, &payload).unwrap()
}
