//! The kind of vehicle that a log is of. The models of this project are of fixed-wing aircraft.

use crate::log::Log;
use crate::quality::QualityReport;

/// Warns if the log is not of a fixed-wing aircraft.
pub(super) fn report(log: &Log, quality: &mut QualityReport) {
    if let Some(kind) = kind(log) {
        quality.warn(
            "vehicle",
            format!(
                "the log says that it is {kind}; models of aerodynamic coefficients here are of flight on wings, with an airspeed, an \
                 angle of attack and control surfaces"
            ),
        );
    }
}

/// The vehicle as a noun with its article, if it is no aeroplane; `None` for an aeroplane or where the log does not
/// say.
fn kind(log: &Log) -> Option<String> {
    // MAV_TYPE of the MAVLink common dialect.
    let mav_type = log.parameters.iter().find(|(name, _)| name == "MAV_TYPE").map(|(_, value)| *value as i64);
    let of_type = |kind: i64| match kind {
        2 | 3 | 13 | 14 | 15 | 29 | 35 => Some("a multirotor"),
        4 => Some("a helicopter"),
        10 => Some("a ground rover"),
        11 => Some("a boat"),
        12 => Some("a submarine"),
        19..=25 => Some("a VTOL aircraft: only its forward flight counts"),
        _ => None,
    };
    if let Some(kind) = mav_type {
        return of_type(kind).map(|words| format!("{words} (MAV_TYPE = {kind})"));
    }
    log.messages.iter().find_map(|message| {
        let words = message.text.split_whitespace().next()?.trim_start_matches("APM:");
        let kinds = [
            ("ArduCopter", "a multirotor"),
            ("Copter", "a multirotor"),
            ("ArduRover", "a rover"),
            ("Rover", "a rover"),
        ];
        let (_, kind) = kinds.into_iter().find(|(name, _)| *name == words)?;
        Some(format!("{kind} ('{}')", message.text))
    })
}
