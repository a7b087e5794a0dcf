//! `[channels]`: what the channels are called in the user's file, and which of its columns make a channel together.

use std::collections::BTreeMap;

use phugoid_flight_data::quantity::Dimension;
use phugoid_flight_data::table::ColumnMapping;
use toml::Spanned;
use toml::de::DeValue;

use crate::model_file::error::ModelFileError;
use crate::model_file::section::Section;

/// Channels that a model can use; only these can be mapped.
const MAPPABLE: [&str; 28] = [
    "time",
    "true_airspeed",
    "alpha",
    "beta",
    "phi",
    "theta",
    "p",
    "q",
    "r",
    "ax",
    "ay",
    "az",
    "pdot",
    "qdot",
    "rdot",
    "elevator",
    "aileron",
    "rudder",
    "thrust",
    "altitude",
    "air_density",
    "mass",
    "ixx",
    "iyy",
    "izz",
    "ixz",
    "dynamic_pressure",
    "throttle",
];

/// The mappings of the file, by channel; none if it has no such table.
pub(super) fn channels(top: &Section, extra: &[String]) -> Result<BTreeMap<String, ColumnMapping>, ModelFileError> {
    let Some(section) = top.section("channels")? else { return Ok(BTreeMap::new()) };
    section.allow("channel", MAPPABLE.iter().copied().chain(extra.iter().map(String::as_str)))?;
    let mut channels = BTreeMap::new();
    for (key, _) in section.keys() {
        let mapping = match section.get(key).map(Spanned::get_ref) {
            Some(DeValue::Table(_)) => match section.section(key)? {
                Some(inner) => mapping(key, &inner)?,
                None => continue,
            },
            _ => ColumnMapping::new(key, section.string(key)?.unwrap_or_default()),
        };
        channels.insert(key.to_owned(), mapping);
    }
    Ok(channels)
}

/// `{ header = "ELEV", scale = -1, unit = "deg" }`, or `{ sum = { "left" = 0.5, "right" = 0.5 }, unit = "deg" }`.
fn mapping(channel: &str, inner: &Section) -> Result<ColumnMapping, ModelFileError> {
    inner.allow("key", ["header", "unit", "scale", "sum"].into_iter())?;
    let scale = inner.number("scale", Dimension::NUMBER)?;
    let mut mapping = match (inner.string("header")?, inner.section("sum")?) {
        (Some(header), None) => ColumnMapping::new(channel, header).with_scale(scale.unwrap_or(1.0)),
        (None, Some(sum)) => {
            if scale.is_some() {
                return Err(inner.error("scale", "`scale` beside `sum`: write it into the factors of the sum"));
            }
            summed(channel, inner, &sum)?
        }
        (Some(_), Some(_)) => return Err(inner.error("sum", "`header` and `sum` together: keep one")),
        (None, None) => return Err(inner.missing("header", "the header in your file, or a `sum` of several")),
    };
    mapping.unit = inner.string("unit")?.map(str::to_owned);
    Ok(mapping)
}

/// The headers of a sum and their factors, in the order of the file.
fn summed(channel: &str, inner: &Section, sum: &Section) -> Result<ColumnMapping, ModelFileError> {
    let mut found: Option<ColumnMapping> = None;
    for (header, _) in sum.keys() {
        let factor = sum.number(header, Dimension::NUMBER)?.filter(|factor| *factor != 0.0);
        let factor = factor.ok_or_else(|| sum.error(header, "the factor is zero: leave the header out"))?;
        found = Some(match found {
            Some(mapping) => mapping.plus(header, factor),
            None => ColumnMapping::new(channel, header).with_scale(factor),
        });
    }
    found.ok_or_else(|| inner.error("sum", "`sum` is empty: write { \"header\" = factor, ... }"))
}
