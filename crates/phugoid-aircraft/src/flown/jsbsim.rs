//! An aircraft of JSBSim over a flat earth.

use std::path::Path;
use std::sync::{Mutex, MutexGuard, PoisonError};

use phugoid_flight_dynamics::actuator::Actuators;
use phugoid_flight_dynamics::aircraft::{
    AirData, Aircraft as Flown, Coefficients, Controls, DataRange, Geometry, Propulsion,
};
use phugoid_flight_dynamics::atmosphere::Atmosphere;
use phugoid_flight_dynamics::mass::MassProperties;
use phugoid_flight_dynamics::scalar::Scalar;

use super::FlownError;
use super::surface::{LAG_S, Surface, surfaces};
use crate::jsbsim::{Aircraft, Engine, EngineKind, Evaluator, FlightCondition, Moment, altitude_of_density_m};
use crate::transport::Damage;

/// What makes the thrust.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub enum Thrust {
    /// The engines of the files, with their places and, of propellers, their torque. Where one of them has no model here, or
    /// there is none, a force along body x through the centre of gravity, of half the weight at full throttle.
    #[default]
    Engines,
    /// A force along body x through the centre of gravity, in proportion to the throttle.
    AlongBodyX {
        /// The force at full throttle, N; a positive number.
        largest_n: f64,
    },
}

/// What is not in the files, or is to be another.
#[derive(Clone, Debug, PartialEq)]
pub struct FlownOptions {
    /// Acceleration of gravity, m/s2, the same at every altitude; a positive number, 9.80665 by default.
    pub gravity: f64,
    /// What makes the thrust: the engines by default.
    pub thrust: Thrust,
    /// What the thrust and its moments are multiplied by; not negative, 1 by default.
    pub thrust_scale: f64,
    /// Properties by name with their values in the units of JSBSim, set once: contents of tanks, flaps, gear. By default the
    /// gear is up (`gear/gear-pos-norm` is 0).
    pub properties: Vec<(String, f64)>,
    /// Damage, which the Generic Transport Model alone has; none by default.
    pub damage: Damage,
}

impl Default for FlownOptions {
    fn default() -> Self {
        Self {
            gravity: 9.80665,
            thrust: Thrust::Engines,
            thrust_scale: 1.0,
            properties: Vec::new(),
            damage: Damage::None,
        }
    }
}

/// Speed (m/s), angle of attack and sideslip (rad), density (kg/m3), Mach number, p, q, r (rad/s), elevator, aileron, rudder
/// (rad, in the signs of the equations of motion).
const VARIABLES: usize = 11;
/// Steps of the central differences: those of speed, density and Mach number are shares of them. Values carry rounding of some
/// 1e-16, so that derivatives of smooth data are good to 1e-10; those of a kink within a step are between both sides.
const STEPS: [f64; VARIABLES] = [1e-5, 1e-5, 1e-5, 1e-5, 1e-5, 1e-4, 1e-4, 1e-4, 1e-5, 1e-5, 1e-5];
const IS_SHARE: [bool; VARIABLES] = [true, false, false, true, true, false, false, false, false, false, false];
/// Rate of the angle of attack, rad/s, whose coefficients less those without it give the slope: they are linear in it.
const ALPHA_RATE: f64 = 0.1;
/// Steps of power (percent), altitude (m) and Mach number for the derivatives of thrust.
const THRUST_STEPS: [f64; 3] = [1e-2, 1.0, 1e-5];
/// Time constant of the engines behind the throttle, s.
const ENGINE_LAG_S: f64 = 1.0;
/// Where the reference point of the aerodynamics is taken to be, in chords.
const QUARTER: f64 = 0.25;
/// Gas constant of air, J/(kg K), and its ratio of specific heats.
const GAS: f64 = 8314.32 / 28.9644;
const RATIO_OF_HEATS: f64 = 1.4;

/// An evaluator between two calls, and what it computed last.
#[derive(Clone, Debug)]
struct Slot {
    moment: Moment,
    at: [f64; VARIABLES],
    coefficients: [f64; 6],
}

/// Evaluators that are not in use: each thread takes one for the time of a call.
#[derive(Debug, Default)]
struct Pool(Mutex<Vec<Slot>>);

impl Pool {
    fn slots(&self) -> MutexGuard<'_, Vec<Slot>> {
        // A slot is whole whenever it is here, whatever happened to a thread.
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Clone for Pool {
    fn clone(&self) -> Self {
        Self::default()
    }
}

/// The thrust as it is made.
#[derive(Clone, Debug)]
enum Drive {
    /// Throttles of the engines, each with the most of it.
    Engines(Vec<(usize, f64)>),
    /// Along body x, N at full power.
    Force(f64),
}

/// An aircraft of JSBSim that trim, linear models and simulation fly over a flat earth.
///
/// Coefficients are those of the files at every instant, about the centre of gravity. Derivatives (of dual numbers) are central
/// differences with steps of 1e-5 rad, 1e-4 rad/s and 1e-5 of speed, density and Mach number: good to some 1e-9 between the
/// kinks of tables. They cost 22 evaluations in place of one. Where the aerodynamics read the rate of the angle of attack, it is
/// solved with the accelerations; its coefficients, per rad/s, are taken to change with the speed alone as `1/V`.
///
/// The aerodynamics see the attitude of straight flight in the plane of symmetry (pitch angle equal to the angle of attack),
/// no rate of sideslip, no engines, and the height that the density has in the standard atmosphere. Mass and inertia stay those
/// of the beginning. Flight control does not run: the surfaces are where they are put. What is not finite in gives what is not
/// finite out.
///
/// The engines follow the throttle with a lag of 1 s, and push as in axial flow; power is the throttle in percent. It is
/// `Send` and `Sync`: threads evaluate side by side.
#[derive(Clone, Debug)]
pub struct FlownJsbsim {
    aircraft: Aircraft,
    start: Moment,
    aerodynamics: Pool,
    propulsion: Pool,
    geometry: Geometry,
    mass: MassProperties,
    gravity: f64,
    drive: Drive,
    thrust_scale: f64,
    surfaces: [Surface; 3],
    actuators: Actuators,
    data_range: DataRange,
    /// The rate of the angle of attack in rad/s and in deg/s, where the aerodynamics read it.
    alpha_rate: Option<[usize; 2]>,
    hysteresis: Option<usize>,
    notes: Vec<String>,
}

impl FlownJsbsim {
    /// Opens the aircraft of a file, or of a folder `name` the one in `name/name.xml`.
    ///
    /// # Errors
    /// [`FlownError`]: files that cannot be read, a surface that cannot be moved by its angle, no mass.
    pub fn open(path: impl AsRef<Path>) -> Result<Self, FlownError> {
        Self::open_with(path, &FlownOptions::default())
    }

    /// As [`open`](Self::open), with options.
    ///
    /// # Errors
    /// As [`open`](Self::open), and for an option that makes no sense.
    pub fn open_with(path: impl AsRef<Path>, options: &FlownOptions) -> Result<Self, FlownError> {
        Self::new(Aircraft::open(path)?, options)
    }

    /// From an aircraft that was read.
    ///
    /// # Errors
    /// As [`open_with`](Self::open_with), but for the files.
    pub fn new(aircraft: Aircraft, options: &FlownOptions) -> Result<Self, FlownError> {
        check(options)?;
        let mut notes: Vec<String> = aircraft.omitted().iter().map(ToString::to_string).collect();
        let surfaces = surfaces(&aircraft, &mut notes)?;
        let mut evaluator = started(&aircraft, options)?;
        let masses = evaluator.mass_properties();
        let mass = MassProperties::from_tensor(masses.mass_kg, masses.inertia_kg_m2, 0.0).ok_or(FlownError::Mass)?;
        let geometry = geometry(&aircraft, masses.centre_of_gravity_m[0])?;
        notes.push("The reference point of the aerodynamics is taken to be at a quarter of the chord.".into());
        notes.push(format!(
            "Flight control does not run: surfaces follow their commands with a lag of {LAG_S} s and no limit of rate."
        ));
        let drive = drive(&aircraft, options.thrust, mass.mass() * options.gravity, &mut notes);
        let reads_rate = note_inputs(&aircraft, &surfaces, &mut evaluator, &mut notes);
        let alpha_rate = match ["rad", "deg"].map(|unit| aircraft.property(&format!("aero/alphadot-{unit}_sec"))) {
            [Some(radians), Some(degrees)] if reads_rate => Some([radians, degrees]),
            _ => None,
        };
        let alpha = aircraft.alpha_of_tables().unwrap_or(DataRange::UNSTATED.alpha);
        let [elevator, aileron, rudder] = [0, 1, 2].map(|i: usize| surfaces[i].actuator);
        Ok(Self {
            start: evaluator.into_moment(),
            aerodynamics: Pool::default(),
            propulsion: Pool::default(),
            geometry,
            mass,
            gravity: options.gravity,
            drive,
            thrust_scale: options.thrust_scale,
            surfaces,
            actuators: Actuators { elevator, aileron, rudder },
            data_range: DataRange { alpha, ..DataRange::UNSTATED },
            alpha_rate,
            hysteresis: aircraft.property("aero/stall-hyst-norm"),
            notes,
            aircraft,
        })
    }

    /// The name that the file gives.
    pub fn name(&self) -> &str {
        self.aircraft.name()
    }

    /// The aircraft of the files.
    pub fn aircraft(&self) -> &Aircraft {
        &self.aircraft
    }

    /// What the files ask for and is left out, and what is assumed, in sentences.
    pub fn notes(&self) -> &[String] {
        &self.notes
    }

    /// Lends an evaluator that is not in use.
    fn lend<R>(
        &self,
        pool: &Pool,
        with: impl FnOnce(&mut Evaluator<'_>, &mut [f64; VARIABLES], &mut [f64; 6]) -> R,
    ) -> R {
        let free = pool.slots().pop();
        let Slot { moment, mut at, mut coefficients } = free.unwrap_or_else(|| Slot {
            moment: self.start.clone(),
            at: [f64::NAN; VARIABLES],
            coefficients: [f64::NAN; 6],
        });
        let mut evaluator = Evaluator::resume(&self.aircraft, moment);
        let result = with(&mut evaluator, &mut at, &mut coefficients);
        pool.slots().push(Slot { moment: evaluator.into_moment(), at, coefficients });
        result
    }

    /// Puts the evaluator into a flight without a rate of the angle of attack.
    fn set(&self, evaluator: &mut Evaluator<'_>, x: &[f64; VARIABLES]) {
        let &[speed, alpha, beta, density, mach, p, q, r, ..] = x;
        let sound = speed / mach;
        let temperature = sound * sound / (RATIO_OF_HEATS * GAS);
        let height = altitude_of_density_m(density);
        evaluator.set_flight(&FlightCondition {
            airspeed_m_s: speed,
            alpha_rad: alpha,
            beta_rad: beta,
            alphadot_rad_s: 0.0,
            betadot_rad_s: 0.0,
            rates_rad_s: [p, q, r],
            attitude_rad: [0.0, alpha, 0.0],
            height_m: height,
            height_above_ground_m: height,
            density_kg_m3: density,
            pressure_pa: density * GAS * temperature,
            temperature_k: temperature,
            sound_speed_m_s: sound,
        });
        for (surface, angle) in self.surfaces.iter().zip(&x[8..]) {
            surface.set(evaluator, *angle);
        }
        if let Some(index) = self.hysteresis {
            // Forces follow from the flight alone, whatever was before it.
            evaluator.set_index(index, 0.0);
        }
    }

    /// Force coefficients along body x, y, z, moment coefficients about them.
    fn evaluated(&self, evaluator: &mut Evaluator<'_>, x: &[f64; VARIABLES]) -> [f64; 6] {
        let sum = evaluator.aerodynamic_force_moment();
        let force = 0.5 * x[3] * x[0] * x[0] * self.geometry.wing_area;
        let [l, m, n] = sum.moment_n_m;
        let [cx, cy, cz] = sum.force_n.map(|newton| newton / force);
        let (span, chord) = (force * self.geometry.span, force * self.geometry.mean_chord);
        [cx, cy, cz, l / span, m / chord, n / span]
    }

    fn at(&self, x: &[f64; VARIABLES]) -> [f64; 6] {
        self.lend(&self.aerodynamics, |evaluator, at, coefficients| {
            self.set(evaluator, x);
            (*at, *coefficients) = (*x, self.evaluated(evaluator, x));
            *coefficients
        })
    }

    /// The change of the coefficients with the rate of the angle of attack, per rad/s.
    fn by_alpha_rate(&self, x: &[f64; VARIABLES], [radians, degrees]: [usize; 2]) -> [f64; 6] {
        self.lend(&self.aerodynamics, |evaluator, at, coefficients| {
            // As a rule the evaluator is still in this flight, from the coefficients without the rate.
            if at != x {
                self.set(evaluator, x);
                *coefficients = self.evaluated(evaluator, x);
            }
            evaluator.set_index(radians, ALPHA_RATE);
            evaluator.set_index(degrees, ALPHA_RATE.to_degrees());
            let with = self.evaluated(evaluator, x);
            // Now it is in another.
            *at = [f64::NAN; VARIABLES];
            std::array::from_fn(|i| (with[i] - coefficients[i]) / ALPHA_RATE)
        })
    }

    /// Force and moment of the engines at power (percent), altitude (m) and Mach number.
    fn pushed(&self, throttles: &[(usize, f64)], [power, altitude, mach]: [f64; 3]) -> [f64; 6] {
        self.lend(&self.propulsion, |evaluator, _, _| {
            let air = Atmosphere::Standard.at(altitude);
            evaluator.set_flight(&FlightCondition {
                airspeed_m_s: mach * air.speed_of_sound,
                alpha_rad: 0.0,
                beta_rad: 0.0,
                alphadot_rad_s: 0.0,
                betadot_rad_s: 0.0,
                rates_rad_s: [0.0; 3],
                attitude_rad: [0.0; 3],
                height_m: altitude,
                height_above_ground_m: altitude,
                density_kg_m3: air.density,
                pressure_pa: air.pressure,
                temperature_k: air.temperature,
                sound_speed_m_s: air.speed_of_sound,
            });
            for &(throttle, most) in throttles {
                evaluator.set_index(throttle, 0.01 * power.clamp(0.0, 100.0) * most);
            }
            let push = evaluator.propulsive_force_moment();
            let ([x, y, z], [l, m, n]) = (push.force_n, push.moment_n_m);
            [x, y, z, l, m, n].map(|value| value * self.thrust_scale)
        })
    }
}

fn check(options: &FlownOptions) -> Result<(), FlownError> {
    let largest = match options.thrust {
        Thrust::Engines => 1.0,
        Thrust::AlongBodyX { largest_n } => largest_n,
    };
    for (what, value, sound, expected) in [
        ("the acceleration of gravity, m/s2,", options.gravity, options.gravity > 0.0, "positive"),
        ("the scale of thrust", options.thrust_scale, options.thrust_scale >= 0.0, "0 or more"),
        ("the largest thrust, N,", largest, largest > 0.0, "positive"),
    ] {
        if !(sound && value.is_finite()) {
            return Err(FlownError::Number { what, value, expected });
        }
    }
    Ok(())
}

/// An evaluator with the properties of the options.
fn started<'a>(aircraft: &'a Aircraft, options: &FlownOptions) -> Result<Evaluator<'a>, FlownError> {
    let mut evaluator = Evaluator::new(aircraft);
    evaluator.set("gear/gear-pos-norm", 0.0);
    for engine in 0..aircraft.engines().len() {
        // Propellers of constant speed at their fastest.
        evaluator.set(&format!("fcs/advance-pos-norm[{engine}]"), 1.0);
    }
    for (name, value) in &options.properties {
        if !value.is_finite() {
            return Err(FlownError::Number { what: "a property", value: *value, expected: "a finite number" });
        }
        if !evaluator.set(name, *value) {
            return Err(FlownError::Property { name: name.clone() });
        }
    }
    Ok(evaluator)
}

fn geometry(aircraft: &Aircraft, centre_m: f64) -> Result<Geometry, FlownError> {
    let sizes = aircraft.geometry();
    for (what, value) in [
        ("the area of the wing, m2,", sizes.wing_area_m2),
        ("the span of the wing, m,", sizes.wing_span_m),
        ("the chord of the wing, m,", sizes.chord_m),
    ] {
        if !(value > 0.0 && value.is_finite()) {
            return Err(FlownError::Number { what, value, expected: "positive" });
        }
    }
    let aft = centre_m - sizes.reference_point_m[0];
    Ok(Geometry {
        wing_area: sizes.wing_area_m2,
        span: sizes.wing_span_m,
        mean_chord: sizes.chord_m,
        cg: QUARTER + aft / sizes.chord_m,
        cg_reference: QUARTER,
    })
}

/// Notes what the aerodynamics read and nothing changes; whether they read the rate of the angle of attack.
fn note_inputs(
    aircraft: &Aircraft,
    surfaces: &[Surface; 3],
    evaluator: &mut Evaluator<'_>,
    notes: &mut Vec<String>,
) -> bool {
    let read = aircraft.aerodynamics_read();
    if read.iter().any(|name| name.starts_with("aero/betadot-")) {
        notes.push("The rate of the sideslip angle, which the aerodynamics read, is taken to be 0.".into());
    }
    if read.iter().any(|name| name.starts_with("propulsion/engine")) {
        notes.push("What the engines add to the aerodynamics is left out.".into());
    }
    for name in read.iter().filter(|name| name.starts_with("fcs/") || name.starts_with("gear/")) {
        let Some(index) = aircraft.property(name) else { continue };
        let moved = surfaces.iter().any(|surface| surface.sets(index));
        let angle = ["elevator-pos-", "aileron-pos-", "rudder-pos-"].iter().any(|word| name.contains(word));
        if !moved && !angle {
            notes.push(format!("{name} stays at {}.", evaluator.get(name).unwrap_or(f64::NAN)));
        }
    }
    read.iter().any(|name| name.starts_with("aero/alphadot-"))
}

fn drive(aircraft: &Aircraft, thrust: Thrust, weight_n: f64, notes: &mut Vec<String>) -> Drive {
    if let Thrust::AlongBodyX { largest_n } = thrust {
        notes.push(format!(
            "Thrust is a force along body x through the centre of gravity, {largest_n:.0} N at full throttle."
        ));
        return Drive::Force(largest_n);
    }
    let engines = aircraft.engines();
    let throttles: Vec<_> = engines
        .iter()
        .enumerate()
        .filter(|(_, engine)| matches!(engine.kind, EngineKind::Turbine | EngineKind::Propeller))
        .filter_map(|(number, engine)| {
            let throttle = aircraft.property(&format!("fcs/throttle-pos-norm[{number}]"))?;
            Some((throttle, Engine::dry_throttle(engine)))
        })
        .collect();
    if !engines.is_empty() && throttles.len() == engines.len() {
        notes.push(format!("The engines follow the throttle with a lag of {ENGINE_LAG_S} s, without afterburner."));
        return Drive::Engines(throttles);
    }
    let largest = 0.5 * weight_n;
    notes.push(format!(
        "Not all engines have a model here, or there is none: thrust is a force along body x through the centre of gravity, \
         {largest:.0} N (half the weight) at full throttle."
    ));
    Drive::Force(largest)
}

/// The values of a function with their derivatives, from values at the real parts and, unless the scalar is a plain number,
/// from central differences between the ends `between` of each variable.
fn expanded<T: Scalar, const N: usize>(
    x: [T; N],
    function: impl Fn(&[f64; N]) -> [f64; 6],
    between: impl Fn(usize, f64) -> [f64; 2],
) -> [T; 6] {
    let real = x.map(Scalar::real);
    let mut values = function(&real).map(T::from);
    if T::IS_REAL {
        return values;
    }
    for i in 0..N {
        let ends = between(i, real[i]);
        let [below, above] = ends.map(|end| {
            let mut moved = real;
            moved[i] = end;
            function(&moved)
        });
        let step = x[i] - real[i];
        for (k, value) in values.iter_mut().enumerate() {
            *value = *value + step * ((above[k] - below[k]) / (ends[1] - ends[0]));
        }
    }
    values
}

fn variables<T: Scalar>(air: &AirData<T>, [p, q, r]: [T; 3], controls: &Controls<T>) -> [T; VARIABLES] {
    let Controls { elevator, aileron, rudder, .. } = *controls;
    [air.speed, air.alpha, air.beta, air.density, air.mach, p, q, r, elevator, aileron, rudder]
}

fn coefficients_of<T>([cx, cy, cz, cl, cm, cn]: [T; 6]) -> Coefficients<T> {
    Coefficients { cx, cy, cz, cl, cm, cn }
}

impl Flown for FlownJsbsim {
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
        Atmosphere::Standard
    }

    fn coefficients<T: Scalar>(&self, air: &AirData<T>, rates: [T; 3], controls: &Controls<T>) -> Coefficients<T> {
        let between = |i: usize, value: f64| {
            let step = if IS_SHARE[i] { STEPS[i] * value } else { STEPS[i] };
            [value - step, value + step]
        };
        coefficients_of(expanded(variables(air, rates, controls), |x| self.at(x), between))
    }

    fn alpha_rate_coefficients<T: Scalar>(
        &self,
        air: &AirData<T>,
        rates: [T; 3],
        controls: &Controls<T>,
    ) -> Option<Coefficients<T>> {
        let properties = self.alpha_rate?;
        let x = variables(air, rates, controls).map(Scalar::real);
        let slope = self.by_alpha_rate(&x, properties);
        let per_speed = T::from(air.speed.real()) / air.speed;
        Some(coefficients_of(slope.map(|value| per_speed * value)))
    }

    fn propulsion<T: Scalar>(&self, power: T, altitude: T, mach: T) -> Propulsion<T> {
        let zero = T::from(0.0);
        let throttles = match &self.drive {
            Drive::Engines(throttles) => throttles,
            Drive::Force(largest) => {
                let force = power * (0.01 * largest * self.thrust_scale);
                return Propulsion { force: [force, zero, zero], moment: [zero; 3] };
            }
        };
        let between = |i: usize, value: f64| {
            let ends = [value - THRUST_STEPS[i], value + THRUST_STEPS[i]];
            // Beyond the ends of the throttle nothing changes.
            if i == 0 && (0.0..=100.0).contains(&value) { ends.map(|end| end.clamp(0.0, 100.0)) } else { ends }
        };
        let [x, y, z, l, m, n] = expanded([power, altitude, mach], |at| self.pushed(throttles, *at), between);
        Propulsion { force: [x, y, z], moment: [l, m, n] }
    }

    fn power_rate<T: Scalar>(&self, throttle: T, power: T) -> T {
        (throttle * 100.0 - power) / ENGINE_LAG_S
    }

    fn steady_power<T: Scalar>(&self, throttle: T) -> T {
        throttle * 100.0
    }

    fn actuators(&self) -> &Actuators {
        &self.actuators
    }

    fn data_range(&self) -> DataRange {
        self.data_range
    }
}
