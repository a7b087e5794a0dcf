//! A pilot's continuous stick, which the abstract of the thesis promises and no case of it shows: random with a fixed seed,
//! and from a file.

use super::trim::SHORT_PERIOD_S;
use crate::aircraft_case::{AircraftCase, model_file};
use crate::embedded::{case, cases};
use crate::repeated::{RUNS, believable, repeated, table, worst_ratio};
use crate::result::Reproduction;
use crate::result::{Requirement, Role, in_seconds};
use phugoid_evaluation::accuracy::StudyError;

cases! {
    "pilot"/"seeded": "A pilot's random stick",
    "pilot"/"file": "A pilot's stick from a file",
}

/// One and two cycles of the short period, and the end, s.
const CHECKPOINTS_S: [f64; 3] = [SHORT_PERIOD_S, 2.0 * SHORT_PERIOD_S, 20.0];
/// Root mean square errors of 40 runs scatter by 11 %; three times that.
const LARGEST_RATIO: f64 = 1.35;

fn run(id: &str, progress: &(dyn Fn(f64) + Sync)) -> Result<Reproduction, StudyError> {
    let case = case(FILES, id, AircraftCase::parse)?;
    let mut reproduction = case.run(id)?;
    progress(0.3);
    let study = repeated(&case, &model_file(&case)?, &CHECKPOINTS_S)?;
    progress(1.0);
    let flagship = reproduction.outcomes.iter().filter(|outcome| outcome.role == Role::Flagship);
    let found: Vec<Requirement> = flagship
        .flat_map(|outcome| &outcome.parameters)
        .map(|p| Requirement {
            what: format!("{} within 5 % to stay, seed of the file", p.name),
            limit: "before the end".into(),
            found: in_seconds(p.converged_s),
            met: p.converged_s.is_some(),
        })
        .collect();
    let ratio = worst_ratio(&study);
    reproduction.requirements.extend(found);
    reproduction.requirements.extend([
        Requirement {
            what: format!(
                "root mean square error of {RUNS} runs over the Cramer-Rao bound at the end, largest of the four"
            ),
            limit: format!("{LARGEST_RATIO} (40 runs scatter by 11 %)"),
            found: format!("{ratio:.2}"),
            met: ratio <= LARGEST_RATIO,
        },
        believable(&study, ""),
    ]);
    reproduction.tables.push(table("What the flagship finds under the pilot's stick", &[("as told", &study)]));
    Ok(reproduction)
}
