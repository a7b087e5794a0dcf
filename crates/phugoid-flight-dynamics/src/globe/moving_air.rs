//! A vehicle in gusts and turbulence.

use super::condition::Condition;
use super::loads::{ForcesAndMoments, Loads};
use crate::gust::AirMotion;
use crate::mass::MassProperties;

/// A vehicle in air that moves besides the wind of the [`World`](super::condition::World).
///
/// The motion of the air is asked for once at the start of every step, with the time (s), and holds during the step: draw
/// from [`Dryden`](crate::dryden::Dryden) or [`VonKarman`](crate::von_karman::VonKarman) with the step as sample time. Where
/// the vehicle uses the rates of angle of attack and sideslip, these are those relative to the air without this motion.
///
/// ```
/// use phugoid_flight_dynamics::globe::loads::BluntBody;
/// use phugoid_flight_dynamics::globe::moving_air::InMovingAir;
/// use phugoid_flight_dynamics::gust::AirMotion;
/// use phugoid_flight_dynamics::mass::MassProperties;
///
/// let inertia = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
/// let mass = MassProperties::from_tensor(10.0, inertia, 0.0).ok_or("impossible inertia")?;
/// let body = BluntBody { mass, area: 0.02, span: 1.0, chord: 1.0, drag: 0.1, damping: [0.0; 3] };
/// // An updraught of 5 m/s after ten seconds.
/// let updraught = |time: f64| AirMotion::from([0.0, 0.0, if time < 10.0 { 0.0 } else { -5.0 }]);
/// let mut gusty = InMovingAir::new(body, updraught); // flown as any other vehicle
/// # let _ = &mut gusty;
/// # Ok::<(), &str>(())
/// ```
#[derive(Clone, Debug)]
pub struct InMovingAir<L, A> {
    vehicle: L,
    air: A,
    now: AirMotion,
}

impl<L, A: FnMut(f64) -> AirMotion> InMovingAir<L, A> {
    /// A vehicle, and the motion of the air at a time (s) in body axes.
    pub fn new(vehicle: L, air: A) -> Self {
        Self { vehicle, air, now: AirMotion::default() }
    }

    /// The vehicle.
    pub fn vehicle(&mut self) -> &mut L {
        &mut self.vehicle
    }
}

impl<const X: usize, L: Loads<X>, A: FnMut(f64) -> AirMotion> Loads<X> for InMovingAir<L, A> {
    fn mass_properties(&mut self, condition: &Condition<X>) -> MassProperties {
        self.vehicle.mass_properties(&condition.in_moving_air(&self.now))
    }

    fn loads(&mut self, condition: &Condition<X>) -> ForcesAndMoments {
        self.vehicle.loads(&condition.in_moving_air(&self.now))
    }

    fn internal_rates(&mut self, condition: &Condition<X>) -> [f64; X] {
        self.vehicle.internal_rates(&condition.in_moving_air(&self.now))
    }

    fn uses_angle_rates(&self) -> bool {
        self.vehicle.uses_angle_rates()
    }

    fn update(&mut self, condition: &Condition<X>) {
        self.now = (self.air)(condition.time);
        self.vehicle.update(&condition.in_moving_air(&self.now));
    }
}
