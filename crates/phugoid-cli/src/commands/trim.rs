//! `phugoid trim`.

use std::fmt::Write as _;

use phugoid::trim;
use phugoid_flight_dynamics::aircraft::Aircraft;
use phugoid_flight_dynamics::built_in::{self, BuiltInAircraft};
use phugoid_flight_dynamics::f16::F16Tables;
use phugoid_flight_dynamics::trim::{Trim, TrimCondition};
use serde::Serialize;

use crate::arguments::{self, AircraftName, FlightCondition, TablesName};
use crate::failure::Failure;
use crate::output::{Table, deliver, fixed, significant};

#[derive(Serialize)]
struct Document<'a> {
    aircraft: &'a str,
    tables: &'a str,
    cg: f64,
    #[serde(flatten)]
    trim: &'a Trim,
}

/// The aircraft that the command line names.
pub(crate) fn aircraft(condition: &FlightCondition) -> Result<BuiltInAircraft, Failure> {
    let name = match condition.aircraft {
        AircraftName::F16 => built_in::AircraftName::F16,
    };
    let tables = match condition.tables {
        TablesName::Book => F16Tables::Book,
        TablesName::Morelli => F16Tables::Morelli,
    };
    BuiltInAircraft::new(name, tables, condition.cg).map_err(Failure::impossible)
}

/// The trim of the aircraft in the given condition.
pub(crate) fn trimmed<A: Aircraft>(aircraft: &A, condition: &FlightCondition) -> Result<Trim, Failure> {
    let (speed, altitude) = (condition.speed.si(), condition.altitude.si());
    let (path, turn) = (condition.flight_path.si(), condition.turn_rate.si());
    Ok(trim(aircraft, &TrimCondition::steady(aircraft, speed, altitude, path, turn))?)
}

/// Names of the aircraft and its tables, as JSON documents contain them.
pub(crate) fn names(condition: &FlightCondition) -> (&'static str, &'static str) {
    let aircraft = match condition.aircraft {
        AircraftName::F16 => "f16",
    };
    let tables = match condition.tables {
        TablesName::Book => "book",
        TablesName::Morelli => "morelli",
    };
    (aircraft, tables)
}

pub(crate) fn run(arguments: &arguments::Trim) -> Result<(), Failure> {
    let condition = &arguments.condition;
    let trim = trimmed(&aircraft(condition)?, condition)?;
    let (aircraft, tables) = names(condition);
    let document = Document { aircraft, tables, cg: condition.cg, trim: &trim };
    let delivery = &arguments.delivery;
    deliver(&document, delivery.json, delivery.out.as_deref(), || text(&document))
}

fn text(document: &Document) -> String {
    let trim = document.trim;
    let mut table = Table::without_header();
    let mut row = |name: &str, value: String, unit: &str| {
        table.row([name.to_owned(), value, unit.to_owned()]);
    };
    let degrees = |angle: f64| fixed(angle.to_degrees(), 5);
    row("angle of attack", degrees(trim.alpha_rad), "deg");
    row("sideslip", degrees(trim.beta_rad), "deg");
    row("bank angle", degrees(trim.phi_rad), "deg");
    row("pitch angle", degrees(trim.theta_rad), "deg");
    row("elevator", degrees(trim.elevator_rad), "deg");
    row("aileron", degrees(trim.aileron_rad), "deg");
    row("rudder", degrees(trim.rudder_rad), "deg");
    row("throttle", format!("{:.5}", trim.throttle), "-");
    row("engine power", format!("{:.4}", trim.power_percent), "%");
    row("thrust", format!("{:.2}", trim.thrust_n), "N");
    row("roll rate", degrees(trim.p_rad_s), "deg/s");
    row("pitch rate", degrees(trim.q_rad_s), "deg/s");
    row("yaw rate", degrees(trim.r_rad_s), "deg/s");
    row("load factor", format!("{:.5}", trim.load_factor), "-");
    row("dynamic pressure", format!("{:.2}", trim.dynamic_pressure_pa), "Pa");
    row("Mach number", format!("{:.5}", trim.mach), "-");
    row("trim index", format!("{:.2e}", trim.trim_index), "-");
    let mut text = title(document.aircraft, document.tables, document.cg, trim);
    // Writing to a string cannot fail.
    let _ = write!(text, "\n{}", table.render());
    text
}

/// The first line of the text about a trim.
pub(crate) fn title(aircraft: &str, tables: &str, cg: f64, trim: &Trim) -> String {
    let mut text = format!(
        "{aircraft} ({tables} tables), cg at {cg} of the mean chord: {} m/s at {} m",
        significant(trim.speed_m_s, 5),
        significant(trim.altitude_m, 5)
    );
    if trim.flight_path_angle_rad != 0.0 {
        let _ = write!(text, ", climbing {} deg", significant(trim.flight_path_angle_rad.to_degrees(), 4));
    }
    if trim.turn_rate_rad_s != 0.0 {
        let _ = write!(text, ", turning {} deg/s", significant(trim.turn_rate_rad_s.to_degrees(), 4));
    }
    text.push('\n');
    text
}
