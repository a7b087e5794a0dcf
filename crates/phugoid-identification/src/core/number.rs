//! Numbers in sentences.

/// The number with so many significant digits, in plain notation, as it may stand in a model file; at most nine decimals.
pub(crate) fn significant(value: f64, digits: i32) -> String {
    let exponent = if value == 0.0 || !value.is_finite() { 0 } else { value.abs().log10().floor() as i32 };
    format!("{value:.*}", (digits - 1 - exponent).clamp(0, 9) as usize)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_their_digits() {
        assert_eq!(significant(-0.012_345, 4), "-0.01235");
        assert_eq!(significant(123.456, 4), "123.5");
        assert_eq!(significant(0.0, 4), "0.000");
        assert_eq!(significant(0.015_3, 2), "0.015");
        assert_eq!(significant(f64::NAN, 2), "NaN");
    }
}
