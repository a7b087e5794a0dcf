//! The integration of a flight sample by sample: for who decides from one sample to the next what flies and how.

use super::delay::Delay;
use super::lighter::Lighter;
use super::{CommandHold, SimulationError, TrajectorySample, grid_time};
use crate::actuator::ACTUATOR_STATES;
use crate::aircraft::{Aircraft, Controls, STATES, State};
use crate::earth::Earth;
use crate::globe::attitude::{EulerAngles, Quaternion};
use crate::globe::vector::product;
use crate::gust::AirMotion;
use crate::increments::Increments;
use crate::integrate::rk4_step;
use crate::motion::{Disturbance, Motion, motion};
use crate::rigid_body::{Angles, attitude_equations};
use crate::standard_atmosphere::geopotential_altitude;
use crate::wind::WindProfile;

/// Aircraft states and the three surface positions.
const VECTOR: usize = STATES + ACTUATOR_STATES;
/// Places of roll, pitch and heading angle among them.
const ATTITUDE: std::ops::Range<usize> = 3..6;

const NAMES: [&str; VECTOR] = [
    "speed", "alpha", "beta", "phi", "theta", "psi", "p", "q", "r", "north", "east", "altitude", "power", "elevator",
    "aileron", "rudder",
];

/// What acts on the aircraft at one instant.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Instant {
    /// Commands to lever and surfaces (rad, throttle 0 to 1).
    pub commands: Controls,
    /// Motion of the air.
    pub air: AirMotion,
    /// Aerodynamic increments in force.
    pub increments: Increments,
}

/// A flight that is integrated one sample after another. [`Simulation`](super::Simulation) runs one from its beginning to its
/// end; who holds a stepper may give it another aircraft for each sample (damage that grows) and choose the commands from what
/// was measured.
///
/// ```
/// use phugoid_flight_dynamics::f16::{F16, F16Options};
/// use phugoid_flight_dynamics::simulate::{CommandHold, Instant, Stepper};
/// use phugoid_flight_dynamics::trim::{TrimCondition, trim};
///
/// let aircraft = F16::new(F16Options { cg: 0.30, ..F16Options::default() })?;
/// let steady = trim(&aircraft, &TrimCondition::steady(&aircraft, 205.74, 6096.0, 0.0, 0.0))?;
/// let mut flight = Stepper::new(steady.state(), steady.controls(), 0.01, 2, CommandHold::Sample);
/// for _ in 0..100 {
///     flight.hold(&aircraft, &Instant { commands: steady.controls(), ..Instant::default() })?;
/// }
/// assert_eq!(flight.time(), 1.0);
/// assert!(flight.state().q.abs() < 1e-9); // still in trim
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Stepper {
    /// Where the attitude is kept in `attitude`, its angles are those since the step began: zero.
    x: [f64; VECTOR],
    /// The attitude at the beginning of the step, where it is kept as a quaternion.
    attitude: Option<Quaternion>,
    /// Surface positions behind the play of their actuators, rad.
    surfaces: [f64; ACTUATOR_STATES],
    /// Commands that actuators with a delay still have to get.
    delay: Delay,
    /// Fuel that is burnt, kg.
    burnt: f64,
    /// Number of samples flown.
    k: usize,
    sample_time: f64,
    substeps: usize,
    hold: CommandHold,
    use_actuators: bool,
    wind: WindProfile,
    earth: Option<Earth>,
}

impl Stepper {
    /// A flight that begins in the state `initial` with the surfaces at `surfaces` (rad), with actuators. The sample time (s)
    /// is divided into `substeps` steps of the integration, at least one.
    pub fn new(initial: State, surfaces: Controls, sample_time: f64, substeps: usize, hold: CommandHold) -> Self {
        let surfaces = [surfaces.elevator, surfaces.aileron, surfaces.rudder];
        let (x, delay) = (join(&initial, surfaces), Delay::new(surfaces));
        let substeps = substeps.max(1);
        Self {
            x,
            attitude: None,
            surfaces,
            delay,
            burnt: 0.0,
            k: 0,
            sample_time,
            substeps,
            hold,
            use_actuators: true,
            wind: WindProfile::default(),
            earth: None,
        }
    }

    /// The same flight with or without the aircraft's actuators.
    #[must_use]
    pub fn with_actuators(self, use_actuators: bool) -> Self {
        Self { use_actuators, ..self }
    }

    /// The same flight in air that moves with this wind. Speed, angle of attack and sideslip of the state are those relative
    /// to it.
    #[must_use]
    pub fn with_wind(self, wind: WindProfile) -> Self {
        Self { wind, ..self }
    }

    /// The same flight over a planet; without one, or with none, over a plane. `p`, `q` and `r` of the state are then relative to
    /// the stars, the altitude is geometric, and `north` and `east` are as in [`earth`](crate::earth).
    #[must_use]
    pub fn over(self, earth: Option<Earth>) -> Self {
        Self { earth, ..self }
    }

    /// The same flight with its attitude kept as a quaternion from step to step, in place of Euler angles, which fail at 90 deg of
    /// pitch: it flies loops. Within a step it turns by small angles from where the step began. Roll angle and heading of the
    /// state are then from -pi to pi.
    #[must_use]
    pub fn with_quaternion(mut self) -> Self {
        let state = self.state();
        self.attitude = Some(Quaternion::default());
        self.set_state(&state);
        self
    }

    /// Time since the start of the flight, s.
    pub fn time(&self) -> f64 {
        grid_time(self.k, self.sample_time)
    }

    /// State of the aircraft now.
    pub fn state(&self) -> State {
        turned(self.attitude.as_ref(), split(&self.x).0)
    }

    /// Puts the aircraft into another state; surfaces and time stay. For an aircraft whose centre of gravity jumps in the body.
    pub fn set_state(&mut self, state: &State) {
        let (_, surfaces) = split(&self.x);
        self.x = join(state, surfaces);
        if let Some(attitude) = &mut self.attitude {
            *attitude = Quaternion::of_matrix(&angles(state).matrix());
            self.x[ATTITUDE].fill(0.0);
        }
    }

    /// Surface positions behind the actuators and their play, `[elevator, aileron, rudder]`, rad. Without actuators they are where
    /// they began.
    pub fn positions(&self) -> [f64; ACTUATOR_STATES] {
        self.surfaces
    }

    /// Everything that the aircraft shows at this instant.
    pub fn sample<A: Aircraft>(&self, aircraft: &A, now: &Instant) -> TrajectorySample {
        match aircraft.after_burning(self.burnt) {
            None => self.sample_of(aircraft, now, None),
            Some(burnt) => self.sample_of(&Lighter::new(aircraft, burnt), now, Some(burnt.left)),
        }
    }

    fn sample_of<A: Aircraft>(&self, aircraft: &A, now: &Instant, fuel: Option<f64>) -> TrajectorySample {
        let state = self.state();
        let wind = self.wind.at(state.altitude);
        let (gust, gust_rates) = (now.air.velocity, now.air.rates);
        let earth = self.earth.map(|earth| earth.under(&state));
        let disturbance = Disturbance { wind, gust, gust_rates, increments: now.increments, earth };
        let [north, east] = earth.map_or([1.0; 2], |earth| earth.map);
        let actuators = self.use_actuators.then(|| aircraft.actuators());
        let surfaces = actuators.map_or(now.commands, |a| a.controls(&now.commands, self.surfaces));
        let motion = motion(aircraft, &state, &surfaces, &disturbance);
        TrajectorySample {
            time: self.time(),
            state,
            commands: now.commands,
            surfaces,
            air: motion.air,
            specific_force: motion.specific_force,
            angular_acceleration: [motion.rates.p, motion.rates.q, motion.rates.r],
            propulsive_force: aircraft.propulsion(state.power, air_altitude(self.earth, &state), motion.air.mach).force,
            coefficients: motion.coefficients,
            wind: wind.velocity,
            ground_velocity: [motion.rates.north / north, motion.rates.east / east, -motion.rates.altitude],
            place: self.earth.map(|earth| earth.place(state.north, state.east, state.altitude)),
            mass: aircraft.mass_properties().mass(),
            fuel,
        }
    }

    /// Flies one sample with commands that are held, and the same air and increments throughout.
    ///
    /// # Errors
    /// [`SimulationError`]: the motion diverges, or the aircraft leaves its atmosphere.
    pub fn hold<A: Aircraft>(&mut self, aircraft: &A, now: &Instant) -> Result<(), SimulationError> {
        self.advance(aircraft, now.commands, |_, _| now.commands, |_| now.air, |_| now.increments)
    }

    /// Flies one sample. `command` holds from its beginning; where commands are held over a step, `commands` is asked again at
    /// the beginning of each further one. The air is asked at every stage of the integration, the increments at every step. The mass
    /// over a sample is that of its middle.
    ///
    /// # Errors
    /// [`SimulationError`]: the motion diverges, or the aircraft leaves its atmosphere; the flight is then over.
    pub fn advance<A: Aircraft>(
        &mut self,
        aircraft: &A,
        command: Controls,
        commands: impl FnMut(f64, &State) -> Controls,
        air: impl FnMut(f64) -> AirMotion,
        increments: impl Fn(f64) -> Increments,
    ) -> Result<(), SimulationError> {
        let earth = self.earth;
        let flow = |state: &State| {
            let altitude = air_altitude(earth, state);
            let mach = state.speed / aircraft.atmosphere().at(altitude).speed_of_sound;
            aircraft.fuel_flow(state.power, altitude, mach)
        };
        let Some(now) = aircraft.after_burning(self.burnt) else {
            return self.advance_as(aircraft, command, commands, air, increments);
        };
        // Without fuel the engines do not run.
        let runs = now.left > 0.0;
        let before = if runs { flow(&self.state()) } else { 0.0 };
        let middle = aircraft.after_burning(self.burnt + 0.5 * self.sample_time * before).unwrap_or(now);
        self.advance_as(&Lighter::new(aircraft, middle), command, commands, air, increments)?;
        if runs {
            self.burnt += 0.5 * self.sample_time * (before + flow(&self.state()));
        }
        Ok(())
    }

    fn advance_as<A: Aircraft>(
        &mut self,
        aircraft: &A,
        mut command: Controls,
        mut commands: impl FnMut(f64, &State) -> Controls,
        mut air: impl FnMut(f64) -> AirMotion,
        increments: impl Fn(f64) -> Increments,
    ) -> Result<(), SimulationError> {
        let time = self.time();
        let last_speed = self.state().speed;
        let step = self.sample_time / self.substeps as f64;
        let actuators = self.use_actuators.then(|| aircraft.actuators());
        let wind = &self.wind;
        let mut disturbance = Disturbance { increments: increments(time), ..Disturbance::default() };
        for substep in 0..self.substeps {
            let t = time + substep as f64 * step;
            if substep > 0 {
                if self.hold == CommandHold::Step {
                    command = commands(t, &self.state());
                }
                disturbance.increments = increments(t);
            }
            let told = match actuators {
                Some(a) => self.delay.delayed(a, command, t, step),
                None => command,
            };
            let before = self.surfaces;
            let (begun, earth) = (self.attitude, self.earth);
            let rates = |t: f64, x: &[f64; VECTOR]| {
                let (moved, positions) = split(x);
                let state = turned(begun.as_ref(), moved);
                let air = air(t);
                (disturbance.gust, disturbance.gust_rates) = (air.velocity, air.rates);
                disturbance.wind = wind.at(state.altitude);
                disturbance.earth = earth.map(|earth| earth.under(&state));
                let (surfaces, surface_rates) = match actuators {
                    Some(a) => (a.controls(&told, a.surfaces(positions, before)), a.rates(&told, positions)),
                    None => (command, [0.0; ACTUATOR_STATES]),
                };
                join(
                    &rates_since(begun.is_some(), &moved, motion(aircraft, &state, &surfaces, &disturbance)),
                    surface_rates,
                )
            };
            self.x = rk4_step(rates, t, &self.x, step);
            if let Some(attitude) = &mut self.attitude {
                let (moved, _) = split(&self.x);
                *attitude = Quaternion::of_matrix(&product(&angles(&moved).matrix(), &attitude.matrix()));
                self.x[ATTITUDE].fill(0.0);
            }
            if let Some(a) = actuators {
                self.surfaces = a.surfaces(split(&self.x).1, before);
            }
        }
        self.k += 1;
        let time = self.time();
        if let Some((_, state)) = self.x.iter().zip(NAMES).find(|(v, _)| !v.is_finite()) {
            return Err(SimulationError::NotFinite { state, time, last_speed });
        }
        let (altitude, ceiling) = (air_altitude(self.earth, &self.state()), aircraft.atmosphere().ceiling());
        if altitude > ceiling {
            return Err(SimulationError::AboveTheAir { time, altitude, ceiling });
        }
        Ok(())
    }
}

/// The altitude by which the aircraft's atmosphere counts, m: over a planet that of the state is geometric.
fn air_altitude(earth: Option<Earth>, state: &State) -> f64 {
    if earth.is_some() { geopotential_altitude(state.altitude) } else { state.altitude }
}

fn angles(state: &State) -> EulerAngles {
    EulerAngles { yaw: state.psi, pitch: state.theta, roll: state.phi }
}

/// A state whose attitude is that since the attitude `begun`, with its attitude against north, east and down. Without one it is
/// that already.
fn turned(begun: Option<&Quaternion>, state: State) -> State {
    let Some(begun) = begun else { return state };
    let EulerAngles { yaw, pitch, roll } = EulerAngles::of_matrix(&product(&angles(&state).matrix(), &begun.matrix()));
    State { phi: roll, theta: pitch, psi: yaw, ..state }
}

/// The rates of a state; where its attitude is that since the step began, the rates of those angles, which stay small.
fn rates_since(begun: bool, moved: &State, motion: Motion) -> State {
    if !begun {
        return motion.rates;
    }
    let angles = Angles::of(0.0, 0.0, moved.phi, moved.theta);
    let [phi, theta, psi] = attitude_equations(&angles, motion.turning);
    State { phi, theta, psi, ..motion.rates }
}

fn join(state: &State, surfaces: [f64; ACTUATOR_STATES]) -> [f64; VECTOR] {
    let mut x = [0.0; VECTOR];
    let (head, tail) = x.split_at_mut(STATES);
    head.copy_from_slice(&state.to_array());
    tail.copy_from_slice(&surfaces);
    x
}

fn split(x: &[f64; VECTOR]) -> (State, [f64; ACTUATOR_STATES]) {
    (State::from_array(core::array::from_fn(|i| x[i])), core::array::from_fn(|i| x[STATES + i]))
}
