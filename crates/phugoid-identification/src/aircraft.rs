//! A model file as an aircraft: what trims, gives linear models and flies in scenarios.

mod engine;

use phugoid_aircraft::engine::Schedule;
use phugoid_flight_dynamics::actuator::Actuators;
use phugoid_flight_dynamics::aircraft::{AirData, Aircraft, Coefficients, Controls, DataRange, Geometry, Propulsion};
use phugoid_flight_dynamics::atmosphere::Atmosphere;
use phugoid_flight_dynamics::fuel::Burnt;
use phugoid_flight_dynamics::increments::lift_drag_to_body;
use phugoid_flight_dynamics::mass::MassProperties;
use phugoid_flight_dynamics::scalar::Scalar;

use crate::core::term::{Coefficient, EXTRA_INPUTS, Term, Variable};
use crate::export::Identified;
use crate::model_file::{AirDensity, FuelData, FuelFlow, KnownAircraft, ModelFile, ReferenceValue, Source};
use crate::models::longitudinal::Database;
use crate::models::rigid::{Aerodynamics, Air, AircraftConstants, MassInput};
use crate::motion::ReferencePoint;
use crate::preparation::prepare::{database, reference_trim};
use engine::{At, Engine};

/// A term of a coefficient with its value.
type Valued = (Coefficient, Term, f64);

/// Why a model file makes no aircraft that can be flown.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum ModelAircraftError {
    /// Without lift, drag and pitching moment nothing flies.
    #[error(
        "the model `{0}` has the lateral axes alone, and without lift, drag and pitching moment nothing flies: write \
         axes = [\"longitudinal\", \"lateral\"] and the missing coefficients"
    )]
    LateralAlone(String),
    /// A quantity comes from a channel of a record, and there is no record.
    #[error(
        "`{key}` of the model `{model}` comes from the channel `{channel}` of a record, which an aircraft that is \
         simulated does not have: write a value"
    )]
    Recorded {
        /// Name of the model.
        model: String,
        /// The key of the model file.
        key: &'static str,
        /// The channel that it names.
        channel: String,
    },
    /// A reference point comes from the first sample of a record, and there is no record.
    #[error(
        "the reference of `{what}` in the model `{model}` is the first sample of a record, which an aircraft that is \
         simulated does not have: give it a value under [reference]"
    )]
    FirstSample {
        /// Name of the model.
        model: String,
        /// `alpha` or a surface.
        what: &'static str,
    },
    /// Mass and moments of inertia that no body has.
    #[error("mass and moments of inertia of the model `{0}` are those of no body: check their values and units")]
    Mass(String),
    /// Without its fuel the aircraft is no body: the fuel has more inertia than the aircraft with it.
    #[error(
        "without the fuel of [simulation.fuel] the model `{0}` has a moment of inertia that no body has: the fuel, where `cg` puts it, \
         has more than the aircraft with it"
    )]
    Fuel(String),
    /// The database of the model cannot be loaded, or has no trim to be the reference point.
    #[error("{0}")]
    Database(String),
}

/// A model file with a value for each of its parameters, as an [`Aircraft`].
///
/// The coefficients are those of the file at every instant: the database, if there is one, and all terms with their values
/// (offsets are constants; biases belong to sensors and are left out). Further `inputs` of the file are zero. A model of the
/// longitudinal axes alone has no side force and no rolling or yawing moment: it flies straight ahead, and nothing turns
/// it.
///
/// Thrust acts along the thrust line of the file. Engine or propeller, fuel and the surfaces' limits are those of the table
/// `[simulation]`; without an engine there, that of the database flies. A propeller is met along its axis: it has no force across
/// it. Mass, centre of gravity and inertia are those of the beginning in trims and linear models; in a simulation fuel is burnt.
/// The atmosphere is the one that the file names, the 1976 standard atmosphere for a density of its own.
/// What the file did not say and was assumed is said by [`notes`](Self::notes).
///
/// ```
/// use phugoid_flight_dynamics::trim::{TrimCondition, trim};
/// use phugoid_identification::aircraft::ModelAircraft;
/// use phugoid_identification::model_file::ModelFile;
///
/// let glider = ModelFile::parse("glider.toml", r#"
///     axes = ["longitudinal"]
///     [aircraft]
///     mass = "450 kg"
///     iyy = "600 kg*m^2"
///     wing_area = "10.5 m^2"
///     mean_chord = "0.75 m"
///     thrust = 0
///     air_density = "standard_atmosphere"
///     [simulation]
///     largest_thrust = "600 N"
///     [coefficients]
///     CL = ["1", "alpha"]
///     CD = ["1", "alpha^2"]
///     Cm = ["alpha", "q_hat", "elevator"]
///     [parameters]
///     CL_0 = { start = 0.3, prior_std = 0.3 }
///     CL_alpha = { start = 5.5, prior_std = 2 }
///     CD_0 = { start = 0.015, prior_std = 0.02 }
///     CD_alpha2 = { start = 0.5, prior_std = 2 }
///     Cm_alpha = { start = -0.8, prior_std = 1 }
///     Cm_q = { start = -15, prior_std = 15 }
///     Cm_elevator = { start = -1.2, prior_std = 1 }
/// "#)?;
/// let aircraft = ModelAircraft::new(&glider)?;
/// let level = trim(&aircraft, &TrimCondition::steady(&aircraft, 30.0, 500.0, 0.0, 0.0))?;
/// // Lift is weight: CL = 2 m g / (rho V^2 S) = 0.80, less what the thrust carries.
/// assert!((0.3 + 5.5 * level.alpha_rad - 0.80).abs() < 0.005);
/// // Elevator against the pitching moment of the angle of attack.
/// assert!((level.elevator_rad + 0.8 / 1.2 * level.alpha_rad).abs() < 1e-9);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct ModelAircraft {
    name: String,
    centre_of_gravity: Option<f64>,
    aerodynamics: Aerodynamics,
    /// The terms of the rate of the angle of attack, with their values.
    rate_terms: Vec<Valued>,
    geometry: Geometry,
    mass: MassProperties,
    gravity: f64,
    atmosphere: Atmosphere,
    /// None: the engine of the database.
    engine: Option<Engine>,
    fuel: Option<FuelData>,
    /// Direction of the thrust along body x and z, and its moment per newton, m.
    thrust_line: [f64; 3],
    engine_lag_s: f64,
    actuators: Actuators,
    data_range: DataRange,
    notes: Vec<String>,
}

impl ModelAircraft {
    /// The aircraft of a model file, with the start values of its parameters.
    ///
    /// # Errors
    /// [`ModelAircraftError`]: only lateral axes, a mass or a reference point that comes from a record, an impossible inertia.
    pub fn new(model: &ModelFile) -> Result<Self, ModelAircraftError> {
        Self::with_alpha(&Identified::start(model), None)
    }

    /// The aircraft of an identified model, about the reference point of the estimation.
    ///
    /// # Errors
    /// As [`new`](Self::new).
    pub fn identified(identified: &Identified) -> Result<Self, ModelAircraftError> {
        Self::with_alpha(identified, Some(identified.alpha_reference))
    }

    fn with_alpha(identified: &Identified, alpha: Option<f64>) -> Result<Self, ModelAircraftError> {
        let model = identified.model;
        let data = &model.aircraft;
        if !model.axes.has_longitudinal() {
            return Err(ModelAircraftError::LateralAlone(model.name.clone()));
        }
        let mut notes = Vec::new();
        let constant = |key: &'static str, source: &Source| match source {
            Source::Constant(value) => Ok(*value),
            Source::Channel(channel) => {
                Err(ModelAircraftError::Recorded { model: model.name.clone(), key, channel: channel.clone() })
            }
        };
        let (mass, iyy) = (constant("mass", &data.mass)?, constant("iyy", &data.iyy)?);
        let of_body = |key: &'static str, source: &Option<Source>, standard: f64| match source {
            Some(source) if model.axes.has_lateral() => constant(key, source),
            _ => Ok(standard),
        };
        let body = MassInput {
            mass,
            iyy,
            ixx: of_body("ixx", &data.ixx, iyy)?,
            izz: of_body("izz", &data.izz, iyy)?,
            ixz: of_body("ixz", &data.ixz, 0.0)?,
        };
        let database = database(model).map_err(|e| ModelAircraftError::Database(e.to_string()))?;
        let reference = reference_point(model, &database, [density_at_reference(model), mass], alpha)?;
        let mut constants = AircraftConstants::of(model, &database, &reference);
        if !model.axes.has_lateral() && matches!(database, Database::Aircraft(_)) {
            // It is whole without the terms of the file.
            constants.span = data.wing_span.unwrap_or(data.mean_chord);
        } else if !model.axes.has_lateral() {
            // Nothing of the lateral motion refers to it, but it has to be a length.
            constants.span = data.wing_span.unwrap_or(data.mean_chord);
            notes.push("The model has the longitudinal axes alone: nothing rolls, yaws or pushes to the side.".into());
        }
        let mass_properties =
            match model.known.as_ref().filter(|known| is_body_of(known, &body, model.axes.has_lateral())) {
                // With the products of inertia that a model file has no place for.
                Some(known) => *known.aircraft().mass_properties(),
                None => {
                    let properties = body.properties(constants.rotor_momentum);
                    properties.ok_or_else(|| ModelAircraftError::Mass(model.name.clone()))?
                }
            };
        if !model.extra_inputs.is_empty() {
            notes.push(format!("These inputs of the model are 0 in flight: {}.", model.extra_inputs.join(", ")));
        }
        let terms = |c: Coefficient| identified.terms(c).into_iter().map(move |valued| (c, valued.term, valued.value));
        let known = Coefficient::ALL.into_iter().flat_map(terms).filter(|(_, _, value)| *value != 0.0);
        let is_rate = |term: &Term| term.powers().any(|(variable, _)| variable == Variable::AlphaRate.index());
        let (rate_terms, known) = known.partition(|(_, term, _)| is_rate(term));
        // Coefficients of a model file are about the centre of gravity, wherever that is.
        let cg = data.cg.unwrap_or(0.25);
        let geometry = Geometry {
            wing_area: data.wing_area,
            span: constants.span,
            mean_chord: data.mean_chord,
            cg,
            cg_reference: cg,
        };
        let given = model.simulation.engine.as_ref();
        let engine = match (given, &database) {
            (Some(data), _) => Some(Engine::new(data, identified, model.axes.has_lateral(), &mut notes)),
            (None, Database::F16(_) | Database::Aircraft(_)) => None,
            (None, Database::None) => {
                let half = 0.5 * mass * data.gravity;
                notes.push(format!(
                    "The thrust at full throttle is taken to be half the weight, {half:.0} N (largest_thrust in \
                     [simulation])."
                ));
                Some(Engine::Thrust(Schedule::constant(half)))
            }
        };
        let atmosphere = match &data.air_density {
            AirDensity::BookAtmosphere => Atmosphere::Book,
            AirDensity::StandardAtmosphere => Atmosphere::Standard,
            AirDensity::Known(_) => {
                notes.push(
                    "The density of the air is that of the standard atmosphere at the altitude of flight.".into(),
                );
                Atmosphere::Standard
            }
        };
        let (sin, cos) = data.thrust_inclination.sin_cos();
        let [elevator, aileron, rudder] = model.simulation.actuators;
        let (actuators, data_range) = match &database {
            Database::F16(aircraft) => (*aircraft.actuators(), aircraft.data_range()),
            Database::Aircraft(aircraft) => {
                notes.extend_from_slice(aircraft.notes());
                (*aircraft.actuators(), aircraft.data_range())
            }
            Database::None => {
                let range = DataRange { alpha: model.simulation.alpha, ..DataRange::UNSTATED };
                (Actuators { elevator, aileron, rudder }, range)
            }
        };
        let data_range = given.map_or(data_range, |data| engine::within_tables(data, data_range));
        let fuel = model.simulation.fuel;
        if let Some(FuelData { fuel, .. }) = &fuel
            && fuel.burnt(fuel.mass, &mass_properties, data.mean_chord).is_none()
        {
            return Err(ModelAircraftError::Fuel(model.name.clone()));
        }
        if fuel.is_some() {
            notes.push(
                "Fuel is burnt in simulated flights; trims, linear models and FMUs have the mass of the beginning."
                    .into(),
            );
        }
        Ok(Self {
            name: model.name.clone(),
            centre_of_gravity: data.cg,
            aerodynamics: Aerodynamics { constants, database, known, columns: Vec::new() },
            rate_terms,
            geometry,
            mass: mass_properties,
            gravity: data.gravity,
            atmosphere,
            engine,
            fuel,
            thrust_line: [cos, -sin, data.thrust_arm],
            engine_lag_s: model.simulation.engine_lag_s,
            actuators,
            data_range,
            notes,
        })
    }

    /// The sum of terms with values, in body axes; `rate` is the rate of the angle of attack, made dimensionless.
    fn sum<T: Scalar>(
        &self,
        terms: &[Valued],
        air: &AirData<T>,
        rates: [T; 3],
        controls: &Controls<T>,
        rate: T,
    ) -> Coefficients<T> {
        let at = in_air(air, rates);
        let deflections = [controls.elevator, controls.aileron, controls.rudder];
        let mut variables = self.aerodynamics.variables(&at, &deflections, &[0.0; EXTRA_INPUTS]);
        variables[Variable::AlphaRate.index()] = rate;
        let mut sums = [T::from(0.0); 6];
        for (coefficient, term, value) in terms {
            let sum = &mut sums[*coefficient as usize];
            *sum = *sum + term.value(&variables) * *value;
        }
        let (sin, cos) = air.alpha.sin_cos();
        let [lift, drag, cm, cy, cl, cn] = sums;
        let [cx, cz] = lift_drag_to_body(lift, drag, sin, cos);
        Coefficients { cx, cy, cz, cl, cm, cn }
    }

    /// The name that the model file gives the aircraft.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Centre of gravity behind the leading edge of the mean chord, fraction of it, if the file says it.
    pub fn centre_of_gravity(&self) -> Option<f64> {
        self.centre_of_gravity
    }

    /// What the file does not say and is assumed, in sentences.
    pub fn notes(&self) -> &[String] {
        &self.notes
    }
}

/// Whether mass and inertia are those of the aircraft of the base: of the longitudinal axes alone only mass and Iyy count.
fn is_body_of(known: &KnownAircraft, body: &MassInput, lateral: bool) -> bool {
    let [ixx, iyy, izz, ixz] = known.inertia();
    let same = body.mass == known.aircraft().mass_properties().mass() && body.iyy == iyy;
    same && (!lateral || [body.ixx, body.izz, body.ixz] == [ixx, izz, ixz])
}

/// Density of the air at the reference point, kg/m^3; not a number where it comes from a record.
fn density_at_reference(model: &ModelFile) -> f64 {
    match &model.aircraft.air_density {
        AirDensity::Known(Source::Constant(density)) => *density,
        _ => f64::NAN,
    }
}

/// Where the terms count from; `alpha` takes the place of an angle of attack that would come from a record.
fn reference_point(
    model: &ModelFile,
    database: &Database,
    [density, mass]: [f64; 2],
    alpha: Option<f64>,
) -> Result<ReferencePoint, ModelAircraftError> {
    let trim =
        reference_trim(model, database, density, mass).map_err(|e| ModelAircraftError::Database(e.to_string()))?;
    let value = |what: &'static str, wanted: ReferenceValue, trimmed: Option<f64>| match (wanted, trimmed) {
        (ReferenceValue::Given(value), _) | (ReferenceValue::Trim, Some(value)) => Ok(value),
        _ => Err(ModelAircraftError::FirstSample { model: model.name.clone(), what }),
    };
    let wanted = &model.reference;
    Ok(ReferencePoint {
        alpha: match (wanted.alpha, alpha) {
            (ReferenceValue::FirstSample, Some(alpha)) => alpha,
            (wanted, _) => value("alpha", wanted, trim.map(|t| t.alpha))?,
        },
        elevator: value("elevator", wanted.elevator, trim.map(|t| t.elevator))?,
        aileron: value("aileron", wanted.aileron, Some(0.0))?,
        rudder: value("rudder", wanted.rudder, Some(0.0))?,
    })
}

fn in_air<T: Scalar>(air: &AirData<T>, rates: [T; 3]) -> Air<T> {
    Air { speed: air.speed, alpha: air.alpha, beta: air.beta, rates, density: air.density, mach: Some(air.mach) }
}

impl Aircraft for ModelAircraft {
    fn geometry(&self) -> &Geometry {
        &self.geometry
    }

    fn mass_properties(&self) -> &MassProperties {
        &self.mass
    }

    fn gravity(&self) -> f64 {
        self.gravity
    }

    fn atmosphere(&self) -> Atmosphere {
        self.atmosphere
    }

    fn coefficients<T: Scalar>(&self, air: &AirData<T>, rates: [T; 3], controls: &Controls<T>) -> Coefficients<T> {
        let at = in_air(air, rates);
        let deflections = [controls.elevator, controls.aileron, controls.rudder];
        let variables = self.aerodynamics.variables(&at, &deflections, &[0.0; EXTRA_INPUTS]);
        let (sin, cos) = air.alpha.sin_cos();
        self.aerodynamics.coefficients(&[], &at, &variables, &deflections, sin, cos)
    }

    fn alpha_rate_coefficients<T: Scalar>(
        &self,
        air: &AirData<T>,
        rates: [T; 3],
        controls: &Controls<T>,
    ) -> Option<Coefficients<T>> {
        let known = match &self.aerodynamics.database {
            Database::Aircraft(aircraft) => aircraft.alpha_rate_coefficients(air, rates, controls),
            _ => None,
        };
        if self.rate_terms.is_empty() {
            return known;
        }
        // Its terms are of first order: their value at 1 rad/s is their slope.
        let rate = (air.speed * 2.0).recip() * self.geometry.mean_chord;
        let terms = self.sum(&self.rate_terms, air, rates, controls, rate);
        Some(match known {
            None => terms,
            Some(known) => Coefficients {
                cx: terms.cx + known.cx,
                cy: terms.cy + known.cy,
                cz: terms.cz + known.cz,
                cl: terms.cl + known.cl,
                cm: terms.cm + known.cm,
                cn: terms.cn + known.cn,
            },
        })
    }

    fn propulsion<T: Scalar>(&self, power: T, altitude: T, mach: T) -> Propulsion<T> {
        let zero = T::from(0.0);
        let thrust = match (&self.engine, &self.aerodynamics.database) {
            (Some(engine), _) => {
                return engine.propulsion(At { power, altitude, mach }, self.atmosphere, self.thrust_line);
            }
            (None, Database::F16(aircraft)) => aircraft.propulsion(power, altitude, mach).force[0],
            // Its engines have places and directions of their own.
            (None, Database::Aircraft(aircraft)) => return aircraft.propulsion(power, altitude, mach),
            (None, Database::None) => zero,
        };
        let [along_x, along_z, arm] = self.thrust_line;
        Propulsion { force: [thrust * along_x, zero, thrust * along_z], moment: [zero, thrust * arm, zero] }
    }

    fn slipstream_coefficients<T: Scalar>(
        &self,
        propulsion: &Propulsion<T>,
        air: &AirData<T>,
        rates: [T; 3],
        controls: &Controls<T>,
    ) -> Option<Coefficients<T>> {
        let (rise, terms) = self.engine.as_ref()?.slipstream(propulsion, air, self.thrust_line)?;
        let Coefficients { cx, cy, cz, cl, cm, cn } = self.sum(terms, air, rates, controls, T::from(0.0));
        Some(Coefficients { cx: cx * rise, cy: cy * rise, cz: cz * rise, cl: cl * rise, cm: cm * rise, cn: cn * rise })
    }

    fn fuel_flow(&self, power: f64, altitude: f64, mach: f64) -> f64 {
        let Some(FuelData { flow, least_flow, .. }) = &self.fuel else { return 0.0 };
        let of_engine = match flow {
            FuelFlow::ByThrust(flow) => flow * self.propulsion(power, altitude, mach).thrust(),
            FuelFlow::ByPower(flow) => {
                let at = At { power, altitude, mach };
                flow * self.engine.as_ref().and_then(|engine| engine.power(at, self.atmosphere)).unwrap_or(0.0)
            }
        };
        of_engine.max(*least_flow)
    }

    fn after_burning(&self, burnt: f64) -> Option<Burnt> {
        self.fuel?.fuel.burnt(burnt, &self.mass, self.geometry.mean_chord)
    }

    fn power_rate<T: Scalar>(&self, throttle: T, power: T) -> T {
        match (&self.engine, &self.aerodynamics.database) {
            (None, Database::F16(aircraft)) => aircraft.power_rate(throttle, power),
            (None, Database::Aircraft(aircraft)) => aircraft.power_rate(throttle, power),
            (Some(_), _) | (None, Database::None) => (throttle * 100.0 - power) / self.engine_lag_s,
        }
    }

    fn steady_power<T: Scalar>(&self, throttle: T) -> T {
        match (&self.engine, &self.aerodynamics.database) {
            (None, Database::F16(aircraft)) => aircraft.steady_power(throttle),
            (None, Database::Aircraft(aircraft)) => aircraft.steady_power(throttle),
            (Some(_), _) | (None, Database::None) => throttle * 100.0,
        }
    }

    fn actuators(&self) -> &Actuators {
        &self.actuators
    }

    fn data_range(&self) -> DataRange {
        self.data_range
    }
}
