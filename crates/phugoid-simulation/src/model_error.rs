//! An aircraft that is not quite what its tables say: what the error of a model does to an estimator.

use std::collections::BTreeMap;

use phugoid_flight_dynamics::actuator::Actuators;
use phugoid_flight_dynamics::aircraft::{AirData, Aircraft, Coefficients, Controls, DataRange, Geometry, Propulsion};
use phugoid_flight_dynamics::atmosphere::Atmosphere;
use phugoid_flight_dynamics::mass::MassProperties;
use phugoid_flight_dynamics::scalar::{Dual, Scalar};
use phugoid_flight_dynamics::trim::Trim;

use crate::scenario::{ModelError, TableFactors};

/// An aircraft whose coefficients differ from those of `aircraft` as a [`ModelError`] says.
#[derive(Clone, Copy, Debug)]
pub struct Misjudged<'a, A> {
    aircraft: &'a A,
    factors: TableFactors,
    alpha_squared: f64,
    alpha_reference: f64,
}

impl<'a, A: Aircraft> Misjudged<'a, A> {
    /// The aircraft that flies when `aircraft` is what is known of it. The quadratic term is about the angle of attack
    /// `alpha_reference` (rad), where it vanishes with its slope.
    pub fn new(aircraft: &'a A, error: &ModelError, alpha_reference: f64) -> Self {
        Self { aircraft, factors: error.tables, alpha_squared: error.Cm_alpha_squared, alpha_reference }
    }

    /// The increments to the known aircraft that the error amounts to at a trim: derivatives of the difference, by name. What
    /// an estimator that is told the tables alone should find beside the scenario's own increments, if it flies close to
    /// the trim.
    pub fn equivalent_increments(&self, trim: &Trim) -> BTreeMap<String, f64> {
        const ALPHA: usize = 0;
        const BETA: usize = 1;
        const RATES: [usize; 3] = [2, 3, 4];
        const SURFACES: [usize; 3] = [5, 6, 7];
        let variable = |value: f64, index: usize| Dual::<8>::variable(value, index);
        let alpha = variable(trim.alpha_rad, ALPHA);
        let local = self.aircraft.atmosphere().at(trim.altitude_m);
        let speed = trim.mach * local.speed_of_sound;
        let air = AirData {
            speed: Dual::from(speed),
            alpha,
            beta: variable(trim.beta_rad, BETA),
            density: Dual::from(local.density),
            dynamic_pressure: Dual::from(0.5 * local.density * speed * speed),
            mach: Dual::from(trim.mach),
        };
        let rates = [trim.p_rad_s, trim.q_rad_s, trim.r_rad_s];
        let rates: [Dual<8>; 3] = std::array::from_fn(|i| variable(rates[i], RATES[i]));
        let at = trim.controls();
        let controls = Controls {
            throttle: Dual::from(at.throttle),
            elevator: variable(at.elevator, SURFACES[0]),
            aileron: variable(at.aileron, SURFACES[1]),
            rudder: variable(at.rudder, SURFACES[2]),
        };
        let (known, flown) =
            (self.aircraft.coefficients(&air, rates, &controls), self.coefficients(&air, rates, &controls));
        let (sine, cosine) = alpha.sin_cos();
        let (cx, cz) = (flown.cx - known.cx, flown.cz - known.cz);
        let geometry = self.geometry();
        let (chord_time, span_time) = (geometry.mean_chord / (2.0 * speed), geometry.span / (2.0 * speed));
        let longitudinal =
            [("CL", cx * sine - cz * cosine), ("CD", -(cx * cosine) - cz * sine), ("Cm", flown.cm - known.cm)];
        let lateral = [("CY", flown.cy - known.cy), ("Cl", flown.cl - known.cl), ("Cn", flown.cn - known.cn)];
        let mut found = BTreeMap::new();
        for (coefficient, difference) in longitudinal {
            let d = difference.derivatives;
            for (by, value) in [("alpha", d[ALPHA]), ("q", d[RATES[1]] / chord_time), ("elevator", d[SURFACES[0]])] {
                found.insert(format!("d{coefficient}_{by}"), value);
            }
        }
        for (coefficient, difference) in lateral {
            let d = difference.derivatives;
            let by_rate = |i: usize| d[RATES[i]] / span_time;
            let all = [
                ("beta", d[BETA]),
                ("p", by_rate(0)),
                ("r", by_rate(2)),
                ("aileron", d[SURFACES[1]]),
                ("rudder", d[SURFACES[2]]),
            ];
            for (by, value) in all {
                found.insert(format!("d{coefficient}_{by}"), value);
            }
        }
        found
    }
}

impl<A: Aircraft> Aircraft for Misjudged<'_, A> {
    fn geometry(&self) -> &Geometry {
        self.aircraft.geometry()
    }

    fn mass_properties(&self) -> &MassProperties {
        self.aircraft.mass_properties()
    }

    fn gravity(&self) -> f64 {
        self.aircraft.gravity()
    }

    fn atmosphere(&self) -> Atmosphere {
        self.aircraft.atmosphere()
    }

    fn coefficients<T: Scalar>(&self, air: &AirData<T>, rates: [T; 3], controls: &Controls<T>) -> Coefficients<T> {
        let c = self.aircraft.coefficients(air, rates, controls);
        let f = &self.factors;
        let from_trim = air.alpha - self.alpha_reference;
        Coefficients {
            cx: c.cx * f.CX,
            cy: c.cy * f.CY,
            cz: c.cz * f.CZ,
            cl: c.cl * f.Cl,
            cm: c.cm * f.Cm + from_trim * from_trim * self.alpha_squared,
            cn: c.cn * f.Cn,
        }
    }

    fn alpha_rate_coefficients<T: Scalar>(
        &self,
        air: &AirData<T>,
        rates: [T; 3],
        controls: &Controls<T>,
    ) -> Option<Coefficients<T>> {
        let c = self.aircraft.alpha_rate_coefficients(air, rates, controls)?;
        let f = &self.factors;
        Some(Coefficients {
            cx: c.cx * f.CX,
            cy: c.cy * f.CY,
            cz: c.cz * f.CZ,
            cl: c.cl * f.Cl,
            cm: c.cm * f.Cm,
            cn: c.cn * f.Cn,
        })
    }

    fn propulsion<T: Scalar>(&self, power: T, altitude: T, mach: T) -> Propulsion<T> {
        self.aircraft.propulsion(power, altitude, mach)
    }

    fn power_rate<T: Scalar>(&self, throttle: T, power: T) -> T {
        self.aircraft.power_rate(throttle, power)
    }

    fn steady_power<T: Scalar>(&self, throttle: T) -> T {
        self.aircraft.steady_power(throttle)
    }

    fn actuators(&self) -> &Actuators {
        self.aircraft.actuators()
    }

    fn data_range(&self) -> DataRange {
        self.aircraft.data_range()
    }
}
