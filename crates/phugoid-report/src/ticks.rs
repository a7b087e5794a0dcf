//! Tick marks of axes, and numbers as text.

/// The ticks of one axis with their labels.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Ticks {
    /// Values at the ticks, ascending.
    pub(crate) values: Vec<f64>,
    /// Label of each tick: its value divided by ten to the power of `exponent`.
    pub(crate) labels: Vec<String>,
    /// Power of ten that was taken out of the labels, a multiple of 3.
    pub(crate) exponent: i32,
}

/// Ticks at multiples of 1, 2 or 5 times a power of ten within the limits: about `wanted` of them, and at least three.
/// There are none for limits that are not finite or not ascending.
pub(crate) fn ticks(limits: [f64; 2], wanted: usize) -> Ticks {
    let [lower, upper] = limits;
    let span = upper - lower;
    if !(span > 0.0 && span.is_finite()) {
        return Ticks { values: Vec::new(), labels: Vec::new(), exponent: 0 };
    }
    let raw = span / wanted.max(1) as f64;
    let power = 10f64.powf(raw.log10().floor());
    // Steps from coarse to fine. The search starts at the smallest step that gives at most as many ticks as wanted, and
    // ends at the first one that gives three. The factors near 1 allow for rounding.
    let steps = [10.0, 5.0, 2.0, 1.0, 0.5, 0.2, 0.1].map(|m| m * power);
    let smallest = steps.iter().copied().filter(|s| *s >= raw * 0.999).fold(10.0 * power, f64::min);
    let count_of = |step: f64| (upper / step + 1e-6).floor() - (lower / step - 1e-6).ceil() + 1.0;
    let step = steps.into_iter().filter(|s| *s <= smallest).find(|s| count_of(*s) >= 3.0).unwrap_or(smallest);
    let first = (lower / step - 1e-6).ceil();
    let count = count_of(step).clamp(0.0, 50.0) as usize;
    let values: Vec<f64> = (0..count).map(|k| (first + k as f64) * step).collect();

    let largest = values.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
    let exponent = if largest >= 1e5 || (largest > 0.0 && largest < 1e-2) {
        3 * (((largest.log10() + 1.0) / 3.0).floor() as i32)
    } else {
        0
    };
    let scale = 10f64.powi(exponent);
    let decimals = (-((step / scale).log10() + 1e-9).floor()).clamp(0.0, 9.0) as usize;
    let labels = values.iter().map(|v| fixed(v / scale, decimals)).collect();
    Ticks { values, labels, exponent }
}

/// Ticks of a logarithmic axis at 1, 2 and 5 times powers of ten, or at powers of ten only if those are enough: about
/// `wanted` of them. There are none for limits that are not positive or not ascending.
pub(crate) fn logarithmic_ticks([lower, upper]: [f64; 2], wanted: usize) -> Ticks {
    if !(lower > 0.0 && upper > lower && upper.is_finite()) {
        return Ticks { values: Vec::new(), labels: Vec::new(), exponent: 0 };
    }
    let (first, last) = (lower.log10().floor() as i32, upper.log10().ceil() as i32);
    let inside = |v: &f64| *v >= lower * (1.0 - 1e-9) && *v <= upper * (1.0 + 1e-9);
    let at = |mantissas: &[f64], every: usize| -> Vec<f64> {
        let decades = (first..=last).filter(|k| k.rem_euclid(every as i32) == 0).map(|k| 10f64.powi(k));
        decades.flat_map(|decade| mantissas.iter().map(move |m| m * decade)).filter(inside).collect()
    };
    let mut values = at(&[1.0, 2.0, 5.0], 1);
    for candidate in [at(&[1.0, 3.0], 1), at(&[1.0], 1), at(&[1.0], 2), at(&[1.0], 3), at(&[1.0], 6)] {
        if values.len() > wanted.max(2) && candidate.len() >= 2 {
            values = candidate;
        }
    }
    if values.len() < 2 {
        // The limits are so close together that linear ticks are better.
        return ticks([lower, upper], wanted);
    }
    let labels = values.iter().map(|v| compact(*v, 4)).collect();
    Ticks { values, labels, exponent: 0 }
}

/// A number that is a setting and not a result, with at most so many digits and without trailing zeros: `0.5`, `12`,
/// `10⁻⁴`.
pub(crate) fn compact(value: f64, digits: usize) -> String {
    let text = significant(value, digits);
    let (mantissa, power) = match text.split_once('·') {
        Some((mantissa, power)) => (mantissa, power),
        // A small number is easier to read with a power of ten.
        None if value != 0.0 && value.abs() < 1e-3 => {
            let exponent = value.abs().log10().floor() as i32;
            let power = format!("10{}", superscript(exponent));
            return compact_power(&significant(value / 10f64.powi(exponent), digits), &power);
        }
        None => (text.as_str(), ""),
    };
    compact_power(mantissa, power)
}

/// Mantissa and power of ten without trailing zeros and without a mantissa of 1.
fn compact_power(mantissa: &str, power: &str) -> String {
    let short = if mantissa.contains('.') { mantissa.trim_end_matches('0').trim_end_matches('.') } else { mantissa };
    match (short, power) {
        (_, "") => short.to_owned(),
        ("1", _) => power.to_owned(),
        ("−1", _) => format!("−{power}"),
        _ => format!("{short}·{power}"),
    }
}

/// A number with so many decimals, with the sign `−` and without a negative zero.
pub(crate) fn fixed(value: f64, decimals: usize) -> String {
    let text = format!("{value:.decimals$}");
    match text.strip_prefix('-') {
        Some(rest) if rest.bytes().all(|b| b == b'0' || b == b'.') => rest.to_owned(),
        Some(rest) => format!("−{rest}"),
        None => text,
    }
}

/// A number with so many significant digits (1 to 15), as people write it: plain between 1e-4 and 1e6, else with a
/// power of ten. A number that is not finite is a dash.
///
/// ```
/// use phugoid_report::significant;
///
/// assert_eq!(significant(-0.200_34, 4), "−0.2003");
/// assert_eq!(significant(7.5e8, 3), "7.50·10⁸");
/// assert_eq!(significant(f64::NAN, 3), "–");
/// ```
pub fn significant(value: f64, digits: usize) -> String {
    if !value.is_finite() {
        return "–".to_owned();
    }
    if value == 0.0 {
        return "0".to_owned();
    }
    let digits = digits.clamp(1, 15);
    // Rounded before the exponent is known: 0.99996 with four digits is 1.000.
    let text = format!("{value:.*e}", digits - 1);
    let (mantissa, exponent) = text.split_once('e').unwrap_or((&text, "0"));
    let exponent: i32 = exponent.parse().unwrap_or(0);
    if (-4..6).contains(&exponent) {
        let decimals = (digits as i32 - 1 - exponent).max(0) as usize;
        fixed(value, decimals)
    } else {
        format!("{}·10{}", mantissa.replace('-', "−"), superscript(exponent))
    }
}

/// A value with its error, both rounded to the second digit of the error: `−0.1973 ± 0.0027`.
pub(crate) fn with_error(value: f64, error: f64) -> String {
    // Rounded before the exponent is known: an error of 0.00996 is 0.010.
    let rounded: Option<f64> = format!("{:.1e}", error.abs()).parse().ok();
    let magnitude = rounded.filter(|e| *e > 0.0 && e.is_finite()).map(|e| e.log10().floor() as i32);
    match magnitude {
        Some(magnitude) if (-7..6).contains(&magnitude) && value.is_finite() => {
            let decimals = (1 - magnitude).max(0) as usize;
            format!("{} ± {}", fixed(value, decimals), fixed(error, decimals))
        }
        _ => format!("{} ± {}", significant(value, 4), significant(error, 2)),
    }
}

/// A whole number in superscript digits.
pub(crate) fn superscript(number: i32) -> String {
    number
        .to_string()
        .chars()
        .map(|c| match c {
            '-' => '⁻',
            '1' => '¹',
            '2' => '²',
            '3' => '³',
            '0' => '⁰',
            other => other.to_digit(10).and_then(|d| char::from_u32(0x2070 + d)).unwrap_or(other),
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn usual_axes() {
        let axis = ticks([0.0, 20.0], 10);
        assert_eq!(axis.labels, ["0", "2", "4", "6", "8", "10", "12", "14", "16", "18", "20"]);
        // Two ticks at steps of 0.2 would be too few to read a value from.
        assert_eq!(ticks([-0.31, 0.12], 3).labels, ["−0.3", "−0.2", "−0.1", "0.0", "0.1"]);
        assert_eq!(ticks([-0.31, 0.12], 5).labels, ["−0.3", "−0.2", "−0.1", "0.0", "0.1"]);
        let small = ticks([0.0, 3.2e-4], 4);
        assert_eq!((small.exponent, small.labels), (-3, vec!["0.0".into(), "0.1".into(), "0.2".into(), "0.3".into()]));
        let zoom = ticks([-0.20013, -0.19987], 3);
        assert_eq!(zoom.labels, ["−0.2001", "−0.2000", "−0.1999"]);
        assert!(ticks([f64::NAN, 1.0], 4).values.is_empty());
        assert!(ticks([1.0, 1.0], 4).values.is_empty());
    }

    #[test]
    fn logarithmic_axes() {
        assert_eq!(logarithmic_ticks([0.03, 3.0], 8).labels, ["0.05", "0.1", "0.2", "0.5", "1", "2"]);
        assert_eq!(logarithmic_ticks([1e-4, 1.0], 5).labels, ["10⁻⁴", "0.001", "0.01", "0.1", "1"]);
        assert_eq!(logarithmic_ticks([1e-6, 1e6], 5).labels, ["10⁻⁶", "0.001", "1", "1000", "10⁶"]);
        assert_eq!(logarithmic_ticks([0.9, 1.1], 4).labels, ["0.90", "0.95", "1.00", "1.05", "1.10"]);
        assert!(logarithmic_ticks([-1.0, 1.0], 4).values.is_empty());
    }

    #[test]
    fn settings_have_no_idle_digits() {
        for (value, text) in [
            (0.5, "0.5"),
            (12.0, "12"),
            (100.0, "100"),
            (1e-4, "10⁻⁴"),
            (-2.5e-5, "−2.5·10⁻⁵"),
            (3e7, "3·10⁷"),
            (0.0, "0"),
            (-0.05, "−0.05"),
        ] {
            assert_eq!(compact(value, 4), text);
        }
    }

    #[test]
    fn printed_numbers() {
        for (value, text) in [
            (-0.200_34, "−0.2003"),
            (12_345.6, "12346"),
            (0.999_96, "1.000"),
            (1.234_5e-5, "1.234·10⁻⁵"),
            (-3e-10, "−3.000·10⁻¹⁰"),
            (7.5e8, "7.500·10⁸"),
            (0.0, "0"),
            (f64::NAN, "–"),
            (0.001_234_5, "0.001234"),
            (0.000_123_45, "0.0001234"),
        ] {
            assert_eq!(significant(value, 4), text);
        }
    }

    #[test]
    fn a_value_has_as_many_digits_as_its_error_allows() {
        assert_eq!(with_error(-0.197_34, 0.002_68), "−0.1973 ± 0.0027");
        assert_eq!(with_error(0.12193, 0.000_996), "0.1219 ± 0.0010");
        assert_eq!(with_error(-34.762, 0.3881), "−34.76 ± 0.39");
        assert_eq!(with_error(1234.6, 217.0), "1235 ± 217");
        assert_eq!(with_error(2.0, 0.0), "2.000 ± 0");
        assert_eq!(with_error(2.0, f64::NAN), "2.000 ± –");
        assert_eq!(with_error(0.5, 1e-12), "0.5000 ± 1.0·10⁻¹²");
    }

    proptest! {
        #[test]
        fn ticks_lie_within_the_limits_and_do_not_repeat(
            centre in -1e6..1e6f64, exponent in -5..6i32, wanted in 1usize..12,
        ) {
            let half = 10f64.powi(exponent);
            let limits = [centre - half, centre + half];
            let axis = ticks(limits, wanted);
            prop_assert!(axis.values.len() >= 3 && axis.values.len() <= wanted.max(6) + 1, "{:?}", axis);
            prop_assert_eq!(axis.values.len(), axis.labels.len());
            for pair in axis.values.windows(2) {
                prop_assert!(pair[1] > pair[0]);
            }
            for v in &axis.values {
                prop_assert!(*v >= limits[0] - 1e-3 * half && *v <= limits[1] + 1e-3 * half);
            }
        }
    }
}
