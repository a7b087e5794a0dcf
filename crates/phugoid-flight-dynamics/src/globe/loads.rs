//! What a vehicle tells the equations of motion: its mass, and the forces and moments on it.

use super::condition::Condition;
use super::vector::Vector;
use crate::mass::MassProperties;

/// Forces and moments on a vehicle, gravitation left out, and what of them is aerodynamic.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ForcesAndMoments {
    /// Aerodynamic force in body axes (x forward, y right, z down), N.
    pub aerodynamic_force: Vector,
    /// Aerodynamic moment about the centre of gravity in body axes, N m: positive right wing down, nose up, nose right.
    pub aerodynamic_moment: Vector,
    /// All other forces (engine, landing gear) in body axes, N.
    pub other_force: Vector,
    /// Moment of the other forces about the centre of gravity in body axes, N m.
    pub other_moment: Vector,
}

impl ForcesAndMoments {
    /// Sum of the forces in body axes, N.
    #[inline]
    pub fn force(&self) -> Vector {
        super::vector::add(self.aerodynamic_force, self.other_force)
    }

    /// Sum of the moments about the centre of gravity in body axes, N m.
    #[inline]
    pub fn moment(&self) -> Vector {
        super::vector::add(self.aerodynamic_moment, self.other_moment)
    }
}

/// A vehicle that [`fly`](super::flight::fly) can fly, with `X` states of its own (engine, actuators, controller).
///
/// Every function gets the whole [`Condition`] at an instant: time, position, attitude, rates, air data and the vehicle's
/// own states. They take `&mut self` so that an evaluator of tables may keep its scratch memory; what they give must
/// depend on the condition alone, since the integration asks for instants within a step in any order. What changes at
/// sampling instants belongs in [`update`](Self::update). A value that is not finite ends the flight with an error.
pub trait Loads<const X: usize = 0> {
    /// Mass (kg) and inertia (kg m^2) about the centre of gravity, which is the point whose motion is integrated.
    fn mass_properties(&mut self, condition: &Condition<X>) -> MassProperties;

    /// Forces (N) and moments (N m) about the centre of gravity, gravitation left out.
    fn loads(&mut self, condition: &Condition<X>) -> ForcesAndMoments;

    /// Rates of the vehicle's own states, each in its unit per second.
    fn internal_rates(&mut self, condition: &Condition<X>) -> [f64; X] {
        let _ = condition;
        [0.0; X]
    }

    /// Whether [`loads`](Self::loads) uses the rates of angle of attack and sideslip. They follow from the accelerations
    /// that the loads cause; if true, both are solved together and `loads` is called several times per instant.
    fn uses_angle_rates(&self) -> bool {
        false
    }

    /// Called once at the start of every step with the condition there, before anything else: for sampled controllers.
    fn update(&mut self, condition: &Condition<X>) {
        let _ = condition;
    }
}

impl<const X: usize, L: Loads<X> + ?Sized> Loads<X> for &mut L {
    fn mass_properties(&mut self, condition: &Condition<X>) -> MassProperties {
        (**self).mass_properties(condition)
    }

    fn loads(&mut self, condition: &Condition<X>) -> ForcesAndMoments {
        (**self).loads(condition)
    }

    fn internal_rates(&mut self, condition: &Condition<X>) -> [f64; X] {
        (**self).internal_rates(condition)
    }

    fn uses_angle_rates(&self) -> bool {
        (**self).uses_angle_rates()
    }

    fn update(&mut self, condition: &Condition<X>) {
        (**self).update(condition);
    }
}

/// The simplest vehicle: constant drag along the motion through the air, and damping of the rotation.
///
/// Drag is `qbar S C_D` against the motion through the air. The damping moments are
/// `qbar S b C_lp p b/(2V)`, `qbar S c C_mq q c/(2V)` and `qbar S b C_nr r b/(2V)` with the rates relative to the rotating
/// air. Without motion through the air there is neither.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BluntBody {
    /// Mass and inertia about the centre of gravity.
    pub mass: MassProperties,
    /// Reference area, m^2.
    pub area: f64,
    /// Reference length of rolling and yawing moment, m.
    pub span: f64,
    /// Reference length of the pitching moment, m.
    pub chord: f64,
    /// Drag coefficient, positive against the motion.
    pub drag: f64,
    /// Damping `[C_lp, C_mq, C_nr]` per `p b/(2V)`, `q c/(2V)`, `r b/(2V)`; negative values damp.
    pub damping: Vector,
}

impl Loads for BluntBody {
    fn mass_properties(&mut self, _: &Condition) -> MassProperties {
        self.mass
    }

    fn loads(&mut self, condition: &Condition) -> ForcesAndMoments {
        let speed = condition.air.speed;
        if speed == 0.0 {
            return ForcesAndMoments::default();
        }
        let force = condition.air.dynamic_pressure * self.area;
        let lengths = [self.span, self.chord, self.span];
        let velocity = condition.air_velocity;
        let rates = condition.rates_to_earth;
        ForcesAndMoments {
            aerodynamic_force: velocity.map(|v| -force * self.drag * v / speed),
            aerodynamic_moment: core::array::from_fn(|i| {
                force * lengths[i] * self.damping[i] * rates[i] * lengths[i] / (2.0 * speed)
            }),
            ..ForcesAndMoments::default()
        }
    }
}
