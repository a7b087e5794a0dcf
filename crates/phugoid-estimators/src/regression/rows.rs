//! Rows of a regression without derivatives, after G. Kreisselmeier (IEEE TAC 22, 1977).

use super::pole::{Complex, Weights};
use crate::kernels::add_scaled;

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

/// Known rates and regressors at one instant.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Rates<const N: usize, const P: usize> {
    /// Known rates `f(x, u)`, state units per second.
    pub(crate) known: [f64; N],
    /// Regressors `Phi(x, u)`, row = rate, column = parameter.
    pub(crate) regressors: [[f64; P]; N],
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

    /// Empties the filters: nothing before the next interval is remembered.
    pub(crate) fn clear(&mut self) {
        self.z = [0.0; N];
        self.upsilon = [[0.0; P]; N];
    }

    /// Takes an interval of `h` s. `x`: measured states at its start and its end, NaN where not measured; `rates`:
    /// known rates and regressors there, of which the first `own` columns are used.
    pub(crate) fn advance(&mut self, h: f64, own: usize, x: [&[f64; N]; 2], rates: [&Rates<N, P>; 2]) {
        // Sampling times carry rounding; weights for a nanosecond more are the same.
        if (h - self.interval_s).abs() > 1e-9 * h {
            self.weights = Weights::new(Complex::real(self.pole), h);
            self.interval_s = h;
        }
        let (decay, c0, c1) = (self.weights.decay.re, self.weights.before.re, self.weights.after.re);
        let [before, after] = rates;
        for i in 0..N {
            let (x0, x1) = (x[0][i], x[1][i]);
            self.z[i] *= decay;
            for u in &mut self.upsilon[i][..own] {
                *u *= decay;
            }
            if !(x0.is_finite() && x1.is_finite()) {
                continue;
            }
            let rate = |x: f64, known: f64| self.pole * x - known;
            self.z[i] += x1 - decay * x0 + c0 * rate(x0, before.known[i]) + c1 * rate(x1, after.known[i]);
            add_scaled(&mut self.upsilon[i][..own], c0, &before.regressors[i][..own]);
            add_scaled(&mut self.upsilon[i][..own], c1, &after.regressors[i][..own]);
        }
    }

    /// Left hand side and regressors of the row of a state.
    pub(crate) fn of_state(&self, state: usize) -> (f64, [f64; P]) {
        (self.z[state], self.upsilon[state])
    }
}
