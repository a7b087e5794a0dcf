//! A scenario's flight, one sample after another: for who chooses the commands from what was measured.

use phugoid_aircraft::flown::FlownJsbsim;
use phugoid_flight_dynamics::actuator::{Actuator, Actuators};
use phugoid_flight_dynamics::aircraft::{Aircraft, Controls, State};
use phugoid_flight_dynamics::dryden::{Dryden, DrydenError};
use phugoid_flight_dynamics::earth::LocalEarth;
use phugoid_flight_dynamics::gust::{AirMotion, Gust, total_velocity};
use phugoid_flight_dynamics::increments::{IncrementChange, IncrementSchedule, Increments};
use phugoid_flight_dynamics::linearize::{LinearModel, linearize};
use phugoid_flight_dynamics::motion::Disturbance;
use phugoid_flight_dynamics::simulate::{CommandHold, Instant, SimulationError, Stepper, TrajectorySample};
use phugoid_flight_dynamics::trim::Trim;
use phugoid_flight_dynamics::von_karman::VonKarman;
use phugoid_flight_dynamics::wind::WindProfile;

use crate::aircraft::AircraftError;
use crate::closed_loop::{self, ClosedLoop};
use crate::damaged::{Damaged, Effects};
use crate::flight::FlightError;
use crate::manoeuvre::Surface;
use crate::scenario::{Attitude, FailureKind, Scenario, ScenarioError, Spectrum, Wind};
use crate::start::state_of;

/// Integration steps per sample: the half sample keeps the truncation error of the fastest actuator mode far below any
/// sensor's noise.
const SUBSTEPS: usize = 2;

/// Another aircraft from a time on.
pub struct Change<'a, A> {
    /// The aircraft from then on.
    pub aircraft: &'a A,
    /// When, s.
    pub at: f64,
    /// Its state from that of the aircraft before, in the same motion.
    pub moved: &'a dyn Fn(&State) -> State,
}

impl<A> Clone for Change<'_, A> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<A> Copy for Change<'_, A> {}

impl<'a, A> Change<'a, A> {
    /// The same change of an aircraft that stands for this one.
    pub(crate) fn with<B>(&self, aircraft: &'a B) -> Change<'a, B> {
        Change { aircraft, at: self.at, moved: self.moved }
    }
}

/// The flight of a scenario from its trim on, with its wind, gusts, turbulence, damage and failures; who holds it gives the commands.
///
/// ```
/// use phugoid_simulation::course::Course;
/// use phugoid_simulation::flight::trimmed_aircraft;
/// use phugoid_simulation::scenario::Scenario;
///
/// let scenario = Scenario::named("f16-damage")?;
/// let (aircraft, trim) = trimmed_aircraft(&scenario)?;
/// let mut course = Course::new(&scenario, aircraft.as_ref(), None, &trim)?;
/// for _ in 0..100 {
///     // A damper that moves the elevator by a fifth of the pitch rate.
///     let commands = trim.controls();
///     let q = course.state().q;
///     course.advance(phugoid_flight_dynamics::aircraft::Controls { elevator: commands.elevator + 0.2 * q, ..commands })?;
/// }
/// assert_eq!(course.time(), 1.0); // s
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct Course<'a, A> {
    scenario: &'a Scenario,
    aircraft: &'a A,
    change: Option<Change<'a, A>>,
    trim: Trim,
    stepper: Stepper,
    increments: IncrementSchedule,
    wind: WindProfile,
    gusts: Vec<Gust>,
    /// At every stage of the integration.
    turbulence: Vec<AirMotion>,
    /// Surface positions of the sample before, rad, `[elevator, aileron, rudder]`.
    positions: [f64; 3],
    /// Where a surface was when each failure of the scenario happened, rad; none before.
    failed: Vec<Option<f64>>,
    /// What each damage of the scenario changes beside increments, once it is complete.
    effects: Vec<Effects>,
    /// Whether anything but increments changes.
    alters: bool,
    /// The flight control system of the aircraft, where it moves the surfaces.
    closed: Option<ClosedLoop<'a>>,
}

impl<'a, A: Aircraft> Course<'a, A> {
    /// The flight of a scenario whose drawn values are drawn ([`Scenario::drawn`]), from `trim`. Who holds it moves the surfaces: the
    /// flight control system of the aircraft (`flight_control`) runs in [`fly`](crate::flight::fly) alone.
    ///
    /// # Errors
    /// [`FlightError`]: increments or turbulence that cannot be.
    pub fn new(
        scenario: &'a Scenario,
        aircraft: &'a A,
        change: Option<Change<'a, A>>,
        trim: &Trim,
    ) -> Result<Self, FlightError> {
        let sample_time = 1.0 / scenario.sample_rate.si();
        let about = |i: &Increments| i.about(trim.alpha_rad, trim.q_rad_s, trim.elevator_rad);
        let start = IncrementChange { time: f64::NEG_INFINITY, increments: about(&scenario.increments) };
        let changes = changes(scenario, sample_time)
            .map(|(time, increments)| IncrementChange { time, increments: about(&increments) });
        let increments = IncrementSchedule::new(std::iter::once(start).chain(changes).collect())
            .map_err(|e| ScenarioError::OutOfRange { place: scenario.name.clone(), message: e.to_string() })?;
        let wind = scenario.wind.as_ref().map_or_else(|| Ok(WindProfile::default()), Wind::profile);
        let wind = wind.map_err(|message| ScenarioError::OutOfRange { place: scenario.name.clone(), message })?;
        let controls = trim.controls();
        let stepper = stepper(scenario, state_of(scenario, trim), controls, sample_time, &wind);
        let gust = |g: &crate::scenario::GustSettings| Gust {
            axis: g.axis,
            amplitude: g.amplitude.si(),
            duration: g.duration.si(),
            delay: g.start.si(),
        };
        let effects = scenario.complete_effects();
        let mut course = Self {
            scenario,
            aircraft,
            change,
            trim: *trim,
            stepper,
            increments,
            gusts: scenario.gust.iter().map(gust).collect(),
            wind,
            turbulence: turbulence(scenario, aircraft.geometry().span, scenario.samples())?,
            positions: [controls.elevator, controls.aileron, controls.rudder],
            failed: vec![None; scenario.failure.len()],
            alters: !scenario.failure.is_empty() || effects.iter().any(|effects| *effects != Effects::NONE),
            effects,
            closed: None,
        };
        course.change_aircraft();
        course.fail();
        Ok(course)
    }

    /// Lets the flight control system of an aircraft move the surfaces from now, the start of the flight, on; gives what was found
    /// then, in sentences. It runs as often as samples are taken, or an integer multiple of that.
    pub(crate) fn close_loop(&mut self, controlled: &'a FlownJsbsim) -> Result<Vec<String>, FlightError> {
        let rate = self.scenario.sample_rate.si();
        let steps = closed_loop::steps_per_sample(rate);
        let step = 1.0 / rate / steps as f64;
        let controls = self.trim.controls();
        let surfaces = [controls.elevator, controls.aileron, controls.rudder];
        // In the trim the air is still, and neither angle changes.
        let state = self.stepper.state();
        let (wind, earth) = (self.wind.at(state.altitude), self.earth_under(&state));
        let disturbance = Disturbance { wind, earth, ..Disturbance::default() };
        let mut sensed = closed_loop::sensed(self.aircraft, &state, &controls, &disturbance);
        (sensed.flight.alphadot_rad_s, sensed.flight.betadot_rad_s) = (0.0, 0.0);
        sensed.angular_acceleration_rad_s2 = [0.0; 3];
        let control = controlled.flight_control(&sensed, surfaces, step).map_err(AircraftError::from)?;
        let notes = control.notes().to_vec();
        self.stepper = stepper(self.scenario, state, controls, step, &self.wind);
        self.closed = Some(ClosedLoop::new(control, steps, surfaces));
        Ok(notes)
    }

    /// Lets flight control say where the surfaces go under these commands from this instant on, if it has not yet; does nothing
    /// without it. To be called before [`sample`](Self::sample), which shows the surfaces where it puts them.
    pub(crate) fn run_control(&mut self, commands: Controls) {
        let Some(mut closed) = self.closed.take() else { return };
        if closed.given.is_none() {
            let at = if self.scenario.aircraft.actuators { self.stepper.positions() } else { closed.surfaces };
            let [elevator, aileron, rudder] = at;
            let surfaces = Controls { elevator, aileron, rudder, ..commands };
            let instant = self.instant();
            let state = self.stepper.state();
            let disturbance = Disturbance {
                wind: self.wind.at(state.altitude),
                gust: instant.air.velocity,
                gust_rates: instant.air.rates,
                increments: instant.increments,
                earth: self.earth_under(&state),
            };
            let sensed = if self.alters {
                closed_loop::sensed(&self.damaged(), &state, &surfaces, &disturbance)
            } else {
                closed_loop::sensed(self.flown(), &state, &surfaces, &disturbance)
            };
            closed.step(&sensed, commands);
        }
        self.closed = Some(closed);
    }

    /// The planet under the aircraft; none over a plane.
    fn earth_under(&self, state: &State) -> Option<LocalEarth> {
        self.scenario.earth_below().map(|earth| earth.under(state))
    }

    /// Time since the start of the flight, s.
    pub fn time(&self) -> f64 {
        self.stepper.time()
    }

    /// State of the aircraft now.
    pub fn state(&self) -> State {
        self.stepper.state()
    }

    /// Aerodynamic increments in force at this instant, about the trim.
    pub fn increments(&self) -> Increments {
        self.increments.at(self.time())
    }

    /// Everything that the aircraft shows at this instant under these commands (rad, throttle 0 to 1).
    pub fn sample(&self, commands: Controls) -> TrajectorySample {
        let now = Instant { commands: self.told(commands), ..self.instant() };
        let sample = if self.alters {
            self.stepper.sample(&self.damaged(), &now)
        } else {
            self.stepper.sample(self.flown(), &now)
        };
        TrajectorySample { commands, ..sample }
    }

    /// Flies one sample with these commands.
    ///
    /// # Errors
    /// [`SimulationError`]: the motion diverges, or the aircraft leaves its atmosphere; the flight is then over.
    pub fn advance(&mut self, commands: Controls) -> Result<(), SimulationError> {
        for _ in 0..self.closed.as_ref().map_or(1, |closed| closed.steps) {
            self.run_control(commands);
            self.advance_step(commands)?;
        }
        Ok(())
    }

    /// Flies one sample, or with flight control one step of it.
    fn advance_step(&mut self, commands: Controls) -> Result<(), SimulationError> {
        let told = self.told(commands);
        self.positions = if self.scenario.aircraft.actuators {
            self.stepper.positions()
        } else {
            [told.elevator, told.aileron, told.rudder]
        };
        let again = |_: f64, _: &State| told;
        let (gusts, turbulence, stage) = (&self.gusts, &self.turbulence, stage_time(self.scenario));
        let air = |time: f64| air_at(gusts, turbulence, stage, time);
        let (schedule, aircraft) = (&self.increments, self.flown());
        let increments = |time: f64| schedule.at(time);
        if self.alters {
            let damaged = self.damaged();
            self.stepper.advance(&damaged, told, again, air, increments)?;
        } else {
            self.stepper.advance(aircraft, told, again, air, increments)?;
        }
        if let Some(closed) = &mut self.closed {
            closed.given = None;
            closed.surfaces = [told.elevator, told.aileron, told.rudder];
        }
        self.change_aircraft();
        self.fail();
        Ok(())
    }

    /// The linear model of the aircraft as it is now, with its damage, about this state and these surface positions.
    pub fn linear_model(&self, state: &State, surfaces: &Controls) -> LinearModel {
        let wind = self.wind.at(state.altitude);
        let disturbance = Disturbance { wind, increments: self.increments(), ..Disturbance::default() };
        if self.alters {
            linearize(&self.damaged(), state, surfaces, &disturbance)
        } else {
            linearize(self.flown(), state, surfaces, &disturbance)
        }
    }

    /// Whether elevator, aileron and rudder still move when they are told to, however slowly.
    pub fn obeys(&self) -> [bool; 3] {
        let mut obeys = [true; 3];
        for (failure, failed) in self.scenario.failure.iter().zip(&self.failed) {
            if failed.is_some() {
                obeys[failure.surface.index()] = !matches!(failure.kind, FailureKind::Jam | FailureKind::Float);
            }
        }
        obeys
    }

    fn instant(&self) -> Instant {
        let time = self.time();
        Instant {
            commands: Controls::default(),
            air: air_at(&self.gusts, &self.turbulence, stage_time(self.scenario), time),
            increments: self.increments.at(time),
        }
    }

    /// The aircraft that flies, without effects of damage.
    fn flown(&self) -> &'a A {
        match &self.change {
            // Half a sample makes up for rounding.
            Some(change) if self.time() >= change.at - 0.5 / self.scenario.sample_rate.si() => change.aircraft,
            _ => self.aircraft,
        }
    }

    fn damaged(&self) -> Damaged<'a, A> {
        // The change of a sample holds until the next one: the middle of the interval stands for it.
        let (time, half) = (self.time(), 0.5 / self.scenario.sample_rate.si());
        let growing = |damage: &crate::scenario::Damage| {
            let (at, over) = (damage.at.si(), damage.over.si());
            over > 0.0 && (at..at + over).contains(&time)
        };
        let grows = self.scenario.damage.iter().any(growing);
        let effects = self.scenario.effects_of(&self.effects, if grows { time + half } else { time });
        let flown = self.flown();
        Damaged::new(flown, effects, &self.trim).with_actuators(self.actuators(*flown.actuators()))
    }

    fn actuators(&self, whole: Actuators) -> Actuators {
        let mut actuators = whole;
        for failure in self.scenario.failure.iter().filter(|failure| failure.at.si() <= self.time()) {
            let of: &mut Actuator = match failure.surface {
                Surface::Elevator => &mut actuators.elevator,
                Surface::Aileron => &mut actuators.aileron,
                Surface::Rudder => &mut actuators.rudder,
            };
            *of = failure.actuator(*of);
        }
        actuators
    }

    /// What the actuators are told when these are the commands.
    fn told(&self, commands: Controls) -> Controls {
        let mut told = self.closed.as_ref().and_then(|closed| closed.given).unwrap_or(commands);
        let state = self.stepper.state();
        for (failure, position) in self.scenario.failure.iter().zip(&self.failed) {
            let Some(position) = *position else { continue };
            let (command, trailing) = match failure.surface {
                Surface::Elevator => (&mut told.elevator, -state.alpha),
                Surface::Aileron => (&mut told.aileron, 0.0),
                Surface::Rudder => (&mut told.rudder, state.beta),
            };
            *command = failure.command(self.stepper.time(), *command, position, trailing);
        }
        told
    }

    /// Notes where the surfaces are that have just failed.
    fn fail(&mut self) {
        let time = self.time();
        let positions = if self.scenario.aircraft.actuators { self.stepper.positions() } else { self.positions };
        for (failure, failed) in self.scenario.failure.iter().zip(&mut self.failed) {
            if failed.is_none() && failure.at.si() <= time {
                *failed = Some(positions[failure.surface.index()]);
            }
        }
    }

    /// Puts the aircraft that has just come into the motion of the one before.
    fn change_aircraft(&mut self) {
        let Some(change) = &self.change else { return };
        let (time, half) = (self.time(), 0.5 / self.scenario.sample_rate.si());
        let first = time >= change.at - half && (time - 2.0 * half < change.at - half || time == 0.0);
        if first {
            let state = (change.moved)(&self.stepper.state());
            self.stepper.set_state(&state);
        }
    }
}

/// A flight of a scenario from a state, in steps (s) of which the air is asked at every stage.
fn stepper(scenario: &Scenario, state: State, surfaces: Controls, step: f64, wind: &WindProfile) -> Stepper {
    let stepper = Stepper::new(state, surfaces, step, SUBSTEPS, CommandHold::Sample)
        .with_actuators(scenario.aircraft.actuators)
        .with_wind(wind.clone())
        .over(scenario.earth_below());
    match scenario.attitude {
        Attitude::Euler => stepper,
        Attitude::Quaternion => stepper.with_quaternion(),
    }
}

fn air_at(gusts: &[Gust], turbulence: &[AirMotion], stage: f64, time: f64) -> AirMotion {
    let gust = total_velocity(gusts, time);
    let Some(&random) = turbulence.get((time / stage).round() as usize) else { return AirMotion::from(gust) };
    AirMotion { velocity: std::array::from_fn(|i| gust[i] + random.velocity[i]), rates: random.rates }
}

/// Time between the instants at which the integration looks at the air: the stages of its steps.
fn stage_time(scenario: &Scenario) -> f64 {
    0.5 / (SUBSTEPS as f64 * scenario.sample_rate.si())
}

/// The turbulence of a flight at every stage of the integration; empty without turbulence.
fn turbulence(scenario: &Scenario, span: f64, samples: usize) -> Result<Vec<AirMotion>, DrydenError> {
    let Some(settings) = &scenario.turbulence else { return Ok(Vec::new()) };
    let field = settings.field(scenario.condition.altitude.si());
    // A stream of its own: with and without turbulence the sensors have the same noise.
    let seed = scenario.seed ^ 0x0064_7279_6465_6e00;
    let (speed, stage) = (scenario.condition.speed.si(), stage_time(scenario));
    let mut sample: Box<dyn FnMut() -> AirMotion> = match settings.spectrum {
        Spectrum::Dryden => {
            let mut dryden = Dryden::new(field, speed, span, stage, seed)?;
            Box::new(move || dryden.sample())
        }
        Spectrum::VonKarman => {
            let mut von_karman = VonKarman::new(field, speed, span, stage, seed)?;
            Box::new(move || von_karman.sample())
        }
    };
    let flown = || {
        let air = sample();
        if settings.rates { air } else { AirMotion::from(air.velocity) }
    };
    Ok(std::iter::repeat_with(flown).take(2 * SUBSTEPS * samples).collect())
}

/// Damage as changes at instants (s): one that takes its time changes at every sample.
fn changes(scenario: &Scenario, sample_time: f64) -> impl Iterator<Item = (f64, Increments)> {
    scenario.damage.iter().flat_map(move |damage| {
        let (from, over) = (damage.at.si(), damage.over.si());
        // The change of a sample holds until the next one: the middle of the interval stands for it.
        let steps = (over / sample_time + 1e-9) as usize;
        let during = (0..steps).map(move |k| from + k as f64 * sample_time);
        let ramp = during.map(move |t| (t, scenario.increments_at(t + 0.5 * sample_time)));
        ramp.chain(std::iter::once((from + over, damage.increments)))
    })
}
