//! The numbers of a plant case that are committed and compared.

use super::format::PlantCase;
use super::judged::Judged;
use super::simulate::PlantRun;
use crate::golden::instants;
use crate::result::Behaviour;
use phugoid_evaluation::table::{Cell, Column, Table};

/// Estimates at forty instants, evenly spread; of a law that chatters, diverges or did not always solve its loop only the
/// verdict.
pub(super) fn golden(case: &PlantCase, run: &PlantRun, judged: &[Judged]) -> Table {
    let columns = judged
        .iter()
        .flat_map(|one| case.unknowns().map(|(name, _)| Column::new(format!("{}: {name}", one.method.name), "")));
    instants(&run.time_s, columns.collect(), |k| {
        let of = |one: &Judged| -> Vec<Cell> {
            let behaviour = one.outcome.behaviour;
            let chaotic = one.result.unsolved > 0 || matches!(behaviour, Behaviour::Chatters | Behaviour::Diverges);
            let cell = |values: &Vec<f64>| if chaotic { behaviour.word().into() } else { values[k].into() };
            one.result.estimates.iter().map(cell).collect()
        };
        judged.iter().flat_map(of).collect()
    })
}
