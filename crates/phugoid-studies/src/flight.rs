//! Flying a scenario: from the trim to what the sensors say.

use std::collections::BTreeMap;

use phugoid_flight_data::quality::QualityReport;
use phugoid_flight_data::record::{Channel, Quantity, Record};
use phugoid_flight_dynamics::aircraft::{Aircraft, Controls};
use phugoid_flight_dynamics::f16::{F16, F16DataError, F16Options, F16Tables};
use phugoid_flight_dynamics::gust::{Gust, total_velocity};
use phugoid_flight_dynamics::increments::{IncrementChange, IncrementSchedule, Increments};
use phugoid_flight_dynamics::simulate::{CommandHold, Simulation, SimulationError, Trajectory, TrajectorySample};
use phugoid_flight_dynamics::trim::{Trim, TrimCondition, TrimError, trim};

use crate::constant_thrust::ConstantThrust;
use crate::manoeuvre::Surface;
use crate::scenario::{AircraftKind, Scenario, ScenarioError, Tables, Thrust};
use crate::sensing::measure;

/// A flown scenario.
#[derive(Clone, Debug)]
pub struct Flight {
    /// What the sensors measured, canonical channels in SI.
    pub measured: Record,
    /// What was true at the same times.
    pub truth: Record,
    /// The trim that the flight started in.
    pub trim: Trim,
    /// As [`Scenario::true_parameters`].
    pub true_parameters: BTreeMap<String, f64>,
}

/// Why a scenario could not be flown.
#[derive(Debug, thiserror::Error)]
pub enum FlightError {
    /// Something in the scenario.
    #[error(transparent)]
    Scenario(#[from] ScenarioError),
    /// The aircraft's data.
    #[error(transparent)]
    Aircraft(#[from] F16DataError),
    /// No trim.
    #[error("the scenario has no trim to start in: {0}")]
    Trim(#[from] TrimError),
    /// The motion diverges.
    #[error("{0}")]
    Simulation(#[from] SimulationError),
}

/// Angles of attack that the F-16's tables cover, deg (Stevens & Lewis, appendix A).
pub const F16_ALPHA_RANGE_DEG: [f64; 2] = [-10.0, 45.0];

/// Integration steps per sample: the half sample keeps the truncation error of the fastest actuator mode far below any
/// sensor's noise.
const SUBSTEPS: usize = 2;

/// Flies a scenario.
///
/// Commands are held over a sample; the recorded elevator is the surface, not the command, and without actuators the two
/// are the same. The measured airspeed and angles of attack and sideslip are those relative to the moving air.
///
/// # Errors
/// [`FlightError`]: no trim in this condition, a recorded input that cannot be read, a motion that diverges.
pub fn fly(scenario: &Scenario) -> Result<Flight, FlightError> {
    fly_with_progress(scenario, &|_| ())
}

/// As [`fly`]; `progress` is called with the fraction flown, 0 to 1.
///
/// # Errors
/// As [`fly`].
pub fn fly_with_progress(scenario: &Scenario, progress: &dyn Fn(f64)) -> Result<Flight, FlightError> {
    let AircraftKind::F16 = scenario.aircraft.kind;
    let tables = match scenario.aircraft.tables {
        Tables::Book => F16Tables::Book,
        Tables::Morelli => F16Tables::Morelli,
    };
    let aircraft = F16::new(F16Options { tables, cg: scenario.aircraft.cg, ..F16Options::default() })?;
    let condition = TrimCondition {
        flight_path_angle: scenario.condition.flight_path.si(),
        turn_rate: scenario.condition.turn_rate.si(),
        alpha_range: F16_ALPHA_RANGE_DEG.map(f64::to_radians),
        ..TrimCondition::level(scenario.condition.speed.si(), scenario.condition.altitude.si())
    };
    let trim = trim(&aircraft, &condition)?;
    let trajectory = match scenario.aircraft.thrust {
        Thrust::Engine => trajectory(scenario, &aircraft, &trim, progress)?,
        Thrust::Constant => {
            let frozen = ConstantThrust::at(&aircraft, trim.power_percent, trim.altitude_m, trim.mach);
            trajectory(scenario, &frozen, &trim, progress)?
        }
    };
    let thrust = |s: &TrajectorySample| match scenario.aircraft.thrust {
        Thrust::Engine => aircraft.propulsion(s.state.power, s.state.altitude, s.air.mach).force[0],
        Thrust::Constant => trim.thrust_n,
    };
    let truth = true_record(scenario, &trajectory, thrust);
    let measured = sense(&truth, scenario, scenario.seed)?;
    Ok(Flight { measured, truth, trim, true_parameters: scenario.true_parameters() })
}

/// What the scenario's sensors make of a true record, with a seed of their noise.
///
/// # Errors
/// [`FlightError::Scenario`] for a sensor that cannot be.
pub fn sense(truth: &Record, scenario: &Scenario, seed: u64) -> Result<Record, FlightError> {
    Ok(measure(truth, &scenario.sensors, seed, scenario.name.clone())?)
}

/// The motion from the trim, through commands, gusts and changing increments.
fn trajectory<A: Aircraft>(
    scenario: &Scenario,
    aircraft: &A,
    trim: &Trim,
    progress: &dyn Fn(f64),
) -> Result<Trajectory, FlightError> {
    let trim_controls = trim.controls();
    let sample_time = 1.0 / scenario.sample_rate.si();
    let time: Vec<f64> = (0..scenario.samples()).map(|k| k as f64 / scenario.sample_rate.si()).collect();
    // Deflections from trim of elevator, aileron and rudder at each sample.
    let mut deflections = [vec![0.0; time.len()], vec![0.0; time.len()], vec![0.0; time.len()]];
    for manoeuvre in &scenario.manoeuvre {
        let sum = match manoeuvre.surface() {
            Surface::Elevator => &mut deflections[0],
            Surface::Aileron => &mut deflections[1],
            Surface::Rudder => &mut deflections[2],
        };
        let added = manoeuvre.deflections(&time, scenario.seed, &scenario.folder)?;
        sum.iter_mut().zip(added).for_each(|(sum, added)| *sum += added);
    }
    let at = |t: f64| ((t * scenario.sample_rate.si() + 1e-6) as usize).min(time.len() - 1);
    let commands = |t: f64| {
        let k = at(t);
        if k % 1000 == 0 {
            progress(k as f64 / time.len() as f64);
        }
        Controls {
            throttle: trim_controls.throttle,
            elevator: trim_controls.elevator + deflections[0][k],
            aileron: trim_controls.aileron + deflections[1][k],
            rudder: trim_controls.rudder + deflections[2][k],
        }
    };
    let gusts: Vec<Gust> = scenario
        .gust
        .iter()
        .map(|g| Gust { axis: g.axis, amplitude: g.amplitude.si(), duration: g.duration.si(), delay: g.start.si() })
        .collect();
    let about = |i: &Increments| i.about(trim.alpha_rad, trim.q_rad_s, trim_controls.elevator);
    let start = IncrementChange { time: f64::NEG_INFINITY, increments: about(&scenario.increments) };
    let damage = scenario.damage.iter().map(|d| IncrementChange { time: d.at.si(), increments: about(&d.increments) });
    let increments = IncrementSchedule::new(std::iter::once(start).chain(damage).collect())
        .map_err(|e| ScenarioError::OutOfRange { place: scenario.name.clone(), message: e.to_string() })?;
    let simulation = Simulation {
        aircraft,
        initial: trim.state(),
        initial_surfaces: trim_controls,
        use_actuators: scenario.aircraft.actuators,
        increments,
        duration: (time.len() - 1) as f64 * sample_time,
        sample_time,
        substeps: SUBSTEPS,
        hold: CommandHold::Sample,
    };
    Ok(simulation.run(commands, |t| total_velocity(&gusts, t))?)
}

/// The trajectory as a record of canonical channels.
fn true_record(scenario: &Scenario, trajectory: &Trajectory, thrust: impl Fn(&TrajectorySample) -> f64) -> Record {
    type Get = fn(&TrajectorySample) -> f64;
    const CHANNELS: &[(&str, Quantity, Get)] = &[
        ("true_airspeed", Quantity::Speed, |s| s.air.speed),
        ("alpha", Quantity::Angle, |s| s.air.alpha),
        ("beta", Quantity::Angle, |s| s.air.beta),
        ("phi", Quantity::Angle, |s| s.state.phi),
        ("theta", Quantity::Angle, |s| s.state.theta),
        ("psi", Quantity::Angle, |s| s.state.psi),
        ("p", Quantity::AngularRate, |s| s.state.p),
        ("q", Quantity::AngularRate, |s| s.state.q),
        ("r", Quantity::AngularRate, |s| s.state.r),
        ("pdot", Quantity::AngularAcceleration, |s| s.angular_acceleration[0]),
        ("qdot", Quantity::AngularAcceleration, |s| s.angular_acceleration[1]),
        ("rdot", Quantity::AngularAcceleration, |s| s.angular_acceleration[2]),
        ("ax", Quantity::Acceleration, |s| s.specific_force[0]),
        ("ay", Quantity::Acceleration, |s| s.specific_force[1]),
        ("az", Quantity::Acceleration, |s| s.specific_force[2]),
        ("elevator", Quantity::Angle, |s| s.surfaces.elevator),
        ("aileron", Quantity::Angle, |s| s.surfaces.aileron),
        ("rudder", Quantity::Angle, |s| s.surfaces.rudder),
        ("throttle", Quantity::Number, |s| s.commands.throttle),
        ("altitude", Quantity::Length, |s| s.state.altitude),
        ("north", Quantity::Length, |s| s.state.north),
        ("east", Quantity::Length, |s| s.state.east),
        ("air_density", Quantity::Density, |s| s.air.density),
        ("dynamic_pressure", Quantity::Pressure, |s| s.air.dynamic_pressure),
        ("mach", Quantity::Number, |s| s.air.mach),
    ];
    let samples = &trajectory.samples;
    let mut channels: Vec<Channel> = CHANNELS
        .iter()
        .map(|(name, quantity, get)| Channel {
            name: (*name).to_owned(),
            quantity: *quantity,
            values: samples.iter().map(get).collect(),
        })
        .collect();
    channels.push(Channel {
        name: "thrust".to_owned(),
        quantity: Quantity::Force,
        values: samples.iter().map(thrust).collect(),
    });
    let quality = QualityReport {
        rows_read: samples.len(),
        rows_kept: samples.len(),
        sample_time_s: 1.0 / scenario.sample_rate.si(),
        ..QualityReport::default()
    };
    let source = format!("{} (truth)", scenario.name);
    Record { source, time: samples.iter().map(|s| s.time).collect(), channels, quality }
}
