//! Turbulence with the spectra of von Karman, by rational filters.
//!
//! Measured turbulence falls with the 5/3rd power of the frequency; the spectra of von Karman (MIL-F-8785C, 3.7.1) do so, those
//! of [`dryden`](crate::dryden) fall with the square. With `tau = L/V`, one-sided over the angular frequency `w`:
//!
//! ```text
//! u       sigma^2 (2 tau/pi) / (1 + (1.339 tau w)^2)^(5/6)
//! v, w    sigma^2 (tau/pi) (1 + 8/3 (1.339 tau w)^2) / (1 + (1.339 tau w)^2)^(11/6)
//! ```
//!
//! No linear system has them. The usual filters come close over the frequencies that move an aircraft (S. Gage, Creating a
//! unified graphical wind turbulence model from multiple specifications, AIAA 2003-5529):
//!
//! ```text
//! u       sigma sqrt(2 tau) (1 + 0.25 tau s) / (1 + 1.357 tau s + 0.1987 tau^2 s^2)
//! v, w    sigma sqrt(tau) (1 + 2.7478 tau s + 0.3398 tau^2 s^2) / (1 + 2.9958 tau s + 1.9754 tau^2 s^2 + 0.1539 tau^3 s^3)
//! ```
//!
//! Both are within 10 percent of the spectra up to `w = 20 V/L`. The gusts of rotation are made of `v` and `w`, and `p` of its own noise, as in
//! [`dryden`](crate::dryden); fields and signs are the same, and each filter is sampled exactly at any sample time.

use nalgebra::{DMatrix, SMatrix};
use rand::SeedableRng;
use rand_pcg::Pcg64Mcg;

use crate::dryden::{DrydenError, DrydenField, FOOT, Filter, Intensity, check, lag, roll_gain};
use crate::gust::AirMotion;

/// Numerator and denominator of the filter along x in powers of `tau s`.
const ALONG: ([f64; 2], [f64; 3]) = ([1.0, 0.25], [1.0, 1.357, 0.1987]);
/// The same across the flight path.
const ACROSS: ([f64; 3], [f64; 4]) = ([1.0, 2.7478, 0.3398], [1.0, 2.9958, 1.9754, 0.1539]);

/// The standard's field of an intensity at a height above the ground (m), for the spectra of von Karman.
///
/// Root mean squares (m/s) are those of [`DrydenField::standard`], and below 1000 ft the scale lengths too. Above 2000 ft the scale
/// is 2500 ft in place of 1750 ft (MIL-F-8785C, 3.7.2.1), which lets the two spectra meet at high frequency; between them it
/// is linear in the height. A height that is NaN gives a field that [`VonKarman::new`] refuses.
///
/// ```
/// use phugoid_flight_dynamics::dryden::Intensity;
/// use phugoid_flight_dynamics::von_karman::standard_field;
/// let field = standard_field(Intensity::Moderate, 6096.0);
/// assert_eq!(field.scale_length, [762.0; 3]); // m
/// ```
pub fn standard_field(intensity: Intensity, height: f64) -> DrydenField {
    with_scale(DrydenField::standard(intensity, height), height)
}

/// A field whose vertical gust has this root mean square (m/s), for the spectra of von Karman: scale lengths as
/// [`standard_field`], proportions as [`DrydenField::of_sigma`], at the height (m).
pub fn field_of_sigma(sigma: f64, height: f64) -> DrydenField {
    with_scale(DrydenField::of_sigma(sigma, height), height)
}

/// The field with the scale lengths of von Karman's spectra. At 1000 ft all three are 1000 ft in the standard.
fn with_scale(field: DrydenField, height: f64) -> DrydenField {
    const LOW: f64 = 1000.0 * FOOT;
    const HIGH: f64 = 2000.0 * FOOT;
    const SCALE_HIGH: f64 = 2500.0 * FOOT;
    if height < LOW {
        return field;
    }
    let part = (height - LOW) / (HIGH - LOW);
    let scale = if part > 1.0 { SCALE_HIGH } else { LOW + part * (SCALE_HIGH - LOW) };
    DrydenField { scale_length: [scale; 3], ..field }
}

/// Turbulence along a flight path, one call of [`VonKarman::sample`] per sample time.
///
/// ```
/// use phugoid_flight_dynamics::dryden::Intensity;
/// use phugoid_flight_dynamics::von_karman::{VonKarman, standard_field};
///
/// let field = standard_field(Intensity::Moderate, 6096.0);
/// let mut air = VonKarman::new(field, 205.74, 9.144, 0.01, 7)?;
/// let gust = air.sample().velocity;
/// assert!(gust.iter().all(|v| v.abs() < 6.0 * 2.3));
/// # Ok::<(), phugoid_flight_dynamics::dryden::DrydenError>(())
/// ```
#[derive(Clone, Debug)]
pub struct VonKarman {
    random: Pcg64Mcg,
    along: Filter<2>,
    lateral: Filter<4>,
    vertical: Filter<4>,
    roll: Filter<1>,
}

impl VonKarman {
    /// Turbulence met at a constant airspeed (m/s) by an aircraft of this wing span (m), sampled every `sample_time` (s).
    /// The field is taken as it is; [`standard_field`] and [`field_of_sigma`] have the scale lengths of these spectra. The same
    /// seed gives the same gusts on every machine.
    ///
    /// # Errors
    /// [`DrydenError`] names the number that is out of range.
    pub fn new(field: DrydenField, airspeed: f64, span: f64, sample_time: f64, seed: u64) -> Result<Self, DrydenError> {
        check(&field, airspeed, span, sample_time)?;
        let [tau_u, tau_v, tau_w] = field.scale_length.map(|l| l / airspeed);
        let [sigma_u, sigma_v, sigma_w] = field.sigma;
        let pi = core::f64::consts::PI;
        let (tau_pitch, tau_yaw) = (4.0 * span / (pi * airspeed), 3.0 * span / (pi * airspeed));
        let mut random = Pcg64Mcg::seed_from_u64(seed);
        let along = along(sigma_u * (2.0 * tau_u).sqrt(), tau_u, sample_time, &mut random);
        let lateral = across(sigma_v * tau_v.sqrt(), tau_v, tau_yaw, airspeed, sample_time, &mut random);
        let vertical = across(sigma_w * tau_w.sqrt(), tau_w, tau_pitch, -airspeed, sample_time, &mut random);
        let roll = lag(roll_gain(&field, airspeed, span), tau_pitch, sample_time, &mut random);
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

/// States: `x` and `tau x'` of `(1 + a1 tau s + a2 tau^2 s^2) x = gain n`.
fn along(gain: f64, tau: f64, h: f64, random: &mut Pcg64Mcg) -> Filter<2> {
    let ([b0, b1], [_, a1, a2]) = ALONG;
    let dynamics = SMatrix::<f64, 2, 2>::new(0.0, 1.0, -1.0 / a2, -a1 / a2) / tau;
    let mut intensity = SMatrix::<f64, 2, 2>::zeros();
    intensity[(1, 1)] = (gain / (a2 * tau)).powi(2);
    let output = SMatrix::<f64, 2, 2>::new(b0, b1, 0.0, 0.0);
    filter(dynamics, intensity, output, h, random)
}

/// States: `x`, `tau x'` and `tau^2 x''` of the denominator, and the gust through the lag `1/(1 + tau_rate s)` of its
/// gradient, which is `(gust - lagged)/(speed tau_rate)`.
fn across(gain: f64, tau: f64, tau_rate: f64, speed: f64, h: f64, random: &mut Pcg64Mcg) -> Filter<4> {
    let ([b0, b1, b2], [_, a1, a2, a3]) = ACROSS;
    let last = 1.0 / (a3 * tau);
    let dynamics = SMatrix::<f64, 4, 4>::from_row_slice(&[
        0.0,
        1.0 / tau,
        0.0,
        0.0, //
        0.0,
        0.0,
        1.0 / tau,
        0.0, //
        -last,
        -a1 * last,
        -a2 * last,
        0.0, //
        b0 / tau_rate,
        b1 / tau_rate,
        b2 / tau_rate,
        -1.0 / tau_rate,
    ]);
    let mut intensity = SMatrix::<f64, 4, 4>::zeros();
    intensity[(2, 2)] = (gain * last).powi(2);
    let gradient = 1.0 / (speed * tau_rate);
    let output = SMatrix::<f64, 2, 4>::new(b0, b1, b2, 0.0, b0 * gradient, b1 * gradient, b2 * gradient, -gradient);
    filter(dynamics, intensity, output, h, random)
}

/// Samples `x' = A x + noise of this intensity` exactly.
fn filter<const N: usize>(
    dynamics: SMatrix<f64, N, N>,
    intensity: SMatrix<f64, N, N>,
    output: SMatrix<f64, 2, N>,
    h: f64,
    random: &mut Pcg64Mcg,
) -> Filter<N> {
    let mut step = h;
    let mut doublings = 0;
    while step * dynamics.amax() > 0.5 {
        step *= 0.5;
        doublings += 1;
    }
    // C. F. Van Loan, IEEE Trans. Automatic Control 23, 1978, as for Dryden's filters.
    let mut block = DMatrix::<f64>::zeros(2 * N, 2 * N);
    block.view_mut((0, 0), (N, N)).copy_from(&(-dynamics));
    block.view_mut((0, N), (N, N)).copy_from(&intensity);
    block.view_mut((N, N), (N, N)).copy_from(&dynamics.transpose());
    let exponential = (block * step).exp();
    let mut transition = SMatrix::<f64, N, N>::from_fn(|r, c| exponential[(N + c, N + r)]);
    let integral = transition * SMatrix::<f64, N, N>::from_fn(|r, c| exponential[(r, N + c)]);
    let mut noise = 0.5 * (integral + integral.transpose());
    let double = |transition: &mut SMatrix<f64, N, N>, noise: &mut SMatrix<f64, N, N>| {
        *noise += *transition * *noise * transition.transpose();
        *transition *= *transition;
    };
    for _ in 0..doublings {
        double(&mut transition, &mut noise);
    }
    // The stationary covariance is what intervals without end add up to.
    let (mut long, mut stationary) = (transition, noise);
    for _ in 0..64 {
        double(&mut long, &mut stationary);
        if long.amax() < 1e-18 {
            break;
        }
    }
    Filter::new(transition, noise, stationary, output, random)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Power of a filter at `x = tau w`.
    fn power(numerator: &[f64], denominator: &[f64], x: f64) -> f64 {
        let square = |coefficients: &[f64]| {
            let part = |first: usize| {
                let signed = |(k, c): (usize, &f64)| if (k / 2).is_multiple_of(2) { *c } else { -*c };
                let terms = coefficients.iter().enumerate().skip(first).step_by(2);
                terms.map(|(k, c)| signed((k, c)) * x.powi(k as i32)).sum::<f64>()
            };
            part(0).powi(2) + part(1).powi(2)
        };
        square(numerator) / square(denominator)
    }

    #[test]
    fn the_filters_have_the_spectra() {
        let (mut along, mut across) = (0.0_f64, 0.0_f64);
        for k in 0..=300 {
            let x = 0.01 * 2000.0_f64.powf(f64::from(k) / 300.0);
            let a = 1.339 * x * 1.339 * x;
            let exact = (1.0 + a).powf(-5.0 / 6.0);
            along = along.max((power(&ALONG.0, &ALONG.1, x) / exact - 1.0).abs());
            let exact = (1.0 + 8.0 / 3.0 * a) * (1.0 + a).powf(-11.0 / 6.0);
            across = across.max((power(&ACROSS.0, &ACROSS.1, x) / exact - 1.0).abs());
        }
        // Up to 20 V/L, which is 1.2 Hz for a scale length of 533 m and 200 m/s.
        assert!(along < 0.10 && across < 0.05, "{along} {across}");
    }

    #[test]
    fn scale_lengths_are_those_of_the_standard() {
        let at = |feet: f64| standard_field(Intensity::Severe, feet * FOOT);
        // Low-altitude model at 200 ft, as for Dryden: 200/(0.177 + 0.1646)^1.2 = 725.8 ft along and across, 200 ft up.
        assert_eq!(at(200.0), DrydenField::standard(Intensity::Severe, 200.0 * FOOT));
        assert!((at(200.0).scale_length[0] / FOOT - 725.8).abs() < 0.05);
        for (feet, scale) in [(1000.0, 1000.0), (1500.0, 1750.0), (2000.0, 2500.0), (60_000.0, 2500.0)] {
            let field = at(feet);
            assert!(field.scale_length.iter().all(|l| (l / FOOT - scale).abs() < 1e-9), "{feet}: {field:?}");
            assert_eq!(field.sigma, DrydenField::standard(Intensity::Severe, feet * FOOT).sigma);
        }
        assert_eq!(field_of_sigma(2.0, 6096.0), DrydenField { scale_length: [762.0; 3], sigma: [2.0; 3] });
        assert!(VonKarman::new(standard_field(Intensity::Light, f64::NAN), 200.0, 9.0, 0.01, 1).is_err());
    }

    #[test]
    fn samples_have_the_variance_and_the_order_of_the_seed() {
        let field = DrydenField::of_sigma(1.5, 6096.0);
        let mut sum = [0.0; 3];
        let (flights, samples) = (150, 2000);
        for seed in 0..flights {
            let mut air = VonKarman::new(field, 205.74, 9.144, 0.1, seed).unwrap();
            for _ in 0..samples {
                let velocity = air.sample().velocity;
                sum.iter_mut().zip(velocity).for_each(|(s, v)| *s += v * v / (flights as f64 * samples as f64));
            }
        }
        // The filters leave out the end of the spectrum: a few percent of the variance.
        for (axis, variance) in sum.iter().enumerate() {
            let ratio = variance / 2.25;
            assert!((0.85..1.05).contains(&ratio), "{axis}: {ratio}");
        }
        assert!(VonKarman::new(field, 0.0, 9.0, 0.01, 1).is_err());
    }

    #[test]
    fn the_sample_time_changes_no_variance() {
        let mut random = Pcg64Mcg::seed_from_u64(1);
        let variance = |h: f64, random: &mut Pcg64Mcg| {
            let mut sum = 0.0;
            for _ in 0..20_000 {
                let filter = along(1.0, 0.5, h, random);
                let [u] = filter.outputs();
                sum += u * u / 20_000.0;
            }
            sum
        };
        let (short, long) = (variance(1e-3, &mut random), variance(3.0, &mut random));
        assert!((short / long - 1.0).abs() < 0.06, "{short} {long}");
    }
}
