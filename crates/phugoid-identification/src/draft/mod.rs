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

mod answers;
mod class;
mod command;
mod contents;
mod examined;
mod text;

use phugoid_flight_data::plausibility::Doubt;
use phugoid_flight_data::record::Record;
use phugoid_flight_data::table::Misspelt;

use crate::core::axes::Group;
use crate::manoeuvres::{Settings, find};
use crate::model_file::ModelFile;
pub use answers::{Answers, DraftError, DraftedAxes, Question};
pub use class::AircraftClass;
use contents::Contents;

/// A model file that was begun.
#[derive(Clone, Debug, PartialEq)]
pub struct Draft {
    /// The TOML text of the model file.
    pub text: String,
    /// What was assumed or estimated because nobody said it, a sentence each; the file has it as comments too.
    pub assumed: Vec<String>,
    /// What in the answers and in the record does not belong together, a sentence each.
    pub doubts: Vec<String>,
    /// What is doubtful about the units, signs and sensors of the channels that the model uses, a sentence each.
    pub record_doubts: Vec<String>,
    /// Which of two is used where an answer and the record say the same quantity, a sentence each.
    pub said_twice: Vec<String>,
    /// Where surfaces of the other axes were moved as well: the numbers, counted from 1, of the manoeuvres (as `phugoid inspect`
    /// and [`find`] have them) in which they were not, of which this model is. Empty where all of the flight is.
    pub manoeuvres: Vec<usize>,
}

/// What has to be answered before a model file can be begun; empty if [`draft`] has all that it needs.
pub fn questions(record: &Record, answers: &Answers) -> Vec<Question> {
    let contents = Contents::of(record, &[]);
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
    questions.extend(command::questions(record, answers));
    questions
}

/// Whether a model can be made of the record at all, whatever is answered: what it lacks is no question to anybody.
///
/// # Errors
/// [`DraftError::Channels`], [`DraftError::NoCommand`]: no answer helps. [`DraftError::Travel`]: an answer is no angle of a surface.
pub fn check(record: &Record, answers: &Answers) -> Result<(), DraftError> {
    let (completed, commanded) = command::with_positions(record, answers)?;
    let contents = Contents::of(&completed, &commanded);
    // A surface of which the travel is asked is not missing, and neither are the axes known before it is.
    if !command::questions(record, answers).is_empty() {
        let others =
            |missing: &String| !command::SURFACES.iter().any(|surface| missing.contains(surface.channels.name));
        let axes = command::presumed_axes(record, answers);
        let missing: Vec<String> = contents.lacks(axes).into_iter().filter(others).collect();
        return lacking(record, missing, axes);
    }
    let axes = axes_of(&completed, &contents, answers).0;
    lacking(record, contents.lacks(axes), axes)
}

/// An error that names what is missing, if anything is.
fn lacking(record: &Record, missing: Vec<String>, axes: DraftedAxes) -> Result<(), DraftError> {
    let Some(first) = missing.first() else { return Ok(()) };
    let example = contents::header_of(first);
    let axes = if axes.has_longitudinal() { "longitudinal" } else { "lateral-directional" };
    // `aileron or rudder` is one of the missing.
    let names = missing.iter().flat_map(|missing| missing.split(' '));
    let misspelt = names.flat_map(|name| record.columns_for(name)).map(|column| column.to_string()).collect();
    Err(DraftError::Channels { missing, axes, example, misspelt })
}

/// The axes of the model, and whether the record would do for the lateral-directional ones too.
fn axes_of(record: &Record, contents: &Contents<'_>, answers: &Answers) -> (DraftedAxes, bool) {
    let found = find(record, &Settings::default());
    let moved = |group| found.manoeuvres.iter().any(|manoeuvre| manoeuvre.moves(group));
    let lateral = moved(Group::Lateral) && contents.lacks(DraftedAxes::Lateral).is_empty();
    let axes = answers.axes.unwrap_or(match (moved(Group::Longitudinal), lateral) {
        (false, true) => DraftedAxes::Lateral,
        _ => DraftedAxes::Longitudinal,
    });
    (axes, lateral)
}

/// The manoeuvres that move the axes of a model alone, where others of the record move the other axes.
fn own_manoeuvres(record: &Record, axes: DraftedAxes) -> Vec<usize> {
    let (own, other) = match axes {
        DraftedAxes::Longitudinal => (Group::Longitudinal, Group::Lateral),
        DraftedAxes::Lateral => (Group::Lateral, Group::Longitudinal),
        DraftedAxes::Both => return Vec::new(),
    };
    let found = find(record, &Settings::default());
    if !found.manoeuvres.iter().any(|manoeuvre| manoeuvre.moves(other)) {
        return Vec::new();
    }
    let alone = found.manoeuvres.iter().zip(1..).filter(|(m, _)| m.moves(own) && !m.moves(other));
    alone.map(|(_, number)| number).collect()
}

/// Begins a model file for a flight.
///
/// # Errors
/// [`DraftError`]: something is not known, an answer is not positive or no angle of a surface, the record lacks channels that
/// every estimation needs, or the unit or sign of one that it has is certainly wrong.
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
    let (record, commanded) = command::with_positions(record, answers)?;
    let contents = Contents::of(&record, &commanded);
    let (axes, lateral) = axes_of(&record, &contents, answers);
    lacking(&record, contents.lacks(axes), axes)?;
    let mut writer = text::Writer::new(&contents, answers, axes, &commanded);
    if answers.axes.is_none() && axes == DraftedAxes::Longitudinal && lateral {
        writer.assume(
            "ailerons or rudder were moved too: this model is of the longitudinal motion; another with --axes lateral, or both \
             together with --axes both",
        );
    }
    if answers.axes.is_none() && axes == DraftedAxes::Lateral {
        writer.assume(match contents.has("elevator") {
            true => "ailerons or rudder were moved, and the elevator was not: this model is of the lateral-directional motion",
            false => {
                "the flight has no elevator: this model is of the lateral-directional motion alone. If a column holds the elevator, \
                 call it elevator_deg (or its unit)"
            }
        });
    }
    let (text, aircraft, assumed) = writer.finish();
    let model = ModelFile::parse("the model file", &text).map_err(|error| DraftError::Unreadable(error.to_string()))?;
    let found = examined::of_record(&record, &model)?;
    let doubts = examined::doubts(&contents, answers, &aircraft, &found);
    let mut record_doubts: Vec<String> = found.iter().map(Doubt::to_string).collect();
    record_doubts.extend(examined::assumed_units(&contents, &record, &model));
    record_doubts.extend(record.misspelt().iter().map(Misspelt::to_string));
    let said_twice = examined::said_twice(&contents, answers, axes);
    Ok(Draft { text, assumed, doubts, record_doubts, said_twice, manoeuvres: own_manoeuvres(&record, axes) })
}
