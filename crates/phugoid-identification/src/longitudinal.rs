//! The longitudinal motion of an aircraft as a model for the estimators.

use phugoid_estimators::{Input, LinearizedOutputs, LinearizedRates, Model};
use phugoid_flight_dynamics::f16::F16;
use phugoid_flight_dynamics::longitudinal::{
    LongitudinalLoads, LongitudinalMotion, LongitudinalState, longitudinal_motion,
};
use phugoid_flight_dynamics::scalar::{Dual, Scalar};

use crate::output::{OUTPUTS, Output, STATES};
use crate::term::{Coefficient, EXTRA_INPUTS, FACTORS, Term};

/// What is known of the flight at one instant beside the state.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LongitudinalInput {
    /// Elevator, rad, positive trailing edge down.
    pub elevator: f64,
    /// Air density, kg/m^3.
    pub air_density: f64,
    /// Thrust, N.
    pub thrust: f64,
    /// Mass, kg.
    pub mass: f64,
    /// Moment of inertia about body y, kg m^2.
    pub iyy: f64,
    /// The model file's extra inputs, in its order.
    pub extra: [f64; EXTRA_INPUTS],
    /// True if elevator and extra inputs are held until the next sample, as a digital command is; false if they run
    /// straight to it, as a recorded surface does. All else always runs straight.
    pub controls_held: bool,
}

impl Input for LongitudinalInput {
    #[inline]
    fn interpolate(&self, other: &Self, s: f64) -> Self {
        let between = |a: f64, b: f64| a + s * (b - a);
        let control = |a: f64, b: f64| if self.controls_held { a } else { between(a, b) };
        Self {
            elevator: control(self.elevator, other.elevator),
            air_density: between(self.air_density, other.air_density),
            thrust: between(self.thrust, other.thrust),
            mass: between(self.mass, other.mass),
            iyy: between(self.iyy, other.iyy),
            extra: std::array::from_fn(|i| control(self.extra[i], other.extra[i])),
            controls_held: self.controls_held,
        }
    }
}

/// The known part of the aerodynamics.
#[derive(Clone, Debug)]
pub enum Database {
    /// None: the terms are the whole build-up.
    None,
    /// The F-16 of Stevens & Lewis, with its centre of gravity.
    F16(Box<F16>),
}

impl Database {
    /// `(CL, CD, Cm)` from the angle of attack (rad), `q cbar/2V` with the actual speed, and the elevator (rad).
    #[inline(always)]
    pub(crate) fn coefficients<T: Scalar>(&self, alpha: T, q_hat: T, elevator: T) -> [T; 3] {
        match self {
            Self::None => [T::from(0.0); 3],
            Self::F16(aircraft) => {
                let (cx, cz, cm) = aircraft.longitudinal_coefficients(alpha, q_hat, elevator);
                let (sin, cos) = alpha.sin_cos();
                // Body axes to wind axes, without sideslip.
                [cx * sin - cz * cos, -(cx * cos + cz * sin), cm]
            }
        }
    }
}

/// Constants of the aircraft that [`LongitudinalModel`] needs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LongitudinalConstants {
    /// Wing reference area, m^2.
    pub wing_area: f64,
    /// Mean aerodynamic chord, m.
    pub mean_chord: f64,
    /// Acceleration of gravity, m/s^2.
    pub gravity: f64,
    /// Angle of the thrust line above body x, rad.
    pub thrust_inclination: f64,
    /// Pitching moment per newton of thrust, m, positive nose up.
    pub thrust_arm: f64,
    /// Speed that makes `v_hat = V / V0`, m/s.
    pub reference_speed: f64,
    /// Speed that normalises the pitch rate of the terms, m/s; none: the actual speed.
    pub rate_speed: Option<f64>,
    /// Angle of attack at which the terms' `alpha` is zero, rad.
    pub alpha_reference: f64,
    /// Elevator at which the terms' `elevator` is zero, rad.
    pub elevator_reference: f64,
}

/// Longitudinal motion: states `V, alpha, theta, q`, outputs as in [`Output`].
///
/// ```text
/// C_k = database + sum_j theta_j r_j(alpha, q_hat, v_hat, elevator, ...)      k = L, D, m
/// X = qbar S (CL sin a - CD cos a) + T cos s      Z = -qbar S (CL cos a + CD sin a) - T sin s
/// M = qbar S cbar Cm + T l                        (wind axes to body axes; s, l: thrust line)
/// ```
///
/// so that CD moves only the speed, CL only the angle of attack and Cm only the pitch rate. Linear in the parameters;
/// the derivatives with respect to the state are exact (forward mode).
#[derive(Clone, Debug)]
pub struct LongitudinalModel {
    constants: LongitudinalConstants,
    thrust_direction: [f64; 2],
    database: Database,
    known: Vec<(Coefficient, Term, f64)>,
    columns: Vec<(Coefficient, Term)>,
}

impl LongitudinalModel {
    /// A model with estimated `columns` (the parameter vector's order) and `known` terms with their values.
    pub fn new(
        constants: LongitudinalConstants,
        database: Database,
        columns: Vec<(Coefficient, Term)>,
        known: Vec<(Coefficient, Term, f64)>,
    ) -> Self {
        let (sin, cos) = constants.thrust_inclination.sin_cos();
        Self { constants, thrust_direction: [cos, -sin], database, known, columns }
    }

    /// The estimated terms in the order of the parameter vector.
    pub fn columns(&self) -> &[(Coefficient, Term)] {
        &self.columns
    }

    /// Flight variables of the terms, see [`crate::term::factor_names`].
    #[inline(always)]
    fn factors<T: Scalar>(&self, x: &[T; STATES], u: &LongitudinalInput) -> [T; FACTORS] {
        let c = &self.constants;
        let q_hat = match c.rate_speed {
            Some(speed) => x[3] * (0.5 * c.mean_chord / speed),
            None => x[3] * (0.5 * c.mean_chord) / x[0],
        };
        let mut factors = [T::from(0.0); FACTORS];
        factors[0] = x[1] - c.alpha_reference;
        factors[1] = q_hat;
        factors[2] = x[0] * (1.0 / c.reference_speed);
        factors[3] = T::from(u.elevator - c.elevator_reference);
        for (factor, extra) in factors[4..].iter_mut().zip(&u.extra) {
            *factor = T::from(*extra);
        }
        factors
    }

    /// `CL, CD, Cm` with the known and the estimated terms.
    #[inline(always)]
    fn coefficients<T: Scalar, const P: usize>(
        &self,
        x: &[T; STATES],
        theta: &[f64; P],
        u: &LongitudinalInput,
        factors: &[T; FACTORS],
    ) -> [T; 3] {
        let mut total = match self.database {
            Database::None => [T::from(0.0); 3],
            ref database => {
                let q_hat = x[3] * (0.5 * self.constants.mean_chord) / x[0];
                database.coefficients(x[1], q_hat, T::from(u.elevator))
            }
        };
        for (coefficient, term, value) in &self.known {
            let sum = &mut total[*coefficient as usize];
            *sum = *sum + term.value(factors) * *value;
        }
        for ((coefficient, term), value) in self.columns.iter().zip(theta) {
            let sum = &mut total[*coefficient as usize];
            *sum = *sum + term.value(factors) * *value;
        }
        total
    }

    #[inline(always)]
    fn motion<T: Scalar>(&self, x: &[T; STATES], u: &LongitudinalInput, [cl, cd, cm]: [T; 3]) -> LongitudinalMotion<T> {
        let c = &self.constants;
        let [speed, alpha, theta, q] = *x;
        let force = speed * speed * (0.5 * u.air_density * c.wing_area);
        let (sin, cos) = alpha.sin_cos();
        let thrust = u.thrust;
        let loads = LongitudinalLoads {
            force_x: force * (cl * sin - cd * cos) + thrust * self.thrust_direction[0],
            force_z: -(force * (cl * cos + cd * sin)) + thrust * self.thrust_direction[1],
            pitching_moment: force * cm * c.mean_chord + thrust * c.thrust_arm,
        };
        let state = LongitudinalState { speed, alpha, theta, q };
        longitudinal_motion(&state, &loads, u.mass, u.iyy, c.gravity)
    }

    /// The output vector, see [`Output`].
    #[inline(always)]
    fn outputs<T: Scalar>(x: &[T; STATES], motion: &LongitudinalMotion<T>) -> [T; OUTPUTS] {
        [x[0], x[1], x[2], x[3], motion.specific_force_x, motion.specific_force_z, motion.rates.q]
    }
}

fn to_array<T: Copy>(rates: &LongitudinalState<T>) -> [T; STATES] {
    [rates.speed, rates.alpha, rates.theta, rates.q]
}

fn variables(x: &[f64; STATES]) -> [Dual<STATES>; STATES] {
    std::array::from_fn(|i| Dual::variable(x[i], i))
}

impl<const P: usize> Model<STATES, OUTPUTS, P> for LongitudinalModel {
    type Input = LongitudinalInput;

    fn parameter_count(&self) -> usize {
        self.columns.len().min(P)
    }

    fn rates(&self, x: &[f64; STATES], theta: &[f64; P], u: &Self::Input) -> [f64; STATES] {
        let factors = self.factors(x, u);
        let coefficients = self.coefficients(x, theta, u, &factors);
        to_array(&self.motion(x, u, coefficients).rates)
    }

    fn linearized_rates(
        &self,
        x: &[f64; STATES],
        theta: &[f64; P],
        u: &Self::Input,
        out: &mut LinearizedRates<STATES, P>,
    ) {
        let dual = variables(x);
        let factors = self.factors(&dual, u);
        let coefficients = self.coefficients(&dual, theta, u, &factors);
        let rates = to_array(&self.motion(&dual, u, coefficients).rates);
        for i in 0..STATES {
            out.rates[i] = rates[i].value;
            out.state_jacobian[i] = rates[i].derivatives;
        }
        let force = 0.5 * u.air_density * self.constants.wing_area * x[0] * x[0];
        let values = factors.map(|f| f.value);
        let per_coefficient = [-force / (u.mass * x[0]), -force / u.mass, force * self.constants.mean_chord / u.iyy];
        for (j, (coefficient, term)) in self.columns.iter().take(P).enumerate() {
            let mut entry = [0.0; STATES];
            let state = match coefficient {
                Coefficient::Lift => 1,
                Coefficient::Drag => 0,
                Coefficient::PitchingMoment => 3,
            };
            entry[state] = per_coefficient[*coefficient as usize] * term.value(&values);
            for i in 0..STATES {
                out.regressors[i][j] = entry[i];
            }
        }
    }

    fn linearized_outputs(
        &self,
        x: &[f64; STATES],
        theta: &[f64; P],
        u: &Self::Input,
        out: &mut LinearizedOutputs<STATES, OUTPUTS, P>,
    ) {
        let dual = variables(x);
        let factors = self.factors(&dual, u);
        let coefficients = self.coefficients(&dual, theta, u, &factors);
        let outputs = Self::outputs(&dual, &self.motion(&dual, u, coefficients));
        for i in 0..OUTPUTS {
            out.outputs[i] = outputs[i].value;
            out.state_jacobian[i] = outputs[i].derivatives;
        }
        let force = 0.5 * u.air_density * self.constants.wing_area * x[0] * x[0];
        let specific = force / u.mass;
        let angular = force * self.constants.mean_chord / u.iyy;
        let (sin, cos) = x[1].sin_cos();
        let values = factors.map(|f| f.value);
        for (j, (coefficient, term)) in self.columns.iter().take(P).enumerate() {
            let mut entry = [0.0; OUTPUTS];
            let r = term.value(&values);
            match coefficient {
                Coefficient::Lift => {
                    entry[Output::Ax.index()] = specific * sin * r;
                    entry[Output::Az.index()] = -specific * cos * r;
                }
                Coefficient::Drag => {
                    entry[Output::Ax.index()] = -specific * cos * r;
                    entry[Output::Az.index()] = -specific * sin * r;
                }
                Coefficient::PitchingMoment => {
                    entry[Output::PitchAcceleration.index()] = angular * r;
                }
            }
            for i in 0..OUTPUTS {
                out.parameter_jacobian[i][j] = entry[i];
            }
        }
    }

    fn measuring_output(&self, state: usize) -> Option<usize> {
        (state < STATES).then_some(state)
    }
}
