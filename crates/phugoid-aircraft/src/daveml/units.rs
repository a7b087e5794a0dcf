//! Units as S-119 writes them (`ft_s`, `slugft2`, `_rad`), and what they are in SI.
//!
//! A unit is a product of symbols; what follows an underscore divides, and a digit after a symbol is its power:
//! `lbf_ft2` is a pound per square foot, `_deg` is "per degree". Older files write `/` for the underscore, or powers with
//! their sign, where an underscore only separates: `rad_s-1`. Angles count as dimensionless, with the radian as one.

/// Symbols with their factor to SI and their powers of metre, kilogram, second, kelvin and ampere.
const SYMBOLS: [(&str, f64, [i8; 5]); 62] = [
    ("nd", 1.0, [0; 5]),
    ("ND", 1.0, [0; 5]),
    ("nondimensional", 1.0, [0; 5]),
    ("frac", 1.0, [0; 5]),
    ("fracMAC", 1.0, [0; 5]),
    ("pct", 0.01, [0; 5]),
    ("pctMAC", 0.01, [0; 5]),
    ("rad", 1.0, [0; 5]),
    ("r", 1.0, [0; 5]),
    ("deg", DEGREE, [0; 5]),
    ("d", DEGREE, [0; 5]),
    ("rev", core::f64::consts::TAU, [0; 5]),
    ("m", 1.0, LENGTH),
    ("cm", 0.01, LENGTH),
    ("mm", 0.001, LENGTH),
    ("km", 1000.0, LENGTH),
    ("ft", FOOT, LENGTH),
    ("f", FOOT, LENGTH),
    ("kft", 1000.0 * FOOT, LENGTH),
    ("in", FOOT / 12.0, LENGTH),
    ("inch", FOOT / 12.0, LENGTH),
    ("yd", 3.0 * FOOT, LENGTH),
    ("mi", 5280.0 * FOOT, LENGTH),
    ("nmi", 1852.0, LENGTH),
    ("s", 1.0, TIME),
    ("sec", 1.0, TIME),
    ("ms", 0.001, TIME),
    ("min", 60.0, TIME),
    ("h", 3600.0, TIME),
    ("hr", 3600.0, TIME),
    ("Hz", 1.0, [0, 0, -1, 0, 0]),
    ("kt", 1852.0 / 3600.0, SPEED),
    ("kts", 1852.0 / 3600.0, SPEED),
    ("knot", 1852.0 / 3600.0, SPEED),
    ("fps", FOOT, SPEED),
    ("mph", 5280.0 * FOOT / 3600.0, SPEED),
    ("rpm", core::f64::consts::TAU / 60.0, [0, 0, -1, 0, 0]),
    ("g", 9.806_65, [1, 0, -2, 0, 0]),
    ("gee", 9.806_65, [1, 0, -2, 0, 0]),
    ("kg", 1.0, MASS),
    ("gm", 0.001, MASS),
    ("lbm", POUND, MASS),
    ("slug", SLUG, MASS),
    ("sl", SLUG, MASS),
    ("N", 1.0, FORCE),
    ("kN", 1000.0, FORCE),
    ("lbf", POUND_FORCE, FORCE),
    ("lb", POUND_FORCE, FORCE),
    ("klbf", 1000.0 * POUND_FORCE, FORCE),
    ("Pa", 1.0, PRESSURE),
    ("kPa", 1000.0, PRESSURE),
    ("hPa", 100.0, PRESSURE),
    ("mbar", 100.0, PRESSURE),
    ("bar", 1.0e5, PRESSURE),
    ("atm", 101_325.0, PRESSURE),
    ("psf", POUND_FORCE / (FOOT * FOOT), PRESSURE),
    ("psi", 144.0 * POUND_FORCE / (FOOT * FOOT), PRESSURE),
    ("J", 1.0, [2, 1, -2, 0, 0]),
    ("W", 1.0, [2, 1, -3, 0, 0]),
    ("hp", 550.0 * FOOT * POUND_FORCE, [2, 1, -3, 0, 0]),
    ("A", 1.0, [0, 0, 0, 0, 1]),
    ("V", 1.0, [2, 1, -3, 0, -1]),
];
/// Temperatures: symbol, factor to kelvin, and the zero of the scale in kelvin.
const TEMPERATURES: [(&str, f64, f64); 6] = [
    ("K", 1.0, 0.0),
    ("dgK", 1.0, 0.0),
    ("dgC", 1.0, 273.15),
    ("dgF", 5.0 / 9.0, 459.67 * 5.0 / 9.0),
    ("dgR", 5.0 / 9.0, 0.0),
    ("R", 5.0 / 9.0, 0.0),
];
const TEMPERATURE: [i8; 5] = [0, 0, 0, 1, 0];
const DEGREE: f64 = core::f64::consts::PI / 180.0;
const FOOT: f64 = 0.3048;
const POUND: f64 = 0.453_592_37;
const POUND_FORCE: f64 = POUND * 9.806_65;
const SLUG: f64 = POUND_FORCE / FOOT;
const LENGTH: [i8; 5] = [1, 0, 0, 0, 0];
const MASS: [i8; 5] = [0, 1, 0, 0, 0];
const TIME: [i8; 5] = [0, 0, 1, 0, 0];
const SPEED: [i8; 5] = [1, 0, -1, 0, 0];
const FORCE: [i8; 5] = [1, 1, -2, 0, 0];
const PRESSURE: [i8; 5] = [-1, 1, -2, 0, 0];

/// A unit as its relation to the SI unit of the same dimension: `si = value * factor + offset`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Unit {
    /// SI units in one of this unit. One for radians, 0.01 for percent.
    pub factor: f64,
    /// What is added after the factor; not zero only for temperatures with a zero of their own, such as `dgC`.
    pub offset: f64,
    /// Powers of metre, kilogram, second, kelvin and ampere.
    pub dimension: [i8; 5],
}

impl Unit {
    /// The unit with this S-119 text; none where a symbol is not known or a power has no place in eight bits. An empty
    /// text is dimensionless.
    ///
    /// ```
    /// use phugoid_aircraft::daveml::Unit;
    /// assert_eq!(Unit::parse("ft_s").map(|unit| unit.to_si(10.0)), Some(3.048));
    /// assert_eq!(Unit::parse("cubit"), None);
    /// ```
    pub fn parse(text: &str) -> Option<Self> {
        let text = text.trim();
        let dimensionless = Self { factor: 1.0, offset: 0.0, dimension: [0; 5] };
        if text.is_empty() {
            return Some(dimensionless);
        }
        if let Some(&(_, factor, offset)) = TEMPERATURES.iter().find(|(symbol, ..)| *symbol == text) {
            return Some(Self { factor, offset, dimension: TEMPERATURE });
        }
        let mut unit = dimensionless;
        let signed = text.contains('-');
        for (position, part) in text.split(['_', '/']).enumerate() {
            let sign: i8 = if position == 0 || signed { 1 } else { -1 };
            let part = if position == 0 && part == "1" { "" } else { part };
            let mut rest = part;
            while !rest.is_empty() {
                // The longest symbol that fits, as `min` is a minute and not a metre-inch.
                let known = SYMBOLS.iter().map(|&(symbol, factor, dimension)| (symbol, factor, dimension));
                let warm = TEMPERATURES.iter().map(|&(symbol, factor, _)| (symbol, factor, TEMPERATURE));
                let (symbol, factor, dimension) = known
                    .chain(warm)
                    .filter(|(symbol, ..)| rest.starts_with(symbol))
                    .max_by_key(|(symbol, ..)| symbol.len())?;
                rest = &rest[symbol.len()..];
                let digits = rest.len() - rest.trim_start_matches(|c: char| c.is_ascii_digit() || c == '-').len();
                let power: i8 = if digits == 0 { 1 } else { rest[..digits].parse().ok()? };
                rest = &rest[digits..];
                let power = power.checked_mul(sign)?;
                unit.factor *= factor.powi(i32::from(power));
                for (total, own) in unit.dimension.iter_mut().zip(dimension) {
                    *total = total.checked_add(own.checked_mul(power)?)?;
                }
            }
        }
        Some(unit)
    }

    /// A value in this unit, in SI. NaN stays NaN.
    pub fn to_si(&self, value: f64) -> f64 {
        value * self.factor + self.offset
    }

    /// A value in SI, in this unit. NaN stays NaN.
    pub fn from_si(&self, value: f64) -> f64 {
        (value - self.offset) / self.factor
    }
}

/// A value of check data in the unit of its variable. Where a unit is not given or not known, or they measure different things,
/// the value is taken as it stands.
pub(super) fn converted(value: f64, from: &str, to: &str) -> f64 {
    if from.trim().is_empty() || from.trim() == to.trim() {
        return value;
    }
    match (Unit::parse(from), Unit::parse(to)) {
        (Some(from), Some(to))
            if from.dimension == to.dimension && (from.factor, from.offset) != (to.factor, to.offset) =>
        {
            to.from_si(from.to_si(value))
        }
        _ => value,
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use super::*;

    #[test]
    fn units_of_the_standard_are_known() {
        for (text, value, si) in [
            ("deg", 180.0, core::f64::consts::PI),
            ("rad_s", 2.0, 2.0),
            ("ft", 1.0, 0.3048),
            ("ft2", 1.0, 0.3048 * 0.3048),
            ("nmi_h", 3600.0, 1852.0),
            ("kt", 3600.0, 1852.0),
            ("lbf", 1.0, 4.448_221_615_260_5),
            ("slug", 1.0, 14.593_902_937_206_4),
            ("slugft2", 1.0, 1.355_817_948_331_4),
            ("ftlbf", 1.0, 1.355_817_948_331_4),
            ("lbf_ft2", 1.0, 47.880_258_980_336),
            ("_rad", 2.0, 2.0),
            ("_deg", 1.0, 180.0 / core::f64::consts::PI),
            ("deg_ft", 1.0, 180.0_f64.recip() * core::f64::consts::PI / 0.3048),
            ("pct", 50.0, 0.5),
            ("dgC", 15.0, 288.15),
            ("dgF", 59.0, 288.15),
            ("m_s2", 1.0, 1.0),
            ("1/deg", 1.0, 180.0 / core::f64::consts::PI),
            ("ft_s-1", 1.0, 0.3048),
            ("", 1.0, 1.0),
        ] {
            let unit = Unit::parse(text).unwrap();
            assert!((unit.to_si(value) - si).abs() <= 1e-12 * si.abs(), "{text}: {}", unit.to_si(value));
            assert!((unit.from_si(si) - value).abs() <= 1e-12 * value.abs().max(100.0), "{text}");
        }
        for text in ["furlong", "ft200", "m127m", "1", "ft__", "ft-", "ft--2", "ft-128"] {
            let _ = Unit::parse(text);
        }
        assert_eq!(Unit::parse("furlong"), None);
    }

    #[test]
    fn only_units_of_the_same_kind_convert() {
        assert_eq!(converted(1.0, "rad", "deg"), 180.0 / core::f64::consts::PI);
        assert_eq!(converted(7.0, "f_s", "ft_s"), 7.0);
        assert_eq!(converted(7.0, "ft", "deg"), 7.0);
        assert_eq!(converted(7.0, "spans", "deg"), 7.0);
    }
}
