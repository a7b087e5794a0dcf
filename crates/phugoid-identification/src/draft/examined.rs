//! Holds the answers against the record and against one another, and asks whether the units of the record can be right.

use phugoid_flight_data::plausibility::{Cause, Doubt};
use phugoid_flight_data::record::{Quantity, Record};

use super::answers::{Answers, DraftError, DraftedAxes};
use super::command::SURFACES;
use super::contents::{Contents, Density};
use super::text::{Aircraft, GRAVITY, rounded};
use crate::core::error::EstimateError;
use crate::judge::physics::aircraft::{ASPECT_RATIO, CHORD, FLAT};
use crate::model_file::ModelFile;
use crate::preparation::checks;

/// Coefficients of lift of flights that are not near the stall and not in a dive.
const LIFT: [f64; 2] = [0.03, 1.8];

/// What does not belong together, a sentence each.
/// `found` are the doubts about the record.
pub(super) fn doubts(contents: &Contents<'_>, answers: &Answers, aircraft: &Aircraft, found: &[Doubt]) -> Vec<String> {
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
    // What carries an aircraft that stands for most of the record are its wheels.
    let stands = found.iter().any(|doubt| doubt.cause == Cause::Standing);
    if let (Some(speed), Some(density), false) = (speed, aircraft.density, stands) {
        let pressure = 0.5 * density * speed * speed;
        // In steady flight the specific force along body z is one g. What is doubted itself is no witness against the mass.
        let doubted = found.iter().any(|doubt| doubt.channels.iter().any(|name| name == "az"));
        let force = contents.middle("az").filter(|_| !doubted).map_or(GRAVITY, |az| -az);
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
    doubts.extend(inertia(answers, aircraft));
    doubts
}

/// Whether the moments of inertia can be those of one body, and which of them somebody has said.
fn inertia(answers: &Answers, aircraft: &Aircraft) -> Option<String> {
    let [ixx, iyy, izz] = aircraft.inertia;
    let ratio = izz / (ixx + iyy);
    if !ratio.is_finite() || (FLAT[0]..=FLAT[1]).contains(&ratio) {
        return None;
    }
    let all = [("ixx", ixx, answers.ixx_kg_m2), ("iyy", iyy, answers.iyy_kg_m2), ("izz", izz, answers.izz_kg_m2)];
    let list = |said: bool| -> String {
        let chosen = all.iter().filter(|(.., answer)| answer.is_some() == said);
        chosen.map(|(name, value, _)| format!("{name} {value} kg m^2")).collect::<Vec<_>>().join(", ")
    };
    let (said, estimated) = (list(true), list(false));
    let shape =
        format!("izz would be {ratio:.2} times the sum of ixx and iyy, and 0.7 to 1 is expected of an aeroplane");
    Some(match (said.as_str(), estimated.as_str()) {
        ("", _) => {
            format!("the estimated moments of inertia do not belong to one body: {shape}: check span and length")
        }
        (_, "") => format!("the moments of inertia do not belong to one body: {shape}: is one in another unit?"),
        (said, estimated) => format!(
            "{said} does not suit what is estimated from mass, class and size ({estimated}): {shape}. Is what was said in \
             another unit, or has it a wrong digit?"
        ),
    })
}

/// What is doubtful about the units, signs and sensors of the channels that the model uses.
///
/// # Errors
/// [`DraftError::Units`] where an estimation from this record would be refused.
pub(super) fn of_record(record: &Record, model: &ModelFile) -> Result<Vec<Doubt>, DraftError> {
    checks::doubts(record, model).map_err(|error| match error {
        EstimateError::Units { units } => DraftError::Units { units },
        other => DraftError::Units { units: vec![other.to_string()] },
    })
}

/// A sentence for each channel that the model uses and of which no unit is written.
pub(super) fn assumed_units(contents: &Contents<'_>, record: &Record, model: &ModelFile) -> Vec<String> {
    let mut used = model.channels_used();
    // The reader makes the altitude of a pressure altitude where there is no other one.
    if used.contains(&"altitude") && contents.has("pressure_altitude") {
        used.push("pressure_altitude");
    }
    let assumed = record.quality.channels.iter().filter(|channel| channel.unit_assumed);
    let mut sentences = Vec::new();
    for channel in assumed.filter(|channel| used.contains(&channel.name.as_str())) {
        let Some([low, high]) = contents.ends(&channel.name) else { continue };
        let quantity = record.channel(&channel.name).map(|found| found.quantity);
        let degrees = match quantity {
            Some(Quantity::Angle) => format!(", which is {:.3} to {:.3} deg", low.to_degrees(), high.to_degrees()),
            Some(Quantity::AngularRate) => {
                format!(", which is {:.3} to {:.3} deg/s", low.to_degrees(), high.to_degrees())
            }
            _ => String::new(),
        };
        let unit = quantity.map_or("", Quantity::si_unit);
        sentences.push(format!(
            "column '{}' has no unit: {} is taken to go from {low:.4} to {high:.4} {unit}{degrees}. If that is not so, write the \
             unit into the header",
            channel.header, channel.name
        ));
    }
    sentences
}

/// Which of two is used where an answer and the record say the same, a sentence each.
pub(super) fn said_twice(contents: &Contents<'_>, answers: &Answers, axes: DraftedAxes) -> Vec<String> {
    let mut sentences = Vec::new();
    let known = match contents.density {
        Some(Density::Channel) => Some("the air density"),
        Some(Density::Altitude) => Some("the altitude"),
        Some(Density::Pressure(_)) => Some("dynamic pressure and true airspeed"),
        Some(Density::Static(_)) => Some("static pressure and temperature"),
        None => None,
    };
    if let (Some(altitude), Some(known)) = (answers.altitude_m, known) {
        sentences.push(format!(
            "the altitude of {altitude} m that was said is not used: the record has {known}, and the density of the air follows \
             from that"
        ));
    }
    let lateral = axes.has_lateral();
    let constants = [
        ("mass", answers.mass_kg, "kg", true),
        ("thrust", answers.thrust_n, "N", true),
        ("ixx", answers.ixx_kg_m2, "kg m^2", lateral),
        ("iyy", answers.iyy_kg_m2, "kg m^2", true),
        ("izz", answers.izz_kg_m2, "kg m^2", lateral),
    ];
    for (name, said, unit, written) in constants {
        if let (Some(said), Some(recorded), true) = (said, contents.middle(name), written) {
            let (said, recorded) = (rounded(said), rounded(recorded));
            sentences.push(format!(
                "{name} is the constant {said} {unit} that was said, and not what the record has (median {recorded} \
                 {unit}); leave the answer out to use the record"
            ));
        }
    }
    for surface in SURFACES.iter().filter(|surface| surface.travel(answers).is_some()) {
        let (name, command) = (surface.channels.name, surface.channels.command);
        if contents.is_recorded(name) {
            sentences.push(format!("the travel of the {name} that was said is not used: the record has its position"));
        } else if !contents.has(command) {
            sentences.push(format!("the travel of the {name} that was said is not used: the record has no {command}"));
        }
    }
    sentences
}
