//! What the difference between two aircraft amounts to in the words of an estimator: constants, derivatives and couplings.

use std::collections::BTreeMap;

use phugoid_flight_dynamics::aircraft::{AirData, Aircraft, Coefficients, Controls};
use phugoid_flight_dynamics::increments::{Increments, lift_drag_to_body};
use phugoid_flight_dynamics::scalar::{Dual, Scalar};
use phugoid_flight_dynamics::trim::Trim;

use crate::damaged::{COEFFICIENTS, Damaged, VARIABLES};

/// Eight variables of the build-up.
type Slopes = Dual<8>;

/// Coefficients and their derivatives at a trim, by name: `Cm_0`, `Cm_alpha`, `Cl_p`, ... and those with respect to variables of the
/// other axes; lift and drag in stability axes, the others in body axes, angles in rad, rates made dimensionless.
///
/// ```
/// use phugoid_simulation::equivalent::derivatives;
/// use phugoid_simulation::flight::trimmed_aircraft;
/// use phugoid_simulation::scenario::Scenario;
///
/// let (aircraft, trim) = trimmed_aircraft(&Scenario::named("f16-calm")?)?;
/// let found = derivatives(aircraft.as_ref(), &trim);
/// assert!(found["CL_alpha"] > 3.0 && found["Cm_q"] < -4.0 && found["Cm_beta"].abs() < 1e-9);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn derivatives(aircraft: &impl Aircraft, trim: &Trim) -> BTreeMap<String, f64> {
    apparent_derivatives(aircraft, trim, &Increments::NONE, |c| c)
}

/// As [`derivatives`], of the coefficients that `apparent` makes of those of the aircraft with increments.
fn apparent_derivatives(
    aircraft: &impl Aircraft,
    trim: &Trim,
    increments: &Increments,
    apparent: impl Fn(Coefficients<Slopes>) -> Coefficients<Slopes>,
) -> BTreeMap<String, f64> {
    const RATES: [usize; 3] = [2, 3, 4];
    let variable = |value: f64, index: usize| Slopes::variable(value, index);
    let alpha = variable(trim.alpha_rad, 0);
    let local = aircraft.atmosphere().at(trim.altitude_m);
    let speed = trim.mach * local.speed_of_sound;
    let air = AirData {
        speed: Dual::from(speed),
        alpha,
        beta: variable(trim.beta_rad, 1),
        density: Dual::from(local.density),
        dynamic_pressure: Dual::from(0.5 * local.density * speed * speed),
        mach: Dual::from(trim.mach),
    };
    let rates = [trim.p_rad_s, trim.q_rad_s, trim.r_rad_s];
    let rates: [Slopes; 3] = std::array::from_fn(|i| variable(rates[i], RATES[i]));
    let at = trim.controls();
    let controls = Controls {
        throttle: Dual::from(at.throttle),
        elevator: variable(at.elevator, 5),
        aileron: variable(at.aileron, 6),
        rudder: variable(at.rudder, 7),
    };
    let (sine, cosine) = alpha.sin_cos();
    let geometry = aircraft.geometry();
    let (chord_time, span_time) = (geometry.mean_chord / (2.0 * speed), geometry.span / (2.0 * speed));
    let mut c = aircraft.coefficients(&air, rates, &controls);
    let [lift, drag, pitch] = increments.longitudinal(alpha, Dual::from(chord_time), rates[1], controls.elevator);
    let [cx, cz] = lift_drag_to_body(lift, drag, sine, cosine);
    let [p_hat, r_hat] = [rates[0] * span_time, rates[2] * span_time];
    let [side, roll, yaw] = increments.lateral(air.beta, p_hat, r_hat, controls.aileron, controls.rudder);
    (c.cx, c.cz, c.cm) = (c.cx + cx, c.cz + cz, c.cm + pitch);
    (c.cy, c.cl, c.cn) = (c.cy + side, c.cl + roll, c.cn + yaw);
    let c = apparent(c);
    let values = [c.cx * sine - c.cz * cosine, -(c.cx * cosine) - c.cz * sine, c.cm, c.cy, c.cl, c.cn];
    let mut found = BTreeMap::new();
    for (coefficient, value) in COEFFICIENTS.into_iter().zip(values) {
        found.insert(format!("{coefficient}_0"), value.value);
        for (j, variable) in VARIABLES.into_iter().enumerate() {
            let unit = match variable {
                "q" => chord_time,
                "p" | "r" => span_time,
                _ => 1.0,
            };
            found.insert(format!("{coefficient}_{variable}"), value.derivatives[j] / unit);
        }
    }
    found
}

/// The increments to the aircraft `known` that make it the aircraft `flown`, at a trim: constants (`dCm_0`) and derivatives with
/// respect to every variable (`dCm_alpha`, `dCl_alpha`, ...), beside the `increments` (about the trim) that the flown aircraft has.
/// `apparent` turns the coefficients of the flown aircraft into those that the known mass and inertia would need for the same motion.
pub(crate) fn equivalent_increments(
    known: &impl Aircraft,
    flown: &impl Aircraft,
    trim: &Trim,
    increments: &Increments,
    apparent: impl Fn(Coefficients<Slopes>) -> Coefficients<Slopes>,
) -> BTreeMap<String, f64> {
    let before = derivatives(known, trim);
    let after = apparent_derivatives(flown, trim, increments, apparent);
    let named: BTreeMap<&str, f64> = increments.named().into_iter().collect();
    let beside = |(name, value): (String, f64)| {
        let increment = format!("d{name}");
        let there = named.get(increment.as_str()).copied().unwrap_or(0.0);
        (increment, value - before.get(&name).copied().unwrap_or(0.0) - there)
    };
    after.into_iter().map(beside).collect()
}

/// What damage amounts to at the trim before it, for an estimator that is told the undamaged tables, mass and inertia, and the
/// thrust that is left: it books what a lost mass or a shifted thrust does under coefficients. What a changed inertia does to
/// the coupling by rates is left out; it is of second order in them.
pub(crate) fn damage_increments<A: Aircraft>(
    known: &A,
    damaged: &Damaged<'_, A>,
    trim: &Trim,
    increments: &Increments,
) -> BTreeMap<String, f64> {
    let (before, after) = (known.mass_properties(), damaged.mass_properties());
    let geometry = known.geometry();
    let air = known.atmosphere().at(trim.altitude_m);
    let force = 0.5 * air.density * (trim.mach * air.speed_of_sound).powi(2) * geometry.wing_area;
    let lengths = [geometry.span, geometry.mean_chord, geometry.span];
    let lighter = before.mass() / after.mass();
    let (tensor, inverse) = (before.inertia_tensor(), after.inverse_inertia());
    let engine = damaged.propulsion(trim.power_percent, trim.altitude_m, trim.mach);
    // The known aircraft is told the thrust and takes its own moment arm for it.
    let whole = known.propulsion(trim.power_percent, trim.altitude_m, trim.mach);
    let left = if whole.thrust() == 0.0 { 0.0 } else { engine.thrust() / whole.thrust() };
    equivalent_increments(known, damaged, trim, increments, |c| {
        let forces: [Slopes; 3] = std::array::from_fn(|i| {
            let thrust = engine.force[i] / force;
            ([c.cx, c.cy, c.cz][i] + thrust) * lighter - thrust
        });
        let moments: [Slopes; 3] =
            std::array::from_fn(|i| [c.cl, c.cm, c.cn][i] * (force * lengths[i]) + engine.moment[i]);
        let turned = |i: usize| {
            let sum = (0..3).fold(Dual::from(0.0), |sum: Slopes, k| {
                let element: f64 = (0..3).map(|j| tensor[i][j] * inverse[j][k]).sum();
                sum + moments[k] * element
            });
            (sum - whole.moment[i] * left) * (1.0 / (force * lengths[i]))
        };
        let [cx, cy, cz] = forces;
        Coefficients { cx, cy, cz, cl: turned(0), cm: turned(1), cn: turned(2) }
    })
}
