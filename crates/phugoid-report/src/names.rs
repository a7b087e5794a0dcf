//! Names of signals and parameters in figures, and the units in which they are shown.

/// A unit as it is printed, and the factor from SI to it.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct DisplayUnit {
    pub(crate) text: String,
    pub(crate) factor: f64,
}

/// The unit in which an SI quantity is shown: angles in degrees, all others as they are, with superscripts. The unit of
/// a pure number (`-`, `1` or nothing) is an en dash.
pub(crate) fn display_unit(si: &str) -> DisplayUnit {
    let factor = match si {
        "rad" | "rad/s" | "rad/s^2" => 180.0 / std::f64::consts::PI,
        _ => 1.0,
    };
    let text = match si.trim() {
        "" | "-" | "1" => "–".to_owned(),
        "rad" => "deg".to_owned(),
        "rad/s" => "deg/s".to_owned(),
        "rad/s^2" => "deg/s²".to_owned(),
        other => other.replace("^2", "²").replace("^3", "³").replace('*', "·"),
    };
    DisplayUnit { text, factor }
}

/// The words for a canonical channel name, as a heading; the name itself with a capital letter if there are none.
pub(crate) fn signal_label(name: &str) -> String {
    known_label(name).map_or_else(|| heading(name), str::to_owned)
}

/// The words for a canonical channel name, for a legend; the name itself with blanks if there are none.
pub(crate) fn legend_label(name: &str) -> String {
    known_label(name).map_or_else(|| name.replace('_', " "), str::to_owned)
}

/// The words for the channels that have words of their own.
fn known_label(name: &str) -> Option<&'static str> {
    Some(match name {
        "true_airspeed" => "True airspeed V",
        "alpha" => "Angle of attack α",
        "beta" => "Angle of sideslip β",
        "theta" => "Pitch attitude θ",
        "phi" => "Bank angle φ",
        "psi" => "Heading ψ",
        "flight_path_angle" => "Flight-path angle γ",
        "p" => "Roll rate p",
        "q" => "Pitch rate q",
        "r" => "Yaw rate r",
        "pdot" => "Roll acceleration dp/dt",
        "qdot" => "Pitch acceleration dq/dt",
        "rdot" => "Yaw acceleration dr/dt",
        "ax" => "Specific force ax, forward",
        "ay" => "Specific force ay, right",
        "az" => "Specific force az, down",
        "elevator" => "Elevator δe, trailing edge down",
        "aileron" => "Aileron δa",
        "rudder" => "Rudder δr",
        "throttle" => "Throttle",
        "thrust" => "Thrust",
        "altitude" => "Altitude",
        "mach" => "Mach number",
        "dynamic_pressure" => "Dynamic pressure",
        _ => return None,
    })
}

/// `air_density` as `Air density`. A single letter is a symbol and stays as it is.
fn heading(name: &str) -> String {
    let words = name.replace('_', " ");
    let mut characters = words.chars();
    match characters.next() {
        Some(first) if words.chars().nth(1).is_some_and(char::is_lowercase) => {
            first.to_uppercase().chain(characters).collect()
        }
        _ => words,
    }
}

/// The unit of a parameter, from its name. `bias_alpha` has the unit of its channel, which `unit_of_channel` gives in
/// SI. A derivative such as `Cm_alpha` or `CL_alpha_elevator` is per radian, once for each angle or normalised angular
/// rate that it multiplies. Everything else is a pure number.
pub(crate) fn parameter_unit(name: &str, unit_of_channel: impl Fn(&str) -> Option<String>) -> DisplayUnit {
    if let Some(unit) = name.strip_prefix("bias_").and_then(unit_of_channel) {
        return display_unit(&unit);
    }
    let pure = DisplayUnit { text: "–".to_owned(), factor: 1.0 };
    if name.starts_with("offset_") {
        return pure;
    }
    let Some((_, variables)) = name.split_once('_') else { return pure };
    let radians: u32 = variables
        .split('_')
        .map(|variable| {
            let base = variable.trim_end_matches(|c: char| c.is_ascii_digit());
            let power = variable[base.len()..].parse().unwrap_or(1);
            if is_angle(base.trim_end_matches('^')) { power } else { 0 }
        })
        .sum();
    match radians {
        0 => pure,
        1 => DisplayUnit { text: "1/rad".to_owned(), factor: 1.0 },
        2 => DisplayUnit { text: "1/rad²".to_owned(), factor: 1.0 },
        n => DisplayUnit { text: format!("1/rad{}", crate::ticks::superscript(n as i32)), factor: 1.0 },
    }
}

/// Whether a variable of a derivative is an angle or a normalised angular rate.
fn is_angle(variable: &str) -> bool {
    matches!(
        variable,
        "alpha"
            | "alphadot"
            | "beta"
            | "betadot"
            | "p"
            | "q"
            | "r"
            | "elevator"
            | "de"
            | "aileron"
            | "da"
            | "rudder"
            | "dr"
            | "stabilator"
            | "canard"
            | "flap"
            | "flaps"
            | "spoiler"
            | "tail"
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parameters_have_the_unit_of_what_they_multiply() {
        let channel = |name: &str| (name == "alpha").then(|| "rad".to_owned());
        for (name, unit) in [
            ("Cm_alpha", "1/rad"),
            ("dCm_q", "1/rad"),
            ("CL_0", "–"),
            ("CD_V", "–"),
            ("CD_alpha2", "1/rad²"),
            ("Cm_alpha_elevator", "1/rad²"),
            ("offset_Cm", "–"),
            ("bias_alpha", "deg"),
            ("bias_unknown", "–"),
            ("mystery", "–"),
        ] {
            assert_eq!(parameter_unit(name, channel).text, unit, "{name}");
        }
        assert_eq!(signal_label("air_density"), "Air density");
        assert_eq!((signal_label("u"), signal_label("")), ("u".to_owned(), String::new()));
        assert!((display_unit("rad/s").factor - 57.295_779_513).abs() < 1e-6);
        assert_eq!(display_unit("m/s^2"), DisplayUnit { text: "m/s²".into(), factor: 1.0 });
    }
}
