//! One flight in closed loop: the aircraft of a scenario with its damage, its sensors, an estimator, and a control law.

use phugoid_control::excitation::Settings as ExcitationSettings;
use phugoid_control::following::Follower;
use phugoid_control::gains::Gains;
use phugoid_control::interval::Estimate;
use phugoid_control::law::{Form, Law, Measured, Settings as LawSettings};
use phugoid_control::local::SURFACES;
use phugoid_control::lost::{Name, losses, name};
use phugoid_control::target::Targets;
use phugoid_estimators::ChangeState;
use phugoid_flight_dynamics::aircraft::{Aircraft, Controls};
use phugoid_flight_dynamics::built_in::AircraftName;
use phugoid_flight_dynamics::f16::F16Tables;
use phugoid_flight_dynamics::trim::Trim;
use phugoid_identification::estimate::EstimateOptions;
use phugoid_identification::estimation::EventKind;
use phugoid_identification::method::Method;
use phugoid_identification::model_file::{Base, ModelFile};
use phugoid_identification::session::{Session, Step};
use phugoid_simulation::aircraft::AnyAircraft;
use phugoid_simulation::course::Course;
use phugoid_simulation::flight::{LaterAircraft, later_aircraft, trimmed_aircraft};
use phugoid_simulation::quantity::Length;
use phugoid_simulation::scenario::Scenario;
use serde::{Deserialize, Serialize};

pub use crate::error::RecoveryError;
pub use crate::history::History;

use crate::changes::{Changes, Known};
use crate::controller::{Controller, Decision, NAMES, Told};
use crate::known::{Body, Declared, Increment, estimate, local_model, whole};
use crate::outcome::{Left, Outcome, judge, left};
use crate::pilot::Pilot;
use crate::robust::robust_gains;
use crate::scale::Scale;
use crate::sensing::{Reading, Sensors};

/// Where the gains come from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Control {
    /// From the estimate of the aircraft in flight and its bounds.
    #[default]
    Adaptive,
    /// From the undamaged aircraft.
    Fixed,
    /// Fixed, and chosen for a set of damages.
    Robust,
    /// From the true aircraft: what could be reached at best.
    Oracle,
}

impl Control {
    /// All, in the order of tables.
    pub const ALL: [Self; 4] = [Self::Fixed, Self::Robust, Self::Adaptive, Self::Oracle];

    /// Its word, as on the command line.
    pub const fn word(self) -> &'static str {
        match self {
            Self::Adaptive => "adaptive",
            Self::Fixed => "fixed",
            Self::Robust => "robust",
            Self::Oracle => "oracle",
        }
    }
}

/// Settings of a flight.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// Where the gains come from.
    pub control: Control,
    /// The form of the law.
    pub form: Form,
    /// The wanted motion.
    pub targets: Targets,
    /// The excitation that the adaptive control may add; `None` leaves the pilot's input alone.
    pub excitation: Option<ExcitationSettings>,
    /// The causal method of the estimator; `None` takes that of the model file.
    pub method: Option<Method>,
}

impl Default for Settings {
    /// Adaptive control with excitation, the law in the form of the model, the default targets.
    fn default() -> Self {
        Self {
            control: Control::Adaptive,
            form: Form::Model,
            targets: Targets::default(),
            excitation: Some(ExcitationSettings::default()),
            method: Some(Method::Ekf),
        }
    }
}

/// Something that happened.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Event {
    /// When, s.
    pub time_s: f64,
    /// What.
    pub kind: Kind,
    /// In words.
    pub text: String,
}

/// What an event is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Kind {
    /// Damage or a failure of the scenario.
    Damage,
    /// The estimator suspects a change.
    InDoubt,
    /// The estimator adopted a change.
    Adopted,
    /// A suspected change was dropped, or an adopted one taken back.
    Withdrawn,
    /// A surface no longer does what it is told.
    Surface,
    /// New gains.
    NewGains,
    /// The motion left what the aircraft's data cover, or turned over.
    Departed,
}

/// A flight and what became of it.
#[derive(Clone, Debug, Serialize)]
pub struct RecoveryFlight {
    /// Name of the scenario.
    pub scenario: String,
    /// Where the gains came from.
    pub control: Control,
    /// Everything that happened, in order of time.
    pub events: Vec<Event>,
    /// The samples.
    pub history: History,
    /// How it ended.
    pub outcome: Outcome,
    /// What the last estimate says is left, with the control that has one.
    pub left: Option<Left>,
    /// Whether the last estimate explains how the aircraft moved in the last seconds; where it does not, neither it nor what follows
    /// from it is to be used. With the control that has one.
    pub explained: Option<bool>,
    /// What is left in truth; its bounds are zero.
    pub truly_left: Left,
    /// Which part of the aircraft is gone, by the estimates before and after what was adopted last; none where nothing was adopted.
    pub lost: Option<Name>,
    /// The last estimate, with the control that has one; of a dynamically scaled model at full size.
    pub estimate: Option<Estimate>,
    /// The true aircraft at the end, about the attitude of the trim; of a dynamically scaled model at full size.
    pub truth: Estimate,
}

/// Flies a scenario in closed loop. `model` is what the adaptive control estimates with: increments to the scenario's aircraft, or all
/// of its aerodynamics, in absolute form.
///
/// # Errors
/// [`RecoveryError`]: a scenario that cannot be flown in closed loop, a model that does not fit it.
pub fn fly(scenario: &Scenario, settings: &Settings, model: &ModelFile) -> Result<RecoveryFlight, RecoveryError> {
    let scenario = scenario.drawn();
    if scenario.aircraft.thrust == phugoid_simulation::scenario::Thrust::Constant {
        return Err(RecoveryError::Unsuitable(format!(
            "{}: the pilot of a flight in closed loop moves the throttle: give `thrust = \"engine\"` under [aircraft]",
            scenario.name
        )));
    }
    if scenario.model_error != Default::default() {
        return Err(RecoveryError::Unsuitable(format!(
            "{}: [model_error] is not flown in closed loop: say what differs under [increments] or [[damage]]",
            scenario.name
        )));
    }
    if scenario.sensors.accelerometers != <[Length; 3]>::default() || scenario.sensors.vanes != <[Length; 3]>::default()
    {
        return Err(RecoveryError::Unsuitable(format!(
            "{}: sensors of a flight in closed loop are at the centre of gravity: leave `accelerometers` and `vanes` out",
            scenario.name
        )));
    }
    let (aircraft, trim) = trimmed_aircraft(&scenario)?;
    let later = later_aircraft(&scenario, &aircraft)?;
    let learning = match settings.control {
        Control::Adaptive => Some(learning(&scenario, settings, model, &trim)?),
        _ => None,
    };
    Loop::new(&scenario, aircraft.as_ref(), later.as_ref(), trim, settings, learning)?.run()
}

/// The estimator of a flight, and what its parameters are of.
struct Learning {
    session: Session,
    /// The aircraft where the parameters are all of its aerodynamics; none where they are increments to the one that flies.
    body: Option<Body>,
}

fn learning(
    scenario: &Scenario,
    settings: &Settings,
    model: &ModelFile,
    trim: &Trim,
) -> Result<Box<Learning>, RecoveryError> {
    let body = match model.base {
        Base::None => {
            let body = Body::of(model);
            Some(body.map_err(|why| RecoveryError::Unsuitable(format!("the model `{}`: {why}", model.name)))?)
        }
        Base::F16 => {
            fits(scenario, model)?;
            None
        }
        _ => {
            return Err(RecoveryError::Unsuitable(format!(
                "the model `{}` is made of increments to the aircraft of a file, which are not flown in closed loop yet: give a model \
                 without `base`, or fly with --control fixed, robust or oracle",
                model.name
            )));
        }
    };
    if let Some(body) = &body {
        body.counts_from(trim)
            .map_err(|why| RecoveryError::Unsuitable(format!("the model `{}`: {why}", model.name)))?;
    }
    let options = EstimateOptions { method: settings.method, ..EstimateOptions::default() };
    Ok(Box::new(Learning { session: Session::new(model, &options)?, body }))
}

/// Refuses a model whose parameters are no increments to the aircraft that flies, about the trim that it flies from: they would be
/// read as if they were, and gains and margins would be those of another aircraft.
fn fits(scenario: &Scenario, model: &ModelFile) -> Result<(), RecoveryError> {
    // One per cent of the speed moves the angle of attack of the trim by less than the declared constant error of a vane.
    const SPEED: f64 = 0.01;
    // So do 100 m of altitude, which are one per cent of the density.
    const ALTITUDE: f64 = 100.0;
    let refused = |why: String| Err(RecoveryError::Unsuitable(format!("{}: {why}", scenario.name)));
    if scenario.aircraft.kind != Some(AircraftName::F16) {
        return refused(format!(
            "the model `{}` is made of increments to the F-16 (`base = \"f16\"`), and the scenario flies another aircraft: give a model of \
             that aircraft without `base`, or fly with --control fixed, robust or oracle",
            model.name
        ));
    }
    let (flown, known) = (scenario.aircraft.cg.unwrap_or(0.35), model.aircraft.cg);
    if known != Some(flown) {
        return refused(format!(
            "the centre of gravity is at {flown} of the mean chord, and in the model `{}` at {}: give both the same",
            model.name,
            known.map_or("no stated place".to_owned(), |cg| cg.to_string())
        ));
    }
    if scenario.aircraft.tables.is_some_and(|tables| tables != F16Tables::default()) {
        return refused(format!(
            "the increments of the model `{}` count from the tables of the book: give `tables = \"book\"` under [aircraft]",
            model.name
        ));
    }
    let (altitude, known) = (scenario.condition.altitude.si(), model.reference.altitude);
    if known.is_none_or(|known| (known - altitude).abs() > ALTITUDE) {
        return refused(format!(
            "the flight begins at {altitude:.0} m, and the increments of the model `{}` count from a trim at {}: give `altitude` under \
             [reference] that of the scenario",
            model.name,
            known.map_or("no stated altitude".to_owned(), |known| format!("{known:.0} m"))
        ));
    }
    let speed = scenario.condition.speed.si();
    match model.aircraft.reference_speed {
        Some(reference) if (reference / speed - 1.0).abs() <= SPEED => Ok(()),
        reference => refused(format!(
            "the flight begins at {speed:.1} m/s, and the increments of the model `{}` count from a trim at {} m/s: give \
             `reference_speed` the speed of the scenario",
            model.name,
            reference.map_or("no stated speed, in".to_owned(), |reference| format!("{reference:.1}"))
        )),
    }
}

/// Gains for the undamaged aircraft in its trim.
pub(crate) fn healthy_gains<A: Aircraft>(
    aircraft: &A,
    trim: &Trim,
    targets: &Targets,
    scale: Scale,
) -> Result<Gains, RecoveryError> {
    let known = estimate(aircraft, trim, &[], &Declared::UNSTATED, trim.speed_m_s, trim.altitude_m);
    Gains::place(&scale.model(&known.model), targets).ok_or(RecoveryError::NoGains)
}

struct Loop<'a> {
    scenario: &'a Scenario,
    aircraft: &'a AnyAircraft,
    trim: Trim,
    settings: Settings,
    /// Control law and pilot are those of the full size, and so is the estimate that they are told.
    scale: Scale,
    course: Course<'a, AnyAircraft>,
    sensors: Sensors,
    pilot: Pilot,
    controller: Controller,
    learning: Option<Box<Learning>>,
    changes: Changes,
    estimate: Option<Estimate>,
    history: History,
    events: Vec<Event>,
    /// Airspeed and altitude as measured last.
    flown: [f64; 2],
    /// Whether the estimator suspects a change, and when it last gave a suspicion up, s.
    in_doubt: bool,
    dropped_s: f64,
    departed: bool,
}

impl<'a> Loop<'a> {
    fn new(
        scenario: &'a Scenario,
        aircraft: &'a AnyAircraft,
        later: Option<&'a LaterAircraft>,
        trim: Trim,
        settings: &Settings,
        learning: Option<Box<Learning>>,
    ) -> Result<Self, RecoveryError> {
        let scale = Scale::of(scenario);
        let gains = match settings.control {
            // What is not known yet is flown with the gains that hold for the most.
            Control::Robust | Control::Adaptive => robust_gains(aircraft, &trim, &settings.targets, scale)?,
            _ => healthy_gains(aircraft, &trim, &settings.targets, scale)?,
        };
        let controls = trim.controls();
        let actuators = aircraft.actuators();
        let each = [actuators.elevator, actuators.aileron, actuators.rudder];
        let law = LawSettings {
            form: settings.form,
            ..LawSettings::new(
                scale.time(1.0 / scenario.sample_rate.si()),
                [trim.alpha_rad, trim.beta_rad, 0.0, 0.0, 0.0],
                [controls.elevator, controls.aileron, controls.rudder],
                each.map(|actuator| [-actuator.limit, actuator.limit]),
                each.map(|actuator| scale.rate(actuator.rate_limit)),
            )
        };
        let learns = learning.is_some();
        let followers = (learns && scenario.aircraft.actuators).then(|| {
            each.map(|actuator| {
                let (lag, rate) = (scale.time(actuator.lag), scale.rate(actuator.rate_limit));
                Follower::new(lag, rate, 0.7_f64.to_radians())
            })
        });
        let excitation = settings.excitation.filter(|_| learns);
        Ok(Self {
            scenario,
            aircraft,
            trim,
            settings: *settings,
            scale,
            course: Course::new(scenario, aircraft, later.map(LaterAircraft::change), &trim)?,
            sensors: Sensors::new(scenario)?,
            pilot: Pilot::new(scenario, &trim, aircraft.gravity())?,
            controller: Controller::new(Law::new(law, gains), settings.targets, followers, excitation),
            learning,
            changes: Changes::default(),
            estimate: None,
            history: History::default(),
            events: scenario_events(scenario, later),
            flown: [trim.speed_m_s, trim.altitude_m],
            in_doubt: false,
            dropped_s: f64::NEG_INFINITY,
            departed: false,
        })
    }

    fn run(mut self) -> Result<RecoveryFlight, RecoveryError> {
        let mut controls = self.trim.controls();
        for k in 0..self.scenario.samples() {
            // What the sensors show at the beginning of a sample belongs to the commands of the one before.
            let sample = self.course.sample(controls);
            let reading = self.sensors.read(&sample)?;
            self.learn(sample.time, &reading)?;
            let commands = self.command(k, sample.time, &reading, &controls);
            self.record(&sample, &commands);
            controls = commands;
            if self.has_departed(&sample.state) {
                self.event(sample.time, Kind::Departed, "the aircraft departed".to_owned());
                self.departed = true;
                break;
            }
            if k + 1 < self.scenario.samples() && self.course.advance(controls).is_err() {
                self.event(sample.time, Kind::Departed, "the motion diverged".to_owned());
                self.departed = true;
                break;
            }
        }
        self.events.sort_by(|a, b| a.time_s.total_cmp(&b.time_s));
        let truth = self.truth();
        let gains = *self.controller.gains();
        let outcome = judge(&self.history, self.departed, &self.trim, &truth, &gains, self.scale);
        let lost = self.lost();
        let law = *self.controller.law().settings();
        let scale = Declared::UNSTATED.surface_scale;
        let left = |estimate: &Estimate| left(estimate, &gains, &law.surfaces, &law.limits, scale);
        Ok(RecoveryFlight {
            scenario: self.scenario.name.clone(),
            control: self.settings.control,
            events: self.events,
            history: self.history,
            outcome,
            left: self.estimate.as_ref().map(|estimate| left(&self.controller.checked(estimate))),
            explained: self.estimate.as_ref().map(|estimate| self.controller.explains(estimate)),
            truly_left: left(&truth),
            lost,
            estimate: self.estimate,
            truth,
        })
    }

    /// Gives the estimator its sample and takes what it says.
    fn learn(&mut self, time: f64, reading: &Reading) -> Result<(), RecoveryError> {
        for (flown, name) in self.flown.iter_mut().zip(["true_airspeed", "altitude"]) {
            let now = reading.channel(name);
            // The air's own motion is not the aircraft's.
            if now.is_finite() {
                *flown += 0.01 * (now - *flown);
            }
        }
        let Some(Learning { session, body }) = self.learning.as_deref_mut() else { return Ok(()) };
        let values: Vec<f64> = session.channels().iter().map(|name| reading.channel(name)).collect();
        let step = session.update(time, &values)?;
        let events = session.take_events();
        let mut now = None;
        if step == Step::Estimated
            && let Some(snapshot) = session.snapshot()
        {
            let layout = &session.layout().parameters;
            let increments: Vec<Increment> = layout
                .iter()
                .zip(&snapshot.parameters)
                .map(|(layout, parameter)| Increment {
                    name: layout.name.clone(),
                    value: parameter.value,
                    std_error: parameter.std_error,
                })
                .collect();
            let [speed, altitude] = self.flown;
            self.in_doubt = snapshot.change == ChangeState::InDoubt;
            if !self.in_doubt {
                now = Some(Known::new(&snapshot.parameters, self.flown));
            }
            // Linearising is the dearest part of a frame; the controller decides five times a second.
            let every = (self.scale.model_time(0.1) * self.scenario.sample_rate.si()).max(1.0) as usize;
            if self.history.time_s.len().is_multiple_of(every) {
                let found = local(self.aircraft, &self.trim, body.as_ref(), &increments, [speed, altitude]);
                self.estimate = Some(self.scale.estimate(&found));
            }
        }
        for event in events {
            // Told before what is known now takes the place of what was known before.
            self.changes.event(event.kind, event.time_s, self.scale);
            if event.kind == EventKind::DoubtDropped {
                self.dropped_s = event.time_s;
            }
            let (kind, text) = match event.kind {
                EventKind::InDoubt => (Kind::InDoubt, "a change of the aircraft is suspected"),
                EventKind::Adopted => (Kind::Adopted, "the change is adopted: new estimates"),
                EventKind::DoubtDropped => (Kind::Withdrawn, "the suspected change was none"),
                EventKind::RolledBack => (Kind::Withdrawn, "the adopted change was taken back"),
                _ => continue,
            };
            self.event(event.time_s, kind, text.to_owned());
        }
        if let Some(now) = now {
            self.changes.note(now);
        }
        Ok(())
    }

    /// Which part of the aircraft the adopted changes look like.
    fn lost(&self) -> Option<Name> {
        let (before, after) = self.changes.before_and_after()?;
        let Learning { session, body } = self.learning.as_deref()?;
        let of = |known: &Known| {
            let named = session.layout().parameters.iter().zip(&known.parameters);
            let increments: Vec<Increment> = named
                .map(|(layout, [value, std_error])| Increment {
                    name: layout.name.clone(),
                    value: *value,
                    std_error: *std_error,
                })
                .collect();
            let found = local(self.aircraft, &self.trim, body.as_ref(), &increments, known.flown);
            self.scale.estimate(&found)
        };
        let span = self.scale.length(self.aircraft.geometry().span);
        Some(name(&losses(&of(before), &of(after), span)))
    }

    fn command(&mut self, k: usize, time: f64, reading: &Reading, before: &Controls) -> Controls {
        let wish = self.pilot.fly(k, reading);
        let channels = ["alpha", "beta", "p", "q", "r"].map(|name| self.scale.channel(name, reading.channel(name)));
        let surfaces = NAMES.map(|name| reading.channel(name));
        let measured = Measured { variables: channels, surfaces };
        let is_asked = self.settings.control == Control::Oracle && self.controller.is_due(self.scale.time(time));
        let truth = is_asked.then(|| self.truth());
        let told = Told {
            time_s: self.scale.time(time),
            measured,
            commands: [before.elevator, before.aileron, before.rudder],
            estimate: truth.as_ref().or(self.estimate.as_ref()),
            is_truth: truth.is_some(),
            // A suspicion that was just given up may come back: what was estimated meanwhile is of two aircraft.
            is_settled: !self.in_doubt && time > self.dropped_s + self.scale.model_time(1.0),
        };
        for decision in self.controller.decide(&told) {
            // The oracle's gains follow the truth all the time.
            let (kind, text) = match decision {
                Decision::NewGains if told.is_truth => continue,
                Decision::NewGains => (Kind::NewGains, "new gains, because the bounds support them".to_owned()),
                Decision::Surface(j, found) => {
                    let word = format!("{found:?}").to_lowercase();
                    (Kind::Surface, format!("the {} does not follow its command: {word}", NAMES[j]))
                }
            };
            self.events.push(Event { time_s: time, kind, text });
        }
        let load_factor = -reading.channel("az") / self.aircraft.gravity();
        let added = self.controller.excite(&told, load_factor);
        let commands = self.controller.law().update(&measured, &wish.demand);
        let [elevator, aileron, rudder]: [f64; SURFACES] = std::array::from_fn(|j| commands[j] + added[j]);
        Controls { throttle: wish.throttle, elevator, aileron, rudder }
    }

    /// The true aircraft about the trim's attitude, at its own speed and altitude.
    fn truth(&self) -> Estimate {
        let state = self.course.state();
        let reference = phugoid_flight_dynamics::aircraft::State {
            speed: state.speed,
            altitude: state.altitude,
            power: state.power,
            ..self.trim.state()
        };
        let linear = self.course.linear_model(&reference, &self.trim.controls());
        let mut model = local_model(&linear, self.trim.alpha_rad, state.speed, self.aircraft.gravity());
        for (j, left) in self.course.obeys().into_iter().enumerate() {
            if !left {
                model.surfaces.iter_mut().for_each(|row| row[j] = 0.0);
            }
        }
        Estimate { model: self.scale.model(&model), ..Estimate::default() }
    }

    fn has_departed(&self, state: &phugoid_flight_dynamics::aircraft::State) -> bool {
        let range = self.aircraft.data_range();
        let outside = |value: f64, [low, high]: [f64; 2]| !(low..=high).contains(&value);
        state.phi.abs() > std::f64::consts::FRAC_PI_2
            || state.theta.abs() > 1.05
            || outside(state.alpha, range.alpha)
            || outside(state.beta, range.beta)
            || state.altitude < 0.0
    }

    fn event(&mut self, time_s: f64, kind: Kind, text: String) {
        self.events.push(Event { time_s, kind, text });
    }

    fn record(&mut self, sample: &phugoid_flight_dynamics::simulate::TrajectorySample, commands: &Controls) {
        let (h, s) = (&mut self.history, &sample.state);
        h.time_s.push(sample.time);
        h.alpha.push(sample.air.alpha);
        h.beta.push(sample.air.beta);
        h.phi.push(s.phi);
        h.theta.push(s.theta);
        for (rates, rate) in h.rates.iter_mut().zip([s.p, s.q, s.r]) {
            rates.push(rate);
        }
        h.altitude.push(s.altitude);
        h.speed.push(s.speed);
        h.load_factor.push(-sample.specific_force[2] / self.aircraft.gravity());
        let told = [commands.elevator, commands.aileron, commands.rudder];
        let there = [sample.surfaces.elevator, sample.surfaces.aileron, sample.surfaces.rudder];
        let level = self.controller.excitation_level();
        for j in 0..SURFACES {
            h.commands[j].push(told[j]);
            h.surfaces[j].push(there[j]);
            h.excitation[j].push(level[j]);
        }
    }
}

/// The local model that parameters make at an airspeed (m/s) and altitude (m).
fn local(
    aircraft: &AnyAircraft,
    trim: &Trim,
    body: Option<&Body>,
    parameters: &[Increment],
    [speed, altitude]: [f64; 2],
) -> Estimate {
    let declared = Declared::UNSTATED;
    match body {
        None => estimate(aircraft, trim, parameters, &declared, speed, altitude),
        Some(body) => {
            let density = aircraft.atmosphere().at(altitude).density;
            whole(body, parameters, trim, &declared, speed, density)
        }
    }
}

fn scenario_events(scenario: &Scenario, later: Option<&LaterAircraft>) -> Vec<Event> {
    // What differs from the start is no event: the aircraft took off with it.
    let damage = scenario.damage.iter().filter(|damage| damage.at.si() > 0.0).map(|damage| Event {
        time_s: damage.at.si(),
        kind: Kind::Damage,
        text: "damage".to_owned(),
    });
    let failures = scenario.failure.iter().map(|failure| Event {
        time_s: failure.at.si(),
        kind: Kind::Damage,
        text: format!("failure of the {}", failure.surface.name()),
    });
    let changes = later.iter().map(|later| Event {
        time_s: later.at(),
        kind: Kind::Damage,
        text: scenario.aircraft.damaged.map_or("damage".to_owned(), |word| format!("damage: {}", word.0.word())),
    });
    damage.chain(failures).chain(changes).collect()
}
