//! A first-order filter with one real or complex pole, exact for signals that run straight between samples.
//!
//! ```text
//! Y' = s Y + g      =>      Y(t + h) = e^{sh} Y(t) + c0 g(t) + c1 g(t + h)
//! c0 + c1 = (e^{sh} - 1)/s,      c1 = h phi_2(sh),      phi_2(k) = (e^k - 1 - k)/k^2
//! ```
//!
//! With `s = -w` it is the low-pass filter of Kreisselmeier's regression, with `s = j omega - lambda` the recursive
//! Fourier transform with exponential forgetting, referred to the present time.

/// A complex number; real ones have an exact zero as imaginary part and keep it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Complex {
    pub(crate) re: f64,
    pub(crate) im: f64,
}

impl Complex {
    pub(crate) const fn new(re: f64, im: f64) -> Self {
        Self { re, im }
    }

    pub(crate) const fn real(re: f64) -> Self {
        Self { re, im: 0.0 }
    }

    #[inline]
    pub(crate) fn plus(self, other: Self) -> Self {
        Self::new(self.re + other.re, self.im + other.im)
    }

    #[inline]
    pub(crate) fn times(self, other: Self) -> Self {
        Self::new(self.re * other.re - self.im * other.im, self.re * other.im + self.im * other.re)
    }

    #[inline]
    pub(crate) fn scaled(self, factor: f64) -> Self {
        Self::new(factor * self.re, factor * self.im)
    }

    pub(crate) fn squared_size(self) -> f64 {
        self.re * self.re + self.im * self.im
    }

    fn exp(self) -> Self {
        let size = libm::exp(self.re);
        if self.im == 0.0 {
            return Self::real(size);
        }
        Self::new(size * libm::cos(self.im), size * libm::sin(self.im))
    }

    fn over(self, other: Self) -> Self {
        let conjugate = Self::new(other.re, -other.im);
        self.times(conjugate).scaled(1.0 / other.squared_size())
    }
}

/// What one interval does to the filter and to its inputs.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Weights {
    /// Factor `e^{sh}` by which the filter decays in the interval.
    pub(crate) decay: Complex,
    /// `c0`, s: of the input at the start of the interval.
    pub(crate) before: Complex,
    /// `c1`, s: of the input at its end.
    pub(crate) after: Complex,
}

impl Weights {
    /// For the pole `s` (1/s) and the interval `h` (s).
    pub(crate) fn new(s: Complex, h: f64) -> Self {
        let k = s.scaled(h);
        let decay = k.exp();
        let (phi1, phi2) = if k.squared_size() < 0.25 {
            // Sums of k^n/(n+1)! and k^n/(n+2)!: the closed form would cancel. 0.5^14/15! is far below rounding.
            let (mut phi1, mut phi2) = (Complex::default(), Complex::default());
            let mut power = Complex::real(1.0);
            for n in 1..=14 {
                let n = f64::from(n);
                // power = k^(n-1)/n!
                phi1 = phi1.plus(power);
                phi2 = phi2.plus(power.scaled(1.0 / (n + 1.0)));
                power = power.times(k).scaled(1.0 / (n + 1.0));
            }
            (phi1, phi2)
        } else {
            let one = Complex::real(-1.0);
            let phi1 = decay.plus(one).over(k);
            (phi1, phi1.plus(one).over(k))
        };
        let after = phi2.scaled(h);
        Self { decay, before: phi1.scaled(h).plus(after.scaled(-1.0)), after }
    }
}

#[cfg(test)]
mod tests {
    use super::{Complex, Weights};

    /// `int_0^h g(t) e^{s(h-t)} dt` of a straight line by a fine midpoint sum.
    fn reference(s: Complex, h: f64, from: f64, to: f64) -> Complex {
        let n = 20_000;
        let step = h / f64::from(n);
        (0..n).fold(Complex::default(), |sum, i| {
            let t = (f64::from(i) + 0.5) * step;
            let value = from + (to - from) * t / h;
            sum.plus(s.scaled(h - t).exp().scaled(value * step))
        })
    }

    #[test]
    fn a_straight_line_is_filtered_exactly() {
        for s in [Complex::real(-3.0), Complex::real(0.0), Complex::new(0.0, 9.4), Complex::new(-0.5, 60.0)] {
            for h in [0.01, 0.1, 0.5] {
                let w = Weights::new(s, h);
                let got = w.before.scaled(2.0).plus(w.after.scaled(-1.0));
                let expected = reference(s, h, 2.0, -1.0);
                // The midpoint sum itself is good to (|s| h / 20000)^2.
                assert!(got.plus(expected.scaled(-1.0)).squared_size().sqrt() < 1e-6 * h, "{s:?} {h}");
                assert_eq!(w.after.im == 0.0, s.im == 0.0);
            }
        }
    }

    #[test]
    fn series_and_closed_form_meet() {
        let s = Complex::new(-1.0, 3.0);
        let h = 0.5 / s.squared_size().sqrt();
        let (below, above) = (Weights::new(s, h * (1.0 - 1e-13)), Weights::new(s, h * (1.0 + 1e-13)));
        for (a, b) in [(below.before, above.before), (below.after, above.after), (below.decay, above.decay)] {
            assert!(a.plus(b.scaled(-1.0)).squared_size().sqrt() < 1e-12 * h.max(1.0));
        }
    }
}
