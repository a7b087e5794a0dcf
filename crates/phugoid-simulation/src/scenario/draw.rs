//! Values that differ from flight to flight: they are drawn once, from the seed of the scenario.

use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64;

use super::Scenario;
use super::sensors::{Sensor, Sensors};
use crate::quantity::{Acceleration, Angle, AngularAcceleration, AngularRate, Length, Quantity, Speed};

impl Scenario {
    /// The scenario as it is flown with its seed: every value that is drawn once per flight is replaced by its drawn
    /// value. Noise, outliers, dropped frames, the pilot and turbulence stay random signals of the seed.
    #[must_use]
    pub fn drawn(&self) -> Self {
        let mut flown = self.clone();
        // A stream of its own, so that a range more changes no noise.
        let mut random = Pcg64::seed_from_u64(self.seed ^ 0x0064_7261_776e);
        flown.increment_ranges.draw(&mut flown.increments, &mut random);
        for damage in &mut flown.damage {
            damage.ranges.draw(&mut damage.increments, &mut random);
        }
        flown.sensors.draw(self.seed);
        flown
    }
}

impl Sensors {
    /// Draws the constant errors of a flight.
    pub(crate) fn draw(&mut self, seed: u64) {
        let mut random = Pcg64::seed_from_u64(seed ^ 0x6269_6173_6573);
        draw(&mut self.true_airspeed, Speed::from_si, &mut random);
        draw(&mut self.alpha, Angle::from_si, &mut random);
        draw(&mut self.beta, Angle::from_si, &mut random);
        draw(&mut self.phi, Angle::from_si, &mut random);
        draw(&mut self.theta, Angle::from_si, &mut random);
        draw(&mut self.psi, Angle::from_si, &mut random);
        draw(&mut self.p, AngularRate::from_si, &mut random);
        draw(&mut self.q, AngularRate::from_si, &mut random);
        draw(&mut self.r, AngularRate::from_si, &mut random);
        draw(&mut self.ax, Acceleration::from_si, &mut random);
        draw(&mut self.ay, Acceleration::from_si, &mut random);
        draw(&mut self.az, Acceleration::from_si, &mut random);
        draw(&mut self.altitude, Length::from_si, &mut random);
        draw(&mut self.elevator, Angle::from_si, &mut random);
        draw(&mut self.aileron, Angle::from_si, &mut random);
        draw(&mut self.rudder, Angle::from_si, &mut random);
        for sensor in [&mut self.pdot, &mut self.qdot, &mut self.rdot].into_iter().flatten() {
            draw(sensor, AngularAcceleration::from_si, &mut random);
        }
        for sensor in [&mut self.north, &mut self.east].into_iter().flatten() {
            draw(sensor, Length::from_si, &mut random);
        }
        if let Some(sensor) = &mut self.ground_speed {
            draw(sensor, Speed::from_si, &mut random);
        }
    }
}

fn draw<Q: Quantity>(sensor: &mut Sensor<Q>, of_si: fn(f64) -> Q, random: &mut Pcg64) {
    let normal: f64 = StandardNormal.sample(random);
    let spread = sensor.bias_spread.si();
    if spread != 0.0 {
        sensor.bias = of_si(sensor.bias.si() + spread * normal);
        sensor.bias_spread = of_si(0.0);
    }
    // Only drawn where it is asked for: scenarios without it keep their numbers.
    if sensor.scale_error_spread != 0.0 {
        let normal: f64 = StandardNormal.sample(random);
        sensor.scale_error += sensor.scale_error_spread * normal;
        sensor.scale_error_spread = 0.0;
    }
}
