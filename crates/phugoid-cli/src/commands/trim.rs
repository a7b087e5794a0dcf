//! `phugoid trim`.

use std::fmt::Write as _;

use phugoid::trim;
use phugoid_aircraft::flown::{FlownOptions, Thrust};
use phugoid_flight_dynamics::aircraft::Aircraft;
use phugoid_flight_dynamics::built_in::AircraftName;
use phugoid_flight_dynamics::f16::F16Tables;
use phugoid_flight_dynamics::trim::{Trim, TrimCondition};
use phugoid_identification::model_file::ModelFile;
use phugoid_simulation::aircraft::{AircraftError, AnyAircraft};
use phugoid_simulation::scenario::nearest;
use serde::Serialize;

use crate::arguments::{self, AircraftChoice, FlightCondition, TablesName};
use crate::failure::Failure;
use crate::output::{Table, deliver, fixed, notes_text, significant};

#[derive(Serialize)]
struct Document<'a> {
    #[serde(flatten)]
    aircraft: &'a Described,
    #[serde(flatten)]
    trim: &'a Trim,
}

/// What a document says of the aircraft.
#[derive(Serialize)]
pub(crate) struct Described {
    aircraft: String,
    /// Aerodynamic tables of the F-16; not there for other aircraft.
    #[serde(skip_serializing_if = "Option::is_none")]
    tables: Option<&'static str>,
    /// Centre of gravity, fraction of the mean aerodynamic chord; not there for a model file that does not say it.
    #[serde(skip_serializing_if = "Option::is_none")]
    cg: Option<f64>,
    /// What the file asks for and is left out, and what is assumed.
    #[serde(skip_serializing_if = "<[_]>::is_empty")]
    notes: Vec<String>,
}

impl Described {
    fn of(aircraft: &AnyAircraft, choice: &AircraftChoice) -> Self {
        let tables = matches!(aircraft, AnyAircraft::BuiltIn(_)).then(|| match choice.tables {
            None | Some(TablesName::Book) => "book",
            Some(TablesName::Morelli) => "morelli",
        });
        Self {
            aircraft: aircraft.name().to_owned(),
            tables,
            cg: aircraft.centre_of_gravity(),
            notes: aircraft.notes().to_vec(),
        }
    }

    /// The notes as lines of text after a result; empty without any.
    pub(crate) fn notes_text(&self) -> String {
        let text = notes_text(&self.notes);
        if text.is_empty() { text } else { format!("\n{text}") }
    }
}

/// The aircraft that the command line names, and what documents say of it.
pub(crate) fn aircraft(choice: &AircraftChoice) -> Result<(AnyAircraft, Described), Failure> {
    let aircraft = opened(choice)?;
    let described = Described::of(&aircraft, choice);
    Ok((aircraft, described))
}

fn opened(choice: &AircraftChoice) -> Result<AnyAircraft, Failure> {
    let wanted = choice.aircraft.as_str();
    let refuse = |option: &str, of: &str| {
        Err(Failure::input(format!(
            "{option} has a meaning for {of} alone, and the aircraft is `{wanted}`: leave it out"
        )))
    };
    if wanted == AircraftName::F16.word() {
        if !choice.properties.is_empty() {
            return refuse("--property", "an aircraft of JSBSim or in DAVE-ML");
        }
        if choice.largest_thrust.is_some() {
            return refuse("--largest-thrust", "an aircraft of JSBSim or in DAVE-ML");
        }
        if !choice.with.is_empty() {
            return refuse("--with", "an aircraft in DAVE-ML");
        }
        if choice.damaged.is_some() {
            return refuse("--damaged", "the Generic Transport Model");
        }
        return AnyAircraft::f16(tables(choice), choice.cg).map_err(Failure::impossible);
    }
    if choice.tables.is_some() {
        return refuse("--tables", "the F-16");
    }
    if choice.cg.is_some() {
        return refuse("--cg", "the F-16");
    }
    AnyAircraft::open(wanted, &options(choice)).map_err(|error| not_opened(wanted, &error))
}

/// The tables of the F-16 that the command line names.
pub(crate) fn tables(choice: &AircraftChoice) -> Option<F16Tables> {
    choice.tables.map(|tables| match tables {
        TablesName::Book => F16Tables::Book,
        TablesName::Morelli => F16Tables::Morelli,
    })
}

/// What the command line says of an aircraft beside its file.
pub(crate) fn options(choice: &AircraftChoice) -> FlownOptions {
    FlownOptions {
        thrust: choice.largest_thrust.map_or(Thrust::Engines, |force| Thrust::AlongBodyX { largest_n: force.si() }),
        properties: choice.properties.clone(),
        with: choice.with.clone(),
        damage: choice.damaged.unwrap_or_default(),
        ..FlownOptions::default()
    }
}

fn not_opened(wanted: &str, error: &AircraftError) -> Failure {
    if std::path::Path::new(wanted).exists() {
        return Failure::input(error);
    }
    let names = ModelFile::BUILT_IN.iter().map(|(name, _)| *name).chain([AircraftName::F16.word()]);
    if let Some(near) = nearest(wanted, names) {
        return Failure::input(format!("{error}\nThere is no built-in aircraft `{wanted}`: did you mean `{near}`?"));
    }
    Failure::input(format!(
        "{error}\n`{wanted}` is neither f16, nor a built-in model, nor a file or a folder: --aircraft takes a model file \
         (.toml), an aircraft of JSBSim (its folder, or the XML file in it), a model in DAVE-ML (.dml), or the folder of NASA's \
         Generic Transport Model"
    ))
}

/// The trim of the aircraft in the given condition.
pub(crate) fn trimmed<A: Aircraft>(aircraft: &A, condition: &FlightCondition) -> Result<Trim, Failure> {
    let (speed, altitude) = (condition.speed.si(), condition.altitude.si());
    let (path, turn) = (condition.flight_path.si(), condition.turn_rate.si());
    Ok(trim(aircraft, &TrimCondition::steady(aircraft, speed, altitude, path, turn))?)
}

pub(crate) fn run(arguments: &arguments::Trim) -> Result<(), Failure> {
    let condition = &arguments.condition;
    let (aircraft, described) = aircraft(&condition.aircraft)?;
    let trim = trimmed(&aircraft, condition)?;
    let document = Document { aircraft: &described, trim: &trim };
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
    let mut text = title(document.aircraft, trim);
    // Writing to a string cannot fail.
    let _ = write!(text, "\n{}{}", table.render(), document.aircraft.notes_text());
    text
}

/// The first line of the text about a trim.
pub(crate) fn title(aircraft: &Described, trim: &Trim) -> String {
    let tables = aircraft.tables.map_or_else(String::new, |tables| format!(" ({tables} tables)"));
    let cg =
        aircraft.cg.map(|cg| format!(", cg at {} of the mean chord", (cg * 1e4).round() / 1e4)).unwrap_or_default();
    let mut text = format!(
        "{}{tables}{cg}: {} m/s at {} m",
        aircraft.aircraft,
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
