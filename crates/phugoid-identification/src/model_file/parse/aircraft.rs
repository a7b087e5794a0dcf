//! `[aircraft]`: mass, inertia, sizes, thrust, air.

use phugoid_flight_data::quantity::Dimension;
use phugoid_flight_dynamics::aircraft::Aircraft as _;
use toml::Spanned;
use toml::de::DeValue;

use super::axes::written;
use crate::core::axes::Axes;
use crate::model_file::aircraft::{AirDensity, AircraftData, Base, STANDARD_GRAVITY, Source, Thrust};
use crate::model_file::error::ModelFileError;
use crate::model_file::known::KnownAircraft;
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

/// The value of the file of `base` where the model file has none.
fn known_source(
    section: &Section,
    key: &str,
    dimension: Dimension,
    known: Option<f64>,
) -> Result<Source, ModelFileError> {
    match known.filter(|_| section.get(key).is_none()) {
        Some(value) => Ok(Source::Constant(value)),
        None => required_source(section, key, dimension),
    }
}

/// A size, which has to be that of `base` where there is one: its coefficients belong to it.
fn size(section: &Section, key: &str, dimension: Dimension, known: Option<f64>) -> Result<Option<f64>, ModelFileError> {
    /// How far a size that is written with few digits may be off.
    const ROUNDED: f64 = 1e-4;
    match (section.positive(key, dimension)?, known) {
        (Some(value), Some(known)) if (value / known - 1.0).abs() > ROUNDED => Err(section.error(
            key,
            format!("`{key}` is {value}, and the coefficients of `base` belong to {known}: leave it out, it is taken from there"),
        )),
        (value, known) => Ok(known.or(value)),
    }
}

pub(super) fn aircraft(
    top: &Section,
    base: Base,
    known: Option<&KnownAircraft>,
    axes: Axes,
) -> Result<AircraftData, ModelFileError> {
    let section = top.section("aircraft")?.ok_or_else(|| top.missing("aircraft", "a table [aircraft]"))?;
    section.allow("key", AIRCRAFT_KEYS.iter().copied())?;
    let text = |key: &str| section.get(key).and_then(|v| v.get_ref().as_str());
    let thrust = match text("thrust") {
        Some("trim") if base == Base::None => {
            return Err(section.error(
                "thrust",
                "thrust = \"trim\" needs a database (base = \"f16\", or the path of an aircraft) to trim",
            ));
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
    let mut cg = section.number("cg", Dimension::NUMBER)?;
    if let Some(known) = known {
        if cg.is_some() {
            return Err(section.error("cg", "`cg` is that of the aircraft of `base`: leave it out"));
        }
        cg = known.aircraft().centre_of_gravity();
    }
    if base == Base::F16 && cg.is_none() {
        return Err(section.missing("cg", "the centre of gravity as a fraction of the mean chord, for the database"));
    }
    // What only the lateral axes need may be there for all: one description of the aircraft serves every file.
    let lateral = |key: &str, found: bool, expected: &str| {
        if found || !axes.has_lateral() {
            return Ok(());
        }
        Err(section.missing(key, &format!("{expected}, for the lateral axes ({})", written(axes))))
    };
    let geometry = known.map(|known| *known.aircraft().geometry());
    let wing_span = size(&section, "wing_span", Dimension::LENGTH, geometry.map(|sizes| sizes.span))?;
    lateral("wing_span", wing_span.is_some(), "the span in m or with a unit")?;
    let moments = known.map(KnownAircraft::inertia);
    let of = |place: usize| moments.map(|moments| moments[place]);
    let inertia = |key: &str, known: Option<f64>| -> Result<Option<Source>, ModelFileError> {
        let found = source_of(&section, key, Dimension::INERTIA)?.or(known.map(Source::Constant));
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
    let (ixx, izz, ixz) = (inertia("ixx", of(0))?, inertia("izz", of(2))?, inertia("ixz", of(3))?);
    if let (Some(Source::Constant(x)), Some(Source::Constant(z)), Some(Source::Constant(xz))) = (&ixx, &izz, &ixz)
        && xz * xz >= x * z
    {
        let message = format!("`ixz` is {xz}: its square must be below ixx izz = {}", x * z);
        return Err(section.error("ixz", message));
    }
    let [inclination, arm] = known.map_or([0.0; 2], KnownAircraft::thrust_line);
    Ok(AircraftData {
        ixx,
        izz,
        ixz,
        wing_span,
        mass: known_source(&section, "mass", Dimension::MASS, known.map(|k| k.aircraft().mass_properties().mass()))?,
        iyy: known_source(&section, "iyy", Dimension::INERTIA, of(1))?,
        wing_area: match geometry {
            Some(sizes) => {
                size(&section, "wing_area", Dimension::AREA, Some(sizes.wing_area))?.unwrap_or(sizes.wing_area)
            }
            None => section.required_positive("wing_area", Dimension::AREA)?,
        },
        mean_chord: match geometry {
            Some(sizes) => {
                size(&section, "mean_chord", Dimension::LENGTH, Some(sizes.mean_chord))?.unwrap_or(sizes.mean_chord)
            }
            None => section.required_positive("mean_chord", Dimension::LENGTH)?,
        },
        cg,
        thrust,
        thrust_inclination: section.number("thrust_inclination", Dimension::ANGLE)?.unwrap_or(inclination),
        thrust_arm: section.number("thrust_arm", Dimension::LENGTH)?.unwrap_or(arm),
        air_density,
        rotor_momentum: section.number("rotor_momentum", Dimension::ANGULAR_MOMENTUM)?.unwrap_or(0.0),
        reference_speed: section.positive("reference_speed", Dimension::SPEED)?,
        gravity: section.positive("gravity", Dimension::ACCELERATION)?.unwrap_or(STANDARD_GRAVITY),
    })
}
