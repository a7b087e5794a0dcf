//! Lists and tables of quantities.

use phugoid_flight_data::quantity::Dimension;
use toml::Spanned;
use toml::de::DeValue;

use super::super::error::ModelFileError;
use super::super::section::{Section, kind};

impl<'a> Section<'a> {
    /// A list of quantities, each a number in SI or a string with a unit.
    pub(super) fn list_of(&self, key: &str, dimension: Dimension) -> Result<Option<Vec<f64>>, ModelFileError> {
        let Some(value) = self.get(key) else { return Ok(None) };
        let Some(items) = value.get_ref().as_array() else {
            let found = kind(value.get_ref());
            return Err(self.error(key, format!("`{key}` is {found}: expected a list of numbers")));
        };
        items.iter().map(|item| self.quantity(key, item, dimension)).collect::<Result<_, _>>().map(Some)
    }

    /// A table of quantities as lists of lists: as many lists as `shape` says, from the outside inwards. `of` names what each of
    /// them counts.
    pub(super) fn table_of(
        &self,
        key: &str,
        dimension: Dimension,
        shape: &[(&str, usize)],
    ) -> Result<Option<Vec<f64>>, ModelFileError> {
        let Some(value) = self.get(key) else { return Ok(None) };
        let mut values = Vec::new();
        self.collect(key, dimension, value, shape, &mut values)?;
        Ok(Some(values))
    }

    /// The recursion ends with `shape`, whatever the file nests.
    fn collect(
        &self,
        key: &str,
        dimension: Dimension,
        value: &Spanned<DeValue<'a>>,
        shape: &[(&str, usize)],
        values: &mut Vec<f64>,
    ) -> Result<(), ModelFileError> {
        let Some(((of, count), inner)) = shape.split_first() else {
            values.push(self.quantity(key, value, dimension)?);
            return Ok(());
        };
        let items = value.get_ref().as_array();
        let found =
            items.map_or_else(|| kind(value.get_ref()).to_owned(), |items| format!("a list of {}", items.len()));
        let Some(items) = items.filter(|items| items.len() == *count) else {
            let message = format!("`{key}` has {found} where it needs a list of {count}, one for each of `{of}`");
            return Err(self.source.error(value.span(), &format!("{}.{key}", self.path), message));
        };
        items.iter().try_for_each(|item| self.collect(key, dimension, item, inner, values))
    }

    /// A quantity that is not below zero.
    pub(super) fn not_negative(&self, key: &str, dimension: Dimension) -> Result<Option<f64>, ModelFileError> {
        match self.number(key, dimension)? {
            Some(value) if value < 0.0 => Err(self.error(key, format!("`{key}` is {value}: expected zero or more"))),
            other => Ok(other),
        }
    }
}
