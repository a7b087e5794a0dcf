//! The numbers that the equations are written for: plain `f64`, or [`Dual`] for exact derivatives.

use core::ops::{Add, Div, Mul, Neg, Sub};

use crate::trigonometry;

/// A real scalar: everything the equations of motion need, and nothing else.
pub trait Scalar:
    Copy
    + From<f64>
    + Neg<Output = Self>
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Add<f64, Output = Self>
    + Sub<f64, Output = Self>
    + Mul<f64, Output = Self>
    + Div<f64, Output = Self>
{
    /// Whether this is a plain number without derivatives: data whose derivatives cost more than their value leave them out.
    const IS_REAL: bool = false;

    /// The value without its derivatives (for branches and table look-up).
    fn real(self) -> f64;
    /// Square root; NaN for negative numbers.
    fn sqrt(self) -> Self;
    /// Sine and cosine of an angle in radians.
    fn sin_cos(self) -> (Self, Self);
    /// Four-quadrant arc tangent of `self / x`, rad.
    fn atan2(self, x: Self) -> Self;
    /// Arc sine, rad; NaN outside -1 to 1.
    fn asin(self) -> Self;
    /// Power with a constant exponent.
    fn powf(self, exponent: f64) -> Self;
    /// Exponential function `e^x`.
    fn exp(self) -> Self;
    /// Reciprocal `1/x`; infinite for zero.
    #[inline]
    fn recip(self) -> Self {
        Self::from(1.0) / self
    }
}

// With `std` the platform's library, three times as fast as `libm`; without it `libm`, on a host as on board: build both
// without `std` where a replay must be the flight to the last bit.
#[cfg(feature = "std")]
mod maths {
    #[inline]
    pub(super) fn sqrt(x: f64) -> f64 {
        x.sqrt()
    }
    #[inline]
    pub(super) fn atan2(y: f64, x: f64) -> f64 {
        y.atan2(x)
    }
    #[inline]
    pub(super) fn asin(x: f64) -> f64 {
        x.asin()
    }
    #[inline]
    pub(super) fn powf(x: f64, e: f64) -> f64 {
        x.powf(e)
    }
    #[inline]
    pub(super) fn exp(x: f64) -> f64 {
        x.exp()
    }
}

#[cfg(not(feature = "std"))]
mod maths {
    pub(super) use libm::{asin, atan2, exp, pow as powf, sqrt};
}

impl Scalar for f64 {
    const IS_REAL: bool = true;

    #[inline]
    fn real(self) -> f64 {
        self
    }
    #[inline]
    fn sqrt(self) -> Self {
        maths::sqrt(self)
    }
    #[inline]
    fn sin_cos(self) -> (Self, Self) {
        trigonometry::sin_cos(self)
    }
    #[inline]
    fn atan2(self, x: Self) -> Self {
        maths::atan2(self, x)
    }
    #[inline]
    fn asin(self) -> Self {
        maths::asin(self)
    }
    #[inline]
    fn powf(self, exponent: f64) -> Self {
        maths::powf(self, exponent)
    }
    #[inline]
    fn exp(self) -> Self {
        maths::exp(self)
    }
}

/// Forward-mode dual number: a value and its derivatives with respect to `D` independent variables.
///
/// The rules are those of the first-order Taylor expansion, `f(a + b e) = f(a) + f'(a) b e` with `e^2 = 0`; a test
/// compares them with the `num-dual` crate, which needs `std` and therefore cannot serve on board.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dual<const D: usize> {
    /// The value of the expression.
    pub value: f64,
    /// Derivatives of the value by the `D` variables.
    pub derivatives: [f64; D],
}

impl<const D: usize> Dual<D> {
    /// The independent variable number `index` at `value`: its own derivative is one. An index out of range gives a
    /// constant.
    #[inline]
    pub fn variable(value: f64, index: usize) -> Self {
        Self { value, derivatives: core::array::from_fn(|i| f64::from(i == index)) }
    }

    /// `f(self)` from the value and the slope of `f` at `self.value`.
    #[inline(always)]
    pub fn chain(self, value: f64, slope: f64) -> Self {
        Self { value, derivatives: self.derivatives.map(|d| slope * d) }
    }
}

impl<const D: usize> From<f64> for Dual<D> {
    #[inline(always)]
    fn from(value: f64) -> Self {
        Self { value, derivatives: [0.0; D] }
    }
}

impl<const D: usize> Neg for Dual<D> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        self.chain(-self.value, -1.0)
    }
}

impl<const D: usize> Add for Dual<D> {
    type Output = Self;
    #[inline(always)]
    fn add(self, o: Self) -> Self {
        Self {
            value: self.value + o.value,
            derivatives: core::array::from_fn(|i| self.derivatives[i] + o.derivatives[i]),
        }
    }
}

impl<const D: usize> Sub for Dual<D> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, o: Self) -> Self {
        Self {
            value: self.value - o.value,
            derivatives: core::array::from_fn(|i| self.derivatives[i] - o.derivatives[i]),
        }
    }
}

impl<const D: usize> Mul for Dual<D> {
    type Output = Self;
    // The product rule is a sum.
    #[allow(clippy::suspicious_arithmetic_impl)]
    #[inline(always)]
    fn mul(self, o: Self) -> Self {
        Self {
            value: self.value * o.value,
            derivatives: core::array::from_fn(|i| self.value * o.derivatives[i] + o.value * self.derivatives[i]),
        }
    }
}

impl<const D: usize> Div for Dual<D> {
    type Output = Self;
    #[inline(always)]
    fn div(self, o: Self) -> Self {
        let inverse = 1.0 / o.value;
        let value = self.value * inverse;
        Self {
            value,
            derivatives: core::array::from_fn(|i| (self.derivatives[i] - value * o.derivatives[i]) * inverse),
        }
    }
}

impl<const D: usize> Add<f64> for Dual<D> {
    type Output = Self;
    #[inline(always)]
    fn add(self, o: f64) -> Self {
        Self { value: self.value + o, ..self }
    }
}

impl<const D: usize> Sub<f64> for Dual<D> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, o: f64) -> Self {
        Self { value: self.value - o, ..self }
    }
}

impl<const D: usize> Mul<f64> for Dual<D> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, o: f64) -> Self {
        self.chain(self.value * o, o)
    }
}

impl<const D: usize> Div<f64> for Dual<D> {
    type Output = Self;
    #[inline(always)]
    fn div(self, o: f64) -> Self {
        let inverse = 1.0 / o;
        self.chain(self.value * inverse, inverse)
    }
}

impl<const D: usize> Scalar for Dual<D> {
    #[inline]
    fn real(self) -> f64 {
        self.value
    }
    #[inline]
    fn sqrt(self) -> Self {
        let root = maths::sqrt(self.value);
        self.chain(root, 0.5 / root)
    }
    #[inline]
    fn sin_cos(self) -> (Self, Self) {
        let (s, c) = trigonometry::sin_cos(self.value);
        (self.chain(s, c), self.chain(c, -s))
    }
    #[inline]
    fn atan2(self, x: Self) -> Self {
        let r2 = self.value * self.value + x.value * x.value;
        Self {
            value: maths::atan2(self.value, x.value),
            derivatives: core::array::from_fn(|i| (x.value * self.derivatives[i] - self.value * x.derivatives[i]) / r2),
        }
    }
    #[inline]
    fn asin(self) -> Self {
        self.chain(maths::asin(self.value), 1.0 / maths::sqrt(1.0 - self.value * self.value))
    }
    #[inline]
    fn powf(self, exponent: f64) -> Self {
        let power = maths::powf(self.value, exponent);
        self.chain(power, exponent * power / self.value)
    }
    #[inline]
    fn exp(self) -> Self {
        let e = maths::exp(self.value);
        self.chain(e, e)
    }
}
