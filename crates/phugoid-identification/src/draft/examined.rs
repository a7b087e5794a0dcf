//! Holds the answers against the record and against one another.

use super::Answers;
use super::contents::Contents;
use super::text::{Aircraft, GRAVITY};
use crate::judge::physics::aircraft::{ASPECT_RATIO, CHORD, FLAT};

/// Coefficients of lift of flights that are not near the stall and not in a dive.
const LIFT: [f64; 2] = [0.03, 1.8];

/// What does not belong together, a sentence each.
pub(super) fn doubts(contents: &Contents<'_>, answers: &Answers, aircraft: &Aircraft) -> Vec<String> {
    let mut doubts = Vec::new();
    let outside = |value: f64, [low, high]: [f64; 2]| value.is_finite() && !(low..=high).contains(&value);
    let Aircraft { area, span, chord, .. } = *aircraft;
    let aspect = span * span / area;
    if outside(aspect, ASPECT_RATIO) || outside(span * chord / area, CHORD) {
        doubts.push(format!(
            "wing area {area} m^2, span {span} m and chord {chord} m do not belong to one wing (aspect ratio {aspect:.2}): is \
             one of them in feet?"
        ));
    }
    let typical = answers.class.typical();
    let Some(mass) = aircraft.mass else { return doubts };
    if outside(mass, typical.mass) {
        let [low, high] = typical.mass;
        doubts.push(format!("{mass} kg is no usual mass of this class ({low} to {high} kg): is it in pounds?"));
    }
    let speed =
        contents.middle("true_airspeed").or_else(|| contents.other_speed().and_then(|name| contents.middle(name)));
    if let (Some(speed), Some(density)) = (speed, aircraft.density) {
        let pressure = 0.5 * density * speed * speed;
        // In steady flight the specific force along body z is one g.
        let force = contents.middle("az").map_or(GRAVITY, |az| -az);
        let lift = mass * force / (pressure * area);
        if outside(lift, LIFT) {
            doubts.push(format!(
                "at {speed:.1} m/s in air of {density:.3} kg/m^3 a coefficient of lift of {lift:.3} carries {mass} kg on \
                 {area} m^2: mass, area, airspeed or density is in another unit"
            ));
        }
        if let (Some(thrust), Some(ax), Some(alpha)) =
            (aircraft.thrust, contents.middle("ax"), contents.middle("alpha"))
        {
            let drag = (thrust - mass * (ax * alpha.cos() - force * alpha.sin())) / (pressure * area);
            if drag < 0.0 {
                doubts.push(format!(
                    "with a thrust of {thrust:.0} N the coefficient of drag is {drag:.3} in the middle of the record, and drag is \
                     positive: the thrust is too small, or ax is not forward in m/s^2"
                ));
            }
        }
    }
    let [ixx, iyy, izz] = aircraft.inertia;
    if outside(izz / (ixx + iyy), FLAT) {
        doubts.push(format!(
            "izz is {:.2} times the sum of ixx and iyy, and 0.7 to 1 is expected of an aeroplane",
            izz / (ixx + iyy)
        ));
    }
    doubts
}
