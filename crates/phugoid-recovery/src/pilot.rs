//! The pilot: holds altitude, speed and wings level with slow loops, and moves the stick as the scenario says.

use phugoid_control::law::Demand;
use phugoid_flight_dynamics::trim::Trim;
use phugoid_simulation::scenario::{Scenario, ScenarioError};

use crate::scale::Scale;
use crate::sensing::Reading;

/// Pitch rate per degree of elevator stick, 1/s; roll rate per degree of aileron stick; sideslip per degree of rudder stick.
const PITCH_RATE: f64 = -1.0;
const ROLL_RATE: f64 = -5.0;
const SIDESLIP: f64 = 0.5;
/// Bandwidths of the pilot's loops, rad/s: attitude, and the flight path by the altitude.
const ATTITUDE: f64 = 1.0;
const ALTITUDE: f64 = 0.1;
/// Largest climb or descent that the pilot asks for, m/s, and largest rates, rad/s.
const CLIMB: f64 = 8.0;
const LARGEST_PITCH_RATE: f64 = 0.06;
const LARGEST_ROLL_RATE: f64 = 0.35;
/// Time over which the pilot takes the angle of attack for steady, s.
const STEADY: f64 = 2.0;

/// A pilot who flies straight and level.
pub struct Pilot {
    /// The pilot flies the full size: everything below is of it.
    scale: Scale,
    /// Stick in the direction of elevator, aileron and rudder at each sample, rad.
    stick: [Vec<f64>; 3],
    altitude: f64,
    speed: f64,
    throttle: f64,
    /// Angle of attack that goes with steady flight, rad.
    alpha: f64,
    /// Speed error that was integrated, m.
    slow: f64,
    sample_time: f64,
    gravity: f64,
    last: [f64; 5],
}

/// What the pilot does in one frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wish {
    /// What the control law is asked for, rates at full size.
    pub demand: Demand,
    /// Throttle lever, 0 to 1.
    pub throttle: f64,
}

impl Pilot {
    /// A pilot who keeps the altitude and the speed of the trim, with the stick of the scenario's manoeuvres.
    ///
    /// # Errors
    /// [`ScenarioError`]: a manoeuvre that cannot be flown.
    pub fn new(scenario: &Scenario, trim: &Trim, gravity: f64) -> Result<Self, ScenarioError> {
        let scale = Scale::of(scenario);
        let (altitude, speed) = (scale.length(trim.altitude_m), scale.speed(trim.speed_m_s));
        Ok(Self {
            scale,
            stick: scenario.deflections()?,
            altitude,
            speed,
            throttle: trim.throttle,
            alpha: trim.alpha_rad,
            slow: 0.0,
            sample_time: scale.time(1.0 / scenario.sample_rate.si()),
            gravity,
            last: [trim.phi_rad, trim.theta_rad, trim.alpha_rad, speed, altitude],
        })
    }

    /// What the pilot does at sample `k`.
    pub fn fly(&mut self, k: usize, reading: &Reading) -> Wish {
        for (last, name) in self.last.iter_mut().zip(["phi", "theta", "alpha", "true_airspeed", "altitude"]) {
            let now = self.scale.channel(name, reading.channel(name));
            if now.is_finite() {
                *last = now;
            }
        }
        let [phi, theta, alpha, speed, altitude] = self.last;
        self.alpha += (alpha - self.alpha) * self.sample_time / STEADY;
        let climb = (ALTITUDE * (self.altitude - altitude)).clamp(-CLIMB, CLIMB);
        let pitch = climb / speed.max(1.0) + self.alpha;
        let (sine, cosine) = phi.sin_cos();
        // A turn needs a pitch rate as well: q = r tan(phi).
        let yaw_rate = self.gravity / speed.max(1.0) * sine * theta.cos();
        let turning = if cosine.abs() > 0.2 { yaw_rate * sine / cosine } else { 0.0 };
        let stick = |surface: usize| self.stick[surface].get(k).copied().unwrap_or(0.0);
        let held = (ATTITUDE * (pitch - theta)).clamp(-LARGEST_PITCH_RATE, LARGEST_PITCH_RATE);
        let levelled = (-ATTITUDE * phi).clamp(-LARGEST_ROLL_RATE, LARGEST_ROLL_RATE);
        let behind = self.speed - speed;
        let throttle = self.throttle + 0.02 * behind + 0.002 * self.slow;
        // Only integrated where the lever can follow.
        if (0.0..=1.0).contains(&throttle) {
            self.slow += behind * self.sample_time;
        }
        Wish {
            demand: Demand {
                pitch_rate: held + turning + PITCH_RATE * stick(0),
                roll_rate: levelled + ROLL_RATE * stick(1),
                yaw_rate,
                sideslip: SIDESLIP * stick(2),
            },
            throttle: throttle.clamp(0.0, 1.0),
        }
    }
}
