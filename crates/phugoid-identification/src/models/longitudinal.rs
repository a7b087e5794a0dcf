//! The longitudinal motion of an aircraft as a model for the estimators.

mod alpha_rate;
pub(crate) mod constants;
mod terms;

use alpha_rate::AlphaRateTerms;
use phugoid_estimators::{Input, LinearizedOutputs, LinearizedRates, Model, RegressorShift};
use phugoid_flight_dynamics::longitudinal::{
    LongitudinalLoads, LongitudinalMotion, LongitudinalState, longitudinal_motion,
};
use phugoid_flight_dynamics::scalar::{Dual, Scalar};
use terms::{FACTORS, ONE, QuickTerm, Variables, short};

pub use super::database::Database;
use crate::core::scaling::ScalingPowers;
use crate::core::term::{Coefficient, EXTRA_INPUTS, Term};

/// States of the longitudinal motion: true airspeed, angle of attack, pitch angle, pitch rate.
pub const STATES: usize = 4;
/// Outputs: the states, the specific forces along body x and z at the centre of gravity, and the pitch acceleration.
pub const OUTPUTS: usize = 7;

/// Positions in the output vector, those of [`crate::core::axes::Axes::outputs`]; the first four are the states.
pub mod row {
    /// True airspeed, m/s: also the first state.
    pub const TRUE_AIRSPEED: usize = 0;
    /// Angle of attack, rad: also the second state.
    pub const ALPHA: usize = 1;
    /// Pitch angle, rad, positive nose up: also the third state.
    pub const THETA: usize = 2;
    /// Pitch rate about body y, rad/s, positive nose up: also the fourth state.
    pub const PITCH_RATE: usize = 3;
    /// Specific force along body x, m/s^2.
    pub const AX: usize = 4;
    /// Specific force along body z, m/s^2.
    pub const AZ: usize = 5;
    /// Pitch acceleration `q'`, rad/s^2, positive nose up.
    pub const PITCH_ACCELERATION: usize = 6;
}

/// What is known of the flight at one instant beside the state.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LongitudinalInput {
    /// Elevator, rad, positive trailing edge down.
    pub elevator: f64,
    /// Density of the air, kg/m^3.
    pub air_density: f64,
    /// Thrust along the thrust line, N.
    pub thrust: f64,
    /// Mass of the aircraft, kg.
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

/// Constants of the aircraft that [`LongitudinalModel`] needs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LongitudinalConstants {
    /// Wing reference area `S`, m^2.
    pub wing_area: f64,
    /// Mean aerodynamic chord `cbar`, m.
    pub mean_chord: f64,
    /// Acceleration of gravity, m/s^2, positive.
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

/// Longitudinal motion: states `V, alpha, theta, q`, outputs as in [`row`].
///
/// ```text
/// C_k = database + sum_j theta_j r_j(alpha, q_hat, v_hat, elevator, ...)      k = L, D, m
/// X = qbar S (CL sin a - CD cos a) + T cos s      Z = -qbar S (CL cos a + CD sin a) - T sin s
/// M = qbar S cbar Cm + T l                        (wind axes to body axes; s, l: thrust line)
/// ```
///
/// so that CD moves only the speed, CL only the angle of attack and Cm only the pitch rate. Linear in the parameters,
/// unless a term has the rate of the angle of attack: that equation is solved exactly, and the regressors are the
/// derivatives at the parameters asked for;
/// the derivatives with respect to the state are exact. [`Model::rates`] goes through the equations of motion of
/// `phugoid-flight-dynamics`; the linearised forms are worked out by hand in wind axes, because they are evaluated five
/// times per sample on board. Tests hold the two together.
#[derive(Clone, Debug)]
pub struct LongitudinalModel {
    constants: LongitudinalConstants,
    thrust_direction: [f64; 2],
    database: Database,
    columns: Vec<(Coefficient, Term)>,
    /// By which powers of the scales the regressor of each column goes.
    scaling: Vec<ScalingPowers>,
    /// What constants add to it of the regressors of other columns.
    shifts: Vec<Vec<RegressorShift>>,
    /// Known and estimated terms in the [`short`] order of flight variables.
    known: Vec<(Coefficient, Term, f64)>,
    estimated: Vec<(Coefficient, Term)>,
    /// The same for evaluation in flight.
    quick: Vec<QuickTerm>,
    quick_known: Vec<(QuickTerm, f64)>,
    /// Terms with the rate of the angle of attack, which make the equations implicit.
    alpha_rate: Option<AlphaRateTerms>,
}

/// What rates and outputs share: coefficients with their derivatives, and the factors that make forces of them.
struct Point {
    variables: Variables,
    /// The coefficients `CL, CD, Cm`, dimensionless.
    c: [f64; 3],
    /// Their derivatives with respect to V, alpha and q.
    dc: [[f64; 3]; 3],
    sin_alpha: f64,
    cos_alpha: f64,
    /// `qbar S`, N, and its derivative with respect to V.
    force: f64,
    force_v: f64,
    /// Thrust along body x and z, N.
    thrust: [f64; 2],
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
        let alpha_rate = AlphaRateTerms::of(&columns, &known);
        let by_airspeed = constants.rate_speed.is_none();
        let scaling = columns.iter().map(|(c, t)| ScalingPowers::of(*c, t, by_airspeed)).collect();
        let shifts = constants::shifts(&columns, &constants);
        let estimated: Vec<(Coefficient, Term)> = columns.iter().map(|(c, t)| short(*c, t)).collect();
        let known: Vec<(Coefficient, Term, f64)> = known
            .iter()
            .map(|(c, t, value)| {
                let (c, t) = short(*c, t);
                (c, t, *value)
            })
            .collect();
        let quick = estimated.iter().map(|(c, t)| QuickTerm::new(*c, t)).collect();
        let quick_known = known.iter().map(|(c, t, value)| (QuickTerm::new(*c, t), *value)).collect();
        Self {
            constants,
            thrust_direction: [cos, -sin],
            database,
            columns,
            scaling,
            shifts,
            known,
            estimated,
            quick,
            quick_known,
            alpha_rate,
        }
    }

    /// The constants of the aircraft that the model was built with.
    pub fn constants(&self) -> &LongitudinalConstants {
        &self.constants
    }

    /// The estimated terms in the order of the parameter vector.
    pub fn columns(&self) -> &[(Coefficient, Term)] {
        &self.columns
    }

    /// Flight variables of the terms in the [`short`] order.
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

    /// `CL, CD, Cm` with the known and the estimated terms. `density` (kg/m^3) and `elevator` are for the database.
    #[inline(always)]
    fn coefficients<T: Scalar, const P: usize>(
        &self,
        x: &[T; STATES],
        theta: &[f64; P],
        density: f64,
        elevator: T,
        factors: &[T; FACTORS],
    ) -> [T; 3] {
        let mut total = match self.database {
            Database::None => [T::from(0.0); 3],
            ref database => {
                let q_hat = x[3] * (0.5 * self.constants.mean_chord) / x[0];
                database.coefficients(x[0], density, x[1], q_hat, elevator)
            }
        };
        for (coefficient, term, value) in &self.known {
            let sum = &mut total[*coefficient as usize];
            *sum = *sum + term.value(factors) * *value;
        }
        for ((coefficient, term), value) in self.estimated.iter().zip(theta) {
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

    #[inline(always)]
    fn variables(&self, x: &[f64; STATES], u: &LongitudinalInput) -> Variables {
        let c = &self.constants;
        let mut value = [0.0; FACTORS + 1];
        let mut gradient = [[0.0; 3]; FACTORS + 1];
        value[0] = x[1] - c.alpha_reference;
        gradient[0][1] = 1.0;
        match c.rate_speed {
            Some(speed) => {
                let scale = 0.5 * c.mean_chord / speed;
                value[1] = x[3] * scale;
                gradient[1][2] = scale;
            }
            None => {
                let scale = 0.5 * c.mean_chord / x[0];
                value[1] = x[3] * scale;
                gradient[1] = [-value[1] / x[0], 0.0, scale];
            }
        }
        let per_speed = 1.0 / c.reference_speed;
        value[2] = x[0] * per_speed;
        gradient[2][0] = per_speed;
        value[3] = u.elevator - c.elevator_reference;
        value[4..ONE].copy_from_slice(&u.extra);
        value[ONE] = 1.0;
        Variables { value, gradient }
    }

    #[inline(always)]
    fn point<const P: usize>(&self, x: &[f64; STATES], theta: &[f64; P], u: &LongitudinalInput) -> Point {
        let variables = self.variables(x, u);
        let (sin_alpha, cos_alpha) = x[1].sin_cos();
        let (mut c, mut dc) = match &self.database {
            Database::None => ([0.0; 3], [[0.0; 3]; 3]),
            Database::Aircraft(aircraft) => {
                let [speed, alpha, q] = [0, 1, 3].map(|i: usize| x[i]);
                let values = Database::in_plane(
                    aircraft,
                    Dual::<3>::variable(speed, 0),
                    u.air_density,
                    Dual::<3>::variable(alpha, 1),
                    Dual::<3>::variable(q, 2),
                    Dual::<3>::from(u.elevator),
                );
                (values.map(|value| value.value), values.map(|value| value.derivatives))
            }
            Database::F16(aircraft) => {
                // Derivatives with respect to alpha and q_hat, then q_hat = q cbar/2V.
                let scale = 0.5 * self.constants.mean_chord / x[0];
                let q_hat = x[3] * scale;
                let (cx, cz, cm) = aircraft.longitudinal_coefficients(
                    Dual::<2>::variable(x[1], 0),
                    Dual::<2>::variable(q_hat, 1),
                    Dual::<2>::from(u.elevator),
                );
                let chain = |alpha: f64, rate: f64| [-rate * q_hat / x[0], alpha, rate * scale];
                let lift = |x: f64, z: f64| x * sin_alpha - z * cos_alpha;
                let drag = |x: f64, z: f64| -(x * cos_alpha + z * sin_alpha);
                let (cl, cd) = (lift(cx.value, cz.value), drag(cx.value, cz.value));
                let [cx_a, cx_q] = cx.derivatives;
                let [cz_a, cz_q] = cz.derivatives;
                (
                    [cl, cd, cm.value],
                    [
                        chain(lift(cx_a, cz_a) - cd, lift(cx_q, cz_q)),
                        chain(drag(cx_a, cz_a) + cl, drag(cx_q, cz_q)),
                        chain(cm.derivatives[0], cm.derivatives[1]),
                    ],
                )
            }
        };
        let known = self.quick_known.iter().map(|(term, value)| (term, *value));
        for (term, factor) in known.chain(self.quick.iter().zip(theta.iter().copied())) {
            let (value, gradient) = term.at(&variables);
            c[term.coefficient] += factor * value;
            for (d, g) in dc[term.coefficient].iter_mut().zip(gradient) {
                *d += factor * g;
            }
        }
        let force_v = u.air_density * self.constants.wing_area * x[0];
        Point {
            variables,
            c,
            dc,
            sin_alpha,
            cos_alpha,
            force: 0.5 * force_v * x[0],
            force_v,
            thrust: self.thrust_direction.map(|d| u.thrust * d),
        }
    }
}

fn to_array<T: Copy>(rates: &LongitudinalState<T>) -> [T; STATES] {
    [rates.speed, rates.alpha, rates.theta, rates.q]
}

impl<const P: usize> Model<STATES, OUTPUTS, P> for LongitudinalModel {
    type Input = LongitudinalInput;

    fn parameter_count(&self) -> usize {
        self.columns.len().min(P)
    }

    fn rates(&self, x: &[f64; STATES], theta: &[f64; P], u: &Self::Input) -> [f64; STATES] {
        if let Some(terms) = &self.alpha_rate {
            return self.implicit_rates(terms, x, theta, u);
        }
        let factors = self.factors(x, u);
        let coefficients = self.coefficients(x, theta, u.air_density, u.elevator, &factors);
        to_array(&self.motion(x, u, coefficients).rates)
    }

    fn linearized_rates(
        &self,
        x: &[f64; STATES],
        theta: &[f64; P],
        u: &Self::Input,
        out: &mut LinearizedRates<STATES, P>,
    ) {
        if let Some(terms) = &self.alpha_rate {
            return self.implicit_linearized_rates(terms, x, theta, u, out);
        }
        let c = &self.constants;
        let p = self.point(x, theta, u);
        let [cl, cd, cm] = p.c;
        let [dcl, dcd, dcm] = p.dc;
        let per_mass = 1.0 / u.mass;
        let per_speed = 1.0 / x[0];
        let (sin_path, cos_path) = (x[2] - x[1]).sin_cos();
        let (gs, gc) = (c.gravity * sin_path, c.gravity * cos_path);
        // Thrust along the airspeed and perpendicular to it (down).
        let along = (p.thrust[0] * p.cos_alpha + p.thrust[1] * p.sin_alpha) * per_mass;
        let across = (p.thrust[1] * p.cos_alpha - p.thrust[0] * p.sin_alpha) * per_mass;
        let f = p.force * per_mass;
        let f_v = p.force_v * per_mass;
        let moment = c.mean_chord / u.iyy;
        // V' = -qbar S CD/m + T cos(a + s)/m - g sin(theta - a)
        out.rates[0] = along - f * cd - gs;
        out.state_jacobian[0] = [-(f_v * cd + f * dcd[0]), across - f * dcd[1] + gc, -gc, -f * dcd[2]];
        // alpha' = q + (-qbar S CL/m - T sin(a + s)/m + g cos(theta - a)) / V
        let turn = across - f * cl + gc;
        out.rates[1] = x[3] + turn * per_speed;
        out.state_jacobian[1] = [
            -(f_v * cl + f * dcl[0] + turn * per_speed) * per_speed,
            (gs - f * dcl[1] - along) * per_speed,
            -gs * per_speed,
            1.0 - f * dcl[2] * per_speed,
        ];
        // theta' = q
        out.rates[2] = x[3];
        out.state_jacobian[2] = [0.0, 0.0, 0.0, 1.0];
        // q' = (qbar S cbar Cm + T l) / Iyy
        out.rates[3] = p.force * cm * moment + u.thrust * c.thrust_arm / u.iyy;
        out.state_jacobian[3] =
            [moment * (p.force_v * cm + p.force * dcm[0]), moment * p.force * dcm[1], 0.0, moment * p.force * dcm[2]];
        let per_coefficient = [[0.0, -f * per_speed, 0.0], [-f, 0.0, 0.0], [0.0, 0.0, p.force * moment]];
        for (j, term) in self.quick.iter().take(P).enumerate() {
            let (value, _) = term.at(&p.variables);
            let [v, a, q] = per_coefficient[term.coefficient];
            out.regressors[0][j] = v * value;
            out.regressors[1][j] = a * value;
            out.regressors[2][j] = 0.0;
            out.regressors[3][j] = q * value;
        }
    }

    fn linearized_outputs(
        &self,
        x: &[f64; STATES],
        theta: &[f64; P],
        u: &Self::Input,
        out: &mut LinearizedOutputs<STATES, OUTPUTS, P>,
    ) {
        if let Some(terms) = &self.alpha_rate {
            return self.implicit_linearized_outputs(terms, x, theta, u, out);
        }
        let p = self.point(x, theta, u);
        let [cl, cd, cm] = p.c;
        let [dcl, dcd, dcm] = p.dc;
        let (sin, cos) = (p.sin_alpha, p.cos_alpha);
        let per_mass = 1.0 / u.mass;
        let f = p.force * per_mass;
        let f_v = p.force_v * per_mass;
        let moment = self.constants.mean_chord / u.iyy;
        out.outputs[..STATES].copy_from_slice(x);
        for i in 0..STATES {
            out.state_jacobian[i] = [0.0; STATES];
            out.state_jacobian[i][i] = 1.0;
        }
        // ax = (qbar S (CL sin a - CD cos a) + T cos s) / m,   az = (-qbar S (CL cos a + CD sin a) - T sin s) / m
        let (x_force, z_force) = (cl * sin - cd * cos, -(cl * cos + cd * sin));
        let along_x = |d: usize| dcl[d] * sin - dcd[d] * cos;
        let along_z = |d: usize| -(dcl[d] * cos + dcd[d] * sin);
        let ax = row::AX;
        out.outputs[ax] = f * x_force + p.thrust[0] * per_mass;
        out.state_jacobian[ax] = [f_v * x_force + f * along_x(0), f * (along_x(1) - z_force), 0.0, f * along_x(2)];
        let az = row::AZ;
        out.outputs[az] = f * z_force + p.thrust[1] * per_mass;
        out.state_jacobian[az] = [f_v * z_force + f * along_z(0), f * (along_z(1) + x_force), 0.0, f * along_z(2)];
        let qdot = row::PITCH_ACCELERATION;
        out.outputs[qdot] = p.force * cm * moment + u.thrust * self.constants.thrust_arm / u.iyy;
        out.state_jacobian[qdot] =
            [moment * (p.force_v * cm + p.force * dcm[0]), moment * p.force * dcm[1], 0.0, moment * p.force * dcm[2]];
        let per_coefficient = [[f * sin, -f * cos, 0.0], [-f * cos, -f * sin, 0.0], [0.0, 0.0, p.force * moment]];
        for (j, term) in self.quick.iter().take(P).enumerate() {
            let (value, _) = term.at(&p.variables);
            let [x_part, z_part, q_part] = per_coefficient[term.coefficient];
            for row in &mut out.parameter_jacobian[..STATES] {
                row[j] = 0.0;
            }
            out.parameter_jacobian[ax][j] = x_part * value;
            out.parameter_jacobian[az][j] = z_part * value;
            out.parameter_jacobian[qdot][j] = q_part * value;
        }
    }

    fn measuring_output(&self, state: usize) -> Option<usize> {
        (state < STATES).then_some(state)
    }
}
