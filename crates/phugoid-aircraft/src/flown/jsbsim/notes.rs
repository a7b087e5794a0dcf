//! What the aerodynamics and engines of an aircraft of JSBSim read and nothing changes.

use super::drive::engines_flown;
use super::start::is_begun;
use crate::flown::options::FlownOptions;
use crate::flown::surface::Surface;
use crate::jsbsim::{Aircraft, Awaited, Evaluator};

/// Notes what the aerodynamics and the engines read and nothing changes; whether they read the rate of the angle of attack.
pub(super) fn note_inputs(
    aircraft: &Aircraft,
    surfaces: &[Surface; 3],
    evaluator: &mut Evaluator<'_>,
    options: &FlownOptions,
    notes: &mut Vec<String>,
) -> bool {
    let read = aircraft.aerodynamics_read();
    if read.iter().any(|name| name.starts_with("aero/betadot-")) {
        notes.push("The rate of the sideslip angle, which the aerodynamics read, is taken to be 0.".into());
    }
    if read.iter().any(|name| name.starts_with("propulsion/engine")) {
        notes.push("What the engines add to the aerodynamics is left out.".into());
    }
    let mut all = read.clone();
    let throttles = match engines_flown(aircraft, options.thrust) {
        None => Vec::new(),
        Some((throttles, _)) => {
            all.extend(aircraft.engines_read().into_iter().filter(|name| !read.contains(name)));
            throttles
        }
    };
    for name in all {
        let Some(index) = aircraft.property(name) else { continue };
        let moved = surfaces.iter().any(|surface| surface.sets(index)) || throttles.contains(&index);
        let angle = ["elevator-pos-", "aileron-pos-", "rudder-pos-"].iter().any(|word| name.contains(word));
        // The rates of the angles have notes of their own.
        if moved || angle || name.starts_with("aero/betadot-") {
            continue;
        }
        let value = evaluator.get(name).unwrap_or(f64::NAN);
        let of_control = name.starts_with("fcs/") || name.starts_with("gear/");
        let given = options.properties.iter().any(|(given, _)| aircraft.property(given) == Some(index));
        notes.push(match aircraft.awaited(index) {
            Some(Awaited::Channel) if options.flight_control && !given && !is_begun(name) => format!(
                "{name}, which a channel writes, stays at {value} for aerodynamics and engines: of what channels write they feel the \
                 surfaces alone."
            ),
            _ if of_control && !aircraft.is_computed(index) => format!("{name} stays at {value}."),
            None => continue,
            Some(Awaited::Channel) => {
                format!("{name}, which a channel would write, stays at {value}: no channel runs.")
            }
            Some(Awaited::LeftOut) => format!("{name}, which a part that is left out would write, stays at {value}."),
            Some(Awaited::Jsbsim) => format!("{name}, which JSBSim computes in flight, stays at {value}."),
        });
    }
    read.iter().any(|name| name.starts_with("aero/alphadot-"))
}
