//! Writes the logs of a simulated fleet, one folder for each airframe:
//!
//!     cargo run -p phugoid-fleet --example simulated_fleet -- FOLDER AIRFRAMES FLIGHTS SENSOR_SCALE DRIFT \
//!         RATE_HZ MANOEUVRES [exchanges=FILE.csv] [format=csv|ulog|dataflash|all] [spoilt=PART]
//!
//! `DRIFT` is the part of Cm_alpha that the airframe `airframe-2` gains with each flight: 0.0002 is 1 % in 50 flights.
//! `MANOEUVRES` is the number of 3-2-1-1 in each flight, or two numbers (`1-8`) between which it is drawn for each flight, by
//! equal ratios. The file of exchanged sensors has: airframe (from 0), first flight with the other one (from 1), channel, by
//! which part more it shows, and degrees that its zero is off (`exchanges.csv` beside this file). `format=all` gives a third of
//! the flights each format. Logs of autopilots have topics, rates and sizes as in life ([`autopilot`]); they, and the CSV of
//! `format=all`, are estimated with the model `logged_hfb320.toml` beside this file. `spoilt=0.05` makes 5 % of the logs
//! unusable, in six ways in turn ([`spoil`]).

mod autopilot;
mod bytes;
mod dataflash;
mod spoil;
mod ulog;

use std::collections::HashMap;
use std::path::Path;

use phugoid_fleet::simulated::{Drift, Exchange, SimulatedFleet};
use phugoid_flight_data::csv;
use phugoid_flight_data::record::{Channel, Quantity, Record};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use rayon::prelude::*;

type Failure = Box<dyn std::error::Error>;

fn main() -> Result<(), Failure> {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let ([folder, airframes, flights, sensor_scale, drift, rate, manoeuvres], named) =
        words.split_at(words.len().min(7))
    else {
        return Err("expected: FOLDER AIRFRAMES FLIGHTS SENSOR_SCALE DRIFT RATE_HZ MANOEUVRES [exchanges=FILE.csv] \
                    [format=csv|ulog|dataflash|all] [spoilt=PART]"
            .into());
    };
    let named: HashMap<&str, &str> = named.iter().map(|word| word.split_once('=').unwrap_or((word, ""))).collect();
    if let Some(unknown) = named.keys().find(|name| !["exchanges", "format", "spoilt"].contains(name)) {
        return Err(format!("`{unknown}` is none of exchanges=FILE.csv, format=FORMAT, spoilt=PART").into());
    }
    let (airframes, flights): (usize, usize) = (airframes.parse()?, flights.parse()?);
    let (fewest, most) = manoeuvres.split_once('-').unwrap_or((manoeuvres, manoeuvres));
    let (fewest, most): (f64, f64) = (fewest.parse()?, most.parse()?);
    if !(1.0 <= fewest && fewest <= most && most.is_finite()) {
        return Err(
            format!("`{manoeuvres}`: expected the number of manoeuvres, 1 or more, or two in order, `1-8`").into()
        );
    }
    let formats: &[Format] = match *named.get("format").unwrap_or(&"csv") {
        "csv" => &[Format::Csv],
        "ulog" => &[Format::Ulog],
        "dataflash" => &[Format::DataFlash],
        "all" => &[Format::Ulog, Format::DataFlash, Format::CsvOfCommands],
        other => return Err(format!("`format={other}`: expected csv, ulog, dataflash or all").into()),
    };
    let spoilt: f64 = named.get("spoilt").unwrap_or(&"0").parse()?;
    if !(0.0..=1.0).contains(&spoilt) {
        return Err(format!("`spoilt={spoilt}`: expected a part of the logs, from 0 to 1").into());
    }
    let exchanges = named.get("exchanges").map(|file| exchanges(Path::new(file))).transpose()?.unwrap_or_default();
    let fleet = SimulatedFleet {
        seed: 1,
        sensor_scale: sensor_scale.parse()?,
        sample_rate_hz: rate.parse()?,
        manoeuvres: 1,
        drifts: vec![Drift { airframe: 2, parameter: "Cm_alpha".to_owned(), part_per_flight: drift.parse()? }],
        exchanges,
    };
    // Whether the log was spoilt.
    let write = |number: usize| -> Result<bool, String> {
        let (airframe, flight) = (number / flights, number % flights);
        let folder = Path::new(folder).join(format!("airframe-{airframe}"));
        let mut draws = Pcg64Mcg::seed_from_u64(number as u64);
        let manoeuvres = (fewest * (most / fewest).powf(draws.random::<f64>())).round() as u32;
        let fleet = SimulatedFleet { manoeuvres, ..fleet.clone() };
        let mut record = fleet.record(airframe, flight).map_err(|error| error.to_string())?;
        let spoilt = draws.random_bool(spoilt).then_some(number);
        if let Some(number) = spoilt {
            spoil::record(&mut record, number);
        }
        std::fs::create_dir_all(&folder).map_err(|error| error.to_string())?;
        let name = |ending: &str| folder.join(format!("flight-{:03}.{ending}", flight + 1));
        let format = formats[flight % formats.len()];
        let path = name(format.ending());
        match format {
            Format::Csv => csv::write_path(&record, &path).map_err(|error| error.to_string())?,
            Format::CsvOfCommands => {
                command(&mut record);
                csv::write_path(&record, &path).map_err(|error| error.to_string())?;
            }
            Format::Ulog => std::fs::write(&path, ulog::log(&record)).map_err(|error| error.to_string())?,
            Format::DataFlash => std::fs::write(&path, dataflash::log(&record)).map_err(|error| error.to_string())?,
        }
        if let Some(number) = spoilt {
            spoil::file(&path, number).map_err(|error| error.to_string())?;
        }
        Ok(spoilt.is_some())
    };
    let written: Vec<bool> = (0..airframes * flights).into_par_iter().map(write).collect::<Result<_, _>>()?;
    println!("{} logs, {} of them spoilt", written.len(), written.iter().filter(|spoilt| **spoilt).count());
    Ok(())
}

/// What a flight is written as.
#[derive(Clone, Copy)]
enum Format {
    /// The channels as they are.
    Csv,
    /// The command of the elevator in place of its deflection, as in the logs of the autopilots.
    CsvOfCommands,
    Ulog,
    DataFlash,
}

impl Format {
    fn ending(self) -> &'static str {
        match self {
            Self::Csv | Self::CsvOfCommands => "csv",
            Self::Ulog => "ulg",
            Self::DataFlash => "BIN",
        }
    }
}

/// Puts the command of the elevator, a pure number, in the place of its deflection.
fn command(record: &mut Record) {
    record.channels.retain_mut(|channel| match channel.name.as_str() {
        "elevator" => {
            let values = channel.values.iter().map(|deflection| deflection / autopilot::FULL_ELEVATOR).collect();
            *channel = Channel { name: "elevator_command".to_owned(), quantity: Quantity::Number, values };
            true
        }
        "thrust" => false,
        _ => true,
    });
}

/// The rows of a file of exchanged sensors.
fn exchanges(file: &Path) -> Result<Vec<Exchange>, Failure> {
    let text = std::fs::read_to_string(file)?;
    let row = |line: &str| -> Result<Exchange, Failure> {
        let cells: Vec<&str> = line.split(',').map(str::trim).collect();
        let [airframe, first_flight, channel, scale, zero_deg] = cells[..] else {
            return Err("expected airframe,first_flight,channel,scale,zero_deg".into());
        };
        let flight = first_flight.parse::<usize>()?.checked_sub(1).ok_or("flights are counted from 1")?;
        let zero = zero_deg.parse::<f64>()?.to_radians();
        Ok(Exchange { airframe: airframe.parse()?, flight, channel: channel.to_owned(), scale: scale.parse()?, zero })
    };
    let told = |line: &str| row(line).map_err(|error| format!("{}: `{line}`: {error}", file.display()).into());
    text.lines().skip(1).filter(|line| !line.trim().is_empty()).map(told).collect()
}
