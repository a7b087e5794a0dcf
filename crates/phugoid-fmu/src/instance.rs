//! A running FMU: the rules of FMI 3.0 about what may be called when, over the equations of motion and the integration that every
//! simulated flight of Phugoid has.

use phugoid_flight_dynamics::aircraft::{Aircraft, Controls, State};
use phugoid_flight_dynamics::motion::{Disturbance, motion};
use phugoid_flight_dynamics::simulate::{CommandHold, Instant, SimulationError, Stepper, TrajectorySample};

use crate::point::{Point, PointError};
use crate::resources::Resources;
use crate::variables::{Role, STATES, Variability, Variable, variable, variables};

/// Most integration steps of one communication step: some minutes of computing.
const MOST_STEPS: f64 = 1e7;
/// How far the communication point may be from the time of the FMU: as a part of the step, and of the time.
const TIME_TOLERANCE: [f64; 2] = [1e-6, 1e-9];

/// Who integrates.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Interface {
    /// The importing program, which asks for derivatives.
    ModelExchange,
    /// The FMU, with the classical Runge-Kutta method.
    CoSimulation,
}

/// The states of the state machine of FMI 3.0 that an FMU without events passes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(missing_docs)] // the words of FMI 3.0
pub enum Mode {
    Instantiated,
    Initialization,
    Event,
    ContinuousTime,
    Step,
    Terminated,
}

impl Mode {
    const ALL: [Self; 6] =
        [Self::Instantiated, Self::Initialization, Self::Event, Self::ContinuousTime, Self::Step, Self::Terminated];

    fn word(self) -> &'static str {
        match self {
            Self::Instantiated => "instantiated",
            Self::Initialization => "initialization mode",
            Self::Event => "event mode",
            Self::ContinuousTime => "continuous-time mode",
            Self::Step => "step mode",
            Self::Terminated => "terminated",
        }
    }
}

/// Why a call is refused.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum InstanceError {
    /// A call at the wrong moment.
    #[error("{call} is not allowed now: the FMU is in the state `{}`", now.word())]
    Mode {
        /// The function.
        call: &'static str,
        /// The state of the FMU.
        now: Mode,
    },
    /// A reference that no variable has.
    #[error("no Float64 variable of this FMU has the value reference {0}")]
    Unknown(u32),
    /// A variable that cannot be set, or not now.
    #[error("`{name}` cannot be set in the state `{}`: {why}", now.word())]
    NotSettable {
        /// The variable.
        name: &'static str,
        /// The state of the FMU.
        now: Mode,
        /// When it can be.
        why: &'static str,
    },
    /// A value that makes no sense.
    #[error("`{name}` is set to {value}: {expected}")]
    Value {
        /// The variable.
        name: &'static str,
        /// The value.
        value: f64,
        /// What was expected.
        expected: &'static str,
    },
    /// An array of another length than that of the variables.
    #[error("{call}: {found} values, and there are {expected}")]
    Count {
        /// The function.
        call: &'static str,
        /// Number of values given.
        found: usize,
        /// Number of values expected.
        expected: usize,
    },
    /// A communication point that is not where the last step ended.
    #[error("fmi3DoStep from {point} s, and the FMU is at {time} s: steps follow each other")]
    Point {
        /// The communication point, s.
        point: f64,
        /// The time of the FMU, s.
        time: f64,
    },
    /// A communication step that would take too long.
    #[error(
        "fmi3DoStep over {size} s takes more than 1e7 integration steps of {step} s: take a shorter one, or set `integration_step`"
    )]
    TooLong {
        /// Size of the step, s.
        size: f64,
        /// Longest integration step, s.
        step: f64,
    },
    /// The motion has left the finite numbers while the FMU integrated.
    #[error("from {time} s on: {source}")]
    Diverged {
        /// Time at the beginning of the communication step, s.
        time: f64,
        /// What happened.
        source: SimulationError,
    },
    /// What is asked for is not finite at this point. A solver may try a smaller step.
    #[error(
        "`{name}` is not finite at this state: the speed is zero, an angle is at 90 deg, or the motion has diverged"
    )]
    NotFinite {
        /// The variable.
        name: &'static str,
    },
    /// A state that was written down cannot be read.
    #[error(transparent)]
    Written(#[from] PointError),
}

impl InstanceError {
    /// Whether another point may be possible, so that a solver is to try again.
    pub fn is_of_this_point(&self) -> bool {
        matches!(self, Self::NotFinite { .. })
    }
}

/// An instance of an FMU. Instances share nothing that changes.
#[derive(Clone, Debug)]
pub struct Instance {
    resources: Resources,
    interface: Interface,
    point: Point,
    mode: Mode,
    sample: Option<TrajectorySample>,
    rates: Option<State>,
    /// Variables that were outside the data once, so that it is said once.
    warned: Vec<&'static str>,
}

impl Instance {
    /// An instance at the start of its resources.
    pub fn new(resources: Resources, interface: Interface) -> Self {
        let point = resources.start;
        Self { resources, interface, point, mode: Mode::Instantiated, sample: None, rates: None, warned: Vec::new() }
    }

    /// Who integrates.
    pub fn interface(&self) -> Interface {
        self.interface
    }

    /// Time, state, inputs and parameters now.
    pub fn point(&self) -> &Point {
        &self.point
    }

    /// Refuses a call that is only allowed in some modes.
    fn allow(&self, call: &'static str, modes: &[Mode]) -> Result<(), InstanceError> {
        if modes.contains(&self.mode) { Ok(()) } else { Err(InstanceError::Mode { call, now: self.mode }) }
    }

    fn changed(&mut self) {
        (self.sample, self.rates) = (None, None);
    }

    /// Back to the start.
    pub fn reset(&mut self) {
        (self.point, self.mode) = (self.resources.start, Mode::Instantiated);
        self.warned.clear();
        self.changed();
    }

    /// Begins the initialisation at a time (s).
    ///
    /// # Errors
    /// [`InstanceError`]: another moment, a time that is not finite.
    pub fn enter_initialization(&mut self, start: f64) -> Result<(), InstanceError> {
        self.allow("fmi3EnterInitializationMode", &[Mode::Instantiated])?;
        self.point.time = finite("time", start)?;
        self.mode = Mode::Initialization;
        Ok(())
    }

    /// Ends it: event mode for model exchange, step mode for co-simulation.
    ///
    /// # Errors
    /// [`InstanceError::Mode`].
    pub fn exit_initialization(&mut self) -> Result<(), InstanceError> {
        self.allow("fmi3ExitInitializationMode", &[Mode::Initialization])?;
        self.mode = match self.interface {
            Interface::ModelExchange => Mode::Event,
            Interface::CoSimulation => Mode::Step,
        };
        Ok(())
    }

    /// Enters event mode; nothing happens there.
    ///
    /// # Errors
    /// [`InstanceError::Mode`]: co-simulation has no events.
    pub fn enter_event_mode(&mut self) -> Result<(), InstanceError> {
        self.allow("fmi3EnterEventMode", &[Mode::ContinuousTime])?;
        self.mode = Mode::Event;
        Ok(())
    }

    /// Updates the discrete states, of which there are none.
    ///
    /// # Errors
    /// [`InstanceError::Mode`].
    pub fn update_discrete_states(&self) -> Result<(), InstanceError> {
        self.allow("fmi3UpdateDiscreteStates", &[Mode::Event])
    }

    /// Leaves event mode.
    ///
    /// # Errors
    /// [`InstanceError::Mode`].
    pub fn enter_continuous_time_mode(&mut self) -> Result<(), InstanceError> {
        self.allow("fmi3EnterContinuousTimeMode", &[Mode::Event])?;
        self.mode = Mode::ContinuousTime;
        Ok(())
    }

    /// Ends the simulation; values can still be read.
    ///
    /// # Errors
    /// [`InstanceError::Mode`]: before the simulation has begun.
    pub fn terminate(&mut self) -> Result<(), InstanceError> {
        self.allow("fmi3Terminate", &[Mode::Event, Mode::ContinuousTime, Mode::Step])?;
        self.mode = Mode::Terminated;
        Ok(())
    }

    /// The value of a variable.
    ///
    /// # Errors
    /// [`InstanceError`]: no such variable, a value that is not finite at this point.
    pub fn get(&mut self, reference: u32) -> Result<f64, InstanceError> {
        let variable = found(reference)?;
        if let Some(value) = self.point.value(&variable.role) {
            return Ok(value);
        }
        let value = match variable.role {
            Role::Rate(i) => self.rates().to_array()[i],
            Role::Output(signal) => signal(&self.sample()),
            // All others are in the point.
            _ => f64::NAN,
        };
        if value.is_finite() { Ok(value) } else { Err(InstanceError::NotFinite { name: &variable.name }) }
    }

    /// Sets a variable.
    ///
    /// # Errors
    /// As [`check`](Self::check).
    pub fn set(&mut self, reference: u32, value: f64) -> Result<(), InstanceError> {
        let variable = self.check(reference, value)?;
        self.point.set(&variable.role, value);
        self.changed();
        Ok(())
    }

    /// Whether a variable can be set to a value now, without doing it.
    ///
    /// # Errors
    /// [`InstanceError`]: no such variable, one that is not set from outside or not now, a value that is not finite or makes no sense.
    pub fn check(&self, reference: u32, value: f64) -> Result<&'static Variable, InstanceError> {
        let variable = found(reference)?;
        self.check_settable(variable)?;
        let name = variable.name.as_str();
        finite(name, value)?;
        let refuse = |expected| Err(InstanceError::Value { name, value, expected });
        match variable.role {
            Role::Step if value <= 0.0 => refuse("a step of the integration has to be positive, s"),
            Role::Control(0) if !(0.0..=1.0).contains(&value) => {
                refuse("the throttle lever has to be between 0 and 1; limit what is connected to it")
            }
            Role::State(0) if value <= 0.0 => refuse("the speed has to be positive, m/s"),
            _ => Ok(variable),
        }
    }

    fn check_settable(&self, variable: &'static Variable) -> Result<(), InstanceError> {
        let (now, name) = (self.mode, variable.name.as_str());
        let before = matches!(now, Mode::Instantiated | Mode::Initialization);
        let (can, why) = match (&variable.role, variable.variability()) {
            (Role::Time | Role::Rate(_) | Role::Output(_), _) => (false, "it is computed"),
            (Role::State(_), _) | (_, Variability::Fixed) => (
                before,
                "only until the end of the initialization; later a solver sets states by fmi3SetContinuousStates",
            ),
            (_, Variability::Tunable) => (
                before || matches!(now, Mode::Event | Mode::Step),
                "a tunable parameter changes before the start, in event mode and between steps",
            ),
            (_, Variability::Continuous) => (now != Mode::Terminated, "the simulation is over"),
        };
        if can { Ok(()) } else { Err(InstanceError::NotSettable { name, now, why }) }
    }

    /// Sets the time (s) of model exchange. Nothing depends on it: the air is that of a standard day without wind of its own.
    ///
    /// # Errors
    /// [`InstanceError`]: another moment, a time that is not finite.
    pub fn set_time(&mut self, time: f64) -> Result<(), InstanceError> {
        self.allow("fmi3SetTime", &[Mode::Event, Mode::ContinuousTime])?;
        self.point.time = finite("time", time)?;
        Ok(())
    }

    /// Sets the continuous states, in the order of [`State`].
    ///
    /// # Errors
    /// [`InstanceError`]: another moment, another number of values, one that is not finite.
    pub fn set_states(&mut self, values: &[f64]) -> Result<(), InstanceError> {
        const CALL: &str = "fmi3SetContinuousStates";
        self.allow(CALL, &[Mode::Event, Mode::ContinuousTime])?;
        let states: [f64; STATES] = values.try_into().map_err(|_| InstanceError::Count {
            call: CALL,
            found: values.len(),
            expected: STATES,
        })?;
        for variable in variables() {
            if let Role::State(i) = variable.role {
                finite(&variable.name, states[i])?;
            }
        }
        self.point.state = State::from_array(states);
        self.changed();
        Ok(())
    }

    /// The continuous states, in the order of [`State`].
    pub fn states(&self) -> [f64; STATES] {
        self.point.state.to_array()
    }

    /// Their derivatives, each in its unit per second.
    ///
    /// # Errors
    /// [`InstanceError::NotFinite`].
    pub fn derivatives(&mut self) -> Result<[f64; STATES], InstanceError> {
        let rates = self.rates().to_array();
        for variable in variables() {
            if let Role::Rate(i) = variable.role
                && !rates[i].is_finite()
            {
                return Err(InstanceError::NotFinite { name: &variable.name });
            }
        }
        Ok(rates)
    }

    /// Flies a communication step of co-simulation: from a point (s) over a size (s), with inputs that are held.
    ///
    /// The step is divided into equal steps of the classical Runge-Kutta method, none longer than `integration_step`.
    ///
    /// # Errors
    /// [`InstanceError`]; the FMU stays where it was.
    pub fn do_step(&mut self, point: f64, size: f64) -> Result<(), InstanceError> {
        self.allow("fmi3DoStep", &[Mode::Step])?;
        finite("time", point)?;
        let time = self.point.time;
        if !(size > 0.0 && size.is_finite()) {
            let expected = "it has to be positive and finite, s";
            return Err(InstanceError::Value { name: "communicationStepSize", value: size, expected });
        }
        let [of_step, of_time] = TIME_TOLERANCE;
        if (point - time).abs() > of_step * size + of_time * time.abs() {
            return Err(InstanceError::Point { point, time });
        }
        let step = self.point.step;
        // A step that fits but for rounding fits.
        let steps = (size / step * (1.0 - 1e-9)).ceil().max(1.0);
        if steps > MOST_STEPS {
            return Err(InstanceError::TooLong { size, step });
        }
        let Point { state, controls, .. } = self.point;
        let mut flight = Stepper::new(state, controls, size, steps as usize, CommandHold::Sample).with_actuators(false);
        flight
            .hold(self.resources.aircraft.as_ref(), &self.instant())
            .map_err(|source| InstanceError::Diverged { time, source })?;
        self.point.state = flight.state();
        self.point.time = point + size;
        self.changed();
        Ok(())
    }

    /// What of the flight is outside the data of the aircraft now and was not before, in sentences: whatever is computed there is
    /// extrapolated. Each is said once.
    pub fn warnings(&mut self) -> Vec<String> {
        let range = self.resources.aircraft.data_range();
        let air = self.sample().air;
        let Controls { elevator, aileron, rudder, .. } = self.point.controls;
        let limits = self.resources.aircraft.actuators();
        let within = |range: [f64; 2], limit: f64| [range[0].max(-limit), range[1].min(limit)];
        let place = [
            ("true_airspeed", " m/s", air.speed, range.speed),
            ("mach", "", air.mach, range.mach),
            ("altitude", " m", self.point.state.altitude, range.altitude),
        ];
        let angles = [
            ("alpha", air.alpha, range.alpha),
            ("beta", air.beta, range.beta),
            ("elevator", elevator, within(range.elevator, limits.elevator.limit)),
            ("aileron", aileron, within(range.aileron, limits.aileron.limit)),
            ("rudder", rudder, within(range.rudder, limits.rudder.limit)),
        ];
        let angles = angles.map(|(name, value, range)| (name, " deg", value.to_degrees(), range.map(f64::to_degrees)));
        let mut warnings = Vec::new();
        for (name, unit, value, [low, high]) in angles.into_iter().chain(place) {
            if !(low..=high).contains(&value) && !self.warned.contains(&name) {
                self.warned.push(name);
                warnings.push(format!(
                    "at {} s `{name}` is {value:.3}{unit}, outside {low:.3} to {high:.3}{unit}, for which the aircraft has data: \
                     what follows is extrapolated and describes no aircraft",
                    self.point.time,
                ));
            }
        }
        warnings
    }

    /// The instance as it is now, to go back to.
    pub fn written(&self) -> Vec<u8> {
        let mode = Mode::ALL.iter().position(|mode| *mode == self.mode).unwrap_or(0);
        let mut bytes = self.point.to_bytes();
        bytes.push(mode as u8);
        bytes
    }

    /// Bytes of [`written`](Self::written).
    pub const WRITTEN: usize = Point::BYTES + 1;

    /// Checks what [`written`](Self::written) has given, here or in another process.
    ///
    /// # Errors
    /// [`InstanceError::Written`].
    pub fn check_written(bytes: &[u8]) -> Result<(), InstanceError> {
        parsed(bytes).map(|_| ())
    }

    /// Goes back to what [`written`](Self::written) has given.
    ///
    /// # Errors
    /// [`InstanceError::Written`].
    pub fn restore(&mut self, bytes: &[u8]) -> Result<(), InstanceError> {
        (self.point, self.mode) = parsed(bytes)?;
        self.changed();
        Ok(())
    }

    fn instant(&self) -> Instant {
        Instant { commands: self.point.controls, air: self.point.air, increments: self.point.increments }
    }

    /// The flight now, as simulated flights record it.
    fn sample(&mut self) -> TrajectorySample {
        if let Some(sample) = self.sample {
            return sample;
        }
        let Point { state, controls, .. } = self.point;
        let here = Stepper::new(state, controls, 1.0, 1, CommandHold::Sample).with_actuators(false);
        let sample = here.sample(self.resources.aircraft.as_ref(), &self.instant());
        self.sample = Some(sample);
        sample
    }

    fn rates(&mut self) -> State {
        if let Some(rates) = self.rates {
            return rates;
        }
        let Point { state, controls, air, increments, .. } = self.point;
        let disturbance =
            Disturbance { gust: air.velocity, gust_rates: air.rates, increments, ..Disturbance::default() };
        let rates = motion(self.resources.aircraft.as_ref(), &state, &controls, &disturbance).rates;
        self.rates = Some(rates);
        rates
    }
}

fn parsed(bytes: &[u8]) -> Result<(Point, Mode), InstanceError> {
    let (last, point) = bytes.split_last().ok_or(PointError::Foreign)?;
    let mode = Mode::ALL.get(usize::from(*last)).ok_or(PointError::Foreign)?;
    Ok((Point::from_bytes(point)?, *mode))
}

fn found(reference: u32) -> Result<&'static Variable, InstanceError> {
    variable(reference).ok_or(InstanceError::Unknown(reference))
}

fn finite(name: &'static str, value: f64) -> Result<f64, InstanceError> {
    let expected = "it has to be a finite number; look at what is connected to it";
    if value.is_finite() { Ok(value) } else { Err(InstanceError::Value { name, value, expected }) }
}
