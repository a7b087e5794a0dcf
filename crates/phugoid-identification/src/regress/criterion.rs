//! What ends the selection of terms.

use std::str::FromStr;

use serde::{Deserialize, Serialize};

use crate::core::words::did_you_mean;

/// What ends the selection of terms. Whichever it is, a term needs the F to remove at the end.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Criterion {
    /// The smallest predicted square error (Morelli 1995).
    #[default]
    Pse,
    /// The smallest mean square of residuals predicted without their own rows (Allen 1974).
    Press,
    /// Partial F to enter and to remove: modified stepwise regression (Klein, Batterson & Murphy 1981).
    F,
}

impl Criterion {
    /// The word of the command line.
    pub fn word(self) -> &'static str {
        match self {
            Self::Pse => "pse",
            Self::Press => "press",
            Self::F => "f",
        }
    }
}

impl FromStr for Criterion {
    type Err = String;

    fn from_str(word: &str) -> Result<Self, String> {
        let all = [Self::Pse, Self::Press, Self::F];
        all.into_iter().find(|known| known.word() == word).ok_or_else(|| {
            format!("there is no criterion `{word}`{}", did_you_mean(word, ["pse", "press", "f"].into_iter()))
        })
    }
}
