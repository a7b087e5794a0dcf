//! Channels that follow from others of a record: specific forces from load factors, altitude from pressure altitude.

use crate::quality::QualityReport;
use crate::record::{Channel, Record};
use crate::units::Quantity;

/// Standard acceleration of gravity, m/s^2 (ISO 80000-3): the unit of load factors.
const STANDARD_GRAVITY: f64 = 9.806_65;

/// A channel and how it follows from another one.
struct Rule {
    name: &'static str,
    quantity: Quantity,
    from: &'static str,
    factor: f64,
    meaning: &'static str,
}

const RULES: [Rule; 4] = [
    force("ax", "nx", STANDARD_GRAVITY, "9.80665 m/s2 times nx"),
    force("ay", "ny", STANDARD_GRAVITY, "9.80665 m/s2 times ny"),
    force("az", "nz", -STANDARD_GRAVITY, "-9.80665 m/s2 times nz (nz is positive upwards)"),
    Rule {
        name: "altitude",
        quantity: Quantity::Length,
        from: "pressure_altitude",
        factor: 1.0,
        meaning: "pressure_altitude, for want of a geometric one: where the air is not standard, a density from it is that of \
                  standard air at the same pressure",
    },
];

const fn force(name: &'static str, from: &'static str, factor: f64, meaning: &'static str) -> Rule {
    Rule { name, quantity: Quantity::Acceleration, from, factor, meaning }
}

/// Adds the channels that a record lacks and that follow from those that it has, and says so. Missing values stay missing.
pub(super) fn complete(record: &mut Record, report: &mut QualityReport) {
    for rule in &RULES {
        if record.channel(rule.name).is_some() {
            continue;
        }
        let Some(source) = record.channel(rule.from) else { continue };
        let values = source.values.iter().map(|value| rule.factor * value).collect();
        record.channels.push(Channel { name: rule.name.to_owned(), quantity: rule.quantity, values });
        report.note(format!("channel {}", rule.name), format!("not recorded; taken as {}", rule.meaning));
    }
}
