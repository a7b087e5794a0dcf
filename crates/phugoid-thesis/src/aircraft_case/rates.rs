//! The longitudinal motion with its rates among the outputs.

use phugoid_estimators::{LinearizedOutputs, LinearizedRates, Model};
use phugoid_identification::longitudinal::{LongitudinalInput, LongitudinalModel, STATES};

/// Outputs of [`WithRates`]: V, alpha, theta, q (SI), then their rates in the same order.
pub(super) const OUTPUTS_WITH_RATES: usize = 2 * STATES;

/// A longitudinal model whose outputs are its states and their rates, as the printed laws want them: they are told the
/// rates of the reference aircraft.
#[derive(Clone, Debug)]
pub(super) struct WithRates(pub(super) LongitudinalModel);

impl<const P: usize> Model<STATES, OUTPUTS_WITH_RATES, P> for WithRates {
    type Input = LongitudinalInput;

    fn parameter_count(&self) -> usize {
        self.0.columns().len().min(P)
    }

    fn rates(&self, x: &[f64; STATES], theta: &[f64; P], u: &Self::Input) -> [f64; STATES] {
        self.0.rates(x, theta, u)
    }

    fn linearized_rates(
        &self,
        x: &[f64; STATES],
        theta: &[f64; P],
        u: &Self::Input,
        out: &mut LinearizedRates<STATES, P>,
    ) {
        self.0.linearized_rates(x, theta, u, out);
    }

    fn linearized_outputs(
        &self,
        x: &[f64; STATES],
        theta: &[f64; P],
        u: &Self::Input,
        out: &mut LinearizedOutputs<STATES, OUTPUTS_WITH_RATES, P>,
    ) {
        let mut rates = LinearizedRates::ZERO;
        self.0.linearized_rates(x, theta, u, &mut rates);
        *out = LinearizedOutputs::ZERO;
        for i in 0..STATES {
            out.outputs[i] = x[i];
            out.state_jacobian[i][i] = 1.0;
            out.outputs[STATES + i] = rates.rates[i];
            out.state_jacobian[STATES + i] = rates.state_jacobian[i];
            out.parameter_jacobian[STATES + i] = rates.regressors[i];
        }
    }

    fn measuring_output(&self, state: usize) -> Option<usize> {
        (state < STATES).then_some(state)
    }
}
