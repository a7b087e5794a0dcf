//! An identified model in DAVE-ML (ANSI/AIAA S-119), with the standard uncertainty of each value, their correlations, and check
//! data.

use std::time::{SystemTime, UNIX_EPOCH};

use phugoid_aircraft::daveml::{
    CheckPoint, Coefficient as Sum, Constant, Correlation, Derived, Expression, IdentifiedModel, Input,
    Term as Product, identifier, write,
};
use phugoid_flight_data::calendar::date;

use super::identified::{ExportError, Exported, Identified, Valued};
use crate::core::term::{Bend, Coefficient, Variable};
use crate::model_file::{RateSpeed, ReferenceValue};

/// The check point beside the reference: angles, rad, dimensionless rates and shares of the speed from it.
const AWAY: f64 = 0.04;
/// Speed of the check points where the model file names none, m/s.
const SPEED: f64 = 50.0;

/// Writes a model in absolute form. Its coefficients are `CL`, `CD` (stability axes), `Cm`, `CY`, `Cl`, `Cn` (body axes, about the
/// centre of gravity), its inputs what their terms need, in SI units and radians; each derivative is a variable of its own, with
/// its standard uncertainty as a normal distribution. The check data are values at the reference point and beside it.
///
/// ```
/// use phugoid_identification::export::{Identified, daveml};
/// use phugoid_identification::model_file::ModelFile;
///
/// let model = ModelFile::named("hfb320")?; // Identified::new takes the values of an estimation instead
/// let text = daveml(&Identified::start(&model))?.text;
/// let read = phugoid_aircraft::daveml::Model::parse(&text)?;
/// assert!(read.check().passed());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`ExportError`]: increments to a database, a reference that is not in the result.
pub fn daveml(identified: &Identified<'_>) -> Result<Exported, ExportError> {
    identified.absolute("DAVE-ML")?;
    let mut writer = Writer { identified, model: IdentifiedModel::default(), centre: Vec::new() };
    for coefficient in Coefficient::ALL {
        let terms = identified.terms(coefficient);
        if !terms.is_empty() {
            writer.add(coefficient, &terms)?;
        }
    }
    let Writer { mut model, centre, .. } = writer;
    let file = identified.model;
    model.name.clone_from(&file.name);
    model.author = "Phugoid".to_owned();
    model.created = today();
    model.description = format!(
        "Values: {}. Moments about the centre of gravity of the flight. Lift and drag along the stability axes.",
        identified.origin
    );
    let known = |name: &str| {
        model.coefficients.iter().flat_map(|c| &c.terms).any(|t| t.id == name && t.standard_uncertainty.is_some())
    };
    model.correlations = identified
        .correlations
        .iter()
        .map(|(first, second, coefficient)| Correlation {
            first: identifier(first),
            second: identifier(second),
            coefficient: coefficient.clamp(-1.0, 1.0),
        })
        .filter(|pair| known(&pair.first) && known(&pair.second))
        .collect();
    let point = |name: &str, away: f64| CheckPoint {
        name: name.to_owned(),
        inputs: centre.iter().map(|(id, value, step)| (id.clone(), value + away * step)).collect(),
    };
    model.check_points = vec![point("reference", 0.0), point("above", 1.0), point("below", -1.0)];
    let text = write(&model).map_err(|e| ExportError::NoPlace(format!("DAVE-ML: {e}")))?;
    let notes =
        vec!["the coefficients are dimensionless; the reference area and lengths are constants of the file".to_owned()];
    Ok(Exported { text, notes })
}

/// The model as it grows with the terms that are added.
struct Writer<'a> {
    identified: &'a Identified<'a>,
    model: IdentifiedModel,
    /// Inputs with their value at the reference point and a step from it.
    centre: Vec<(String, f64, f64)>,
}

impl Writer<'_> {
    fn add(&mut self, coefficient: Coefficient, terms: &[Valued]) -> Result<(), ExportError> {
        let mut products = Vec::new();
        for valued in terms {
            let mut factors = Vec::new();
            for &(index, power) in valued.term.factors() {
                let variable = self.variable(index)?;
                factors.extend((0..power).map(|_| variable.clone()));
            }
            for bent in valued.term.bent() {
                let variable = self.bent(bent.variable, bent.bend)?;
                factors.extend((0..bent.power).map(|_| variable.clone()));
            }
            let units = if valued.term.parameter_unit() == "per rad" { "_rad" } else { "nd" };
            products.push(Product {
                id: identifier(&valued.name),
                units: units.to_owned(),
                factors,
                value: valued.value,
                standard_uncertainty: self
                    .identified
                    .std_errors
                    .get(&valued.name)
                    .copied()
                    .filter(|std| std.is_finite()),
            });
        }
        let (name, standard) = match coefficient {
            Coefficient::PitchingMoment => ("aeroBodyMomentCoefficient_Pitch", true),
            Coefficient::RollingMoment => ("aeroBodyMomentCoefficient_Roll", true),
            Coefficient::YawingMoment => ("aeroBodyMomentCoefficient_Yaw", true),
            Coefficient::SideForce => ("aeroBodyForceCoefficient_Y", true),
            Coefficient::Lift => ("coefficient of lift, stability axes", false),
            Coefficient::Drag => ("coefficient of drag, stability axes", false),
        };
        self.model.coefficients.push(Sum {
            id: coefficient.symbol().to_owned(),
            name: name.to_owned(),
            standard,
            terms: products,
            ..Sum::default()
        });
        Ok(())
    }

    /// Identifier of an input, which is added with its value at the reference point if it is not there yet.
    fn input(&mut self, id: &str, name: &str, units: &str, sign: &str, at: f64, step: f64) -> String {
        if !self.model.inputs.iter().any(|input| input.id == id) {
            self.model.inputs.push(Input {
                id: id.to_owned(),
                name: name.to_owned(),
                units: units.to_owned(),
                sign: sign.to_owned(),
                standard: !name.is_empty(),
                ..Input::default()
            });
            self.centre.push((id.to_owned(), at, step));
        }
        id.to_owned()
    }

    fn constant(&mut self, id: &str, units: &str, value: f64) -> Expression {
        if !self.model.constants.iter().any(|constant| constant.id == id) {
            self.model.constants.push(Constant {
                id: id.to_owned(),
                units: units.to_owned(),
                value,
                ..Constant::default()
            });
        }
        Expression::Variable(id.to_owned())
    }

    fn derived(&mut self, id: &str, value: Expression) -> String {
        if !self.model.derived.iter().any(|derived| derived.id == id) {
            let units = "nd".to_owned();
            self.model.derived.push(Derived { id: id.to_owned(), name: String::new(), units, value });
        }
        id.to_owned()
    }

    /// An angle from its reference.
    fn from(&mut self, id: &str, reference: f64) -> String {
        if reference == 0.0 {
            return id.to_owned();
        }
        let at = self.constant(&format!("{id}_reference"), "rad", reference);
        let angle = Expression::Variable(id.to_owned());
        self.derived(&format!("{id}_from_reference"), Expression::Difference(angle.into(), at.into()))
    }

    fn speed(&mut self) -> String {
        let speed = self.identified.model.aircraft.reference_speed.unwrap_or(SPEED);
        self.input("V", "trueAirspeed", "m_s", "", speed, AWAY * speed)
    }

    fn reference_speed(&mut self) -> Result<Expression, ExportError> {
        let speed = self.identified.model.aircraft.reference_speed;
        let speed = speed.ok_or_else(|| ExportError::NoPlace("the model file has no reference speed".to_owned()))?;
        Ok(self.constant("V_reference", "m_s", speed))
    }

    /// A rate made dimensionless: times half a length over the speed.
    fn hat(&mut self, id: &str, rate: String, length: &str, metres: f64) -> Result<String, ExportError> {
        let length = self.constant(length, "m", metres);
        let speed = match self.identified.model.rate_speed {
            RateSpeed::Actual => Expression::Variable(self.speed()),
            RateSpeed::Reference => self.reference_speed()?,
        };
        let double = Expression::Product(vec![Expression::Number(2.0), speed]);
        let times = Expression::Product(vec![Expression::Variable(rate), length]);
        Ok(self.derived(id, Expression::Quotient(times.into(), double.into())))
    }

    /// Identifier of the flight variable with this index.
    fn variable(&mut self, index: usize) -> Result<String, ExportError> {
        let model = self.identified.model;
        let Some(variable) = Variable::ALL.get(index) else {
            let name = model.extra_inputs.get(index - Variable::ALL.len()).map_or("input", String::as_str);
            return Ok(self.input(&identifier(name), "", "nd", "", 0.0, AWAY));
        };
        let reference = &model.reference;
        let chord = model.aircraft.mean_chord;
        let span = model.aircraft.wing_span.unwrap_or(f64::NAN);
        let rate = |length: f64| AWAY * 2.0 * model.aircraft.reference_speed.unwrap_or(SPEED) / length;
        Ok(match variable {
            Variable::Alpha => {
                let at = self.identified.alpha_reference;
                self.input("alpha", "angleOfAttack", "rad", "+NU", at, AWAY);
                self.from("alpha", at)
            }
            Variable::Beta => self.input("beta", "angleOfSideslip", "rad", "+ANR", 0.0, AWAY),
            Variable::RollRate => {
                let p = self.input("p", "bodyAngularRate_Roll", "rad_s", "+RWD", 0.0, rate(span));
                self.hat("p_hat", p, "b", span)?
            }
            Variable::PitchRate => {
                let q = self.input("q", "bodyAngularRate_Pitch", "rad_s", "+NU", 0.0, 0.1 * rate(chord));
                self.hat("q_hat", q, "cbar", chord)?
            }
            Variable::YawRate => {
                let r = self.input("r", "bodyAngularRate_Yaw", "rad_s", "+NR", 0.0, rate(span));
                self.hat("r_hat", r, "b", span)?
            }
            Variable::Airspeed => {
                let (speed, reference) = (self.speed(), self.reference_speed()?);
                self.derived("v_hat", Expression::Quotient(Expression::Variable(speed).into(), reference.into()))
            }
            Variable::Elevator => self.surface("elevator", "+TED", reference.elevator)?,
            Variable::Aileron => self.surface("aileron", "+RTED", reference.aileron)?,
            Variable::Rudder => self.surface("rudder", "+TEL", reference.rudder)?,
            Variable::AlphaRate => {
                let rate = self.input("alpha_dot", "", "rad_s", "+NU", 0.0, 0.1 * rate(chord));
                self.hat("alpha_dot_hat", rate, "cbar", chord)?
            }
        })
    }

    fn surface(&mut self, name: &str, sign: &str, reference: ReferenceValue) -> Result<String, ExportError> {
        let at = self.identified.surface_reference(name, reference)?;
        self.input(name, "", "rad", sign, at, -AWAY);
        Ok(self.from(name, at))
    }

    /// Identifier of a bent flight variable.
    fn bent(&mut self, index: usize, bend: Bend) -> Result<String, ExportError> {
        let variable = self.variable(index)?;
        let inside = Expression::Variable(variable.clone());
        Ok(match bend {
            Bend::Magnitude => self.derived(&format!("abs_{variable}"), Expression::Magnitude(inside.into())),
            Bend::Above(from) => {
                let over = Expression::Difference(inside.into(), Expression::Number(from).into());
                let id = identifier(&format!("{variable}_above_{from}"));
                self.derived(&id, Expression::Largest(vec![over, Expression::Number(0.0)]))
            }
        })
    }
}

/// The date of today, UTC, ISO 8601.
fn today() -> String {
    let seconds = SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |since| since.as_secs());
    let (year, month, day) = date((seconds / 86_400) as i64);
    format!("{year:04}-{month:02}-{day:02}")
}
