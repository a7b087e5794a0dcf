//! Physical quantities, the units that are understood in headers, unit rows and mappings, and their conversion to SI.
//!
//! ```
//! use phugoid_flight_data::units::{Quantity, accepted, find_for};
//! let knots = find_for("KTS", Quantity::Speed).expect("knots are known");
//! assert!((knots.to_si(100.0) - 51.444).abs() < 1e-3);
//! assert_eq!(find_for("deg/s", Quantity::AngularRate), find_for("Deg per sec", Quantity::AngularRate));
//! assert_eq!(find_for("deg", Quantity::Speed), None);
//! assert_eq!(accepted(Quantity::Angle), "rad, deg, mrad");
//! ```

use serde::{Deserialize, Serialize};

/// The physical quantity of a channel. It decides which units are understood, and in which SI unit values are kept.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Quantity {
    /// A time or a duration; SI unit s.
    Time,
    /// A frequency; SI unit Hz.
    Frequency,
    /// An angle; SI unit rad.
    Angle,
    /// An angular rate; SI unit rad/s.
    AngularRate,
    /// An angular acceleration; SI unit rad/s^2.
    AngularAcceleration,
    /// A speed or a component of a velocity; SI unit m/s.
    Speed,
    /// An acceleration or a specific force; SI unit m/s^2.
    Acceleration,
    /// A length, a distance or an altitude; SI unit m.
    Length,
    /// A pressure; SI unit Pa.
    Pressure,
    /// The density of a gas or liquid; SI unit kg/m^3.
    Density,
    /// A force; SI unit N.
    Force,
    /// A mass; SI unit kg.
    Mass,
    /// A moment or product of inertia; SI unit kg m^2.
    Inertia,
    /// A temperature above absolute zero; SI unit K.
    Temperature,
    /// A pure number: throttle, Mach number, load factor, a flag. No unit.
    Number,
}

impl Quantity {
    /// The SI unit as printed: `rad/s`, `kg m^2`, `-` for a pure number.
    pub fn si_unit(self) -> &'static str {
        match self {
            Quantity::Time => "s",
            Quantity::Frequency => "Hz",
            Quantity::Angle => "rad",
            Quantity::AngularRate => "rad/s",
            Quantity::AngularAcceleration => "rad/s^2",
            Quantity::Speed => "m/s",
            Quantity::Acceleration => "m/s^2",
            Quantity::Length => "m",
            Quantity::Pressure => "Pa",
            Quantity::Density => "kg/m^3",
            Quantity::Force => "N",
            Quantity::Mass => "kg",
            Quantity::Inertia => "kg m^2",
            Quantity::Temperature => "K",
            Quantity::Number => "-",
        }
    }

    /// The SI unit as a header suffix: `rad_s`, `kg_m2`, empty for a pure number.
    pub fn si_suffix(self) -> &'static str {
        match self {
            Quantity::Time => "s",
            Quantity::Frequency => "hz",
            Quantity::Angle => "rad",
            Quantity::AngularRate => "rad_s",
            Quantity::AngularAcceleration => "rad_s2",
            Quantity::Speed => "m_s",
            Quantity::Acceleration => "m_s2",
            Quantity::Length => "m",
            Quantity::Pressure => "pa",
            Quantity::Density => "kg_m3",
            Quantity::Force => "n",
            Quantity::Mass => "kg",
            Quantity::Inertia => "kg_m2",
            Quantity::Temperature => "k",
            Quantity::Number => "",
        }
    }

    /// The quantity as a noun with its article, for messages: `an angle`, `a speed`.
    pub const fn in_words(self) -> &'static str {
        match self {
            Quantity::Time => "a time",
            Quantity::Frequency => "a frequency",
            Quantity::Angle => "an angle",
            Quantity::AngularRate => "an angular rate",
            Quantity::AngularAcceleration => "an angular acceleration",
            Quantity::Speed => "a speed",
            Quantity::Acceleration => "an acceleration",
            Quantity::Length => "a length",
            Quantity::Pressure => "a pressure",
            Quantity::Density => "a density",
            Quantity::Force => "a force",
            Quantity::Mass => "a mass",
            Quantity::Inertia => "a moment of inertia",
            Quantity::Temperature => "a temperature",
            Quantity::Number => "a pure number",
        }
    }
}

/// A unit of a quantity: `SI value = scale * value + offset`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Unit {
    /// How it is written in messages and in header suffixes, e.g. `ft_s2`.
    pub symbol: &'static str,
    /// The quantity that it measures.
    pub quantity: Quantity,
    /// SI units per one of this unit.
    pub scale: f64,
    /// SI value of zero in this unit; not 0 only for temperatures such as degC.
    pub offset: f64,
}

impl Unit {
    /// Converts a value in this unit to SI. NaN stays NaN.
    pub fn to_si(&self, value: f64) -> f64 {
        self.scale * value + self.offset
    }

    /// Converts a value in SI to this unit. NaN stays NaN.
    pub fn from_si(&self, value: f64) -> f64 {
        (value - self.offset) / self.scale
    }
}

const fn unit(symbol: &'static str, quantity: Quantity, scale: f64) -> Unit {
    Unit { symbol, quantity, scale, offset: 0.0 }
}

const FOOT: f64 = 0.3048; // exact, international foot (1959)
const POUND: f64 = 0.453_592_37; // exact, avoirdupois pound (1959)
const GRAVITY: f64 = 9.806_65; // exact, standard gravity (CGPM 1901)
const NAUTICAL_MILE: f64 = 1852.0; // exact
const POUND_FORCE: f64 = POUND * GRAVITY;
const SLUG: f64 = POUND_FORCE / FOOT;
const DEGREE: f64 = std::f64::consts::PI / 180.0;
const FEET2: f64 = FOOT * FOOT;
const INCH2: f64 = FEET2 / 144.0;

use Quantity::{
    Acceleration, Angle, AngularAcceleration, AngularRate, Density, Force, Frequency, Inertia, Length, Mass, Number,
    Pressure, Speed, Temperature, Time,
};

/// All units that are understood. The first one of a quantity is its SI unit. A symbol may stand under two quantities
/// (`lb` is a mass and a force, `kn` a speed and a force); the channel decides which is meant.
#[rustfmt::skip]
pub const UNITS: &[Unit] = &[
    unit("s", Time, 1.0), unit("ms", Time, 1e-3), unit("us", Time, 1e-6), unit("ns", Time, 1e-9),
    unit("min", Time, 60.0), unit("h", Time, 3600.0),

    unit("hz", Frequency, 1.0), unit("khz", Frequency, 1e3),

    unit("rad", Angle, 1.0), unit("deg", Angle, DEGREE), unit("mrad", Angle, 1e-3),

    unit("rad_s", AngularRate, 1.0), unit("deg_s", AngularRate, DEGREE), unit("dps", AngularRate, DEGREE),
    unit("mrad_s", AngularRate, 1e-3),

    unit("rad_s2", AngularAcceleration, 1.0), unit("deg_s2", AngularAcceleration, DEGREE),
    unit("dps2", AngularAcceleration, DEGREE),

    unit("m_s", Speed, 1.0), unit("mps", Speed, 1.0), unit("ft_s", Speed, FOOT), unit("fps", Speed, FOOT),
    unit("kt", Speed, NAUTICAL_MILE / 3600.0), unit("kn", Speed, NAUTICAL_MILE / 3600.0),
    unit("km_h", Speed, 1.0 / 3.6), unit("kmh", Speed, 1.0 / 3.6), unit("kph", Speed, 1.0 / 3.6),
    unit("mph", Speed, 5280.0 * FOOT / 3600.0), unit("ft_min", Speed, FOOT / 60.0), unit("fpm", Speed, FOOT / 60.0),

    unit("m_s2", Acceleration, 1.0), unit("mps2", Acceleration, 1.0), unit("ft_s2", Acceleration, FOOT),
    unit("fps2", Acceleration, FOOT), unit("g", Acceleration, GRAVITY), unit("mg", Acceleration, 1e-3 * GRAVITY),

    unit("m", Length, 1.0), unit("ft", Length, FOOT), unit("km", Length, 1e3), unit("mm", Length, 1e-3),
    unit("cm", Length, 1e-2), unit("in", Length, FOOT / 12.0), unit("nm", Length, NAUTICAL_MILE),
    unit("nmi", Length, NAUTICAL_MILE),

    unit("pa", Pressure, 1.0), unit("hpa", Pressure, 100.0), unit("kpa", Pressure, 1e3), unit("mbar", Pressure, 100.0),
    unit("mb", Pressure, 100.0), unit("bar", Pressure, 1e5), unit("psf", Pressure, POUND_FORCE / FEET2),
    unit("lbf_ft2", Pressure, POUND_FORCE / FEET2), unit("lb_ft2", Pressure, POUND_FORCE / FEET2),
    unit("psi", Pressure, POUND_FORCE / INCH2), unit("lbf_in2", Pressure, POUND_FORCE / INCH2),
    unit("n_m2", Pressure, 1.0), unit("inhg", Pressure, 3386.389), unit("mmhg", Pressure, 133.322_387_415),
    unit("atm", Pressure, 101_325.0),

    unit("kg_m3", Density, 1.0), unit("slug_ft3", Density, SLUG / (FEET2 * FOOT)),
    unit("lb_ft3", Density, POUND / (FEET2 * FOOT)), unit("lbm_ft3", Density, POUND / (FEET2 * FOOT)),
    unit("g_m3", Density, 1e-3),

    unit("n", Force, 1.0), unit("kn", Force, 1e3), unit("dan", Force, 10.0), unit("lbf", Force, POUND_FORCE),
    unit("lb", Force, POUND_FORCE), unit("klbf", Force, 1e3 * POUND_FORCE), unit("kgf", Force, GRAVITY),

    unit("kg", Mass, 1.0), unit("lb", Mass, POUND), unit("lbm", Mass, POUND), unit("slug", Mass, SLUG),
    unit("t", Mass, 1e3),

    unit("kg_m2", Inertia, 1.0), unit("slug_ft2", Inertia, SLUG * FEET2), unit("lb_ft2", Inertia, POUND * FEET2),
    unit("lbm_ft2", Inertia, POUND * FEET2),

    unit("k", Temperature, 1.0),
    Unit { symbol: "degc", quantity: Temperature, scale: 1.0, offset: 273.15 },
    Unit { symbol: "c", quantity: Temperature, scale: 1.0, offset: 273.15 },
    Unit { symbol: "degf", quantity: Temperature, scale: 5.0 / 9.0, offset: 459.67 * 5.0 / 9.0 },
    Unit { symbol: "f", quantity: Temperature, scale: 5.0 / 9.0, offset: 459.67 * 5.0 / 9.0 },
    unit("degr", Temperature, 5.0 / 9.0),

    unit("-", Number, 1.0), unit("1", Number, 1.0), unit("nd", Number, 1.0), unit("pct", Number, 0.01),
];

/// The units that a text can mean, at most one per quantity; empty if it is no unit. Case, spaces and the usual
/// spellings do not matter: `deg/s`, `deg_s`, `Deg per sec`, `°/s` and `deg s-1` are the same unit.
pub fn find(text: &str) -> Vec<Unit> {
    let symbol = normalise(text);
    UNITS.iter().copied().filter(|unit| unit.symbol == symbol).collect()
}

/// The unit of this quantity that a text means; `None` if it is no unit, or one of another quantity.
pub fn find_for(text: &str, quantity: Quantity) -> Option<Unit> {
    find(text).into_iter().find(|unit| unit.quantity == quantity)
}

/// The symbols understood for a quantity, SI first, for messages: `rad, deg, mrad`.
pub fn accepted(quantity: Quantity) -> String {
    let symbols: Vec<_> = UNITS.iter().filter(|unit| unit.quantity == quantity).map(|unit| unit.symbol).collect();
    symbols.join(", ")
}

/// Brings a unit as typed to the spelling of [`UNITS`]: lower case, factors joined by `_`, exponents as digits.
fn normalise(text: &str) -> String {
    let text = text.trim().to_lowercase().replace("**", "");
    match text.as_str() {
        "-" | "--" | "1" | "none" | "n/a" | "dimensionless" | "nondim" | "ratio" | "fraction" => return "-".into(),
        "%" | "percent" | "pct" | "per cent" => return "pct".into(),
        "g's" | "gs" | "g0" => return "g".into(),
        "degps" | "degpersec" => return "deg_s".into(),
        "radps" | "radpersec" => return "rad_s".into(),
        "degps2" => return "deg_s2".into(),
        "radps2" => return "rad_s2".into(),
        _ => {}
    }
    let mut plain = String::with_capacity(text.len() + 4);
    for c in text.chars() {
        match c {
            '°' | 'º' => plain.push_str("deg"),
            '²' => plain.push('2'),
            '³' => plain.push('3'),
            'µ' | 'μ' => plain.push('u'),
            '^' => {}
            '/' | '·' | '*' | '.' | '_' | '(' | ')' => plain.push(' '),
            c if c.is_whitespace() => plain.push(' '),
            c => plain.push(c),
        }
    }
    let mut factors: Vec<&str> = plain.split_whitespace().map(factor).filter(|f| !f.is_empty()).collect();
    // `m/s/s`
    if let [.., "s", "s"] = factors.as_slice() {
        factors.truncate(factors.len() - 2);
        factors.push("s2");
    }
    // `deg C`
    if let ["deg", letter @ ("c" | "f" | "r")] = factors.as_slice() {
        return format!("deg{letter}");
    }
    factors.join("_")
}

/// Brings one factor of a unit to the spelling of [`UNITS`].
fn factor(word: &str) -> &str {
    match word {
        "per" => "",
        "sec" | "secs" | "second" | "seconds" | "s-1" | "sec-1" | "sek" => "s",
        "s-2" | "sec2" | "sec-2" => "s2",
        "m-2" => "m2",
        "m-3" => "m3",
        "msec" | "millis" | "millisecond" | "milliseconds" => "ms",
        "usec" | "micros" | "microsecond" | "microseconds" => "us",
        "nsec" | "nanos" | "nanosecond" | "nanoseconds" => "ns",
        "minute" | "minutes" | "mins" => "min",
        "hr" | "hrs" | "hour" | "hours" => "h",
        "degree" | "degrees" | "degs" | "grad" | "grados" | "degré" | "degrés" => "deg",
        "radian" | "radians" | "rads" => "rad",
        "meter" | "meters" | "metre" | "metres" => "m",
        "foot" | "feet" => "ft",
        "knot" | "knots" | "kts" | "knoten" => "kt",
        "newton" | "newtons" => "n",
        "pascal" | "pascals" => "pa",
        "kgs" | "kilogram" | "kilograms" => "kg",
        "lbs" | "pound" | "pounds" => "lb",
        "slugs" => "slug",
        "kelvin" => "k",
        "celsius" => "degc",
        "fahrenheit" => "degf",
        "rankine" => "degr",
        other => other,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spellings_of_one_unit_agree() {
        for text in [
            "deg/s",
            "deg_s",
            "Deg per sec",
            "°/s",
            "deg s-1",
            "degrees/second",
            "DEG_S",
            "Grad/s",
            "grados/s",
            "degps",
        ] {
            assert_eq!(find_for(text, AngularRate).map(|u| u.symbol), Some("deg_s"), "{text}");
        }
        for text in ["m/s^2", "m/s²", "m_s2", "m/s/s", "M/S2", "m s-2", "m/s**2", "m/sec^2"] {
            assert_eq!(find_for(text, Acceleration).map(|u| u.symbol), Some("m_s2"), "{text}");
        }
        for text in ["slug/ft^3", "slug_ft3", "slugs/ft³"] {
            assert_eq!(find_for(text, Density).map(|u| u.symbol), Some("slug_ft3"), "{text}");
        }
        assert!(find("parsec").is_empty());
        assert!(find("").is_empty());
    }

    /// Published conversion factors (NIST SP 811, appendix B.8), to the digits printed there.
    #[test]
    fn factors_are_the_published_ones() {
        for (text, quantity, factor, tolerance) in [
            ("kt", Speed, 0.514_444_4, 1e-7),
            ("psf", Pressure, 47.880_26, 1e-5),
            ("psi", Pressure, 6894.757, 1e-3),
            ("lbf", Force, 4.448_222, 1e-6),
            ("slug", Mass, 14.593_90, 1e-5),
            ("slug_ft2", Inertia, 1.355_818, 1e-6),
            ("slug_ft3", Density, 515.3788, 1e-4),
            ("inhg", Pressure, 3386.389, 1e-3),
            ("mph", Speed, 0.447_04, 1e-9),
            ("deg", Angle, 0.017_453_29, 1e-8),
        ] {
            let found = find_for(text, quantity).unwrap_or_else(|| panic!("{text}"));
            assert!((found.to_si(1.0) - factor).abs() <= tolerance, "{text}: {}", found.to_si(1.0));
        }
        let fahrenheit = find_for("degF", Temperature).unwrap();
        assert!((fahrenheit.to_si(59.0) - 288.15).abs() < 1e-9, "59 F is 15 C");
        assert!((fahrenheit.from_si(288.15) - 59.0).abs() < 1e-9);
    }

    #[test]
    fn every_quantity_begins_with_its_si_unit_and_no_symbol_is_double() {
        for (index, unit) in UNITS.iter().enumerate() {
            let first = UNITS.iter().find(|other| other.quantity == unit.quantity).unwrap();
            assert_eq!((first.scale, first.offset), (1.0, 0.0), "{}", first.symbol);
            assert_eq!(find_for(unit.symbol, unit.quantity).map(|u| u.scale), Some(unit.scale), "{}", unit.symbol);
            let double = UNITS[..index].iter().any(|o| o.symbol == unit.symbol && o.quantity == unit.quantity);
            assert!(!double, "{}", unit.symbol);
        }
    }
}
