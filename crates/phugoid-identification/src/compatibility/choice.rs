//! Which unknowns are estimated: by groups, by name, or held at a value.

use phugoid_flight_data::quantity::Dimension;
use serde::{Deserialize, Serialize};

use super::kinematics::{PARAMETERS, place};
use super::signals::Flight;
use super::unknowns::{Group, Spec, UNKNOWNS};
use super::{CompatibilityOptions, moves};
use crate::core::error::EstimateError;
use crate::core::words::nearest;

/// An error of a sensor that is known beforehand, from a calibration for example. It is not estimated, and it is taken out
/// of the record with the corrections.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct HeldError {
    /// Name of the unknown, e.g. `bias_q`.
    pub name: String,
    /// Its value, in the SI unit of the unknown.
    pub value: f64,
    /// SI unit, `-` for a pure number. It is not read, but follows from the name.
    #[serde(default)]
    pub unit: String,
}

impl HeldError {
    /// Reads `NAME=VALUE`, the value with its unit: `bias_q=0.06deg/s`, `scale_alpha=3%`, `delay_alpha=40ms`.
    ///
    /// ```
    /// use phugoid_identification::compatibility::HeldError;
    /// let held = HeldError::parse("bias_alpha=0.5deg")?;
    /// assert_eq!((held.name.as_str(), held.unit.as_str()), ("bias_alpha", "rad"));
    /// assert!((held.value - 0.5_f64.to_radians()).abs() < 1e-15);
    /// assert!(HeldError::parse("bias_alhpa=0.5deg").unwrap_err().contains("did you mean `bias_alpha`?"));
    /// # Ok::<(), String>(())
    /// ```
    ///
    /// # Errors
    /// A sentence: no `=`, an unknown name with the nearest right one, a value without a unit or of another quantity, or one
    /// that no sensor can have.
    pub fn parse(text: &str) -> Result<Self, String> {
        let (name, value) = text
            .split_once('=')
            .ok_or_else(|| format!("`{text}` has no value: write a name and a value, as in bias_q=0.06deg/s"))?;
        let place = find(name.trim())?;
        let spec = &UNKNOWNS[place];
        let value = dimension(spec).parse(value).map_err(|error| format!("{}: {error}", spec.name))?;
        let held = Self { name: spec.name.to_owned(), value, unit: spec.unit.to_owned() };
        possible(spec, value)?;
        Ok(held)
    }
}

fn dimension(spec: &Spec) -> Dimension {
    match spec.unit {
        "m/s^2" => Dimension::ACCELERATION,
        "rad/s" => Dimension::ANGULAR_RATE,
        "m/s" => Dimension::SPEED,
        "rad" => Dimension::ANGLE,
        "s" => Dimension::TIME,
        "m" => Dimension::LENGTH,
        _ => Dimension::NUMBER,
    }
}

fn possible(spec: &Spec, value: f64) -> Result<(), String> {
    let [least, most] = spec.possible;
    if (least..=most).contains(&value) {
        return Ok(());
    }
    let unit = if spec.unit == "-" { String::new() } else { format!(" {}", spec.unit) };
    Err(format!(
        "{} cannot be {value}{unit}: no sensor has less than {least}{unit} or more than {most}{unit}",
        spec.name
    ))
}

/// Names of the unknowns that can be estimated, in the order of the results; which of them a flight can show follows from
/// its channels.
///
/// ```
/// use phugoid_identification::compatibility::unknown_names;
/// assert!(unknown_names().any(|name| name == "scale_true_airspeed"));
/// ```
pub fn unknown_names() -> impl Iterator<Item = &'static str> {
    UNKNOWNS.iter().filter(|spec| spec.group.is_some()).map(|spec| spec.name)
}

/// The place of the unknown with this name.
fn find(name: &str) -> Result<usize, String> {
    let found = UNKNOWNS.iter().position(|spec| spec.name == name && spec.group.is_some());
    found.ok_or_else(|| {
        let hint = match nearest(name, unknown_names()) {
            Some(near) => format!("did you mean `{near}`?"),
            None => format!("there are {}", unknown_names().collect::<Vec<_>>().join(", ")),
        };
        format!("there is no error of a sensor `{name}`: {hint}")
    })
}

/// What is asked for, by place.
pub(super) struct Choice {
    /// Whether each unknown is estimated where the flights can show it.
    pub(super) estimated: [bool; PARAMETERS],
    /// Values of what is not estimated.
    pub(super) fixed: [f64; PARAMETERS],
    /// Errors that are known.
    pub(super) held: Vec<HeldError>,
    /// Remarks, in sentences.
    pub(super) notes: Vec<String>,
}

impl Choice {
    /// From the options.
    ///
    /// # Errors
    /// [`EstimateError::Model`]: an unknown name with the nearest right one, an unknown that is both asked for and left out
    /// or held, one that no flight can show, or a value that no sensor can have.
    pub(super) fn of(options: &CompatibilityOptions, flights: &[Flight]) -> Result<Self, EstimateError> {
        let wrong = |why: String| EstimateError::Model(format!("data compatibility: {why}"));
        let places = |names: &[String]| {
            names.iter().map(|name| find(name)).collect::<Result<Vec<usize>, String>>().map_err(wrong)
        };
        let mut notes = Vec::new();
        let mut estimated: [bool; PARAMETERS] = std::array::from_fn(|place| {
            let group = UNKNOWNS[place].group;
            group.is_none_or(|group| group == Group::Biases || options.groups.contains(&group))
        });
        let without = places(&options.without)?;
        if let Some(names) = &options.unknowns {
            let only = places(names)?;
            if only.is_empty() {
                return Err(wrong(format!(
                    "no unknown is named that is to be estimated: there are {}",
                    unknown_names().collect::<Vec<_>>().join(", ")
                )));
            }
            if let Some(place) = only.iter().find(|place| without.contains(place)) {
                return Err(wrong(format!("{} is asked for and left out: name it once", UNKNOWNS[*place].name)));
            }
            for &place in &only {
                shown_by_some(place, flights).map_err(wrong)?;
            }
            estimated = std::array::from_fn(|place| UNKNOWNS[place].group.is_none() || only.contains(&place));
        }
        for place in without {
            if !estimated[place] {
                let spec = &UNKNOWNS[place];
                notes.push(format!(
                    "{} is left out, and would not have been estimated without being asked for",
                    spec.name
                ));
            }
            estimated[place] = false;
        }
        let mut fixed = [0.0; PARAMETERS];
        let mut held: Vec<HeldError> = Vec::with_capacity(options.held.len());
        for known in &options.held {
            let place = find(&known.name).map_err(wrong)?;
            let spec = &UNKNOWNS[place];
            if !known.value.is_finite() {
                return Err(wrong(format!("{} is held at {}, which is no number", spec.name, known.value)));
            }
            possible(spec, known.value).map_err(wrong)?;
            if held.iter().any(|other| other.name == spec.name) {
                return Err(wrong(format!("{} is held twice: name it once", spec.name)));
            }
            if options.unknowns.as_ref().is_some_and(|names| names.iter().any(|name| name == spec.name)) {
                return Err(wrong(format!("{} is asked for and held: an unknown is either", spec.name)));
            }
            if spec.group == Some(Group::Wind) && flights.len() > 1 {
                return Err(wrong(format!(
                    "{} belongs to each of the flights: it cannot be held for several",
                    spec.name
                )));
            }
            shown_by_some(place, flights).map_err(wrong)?;
            estimated[place] = false;
            fixed[place] = known.value;
            held.push(HeldError { unit: spec.unit.to_owned(), ..known.clone() });
        }
        for (place, known) in [place::VANE_ALPHA, place::VANE_BETA].into_iter().zip(options.vanes_x) {
            let is_held = held.iter().any(|held| held.name == UNKNOWNS[place].name);
            if is_held && known != 0.0 {
                return Err(wrong(format!(
                    "the position of the vane is given twice, as {known} m and as {}: give it once",
                    UNKNOWNS[place].name
                )));
            }
            if !estimated[place] && !is_held {
                fixed[place] = known;
            }
        }
        Ok(Self { estimated, fixed, held, notes })
    }
}

/// Checks that a flight has what an unknown needs.
fn shown_by_some(place: usize, flights: &[Flight]) -> Result<(), String> {
    let spec = &UNKNOWNS[place];
    if flights.iter().any(|flight| moves(spec, flight) && flight.has(spec.channel)) {
        return Ok(());
    }
    let needed = needs(spec);
    let missing: Vec<&str> =
        needed.iter().copied().filter(|name| !flights.iter().any(|flight| flight.has(name))).collect();
    let several = if flights.len() > 1 { "no flight has" } else { "the record does not have" };
    Err(match missing.as_slice() {
        [] => format!("{} needs {} in one record, and they are in different ones", spec.name, needed.join(", ")),
        missing => format!("{} cannot be estimated: {several} {}", spec.name, missing.join(", ")),
    })
}

/// The channels that a record must have for an unknown to show.
fn needs(spec: &Spec) -> Vec<&'static str> {
    let further: &[&'static str] = match spec.name {
        "bias_p" | "bias_r" | "scale_p" | "scale_r" | "bias_phi" | "scale_phi" => &["phi", "p", "r"],
        "bias_ay" | "scale_ay" | "bias_beta" | "scale_beta" | "delay_beta" | "vane_beta_x" => {
            &["beta", "ay", "phi", "p", "r"]
        }
        "bias_psi" => &["psi", "phi", "p", "r"],
        "wind_north" | "wind_east" | "wind_down" => &["north", "east", "altitude", "psi", "phi", "p", "r"],
        _ => &[],
    };
    let mut needed = vec![spec.channel];
    needed.extend(further.iter().copied().filter(|name| *name != spec.channel));
    needed
}

#[cfg(test)]
mod tests {
    use phugoid_flight_data::record::Record;

    use super::*;
    use crate::compatibility::{Compatibility, compatibility};

    fn flight() -> Record {
        Record::open("examples/flight.csv").unwrap()
    }

    fn names(result: &Compatibility) -> Vec<&str> {
        result.errors.iter().map(|error| error.name.as_str()).collect()
    }

    fn words(list: &[&str]) -> Vec<String> {
        list.iter().map(|name| (*name).to_owned()).collect()
    }

    #[test]
    fn only_what_is_named_is_estimated_and_nothing_that_is_left_out() {
        let only = CompatibilityOptions {
            unknowns: Some(words(&["scale_alpha", "bias_az", "bias_q"])),
            ..CompatibilityOptions::default()
        };
        assert_eq!(names(&compatibility(&flight(), &only).unwrap()), ["bias_az", "bias_q", "scale_alpha"]);
        let groups = CompatibilityOptions { groups: vec![Group::AttitudeScales], ..CompatibilityOptions::default() };
        let all = compatibility(&flight(), &groups).unwrap();
        assert!(names(&all).contains(&"scale_theta"), "{:?}", names(&all));
        let without = CompatibilityOptions { without: words(&["scale_theta", "scale_q"]), ..groups };
        let result = compatibility(&flight(), &without).unwrap();
        let rest: Vec<&str> = names(&all).into_iter().filter(|name| *name != "scale_theta").collect();
        assert_eq!(names(&result), rest);
        assert!(result.notes.iter().any(|note| note.starts_with("scale_q is left out")), "{:?}", result.notes);
    }

    /// A gyroscope with a known bias, which is held, gives what the flight without the bias gives without that unknown.
    #[test]
    fn a_held_error_is_taken_out_and_leaves_the_others_as_they_were() {
        let mut shifted = flight();
        for channel in shifted.channels.iter_mut().filter(|channel| channel.name == "q") {
            channel.values.iter_mut().for_each(|q| *q += 0.01);
        }
        let base = CompatibilityOptions { groups: Vec::new(), ..CompatibilityOptions::default() };
        let held = CompatibilityOptions { held: vec![HeldError::parse("bias_q=0.01 rad/s").unwrap()], ..base.clone() };
        let with = compatibility(&shifted, &held).unwrap();
        let without = compatibility(&flight(), &CompatibilityOptions { without: words(&["bias_q"]), ..base }).unwrap();
        assert_eq!(names(&with), names(&without));
        for (a, b) in with.errors.iter().zip(&without.errors) {
            // The searches end within a twentieth of a standard error of their minimum.
            assert!((a.value - b.value).abs() < 0.05 * b.std_error, "{}: {} {}", a.name, a.value, b.value);
        }
        assert_eq!(
            (with.held[0].name.as_str(), with.held[0].value, with.held[0].unit.as_str()),
            ("bias_q", 0.01, "rad/s")
        );
        assert!((with.corrections.channels["q"].bias - 0.01).abs() < 1e-15, "{:?}", with.corrections);
        let corrected = with.corrections.apply(&shifted);
        let (q, truth) = (&corrected.channel("q").unwrap().values, flight());
        assert!(q.iter().zip(&truth.channel("q").unwrap().values).all(|(a, b)| (a - b).abs() < 1e-12));
    }

    /// Corrections are set one after the other, and what was set before stays.
    #[test]
    fn a_held_bias_stays_where_a_scale_of_the_same_sensor_moves() {
        let mut corrections = crate::compatibility::Corrections::default();
        corrections.set(&[("bias_q", 0.01), ("scale_q", 0.02), ("bias_alpha", 0.03), ("scale_alpha", 0.1)]);
        let whole = corrections.clone();
        let mut moved = corrections.clone();
        moved.set(&[("scale_q", 0.03), ("scale_alpha", 0.2)]);
        // True = (1 - scale) measured - bias of the gyroscope.
        let q = moved.channels["q"];
        let truth = |c: &crate::compatibility::ChannelCorrection, measured: f64| (measured - c.bias) / (1.0 + c.scale);
        assert!((truth(&q, 0.5) - (0.97 * 0.5 - 0.01)).abs() < 1e-12, "{q:?}");
        assert_eq!((moved.channels["alpha"].bias, moved.channels["alpha"].scale), (0.03, 0.2));
        moved.set(&[("scale_q", 0.02), ("scale_alpha", 0.1)]);
        assert!((moved.channels["q"].bias - whole.channels["q"].bias).abs() < 1e-15);
    }

    #[test]
    fn what_is_wrong_is_named_with_what_would_be_right() {
        let held = |text: &str| vec![HeldError::parse(text).unwrap()];
        let options = CompatibilityOptions::default;
        let cases = [
            (
                CompatibilityOptions { unknowns: Some(words(&["bias_alhpa"])), ..options() },
                "did you mean `bias_alpha`?",
            ),
            (CompatibilityOptions { without: words(&["xyz"]), ..options() }, "there are bias_ax, bias_ay"),
            (CompatibilityOptions { without: words(&["gravity"]), ..options() }, "no error of a sensor `gravity`"),
            (CompatibilityOptions { unknowns: Some(Vec::new()), ..options() }, "no unknown is named"),
            (
                CompatibilityOptions { unknowns: Some(words(&["bias_beta"])), ..options() },
                "bias_beta cannot be estimated: the record does not have beta, ay, phi, p, r",
            ),
            (
                CompatibilityOptions { unknowns: Some(words(&["bias_q"])), without: words(&["bias_q"]), ..options() },
                "bias_q is asked for and left out",
            ),
            (
                CompatibilityOptions { unknowns: Some(words(&["bias_q"])), held: held("bias_q=0rad/s"), ..options() },
                "bias_q is asked for and held",
            ),
            (
                CompatibilityOptions { held: [held("bias_q=0rad/s"), held("bias_q=0rad/s")].concat(), ..options() },
                "held twice",
            ),
            (CompatibilityOptions { held: held("bias_r=0rad/s"), ..options() }, "does not have r, phi, p"),
            (
                CompatibilityOptions { held: held("vane_alpha_x=1m"), vanes_x: [2.0, 0.0], ..options() },
                "the position of the vane is given twice",
            ),
        ];
        for (options, words) in cases {
            let error = compatibility(&flight(), &options).expect_err(words).to_string();
            assert!(error.contains(words), "{words}: {error}");
        }
        for (text, words) in [
            ("bias_q", "has no value"),
            ("bias_q=0.1", "has no unit"),
            ("bias_q=0.1m", "bias_q: "),
            ("scale_alpha=0.9", "scale_alpha cannot be 0.9: no sensor has less than -0.5 or more than 0.5"),
            ("delay_alpha=2s", "delay_alpha cannot be 2 s"),
        ] {
            let error = HeldError::parse(text).expect_err(text);
            assert!(error.contains(words), "{text}: {error}");
        }
        assert!((HeldError::parse("scale_alpha=3%").unwrap().value - 0.03).abs() < 1e-15);
    }
}
