//! Reads a flight of any format and prints its channels and its quality report:
//! `cargo run -p phugoid-flight-data --example describe -- FLIGHT`

use phugoid_flight_data::reader::{ReadOptions, read_path};

fn main() -> std::process::ExitCode {
    let Some(path) = std::env::args_os().nth(1) else {
        eprintln!("which file? usage: describe FLIGHT");
        return std::process::ExitCode::from(2);
    };
    match read_path(path.as_ref(), &ReadOptions::default()) {
        Ok(record) => {
            print!("{}", record.quality);
            for entry in &record.quality.channels {
                let assumed = if entry.unit_assumed { " (assumed)" } else { "" };
                println!(
                    "{:<24} from '{}' in {}{assumed}, {} missing",
                    entry.name, entry.header, entry.unit, entry.missing
                );
            }
            std::process::ExitCode::SUCCESS
        }
        Err(error) => {
            eprintln!("{error}");
            std::process::ExitCode::FAILURE
        }
    }
}
