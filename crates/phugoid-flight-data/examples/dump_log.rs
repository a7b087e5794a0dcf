//! Prints every topic of a log as one line of JSON, for comparison with the formats' own tools.
//!
//!     cargo run -p phugoid-flight-data --example dump_log -- flight.ulg

use std::io::Write;

use phugoid_flight_data::log::{self, Selection};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let file = std::env::args().nth(1).ok_or("the name of a log is needed")?;
    let log = log::read_path(file.as_ref(), &Selection::default())?;
    eprintln!("{}", log.quality);
    let mut out = std::io::BufWriter::new(std::io::stdout().lock());
    let head =
        serde_json::json!({ "information": log.information, "parameters": log.parameters, "messages": log.messages });
    writeln!(out, "{head}")?;
    for topic in &log.topics {
        serde_json::to_writer(&mut out, topic)?;
        writeln!(out)?;
    }
    Ok(())
}
