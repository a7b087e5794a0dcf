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

#[cfg(test)]
mod tests {
    use super::{Kreisselmeier, Rates};

    /// The row of a state holds its own rates and the columns in use, whatever the others are: each column is what it is
    /// when it stands alone, no column beyond those in use is touched, and a state that is not measured only forgets.
    #[test]
    fn every_column_is_what_it_is_alone() {
        let rates = |t: f64| Rates::<2, 5> {
            known: [0.3 - t, 1.0 + 0.2 * t],
            regressors: core::array::from_fn(|i| core::array::from_fn(|j| 1.0 + i as f64 - j as f64 * t)),
        };
        // Of libm, whose last bit is the same each time: that of the standard library is not under Miri.
        let state = |t: f64| [libm::sin(t), if t > 0.25 { f64::NAN } else { libm::cos(t) }];
        let run = |own: usize, only: Option<usize>| {
            let mut filter = Kreisselmeier::<2, 5>::new(2.0);
            for k in 0..6 {
                let times = [0.1 * f64::from(k), 0.1 * f64::from(k + 1)];
                let mut rates = times.map(rates);
                if let Some(only) = only {
                    for row in rates.iter_mut().flat_map(|rates| &mut rates.regressors) {
                        row[0] = row[only];
                    }
                }
                filter.advance(0.1, own, [&state(times[0]), &state(times[1])], [&rates[0], &rates[1]]);
            }
            filter
        };
        for own in 0..=5 {
            let together = run(own, None);
            for i in 0..2 {
                let (z, columns) = together.of_state(i);
                assert!(columns[own..].iter().all(|column| *column == 0.0));
                for (j, column) in columns[..own].iter().enumerate() {
                    let alone = run(1, Some(j)).of_state(i);
                    assert_eq!((z, *column), (alone.0, alone.1[0]));
                    assert!(*column != 0.0);
                }
            }
        }
        // Two intervals of 0.1 s were measured; over the other four 0.1 s are forgotten at 2 per second.
        let mut measured = Kreisselmeier::<2, 5>::new(2.0);
        for k in 0..2 {
            let times = [0.1 * f64::from(k), 0.1 * f64::from(k + 1)];
            measured.advance(0.1, 5, [&state(times[0]), &state(times[1])], [&rates(times[0]), &rates(times[1])]);
        }
        let expected = measured.of_state(1).0 * libm::exp(-0.8);
        assert!((run(5, None).of_state(1).0 - expected).abs() < 1e-14);
    }
}
