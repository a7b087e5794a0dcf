//! One equation of the regression, transformed at every frequency.

use crate::regression::{Complex, Weights};
use crate::settings::MAXIMUM_BINS;

/// The frequencies and what one interval does at each.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bins {
    count: usize,
    /// `s = j omega - lambda`, 1/s.
    pub(super) pole: [Complex; MAXIMUM_BINS],
    pub(super) weights: [Weights; MAXIMUM_BINS],
    /// Forgetting rate `lambda`, 1/s.
    pub(super) forgetting: f64,
    interval_s: f64,
}

impl Bins {
    pub(super) fn new(count: usize, forgetting: f64, frequency_hz: impl Fn(usize) -> f64) -> Self {
        let pole = core::array::from_fn(|m| {
            let hz = if m < count { frequency_hz(m) } else { 0.0 };
            Complex::new(-forgetting, 2.0 * core::f64::consts::PI * hz)
        });
        let weights = core::array::from_fn(|_| Weights::new(Complex::default(), 0.0));
        Self { count, pole, weights, forgetting, interval_s: 0.0 }
    }

    pub(super) fn set_interval(&mut self, h: f64) {
        // Sampling times carry rounding; weights for a nanosecond more are the same.
        if (h - self.interval_s).abs() > 1e-9 * h {
            for m in 0..self.count() {
                self.weights[m] = Weights::new(self.pole[m], h);
            }
            self.interval_s = h;
        }
    }

    /// Number of frequencies, at most [`MAXIMUM_BINS`].
    #[inline(always)]
    pub(super) fn count(&self) -> usize {
        self.count.min(MAXIMUM_BINS)
    }

    /// Width of the band, from the lowest frequency to the highest one, rad/s.
    pub(super) fn width(&self) -> f64 {
        let used = &self.pole[..self.count()];
        used.last().map_or(0.0, |pole| pole.im) - used.first().map_or(0.0, |pole| pole.im)
    }

    pub(super) fn interval_s(&self) -> f64 {
        self.interval_s
    }
}

/// A signal's transform `int g(t) e^{s(T-t)} dt`, referred to the present time `T`.
pub(super) type Transform = [Complex; MAXIMUM_BINS];

/// One interval of `transform`, the signal running straight from `before` to `after`.
pub(super) fn add(transform: &mut Transform, bins: &Bins, before: f64, after: f64) {
    for (y, w) in transform[..bins.count()].iter_mut().zip(&bins.weights) {
        let decayed = y.times(w.decay);
        *y = Complex::new(
            decayed.re + before * w.before.re + after * w.after.re,
            decayed.im + before * w.before.im + after * w.after.im,
        );
    }
}

/// Transforms of both sides of `z = w theta`, with what is known of the noise.
#[derive(Clone, Copy, Debug)]
pub(super) struct Equation<const P: usize> {
    pub(super) z: Transform,
    pub(super) w: [Transform; P],
    /// Columns that have ever been other than zero.
    pub(super) used: [bool; P],
    /// One sigma of the measurement, output units.
    pub(super) std: f64,
    /// Sum of the squared intervals, faded: the noise of a transform is `std^2` times this.
    pub(super) energy: f64,
    /// Squared size of the ends of stretches inside the record: each leaves one measurement's noise in the transform.
    pub(super) seams: f64,
    /// `e^{s(T - t0)}`: how the noise of the first measurement enters; zero before there is one.
    pub(super) first: Transform,
    /// Whether the record has begun, and whether the last frame was measured.
    begun: bool,
    open: bool,
    /// Variance of the residual over what the noise levels promise, at least one.
    pub(super) excess: f64,
}

impl<const P: usize> Equation<P> {
    pub(super) fn new() -> Self {
        let nothing = [Complex::default(); MAXIMUM_BINS];
        Self {
            z: nothing,
            w: [nothing; P],
            used: [false; P],
            std: 0.0,
            energy: 0.0,
            seams: 0.0,
            first: nothing,
            begun: false,
            open: false,
            excess: 1.0,
        }
    }

    /// True if there is anything to learn from.
    pub(super) fn has_data(&self) -> bool {
        self.energy > 0.0 && self.std > 0.0 && self.used.contains(&true)
    }

    /// True if the last frame belongs to it.
    pub(super) fn is_open(&self) -> bool {
        self.open
    }

    /// An interval that is not measured at both ends: the window is zero there.
    pub(super) fn skip(&mut self, bins: &Bins, columns: usize) {
        self.close();
        if !self.begun {
            return;
        }
        self.fade(bins);
        for (w, _) in self.w.iter_mut().zip(&self.used).take(columns).filter(|(_, used)| **used) {
            add(w, bins, 0.0, 0.0);
        }
        add(&mut self.z, bins, 0.0, 0.0);
    }

    /// Ends the running stretch; the next one follows without time between.
    pub(super) fn close(&mut self) {
        if self.open {
            self.seams += 1.0;
            self.open = false;
        }
    }

    fn fade(&mut self, bins: &Bins) {
        let h = bins.interval_s();
        let fading = libm::exp(-2.0 * bins.forgetting * h);
        self.energy *= fading;
        self.seams *= fading;
        add(&mut self.first, bins, 0.0, 0.0);
    }

    /// An interval that is measured at both ends. `regressors` at its start and its end.
    fn add_regressors(&mut self, bins: &Bins, columns: usize, before: &[f64; P], after: &[f64; P]) {
        if !self.open {
            self.open = true;
            if self.begun {
                self.seams += 1.0;
            } else {
                self.begun = true;
                self.first[..bins.count()].fill(Complex::real(1.0));
            }
        }
        self.fade(bins);
        let h = bins.interval_s();
        self.energy += h * h;
        for j in 0..columns.min(P) {
            self.used[j] |= before[j] != 0.0 || after[j] != 0.0;
            if self.used[j] {
                add(&mut self.w[j], bins, before[j], after[j]);
            }
        }
    }

    /// Algebraic equation: `z` at both ends.
    pub(super) fn add_algebraic(
        &mut self,
        bins: &Bins,
        columns: usize,
        z: [f64; 2],
        before: &[f64; P],
        after: &[f64; P],
    ) {
        self.add_regressors(bins, columns, before, after);
        add(&mut self.z, bins, z[0], z[1]);
    }

    /// Dynamic equation: state and known rate at both ends.
    ///
    /// `int x' e^{s(T-t)} dt = x(T) - x(0) e^{sT} + s int x e^{s(T-t)} dt`, the end-point term interval by interval.
    #[allow(clippy::too_many_arguments)]
    pub(super) fn add_dynamic(
        &mut self,
        bins: &Bins,
        columns: usize,
        x: [f64; 2],
        known: [f64; 2],
        before: &[f64; P],
        after: &[f64; P],
        end_point: bool,
    ) {
        self.add_regressors(bins, columns, before, after);
        let mut z = self.z;
        add(&mut z, bins, -known[0], -known[1]);
        for m in 0..bins.count() {
            let w = &bins.weights[m];
            let transformed = w.before.scaled(x[0]).plus(w.after.scaled(x[1]));
            z[m] = z[m].plus(bins.pole[m].times(transformed));
            if end_point {
                z[m] = z[m].plus(Complex::real(x[1])).plus(w.decay.scaled(-x[0]));
            }
        }
        self.z = z;
    }
}
