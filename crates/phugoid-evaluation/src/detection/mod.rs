//! Is a sudden change found, how soon, and how often is one believed that never was? Every flight has its own aircraft, damage, stick,
//! air and sensors.

mod conditions;
mod draw;
mod limit;
mod lines;
mod model_error;

pub use conditions::{Air, Stick};
pub use lines::{DamageLine, RecoveryLine, damage_lines};
pub use model_error::{ModelErrorLine, model_error_lines};

use phugoid_identification::model_file::ModelFile;
use serde::Serialize;

use crate::accuracy::StudyError;
use crate::ledger::Ledger;
use crate::published::{DAMAGE_SCENARIO, F16_MODEL};
use phugoid_simulation::scenario::Scenario;

/// Result of the detection study: flights with damage, and flights without damage but with an error of the model.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct DetectionStudy {
    /// Flights, and minutes of flight, per line.
    pub runs: usize,
    /// First seed of every line.
    pub seed: u64,
    /// Damage, with the built-in model file `f16`.
    pub damage: Vec<DamageLine>,
    /// No damage but errors of the model: with the same model file, and with a term for the error that it asks for.
    pub model_error: Vec<ModelErrorLine>,
}

/// The study: `runs` damages and `runs` minutes of flight for each line. `ledger` is told of each flight, from any thread, and may
/// keep what is measured in it.
///
/// # Errors
/// [`StudyError`]: a flight cannot be flown, or the model does not fit it.
pub fn detection(runs: usize, seed: u64, ledger: &dyn Ledger) -> Result<DetectionStudy, StudyError> {
    let base = Scenario::parse(DAMAGE_SCENARIO, "f16-damage").map_err(StudyError::unsuitable)?;
    let read = |text: &str| ModelFile::parse("f16", text).map_err(StudyError::unsuitable);
    let with_term = F16_MODEL
        .replace("\"elevator\"]", "\"elevator\", \"alpha^2\"]")
        .replace("[parameters]", "[parameters]\ndCm_alpha2 = { bounds = [-4, 4] }\n#");
    Ok(DetectionStudy {
        runs,
        seed,
        damage: damage_lines(&base, &read(F16_MODEL)?, runs, seed, ledger)?,
        model_error: model_error_lines(&base, [&read(F16_MODEL)?, &read(&with_term)?], runs, seed, ledger)?,
    })
}

/// Flights of [`detection`] with so many runs.
pub fn detection_flights(runs: usize) -> usize {
    lines::LINES * runs + model_error::LINES.len() * runs
}
