//! Interprets the header of a column: a name and perhaps a unit.

use crate::channels::{self, AMBIGUOUS, ChannelSpec};
use crate::record::Quantity;
use crate::units::{self, Unit};

/// The meaning of a header.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Meaning {
    /// A known channel, with the unit if one was written.
    Known { spec: &'static ChannelSpec, unit: Option<Unit> },
    /// No known channel: the column is kept under its own name.
    Unknown { name: String, unit: Option<Unit>, doubt: Option<Doubt> },
}

/// Why a header was not taken for a known channel although it looks like one.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Doubt {
    /// The name is known, but the unit is one of another quantity (`found`) or is not known.
    Unit { spec: &'static ChannelSpec, text: String, found: Option<Quantity> },
    /// The name could mean several channels.
    Ambiguous(Vec<&'static str>),
    /// The name is probably a misspelling of this channel, of which `like` is one of the names; or its unit is one of `unit`.
    Near { name: &'static str, like: &'static str, unit: Option<Unit> },
}

/// Two different units are stated for one column: in its header, in brackets, or in the row of units below.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Conflict {
    pub(crate) first: String,
    pub(crate) second: String,
}

/// The meaning of a header and of the text below it in the row of units, if there is one.
pub(crate) fn interpret(header: &str, unit_below: Option<&str>) -> Result<Meaning, Conflict> {
    let header = header.trim();
    let below = unit_below.map(str::trim).filter(|text| !text.is_empty());
    let (name, bracket) = split_bracket(header);
    match (bracket.filter(|text| !text.is_empty()), below) {
        (Some(unit), None) => with_unit(header, name, unit),
        (None, Some(below)) => with_unit(name, name, below),
        (None, None) => Ok(with_suffix(name)),
        (Some(unit), Some(below)) => {
            let (inside, outside) = (units::find(unit), units::find(below));
            if !inside.is_empty() && !outside.is_empty() && inside != outside {
                return Err(Conflict { first: unit.to_owned(), second: below.to_owned() });
            }
            with_unit(header, name, unit)
        }
    }
}

/// A unit of this quantity that is written in a header or below it, whatever the name of the column is.
pub(crate) fn unit_for(header: &str, unit_below: Option<&str>, quantity: Quantity) -> Option<Unit> {
    let (name, bracket) = split_bracket(header.trim());
    let stated = bracket.into_iter().chain(unit_below).find_map(|text| units::find_for(text, quantity));
    stated.or_else(|| splits(name, true).into_iter().find_map(|(_, suffix)| units::find_for(suffix, quantity)))
}

/// The names that a header can mean: without what stands in brackets, and without a unit at its end.
pub(super) fn names(header: &str) -> Vec<&str> {
    let (name, _) = split_bracket(header.trim());
    let shorter = splits(name, true).into_iter().filter(|(_, suffix)| !units::find(suffix).is_empty());
    std::iter::once(name).chain(shorter.map(|(name, _)| name)).collect()
}

/// Whether a header is this name (in lower case, letters only), alone or with a unit of speed behind it.
pub(crate) fn is_speed_named(header: &str, wanted: &str) -> bool {
    let (name, _) = split_bracket(header.trim());
    let speed = |unit: &str| units::find_for(unit, Quantity::Speed).is_some();
    channels::key(name) == wanted
        || splits(name, true).into_iter().any(|(name, unit)| channels::key(name) == wanted && speed(unit))
}

/// Splits `alpha [deg]`, `alpha (deg)`, `alpha {deg}` or `Alpha, deg` into the name and the text of the unit.
fn split_bracket(header: &str) -> (&str, Option<&str>) {
    for (open, close) in [('[', ']'), ('(', ')'), ('{', '}')] {
        if let Some(inner) = header.strip_suffix(close)
            && let Some((name, unit)) = inner.rsplit_once(open)
            && !name.trim().is_empty()
        {
            return (name.trim(), Some(unit.trim()));
        }
    }
    if let Some((name, unit)) = header.rsplit_once(',')
        && !name.trim().is_empty()
        && !units::find(unit).is_empty()
    {
        return (name.trim(), Some(unit.trim()));
    }
    (header, None)
}

fn with_unit(header: &str, name: &str, unit_text: &str) -> Result<Meaning, Conflict> {
    let found = units::find(unit_text);
    if let Some(meanings) = ambiguous(name) {
        if let Some(known) = only_one(meanings, &found) {
            return Ok(known);
        }
        let unit = found.first().copied();
        return Ok(Meaning::Unknown { name: name.to_owned(), unit, doubt: doubt_of(meanings, unit) });
    }
    let specs = channels::by_any_name(name);
    for spec in &specs {
        if let Some(unit) = found.iter().find(|unit| unit.quantity == spec.quantity) {
            return Ok(Meaning::Known { spec, unit: Some(*unit) });
        }
        if let Some(unit) = load_factor_unit(spec, unit_text) {
            return Ok(Meaning::Known { spec, unit: Some(unit) });
        }
    }
    if let Some(spec) = specs.first() {
        let doubt = Doubt::Unit { spec, text: unit_text.to_owned(), found: found.first().map(|unit| unit.quantity) };
        return Ok(Meaning::Unknown { name: header.to_owned(), unit: None, doubt: Some(doubt) });
    }
    // In `alpha_deg [deg]` the name contains a unit too.
    let by_name = with_suffix(name);
    if let Meaning::Known { unit: Some(suffix), .. } | Meaning::Unknown { unit: Some(suffix), .. } = &by_name
        && !found.is_empty()
    {
        return match found.contains(suffix) {
            true => Ok(by_name),
            false => Err(Conflict { first: suffix.symbol.to_owned(), second: unit_text.to_owned() }),
        };
    }
    // If the unit is not known, the text in brackets stays part of the name.
    let (name, unit) = match found.first() {
        Some(unit) => (name, Some(*unit)),
        None => (header, None),
    };
    Ok(Meaning::Unknown { name: name.to_owned(), unit, doubt: near(name) })
}

fn with_suffix(header: &str) -> Meaning {
    let unknown = |name: &str, unit, doubt| Meaning::Unknown { name: name.to_owned(), unit, doubt };
    if let Some(meanings) = ambiguous(header) {
        return unknown(header, None, Some(Doubt::Ambiguous(meanings.to_vec())));
    }
    if let Some(spec) = channels::by_any_name(header).first() {
        return Meaning::Known { spec, unit: None };
    }
    if let Some(known) = knots(header) {
        return known;
    }
    let mut doubt = None;
    for (name, suffix) in splits(header, true) {
        let found = units::find(suffix);
        let Some(first) = found.first() else { continue };
        if let Some(meanings) = ambiguous(name) {
            if let Some(known) = only_one(meanings, &found) {
                return known;
            }
            return unknown(name, Some(*first), doubt_of(meanings, Some(*first)));
        }
        let specs = channels::by_any_name(name);
        for spec in &specs {
            if let Some(unit) = found.iter().find(|unit| unit.quantity == spec.quantity) {
                return Meaning::Known { spec, unit: Some(*unit) };
            }
            if let Some(unit) = load_factor_unit(spec, suffix) {
                return Meaning::Known { spec, unit: Some(unit) };
            }
        }
        // A single letter can be an index or a mark (`theta_c`: commanded) as well as a unit.
        if let (Some(spec), None, true) = (specs.first(), &doubt, suffix.len() > 1) {
            doubt = Some(Doubt::Unit { spec, text: suffix.to_owned(), found: Some(first.quantity) });
        }
    }
    if doubt.is_some() {
        return unknown(header, None, doubt);
    }
    // After an unknown name only an unmistakable suffix is taken as a unit: `delta_Cm` is no length, `theta_c` no
    // temperature.
    let unmistakable = splits(header, false).into_iter().find_map(|(name, suffix)| {
        let unit = units::find(suffix).first().copied()?;
        UNMISTAKABLE.contains(&unit.symbol).then_some((name, unit))
    });
    match unmistakable {
        Some((name, unit)) => unknown(name, Some(unit), near(name)),
        None => {
            let before_unit = || {
                splits(header, true)
                    .into_iter()
                    .filter(|(name, suffix)| !units::find(suffix).is_empty() && channels::by_any_name(name).is_empty())
                    .find_map(|(name, _)| near(name))
            };
            unknown(header, None, near(header).or_else(before_unit).or_else(|| misspelt_unit(header)))
        }
    }
}

/// The doubt about a name that is like one of a channel.
fn near(name: &str) -> Option<Doubt> {
    channels::nearest_spelling(name).map(|(name, like)| Doubt::Near { name, like, unit: None })
}

/// The doubt about a known name behind which a unit is misspelt by one letter: `alpha_dg`.
fn misspelt_unit(header: &str) -> Option<Doubt> {
    /// What is demanded and desired is one letter from degrees.
    const OTHER_WORDS: [&str; 2] = ["dem", "des"];
    splits(header, true).into_iter().find_map(|(name, suffix)| {
        let suffix = suffix.to_lowercase();
        let one_letter = |symbol: &str| symbol.len() > 2 && strsim::damerau_levenshtein(symbol, &suffix) == 1;
        let near = |spec: &ChannelSpec| {
            let quantity = spec.quantity;
            units::UNITS.iter().filter(move |unit| unit.quantity == quantity && one_letter(unit.symbol))
        };
        let spec = channels::by_any_name(name).into_iter().find(|spec| near(spec).next().is_some())?;
        // Where several units are as near, nobody knows which is meant.
        let mut units = near(spec).copied();
        let unit = units.next().filter(|first| units.all(|other| other.scale == first.scale));
        // A single letter is an index or a mark.
        let is_unit = suffix.len() > 1 && !OTHER_WORDS.contains(&suffix.as_str());
        is_unit.then_some(Doubt::Near { name: spec.name, like: spec.name, unit })
    })
}

/// Suffixes that are units also after a name that is not known.
const UNMISTAKABLE: &[&str] = &[
    "rad", "deg", "rad_s", "deg_s", "dps", "rad_s2", "deg_s2", "m_s", "ft_s", "kt", "m_s2", "ft_s2", "ft", "pa", "hpa",
    "kpa", "psf", "kg", "lbf", "slug", "kg_m2", "slug_ft2", "kg_m3", "slug_ft3", "degc", "degf",
];

fn ambiguous(name: &str) -> Option<&'static [&'static str]> {
    let key = channels::key(name);
    AMBIGUOUS.iter().find(|(ambiguous, _)| *ambiguous == key).map(|(_, meanings)| *meanings)
}

/// The doubt about a name that could mean these channels. A unit that the only one of them does not have says that the
/// column is something else: `eta [%]` is an efficiency.
fn doubt_of(meanings: &[&'static str], unit: Option<Unit>) -> Option<Doubt> {
    let something_else = meanings.len() == 1 && unit.is_some();
    (!something_else).then(|| Doubt::Ambiguous(meanings.to_vec()))
}

/// The only channel among the meanings whose quantity has this unit: `m_kg` is the mass. `None` if there is none or
/// several.
fn only_one(meanings: &[&str], found: &[Unit]) -> Option<Meaning> {
    let mut suiting = meanings.iter().filter_map(|name| channels::by_name(name)).filter_map(|spec| {
        let unit = found.iter().find(|unit| unit.quantity == spec.quantity)?;
        Some(Meaning::Known { spec, unit: Some(*unit) })
    });
    suiting.next().filter(|_| suiting.next().is_none())
}

/// For a load factor in `g`, the unit of a pure number; `None` for everything else.
fn load_factor_unit(spec: &ChannelSpec, text: &str) -> Option<Unit> {
    let is_load_factor = matches!(spec.name, "nx" | "ny" | "nz");
    let in_g = units::find_for(text, Quantity::Acceleration).is_some_and(|unit| unit.symbol == "g");
    (is_load_factor && in_g).then(|| units::find_for("-", Quantity::Number)).flatten()
}

/// Interprets `KTAS`, `KIAS`, `KCAS` and `KEAS`, airspeeds in knots; `None` for other names.
fn knots(header: &str) -> Option<Meaning> {
    let key = channels::key(header);
    let name = key.strip_prefix('k').filter(|name| matches!(*name, "tas" | "ias" | "cas" | "eas"))?;
    let spec = channels::by_any_name(name).first().copied()?;
    Some(Meaning::Known { spec, unit: units::find_for("kt", Quantity::Speed) })
}

/// All ways to split a header into a name and a suffix, the longest suffix first. Words begin after a separator and,
/// with `camel_case`, at a capital after a small letter (`TimeUS`).
fn splits(header: &str, camel_case: bool) -> Vec<(&str, &str)> {
    let mut starts = Vec::new();
    let mut previous = ' ';
    for (index, c) in header.char_indices() {
        let separated = !previous.is_alphanumeric() && (c.is_alphanumeric() || c == '%' || c == '°');
        let capital = camel_case && previous.is_lowercase() && c.is_uppercase();
        if index > 0 && (separated || capital) {
            starts.push(index);
        }
        previous = c;
    }
    let longest = starts.len().saturating_sub(4);
    starts
        .get(longest..)
        .unwrap_or_default()
        .iter()
        .filter_map(|&start| header.split_at_checked(start))
        .map(|(name, suffix)| (name.trim_end_matches(|c: char| !c.is_alphanumeric() && c != ')' && c != ']'), suffix))
        .filter(|(name, _)| !name.is_empty())
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn known(header: &str) -> (String, Option<&'static str>) {
        match interpret(header, None) {
            Ok(Meaning::Known { spec, unit }) => (spec.name.to_owned(), unit.map(|unit| unit.symbol)),
            other => panic!("{header}: {other:?}"),
        }
    }

    fn unknown(header: &str) -> (String, Option<&'static str>, Option<Doubt>) {
        match interpret(header, None) {
            Ok(Meaning::Unknown { name, unit, doubt }) => (name, unit.map(|unit| unit.symbol), doubt),
            other => panic!("{header}: {other:?}"),
        }
    }

    #[test]
    fn names_and_units() {
        for (header, name, unit) in [
            ("time_s", "time", Some("s")),
            ("TimeUS", "time", Some("us")),
            ("timestamp_ms", "time", Some("ms")),
            ("tas_ft_s", "true_airspeed", Some("ft_s")),
            ("tas_kt", "true_airspeed", Some("kt")),
            ("tas_kts", "true_airspeed", Some("kt")),
            ("KTAS", "true_airspeed", Some("kt")),
            ("true_airspeed_m_s", "true_airspeed", Some("m_s")),
            ("True Airspeed (knots)", "true_airspeed", Some("kt")),
            ("IAS [kt]", "indicated_airspeed", Some("kt")),
            ("alpha_rad", "alpha", Some("rad")),
            ("alpha [deg]", "alpha", Some("deg")),
            ("Alpha (deg)", "alpha", Some("deg")),
            ("Alpha, deg", "alpha", Some("deg")),
            ("ALPHA_DEG", "alpha", Some("deg")),
            ("alpha [°]", "alpha", Some("deg")),
            ("alpha deg", "alpha", Some("deg")),
            ("AlphaDeg", "alpha", Some("deg")),
            ("alpha_deg [deg]", "alpha", Some("deg")),
            ("alpha", "alpha", None),
            ("pitch_rad", "theta", Some("rad")),
            ("theta_rad", "theta", Some("rad")),
            ("q_rad_s", "q", Some("rad_s")),
            ("q_deg_s", "q", Some("deg_s")),
            ("q_dps", "q", Some("dps")),
            ("q_degps", "q", Some("deg_s")),
            ("q_psf", "dynamic_pressure", Some("psf")),
            ("q", "q", None),
            ("p_hpa", "static_pressure", Some("hpa")),
            ("pressure_hpa", "static_pressure", Some("hpa")),
            ("t_s", "time", Some("s")),
            ("T [degC]", "temperature", Some("degc")),
            ("qdot_rad_s2", "qdot", Some("rad_s2")),
            ("Pitch Rate [deg/s]", "q", Some("deg_s")),
            ("ax_g", "ax", Some("g")),
            ("ax_ft_s2", "ax", Some("ft_s2")),
            ("nz_g", "nz", Some("-")),
            ("nz", "nz", None),
            ("thrust_n", "thrust", Some("n")),
            ("thrust_lb", "thrust", Some("lb")),
            ("thrust_kN", "thrust", Some("kn")),
            ("fuel_lb", "fuel", Some("lb")),
            ("m_kg", "mass", Some("kg")),
            ("M [-]", "mach", Some("-")),
            ("dynamic_pressure_pa", "dynamic_pressure", Some("pa")),
            ("altitude_ft", "altitude", Some("ft")),
            ("throttle [%]", "throttle", Some("pct")),
            ("roll_rad", "phi", Some("rad")),
            ("w_m_s", "w", Some("m_s")),
            ("air_density_kg_m3", "air_density", Some("kg_m3")),
            ("iyy_slug_ft2", "iyy", Some("slug_ft2")),
            ("η [°]", "elevator", Some("deg")),
            ("ξ [deg]", "aileron", Some("deg")),
            ("ζ (rad)", "rudder", Some("rad")),
            ("eta_deg", "elevator", Some("deg")),
            ("Fahrtmesser TAS [kt]", "true_airspeed", Some("kt")),
            ("Fahrtmesser [kt]", "indicated_airspeed", Some("kt")),
            ("Wahre Eigengeschwindigkeit [km/h]", "true_airspeed", Some("km_h")),
            ("Querneigung [°]", "phi", Some("deg")),
            ("Höhenruderausschlag [°]", "elevator", Some("deg")),
            ("Staudruck [hPa]", "dynamic_pressure", Some("hpa")),
        ] {
            assert_eq!(known(header), (name.to_owned(), unit), "{header}");
        }
    }

    #[test]
    fn other_names_stay_as_they_are() {
        for (header, name, unit) in [
            ("expected_dCm_alpha", "expected_dCm_alpha", None),
            ("expected_corrected_sd_dCm_q", "expected_corrected_sd_dCm_q", None),
            ("frame_present", "frame_present", None),
            ("process_noise_scale", "process_noise_scale", None),
            ("delta_Cm", "delta_Cm", None),
            ("pilot_command_rad", "pilot_command", Some("rad")),
            ("probe temp rise [K]", "probe temp rise", Some("k")),
            ("mode [auto]", "mode [auto]", None),
            ("η [%]", "η", Some("pct")),
            ("zeta [-]", "zeta", Some("-")),
            ("ETA [s]", "ETA", Some("s")),
        ] {
            assert_eq!(unknown(header), (name.to_owned(), unit, None), "{header}");
        }
    }

    #[test]
    fn doubtful_headers_are_not_guessed() {
        assert!(matches!(unknown("airspeed_kt").2, Some(Doubt::Ambiguous(_))));
        assert!(matches!(unknown("V").2, Some(Doubt::Ambiguous(_))));
        assert!(matches!(unknown("Fahrt [kt]").2, Some(Doubt::Ambiguous(_))));
        assert!(matches!(unknown("ζ").2, Some(Doubt::Ambiguous(_))));
        assert!(matches!(unknown("aplha_deg").2, Some(Doubt::Near { name: "alpha", .. })));
        // The letter is no temperature; whether it is the pitch attitude only the user knows.
        assert_eq!(
            unknown("theta_c"),
            ("theta_c".into(), None, Some(Doubt::Near { name: "theta", like: "theta", unit: None }))
        );
        let Some(Doubt::Near { name: "alpha", unit: Some(unit), .. }) = unknown("alpha_dg").2 else {
            panic!("alpha_dg")
        };
        assert_eq!(unit.symbol, "deg");
        assert!(matches!(unknown("Höhenuder [°]").2, Some(Doubt::Near { name: "elevator", like: "höhenruder", .. })));
        assert!(matches!(
            unknown("Anstelwinkel [°]").2,
            Some(Doubt::Near { name: "alpha", like: "anstellwinkel", .. })
        ));
        for header in ["alpha_des", "alpha_ref", "elevator_cmd"] {
            assert_eq!(unknown(header).2, None, "{header}");
        }
        assert!(matches!(unknown("elevtor").2, Some(Doubt::Near { name: "elevator", .. })));
        assert!(matches!(unknown("elevator_kt").2, Some(Doubt::Unit { found: Some(Quantity::Speed), .. })));
        assert!(matches!(unknown("alpha (vane)").2, Some(Doubt::Unit { found: None, .. })));
    }

    #[test]
    fn two_units_for_one_column_are_a_conflict() {
        assert!(interpret("alpha_deg [rad]", None).is_err());
        assert!(interpret("alpha [deg]", Some("rad")).is_err());
        assert!(interpret("alpha_deg", Some("rad")).is_err());
        assert!(interpret("alpha_deg", Some("deg")).is_ok());
    }
}
