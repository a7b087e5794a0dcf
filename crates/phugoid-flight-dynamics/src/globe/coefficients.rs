//! Any [`Aircraft`] of this crate as a vehicle over the Earth.

use super::condition::Condition;
use super::loads::{ForcesAndMoments, Loads};
use crate::aircraft::{Aircraft, Controls};
use crate::mass::MassProperties;

/// An [`Aircraft`] with its controls as a function of time, flown by [`fly`](super::flight::fly) with one state of its own,
/// the engine's power level in percent.
///
/// Gravity and atmosphere are those of the [`World`](super::condition::World), whatever the aircraft's data assume; surfaces are
/// where they are commanded. Body rates are those relative to the rotating earth.
///
/// ```
/// use phugoid_flight_dynamics::aircraft::Controls;
/// use phugoid_flight_dynamics::f16::{F16, F16Options};
/// use phugoid_flight_dynamics::globe::attitude::EulerAngles;
/// use phugoid_flight_dynamics::globe::coefficients::FlownAircraft;
/// use phugoid_flight_dynamics::globe::condition::{InitialRates, Launch, World};
/// use phugoid_flight_dynamics::globe::flight::fly;
/// use phugoid_flight_dynamics::globe::planet::{Geodetic, Planet};
///
/// let aircraft = F16::new(F16Options { cg: 0.30, ..F16Options::default() })?;
/// let controls = Controls { throttle: 0.154, elevator: -1.96_f64.to_radians(), aileron: 0.0, rudder: 0.0 };
/// let mut vehicle = FlownAircraft::new(&aircraft, |_| controls);
/// // Over the north pole at 20,000 ft.
/// let world = World::new(Planet::WGS84);
/// let launch = Launch {
///     place: Geodetic { latitude: 1.5705, longitude: 0.0, altitude: 6096.0 },
///     velocity: [205.74, 0.0, 0.0],
///     euler: EulerAngles { pitch: 0.0417, ..EulerAngles::default() },
///     rates: InitialRates::Local([0.0; 3]),
/// };
/// let mut longitude = 0.0;
/// fly(&world, &mut vehicle, launch.state(&world.planet, 0.0, [10.0]), 0.0, 20.0, 0.01, |motion| {
///     longitude = motion.condition.place.longitude;
/// })?;
/// assert!(longitude.abs() > 3.0); // the other side of the pole
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct FlownAircraft<'a, A, C> {
    aircraft: &'a A,
    controls: C,
}

impl<'a, A: Aircraft, C: FnMut(f64) -> Controls> FlownAircraft<'a, A, C> {
    /// An aircraft, and its throttle lever (0 to 1) and surfaces (rad) at a time (s).
    pub fn new(aircraft: &'a A, controls: C) -> Self {
        Self { aircraft, controls }
    }
}

impl<A: Aircraft, C: FnMut(f64) -> Controls> Loads<1> for FlownAircraft<'_, A, C> {
    fn mass_properties(&mut self, _: &Condition<1>) -> MassProperties {
        *self.aircraft.mass_properties()
    }

    fn loads(&mut self, condition: &Condition<1>) -> ForcesAndMoments {
        let controls = (self.controls)(condition.time);
        let geometry = self.aircraft.geometry();
        let (air, rates) = (&condition.air, condition.rates_to_earth);
        let mut c = self.aircraft.coefficients(air, rates, &controls);
        let force = air.dynamic_pressure * geometry.wing_area;
        let [power] = condition.state.internal;
        let engine = self.aircraft.propulsion(power, condition.place.altitude, air.mach);
        if let Some(blown) = self.aircraft.slipstream_coefficients(&engine, air, rates, &controls) {
            c = c.with(&blown, 1.0);
        }
        ForcesAndMoments {
            aerodynamic_force: [c.cx * force, c.cy * force, c.cz * force],
            aerodynamic_moment: [
                c.cl * force * geometry.span,
                c.cm * force * geometry.mean_chord,
                c.cn * force * geometry.span,
            ],
            other_force: engine.force,
            other_moment: engine.moment,
        }
    }

    fn internal_rates(&mut self, condition: &Condition<1>) -> [f64; 1] {
        let controls = (self.controls)(condition.time);
        let [power] = condition.state.internal;
        [self.aircraft.power_rate(controls.throttle, power)]
    }
}
