//! The published aircraft cases with realistic sensors, and an input that is sized for them.
//!
//! The thesis flies without sensor noise, with an elevator of 0.05 deg. With real sensors so small an input says next to
//! nothing: no method can find what the data do not hold. How much they hold is the Cramer-Rao bound ([`information`]); an
//! input that is large enough and not too large is chosen by a rule ([`input`]); how often the flagship then finds the
//! coefficients in one cycle of the short period is counted over seeds ([`seeds`]) and set beside what the bound allows.

mod damping;
mod information;
mod input;
mod report;
mod seeds;
mod study;

use crate::aircraft_case::AircraftCase;
use crate::embedded::{case, cases};
use crate::result::Reproduction;
use input::{START_S, Shape};
use phugoid_evaluation::accuracy::StudyError;
use phugoid_simulation::manoeuvre::{Manoeuvre, Surface};
use phugoid_simulation::quantity::{Angle, Time};
use study::Study;

/// Amplitude of the thesis's inputs, deg.
const THESIS_DEG: f64 = 0.05;

/// Inputs of the thesis.
#[derive(Clone, Copy)]
enum ThesisInput {
    Doublet,
    Sine,
}

cases! {
    "sensors"/"dcm-alpha": "dCm_alpha with realistic sensors",
    "sensors"/"dcm-q": "dCm_q with realistic sensors",
    "sensors"/"dcl-alpha": "dCL_alpha with realistic sensors",
    "sensors"/"dcd-alpha": "dCD_alpha with realistic sensors",
    "sensors"/"combined": "All four at once with realistic sensors",
}

impl ThesisInput {
    /// That of the case which a case with realistic sensors repeats.
    fn of(id: &str) -> Self {
        if id == "sensors/dcm-alpha" { Self::Doublet } else { Self::Sine }
    }

    /// In words, amplitude in deg, and as a manoeuvre that starts with the others.
    fn described(self) -> (String, f64, Manoeuvre) {
        match self {
            Self::Doublet => {
                let manoeuvre = Manoeuvre::Doublet {
                    surface: Surface::Elevator,
                    start: Time::from_si(START_S),
                    width: Time::from_si(1.0),
                    amplitude: Angle::from_si(THESIS_DEG.to_radians()),
                };
                ("thesis: doublet of 1 + 1 s".to_owned(), THESIS_DEG, manoeuvre)
            }
            Self::Sine => {
                let shape = Shape::Sine(1.0);
                (format!("thesis: {}", shape.words()), THESIS_DEG, shape.manoeuvre(THESIS_DEG))
            }
        }
    }
}

fn run(id: &str, progress: &(dyn Fn(f64) + Sync)) -> Result<Reproduction, StudyError> {
    let case = case(FILES, id, AircraftCase::parse)?;
    let mut reproduction = case.run(id)?;
    progress(0.2);
    let study = Study::of(&case, &ThesisInput::of(id).described(), &|done| progress(0.2 + 0.8 * done))?;
    report::add(&mut reproduction, &case, &study);
    reproduction.tables.push(damping::sweep(&case)?);
    Ok(reproduction)
}
