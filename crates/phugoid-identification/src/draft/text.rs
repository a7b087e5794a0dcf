//! Writes the model file of a draft.

use std::fmt::Write as _;

use phugoid_flight_dynamics::atmosphere::Atmosphere;

use super::answers::{Answers, DraftedAxes};
use super::command::Surface;
use super::contents::{Contents, Density};

/// Density at sea level of the standard atmosphere, kg/m^3.
const SEA_LEVEL: f64 = phugoid_flight_data::airspeed::SEA_LEVEL_DENSITY;
/// Standard acceleration of gravity, m/s^2.
pub(super) const GRAVITY: f64 = 9.806_65;
/// One sigma of moments of inertia that were estimated by class and size: radii of gyration of one class scatter by about 15 %
/// (the tables of Raymer and Roskam), moments by twice that.
const ESTIMATED_INERTIA: f64 = 0.3;
/// Largest estimated izz over the sum of ixx and iyy: aeroplanes are nearly flat.
const FLATTEST: f64 = 0.97;
/// One sigma of a thrust that was taken from a typical ratio of lift to drag.
const ESTIMATED_THRUST: f64 = 0.4;
/// From this part of the airspeed on, its change over the record asks for terms in the airspeed.
const SPEED_CHANGES: f64 = 0.05;

/// Up to this step of the record CL has terms of pitch rate and elevator, s. They are small, and on a slower record they take
/// the lags of the sensors for themselves (of the HFB-320 at 10 Hz a CL_q of 90 comes out) and bend the moments with them.
const FAST: f64 = 0.05;
/// From this range of the angle of attack on, rad, the drag has a term in its square: over 4 deg it is 4 % of the drag of an
/// aircraft whose CD grows by 2 per rad^2.
const BENT: f64 = 0.07;

/// The numbers that the file has, SI.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Aircraft {
    pub(super) mass: Option<f64>,
    pub(super) area: f64,
    pub(super) span: f64,
    pub(super) chord: f64,
    pub(super) density: Option<f64>,
    pub(super) thrust: Option<f64>,
    pub(super) inertia: [f64; 3],
}

pub(super) struct Writer<'a> {
    contents: &'a Contents<'a>,
    answers: &'a Answers,
    axes: DraftedAxes,
    /// Surfaces whose commands stand for their positions.
    commanded: &'a [&'static Surface],
    aircraft: Aircraft,
    assumed: Vec<String>,
    estimated_inertia: bool,
    estimated_thrust: bool,
    text: String,
}

impl<'a> Writer<'a> {
    pub(super) fn new(
        contents: &'a Contents<'a>,
        answers: &'a Answers,
        axes: DraftedAxes,
        commanded: &'a [&'static Surface],
    ) -> Self {
        Self {
            contents,
            answers,
            axes,
            commanded,
            aircraft: Aircraft::default(),
            assumed: Vec::new(),
            estimated_inertia: false,
            estimated_thrust: false,
            text: String::new(),
        }
    }

    /// Something that nobody said.
    pub(super) fn assume(&mut self, what: impl Into<String>) {
        self.assumed.push(what.into());
    }

    fn line(&mut self, line: &str) {
        self.text.push_str(line);
        self.text.push('\n');
    }

    /// A key with a value and a comment behind it.
    fn put(&mut self, key: &str, value: &str, comment: &str) {
        let line = format!("{key} = {value}");
        // Writing to a string cannot fail.
        let _ = match comment {
            "" => writeln!(self.text, "{line}"),
            comment => writeln!(self.text, "{line:<45} # {comment}"),
        };
    }

    pub(super) fn finish(mut self) -> (String, Aircraft, Vec<String>) {
        self.head();
        self.aircraft();
        self.coefficients();
        self.uncertainty();
        self.channels();
        (self.text, self.aircraft, self.assumed)
    }

    fn head(&mut self) {
        let class = self.answers.class.word();
        self.line(&format!(
            "# Begun by `phugoid init` (class {class}). Plain numbers are SI, angles are radians; numbers with units"
        ));
        self.line(
            "# stand in quotes. Whatever is marked `assumed` was not said by anybody: put your own number there.",
        );
        let name = self.answers.name.clone().unwrap_or_else(|| format!("my {class}"));
        self.put("name", &toml::Value::String(name).to_string(), "");
        let axes = match self.axes {
            DraftedAxes::Longitudinal => r#"["longitudinal"]"#,
            DraftedAxes::Lateral => r#"["lateral"]"#,
            DraftedAxes::Both => r#"["longitudinal", "lateral"]"#,
        };
        self.put("axes", axes, "");
        self.put("input", r#""auto""#, "surfaces held, in straight lines or late: found from each record");
        let mut outputs = Vec::new();
        let (longitudinal, lateral) = (self.axes.has_longitudinal(), self.axes.has_lateral());
        for (name, of_axes) in [
            ("true_airspeed", longitudinal),
            ("alpha", longitudinal),
            ("beta", lateral),
            ("phi", lateral),
            ("theta", longitudinal),
            ("p", lateral),
            ("q", longitudinal),
            ("r", lateral),
            ("ax", longitudinal),
            ("ay", lateral),
            ("az", longitudinal),
        ] {
            if of_axes && (self.contents.has(name) || name == "true_airspeed") {
                outputs.push(format!("\"{name}\""));
            }
        }
        self.put("outputs", &format!("[{}]", outputs.join(", ")), "what this record has");
        for (vane, wanted) in [("alpha", longitudinal), ("beta", lateral)] {
            if wanted && !self.contents.has(vane) {
                self.assume(format!("{vane} was not recorded: it starts from nearly level, straight flight, and its derivatives will be poor"));
            }
        }
        for (force, wanted) in [("ax", longitudinal), ("az", longitudinal), ("ay", lateral)] {
            if wanted && !self.contents.has(force) {
                self.assume(format!(
                    "{force} was not recorded: the coefficient of that force is found from motion alone"
                ));
            }
        }
        self.line("");
    }

    fn aircraft(&mut self) {
        self.line("[aircraft]");
        let answers = self.answers;
        match answers.mass_kg {
            Some(mass) => {
                self.aircraft.mass = Some(mass);
                self.put("mass", &quantity(mass, "kg"), "");
            }
            None => {
                self.aircraft.mass = self.contents.middle("mass");
                self.put("mass", r#"{ channel = "mass" }"#, "recorded");
            }
        }
        let area = answers.wing_area_m2.unwrap_or(f64::NAN);
        let span = answers.wing_span_m.unwrap_or(f64::NAN);
        let chord = answers.mean_chord_m.unwrap_or_else(|| rounded(area / span));
        (self.aircraft.area, self.aircraft.span, self.aircraft.chord) = (area, span, chord);
        self.inertia();
        self.put("wing_area", &quantity(area, "m^2"), "");
        self.put("wing_span", &quantity(span, "m"), "");
        if answers.mean_chord_m.is_none() {
            self.put("mean_chord", &format!("\"{chord} m\""), "assumed: area over span");
            self.assume(format!("mean_chord {chord} m: area over span (of a tapered wing a few per cent too small)"));
        } else {
            self.put("mean_chord", &quantity(chord, "m"), "");
        }
        self.density();
        if self.axes.has_longitudinal() || self.contents.has("thrust") || self.answers.thrust_n.is_some() {
            self.thrust();
        }
        if let Some(speed) = self.contents.middle("true_airspeed").filter(|_| self.varies()) {
            self.put("reference_speed", &format!("\"{} m/s\"", rounded(speed)), "the median of the record");
        }
        self.line("");
    }

    /// Whether the speed changes so much that coefficients have terms in it.
    fn varies(&self) -> bool {
        self.axes.has_longitudinal()
            && self.contents.spread("true_airspeed").is_some_and(|spread| spread > SPEED_CHANGES)
    }

    fn inertia(&mut self) {
        let (answers, typical) = (self.answers, self.answers.class.typical());
        let length = answers.length_m.unwrap_or(typical.length_over_span * self.aircraft.span);
        let mass = self.aircraft.mass.unwrap_or(f64::NAN);
        let lengths = [self.aircraft.span, length, 0.5 * (self.aircraft.span + length)];
        let given = [("ixx", answers.ixx_kg_m2), ("iyy", answers.iyy_kg_m2), ("izz", answers.izz_kg_m2)];
        for (axis, (name, said)) in given.into_iter().enumerate() {
            // Raymer's dimensionless radius of gyration: twice the radius over the length.
            let radius = 0.5 * typical.radii[axis] * lengths[axis];
            let mut estimate = mass * radius * radius;
            if axis == 2 {
                // No body has an izz above the sum of the others.
                estimate = estimate.min(FLATTEST * (self.aircraft.inertia[0] + self.aircraft.inertia[1]));
            }
            let estimate = rounded(estimate);
            self.aircraft.inertia[axis] = said.unwrap_or(estimate);
            if name != "iyy" && !self.axes.has_lateral() {
                continue;
            }
            if let Some(said) = said {
                self.put(name, &quantity(said, "kg*m^2"), "");
            } else if self.contents.has(name) {
                self.put(name, &format!("{{ channel = \"{name}\" }}"), "recorded");
            } else {
                self.estimated_inertia = true;
                self.put(name, &format!("\"{estimate} kg*m^2\""), "assumed: radius of gyration of the class");
                self.assume(format!(
                    "{name} {estimate} kg m^2, from the radius of gyration that is typical of the class (one sigma 30 %, which is \
                     in the bounds of moments): measure it, or say it with --{name}"
                ));
            }
        }
        if self.axes.has_lateral() {
            match answers.ixz_kg_m2 {
                Some(ixz) => self.put("ixz", &quantity(ixz, "kg*m^2"), ""),
                None => {
                    self.put("ixz", "0", "assumed: not known");
                    self.assume("ixz 0, and no error of it is in the bounds: say it with --ixz");
                }
            }
        }
    }

    fn density(&mut self) {
        match self.contents.density {
            Some(Density::Channel) => {
                self.aircraft.density = self.contents.middle("air_density");
                self.put("air_density", r#"{ channel = "air_density" }"#, "recorded");
            }
            Some(Density::Altitude) => {
                self.aircraft.density = self.contents.middle("altitude").map(|h| Atmosphere::Standard.at(h).density);
                self.put("air_density", r#""standard_atmosphere""#, "at the recorded altitude");
            }
            Some(Density::Pressure(density)) => {
                self.constant_density(density, "from dynamic pressure and true airspeed")
            }
            Some(Density::Static(density)) => self.constant_density(density, "from static pressure and temperature"),
            None => {
                let altitude = self.answers.altitude_m.unwrap_or_default();
                let density = Atmosphere::Standard.at(altitude).density;
                self.constant_density(density, &format!("standard atmosphere at {altitude} m"));
            }
        }
    }

    fn constant_density(&mut self, density: f64, comment: &str) {
        self.aircraft.density = Some(density);
        self.put("air_density", &format!("\"{} kg/m^3\"", rounded(density)), comment);
    }

    fn thrust(&mut self) {
        if let Some(thrust) = self.answers.thrust_n {
            self.aircraft.thrust = Some(thrust);
            return self.put("thrust", &quantity(thrust, "N"), "constant");
        }
        if self.contents.has("thrust") {
            self.aircraft.thrust = self.contents.middle("thrust");
            return self.put("thrust", r#"{ channel = "thrust" }"#, "recorded");
        }
        if self.answers.class == super::AircraftClass::Glider {
            self.aircraft.thrust = Some(0.0);
            return self.put("thrust", "0", "a glider");
        }
        self.estimated_thrust = true;
        let weight = self.aircraft.mass.unwrap_or(f64::NAN) * GRAVITY;
        let thrust = rounded(weight / self.answers.class.typical().lift_over_drag);
        self.aircraft.thrust = Some(thrust);
        self.put("thrust", &quantity(thrust, "N"), "assumed: the drag of level flight, typical of the class");
        self.assume(format!(
            "thrust {thrust} N, constant, from a typical ratio of lift to drag (one sigma 40 %, which is in the bounds of the \
             drag): record it, or say it with --thrust"
        ));
    }

    fn coefficients(&mut self) {
        let typical = self.answers.class.typical();
        let [cm_alpha, cm_q, cm_elevator] = typical.pitch;
        let aspect = self.aircraft.span.powi(2) / self.aircraft.area;
        // Slope of lift of a straight wing by Helmbold's equation.
        let slope = rounded(2.0 * std::f64::consts::PI * aspect / (2.0 + (4.0 + aspect * aspect).sqrt()));
        let mut rows: Vec<(&str, Vec<Term>)> = Vec::new();
        if self.axes.has_longitudinal() {
            let mut lift = vec![("1", "0", 0.3, 0.6), ("alpha", "alpha", slope, 2.5)];
            if self.contents.sample_time() <= FAST {
                lift.extend([("q_hat", "q", 5.0, 20.0), ("elevator", "elevator", 0.4, 0.6)]);
            }
            rows.push(("CL", lift));
            let mut drag = vec![("1", "0", 0.03, 0.1), ("alpha", "alpha", 0.1, 0.7)];
            if self.contents.range("alpha").is_some_and(|range| range >= BENT) {
                drag.push(("alpha^2", "alpha2", 1.0, 5.0));
            }
            rows.push(("CD", drag));
            rows.push((
                "Cm",
                vec![
                    ("1", "0", 0.0, 0.15),
                    ("alpha", "alpha", cm_alpha, 1.5),
                    ("q_hat", "q", cm_q, 30.0),
                    ("elevator", "elevator", cm_elevator, 1.5),
                ],
            ));
            if self.varies() {
                for ((_, terms), prior) in rows.iter_mut().zip([1.0, 0.2, 0.2]) {
                    terms.push(("v_hat", "V", 0.0, prior));
                }
            }
        }
        if self.axes.has_lateral() {
            let surface = |name: &'static str, start, prior| -> Option<Term> {
                self.contents.has(name).then_some((name, name, start, prior))
            };
            let base = |terms: [Term; 4], surfaces: [Option<Term>; 2]| -> Vec<Term> {
                terms.into_iter().chain(surfaces.into_iter().flatten()).collect()
            };
            rows.push((
                "CY",
                base(
                    [
                        ("1", "0", 0.0, 0.05),
                        ("beta", "beta", -0.6, 0.8),
                        ("p_hat", "p", 0.0, 0.5),
                        ("r_hat", "r", 0.2, 0.8),
                    ],
                    [surface("rudder", 0.15, 0.3), None],
                ),
            ));
            rows.push((
                "Cl",
                base(
                    [
                        ("1", "0", 0.0, 0.01),
                        ("beta", "beta", -0.08, 0.15),
                        ("p_hat", "p", -0.45, 0.5),
                        ("r_hat", "r", 0.1, 0.3),
                    ],
                    [surface("aileron", -0.15, 0.2), surface("rudder", 0.01, 0.05)],
                ),
            ));
            rows.push((
                "Cn",
                base(
                    [
                        ("1", "0", 0.0, 0.01),
                        ("beta", "beta", 0.1, 0.15),
                        ("p_hat", "p", -0.03, 0.2),
                        ("r_hat", "r", -0.15, 0.3),
                    ],
                    [surface("aileron", 0.0, 0.05), surface("rudder", -0.07, 0.1)],
                ),
            ));
        }
        self.line("# The usual terms. What they lack is found from the flight and offered beside the result.");
        self.line("[coefficients]");
        for (name, terms) in &rows {
            let terms: Vec<String> = terms.iter().map(|(term, ..)| format!("\"{term}\"")).collect();
            self.put(name, &format!("[{}]", terms.join(", ")), "");
        }
        self.line("");
        self.line("# Textbook values of the class to start from, and one sigma of what is known beforehand: wide, the data decide.");
        self.line("[parameters]");
        for (coefficient, terms) in rows {
            for (_, name, start, prior) in terms {
                let (key, value) =
                    (format!("{coefficient}_{name}"), format!("{{ start = {start}, prior_std = {prior} }}"));
                self.put(&key, &value, "");
            }
        }
        self.line("");
    }

    fn uncertainty(&mut self) {
        let typical = self.answers.class.typical();
        self.line("# Errors that leave no trace in a flight; `phugoid estimate --model FILE --show-uncertainty` prints all of them.");
        self.line("[uncertainty]");
        let without_vane = typical.uncertainty == "unmanned" && !self.contents.has("alpha");
        let class = if without_vane { "unmanned-without-vane" } else { typical.uncertainty };
        self.put("class", &format!("\"{class}\""), "instruments and masses of this kind");
        if self.estimated_inertia {
            self.put("inertia", &ESTIMATED_INERTIA.to_string(), "assumed above, by class and size");
        }
        if self.estimated_thrust {
            self.put("thrust", &ESTIMATED_THRUST.to_string(), "assumed above, by class");
        }
    }

    /// What has to be made of other columns: a true airspeed of another one, and positions of surfaces of their commands.
    fn channels(&mut self) {
        let speed =
            self.contents.other_speed().and_then(|speed| Some((speed, self.contents.header(speed)?.to_owned())));
        if speed.is_none() && self.commanded.is_empty() {
            return;
        }
        self.line("");
        self.line("[channels]");
        if let Some((speed, header)) = speed {
            self.airspeed(speed, header);
        }
        if !self.commanded.is_empty() {
            self.line("# These are commands of the autopilot and not positions of the surfaces: how late the servos follow, and how");
            self.line("# far they come, is not in the record. `scale` is the angle at command 1, with the sign of the deflection.");
        }
        for surface in self.commanded {
            let degrees = digits(surface.travel(self.answers).unwrap_or(f64::NAN).to_degrees());
            let header = toml::Value::String(self.contents.header_of_command(surface).to_owned()).to_string();
            self.put(surface.channels.name, &format!("{{ header = {header}, scale = {degrees}, unit = \"deg\" }}"), "");
            self.assume(format!(
                "the {} stands at its command times {degrees} deg: the lag and the play of its servo are in no bound",
                surface.channels.name
            ));
        }
    }

    /// A true airspeed of another one, where only that was recorded.
    fn airspeed(&mut self, speed: &str, header: String) {
        let density = self.aircraft.density.unwrap_or(SEA_LEVEL);
        let factor = rounded((SEA_LEVEL / density).sqrt());
        let header = toml::Value::String(header).to_string();
        self.put(
            "true_airspeed",
            &format!("{{ header = {header}, scale = {factor} }}"),
            "assumed: its error of position is none",
        );
        self.assume(format!(
            "the true airspeed is {factor} times {speed}: the root of the density at sea level over that of the flight, without \
             corrections for position and compressibility"
        ));
    }
}

/// A term, the end of its parameter's name, its start value and one sigma of what is known beforehand.
type Term = (&'static str, &'static str, f64, f64);

/// A quantity as a model file writes it, to seven digits: what a conversion of units leaves behind them means nothing.
fn quantity(value: f64, unit: &str) -> String {
    format!("\"{} {unit}\"", digits(value))
}

/// Seven significant digits.
fn digits(value: f64) -> f64 {
    format!("{value:.6e}").parse().unwrap_or(value)
}

/// Four significant digits: more than anybody knows of what is estimated here.
pub(super) fn rounded(value: f64) -> f64 {
    format!("{value:.3e}").parse().unwrap_or(value)
}
