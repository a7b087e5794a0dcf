//! Dryden turbulence: a random gust field of the military standards, exact at any sample time.
//!
//! The spectra are those of MIL-F-8785C, 3.7.2. MIL-HDBK-1797 writes the same ones with lateral and vertical scale lengths
//! of half the size, so that there is nothing to choose. With `tau = L/V` and white noise of unit intensity the forming
//! filters are
//!
//! ```text
//! u, along x    sigma_u sqrt(2 tau_u) / (1 + tau_u s)
//! v, along y    sigma_v sqrt(tau_v) (1 + sqrt(3) tau_v s) / (1 + tau_v s)^2
//! w, along z    sigma_w sqrt(tau_w) (1 + sqrt(3) tau_w s) / (1 + tau_w s)^2
//! p             sqrt(pi/V sigma_w^2/L_w 0.8 (pi L_w/4b)^(1/3)) / (1 + 4b/(pi V) s)
//! q             -(s/V) w / (1 + 4b/(pi V) s)
//! r              (s/V) v / (1 + 3b/(pi V) s)
//! ```
//!
//! The rates are those of air that turns with the aircraft's axes as a rigid body would: `w = -q x` and `v = r x` along the
//! fuselage, hence the signs. The field is frozen and flown through at the airspeed V.
//!
//! Each filter is a linear system `x' = A x + B n`. From one sample to the next its state is `exp(A h) x` plus a normal
//! variable of covariance `integral of exp(A t) B B^T exp(A^T t)` over the interval; it starts in its stationary
//! distribution. Samples therefore have the variances and covariances of the continuous process whatever the sample time.

use nalgebra::{SMatrix, SVector};
use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64Mcg;

use crate::gust::AirMotion;

/// Metres per foot, exact.
pub(crate) const FOOT: f64 = 0.3048;

/// How often the intensity of turbulence at medium and high altitude is exceeded: the three of MIL-F-8785C, 3.7.3.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Intensity {
    /// One part in 100 of the time.
    Light,
    /// Exceeded one part in 1000 of the time.
    Moderate,
    /// Exceeded one part in 100,000 of the time.
    Severe,
}

/// Altitudes (ft) and, for light, moderate and severe turbulence, root mean squares of the vertical gust (ft/s): points read
/// off the curves of MIL-F-8785C, figure 7.
const EXCEEDANCE: [(f64, [f64; 3]); 12] = [
    (500.0, [6.6, 8.6, 15.6]),
    (1750.0, [6.9, 9.6, 17.6]),
    (3750.0, [7.4, 10.6, 23.0]),
    (7500.0, [6.7, 10.1, 23.6]),
    (15_000.0, [4.6, 8.0, 22.1]),
    (25_000.0, [2.7, 6.6, 20.0]),
    (35_000.0, [0.4, 5.0, 16.0]),
    (45_000.0, [0.0, 4.2, 15.1]),
    (55_000.0, [0.0, 2.7, 12.1]),
    (65_000.0, [0.0, 0.0, 7.9]),
    (75_000.0, [0.0, 0.0, 6.2]),
    (80_000.0, [0.0, 0.0, 5.1]),
];

/// Scale lengths and root mean squares of a turbulence field.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DrydenField {
    /// Scale lengths along x, y, z, m, as MIL-F-8785C defines them.
    pub scale_length: [f64; 3],
    /// Root mean square velocity of the air along x, y, z, m/s.
    pub sigma: [f64; 3],
}

impl DrydenField {
    /// The standard's field of an intensity at a height above the ground (m): the low-altitude model below 1000 ft, with a
    /// wind at 20 ft of 15, 30 or 45 kt (3.7.3.4); the medium- and high-altitude one above 2000 ft, isotropic with a scale of
    /// 1750 ft; between them linear in the height.
    pub fn standard(intensity: Intensity, height: f64) -> Self {
        let feet = height / FOOT;
        if feet < 1000.0 {
            Self::low(intensity, feet)
        } else if feet <= 2000.0 {
            let (low, high) = (Self::low(intensity, 1000.0), Self::high(intensity, 2000.0));
            let part = (feet - 1000.0) / 1000.0;
            let between = |a: [f64; 3], b: [f64; 3]| core::array::from_fn(|i| a[i] + part * (b[i] - a[i]));
            Self { scale_length: between(low.scale_length, high.scale_length), sigma: between(low.sigma, high.sigma) }
        } else {
            Self::high(intensity, feet)
        }
    }

    /// A field whose vertical gust has this root mean square (m/s), with scale lengths and proportions of the standard at
    /// the height (m).
    #[must_use]
    pub fn of_sigma(sigma: f64, height: f64) -> Self {
        // Scale lengths and, up to 2000 ft, proportions; the intensity itself cancels where all three are equal.
        let feet = height / FOOT;
        let standard = Self::standard(Intensity::Light, height);
        let ratio = if feet > 2000.0 { [1.0; 3] } else { standard.sigma.map(|s| s / standard.sigma[2]) };
        Self { scale_length: standard.scale_length, sigma: ratio.map(|r| r * sigma) }
    }

    /// MIL-F-8785C, 3.7.3.4 and figures 10 and 11; the height is limited to the 10 ft where they begin.
    fn low(intensity: Intensity, feet: f64) -> Self {
        const KNOT: f64 = 1852.0 / 3600.0;
        let wind_at_20_ft = match intensity {
            Intensity::Light => 15.0 * KNOT,
            Intensity::Moderate => 30.0 * KNOT,
            Intensity::Severe => 45.0 * KNOT,
        };
        let h = feet.max(10.0);
        let shape = 0.177 + 0.000_823 * h;
        let horizontal = h / shape.powf(1.2) * FOOT;
        let vertical = 0.1 * wind_at_20_ft;
        let along = vertical / shape.powf(0.4);
        Self { scale_length: [horizontal, horizontal, h * FOOT], sigma: [along, along, vertical] }
    }

    /// MIL-F-8785C, 3.7.2.1 and figure 7.
    fn high(intensity: Intensity, feet: f64) -> Self {
        let sigma = exceedance(intensity, feet) * FOOT;
        Self { scale_length: [1750.0 * FOOT; 3], sigma: [sigma; 3] }
    }
}

/// Root mean square gust, ft/s, of figure 7 at an altitude in feet; the ends of the curves continue as they are.
fn exceedance(intensity: Intensity, feet: f64) -> f64 {
    let column = match intensity {
        Intensity::Light => 0,
        Intensity::Moderate => 1,
        Intensity::Severe => 2,
    };
    let after = EXCEEDANCE.partition_point(|(altitude, _)| *altitude <= feet);
    let row = |index: usize| EXCEEDANCE.get(index).map(|(altitude, sigma)| (*altitude, sigma[column]));
    match (after.checked_sub(1).and_then(row), row(after)) {
        (Some((h0, s0)), Some((h1, s1))) => s0 + (s1 - s0) * (feet - h0) / (h1 - h0),
        (Some((_, s)), None) | (None, Some((_, s))) => s,
        (None, None) => 0.0,
    }
}

/// Turbulence along a flight path, one call of [`Dryden::sample`] per sample time.
///
/// ```
/// use phugoid_flight_dynamics::dryden::{Dryden, DrydenField, Intensity};
///
/// let field = DrydenField::standard(Intensity::Moderate, 6096.0);
/// // 205.74 m/s, a span of 9.144 m, 100 samples per second. The seed decides everything random.
/// let gusts = |seed| -> Result<Vec<f64>, _> {
///     let mut air = Dryden::new(field, 205.74, 9.144, 0.01, seed)?;
///     Ok((0..100).map(|_| air.sample().velocity[2]).collect())
/// };
/// assert_eq!(gusts(1)?, gusts(1)?);
/// assert_ne!(gusts(1)?, gusts(2)?);
/// # Ok::<(), phugoid_flight_dynamics::dryden::DrydenError>(())
/// ```
#[derive(Clone, Debug)]
pub struct Dryden {
    random: Pcg64Mcg,
    along: Filter<1>,
    lateral: Filter<3>,
    vertical: Filter<3>,
    roll: Filter<1>,
}

/// A field that cannot be sampled, of Dryden or of von Karman.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("turbulence: {what} is {value}, expected {expected}")]
pub struct DrydenError {
    /// What is out of range.
    pub what: &'static str,
    /// The number that was given, SI units.
    pub value: f64,
    /// The numbers that are allowed, in words.
    pub expected: &'static str,
}

impl Dryden {
    /// Turbulence met at a constant airspeed (m/s) by an aircraft of this wing span (m), sampled every `sample_time` (s).
    /// The same seed gives the same gusts on every machine.
    ///
    /// # Errors
    /// [`DrydenError`] names the number that is out of range.
    pub fn new(field: DrydenField, airspeed: f64, span: f64, sample_time: f64, seed: u64) -> Result<Self, DrydenError> {
        check(&field, airspeed, span, sample_time)?;
        let [tau_u, tau_v, tau_w] = field.scale_length.map(|l| l / airspeed);
        let [sigma_u, sigma_v, sigma_w] = field.sigma;
        let pi = core::f64::consts::PI;
        let (tau_pitch, tau_yaw) = (4.0 * span / (pi * airspeed), 3.0 * span / (pi * airspeed));
        let roll_gain = roll_gain(&field, airspeed, span);
        let mut random = Pcg64Mcg::seed_from_u64(seed);
        let along = lag(sigma_u * (2.0 * tau_u).sqrt(), tau_u, sample_time, &mut random);
        let lateral = transverse(sigma_v, tau_v, tau_yaw, airspeed, sample_time, &mut random);
        let vertical = transverse(sigma_w, tau_w, tau_pitch, -airspeed, sample_time, &mut random);
        let roll = lag(roll_gain, tau_pitch, sample_time, &mut random);
        Ok(Self { random, along, lateral, vertical, roll })
    }

    /// The air at this sample, and one sample time onwards. The first call gives the air at the start.
    pub fn sample(&mut self) -> AirMotion {
        let [u] = self.along.outputs();
        let [v, yaw] = self.lateral.outputs();
        let [w, pitch] = self.vertical.outputs();
        let [roll] = self.roll.outputs();
        self.along.advance(&mut self.random);
        self.lateral.advance(&mut self.random);
        self.vertical.advance(&mut self.random);
        self.roll.advance(&mut self.random);
        AirMotion { velocity: [u, v, w], rates: [roll, pitch, yaw] }
    }
}

/// Whether turbulence can be sampled with these numbers.
pub(crate) fn check(field: &DrydenField, airspeed: f64, span: f64, sample_time: f64) -> Result<(), DrydenError> {
    let positive = "a positive, finite number";
    let mut needed = vec![("the airspeed", airspeed), ("the wing span", span), ("the sample time", sample_time)];
    needed.extend(field.scale_length.map(|l| ("a scale length", l)));
    for (what, value) in needed {
        if !(value > 0.0 && value.is_finite()) {
            return Err(DrydenError { what, value, expected: positive });
        }
    }
    if let Some(value) = field.sigma.into_iter().find(|s| !(*s >= 0.0 && s.is_finite())) {
        return Err(DrydenError { what: "an intensity", value, expected: "a finite number, not negative" });
    }
    Ok(())
}

/// Gain of the rolling gust's filter, `sqrt(pi/V sigma_w^2/L_w 0.8 (pi L_w/4b)^(1/3))`.
pub(crate) fn roll_gain(field: &DrydenField, airspeed: f64, span: f64) -> f64 {
    let pi = core::f64::consts::PI;
    let (scale_w, sigma_w) = (field.scale_length[2], field.sigma[2]);
    (pi / airspeed * sigma_w * sigma_w / scale_w * 0.8 * (pi * scale_w / (4.0 * span)).cbrt()).sqrt()
}

/// A sampled linear system driven by white noise.
#[derive(Clone, Debug)]
pub(crate) struct Filter<const N: usize> {
    state: SVector<f64, N>,
    transition: SMatrix<f64, N, N>,
    /// `noise noise^T` is the covariance that one interval adds.
    noise: SMatrix<f64, N, N>,
    /// One row per output; unused rows are zero.
    output: SMatrix<f64, 2, N>,
}

impl<const N: usize> Filter<N> {
    pub(crate) fn outputs<const M: usize>(&self) -> [f64; M] {
        let y = self.output * self.state;
        core::array::from_fn(|i| y[i])
    }

    pub(crate) fn advance(&mut self, random: &mut Pcg64Mcg) {
        self.state = self.transition * self.state + self.noise * standard_normal(random);
    }

    /// Starts in the stationary distribution, of covariance `stationary`.
    pub(crate) fn new(
        transition: SMatrix<f64, N, N>,
        noise_covariance: SMatrix<f64, N, N>,
        stationary: SMatrix<f64, N, N>,
        output: SMatrix<f64, 2, N>,
        random: &mut Pcg64Mcg,
    ) -> Self {
        let state = factor(stationary) * standard_normal(random);
        Self { state, transition, noise: factor(noise_covariance), output }
    }
}

fn standard_normal<const N: usize>(random: &mut Pcg64Mcg) -> SVector<f64, N> {
    SVector::from_fn(|_, _| StandardNormal.sample(random))
}

/// Lower triangular factor of a covariance. The noise of a short interval is nearly the same in all states of a chain; a
/// pivot that rounding has made negative is a direction in which nothing is added.
fn factor<const N: usize>(covariance: SMatrix<f64, N, N>) -> SMatrix<f64, N, N> {
    let mut lower = SMatrix::<f64, N, N>::zeros();
    for j in 0..N {
        let pivot = covariance[(j, j)] - (0..j).map(|k| lower[(j, k)] * lower[(j, k)]).sum::<f64>();
        let root = pivot.max(0.0).sqrt();
        lower[(j, j)] = root;
        for i in j + 1..N {
            let rest = covariance[(i, j)] - (0..j).map(|k| lower[(i, k)] * lower[(j, k)]).sum::<f64>();
            lower[(i, j)] = if root > 0.0 { rest / root } else { 0.0 };
        }
    }
    lower
}

/// `gain / (1 + tau s)`.
pub(crate) fn lag(gain: f64, tau: f64, h: f64, random: &mut Pcg64Mcg) -> Filter<1> {
    let variance = gain * gain / (2.0 * tau);
    Filter::new(
        SMatrix::from_element((-h / tau).exp()),
        SMatrix::from_element(-variance * (-2.0 * h / tau).exp_m1()),
        SMatrix::from_element(variance),
        SMatrix::<f64, 2, 1>::new(1.0, 0.0),
        random,
    )
}

/// The transverse gust `sigma sqrt(tau) (1 + sqrt(3) tau s)/(1 + tau s)^2` and its gradient over the aircraft,
/// `(s/speed) / (1 + tau_rate s)` of it. States: `x1 = n/(1 + tau s)`, `x2 = x1/(1 + tau s)`, and the gust through the lag of
/// the gradient, all times the gain.
fn transverse(sigma: f64, tau: f64, tau_rate: f64, speed: f64, h: f64, random: &mut Pcg64Mcg) -> Filter<3> {
    // (1 + sqrt(3) tau s)/(1 + tau s) = sqrt(3) + (1 - sqrt(3))/(1 + tau s)
    let root = 3.0_f64.sqrt();
    let (c1, c2) = (root, 1.0 - root);
    let dynamics = SMatrix::<f64, 3, 3>::new(
        -1.0 / tau,
        0.0,
        0.0, //
        1.0 / tau,
        -1.0 / tau,
        0.0, //
        c1 / tau_rate,
        c2 / tau_rate,
        -1.0 / tau_rate,
    );
    // B B^T with B = gain/tau on the first state, gain = sigma sqrt(tau).
    let mut intensity = SMatrix::<f64, 3, 3>::zeros();
    intensity[(0, 0)] = sigma * sigma / tau;
    let (transition, noise) = sampled(dynamics, intensity, h);
    // Stationary covariance, A P + P A^T + B B^T = 0, state by state.
    let s2 = sigma * sigma;
    let (p11, p12, p22) = (0.5 * s2, 0.25 * s2, 0.25 * s2);
    let p23_of = |p13: f64| (tau_rate * p13 + tau * (c1 * p12 + c2 * p22)) / (tau + tau_rate);
    let p13 = tau * (c1 * p11 + c2 * p12) / (tau + tau_rate);
    let p23 = p23_of(p13);
    let p33 = c1 * p13 + c2 * p23;
    let stationary = SMatrix::<f64, 3, 3>::new(p11, p12, p13, p12, p22, p23, p13, p23, p33);
    // (s/V)/(1 + tau_r s) w = (w - w/(1 + tau_r s)) / (V tau_r)
    let gradient = 1.0 / (speed * tau_rate);
    let output = SMatrix::<f64, 2, 3>::new(c1, c2, 0.0, c1 * gradient, c2 * gradient, -gradient);
    Filter::new(transition, noise, stationary, output, random)
}

/// `exp(A h)` and `integral of exp(A t) Q exp(A^T t) dt` over `0..h`.
fn sampled(
    dynamics: SMatrix<f64, 3, 3>,
    intensity: SMatrix<f64, 3, 3>,
    h: f64,
) -> (SMatrix<f64, 3, 3>, SMatrix<f64, 3, 3>) {
    // C. F. Van Loan, IEEE Trans. Automatic Control 23, 1978: exp([[-A, Q], [0, A^T]] h) holds both. The growing half
    // would swamp the other one over a long interval, so a short one is doubled.
    let mut doublings = 0;
    let mut step = h;
    while step * dynamics.amax() > 0.5 {
        step *= 0.5;
        doublings += 1;
    }
    let mut block = SMatrix::<f64, 6, 6>::zeros();
    block.fixed_view_mut::<3, 3>(0, 0).copy_from(&(-dynamics));
    block.fixed_view_mut::<3, 3>(0, 3).copy_from(&intensity);
    block.fixed_view_mut::<3, 3>(3, 3).copy_from(&dynamics.transpose());
    let exponential = (block * step).exp();
    let mut transition = exponential.fixed_view::<3, 3>(3, 3).transpose();
    let integral = transition * exponential.fixed_view::<3, 3>(0, 3);
    let mut noise = 0.5 * (integral + integral.transpose());
    for _ in 0..doublings {
        noise += transition * noise * transition.transpose();
        transition *= transition;
    }
    (transition, noise)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn intensities_are_those_of_the_standard() {
        // 20,000 ft: halfway between the points at 15,000 and 25,000 ft.
        let light = DrydenField::standard(Intensity::Light, 6096.0);
        let moderate = DrydenField::standard(Intensity::Moderate, 6096.0);
        assert!((light.sigma[2] / FOOT - 3.65).abs() < 1e-9 && (moderate.sigma[0] / FOOT - 7.3).abs() < 1e-9);
        assert!((light.scale_length[2] / FOOT - 1750.0).abs() < 1e-9);
        // Low altitude, 200 ft: L_w = h, sigma_w = 0.1 W20, L_u = h/(0.177 + 0.000823 h)^1.2.
        let low = DrydenField::standard(Intensity::Moderate, 200.0 * FOOT);
        assert!((low.sigma[2] / (0.1 * 30.0 * 1852.0 / 3600.0) - 1.0).abs() < 1e-12);
        assert!((low.scale_length[2] / FOOT - 200.0).abs() < 1e-9);
        assert!((low.scale_length[0] / FOOT - 200.0 / 0.3416_f64.powf(1.2)).abs() < 1e-9);
        // At 1000 ft the low-altitude field is isotropic: 0.177 + 0.823 = 1.
        let edge = DrydenField::standard(Intensity::Light, 1000.0 * FOOT);
        assert!((edge.sigma[0] / edge.sigma[2] - 1.0).abs() < 1e-12);
        // No turbulence of this probability up there.
        assert_eq!(DrydenField::standard(Intensity::Light, 15_000.0).sigma, [0.0; 3]);
    }

    #[test]
    fn a_given_intensity_keeps_the_proportions_of_the_height() {
        assert_eq!(DrydenField::of_sigma(2.0, 15_000.0).sigma, [2.0; 3]);
        let low = DrydenField::of_sigma(2.0, 60.0);
        let standard = DrydenField::standard(Intensity::Severe, 60.0);
        assert!((low.sigma[0] / low.sigma[2] - standard.sigma[0] / standard.sigma[2]).abs() < 1e-12);
    }

    #[test]
    fn numbers_out_of_range_are_named() {
        let field = DrydenField::of_sigma(1.0, 6096.0);
        let error = Dryden::new(field, 0.0, 9.0, 0.01, 1).map(|_| ()).unwrap_err();
        assert_eq!(error.to_string(), "turbulence: the airspeed is 0, expected a positive, finite number");
        let negative = DrydenField { sigma: [1.0, -1.0, 1.0], ..field };
        assert!(Dryden::new(negative, 200.0, 9.0, 0.01, 1).is_err());
    }

    /// The noise of an interval, from the integral, is what keeps the stationary covariance as it is.
    #[test]
    fn the_stationary_covariance_stays_at_any_sample_time() {
        let mut random = Pcg64Mcg::seed_from_u64(0);
        for h in [1e-4, 0.0025, 0.01, 0.3, 10.0] {
            let filter = transverse(1.3, 2.6, 0.057, 205.0, h, &mut random);
            let added = filter.noise * filter.noise.transpose();
            let s2 = 1.3 * 1.3;
            // Walk long enough in covariance space that every start is forgotten.
            let mut p = SMatrix::<f64, 3, 3>::zeros();
            let (mut transition, mut noise) = (filter.transition, added);
            for _ in 0..40 {
                noise += transition * noise * transition.transpose();
                transition *= transition;
                p = noise;
            }
            let w = filter.output.row(0) * p * filter.output.row(0).transpose();
            assert!((w[0] / s2 - 1.0).abs() < 1e-9, "{h}: {}", w[0] / s2);
            assert!((p[(0, 0)] / (0.5 * s2) - 1.0).abs() < 1e-9 && (p[(0, 1)] / (0.25 * s2) - 1.0).abs() < 1e-9, "{h}");
        }
    }
}
