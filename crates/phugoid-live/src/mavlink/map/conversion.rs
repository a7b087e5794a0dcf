//! From the raw value of a field to SI.

use phugoid_flight_data::channels;
use phugoid_flight_data::csv::ColumnMapping;
use phugoid_flight_data::mavlink::units::to_si;
use phugoid_flight_data::printable::toml_string;
use phugoid_flight_data::record::Quantity;
use phugoid_flight_data::units;

/// Servo pulses are counted from this width, us, which is the neutral position.
const NEUTRAL_US: f64 = 1500.0;

/// `SI value = scale * (raw - zero) + offset`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Conversion {
    zero: f64,
    scale: f64,
    offset: f64,
}

impl Conversion {
    /// The value is in SI already.
    pub(super) const NONE: Self = Self { zero: 0.0, scale: 1.0, offset: 0.0 };

    /// The conversion of a unit in the spelling of MAVLink or of a profile, times a factor; `None` for a unit that is
    /// not known.
    pub(super) fn of_unit(unit: &str, factor: f64) -> Option<Self> {
        to_si(unit).map(|(scale, offset)| Self { zero: 0.0, scale: factor * scale, offset })
    }

    /// Converts a raw value to SI.
    pub(super) fn si(self, raw: f64) -> f64 {
        self.scale * (raw - self.zero) + self.offset
    }
}

/// The conversion of a field that the model file maps to a channel; the unit of the mapping wins over that of the
/// field.
///
/// # Errors
/// A sentence for people: a unit that does not suit the channel, or a command without a scale to an angle.
pub(super) fn of_mapping(mapping: &ColumnMapping, unit_of_field: &str) -> Result<Conversion, String> {
    let quantity = channels::by_name(&mapping.channel).map_or(Quantity::Number, |spec| spec.quantity);
    if let Some(text) = &mapping.unit {
        let Some(unit) = units::find_for(text, quantity) else {
            let accepted = units::accepted(quantity);
            return Err(format!(
                "[channels] {}: the unit `{text}` is not understood for {}; accepted are {accepted}",
                mapping.channel,
                quantity.in_words()
            ));
        };
        return Ok(Conversion { zero: 0.0, scale: mapping.scale * unit.scale, offset: unit.offset });
    }
    let suits = quantity == Quantity::Number
        || units::find_for(unit_of_field, quantity).is_some()
        || (unit_of_field == "mG" && quantity == Quantity::Acceleration)
        || (to_si(unit_of_field).is_some() && units::find(unit_of_field).is_empty() && !unit_of_field.is_empty());
    if suits && let Some(conversion) = Conversion::of_unit(unit_of_field, mapping.scale) {
        return Ok(conversion);
    }
    if unit_of_field.is_empty() && mapping.header.starts_with("NAMED_VALUE_FLOAT") {
        return Ok(Conversion { zero: 0.0, scale: mapping.scale, offset: 0.0 });
    }
    if mapping.scale == 1.0 {
        return Err(format!(
            "[channels] {}: `{}` is a command {}, not {} in a unit. Give what one of its units is in {}: \
             {} = {{ header = {}, scale = ... }}. Servo pulses count from 1500 us",
            mapping.channel,
            mapping.header,
            if unit_of_field.is_empty() { "without a unit".to_owned() } else { format!("in {unit_of_field}") },
            quantity.in_words(),
            quantity.si_unit(),
            mapping.channel,
            toml_string(&mapping.header)
        ));
    }
    let zero = if unit_of_field == "us" { NEUTRAL_US } else { 0.0 };
    Ok(Conversion { zero, scale: mapping.scale, offset: 0.0 })
}
