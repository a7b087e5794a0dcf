//! Linear models about a flight condition, with exact derivatives.
//!
//! ```text
//! x' = f0 + A (x - x0) + B (u - u0),     y = y0 + C (x - x0) + D (u - u0)
//! ```
//!
//! The derivatives come from forward-mode dual numbers through the same equations that are simulated, in one pass. The
//! tables are piecewise linear: on a table point the derivatives are those of the cell that the look-up takes there.

use serde::Serialize;

use crate::aircraft::{Aircraft, Controls, STATES, State};
use crate::modes::{Mode, ModesError, lateral_modes, longitudinal_modes};
use crate::motion::{Disturbance, motion};
use crate::scalar::Dual;

/// Number of controls: throttle, elevator, aileron, rudder.
pub const INPUTS: usize = 4;
/// Number of outputs: the specific force at the centre of gravity along body x, y, z.
pub const OUTPUTS: usize = 3;

/// Names of the states with their units, in the order of [`State::to_array`].
pub const STATE_NAMES: [&str; STATES] = [
    "speed_m_s",
    "alpha_rad",
    "beta_rad",
    "phi_rad",
    "theta_rad",
    "psi_rad",
    "p_rad_s",
    "q_rad_s",
    "r_rad_s",
    "north_m",
    "east_m",
    "altitude_m",
    "power_percent",
];
/// Names of the controls with their units.
pub const INPUT_NAMES: [&str; INPUTS] = ["throttle", "elevator_rad", "aileron_rad", "rudder_rad"];
/// Names of the outputs with their units.
pub const OUTPUT_NAMES: [&str; OUTPUTS] = ["ax_m_s2", "ay_m_s2", "az_m_s2"];

// Places in the lists above.
const POWER: usize = 12;
const THROTTLE: usize = 0;
const LONGITUDINAL_STATES: [usize; 4] = [0, 1, 4, 7];
const LATERAL_STATES: [usize; 4] = [2, 3, 6, 8];

/// The linear model with all states, inputs and outputs. Rows are equations, columns variables.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LinearModel {
    /// Names of the states, rows and columns of A.
    pub states: [&'static str; STATES],
    /// Names of the inputs, columns of B and D.
    pub inputs: [&'static str; INPUTS],
    /// Names of the outputs, rows of C and D.
    pub outputs: [&'static str; OUTPUTS],
    /// Rates of the states at the reference, `f0`; zero at a trim but for heading, position and, climbing, altitude.
    pub rates: [f64; STATES],
    /// Outputs at the reference, `y0`, m/s^2.
    pub output_values: [f64; OUTPUTS],
    /// State matrix `A`: rates (rows) by states (columns), each in its own unit per second.
    #[serde(rename = "A")]
    pub a: [[f64; STATES]; STATES],
    /// Input matrix `B`: rates (rows) by inputs (columns).
    #[serde(rename = "B")]
    pub b: [[f64; INPUTS]; STATES],
    /// Output matrix `C`: outputs (rows) by states (columns).
    #[serde(rename = "C")]
    pub c: [[f64; STATES]; OUTPUTS],
    /// Direct input matrix `D`: outputs (rows) by inputs (columns).
    #[serde(rename = "D")]
    pub d: [[f64; INPUTS]; OUTPUTS],
    /// Change of the settled engine state per unit of throttle, percent.
    pub steady_power_per_throttle: f64,
}

/// A part of the linear model: four states and two inputs of one plane of motion, the other states held.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SubModel {
    /// Names of the four states with their units, the order of the rows of `A` and `B`.
    pub states: [&'static str; 4],
    /// Names of the two inputs with their units, the order of the columns of `B` and `D`.
    pub inputs: [&'static str; 2],
    /// Names of the outputs, rows of C and D.
    pub outputs: Vec<&'static str>,
    /// State matrix `A`: rates (rows) by states (columns), each in its own unit per second.
    #[serde(rename = "A")]
    pub a: [[f64; 4]; 4],
    /// Input matrix `B`: rates (rows) by inputs (columns).
    #[serde(rename = "B")]
    pub b: [[f64; 2]; 4],
    /// Output matrix `C`: outputs (rows) by states (columns).
    #[serde(rename = "C")]
    pub c: Vec<[f64; 4]>,
    /// Direct input matrix `D`: outputs (rows) by inputs (columns).
    #[serde(rename = "D")]
    pub d: Vec<[f64; 2]>,
    /// Natural modes of `A`, the fastest first.
    pub modes: Vec<Mode>,
}

/// The linear model about any state and controls, trimmed or not, under a constant disturbance. Units: SI and radians,
/// power in percent, throttle 0 to 1.
///
/// ```
/// use phugoid_flight_dynamics::f16::{F16, F16Options};
/// use phugoid_flight_dynamics::linearize::linearize;
/// use phugoid_flight_dynamics::motion::Disturbance;
/// use phugoid_flight_dynamics::trim::{TrimCondition, trim};
///
/// let aircraft = F16::new(F16Options { cg: 0.30, ..F16Options::default() })?;
/// let steady = trim(&aircraft, &TrimCondition::steady(&aircraft, 205.74, 6096.0, 0.0, 0.0))?;
/// let model = linearize(&aircraft, &steady.state(), &steady.controls(), &Disturbance::default());
/// // In trim nothing changes but the position, and the nose goes down with the elevator.
/// assert!(model.rates[..9].iter().all(|rate| rate.abs() < 1e-10));
/// let longitudinal = model.longitudinal()?;
/// assert_eq!(longitudinal.states, ["speed_m_s", "alpha_rad", "theta_rad", "q_rad_s"]);
/// assert!(longitudinal.b[3][0] < 0.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn linearize<A: Aircraft>(
    aircraft: &A,
    state: &State,
    controls: &Controls,
    disturbance: &Disturbance,
) -> LinearModel {
    const VARIABLES: usize = STATES + INPUTS;
    let x = state.to_array();
    let u = [controls.throttle, controls.elevator, controls.aileron, controls.rudder];
    let input = |i: usize| Dual::<VARIABLES>::variable(u[i], STATES + i);
    let dual_state = State::from_array(core::array::from_fn(|i| Dual::<VARIABLES>::variable(x[i], i)));
    let dual_controls = Controls { throttle: input(0), elevator: input(1), aileron: input(2), rudder: input(3) };
    let motion = motion(aircraft, &dual_state, &dual_controls, disturbance);
    let rates = motion.rates.to_array();
    let outputs = motion.specific_force;
    let power = aircraft.steady_power(Dual::<1>::variable(controls.throttle, 0));
    LinearModel {
        states: STATE_NAMES,
        inputs: INPUT_NAMES,
        outputs: OUTPUT_NAMES,
        rates: rates.map(|r| r.value),
        output_values: outputs.map(|y| y.value),
        a: rates.map(|r| core::array::from_fn(|j| r.derivatives[j])),
        b: rates.map(|r| core::array::from_fn(|j| r.derivatives[STATES + j])),
        c: outputs.map(|y| core::array::from_fn(|j| y.derivatives[j])),
        d: outputs.map(|y| core::array::from_fn(|j| y.derivatives[STATES + j])),
        steady_power_per_throttle: power.derivatives[0],
    }
}

impl LinearModel {
    /// States speed, alpha, theta, q; inputs elevator and throttle; outputs ax and az. The engine is taken to follow the
    /// throttle at once (its lag is not among the four states), the altitude to stay.
    ///
    /// # Errors
    /// [`ModesError`] when the matrix has no eigenvalues to give.
    pub fn longitudinal(&self) -> Result<SubModel, ModesError> {
        let a = self.state_block(LONGITUDINAL_STATES);
        let settled = |direct: f64, power: f64| direct + power * self.steady_power_per_throttle;
        let rows = [0, 2];
        Ok(SubModel {
            states: LONGITUDINAL_STATES.map(|i| STATE_NAMES[i]),
            inputs: [INPUT_NAMES[1], INPUT_NAMES[THROTTLE]],
            outputs: rows.map(|i| OUTPUT_NAMES[i]).to_vec(),
            a,
            b: LONGITUDINAL_STATES.map(|i| [self.b[i][1], settled(self.b[i][THROTTLE], self.a[i][POWER])]),
            c: rows.map(|i| LONGITUDINAL_STATES.map(|j| self.c[i][j])).to_vec(),
            d: rows.map(|i| [self.d[i][1], settled(self.d[i][THROTTLE], self.c[i][POWER])]).to_vec(),
            modes: longitudinal_modes(&a)?,
        })
    }

    /// States beta, phi, p, r; inputs aileron and rudder; output ay. An aircraft that nothing rolls or yaws has no lateral modes.
    ///
    /// # Errors
    /// [`ModesError`] when the matrix has no eigenvalues to give.
    pub fn lateral(&self) -> Result<SubModel, ModesError> {
        let a = self.state_block(LATERAL_STATES);
        // Rows of roll and yaw acceleration.
        let turns = a.iter().skip(2).flatten().any(|value| *value != 0.0);
        Ok(SubModel {
            states: LATERAL_STATES.map(|i| STATE_NAMES[i]),
            inputs: [INPUT_NAMES[2], INPUT_NAMES[3]],
            outputs: vec![OUTPUT_NAMES[1]],
            a,
            b: LATERAL_STATES.map(|i| [self.b[i][2], self.b[i][3]]),
            c: vec![LATERAL_STATES.map(|j| self.c[1][j])],
            d: vec![[self.d[1][2], self.d[1][3]]],
            modes: if turns { lateral_modes(&a)? } else { Vec::new() },
        })
    }

    fn state_block(&self, states: [usize; 4]) -> [[f64; 4]; 4] {
        states.map(|i| states.map(|j| self.a[i][j]))
    }
}
