//! The tables of the aerodynamics as they are in the files, shared by all configurations of an aircraft.

use std::path::Path;

use super::axis::Axis;
use super::damage::Damage;
use super::error::TransportError;
use super::read::{Document, Expected, Table};

/// rad per degree.
const DEGREE: f64 = std::f64::consts::PI / 180.0;
/// All six components, in the order of [`Coefficients`](phugoid_flight_dynamics::aircraft::Coefficients).
const SIX: [&str; 6] = ["CX", "CY", "CZ", "Cl", "Cm", "Cn"];
/// Components of the longitudinal motion.
const LONGITUDINAL: [&str; 3] = ["CX", "CZ", "Cm"];
/// Components of the lateral motion.
const LATERAL: [&str; 3] = ["CY", "Cl", "Cn"];
/// Damage cases.
pub(super) const CASES: usize = 6;

/// The tables; angles in rad, rates without dimension.
#[derive(Debug)]
pub(super) struct Tables {
    /// Angle of attack and sideslip of the basic table and of those of the surfaces.
    pub(super) alpha: Axis,
    pub(super) beta: Axis,
    /// (alpha, beta).
    pub(super) basic: Vec<[f64; 6]>,
    pub(super) symmetric_correction: Vec<[f64; 3]>,
    /// (alpha, beta, stabiliser, elevator); CX, CZ, Cm.
    pub(super) stabiliser_elevator: Vec<[f64; 3]>,
    pub(super) stabiliser: Axis,
    pub(super) elevator: Axis,
    /// (alpha, beta, surface).
    pub(super) aileron_right: Vec<[f64; 6]>,
    pub(super) aileron: Axis,
    pub(super) rudder_negative: Vec<[f64; 6]>,
    pub(super) rudder: Axis,
    pub(super) spoiler_right: Vec<[f64; 6]>,
    pub(super) spoiler: Axis,
    /// (alpha, up or down); CX, CZ, Cm.
    pub(super) landing_gear: Vec<[f64; 3]>,
    /// Per degree: left outboard, left inboard, right inboard, right outboard.
    pub(super) flaps: [[f64; 6]; 4],
    /// (alpha, rate): p and r CY, Cl, Cn; q CX, CZ, Cm.
    pub(super) oscillation: [Oscillation; 3],
    pub(super) rotary: Rotary,
    pub(super) damage: DamageTables,
    /// Mean chord over span.
    pub(super) chord_by_span: f64,
}

/// Increments by forced oscillation about one axis.
#[derive(Debug)]
pub(super) struct Oscillation {
    pub(super) alpha: Axis,
    pub(super) rate: Axis,
    pub(super) data: Vec<[f64; 3]>,
}

/// Increments by steady rotation about the velocity: (alpha, omega, beta).
#[derive(Debug)]
pub(super) struct Rotary {
    pub(super) alpha: Axis,
    pub(super) omega: Axis,
    pub(super) beta: Axis,
    pub(super) data: Vec<[f64; 6]>,
}

/// What damage changes.
#[derive(Debug)]
pub(super) struct DamageTables {
    pub(super) alpha: Axis,
    pub(super) beta: Axis,
    /// (alpha, beta, case).
    pub(super) increment: Vec<[f64; 6]>,
    /// Angle of attack of the factors on the increments by rates.
    pub(super) scale_alpha: Axis,
    /// (alpha, case, rate).
    pub(super) scale: Vec<[f64; 6]>,
    /// Angle of attack of the derivatives that are added.
    pub(super) rate_alpha: Axis,
    /// (alpha, case, rate), per dimensionless rate.
    pub(super) rate: Vec<[f64; 6]>,
}

/// The axes of a table, which its reader has found to be so many.
fn axes<const N: usize, const K: usize>(table: Table<K>) -> Option<([Axis; N], Vec<[f64; K]>)> {
    Some((table.axes.try_into().ok()?, table.data))
}

impl Tables {
    /// Reads the folder `tables` of an aircraft with this mean chord over its span.
    pub(super) fn read(folder: &Path, chord_by_span: f64) -> Result<Self, TransportError> {
        let degrees = || Expected::Numbers(DEGREE);
        let basic = Table::read(folder, "basic", &[("alpha_deg", degrees()), ("beta_deg", degrees())], SIX)?;
        let Some(([alpha, beta], basic)) = axes(basic) else { return Err(inconsistent(folder, "basic")) };
        // Tables with the axes of the basic one.
        let same = |name: &'static str, found: [&Axis; 2]| {
            if found == [&alpha, &beta] { Ok(()) } else { Err(inconsistent(folder, name)) }
        };
        let surface = |name: &'static str, axis: &'static str| {
            let expected = [("alpha_deg", degrees()), ("beta_deg", degrees()), (axis, degrees())];
            let table = Table::<6>::read(folder, name, &expected, SIX)?;
            let Some(([a, b, surface], data)) = axes(table) else { return Err(inconsistent(folder, name)) };
            same(name, [&a, &b])?;
            Ok((surface, data))
        };
        let (aileron, aileron_right) = surface("aileron_right", "aileron_deg")?;
        let (rudder, rudder_negative) = surface("rudder_negative", "rudder_deg")?;
        let (spoiler, spoiler_right) = surface("spoiler_right", "spoiler_deg")?;
        let name = "stabiliser_elevator";
        let expected =
            [("alpha_deg", degrees()), ("beta_deg", degrees()), ("stab_deg", degrees()), ("elevator_deg", degrees())];
        let table = Table::read(folder, name, &expected, LONGITUDINAL)?;
        let Some(([a, b, stabiliser, elevator], stabiliser_elevator)) = axes(table) else {
            return Err(inconsistent(folder, name));
        };
        same(name, [&a, &b])?;
        let name = "symmetric_correction";
        let table = Table::read(folder, name, &[("alpha_deg", degrees()), ("beta_deg", degrees())], LATERAL)?;
        let Some(([a, b], symmetric_correction)) = axes(table) else { return Err(inconsistent(folder, name)) };
        same(name, [&a, &b])?;
        let name = "landing_gear";
        let expected = [("alpha_deg", degrees()), ("gear", Expected::Words(&["up", "down"]))];
        let Some(([a], landing_gear)) = axes(Table::read(folder, name, &expected, LONGITUDINAL)?) else {
            return Err(inconsistent(folder, name));
        };
        same(name, [&a, &beta])?;
        let oscillation = |name: &'static str, rate: &'static str, components| {
            let expected = [("alpha_deg", degrees()), (rate, Expected::Numbers(1.0))];
            let Some(([alpha, rate], data)) = axes(Table::read(folder, name, &expected, components)?) else {
                return Err(inconsistent(folder, name));
            };
            Ok(Oscillation { alpha, rate, data })
        };
        Ok(Self {
            oscillation: [
                oscillation("forced_oscillation_p", "p_hat", LATERAL)?,
                oscillation("forced_oscillation_q", "q_hat", LONGITUDINAL)?,
                oscillation("forced_oscillation_r", "r_hat", LATERAL)?,
            ],
            rotary: rotary(folder)?,
            damage: damage(folder)?,
            flaps: flaps(folder)?,
            chord_by_span,
            alpha,
            beta,
            basic,
            symmetric_correction,
            stabiliser_elevator,
            stabiliser,
            elevator,
            aileron_right,
            aileron,
            rudder_negative,
            rudder,
            spoiler_right,
            spoiler,
            landing_gear,
        })
    }
}

fn inconsistent(folder: &Path, name: &str) -> TransportError {
    TransportError::Content {
        file: folder.join("tables").join(format!("{name}.json")),
        key: "axes".to_owned(),
        problem: "angle of attack and sideslip have to be those of basic.json".to_owned(),
    }
}

fn rotary(folder: &Path) -> Result<Rotary, TransportError> {
    let name = "rotary_balance";
    let expected = [
        ("alpha_deg", Expected::Numbers(DEGREE)),
        ("omega_hat", Expected::Numbers(1.0)),
        ("beta_deg", Expected::Numbers(DEGREE)),
    ];
    match axes(Table::read(folder, name, &expected, SIX)?) {
        Some(([alpha, omega, beta], data)) => Ok(Rotary { alpha, omega, beta, data }),
        None => Err(inconsistent(folder, name)),
    }
}

fn damage(folder: &Path) -> Result<DamageTables, TransportError> {
    let mut cases = [""; CASES];
    for (name, damage) in cases.iter_mut().zip(Damage::ALL.iter().skip(1)) {
        *name = damage.name_in_tables();
    }
    let alpha = || ("alpha_deg", Expected::Numbers(DEGREE));
    let name = "damage_static_increment";
    let expected = [alpha(), ("beta_deg", Expected::Numbers(DEGREE)), ("damage_case", Expected::Words(&cases))];
    let Some(([static_alpha, beta], increment)) = axes(Table::read(folder, name, &expected, SIX)?) else {
        return Err(inconsistent(folder, name));
    };
    let by_rate = |name: &'static str| {
        let expected = [alpha(), ("damage_case", Expected::Words(&cases)), ("rate", Expected::Words(&["p", "q", "r"]))];
        match axes(Table::read(folder, name, &expected, SIX)?) {
            Some(([alpha], data)) => Ok((alpha, data)),
            None => Err(inconsistent(folder, name)),
        }
    };
    let (scale_alpha, scale) = by_rate("damage_rate_scale")?;
    let (rate_alpha, rate) = by_rate("damage_rate_increment")?;
    Ok(DamageTables { alpha: static_alpha, beta, increment, scale_alpha, scale, rate_alpha, rate })
}

fn flaps(folder: &Path) -> Result<[[f64; 6]; 4], TransportError> {
    let document = Document::open(folder.join("tables/flaps.json"))?;
    let root = document.root();
    root.get("components")?.expect_texts(&SIX)?;
    let segment = |name: &str| root.get(name)?.vector();
    Ok([segment("left_outboard")?, segment("left_inboard")?, segment("right_inboard")?, segment("right_outboard")?])
}
