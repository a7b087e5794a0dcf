//! An aircraft with damage that is more than other derivatives: constant forces and moments, terms that couple the axes,
//! surfaces that have lost a part, another mass, centre of gravity and thrust.

use phugoid_flight_dynamics::actuator::Actuators;
use phugoid_flight_dynamics::aircraft::{AirData, Aircraft, Coefficients, Controls, Propulsion};
use phugoid_flight_dynamics::fuel::Burnt;
use phugoid_flight_dynamics::increments::lift_drag_to_body;
use phugoid_flight_dynamics::mass::MassProperties;
use phugoid_flight_dynamics::modified::Modified;
use phugoid_flight_dynamics::scalar::Scalar;
use phugoid_flight_dynamics::trim::Trim;

/// Coefficients in the order of [`Effects::constants`] and the rows of [`Effects::coupling`].
pub const COEFFICIENTS: [&str; 6] = ["CL", "CD", "Cm", "CY", "Cl", "Cn"];
/// Variables in the order of the columns of [`Effects::coupling`]; angles and deflections in rad, rates made dimensionless.
pub const VARIABLES: [&str; 8] = ["alpha", "beta", "p", "q", "r", "elevator", "aileron", "rudder"];

/// What damage changes beside the increments of the derivatives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Effects {
    /// Constant coefficients that are added, in the order of [`COEFFICIENTS`]: lift and drag in stability axes, the others in
    /// body axes.
    pub constants: [f64; 6],
    /// Coefficients (rows) that vary with variables (columns) of the other axes, per rad; the angle of attack and the elevator
    /// count from the trim.
    pub coupling: [[f64; 8]; 6],
    /// What is left of elevator, aileron and rudder: factors on the deflection that the aerodynamics feel, 0 to 1.
    pub effectiveness: [f64; 3],
    /// Factor on the mass.
    pub mass: f64,
    /// Factors on the moments of inertia about body x, y and z.
    pub inertia: [f64; 3],
    /// How far the centre of gravity has moved aft, fraction of the mean chord.
    pub cg_shift: f64,
    /// Factor on the thrust.
    pub thrust: f64,
    /// How far to the right of the centre of gravity the thrust acts, m.
    pub thrust_arm: f64,
}

impl Effects {
    /// Nothing is changed.
    pub const NONE: Self = Self {
        constants: [0.0; 6],
        coupling: [[0.0; 8]; 6],
        effectiveness: [1.0; 3],
        mass: 1.0,
        inertia: [1.0; 3],
        cg_shift: 0.0,
        thrust: 1.0,
        thrust_arm: 0.0,
    };

    /// A part of the way, 0 to 1, to other effects.
    #[must_use]
    pub fn towards(&self, other: &Self, part: f64) -> Self {
        let between = |from: f64, to: f64| from + part * (to - from);
        Self {
            constants: std::array::from_fn(|i| between(self.constants[i], other.constants[i])),
            coupling: std::array::from_fn(|i| {
                std::array::from_fn(|j| between(self.coupling[i][j], other.coupling[i][j]))
            }),
            effectiveness: std::array::from_fn(|i| between(self.effectiveness[i], other.effectiveness[i])),
            mass: between(self.mass, other.mass),
            inertia: std::array::from_fn(|i| between(self.inertia[i], other.inertia[i])),
            cg_shift: between(self.cg_shift, other.cg_shift),
            thrust: between(self.thrust, other.thrust),
            thrust_arm: between(self.thrust_arm, other.thrust_arm),
        }
    }

    /// Mass and inertia with these effects. Factors that are not positive leave them as they are.
    fn on_mass(&self, whole: &MassProperties) -> MassProperties {
        if self.mass == 1.0 && self.inertia == [1.0; 3] {
            return *whole;
        }
        whole.changed(self.mass, self.inertia).unwrap_or(*whole)
    }
}

/// An aircraft with [`Effects`] of damage, and with actuators that may have become slower.
#[derive(Clone, Copy, Debug)]
pub struct Damaged<'a, A> {
    aircraft: &'a A,
    effects: Effects,
    mass: MassProperties,
    actuators: Actuators,
    alpha_reference: f64,
    elevator_reference: f64,
}

impl<'a, A: Aircraft> Damaged<'a, A> {
    /// `aircraft` with these effects; couplings count from the angle of attack and the elevator of `trim`. Factors on mass and
    /// inertia that are not positive leave them as they are (scenario files refuse such factors).
    pub fn new(aircraft: &'a A, effects: Effects, trim: &Trim) -> Self {
        Self {
            aircraft,
            effects,
            mass: effects.on_mass(aircraft.mass_properties()),
            actuators: *aircraft.actuators(),
            alpha_reference: trim.alpha_rad,
            elevator_reference: trim.elevator_rad,
        }
    }

    /// The same aircraft with other actuators.
    #[must_use]
    pub fn with_actuators(self, actuators: Actuators) -> Self {
        Self { actuators, ..self }
    }

    fn felt<T: Scalar>(&self, controls: &Controls<T>) -> Controls<T> {
        let [elevator, aileron, rudder] = self.effects.effectiveness;
        Controls {
            throttle: controls.throttle,
            elevator: controls.elevator * elevator,
            aileron: controls.aileron * aileron,
            rudder: controls.rudder * rudder,
        }
    }
}

impl<A: Aircraft> Modified for Damaged<'_, A> {
    type Unmodified = A;

    fn unmodified(&self) -> &A {
        self.aircraft
    }

    fn mass_properties(&self) -> &MassProperties {
        &self.mass
    }

    fn coefficients<T: Scalar>(&self, air: &AirData<T>, rates: [T; 3], controls: &Controls<T>) -> Coefficients<T> {
        let effects = &self.effects;
        let mut c = self.aircraft.coefficients(air, rates, &self.felt(controls));
        let geometry = self.aircraft.geometry();
        let (span_time, chord_time) =
            ((air.speed * 2.0).recip() * geometry.span, (air.speed * 2.0).recip() * geometry.mean_chord);
        let variables = [
            air.alpha - self.alpha_reference,
            air.beta,
            rates[0] * span_time,
            rates[1] * chord_time,
            rates[2] * span_time,
            controls.elevator - self.elevator_reference,
            controls.aileron,
            controls.rudder,
        ];
        let added: [T; 6] = std::array::from_fn(|i| {
            let slopes = effects.coupling[i].iter().zip(&variables).filter(|(slope, _)| **slope != 0.0);
            slopes.fold(T::from(effects.constants[i]), |sum, (slope, variable)| sum + *variable * *slope)
        });
        let [lift, drag, pitch, side, roll, yaw] = added;
        let (sine, cosine) = air.alpha.sin_cos();
        let [cx, cz] = lift_drag_to_body(lift, drag, sine, cosine);
        c.cx = c.cx + cx;
        c.cz = c.cz + cz;
        c.cy = c.cy + side;
        c.cl = c.cl + roll;
        c.cm = c.cm + pitch;
        c.cn = c.cn + yaw;
        c.about(effects.cg_shift, geometry)
    }

    fn alpha_rate_coefficients<T: Scalar>(
        &self,
        air: &AirData<T>,
        rates: [T; 3],
        controls: &Controls<T>,
    ) -> Option<Coefficients<T>> {
        let c = self.aircraft.alpha_rate_coefficients(air, rates, &self.felt(controls))?;
        Some(c.about(self.effects.cg_shift, self.aircraft.geometry()))
    }

    fn propulsion<T: Scalar>(&self, power: T, altitude: T, mach: T) -> Propulsion<T> {
        let whole = self.aircraft.propulsion(power, altitude, mach);
        let force = whole.force.map(|force| force * self.effects.thrust);
        let [roll, pitch, yaw] = whole.moment.map(|moment| moment * self.effects.thrust);
        Propulsion { force, moment: [roll, pitch, yaw - force[0] * self.effects.thrust_arm] }
    }

    fn slipstream_coefficients<T: Scalar>(
        &self,
        propulsion: &Propulsion<T>,
        air: &AirData<T>,
        rates: [T; 3],
        controls: &Controls<T>,
    ) -> Option<Coefficients<T>> {
        let c = self.aircraft.slipstream_coefficients(propulsion, air, rates, &self.felt(controls))?;
        Some(c.about(self.effects.cg_shift, self.aircraft.geometry()))
    }

    fn fuel_flow(&self, power: f64, altitude: f64, mach: f64) -> f64 {
        self.aircraft.fuel_flow(power, altitude, mach) * self.effects.thrust
    }

    fn after_burning(&self, fuel: f64) -> Option<Burnt> {
        let burnt = self.aircraft.after_burning(fuel)?;
        Some(Burnt { mass: self.effects.on_mass(&burnt.mass), ..burnt })
    }

    fn actuators(&self) -> &Actuators {
        &self.actuators
    }
}

#[cfg(test)]
mod tests {
    use phugoid_flight_dynamics::f16::{F16, F16Options};
    use phugoid_flight_dynamics::motion::{Disturbance, motion};
    use phugoid_flight_dynamics::trim::{TrimCondition, trim};

    use super::*;

    fn steady() -> (F16, Trim) {
        let f16 = F16::new(F16Options { cg: 0.30, ..F16Options::default() }).unwrap();
        let trim = trim(&f16, &TrimCondition::steady(&f16, 205.74, 6096.0, 0.0, 0.0)).unwrap();
        (f16, trim)
    }

    fn rates(aircraft: &impl Aircraft, trim: &Trim) -> [f64; 13] {
        motion(aircraft, &trim.state(), &trim.controls(), &Disturbance::default()).rates.to_array()
    }

    #[test]
    fn no_effects_change_no_bit() {
        let (f16, trim) = steady();
        assert_eq!(rates(&Damaged::new(&f16, Effects::NONE, &trim), &trim), rates(&f16, &trim));
    }

    /// Newton's laws by hand: what a constant moment, a shift of the centre of gravity and a lost engine do in trim.
    #[test]
    fn effects_act_as_newton_says() {
        let (f16, trim) = steady();
        let (g, m) = (*f16.geometry(), *f16.mass_properties());
        let air = f16.atmosphere().at(trim.altitude_m);
        let qs = 0.5 * air.density * trim.speed_m_s.powi(2) * g.wing_area;
        let of = |effects: Effects| rates(&Damaged::new(&f16, effects, &trim), &trim);
        let roll = of(Effects { constants: [0.0, 0.0, 0.0, 0.0, 0.004, 0.0], ..Effects::NONE });
        let expected = m.angular_acceleration([0.0; 3], [0.004 * qs * g.span, 0.0, 0.0]);
        assert!((roll[6] - expected[0]).abs() < 1e-10 && (roll[8] - expected[2]).abs() < 1e-10);
        // Lift ahead of the centre of gravity pitches up: M = -CZ qS shift cbar.
        let shifted = of(Effects { cg_shift: 0.05, ..Effects::NONE });
        let weight = m.mass() * f16.gravity();
        let rough = weight * 0.05 * g.mean_chord / m.pitch_inertia();
        assert!(shifted[7] > 0.9 * rough && shifted[7] < 1.1 * rough, "{} {rough}", shifted[7]);
        // Half the thrust, 1 m to the right: slower by T/2m, and the nose goes left.
        let engine = of(Effects { thrust: 0.5, thrust_arm: 1.0, ..Effects::NONE });
        let thrust = f16.propulsion(trim.power_percent, trim.altitude_m, trim.mach).force[0];
        assert!((engine[0] + 0.5 * thrust * trim.alpha_rad.cos() / m.mass()).abs() < 1e-9, "{}", engine[0]);
        assert!(engine[8] < 0.0);
    }
}
