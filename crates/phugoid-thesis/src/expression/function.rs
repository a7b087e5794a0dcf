//! The functions of formulas.

/// A function of one number. Angles are in radians.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Function {
    Sin,
    Cos,
    Tan,
    Asin,
    Acos,
    Atan,
    Sinh,
    Cosh,
    Tanh,
    Exp,
    Ln,
    Sqrt,
    Abs,
}

impl Function {
    pub(crate) const ALL: [(&'static str, Self); 13] = [
        ("sin", Self::Sin),
        ("cos", Self::Cos),
        ("tan", Self::Tan),
        ("asin", Self::Asin),
        ("acos", Self::Acos),
        ("atan", Self::Atan),
        ("sinh", Self::Sinh),
        ("cosh", Self::Cosh),
        ("tanh", Self::Tanh),
        ("exp", Self::Exp),
        ("ln", Self::Ln),
        ("sqrt", Self::Sqrt),
        ("abs", Self::Abs),
    ];

    pub(crate) fn named(name: &str) -> Option<Self> {
        Self::ALL.iter().find(|(known, _)| *known == name).map(|(_, function)| *function)
    }

    /// Value and slope. Outside its domain a function is NaN; the slope of `abs` at zero is taken as zero.
    pub(super) fn at(self, x: f64) -> (f64, f64) {
        match self {
            Self::Sin => (libm::sin(x), libm::cos(x)),
            Self::Cos => (libm::cos(x), -libm::sin(x)),
            Self::Tan => {
                let tan = libm::tan(x);
                (tan, 1.0 + tan * tan)
            }
            Self::Asin => (libm::asin(x), 1.0 / (1.0 - x * x).sqrt()),
            Self::Acos => (libm::acos(x), -1.0 / (1.0 - x * x).sqrt()),
            Self::Atan => (libm::atan(x), 1.0 / (1.0 + x * x)),
            Self::Sinh => (libm::sinh(x), libm::cosh(x)),
            Self::Cosh => (libm::cosh(x), libm::sinh(x)),
            Self::Tanh => {
                let tanh = libm::tanh(x);
                (tanh, 1.0 - tanh * tanh)
            }
            Self::Exp => (libm::exp(x), libm::exp(x)),
            Self::Ln => (libm::log(x), 1.0 / x),
            Self::Sqrt => (x.sqrt(), 0.5 / x.sqrt()),
            Self::Abs if x == 0.0 => (0.0, 0.0),
            Self::Abs => (x.abs(), x.signum()),
        }
    }
}
