//! Writes the logs of a simulated fleet, one folder for each airframe:
//!
//!     cargo run -p phugoid-fleet --example simulated_fleet -- FOLDER AIRFRAMES FLIGHTS SENSOR_SCALE DRIFT \
//!         RATE_HZ MANOEUVRES [VANE_SCALE VANE_ZERO_DEG]
//!
//! `DRIFT` is the part of Cm_alpha that the airframe `airframe-2` gains with each flight: 0.0002 is 1 % in 50 flights. After half of
//! its flights the airframe `airframe-1` gets another vane, which shows so much more.

use std::path::Path;

use phugoid_fleet::simulated::{Drift, Exchange, SimulatedFleet};
use phugoid_flight_data::csv;
use rayon::prelude::*;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let [folder, airframes, flights, sensor_scale, drift, rate, manoeuvres, vane @ ..] = words.as_slice() else {
        return Err(
            "expected: FOLDER AIRFRAMES FLIGHTS SENSOR_SCALE DRIFT RATE_HZ MANOEUVRES [VANE_SCALE VANE_ZERO_DEG]"
                .into(),
        );
    };
    let (airframes, flights): (usize, usize) = (airframes.parse()?, flights.parse()?);
    let drift = Drift { airframe: 2, parameter: "Cm_alpha".to_owned(), part_per_flight: drift.parse()? };
    let (sample_rate_hz, manoeuvres) = (rate.parse()?, manoeuvres.parse()?);
    let exchanges = match vane {
        [] => Vec::new(),
        [scale, zero_deg] => vec![Exchange {
            airframe: 1,
            flight: flights / 2,
            channel: "alpha".to_owned(),
            scale: scale.parse()?,
            zero: zero_deg.parse::<f64>()?.to_radians(),
        }],
        _ => return Err("of the other vane its scale and its zero are expected".into()),
    };
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
