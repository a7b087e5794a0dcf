//! Regression without derivatives: what recursive least squares, the recursive Fourier regression and the teaching
//! modes share.
//!
//! The plant `x' = f + Phi theta`, `y = h0 + D theta` is read as two kinds of equations, linear in the parameters, at
//! states that a [`StateSource`] supplies:
//!
//! ```text
//! algebraic   y_i - h0_i = D_i theta + n                      an accelerometer sees lift and drag at once
//! dynamic     int (x_i' - f_i) k(T-t) dt = int Phi_i k(T-t) dt theta + n'
//! ```
//!
//! The kernel `k` spares the derivative: `int x' k = [x k] - int x k'` needs the measured state alone. Kernels of one
//! pole (`e^{s(T-t)}`) are first-order filters; `s = -w` is Kreisselmeier's regression, `s = j omega` Fourier's. Which
//! equations there are follows from the model: every used output that sees a parameter, and every measured state driven
//! by a parameter that no output sees. Each interval is integrated with the input that acted during it. A missing
//! measurement makes no row. A state that is missing for a moment goes on as the source has it; for longer the kernel's
//! window is zero, which keeps both sides of the equation equal.
//!
//! [`rls`](crate::rls) and [`fourier`](crate::fourier) say when to use them and where they fail.

mod claim;
mod equations;
mod gate;
mod pole;
mod row_source;
mod rows;
mod source;

pub use equations::Regression;
pub use rows::Row;
pub use source::{MeasuredStates, SourceStep, StateError, StateSource};

pub(crate) use claim::Claim;
pub(crate) use pole::{Complex, Weights};
pub(crate) use row_source::{Frame, RowSource, Taken};
