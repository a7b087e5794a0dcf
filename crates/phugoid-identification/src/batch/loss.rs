//! A likelihood that outliers do not bend.
//!
//! With the residual `z` in units of one sigma, the cost of a value is
//!
//! ```text
//! rho(z) = z^2/2                        |z| <= k        as for Gaussian noise
//!          k^2/2 + k^2 ln(|z|/k)        |z| >  k        tails that fall off with the power k^2 of the distance
//! ```
//!
//! and that of one sigma itself is `beta ln sigma` with `beta = E[z rho'(z)]` for Gaussian noise, so that the level of
//! Gaussian noise is found without bias. A residual acts with the weight `rho'(z)/z = min(1, k^2/z^2)` on the parameters
//! and adds at most `k^2` to the sum that decides the level. (Huber's own loss, whose tails are exponential, lets one
//! outlier of 100 sigmas in 100 values make the level three times too large: P. J. Huber, Robust Statistics, 1981,
//! section 5.)

use crate::core::options::Likelihood;

/// `k`: of Gaussian values 0.27 % are further away. Half a percent of outliers adds at most 4.5 % to the variance.
const CORE: f64 = 3.0;
/// `beta = P(|z| <= 3) - 6 phi(3) + 9 P(|z| > 3)` of a Gaussian value.
const SHARE: f64 = 0.995_007_278_0;

/// What a residual costs, and with what weight it acts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Loss {
    /// Residuals up to this many sigmas count as those of Gaussian noise; infinite for Gaussian noise.
    core: f64,
    /// What the logarithm of one sigma costs per value.
    pub(crate) share: f64,
}

impl Loss {
    /// Of least squares.
    pub(crate) const GAUSSIAN: Self = Self { core: f64::INFINITY, share: 1.0 };

    pub(crate) fn of(likelihood: Likelihood) -> Self {
        match likelihood {
            Likelihood::Gaussian => Self::GAUSSIAN,
            Likelihood::Robust => Self { core: CORE, share: SHARE },
        }
    }

    /// `rho(z)`; NaN for NaN.
    pub(crate) fn cost(self, z: f64) -> f64 {
        let far = z.abs() / self.core;
        if far > 1.0 { self.core * self.core * (0.5 + far.ln()) } else { 0.5 * z * z }
    }

    /// `rho'(z)/z`, 0 to 1; 1 for NaN.
    pub(crate) fn weight(self, z: f64) -> f64 {
        let far = z.abs() / self.core;
        if far > 1.0 { 1.0 / (far * far) } else { 1.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_loss_is_smooth_and_its_share_is_that_of_gaussian_noise() {
        let robust = Loss::of(Likelihood::Robust);
        assert!((robust.cost(3.0) - robust.cost(3.0 + 1e-9)).abs() < 1e-8);
        let slope = (robust.cost(10.0 + 1e-6) - robust.cost(10.0 - 1e-6)) / 2e-6;
        assert!((slope - 10.0 * robust.weight(10.0)).abs() < 1e-6, "{slope}");
        assert_eq!(robust.weight(-30.0), 0.01);
        assert_eq!((robust.cost(-2.0), robust.weight(2.0)), (2.0, 1.0));
        let plain = Loss::GAUSSIAN;
        assert_eq!((plain.cost(30.0), plain.weight(30.0)), (450.0, 1.0));
        assert!(robust.cost(f64::NAN).is_nan() && robust.weight(f64::NAN) == 1.0);
        // E[z rho'(z)] by the midpoint rule.
        let step = 1e-3;
        let density = |z: f64| (-0.5 * z * z).exp() / std::f64::consts::TAU.sqrt();
        let points = (-10_000..10_000).map(|k| (f64::from(k) + 0.5) * step);
        let share: f64 = points.map(|z| step * density(z) * z * z * robust.weight(z)).sum();
        assert!((share - SHARE).abs() < 1e-7, "{share}");
    }
}
