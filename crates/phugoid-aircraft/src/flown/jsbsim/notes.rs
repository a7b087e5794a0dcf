//! What the aerodynamics of an aircraft of JSBSim read and nothing changes.

use crate::flown::surface::Surface;
use crate::jsbsim::{Aircraft, Evaluator};

/// Notes what the aerodynamics read and nothing changes; whether they read the rate of the angle of attack.
pub(super) fn note_inputs(
    aircraft: &Aircraft,
    surfaces: &[Surface; 3],
    evaluator: &mut Evaluator<'_>,
    given: &[(String, f64)],
    notes: &mut Vec<String>,
) -> bool {
    let read = aircraft.aerodynamics_read();
    if read.iter().any(|name| name.starts_with("aero/betadot-")) {
        notes.push("The rate of the sideslip angle, which the aerodynamics read, is taken to be 0.".into());
    }
    if read.iter().any(|name| name.starts_with("propulsion/engine")) {
        notes.push("What the engines add to the aerodynamics is left out.".into());
    }
    for name in read.iter().filter(|name| name.starts_with("fcs/") || name.starts_with("gear/")) {
        let Some(index) = aircraft.property(name) else { continue };
        let moved = surfaces.iter().any(|surface| surface.sets(index));
        let angle = ["elevator-pos-", "aileron-pos-", "rudder-pos-"].iter().any(|word| name.contains(word));
        if !moved && !angle {
            notes.push(format!("{name} stays at {}.", evaluator.get(name).unwrap_or(f64::NAN)));
        }
    }
    // Tanks and masses are read elsewhere; what flight control would make of its properties is made by nobody here.
    let of_control = |name: &str| name.starts_with("fcs/") || name.starts_with("gear/");
    for (name, _) in given.iter().filter(|(name, _)| of_control(name) && !read.contains(&name.as_str())) {
        notes.push(format!("{name} is set, and the aerodynamics do not read it: it changes none of their forces."));
    }
    read.iter().any(|name| name.starts_with("aero/alphadot-"))
}
