//! Prints every frame of a file of MAVLink as one line of JSON, and in the last line what was skipped, for comparison with pymavlink.
//!
//!     cargo run -p phugoid-live --example dump_mavlink -- telemetry.mavlink

use std::io::Write;

use phugoid_live::mavlink::definitions::{self, Field, Kind};
use phugoid_live::mavlink::frame::{self, Found, Frame};
use serde_json::{Map, Value, json};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let file = std::env::args().nth(1).ok_or("the name of a file is needed")?;
    let bytes = std::fs::read(file)?;
    let mut lines = Vec::new();
    let (mut bad_checksums, mut garbage_bytes) = (0_usize, 0_usize);
    let used = frame::split(&bytes, &mut |found| match found {
        Found::Frame(frame, _) => lines.push(described(&frame)),
        Found::BadChecksum(_) => bad_checksums += 1,
        Found::Garbage(skipped) => garbage_bytes += skipped,
        Found::Incomplete => {}
    });
    // Of a frame whose checksum does not hold the first byte is skipped, and what follows it is looked at anew.
    lines.push(json!({
        "bad_checksums": bad_checksums, "skipped_bytes": bad_checksums + garbage_bytes, "left_bytes": bytes.len() - used,
    }));
    let mut out = std::io::BufWriter::new(std::io::stdout().lock());
    for line in lines {
        writeln!(out, "{line}")?;
    }
    Ok(())
}

fn described(frame: &Frame<'_>) -> Value {
    let message = definitions::messages().get(&frame.id);
    let fields = message.into_iter().flat_map(|message| &message.fields);
    let fields: Map<String, Value> = fields.map(|field| (field.name.to_owned(), value(field, frame.payload))).collect();
    json!({
        "id": frame.id, "name": message.map(|message| message.name), "sequence": frame.sequence, "system": frame.system,
        "component": frame.component, "fields": fields,
    })
}

/// A number, a list of them or a text; null for what is no finite number.
fn value(field: &Field, payload: &[u8]) -> Value {
    let number = |element| field.value(payload, element).into();
    match (field.kind, field.count) {
        (Kind::Character, _) => field.text(payload).into(),
        (_, 0) => number(0),
        (_, count) => (0..count).map(number).collect(),
    }
}
