//! Finds the numbers in a JSON document and names them by their paths.

use std::fmt;

use serde::Deserializer;
use serde::de::{DeserializeSeed, Error, IgnoredAny, MapAccess, SeqAccess, Visitor};

/// Largest number of values kept of one message. An image or a laser scan has more, and is no signal.
const MAX_NUMBERS: usize = 4096;
/// The longest path of a value that is kept, bytes.
pub(super) const LONGEST_NAME: usize = 400;

/// Writes the names and values of all numbers and truth values in a document, in its order. A null is a missing number
/// (NaN). Returns the number of values that are left out because their names are too long; `None` if the text is no
/// document. The document itself is never in memory: it could take many times its text.
pub(super) fn flatten(text: &[u8], names: &mut Vec<String>, values: &mut Vec<f64>) -> Option<u64> {
    names.clear();
    values.clear();
    let (mut path, mut unnamed) = (String::new(), 0);
    let mut reader = serde_json::Deserializer::from_slice(text);
    let walk = Walk { path: &mut path, names, values, unnamed: &mut unnamed };
    walk.deserialize(&mut reader).and_then(|()| reader.end()).ok()?;
    Some(unnamed)
}

/// What is at a path, and what was found before it.
struct Walk<'a> {
    path: &'a mut String,
    names: &'a mut Vec<String>,
    values: &'a mut Vec<f64>,
    unnamed: &'a mut u64,
}

impl Walk<'_> {
    fn is_full(&self) -> bool {
        self.values.len() >= MAX_NUMBERS
    }

    fn push<E>(self, value: f64) -> Result<(), E> {
        if self.path.len() > LONGEST_NAME {
            *self.unnamed += 1;
        } else if !self.is_full() {
            self.names.push(if self.path.is_empty() { "value".to_owned() } else { self.path.clone() });
            self.values.push(value);
        }
        Ok(())
    }

    fn below(&mut self) -> Walk<'_> {
        Walk { path: self.path, names: self.names, values: self.values, unnamed: self.unnamed }
    }
}

impl<'de> DeserializeSeed<'de> for Walk<'_> {
    type Value = ();

    fn deserialize<D: Deserializer<'de>>(self, reader: D) -> Result<(), D::Error> {
        reader.deserialize_any(self)
    }
}

impl<'de> Visitor<'de> for Walk<'_> {
    type Value = ();

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a document in JSON")
    }

    fn visit_bool<E: Error>(self, truth: bool) -> Result<(), E> {
        self.push(f64::from(u8::from(truth)))
    }

    fn visit_i64<E: Error>(self, number: i64) -> Result<(), E> {
        self.push(number as f64)
    }

    fn visit_u64<E: Error>(self, number: u64) -> Result<(), E> {
        self.push(number as f64)
    }

    fn visit_f64<E: Error>(self, number: f64) -> Result<(), E> {
        self.push(number)
    }

    fn visit_unit<E: Error>(self) -> Result<(), E> {
        self.push(f64::NAN)
    }

    fn visit_str<E: Error>(self, _: &str) -> Result<(), E> {
        Ok(())
    }

    fn visit_seq<A: SeqAccess<'de>>(mut self, mut elements: A) -> Result<(), A::Error> {
        let length = self.path.len();
        for index in 0..MAX_NUMBERS {
            if self.is_full() {
                break;
            }
            self.path.push_str(&format!("[{index}]"));
            let element = elements.next_element_seed(self.below());
            self.path.truncate(length);
            if element?.is_none() {
                return Ok(());
            }
        }
        while elements.next_element::<IgnoredAny>()?.is_some() {}
        Ok(())
    }

    fn visit_map<A: MapAccess<'de>>(mut self, mut members: A) -> Result<(), A::Error> {
        let length = self.path.len();
        while !self.is_full() {
            if length > 0 {
                self.path.push('.');
            }
            let name = members.next_key_seed(Name(self.path));
            let member = match name {
                Ok(Some(())) => members.next_value_seed(self.below()).map(Some),
                Ok(None) => Ok(None),
                Err(error) => Err(error),
            };
            self.path.truncate(length);
            if member?.is_none() {
                return Ok(());
            }
        }
        while members.next_entry::<IgnoredAny, IgnoredAny>()?.is_some() {}
        Ok(())
    }
}

/// Appends the name of a member to a path; of one that is too long only so much that the path is too long as well.
struct Name<'a>(&'a mut String);

impl<'de> DeserializeSeed<'de> for Name<'_> {
    type Value = ();

    fn deserialize<D: Deserializer<'de>>(self, reader: D) -> Result<(), D::Error> {
        reader.deserialize_str(self)
    }
}

impl Visitor<'_> for Name<'_> {
    type Value = ();

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a name")
    }

    fn visit_str<E: Error>(self, name: &str) -> Result<(), E> {
        match name.char_indices().nth(LONGEST_NAME + 1) {
            Some((end, _)) => self.0.push_str(name.get(..end).unwrap_or_default()),
            None => self.0.push_str(name),
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_and_numbers() {
        let text = r#"{"pose": {"x": 1.5, "q": [0, 0.5]}, "ok": true, "name": "n", "gone": null, "n": -3}"#;
        let (mut names, mut values) = (Vec::new(), Vec::new());
        assert_eq!(flatten(text.as_bytes(), &mut names, &mut values), Some(0));
        let found: Vec<(&str, f64)> = names.iter().map(String::as_str).zip(values.iter().copied()).collect();
        assert_eq!(found[..4], [("pose.x", 1.5), ("pose.q[0]", 0.0), ("pose.q[1]", 0.5), ("ok", 1.0)]);
        assert!(found[4].0 == "gone" && found[4].1.is_nan());
        assert_eq!(found[5..], [("n", -3.0)]);
        assert_eq!(flatten(b" 2.0 ", &mut names, &mut values), Some(0));
        assert_eq!(names, ["value"]);
        for wrong in ["", "{", "{\"a\": 1} 2", "[1, 2", "{\"a\": x}", "\u{1}"] {
            assert_eq!(flatten(wrong.as_bytes(), &mut names, &mut values), None, "{wrong}");
        }
    }

    #[test]
    fn very_many_numbers_and_very_long_names() {
        let (mut names, mut values) = (Vec::new(), Vec::new());
        let text = format!("{{\"list\": [{}1], \"after\": 2}}", "1,".repeat(5000));
        assert_eq!(flatten(text.as_bytes(), &mut names, &mut values), Some(0));
        assert_eq!((values.len(), names.last().map(String::as_str)), (MAX_NUMBERS, Some("list[4095]")));
        let text = format!("{{\"{}\": [1, 2], \"after\": 2}}", "n".repeat(100_000));
        assert_eq!(flatten(text.as_bytes(), &mut names, &mut values), Some(2));
        assert_eq!((names.as_slice(), values.as_slice()), (&["after".to_owned()][..], &[2.0][..]));
    }
}
