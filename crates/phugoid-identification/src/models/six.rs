//! The whole motion of an aircraft, all six coefficients at once, as a model for the estimators.

pub(crate) mod constants;

use phugoid_estimators::{Input, LinearizedOutputs, LinearizedRates, Model, RegressorShift};
use phugoid_flight_dynamics::rigid_body::{Angles, attitude_equations, force_equations};
use phugoid_flight_dynamics::scalar::{Dual, Scalar};

use crate::core::scaling::ScalingPowers;
use crate::core::term::{Coefficient, FACTORS, Term};
use crate::models::longitudinal::Database;
use crate::models::rigid::{Aerodynamics, Air, AircraftConstants, MassInput, Surfaces};

/// States: true airspeed, angle of attack, sideslip, roll and pitch angle, roll, pitch and yaw rate.
pub const SIX_STATES: usize = 8;
/// Outputs: the states, the specific forces along body x, y and z at the centre of gravity, the angular accelerations.
pub const SIX_OUTPUTS: usize = 14;

/// What is known of the flight at one instant beside the state.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SixInput {
    /// Deflections of the surfaces and the extra inputs of the model file.
    pub surfaces: Surfaces,
    /// Density of the air, kg/m^3.
    pub air_density: f64,
    /// Thrust along the thrust line, N.
    pub thrust: f64,
    /// Mass, and moments and products of inertia.
    pub mass: MassInput,
}

impl Input for SixInput {
    #[inline]
    fn interpolate(&self, other: &Self, s: f64) -> Self {
        let between = |a: f64, b: f64| a + s * (b - a);
        Self {
            surfaces: self.surfaces.interpolate(&other.surfaces, s),
            air_density: between(self.air_density, other.air_density),
            thrust: between(self.thrust, other.thrust),
            mass: self.mass.interpolate(&other.mass, s),
        }
    }
}

/// The whole motion: states `V, alpha, beta, phi, theta, p, q, r`, outputs those and `ax, ay, az, pdot, qdot, rdot`.
///
/// ```text
/// C_k = database + sum_j theta_j r_j(alpha, beta, p_hat, q_hat, r_hat, surfaces, ...)     k = L, D, m, Y, l, n
/// X = qbar S (CL sin a - CD cos a) + T cos s   Y = qbar S CY   Z = -qbar S (CL cos a + CD sin a) - T sin s
/// [L, M, N] = qbar S [b Cl, cbar Cm + T l / qbar S, b Cn]                                 body axes, about the CG
/// ```
///
/// Lift and drag are along the stability axes (turned from body axes by the angle of attack alone); with sideslip the
/// force along the airspeed is `-qbar S (CD cos b - CY sin b)`. Equations of motion of Stevens & Lewis table 2.5-1,
/// those of [`force_equations`], [`attitude_equations`] and `MassProperties::angular_acceleration`, which the
/// simulation flies. Linear in the parameters; the derivatives with respect to the state are exact (dual numbers
/// through tables and equations).
#[derive(Clone, Debug)]
pub struct SixModel {
    aerodynamics: Aerodynamics,
    thrust_direction: [f64; 2],
    /// By which powers of the scales the regressor of each column goes.
    scaling: Vec<ScalingPowers>,
    /// What constants add to it of the regressors of other columns.
    shifts: Vec<Vec<RegressorShift>>,
}

/// What constants of the aircraft and of the air are multiplied by.
#[derive(Clone, Copy)]
struct Factors<T> {
    density: T,
    /// Of chord and span, and twice of the wing area.
    length: T,
    mass: T,
    thrust: T,
}

/// The rates of the states, and what the outputs need, at one point.
struct Motion<T> {
    rates: [T; SIX_STATES],
    specific_force: [T; 3],
    variables: [T; FACTORS],
}

impl SixModel {
    /// A model with estimated `columns` (the parameter vector's order) and `known` terms with their values.
    pub fn new(
        constants: AircraftConstants,
        database: Database,
        columns: Vec<(Coefficient, Term)>,
        known: Vec<(Coefficient, Term, f64)>,
    ) -> Self {
        let (sin, cos) = constants.thrust_inclination.sin_cos();
        let by_airspeed = constants.rate_speed.is_none();
        let scaling = columns.iter().map(|(c, t)| ScalingPowers::of(*c, t, by_airspeed)).collect();
        let shifts = constants::shifts(&columns, &constants);
        let aerodynamics = Aerodynamics { constants, database, known, columns };
        Self { aerodynamics, thrust_direction: [cos, -sin], scaling, shifts }
    }

    /// The constants of the aircraft that the model was built with.
    pub fn constants(&self) -> &AircraftConstants {
        &self.aerodynamics.constants
    }

    /// The estimated terms in the order of the parameter vector.
    pub fn columns(&self) -> &[(Coefficient, Term)] {
        &self.aerodynamics.columns
    }

    #[inline(always)]
    fn motion<T: Scalar>(&self, x: &[T; SIX_STATES], theta: &[f64], u: &SixInput) -> Motion<T> {
        self.motion_with(x, theta, u, &u.surfaces.deflections(), None)
    }

    /// The motion with the deflections in the type of the equations, and constants multiplied by factors; none: as they are.
    #[inline(always)]
    fn motion_with<T: Scalar>(
        &self,
        x: &[T; SIX_STATES],
        theta: &[f64],
        u: &SixInput,
        deflections: &[T; 3],
        factors: Option<Factors<T>>,
    ) -> Motion<T> {
        let c = &self.aerodynamics.constants;
        let [speed, alpha, beta, phi, pitch, p, q, r] = *x;
        let rates = [p, q, r];
        let density = T::from(u.air_density);
        // Rates are made dimensionless with the lengths.
        let (density, of_terms) = match factors {
            Some(f) => (density * f.density, rates.map(|rate| rate * f.length)),
            None => (density, rates),
        };
        let air = Air { speed, alpha, beta, rates: of_terms, density, mach: None };
        let angles = Angles::of(alpha, beta, phi, pitch);
        let variables = self.aerodynamics.variables(&air, deflections, &u.surfaces.extra);
        let coefficients =
            self.aerodynamics.coefficients(theta, &air, &variables, deflections, angles.sin_alpha, angles.cos_alpha);
        let mut force = speed * speed * (0.5 * u.air_density * c.wing_area);
        let [thrust_x, thrust_z] = self.thrust_direction.map(|d| d * u.thrust / u.mass.mass);
        let [mut thrust_x, mut thrust_z] = [thrust_x, thrust_z].map(T::from);
        let mut thrust_moment = T::from(u.thrust * c.thrust_arm);
        let (mut span, mut chord) = (T::from(c.span), T::from(c.mean_chord));
        if let Some(f) = factors {
            force = force * f.density * f.length * f.length;
            (span, chord) = (span * f.length, chord * f.length);
            (thrust_x, thrust_z) = (thrust_x * f.thrust / f.mass, thrust_z * f.thrust / f.mass);
            thrust_moment = thrust_moment * f.thrust;
        }
        let mut acceleration = force / u.mass.mass;
        if let Some(f) = factors {
            acceleration = acceleration / f.mass;
        }
        let specific_force = [
            coefficients.cx * acceleration + thrust_x,
            coefficients.cy * acceleration,
            coefficients.cz * acceleration + thrust_z,
        ];
        let span_moment = force * span;
        let moment = [
            coefficients.cl * span_moment,
            coefficients.cm * (force * chord) + thrust_moment,
            coefficients.cn * span_moment,
        ];
        let [speed_rate, alpha_rate, beta_rate] =
            force_equations(speed, &angles, angles.body_velocity(speed), rates, specific_force, c.gravity);
        let [phi_rate, pitch_rate, _] = attitude_equations(&angles, rates);
        // An impossible inertia makes the rates NaN, and the estimator leaves the sample out.
        let [p_rate, q_rate, r_rate] = match u.mass.properties(c.rotor_momentum) {
            Some(properties) => properties.angular_acceleration(rates, moment),
            None => [T::from(f64::NAN); 3],
        };
        Motion {
            rates: [speed_rate, alpha_rate, beta_rate, phi_rate, pitch_rate, p_rate, q_rate, r_rate],
            specific_force,
            variables,
        }
    }

    fn differentiated(&self, x: &[f64; SIX_STATES], theta: &[f64], u: &SixInput) -> Motion<Dual<SIX_STATES>> {
        self.motion(&std::array::from_fn(|i| Dual::<SIX_STATES>::variable(x[i], i)), theta, u)
    }

    /// What one unit of each coefficient (`CL, CD, Cm, CY, Cl, Cn`) adds: to `V', alpha', beta'`, to the specific force
    /// and to `p', q', r'`.
    fn per_coefficient(&self, x: &[f64; SIX_STATES], u: &SixInput) -> [PerCoefficient; 6] {
        let c = &self.aerodynamics.constants;
        let [speed, alpha, beta, ..] = *x;
        let force = 0.5 * u.air_density * c.wing_area * speed * speed;
        let f = force / u.mass.mass;
        let ((sin_alpha, cos_alpha), (sin_beta, cos_beta)) = (alpha.sin_cos(), beta.sin_cos());
        let inverse = u.mass.properties(c.rotor_momentum).map_or([[f64::NAN; 3]; 3], |m| *m.inverse_inertia());
        let turn = |axis: usize, length: f64| PerCoefficient {
            angular: std::array::from_fn(|row| inverse[row][axis] * force * length),
            ..PerCoefficient::default()
        };
        [
            PerCoefficient {
                velocity: [0.0, -f / (speed * cos_beta), 0.0],
                force: [f * sin_alpha, 0.0, -f * cos_alpha],
                ..PerCoefficient::default()
            },
            PerCoefficient {
                velocity: [-f * cos_beta, 0.0, f * sin_beta / speed],
                force: [-f * cos_alpha, 0.0, -f * sin_alpha],
                ..PerCoefficient::default()
            },
            turn(1, c.mean_chord),
            PerCoefficient {
                velocity: [f * sin_beta, 0.0, f * cos_beta / speed],
                force: [0.0, f, 0.0],
                ..PerCoefficient::default()
            },
            turn(0, c.span),
            turn(2, c.span),
        ]
    }
}

/// What one unit of a coefficient adds.
#[derive(Clone, Copy, Default)]
struct PerCoefficient {
    /// What it adds to `V', alpha', beta'`.
    velocity: [f64; 3],
    /// What it adds to the specific force.
    force: [f64; 3],
    /// What it adds to `p', q', r'`.
    angular: [f64; 3],
}

impl<const P: usize> Model<SIX_STATES, SIX_OUTPUTS, P> for SixModel {
    type Input = SixInput;

    fn parameter_count(&self) -> usize {
        self.columns().len().min(P)
    }

    fn rates(&self, x: &[f64; SIX_STATES], theta: &[f64; P], u: &Self::Input) -> [f64; SIX_STATES] {
        self.motion(x, theta, u).rates
    }

    fn linearized_rates(
        &self,
        x: &[f64; SIX_STATES],
        theta: &[f64; P],
        u: &Self::Input,
        out: &mut LinearizedRates<SIX_STATES, P>,
    ) {
        let motion = self.differentiated(x, theta, u);
        out.rates = motion.rates.map(|rate| rate.value);
        out.state_jacobian = motion.rates.map(|rate| rate.derivatives);
        let per_coefficient = self.per_coefficient(x, u);
        let variables = motion.variables.map(|v| v.value);
        for (j, (coefficient, term)) in self.columns().iter().take(P).enumerate() {
            let value = term.value(&variables);
            let per = &per_coefficient[*coefficient as usize];
            for i in 0..3 {
                out.regressors[i][j] = per.velocity[i] * value;
                out.regressors[5 + i][j] = per.angular[i] * value;
            }
            out.regressors[3][j] = 0.0;
            out.regressors[4][j] = 0.0;
        }
    }

    fn linearized_outputs(
        &self,
        x: &[f64; SIX_STATES],
        theta: &[f64; P],
        u: &Self::Input,
        out: &mut LinearizedOutputs<SIX_STATES, SIX_OUTPUTS, P>,
    ) {
        let motion = self.differentiated(x, theta, u);
        out.outputs[..SIX_STATES].copy_from_slice(x);
        for i in 0..SIX_STATES {
            out.state_jacobian[i] = [0.0; SIX_STATES];
            out.state_jacobian[i][i] = 1.0;
        }
        for i in 0..3 {
            let (force, angular) = (&motion.specific_force[i], &motion.rates[5 + i]);
            out.outputs[8 + i] = force.value;
            out.state_jacobian[8 + i] = force.derivatives;
            out.outputs[11 + i] = angular.value;
            out.state_jacobian[11 + i] = angular.derivatives;
        }
        let per_coefficient = self.per_coefficient(x, u);
        let variables = motion.variables.map(|v| v.value);
        for (j, (coefficient, term)) in self.columns().iter().take(P).enumerate() {
            let value = term.value(&variables);
            let per = &per_coefficient[*coefficient as usize];
            for row in &mut out.parameter_jacobian[..SIX_STATES] {
                row[j] = 0.0;
            }
            for i in 0..3 {
                out.parameter_jacobian[8 + i][j] = per.force[i] * value;
                out.parameter_jacobian[11 + i][j] = per.angular[i] * value;
            }
        }
    }

    fn measuring_output(&self, state: usize) -> Option<usize> {
        (state < SIX_STATES).then_some(state)
    }
}
