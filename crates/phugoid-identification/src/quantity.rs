//! Quantities with units, as people write them: `"20500 lb"`, `"300 ft^2"`, `"-2 deg"`, `"91388 kg*m^2"`.

use strsim::jaro_winkler;

/// Powers of the base dimensions of a quantity: length, mass, time, angle.
///
/// Angles carry a dimension of their own here, although SI has none for them: it catches `"5 m"` written for an angle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Dimension {
    powers: [i8; 4],
    /// The SI unit, for messages.
    si_unit: &'static str,
}

impl Dimension {
    const fn new(length: i8, mass: i8, time: i8, angle: i8, si_unit: &'static str) -> Self {
        Self { powers: [length, mass, time, angle], si_unit }
    }
    /// A pure number.
    pub const NUMBER: Self = Self::new(0, 0, 0, 0, "a pure number");
    /// m
    pub const LENGTH: Self = Self::new(1, 0, 0, 0, "m");
    /// m^2
    pub const AREA: Self = Self::new(2, 0, 0, 0, "m^2");
    /// kg
    pub const MASS: Self = Self::new(0, 1, 0, 0, "kg");
    /// kg m^2
    pub const INERTIA: Self = Self::new(2, 1, 0, 0, "kg*m^2");
    /// s
    pub const TIME: Self = Self::new(0, 0, 1, 0, "s");
    /// rad
    pub const ANGLE: Self = Self::new(0, 0, 0, 1, "rad");
    /// rad/s
    pub const ANGULAR_RATE: Self = Self::new(0, 0, -1, 1, "rad/s");
    /// rad/s^2
    pub const ANGULAR_ACCELERATION: Self = Self::new(0, 0, -2, 1, "rad/s^2");
    /// m/s
    pub const SPEED: Self = Self::new(1, 0, -1, 0, "m/s");
    /// m/s^2
    pub const ACCELERATION: Self = Self::new(1, 0, -2, 0, "m/s^2");
    /// N
    pub const FORCE: Self = Self::new(1, 1, -2, 0, "N");
    /// kg/m^3
    pub const DENSITY: Self = Self::new(-3, 1, 0, 0, "kg/m^3");
    /// m^2/s^3, the spectral density of a speed's rate
    pub const SPEED_NOISE: Self = Self::new(2, 0, -3, 0, "m^2/s^3");
    /// rad^2/s, the spectral density of an angle's rate
    pub const ANGLE_NOISE: Self = Self::new(0, 0, -1, 2, "rad^2/s");
    /// rad^2/s^3, the spectral density of an angular rate's rate
    pub const ANGULAR_RATE_NOISE: Self = Self::new(0, 0, -3, 2, "rad^2/s^3");

    /// The SI unit of this dimension as text.
    pub fn si_unit(&self) -> &'static str {
        self.si_unit
    }
}

/// Units understood: name, factor to SI, powers. Factors are exact by definition (international foot and pound,
/// standard gravity 9.80665 m/s^2) or, for the slug, follow from them.
const UNITS: &[(&str, f64, [i8; 4])] = &[
    ("m", 1.0, [1, 0, 0, 0]),
    ("km", 1000.0, [1, 0, 0, 0]),
    ("cm", 0.01, [1, 0, 0, 0]),
    ("mm", 0.001, [1, 0, 0, 0]),
    ("ft", 0.3048, [1, 0, 0, 0]),
    ("in", 0.0254, [1, 0, 0, 0]),
    ("nmi", 1852.0, [1, 0, 0, 0]),
    ("kg", 1.0, [0, 1, 0, 0]),
    ("t", 1000.0, [0, 1, 0, 0]),
    ("lb", 0.453_592_37, [0, 1, 0, 0]),
    ("lbm", 0.453_592_37, [0, 1, 0, 0]),
    ("slug", 0.453_592_37 * 9.80665 / 0.3048, [0, 1, 0, 0]),
    ("s", 1.0, [0, 0, 1, 0]),
    ("ms", 0.001, [0, 0, 1, 0]),
    ("min", 60.0, [0, 0, 1, 0]),
    ("h", 3600.0, [0, 0, 1, 0]),
    ("Hz", 1.0, [0, 0, -1, 0]),
    ("rad", 1.0, [0, 0, 0, 1]),
    ("mrad", 0.001, [0, 0, 0, 1]),
    ("deg", std::f64::consts::PI / 180.0, [0, 0, 0, 1]),
    ("kt", 1852.0 / 3600.0, [1, 0, -1, 0]),
    ("kts", 1852.0 / 3600.0, [1, 0, -1, 0]),
    ("knot", 1852.0 / 3600.0, [1, 0, -1, 0]),
    ("g", 9.80665, [1, 0, -2, 0]),
    ("N", 1.0, [1, 1, -2, 0]),
    ("kN", 1000.0, [1, 1, -2, 0]),
    ("lbf", 0.453_592_37 * 9.80665, [1, 1, -2, 0]),
];

/// Parses a plain number (SI) or a number with a unit into SI.
///
/// The unit is a product of names with integer powers: `ft/s^2`, `slug*ft^2`, `kg m^2`, `deg/s`. `lb` is mass, `lbf`
/// force, `g` the standard acceleration of gravity.
///
/// # Errors
/// A sentence saying what was found, what was expected, and the nearest known unit.
pub fn parse_quantity(text: &str, dimension: Dimension) -> Result<f64, String> {
    let text = text.trim();
    let (number, unit) = split_number(text);
    let value: f64 = number.parse().map_err(|_| {
        format!("`{text}` is not a quantity: expected a number in {0}, or a number with a unit", dimension.si_unit)
    })?;
    if !value.is_finite() {
        return Err(format!("`{text}` is not finite"));
    }
    if unit.is_empty() {
        return Ok(value);
    }
    let (factor, powers) = parse_unit(unit)?;
    if powers != dimension.powers {
        return Err(format!(
            "`{unit}` in `{text}` is not a unit of this quantity: expected {} or its like",
            dimension.si_unit
        ));
    }
    Ok(value * factor)
}

/// The longest prefix that reads as a number, and the rest.
fn split_number(text: &str) -> (&str, &str) {
    let end = (1..=text.len())
        .rev()
        .filter(|&i| text.is_char_boundary(i))
        .find(|&i| {
            let head = &text[..i];
            head.ends_with(|c: char| c.is_ascii_digit() || c == '.') && head.parse::<f64>().is_ok()
        })
        .unwrap_or(0);
    (&text[..end], text[end..].trim())
}

fn parse_unit(unit: &str) -> Result<(f64, [i8; 4]), String> {
    let mut factor = 1.0;
    let mut powers = [0_i8; 4];
    let mut sign = 1_i32;
    // `*`, a space and `.` multiply, `/` divides by the next factor only.
    let spaced = unit.replace('*', " ").replace('/', " / ");
    for word in spaced.split_whitespace() {
        if word == "/" {
            sign = -1;
            continue;
        }
        let (name, exponent) = match word.split_once('^') {
            Some((name, exponent)) => (
                name,
                exponent
                    .parse::<i32>()
                    .ok()
                    .filter(|e| e.abs() <= 6)
                    .ok_or_else(|| format!("`^{exponent}` in unit `{unit}` is not a whole power"))?,
            ),
            None => (word, 1),
        };
        if name != "1" {
            let Some(&(_, f, p)) = UNITS.iter().find(|(n, _, _)| *n == name) else {
                return Err(format!("unknown unit `{name}`{}", did_you_mean(name, UNITS.iter().map(|u| u.0))));
            };
            factor *= f64::powi(f, sign * exponent);
            for (total, power) in powers.iter_mut().zip(p) {
                *total = total.saturating_add((i32::from(power) * sign * exponent).clamp(-100, 100) as i8);
            }
        }
        sign = 1;
    }
    Ok((factor, powers))
}

/// `: did you mean ...?` with the nearest of the words, or the whole list if nothing is near.
pub(crate) fn did_you_mean<'a>(word: &str, words: impl Iterator<Item = &'a str> + Clone) -> String {
    match nearest(word, words.clone()) {
        Some(near) => format!(": did you mean `{near}`?"),
        None => {
            let list: Vec<String> = words.map(|w| format!("`{w}`")).collect();
            if list.is_empty() { String::new() } else { format!(": expected one of {}", list.join(", ")) }
        }
    }
}

/// The valid word nearest to a misspelt one, if any is near.
pub(crate) fn nearest<'a>(word: &str, words: impl Iterator<Item = &'a str>) -> Option<&'a str> {
    let lower = word.to_lowercase();
    words
        .map(|w| (jaro_winkler(&lower, &w.to_lowercase()), w))
        .filter(|(score, _)| *score > 0.75)
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, w)| w)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_convert_to_si() {
        let close = |text: &str, dimension, expected: f64| {
            let value = parse_quantity(text, dimension).unwrap();
            assert!((value - expected).abs() <= 1e-12 * expected.abs(), "{text}: {value} != {expected}");
        };
        close("2.43 m", Dimension::LENGTH, 2.43);
        close("300 ft^2", Dimension::AREA, 300.0 * 0.3048 * 0.3048);
        close("-2 deg", Dimension::ANGLE, -2.0_f64.to_radians());
        close("20500 lb", Dimension::MASS, 20500.0 * 0.453_592_37);
        close("20500lb", Dimension::MASS, 20500.0 * 0.453_592_37);
        close("1e3 kg", Dimension::MASS, 1000.0);
        // 1 slug = 14.593902937206 kg (NIST SP 811, table B.8)
        close("1 slug", Dimension::MASS, 14.593_902_937_206_364);
        close("55814 slug*ft^2", Dimension::INERTIA, 55814.0 * 1.355_817_948_331_400_4);
        close("32.17 ft/s^2", Dimension::ACCELERATION, 9.805_416);
        close("2227.744 lbf", Dimension::FORCE, 2227.744 * 4.448_221_615_260_5);
        close("10 ft^2/s^3", Dimension::SPEED_NOISE, 10.0 * 0.3048 * 0.3048);
        close("3", Dimension::LENGTH, 3.0);
    }

    #[test]
    fn wrong_units_are_named() {
        assert!(parse_quantity("5 m", Dimension::ANGLE).unwrap_err().contains("expected rad"));
        assert!(parse_quantity("5 slgu", Dimension::MASS).unwrap_err().contains("did you mean `slug`"));
        assert!(parse_quantity("five", Dimension::MASS).is_err());
        assert!(parse_quantity("", Dimension::MASS).is_err());
        assert!(parse_quantity("5 m^99", Dimension::LENGTH).is_err());
        assert!(parse_quantity("nan", Dimension::LENGTH).is_err());
    }
}
