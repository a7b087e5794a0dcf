//! The F-16 of NASA TP-1538: aerodynamics from the wind tunnel between -20 and 45 deg of angle of attack, with the leading-edge
//! flap that the flight control moves with angle of attack and Mach number.
//!
//! Its tables are data beside the program and are read at run time (`tp1538_tables.json`). Mass, inertia, engine and actuators are
//! those of the F-16 of Stevens & Lewis, which simplifies the same report.
//!
//! L. T. Nguyen and others: *Simulator Study of Stall/Post-Stall Characteristics of a Fighter Airplane With Relaxed Longitudinal
//! Static Stability*, NASA TP-1538, 1979.

mod tables;

use std::path::Path;
use std::sync::Arc;

use phugoid_flight_dynamics::actuator::Actuators;
use phugoid_flight_dynamics::aircraft::{AirData, Aircraft, Coefficients, Controls, DataRange, Geometry, Propulsion};
use phugoid_flight_dynamics::atmosphere::Atmosphere;
use phugoid_flight_dynamics::f16::{F16, F16DataError, F16Options};
use phugoid_flight_dynamics::mass::MassProperties;
use phugoid_flight_dynamics::scalar::Scalar;

use self::tables::{Flow, Tables};
use crate::transport::TransportError;

/// Name of the file with the tables.
pub const FILE: &str = "tp1538_tables.json";
/// deg per rad.
const DEGREES: f64 = 180.0 / std::f64::consts::PI;
/// Half the ratio of specific heats of air: dynamic over static pressure is this times the square of the Mach number.
const HALF_RATIO_OF_HEATS: f64 = 0.7;
/// Deflections of the tables for aileron and rudder, deg.
const AILERON: f64 = 20.0;
const RUDDER: f64 = 30.0;
/// Largest angle of the leading-edge flap, deg, at which the basic tables are.
const FLAP: f64 = 25.0;

/// Why the aircraft cannot be made.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Tp1538Error {
    /// The tables cannot be read; the message names file and key.
    #[error(transparent)]
    Tables(#[from] TransportError),
    /// Mass, engine or centre of gravity of the F-16.
    #[error(transparent)]
    F16(#[from] F16DataError),
}

/// The F-16 of NASA TP-1538.
///
/// Signs of the controls are those of [`Controls`]. Coefficients are linear between the points of the tables, which are held at
/// their ends, and their derivatives (of dual numbers) are on a point the mean of both sides. The leading-edge flap stands where the
/// steady schedule of the report puts it, `1.38 alpha - 9.05 qbar/p + 1.45` deg between 0 and 25, without its lag; the flight
/// control does not run otherwise.
#[derive(Clone, Debug)]
pub struct Tp1538 {
    tables: Arc<Tables>,
    f16: Box<F16>,
    notes: Vec<String>,
}

impl Tp1538 {
    /// From the tables of a folder, or from their file, with this centre of gravity (fraction of the mean chord; the data refer
    /// to 0.35).
    ///
    /// # Errors
    /// [`Tp1538Error`]: the file and the key of what is missing or makes no sense; a centre of gravity that is not finite.
    pub fn open(path: impl AsRef<Path>, cg: f64) -> Result<Self, Tp1538Error> {
        let path = path.as_ref();
        let file = if path.is_dir() { path.join(FILE) } else { path.to_owned() };
        let tables = Arc::new(Tables::read(file)?);
        let f16 = Box::new(F16::new(F16Options { cg, ..F16Options::default() })?);
        let notes = vec![
            "The leading-edge flap follows angle of attack and Mach number at once, by the steady schedule.".to_owned(),
            "Mass, inertia, engine and actuators are those of the F-16 of Stevens & Lewis.".to_owned(),
            "The deep-stall increment of the pitching moment with the stabiliser is left out: one source alone has it."
                .to_owned(),
        ];
        Ok(Self { tables, f16, notes })
    }

    /// What is left out and what is assumed, in sentences.
    pub fn notes(&self) -> &[String] {
        &self.notes
    }

    /// Angle of the leading-edge flap, rad, from the angle of attack (rad) and the Mach number.
    pub fn leading_edge_flap<T: Scalar>(&self, alpha: T, mach: T) -> T {
        let degrees = alpha * (1.38 * DEGREES) - mach * mach * (9.05 * HALF_RATIO_OF_HEATS) + 1.45;
        let within = match degrees.real() {
            real if real < 0.0 => T::from(0.0),
            real if real > FLAP => T::from(FLAP),
            _ => degrees,
        };
        within * DEGREES.recip()
    }
}

impl Aircraft for Tp1538 {
    fn geometry(&self) -> &Geometry {
        self.f16.geometry()
    }

    fn mass_properties(&self) -> &MassProperties {
        self.f16.mass_properties()
    }

    fn gravity(&self) -> f64 {
        self.f16.gravity()
    }

    fn atmosphere(&self) -> Atmosphere {
        self.f16.atmosphere()
    }

    fn coefficients<T: Scalar>(&self, air: &AirData<T>, [p, q, r]: [T; 3], controls: &Controls<T>) -> Coefficients<T> {
        let Geometry { span, mean_chord, cg, cg_reference, .. } = *self.geometry();
        let degrees = |angle: T| angle * DEGREES;
        let half_time = (air.speed * 2.0).recip();
        let (span_time, chord_time) = (half_time * span, half_time * mean_chord);
        let flow = Flow {
            alpha: degrees(air.alpha),
            beta: degrees(air.beta),
            elevator: degrees(controls.elevator),
            flap: T::from(1.0) - degrees(self.leading_edge_flap(air.alpha, air.mach)) / FLAP,
            aileron: degrees(controls.aileron) / AILERON,
            rudder: degrees(controls.rudder) / RUDDER,
            rates: [p * span_time, q * chord_time, r * span_time],
        };
        let [cx, cy, cz, cl, cm, cn] = self.tables.coefficients(&flow);
        let aft = cg_reference - cg;
        Coefficients { cx, cy, cz, cl, cm: cm + cz * aft, cn: cn - cy * (aft * mean_chord / span) }
    }

    fn propulsion<T: Scalar>(&self, power: T, altitude: T, mach: T) -> Propulsion<T> {
        self.f16.propulsion(power, altitude, mach)
    }

    fn power_rate<T: Scalar>(&self, throttle: T, power: T) -> T {
        self.f16.power_rate(throttle, power)
    }

    fn steady_power<T: Scalar>(&self, throttle: T) -> T {
        self.f16.steady_power(throttle)
    }

    fn actuators(&self) -> &Actuators {
        self.f16.actuators()
    }

    fn data_range(&self) -> DataRange {
        let [alpha, beta, elevator] = self.tables.range().map(|ends| ends.map(|end| end / DEGREES));
        DataRange { alpha, beta, elevator, ..self.f16.data_range() }
    }
}
