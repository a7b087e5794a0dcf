//! Every case, comparison and figure of the thesis that this project grew from: M. Gurbacki, *Feasibility Study of a
//! Novel Method for Real-Time Aerodynamic Coefficient Estimation*, Rochester Institute of Technology, 2010.
//!
//! An [`Entry`] is one case or one study, with an id like `second-order/3`; running it gives a [`Reproduction`]: what was
//! published, what we reconstructed of it, what we found, and what differs and why, as plain data for text, JSON,
//! figures and pages. Cases are files in `scenarios/thesis/`, embedded here; a user's own file runs in the same way.
//!
//! The text of the thesis at hand has lost its minus signs and most digits of its tables. What is reconstructed says so.

pub mod aircraft_case;
pub mod case_file;
pub mod comparison;
mod embedded;
mod flight_charts;
pub mod golden;
pub mod group;
mod gust;
mod gust_flight;
mod health;
mod law_summary;
mod laws;
mod noise_levels;
mod outside;
mod pilot;
pub mod plant_case;
pub mod published;
mod repeated;
pub mod result;
mod sensors;
mod trim;
mod tuning;
mod units;

use crate::accuracy::StudyError;
pub use published::Published;
pub use result::Reproduction;

/// One case or study.
#[derive(Clone, Copy)]
pub struct Entry {
    /// `group/name`, e.g. `second-order/3`.
    pub id: &'static str,
    /// What it is, in a few words.
    pub title: &'static str,
    /// How it is run.
    pub run: Run,
}

/// Runs an entry: told its id, and calling back with the fraction done, 0 to 1, from any thread.
pub type Run = fn(&str, &(dyn Fn(f64) + Sync)) -> Result<Reproduction, StudyError>;

impl Entry {
    /// The part of the id before the slash.
    pub fn group(&self) -> &'static str {
        self.id.split('/').next().unwrap_or(self.id)
    }
}

/// All entries, in the order of the report.
pub fn entries() -> Vec<Entry> {
    [
        // trim, gust
        trim::ENTRIES,
        gust::ENTRIES,
        // first-order, first-order-nonlinear, second-order, second-order-nonlinear, noise
        plant_case::ENTRIES,
        noise_levels::ENTRIES,
        // dcm-alpha, dcm-q, dcl-alpha, dcd-alpha, combined
        aircraft_case::ENTRIES,
        // sensors, gust, pilot
        sensors::ENTRIES,
        gust_flight::ENTRIES,
        pilot::ENTRIES,
        // model-reference
        comparison::ENTRIES,
        // laws
        law_summary::ENTRIES,
        laws::ENTRIES,
        // tuning
        tuning::ENTRIES,
        // health
        health::ENTRIES,
    ]
    .concat()
}
