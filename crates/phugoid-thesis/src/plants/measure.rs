//! What every plant measures.

use phugoid_estimators::{LinearizedOutputs, LinearizedRates};

/// Outputs of a plant whose rates are `lin` at `x`: all `N` states, then the rate of state `row`.
pub(super) fn measure<const N: usize, const R: usize, const P: usize>(
    x: &[f64; N],
    lin: &LinearizedRates<N, P>,
    row: usize,
    out: &mut LinearizedOutputs<N, R, P>,
) {
    const { assert!(R == N + 1, "a plant measures its states and one derivative") };
    *out = LinearizedOutputs::ZERO;
    for i in 0..N {
        out.outputs[i] = x[i];
        out.state_jacobian[i][i] = 1.0;
    }
    out.outputs[N] = lin.rates[row];
    out.state_jacobian[N] = lin.state_jacobian[row];
    out.parameter_jacobian[N] = lin.regressors[row];
}
