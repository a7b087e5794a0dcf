//! The lateral-directional motion of an aircraft as a model for the estimators.

pub(crate) mod constants;

use phugoid_estimators::{Input, LinearizedOutputs, LinearizedRates, Model, RegressorShift};
use phugoid_flight_dynamics::rigid_body::{Angles, attitude_equations, force_equations};
use phugoid_flight_dynamics::scalar::{Dual, Scalar};

use crate::core::scaling::ScalingPowers;
use crate::core::term::{Coefficient, FACTORS, Term};
use crate::models::longitudinal::Database;
use crate::models::rigid::{Aerodynamics, Air, AircraftConstants, MassInput, Surfaces};

/// States: sideslip, roll angle, roll rate, yaw rate.
pub const LATERAL_STATES: usize = 4;
/// Outputs: the states, the specific force along body y at the centre of gravity, roll and yaw acceleration.
pub const LATERAL_OUTPUTS: usize = 7;

/// What is known of the flight at one instant beside the state: surfaces and air, and the motion in the plane of
/// symmetry, which is measured.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LateralInput {
    /// Deflections of the surfaces and the extra inputs of the model file.
    pub surfaces: Surfaces,
    /// Density of the air, kg/m^3.
    pub air_density: f64,
    /// Mass, and moments and products of inertia.
    pub mass: MassInput,
    /// Measured true airspeed, m/s.
    pub speed: f64,
    /// Measured angle of attack, rad.
    pub alpha: f64,
    /// Measured pitch angle, rad, positive nose up.
    pub theta: f64,
    /// Measured pitch rate about body y, rad/s, positive nose up.
    pub q: f64,
    /// Specific force along body x at the centre of gravity, m/s^2: with `az` it says how fast the airspeed changes.
    pub ax: f64,
    /// Specific force along body z at the centre of gravity, m/s^2.
    pub az: f64,
}

impl Input for LateralInput {
    #[inline]
    fn interpolate(&self, other: &Self, s: f64) -> Self {
        let between = |a: f64, b: f64| a + s * (b - a);
        Self {
            surfaces: self.surfaces.interpolate(&other.surfaces, s),
            air_density: between(self.air_density, other.air_density),
            mass: self.mass.interpolate(&other.mass, s),
            speed: between(self.speed, other.speed),
            alpha: between(self.alpha, other.alpha),
            theta: between(self.theta, other.theta),
            q: between(self.q, other.q),
            ax: between(self.ax, other.ax),
            az: between(self.az, other.az),
        }
    }
}

/// Lateral-directional motion: states `beta, phi, p, r`, outputs those and `ay, pdot, rdot`.
///
/// ```text
/// C_k = database + sum_j theta_j r_j(beta, p_hat, r_hat, aileron, rudder, ...)            k = Y, l, n
/// v'    = p w - r u + g cos(theta) sin(phi) + qbar S CY/m
/// beta' = (v' cos b - (u' cos a + w' sin a) sin b) / V
/// phi'  = p + tan(theta) (q sin(phi) + r cos(phi))
/// p', r' from [L, N] = qbar S b [Cl, Cn], Ixx, Iyy, Izz, Ixz, the rotor, p, q, r             body axes, about the CG
/// ```
///
/// The equations are those of [`SixModel`](crate::models::six::SixModel) with `V, alpha, theta, q` measured instead of
/// integrated; `u'` and `w'` come from the measured specific forces, so that thrust, lift and drag are not needed. The
/// noise of these measured inputs is not known to an estimator; `docs/methods.md` says what it does. Linear in the
/// parameters; the derivatives with respect to the state are exact.
#[derive(Clone, Debug)]
pub struct LateralModel {
    aerodynamics: Aerodynamics,
    /// By which powers of the scales the regressor of each column goes.
    scaling: Vec<ScalingPowers>,
    /// What constants add to it of the regressors of other columns.
    shifts: Vec<Vec<RegressorShift>>,
}

/// Measured quantities on which the forces depend.
#[derive(Clone, Copy)]
struct Measured<T> {
    speed: T,
    alpha: T,
    density: T,
    /// What chord and span are multiplied by, and the wing area twice; none: those of the model.
    length: Option<T>,
}

/// The rates of the states, and what the outputs need, at one point.
struct Motion<T> {
    rates: [T; LATERAL_STATES],
    side_force: T,
    variables: [T; FACTORS],
}

impl LateralModel {
    /// A model with estimated `columns` (the parameter vector's order) and `known` terms with their values. Terms of
    /// lift, drag and pitching moment have no effect.
    pub fn new(
        constants: AircraftConstants,
        database: Database,
        columns: Vec<(Coefficient, Term)>,
        known: Vec<(Coefficient, Term, f64)>,
    ) -> Self {
        let by_airspeed = constants.rate_speed.is_none();
        let scaling = columns.iter().map(|(c, t)| ScalingPowers::of(*c, t, by_airspeed)).collect();
        let shifts = constants::shifts(&columns, &constants);
        Self { aerodynamics: Aerodynamics { constants, database, known, columns }, scaling, shifts }
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
    fn motion<T: Scalar>(&self, x: &[T; LATERAL_STATES], theta: &[f64], u: &LateralInput) -> Motion<T> {
        let measured = Measured {
            speed: T::from(u.speed),
            alpha: T::from(u.alpha),
            density: T::from(u.air_density),
            length: None,
        };
        self.motion_with(x, theta, u, &measured, &u.surfaces.deflections())
    }

    /// The motion with quantities of the input in the type of the equations.
    #[inline(always)]
    fn motion_with<T: Scalar>(
        &self,
        x: &[T; LATERAL_STATES],
        theta: &[f64],
        u: &LateralInput,
        measured: &Measured<T>,
        deflections: &[T; 3],
    ) -> Motion<T> {
        let c = &self.aerodynamics.constants;
        let [beta, phi, p, r] = *x;
        let Measured { speed, alpha, density, length } = *measured;
        let rates = [p, T::from(u.q), r];
        // Rates are made dimensionless with the lengths.
        let of_terms = length.map_or(rates, |length| rates.map(|rate| rate * length));
        let air = Air { speed, alpha, beta, rates: of_terms, density, mach: None };
        let angles = Angles::of(air.alpha, beta, phi, T::from(u.theta));
        let variables = self.aerodynamics.variables(&air, deflections, &u.surfaces.extra);
        let coefficients =
            self.aerodynamics.coefficients(theta, &air, &variables, deflections, angles.sin_alpha, angles.cos_alpha);
        let mut force = speed * (density * 0.5) * speed * c.wing_area;
        let mut moment_per_coefficient = force * c.span;
        if let Some(length) = length {
            force = force * length * length;
            moment_per_coefficient = moment_per_coefficient * length * length * length;
        }
        let side_force = coefficients.cy * (force / u.mass.mass);
        let specific_force = [T::from(u.ax), side_force, T::from(u.az)];
        let [_, _, beta_rate] =
            force_equations(speed, &angles, angles.body_velocity(speed), rates, specific_force, c.gravity);
        let [phi_rate, _, _] = attitude_equations(&angles, rates);
        let moment = [coefficients.cl * moment_per_coefficient, T::from(0.0), coefficients.cn * moment_per_coefficient];
        // With a plane of symmetry the pitching moment does not turn the aircraft out of this plane. An impossible
        // inertia makes the rates NaN, and the estimator leaves the sample out.
        let [p_rate, _, r_rate] = match u.mass.properties(c.rotor_momentum) {
            Some(properties) => properties.angular_acceleration(rates, moment),
            None => [T::from(f64::NAN); 3],
        };
        Motion { rates: [beta_rate, phi_rate, p_rate, r_rate], side_force, variables }
    }

    fn differentiated(&self, x: &[f64; LATERAL_STATES], theta: &[f64], u: &LateralInput) -> Motion<Dual<4>> {
        self.motion(&std::array::from_fn(|i| Dual::<LATERAL_STATES>::variable(x[i], i)), theta, u)
    }

    /// What one unit of each coefficient (`CL, CD, Cm, CY, Cl, Cn`) adds to `beta', p', r', ay`.
    fn per_coefficient(&self, beta: f64, u: &LateralInput) -> [[f64; 4]; 6] {
        let c = &self.aerodynamics.constants;
        let force = 0.5 * u.air_density * u.speed * u.speed * c.wing_area;
        let f = force / u.mass.mass;
        let j = u.mass.properties(c.rotor_momentum).map_or([[f64::NAN; 3]; 3], |m| *m.inverse_inertia());
        let moment = force * c.span;
        let none = [0.0; 4];
        [
            none,
            none,
            none,
            [f * beta.cos() / u.speed, 0.0, 0.0, f],
            [0.0, moment * j[0][0], moment * j[2][0], 0.0],
            [0.0, moment * j[0][2], moment * j[2][2], 0.0],
        ]
    }
}

impl<const P: usize> Model<LATERAL_STATES, LATERAL_OUTPUTS, P> for LateralModel {
    type Input = LateralInput;

    fn parameter_count(&self) -> usize {
        self.columns().len().min(P)
    }

    fn rates(&self, x: &[f64; LATERAL_STATES], theta: &[f64; P], u: &Self::Input) -> [f64; LATERAL_STATES] {
        self.motion(x, theta, u).rates
    }

    fn linearized_rates(
        &self,
        x: &[f64; LATERAL_STATES],
        theta: &[f64; P],
        u: &Self::Input,
        out: &mut LinearizedRates<LATERAL_STATES, P>,
    ) {
        let motion = self.differentiated(x, theta, u);
        out.rates = motion.rates.map(|rate| rate.value);
        out.state_jacobian = motion.rates.map(|rate| rate.derivatives);
        let per_coefficient = self.per_coefficient(x[0], u);
        let variables = motion.variables.map(|v| v.value);
        for (j, (coefficient, term)) in self.columns().iter().take(P).enumerate() {
            let value = term.value(&variables);
            let [sideslip, roll, yaw, _] = per_coefficient[*coefficient as usize];
            out.regressors[0][j] = sideslip * value;
            out.regressors[1][j] = 0.0;
            out.regressors[2][j] = roll * value;
            out.regressors[3][j] = yaw * value;
        }
    }

    fn linearized_outputs(
        &self,
        x: &[f64; LATERAL_STATES],
        theta: &[f64; P],
        u: &Self::Input,
        out: &mut LinearizedOutputs<LATERAL_STATES, LATERAL_OUTPUTS, P>,
    ) {
        let motion = self.differentiated(x, theta, u);
        out.outputs[..LATERAL_STATES].copy_from_slice(x);
        for i in 0..LATERAL_STATES {
            out.state_jacobian[i] = [0.0; LATERAL_STATES];
            out.state_jacobian[i][i] = 1.0;
        }
        for (row, value) in [(4, &motion.side_force), (5, &motion.rates[2]), (6, &motion.rates[3])] {
            out.outputs[row] = value.value;
            out.state_jacobian[row] = value.derivatives;
        }
        let per_coefficient = self.per_coefficient(x[0], u);
        let variables = motion.variables.map(|v| v.value);
        for (j, (coefficient, term)) in self.columns().iter().take(P).enumerate() {
            let value = term.value(&variables);
            let [_, roll, yaw, side] = per_coefficient[*coefficient as usize];
            for row in &mut out.parameter_jacobian[..LATERAL_STATES] {
                row[j] = 0.0;
            }
            out.parameter_jacobian[4][j] = side * value;
            out.parameter_jacobian[5][j] = roll * value;
            out.parameter_jacobian[6][j] = yaw * value;
        }
    }

    fn measuring_output(&self, state: usize) -> Option<usize> {
        (state < LATERAL_STATES).then_some(state)
    }
}
