//! Flights of an aircraft from commands, gusts and a schedule of increments: histories in plain data.

mod changed;
mod delay;
mod lighter;
mod stepper;

use crate::aircraft::{AirData, Aircraft, Coefficients, Controls, Propulsion, State};
use crate::globe::planet::Geodetic;
use crate::gust::AirMotion;
use crate::increments::IncrementSchedule;

pub use self::stepper::{Instant, Stepper};

/// How long a command lasts once it is given.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum CommandHold {
    /// Over a whole sample, as from a flight computer that runs at the sample rate. The recorded commands then tell all
    /// there is to know of the input.
    #[default]
    Sample,
    /// Over one integration step, so that commands may change between samples.
    Step,
}

/// A flight to be simulated with a fixed step. Fill in the fields, or start from [`Simulation::new`].
///
/// The step is `sample_time / substeps`, Runge-Kutta of order four. Commands and increments are taken at the beginning of
/// their interval and held over it, so that what switches at `t` acts from `t` on and is in the sample at `t` (right
/// limit). Gusts are taken at every stage of a step.
///
/// A doublet of one degree on the elevator, from the trim:
///
/// ```
/// use phugoid_flight_dynamics::aircraft::Controls;
/// use phugoid_flight_dynamics::f16::{F16, F16Options};
/// use phugoid_flight_dynamics::simulate::{Simulation, still_air};
/// use phugoid_flight_dynamics::trim::{TrimCondition, trim};
///
/// let aircraft = F16::new(F16Options { cg: 0.30, ..F16Options::default() })?;
/// let steady = trim(&aircraft, &TrimCondition::steady(&aircraft, 205.74, 6096.0, 0.0, 0.0))?;
/// let doublet = |time: f64| {
///     let step = if time < 1.0 { 0.0 } else if time < 2.0 { -1.0 } else if time < 3.0 { 1.0 } else { 0.0 };
///     Controls { elevator: steady.elevator_rad + f64::to_radians(step), ..steady.controls() }
/// };
/// let flight = Simulation::new(&aircraft, steady.state(), steady.controls(), 5.0).run(doublet, still_air)?;
/// assert_eq!(flight.samples.len(), 501);
/// assert!(flight.samples[100].state.q.abs() < 1e-9); // in trim until the doublet begins
/// assert!(flight.samples[200].state.alpha > steady.alpha_rad + 0.02); // the nose came up
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Simulation<'a, A> {
    /// The aircraft that flies; any implementation of [`Aircraft`].
    pub aircraft: &'a A,
    /// State of the aircraft at time zero, usually that of a trim.
    pub initial: State,
    /// Surface positions at time zero, rad. Without actuators they are not used.
    pub initial_surfaces: Controls,
    /// Whether the surfaces follow their commands through the aircraft's actuators. Without, the surfaces are where they
    /// are commanded, beyond their limits too.
    pub use_actuators: bool,
    /// Aerodynamic increments and when they change.
    pub increments: IncrementSchedule,
    /// Length of the flight, s.
    pub duration: f64,
    /// Time between the samples of the trajectory, s.
    pub sample_time: f64,
    /// Integration steps per sample, at least one.
    pub substeps: usize,
    /// How long a command is held.
    pub hold: CommandHold,
}

/// The flight at one instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TrajectorySample {
    /// Time since the start of the flight, s.
    pub time: f64,
    /// State of the aircraft at this time.
    pub state: State,
    /// Commands in force from this instant on (rad, throttle 0 to 1).
    pub commands: Controls,
    /// Throttle lever and surface positions (rad).
    pub surfaces: Controls,
    /// Motion relative to the air.
    pub air: AirData,
    /// Specific force at the centre of gravity in body axes, m/s^2.
    pub specific_force: [f64; 3],
    /// Rates of p, q, r, rad/s^2.
    pub angular_acceleration: [f64; 3],
    /// Force of the propulsion system in body axes, N.
    pub propulsive_force: [f64; 3],
    /// Aerodynamic coefficients with the increments in force, body axes, about the centre of gravity.
    pub coefficients: Coefficients,
    /// Steady wind at the altitude of the aircraft, towards north and east, m/s; gusts are not in it.
    pub wind: [f64; 2],
    /// Velocity over the ground towards north, east and down, m/s.
    pub ground_velocity: [f64; 3],
    /// Latitude, longitude and altitude; none over a plane.
    pub place: Option<Geodetic>,
    /// Mass of the aircraft, kg.
    pub mass: f64,
    /// Fuel that is left, kg; none for an aircraft whose mass stays as it is.
    pub fuel: Option<f64>,
}

impl TrajectorySample {
    /// Size of the force of the propulsion system, N, negative where it pushes backwards along body x.
    pub fn thrust(&self) -> f64 {
        Propulsion { force: self.propulsive_force, moment: [0.0; 3] }.thrust()
    }
}

/// A simulated flight: one sample at time zero and then one every sample time, up to and including the duration.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Trajectory {
    /// The samples in order of time.
    pub samples: Vec<TrajectorySample>,
}

/// Why a flight could not be simulated to its end.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum SimulationError {
    /// Times that make no grid.
    #[error(
        "duration {duration} s, sample time {sample_time} s, {substeps} steps per sample: the duration has to be finite \
         and not negative, the sample time positive and the steps at least one"
    )]
    InvalidTimes {
        /// The duration that was asked for, s.
        duration: f64,
        /// Sample time asked for, s.
        sample_time: f64,
        /// Steps per sample asked for.
        substeps: usize,
    },
    /// A state has left the finite numbers: the motion has diverged, or an input is not a number.
    #[error(
        "state {state} is no longer finite at {time} s: the motion has diverged or an input is not a number; last finite \
         airspeed {last_speed} m/s"
    )]
    NotFinite {
        /// Name of the first state that is not finite.
        state: &'static str,
        /// End of the sample in which it happened, s.
        time: f64,
        /// True airspeed one sample earlier, m/s.
        last_speed: f64,
    },
    /// The aircraft has left the atmosphere that its data assume ([`Atmosphere::ceiling`](crate::atmosphere::Atmosphere::ceiling)).
    #[error(
        "at {time} s the aircraft is at {altitude:.0} m, above {ceiling:.0} m, where its model of the atmosphere ends: end \
         the flight before, or fly lower"
    )]
    AboveTheAir {
        /// End of the sample in which it happened, s.
        time: f64,
        /// Altitude above sea level then, m.
        altitude: f64,
        /// Highest altitude of the model, m.
        ceiling: f64,
    },
}

/// Air at rest, for [`Simulation::run`].
pub fn still_air(_time: f64) -> [f64; 3] {
    [0.0; 3]
}

impl<'a, A: Aircraft> Simulation<'a, A> {
    /// A flight with actuators, no increments, 100 samples per second with two integration steps each.
    pub fn new(aircraft: &'a A, initial: State, initial_surfaces: Controls, duration: f64) -> Self {
        Self {
            aircraft,
            initial,
            initial_surfaces,
            use_actuators: true,
            increments: IncrementSchedule::default(),
            duration,
            sample_time: 0.01,
            substeps: 2,
            hold: CommandHold::Sample,
        }
    }

    /// Flies with commands and the motion of the air as functions of time alone; three numbers are its velocity (body
    /// axes, m/s).
    ///
    /// # Errors
    /// [`SimulationError`] when the times make no grid or the motion diverges.
    pub fn run<W: Into<AirMotion>>(
        &self,
        mut commands: impl FnMut(f64) -> Controls,
        gust: impl FnMut(f64) -> W,
    ) -> Result<Trajectory, SimulationError> {
        self.run_closed_loop(|time, _| commands(time), gust)
    }

    /// Flies with commands from time and state: a pilot or an autopilot.
    ///
    /// # Errors
    /// [`SimulationError`] when the times make no grid or the motion diverges.
    pub fn run_closed_loop<W: Into<AirMotion>>(
        &self,
        mut commands: impl FnMut(f64, &State) -> Controls,
        mut gust: impl FnMut(f64) -> W,
    ) -> Result<Trajectory, SimulationError> {
        let (intervals, mut stepper) = self.start()?;
        let mut samples = Vec::with_capacity(intervals + 1);
        for k in 0..=intervals {
            let time = stepper.time();
            let command = commands(time, &stepper.state());
            let now = Instant { commands: command, air: gust(time).into(), increments: self.increments.at(time) };
            samples.push(stepper.sample(self.aircraft, &now));
            if k < intervals {
                let air = |t: f64| gust(t).into();
                stepper.advance(self.aircraft, command, &mut commands, air, |t| self.increments.at(t))?;
            }
        }
        Ok(Trajectory { samples })
    }

    /// The number of samples after the first, and the flight at its beginning.
    fn start(&self) -> Result<(usize, Stepper), SimulationError> {
        let Self { duration, sample_time, substeps, .. } = *self;
        let valid = duration >= 0.0 && duration.is_finite() && sample_time > 0.0 && sample_time.is_finite();
        if !valid || substeps == 0 {
            return Err(SimulationError::InvalidTimes { duration, sample_time, substeps });
        }
        // A duration that is a multiple of the sample time up to rounding includes its last sample.
        let intervals = (duration / sample_time * (1.0 + 1e-12)) as usize;
        let stepper = Stepper::new(self.initial, self.initial_surfaces, sample_time, substeps, self.hold);
        Ok((intervals, stepper.with_actuators(self.use_actuators)))
    }
}

/// The time of sample `k`. Where the sample rate is a whole number of hertz it is `k / rate`, which is the nearest number
/// to the decimal that a scenario names (`k * 0.01` is not), so that a switch at 0.07 s falls on its sample.
fn grid_time(k: usize, sample_time: f64) -> f64 {
    let rate = (1.0 / sample_time).round();
    if rate > 0.0 && (rate * sample_time - 1.0).abs() < 1e-12 { k as f64 / rate } else { k as f64 * sample_time }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sample_times_are_the_decimals_that_scenarios_name() {
        for (k, expected) in [(7, 0.07), (29, 0.29), (57, 0.57), (115, 1.15), (1999, 19.99)] {
            assert_eq!(grid_time(k, 0.01), expected);
        }
        assert_eq!(grid_time(3, 0.02), 0.06);
        assert_eq!(grid_time(4, 0.3), 4.0 * 0.3);
    }
}
