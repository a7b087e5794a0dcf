//! Writes the logs of a simulated fleet, one folder for each airframe:
//!
//!     cargo run -p phugoid-fleet --example simulated_fleet -- FOLDER AIRFRAMES FLIGHTS SENSOR_SCALE DRIFT \
//!         RATE_HZ MANOEUVRES [EXCHANGES.csv]
//!
//! `DRIFT` is the part of Cm_alpha that the airframe `airframe-2` gains with each flight: 0.0002 is 1 % in 50 flights. `EXCHANGES.csv`
//! has the sensors that are exchanged for others: airframe (from 0), first flight with the other one (from 1), channel, by which part
//! more it shows, and degrees that its zero is off (`examples/exchanges.csv`).

use std::path::Path;

use phugoid_fleet::simulated::{Drift, Exchange, SimulatedFleet};
use phugoid_flight_data::csv;
use rayon::prelude::*;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let ([folder, airframes, flights, sensor_scale, drift, rate, manoeuvres], exchanged @ ([] | [_])) =
        words.split_at(words.len().min(7))
    else {
        return Err("expected: FOLDER AIRFRAMES FLIGHTS SENSOR_SCALE DRIFT RATE_HZ MANOEUVRES [EXCHANGES.csv]".into());
    };
    let (airframes, flights): (usize, usize) = (airframes.parse()?, flights.parse()?);
    let drift = Drift { airframe: 2, parameter: "Cm_alpha".to_owned(), part_per_flight: drift.parse()? };
    let (sample_rate_hz, manoeuvres) = (rate.parse()?, manoeuvres.parse()?);
    let exchanges = exchanged.first().map(|file| exchanges(Path::new(file))).transpose()?.unwrap_or_default();
    let fleet = SimulatedFleet {
        seed: 1,
        sensor_scale: sensor_scale.parse()?,
        sample_rate_hz,
        manoeuvres,
        drifts: vec![drift],
        exchanges,
    };
    let write = |number: usize| {
        let (airframe, flight) = (number / flights, number % flights);
        let folder = Path::new(folder).join(format!("airframe-{airframe}"));
        std::fs::create_dir_all(&folder).map_err(|error| error.to_string())?;
        let record = fleet.record(airframe, flight).map_err(|error| error.to_string())?;
        csv::write_path(&record, &folder.join(format!("flight-{:03}.csv", flight + 1)))
            .map_err(|error| error.to_string())
    };
    (0..airframes * flights).into_par_iter().map(write).collect::<Result<(), String>>()?;
    Ok(())
}

/// The rows of a file of exchanged sensors.
fn exchanges(file: &Path) -> Result<Vec<Exchange>, Box<dyn std::error::Error>> {
    let text = std::fs::read_to_string(file)?;
    let row = |line: &str| -> Result<Exchange, Box<dyn std::error::Error>> {
        let cells: Vec<&str> = line.split(',').map(str::trim).collect();
        let [airframe, first_flight, channel, scale, zero_deg] = cells[..] else {
            return Err(
                format!("{}: `{line}`: expected airframe,first_flight,channel,scale,zero_deg", file.display()).into()
            );
        };
        let flight = first_flight.parse::<usize>()?.checked_sub(1).ok_or("flights are counted from 1")?;
        let zero = zero_deg.parse::<f64>()?.to_radians();
        Ok(Exchange { airframe: airframe.parse()?, flight, channel: channel.to_owned(), scale: scale.parse()?, zero })
    };
    let told = |line: &str| row(line).map_err(|error| format!("{}: `{line}`: {error}", file.display()).into());
    text.lines().skip(1).filter(|line| !line.trim().is_empty()).map(told).collect()
}
