//! The aerodynamics of an aircraft as a program of the flight condition and of the angles of three surfaces.

use super::super::aircraft::Aircraft;
use super::super::compiled::{FlightInputs, force_moment};
use super::super::evaluator::{Evaluator, ForceMoment};
use super::super::flight::FlightCondition;
use super::super::function::Action;
use super::super::program::{Instruction, Program, Register, Registers};
use super::super::scaling::Follower;
use super::super::symbolic::{Name, Symbolic};
use super::{Aerodynamics, Frame, Turn, add, transposed_row};

/// Where the outputs of the program begin: sums of the axes, of the forces at the centre of gravity, shift of the reference point.
const AXES: usize = 0;
const AT_CENTRE: usize = 6;
const SHIFT: usize = 9;

/// The aerodynamics where everything but the flight condition and the angles of the surfaces stays as it is.
///
/// Forces follow from these alone: what an [`Evaluator`] would take from the call before is what it was
/// at the beginning.
#[derive(Debug, Clone)]
pub(crate) struct CompiledAerodynamics {
    program: Program,
    flight: FlightInputs,
    surfaces: [Option<Register>; 3],
    outputs: Vec<Register>,
    /// The square of the lift coefficient, its value before the lift is known, and what depends on it.
    cl_squared: Option<(Register, f64, Vec<Instruction>)>,
    /// The rate of the angle of attack in rad/s and in deg/s, and what depends on it.
    alpha_rate: [Option<Register>; 2],
    by_alpha_rate: Vec<Instruction>,
    /// Whether forces or moments turn with the angles of attack or sideslip.
    turns: bool,
    centre_in: [f64; 3],
}

/// What a thread needs to evaluate [`CompiledAerodynamics`].
#[derive(Debug)]
pub(crate) struct AerodynamicWorkspace {
    registers: Registers,
    turn: Turn,
    qbar_psf: f64,
}

impl Aircraft {
    /// The aerodynamics at what an evaluator of the aircraft holds. `surfaces` are the properties that follow the angles of three surfaces.
    pub(crate) fn compile_aerodynamics(
        &self,
        evaluator: &Evaluator<'_>,
        surfaces: [&[Follower]; 3],
    ) -> CompiledAerodynamics {
        let model = &self.model;
        let (state, centre_in) = self.weighed(evaluator);
        let aerodynamics = &self.aerodynamics;
        let own = &aerodynamics.p;
        let mut symbolic = Symbolic::new(model, &state);
        let flight: Vec<Name> = self.flight.indices().iter().map(|_| symbolic.input()).collect();
        for (&index, &name) in self.flight.indices().iter().zip(&flight) {
            symbolic.write(index, name);
        }
        let angles = surfaces.map(|followers| {
            let angle = symbolic.input();
            for follower in followers {
                follower.follow(&mut symbolic, angle);
            }
            angle
        });
        let cl_squared = symbolic.input();
        if own.reads_cl_squared {
            symbolic.write(own.cl_squared, cl_squared);
        }
        let (qbar, area) = (symbolic.read(own.qbar), symbolic.constant(self.metrics.area_ft2));
        let qbar_area = symbolic.apply(Action::Product, &[qbar, area]);
        symbolic.write(own.qbar_area, qbar_area);
        aerodynamics.stall_by_name(&mut symbolic);
        symbolic.hold(&aerodynamics.before);
        let lists = aerodynamics.axes[..3].iter().chain(&aerodynamics.at_centre);
        let forces: Vec<Name> = lists.map(|functions| symbolic.total(functions)).collect();
        let shift = aerodynamics.shift.map(|shift| symbolic.call(shift));
        let moments: Vec<Name> = aerodynamics.axes[3..].iter().map(|functions| symbolic.total(functions)).collect();
        let mut outputs = [&forces[..3], moments.as_slice(), &forces[3..]].concat();
        outputs.extend(shift);

        let inputs = [flight.as_slice(), &angles, &[cl_squared]].concat();
        let (program, inputs, outputs) = symbolic.program(&inputs, &outputs);
        let (of_flight, others) = inputs.split_at(flight.len());
        let place = |name: &str| self.property(name).and_then(|index| self.flight.place(index));
        let alpha_rate = ["aero/alphadot-rad_sec", "aero/alphadot-deg_sec"]
            .map(|name| place(name).and_then(|place| of_flight[place]));
        let changed: Vec<Register> = alpha_rate.into_iter().flatten().collect();
        let turned = |frame: Frame| matches!(frame, Frame::Stability | Frame::Wind);
        CompiledAerodynamics {
            flight: FlightInputs::new(of_flight),
            surfaces: [others[0], others[1], others[2]],
            outputs,
            cl_squared: others[3]
                .map(|register| (register, state.held_by(own.cl_squared), program.depending_on(&[register]))),
            alpha_rate,
            by_alpha_rate: program.depending_on(&changed),
            turns: turned(aerodynamics.forces) || turned(aerodynamics.moments) || others[3].is_some(),
            program,
            centre_in,
        }
    }
}

impl Aerodynamics {
    /// Stall warning and hysteresis, the latter as if the angle of attack had come from below its limits.
    fn stall_by_name(&self, symbolic: &mut Symbolic<'_>) {
        let own = &self.p;
        let alpha = symbolic.read(own.alpha);
        let [zero, one] = [0.0, 1.0].map(|value| symbolic.constant(value));
        if let Some([_, most]) = self.stall_limits
            && most != 0.0
        {
            let [begin, most, share, scale] = [0.85 * most, most, 0.85, 10.0].map(|value| symbolic.constant(value));
            let ratio = symbolic.apply(Action::Quotient, &[alpha, most]);
            let above = symbolic.apply(Action::Difference, &[ratio, share]);
            let strength = symbolic.apply(Action::Product, &[scale, above]);
            let warns = symbolic.apply(Action::Gt, &[alpha, begin]);
            let warning = symbolic.apply(Action::IfThen, &[warns, strength, zero]);
            symbolic.write(own.stall_warning, warning);
        }
        symbolic.write(own.stall_hysteresis, zero);
        if let Some([least, most]) = self.hysteresis_limits
            && least != 0.0
            && most != 0.0
        {
            let most = symbolic.constant(most);
            let stalled = symbolic.apply(Action::Gt, &[alpha, most]);
            let hysteresis = symbolic.apply(Action::IfThen, &[stalled, one, zero]);
            symbolic.write(own.stall_hysteresis, hysteresis);
        }
    }
}

impl CompiledAerodynamics {
    /// What one thread needs.
    pub(crate) fn workspace(&self) -> AerodynamicWorkspace {
        AerodynamicWorkspace { registers: self.program.registers(), turn: Turn([(0.0, 1.0); 2]), qbar_psf: 0.0 }
    }

    /// Whether the heights of the flight condition are read.
    pub(crate) fn reads_height(&self) -> bool {
        self.flight.wanted().height
    }

    /// Force and moment at a flight condition and at angles of the surfaces, rad.
    pub(crate) fn run(
        &self,
        aircraft: &Aircraft,
        workspace: &mut AerodynamicWorkspace,
        flight: &FlightCondition,
        angles: [f64; 3],
    ) -> ForceMoment {
        workspace.qbar_psf = self.flight.set(&mut workspace.registers, flight, &aircraft.metrics, self.centre_in);
        if self.turns {
            workspace.turn = Turn::new(flight.alpha_rad, flight.beta_rad);
        }
        for (register, angle) in self.surfaces.iter().zip(angles) {
            if let Some(register) = register {
                workspace.registers.values[*register as usize] = angle;
            }
        }
        if let Some((register, value, _)) = self.cl_squared {
            workspace.registers.values[register as usize] = value;
        }
        self.program.run(&mut workspace.registers);
        self.finish(aircraft, workspace)
    }

    /// Force and moment where the last run of a workspace was, with another rate of the angle of attack, rad/s.
    pub(crate) fn with_alpha_rate(
        &self,
        aircraft: &Aircraft,
        workspace: &mut AerodynamicWorkspace,
        rate: f64,
    ) -> ForceMoment {
        for (register, value) in self.alpha_rate.iter().zip([rate, rate.to_degrees()]) {
            if let Some(register) = register {
                workspace.registers.values[*register as usize] = value;
            }
        }
        self.program.run_some(&self.by_alpha_rate, &mut workspace.registers);
        self.finish(aircraft, workspace)
    }

    /// Puts together what the program gave.
    fn finish(&self, aircraft: &Aircraft, workspace: &mut AerodynamicWorkspace) -> ForceMoment {
        let AerodynamicWorkspace { registers, turn, qbar_psf } = workspace;
        let (aerodynamics, metrics) = (&aircraft.aerodynamics, &aircraft.metrics);
        let three = |registers: &Registers, start: usize| -> [f64; 3] {
            std::array::from_fn(|k| registers.values[self.outputs[start + k] as usize])
        };
        let forces =
            |registers: &Registers| [AXES, AT_CENTRE].map(|start| aerodynamics.to_body(three(registers, start), turn));
        let mut force = forces(registers);
        if let Some((register, _, instructions)) = &self.cl_squared
            && *qbar_psf > 1.0
        {
            let lift = -transposed_row(&turn.of_wind(), 2, add(force[0], force[1]));
            registers.values[*register as usize] = (lift / (metrics.area_ft2 * *qbar_psf)).powi(2);
            self.program.run_some(instructions, registers);
            force = forces(registers);
        }
        let shift = self.outputs.get(SHIFT).map(|&register| registers.values[register as usize]);
        let given = three(registers, AXES + 3);
        let sum = aerodynamics.about_centre([force[0], force[1], given], shift, turn, metrics, self.centre_in);
        force_moment(sum.force, sum.moment)
    }
}
