//! What the sensors of a scenario make of a flight.

use phugoid_flight_data::quality::QualityReport;
use phugoid_flight_data::record::{Channel, Record};
use phugoid_flight_dynamics::sensors::{Sensor, SensorError, SensorSpecification};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

use crate::scenario::Sensors;

/// Channels that one frame of air data and inertial sensors brings; whole frames may be missing.
const FRAME: &[&str] =
    &["true_airspeed", "alpha", "beta", "phi", "theta", "psi", "p", "q", "r", "qdot", "ax", "ay", "az"];

/// Channels that are there in symmetric flight too, where all others stay at zero.
const LONGITUDINAL: &[&str] =
    &["true_airspeed", "alpha", "theta", "q", "ax", "az", "altitude", "elevator", "throttle", "thrust"];

/// Sensor of a channel; none for channels that no sensor measures.
fn specification(sensors: &Sensors, channel: &str) -> Option<SensorSpecification> {
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
        "qdot" => sensors.qdot?.specification(),
        "ax" => sensors.ax.specification(),
        "ay" => sensors.ay.specification(),
        "az" => sensors.az.specification(),
        "altitude" => sensors.altitude.specification(),
        "elevator" => sensors.elevator.specification(),
        "aileron" => sensors.aileron.specification(),
        "rudder" => sensors.rudder.specification(),
        // Known to the flight computer: its own command, and the engine's.
        "throttle" | "thrust" => SensorSpecification::default(),
        _ => return None,
    })
}

/// The record that the sensors make of the true one. The lateral channels of a flight in which they stay at zero are left
/// out, unless their sensors are named.
pub(crate) fn measure(truth: &Record, sensors: &Sensors, seed: u64, source: String) -> Result<Record, SensorError> {
    // Its own stream, so that dropping frames changes no sensor's noise.
    let mut random = Pcg64::seed_from_u64(seed ^ 0x6672_616d_6573);
    let dropped: Vec<bool> = truth.time.iter().map(|_| random.random::<f64>() < sensors.drops).collect();
    let mut channels = Vec::new();
    for (index, channel) in truth.channels.iter().enumerate() {
        let Some(specification) = specification(sensors, &channel.name) else { continue };
        let still = channel.values.iter().all(|v| v.abs() < 1e-12);
        let perfect = specification == SensorSpecification::default();
        if still && perfect && !LONGITUDINAL.contains(&channel.name.as_str()) {
            continue;
        }
        let mut values = Sensor::new(specification, seed, index)?.record(&truth.time, &channel.values)?;
        if FRAME.contains(&channel.name.as_str()) {
            values.iter_mut().zip(&dropped).filter(|(_, dropped)| **dropped).for_each(|(v, _)| *v = f64::NAN);
        }
        channels.push(Channel { name: channel.name.clone(), quantity: channel.quantity, values });
    }
    let rows = truth.time.len();
    let sample_time_s = truth.quality.sample_time_s;
    let quality = QualityReport { rows_read: rows, rows_kept: rows, sample_time_s, ..QualityReport::default() };
    Ok(Record { source, time: truth.time.clone(), channels, quality })
}
