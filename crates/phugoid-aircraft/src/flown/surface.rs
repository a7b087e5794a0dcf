//! How the angle of a surface gets into the properties that the aerodynamics of JSBSim read.

use phugoid_flight_dynamics::actuator::Actuator;

use super::error::FlownError;
use crate::jsbsim::{Aircraft, Follower, Scaling};

/// Time constant of a surface behind its command, s: an assumption, the same for every aircraft.
pub(super) const LAG_S: f64 = 0.05;
/// That of a surface whose drive the channels of the files have already, where they run, s: the shortest that the steps of a
/// simulation follow.
pub(super) const DRIVEN_LAG_S: f64 = 0.01;
/// Their names.
pub(super) const NAMES: [&str; 3] = ["elevator", "aileron", "rudder"];
/// Signs of the angles in JSBSim against those of the equations of motion.
pub(super) const SIGNS: [f64; 3] = [1.0, -1.0, 1.0];
/// Largest deflection where the files give none, rad.
pub(super) const UNKNOWN_LIMIT: f64 = 60.0 * DEGREE;
const DEGREE: f64 = std::f64::consts::PI / 180.0;

/// One surface: the properties that follow it, and its actuator.
#[derive(Clone, Debug)]
pub(crate) struct Surface {
    targets: Vec<Follower>,
    pub(super) actuator: Actuator,
    /// The lowest and the highest deflection in the sign of the equations of motion, rad.
    pub(super) stops: [f64; 2],
}

/// Names of the properties of a surface without their unit, each with its sign against the first.
const ELEVATOR: &[(&str, f64)] = &[("fcs/elevator-pos", 1.0)];
const AILERON: &[(&str, f64)] =
    &[("fcs/left-aileron-pos", 1.0), ("fcs/right-aileron-pos", -1.0), ("fcs/aileron-pos", 1.0)];
const RUDDER: &[(&str, f64)] = &[("fcs/rudder-pos", 1.0)];

/// Elevator, aileron and rudder; what is assumed of them is added to the notes.
///
/// JSBSim measures the aileron by the angle of the left one, positive with its trailing edge down, which rolls to the right.
/// A rudder is positive with its trailing edge to the left, and an elevator with it down, as in the equations of motion.
pub(super) fn surfaces(aircraft: &Aircraft, notes: &mut Vec<String>) -> Result<[Surface; 3], FlownError> {
    let [elevator, aileron, rudder] = [ELEVATOR, AILERON, RUDDER];
    Ok([
        surface(aircraft, NAMES[0], elevator, SIGNS[0], notes)?,
        surface(aircraft, NAMES[1], aileron, SIGNS[1], notes)?,
        surface(aircraft, NAMES[2], rudder, SIGNS[2], notes)?,
    ])
}

fn surface(
    aircraft: &Aircraft,
    name: &'static str,
    forms: &[(&str, f64)],
    sign: f64,
    notes: &mut Vec<String>,
) -> Result<Surface, FlownError> {
    let read = aircraft.aerodynamics_read();
    let mut targets = Vec::new();
    // From the sign of the equations of motion to that of JSBSim, and on to that of the property.
    let follower = |property, side, scaling| Follower { property, factors: [sign, side], scaling };
    let mut limits: Option<[f64; 2]> = None;
    for &(stem, side) in forms {
        let [radian, degree, share] = ["rad", "deg", "norm"].map(|unit| format!("{stem}-{unit}"));
        let magnitude = radian.replacen("fcs/", "fcs/mag-", 1);
        // The ends of the angle, if flight control gives them in radians or in degrees.
        let ends = [(&radian, 1.0), (&degree, DEGREE)]
            .into_iter()
            .find_map(|(property, factor)| Some(aircraft.scaling(property)?.range.map(|end| end * factor)))
            .filter(|[low, high]| low < high);
        if read.iter().any(|property| [&radian, &degree, &magnitude].iter().any(|form| form == property)) {
            if let Some(index) = aircraft.property(&radian) {
                targets.push(follower(index, side, None));
            } else if let Some(index) = aircraft.property(&degree) {
                let range = [-1.0 / DEGREE, 1.0 / DEGREE];
                let scaling = Scaling { input: (index, 1.0), domain: [-1.0, 1.0], range, centred: false };
                targets.push(follower(index, side, Some(scaling)));
            }
        }
        if let Some(index) = aircraft.property(&share).filter(|_| read.contains(&share.as_str())) {
            let own = aircraft.scaling(&share).filter(|own| aircraft.property(&radian) == Some(own.input.0));
            let by_ends = ends.map(|domain| Scaling { input: (index, 1.0), domain, range: [-1.0, 1.0], centred: true });
            let finite = |scaling: &Scaling| scaling.value(0.1).is_finite() && scaling.value(-0.1).is_finite();
            let Some(scaling) = own.or(by_ends).filter(finite) else {
                return Err(unmoved(aircraft, name, share));
            };
            targets.push(follower(index, side * scaling.input.1, Some(scaling)));
        }
        if !targets.is_empty() && limits.is_none() {
            limits = ends.map(|[low, high]| if side < 0.0 { [-high, -low] } else { [low, high] });
        }
    }
    if targets.is_empty() {
        if let Some(other) = read.iter().find(|property| property.starts_with("fcs/") && property.contains(name)) {
            return Err(unmoved(aircraft, name, (*other).to_owned()));
        }
        notes.push(format!("The aerodynamics know no {name}: it moves nothing."));
    }
    let limit = limits.map_or(UNKNOWN_LIMIT, |[low, high]| low.abs().max(high.abs()));
    match limits {
        Some([low, high]) if (low + high).abs() > 1e-6 * limit => notes.push(format!(
            "In JSBSim the {name} goes from {:.1} to {:.1} deg: a trim keeps to each side, and a simulation to the larger of \
             the two on both.",
            low.to_degrees(),
            high.to_degrees()
        )),
        Some(_) => {}
        None => {
            let degrees = limit.to_degrees();
            notes.push(format!("The files do not say how far the {name} goes: {degrees:.0} deg are taken."));
        }
    }
    let actuator = Actuator::new(limit, f64::INFINITY, LAG_S);
    let [low, high] = limits.unwrap_or([-limit, limit]);
    // The aileron of the equations of motion is the other way round.
    let stops = if sign < 0.0 { [-high, -low] } else { [low, high] };
    Ok(Surface { targets, actuator, stops })
}

/// The refusal of a property that a surface should move.
fn unmoved(aircraft: &Aircraft, surface: &'static str, property: String) -> FlownError {
    let (file, line) = aircraft.mentioned(&property).unwrap_or_default();
    FlownError::Surface { file, line, surface, property }
}

impl Surface {
    /// The properties that follow its angle in the sign of the equations of motion, rad.
    pub(super) fn followers(&self) -> &[Follower] {
        &self.targets
    }

    /// Whether it sets a property.
    pub(super) fn sets(&self, index: usize) -> bool {
        self.targets.iter().any(|target| target.property == index)
    }
}
