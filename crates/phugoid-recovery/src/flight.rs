//! One flight in closed loop: the aircraft of a scenario with its damage, its sensors, an estimator, and a control law.

use phugoid_control::excitation::Settings as ExcitationSettings;
use phugoid_control::following::{Follower, Following};
use phugoid_control::gains::Gains;
use phugoid_control::interval::Estimate;
use phugoid_control::law::{Form, Law, Measured, Settings as LawSettings};
use phugoid_control::local::{LocalModel, SURFACES};
use phugoid_control::lost::{Name, losses, name};
use phugoid_control::prediction::{LAG, Steady};
use phugoid_control::target::Targets;
use phugoid_estimators::ChangeState;
use phugoid_flight_dynamics::aircraft::{Aircraft, Controls};
use phugoid_flight_dynamics::trim::Trim;
use phugoid_identification::estimation::EventKind;
use phugoid_identification::method::Method;
use phugoid_identification::model_file::ModelFile;
use phugoid_identification::session::Step;
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
use crate::known::{Declared, Increment, estimate};
use crate::learning::Learning;
use crate::outcome::{Asked, Left, Outcome, judge, left};
use crate::performance::{Flown, Performance, performance};
use crate::pilot::Pilot;
use crate::polar::Condition;
use crate::robust::robust_gains;
use crate::scale::Scale;
use crate::sensing::{Reading, Sensors};
use crate::truth::{LAST_S, true_model, truly_steady};

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
    /// The gains that hold for many damages, until something is known.
    Reserve,
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
    /// Whether the last estimate explains how the aircraft turned in the last seconds (its angular accelerations, over three seconds and over
    /// six tenths of one), no change is suspected, and the aircraft did not depart; where it does not, neither it nor what follows from
    /// it is to be used. With the control that has one. Whether it explains lift and drag is in
    /// [`performance`](Performance::forces).
    pub explained: Option<bool>,
    /// What the aircraft can still do, by the last estimate; none with a control that has none, and where too little was flown since the
    /// last change.
    pub performance: Option<Performance>,
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
    if scenario.aircraft.flight_control {
        return Err(RecoveryError::Unsuitable(format!(
            "{}: a law of ours moves the surfaces of a flight in closed loop, in place of the flight control system of the aircraft: \
             leave `flight_control` under [aircraft] out",
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
        Control::Adaptive => Some(Box::new(Learning::new(&scenario, settings.method, model, &aircraft, &trim)?)),
        _ => None,
    };
    Loop::new(&scenario, aircraft.as_ref(), later.as_ref(), trim, settings, learning)?.run()
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
            Control::Robust => robust_gains(aircraft, &trim, &settings.targets, scale)?.0,
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
                let lag = scale.time(actuator.lag + actuator.delay);
                let rate = scale.rate(actuator.rate_limit);
                Follower::new(lag, rate, 0.7_f64.to_radians())
            })
        });
        let excitation = settings.excitation.filter(|_| learns);
        let mut controller = Controller::new(Law::new(law, gains), settings.targets, followers, excitation);
        if learns {
            // What is not known yet is flown with the gains that hold for the most.
            let (reserve, targets) = robust_gains(aircraft, &trim, &settings.targets, scale)?;
            controller = controller.with_reserve(reserve, targets);
        }
        Ok(Self {
            scenario,
            aircraft,
            trim,
            settings: *settings,
            scale,
            course: Course::new(scenario, aircraft, later.map(LaterAircraft::change), &trim)?,
            sensors: Sensors::new(scenario)?,
            pilot: Pilot::new(scenario, &trim, aircraft.gravity())?,
            controller,
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
        // What the scenario has after the end of the flight did not happen.
        let end = self.history.time_s.last().copied().unwrap_or(0.0);
        self.events.retain(|event| event.time_s <= end);
        self.events.sort_by(|a, b| a.time_s.total_cmp(&b.time_s));
        let truth = self.truth();
        let gains = *self.controller.gains();
        let outcome =
            judge(&self.history, self.departed, &self.trim, &truth, &gains, self.scale, self.aircraft.gravity());
        let lost = self.lost();
        let limits = self.controller.law().settings().limits;
        let flown = self.estimate.and_then(|estimate| Some((estimate, self.steady(&estimate)?)));
        let window = flown.map_or(LAST_S, |(_, steady)| steady.duration);
        let window = [window, LAG].map(|time| self.scale.model_time(time));
        let truly = truly_steady(&self.course, &self.history, &self.trim, &gains, window, self.aircraft.gravity());
        let scale = Declared::UNSTATED.surface_scale;
        let (before, truly_before) = (self.before(), self.undamaged());
        let told = self.learning.as_deref().map_or([false; 2], Learning::told);
        let asked = flown.as_ref().map(|(estimate, steady)| Asked {
            estimate,
            gains: &gains,
            steady,
            limits: &limits,
            scale,
            before: before.as_ref(),
            told,
        });
        let left = asked.map(|asked| self::left(&asked));
        let explained = self
            .estimate
            .as_ref()
            .map(|estimate| !self.departed && !self.in_doubt && self.controller.explains(estimate));
        let performance =
            left.as_ref().and_then(|left| self.performance(left, &gains, &limits, window[0], explained == Some(true)));
        let truly = Asked {
            estimate: &truth,
            gains: &gains,
            steady: &truly,
            limits: &limits,
            scale: 0.0,
            before: Some(&truly_before),
            told: [true; 2],
        };
        let truly_left = self::left(&truly);
        Ok(RecoveryFlight {
            scenario: self.scenario.name.clone(),
            control: self.settings.control,
            events: self.events,
            history: self.history,
            outcome,
            left,
            performance,
            explained,
            truly_left,
            lost,
            estimate: self.estimate,
            truth,
        })
    }

    /// What was flown in the last seconds on average, as if nothing had moved about it.
    fn steady(&self, estimate: &Estimate) -> Option<Steady> {
        let steady = self.controller.steady(estimate)?;
        let density = self.aircraft.atmosphere().at(self.flown[1]).density;
        let learning = self.learning.as_deref()?;
        Some(learning.settled(steady, self.scale, self.scenario.sample_rate.si(), density))
    }

    /// The undamaged aircraft about the trim's attitude, at the present speed and altitude, at full size.
    fn undamaged(&self) -> LocalModel {
        let [speed, altitude] = self.flown;
        let known = estimate(self.aircraft, &self.trim, &[], &Declared::UNSTATED, speed, altitude);
        self.scale.model(&known.model)
    }

    /// What the estimator knows of the aircraft before it was damaged, at the present speed and altitude, at full size. None where it knows
    /// nothing of before.
    fn before(&self) -> Option<LocalModel> {
        let learning = self.learning.as_deref()?;
        let found = learning.local(self.aircraft, &self.trim, &self.parameters_before()?, self.flown);
        Some(self.scale.model(&found.model))
    }

    /// The parameters before the damage: with increments to a known aircraft none, which is that one, else those before the changes that
    /// were adopted last. None where nothing was adopted.
    fn parameters_before(&self) -> Option<Vec<Increment>> {
        let learning = self.learning.as_deref()?;
        if learning.body.is_none() {
            return Some(Vec::new());
        }
        let (before, _) = self.changes.before_and_after()?;
        let named = learning.session.layout().parameters.iter().zip(&before.parameters);
        let one = named.map(|(layout, [value, std_error])| Increment {
            name: layout.name.clone(),
            value: *value,
            std_error: *std_error,
        });
        Some(one.collect())
    }

    /// What the aircraft can still do, by the last estimate and the last `seconds`.
    fn performance(
        &self,
        left: &Left,
        gains: &Gains,
        limits: &[[f64; 2]; SURFACES],
        seconds: f64,
        motion_explained: bool,
    ) -> Option<Performance> {
        let (learning, estimate) = (self.learning.as_deref()?, self.estimate.as_ref()?);
        let own = Gains::place_with(&estimate.model, &self.settings.targets, gains.free)?;
        let parameters = learning.parameters();
        let covariance = learning.covariance(&parameters)?;
        let positions = left.margins.map(|margin| margin.trim);
        let polar = |alpha: f64| {
            let at = Condition { flown: self.flown, angles: [alpha, 0.0], rates: [0.0; 3], positions };
            learning.polar(self.aircraft, &self.trim, &parameters, &at)
        };
        let at = Condition { flown: self.flown, angles: [left.flow_angles[0], 0.0], rates: [0.0; 3], positions };
        let lift_before =
            self.parameters_before().map(|before| learning.polar(self.aircraft, &self.trim, &before, &at).value[0]);
        let [speed, altitude] = self.flown;
        let rate = self.scenario.sample_rate.si();
        let forces = learning.forces(self.aircraft, &self.trim, &parameters, &covariance, seconds, rate);
        performance(
            &Flown {
                forces: forces.as_ref(),
                lift_before,
                departed: self.departed,
                motion_explained,
                alphas: learning.alphas(),
                alpha: left.flow_angles[0],
                speed,
                altitude,
                covariance: &covariance,
                estimate,
                gains: &own,
                margins: &left.margins,
                before: [self.trim.elevator_rad, self.trim.aileron_rad, self.trim.rudder_rad],
                limits,
            },
            &polar,
        )
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
        let Some(learning) = self.learning.as_deref_mut() else { return Ok(()) };
        learning.note(reading);
        let session = &mut learning.session;
        let values: Vec<f64> = session.channels().iter().map(|name| reading.channel(name)).collect();
        let step = session.update(time, &values)?;
        let events = session.take_events();
        let mut now = None;
        if step == Step::Estimated
            && let Some(snapshot) = session.snapshot()
        {
            self.in_doubt = snapshot.change == ChangeState::InDoubt;
            if !self.in_doubt {
                now = Some(Known::new(&snapshot.parameters, self.flown));
            }
            // Linearising is the dearest part of a frame; the controller decides five times a second.
            let every = (self.scale.model_time(0.1) * self.scenario.sample_rate.si()).max(1.0) as usize;
            if self.history.time_s.len().is_multiple_of(every) {
                let found = learning.local(self.aircraft, &self.trim, &learning.parameters(), self.flown);
                self.estimate = Some(self.scale.estimate(&found));
            }
        }
        for event in events {
            // Told before what is known now takes the place of what was known before.
            self.changes.event(event.kind, event.time_s, self.scale);
            if event.kind == EventKind::Adopted
                && let Some(learning) = self.learning.as_deref_mut()
            {
                learning.forget();
            }
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
        let learning = self.learning.as_deref()?;
        let of = |known: &Known| {
            let named = learning.session.layout().parameters.iter().zip(&known.parameters);
            let increments: Vec<Increment> = named
                .map(|(layout, [value, std_error])| Increment {
                    name: layout.name.clone(),
                    value: *value,
                    std_error: *std_error,
                })
                .collect();
            let found = learning.local(self.aircraft, &self.trim, &increments, known.flown);
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
            is_in_doubt: self.in_doubt,
            // A suspicion that was just given up may come back: what was estimated meanwhile is of two aircraft.
            is_settled: !self.in_doubt && time > self.dropped_s + self.scale.model_time(1.0),
            has_changed: self.changes.has_adopted(),
        };
        for decision in self.controller.decide(&told) {
            // The oracle's gains follow the truth all the time.
            let (kind, text) = match decision {
                Decision::NewGains if told.is_truth => continue,
                Decision::Reserve => {
                    (Kind::Reserve, "robust gains, because the aircraft does not move as it did".to_owned())
                }
                Decision::LeftOut => {
                    let is_rolled = self.controller.gains().roll_by_sideslip.is_some();
                    let how = if is_rolled { ": the rudder rolls the aircraft, by a sideslip" } else { "" };
                    (Kind::NewGains, format!("the same gains with the surfaces that are left{how}"))
                }
                Decision::TakenBack => {
                    (Kind::NewGains, "the same gains with the surface that follows again".to_owned())
                }
                Decision::NewGains => (Kind::NewGains, "new gains, because the bounds support them".to_owned()),
                Decision::Surface(j, Following::Follows) => {
                    (Kind::Surface, format!("the {} follows its command again", NAMES[j]))
                }
                Decision::Surface(j, Following::Play) => {
                    (Kind::Surface, format!("the {} follows its command with play", NAMES[j]))
                }
                Decision::Surface(j, found) => {
                    let word = format!("{found:?}").to_lowercase();
                    (Kind::Surface, format!("the {} does not follow its command: {word}", NAMES[j]))
                }
            };
            self.events.push(Event { time_s: time, kind, text });
        }
        let load_factor = -reading.channel("az") / self.aircraft.gravity();
        let added = self.controller.excite(&told, load_factor);
        let commands = self.controller.command(&measured, &wish.demand);
        let [elevator, aileron, rudder]: [f64; SURFACES] = std::array::from_fn(|j| commands[j] + added[j]);
        Controls { throttle: wish.throttle, elevator, aileron, rudder }
    }

    /// The true aircraft about the trim's attitude, at its own speed and altitude, at full size.
    fn truth(&self) -> Estimate {
        let model = true_model(
            &self.course,
            &self.trim,
            [self.trim.alpha_rad, self.trim.beta_rad],
            &self.trim.controls(),
            self.aircraft.gravity(),
        );
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
        let (sine, cosine) = sample.air.alpha.sin_cos();
        let (x, z) = (sample.coefficients.cx, sample.coefficients.cz);
        h.lift_drag[0].push(x * sine - z * cosine);
        h.lift_drag[1].push(-x * cosine - z * sine);
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
    // A transport that is "damaged" to be whole is the one that took off.
    let none = scenario.aircraft.damaged.is_some_and(|word| word.0.word() == "none");
    let changes = later.iter().filter(|_| !none).map(|later| Event {
        time_s: later.at(),
        kind: Kind::Damage,
        text: scenario.aircraft.damaged.map_or("damage".to_owned(), |word| format!("damage: {}", word.0.word())),
    });
    damage.chain(failures).chain(changes).collect()
}
