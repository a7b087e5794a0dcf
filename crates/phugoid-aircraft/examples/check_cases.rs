//! Flies the check cases and prints the table of `docs/check-cases.md`, how the flights compare with those of NASA's
//! simulators:
//!
//! `cargo run --release -p phugoid-aircraft --example check_cases -- FOLDER [--runge-kutta] [--adams-bashforth] [--all] [--save FOLDER] [CASE...]`
//!
//! with the folder of `cases.json` and `trajectories`. `--runge-kutta` and `--adams-bashforth` integrate every case in this way, `--all` gives every column in place of the worst of each quantity,
//! `--save` writes the flights as comma-separated text. The program fails if a flight cannot be flown.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)] // a program to be read

#[path = "../tests/simulators/mod.rs"]
mod simulators;

use std::path::{Path, PathBuf};

use phugoid_aircraft::check_case::CheckCases;
use phugoid_aircraft::check_case::compare::{Comparison, MARGIN, compare};
use phugoid_flight_dynamics::globe::flight::Integration;

/// Quantities of the table, and how the headings of their columns begin.
const QUANTITIES: [(&str, &str); 20] = [
    ("inertial position, ft", "eiPosition"),
    ("earth-fixed position, ft", "gePosition"),
    ("inertial velocity, ft/s", "eiVelocity"),
    ("velocity over the ground, ft/s", "feVelocity"),
    ("altitude, ft", "altitudeMsl"),
    ("longitude, deg", "longitude"),
    ("latitude, deg", "latitude"),
    ("gravitation, ft/s2", "localGravity"),
    ("yaw, pitch, roll, deg", "eulerAngle"),
    ("inertial body rates, deg/s", "bodyAngularRate"),
    ("climb, ft/min", "altitudeRate"),
    ("speed of sound, ft/s", "speedOfSound"),
    ("density, slug/ft3", "airDensity"),
    ("pressure, lbf/ft2", "ambientPressure"),
    ("temperature, deg R", "ambientTemperature"),
    ("aerodynamic force, lbf", "aero_bodyForce"),
    ("aerodynamic moment, ft lbf", "aero_bodyMoment"),
    ("Mach number", "mach"),
    ("dynamic pressure, lbf/ft2", "dynamicPressure"),
    ("true airspeed, kt", "trueAirspeed"),
];

fn print(id: &str, title: &str, quantity: &str, c: &Comparison) {
    let verdict = if c.largest() <= c.spread {
        "yes".to_owned()
    } else if c.agrees() {
        let share = c.largest() / c.spread - 1.0;
        if share <= MARGIN { format!("within {:.1} %", 100.0 * share) } else { "rounding".to_owned() }
    } else {
        format!("no: {:.2} times", c.largest() / c.spread)
    };
    let numbers = format!("{:.2e} | {:.2e} | {:.2e}", c.closest(), c.largest(), c.spread);
    println!("| {id} | {title} | {quantity} | {numbers} | {verdict} |");
}

fn main() {
    let mut arguments = std::env::args().skip(1);
    let folder = PathBuf::from(arguments.next().expect("the folder of `cases.json`"));
    let (mut all, mut save, mut wanted) = (false, None, Vec::new());
    let mut integration = None;
    while let Some(argument) = arguments.next() {
        match argument.as_str() {
            "--all" => all = true,
            "--runge-kutta" => integration = Some(Integration::RungeKutta4),
            "--adams-bashforth" => integration = Some(Integration::AdamsBashforth2),
            "--save" => save = Some(PathBuf::from(arguments.next().expect("a folder after --save"))),
            _ => wanted.push(argument),
        }
    }
    let cases = CheckCases::read(&folder.join("cases.json")).expect("definitions");
    println!("| case | what it is | quantity | closest simulator | farthest simulator | between simulators | inside |");
    println!("|---|---|---|---|---|---|---|");
    for id in cases.ids().into_iter().filter(|id| wanted.is_empty() || wanted.contains(id)) {
        let case = cases.case(&id).expect("a definition");
        let flight = case.fly_by(integration.unwrap_or(case.integration())).expect("a flight");
        if let Some(save) = &save {
            let file: &Path = &save.join(format!("Atmos_{id}_sim_phugoid.csv"));
            std::fs::write(file, flight.to_csv()).expect("a writable folder");
        }
        let comparisons = compare(&flight, &simulators::simulators(&folder, &id));
        let mut title = case.title.as_str();
        for (quantity, start) in QUANTITIES {
            let columns = comparisons.iter().filter(|c| c.heading.starts_with(start));
            if all {
                columns.for_each(|c| print(&id, "", c.heading, c));
                continue;
            }
            let worst = columns.max_by(|a, b| (a.largest() / a.mark()).total_cmp(&(b.largest() / b.mark())));
            // A quantity that is zero in every simulator and in the flight says nothing.
            if let Some(c) = worst.filter(|c| c.size > 0.0) {
                print(&id, std::mem::take(&mut title), quantity, c);
            }
        }
    }
}
