use super::measure::measure;
use phugoid_estimators::{LinearizedOutputs, LinearizedRates, Model};

/// Second order, `x'' = -a2 x' - a1 x + u`. Parameters `a1`, 1/s^2, and `a2`, 1/s; outputs `x`, `x'`, `x''`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SecondOrder;

impl<const P: usize> Model<2, 3, P> for SecondOrder {
    type Input = [f64; 1];

    fn parameter_count(&self) -> usize {
        2
    }

    fn rates(&self, x: &[f64; 2], theta: &[f64; P], u: &[f64; 1]) -> [f64; 2] {
        const { assert!(P >= 2, "the plant has two parameters") };
        [x[1], -theta[1] * x[1] - theta[0] * x[0] + u[0]]
    }

    fn linearized_rates(&self, x: &[f64; 2], theta: &[f64; P], u: &[f64; 1], out: &mut LinearizedRates<2, P>) {
        out.rates = Model::<2, 3, P>::rates(self, x, theta, u);
        out.state_jacobian = [[0.0, 1.0], [-theta[0], -theta[1]]];
        out.regressors = [[0.0; P]; 2];
        out.regressors[1][..2].copy_from_slice(&[-x[0], -x[1]]);
    }

    fn linearized_outputs(&self, x: &[f64; 2], theta: &[f64; P], u: &[f64; 1], out: &mut LinearizedOutputs<2, 3, P>) {
        let mut lin = LinearizedRates::ZERO;
        Model::<2, 3, P>::linearized_rates(self, x, theta, u, &mut lin);
        measure(x, &lin, 1, &mut out.outputs, &mut out.state_jacobian, &mut out.parameter_jacobian);
    }

    fn measuring_output(&self, state: usize) -> Option<usize> {
        (state < 2).then_some(state)
    }
}
