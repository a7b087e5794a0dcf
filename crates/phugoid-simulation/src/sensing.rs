//! What the sensors of a scenario make of a flight.

use phugoid_flight_data::quality::QualityReport;
use phugoid_flight_data::record::{Channel, Record};
use phugoid_flight_dynamics::sensors::{Sensor, SensorError, SensorSpecification};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

use crate::mounting::at_the_sensors;
use crate::scenario::{ModelError, RecordedSurfaces, ScenarioError, Sensors};

/// Channels that one frame of air data and inertial sensors brings; whole frames may be missing.
const FRAME: &[&str] =
    &["true_airspeed", "alpha", "beta", "phi", "theta", "psi", "p", "q", "r", "pdot", "qdot", "rdot", "ax", "ay", "az"];

/// Whether a channel comes in the frame of air data and inertial sensors, which may be missing as a whole.
pub fn is_framed(channel: &str) -> bool {
    FRAME.contains(&channel)
}

/// The stream that decides which frames of a flight are missing: its own, so that dropping frames changes no sensor's noise.
pub fn frame_stream(seed: u64) -> Pcg64 {
    Pcg64::seed_from_u64(seed ^ 0x6672_616d_6573)
}

/// Channels that are there in symmetric flight too, where all others stay at zero. Those of a satellite receiver are only
/// measured where they are named.
const LONGITUDINAL: &[&str] = &[
    "true_airspeed",
    "alpha",
    "theta",
    "q",
    "ax",
    "az",
    "altitude",
    "elevator",
    "throttle",
    "thrust",
    "mass",
    "north",
    "east",
    "ground_speed",
];

/// Sensor of a channel; none for channels that no sensor measures.
pub fn specification(sensors: &Sensors, channel: &str) -> Option<SensorSpecification> {
    Some(match channel {
        "true_airspeed" => sensors.true_airspeed.specification(),
        "alpha" => sensors.alpha.specification(),
        "beta" => sensors.beta.specification(),
        "phi" => sensors.phi.specification(),
        "theta" => sensors.theta.specification(),
        "psi" => sensors.psi.specification(),
        "p" => sensors.p.specification(),
        "q" => sensors.q.specification(),
        "r" => sensors.r.specification(),
        "pdot" => sensors.pdot?.specification(),
        "qdot" => sensors.qdot?.specification(),
        "rdot" => sensors.rdot?.specification(),
        "ax" => sensors.ax.specification(),
        "ay" => sensors.ay.specification(),
        "az" => sensors.az.specification(),
        "altitude" => sensors.altitude.specification(),
        "north" => sensors.north?.specification(),
        "east" => sensors.east?.specification(),
        "ground_speed" => sensors.ground_speed?.specification(),
        "elevator" => sensors.elevator.specification(),
        "aileron" => sensors.aileron.specification(),
        "rudder" => sensors.rudder.specification(),
        // Known to the flight computer: its own command, the engine's thrust, and what the tanks hold.
        "throttle" | "thrust" | "mass" => SensorSpecification::default(),
        _ => return None,
    })
}

/// The record that the sensors make of the true one. The lateral channels of a flight in which they stay at zero are left
/// out, unless their sensors or, of surfaces, a manoeuvre (of amplitude zero) are `named` in the scenario.
pub(crate) fn measure(
    truth: &Record,
    sensors: &Sensors,
    named: &[&str],
    error: &ModelError,
    seed: u64,
    source: String,
) -> Result<Record, ScenarioError> {
    let mut random = frame_stream(seed);
    let dropped: Vec<bool> = truth.time.iter().map(|_| random.random::<f64>() < sensors.drops).collect();
    let there = at_the_sensors(truth, sensors);
    let mut channels = Vec::new();
    for (index, channel) in truth.channels.iter().enumerate() {
        let name = channel.name.as_str();
        let Some(specification) = specification(sensors, name) else { continue };
        let recorded = match error.surfaces {
            RecordedSurfaces::Commanded => command_channel(name).and_then(|command| truth.channel(command)),
            RecordedSurfaces::Measured => None,
        };
        let felt = there.iter().find(|(moved, _)| *moved == name).map(|(_, values)| values.as_slice());
        let values = felt.unwrap_or(&recorded.unwrap_or(channel).values);
        let still = values.iter().all(|v| v.abs() < 1e-12);
        let perfect = specification == SensorSpecification::default();
        if still && perfect && !LONGITUDINAL.contains(&name) && !named.contains(&name) {
            continue;
        }
        let mut values = Sensor::new(specification, seed, index)
            .and_then(|mut sensor| sensor.record(&truth.time, values))
            .map_err(|error| ScenarioError::OutOfRange { place: source.clone(), message: told(name, error) })?;
        if is_framed(name) {
            values.iter_mut().zip(&dropped).filter(|(_, dropped)| **dropped).for_each(|(v, _)| *v = f64::NAN);
        }
        if name == "thrust" && error.thrust != 0.0 {
            values.iter_mut().for_each(|v| *v *= 1.0 + error.thrust);
        }
        channels.push(Channel { name: channel.name.clone(), quantity: channel.quantity, values });
    }
    let rows = truth.time.len();
    let sample_time_s = truth.quality.sample_time_s;
    let quality = QualityReport { rows_read: rows, rows_kept: rows, sample_time_s, ..QualityReport::default() };
    Ok(Record { source, time: truth.time.clone(), channels, quality })
}

/// The channel of the true record that holds the command of a surface.
pub(crate) fn command_channel(surface: &str) -> Option<&'static str> {
    match surface {
        "elevator" => Some("elevator_command"),
        "aileron" => Some("aileron_command"),
        "rudder" => Some("rudder_command"),
        _ => None,
    }
}

/// The sensor's complaint under the name that its channel has in the scenario file.
fn told(channel: &str, error: SensorError) -> String {
    match error {
        SensorError::Specification { field, value, expected, .. } => {
            format!("`sensors.{channel}`: {field} is {value} in SI units, expected {expected}")
        }
        other => format!("`sensors.{channel}`: {other}"),
    }
}
