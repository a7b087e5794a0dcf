//! What programs of the aerodynamics and of the engines have in common, and the program of the engines.

use super::aircraft::Aircraft;
use super::evaluator::{Evaluator, ForceMoment};
use super::flight::{FlightCondition, FlightProperties, Known, Wanted};
use super::function::Action;
use super::mass::Metrics;
use super::model::State;
use super::program::{Program, Register, Registers};
use super::propulsion::{Guess, INPUTS, Source};
use super::scaling::Follower;
use super::symbolic::{Name, Symbolic};
use super::units::{FOOT, POUND_FORCE};

/// The properties of a flight condition that a program reads.
#[derive(Debug, Clone)]
pub(super) struct FlightInputs {
    /// Place among the values of a flight condition, and register.
    registers: Vec<(usize, Register)>,
    wanted: Wanted,
}

impl FlightInputs {
    /// From the registers of all properties, with none for those that are not read.
    pub(super) fn new(registers: &[Option<Register>]) -> Self {
        let registers: Vec<_> =
            registers.iter().enumerate().filter_map(|(place, register)| Some((place, (*register)?))).collect();
        Self { wanted: FlightProperties::wanted(registers.iter().map(|(place, _)| *place)), registers }
    }

    /// What is to be computed.
    pub(super) fn wanted(&self) -> &Wanted {
        &self.wanted
    }

    /// Sets the registers; gives the dynamic pressure, pounds per square foot.
    #[inline]
    pub(super) fn set(
        &self,
        registers: &mut Registers,
        flight: &FlightCondition,
        metrics: &Metrics,
        centre_in: [f64; 3],
    ) -> f64 {
        let known = Known::new(flight, metrics, centre_in, &self.wanted);
        for &(place, register) in &self.registers {
            registers.values[register as usize] = known.value(place);
        }
        known.qbar()
    }
}

/// Force in pounds and moment in foot pounds, in SI.
pub(super) fn force_moment(force_lb: [f64; 3], moment_ft_lb: [f64; 3]) -> ForceMoment {
    ForceMoment {
        force_n: force_lb.map(|pounds| pounds * POUND_FORCE),
        moment_n_m: moment_ft_lb.map(|foot_pounds| foot_pounds * POUND_FORCE * FOOT),
    }
}

impl Follower {
    /// Writes its property for an angle.
    pub(super) fn follow(&self, symbolic: &mut Symbolic<'_>, angle: Name) {
        let mut x = angle;
        for factor in self.factors {
            let factor = symbolic.constant(factor);
            x = symbolic.apply(Action::Product, &[factor, x]);
        }
        if let Some(scaling) = &self.scaling {
            let ([low, high], [least, most]) = (scaling.domain, scaling.range);
            if scaling.centred {
                let zero = symbolic.constant(0.0);
                let [below, above] = [[least, low], [most, high]].map(|pair| {
                    let [end, at] = pair.map(|value| symbolic.constant(value));
                    let product = symbolic.apply(Action::Product, &[end, x]);
                    symbolic.apply(Action::Quotient, &[product, at])
                });
                let negative = symbolic.apply(Action::Lt, &[x, zero]);
                x = symbolic.apply(Action::IfThen, &[negative, below, above]);
            } else {
                let [least, span, low, width] =
                    [least, most - least, low, high - low].map(|value| symbolic.constant(value));
                let from = symbolic.apply(Action::Difference, &[x, low]);
                let product = symbolic.apply(Action::Product, &[span, from]);
                let share = symbolic.apply(Action::Quotient, &[product, width]);
                x = symbolic.apply(Action::Sum, &[least, share]);
            }
        }
        symbolic.write(self.property, x);
    }
}

/// The engines where everything but the flight condition and some throttles stays as it is.
#[derive(Debug, Clone)]
pub(crate) struct CompiledPropulsion {
    program: Program,
    flight: FlightInputs,
    throttles: Vec<Option<Register>>,
    /// What each engine reads, in its order.
    engines: Vec<Vec<Register>>,
    centre_in: [f64; 3],
}

/// What a thread needs to evaluate [`CompiledPropulsion`].
#[derive(Debug)]
pub(crate) struct PropulsiveWorkspace {
    registers: Registers,
    guesses: Vec<Guess>,
}

impl Aircraft {
    /// What an evaluator holds with the weight that follows from it, and the centre of gravity, inches in the structural frame.
    pub(super) fn weighed(&self, evaluator: &Evaluator<'_>) -> (State, [f64; 3]) {
        let mut state = evaluator.state.clone();
        let (_, centre_in) = self.fed.weight(&self.model, &mut state, &self.masses);
        (state, centre_in)
    }

    /// The engines at what an evaluator of the aircraft holds. `throttles` are the properties that are set at each run.
    pub(crate) fn compile_propulsion(&self, evaluator: &Evaluator<'_>, throttles: &[usize]) -> CompiledPropulsion {
        let model = &self.model;
        let (state, centre_in) = self.weighed(evaluator);
        let mut symbolic = Symbolic::new(model, &state);
        let mut inputs: Vec<Name> = Vec::new();
        for &index in self.flight.indices().iter().chain(throttles) {
            let name = symbolic.input();
            symbolic.write(index, name);
            inputs.push(name);
        }
        let mut outputs = Vec::new();
        for source in self.engines.iter().flat_map(|engine| engine.sources()) {
            outputs.push(match source {
                Source::Property(index) => symbolic.read(index),
                Source::Function(function) => symbolic.call(function),
            });
        }
        let (program, inputs, outputs) = symbolic.program(&inputs, &outputs);
        let (of_flight, of_throttles) = inputs.split_at(self.flight.indices().len());
        let mut outputs = outputs.into_iter();
        let engines =
            self.engines.iter().map(|engine| outputs.by_ref().take(engine.sources().count()).collect()).collect();
        CompiledPropulsion {
            flight: FlightInputs::new(of_flight),
            throttles: of_throttles.to_vec(),
            engines,
            program,
            centre_in,
        }
    }
}

impl CompiledPropulsion {
    /// What one thread needs.
    pub(crate) fn workspace(&self) -> PropulsiveWorkspace {
        PropulsiveWorkspace { registers: self.program.registers(), guesses: vec![Guess::default(); self.engines.len()] }
    }

    /// Force and moment of the engines at a flight condition and at the throttles in their order. No thrust of an engine and no
    /// speed of a propeller is set.
    pub(crate) fn run(
        &self,
        aircraft: &Aircraft,
        workspace: &mut PropulsiveWorkspace,
        flight: &FlightCondition,
        throttles: impl Iterator<Item = f64>,
    ) -> ForceMoment {
        let PropulsiveWorkspace { registers, guesses } = workspace;
        self.flight.set(registers, flight, &aircraft.metrics, self.centre_in);
        for (register, throttle) in self.throttles.iter().zip(throttles) {
            if let Some(register) = register {
                registers.values[*register as usize] = throttle;
            }
        }
        self.program.run(registers);
        let (mut force, mut moment) = ([0.0; 3], [0.0; 3]);
        for ((engine, sources), guess) in aircraft.engines.iter().zip(&self.engines).zip(guesses) {
            let mut inputs = [0.0; INPUTS];
            for (input, register) in inputs.iter_mut().zip(sources) {
                *input = registers.values[*register as usize];
            }
            let push = engine.push(&inputs, None, self.centre_in, guess);
            for axis in 0..3 {
                force[axis] += push.force_lb[axis];
                moment[axis] += push.moment_ft_lb[axis];
            }
        }
        force_moment(force, moment)
    }
}
