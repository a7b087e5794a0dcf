//! What an FMU says of itself to people: `documentation/index.html` and the terms of use.

use std::fmt::Write as _;

use phugoid_aircraft::xml::escaped;
use phugoid_flight_dynamics::trim::Trim;

use crate::variables::{Direction, variables};

/// What a page differs in from one FMU to the next.
pub(crate) struct Page<'a> {
    pub(crate) name: &'a str,
    pub(crate) summary: &'a str,
    pub(crate) notes: &'a [String],
    pub(crate) files: &'a [String],
    pub(crate) licence: &'a str,
    pub(crate) trim: &'a Trim,
}

/// One sentence about an FMU.
pub(crate) fn summary(name: &str, trim: &Trim) -> String {
    format!(
        "{name}: rigid aircraft over a flat earth with its engine, in trim at {:.2} m/s and {:.1} m. Inputs are positions of \
         surfaces and throttle; SI units and radians; body axes x forward, y right, z down",
        trim.speed_m_s, trim.altitude_m
    )
}

const METHOD: &str = "<h2>How it works</h2>\n<p>Equations of motion of Stevens &amp; Lewis (Aircraft Control and Simulation, table \
2.5-1) with speed, angle of attack and sideslip as states, which are singular at zero speed and at 90 deg of pitch or sideslip. The \
surfaces are where the inputs put them: there are no actuators. In co-simulation the inputs are held over a communication step, \
which is divided into equal steps of the classical Runge-Kutta method of order four, none longer than the parameter \
<code>integration_step</code>. There are no events. Values that are not finite are refused with an error; a flight that leaves what \
the aircraft has data for is warned of once.</p>\n";

/// The page.
pub(crate) fn page(page: &Page<'_>) -> String {
    let Page { name, summary, notes, files, licence, trim } = page;
    let name = escaped(name);
    let mut text = format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head><meta charset=\"utf-8\"><title>{name}</title>\n\
         <style>body{{font:16px/1.5 sans-serif;max-width:60em;margin:2em auto;padding:0 1em}}\
         td,th{{text-align:left;padding:.2em 1em .2em 0;vertical-align:top}}</style></head>\n<body>\n<h1>{name}</h1>\n<p>{}.</p>\n",
        escaped(summary)
    );
    text.push_str("<h2>Start: the trim</h2>\n<table>\n");
    for (what, value, unit) in [
        ("angle of attack", trim.alpha_rad.to_degrees(), "deg"),
        ("pitch angle", trim.theta_rad.to_degrees(), "deg"),
        ("bank angle", trim.phi_rad.to_degrees(), "deg"),
        ("elevator", trim.elevator_rad.to_degrees(), "deg"),
        ("aileron", trim.aileron_rad.to_degrees(), "deg"),
        ("rudder", trim.rudder_rad.to_degrees(), "deg"),
        ("throttle", trim.throttle, ""),
        ("thrust", trim.thrust_n, "N"),
    ] {
        // Writing to a string cannot fail, here and below.
        let _ = writeln!(text, "<tr><td>{what}</td><td>{value:.4} {unit}</td></tr>");
    }
    let _ = write!(text, "</table>\n{METHOD}");
    list(&mut text, "What is left out and what is assumed", notes);
    if !notes.is_empty() {
        text.push_str("<p>What these notes say of lags and limits of surfaces is of their actuators, which this FMU does not have.</p>\n");
    }
    text.push_str("<h2>Inputs, parameters and outputs</h2>\n<table>\n");
    for variable in variables() {
        let kind = match variable.direction() {
            Direction::Input => "input",
            Direction::Parameter => "parameter",
            Direction::Output => "output",
            Direction::Independent | Direction::Local => continue,
        };
        let (name, description) = (escaped(&variable.name), escaped(&variable.description));
        let _ = writeln!(text, "<tr><td><code>{name}</code></td><td>{kind}</td><td>{description}</td></tr>");
    }
    text.push_str("</table>\n");
    list(&mut text, "Files of the aircraft in this FMU", files);
    let _ = write!(text, "<h2>Terms of use</h2>\n<p>{}</p>\n</body>\n</html>\n", escaped(licence));
    text
}

fn list(text: &mut String, title: &str, items: &[String]) {
    if items.is_empty() {
        return;
    }
    let _ = write!(text, "<h2>{title}</h2>\n<ul>\n");
    for item in items {
        let _ = writeln!(text, "<li>{}</li>", escaped(item));
    }
    text.push_str("</ul>\n");
}

/// The terms of use as text, with those of Phugoid in full.
pub(crate) fn licence_text(licence: &str) -> String {
    let [mit, apache] = [include_str!("../../../LICENSE-MIT"), include_str!("../../../LICENSE-APACHE")];
    format!("{licence}\n\n----\n\n{mit}\n----\n\n{apache}")
}
