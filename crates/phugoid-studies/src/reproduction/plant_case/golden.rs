//! The numbers of a plant case that are committed and compared.

use super::report::Told;
use super::{PlantCase, PlantRun};
use crate::reproduction::result::{Behaviour, Cell, Column, Table};

/// Rows of the table.
const ROWS: usize = 40;

/// Estimates at forty instants, evenly spread; of a law that chatters, diverges or did not always solve its loop only the
/// verdict.
pub(super) fn golden(case: &PlantCase, run: &PlantRun, told: &[Told]) -> Table {
    let mut columns = vec![Column::new("time", "s")];
    for t in told {
        columns.extend(case.unknowns().map(|(name, _)| Column::new(format!("{}: {name}", t.shown.name), "")));
    }
    let last = run.time_s.len() - 1;
    let rows = (1..=ROWS)
        .map(|row| {
            let k = row * last / ROWS;
            let mut cells = vec![Cell::from(run.time_s[k])];
            for t in told {
                let chaotic =
                    t.result.unsolved > 0 || matches!(t.outcome.behaviour, Behaviour::Chatters | Behaviour::Diverges);
                cells.extend(t.result.estimates.iter().map(|values| {
                    if chaotic { Cell::from(t.outcome.behaviour.word()) } else { Cell::from(values[k]) }
                }));
            }
            cells
        })
        .collect();
    Table { title: "Estimates".to_owned(), columns, rows }
}
