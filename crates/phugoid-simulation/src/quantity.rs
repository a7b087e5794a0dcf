//! Quantities of command lines and scenario files, each a type of its own: `20000ft`, `1.5 deg`, `675 ft/s`.
//!
//! Inside there is SI and radians only; a bare number for a quantity that has a dimension is refused.

use std::fmt;
use std::str::FromStr;

use phugoid_flight_data::quantity::Dimension;
pub use phugoid_flight_data::quantity::QuantityError;
use serde::{Deserialize, Deserializer, Serialize, Serializer, de};

/// Periods per second; radians per second are understood too.
fn frequency(text: &str) -> Result<f64, QuantityError> {
    Dimension::FREQUENCY.parse(text).or_else(|error| match Dimension::ANGULAR_RATE.parse(text) {
        Ok(rate) => Ok(rate / std::f64::consts::TAU),
        Err(_) => Err(error),
    })
}

/// A quantity that can be read from text with its unit.
pub trait Quantity: Copy + FromStr<Err = QuantityError> {
    /// The value in SI (radians for angles).
    fn si(self) -> f64;
}

macro_rules! quantity {
    ($(#[$doc:meta])* $name:ident, $dimension:expr, $parse:expr) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, Default, PartialEq, PartialOrd)]
        pub struct $name(f64);

        impl $name {
            /// From a value in SI.
            pub const fn from_si(value: f64) -> Self {
                Self(value)
            }

            /// The value in the SI unit of the quantity: angles in radians, angular rates in rad/s, frequencies in Hz.
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
                $parse(text).map(Self)
            }
        }

        impl fmt::Display for $name {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                write!(f, "{} {}", self.0, $dimension.si_unit())
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
                        let (name, unit) = ($dimension.in_words(), $dimension.si_unit());
                        write!(f, "{name} with its unit in quotes, as in \"1 {unit}\"")
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
    Length, Dimension::LENGTH, |text| Dimension::LENGTH.parse(text)
);
quantity!(
    /// A speed, m/s.
    Speed, Dimension::SPEED, |text| Dimension::SPEED.parse(text)
);
quantity!(
    /// An angle, rad.
    Angle, Dimension::ANGLE, |text| Dimension::ANGLE.parse(text)
);
quantity!(
    /// An angular rate, rad/s.
    AngularRate, Dimension::ANGULAR_RATE, |text| Dimension::ANGULAR_RATE.parse(text)
);
quantity!(
    /// An angular acceleration, rad/s^2.
    AngularAcceleration, Dimension::ANGULAR_ACCELERATION, |text| Dimension::ANGULAR_ACCELERATION.parse(text)
);
quantity!(
    /// An acceleration, m/s^2; `g` is the standard 9.80665 m/s^2.
    Acceleration, Dimension::ACCELERATION, |text| Dimension::ACCELERATION.parse(text)
);
quantity!(
    /// A time, s.
    Time, Dimension::TIME, |text| Dimension::TIME.parse(text)
);
quantity!(
    /// A frequency, Hz.
    Frequency, Dimension::FREQUENCY, frequency
);
quantity!(
    /// A force, N.
    Force, Dimension::FORCE, |text| Dimension::FORCE.parse(text)
);

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn text_and_toml_are_read_alike() {
        assert_eq!("20000ft".parse::<Length>().unwrap().si(), 6096.0);
        assert_eq!("675 ft/s".parse::<Speed>().unwrap().si(), 205.74);
        assert_eq!("180deg".parse::<Angle>().unwrap().si(), std::f64::consts::PI);
        assert_eq!("20ms".parse::<Time>().unwrap().si(), 0.02);
        assert_eq!("100 Hz".parse::<Frequency>().unwrap().si(), 100.0);
        assert_eq!("360 deg/s".parse::<Frequency>().unwrap().si(), 1.0);
        #[derive(Deserialize)]
        struct Table {
            width: Length,
        }
        assert_eq!(toml::from_str::<Table>("width = \"2 m\"").unwrap().width, Length::from_si(2.0));
        let bare = toml::from_str::<Table>("width = 2").map(|t| t.width).unwrap_err().to_string();
        assert!(bare.contains("no unit"), "{bare}");
        let none = toml::from_str::<Table>("width = true").map(|t| t.width).unwrap_err().to_string();
        assert!(none.contains("a length with its unit in quotes, as in \"1 m\""), "{none}");
    }

    #[test]
    fn a_bare_number_is_refused_with_the_units_to_write() {
        let message = "675".parse::<Speed>().unwrap_err().to_string();
        assert!(message.contains("no unit") && message.contains("ft/s") && message.contains("kt"), "{message}");
        let message = "675 ft".parse::<Speed>().unwrap_err().to_string();
        assert!(message.contains("`ft`") && message.contains("not a unit of a speed"), "{message}");
        assert!("fast".parse::<Speed>().unwrap_err().to_string().contains("does not start with a number"));
    }

    proptest! {
        #[test]
        fn what_is_printed_is_read_back(value in -1e6..1e6_f64) {
            let read: AngularRate = AngularRate::from_si(value).to_string().parse().unwrap();
            prop_assert_eq!(read.si(), value);
        }
    }
}
