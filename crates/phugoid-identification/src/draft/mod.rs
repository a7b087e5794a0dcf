//! The first model file of an aircraft, made of a flight and the few numbers that no flight tells.
//!
//! [`questions`] says what has to be known besides the record. [`draft`] writes the file with comments, estimates what may be
//! estimated (moments of inertia, thrust) with an uncertainty that goes into the bounds, and holds the answers against the
//! record.
//!
//! ```
//! use phugoid_flight_data::record::Record;
//! use phugoid_identification::draft::{AircraftClass, Answers, draft, questions};
//! use phugoid_identification::model_file::ModelFile;
//! let flight = Record::open("examples/flight.csv")?;
//! let mut answers = Answers::of(AircraftClass::Fighter);
//! assert_eq!(questions(&flight, &answers)[0].key, "mass");
//! (answers.mass_kg, answers.wing_area_m2, answers.wing_span_m) = (Some(9295.0), Some(27.87), Some(9.14));
//! let drafted = draft(&flight, &answers)?;
//! let model = ModelFile::parse("mine.toml", &drafted.text)?;
//! assert!(model.parameters.iter().any(|p| p.name == "Cm_alpha"));
//! // Nobody said what the moments of inertia are.
//! assert!(drafted.assumed.iter().any(|line| line.contains("iyy")));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod class;
mod contents;
mod examined;
mod text;

use phugoid_flight_data::record::Record;

use crate::core::axes::Group;
use crate::manoeuvres::{Settings, find};
pub use class::AircraftClass;
use contents::Contents;

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
    /// Which answer it is: `mass`, `wing_area`, `wing_span`, `altitude`.
    pub key: &'static str,
    /// The question, in words.
    pub text: &'static str,
    /// Why it is asked.
    pub why: &'static str,
}

/// A model file that was begun.
#[derive(Clone, Debug, PartialEq)]
pub struct Draft {
    /// The TOML text of the model file.
    pub text: String,
    /// What was assumed or estimated because nobody said it, a sentence each; the file has it as comments too.
    pub assumed: Vec<String>,
    /// What in the answers and in the record does not belong together, a sentence each.
    pub doubts: Vec<String>,
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
        "the flight has no {}; {axes} derivatives cannot be estimated without. If a column holds it under another name, call \
         the column so (with its unit), as in {example}",
        missing.join(", no ")
    )]
    Channels {
        /// The channels that are not there.
        missing: Vec<String>,
        /// The axes in words.
        axes: &'static str,
        /// A header that would be understood.
        example: String,
    },
}

/// What has to be answered before a model file can be begun; empty if [`draft`] has all that it needs.
pub fn questions(record: &Record, answers: &Answers) -> Vec<Question> {
    let contents = Contents::of(record);
    let mut questions = Vec::new();
    let mut ask = |known: bool, key, text, why| {
        if !known {
            questions.push(Question { key, text, why });
        }
    };
    let mass = answers.mass_kg.is_some() || contents.has("mass");
    ask(mass, "mass", "mass in flight", "every force coefficient is proportional to it");
    ask(answers.wing_area_m2.is_some(), "wing_area", "wing reference area", "every coefficient is referred to it");
    ask(
        answers.wing_span_m.is_some(),
        "wing_span",
        "wing span",
        "the chord, and estimates of the inertia, follow from it",
    );
    let density = contents.density.is_some() || answers.altitude_m.is_some();
    ask(density, "altitude", "altitude of the flight", "the record has no altitude, air density or dynamic pressure");
    questions
}

/// Begins a model file for a flight.
///
/// # Errors
/// [`DraftError`]: something is not known, an answer is not positive, or the record lacks channels that every estimation needs.
pub fn draft(record: &Record, answers: &Answers) -> Result<Draft, DraftError> {
    let open = questions(record, answers);
    if !open.is_empty() {
        return Err(DraftError::Unanswered(open));
    }
    let positive = [
        ("mass", answers.mass_kg),
        ("wing_area", answers.wing_area_m2),
        ("wing_span", answers.wing_span_m),
        ("mean_chord", answers.mean_chord_m),
        ("length", answers.length_m),
        ("ixx", answers.ixx_kg_m2),
        ("iyy", answers.iyy_kg_m2),
        ("izz", answers.izz_kg_m2),
    ];
    for (key, value) in positive {
        if let Some(value) = value.filter(|value| value.is_nan() || *value <= 0.0 || value.is_infinite()) {
            return Err(DraftError::NotPositive { key, value });
        }
    }
    let contents = Contents::of(record);
    let found = find(record, &Settings::default());
    let moved = |group| found.manoeuvres.iter().any(|manoeuvre| manoeuvre.moves(group));
    let lateral = moved(Group::Lateral) && contents.lacks(DraftedAxes::Lateral).is_empty();
    let axes = answers.axes.unwrap_or(match (moved(Group::Longitudinal), lateral) {
        (false, true) => DraftedAxes::Lateral,
        _ => DraftedAxes::Longitudinal,
    });
    let missing = contents.lacks(axes);
    if let Some(first) = missing.first() {
        let example = contents::header_of(first);
        let axes = if axes.has_longitudinal() { "longitudinal" } else { "lateral-directional" };
        return Err(DraftError::Channels { missing, axes, example });
    }
    let mut writer = text::Writer::new(&contents, answers, axes);
    if answers.axes.is_none() && axes == DraftedAxes::Longitudinal && lateral {
        writer.assume(
            "ailerons or rudder were moved too: this model is of the longitudinal motion; another with --axes lateral, or both \
             together with --axes both",
        );
    }
    let (text, aircraft, assumed) = writer.finish();
    Ok(Draft { text, assumed, doubts: examined::doubts(&contents, answers, &aircraft) })
}
