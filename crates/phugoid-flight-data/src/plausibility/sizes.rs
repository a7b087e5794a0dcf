//! Checks of sizes: values larger than those of any flying aeroplane.

use std::f64::consts::{FRAC_PI_2, PI};

use super::doubt::{Cause, Certainty, Doubts, write_degrees};
use super::robust::{largest_size, median_of_finite, span, span_beyond};
use super::standing;
use crate::channels;
use crate::record::Quantity;
use crate::wording::Short;

/// Limits that 95 % of the samples of an angle (rad) or a rate (rad/s) stay below: in ordinary flight, and in any
/// flight. `None` for other channels.
fn limits(name: &str, quantity: Quantity) -> Option<(f64, f64)> {
    Some(match (name, quantity) {
        ("alpha" | "beta", _) => (0.6, 1.2),
        ("theta", _) => (1.2, 1.05 * FRAC_PI_2),
        ("elevator" | "aileron" | "rudder", _) => (0.7, 1.05),
        // Some files have bank angle and longitude from 0 to 360 degrees.
        ("phi" | "longitude", _) => (1.02 * PI, 2.04 * PI),
        ("psi", _) => (2.04 * PI, 2.04 * PI),
        (_, Quantity::Angle) => (1.02 * FRAC_PI_2, 1.02 * FRAC_PI_2),
        ("q" | "r", _) => (1.5, 4.0),
        ("p", _) => (4.0, 8.0),
        _ => return None,
    })
}

/// Checks angles and rates: degrees that were read as radians are too large.
pub(super) fn angles(doubts: &mut Doubts) {
    for channel in &doubts.record.channels {
        let name = channel.name.as_str();
        let Some((unusual, impossible)) = limits(name, channel.quantity) else { continue };
        let Some(values) = doubts.values(name).filter(|_| channels::by_name(name).is_some()) else { continue };
        let Some(span) = span_beyond(values, unusual) else { continue };
        let size = largest_size(span);
        let certainty = if size > impossible { Certainty::Certain } else { Certainty::Doubtful };
        let (si, degrees) = if channel.quantity == Quantity::AngularRate { ("rad/s", "deg/s") } else { ("rad", "deg") };
        let found = format!("reaches {} {si}, i.e. {} {degrees}", Short(size), Short(size.to_degrees()));
        let message = match doubts.unit(name) {
            Some(unit) if unit != si => {
                format!("{found}: more than an aeroplane flies with. Is it really in {unit}? Check the column")
            }
            _ => format!("{found}: it looks like degrees read as radians. {}", write_degrees(name, degrees)),
        };
        doubts.add(&[name], certainty, message);
    }
    // Radians read as degrees show only in the angle of attack: no aeroplane flies with less than a third of a degree.
    if doubts.unit("alpha") == Some("deg")
        && let Some(size) = doubts.values("alpha").and_then(span).map(|span| largest_size(span).to_degrees())
        && size > 0.0
        && size < 0.35
        && !theta_agrees(doubts)
    {
        let message = format!(
            "stays below {} deg: a deviation from trim, or radians taken for degrees. If so, write alpha_rad",
            Short(size)
        );
        doubts.add(&["alpha"], Certainty::Doubtful, message);
    }
}

/// Whether the pitch angle stays within a third of what the angle of attack would be if its numbers were radians: an
/// aeroplane that is trimmed close to zero angle of attack flies nose level. False without a pitch angle.
fn theta_agrees(doubts: &Doubts) -> bool {
    let size = |name: &str| doubts.values(name).and_then(span).map(largest_size);
    let (Some(theta), Some(alpha)) = (size("theta"), size("alpha")) else { return false };
    3.0 * theta < alpha.to_degrees()
}

/// No aeroplane flies slower, m/s.
pub(super) const SLOWEST: f64 = 5.0;

/// Checks the size of the airspeed.
fn airspeed(doubts: &mut Doubts) {
    let values = || doubts.values("true_airspeed").map(|values| values.iter().copied());
    if let Some(speed) = values().and_then(median_of_finite).filter(|speed| *speed <= -SLOWEST) {
        let message = format!(
            "is {} m/s in the middle (median), and no airspeed is negative: change the sign, map it with scale -1",
            Short(speed)
        );
        return doubts.add(&["true_airspeed"], Certainty::Certain, message);
    }
    let speed = values().and_then(|values| median_of_finite(values.map(f64::abs)));
    if let Some(speed) = speed.filter(|speed| !(SLOWEST..=1200.0).contains(speed)) {
        if speed < SLOWEST
            && let Some(message) = standing::message(doubts)
        {
            return doubts.add_cause(&["true_airspeed"], Certainty::Doubtful, Cause::Standing, message);
        }
        if values().is_some_and(|mut values| values.all(|value| value == 0.0 || value.is_nan())) {
            let message = "is 0 m/s throughout, so that there are no coefficients: the sensor or its recorder did not work, or the \
                           column is another one. Name the column that holds the airspeed in the model file: [channels] \
                           true_airspeed = \"your header\"";
            return doubts.add(&["true_airspeed"], Certainty::Certain, message.to_owned());
        }
        let message = format!("is about {} m/s, and no aeroplane flies at that: check its unit", Short(speed));
        doubts.add(&["true_airspeed"], Certainty::Doubtful, message);
    }
}

/// Checks the sizes of airspeed, altitude and throttle.
pub(super) fn others(doubts: &mut Doubts) {
    airspeed(doubts);
    let size = |name: &str| median_of_finite(doubts.values(name)?.iter().map(|value| value.abs()));
    let altitude = size("altitude");
    if let Some(altitude) = altitude.filter(|altitude| *altitude > 25_000.0) {
        let message = format!(
            "is about {} m: if it is in feet, name the column `altitude_ft` or give its unit in the model file",
            Short(altitude)
        );
        doubts.add(&["altitude"], Certainty::Doubtful, message);
    }
    if let Some(throttle) = doubts.values("throttle").and_then(|throttle| span_beyond(throttle, 1.5)).map(largest_size)
    {
        let message = format!("reaches {}; 0 to 1 is expected. If it is percent, write throttle_pct", Short(throttle));
        doubts.add(&["throttle"], Certainty::Certain, message);
    }
}
