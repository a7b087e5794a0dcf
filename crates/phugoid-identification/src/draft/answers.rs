//! What has to be known besides the flight, and why no model file can be begun without.

use super::class::AircraftClass;

/// What is known of the aircraft besides the flight, SI; `None` where nobody said it.
#[derive(Clone, Debug, PartialEq)]
pub struct Answers {
    /// What kind of aircraft it is: where the typical numbers come from.
    pub class: AircraftClass,
    /// Its name, for reports.
    pub name: Option<String>,
    /// What is to be estimated; `None`: the axes whose surfaces were moved.
    pub axes: Option<DraftedAxes>,
    /// Mass in flight, kg.
    pub mass_kg: Option<f64>,
    /// Wing reference area, m^2.
    pub wing_area_m2: Option<f64>,
    /// Wing span, m.
    pub wing_span_m: Option<f64>,
    /// Mean aerodynamic chord, m; `None`: the area over the span.
    pub mean_chord_m: Option<f64>,
    /// Length of the fuselage, m; used for estimated moments of inertia alone.
    pub length_m: Option<f64>,
    /// Moment of inertia about body x, kg m^2.
    pub ixx_kg_m2: Option<f64>,
    /// Moment of inertia about body y, kg m^2.
    pub iyy_kg_m2: Option<f64>,
    /// Moment of inertia about body z, kg m^2.
    pub izz_kg_m2: Option<f64>,
    /// Product of inertia, integral of x z dm, kg m^2.
    pub ixz_kg_m2: Option<f64>,
    /// Constant thrust, N; 0 for a glider.
    pub thrust_n: Option<f64>,
    /// Altitude of the flight, m, where the record has neither density nor altitude.
    pub altitude_m: Option<f64>,
    /// Deflection of the elevator at command 1, rad, trailing edge down positive, where the record has only `elevator_command`.
    pub elevator_travel_rad: Option<f64>,
    /// Deflection of the ailerons at command 1, rad, right trailing edge down positive, where the record has only
    /// `aileron_command`.
    pub aileron_travel_rad: Option<f64>,
    /// Deflection of the rudder at command 1, rad, trailing edge left positive, where the record has only `rudder_command`.
    pub rudder_travel_rad: Option<f64>,
}

impl Answers {
    /// Nothing but the class.
    pub fn of(class: AircraftClass) -> Self {
        Self {
            class,
            name: None,
            axes: None,
            mass_kg: None,
            wing_area_m2: None,
            wing_span_m: None,
            mean_chord_m: None,
            length_m: None,
            ixx_kg_m2: None,
            iyy_kg_m2: None,
            izz_kg_m2: None,
            ixz_kg_m2: None,
            thrust_n: None,
            altitude_m: None,
            elevator_travel_rad: None,
            aileron_travel_rad: None,
            rudder_travel_rad: None,
        }
    }
}

/// The axes of a drafted model.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DraftedAxes {
    /// Lift, drag and pitching moment.
    Longitudinal,
    /// Side force, rolling and yawing moment.
    Lateral,
    /// All six coefficients.
    Both,
}

impl DraftedAxes {
    /// Whether the longitudinal axes are among them.
    pub fn has_longitudinal(self) -> bool {
        self != Self::Lateral
    }

    /// Whether the lateral-directional axes are among them.
    pub fn has_lateral(self) -> bool {
        self != Self::Longitudinal
    }
}

/// Something that has to be known and that neither the record nor the answers say.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Question {
    /// Which answer it is: `mass`, `wing_area`, `wing_span`, `altitude`, `elevator_travel`, `aileron_travel`, `rudder_travel`.
    pub key: &'static str,
    /// The question, in words.
    pub text: &'static str,
    /// Why it is asked.
    pub why: &'static str,
}

/// Why no model file could be begun.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum DraftError {
    /// Something that has to be known was not said.
    #[error("not known: {}", .0.iter().map(|question| question.key).collect::<Vec<_>>().join(", "))]
    Unanswered(Vec<Question>),
    /// An answer is no positive number.
    #[error("{key} is {value}; a positive number is expected")]
    NotPositive {
        /// Which answer.
        key: &'static str,
        /// What was answered, SI.
        value: f64,
    },
    /// The record lacks channels without which nothing can be estimated.
    #[error(
        "the flight has no {}; {axes} derivatives cannot be estimated without. {}",
        missing.join(", no "),
        match misspelt.as_slice() {
            [] => format!(
                "If a column holds it under another name, call the column so (with its unit), as in {example}"
            ),
            columns => columns.join(". "),
        }
    )]
    Channels {
        /// The channels that are not there.
        missing: Vec<String>,
        /// The axes in words.
        axes: &'static str,
        /// A header that would be understood.
        example: String,
        /// Columns whose names are like those of the missing channels, and what to write in their place, a sentence each.
        misspelt: Vec<String>,
    },
    /// The angle at full command is no angle of a surface.
    #[error(
        "the travel of the {surface} is {degrees} deg; the degrees at command 1 are expected, up to 90 and not 0, with the sign of \
         the deflection"
    )]
    Travel {
        /// The surface.
        surface: &'static str,
        /// What was answered, deg.
        degrees: f64,
    },
    /// What is called a command does not go from -1 to 1.
    #[error(
        "the flight has no {surface}, and its {command} goes from {low} to {high}: that is no command from -1 to 1, so that degrees \
         at full command say nothing. If it is an angle, call the column {surface}_deg or {surface}_rad; if it is counted in \
         microseconds or per cent, map it under [channels] of a model file with a scale"
    )]
    NoCommand {
        /// The surface.
        surface: &'static str,
        /// The channel of its command.
        command: &'static str,
        /// The smallest command.
        low: f64,
        /// The largest command.
        high: f64,
    },
    /// Units or signs of channels that the model uses are certainly wrong: no estimate would be made of this record.
    #[error("{}", units.join("\n"))]
    Units {
        /// What is wrong, one sentence for each channel concerned.
        units: Vec<String>,
    },
    /// The text that was written is no model file: a fault of this program.
    #[error("the model file that was begun cannot be read again: {0}")]
    Unreadable(String),
}
