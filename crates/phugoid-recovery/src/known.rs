//! What an estimate says about the motion of an aircraft: its local linear model with standard errors. Either the aircraft is known
//! but for increments, or nothing is known of it but mass, inertia and geometry, and the estimate is all of its aerodynamics.

use phugoid_control::interval::Estimate;
use phugoid_control::local::{ALPHA, AXES, BETA, LocalModel, P, Q, R, VARIABLES};
use phugoid_flight_dynamics::aircraft::{Aircraft, Controls, Geometry, State};
use phugoid_flight_dynamics::increments::Increments;
use phugoid_flight_dynamics::linearize::{LinearModel, linearize};
use phugoid_flight_dynamics::mass::MassProperties;
use phugoid_flight_dynamics::motion::Disturbance;
use phugoid_flight_dynamics::trim::Trim;
use phugoid_identification::model_file::{ModelFile, RateSpeed, ReferenceValue, Role, Source};
use phugoid_identification::rigid::MassInput;
use phugoid_identification::term::{Coefficient, FACTORS, Term, Variable};

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
fn with_declared(model: LocalModel, mut variance: LocalModel, declared: &Declared, trim: &Trim) -> Estimate {
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

/// What an estimate needs of a model file beside its parameters, where it is all of the aerodynamics: a rigid body and the point that
/// terms count from.
#[derive(Clone, Debug)]
pub struct Body {
    mass: MassProperties,
    geometry: Geometry,
    gravity: f64,
    /// Speed of `v_hat`, m/s; NaN where no term has it.
    reference_speed: f64,
    /// Whether rates are made dimensionless with the reference speed in place of the airspeed.
    rates_by_reference: bool,
    /// Angle of attack, elevator, aileron and rudder that count as zero, rad.
    reference: [f64; 4],
    terms: Vec<BodyTerm>,
}

/// A term of the build-up and the parameter that multiplies it.
#[derive(Clone, Debug)]
struct BodyTerm {
    parameter: String,
    coefficient: Coefficient,
    term: Term,
    /// The value of a parameter that is not estimated.
    fixed: Option<f64>,
}

impl Body {
    /// The body of a model file in absolute form.
    ///
    /// # Errors
    /// In words: what is missing or not constant, and what the local model of a control law does not have (terms of the rate of the angle of
    /// attack or of other inputs, moments of the thrust line, spinning rotors), so that it would be left out silently.
    pub fn of(model: &ModelFile) -> Result<Self, String> {
        let aircraft = &model.aircraft;
        let constant = |name: &str, source: Option<&Source>| match source {
            Some(Source::Constant(value)) => Ok(*value),
            Some(Source::Channel(_)) => Err(format!("`{name}` comes from a channel; a control law needs a constant")),
            None => Err(format!("`{name}` is missing: a control law needs both groups of axes")),
        };
        let given = |name: &str, value: ReferenceValue| match value {
            ReferenceValue::Given(value) => Ok(value),
            _ => Err(format!("`{name}` under [reference] has to be a number for a control law")),
        };
        let mass = MassInput {
            mass: constant("mass", Some(&aircraft.mass))?,
            ixx: constant("ixx", aircraft.ixx.as_ref())?,
            iyy: constant("iyy", Some(&aircraft.iyy))?,
            izz: constant("izz", aircraft.izz.as_ref())?,
            ixz: constant("ixz", aircraft.ixz.as_ref())?,
        };
        for (name, value) in [("thrust_arm", aircraft.thrust_arm), ("rotor_momentum", aircraft.rotor_momentum)] {
            if value != 0.0 {
                return Err(format!("`{name}` makes moments that a control law does not know: leave it out"));
            }
        }
        let mut terms = Vec::new();
        for parameter in &model.parameters {
            let (coefficient, term) = match &parameter.role {
                Role::Term(coefficient, term) => (*coefficient, term.clone()),
                // What takes up the error of a coefficient is a part of it: a constant.
                Role::Offset(coefficient) => (*coefficient, Term::default()),
                Role::Bias(_) => continue,
            };
            if term.powers().any(|(variable, _)| variable >= Variable::AlphaRate.index()) {
                return Err(format!(
                    "`{}` multiplies `{}`, which the local model of a control law does not have",
                    parameter.name,
                    term.text(&model.extra_inputs)
                ));
            }
            let fixed = parameter.fixed.then_some(parameter.start);
            terms.push(BodyTerm { parameter: parameter.name.clone(), coefficient, term, fixed });
        }
        Ok(Self {
            mass: mass
                .properties(aircraft.rotor_momentum)
                .ok_or("mass and moments of inertia belong to no body: `mass`, `ixx`, `iyy`, `izz`, `ixz`")?,
            geometry: Geometry {
                wing_area: aircraft.wing_area,
                span: aircraft.wing_span.ok_or("`wing_span` is missing: a control law needs both groups of axes")?,
                mean_chord: aircraft.mean_chord,
                // Coefficients are about the centre of gravity, wherever that is.
                cg: 0.25,
                cg_reference: 0.25,
            },
            gravity: aircraft.gravity,
            reference_speed: aircraft.reference_speed.unwrap_or(f64::NAN),
            rates_by_reference: model.rate_speed == RateSpeed::Reference,
            reference: [
                given("alpha", model.reference.alpha)?,
                given("elevator", model.reference.elevator)?,
                given("aileron", model.reference.aileron)?,
                given("rudder", model.reference.rudder)?,
            ],
            terms,
        })
    }

    /// Refuses a build-up whose terms count from far away: constants and slopes then have large errors that cancel, which bounds of
    /// single parameters do not show.
    ///
    /// # Errors
    /// The number to write, in words.
    pub fn counts_from(&self, trim: &Trim) -> Result<(), String> {
        /// A tenth of what moves an aeroplane out of trim by a g.
        const NEAR: f64 = 0.01;
        let trims = [trim.alpha_rad, trim.elevator_rad, trim.aileron_rad, trim.rudder_rad];
        for ((name, reference), trim) in
            ["alpha", "elevator", "aileron", "rudder"].iter().zip(self.reference).zip(trims)
        {
            if (reference - trim).abs() > NEAR {
                return Err(format!(
                    "its terms count {name} from {:.2} deg, and the flight begins at {:.2} deg: give `{name} = \"{:.2} deg\"` under \
                     [reference], so that the bound of what is out of trim is that of the flight",
                    reference.to_degrees(),
                    trim.to_degrees(),
                    trim.to_degrees()
                ));
            }
        }
        Ok(())
    }
}

/// The estimate of an aircraft whose aerodynamics are the parameters alone, at the trim's attitude, at an airspeed (m/s) and air
/// density (kg/m^3). Terms that are not linear count with their slope there.
///
/// To first order in the variables, for nearly level flight: `Za = -qbar S/(m V) (CL_alpha + CD)`, `Yb = qbar S/(m V) CY_beta`, and
/// the moments by the inverse of the inertia (B. L. Stevens, F. L. Lewis, *Aircraft Control and Simulation*, section 3.7).
pub fn whole(
    body: &Body,
    parameters: &[Increment],
    trim: &Trim,
    declared: &Declared,
    speed: f64,
    density: f64,
) -> Estimate {
    let rate_speed = if body.rates_by_reference { body.reference_speed } else { speed };
    let reach = Reach::new(&body.geometry, &body.mass, density, speed, rate_speed);
    let [alpha, elevator, aileron, rudder] = body.reference;
    let mut at = [0.0; FACTORS];
    at[Variable::Alpha.index()] = trim.alpha_rad - alpha;
    at[Variable::Airspeed.index()] = speed / body.reference_speed;
    at[Variable::Elevator.index()] = trim.elevator_rad - elevator;
    at[Variable::Aileron.index()] = trim.aileron_rad - aileron;
    at[Variable::Rudder.index()] = trim.rudder_rad - rudder;
    let mut model = LocalModel { alpha: trim.alpha_rad, speed, gravity: body.gravity, ..LocalModel::default() };
    let mut variance = LocalModel::default();
    for BodyTerm { parameter, coefficient, term, fixed } in &body.terms {
        let found = parameters.iter().find(|found| found.name == *parameter);
        let (value, std_error) = match (found, fixed) {
            (Some(found), _) => (found.value, found.std_error),
            (None, Some(value)) => (*value, 0.0),
            (None, None) => continue,
        };
        let slope = |variable: &Variable| (variable.short_name(), term.slope(variable.index(), &at));
        let parts = Variable::OF_DERIVATIVES.iter().map(slope);
        for (variable, part) in parts.chain([("0", term.value(&at))]) {
            if part != 0.0 {
                let scaled = Increment { name: String::new(), value: value * part, std_error: std_error * part.abs() };
                add(&mut model, &mut variance, &reach, coefficient.symbol(), variable, &scaled, true);
            }
        }
    }
    with_declared(model, variance, declared, trim)
}

/// What one unit of each coefficient does at a flight condition.
struct Reach {
    /// Angular accelerations (rows) by `Cl`, `Cm` and `Cn` (columns), rad/s^2.
    accelerations: [[f64; AXES]; AXES],
    /// Rate of the flow angles by lift and side force coefficient, rad/s.
    turning: f64,
    /// Time that makes a roll or yaw rate dimensionless, `b/2V`, and a pitch rate, `cbar/2V`, s.
    span_time: f64,
    chord_time: f64,
}

impl Reach {
    /// At an air density (kg/m^3) and airspeed (m/s); `rate_speed` (m/s) makes the rates dimensionless.
    fn new(geometry: &Geometry, mass: &MassProperties, density: f64, speed: f64, rate_speed: f64) -> Self {
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
fn parts(name: &str) -> Option<(&str, &str)> {
    name.strip_prefix('d')?.split_once('_')
}

fn add(
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

    const MODEL: &str = include_str!("../examples/transport/model.toml");

    /// The model file as an aircraft of its own, linearised, has the motion that its parameters make: with offsets, with terms that
    /// are not linear, and with rates by the reference speed.
    #[test]
    fn parameters_alone_give_the_motion_of_their_aircraft() {
        let text = MODEL
            .replace("thrust = { channel = \"thrust\" }", "thrust = 0\nreference_speed = \"40 m/s\"")
            .replace("Cm = [\"1\", ", "offsets = true\nCm = [")
            .replace("Cm_0 = { start = 0.0", "offset_Cm = { start = 0.01")
            .replace("input = \"interpolated\"", "input = \"interpolated\"\nrate_speed = \"reference\"");
        let model = ModelFile::parse("model.toml", &text).unwrap();
        let aircraft = phugoid_identification::aircraft::ModelAircraft::new(&model).unwrap();
        let condition = phugoid_flight_dynamics::trim::TrimCondition::steady(&aircraft, 46.0, 300.0, 0.0, 0.0);
        let trim = phugoid_flight_dynamics::trim::trim(&aircraft, &condition).unwrap();
        // About another attitude than its trim, so that something is out of trim.
        let trim = Trim { elevator_rad: trim.elevator_rad + 0.01, alpha_rad: trim.alpha_rad + 0.02, ..trim };
        let state = trim.state();
        let linear = linearize(&aircraft, &state, &trim.controls(), &Disturbance::default());
        let truth = local_model(&linear, trim.alpha_rad, trim.speed_m_s, aircraft.gravity());
        let known = model.parameters.iter().map(|p| Increment { name: p.name.clone(), value: p.start, std_error: 0.0 });
        let density = aircraft.atmosphere().at(300.0).density;
        let body = Body::of(&model).unwrap();
        let known: Vec<Increment> = known.collect();
        let found = whole(&body, &known, &trim, &Declared::UNSTATED, 46.0, density).model;
        let is_near = |found: f64, truth: f64, of: &str| {
            assert!((found - truth).abs() < 1e-9 * (1.0 + truth.abs()), "{of}: {found} {truth}");
        };
        for i in 0..AXES {
            for j in 0..VARIABLES {
                is_near(found.rates[i][j], truth.rates[i][j], &format!("rates {i} {j}"));
            }
            for j in 0..3 {
                is_near(found.surfaces[i][j], truth.surfaces[i][j], &format!("surfaces {i} {j}"));
            }
            is_near(found.constant[i], truth.constant[i], &format!("constant {i}"));
        }
        // To first order in small angles.
        assert!((found.alpha_by_alpha / truth.alpha_by_alpha - 1.0).abs() < 0.02);
        assert!((found.alpha_by_elevator / truth.alpha_by_elevator - 1.0).abs() < 0.02);
        assert!((found.beta_by_beta / truth.beta_by_beta - 1.0).abs() < 0.05);
    }

    #[test]
    fn what_a_control_law_would_leave_out_is_refused() {
        let refused = |from: &str, to: &str| {
            assert!(MODEL.contains(from), "{from}");
            Body::of(&ModelFile::parse("model.toml", &MODEL.replacen(from, to, 1)).unwrap()).unwrap_err()
        };
        // The elevator's term becomes one of the flap, under the same parameter's line.
        let flap = MODEL.replace("CL_elevator", "CL_flap").replacen("\"elevator\"]", "\"flap\"]", 1);
        let flap = flap.replacen("input =", "inputs = [\"flap\"]\ninput =", 1);
        let found = Body::of(&ModelFile::parse("model.toml", &flap).unwrap()).unwrap_err();
        assert!(found.contains("multiplies `flap`"), "{found}");
        let found = refused("[reference]", "thrust_arm = \"0.1 m\"\n[reference]");
        assert!(found.contains("thrust_arm"), "{found}");
        let found = refused("ixx = \"1.6554 kg*m^2\"", "ixx = { channel = \"ixx\" }");
        assert!(found.contains("`ixx` comes from a channel"), "{found}");
    }
}
