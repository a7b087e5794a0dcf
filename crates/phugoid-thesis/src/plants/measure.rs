//! What every plant measures.

use phugoid_estimators::LinearizedRates;

/// Writes what a plant measures whose rates are `lin` at `x`: all `N` states, then the rate of state `row`. The three slices are
/// the values, their derivatives by the states and those by the parameters, one entry per output: `N + 1` of each.
pub(super) fn measure<const N: usize, const P: usize>(
    x: &[f64; N],
    lin: &LinearizedRates<N, P>,
    row: usize,
    outputs: &mut [f64],
    by_state: &mut [[f64; N]],
    by_parameter: &mut [[f64; P]],
) {
    outputs[..N].copy_from_slice(x);
    by_state.fill([0.0; N]);
    by_parameter.fill([0.0; P]);
    for i in 0..N {
        by_state[i][i] = 1.0;
    }
    outputs[N] = lin.rates[row];
    by_state[N] = lin.state_jacobian[row];
    by_parameter[N] = lin.regressors[row];
}
