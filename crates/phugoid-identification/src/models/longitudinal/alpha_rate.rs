//! Terms with the rate of the angle of attack, `alpha' cbar / 2V`: the equations that they make implicit.
//!
//! `alpha'` depends on CL, and with such terms CL (and CD and Cm) on `alpha'`, linearly. The equation is solved
//! exactly:
//!
//! ```text
//! V alpha' = V q + g cos(theta - alpha) + T_perpendicular/m - f (CL_s + k_L alpha'),    f = qbar S/m
//!   alpha' = (V q + g cos(theta - alpha) + T_perpendicular/m - f CL_s) / (V + f k_L)
//! C_k = C_k,s + k_k alpha',      k_k = (cbar/2V) * sum of theta_j r_j over the terms r_j alpha_dot_hat of C_k
//! ```
//!
//! `C_s` are the coefficients without these terms. The motion is then no longer linear in the parameters: `alpha'`
//! holds those of CL, divided by `V + f k_L`. What the model gives as regressors are the derivatives at the parameters
//! asked for, which is what filters and output error use; at `theta = 0` they are the linear model's.

use phugoid_estimators::{LinearizedOutputs, LinearizedRates};
use phugoid_flight_dynamics::longitudinal::LongitudinalMotion;
use phugoid_flight_dynamics::scalar::{Dual, Scalar};

use super::{FACTORS, LongitudinalInput, LongitudinalModel, OUTPUTS, STATES, row, short, to_array};
use crate::core::term::{Coefficient, Term, Variable};

/// The terms with `alpha_dot_hat`, each without that factor, in the order of the flight variables of symmetric flight.
#[derive(Clone, Debug, Default)]
pub(super) struct AlphaRateTerms {
    known: Vec<(Coefficient, Term, f64)>,
    /// By column of the parameter vector; none for an ordinary term.
    columns: Vec<Option<(Coefficient, Term)>>,
}

impl AlphaRateTerms {
    /// Those among estimated and known terms; `None` if there is none, so that an explicit model costs no time for it.
    pub(super) fn of(columns: &[(Coefficient, Term)], known: &[(Coefficient, Term, f64)]) -> Option<Self> {
        let rest = |coefficient: Coefficient, term: &Term| {
            let rest = term.without(Variable::AlphaRate)?;
            Some(short(coefficient, &rest))
        };
        let this = Self {
            known: known.iter().filter_map(|(c, t, value)| rest(*c, t).map(|(c, t)| (c, t, *value))).collect(),
            columns: columns.iter().map(|(c, t)| rest(*c, t)).collect(),
        };
        (!this.known.is_empty() || this.columns.iter().any(Option::is_some)).then_some(this)
    }
}

/// What the implicit equations of the motion need at one point.
pub(super) struct Implicit<T> {
    factors: [T; FACTORS],
    alpha_rate: T,
    /// Time that the air takes along half of the chord, `cbar / 2V`, s.
    chord_time: T,
    /// Coefficients of the rate of alpha in lift, drag and pitching moment, `k_L, k_D, k_m`, s.
    gains: [T; 3],
    pub(super) motion: LongitudinalMotion<T>,
}

impl LongitudinalModel {
    #[inline]
    pub(super) fn implicit<T: Scalar, const P: usize>(
        &self,
        terms: &AlphaRateTerms,
        x: &[T; STATES],
        theta: &[f64; P],
        u: &LongitudinalInput,
    ) -> Implicit<T> {
        let c = &self.constants;
        let [speed, alpha, pitch, q] = *x;
        let factors = self.factors(x, u);
        let explicit = self.coefficients(x, theta, u.air_density, T::from(u.elevator), &factors);
        let chord_time = match c.rate_speed {
            Some(speed) => T::from(0.5 * c.mean_chord / speed),
            None => (speed * 2.0).recip() * c.mean_chord,
        };
        let mut gains = [T::from(0.0); 3];
        let estimated = terms.columns.iter().zip(theta);
        let estimated = estimated.filter_map(|(term, value)| term.as_ref().map(|(c, t)| (c, t, value)));
        for (coefficient, rest, value) in terms.known.iter().map(|(c, t, value)| (c, t, value)).chain(estimated) {
            let gain = &mut gains[*coefficient as usize];
            *gain = *gain + rest.value(&factors) * chord_time * *value;
        }
        let (sin_alpha, cos_alpha) = alpha.sin_cos();
        let (_, cos_path) = (pitch - alpha).sin_cos();
        let f = speed * speed * (0.5 * u.air_density * c.wing_area / u.mass);
        let [thrust_x, thrust_z] = self.thrust_direction.map(|d| d * u.thrust / u.mass);
        let across = cos_alpha * thrust_z - sin_alpha * thrust_x;
        let alpha_rate = (speed * q + cos_path * c.gravity + across - f * explicit[0]) / (speed + f * gains[0]);
        let total = std::array::from_fn(|k| explicit[k] + gains[k] * alpha_rate);
        Implicit { factors, alpha_rate, chord_time, gains, motion: self.motion(x, u, total) }
    }

    pub(super) fn implicit_rates<const P: usize>(
        &self,
        terms: &AlphaRateTerms,
        x: &[f64; STATES],
        theta: &[f64; P],
        u: &LongitudinalInput,
    ) -> [f64; STATES] {
        to_array(&self.implicit(terms, x, theta, u).motion.rates)
    }

    /// What one unit of parameter `j` adds to `CL, CD, Cm`: directly, and through `alpha'`.
    fn through_alpha_rate<const D: usize>(
        &self,
        terms: &AlphaRateTerms,
        at: &Implicit<Dual<D>>,
        per_speed: [f64; 2],
        j: usize,
    ) -> [f64; 3] {
        let [speed, f] = per_speed;
        let factors = at.factors.map(|v| v.value);
        let (coefficient, value) = match (terms.columns.get(j), self.estimated.get(j)) {
            (Some(Some((coefficient, rest))), _) => {
                (*coefficient as usize, rest.value(&factors) * at.chord_time.value * at.alpha_rate.value)
            }
            (_, Some((coefficient, term))) => (*coefficient as usize, term.value(&factors)),
            _ => return [0.0; 3],
        };
        let gains = at.gains.map(|gain| gain.value);
        let alpha_rate = if coefficient == 0 { -f * value / (speed + f * gains[0]) } else { 0.0 };
        std::array::from_fn(|k| gains[k] * alpha_rate + if k == coefficient { value } else { 0.0 })
    }

    fn implicit_at<const P: usize>(
        &self,
        terms: &AlphaRateTerms,
        x: &[f64; STATES],
        theta: &[f64; P],
        u: &LongitudinalInput,
    ) -> Implicit<Dual<STATES>> {
        self.implicit(terms, &std::array::from_fn(|i| Dual::<STATES>::variable(x[i], i)), theta, u)
    }

    pub(super) fn implicit_linearized_rates<const P: usize>(
        &self,
        terms: &AlphaRateTerms,
        x: &[f64; STATES],
        theta: &[f64; P],
        u: &LongitudinalInput,
        out: &mut LinearizedRates<STATES, P>,
    ) {
        let at = self.implicit_at(terms, x, theta, u);
        let rates = to_array(&at.motion.rates);
        out.rates = rates.map(|rate| rate.value);
        out.state_jacobian = rates.map(|rate| rate.derivatives);
        let force = 0.5 * u.air_density * self.constants.wing_area * x[0] * x[0];
        let f = force / u.mass;
        for j in 0..self.estimated.len().min(P) {
            let [lift, drag, moment] = self.through_alpha_rate(terms, &at, [x[0], f], j);
            out.regressors[0][j] = -f * drag;
            out.regressors[1][j] = -f * lift / x[0];
            out.regressors[2][j] = 0.0;
            out.regressors[3][j] = force * self.constants.mean_chord / u.iyy * moment;
        }
    }

    pub(super) fn implicit_linearized_outputs<const P: usize>(
        &self,
        terms: &AlphaRateTerms,
        x: &[f64; STATES],
        theta: &[f64; P],
        u: &LongitudinalInput,
        out: &mut LinearizedOutputs<STATES, OUTPUTS, P>,
    ) {
        let at = self.implicit_at(terms, x, theta, u);
        out.outputs[..STATES].copy_from_slice(x);
        for i in 0..STATES {
            out.state_jacobian[i] = [0.0; STATES];
            out.state_jacobian[i][i] = 1.0;
        }
        let measured = [
            (row::AX, at.motion.specific_force_x),
            (row::AZ, at.motion.specific_force_z),
            (row::PITCH_ACCELERATION, at.motion.rates.q),
        ];
        for (row, value) in measured {
            out.outputs[row] = value.value;
            out.state_jacobian[row] = value.derivatives;
        }
        let force = 0.5 * u.air_density * self.constants.wing_area * x[0] * x[0];
        let f = force / u.mass;
        let (sin, cos) = x[1].sin_cos();
        for j in 0..self.estimated.len().min(P) {
            let [lift, drag, moment] = self.through_alpha_rate(terms, &at, [x[0], f], j);
            for row in &mut out.parameter_jacobian[..STATES] {
                row[j] = 0.0;
            }
            out.parameter_jacobian[row::AX][j] = f * (lift * sin - drag * cos);
            out.parameter_jacobian[row::AZ][j] = -f * (lift * cos + drag * sin);
            out.parameter_jacobian[row::PITCH_ACCELERATION][j] = force * self.constants.mean_chord / u.iyy * moment;
        }
    }
}
