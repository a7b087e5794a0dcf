//! `fuel`: what is burnt, and what the aircraft weighs after it.

use phugoid_flight_data::quantity::Dimension;
use phugoid_flight_dynamics::fuel::Fuel;

use super::super::aircraft::{AircraftData, Source};
use super::super::error::ModelFileError;
use super::super::section::Section;
use super::engine::EngineData;

/// Fuel of an aircraft that is flown.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FuelData {
    /// Its mass, place and inertia at the beginning.
    pub fuel: Fuel,
    /// What is burnt.
    pub flow: FuelFlow,
    /// The least flow while the engine runs, kg/s.
    pub least_flow: f64,
}

/// What the flow of fuel is in proportion to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FuelFlow {
    /// kg/s for each newton of thrust.
    ByThrust(f64),
    /// kg/s for each watt of power.
    ByPower(f64),
}

/// The fuel of the table `[simulation]`; none if it says nothing of it.
pub(super) fn fuel(
    section: &Section,
    aircraft: &AircraftData,
    engine: Option<&EngineData>,
) -> Result<Option<FuelData>, ModelFileError> {
    let Some(inner) = section.section("fuel")? else { return Ok(None) };
    const KEYS: [&str; 8] = ["mass", "flow_by_thrust", "flow_by_power", "least_flow", "cg", "ixx", "iyy", "izz"];
    inner.allow("key", KEYS.into_iter())?;
    let mass = inner.required_positive("mass", Dimension::MASS)?;
    if let Source::Constant(whole) = aircraft.mass
        && mass >= whole
    {
        let message = format!(
            "`mass` is {mass} kg of fuel, and the aircraft with it weighs {whole} kg (mass in [aircraft]): it has to be less"
        );
        return Err(inner.error("mass", message));
    }
    let by_thrust = inner.positive("flow_by_thrust", Dimension::FUEL_BY_THRUST)?;
    let by_power = inner.positive("flow_by_power", Dimension::FUEL_BY_POWER)?;
    let flow = match (by_thrust, by_power) {
        (Some(flow), None) => FuelFlow::ByThrust(flow),
        (None, Some(flow)) => FuelFlow::ByPower(flow),
        (Some(_), Some(_)) => {
            return Err(inner.error("flow_by_power", "`flow_by_thrust` and `flow_by_power`: give one of them"));
        }
        (None, None) => {
            return Err(inner.missing("flow_by_thrust", "e.g. \"0.6 lb/lbf/h\"; or flow_by_power with a propeller"));
        }
    };
    if matches!(flow, FuelFlow::ByPower(_)) && !matches!(engine, Some(EngineData::Propeller(_))) {
        let message = "`flow_by_power` needs the power of [simulation.propeller]: give `flow_by_thrust`";
        return Err(inner.error("flow_by_power", message));
    }
    let aft = match (inner.number("cg", Dimension::NUMBER)?, aircraft.cg) {
        (None, _) => 0.0,
        (Some(fuel), Some(whole)) => (fuel - whole) * aircraft.mean_chord,
        (Some(_), None) => {
            let message = "`cg` of the fuel is beside that of the aircraft: give `cg` in [aircraft] too";
            return Err(inner.error("cg", message));
        }
    };
    let moment = |key: &str| inner.not_negative(key, Dimension::INERTIA).map(|moment| moment.unwrap_or(0.0));
    let fuel = Fuel { mass, aft, inertia: [moment("ixx")?, moment("iyy")?, moment("izz")?] };
    let least_flow = inner.not_negative("least_flow", Dimension::FUEL_FLOW)?.unwrap_or(0.0);
    Ok(Some(FuelData { fuel, flow, least_flow }))
}
