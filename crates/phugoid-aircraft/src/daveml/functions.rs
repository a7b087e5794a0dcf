//! The functions of MathML on [`Scalar`] numbers, with exact first derivatives.
//!
//! Truth is one and falsehood zero; every number but zero and NaN counts as true. Functions that are constant in steps,
//! and limits, have the derivative zero.

use core::f64::consts::{FRAC_PI_2, LN_2};

use phugoid_flight_dynamics::scalar::Scalar;

/// A function of one operand.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Unary {
    Identity,
    Negate,
    Sqrt,
    Exp,
    Ln,
    Abs,
    Floor,
    Ceiling,
    Factorial,
    Not,
    Sin,
    Cos,
    Tan,
    Sec,
    Csc,
    Cot,
    Asin,
    Acos,
    Atan,
    Asec,
    Acsc,
    Acot,
    Sinh,
    Cosh,
    Tanh,
    Sech,
    Csch,
    Coth,
    Asinh,
    Acosh,
    Atanh,
    Asech,
    Acsch,
    Acoth,
}

/// A function of two operands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Binary {
    Plus,
    Minus,
    Times,
    Divide,
    Power,
    /// Root of the first operand with the degree of the second.
    Root,
    /// Logarithm of the first operand to the base of the second.
    Log,
    Quotient,
    Remainder,
    Atan2,
    Min,
    Max,
    And,
    Or,
    Xor,
    Implies,
    Equal,
    NotEqual,
    Less,
    Greater,
    LessOrEqual,
    GreaterOrEqual,
}

/// `f(x)` from the value and the slope of `f` there. Where the slope is not finite the derivatives are lost.
fn chain<T: Scalar>(x: T, value: f64, slope: f64) -> T {
    if slope.is_finite() && x.real().is_finite() { (x - x.real()) * slope + value } else { T::from(value) }
}

/// Whether a number counts as true.
pub(super) fn holds<T: Scalar>(x: T) -> bool {
    x.real() != 0.0 && !x.real().is_nan()
}

fn truth<T: Scalar>(holds: bool) -> T {
    T::from(if holds { 1.0 } else { 0.0 })
}

impl Unary {
    pub(super) fn of<T: Scalar>(self, x: T) -> T {
        let real = x.real();
        match self {
            Self::Identity => x,
            Self::Negate => -x,
            Self::Sqrt => x.sqrt(),
            Self::Exp => x.exp(),
            Self::Ln => chain(x, real.ln(), real.recip()),
            Self::Abs => {
                if real.is_sign_negative() {
                    -x
                } else {
                    x
                }
            }
            Self::Floor => T::from(real.floor()),
            Self::Ceiling => T::from(real.ceil()),
            Self::Factorial => T::from(factorial(real)),
            Self::Not => truth(!holds(x)),
            Self::Sin => x.sin_cos().0,
            Self::Cos => x.sin_cos().1,
            Self::Tan => {
                let (sin, cos) = x.sin_cos();
                sin / cos
            }
            Self::Sec => x.sin_cos().1.recip(),
            Self::Csc => x.sin_cos().0.recip(),
            Self::Cot => {
                let (sin, cos) = x.sin_cos();
                cos / sin
            }
            Self::Asin => x.asin(),
            Self::Acos => -x.asin() + FRAC_PI_2,
            Self::Atan => x.atan2(T::from(1.0)),
            Self::Asec => -x.recip().asin() + FRAC_PI_2,
            Self::Acsc => x.recip().asin(),
            Self::Acot => T::from(1.0).atan2(x),
            Self::Sinh => chain(x, real.sinh(), real.cosh()),
            Self::Cosh => chain(x, real.cosh(), real.sinh()),
            Self::Tanh => chain(x, real.tanh(), 1.0 - real.tanh() * real.tanh()),
            Self::Sech => Self::Cosh.of(x).recip(),
            Self::Csch => Self::Sinh.of(x).recip(),
            Self::Coth => Self::Tanh.of(x).recip(),
            Self::Asinh => chain(x, real.asinh(), (real * real + 1.0).sqrt().recip()),
            Self::Acosh => chain(x, real.acosh(), (real * real - 1.0).sqrt().recip()),
            Self::Atanh => chain(x, real.atanh(), (1.0 - real * real).recip()),
            Self::Asech => Self::Acosh.of(x.recip()),
            Self::Acsch => Self::Asinh.of(x.recip()),
            Self::Acoth => Self::Atanh.of(x.recip()),
        }
    }
}

/// Factorial of a whole number from zero; NaN for others, infinite above 170.
fn factorial(x: f64) -> f64 {
    if x < 0.0 || x.fract() != 0.0 {
        return f64::NAN;
    }
    if x > 170.0 {
        return f64::INFINITY;
    }
    let (mut product, mut factor) = (1.0, 2.0);
    while factor <= x {
        product *= factor;
        factor += 1.0;
    }
    product
}

impl Binary {
    pub(super) fn of<T: Scalar>(self, x: T, y: T) -> T {
        let (a, b) = (x.real(), y.real());
        match self {
            Self::Plus => x + y,
            Self::Minus => x - y,
            Self::Times => x * y,
            Self::Divide => x / y,
            Self::Power => power(x, y),
            Self::Root => {
                if b == 2.0 {
                    // The library's own is exact.
                    let by_degree = if a > 0.0 { -a.sqrt() * a.ln() / 4.0 } else { 0.0 };
                    x.sqrt() + chain(y, 0.0, by_degree)
                } else if b.rem_euclid(2.0) == 1.0 && a < 0.0 {
                    // An odd root of a negative number is real.
                    -power(-x, y.recip())
                } else {
                    power(x, y.recip())
                }
            }
            Self::Log => {
                // The library's own are exact at powers of the base.
                let value = if b == 10.0 {
                    a.log10()
                } else if b == 2.0 {
                    a.log2()
                } else {
                    a.ln() / b.ln()
                };
                let base = if b == 2.0 { LN_2 } else { b.ln() };
                chain(x, value, (a * base).recip()) + chain(y, 0.0, -value / (b * base))
            }
            Self::Quotient => T::from((a / b).trunc()),
            // x - y trunc(x / y), without rounding.
            Self::Remainder => chain(x, a % b, 1.0) + chain(y, 0.0, -(a / b).trunc()),
            Self::Atan2 => x.atan2(y),
            Self::Min => {
                if b < a || b.is_nan() {
                    y
                } else {
                    x
                }
            }
            Self::Max => {
                if b > a || b.is_nan() {
                    y
                } else {
                    x
                }
            }
            Self::And => truth(holds(x) && holds(y)),
            Self::Or => truth(holds(x) || holds(y)),
            Self::Xor => truth(holds(x) != holds(y)),
            Self::Implies => truth(!holds(x) || holds(y)),
            Self::Equal => truth(a == b),
            Self::NotEqual => truth(a != b),
            Self::Less => truth(a < b),
            Self::Greater => truth(a > b),
            Self::LessOrEqual => truth(a <= b),
            Self::GreaterOrEqual => truth(a >= b),
        }
    }
}

fn power<T: Scalar>(x: T, y: T) -> T {
    let (a, b) = (x.real(), y.real());
    let value = a.powf(b);
    let by_base = if b == 0.0 { 0.0 } else { b * a.powf(b - 1.0) };
    let by_exponent = if a > 0.0 { value * a.ln() } else { 0.0 };
    chain(x, value, by_base) + chain(y, 0.0, by_exponent)
}

#[cfg(test)]
mod tests {
    use phugoid_flight_dynamics::scalar::Dual;

    use super::*;

    #[test]
    fn derivatives_are_those_of_differences() {
        let unary = [
            (Unary::Sqrt, 0.7),
            (Unary::Exp, 0.7),
            (Unary::Ln, 0.7),
            (Unary::Abs, -0.7),
            (Unary::Tan, 0.7),
            (Unary::Sec, 0.7),
            (Unary::Csc, 0.7),
            (Unary::Cot, 0.7),
            (Unary::Acos, 0.7),
            (Unary::Atan, 0.7),
            (Unary::Asec, 1.7),
            (Unary::Acsc, 1.7),
            (Unary::Acot, 0.7),
            (Unary::Sinh, 0.7),
            (Unary::Cosh, 0.7),
            (Unary::Tanh, 0.7),
            (Unary::Sech, 0.7),
            (Unary::Csch, 0.7),
            (Unary::Coth, 0.7),
            (Unary::Asinh, 0.7),
            (Unary::Acosh, 1.7),
            (Unary::Atanh, 0.7),
            (Unary::Asech, 0.7),
            (Unary::Acsch, 0.7),
            (Unary::Acoth, 1.7),
        ];
        let step = 1e-6;
        for (function, x) in unary {
            let exact = function.of(Dual::<1>::variable(x, 0));
            let difference = (function.of(x + step) - function.of(x - step)) / (2.0 * step);
            assert!((exact.derivatives[0] - difference).abs() < 1e-8, "{function:?}");
            assert!((exact.value - function.of(x)).abs() < 1e-15, "{function:?}");
        }
        let binary = [Binary::Power, Binary::Root, Binary::Log, Binary::Remainder, Binary::Atan2, Binary::Min];
        for (function, y) in
            binary.map(|function| (function, 2.1)).into_iter().chain([(Binary::Root, 2.0), (Binary::Log, 10.0)])
        {
            let x = 7.3;
            let exact = function.of(Dual::<2>::variable(x, 0), Dual::<2>::variable(y, 1));
            let by_x = (function.of(x + step, y) - function.of(x - step, y)) / (2.0 * step);
            let by_y = (function.of(x, y + step) - function.of(x, y - step)) / (2.0 * step);
            assert!((exact.derivatives[0] - by_x).abs() < 1e-7, "{function:?}");
            assert!((exact.derivatives[1] - by_y).abs() < 1e-7, "{function:?}");
        }
    }

    #[test]
    fn special_values_are_those_of_mathml() {
        assert_eq!(Binary::Quotient.of(-7.0, 2.0), -3.0);
        assert_eq!(Binary::Remainder.of(-7.0, 2.0), -1.0);
        assert_eq!(Binary::Power.of(-5.0, 3.0), -125.0);
        assert_eq!(Binary::Power.of(0.0, 2.0), 0.0);
        assert!((Binary::Root.of(-27.0, 3.0) + 3.0_f64).abs() < 1e-15);
        assert_eq!(Binary::Log.of(1000.0, 10.0), 3.0);
        assert_eq!(Unary::Factorial.of(5.0), 120.0);
        assert!(Unary::Factorial.of(2.5).is_nan() && Unary::Ln.of(-1.0).is_nan());
        assert_eq!(Unary::Not.of(f64::NAN), 1.0);
        assert_eq!(Unary::Ln.of(0.0), f64::NEG_INFINITY);
        assert!(Binary::Max.of(1.0, f64::NAN).is_nan() && Binary::Min.of(f64::NAN, 1.0).is_nan());
    }
}
