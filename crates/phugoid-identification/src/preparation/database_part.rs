//! What the database of a model file has in the place of each estimated parameter.

use phugoid_flight_data::statistics::median;

use crate::core::term::{Coefficient, Variable};
use crate::model_file::{DatabasePart, ModelFile, Role};
use crate::models::database::{Database, InAir};
use crate::motion::ReferencePoint;

/// Half of the range over which a slope is taken, about the reference point: rad of angles and surfaces, dimensionless rates,
/// and a part of the airspeed. Tables bend from one knot to the next, and a manoeuvre sees more than one.
const ANGLE: f64 = 0.035;
const RATE: f64 = 0.005;
const SPEED: f64 = 0.02;

/// The flight condition in which a database is asked for its coefficients.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Condition {
    /// True airspeed, m/s; NaN where nothing gives it.
    pub(crate) speed: f64,
    /// Density of the air, kg/m^3; NaN where nothing gives it.
    pub(crate) density: f64,
}

impl Condition {
    /// That of the model file's reference, else the medians of what was flown.
    pub(crate) fn of(file: &ModelFile, mut speeds: Vec<f64>, densities: Option<&[f64]>) -> Self {
        speeds.retain(|speed| speed.is_finite());
        let speed = file.aircraft.reference_speed.or_else(|| median(&mut speeds)).unwrap_or(f64::NAN);
        let density = densities.and_then(|values| median(&mut values.to_vec())).unwrap_or(f64::NAN);
        Self { speed, density }
    }
}

/// One entry per estimated parameter, in the order of the columns; and a sentence where the database has no number, whose
/// entries are zero then.
pub(crate) fn database_parts(
    file: &ModelFile,
    database: &Database,
    reference: &ReferencePoint,
    condition: Condition,
) -> (Vec<DatabasePart>, Option<String>) {
    if matches!(database, Database::None) {
        return (file.estimated().map(|_| DatabasePart::default()).collect(), None);
    }
    let point = Point { file, database, reference, condition };
    let mut lacking = Vec::new();
    let parts = file.estimated().map(|parameter| {
        let part = match &parameter.role {
            Role::Term(coefficient, term) if term.is_constant() => point.constant(*coefficient),
            Role::Offset(coefficient) => point.constant(*coefficient),
            Role::Term(coefficient, term) => match term.single().and_then(|index| Variable::ALL.get(index)) {
                Some(variable) => {
                    DatabasePart { value: point.slope(*coefficient, *variable), ..DatabasePart::default() }
                }
                None => DatabasePart::default(),
            },
            Role::Bias(_) => DatabasePart::default(),
        };
        let [elevator, aileron, rudder] = part.by_surfaces;
        if (part.value + part.by_flow_angles + elevator + aileron + rudder).is_finite() {
            return part;
        }
        lacking.push(parameter.name.as_str());
        DatabasePart::default()
    });
    let parts = parts.collect();
    let note = (!lacking.is_empty()).then(|| {
        format!(
            "the database has no number at the reference point for {}: what declared errors of scales make of the database is \
             not in the bounds of methods that do not follow them; give `reference_speed` under [aircraft]",
            lacking.join(", ")
        )
    });
    (parts, note)
}

/// A database at the reference point of a model file.
struct Point<'a> {
    file: &'a ModelFile,
    database: &'a Database,
    reference: &'a ReferencePoint,
    condition: Condition,
}

impl Point<'_> {
    /// A coefficient where one variable is off the reference by so much, in the unit of a term.
    fn at(&self, coefficient: Coefficient, variable: Variable, off: f64) -> f64 {
        let ReferencePoint { alpha, elevator, aileron, rudder } = *self.reference;
        let Condition { speed, density } = self.condition;
        let mut flight = InAir {
            speed,
            flow: [alpha, 0.0],
            density,
            mach: None,
            rates: [0.0; 3],
            deflections: [elevator, aileron, rudder],
        };
        let aircraft = &self.file.aircraft;
        let by_span = 2.0 * speed / aircraft.wing_span.unwrap_or(f64::NAN);
        match variable {
            Variable::Alpha => flight.flow[0] += off,
            Variable::Beta => flight.flow[1] += off,
            Variable::RollRate => flight.rates[0] = off * by_span,
            Variable::PitchRate => flight.rates[1] = off * 2.0 * speed / aircraft.mean_chord,
            Variable::YawRate => flight.rates[2] = off * by_span,
            Variable::Airspeed => flight.speed += off * speed,
            Variable::Elevator => flight.deflections[0] += off,
            Variable::Aileron => flight.deflections[1] += off,
            Variable::Rudder => flight.deflections[2] += off,
            Variable::AlphaRate => {}
        }
        self.database.all(&flight)[coefficient as usize]
    }

    fn slope(&self, coefficient: Coefficient, variable: Variable) -> f64 {
        let half = match variable {
            Variable::AlphaRate => {
                let Condition { speed, density } = self.condition;
                let ReferencePoint { alpha, elevator, .. } = *self.reference;
                let slopes = self.database.by_alpha_rate(speed, density, alpha, elevator);
                return slopes.and_then(|slopes| slopes.get(coefficient as usize).copied()).unwrap_or(0.0);
            }
            Variable::Alpha | Variable::Beta | Variable::Elevator | Variable::Aileron | Variable::Rudder => ANGLE,
            Variable::RollRate | Variable::PitchRate | Variable::YawRate => RATE,
            Variable::Airspeed => SPEED,
        };
        (self.at(coefficient, variable, half) - self.at(coefficient, variable, -half)) / (2.0 * half)
    }

    fn constant(&self, coefficient: Coefficient) -> DatabasePart {
        let ReferencePoint { alpha, elevator, aileron, rudder } = *self.reference;
        // A surface or an angle that is zero at the reference point is zero whatever its scale.
        let shift =
            |variable: Variable, from: f64| if from == 0.0 { 0.0 } else { from * self.slope(coefficient, variable) };
        DatabasePart {
            value: self.at(coefficient, Variable::Alpha, 0.0),
            by_flow_angles: shift(Variable::Alpha, alpha),
            by_surfaces: [
                shift(Variable::Elevator, elevator),
                shift(Variable::Aileron, aileron),
                shift(Variable::Rudder, rudder),
            ],
        }
    }
}
