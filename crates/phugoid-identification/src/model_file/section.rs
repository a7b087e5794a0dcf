//! Reading a TOML table with errors that name the line, the key and the nearest valid word.

use std::ops::Range;

use phugoid_flight_data::quantity::Dimension;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::error::ModelFileError;
use crate::core::words::{did_you_mean, nearest};

/// The text of a model file, for turning byte offsets into lines.
pub(super) struct Source<'a> {
    pub(super) file: &'a str,
    pub(super) text: &'a str,
}

impl Source<'_> {
    /// An error at a byte range of the text.
    pub(super) fn error(&self, span: Range<usize>, key: &str, message: String) -> ModelFileError {
        let start = span.start.min(self.text.len());
        let before = &self.text.as_bytes()[..start];
        let line = 1 + before.iter().filter(|&&b| b == b'\n').count();
        let line_start = before.iter().rposition(|&b| b == b'\n').map_or(0, |i| i + 1);
        let column = 1 + String::from_utf8_lossy(&before[line_start..]).chars().count();
        let excerpt = self.text.lines().nth(line - 1).unwrap_or_default().into();
        ModelFileError {
            file: self.file.into(),
            line,
            column,
            key: key.into(),
            message: message.into(),
            nearest: None,
            excerpt,
        }
    }
}

/// One table of the file.
#[derive(Clone)]
pub(super) struct Section<'a> {
    pub(super) source: &'a Source<'a>,
    /// Dotted path of the table, empty for the whole file.
    pub(super) path: String,
    pub(super) table: &'a DeTable<'a>,
    pub(super) span: Range<usize>,
}

/// Strings of a list, each with its byte range in the text.
type Words<'a> = Vec<(&'a str, Range<usize>)>;
type Found<'a> = Option<&'a Spanned<DeValue<'a>>>;

impl<'a> Section<'a> {
    fn dotted(&self, key: &str) -> String {
        if self.path.is_empty() { key.to_owned() } else { format!("{}.{key}", self.path) }
    }

    fn place(&self) -> String {
        if self.path.is_empty() { "at the top level".to_owned() } else { format!("in [{}]", self.path) }
    }

    /// Keys in the order of the file.
    pub(super) fn keys(&self) -> Vec<(&'a str, Range<usize>)> {
        let mut keys: Vec<_> = self.table.iter().map(|(k, _)| (k.get_ref().as_ref(), k.span())).collect();
        keys.sort_by_key(|(_, span)| span.start);
        keys
    }

    /// Refuses keys that are not allowed, naming the nearest that is.
    pub(super) fn allow<'b>(
        &self,
        what: &str,
        allowed: impl Iterator<Item = &'b str> + Clone,
    ) -> Result<(), ModelFileError> {
        self.allow_also(what, allowed, &[])
    }

    /// The same, with former names of keys that are still read but no longer proposed.
    pub(super) fn allow_also<'b>(
        &self,
        what: &str,
        allowed: impl Iterator<Item = &'b str> + Clone,
        former: &[&str],
    ) -> Result<(), ModelFileError> {
        for (key, span) in self.keys() {
            if !former.contains(&key) && !allowed.clone().any(|a| a == key) {
                let message = format!("unknown {what} `{key}` {}{}", self.place(), did_you_mean(key, allowed.clone()));
                let mut error = self.source.error(span, &self.dotted(key), message);
                error.nearest = nearest(key, allowed.clone()).map(Into::into);
                return Err(error);
            }
        }
        Ok(())
    }

    pub(super) fn get(&self, key: &str) -> Found<'a> {
        self.table.get(key)
    }

    /// An error at the value of a key (or at the section, if the key is not there).
    pub(super) fn error(&self, key: &str, message: impl Into<String>) -> ModelFileError {
        let span = self.get(key).map_or(self.span.clone(), Spanned::span);
        self.source.error(span, &self.dotted(key), message.into())
    }

    pub(super) fn missing(&self, key: &str, expected: &str) -> ModelFileError {
        self.source.error(
            self.span.clone(),
            &self.dotted(key),
            format!("key `{key}` is missing {}: expected {expected}", self.place()),
        )
    }

    /// The sub-table under this key; none if the key is not there.
    pub(super) fn section(&self, key: &str) -> Result<Option<Section<'a>>, ModelFileError> {
        let Some(value) = self.get(key) else { return Ok(None) };
        let Some(table) = value.get_ref().as_table() else {
            return Err(self.error(key, format!("`{key}` is {}: expected a table", kind(value.get_ref()))));
        };
        Ok(Some(Section { source: self.source, path: self.dotted(key), table, span: value.span() }))
    }

    pub(super) fn string(&self, key: &str) -> Result<Option<&'a str>, ModelFileError> {
        let Some(value) = self.get(key) else { return Ok(None) };
        value
            .get_ref()
            .as_str()
            .map(Some)
            .ok_or_else(|| self.error(key, format!("`{key}` is {}: expected a string", kind(value.get_ref()))))
    }

    pub(super) fn boolean(&self, key: &str) -> Result<Option<bool>, ModelFileError> {
        let Some(value) = self.get(key) else { return Ok(None) };
        value
            .get_ref()
            .as_bool()
            .map(Some)
            .ok_or_else(|| self.error(key, format!("`{key}` is {}: expected true or false", kind(value.get_ref()))))
    }

    /// One of a list of words.
    pub(super) fn word(&self, key: &str, words: &[&'static str]) -> Result<Option<&'static str>, ModelFileError> {
        let Some(found) = self.string(key)? else { return Ok(None) };
        self.choose(key, found, self.get(key).map_or(self.span.clone(), Spanned::span), words).map(Some)
    }

    pub(super) fn choose(
        &self,
        key: &str,
        found: &str,
        span: Range<usize>,
        words: &[&'static str],
    ) -> Result<&'static str, ModelFileError> {
        words.iter().find(|w| **w == found).copied().ok_or_else(|| {
            let message = format!("unknown word `{found}` for `{key}`{}", did_you_mean(found, words.iter().copied()));
            let mut error = self.source.error(span, &self.dotted(key), message);
            error.nearest = nearest(found, words.iter().copied()).map(Into::into);
            error
        })
    }

    /// A list of strings with their places.
    pub(super) fn strings(&self, key: &str) -> Result<Option<Words<'a>>, ModelFileError> {
        let Some(value) = self.get(key) else { return Ok(None) };
        let Some(array) = value.get_ref().as_array() else {
            return Err(self.error(key, format!("`{key}` is {}: expected a list", kind(value.get_ref()))));
        };
        let strings = array.iter().map(|item| {
            item.get_ref().as_str().map(|s| (s, item.span())).ok_or_else(|| {
                let message = format!("`{key}` holds {}: expected strings", kind(item.get_ref()));
                self.source.error(item.span(), &self.dotted(key), message)
            })
        });
        strings.collect::<Result<_, _>>().map(Some)
    }

    /// A number in SI, or a string with a unit.
    pub(super) fn number(&self, key: &str, dimension: Dimension) -> Result<Option<f64>, ModelFileError> {
        let Some(value) = self.get(key) else { return Ok(None) };
        self.quantity(key, value, dimension).map(Some)
    }

    pub(super) fn quantity(
        &self,
        key: &str,
        value: &Spanned<DeValue<'a>>,
        dimension: Dimension,
    ) -> Result<f64, ModelFileError> {
        let result = match value.get_ref() {
            DeValue::Float(number) => number.as_str().replace('_', "").parse::<f64>().map_err(|e| e.to_string()),
            DeValue::Integer(number) => number.as_str().replace('_', "").parse::<f64>().map_err(|e| e.to_string()),
            DeValue::String(text) => dimension.parse_or_si(text).map_err(|error| error.to_string()),
            other => Err(format!(
                "`{key}` is {}: expected a number in {} or a string with a unit",
                kind(other),
                dimension.si_unit()
            )),
        };
        result
            .and_then(|v| if v.is_finite() { Ok(v) } else { Err(format!("`{key}` is not finite")) })
            .map_err(|message| self.source.error(value.span(), &self.dotted(key), message))
    }

    pub(super) fn positive(&self, key: &str, dimension: Dimension) -> Result<Option<f64>, ModelFileError> {
        match self.number(key, dimension)? {
            Some(v) if v <= 0.0 => Err(self.error(key, format!("`{key}` is {v}: expected more than zero"))),
            other => Ok(other),
        }
    }

    pub(super) fn required_positive(&self, key: &str, dimension: Dimension) -> Result<f64, ModelFileError> {
        self.positive(key, dimension)?
            .ok_or_else(|| self.missing(key, &format!("a quantity in {} or with a unit", dimension.si_unit())))
    }

    /// A list of exactly two numbers.
    pub(super) fn pair(&self, key: &str) -> Result<Option<[f64; 2]>, ModelFileError> {
        self.pair_of(key, Dimension::NUMBER)
    }

    /// A list of exactly two quantities, the lower one first.
    pub(super) fn pair_of(&self, key: &str, dimension: Dimension) -> Result<Option<[f64; 2]>, ModelFileError> {
        let Some(value) = self.get(key) else { return Ok(None) };
        let items = value.get_ref().as_array().filter(|a| a.len() == 2);
        let Some(items) = items else {
            return Err(self.error(key, format!("`{key}`: expected two numbers, [lower, upper]")));
        };
        let mut pair = [0.0; 2];
        for (slot, item) in pair.iter_mut().zip(items.iter()) {
            *slot = self.quantity(key, item, dimension)?;
        }
        if pair[0] >= pair[1] {
            return Err(
                self.error(key, format!("`{key}` is [{}, {}]: the lower one must come first", pair[0], pair[1]))
            );
        }
        Ok(Some(pair))
    }
}

/// What a value of a file is, with its article.
pub(super) fn kind(value: &DeValue<'_>) -> &'static str {
    match value {
        DeValue::String(_) => "a string",
        DeValue::Integer(_) => "an integer",
        DeValue::Float(_) => "a number",
        DeValue::Boolean(_) => "a boolean",
        DeValue::Datetime(_) => "a date",
        DeValue::Array(_) => "a list",
        DeValue::Table(_) => "a table",
    }
}
