//! An aircraft of which nothing is known but mass, inertia and geometry: the estimate is all of its aerodynamics.

use phugoid_control::interval::Estimate;
use phugoid_control::local::{AXES, LocalModel};
use phugoid_flight_dynamics::aircraft::Geometry;
use phugoid_flight_dynamics::mass::MassProperties;
use phugoid_flight_dynamics::trim::Trim;
use phugoid_identification::model_file::{ModelFile, RateSpeed, ReferenceValue, Role, Source};
use phugoid_identification::rigid::MassInput;
use phugoid_identification::term::{Coefficient, FACTORS, Term, Variable};

use crate::forces::THRUST;
use crate::known::{Declared, Increment, Reach, add, with_declared};
use crate::polar::{Condition, Instant, Polar};

/// What an estimate needs of a model file beside its parameters, where it is all of the aerodynamics: a rigid body and the point that
/// terms count from.
#[derive(Clone, Debug)]
pub struct Body {
    mass: MassProperties,
    geometry: Geometry,
    gravity: f64,
    /// Pitching moment per newton of thrust, m.
    thrust_arm: f64,
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

impl BodyTerm {
    /// Value of its parameter and one standard error; none where it is neither estimated nor fixed.
    fn known(&self, parameters: &[Increment]) -> Option<[f64; 2]> {
        let found = parameters.iter().find(|found| found.name == self.parameter);
        found.map(|found| [found.value, found.std_error]).or(self.fixed.map(|value| [value, 0.0]))
    }
}

impl Body {
    /// The body of a model file in absolute form.
    ///
    /// # Errors
    /// In words: what is missing or not constant, and what the local model of a control law does not have (terms of the rate of the angle of
    /// attack or of other inputs, spinning rotors), so that it would be left out silently.
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
        if aircraft.rotor_momentum != 0.0 {
            return Err("`rotor_momentum` makes moments that a control law does not know: leave it out".to_owned());
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
            thrust_arm: aircraft.thrust_arm,
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

/// The estimate of an aircraft whose aerodynamics are the parameters alone, at the trim's attitude, at an airspeed (m/s), air
/// density (kg/m^3) and thrust (N). Terms that are not linear count with their slope there. The moment of a thrust line beside the centre
/// of gravity is a part of what is out of trim.
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
    thrust: f64,
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
    for own @ BodyTerm { coefficient, term, .. } in &body.terms {
        let Some([value, std_error]) = own.known(parameters) else { continue };
        let slope = |variable: &Variable| (variable.short_name(), term.slope(variable.index(), &at));
        let parts = Variable::OF_DERIVATIVES.iter().map(slope);
        for (variable, part) in parts.chain([("0", term.value(&at))]) {
            if part != 0.0 {
                let scaled = Increment { name: String::new(), value: value * part, std_error: std_error * part.abs() };
                add(&mut model, &mut variance, &reach, coefficient.symbol(), variable, &scaled, true);
            }
        }
    }
    if body.thrust_arm != 0.0 {
        let inverse = body.mass.inverse_inertia();
        for i in 0..AXES {
            let by_thrust = inverse[i][1] * body.thrust_arm * thrust;
            model.constant[i] += by_thrust;
            variance.constant[i] += (THRUST * by_thrust).powi(2);
        }
    }
    with_declared(model, variance, declared, trim)
}

impl Body {
    /// Lift and drag coefficient at a condition, and what a unit of each parameter adds to them.
    pub(crate) fn polar(&self, parameters: &[Increment], condition: &Condition) -> Polar {
        let Condition { flown: [speed, _], angles: [alpha, beta], rates, positions } = *condition;
        let rate_speed = if self.rates_by_reference { self.reference_speed } else { speed };
        let mut at = [0.0; FACTORS];
        at[Variable::Beta.index()] = beta;
        at[Variable::RollRate.index()] = rates[0] * self.geometry.span / (2.0 * rate_speed);
        at[Variable::PitchRate.index()] = rates[1] * self.geometry.mean_chord / (2.0 * rate_speed);
        at[Variable::YawRate.index()] = rates[2] * self.geometry.span / (2.0 * rate_speed);
        at[Variable::Alpha.index()] = alpha - self.reference[0];
        at[Variable::Airspeed.index()] = speed / self.reference_speed;
        for (j, variable) in [Variable::Elevator, Variable::Aileron, Variable::Rudder].into_iter().enumerate() {
            at[variable.index()] = positions[j] - self.reference[1 + j];
        }
        let mut polar = Polar { value: [0.0; 2], by_parameter: vec![[0.0; 2]; parameters.len()] };
        for BodyTerm { parameter, coefficient, term, fixed } in &self.terms {
            let Some(which) = ["CL", "CD"].iter().position(|symbol| *symbol == coefficient.symbol()) else { continue };
            let factor = term.value(&at);
            match (parameters.iter().position(|found| found.name == *parameter), fixed) {
                (Some(k), _) => {
                    polar.value[which] += factor * parameters[k].value;
                    polar.by_parameter[k][which] += factor;
                }
                (None, Some(value)) => polar.value[which] += factor * value,
                (None, None) => {}
            }
        }
        polar
    }
}

/// Mean angular accelerations that terms which are not linear make of the motion about its mean, and one standard error of them from
/// the parameters', rad/s^2: what the terms give on average over these instants less what they give at the mean of the instants.
/// Ailerons that move to either side and pitch the nose down with both are an example. Instants with values that are no numbers
/// are left out; without any the result is zero. `density` in kg/m^3.
pub fn rectified(body: &Body, parameters: &[Increment], flown: &[Instant], density: f64) -> [[f64; AXES]; 2] {
    let flown: Vec<&Instant> = flown.iter().filter(|row| row.iter().all(|value| value.is_finite())).collect();
    if flown.is_empty() {
        return [[0.0; AXES]; 2];
    }
    let count = flown.len() as f64;
    let mean: Instant = std::array::from_fn(|j| flown.iter().map(|row| row[j]).sum::<f64>() / count);
    let rate_speed = if body.rates_by_reference { body.reference_speed } else { mean[5] };
    let reach = Reach::new(&body.geometry, &body.mass, density, mean[5], rate_speed);
    let factors = |row: &Instant| {
        let [alpha, elevator, aileron, rudder] = body.reference;
        let mut at = [0.0; FACTORS];
        for (variable, value) in [
            (Variable::Alpha, row[0] - alpha),
            (Variable::Beta, row[1]),
            (Variable::RollRate, row[2] * reach.span_time),
            (Variable::PitchRate, row[3] * reach.chord_time),
            (Variable::YawRate, row[4] * reach.span_time),
            (Variable::Airspeed, row[5] / body.reference_speed),
            (Variable::Elevator, row[6] - elevator),
            (Variable::Aileron, row[7] - aileron),
            (Variable::Rudder, row[8] - rudder),
        ] {
            at[variable.index()] = value;
        }
        at
    };
    let at_mean = factors(&mean);
    let (mut sums, mut squares) = ([0.0; AXES], [0.0; AXES]);
    for own @ BodyTerm { coefficient, term, .. } in &body.terms {
        let Some(axis) = ["Cl", "Cm", "Cn"].iter().position(|symbol| *symbol == coefficient.symbol()) else { continue };
        let Some([value, std_error]) = own.known(parameters) else { continue };
        let on_average: f64 = flown.iter().map(|row| term.value(&factors(row))).sum::<f64>() / count;
        let beyond = on_average - term.value(&at_mean);
        for i in 0..AXES {
            let unit = reach.accelerations[i][axis] * beyond;
            sums[i] += unit * value;
            squares[i] += (unit * std_error) * (unit * std_error);
        }
    }
    [sums, squares.map(f64::sqrt)]
}

#[cfg(test)]
mod tests {
    use phugoid_control::local::VARIABLES;
    use phugoid_flight_dynamics::aircraft::Aircraft;
    use phugoid_flight_dynamics::linearize::linearize;
    use phugoid_flight_dynamics::motion::Disturbance;

    use super::*;
    use crate::known::local_model;

    const MODEL: &str = include_str!("../examples/transport/model.toml");

    /// The model file as an aircraft of its own, linearised, has the motion that its parameters make: with offsets, with terms that
    /// are not linear, with rates by the reference speed, and with a thrust line below the centre of gravity.
    #[test]
    fn parameters_alone_give_the_motion_of_their_aircraft() {
        let text = MODEL
            .replace("thrust = { channel = \"thrust\" }", "thrust = 0\nreference_speed = \"40 m/s\"")
            .replace("[coefficients]", "[simulation]\nlargest_thrust = \"80 N\"\n[coefficients]")
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
        let mach = 46.0 / aircraft.atmosphere().at(300.0).speed_of_sound;
        let thrust = aircraft.propulsion(state.power, 300.0, mach).thrust();
        assert!(thrust > 10.0 && model.aircraft.thrust_arm > 0.1, "{thrust}");
        let estimate = whole(&body, &known, &trim, &Declared::UNSTATED, 46.0, density, thrust);
        // The thrust is known to a twentieth, and what it turns the nose by with it.
        let without = whole(&body, &known, &trim, &Declared::UNSTATED, 46.0, density, 0.0);
        let by_thrust = estimate.model.constant[1] - without.model.constant[1];
        let spread = (estimate.std_error.constant[1].powi(2) - without.std_error.constant[1].powi(2)).sqrt();
        assert!((spread - 0.05 * by_thrust).abs() < 1e-9 && by_thrust > 0.1, "{spread} {by_thrust}");
        let found = estimate.model;
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
        let found = refused("[reference]", "rotor_momentum = \"0.1 kg*m^2/s\"\n[reference]");
        assert!(found.contains("rotor_momentum"), "{found}");
        let found = refused("ixx = \"1.6554 kg*m^2\"", "ixx = { channel = \"ixx\" }");
        assert!(found.contains("`ixx` comes from a channel"), "{found}");
    }

    /// Ailerons that move by 0.1 rad to either side pitch the nose down by the magnitude's term; a term that is linear makes nothing,
    /// and an instant that was not measured does not count.
    #[test]
    fn what_moves_to_either_side_does_not_cancel() {
        let body = Body::of(&ModelFile::parse("model.toml", MODEL).unwrap()).unwrap();
        let named = |name: &str, value: f64| Increment { name: name.to_owned(), value, std_error: 0.1 * value.abs() };
        let at = |aileron: f64| [body.reference[0], 0.0, 0.0, 0.0, 0.0, 46.0, body.reference[1], aileron, 0.0];
        let middle = body.reference[2];
        let flown = [at(middle + 0.1), at(middle - 0.1), [f64::NAN; 9]];
        let one = |name: &str| rectified(&body, &[named(name, -0.2)], &flown, 1.19);
        let per_moment = body.mass.inverse_inertia()[1][1] * 0.5 * 1.19 * 46.0 * 46.0 * 0.5483 * 0.27898;
        let [mean, error] = one("Cm_abs_aileron");
        assert!((mean[1] + 0.02 * per_moment).abs() < 1e-9 && (error[1] - 0.002 * per_moment).abs() < 1e-9, "{mean:?}");
        assert!(one("Cm_aileron")[0][1].abs() < 1e-12);
        assert_eq!(rectified(&body, &[], &[[f64::NAN; 9]], 1.19), [[0.0; AXES]; 2]);
    }
}
