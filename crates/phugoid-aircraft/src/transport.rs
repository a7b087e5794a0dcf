//! The Generic Transport Model of NASA, undamaged and with damage that was measured: a transport of 26 kg, dynamically scaled
//! to 5.5 %, with aerodynamics to high angles of attack and six cases of damage with their own mass, centre of gravity and
//! inertia.
//!
//! Its tables are data beside the program, under an agreement of their own, and are read at run time; what is in them, the
//! equations and the assumptions stand in `docs/transport.md`.
//!
//! [`Transport`] is an [`Aircraft`] like any other: trim, linear models, scenarios and studies work on it.
//! [`Transport::damaged`] is the same aircraft with a damage, [`fly_damaged`] a flight in which damage happens.

mod aerodynamics;
pub(crate) mod axis;
mod damage;
mod error;
mod flight;
mod options;
pub(crate) mod read;
mod tables;
mod vehicle;

use std::path::Path;
use std::sync::Arc;

use phugoid_flight_dynamics::actuator::{Actuator, Actuators};
use phugoid_flight_dynamics::aircraft::{AirData, Aircraft, Coefficients, Controls, DataRange, Geometry, Propulsion};
use phugoid_flight_dynamics::atmosphere::Atmosphere;
use phugoid_flight_dynamics::globe::vector::{cross, subtract};
use phugoid_flight_dynamics::mass::MassProperties;
use phugoid_flight_dynamics::scalar::Scalar;

use self::aerodynamics::Aerodynamics;
use self::axis::blend_1;
pub use self::damage::Damage;
pub use self::error::TransportError;
pub use self::flight::{fly_damaged, moved_to};
pub use self::options::{RateModel, TransportOptions};
use self::tables::Tables;
use self::vehicle::VehicleData;

/// rad per degree.
const DEGREE: f64 = std::f64::consts::PI / 180.0;
/// Angles of attack and sideslip, deg, in which the data of the whole and of the damaged aircraft are good: beyond, the
/// polynomials behind the tables reach values that no aircraft has, and the damage was not measured.
const WHOLE: [[f64; 2]; 2] = [[-5.0, 40.0], [-30.0, 30.0]];
const DAMAGED: [[f64; 2]; 2] = [[-4.0, 30.0], [-20.0, 20.0]];
/// Pressure of the air at sea level, Pa, and ratio of specific heats of air.
const SEA_LEVEL_PRESSURE: f64 = 101_325.0;
const RATIO_OF_HEATS: f64 = 1.4;
/// Largest deflections, deg: those of the tables for elevator (upwards) and aileron, and 30 deg for the rudder.
const LIMIT: f64 = 30.0;

/// The Generic Transport Model in one configuration: damage and settings.
///
/// ```no_run
/// use phugoid_aircraft::transport::{Damage, Transport};
/// use phugoid_flight_dynamics::trim::{TrimCondition, trim};
///
/// let whole = Transport::open("shared/data/gtm")?;
/// let damaged = whole.damaged(Damage::LeftStabiliserOff)?;
/// for aircraft in [&whole, &damaged] {
///     let level = trim(aircraft, &TrimCondition::steady(aircraft, 40.0, 300.0, 0.0, 0.0))?;
///     println!("{}: elevator {:.2} deg", aircraft.damage(), level.elevator_rad.to_degrees());
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// Signs of the controls are those of [`Controls`]: elevator positive with the trailing edge down; aileron positive with the
/// trailing edge of the right one down and of the left one up by the same angle; rudder positive with the trailing edge to the
/// left. These are the signs of the tables too.
///
/// Derivatives (of dual numbers) are those of the piecewise linear tables, and on a point of a table the mean of both sides.
#[derive(Clone, Debug)]
pub struct Transport {
    data: Arc<Data>,
    options: TransportOptions,
    aerodynamics: Aerodynamics,
    geometry: Geometry,
    mass: MassProperties,
    /// Centre of gravity in structural axes, m.
    centre: [f64; 3],
    /// From the centre of gravity to the moment reference point, body axes, m.
    arm: [f64; 3],
    /// Force and moment about the centre of gravity, body axes, of 1 N of thrust of each engine.
    push: [[f64; 3]; 2],
    actuators: Actuators,
    name: String,
    notes: Vec<String>,
}

/// What all configurations share.
#[derive(Debug)]
struct Data {
    tables: Arc<Tables>,
    vehicle: VehicleData,
}

impl Transport {
    /// The undamaged aircraft from the folder with `vehicle.json` and `tables`, with the default [`TransportOptions`].
    ///
    /// # Errors
    /// [`TransportError`] names the file and the key of what is missing or makes no sense.
    pub fn open(folder: impl AsRef<Path>) -> Result<Self, TransportError> {
        Self::open_with(folder, &TransportOptions::default())
    }

    /// As [`open`](Self::open), with options.
    ///
    /// # Errors
    /// As [`open`](Self::open), and for an option that is out of its range.
    pub fn open_with(folder: impl AsRef<Path>, options: &TransportOptions) -> Result<Self, TransportError> {
        let folder = folder.as_ref();
        let vehicle = VehicleData::read(folder)?;
        let chord_by_span = vehicle.geometry.mean_chord / vehicle.geometry.span;
        let tables = Arc::new(Tables::read(folder, chord_by_span)?);
        Self::new(Arc::new(Data { tables, vehicle }), options)
    }

    /// The same aircraft with other options; the tables are shared.
    ///
    /// # Errors
    /// [`TransportError`] for an option that is out of its range.
    pub fn with(&self, options: &TransportOptions) -> Result<Self, TransportError> {
        Self::new(Arc::clone(&self.data), options)
    }

    /// The same aircraft with this damage in place of its own; the tables are shared.
    ///
    /// # Errors
    /// [`TransportError`] if mass and inertia are not positive with the changes of the data.
    pub fn damaged(&self, damage: Damage) -> Result<Self, TransportError> {
        self.with(&TransportOptions { damage, ..self.options })
    }

    /// The damage of this aircraft.
    pub fn damage(&self) -> Damage {
        self.options.damage
    }

    /// The options of this aircraft.
    pub fn options(&self) -> &TransportOptions {
        &self.options
    }

    /// Centre of gravity, m, in structural axes: x forward, y to the right, z down; the origin is ahead of the nose.
    pub fn centre_of_gravity(&self) -> [f64; 3] {
        self.centre
    }

    /// Coefficients in body axes with moments about the reference point of the data, at 25 % of the mean chord, from angle of
    /// attack and sideslip (rad), the dimensionless rates `[p b/2V, q cbar/2V, r b/2V]` and the surface positions.
    pub fn coefficients_about_reference<T: Scalar>(
        &self,
        alpha: T,
        beta: T,
        rates: [T; 3],
        controls: &Controls<T>,
    ) -> Coefficients<T> {
        let [cx, cy, cz, cl, cm, cn] = self.aerodynamics.coefficients(alpha, beta, rates, controls);
        Coefficients { cx, cy, cz, cl, cm, cn }
    }

    /// As [`coefficients_about_reference`](Self::coefficients_about_reference) without what the rates add. The tables of forced
    /// oscillation are not all zero at a rate of zero, so that this differs a little from the coefficients without rates.
    pub fn static_coefficients_about_reference<T: Scalar>(
        &self,
        alpha: T,
        beta: T,
        controls: &Controls<T>,
    ) -> Coefficients<T> {
        let [cx, cy, cz, cl, cm, cn] = self.aerodynamics.without_rates(alpha, beta, controls);
        Coefficients { cx, cy, cz, cl, cm, cn }
    }

    fn new(data: Arc<Data>, options: &TransportOptions) -> Result<Self, TransportError> {
        options.check(&data.tables)?;
        let vehicle = &data.vehicle;
        let mut mass = vehicle.mass.with_fuel(&vehicle.tanks, options.fuel);
        if options.gear_down {
            mass = mass.plus(&vehicle.gear_down);
        }
        let change = options.damage.case().checked_sub(1).and_then(|case| vehicle.damage.get(case));
        if let Some(change) = change {
            mass = mass.plus(&change.mass);
        }
        let gone = change.map(|change| change.gone).unwrap_or_default();
        let centre = mass.centre;
        let mut push = [[0.0; 3]; 2];
        for engine in vehicle.engines {
            let moment = cross(subtract(engine.position, centre), engine.direction);
            for (sum, part) in push.iter_mut().zip([engine.direction, moment]) {
                *sum = std::array::from_fn(|i| sum[i] + part[i]);
            }
        }
        let geometry =
            Geometry { cg: (-centre[0] - vehicle.leading_edge) / vehicle.geometry.mean_chord, ..vehicle.geometry };
        let actuator = Actuator::new(LIMIT * DEGREE, options.surface_rate, options.actuator_lag);
        let properties = MassProperties::from_tensor(mass.mass, mass.tensor(), 0.0);
        Ok(Self {
            options: *options,
            aerodynamics: Aerodynamics::new(Arc::clone(&data.tables), options, &gone),
            geometry,
            mass: properties.ok_or(TransportError::Mass { damage: options.damage.word() })?,
            centre,
            arm: subtract(vehicle.reference, centre),
            push,
            actuators: Actuators { elevator: actuator, aileron: actuator, rudder: actuator },
            data,
            name: match options.damage {
                Damage::None => "Generic Transport Model".to_owned(),
                damage => format!("Generic Transport Model, {damage}"),
            },
            notes: notes(options),
        })
    }

    /// The name, with the damage.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// What the data do not give and is assumed, and the settings that stay as they are, in sentences.
    pub fn notes(&self) -> &[String] {
        &self.notes
    }
}

fn notes(options: &TransportOptions) -> Vec<String> {
    let degrees = |angle: f64| angle / DEGREE;
    let gear = if options.gear_down { "down" } else { "up" };
    vec![
        format!(
            "It stays so in flight: stabiliser at {} deg, flaps at {} deg, landing gear {gear}, {} % of the fuel.",
            degrees(options.stabiliser),
            degrees(options.flaps),
            100.0 * options.fuel
        ),
        format!(
            "Assumed: surfaces with a lag of {:.3} s, at most {:.0} deg/s and {LIMIT} deg to either side; engines with a lag of \
             {} s.",
            options.actuator_lag,
            degrees(options.surface_rate),
            options.engine_lag
        ),
    ]
}

impl Aircraft for Transport {
    fn geometry(&self) -> &Geometry {
        &self.geometry
    }

    fn mass_properties(&self) -> &MassProperties {
        &self.mass
    }

    fn gravity(&self) -> f64 {
        self.options.gravity
    }

    fn atmosphere(&self) -> Atmosphere {
        Atmosphere::Standard
    }

    fn coefficients<T: Scalar>(&self, air: &AirData<T>, rates: [T; 3], controls: &Controls<T>) -> Coefficients<T> {
        let Geometry { span, mean_chord, .. } = self.geometry;
        let time = (air.speed * 2.0).recip();
        let hats = [rates[0] * (time * span), rates[1] * (time * mean_chord), rates[2] * (time * span)];
        let Coefficients { cx, cy, cz, cl, cm, cn } =
            self.coefficients_about_reference(air.alpha, air.beta, hats, controls);
        // The moment of the force at the reference point about the centre of gravity.
        let [x, y, z] = self.arm;
        Coefficients {
            cx,
            cy,
            cz,
            cl: cl + (cz * y - cy * z) / span,
            cm: cm + (cx * z - cz * x) / mean_chord,
            cn: cn + (cy * x - cx * y) / span,
        }
    }

    fn propulsion<T: Scalar>(&self, power: T, altitude: T, mach: T) -> Propulsion<T> {
        let vehicle = &self.data.vehicle;
        let pressure = self.atmosphere().at(altitude).pressure;
        let [static_thrust] = blend_1(&vehicle.thrust, &vehicle.handle.place_within(power));
        let ram_drag = pressure * mach * mach * (0.5 * RATIO_OF_HEATS * vehicle.ram_drag * self.geometry.wing_area);
        let mut thrust = static_thrust * (pressure / SEA_LEVEL_PRESSURE) - ram_drag;
        if thrust.real() < 0.0 {
            thrust = T::from(0.0);
        }
        let [force, moment] = self.push.map(|each| each.map(|part| thrust * part));
        Propulsion { force, moment }
    }

    fn power_rate<T: Scalar>(&self, throttle: T, power: T) -> T {
        (self.steady_power(throttle) - power) / self.options.engine_lag
    }

    fn steady_power<T: Scalar>(&self, throttle: T) -> T {
        let real = throttle.real();
        if real < 0.0 {
            T::from(0.0)
        } else if real > 1.0 {
            T::from(100.0)
        } else {
            throttle * 100.0
        }
    }

    fn actuators(&self) -> &Actuators {
        &self.actuators
    }

    fn data_range(&self) -> DataRange {
        let [alpha, beta] = if self.options.damage == Damage::None { WHOLE } else { DAMAGED };
        let tables = &self.data.tables;
        let rudder = -tables.rudder.ends()[0];
        DataRange {
            alpha: alpha.map(f64::to_radians),
            beta: beta.map(f64::to_radians),
            elevator: tables.elevator.ends(),
            aileron: tables.aileron.ends(),
            rudder: [-rudder, rudder],
            ..DataRange::UNSTATED
        }
    }
}
