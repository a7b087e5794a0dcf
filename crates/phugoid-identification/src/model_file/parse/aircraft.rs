//! `[aircraft]`: mass, inertia, sizes, thrust, air.

use phugoid_flight_data::quantity::Dimension;
use toml::Spanned;
use toml::de::DeValue;

use super::axes::written;
use crate::core::axes::Axes;
use crate::model_file::aircraft::{AirDensity, AircraftData, Base, Source, Thrust};
use crate::model_file::error::ModelFileError;
use crate::model_file::section::Section;

const AIRCRAFT_KEYS: [&str; 16] = [
    "rotor_momentum",
    "mass",
    "ixx",
    "iyy",
    "izz",
    "ixz",
    "wing_area",
    "mean_chord",
    "wing_span",
    "cg",
    "thrust",
    "thrust_inclination",
    "thrust_arm",
    "air_density",
    "reference_speed",
    "gravity",
];

/// A constant, or `{ channel = "name" }`.
fn source_of(section: &Section, key: &str, dimension: Dimension) -> Result<Option<Source>, ModelFileError> {
    match section.get(key).map(Spanned::get_ref) {
        Some(DeValue::Table(_)) => {
            let Some(inner) = section.section(key)? else { return Ok(None) };
            inner.allow("key", ["channel"].into_iter())?;
            let channel = inner.string("channel")?.ok_or_else(|| inner.missing("channel", "the name of a channel"))?;
            Ok(Some(Source::Channel(channel.to_owned())))
        }
        _ => Ok(section.number(key, dimension)?.map(Source::Constant)),
    }
}

fn required_source(section: &Section, key: &str, dimension: Dimension) -> Result<Source, ModelFileError> {
    let found = source_of(section, key, dimension)?;
    let found = found.ok_or_else(|| {
        section.missing(key, &format!("a quantity in {}, or {{ channel = \"{key}\" }}", dimension.si_unit()))
    })?;
    match found {
        Source::Constant(v) if v <= 0.0 => Err(section.error(key, format!("`{key}` is {v}: expected more than zero"))),
        other => Ok(other),
    }
}

pub(super) fn aircraft(top: &Section, base: Base, axes: Axes) -> Result<AircraftData, ModelFileError> {
    let section = top.section("aircraft")?.ok_or_else(|| top.missing("aircraft", "a table [aircraft]"))?;
    section.allow("key", AIRCRAFT_KEYS.iter().copied())?;
    let text = |key: &str| section.get(key).and_then(|v| v.get_ref().as_str());
    let thrust = match text("thrust") {
        Some("trim") if base == Base::None => {
            return Err(section.error("thrust", "thrust = \"trim\" needs a database (base = \"f16\") to trim"));
        }
        Some("trim") => Thrust::Trim,
        // The lateral-directional motion takes the measured specific forces in its place.
        None if section.get("thrust").is_none() && !axes.has_longitudinal() => Thrust::Known(Source::Constant(0.0)),
        _ => Thrust::Known(source_of(&section, "thrust", Dimension::FORCE)?.ok_or_else(|| {
            section
                .missing("thrust", "a force (0 for a glider), { channel = \"thrust\" } or, with a database, \"trim\"")
        })?),
    };
    let air_density = match text("air_density") {
        Some("standard_atmosphere") => AirDensity::StandardAtmosphere,
        Some("book_atmosphere") => AirDensity::BookAtmosphere,
        Some(word) if word.starts_with(|c: char| c.is_ascii_alphabetic()) => {
            let words = ["standard_atmosphere", "book_atmosphere"];
            let span = section.get("air_density").map_or(section.span.clone(), Spanned::span);
            section.choose("air_density", word, span, &words)?;
            AirDensity::StandardAtmosphere
        }
        _ => AirDensity::Known(required_source(&section, "air_density", Dimension::DENSITY)?),
    };
    let cg = section.number("cg", Dimension::NUMBER)?;
    if base != Base::None && cg.is_none() {
        return Err(section.missing("cg", "the centre of gravity as a fraction of the mean chord, for the database"));
    }
    // What only the lateral axes need may be there for all: one description of the aircraft serves every file.
    let lateral = |key: &str, found: bool, expected: &str| {
        if found || !axes.has_lateral() {
            return Ok(());
        }
        Err(section.missing(key, &format!("{expected}, for the lateral axes ({})", written(axes))))
    };
    let wing_span = section.positive("wing_span", Dimension::LENGTH)?;
    lateral("wing_span", wing_span.is_some(), "the span in m or with a unit")?;
    let inertia = |key: &str| -> Result<Option<Source>, ModelFileError> {
        let found = source_of(&section, key, Dimension::INERTIA)?;
        if let Some(Source::Constant(v)) = found
            && v <= 0.0
            && key != "ixz"
        {
            return Err(section.error(key, format!("`{key}` is {v}: expected more than zero")));
        }
        let expected = format!("a quantity in kg*m^2, or {{ channel = \"{key}\" }}");
        lateral(key, found.is_some(), &expected)?;
        Ok(found)
    };
    let (ixx, izz, ixz) = (inertia("ixx")?, inertia("izz")?, inertia("ixz")?);
    if let (Some(Source::Constant(x)), Some(Source::Constant(z)), Some(Source::Constant(xz))) = (&ixx, &izz, &ixz)
        && xz * xz >= x * z
    {
        let message = format!("`ixz` is {xz}: its square must be below ixx izz = {}", x * z);
        return Err(section.error("ixz", message));
    }
    Ok(AircraftData {
        ixx,
        izz,
        ixz,
        wing_span,
        mass: required_source(&section, "mass", Dimension::MASS)?,
        iyy: required_source(&section, "iyy", Dimension::INERTIA)?,
        wing_area: section.required_positive("wing_area", Dimension::AREA)?,
        mean_chord: section.required_positive("mean_chord", Dimension::LENGTH)?,
        cg,
        thrust,
        thrust_inclination: section.number("thrust_inclination", Dimension::ANGLE)?.unwrap_or(0.0),
        thrust_arm: section.number("thrust_arm", Dimension::LENGTH)?.unwrap_or(0.0),
        air_density,
        rotor_momentum: section.number("rotor_momentum", Dimension::ANGULAR_MOMENTUM)?.unwrap_or(0.0),
        reference_speed: section.positive("reference_speed", Dimension::SPEED)?,
        gravity: section.positive("gravity", Dimension::ACCELERATION)?.unwrap_or(9.80665),
    })
}
