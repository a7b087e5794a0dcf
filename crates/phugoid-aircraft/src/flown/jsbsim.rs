//! An aircraft of JSBSim over a flat earth.

mod aerodynamics;
mod control;
mod drive;
mod notes;
mod start;

use std::path::Path;

use phugoid_flight_dynamics::actuator::{Actuator, Actuators};
use phugoid_flight_dynamics::aircraft::{
    AirData, Aircraft as Flown, Coefficients, Controls, DataRange, Geometry, Propulsion,
};
use phugoid_flight_dynamics::atmosphere::Atmosphere;
use phugoid_flight_dynamics::mass::MassProperties;
use phugoid_flight_dynamics::scalar::Scalar;

use super::error::FlownError;
use super::options::{FlownOptions, check};
use super::surface::{LAG_S, surfaces};
use crate::expansion::expanded;
use crate::jsbsim::Aircraft;
use aerodynamics::{Aerodynamics, VARIABLES};
use control::Control;
pub use control::{FlightControl, Sensed};
use drive::{Drive, ENGINE_LAG_S};
use start::started;

/// Steps of the central differences: those of speed, density and Mach number are shares of them. Values carry rounding of some
/// 1e-16, so that derivatives of smooth data are good to 1e-10; those of a kink within a step are between both sides.
const STEPS: [f64; VARIABLES] = [1e-5, 1e-5, 1e-5, 1e-5, 1e-5, 1e-4, 1e-4, 1e-4, 1e-5, 1e-5, 1e-5];
const IS_SHARE: [bool; VARIABLES] = [true, false, false, true, true, false, false, false, false, false, false];
/// Steps of power (percent), altitude (m) and Mach number for the derivatives of thrust.
const THRUST_STEPS: [f64; 3] = [1e-2, 1.0, 1e-5];
/// Where the reference point of the aerodynamics is taken to be, in chords.
const QUARTER: f64 = 0.25;
/// Gas constant of air, J/(kg K), and its ratio of specific heats.
const GAS: f64 = 8314.32 / 28.9644;
const RATIO_OF_HEATS: f64 = 1.4;

/// An aircraft of JSBSim that trim, linear models and simulation fly over a flat earth.
///
/// Coefficients are those of the files at every instant, about the centre of gravity. Derivatives (of dual numbers) are central
/// differences with steps of 1e-5 rad, 1e-4 rad/s and 1e-5 of speed, density and Mach number: good to some 1e-9 between the
/// kinks of tables. They cost 22 evaluations in place of one. Where the aerodynamics read the rate of the angle of attack, it is
/// solved with the accelerations; its coefficients, per rad/s, are taken to change with the speed alone as `1/V`.
///
/// The aerodynamics see the attitude of straight flight in the plane of symmetry (pitch angle equal to the angle of attack),
/// no rate of sideslip, no engines, and the height that the density has in the standard atmosphere. Mass and inertia stay those
/// of the beginning. Flight control is no part of it: the surfaces are where they are put, and of its components only those without a
/// memory that follow the flight alone have their values. Opened with `flight_control`, it gives the flight control system of the
/// files beside it ([`flight_control`](Self::flight_control)), which says where to put them. What is not finite in gives what is not
/// finite out.
///
/// The engines follow the throttle with a lag of 1 s, and push as in axial flow; power is the throttle in percent. It is
/// `Send` and `Sync`: threads evaluate side by side.
#[derive(Clone, Debug)]
pub struct FlownJsbsim {
    aircraft: Aircraft,
    aerodynamics: Aerodynamics,
    geometry: Geometry,
    mass: MassProperties,
    gravity: f64,
    drive: Drive,
    thrust_scale: f64,
    actuators: Actuators,
    surface_stops: [[f64; 2]; 3],
    data_range: DataRange,
    /// Whether the aerodynamics read the rate of the angle of attack.
    reads_alpha_rate: bool,
    /// The channels, where they are to run.
    control: Option<Box<Control>>,
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
    /// As [`open`](Self::open), and for an option that makes no sense or a property that would change nothing.
    pub fn open_with(path: impl AsRef<Path>, options: &FlownOptions) -> Result<Self, FlownError> {
        Self::new(Aircraft::open(path)?, options)
    }

    /// From an aircraft that was read.
    ///
    /// # Errors
    /// As [`open_with`](Self::open_with), but for the files.
    pub fn new(mut aircraft: Aircraft, options: &FlownOptions) -> Result<Self, FlownError> {
        check(options)?;
        let mut notes: Vec<String> = aircraft.omitted().iter().map(ToString::to_string).collect();
        let as_written = options.flight_control.then(|| aircraft.clone());
        let computed = aircraft.compute_steady_channels()?;
        if !computed.is_empty() {
            notes.push(format!(
                "What components of channels without a memory make of the flight is computed at every instant: {}.",
                computed.join(", ")
            ));
        }
        let surfaces = surfaces(&aircraft, &mut notes)?;
        let (mut evaluator, engaged) = started(&aircraft, &surfaces, options)?;
        let masses = evaluator.mass_properties();
        let mass = MassProperties::from_tensor(masses.mass_kg, masses.inertia_kg_m2, 0.0).ok_or_else(|| {
            let [[xx, ..], [_, yy, _], [.., zz]] = masses.inertia_kg_m2;
            FlownError::Mass { file: aircraft.own_file(), mass_kg: masses.mass_kg, inertia_kg_m2: [xx, yy, zz] }
        })?;
        let geometry = geometry(&aircraft, masses.centre_of_gravity_m[0])?;
        notes.push("The reference point of the aerodynamics is taken to be at a quarter of the chord.".into());
        let control = match as_written {
            Some(as_written) => {
                let control = Control::new(as_written, &mut evaluator, &surfaces, options, engaged, &mut notes)?;
                Some(Box::new(control))
            }
            None => {
                notes.push(format!(
                    "Flight control does not run: surfaces follow their commands with a lag of {LAG_S} s and no limit of rate."
                ));
                None
            }
        };
        let drive = Drive::new(&aircraft, &evaluator, options.thrust, mass.mass() * options.gravity, &mut notes);
        let reads_alpha_rate = notes::note_inputs(&aircraft, &surfaces, &mut evaluator, options, &mut notes);
        let alpha = aircraft.alpha_of_tables().unwrap_or(DataRange::UNSTATED.alpha);
        let lags = control.as_ref().map_or([LAG_S; 3], |control| control.lags_s());
        let [elevator, aileron, rudder] = [0, 1, 2].map(|i: usize| Actuator { lag: lags[i], ..surfaces[i].actuator });
        let surface_stops = [0, 1, 2].map(|i: usize| surfaces[i].stops);
        let aerodynamics = Aerodynamics::new(&aircraft, &evaluator, &surfaces);
        Ok(Self {
            aerodynamics,
            geometry,
            mass,
            gravity: options.gravity,
            drive,
            thrust_scale: options.thrust_scale,
            actuators: Actuators { elevator, aileron, rudder },
            surface_stops,
            data_range: DataRange { alpha, ..DataRange::UNSTATED },
            reads_alpha_rate,
            control,
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

    /// The flight control system of the files as it takes over in a trim: with what it senses there, from elevator, aileron and rudder
    /// at these angles (rad, in the signs of the equations of motion), to run every `step_s` seconds.
    ///
    /// # Errors
    /// [`FlownError`]: an aircraft that was opened without [`flight_control`](FlownOptions::flight_control), channels that do not
    /// come to rest in this trim, a step that is not positive.
    pub fn flight_control(
        &self,
        sensed: &Sensed,
        trim_rad: [f64; 3],
        step_s: f64,
    ) -> Result<FlightControl<'_>, FlownError> {
        let control = self.control.as_deref().ok_or_else(|| FlownError::NoFlightControl {
            file: self.aircraft.own_file(),
            why: "this one was opened without it".to_owned(),
        })?;
        FlightControl::new(control, sensed, trim_rad, step_s)
    }
}

fn geometry(aircraft: &Aircraft, centre_m: f64) -> Result<Geometry, FlownError> {
    let sizes = aircraft.geometry();
    for (what, value, element) in [
        ("area of the wing, m2,", sizes.wing_area_m2, "wingarea"),
        ("span of the wing, m,", sizes.wing_span_m, "wingspan"),
        ("chord of the wing, m,", sizes.chord_m, "chord"),
    ] {
        if !(value > 0.0 && value.is_finite()) {
            return Err(FlownError::Size { file: aircraft.own_file(), what, value, element });
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
        coefficients_of(expanded(
            variables(air, rates, controls),
            |x| self.aerodynamics.at(&self.aircraft, &self.geometry, x),
            between,
        ))
    }

    fn alpha_rate_coefficients<T: Scalar>(
        &self,
        air: &AirData<T>,
        rates: [T; 3],
        controls: &Controls<T>,
    ) -> Option<Coefficients<T>> {
        if !self.reads_alpha_rate {
            return None;
        }
        let x = variables(air, rates, controls).map(Scalar::real);
        let slope = self.aerodynamics.by_alpha_rate(&self.aircraft, &self.geometry, &x);
        let per_speed = T::from(air.speed.real()) / air.speed;
        Some(coefficients_of(slope.map(|value| per_speed * value)))
    }

    fn propulsion<T: Scalar>(&self, power: T, altitude: T, mach: T) -> Propulsion<T> {
        let zero = T::from(0.0);
        let engines = match &self.drive {
            Drive::Engines(engines) => engines,
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
        let [x, y, z, l, m, n] = expanded(
            [power, altitude, mach],
            |at| engines.push(&self.aircraft, *at).map(|value| value * self.thrust_scale),
            between,
        );
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

    fn surface_stops(&self) -> [[f64; 2]; 3] {
        self.surface_stops
    }

    fn data_range(&self) -> DataRange {
        self.data_range
    }
}
