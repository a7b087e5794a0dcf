//! Decodes numbers in the bytes of a message.

/// The type in which a number is stored; all are little-endian.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    I64,
    U64,
    F16,
    F32,
    F64,
}

impl Kind {
    /// Size in bytes.
    pub(super) fn size(self) -> usize {
        match self {
            Kind::I8 | Kind::U8 => 1,
            Kind::I16 | Kind::U16 | Kind::F16 => 2,
            Kind::I32 | Kind::U32 | Kind::F32 => 4,
            Kind::I64 | Kind::U64 | Kind::F64 => 8,
        }
    }
}

/// Where a number is in a message, its type, and its factor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Place {
    pub(super) offset: usize,
    pub(super) kind: Kind,
    pub(super) scale: Scale,
}

/// A factor, stored as a multiplier and a divisor so that decimal fractions are exact: 123 / 100 is the double nearest
/// to 1.23, and 123 * 0.01 is not always.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Scale {
    multiply: f64,
    divide: f64,
}

impl Scale {
    pub(super) const ONE: Self = Self { multiply: 1.0, divide: 1.0 };

    /// This factor; 1 for what is no factor (0, NaN, infinite).
    pub(super) fn new(factor: f64) -> Self {
        let inverse = (1.0 / factor).round();
        if !factor.is_finite() || factor == 0.0 {
            Self::ONE
        } else if factor.abs() < 1.0 && inverse.abs() < 1e15 && (inverse * factor - 1.0).abs() < 1e-12 {
            Self { multiply: 1.0, divide: inverse }
        } else {
            Self { multiply: factor, divide: 1.0 }
        }
    }

    pub(super) fn apply(self, value: f64) -> f64 {
        value * self.multiply / self.divide
    }
}

impl Place {
    /// Decodes the number; NaN if the message ends before it.
    #[inline]
    pub(super) fn read(&self, message: &[u8]) -> f64 {
        let Some(bytes) = message.get(self.offset..) else { return f64::NAN };
        macro_rules! number {
            ($type:ty) => {
                bytes.first_chunk().map_or(f64::NAN, |bytes| <$type>::from_le_bytes(*bytes) as f64)
            };
        }
        let value = match self.kind {
            Kind::I8 => number!(i8),
            Kind::U8 => number!(u8),
            Kind::I16 => number!(i16),
            Kind::U16 => number!(u16),
            Kind::I32 => number!(i32),
            Kind::U32 => number!(u32),
            Kind::I64 => number!(i64),
            Kind::U64 => number!(u64),
            Kind::F16 => bytes.first_chunk().map_or(f64::NAN, |bytes| half(u16::from_le_bytes(*bytes))),
            Kind::F32 => number!(f32),
            Kind::F64 => number!(f64),
        };
        if self.scale == Scale::ONE { value } else { self.scale.apply(value) }
    }
}

/// Converts the bits of a half-precision number (IEEE 754 binary16).
fn half(bits: u16) -> f64 {
    let sign = if bits >> 15 == 1 { -1.0 } else { 1.0 };
    let (exponent, fraction) = (i32::from((bits >> 10) & 0x1F), f64::from(bits & 0x3FF));
    sign * match exponent {
        0 => fraction * 2_f64.powi(-24),
        31 if fraction == 0.0 => f64::INFINITY,
        31 => f64::NAN,
        _ => (1.0 + fraction / 1024.0) * 2_f64.powi(exponent - 15),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Values of IEEE 754-2019, table of binary16 examples.
    #[test]
    fn halves() {
        for (bits, value) in [
            (0x3C00, 1.0),
            (0xC000, -2.0),
            (0x7BFF, 65504.0),
            (0x0400, 2_f64.powi(-14)),
            (0x0001, 2_f64.powi(-24)),
            (0x3555, 0.333_251_953_125),
            (0x7C00, f64::INFINITY),
        ] {
            assert_eq!(half(bits), value, "{bits:#x}");
        }
        assert!(half(0x7C01).is_nan());
    }

    #[test]
    fn hundredths_are_the_nearest_numbers() {
        let scale = Scale::new(0.01);
        (-40_000..40_000_i32)
            .for_each(|n| assert_eq!(scale.apply(f64::from(n)), format!("{n}e-2").parse::<f64>().unwrap()));
        assert_eq!(Scale::new(1e-7).apply(-353_632_621.0), -35.363_262_1);
        assert_eq!(Scale::new(3.6).apply(10.0), 36.0);
        assert_eq!(Scale::new(0.0).apply(10.0), 10.0);
    }

    #[test]
    fn beyond_the_message_there_is_nothing() {
        let place = Place { offset: 2, kind: Kind::F32, scale: Scale::ONE };
        assert!(place.read(&[0; 5]).is_nan());
        assert_eq!(place.read(&[9, 9, 0, 0, 0x80, 0x3F]), 1.0);
    }
}
