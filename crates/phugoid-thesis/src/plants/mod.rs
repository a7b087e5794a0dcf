//! The four proof-of-concept plants of the thesis, as models: two of first and two of second order, linear and not.
//!
//! Times are seconds; states, inputs and parameters are pure numbers. Every plant measures all its states and, as its last
//! output, the derivative that the printed sliding-mode laws need. An estimator that needs none is given NaN there.
//!
//! | plant | states | parameters | input | outputs |
//! |---|---|---|---|---|
//! | [`FirstOrder`] | `x` | `a` | `u` | `x, x'` |
//! | [`FirstOrderNonlinear`] | `x, y` | `a` | `u, sin(w t)` | `x, y, x'` |
//! | [`SecondOrder`] | `x, x'` | `a1, a2` | `u` | `x, x', x''` |
//! | [`SecondOrderNonlinear`] | `x, x'` | `a1, a2` | `u` | `x, x', x''` |
//!
//! The text of the thesis at hand has lost its minus signs; they are restored from its derivations.

mod first_order;
mod first_order_nonlinear;
mod second_order;
mod second_order_nonlinear;

pub use first_order::FirstOrder;
pub use first_order_nonlinear::FirstOrderNonlinear;
pub use second_order::SecondOrder;
pub use second_order_nonlinear::SecondOrderNonlinear;

use phugoid_estimators::{LinearizedOutputs, LinearizedRates};

/// Outputs of a plant whose rates are `lin` at `x`: all `N` states, then the rate of state `row`.
fn measure<const N: usize, const R: usize, const P: usize>(
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
