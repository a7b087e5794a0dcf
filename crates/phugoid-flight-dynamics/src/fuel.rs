//! An aircraft that has burnt some of its fuel.

use crate::actuator::Actuators;
use crate::aircraft::{AirData, Aircraft, Coefficients, Controls, DataRange, Geometry, Propulsion};
use crate::atmosphere::Atmosphere;
use crate::mass::MassProperties;
use crate::scalar::Scalar;

/// The body of an aircraft that has burnt some of its fuel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Burnt {
    /// Mass and inertia about the centre of gravity that the aircraft has now.
    pub mass: MassProperties,
    /// How far the centre of gravity has moved aft, mean chords.
    pub shift: f64,
    /// Fuel that is left, kg. Without any the engines do not run: the aircraft has neither thrust nor torque.
    pub left: f64,
}

/// Fuel of an aircraft in one place: what the body becomes as it is burnt.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fuel {
    /// Fuel at the beginning, kg, which is part of the mass of the aircraft.
    pub mass: f64,
    /// How far its centre is aft of the centre of gravity that the aircraft has at the beginning, m.
    pub aft: f64,
    /// Moments of inertia of the fuel at the beginning about its own centre, body x, y and z, kg m^2. They shrink with its mass.
    pub inertia: [f64; 3],
}

impl Fuel {
    /// The body when `burnt` kg are burnt (not below 0, not above all), of an aircraft that at the beginning has these mass properties
    /// and mean chord (m). `None` where what is left is no body: the fuel is heavier, or has more inertia, than the aircraft.
    ///
    /// By the parallel axes, with the burnt mass `b` at the distance `d` from the centre of gravity of the beginning: the mass is
    /// `m - b`, the centre of gravity has moved aft by `s = -b d/(m - b)`, and about body y and z the inertia has lost that of the fuel
    /// itself, `b d^2` and `(m - b) s^2`.
    pub fn burnt(&self, burnt: f64, whole: &MassProperties, mean_chord: f64) -> Option<Burnt> {
        let burnt = burnt.clamp(0.0, self.mass.max(0.0));
        let mass = whole.mass() - burnt;
        let part = if self.mass > 0.0 { burnt / self.mass } else { 0.0 };
        let aft = -burnt * self.aft / mass;
        let across = burnt * self.aft * self.aft + mass * aft * aft;
        let mut tensor = whole.inertia_tensor();
        let [x, y, z] = self.inertia;
        for (axis, lost) in [part * x, part * y + across, part * z + across].into_iter().enumerate() {
            tensor[axis][axis] -= lost;
        }
        let mass = MassProperties::from_tensor(mass, tensor, whole.rotor_momentum())?;
        Some(Burnt { mass, shift: aft / mean_chord, left: self.mass - burnt })
    }
}

/// An aircraft that has burnt some of its fuel.
#[derive(Clone, Copy, Debug)]
pub struct Lighter<'a, A> {
    aircraft: &'a A,
    now: Burnt,
    geometry: Geometry,
}

impl<'a, A: Aircraft> Lighter<'a, A> {
    /// `aircraft` with the body that it has now.
    pub fn new(aircraft: &'a A, now: Burnt) -> Self {
        let whole = *aircraft.geometry();
        Self { aircraft, now, geometry: Geometry { cg: whole.cg + now.shift, ..whole } }
    }
}

impl<A: Aircraft> Aircraft for Lighter<'_, A> {
    fn geometry(&self) -> &Geometry {
        &self.geometry
    }

    fn mass_properties(&self) -> &MassProperties {
        &self.now.mass
    }

    fn gravity(&self) -> f64 {
        self.aircraft.gravity()
    }

    fn atmosphere(&self) -> Atmosphere {
        self.aircraft.atmosphere()
    }

    fn coefficients<T: Scalar>(&self, air: &AirData<T>, rates: [T; 3], controls: &Controls<T>) -> Coefficients<T> {
        self.aircraft.coefficients(air, rates, controls).about(self.now.shift, &self.geometry)
    }

    fn alpha_rate_coefficients<T: Scalar>(
        &self,
        air: &AirData<T>,
        rates: [T; 3],
        controls: &Controls<T>,
    ) -> Option<Coefficients<T>> {
        let slope = self.aircraft.alpha_rate_coefficients(air, rates, controls)?;
        Some(slope.about(self.now.shift, &self.geometry))
    }

    fn propulsion<T: Scalar>(&self, power: T, altitude: T, mach: T) -> Propulsion<T> {
        if self.now.left <= 0.0 {
            return Propulsion { force: [T::from(0.0); 3], moment: [T::from(0.0); 3] };
        }
        self.aircraft.propulsion(power, altitude, mach).about(self.now.shift * self.geometry.mean_chord)
    }

    fn slipstream_coefficients<T: Scalar>(
        &self,
        propulsion: &Propulsion<T>,
        air: &AirData<T>,
        rates: [T; 3],
        controls: &Controls<T>,
    ) -> Option<Coefficients<T>> {
        let blown = self.aircraft.slipstream_coefficients(propulsion, air, rates, controls)?;
        Some(blown.about(self.now.shift, &self.geometry))
    }

    fn fuel_flow(&self, power: f64, altitude: f64, mach: f64) -> f64 {
        if self.now.left > 0.0 { self.aircraft.fuel_flow(power, altitude, mach) } else { 0.0 }
    }

    fn after_burning(&self, _fuel: f64) -> Option<Burnt> {
        Some(self.now)
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

#[cfg(test)]
mod tests {
    use super::*;

    /// Two points of 1000 kg each, 2 m ahead and 2 m aft of the middle. The one aft is fuel: without it the one ahead is left.
    #[test]
    fn what_is_left_is_the_other_part() {
        let own = 50.0;
        let tensor = [[2.0 * own, 0.0, 0.0], [0.0, 8000.0 + 2.0 * own, 0.0], [0.0, 0.0, 8000.0 + 2.0 * own]];
        let whole = MassProperties::from_tensor(2000.0, tensor, 0.0).unwrap();
        let fuel = Fuel { mass: 1000.0, aft: 2.0, inertia: [own; 3] };
        let all = fuel.burnt(1000.0, &whole, 4.0).unwrap();
        assert!((all.mass.mass() - 1000.0).abs() < 1e-9 && all.left == 0.0);
        assert!((all.shift + 0.5).abs() < 1e-12, "2 m ahead are half a chord: {}", all.shift);
        for axis in 0..3 {
            assert!((all.mass.inertia_tensor()[axis][axis] - own).abs() < 1e-6, "{axis}");
        }
        assert_eq!(fuel.burnt(5000.0, &whole, 4.0), Some(all));
        // Half of it: 500 kg at +2 m and 1000 kg at -2 m have their centre at -2/3 m.
        let half = fuel.burnt(500.0, &whole, 4.0).unwrap();
        assert!((half.shift * 4.0 + 2.0 / 3.0).abs() < 1e-12);
        let expected = 1.5 * own + 500.0 * (8.0_f64 / 3.0).powi(2) + 1000.0 * (4.0_f64 / 3.0).powi(2);
        assert!((half.mass.inertia_tensor()[1][1] - expected).abs() < 1e-6);
        assert!(Fuel { mass: 2000.0, ..fuel }.burnt(2000.0, &whole, 4.0).is_none());
        assert!(Fuel { inertia: [500.0; 3], ..fuel }.burnt(1000.0, &whole, 4.0).is_none());
    }
}
