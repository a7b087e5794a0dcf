//! The table `[expected]`: the parameters of a healthy aircraft, and the deviations that still count as healthy.

use phugoid_flight_data::quantity::Dimension;
use toml::de::DeTable;

use super::error::ModelFileError;
use super::file::ModelFile;
use super::parameter::{Expectation, Parameter};
use super::section::{Section, Source as Text};
use crate::core::words::{did_you_mean, nearest};

/// Part of the parameter's own size (without a database) and of its prior sigma (with one) that is tolerated where the
/// file does not say.
const STANDARD_TOLERANCE: f64 = 0.1;

impl ModelFile {
    /// What is expected: the table `[expected]`, or without one the start value of every term that is estimated, within
    /// a tenth of it or, where it is zero, a tenth of the prior sigma.
    ///
    /// Offsets and sensor biases are not monitored.
    pub fn expectations(&self) -> Vec<Expectation> {
        self.expected.clone().unwrap_or_else(|| {
            let terms = self.estimated().filter(|p| !p.is_nuisance());
            terms
                .map(|p| Expectation {
                    name: p.name.clone(),
                    value: p.start,
                    tolerance: STANDARD_TOLERANCE * if p.start == 0.0 { p.prior_std } else { p.start.abs() },
                    failure_std: None,
                })
                .collect()
        })
    }

    /// Reads expectations from a file of their own, which holds nothing but the table `[expected]`; the parameters are
    /// those of this model.
    ///
    /// # Errors
    /// The first thing found wrong, with file, line, column, key and the nearest valid word.
    pub fn parse_expected(&self, file: &str, text: &str) -> Result<Vec<Expectation>, ModelFileError> {
        let source = Text { file, text };
        let document = DeTable::parse(text).map_err(|error| {
            let message = format!("not valid TOML: {}", error.message());
            source.error(error.span().unwrap_or(0..0), "", message)
        })?;
        let top = Section { source: &source, path: String::new(), table: document.get_ref(), span: 0..0 };
        top.allow("key", ["expected"].into_iter())?;
        expected(&top, &self.parameters)?.ok_or_else(|| top.missing("expected", "a table [expected]"))
    }
}

/// The table `[expected]`, if there is one.
pub(super) fn expected(top: &Section, parameters: &[Parameter]) -> Result<Option<Vec<Expectation>>, ModelFileError> {
    let Some(section) = top.section("expected")? else { return Ok(None) };
    let mut expectations = Vec::new();
    for (name, span) in section.keys() {
        let names = || parameters.iter().filter(|p| !p.is_nuisance()).map(|p| p.name.as_str());
        let key = format!("expected.{name}");
        let refuse = |message: String| {
            let mut error = section.source.error(span.clone(), &key, message);
            error.nearest = nearest(name, names()).map(Into::into);
            error
        };
        let Some(parameter) = parameters.iter().find(|p| p.name == name) else {
            return Err(refuse(format!("unknown parameter `{name}` in [expected]{}", did_you_mean(name, names()))));
        };
        if parameter.is_nuisance() {
            return Err(refuse(format!("`{name}` only supports the others and is not monitored: take it out")));
        }
        if parameter.fixed {
            return Err(refuse(format!("`{name}` is fixed: what is not estimated cannot be monitored")));
        }
        let Some(table) = section.section(name)? else { continue };
        table.allow("key", ["value", "tolerance", "failure_std"].into_iter())?;
        let value = table.number("value", Dimension::NUMBER)?.unwrap_or(parameter.start);
        let tolerance = table
            .positive("tolerance", Dimension::NUMBER)?
            .ok_or_else(|| table.missing("tolerance", "how far off still counts as healthy, as in tolerance = 0.05"))?;
        let failure_std = table.positive("failure_std", Dimension::NUMBER)?;
        if let Some([low, high]) = parameter.bounds
            && !(low..=high).contains(&value)
        {
            let message = format!("expected {value} of `{name}` is outside its bounds [{low}, {high}]");
            return Err(table.error("value", message));
        }
        expectations.push(Expectation { name: name.to_owned(), value, tolerance, failure_std });
    }
    if expectations.is_empty() {
        return Err(top.error("expected", "[expected] is empty: name at least one parameter with its tolerance"));
    }
    Ok(Some(expectations))
}
