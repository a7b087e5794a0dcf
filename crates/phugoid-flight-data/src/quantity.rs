//! Numbers with units in text: `20000ft`, `-2 deg`, `300 ft^2`, `55814 slug*ft^2`.
//!
//! Command lines, scenario files and model files all read them here. The factors are those of [`crate::units`]. A decimal comma
//! is understood (`4,5 s`), unless it may as well separate thousands (`1,034 kg`).
//!
//! ```
//! use phugoid_flight_data::quantity::{Dimension, QuantityError};
//! assert_eq!(Dimension::LENGTH.parse("20000 ft"), Ok(6096.0));
//! assert!((Dimension::INERTIA.parse("1 slug*ft^2")? - 1.355_818).abs() < 1e-6);
//! assert!(matches!(Dimension::ANGLE.parse("2"), Err(QuantityError::NoUnit { .. })));
//! assert_eq!(Dimension::ANGLE.parse_or_si("2"), Ok(2.0));
//! assert!(matches!(Dimension::ANGLE.parse("5 m"), Err(QuantityError::WrongUnit { .. })));
//! # Ok::<(), QuantityError>(())
//! ```

use crate::units::{self, Quantity, UNITS};

/// Powers of length, mass, time, angle and temperature.
type Powers = [i8; 5];

/// The dimension of a quantity as powers of the base units, with the words that messages need.
///
/// Angles have a dimension of their own here, which SI does not give them, so that `5 m` is refused for an angle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Dimension {
    powers: Powers,
    name: &'static str,
    /// Examples of units that are understood, the SI unit first.
    units: &'static [&'static str],
}

/// Powers of the base units in the SI unit of a channel's quantity.
const fn powers(quantity: Quantity) -> Powers {
    match quantity {
        Quantity::Time => [0, 0, 1, 0, 0],
        Quantity::Frequency => [0, 0, -1, 0, 0],
        Quantity::Angle => [0, 0, 0, 1, 0],
        Quantity::AngularRate => [0, 0, -1, 1, 0],
        Quantity::AngularAcceleration => [0, 0, -2, 1, 0],
        Quantity::Speed => [1, 0, -1, 0, 0],
        Quantity::Acceleration => [1, 0, -2, 0, 0],
        Quantity::Length => [1, 0, 0, 0, 0],
        Quantity::Pressure => [-1, 1, -2, 0, 0],
        Quantity::Density => [-3, 1, 0, 0, 0],
        Quantity::Force => [1, 1, -2, 0, 0],
        Quantity::Mass => [0, 1, 0, 0, 0],
        Quantity::Inertia => [2, 1, 0, 0, 0],
        Quantity::Temperature => [0, 0, 0, 0, 1],
        Quantity::Number => [0; 5],
    }
}

/// Units of engines, by factor and powers. They are no units of headers: a column `q_w` is the fourth part of a quaternion and no
/// power.
fn of_engine(name: &str) -> Option<(f64, Powers)> {
    /// 550 ft lbf/s.
    const HORSEPOWER: f64 = 550.0 * 0.3048 * 0.453_592_37 * 9.806_65;
    const POWER: Powers = Dimension::POWER.powers;
    match name.to_ascii_lowercase().as_str() {
        "w" => Some((1.0, POWER)),
        "kw" => Some((1e3, POWER)),
        "hp" => Some((HORSEPOWER, POWER)),
        "rpm" => Some((1.0 / 60.0, Dimension::TURNS.powers)),
        _ => None,
    }
}

impl Dimension {
    const fn of(quantity: Quantity, units: &'static [&'static str]) -> Self {
        Self { powers: powers(quantity), name: quantity.in_words(), units }
    }
    /// A pure number, with no unit or in percent.
    pub const NUMBER: Self = Self::of(Quantity::Number, &["a pure number", "%"]);
    /// A length; SI unit m.
    pub const LENGTH: Self = Self::of(Quantity::Length, &["m", "ft", "km", "nmi", "cm", "mm", "in"]);
    /// An area; SI unit m^2.
    pub const AREA: Self = Self { powers: [2, 0, 0, 0, 0], name: "an area", units: &["m^2", "ft^2", "in^2"] };
    /// A mass; SI unit kg.
    pub const MASS: Self = Self::of(Quantity::Mass, &["kg", "lb", "slug", "t"]);
    /// A moment of inertia; SI unit kg m^2.
    pub const INERTIA: Self = Self::of(Quantity::Inertia, &["kg*m^2", "slug*ft^2", "lb*ft^2"]);
    /// An angular momentum, as of a rotor; SI unit kg m^2/s.
    pub const ANGULAR_MOMENTUM: Self =
        Self { powers: [2, 1, -1, 0, 0], name: "an angular momentum", units: &["kg*m^2/s", "slug*ft^2/s"] };
    /// A time or duration; SI unit s.
    pub const TIME: Self = Self::of(Quantity::Time, &["s", "ms", "min", "h"]);
    /// A frequency; SI unit Hz.
    pub const FREQUENCY: Self = Self::of(Quantity::Frequency, &["Hz", "kHz"]);
    /// An angle; SI unit rad.
    pub const ANGLE: Self = Self::of(Quantity::Angle, &["rad", "deg", "mrad"]);
    /// An angular rate; SI unit rad/s.
    pub const ANGULAR_RATE: Self = Self::of(Quantity::AngularRate, &["rad/s", "deg/s"]);
    /// An angular acceleration; SI unit rad/s^2.
    pub const ANGULAR_ACCELERATION: Self = Self::of(Quantity::AngularAcceleration, &["rad/s^2", "deg/s^2"]);
    /// A speed; SI unit m/s.
    pub const SPEED: Self = Self::of(Quantity::Speed, &["m/s", "ft/s", "kt", "km/h", "mph", "ft/min"]);
    /// An acceleration; SI unit m/s^2.
    pub const ACCELERATION: Self = Self::of(Quantity::Acceleration, &["m/s^2", "ft/s^2", "g", "mg"]);
    /// A force; SI unit N.
    pub const FORCE: Self = Self::of(Quantity::Force, &["N", "kN", "lbf"]);
    /// A power; SI unit W.
    pub const POWER: Self = Self { powers: [2, 1, -3, 0, 0], name: "a power", units: &["W", "kW", "hp"] };
    /// A speed of rotation, as of a propeller, in turns; SI unit Hz (turns per second).
    pub const TURNS: Self = Self { powers: [0, 0, -1, 0, 0], name: "a speed of rotation", units: &["Hz", "rpm"] };
    /// A flow of fuel; SI unit kg/s.
    pub const FUEL_FLOW: Self =
        Self { powers: [0, 1, -1, 0, 0], name: "a fuel flow", units: &["kg/s", "kg/h", "lb/h"] };
    /// Fuel for each thrust and time; SI unit kg/(N s), written kg/N/s.
    pub const FUEL_BY_THRUST: Self =
        Self { powers: [-1, 0, 1, 0, 0], name: "a fuel flow for each thrust", units: &["kg/N/s", "lb/lbf/h"] };
    /// Fuel for each power and time; SI unit kg/(W s), written kg/W/s.
    pub const FUEL_BY_POWER: Self =
        Self { powers: [-2, 0, 2, 0, 0], name: "a fuel flow for each power", units: &["kg/W/s", "kg/kW/h", "lb/hp/h"] };
    /// A density of the air; SI unit kg/m^3.
    pub const DENSITY: Self = Self::of(Quantity::Density, &["kg/m^3", "slug/ft^3", "lb/ft^3"]);
    /// The spectral density of the noise that drives a speed; SI unit m^2/s^3.
    pub const SPEED_NOISE: Self = Self {
        powers: [2, 0, -3, 0, 0],
        name: "a spectral density of an acceleration",
        units: &["m^2/s^3", "ft^2/s^3"],
    };
    /// The spectral density of the noise that drives an angle; SI unit rad^2/s.
    pub const ANGLE_NOISE: Self = Self {
        powers: [0, 0, -1, 2, 0],
        name: "a spectral density of an angular rate",
        units: &["rad^2/s", "deg^2/s"],
    };
    /// The spectral density of the noise that drives an angular rate; SI unit rad^2/s^3.
    pub const ANGULAR_RATE_NOISE: Self = Self {
        powers: [0, 0, -3, 2, 0],
        name: "a spectral density of an angular acceleration",
        units: &["rad^2/s^3", "deg^2/s^3"],
    };

    /// The SI unit of this dimension as text, such as `m/s^2`.
    pub fn si_unit(&self) -> &'static str {
        self.units.first().copied().unwrap_or_default()
    }

    /// The quantity as a noun with its article, for messages: `a length`, `an angle`.
    pub fn in_words(&self) -> &'static str {
        self.name
    }

    /// Reads a number with its unit and converts it to SI. A number without a unit is refused, because one person reads
    /// `alpha = 2` as degrees and the next as radians; only a pure number needs no unit.
    ///
    /// The unit is a product of units with whole powers: `ft/s^2`, `slug*ft^2`, `kg m^2`, `deg/s`; `/` divides by the
    /// next factor alone. Where a symbol has two meanings (`lb`, `kn`) the one that gives this dimension is taken.
    ///
    /// # Errors
    /// [`QuantityError`]: there is no number or no unit, or the unit is unknown or one of another quantity. The result
    /// is always finite: `nan` and `inf` are no numbers here.
    pub fn parse(&self, text: &str) -> Result<f64, QuantityError> {
        match self.split(text)? {
            (_, "") if *self != Self::NUMBER => Err(QuantityError::NoUnit {
                text: text.trim().into(),
                kind: self.name,
                first: self.si_unit(),
                units: self.units.join(", "),
            }),
            (number, unit) => self.convert(text, number, unit),
        }
    }

    /// As [`Self::parse`], but a number without a unit is taken as SI.
    ///
    /// # Errors
    /// As [`Self::parse`], without [`QuantityError::NoUnit`].
    pub fn parse_or_si(&self, text: &str) -> Result<f64, QuantityError> {
        let (number, unit) = self.split(text)?;
        self.convert(text, number, unit)
    }

    /// Separates number and unit. The number is the longest beginning that is one: `1e3m` is a thousand metres, and in
    /// `1ev` the `e` belongs to the unit.
    fn split<'a>(&self, text: &'a str) -> Result<(f64, &'a str), QuantityError> {
        let trimmed = text.trim();
        if let Some(read) = with_comma(trimmed) {
            return read;
        }
        // `inf` and `nan` parse as numbers in Rust and are none here.
        let end = trimmed.find(|c: char| !(c.is_ascii_digit() || "+-.eE_".contains(c))).unwrap_or(trimmed.len());
        (1..=end)
            .rev()
            .find_map(|i| {
                let number: f64 = trimmed.get(..i)?.replace('_', "").parse().ok()?;
                number.is_finite().then_some((number, trimmed.get(i..)?.trim()))
            })
            .ok_or_else(|| QuantityError::NoNumber {
                text: trimmed.into(),
                kind: self.name,
                first: self.si_unit(),
                units: self.units.join(", "),
            })
    }

    fn convert(&self, text: &str, number: f64, unit: &str) -> Result<f64, QuantityError> {
        if unit.is_empty() {
            return Ok(number);
        }
        // The zero of degC and degF is not that of SI: they need more than a factor.
        let value = match units::find(unit).into_iter().find(|u| u.offset != 0.0 && powers(u.quantity) == self.powers) {
            Some(with_zero) => Some(with_zero.to_si(number)),
            None => self.factor(text, unit)?.map(|factor| number * factor),
        };
        value.filter(|si| si.is_finite()).ok_or_else(|| QuantityError::WrongUnit {
            text: text.trim().into(),
            unit: unit.into(),
            kind: self.name,
            units: self.units.join(", "),
        })
    }

    /// SI units per one of the unit; `None` if it is a unit of another dimension.
    fn factor(&self, text: &str, unit: &str) -> Result<Option<f64>, QuantityError> {
        // All products of meanings of the words so far: (factor, powers). Few words have more than one meaning.
        let mut meanings: Vec<(f64, [i32; 5])> = vec![(1.0, [0; 5])];
        let mut sign = 1;
        let spaced = unit.replace(['*', '·'], " ").replace('/', " / ").replace('²', "^2").replace('³', "^3");
        for word in spaced.split_whitespace() {
            if word == "/" || word == "per" {
                sign = -1;
                continue;
            }
            let (name, power) = name_and_power(word).ok_or_else(|| self.unknown(text, word))?;
            let found: Vec<(f64, Powers)> = units::find(name)
                .into_iter()
                // Units with an offset (degC) have no meaning in products.
                .filter(|unit| unit.offset == 0.0)
                .map(|unit| (unit.scale, powers(unit.quantity)))
                .chain(of_engine(name))
                .collect();
            if found.is_empty() || meanings.len() > 64 {
                return Err(self.unknown(text, name));
            }
            meanings = meanings
                .iter()
                .flat_map(|(factor, total)| {
                    found.iter().map(move |(scale, powers)| {
                        let total = std::array::from_fn(|i| total[i] + sign * power * i32::from(powers[i]));
                        (factor * scale.powi(sign * power), total)
                    })
                })
                .collect();
            sign = 1;
        }
        let wanted = self.powers.map(i32::from);
        Ok(meanings.into_iter().find(|(_, powers)| *powers == wanted).map(|(factor, _)| factor))
    }

    fn unknown(&self, text: &str, word: &str) -> QuantityError {
        let symbols = self.units.iter().copied().chain(UNITS.iter().map(|unit| unit.symbol));
        let near = symbols
            .map(|symbol| (strsim::jaro_winkler(&word.to_lowercase(), &symbol.to_lowercase()), symbol))
            .filter(|(likeness, _)| *likeness > 0.75)
            // Of equally similar symbols the first, because the units of this dimension come first.
            .fold(
                None,
                |best: Option<(f64, &str)>, next| if best.is_none_or(|b| next.0 > b.0) { Some(next) } else { best },
            );
        QuantityError::UnknownUnit {
            text: text.trim().into(),
            word: word.into(),
            kind: self.name,
            near: near.map(|(_, symbol)| symbol),
            units: self.units.join(", "),
        }
    }
}

/// Separates a number with a comma in it from its unit; `None` where the text begins with no such number. A comma is a decimal one,
/// as in the files that are read, unless it may as well separate thousands.
fn with_comma(text: &str) -> Option<Result<(f64, &str), QuantityError>> {
    let end = text.find(|c: char| !(c.is_ascii_digit() || "+-.,".contains(c))).unwrap_or(text.len());
    let (number, rest) = text.split_at_checked(end)?;
    let last = number.rfind([',', '.'])?;
    let (whole, decimals) = (number.get(..last)?, number.get(last + 1..)?);
    let digits = whole.trim_start_matches(['+', '-']);
    if !number.contains(',') || decimals.is_empty() || digits.is_empty() || whole.len() > digits.len() + 1 {
        return None;
    }
    let plain = |text: &str| text.bytes().all(|byte| byte.is_ascii_digit());
    let point = format!("{whole}.{decimals}");
    match plain(digits) && plain(decimals) {
        // `0,050` and `1034,250` are no groups of three.
        true if decimals.len() == 3 && digits.len() <= 3 && !digits.starts_with('0') => {
            let (text, thousands) = (text.to_owned(), format!("{whole}{decimals}{rest}"));
            Some(Err(QuantityError::PointOrThousands { text, point: format!("{point}{rest}"), thousands }))
        }
        true => {
            // What stands behind it may be an exponent: `1,5e3`.
            let with_point = format!("{point}{rest}");
            let ends = (1..=with_point.len()).rev().filter(|&end| end >= point.len());
            let (value, end) = ends
                .filter_map(|end| Some((with_point.get(..end)?.parse::<f64>().ok()?, end)))
                .find(|(value, _)| value.is_finite())?;
            Some(Ok((value, text.get(end..)?.trim())))
        }
        // Marks of thousands in front of decimals, or several of them.
        false => {
            let groups: Vec<&str> = number.trim_start_matches(['+', '-']).split([',', '.']).collect();
            let all_plain = groups.iter().all(|group| !group.is_empty() && plain(group));
            let mark = whole.chars().find(|c| matches!(c, ',' | '.'))?;
            let without = |text: &str| text.replace([',', '.'], "");
            let written = match number.get(last..)?.starts_with(mark) {
                true => format!("{}{rest}", without(number)),
                false => format!("{}.{decimals}{rest}", without(whole)),
            };
            all_plain.then(|| Err(QuantityError::Thousands { text: text.to_owned(), written }))
        }
    }
}

/// Splits `ft^2`, `ft2` or `s^-1` into the unit and its power; `None` if the power is no whole number from -6 to 6.
fn name_and_power(word: &str) -> Option<(&str, i32)> {
    let (name, power) = match word.split_once('^') {
        Some(parts) => parts,
        // `m_s2` and `dps2` are units of their own.
        None if !units::find(word).is_empty() => return Some((word, 1)),
        None => {
            let name = word.trim_end_matches(|c: char| c.is_ascii_digit()).trim_end_matches('-');
            (name, word.get(name.len()..).filter(|power| !power.is_empty()).unwrap_or("1"))
        }
    };
    power.parse().ok().filter(|power: &i32| power.abs() <= 6).map(|power| (name, power))
}

/// Why a text cannot be read as a quantity of the wanted dimension.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum QuantityError {
    /// The text is a number without a unit.
    #[error("`{text}` has no unit: write {kind} as in `{text}{first}` (units: {units})")]
    NoUnit {
        /// The text as it was written.
        text: String,
        /// The wanted quantity as a noun with its article.
        kind: &'static str,
        /// The SI unit of the wanted dimension.
        first: &'static str,
        /// Examples of units of the wanted dimension, separated by commas.
        units: String,
    },
    /// The text does not begin with a number.
    #[error("`{text}` does not start with a number: write {kind} as in `10 {first}` (units: {units})")]
    NoNumber {
        /// The text as it was written.
        text: String,
        /// The wanted quantity as a noun with its article.
        kind: &'static str,
        /// The SI unit of the wanted dimension.
        first: &'static str,
        /// Examples of units of the wanted dimension, separated by commas.
        units: String,
    },
    /// A comma with three digits behind it: a decimal comma, or one between thousands.
    #[error(
        "`{text}` can be read as `{point}` or as `{thousands}`: write the one that is meant, with a point or without a mark"
    )]
    PointOrThousands {
        /// The text as it was written.
        text: String,
        /// With the comma as a decimal one.
        point: String,
        /// With the comma between thousands.
        thousands: String,
    },
    /// The number has marks between its thousands.
    #[error("`{text}` has marks between thousands: write the number without them, as in `{written}`")]
    Thousands {
        /// The text as it was written.
        text: String,
        /// The number without marks of thousands, and with a decimal point.
        written: String,
    },
    /// The unit is known, but is a unit of another dimension.
    #[error("`{unit}` in `{text}` is not a unit of {kind}: expected {units} or its like")]
    WrongUnit {
        /// The text as it was written.
        text: String,
        /// The part that was taken for the unit.
        unit: String,
        /// The wanted quantity as a noun with its article.
        kind: &'static str,
        /// Examples of units of the wanted dimension, separated by commas.
        units: String,
    },
    /// A word of the unit is not known.
    #[error("unknown unit `{word}` in `{text}`{}", match near {
        Some(near) => format!(": did you mean `{near}`?"),
        None => format!(", which should be {kind}: expected {units} or its like"),
    })]
    UnknownUnit {
        /// The text as it was written.
        text: String,
        /// The word that is not known.
        word: String,
        /// The wanted quantity as a noun with its article.
        kind: &'static str,
        /// The unit with the most similar symbol.
        near: Option<&'static str>,
        /// Examples of units of the wanted dimension, separated by commas.
        units: String,
    },
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const ALL: [Dimension; 23] = [
        Dimension::NUMBER,
        Dimension::LENGTH,
        Dimension::AREA,
        Dimension::MASS,
        Dimension::INERTIA,
        Dimension::TIME,
        Dimension::FREQUENCY,
        Dimension::ANGLE,
        Dimension::ANGULAR_RATE,
        Dimension::ANGULAR_ACCELERATION,
        Dimension::SPEED,
        Dimension::ACCELERATION,
        Dimension::FORCE,
        Dimension::DENSITY,
        Dimension::SPEED_NOISE,
        Dimension::ANGLE_NOISE,
        Dimension::ANGULAR_RATE_NOISE,
        Dimension::of(Quantity::Temperature, &["K", "degC", "degF"]),
        Dimension::POWER,
        Dimension::TURNS,
        Dimension::FUEL_FLOW,
        Dimension::FUEL_BY_THRUST,
        Dimension::FUEL_BY_POWER,
    ];

    #[test]
    fn units_convert_to_si() {
        let close = |text: &str, dimension: Dimension, expected: f64| {
            let value = dimension.parse(text).unwrap();
            assert!((value - expected).abs() <= 1e-12 * expected.abs(), "{text}: {value} != {expected}");
        };
        close("2.43 m", Dimension::LENGTH, 2.43);
        close("20000ft", Dimension::LENGTH, 6096.0);
        close("20_000 ft", Dimension::LENGTH, 6096.0);
        close("1e3m", Dimension::LENGTH, 1000.0);
        close("675 ft/s", Dimension::SPEED, 205.74);
        close("36 km/h", Dimension::SPEED, 10.0);
        close("300 ft^2", Dimension::AREA, 300.0 * 0.3048 * 0.3048);
        close("300ft²", Dimension::AREA, 300.0 * 0.3048 * 0.3048);
        close("-2 deg", Dimension::ANGLE, -2.0_f64.to_radians());
        close("3 °/s", Dimension::ANGULAR_RATE, 3.0_f64.to_radians());
        close("3 deg per sec", Dimension::ANGULAR_RATE, 3.0_f64.to_radians());
        close("3 deg_s", Dimension::ANGULAR_RATE, 3.0_f64.to_radians());
        close("20500 lb", Dimension::MASS, 20500.0 * 0.453_592_37);
        close("20500lb", Dimension::MASS, 20500.0 * 0.453_592_37);
        // The dimension decides what a pound and a kn are.
        close("1 lb", Dimension::FORCE, 4.448_221_615_260_5);
        close("1 kn", Dimension::FORCE, 1000.0);
        close("3600 kn", Dimension::SPEED, 1852.0);
        close("1 lb/ft^3", Dimension::DENSITY, 0.453_592_37 / 0.3048_f64.powi(3));
        // 1 slug = 14.593902937206 kg (NIST SP 811, table B.8)
        close("1 slug", Dimension::MASS, 14.593_902_937_206_364);
        for text in ["55814 slug*ft^2", "55814 slug ft2", "55814 slug_ft2", "55814 slug·ft²"] {
            close(text, Dimension::INERTIA, 55814.0 * 1.355_817_948_331_400_4);
        }
        close("32.17 ft/s^2", Dimension::ACCELERATION, 9.805_416);
        close("32.17 ft/s/s", Dimension::ACCELERATION, 9.805_416);
        close("32.17 ft s-2", Dimension::ACCELERATION, 9.805_416);
        close("2227.744 lbf", Dimension::FORCE, 2227.744 * 4.448_221_615_260_5);
        close("10 ft^2/s^3", Dimension::SPEED_NOISE, 10.0 * 0.3048 * 0.3048);
        close("1e-4 rad^2/s", Dimension::ANGLE_NOISE, 1e-4);
        close("2 1/s", Dimension::FREQUENCY, 2.0);
        close("59 degF", ALL[17], 288.15);
        close("119 kW", Dimension::POWER, 119_000.0);
        // 1 hp = 745.699872 W (NIST SP 811, table B.8)
        close("160 hp", Dimension::POWER, 160.0 * 745.699_871_582_270_1);
        close("2400 rpm", Dimension::TURNS, 40.0);
        close("0.6 lb/lbf/h", Dimension::FUEL_BY_THRUST, 0.6 / 9.806_65 / 3600.0);
        close("0.3 kg/kW/h", Dimension::FUEL_BY_POWER, 0.3 / 1000.0 / 3600.0);
        close("30 %", Dimension::NUMBER, 0.3);
        // Decimal commas, where they can be nothing else.
        close("4,5s", Dimension::TIME, 4.5);
        close("16,17 m2", Dimension::AREA, 16.17);
        close("-0,050 s", Dimension::TIME, -0.05);
        close("1034,250 kg", Dimension::MASS, 1034.25);
        close("1,5e3m", Dimension::LENGTH, 1500.0);
        close("1,5e-3 m", Dimension::LENGTH, 0.0015);
        close("2,5", Dimension::NUMBER, 2.5);
        close("0.3", Dimension::NUMBER, 0.3);
        assert_eq!(Dimension::LENGTH.parse_or_si("3"), Ok(3.0));
    }

    #[test]
    fn the_units_in_messages_are_understood() {
        for dimension in ALL {
            for unit in dimension.units.iter().filter(|unit| **unit != "a pure number") {
                assert!(dimension.parse(&format!("2 {unit}")).is_ok(), "{unit}");
            }
            assert!(
                dimension == Dimension::NUMBER || dimension.parse(&format!("2 {}", dimension.si_unit())) == Ok(2.0)
            );
        }
    }

    /// The powers of a quantity and the factor of its units are two statements about one thing.
    #[test]
    fn every_unit_of_the_table_is_one_of_its_dimension() {
        for unit in UNITS.iter().filter(|unit| unit.symbol != "-" && unit.symbol != "1") {
            let dimension = Dimension::of(unit.quantity, &[]);
            assert_eq!(dimension.parse(&format!("3 {}", unit.symbol)), Ok(unit.to_si(3.0)), "{}", unit.symbol);
            // A composite is what its factors make of it; but `g` alone is that of the accelerations, no gram.
            if let Some((first, rest)) = unit.symbol.split_once('_').filter(|(first, _)| *first != "g") {
                let per = unit.quantity != Quantity::Inertia;
                let product = format!("3 {first}{}{rest}", if per { "/" } else { "*" });
                let value = dimension.parse(&product).unwrap();
                assert!((value / unit.to_si(3.0) - 1.0).abs() < 1e-15, "{product}");
            }
        }
    }

    #[test]
    fn wrong_units_are_named() {
        let error = |text: &str, dimension: Dimension| dimension.parse(text).unwrap_err().to_string();
        assert!(error("5 m", Dimension::ANGLE).contains("not a unit of an angle: expected rad"));
        assert!(error("5 slgu", Dimension::MASS).contains("did you mean `slug`"));
        assert!(error("5 slgu*ft^2", Dimension::INERTIA).contains("unknown unit `slgu`"));
        assert!(error("55 kg/m^2", Dimension::INERTIA).contains("not a unit of a moment of inertia"));
        assert!(error("55 ft*s", Dimension::SPEED).contains("not a unit of a speed"));
        assert!(error("5 xyzzy", Dimension::MASS).contains("kg, lb, slug"));
        assert!(error("675", Dimension::SPEED).contains("no unit") && error("675", Dimension::SPEED).contains("kt"));
        let both = error("1,034 kg", Dimension::MASS);
        assert!(both.contains("`1.034 kg` or as `1034 kg`"), "{both}");
        assert!(error("-12,500ft", Dimension::LENGTH).contains("`-12.500ft` or as `-12500ft`"));
        assert!(error("1.034,5 kg", Dimension::MASS).contains("as in `1034.5 kg`"));
        assert!(error("1,034.5 kg", Dimension::MASS).contains("as in `1034.5 kg`"));
        assert!(error("1,034,000 kg", Dimension::MASS).contains("as in `1034000 kg`"));
        for text in [
            "1,",
            ",5 m",
            "1,,5 m",
            "--1,5 m",
            "1,5,2.7,m",
            "five",
            "",
            "5 m^99",
            "5 m^m",
            "5 ^2",
            "nan",
            "inf m",
            "NaNm",
            "1e999m",
            "5 degC",
        ] {
            assert!(Dimension::LENGTH.parse(text).is_err() && Dimension::LENGTH.parse_or_si(text).is_err(), "{text}");
        }
    }

    proptest! {
        #[test]
        fn no_text_panics(text in "\\PC*", unit in "[a-z0-9 */^.-]{0,40}") {
            for dimension in ALL {
                let _ = dimension.parse(&text);
                let _ = dimension.parse(&format!("3 {unit}"));
            }
        }

        #[test]
        fn what_is_printed_is_read_back(value in -1e6..1e6_f64) {
            for dimension in &ALL[1..] {
                prop_assert_eq!(dimension.parse(&format!("{value} {}", dimension.si_unit())), Ok(value));
            }
        }
    }
}
