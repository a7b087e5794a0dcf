use super::measure::measure;
use phugoid_estimators::{LinearizedOutputs, LinearizedRates, Model};

/// First order, `x' = -a x + u`. Parameter `a`, 1/s; outputs `x`, `x'`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FirstOrder;

impl<const P: usize> Model<1, 2, P> for FirstOrder {
    type Input = [f64; 1];

    fn parameter_count(&self) -> usize {
        1
    }

    fn rates(&self, x: &[f64; 1], theta: &[f64; P], u: &[f64; 1]) -> [f64; 1] {
        const { assert!(P >= 1, "the plant has one parameter") };
        [-theta[0] * x[0] + u[0]]
    }

    fn linearized_rates(&self, x: &[f64; 1], theta: &[f64; P], u: &[f64; 1], out: &mut LinearizedRates<1, P>) {
        out.rates = Model::<1, 2, P>::rates(self, x, theta, u);
        out.state_jacobian = [[-theta[0]]];
        out.regressors = [[0.0; P]];
        out.regressors[0][0] = -x[0];
    }

    fn linearized_outputs(&self, x: &[f64; 1], theta: &[f64; P], u: &[f64; 1], out: &mut LinearizedOutputs<1, 2, P>) {
        let mut lin = LinearizedRates::ZERO;
        Model::<1, 2, P>::linearized_rates(self, x, theta, u, &mut lin);
        measure(x, &lin, 0, &mut out.outputs, &mut out.state_jacobian, &mut out.parameter_jacobian);
    }

    fn measuring_output(&self, state: usize) -> Option<usize> {
        (state == 0).then_some(0)
    }
}
