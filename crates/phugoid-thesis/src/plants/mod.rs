//! The four proof-of-concept plants of the thesis, as models: two of first and two of second order, linear and not; and plants of
//! a user's own, given by formulas ([`OwnPlant`]).
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
mod measure;
mod own;
mod second_order;
mod second_order_nonlinear;

pub use first_order::FirstOrder;
pub use first_order_nonlinear::FirstOrderNonlinear;
pub use own::{MOST_PARAMETERS, MOST_STATES, OwnPlant};
pub use second_order::SecondOrder;
pub use second_order_nonlinear::SecondOrderNonlinear;
