//! Units in the spelling of MAVLink's definitions.

use crate::units;

/// Factor and offset of a unit: SI value = factor * value + offset. `None` for a unit that is not known.
pub fn to_si(unit: &str) -> Option<(f64, f64)> {
    const DEGREE: f64 = std::f64::consts::PI / 180.0;
    // Spellings that only MAVLink has (https://mavlink.io/en/messages/common.html#enums, "Unit").
    Some(match unit {
        "" => (1.0, 0.0),
        "degE7" => (1e-7 * DEGREE, 0.0),
        "degE5" => (1e-5 * DEGREE, 0.0),
        "cdeg" => (1e-2 * DEGREE, 0.0),
        "ddeg" => (1e-1 * DEGREE, 0.0),
        "ddeg/s" => (1e-1 * DEGREE, 0.0),
        "cm/s" => (1e-2, 0.0),
        "dm/s" => (1e-1, 0.0),
        "mm/s" => (1e-3, 0.0),
        "dm" => (1e-1, 0.0),
        "dam" => (10.0, 0.0),
        "cdegC" => (1e-2, 273.15),
        "%" => (1e-2, 0.0),
        "d%" => (1e-3, 0.0),
        "c%" => (1e-4, 0.0),
        // A thousandth of standard gravity.
        "mG" => (9.806_65e-3, 0.0),
        other => {
            let unit = units::find(other).first().copied()?;
            (unit.scale, unit.offset)
        }
    })
}

/// The unit in the spelling of this crate, and the factor from MAVLink's unit to it; another unit stays as it is.
pub(crate) fn plain(unit: &str) -> (&str, f64) {
    match unit {
        "degE7" => ("deg", 1e-7),
        "degE5" => ("deg", 1e-5),
        "cdeg" => ("deg", 1e-2),
        "ddeg" => ("deg", 1e-1),
        "ddeg/s" => ("deg/s", 1e-1),
        "cm/s" => ("m/s", 1e-2),
        "dm/s" => ("m/s", 1e-1),
        "mm/s" => ("m/s", 1e-3),
        "dm" => ("m", 1e-1),
        "dam" => ("m", 10.0),
        "cdegC" => ("degC", 1e-2),
        "d%" => ("%", 1e-1),
        "c%" => ("%", 1e-2),
        "mG" => ("g", 1e-3),
        other => (other, 1.0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mavlink::definitions;

    #[test]
    fn both_ways_to_si_agree_for_every_unit_of_the_definitions() {
        let mut known = 0;
        for unit in definitions::messages().values().flat_map(|message| &message.fields).map(|field| field.unit) {
            let Some((scale, offset)) = to_si(unit).filter(|_| !unit.is_empty()) else { continue };
            let (name, factor) = plain(unit);
            let (of_name, zero) = to_si(name).unwrap_or_else(|| panic!("{unit}: {name} is unknown"));
            let error = (factor * of_name / scale - 1.0).abs();
            assert!(error < 1e-12 && zero == offset, "{unit}: {factor} {name}");
            known += 1;
        }
        assert!(known > 500, "{known}");
    }

    #[test]
    fn every_unit_of_motion_is_understood() {
        for (unit, scale) in [
            ("m/s/s", 1.0),
            ("m/s", 1.0),
            ("rad/s", 1.0),
            ("mrad/s", 1e-3),
            ("deg", 0.017_453_292_519_943_295),
            ("hPa", 100.0),
        ] {
            assert_eq!(to_si(unit), Some((scale, 0.0)), "{unit}");
        }
        assert_eq!(to_si("degC"), Some((1.0, 273.15)));
        assert_eq!(to_si("gauss"), None);
    }
}
