//! A setting that is searched: its name, its range, and what the rule says.

use serde::Serialize;

/// Where a setting is looked for.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Range {
    /// Between two positive numbers, in the logarithm.
    Logarithmic {
        /// Smallest value that is tried, in the setting's unit.
        lower: f64,
        /// Largest value that is tried, in the setting's unit.
        upper: f64,
    },
    /// One of a few words; the value is the index of the word.
    Choice {
        /// The words that can be chosen, as they stand in settings files.
        words: Vec<&'static str>,
    },
}

/// A setting of a method, with the value that the rule gives it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Setting {
    /// Key in settings files, e.g. `reaching_limit`.
    pub name: &'static str,
    /// Unit as printed, e.g. `s`; `-` for a pure number.
    pub unit: &'static str,
    /// What it is, in a few words.
    pub meaning: &'static str,
    /// Where it is looked for.
    pub range: Range,
    /// Value by rule: a number in the range, or the index of a word.
    pub rule: f64,
    /// Where the rule comes from.
    pub origin: &'static str,
}

impl Setting {
    /// The value at a place of the unit interval, where the search moves.
    pub fn at(&self, place: f64) -> f64 {
        let place = place.clamp(0.0, 1.0);
        match &self.range {
            Range::Logarithmic { lower, upper } => {
                (lower.ln() + place * (upper / lower).ln()).exp().clamp(*lower, *upper)
            }
            Range::Choice { words } => (place * words.len() as f64).floor().min(words.len() as f64 - 1.0),
        }
    }

    /// The place of a value in the unit interval: the inverse of [`Setting::at`] up to rounding.
    pub fn place(&self, value: f64) -> f64 {
        match &self.range {
            Range::Logarithmic { lower, upper } => ((value / lower).ln() / (upper / lower).ln()).clamp(0.0, 1.0),
            Range::Choice { words } => ((value + 0.5) / words.len() as f64).clamp(0.0, 1.0),
        }
    }

    /// The value as it stands in a settings file: a number, or a quoted word.
    pub fn in_toml(&self, value: f64) -> String {
        match &self.range {
            Range::Logarithmic { .. } => format!("{value:?}"),
            Range::Choice { .. } => format!("\"{}\"", self.word(value)),
        }
    }

    /// The word of a choice; empty for a number.
    pub fn word(&self, value: f64) -> &'static str {
        match &self.range {
            Range::Logarithmic { .. } => "",
            Range::Choice { words } => words.get(value.max(0.0) as usize).copied().unwrap_or_default(),
        }
    }
}

/// The values of all settings at a point of the unit cube.
pub fn values_at(settings: &[Setting], point: &[f64]) -> Vec<f64> {
    settings.iter().zip(point).map(|(setting, place)| setting.at(*place)).collect()
}

/// The values that the rules give.
pub fn values_by_rule(settings: &[Setting]) -> Vec<f64> {
    settings.iter().map(|setting| setting.rule).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn setting(range: Range) -> Setting {
        Setting { name: "a", unit: "-", meaning: "", range, rule: 0.0, origin: "" }
    }

    #[test]
    fn words_share_the_interval_evenly() {
        let choice = setting(Range::Choice { words: vec!["damped", "reduced", "printed"] });
        assert_eq!([0.0, 0.32, 0.34, 0.66, 0.67, 1.0].map(|p| choice.at(p)), [0.0, 0.0, 1.0, 1.0, 2.0, 2.0]);
        assert_eq!([0.0, 1.0, 2.0].map(|v| choice.at(choice.place(v))), [0.0, 1.0, 2.0]);
        assert_eq!(choice.in_toml(1.0), "\"reduced\"");
    }

    proptest! {
        #[test]
        fn a_value_is_found_again_at_its_place(lower in -9.0..3.0_f64, decades in 0.1..6.0_f64, place in 0.0..1.0_f64) {
            let (lower, upper) = (10_f64.powf(lower), 10_f64.powf(lower + decades));
            let s = setting(Range::Logarithmic { lower, upper });
            let value = s.at(place);
            prop_assert!((lower..=upper).contains(&value));
            prop_assert!((s.place(value) - place).abs() < 1e-9);
            // As written in a file it is the same number.
            prop_assert_eq!(s.in_toml(value).parse::<f64>().unwrap(), value);
        }
    }
}
