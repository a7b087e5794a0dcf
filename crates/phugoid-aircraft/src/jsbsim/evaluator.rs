//! The properties of an aircraft at one moment, and the forces that follow from them.

use super::aircraft::Aircraft;
use super::channels::Memories;
use super::compiled::force_moment;
use super::flight::FlightCondition;
use super::mass::MassProperties;
use super::model::State;
use super::propulsion::{EngineKind, Guess, INPUTS, Source};
use super::units::PSF;

/// Force and moment in body axes (x forward, y right, z down), the moment about the centre of gravity.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ForceMoment {
    /// Force, N.
    pub force_n: [f64; 3],
    /// Moment, N m.
    pub moment_n_m: [f64; 3],
}

/// Coefficients of the aerodynamic force and moment in body axes, the moment about the centre of gravity. They refer to the
/// dynamic pressure and the area of the wing, roll and yaw to its span, pitch to its chord.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Coefficients {
    /// Forward, right and down.
    pub force: [f64; 3],
    /// Roll to the right, pitch up, yaw to the right.
    pub moment: [f64; 3],
}

/// Values of all properties of an aircraft at one moment.
#[derive(Debug, Clone)]
pub struct Evaluator<'a> {
    aircraft: &'a Aircraft,
    pub(super) state: State,
    memories: Memories,
    /// What was set for each engine: a thrust, N, or the speed of a propeller, turns per minute.
    engines_set: Vec<Option<f64>>,
    /// Where the balance of each propeller was.
    guesses: Vec<Guess>,
    /// Lift of the call before, pounds, if it is asked for.
    lift_before: Option<f64>,
}

impl<'a> Evaluator<'a> {
    /// The properties as the files give them; what they do not give is 0, and the gear is down (`gear/gear-pos-norm` is 1).
    pub fn new(aircraft: &'a Aircraft) -> Self {
        Self {
            aircraft,
            state: State::new(&aircraft.model),
            memories: aircraft.channels.memories(),
            engines_set: vec![None; aircraft.engines.len()],
            guesses: vec![Guess::default(); aircraft.engines.len()],
            lift_before: None,
        }
    }

    /// The aircraft that is evaluated.
    pub fn aircraft(&self) -> &'a Aircraft {
        self.aircraft
    }

    /// Sets a property of a name, in the units of JSBSim that its name tells; `false` where no file mentions it, and nothing is
    /// set. An angle of a surface in radians sets the one in degrees and its magnitude, and the other way round. The value of a
    /// function cannot be set.
    pub fn set(&mut self, name: &str, value: f64) -> bool {
        let found = self.aircraft.property(name);
        if let Some(index) = found {
            self.set_index(index, value);
        }
        found.is_some()
    }

    /// Sets a property of an index of [`Aircraft::property`], as [`Evaluator::set`] does; an index that there is not does nothing.
    pub fn set_index(&mut self, index: usize, value: f64) {
        if index < self.aircraft.model.properties.len() {
            self.state.write(&self.aircraft.model, index, value);
        }
    }

    /// The value of a property of a name, in the units of JSBSim that its name tells; `None` where no file mentions it.
    pub fn get(&mut self, name: &str) -> Option<f64> {
        self.aircraft.property(name).and_then(|index| self.get_index(index))
    }

    /// The value of a property of an index of [`Aircraft::property`]; `None` where there is none.
    pub fn get_index(&mut self, index: usize) -> Option<f64> {
        let there = index < self.aircraft.model.properties.len();
        there.then(|| self.state.read(&self.aircraft.model, index))
    }

    /// Sets the properties of motion and air that follow from a flight condition.
    pub fn set_flight(&mut self, flight: &FlightCondition) {
        let aircraft = self.aircraft;
        let (_, centre) = aircraft.fed.weight(&aircraft.model, &mut self.state, &aircraft.masses);
        aircraft.flight.set(&aircraft.model, &mut self.state, flight, &aircraft.metrics, centre);
    }

    /// Mass, centre and inertia with what the tanks hold now (`propulsion/tank[k]/contents-lbs`) and the point masses weigh
    /// (`inertia/pointmass-weight-lbs[k]`).
    pub fn mass_properties(&mut self) -> MassProperties {
        self.aircraft.masses.properties(&self.aircraft.model, &mut self.state)
    }

    /// Whether the aerodynamics take from the call before what JSBSim takes from its step before: the square of the lift
    /// coefficient, and functions that stand after the one that reads them. Otherwise, as at the beginning, forces follow from
    /// the properties alone, as an integrator or a search for trim needs.
    pub fn set_stepwise(&mut self, stepwise: bool) {
        self.lift_before = stepwise.then(|| self.lift_before.unwrap_or(0.0));
    }

    /// Aerodynamic force and moment at the flight condition and the properties that were set last.
    pub fn aerodynamic_force_moment(&mut self) -> ForceMoment {
        let aircraft = self.aircraft;
        let model = &aircraft.model;
        let (_, centre) = aircraft.masses.weight_and_centre(model, &mut self.state);
        let sum =
            aircraft.aerodynamics.sum(model, &mut self.state, &aircraft.metrics, centre, self.lift_before.as_mut());
        aircraft.fed.aerodynamics(model, &mut self.state, sum.force, sum.moment);
        force_moment(sum.force, sum.moment)
    }

    /// Coefficients of [`Evaluator::aerodynamic_force_moment`]; not a number without dynamic pressure or without a size.
    pub fn coefficients(&mut self) -> Coefficients {
        let sum = self.aerodynamic_force_moment();
        let geometry = self.aircraft.geometry();
        let qbar = self.get("aero/qbar-psf").unwrap_or(0.0) * PSF;
        let force = qbar * geometry.wing_area_m2;
        let [l, m, n] = sum.moment_n_m;
        let (span, chord) = (force * geometry.wing_span_m, force * geometry.chord_m);
        Coefficients { force: sum.force_n.map(|newton| newton / force), moment: [l / span, m / chord, n / span] }
    }

    /// Sets the thrust of an engine without a model of its own, N; `false` where there is no engine of this number, from 0, or it
    /// has one.
    pub fn set_thrust_n(&mut self, engine: usize, thrust_n: f64) -> bool {
        self.set_engine(engine, EngineKind::ConstantForce, Some(thrust_n))
    }

    /// Sets the speed of a propeller, turns per minute, with its pitch at the fine end of its range, instead of the one that its
    /// engine turns it with; `None` takes that again. `false` where there is no propeller of this number, from 0.
    pub fn set_propeller_rpm(&mut self, engine: usize, rpm: Option<f64>) -> bool {
        self.set_engine(engine, EngineKind::Propeller, rpm)
    }

    fn set_engine(&mut self, engine: usize, kind: EngineKind, value: Option<f64>) -> bool {
        let settable = self.aircraft.engines.get(engine).is_some_and(|found| found.kind == kind);
        if settable {
            self.engines_set[engine] = value;
        }
        settable
    }

    /// Force and moment of the engines. A turbine and a propeller are at their throttle (`fcs/throttle-pos-norm[k]`, from 0 to 1, and
    /// to 2 with an afterburner), a propeller of constant speed at that of its lever (`fcs/advance-pos-norm[k]`, from 0 for the
    /// slowest to 1); another engine gives the thrust that was set, or none.
    pub fn propulsive_force_moment(&mut self) -> ForceMoment {
        let aircraft = self.aircraft;
        let (_, centre) = aircraft.masses.weight_and_centre(&aircraft.model, &mut self.state);
        let model = &aircraft.model;
        let (mut force, mut moment) = ([0.0; 3], [0.0; 3]);
        for (number, engine) in aircraft.engines.iter().enumerate() {
            let mut inputs = [0.0; INPUTS];
            for (input, source) in inputs.iter_mut().zip(engine.sources()) {
                *input = match source {
                    Source::Property(index) => self.state.read(model, index),
                    Source::Function(function) => self.state.call(model, function),
                };
            }
            let push = engine.push(&inputs, self.engines_set[number], centre, &mut self.guesses[number]);
            aircraft.fed.engine(model, &mut self.state, number, push.thrust_lb, push.rpm);
            for axis in 0..3 {
                force[axis] += push.force_lb[axis];
                moment[axis] += push.moment_ft_lb[axis];
            }
        }
        aircraft.fed.propulsion(model, &mut self.state, force, moment);
        force_moment(force, moment)
    }

    /// Runs systems, autopilots and flight control once, in the order of the files, and then adds `step_s`, the time since they
    /// ran last, s, to the time that they see (`simulation/sim-time-sec`). Of forces they see those that were computed last.
    /// Without a call of this, surfaces stay where they are set.
    pub fn step_channels(&mut self, step_s: f64) {
        self.run_channels(step_s, true);
        self.aircraft.fed.end_step(&self.aircraft.model, &mut self.state, step_s);
    }

    /// Runs systems, autopilots and flight control once at an initial condition, as JSBSim does (twice) before its first step: all
    /// channels run, also those that run in one of several steps, and time stands still. `step_s` is the step to come, s.
    pub fn start_channels(&mut self, step_s: f64) {
        self.run_channels(step_s, false);
    }

    fn run_channels(&mut self, step_s: f64, counted: bool) {
        let aircraft = self.aircraft;
        aircraft.fed.begin_step(&aircraft.model, &mut self.state, step_s);
        aircraft.channels.step(&aircraft.model, &mut self.state, &mut self.memories, step_s, counted);
    }

    /// Makes systems, autopilots and flight control forget what they did; properties stay as they are.
    pub fn reset_channels(&mut self) {
        self.memories = self.aircraft.channels.memories();
    }
}
