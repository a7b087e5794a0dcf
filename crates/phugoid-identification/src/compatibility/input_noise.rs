//! What the noise of the inertial sensors adds to the errors of the estimates.
//!
//! Output error takes its inputs for exact. Here they are measurements, and their noise `w` is integrated: it moves all
//! later outputs, and the estimates with them,
//!
//! ```text
//! dz = C sum_k J_k^T R^-1 sum_(j<k) H_k Phi(k, j+1) B_j w_j        J_k = dy_k/dz,  H_k = dy_k/dx,  C: covariance of the fit
//! ```
//!
//! With `Phi(k, j+1) = Phi_k Phi_(j+1)^-1` the sum over `k > j` is a total less what came before, so that two passes
//! over the record give `cov(dz) = C [ sum_j G_j S G_j^T ] C` with the noise variances `S`. `B_j` is the derivative by
//! a bias of the sensor over one interval: the noise of a sample acts as such a bias until the next one.

use nalgebra::{DMatrix, SMatrix};
use phugoid_estimators::discretization::{InputHold, IntervalInput, Part, step, sub_steps};
use phugoid_estimators::{LinearizedOutputs, Model};

use super::kinematics::{Inertial, Kinematics, OUTPUTS, PARAMETERS, STATES};
use crate::batch::{BatchFit, UnknownKind};
use crate::preparation::noise::measure_noise;

/// Accelerometers, then gyroscopes: the first parameters are their biases, in this order.
const SENSORS: usize = 6;

type States = SMatrix<f64, STATES, STATES>;
type ByParameter = SMatrix<f64, STATES, PARAMETERS>;

/// Derivatives that connect the noise of one sample with the unknowns.
struct Moment {
    /// `J^T R^-1 H Phi`, unknown by state.
    information: DMatrix<f64>,
    /// `J^T R^-1 dy/d(bias)`: what noise of this sample does to its own outputs.
    direct: DMatrix<f64>,
    /// `Phi_(j+1)^-1 B_j`, state by sensor; zero for the last sample.
    impulse: SMatrix<f64, STATES, SENSORS>,
}

/// The arguments of the kinematic simulation for one record.
pub(super) struct Flight<'a> {
    pub(super) model: &'a Kinematics,
    pub(super) time: &'a [f64],
    pub(super) inputs: &'a [Inertial],
    /// NaN where nothing was measured.
    pub(super) outputs: &'a [[f64; OUTPUTS]],
    pub(super) maximum_step_s: f64,
}

impl Flight<'_> {
    /// Covariance that input noise adds to that of the unknowns of the fit, row and column as there.
    pub(super) fn input_noise(&self, fit: &BatchFit) -> DMatrix<f64> {
        let count = fit.unknowns.len();
        let variances = self.variances();
        let mut total = DMatrix::zeros(count, STATES);
        self.walk(fit, &mut |moment| total += &moment.information);
        let mut score = DMatrix::zeros(count, count);
        self.walk(fit, &mut |moment| {
            total -= &moment.information;
            let mut effect = &total * moment.impulse + &moment.direct;
            for (mut column, variance) in effect.column_iter_mut().zip(variances) {
                column *= variance.sqrt();
            }
            score += &effect * effect.transpose();
        });
        let covariance = DMatrix::from_fn(count, count, |i, j| fit.covariance[i][j]);
        &covariance * score * &covariance
    }

    /// Noise variance of each inertial sensor, from its own signal; zero for one that stands still.
    fn variances(&self) -> [f64; SENSORS] {
        std::array::from_fn(|sensor| {
            let value = |input: &Inertial| if sensor < 3 { input.force[sensor] } else { input.rate[sensor - 3] };
            let values: Vec<f64> = self.inputs.iter().map(value).collect();
            measure_noise(&values).map_or(0.0, |noise| noise.std * noise.std)
        })
    }

    /// Simulates the fitted motion and shows every sample.
    fn walk(&self, fit: &BatchFit, show: &mut dyn FnMut(&Moment)) {
        let mut theta = [0.0; PARAMETERS];
        theta.iter_mut().zip(&fit.parameters).for_each(|(s, v)| *s = *v);
        let mut x = [0.0; STATES];
        let given = fit.manoeuvres.first().map(|m| m.initial_state.as_slice()).unwrap_or_default();
        x.iter_mut().zip(given).for_each(|(s, v)| *s = *v);
        let mut phi = States::identity();
        let mut by_parameter = ByParameter::zeros();
        let mut lin = LinearizedOutputs::<STATES, OUTPUTS, PARAMETERS>::ZERO;
        for k in 0..self.time.len() {
            self.model.linearized_outputs(&x, &theta, &self.inputs[k], &mut lin);
            let (mut information, mut direct) =
                (DMatrix::zeros(fit.unknowns.len(), STATES), DMatrix::zeros(fit.unknowns.len(), SENSORS));
            for i in (0..OUTPUTS).filter(|&i| self.outputs[k][i].is_finite() && fit.noise_std[i] > 0.0) {
                let weight = fit.noise_std[i].powi(-2);
                let h = SMatrix::<f64, 1, STATES>::from_row_slice(&lin.state_jacobian[i]);
                let (by_start, by_theta) = (h * phi, h * by_parameter);
                for (row, unknown) in fit.unknowns.iter().enumerate() {
                    let j = match unknown.kind {
                        UnknownKind::Parameter { index } => by_theta[index] + lin.parameter_jacobian[i][index],
                        UnknownKind::InitialState { state, .. } => by_start[state],
                        _ => continue,
                    };
                    for state in 0..STATES {
                        information[(row, state)] += weight * j * by_start[state];
                    }
                    for sensor in 0..SENSORS {
                        direct[(row, sensor)] += weight * j * lin.parameter_jacobian[i][sensor];
                    }
                }
            }
            let mut impulse = SMatrix::zeros();
            if k + 1 < self.time.len() {
                let (transition, added) = self.interval(k, &mut x, &theta);
                phi = transition * phi;
                by_parameter = transition * by_parameter + added;
                // Kinematics can always be run backwards; a singular product is one of overflow, and shows in the fit.
                if let Some(back) = phi.try_inverse() {
                    impulse = back * added.fixed_columns::<SENSORS>(0);
                }
            }
            show(&Moment { information, direct, impulse });
        }
    }

    /// From sample `k` to the next: the state, `A` and `B`.
    fn interval(&self, k: usize, x: &mut [f64; STATES], theta: &[f64; PARAMETERS]) -> (States, ByParameter) {
        let interval_s = self.time[k + 1] - self.time[k];
        let input = IntervalInput { from: self.inputs[k], to: self.inputs[k + 1], hold: InputHold::Linear };
        let steps = sub_steps(interval_s, self.maximum_step_s);
        let mut transition = States::identity();
        let mut added = [[0.0; PARAMETERS]; STATES];
        for part in 0..steps {
            let part = Part { from: part as f64 / steps as f64, to: (part + 1) as f64 / steps as f64 };
            let mut by_state = [[0.0; STATES]; STATES];
            *x = step(self.model, x, theta, &input, interval_s, part, PARAMETERS, &mut added, &mut by_state);
            transition = States::from_fn(|i, j| by_state[i][j]) * transition;
        }
        (transition, ByParameter::from_fn(|i, j| added[i][j]))
    }
}
