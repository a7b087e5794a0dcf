//! Quantities as a user writes them: a number with its unit, `20000ft`, `1.5 deg`, `675 ft/s`.
//!
//! Command lines and scenario files share this module. Inside there is SI and radians only; a bare number for a
//! quantity that has a dimension is refused, because `alpha = 2` means two very different things to two people.

use std::fmt;
use std::str::FromStr;

use phugoid_flight_data::{record, units};
use serde::{Deserialize, Deserializer, Serialize, Serializer, de};

/// What a quantity is called, the units to name in messages (the most usual first), and how a unit is converted to SI.
struct Kind {
    name: &'static str,
    units: &'static [&'static str],
    convert: fn(&str, f64) -> Option<f64>,
}

macro_rules! kind {
    ($name:literal, $quantity:ident, $units:expr) => {
        Kind {
            name: $name,
            units: &$units,
            convert: |unit, value| Some(units::find_for(unit, record::Quantity::$quantity)?.to_si(value)),
        }
    };
}

const LENGTH: Kind = kind!("a length", Length, ["m", "ft", "km", "nmi", "cm", "in"]);
const SPEED: Kind = kind!("a speed", Speed, ["m/s", "ft/s", "kt", "km/h", "mph", "ft/min"]);
const ANGLE: Kind = kind!("an angle", Angle, ["deg", "rad", "mrad"]);
const ANGULAR_RATE: Kind = kind!("an angular rate", AngularRate, ["deg/s", "rad/s"]);
const ANGULAR_ACCELERATION: Kind = kind!("an angular acceleration", AngularAcceleration, ["deg/s2", "rad/s2"]);
const ACCELERATION: Kind = kind!("an acceleration", Acceleration, ["m/s2", "ft/s2", "g", "mg"]);
const TIME: Kind = kind!("a time", Time, ["s", "ms", "min", "h"]);
const FORCE: Kind = kind!("a force", Force, ["N", "kN", "lbf"]);
// Channels of a record are no frequencies, so the units of flight data have none.
const FREQUENCY: Kind = Kind {
    name: "a frequency",
    units: &["Hz", "kHz", "rad/s"],
    convert: |unit, value| match unit.to_lowercase().as_str() {
        "hz" => Some(value),
        "khz" => Some(1000.0 * value),
        "rad/s" => Some(value / std::f64::consts::TAU),
        _ => None,
    },
};

/// Why a text is not a quantity.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum QuantityError {
    /// A number without a unit.
    #[error("`{text}` has no unit: write {kind} as in `{text}{first}` (units: {units})")]
    NoUnit {
        /// What was written.
        text: String,
        /// The quantity, with its article.
        kind: &'static str,
        /// The most usual unit.
        first: &'static str,
        /// All units understood.
        units: String,
    },
    /// A unit of something else, or none at all.
    #[error("`{unit}` in `{text}` is not a unit of {kind} (units: {units})")]
    WrongUnit {
        /// What was written.
        text: String,
        /// The part that was taken for the unit.
        unit: String,
        /// The quantity, with its article.
        kind: &'static str,
        /// All units understood.
        units: String,
    },
    /// No number in front.
    #[error("`{text}` does not start with a number: write {kind} as in `10{first}` (units: {units})")]
    NoNumber {
        /// What was written.
        text: String,
        /// The quantity, with its article.
        kind: &'static str,
        /// The most usual unit.
        first: &'static str,
        /// All units understood.
        units: String,
    },
}

/// Where the number ends and the unit begins: the longest prefix that is a number. `1e3m` is a thousand metres, and the
/// `e` of `1ev` belongs to nothing.
fn split(text: &str) -> Option<(f64, &str)> {
    let text = text.trim();
    (1..=text.len())
        .rev()
        .filter(|&i| text.is_char_boundary(i))
        // `inf` and `nan` parse as numbers in Rust and are none here.
        .filter(|&i| text[..i].chars().all(|c| c.is_ascii_digit() || "+-.eE_".contains(c)))
        .find_map(|i| {
            let number: f64 = text[..i].replace('_', "").parse().ok()?;
            number.is_finite().then_some((number, text[i..].trim()))
        })
}

fn parse(text: &str, kind: &Kind) -> Result<f64, QuantityError> {
    let list = || kind.units.join(", ");
    let first = kind.units.first().copied().unwrap_or_default();
    let Some((number, unit)) = split(text) else {
        return Err(QuantityError::NoNumber { text: text.trim().into(), kind: kind.name, first, units: list() });
    };
    if unit.is_empty() {
        return Err(QuantityError::NoUnit { text: text.trim().into(), kind: kind.name, first, units: list() });
    }
    (kind.convert)(unit, number).filter(|si| si.is_finite()).ok_or_else(|| QuantityError::WrongUnit {
        text: text.trim().into(),
        unit: unit.into(),
        kind: kind.name,
        units: list(),
    })
}

/// A quantity that can be read from text with its unit.
pub trait Quantity: Copy + FromStr<Err = QuantityError> {
    /// The value in SI (radians for angles).
    fn si(self) -> f64;
}

macro_rules! quantity {
    ($(#[$doc:meta])* $name:ident, $kind:expr, $si:literal) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, Default, PartialEq, PartialOrd)]
        pub struct $name(f64);

        impl $name {
            /// From a value in SI.
            pub const fn from_si(value: f64) -> Self {
                Self(value)
            }

            /// The value in SI.
            pub const fn si(self) -> f64 {
                self.0
            }
        }

        impl Quantity for $name {
            fn si(self) -> f64 {
                self.0
            }
        }

        impl FromStr for $name {
            type Err = QuantityError;
            fn from_str(text: &str) -> Result<Self, QuantityError> {
                parse(text, &$kind).map(Self)
            }
        }

        impl fmt::Display for $name {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                write!(f, "{} {}", self.0, $si)
            }
        }

        impl Serialize for $name {
            fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
                serializer.collect_str(self)
            }
        }

        impl<'de> Deserialize<'de> for $name {
            fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
                struct Visitor;
                impl de::Visitor<'_> for Visitor {
                    type Value = $name;
                    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                        write!(f, "{} with its unit in quotes, as in \"1 {}\"", $kind.name, $kind.units[0])
                    }
                    fn visit_str<E: de::Error>(self, text: &str) -> Result<$name, E> {
                        text.parse().map_err(E::custom)
                    }
                    fn visit_i64<E: de::Error>(self, number: i64) -> Result<$name, E> {
                        number.to_string().parse().map_err(E::custom)
                    }
                    fn visit_u64<E: de::Error>(self, number: u64) -> Result<$name, E> {
                        number.to_string().parse().map_err(E::custom)
                    }
                    fn visit_f64<E: de::Error>(self, number: f64) -> Result<$name, E> {
                        number.to_string().parse().map_err(E::custom)
                    }
                }
                deserializer.deserialize_any(Visitor)
            }
        }
    };
}

quantity!(
    /// A length or an altitude, m.
    Length, LENGTH, "m"
);
quantity!(
    /// A speed, m/s.
    Speed, SPEED, "m/s"
);
quantity!(
    /// An angle, rad.
    Angle, ANGLE, "rad"
);
quantity!(
    /// An angular rate, rad/s.
    AngularRate, ANGULAR_RATE, "rad/s"
);
quantity!(
    /// An angular acceleration, rad/s^2.
    AngularAcceleration, ANGULAR_ACCELERATION, "rad/s2"
);
quantity!(
    /// An acceleration, m/s^2; `g` is the standard 9.80665 m/s^2.
    Acceleration, ACCELERATION, "m/s2"
);
quantity!(
    /// A time, s.
    Time, TIME, "s"
);
quantity!(
    /// A frequency, Hz.
    Frequency, FREQUENCY, "Hz"
);
quantity!(
    /// A force, N.
    Force, FORCE, "N"
);

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn units_are_what_their_definitions_say() {
        assert_eq!("20000ft".parse::<Length>().unwrap().si(), 6096.0);
        assert_eq!("675 ft/s".parse::<Speed>().unwrap().si(), 205.74);
        assert_eq!("180deg".parse::<Angle>().unwrap().si(), std::f64::consts::PI);
        assert!(("100kt".parse::<Speed>().unwrap().si() - 51.444_444).abs() < 1e-6);
        assert_eq!("36 km/h".parse::<Speed>().unwrap().si(), 10.0);
        assert_eq!("1e3m".parse::<Length>().unwrap().si(), 1000.0);
        assert_eq!("20_000 ft".parse::<Length>().unwrap().si(), 6096.0);
        assert_eq!("1 g".parse::<Acceleration>().unwrap().si(), 9.80665);
        assert_eq!("20ms".parse::<Time>().unwrap().si(), 0.02);
    }

    #[test]
    fn a_bare_number_is_refused_with_the_units_to_write() {
        let message = "675".parse::<Speed>().unwrap_err().to_string();
        assert!(message.contains("no unit") && message.contains("ft/s") && message.contains("kt"), "{message}");
        let message = "675 ft".parse::<Speed>().unwrap_err().to_string();
        assert!(message.contains("`ft`") && message.contains("not a unit of a speed"), "{message}");
        assert!("fast".parse::<Speed>().unwrap_err().to_string().contains("does not start with a number"));
        assert!("inf m".parse::<Length>().is_err() && "NaNm".parse::<Length>().is_err());
        assert!("1e999m".parse::<Length>().is_err());
    }

    proptest! {
        #[test]
        fn no_text_panics(text in "\\PC*") {
            let _ = text.parse::<Length>();
            let _ = text.parse::<Acceleration>();
        }

        #[test]
        fn what_is_printed_is_read_back(value in -1e6..1e6_f64) {
            let read: AngularRate = AngularRate::from_si(value).to_string().parse().unwrap();
            prop_assert_eq!(read.si(), value);
        }
    }
}
