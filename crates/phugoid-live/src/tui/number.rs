//! Numbers in the form in which people read them.

/// A value and its bound as text: the bound with two digits, the value with as many decimals. A value that is not
/// finite is `-`, and so is a bound that is not positive.
pub(super) fn with_bound(value: f64, bound: f64) -> (String, String) {
    if !value.is_finite() {
        return ("-".to_owned(), "-".to_owned());
    }
    if !(bound.is_finite() && bound > 0.0) {
        return (format!("{value:.5}"), "-".to_owned());
    }
    let exponent = bound.log10().floor();
    if !(-7.0..=6.0).contains(&exponent) {
        return (format!("{value:.3e}"), format!("{bound:.1e}"));
    }
    let decimals = (1.0 - exponent).max(0.0) as usize;
    (format!("{value:.decimals$}"), format!("{bound:.decimals$}"))
}

/// The factor and the unit in which an SI quantity is shown. Angles are in degrees, as in the reports; derivatives stay
/// per radian.
pub(super) fn display_unit(si: &str) -> (f64, &str) {
    match si {
        "rad" => (180.0 / std::f64::consts::PI, "deg"),
        "rad/s" => (180.0 / std::f64::consts::PI, "deg/s"),
        "rad/s^2" => (180.0 / std::f64::consts::PI, "deg/s^2"),
        "-" => (1.0, ""),
        other => (1.0, other),
    }
}

/// A count with a blank between groups of three digits.
pub(super) fn count(number: u64) -> String {
    let digits = number.to_string();
    let mut text = String::new();
    for (place, digit) in digits.chars().enumerate() {
        if place > 0 && (digits.len() - place).is_multiple_of(3) {
            text.push(' ');
        }
        text.push(digit);
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_bound_says_how_many_digits_a_value_has() {
        for (value, bound, expected) in [
            (-0.997_62, 0.040_6, ("-0.998", "0.041")),
            (-35.712, 2.14, ("-35.7", "2.1")),
            (123_456.7, 1_234.0, ("123457", "1234")),
            (1.0e-9, 2.0e-9, ("1.000e-9", "2.0e-9")),
            (0.5, 0.0, ("0.50000", "-")),
            (f64::NAN, 1.0, ("-", "-")),
        ] {
            let (v, b) = with_bound(value, bound);
            assert_eq!((v.as_str(), b.as_str()), expected);
        }
        assert_eq!((count(0), count(999), count(1_234_567)), ("0".into(), "999".into(), "1 234 567".into()));
    }
}
