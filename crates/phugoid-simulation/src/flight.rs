//! Flies a scenario: trims the aircraft, integrates its motion, and simulates the sensors.

use std::collections::BTreeMap;
use std::sync::Arc;

use phugoid_aircraft::flown::AircraftFile;
use phugoid_aircraft::transport::moved_to;
use phugoid_flight_data::quality::QualityReport;
use phugoid_flight_data::record::{Channel, Quantity, Record};
use phugoid_flight_dynamics::aircraft::{Aircraft, Controls, DataRange, State};
use phugoid_flight_dynamics::built_in::BuiltInAircraft;
use phugoid_flight_dynamics::dryden::{Dryden, DrydenError};
use phugoid_flight_dynamics::f16::F16DataError;
use phugoid_flight_dynamics::gust::{AirMotion, Gust, total_velocity};
use phugoid_flight_dynamics::increments::{IncrementChange, IncrementSchedule, Increments};
use phugoid_flight_dynamics::simulate::{CommandHold, Simulation, SimulationError, Trajectory, TrajectorySample};
use phugoid_flight_dynamics::trim::{Trim, TrimCondition, TrimError, trim};

use crate::aircraft::{AircraftError, AnyAircraft};
use crate::constant_thrust::ConstantThrust;
use crate::manoeuvre::Surface;
use crate::model_error::Misjudged;
use crate::scenario::{ModelError, RecordedSurfaces, Scenario, ScenarioError, Thrust};
use crate::sensing::{command_channel, measure};

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
    /// The range of flight that the aircraft's data cover.
    pub data_range: DataRange,
}

/// Pitch attitude of a flight that is looked at, rad.
const ATTITUDE: f64 = 1.0;

impl Flight {
    /// As [`true_parameters`](Self::true_parameters), at a time (s).
    pub fn true_parameters_at(&self, time: f64) -> BTreeMap<String, f64> {
        let mut truth = self.scenario.true_parameters_at(time);
        for (name, error) in &self.error_increments {
            truth.entry(name.clone()).and_modify(|value| *value += error);
        }
        truth
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
    Simulation(#[from] SimulationError),
}

impl From<F16DataError> for FlightError {
    fn from(error: F16DataError) -> Self {
        Self::Aircraft(error.into())
    }
}

/// Integration steps per sample: the half sample keeps the truncation error of the fastest actuator mode far below any
/// sensor's noise.
const SUBSTEPS: usize = 2;

/// Flies a scenario.
///
/// Commands are held over a sample; the recorded elevator is the surface, not the command, and without actuators the two
/// are the same. The measured airspeed and angles of attack and sideslip are those relative to the moving air.
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
    match (aircraft.as_ref(), scenario.aircraft.damage_in_flight()) {
        // Compiled for itself: nothing is asked at each evaluation.
        (AnyAircraft::BuiltIn(BuiltInAircraft::F16(aircraft)), None) => {
            fly_aircraft(aircraft.as_ref(), scenario, progress)
        }
        (aircraft, None) => fly_aircraft(aircraft, scenario, progress),
        (AnyAircraft::File(AircraftFile::Transport(whole)), Some((damage, at))) => {
            let damaged = whole.damaged(damage).map_err(|e| AircraftError::File(e.into()))?;
            let moved = |state: &State| moved_to(whole, &damaged, state);
            fly_changed(whole.as_ref(), Some(&Change { aircraft: &damaged, at, moved: &moved }), scenario, progress)
        }
        (aircraft, Some(_)) => Err(AircraftError::NoDamage(aircraft.name().to_owned()).into()),
    }
}

/// Another aircraft from a time on.
struct Change<'a, A> {
    aircraft: &'a A,
    /// When, s.
    at: f64,
    /// Its state from that of the aircraft before, in the same motion.
    moved: &'a dyn Fn(&State) -> State,
}

impl<'a, A> Change<'a, A> {
    /// The same change of an aircraft that stands for this one.
    fn with<B>(&self, aircraft: &'a B) -> Change<'a, B> {
        Change { aircraft, at: self.at, moved: self.moved }
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
/// As [`fly`].
pub fn fly_aircraft<A: Aircraft>(
    known: &A,
    scenario: &Scenario,
    progress: &dyn Fn(f64),
) -> Result<Flight, FlightError> {
    fly_changed(known, None, scenario, progress)
}

fn fly_changed<A: Aircraft>(
    known: &A,
    change: Option<&Change<'_, A>>,
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
    let trajectory = match scenario.aircraft.thrust {
        Thrust::Engine => {
            let change = change.map(|(change, later)| change.with(later));
            trajectory(&scenario, &aircraft, change.as_ref(), &trim, progress)?
        }
        Thrust::Constant => {
            let frozen = ConstantThrust::at(&aircraft, trim.power_percent, trim.altitude_m, trim.mach);
            let later = change.map(|(change, later)| {
                (change, ConstantThrust::at(later, trim.power_percent, trim.altitude_m, trim.mach))
            });
            let change = later.as_ref().map(|(change, later)| change.with(later));
            trajectory(&scenario, &frozen, change.as_ref(), &trim, progress)?
        }
    };
    let thrust = |s: &TrajectorySample| match scenario.aircraft.thrust {
        Thrust::Engine => aircraft.propulsion(s.state.power, s.state.altitude, s.air.mach).thrust(),
        Thrust::Constant => trim.thrust_n,
    };
    let truth = true_record(&scenario, &trajectory, thrust);
    let measured = sense(&truth, &scenario, scenario.seed)?;
    let whole = known.data_range();
    // Damaged, the data end earlier.
    let data_range = changed.map_or(whole, |changed| changed.data_range().within(&whole));
    let mut flight =
        Flight { measured, truth, trim, true_parameters: BTreeMap::new(), scenario, error_increments, data_range };
    flight.true_parameters = flight.true_parameters_at(f64::INFINITY);
    Ok(flight)
}

/// The aircraft of a scenario as it is known, without the scenario's error of the model, and its trim.
///
/// # Errors
/// [`FlightError`]: the aircraft's data, no trim in this condition.
pub fn trimmed_aircraft(scenario: &Scenario) -> Result<(Arc<AnyAircraft>, Trim), FlightError> {
    let aircraft = scenario.aircraft.aircraft(&scenario.folder)?;
    let trim = trim_of(aircraft.as_ref(), scenario)?;
    Ok((aircraft, trim))
}

/// The steady flight that a scenario starts in, of any aircraft.
///
/// # Errors
/// [`TrimError`]: the aircraft has no steady flight in this condition.
pub fn trim_of<A: Aircraft>(aircraft: &A, scenario: &Scenario) -> Result<Trim, TrimError> {
    let at = &scenario.condition;
    let condition =
        TrimCondition::steady(aircraft, at.speed.si(), at.altitude.si(), at.flight_path.si(), at.turn_rate.si());
    trim(aircraft, &condition)
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

/// The motion from the trim, through commands, gusts and changing increments.
fn trajectory<A: Aircraft>(
    scenario: &Scenario,
    aircraft: &A,
    change: Option<&Change<'_, A>>,
    trim: &Trim,
    progress: &dyn Fn(f64),
) -> Result<Trajectory, FlightError> {
    let trim_controls = trim.controls();
    let sample_time = 1.0 / scenario.sample_rate.si();
    let time: Vec<f64> = (0..scenario.samples()).map(|k| k as f64 / scenario.sample_rate.si()).collect();
    // Deflections from trim of elevator, aileron and rudder at each sample.
    let mut deflections = [vec![0.0; time.len()], vec![0.0; time.len()], vec![0.0; time.len()]];
    for manoeuvre in &scenario.manoeuvre {
        let sum = match manoeuvre.surface() {
            Surface::Elevator => &mut deflections[0],
            Surface::Aileron => &mut deflections[1],
            Surface::Rudder => &mut deflections[2],
        };
        let added = manoeuvre.deflections(&time, scenario.seed, &scenario.folder)?;
        sum.iter_mut().zip(added).for_each(|(sum, added)| *sum += added);
    }
    let at = |t: f64| ((t * scenario.sample_rate.si() + 1e-6) as usize).min(time.len() - 1);
    let commands = |t: f64| {
        let k = at(t);
        if k % 1000 == 0 {
            progress(k as f64 / time.len() as f64);
        }
        Controls {
            throttle: trim_controls.throttle,
            elevator: trim_controls.elevator + deflections[0][k],
            aileron: trim_controls.aileron + deflections[1][k],
            rudder: trim_controls.rudder + deflections[2][k],
        }
    };
    let gusts: Vec<Gust> = scenario
        .gust
        .iter()
        .map(|g| Gust { axis: g.axis, amplitude: g.amplitude.si(), duration: g.duration.si(), delay: g.start.si() })
        .collect();
    let about = |i: &Increments| i.about(trim.alpha_rad, trim.q_rad_s, trim_controls.elevator);
    let start = IncrementChange { time: f64::NEG_INFINITY, increments: about(&scenario.increments) };
    let changes = changes(scenario, sample_time)
        .map(|(time, increments)| IncrementChange { time, increments: about(&increments) });
    let increments = IncrementSchedule::new(std::iter::once(start).chain(changes).collect())
        .map_err(|e| ScenarioError::OutOfRange { place: scenario.name.clone(), message: e.to_string() })?;
    let simulation = Simulation {
        aircraft,
        initial: trim.state(),
        initial_surfaces: trim_controls,
        use_actuators: scenario.aircraft.actuators,
        increments,
        duration: (time.len() - 1) as f64 * sample_time,
        sample_time,
        substeps: SUBSTEPS,
        hold: CommandHold::Sample,
    };
    let turbulence = turbulence(scenario, aircraft.geometry().span, time.len())?;
    let stage = stage_time(scenario);
    let air = |t: f64| {
        let gust = total_velocity(&gusts, t);
        let Some(&random) = turbulence.get((t / stage).round() as usize) else { return AirMotion::from(gust) };
        AirMotion { velocity: std::array::from_fn(|i| gust[i] + random.velocity[i]), rates: random.rates }
    };
    Ok(match change {
        None => simulation.run(commands, air)?,
        Some(change) => simulation.run_changed(change.aircraft, change.at, change.moved, commands, air)?,
    })
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
    let mut dryden = Dryden::new(field, scenario.condition.speed.si(), span, stage_time(scenario), seed)?;
    let sample = || {
        let air = dryden.sample();
        if settings.rates { air } else { AirMotion::from(air.velocity) }
    };
    Ok(std::iter::repeat_with(sample).take(2 * SUBSTEPS * samples).collect())
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

/// The trajectory as a record of canonical channels.
fn true_record(scenario: &Scenario, trajectory: &Trajectory, thrust: impl Fn(&TrajectorySample) -> f64) -> Record {
    type Get = fn(&TrajectorySample) -> f64;
    const CHANNELS: &[(&str, Quantity, Get)] = &[
        ("true_airspeed", Quantity::Speed, |s| s.air.speed),
        ("alpha", Quantity::Angle, |s| s.air.alpha),
        ("beta", Quantity::Angle, |s| s.air.beta),
        ("phi", Quantity::Angle, |s| s.state.phi),
        ("theta", Quantity::Angle, |s| s.state.theta),
        ("psi", Quantity::Angle, |s| s.state.psi),
        ("p", Quantity::AngularRate, |s| s.state.p),
        ("q", Quantity::AngularRate, |s| s.state.q),
        ("r", Quantity::AngularRate, |s| s.state.r),
        ("pdot", Quantity::AngularAcceleration, |s| s.angular_acceleration[0]),
        ("qdot", Quantity::AngularAcceleration, |s| s.angular_acceleration[1]),
        ("rdot", Quantity::AngularAcceleration, |s| s.angular_acceleration[2]),
        ("ax", Quantity::Acceleration, |s| s.specific_force[0]),
        ("ay", Quantity::Acceleration, |s| s.specific_force[1]),
        ("az", Quantity::Acceleration, |s| s.specific_force[2]),
        ("elevator", Quantity::Angle, |s| s.surfaces.elevator),
        ("aileron", Quantity::Angle, |s| s.surfaces.aileron),
        ("rudder", Quantity::Angle, |s| s.surfaces.rudder),
        ("throttle", Quantity::Number, |s| s.commands.throttle),
        ("altitude", Quantity::Length, |s| s.state.altitude),
        ("north", Quantity::Length, |s| s.state.north),
        ("east", Quantity::Length, |s| s.state.east),
        ("air_density", Quantity::Density, |s| s.air.density),
        ("dynamic_pressure", Quantity::Pressure, |s| s.air.dynamic_pressure),
        ("mach", Quantity::Number, |s| s.air.mach),
    ];
    let samples = &trajectory.samples;
    let mut channels: Vec<Channel> = CHANNELS
        .iter()
        .map(|(name, quantity, get)| Channel {
            name: (*name).to_owned(),
            quantity: *quantity,
            values: samples.iter().map(get).collect(),
        })
        .collect();
    if scenario.model_error.surfaces == RecordedSurfaces::Commanded {
        const COMMANDS: [(&str, Get); 3] = [
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
    let quality = QualityReport {
        rows_read: samples.len(),
        rows_kept: samples.len(),
        sample_time_s: 1.0 / scenario.sample_rate.si(),
        ..QualityReport::default()
    };
    let source = format!("{} (truth)", scenario.name);
    Record { source, time: samples.iter().map(|s| s.time).collect(), channels, quality }
}
