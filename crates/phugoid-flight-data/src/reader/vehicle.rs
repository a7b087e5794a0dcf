//! What kind of vehicle a log is of: the models are of aircraft that fly on wings.

use crate::log::Log;
use crate::quality::QualityReport;

/// Says so where the log is not of a fixed-wing aircraft.
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

/// What flies without wings, or with them only now and then.
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
