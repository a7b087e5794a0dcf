//! Estimation while gusts pass.

use crate::aircraft_case::{AircraftCase, model_file};
use crate::embedded::{case, cases};
use crate::repeated::{RUNS, believable, coverage, repeated, table};
use crate::result::Reproduction;
use crate::result::{Requirement, Role, in_seconds};
use phugoid_evaluation::accuracy::StudyError;

cases! {
    "gust"/"flight": "All four coefficients while gusts pass",
}

/// While the first gust rises, before the second, and the end, s.
const CHECKPOINTS_S: [f64; 3] = [6.0, 10.0, 20.0];

fn run(id: &str, progress: &(dyn Fn(f64) + Sync)) -> Result<Reproduction, StudyError> {
    let case = case(FILES, id, AircraftCase::parse)?;
    let mut reproduction = case.run(id)?;
    progress(0.3);
    let told = repeated(&case, &model_file(&case)?, &CHECKPOINTS_S)?;
    progress(0.65);
    let mut unaware = case.clone();
    unaware.estimator.gusts = false;
    let untold = repeated(&unaware, &model_file(&unaware)?, &CHECKPOINTS_S)?;
    let mut calm = case.clone();
    calm.scenario.gust.clear();
    let in_calm = repeated(&calm, &model_file(&calm)?, &CHECKPOINTS_S)?;
    progress(1.0);
    let flagship = reproduction.outcomes.iter().filter(|outcome| outcome.role == Role::Flagship);
    let found: Vec<Requirement> = flagship
        .flat_map(|outcome| &outcome.parameters)
        .map(|p| Requirement {
            what: format!("{} within 5 % to stay, seed of the file, told of gusts", p.name),
            limit: "before the end".into(),
            found: in_seconds(p.converged_s),
            met: p.converged_s.is_some(),
        })
        .collect();
    reproduction.requirements.extend(found);
    reproduction.requirements.push(believable(&told, ", told of gusts"));
    reproduction.requirements.push(Requirement {
        what: format!(
            "not told of gusts the claims are not to be believed: truth within two claimed at the end, {RUNS} runs"
        ),
        limit: "fewer than when told".into(),
        found: format!("{:.1} %, told {:.1} %", coverage(&untold), coverage(&told)),
        met: coverage(&untold) < coverage(&told),
    });
    reproduction.tables.push(table(
        "What the flagship finds while gusts pass",
        &[("told of gusts", &told), ("not told", &untold), ("told, but calm air", &in_calm)],
    ));
    Ok(reproduction)
}
