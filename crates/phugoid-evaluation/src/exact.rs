//! Numbers that come back from JSON as they were written, those that are not finite too.
//!
//! JSON has no word for "not a number" and for infinity, and `serde_json` writes both as `null`. A study tells them apart: a
//! parameter that never settles does so after an infinite time, one of a method that is not causal after none that is known. A
//! field with `#[serde(with = "crate::exact")]` has the words `"NaN"`, `"inf"` and `"-inf"`, which DuckDB casts to DOUBLE.

use serde::{Deserialize, Deserializer, Serialize, Serializer};

/// What can be written so: numbers, and lists and pairs of them.
pub(crate) trait Exact: Sized {
    /// What stands in its place.
    type Form: Serialize + for<'de> Deserialize<'de>;
    fn form(&self) -> Self::Form;
    fn of(form: Self::Form) -> Option<Self>;
}

/// A number, or the word for one that is not finite.
#[derive(Serialize, Deserialize)]
#[serde(untagged)]
pub(crate) enum Number {
    Finite(f64),
    Word(String),
}

impl Exact for f64 {
    type Form = Number;

    fn form(&self) -> Number {
        if self.is_finite() { Number::Finite(*self) } else { Number::Word(self.to_string()) }
    }

    fn of(form: Number) -> Option<Self> {
        match form {
            Number::Finite(value) => Some(value),
            Number::Word(word) => match word.as_str() {
                "NaN" => Some(Self::NAN),
                "inf" => Some(Self::INFINITY),
                "-inf" => Some(Self::NEG_INFINITY),
                _ => None,
            },
        }
    }
}

impl<T: Exact> Exact for Vec<T> {
    type Form = Vec<T::Form>;

    fn form(&self) -> Self::Form {
        self.iter().map(T::form).collect()
    }

    fn of(form: Self::Form) -> Option<Self> {
        form.into_iter().map(T::of).collect()
    }
}

impl<T: Exact, const N: usize> Exact for [T; N] {
    type Form = Vec<T::Form>;

    fn form(&self) -> Self::Form {
        self.iter().map(T::form).collect()
    }

    fn of(form: Self::Form) -> Option<Self> {
        Self::try_from(Vec::of(form)?).ok()
    }
}

impl<A: Exact, B: Exact> Exact for (A, B) {
    type Form = (A::Form, B::Form);

    fn form(&self) -> Self::Form {
        (self.0.form(), self.1.form())
    }

    fn of((a, b): Self::Form) -> Option<Self> {
        Some((A::of(a)?, B::of(b)?))
    }
}

pub(crate) fn serialize<T: Exact, S: Serializer>(value: &T, serializer: S) -> Result<S::Ok, S::Error> {
    value.form().serialize(serializer)
}

pub(crate) fn deserialize<'de, T: Exact, D: Deserializer<'de>>(deserializer: D) -> Result<T, D::Error> {
    let wrong = || serde::de::Error::custom("neither a number nor \"NaN\", \"inf\" or \"-inf\"");
    T::of(T::Form::deserialize(deserializer)?).ok_or_else(wrong)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[derive(Serialize, Deserialize)]
    struct Of<T: Exact>(#[serde(with = "crate::exact")] T);

    fn back<T: Exact>(value: T) -> T {
        let text = serde_json::to_string(&Of(value)).unwrap();
        serde_json::from_str::<Of<T>>(&text).unwrap().0
    }

    /// To the bit: the shortest text that names a number is read as that number.
    #[test]
    fn every_number_comes_back() {
        let numbers =
            [0.1 + 0.2, -0.0, 1e-310, f64::MAX, 2.0 / 3.0, f64::INFINITY, f64::NEG_INFINITY, 9007199254740993.0];
        assert_eq!(
            numbers.map(f64::to_bits).to_vec(),
            back(numbers.to_vec()).iter().map(|v| v.to_bits()).collect::<Vec<_>>()
        );
        assert!(back(f64::NAN).is_nan());
        let pairs = vec![vec![(1.5, f64::INFINITY)], Vec::new()];
        assert_eq!(back(pairs.clone()), pairs);
        assert_eq!(back([[1.0, 2.5], [3.0, -4.0]]), [[1.0, 2.5], [3.0, -4.0]]);
    }

    #[test]
    fn other_words_and_lists_of_another_length_are_refused() {
        assert!(serde_json::from_str::<Of<f64>>("\"many\"").is_err());
        assert!(serde_json::from_str::<Of<f64>>("null").is_err());
        assert!(serde_json::from_str::<Of<[f64; 2]>>("[1.0]").is_err());
    }
}
