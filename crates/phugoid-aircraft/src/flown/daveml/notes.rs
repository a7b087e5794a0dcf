//! What is assumed of an aircraft in DAVE-ML, and which quantities its forces depend on.

use phugoid_flight_dynamics::actuator::{Actuator, Actuators};
use phugoid_flight_dynamics::aircraft::DataRange;

use super::air::{VARIABLES, flow, flow_of_thrust};
use super::feed::{Feed, Flow};
use super::wiring::Wiring;
use super::{Drive, ENGINE_LAG_S, FlownDaveml};
use crate::flown::options::Thrust;
use crate::flown::surface::{LAG_S, UNKNOWN_LIMIT};

/// The surfaces: place of the moment that each makes in the coefficients, and what a positive angle does in the equations of
/// motion.
const SURFACES: [(Feed, &str, usize, &str); 3] = [
    (Feed::Elevator, "elevator", 4, "lowers the nose"),
    (Feed::Aileron, "aileron", 3, "rolls to the left"),
    (Feed::Rudder, "rudder", 5, "yaws to the left"),
];
/// Place of the elevator among the variables of the flight; aileron and rudder follow.
const FIRST_SURFACE: usize = 8;
/// A flight in which nothing is special: 150 m/s at sea level, a little angle of attack.
const PLAIN: [f64; VARIABLES] = [150.0, 0.05, 0.0, 1.225, 0.44, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.3, 0.0];

pub(super) fn note_thrust(drive: &Drive, asked: Thrust, notes: &mut Vec<String>) {
    notes.push(match (drive, asked) {
        (Drive::Models(_), _) => {
            format!("Thrust follows the throttle, which is the share of the lever's way, with a lag of {ENGINE_LAG_S} s.")
        }
        (Drive::Force(largest), Thrust::AlongBodyX { .. }) => format!(
            "Thrust is a force along body x through the centre of gravity, {largest:.0} N at full throttle."
        ),
        (Drive::Force(largest), Thrust::Engines) => format!(
            "No model has a thrust: it is a force along body x through the centre of gravity, {largest:.0} N (half the weight) \
             at full throttle. Give its size by `largest_thrust`, or a file with thrustBodyForce_X by `with`."
        ),
    });
}

/// Limits of the surfaces with the stops to either side (lowest and highest deflection, rad), and the range of the tables.
pub(super) fn surfaces(wiring: &Wiring, notes: &mut Vec<String>) -> (Actuators, [[f64; 2]; 3], DataRange) {
    notes.push(format!("Surfaces follow their commands with a lag of {LAG_S} s and no limit of rate."));
    let ends = |feed: Feed| {
        let entries = wiring.entries(feed).filter_map(|entry| {
            let [a, b] = entry.model.table_ends(entry.position)?.map(|end| entry.si(end));
            Some([a.min(b), a.max(b)])
        });
        entries.reduce(|a, b| [a[0].min(b[0]), a[1].max(b[1])]).filter(|[low, high]| low < high)
    };
    let actuators = SURFACES.map(|(feed, name, ..)| {
        let stated = wiring.entry(feed).and_then(|entry| {
            let variable = entry.variable();
            variable.minimum.zip(variable.maximum).map(|(low, high)| [entry.si(low), entry.si(high)])
        });
        let known = stated.or_else(|| ends(feed)).map(|[a, b]| [a.min(b), a.max(b)]);
        let known = known.filter(|[low, high]| low < high && low.is_finite() && high.is_finite());
        let stops = known.unwrap_or_else(|| {
            if wiring.reads(feed) {
                let degrees = UNKNOWN_LIMIT.to_degrees();
                notes.push(format!("The files do not say how far the {name} goes: {degrees:.0} deg are taken."));
            }
            [-UNKNOWN_LIMIT, UNKNOWN_LIMIT]
        });
        let [low, high] = stops;
        let limit = low.abs().max(high.abs());
        // Tables of one side alone stand for both.
        let stops = if low < 0.0 && high > 0.0 { stops } else { [-limit, limit] };
        let [low, high] = stops;
        if (low + high).abs() > 1e-6 * limit {
            notes.push(format!(
                "In the file the {name} goes from {:.1} to {:.1} deg: a trim keeps to each side, and a simulation to the larger \
                 of the two on both.",
                low.to_degrees(),
                high.to_degrees()
            ));
        }
        (Actuator::new(limit, f64::INFINITY, LAG_S), stops)
    });
    let stops = actuators.map(|(_, stops)| stops);
    let [elevator, aileron, rudder] = actuators.map(|(actuator, _)| actuator);
    let standard = DataRange::UNSTATED;
    let range = DataRange {
        alpha: ends(Feed::Alpha).unwrap_or(standard.alpha),
        beta: standard.beta,
        elevator: ends(Feed::Elevator).unwrap_or(standard.elevator),
        aileron: ends(Feed::Aileron).unwrap_or(standard.aileron),
        rudder: ends(Feed::Rudder).unwrap_or(standard.rudder),
        ..standard
    };
    (Actuators { elevator, aileron, rudder }, stops, range)
}

/// Whether the coefficients follow the rate of the angle of attack, and sentences about what they and the thrust follow.
///
/// What a NaN in a quantity turns into NaN follows that quantity.
pub(super) fn dependence(aircraft: &FlownDaveml) -> (bool, Vec<String>) {
    let mut notes = Vec::new();
    let wiring = &aircraft.wiring;
    let still = flow(&PLAIN, wiring.reads(Feed::Altitude));
    let sound = aircraft.plain_of(&still, &PLAIN);
    let follows = |feed: Feed| {
        let mut without = still;
        without[feed as usize] = f64::NAN;
        let values = aircraft.plain_of(&without, &PLAIN);
        wiring.reads(feed) && values.iter().zip(sound).any(|(value, sound)| value.is_nan() && !sound.is_nan())
    };
    let slopes = aircraft.sloped(&PLAIN);
    for (place, (feed, name, moment, does)) in SURFACES.into_iter().enumerate() {
        if !follows(feed) {
            notes.push(format!("The aerodynamics know no {name}: it moves nothing."));
        } else if slopes[moment].derivatives[FIRST_SURFACE + place] > 0.0 {
            notes.push(format!(
                "A positive {name} {does} in the equations of motion, and in this file it does the opposite: it is taken as the \
                 file has it. Look at the attribute `sign` of its variable."
            ));
        }
    }
    if follows(Feed::BetaRate) {
        notes.push("The rate of the sideslip angle, which the aerodynamics read, is taken to be 0.".to_owned());
    }
    if follows(Feed::PitchAngle) {
        notes.push("The pitch angle, which the aerodynamics read, is taken to be the angle of attack.".to_owned());
    }
    if follows(Feed::Throttle) {
        notes.push("The aerodynamics see the throttle at once, without the lag of the thrust.".to_owned());
    }
    if let Drive::Models(outputs) = &aircraft.thrust {
        let parts = wiring.parts_of(outputs.all());
        let values = |flow: &Flow<f64>| {
            aircraft.plain.lend(
                || wiring.evaluators(),
                |evaluators| {
                    wiring.run(evaluators, flow, parts);
                    outputs.values(evaluators)
                },
            )
        };
        let plain = flow_of_thrust([50.0, 1000.0, 0.4]);
        let sound = values(&plain);
        let beside = [
            (Feed::Alpha, "angle of attack"),
            (Feed::Beta, "sideslip"),
            (Feed::RollRate, "roll rate"),
            (Feed::PitchRate, "pitch rate"),
            (Feed::YawRate, "yaw rate"),
            (Feed::Elevator, "elevator"),
            (Feed::Aileron, "aileron"),
            (Feed::Rudder, "rudder"),
        ];
        for (feed, name) in beside {
            let mut without = plain;
            without[feed as usize] = f64::NAN;
            if values(&without).iter().zip(sound).any(|(value, sound)| value.is_nan() && !sound.is_nan()) {
                notes.push(format!("The thrust, which reads the {name}, is that of axial flow: it is taken to be 0."));
            }
        }
    }
    (follows(Feed::AlphaRate), notes)
}
