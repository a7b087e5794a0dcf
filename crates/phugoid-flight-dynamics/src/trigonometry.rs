//! Sine and cosine together, without a branch in the range that aircraft fly in, the same to the last bit on a laptop
//! and on board.
//!
//! Five of them are a third of the instructions of the equations of motion when the platform's library computes them, a
//! fifth here; and libraries round differently, so that a longitudinal replay on the ground, which needs no other
//! function, would not be the flight.

use core::f64::consts::{FRAC_2_PI, FRAC_PI_4};

/// Sine and cosine of an angle (rad), each within one unit in the last place of 1.
#[inline]
pub(crate) fn sin_cos(angle: f64) -> (f64, f64) {
    // In the first case the reduction would take nothing off and turn no sign: the same bits for a third of the work,
    // and angle of attack, sideslip and pitch are seldom larger.
    if angle.abs() <= FRAC_PI_4 {
        series(angle)
    } else if angle.abs() <= LARGEST {
        reduced(angle)
    } else {
        beyond(angle)
    }
}

/// Largest angle reduced here, rad: some 2^20 quarter turns.
const LARGEST: f64 = 1_048_576.0;

/// pi/2 in two parts. The first has 33 bits, so that a multiple of it up to 2^20 is exact; together they have 86 bits.
const HALF_PI_HIGH: f64 = f64::from_bits(0x3FF9_21FB_5440_0000);
const HALF_PI_LOW: f64 = 6.077_100_506_506_192e-11;

/// Adding 1.5 * 2^52 and taking it away again rounds to the nearest integer, whose lowest bits the sum then shows.
const ROUND: f64 = 6_755_399_441_055_744.0;

/// Coefficients of `(sin r - r) / r^3` and `(cos r - 1 + r^2/2) / r^4` in powers of `r^2`: the Taylor series. On
/// |r| <= pi/4 the terms left out are below 2^-62.
const SERIES: [[f64; 2]; 8] = [
    [-1.0 / 6.0, 1.0 / 24.0],
    [1.0 / 120.0, -1.0 / 720.0],
    [-1.0 / 5_040.0, 1.0 / 40_320.0],
    [1.0 / 362_880.0, -1.0 / 3_628_800.0],
    [-1.0 / 39_916_800.0, 1.0 / 479_001_600.0],
    [1.0 / 6_227_020_800.0, -1.0 / 87_178_291_200.0],
    [-1.0 / 1_307_674_368_000.0, 1.0 / 20_922_789_888_000.0],
    [1.0 / 355_687_428_096_000.0, -1.0 / 6_402_373_705_728_000.0],
];

#[inline(always)]
fn reduced(angle: f64) -> (f64, f64) {
    let shifted = angle * FRAC_2_PI + ROUND;
    let turns = shifted - ROUND;
    let quadrant = shifted.to_bits();
    let (sine, cosine) = series((angle - turns * HALF_PI_HIGH) - turns * HALF_PI_LOW);

    // Odd quadrants exchange the two; the second bit turns the sign.
    let odd = quadrant & 1 != 0;
    let (sine, cosine) = if odd { (cosine, sine) } else { (sine, cosine) };
    let sign = |x: f64, bit: u64| f64::from_bits(x.to_bits() ^ ((bit & 2) << 62));
    (sign(sine, quadrant), sign(cosine, quadrant.wrapping_add(1)))
}

/// Sine and cosine for |r| <= pi/4.
#[inline(always)]
fn series(r: f64) -> (f64, f64) {
    // Both series side by side, even and odd powers apart: short chains that the processor can overlap.
    let z = r * r;
    let w = z * z;
    let series: [f64; 2] = core::array::from_fn(|k| {
        let c = |power: usize| SERIES[power][k];
        let even = c(0) + w * (c(2) + w * (c(4) + w * c(6)));
        let odd = c(1) + w * (c(3) + w * (c(5) + w * c(7)));
        even + z * odd
    });
    (r + r * z * series[0], (1.0 - 0.5 * z) + w * series[1])
}

/// No aircraft turns this far: slow, and right.
#[cold]
fn beyond(angle: f64) -> (f64, f64) {
    libm::sincos(angle)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn within_one_unit_in_the_last_place_of_one() {
        let mut worst = 0.0_f64;
        for i in -2_000_000..=2_000_000 {
            for scale in [1.234_567e-6, 3.1e-2] {
                let x = f64::from(i) * scale;
                let (s, c) = sin_cos(x);
                worst = worst.max((s - x.sin()).abs()).max((c - x.cos()).abs());
            }
        }
        assert!(worst <= f64::EPSILON, "{worst:e}");
    }

    #[test]
    fn small_angles_keep_their_relative_accuracy() {
        for x in [1e-300, 1e-12, -3e-7, 1e-3, -0.02] {
            let (s, c) = sin_cos(x);
            assert!((s / x.sin() - 1.0).abs() <= f64::EPSILON && (c - x.cos()).abs() <= f64::EPSILON, "{x}");
        }
        assert_eq!(sin_cos(0.0), (0.0, 1.0));
    }

    #[test]
    fn every_quadrant_border_and_what_lies_beyond() {
        for k in -40..=40 {
            for offset in [-1e-9, 0.0, 1e-9, core::f64::consts::FRAC_PI_4] {
                let x = f64::from(k) * core::f64::consts::FRAC_PI_2 + offset;
                let (s, c) = sin_cos(x);
                assert!((s - x.sin()).abs() <= f64::EPSILON && (c - x.cos()).abs() <= f64::EPSILON, "{x}");
            }
        }
        for x in [1e6, 1.1e6, -3.3e9, 1e22] {
            let (s, c) = sin_cos(x);
            assert!((s - x.sin()).abs() <= f64::EPSILON && (c - x.cos()).abs() <= f64::EPSILON, "{x}");
        }
        let (s, c) = sin_cos(f64::NAN);
        assert!(s.is_nan() && c.is_nan());
        let (s, c) = sin_cos(f64::INFINITY);
        assert!(s.is_nan() && c.is_nan());
    }
}
