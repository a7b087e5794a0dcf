//! What a campaign asks of a flight.

use std::fmt;

use phugoid_identification::method::Method;
use serde::{Deserialize, Deserializer};

/// An entry of `methods`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Question {
    /// What a method makes of it.
    Estimate(Method),
    /// How good an estimate of it can be: the Cramer-Rao bound, for which nothing is estimated.
    CramerRao,
}

/// The word for [`Question::CramerRao`] in files and in the column `method`.
pub const CRAMER_RAO: &str = "cramer-rao";

impl Question {
    /// The word for it in files and in the column `method`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Estimate(method) => method.name(),
            Self::CramerRao => CRAMER_RAO,
        }
    }
}

impl fmt::Display for Question {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl<'de> Deserialize<'de> for Question {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let word = String::deserialize(deserializer)?;
        if word == CRAMER_RAO {
            return Ok(Self::CramerRao);
        }
        let wrong = |error| serde::de::Error::custom(format!("{error}; and {CRAMER_RAO}, the bound of any method"));
        word.parse().map(Self::Estimate).map_err(wrong)
    }
}
