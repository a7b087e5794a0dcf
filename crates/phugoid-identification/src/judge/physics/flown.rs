//! Checks of the forces that the flight shows: lift against weight, thrust against drag.

use phugoid_flight_data::record::Record;
use phugoid_flight_data::statistics::median;
use phugoid_flight_dynamics::atmosphere::Atmosphere;

use super::aircraft::Body;
use super::finding::reason;
use crate::core::estimation::VerdictReason;
use crate::core::term::{FACTORS, Variable};
use crate::methods::Task;
use crate::motion::Motion;

/// What was flown, in the middle of the record (medians). None where the flight does not have it.
#[derive(Clone, Debug, Default)]
pub(super) struct Flown {
    /// Lift coefficient from the specific forces, the mass and the dynamic pressure.
    pub(super) lift: Option<f64>,
    /// Drag coefficient from the same and the thrust.
    pub(super) drag: Option<f64>,
    /// Whether there was thrust.
    pub(super) powered: bool,
    /// True airspeed, m/s.
    pub(super) speed: Option<f64>,
    /// Mach number, from the airspeed and the standard atmosphere at the altitude, at sea level without one.
    pub(super) mach: Option<f64>,
    /// Largest size of the angle of attack, but for one sample in fifty, rad.
    pub(super) largest_alpha: Option<f64>,
    /// The variables of the terms, from the reference point.
    pub(super) variables: [f64; FACTORS],
}

impl Flown {
    pub(super) fn of<M: Motion<N, R>, const N: usize, const R: usize>(record: &Record, task: &Task<M, N, R>) -> Self {
        let Task { prepared, file, .. } = *task;
        let samples = prepared.time.len();
        let signal = |name: &str| -> Option<Vec<f64>> {
            let known = prepared.known.iter().find(|signal| signal.name == name).map(|signal| signal.values.clone());
            let row = M::AXES.outputs().iter().position(|o| o.name() == name && file.outputs[o.index()]);
            let values = known.or_else(|| row.map(|row| prepared.outputs.iter().map(|y| y[row]).collect()));
            values.filter(|values| values.len() == samples && values.iter().any(|v| v.is_finite()))
        };
        let middle = |values: &mut dyn Iterator<Item = f64>| {
            median(&mut values.filter(|v| v.is_finite()).collect::<Vec<f64>>()).filter(|v| v.is_finite())
        };
        let aircraft = &file.aircraft;
        let [speed, alpha, ax, az] = ["true_airspeed", "alpha", "ax", "az"].map(signal);
        let [density, mass, thrust] = ["air_density", "mass", "thrust"].map(signal);
        let mut flown = Self::default();
        if let (Some(speed), Some(alpha), Some(az), Some(density), Some(mass)) = (&speed, &alpha, &az, &density, &mass)
        {
            let (sin_t, cos_t) = aircraft.thrust_inclination.sin_cos();
            let at = |values: &Option<Vec<f64>>, k: usize| values.as_ref().map_or(0.0, |values| values[k]);
            // Aerodynamic force along body x and z over qbar S.
            let force = |k: usize| {
                let pressure = 0.5 * density[k] * speed[k] * speed[k] * aircraft.wing_area;
                let along = (mass[k] * at(&ax, k) - at(&thrust, k) * cos_t) / pressure;
                (along, (mass[k] * az[k] + at(&thrust, k) * sin_t) / pressure)
            };
            let lift = |k: usize| force(k).0 * alpha[k].sin() - force(k).1 * alpha[k].cos();
            let drag = |k: usize| -(force(k).0 * alpha[k].cos() + force(k).1 * alpha[k].sin());
            flown.lift = middle(&mut (0..samples).map(lift));
            // Without a thrust or a recorded forward acceleration there is no balance along the path. A lateral-directional
            // model needs no thrust, and one that it does not state is zero here.
            let stated = |thrust: &Vec<f64>| M::AXES.has_longitudinal() || thrust.iter().any(|t| *t > 0.0);
            let balanced = ax.is_some() && thrust.as_ref().is_some_and(stated);
            flown.drag = balanced.then(|| middle(&mut (0..samples).map(drag))).flatten();
        }
        flown.powered = thrust.as_ref().is_some_and(|thrust| thrust.iter().any(|t| *t > 0.0));
        let altitude = record.channel("altitude").and_then(|c| middle(&mut c.values.iter().copied()));
        let air = Atmosphere::Standard.at(altitude.unwrap_or(0.0).clamp(0.0, 20_000.0));
        flown.speed = speed.as_ref().and_then(|speed| middle(&mut speed.iter().copied()));
        flown.mach = flown.speed.map(|speed| speed / air.speed_of_sound);
        flown.largest_alpha = alpha.as_ref().and_then(|alpha| {
            let mut sizes: Vec<f64> = alpha.iter().map(|a| a.abs()).filter(|a| a.is_finite()).collect();
            sizes.sort_by(f64::total_cmp);
            sizes.get((0.98 * sizes.len() as f64) as usize).copied()
        });
        let typical = |name: &str| signal(name).and_then(|values| middle(&mut values.into_iter())).unwrap_or(0.0);
        let reference = &prepared.reference;
        for (variable, value) in [
            (Variable::Alpha, alpha.is_some().then(|| typical("alpha") - reference.alpha)),
            (Variable::Elevator, Some(typical("elevator") - reference.elevator)),
            (Variable::Aileron, Some(typical("aileron") - reference.aileron)),
            (Variable::Rudder, Some(typical("rudder") - reference.rudder)),
            (Variable::Airspeed, aircraft.reference_speed.map(|v0| typical("true_airspeed") / v0)),
        ] {
            flown.variables[variable.index()] = value.unwrap_or(0.0);
        }
        for (place, name) in file.extra_inputs.iter().enumerate() {
            flown.variables[Variable::ALL.len() + place] = typical(name);
        }
        flown
    }
}

/// Lift coefficients that a wing reaches with flaps, and that blown flaps and slats do not exceed (A. M. O. Smith,
/// *High-Lift Aerodynamics*, Journal of Aircraft 12, 1975: three-element airfoils 3 to 4).
const LIFT: [f64; 2] = [2.2, 4.5];

/// The lift coefficient that mass and specific force ask of the wing: a mass ten times too large, an area or a speed in
/// another unit show here.
pub(super) fn lift(flown: &Flown) -> Option<VerdictReason> {
    let lift = flown.lift.filter(|lift| lift.abs() > LIFT[0])?;
    Some(reason(
        lift.abs() > LIFT[1],
        &["[aircraft] mass", "[aircraft] wing_area", "true_airspeed", "az"],
        format!(
            "Check mass and wing_area under [aircraft], and the units of true_airspeed, az and the air density: mass times \
             normal specific force asks for a lift coefficient of {lift:.1} in the middle of the flight, and no wing \
             reaches {}.",
            if lift.abs() > LIFT[1] { LIFT[1] } else { LIFT[0] }
        ),
    ))
}

/// Least zero-lift drag coefficient: of a powered aeroplane, and of a glider; clean ones have twice as much (S. F.
/// Hoerner, *Fluid-Dynamic Drag*, 1965; F. Thomas, *Fundamentals of Sailplane Design*, 1999).
const ZERO_LIFT_DRAG: [f64; 2] = [0.008, 0.004];
/// Largest drag coefficient in flight without lift, everything extended.
const LARGEST_DRAG: f64 = 0.25;
/// Lift over drag of which no aeroplane that flies level has less, with everything extended: half of what a lifting body has (R. D. Reed, *Wingless
/// Flight*, NASA SP-4220, 1997: 3 to 4); and the lift coefficient from which on it is asked, for a fast one flies at little lift.
const LEAST_GLIDE: (f64, f64) = (2.0, 0.4);
/// Oswald's efficiency of a wing in a bad state.
const EFFICIENCY: f64 = 0.4;

/// The drag coefficient that thrust and specific force along the path leave: `CD = (T cos(alpha + s) - m (ax cos alpha +
/// az sin alpha)) / (qbar S)`. It is at least that of a smooth aeroplane with the induced drag of an elliptic lift
/// distribution, `CL^2 / (pi A)` (L. Prandtl 1918), so that a thrust in pounds read as newtons shows even where the path
/// is level.
pub(super) fn drag(flown: &Flown, body: &Body) -> Option<VerdictReason> {
    let (drag, lift) = (flown.drag?, flown.lift?);
    let induced = |efficiency: f64| {
        let ratio = body.aspect_ratio()?;
        Some(lift * lift / (std::f64::consts::PI * ratio * efficiency))
    };
    let smooth = if flown.powered { ZERO_LIFT_DRAG[0] } else { ZERO_LIFT_DRAG[1] };
    let least = smooth + induced(1.0).unwrap_or(0.0);
    let most = LARGEST_DRAG + induced(EFFICIENCY).unwrap_or(lift * lift);
    let most = if lift > LEAST_GLIDE.1 { most.min(lift / LEAST_GLIDE.0) } else { most };
    if (least..=most).contains(&drag) {
        return None;
    }
    let advice = match (drag < least, flown.powered) {
        (true, true) => {
            "thrust is too small (pounds read as newtons are 4.4 times too small), or ax or alpha have an offset"
        }
        (true, false) => "ax or alpha have an offset, or there was thrust that [aircraft] does not know",
        (false, _) => {
            "thrust is too large (newtons read as pounds are 4.4 times too large), or the mass is, or ax is wrong"
        }
    };
    Some(reason(
        drag < -least,
        &["[aircraft] thrust", "thrust", "ax"],
        format!(
            "Check thrust under [aircraft], and ax: thrust less mass times the specific force along the path leaves a drag \
             coefficient of {drag:.4} at a lift coefficient of {lift:.2}, and {least:.4} to {most:.2} is possible: {advice}."
        ),
    ))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::core::estimation::EstimationStatus;

    const WING: Body = Body {
        mass: 1034.0,
        ixx: None,
        iyy: 1913.0,
        izz: None,
        ixz: None,
        wing_area: 16.17,
        mean_chord: 1.494,
        wing_span: Some(10.91),
    };

    fn flown(lift: f64, drag: f64, powered: bool) -> Flown {
        Flown { lift: Some(lift), drag: Some(drag), powered, ..Flown::default() }
    }

    #[test]
    fn a_lift_that_no_wing_has_is_doubtful_and_then_refused() {
        assert_eq!(lift(&flown(1.8, 0.1, true)), None);
        assert_eq!(lift(&flown(3.1, 0.1, true)).unwrap().status, EstimationStatus::Doubtful);
        assert_eq!(lift(&flown(-6.0, 0.1, true)).unwrap().status, EstimationStatus::Refused);
        assert_eq!(lift(&Flown::default()), None);
    }

    #[test]
    fn a_drag_below_that_of_the_lift_alone_is_doubtful() {
        // The trim of JSBSim's c182, with its thrust, and with its thrust in pounds.
        assert_eq!(drag(&flown(0.311, 0.0383, true), &WING), None);
        assert_eq!(drag(&flown(0.311, 0.0383 / 4.448, true), &WING).unwrap().status, EstimationStatus::Doubtful);
        assert_eq!(drag(&flown(0.311, 0.0383 * 10.0, true), &WING).unwrap().status, EstimationStatus::Doubtful);
        assert_eq!(drag(&flown(0.311, -0.05, true), &WING).unwrap().status, EstimationStatus::Refused);
        // A business jet at the thrust of its take-off in pounds, read as 4.4 times as many newtons, and no span to tell the induced drag by.
        let no_span = Body { wing_span: None, ..WING };
        assert_eq!(drag(&flown(0.52, 0.37, true), &no_span).unwrap().status, EstimationStatus::Doubtful);
        assert_eq!(drag(&flown(0.52, 0.08, true), &no_span), None);
        // A sailplane has less than a powered aeroplane.
        let glider = Body { wing_span: Some(18.0), wing_area: 10.5, ..WING };
        assert_eq!(drag(&flown(0.5, 0.009, false), &glider), None);
        assert!(drag(&flown(0.5, 0.009, true), &glider).is_some());
        assert_eq!(drag(&Flown { drag: None, ..flown(0.5, 0.0, true) }, &WING), None);
    }
}
