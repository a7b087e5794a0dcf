//! Flies a scenario: trims the aircraft, integrates its motion, and simulates the sensors.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use phugoid_aircraft::flown::{AircraftFile, FlownJsbsim};
use phugoid_aircraft::transport::moved_to;
use phugoid_flight_data::quality::QualityReport;
use phugoid_flight_data::record::{Channel, Quantity, Record};
use phugoid_flight_dynamics::aircraft::{Aircraft, Controls, DataRange, State};
use phugoid_flight_dynamics::built_in::BuiltInAircraft;
use phugoid_flight_dynamics::dryden::DrydenError;
use phugoid_flight_dynamics::f16::F16DataError;
use phugoid_flight_dynamics::simulate::{SimulationError, Trajectory, TrajectorySample};
use phugoid_flight_dynamics::trim::{Trim, TrimError};

use crate::aircraft::{AircraftError, AnyAircraft};
use crate::constant_thrust::ConstantThrust;
use crate::course::{Change, Course};
use crate::damaged::{Damaged, Effects};
use crate::equivalent::damage_increments;
use crate::model_error::Misjudged;
use crate::scenario::{ModelError, RecordedSurfaces, Scenario, ScenarioError, Thrust};
use crate::sensing::{command_channel, measure};
use crate::signals::{OVER_THE_GROUND, PLACE, SIGNALS, Signal};
use crate::start::trim_of;

/// A flown scenario: what the sensors measured, what was true, and where the flight started.
#[derive(Clone, Debug)]
pub struct Flight {
    /// What the sensors measured, canonical channels in SI.
    pub measured: Record,
    /// What was true at the same times, under the same channel names and in SI: no noise, no delay, no missing values.
    pub truth: Record,
    /// The trim that the flight started in.
    pub trim: Trim,
    /// As [`Scenario::true_parameters`], and what the scenario's error of the model amounts to.
    pub true_parameters: BTreeMap<String, f64>,
    /// The scenario as flown: everything that is drawn once per flight has its drawn value here.
    pub scenario: Scenario,
    /// Increments that the scenario's error of the model amounts to at the trim, by name; empty without one.
    pub error_increments: BTreeMap<String, f64>,
    /// What each damage of the scenario, once complete, amounts to at the trim beside its increments, by name; empty where it
    /// changes nothing else.
    pub damage_increments: Vec<BTreeMap<String, f64>>,
    /// The range of flight that the aircraft's data cover.
    pub data_range: DataRange,
    /// When the aircraft ran out of fuel, s: from then on its engines do not run.
    pub out_of_fuel_s: Option<f64>,
    /// What was found when the flight control system of the aircraft took over, in sentences; empty without one.
    pub control_notes: Vec<String>,
}

/// Pitch attitude of a flight that is looked at, rad.
const ATTITUDE: f64 = 1.0;

impl Flight {
    /// As [`true_parameters`](Self::true_parameters), at a time (s).
    pub fn true_parameters_at(&self, time: f64) -> BTreeMap<String, f64> {
        let mut truth = self.scenario.increments_and_biases_at(time);
        for (name, error) in &self.error_increments {
            truth.entry(name.clone()).and_modify(|value| *value += error);
        }
        for (name, change) in self.damage_at(time) {
            *truth.entry(name).or_insert(0.0) += change;
        }
        truth
    }

    /// What damage beside increments amounts to at a time (s): while it grows, a part of it.
    fn damage_at(&self, time: f64) -> BTreeMap<String, f64> {
        let mut now = BTreeMap::new();
        for (damage, complete) in self.scenario.damage.iter().zip(&self.damage_increments) {
            if damage.at.si() > time {
                break;
            }
            let part = damage.part(time);
            let names: BTreeSet<&String> = now.keys().chain(complete.keys()).collect();
            let of = |map: &BTreeMap<String, f64>, name: &String| map.get(name).copied().unwrap_or(0.0);
            now = names
                .into_iter()
                .map(|name| (name.clone(), of(&now, name) + part * (of(complete, name) - of(&now, name))))
                .collect();
        }
        now
    }

    /// Time of the last sample before the true pitch attitude first leaves +-1 rad, s; infinite if it never does. After
    /// this time the aircraft is lost, and studies no longer judge the estimates.
    pub fn held_until_s(&self) -> f64 {
        let theta = self.truth.channel("theta").map(|channel| channel.values.as_slice()).unwrap_or_default();
        match theta.iter().position(|theta| !(-ATTITUDE..=ATTITUDE).contains(theta)) {
            Some(k) => k.checked_sub(1).map_or(f64::NEG_INFINITY, |k| self.truth.time[k]),
            None => f64::INFINITY,
        }
    }
}

/// Why a scenario could not be flown.
#[derive(Debug, thiserror::Error)]
pub enum FlightError {
    /// The scenario contains something that cannot be flown.
    #[error(transparent)]
    Scenario(#[from] ScenarioError),
    /// The aircraft cannot be opened: no such file, or data that make no aircraft.
    #[error("the aircraft: {0}")]
    Aircraft(#[from] AircraftError),
    /// The aircraft has no steady state at the condition of the scenario.
    #[error("the scenario has no trim to start in: {0}")]
    Trim(#[from] TrimError),
    /// The turbulence could not be generated from its settings.
    #[error(transparent)]
    Turbulence(#[from] DrydenError),
    /// The simulation failed: the times make no grid, or the motion is not finite. The message says which.
    #[error("{0}")]
    Simulation(#[from] LostFlight),
}

/// A flight that could not be simulated to its end.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub struct LostFlight {
    /// What ended it.
    pub error: SimulationError,
    /// Where the surfaces were when the aircraft left what it has data for; none where it has not flown at all.
    pub surface: Option<LostSurface>,
}

/// The surface that was deflected most when the aircraft left the range of its data.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LostSurface {
    /// Its name, such as `elevator`.
    pub name: &'static str,
    /// Its deflection, rad.
    pub position_rad: f64,
    /// When the angle of attack or of sideslip left the range that the data cover, s; where it did not, the last sample.
    pub time_s: f64,
    /// The angle of attack then, rad.
    pub alpha_rad: f64,
}

impl std::fmt::Display for LostFlight {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}", self.error)?;
        let Some(LostSurface { name, position_rad, time_s, alpha_rad }) = self.surface else { return Ok(()) };
        write!(
            f,
            ". At {time_s:.2} s, before it was lost, the {name} was at {:.1} deg and the angle of attack {:.1} deg: check the \
             amplitudes of the manoeuvres and their units",
            position_rad.to_degrees(),
            alpha_rad.to_degrees()
        )
    }
}

impl LostFlight {
    fn after(error: SimulationError, samples: &[TrajectorySample], range: &DataRange) -> Self {
        let inside = |value: f64, [low, high]: [f64; 2]| (low..=high).contains(&value);
        let leaves = |s: &&TrajectorySample| !inside(s.air.alpha, range.alpha) || !inside(s.air.beta, range.beta);
        let surface = samples.iter().find(leaves).or(samples.last()).and_then(|sample| {
            let Controls { elevator, aileron, rudder, .. } = sample.surfaces;
            let surfaces = [("elevator", elevator), ("aileron", aileron), ("rudder", rudder)];
            let (name, position_rad) = surfaces.into_iter().max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()))?;
            Some(LostSurface { name, position_rad, time_s: sample.time, alpha_rad: sample.air.alpha })
        });
        Self { error, surface }
    }
}

impl From<SimulationError> for FlightError {
    fn from(error: SimulationError) -> Self {
        Self::Simulation(LostFlight { error, surface: None })
    }
}

impl From<F16DataError> for FlightError {
    fn from(error: F16DataError) -> Self {
        Self::Aircraft(error.into())
    }
}

/// Flies a scenario.
///
/// Commands are held over a sample; the recorded elevator is the surface, not the command, and without actuators the two
/// are the same. With the flight control system of the aircraft (`flight_control`), commands are where the surfaces would be without
/// feedback ([`FlightControl`](phugoid_aircraft::flown::FlightControl)), and the recorded surfaces where the channels put them: they
/// run as often as samples are taken, and where that is less than 100 times a second, the least whole number of times within a sample
/// that makes it so. The measured airspeed and angles of attack and sideslip are those relative to the moving air.
///
/// # Errors
/// [`FlightError`]: no trim in this condition, a recorded input that cannot be read, a motion that diverges.
pub fn fly(scenario: &Scenario) -> Result<Flight, FlightError> {
    fly_with_progress(scenario, &|_| ())
}

/// As [`fly`]; `progress` is called with the fraction flown, 0 to 1.
///
/// # Errors
/// As [`fly`].
pub fn fly_with_progress(scenario: &Scenario, progress: &dyn Fn(f64)) -> Result<Flight, FlightError> {
    let aircraft = scenario.aircraft.aircraft(&scenario.folder)?;
    match (aircraft.as_ref(), later_aircraft(scenario, &aircraft)?) {
        // Compiled for itself: nothing is asked at each evaluation.
        (AnyAircraft::BuiltIn(BuiltInAircraft::F16(aircraft)), None) => {
            fly_aircraft(aircraft.as_ref(), scenario, progress)
        }
        (aircraft, later) => {
            let controlled = match aircraft {
                AnyAircraft::File(AircraftFile::Jsbsim(aircraft)) if scenario.aircraft.flight_control => {
                    Some(aircraft.as_ref())
                }
                _ => None,
            };
            fly_changed(aircraft, later.as_ref().map(LaterAircraft::change), controlled, scenario, progress)
        }
    }
}

/// The aircraft that a scenario flies with from a time on: the one of its `damaged_at`.
pub struct LaterAircraft {
    aircraft: AnyAircraft,
    at: f64,
    moved: Box<dyn Fn(&State) -> State>,
}

impl LaterAircraft {
    /// The change to it, for [`Course::new`].
    pub fn change(&self) -> Change<'_, AnyAircraft> {
        Change { aircraft: &self.aircraft, at: self.at, moved: self.moved.as_ref() }
    }

    /// When it comes, s.
    pub fn at(&self) -> f64 {
        self.at
    }
}

/// The aircraft that takes the place of `aircraft` in the flight of a scenario; none where it stays the same.
///
/// # Errors
/// [`FlightError::Aircraft`]: damage in flight of an aircraft that has none.
pub fn later_aircraft(scenario: &Scenario, aircraft: &AnyAircraft) -> Result<Option<LaterAircraft>, FlightError> {
    match (aircraft, scenario.aircraft.damage_in_flight()) {
        (_, None) => Ok(None),
        (AnyAircraft::File(AircraftFile::Transport(whole)), Some((damage, at))) => {
            let damaged = whole.damaged(damage).map_err(|e| AircraftError::File(e.into()))?;
            let (before, after) = (whole.clone(), damaged.clone());
            Ok(Some(LaterAircraft {
                aircraft: AnyAircraft::File(AircraftFile::Transport(Box::new(damaged))),
                at,
                moved: Box::new(move |state| moved_to(&before, &after, state)),
            }))
        }
        (aircraft, Some(_)) => Err(AircraftError::NoDamage(aircraft.name().to_owned()).into()),
    }
}

/// As [`fly_with_progress`], with any aircraft in place of the one that the scenario names: the entries `type`, `file` and
/// those that belong to them are not read.
///
/// ```
/// use phugoid_flight_dynamics::f16::{F16, F16Constants, F16Options};
/// use phugoid_simulation::flight::{fly, fly_aircraft};
/// use phugoid_simulation::scenario::Scenario;
///
/// // The F-16 with the rounded constants of the book in place of the exact ones.
/// let rounded = F16::new(F16Options { cg: 0.30, constants: F16Constants::BookRounded, ..F16Options::default() })?;
/// let scenario = Scenario::named("f16-calm")?;
/// let (flight, usual) = (fly_aircraft(&rounded, &scenario, &|_fraction| ())?, fly(&scenario)?);
/// let apart = (flight.trim.alpha_rad - usual.trim.alpha_rad).abs();
/// assert!(apart > 0.0 && apart < 1e-4);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// As [`fly`]; a scenario that asks for the flight control system of its aircraft (`flight_control`), which another has not.
pub fn fly_aircraft<A: Aircraft>(
    known: &A,
    scenario: &Scenario,
    progress: &dyn Fn(f64),
) -> Result<Flight, FlightError> {
    if scenario.aircraft.flight_control {
        let message =
            "`aircraft.flight_control` is for the aircraft that the scenario names: fly that one, or leave it out";
        return Err(ScenarioError::OutOfRange { place: scenario.name.clone(), message: message.to_owned() }.into());
    }
    fly_changed(known, None, None, scenario, progress)
}

fn fly_changed<A: Aircraft>(
    known: &A,
    change: Option<Change<'_, A>>,
    controlled: Option<&FlownJsbsim>,
    scenario: &Scenario,
    progress: &dyn Fn(f64),
) -> Result<Flight, FlightError> {
    let scenario = scenario.drawn();
    let known_trim = trim_of(known, &scenario)?;
    let error = &scenario.model_error;
    let (mut trim, mut error_increments) = (known_trim, BTreeMap::new());
    let mut aircraft = Misjudged::new(known, error, trim.alpha_rad);
    if *error != ModelError::default() {
        trim = trim_of(&aircraft, &scenario)?;
        // The quadratic term and its slope vanish at the trim: it is the same with and without.
        aircraft = Misjudged::new(known, error, trim.alpha_rad);
        trim = trim_of(&aircraft, &scenario)?;
        error_increments = aircraft.equivalent_increments(&trim);
    }
    let changed = change.map(|change| change.aircraft);
    let later = change.map(|change| Misjudged::new(change.aircraft, error, trim.alpha_rad));
    let change = change.zip(later.as_ref());
    let (trajectory, control_notes) = match scenario.aircraft.thrust {
        Thrust::Engine => {
            let change = change.map(|(change, later)| change.with(later));
            trajectory(&scenario, &aircraft, change, controlled, &trim, progress)?
        }
        Thrust::Constant => {
            let frozen = ConstantThrust::at(&aircraft, trim.power_percent, trim.altitude_m, trim.mach);
            let later = change.map(|(change, later)| {
                (change, ConstantThrust::at(later, trim.power_percent, trim.altitude_m, trim.mach))
            });
            let change = later.as_ref().map(|(change, later)| change.with(later));
            trajectory(&scenario, &frozen, change, controlled, &trim, progress)?
        }
    };
    let effects = scenario.complete_effects();
    let thrust = |s: &TrajectorySample| match scenario.aircraft.thrust {
        Thrust::Engine => s.thrust(),
        Thrust::Constant => trim.thrust_n * scenario.effects_of(&effects, s.time).thrust,
    };
    let out_of_fuel = trajectory.samples.iter().find(|sample| sample.fuel == Some(0.0));
    let truth = true_record(&scenario, &trajectory, thrust);
    let measured = sense(&truth, &scenario, scenario.seed)?;
    let whole = known.data_range();
    // Damaged, the data end earlier.
    let data_range = changed.map_or(whole, |changed| changed.data_range().within(&whole));
    let damage_increments = scenario.damage.iter().zip(effects).map(|(damage, effects)| match effects {
        Effects::NONE => BTreeMap::new(),
        effects => {
            let increments = damage.increments.about(trim.alpha_rad, trim.q_rad_s, trim.elevator_rad);
            damage_increments(known, &Damaged::new(known, effects, &trim), &trim, &increments)
        }
    });
    let mut flight = Flight {
        measured,
        truth,
        trim,
        true_parameters: BTreeMap::new(),
        error_increments,
        damage_increments: damage_increments.collect(),
        scenario,
        data_range,
        out_of_fuel_s: out_of_fuel.map(|sample| sample.time),
        control_notes,
    };
    flight.true_parameters = flight.true_parameters_at(f64::INFINITY);
    Ok(flight)
}

/// The aircraft of a scenario as it is known, without the scenario's error of the model and without its flight control, and its
/// trim.
///
/// # Errors
/// [`FlightError`]: the aircraft's data, no trim in this condition.
pub fn trimmed_aircraft(scenario: &Scenario) -> Result<(Arc<AnyAircraft>, Trim), FlightError> {
    let aircraft = scenario.aircraft.aircraft(&scenario.folder)?;
    let trim = trim_of(aircraft.as_ref(), scenario)?;
    Ok((aircraft, trim))
}

/// What the scenario's sensors make of a true record, with a seed of their noise. Constant errors that are not drawn yet are
/// drawn from the same seed.
///
/// # Errors
/// [`FlightError::Scenario`] for a sensor that cannot be.
pub fn sense(truth: &Record, scenario: &Scenario, seed: u64) -> Result<Record, FlightError> {
    let mut sensors = scenario.sensors;
    sensors.draw(seed);
    let named: Vec<&str> = scenario.manoeuvre.iter().map(|manoeuvre| manoeuvre.surface().name()).collect();
    Ok(measure(truth, &sensors, &named, &scenario.model_error, seed, scenario.name.clone())?)
}

/// The motion from the trim, through commands, gusts and changing increments, with what was found when flight control of an
/// aircraft took over.
fn trajectory<A: Aircraft>(
    scenario: &Scenario,
    aircraft: &A,
    change: Option<Change<'_, A>>,
    controlled: Option<&FlownJsbsim>,
    trim: &Trim,
    progress: &dyn Fn(f64),
) -> Result<(Trajectory, Vec<String>), FlightError> {
    let trim_controls = trim.controls();
    let (count, deflections) = (scenario.samples(), scenario.deflections()?);
    let commands = |k: usize| {
        if k.is_multiple_of(1000) {
            progress(k as f64 / count as f64);
        }
        Controls {
            throttle: trim_controls.throttle,
            elevator: trim_controls.elevator + deflections[0][k],
            aileron: trim_controls.aileron + deflections[1][k],
            rudder: trim_controls.rudder + deflections[2][k],
        }
    };
    let mut course = Course::new(scenario, aircraft, change, trim)?;
    let mut notes = Vec::new();
    if let Some(controlled) = controlled {
        notes = course.close_loop(controlled)?;
    }
    let mut samples = Vec::with_capacity(count);
    for k in 0..count {
        let commands = commands(k);
        course.run_control(commands);
        samples.push(course.sample(commands));
        if k + 1 < count {
            let flown = course.advance(commands);
            flown.map_err(|error| LostFlight::after(error, &samples, &aircraft.data_range()))?;
        }
    }
    Ok((Trajectory { samples }, notes))
}

/// The trajectory as a record of canonical channels.
fn true_record(scenario: &Scenario, trajectory: &Trajectory, thrust: impl Fn(&TrajectorySample) -> f64) -> Record {
    let samples = &trajectory.samples;
    let mut channels: Vec<Channel> = SIGNALS
        .iter()
        .map(|(name, quantity, get)| Channel {
            name: (*name).to_owned(),
            quantity: *quantity,
            values: samples.iter().map(get).collect(),
        })
        .collect();
    if scenario.model_error.surfaces == RecordedSurfaces::Commanded {
        const COMMANDS: [(&str, Signal); 3] = [
            ("elevator", |s| s.commands.elevator),
            ("aileron", |s| s.commands.aileron),
            ("rudder", |s| s.commands.rudder),
        ];
        for (name, get) in COMMANDS.into_iter().filter_map(|(surface, get)| Some((command_channel(surface)?, get))) {
            let values = samples.iter().map(get).collect();
            channels.push(Channel { name: name.to_owned(), quantity: Quantity::Angle, values });
        }
    }
    channels.push(Channel {
        name: "thrust".to_owned(),
        quantity: Quantity::Force,
        values: samples.iter().map(thrust).collect(),
    });
    if samples.iter().any(|sample| sample.fuel.is_some()) {
        let values = samples.iter().map(|sample| sample.mass).collect();
        channels.push(Channel { name: "mass".to_owned(), quantity: Quantity::Mass, values });
    }
    if scenario.earth.is_some() {
        channels.extend(PLACE.iter().map(|(name, get)| Channel {
            name: (*name).to_owned(),
            quantity: Quantity::Angle,
            values: samples.iter().map(get).collect(),
        }));
    }
    // In still air the speed over the ground says nothing that the others do not, and records stay as they are.
    let windy = scenario.wind.is_some();
    let added = OVER_THE_GROUND.iter().filter(|(name, _)| match *name {
        "ground_speed" => windy || scenario.sensors.ground_speed.is_some(),
        _ => windy,
    });
    channels.extend(added.map(|(name, get)| Channel {
        name: (*name).to_owned(),
        quantity: Quantity::Speed,
        values: samples.iter().map(get).collect(),
    }));
    let quality = QualityReport {
        rows_read: samples.len(),
        rows_kept: samples.len(),
        sample_time_s: 1.0 / scenario.sample_rate.si(),
        ..QualityReport::default()
    };
    let source = format!("{} (truth)", scenario.name);
    Record { source, time: samples.iter().map(|s| s.time).collect(), channels, quality }
}
