//! Rows of a regression without derivatives, after G. Kreisselmeier (IEEE TAC 22, 1977).

use super::flow::Flow;
use super::pole::{Complex, Weights};
use super::source::StateSource;
use crate::kernels::add_scaled;
use crate::model::Model;

/// One row `z = w theta + n` of a regression.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Row<const P: usize> {
    /// The output that it rests on.
    pub output: usize,
    /// Left hand side, output units.
    pub z: f64,
    /// Regressors, output units per parameter unit.
    pub w: [f64; P],
    /// What the output is when `z` is: `y = z + known`.
    pub known: f64,
    /// One sigma of `n`, output units.
    pub std: f64,
}

/// The filters of the dynamic rows.
///
/// With `x' = f + Phi theta` and the window `e^{-w(T-t)}`, zero where the state was not measured for long,
///
/// ```text
/// z   = int (x' - f) e^{-w(T-t)} dt  =  [x e^{-w(T-t)}] - int (w x + f) e^{-w(T-t)} dt
/// Ups = int Phi e^{-w(T-t)} dt,           z = Ups theta
/// ```
///
/// The filter is exact for signals that run straight between samples. The noise of `z` is that of the measured state
/// less its low-pass part.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Kreisselmeier<const N: usize, const P: usize> {
    pole: f64,
    z: [f64; N],
    upsilon: [[f64; P]; N],
    weights: Weights,
    interval_s: f64,
}

impl<const N: usize, const P: usize> Kreisselmeier<N, P> {
    pub(crate) fn new(filter_rate: f64) -> Self {
        let pole = -filter_rate;
        let weights = Weights::new(Complex::real(pole), 0.0);
        Self { pole, z: [0.0; N], upsilon: [[0.0; P]; N], weights, interval_s: 0.0 }
    }

    /// Forgets everything.
    pub(crate) fn clear(&mut self) {
        self.z = [0.0; N];
        self.upsilon = [[0.0; P]; N];
    }

    /// Takes the last interval of the flow.
    pub(crate) fn advance<M, S, const R: usize>(&mut self, flow: &Flow<M, S, N, R, P>)
    where
        M: Model<N, R, P>,
        S: StateSource<M::Input, N, R>,
    {
        let h = flow.interval_s;
        // Sampling times carry rounding; weights for a nanosecond more are the same.
        if (h - self.interval_s).abs() > 1e-9 * h {
            self.weights = Weights::new(Complex::real(self.pole), h);
            self.interval_s = h;
        }
        let (decay, c0, c1) = (self.weights.decay.re, self.weights.before.re, self.weights.after.re);
        let p = flow.columns.own;
        for i in 0..N {
            let (x0, x1) = (flow.measured_before[i], flow.measured_after[i]);
            self.z[i] *= decay;
            for u in &mut self.upsilon[i][..p] {
                *u *= decay;
            }
            if !(x0.is_finite() && x1.is_finite()) {
                continue;
            }
            let rate = |x: f64, known: f64| self.pole * x - known;
            self.z[i] += x1 - decay * x0 + c0 * rate(x0, flow.before.known[i]) + c1 * rate(x1, flow.after.known[i]);
            add_scaled(&mut self.upsilon[i][..p], c0, &flow.before.regressors[i][..p]);
            add_scaled(&mut self.upsilon[i][..p], c1, &flow.after.regressors[i][..p]);
        }
    }

    /// Gives the rows of the last frame to `use_row`, the algebraic ones first.
    pub(crate) fn rows<M, S, const R: usize>(&self, flow: &Flow<M, S, N, R, P>, mut use_row: impl FnMut(&Row<P>))
    where
        M: Model<N, R, P>,
        S: StateSource<M::Input, N, R>,
    {
        let own = flow.columns.own;
        for output in 0..R {
            let measured = flow.believed[output];
            if measured.is_finite() && flow.is_algebraic(output) {
                let known = flow.outputs.outputs[output];
                let std = flow.settings.common.noise_std[output];
                let mut row = Row { output, z: measured - known, w: [0.0; P], known, std };
                row.w[..own].copy_from_slice(&flow.outputs.parameter_jacobian[output][..own]);
                if let Some(column) = flow.columns.bias_of_output[output] {
                    row.w[column] = 1.0;
                }
                use_row(&row);
            }
        }
        for state in 0..N {
            let (before, after) = (flow.measured_before[state], flow.measured_after[state]);
            let Some(output) = flow.columns.output_of_state[state] else { continue };
            if before.is_finite() && flow.believed[output].is_finite() && flow.is_dynamic(state) {
                let std = flow.settings.common.noise_std[output];
                use_row(&Row { output, z: self.z[state], w: self.upsilon[state], known: after - self.z[state], std });
            }
        }
    }
}
