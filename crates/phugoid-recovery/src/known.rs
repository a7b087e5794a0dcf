//! What an estimate says about the motion of an aircraft: its local linear model with standard errors. Either the aircraft is known
//! but for increments, or nothing is known of it but mass, inertia and geometry, and the estimate is all of its aerodynamics
//! ([`body`](crate::body)).

use phugoid_control::interval::Estimate;
use phugoid_control::local::{ALPHA, AXES, BETA, LocalModel, P, Q, R, VARIABLES};
use phugoid_flight_dynamics::aircraft::{Aircraft, Controls, Geometry, State};
use phugoid_flight_dynamics::increments::Increments;
use phugoid_flight_dynamics::linearize::{LinearModel, linearize};
use phugoid_flight_dynamics::mass::MassProperties;
use phugoid_flight_dynamics::motion::Disturbance;
use phugoid_flight_dynamics::trim::Trim;

// Places in `phugoid_flight_dynamics::linearize::STATE_NAMES` and the columns of its input matrix.
const STATE_OF: [usize; VARIABLES] = [1, 2, 6, 7, 8];
const RATE_OF: [usize; AXES] = [6, 7, 8];
const ELEVATOR: usize = 1;
const AILERON: usize = 2;
const RUDDER: usize = 3;

/// An estimated increment.
#[derive(Clone, Debug, PartialEq)]
pub struct Increment {
    /// Its name: `dCm_alpha`, `dCl_0`, ...
    pub name: String,
    /// Its value, per rad (or none, for a constant).
    pub value: f64,
    /// One standard error.
    pub std_error: f64,
}

/// Errors that leave no trace in residuals, one standard deviation each.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Declared {
    /// Scale of angle of attack and sideslip, a part.
    pub flow_angle_scale: f64,
    /// Constant error of angle of attack and sideslip, rad. In level flight nothing tells it from a constant force and moment.
    pub flow_angle_bias: f64,
    /// Scale of the recorded positions of the surfaces, a part.
    pub surface_scale: f64,
}

impl Declared {
    /// The scales of the class `unstated` of model files (docs/model-file.md), and a tenth of a degree.
    pub const UNSTATED: Self = Self { flow_angle_scale: 0.03, flow_angle_bias: 0.00175, surface_scale: 0.03 };
}

/// The local model of a linear one about steady flight at an angle of attack (rad) and airspeed (m/s).
pub fn local_model(model: &LinearModel, alpha: f64, speed: f64, gravity: f64) -> LocalModel {
    let surface = |row: usize| [model.b[row][ELEVATOR], model.b[row][AILERON], model.b[row][RUDDER]];
    LocalModel {
        rates: RATE_OF.map(|row| STATE_OF.map(|column| model.a[row][column])),
        surfaces: RATE_OF.map(surface),
        constant: RATE_OF.map(|row| model.rates[row]),
        alpha_by_alpha: model.a[1][1],
        alpha_by_elevator: model.b[1][ELEVATOR],
        beta_by_beta: model.a[2][2],
        beta_by_rudder: model.b[2][RUDDER],
        beta_by_aileron: model.b[2][AILERON],
        alpha,
        speed,
        gravity,
    }
}

/// The estimate of an aircraft that is `known` but for increments about its trim, at the trim's attitude and at the airspeed (m/s)
/// and altitude (m) that it flies at. Increments whose names are no coefficient with a variable of the motion (biases, `dCD_...`) do not
/// matter here.
///
/// What is out of trim has the `declared` errors of the reference in its bound: a scale of the vane or of a surface shows the
/// reference at another place.
pub fn estimate<A: Aircraft>(
    known: &A,
    trim: &Trim,
    increments: &[Increment],
    declared: &Declared,
    speed: f64,
    altitude: f64,
) -> Estimate {
    let mut named = Increments::NONE.about(trim.alpha_rad, trim.q_rad_s, trim.elevator_rad);
    for increment in increments {
        if let Some(place) = named.by_name_mut(&increment.name) {
            *place = increment.value;
        }
    }
    let state = State { speed, altitude, ..trim.state() };
    let controls: Controls = trim.controls();
    let linear = linearize(known, &state, &controls, &Disturbance { increments: named, ..Disturbance::default() });
    let mut model = local_model(&linear, trim.alpha_rad, speed, known.gravity());
    let mut variance = LocalModel::default();
    let density = known.atmosphere().at(altitude).density;
    let reach = Reach::new(known.geometry(), known.mass_properties(), density, speed, speed);
    for increment in increments {
        let Some((coefficient, variable)) = parts(&increment.name).filter(|(coefficient, _)| *coefficient != "CD")
        else {
            continue;
        };
        // Derivatives of the aircraft's own axes are in the linear model already.
        let is_new = Increments::NONE.named().iter().all(|(name, _)| *name != increment.name);
        add(&mut model, &mut variance, &reach, coefficient, variable, increment, is_new);
    }
    with_declared(model, variance, declared, trim)
}

/// The model with its standard errors: what is out of trim has the declared errors of the reference in its bound, a scale of the vane
/// or of a surface shows the reference at another place.
pub(crate) fn with_declared(model: LocalModel, mut variance: LocalModel, declared: &Declared, trim: &Trim) -> Estimate {
    let surfaces = [trim.elevator_rad, trim.aileron_rad, trim.rudder_rad];
    for i in 0..AXES {
        let by_vane = model.rates[i][ALPHA] * declared.flow_angle_scale * trim.alpha_rad;
        let by_surfaces = surfaces.iter().zip(model.surfaces[i]).map(|(u, effect)| effect * declared.surface_scale * u);
        let by_bias = declared.flow_angle_bias * model.rates[i][ALPHA].hypot(model.rates[i][BETA]);
        variance.constant[i] +=
            by_vane * by_vane + by_bias * by_bias + by_surfaces.map(|part| part * part).sum::<f64>();
    }
    let std_error = LocalModel {
        rates: variance.rates.map(|row| row.map(f64::sqrt)),
        surfaces: variance.surfaces.map(|row| row.map(f64::sqrt)),
        constant: variance.constant.map(f64::sqrt),
        alpha_by_alpha: variance.alpha_by_alpha.sqrt(),
        alpha_by_elevator: variance.alpha_by_elevator.sqrt(),
        beta_by_beta: variance.beta_by_beta.sqrt(),
        beta_by_rudder: variance.beta_by_rudder.sqrt(),
        beta_by_aileron: variance.beta_by_aileron.sqrt(),
        ..LocalModel::default()
    };
    Estimate { model, std_error }
}

/// What one unit of each coefficient does at a flight condition.
pub(crate) struct Reach {
    /// Angular accelerations (rows) by `Cl`, `Cm` and `Cn` (columns), rad/s^2.
    pub(crate) accelerations: [[f64; AXES]; AXES],
    /// Rate of the flow angles by lift and side force coefficient, rad/s.
    turning: f64,
    /// Time that makes a roll or yaw rate dimensionless, `b/2V`, and a pitch rate, `cbar/2V`, s.
    pub(crate) span_time: f64,
    pub(crate) chord_time: f64,
}

impl Reach {
    /// At an air density (kg/m^3) and airspeed (m/s); `rate_speed` (m/s) makes the rates dimensionless.
    pub(crate) fn new(geometry: &Geometry, mass: &MassProperties, density: f64, speed: f64, rate_speed: f64) -> Self {
        let force = 0.5 * density * speed * speed * geometry.wing_area;
        let lengths = [geometry.span, geometry.mean_chord, geometry.span];
        let inverse = mass.inverse_inertia();
        Self {
            accelerations: std::array::from_fn(|i| std::array::from_fn(|k| inverse[i][k] * force * lengths[k])),
            turning: force / (mass.mass() * speed),
            span_time: geometry.span / (2.0 * rate_speed),
            chord_time: geometry.mean_chord / (2.0 * rate_speed),
        }
    }
}

/// Coefficient and variable of `dCm_alpha`; `None` for another name.
pub(crate) fn parts(name: &str) -> Option<(&str, &str)> {
    name.strip_prefix('d')?.split_once('_')
}

/// Whether a parameter of this name (`dCm_alpha`) is an increment that the local model has, or one of drag.
pub(crate) fn is_local(name: &str) -> bool {
    const VARIABLES: [&str; 9] = ["0", "alpha", "beta", "p", "q", "r", "elevator", "aileron", "rudder"];
    parts(name).is_some_and(|(_, variable)| VARIABLES.contains(&variable))
}

pub(crate) fn add(
    model: &mut LocalModel,
    variance: &mut LocalModel,
    reach: &Reach,
    coefficient: &str,
    variable: &str,
    increment: &Increment,
    is_new: bool,
) {
    let square = increment.std_error * increment.std_error;
    let axis = match coefficient {
        "Cl" => 0,
        "Cm" => 1,
        "Cn" => 2,
        "CL" | "CD" | "CY" => {
            let (entry, spread, sign) = match (coefficient, variable) {
                ("CL", "alpha") => (&mut model.alpha_by_alpha, &mut variance.alpha_by_alpha, -1.0),
                ("CL", "elevator") => (&mut model.alpha_by_elevator, &mut variance.alpha_by_elevator, -1.0),
                // The drag of the moment turns with the velocity.
                ("CD", "0") => (&mut model.alpha_by_alpha, &mut variance.alpha_by_alpha, -1.0),
                ("CY", "beta") => (&mut model.beta_by_beta, &mut variance.beta_by_beta, 1.0),
                ("CY", "rudder") => (&mut model.beta_by_rudder, &mut variance.beta_by_rudder, 1.0),
                ("CY", "aileron") => (&mut model.beta_by_aileron, &mut variance.beta_by_aileron, 1.0),
                _ => return,
            };
            if is_new {
                *entry += sign * reach.turning * increment.value;
            }
            *spread += reach.turning * reach.turning * square;
            return;
        }
        _ => return,
    };
    for i in 0..AXES {
        let per_unit = reach.accelerations[i][axis];
        let (entry, spread, unit) = match variable {
            "0" => (&mut model.constant[i], &mut variance.constant[i], 1.0),
            "alpha" => (&mut model.rates[i][ALPHA], &mut variance.rates[i][ALPHA], 1.0),
            "beta" => (&mut model.rates[i][BETA], &mut variance.rates[i][BETA], 1.0),
            "p" => (&mut model.rates[i][P], &mut variance.rates[i][P], reach.span_time),
            "q" => (&mut model.rates[i][Q], &mut variance.rates[i][Q], reach.chord_time),
            "r" => (&mut model.rates[i][R], &mut variance.rates[i][R], reach.span_time),
            "elevator" => (&mut model.surfaces[i][0], &mut variance.surfaces[i][0], 1.0),
            "aileron" => (&mut model.surfaces[i][1], &mut variance.surfaces[i][1], 1.0),
            "rudder" => (&mut model.surfaces[i][2], &mut variance.surfaces[i][2], 1.0),
            _ => return,
        };
        let scale = per_unit * unit;
        if is_new {
            *entry += scale * increment.value;
        }
        *spread += scale * scale * square;
    }
}

#[cfg(test)]
mod tests {
    use phugoid_simulation::course::Course;
    use phugoid_simulation::flight::trimmed_aircraft;
    use phugoid_simulation::scenario::Scenario;

    use super::*;

    /// The model that the true increments of a damaged aircraft give is that of its own equations of motion.
    #[test]
    fn true_increments_give_the_true_motion() {
        let text = include_str!("../../../scenarios/f16-recovery.toml").replace(
            "effectiveness = { elevator = 0.5 }",
            "coupling = { Cl_alpha = 0.05, Cm_beta = 0.03, Cn_alpha = -0.02 }",
        );
        let mut scenario = Scenario::parse(&text, "test").unwrap();
        scenario.damage[0].at = phugoid_simulation::quantity::Time::from_si(0.0);
        let (aircraft, trim) = trimmed_aircraft(&scenario).unwrap();
        let course = Course::new(&scenario, aircraft.as_ref(), None, &trim).unwrap();
        let linear = course.linear_model(&trim.state(), &trim.controls());
        let truth = local_model(&linear, trim.alpha_rad, trim.speed_m_s, aircraft.gravity());
        let named = [
            ("dCm_alpha", 0.4),
            ("dCm_q", 3.0),
            ("dCL_alpha", -0.5),
            ("dCm_0", 0.01),
            ("dCl_0", -0.004),
            ("dCl_alpha", 0.05),
            ("dCm_beta", 0.03),
            ("dCn_alpha", -0.02),
        ];
        let increments = named.map(|(name, value)| Increment { name: name.to_owned(), value, std_error: 0.01 });
        let found =
            estimate(aircraft.as_ref(), &trim, &increments, &Declared::UNSTATED, trim.speed_m_s, trim.altitude_m);
        for i in 0..AXES {
            for j in 0..VARIABLES {
                let (found, truth) = (found.model.rates[i][j], truth.rates[i][j]);
                assert!((found - truth).abs() < 1e-9 * (1.0 + truth.abs()), "{i} {j}: {found} {truth}");
            }
            assert!((found.model.constant[i] - truth.constant[i]).abs() < 1e-9);
        }
        assert!((found.model.alpha_by_alpha - truth.alpha_by_alpha).abs() < 1e-12);
        assert!(found.std_error.rates[1][ALPHA] > 0.0 && found.std_error.rates[1][P] == 0.0);
    }
}
