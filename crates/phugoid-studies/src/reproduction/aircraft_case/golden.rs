//! The numbers of an aircraft case that are committed and compared.

use super::case::AircraftCase;
use super::run::Told;
use crate::reproduction::result::{Behaviour, Cell, Column, Table};

/// Rows of the table.
const ROWS: usize = 40;

/// Estimates at forty instants, evenly spread; of a law that chatters or diverges only the verdict, and of one that jumps only
/// that it is outside its bounds: how far is a matter of rounding.
pub(super) fn golden(case: &AircraftCase, time: &[f64], told: &[Told]) -> Table {
    let mut columns = vec![Column::new("time", "s")];
    for one in told {
        let name = |p: &str| Column::new(format!("{}: {p}", one.settings.name), "1/rad");
        columns.extend(one.run.parameters.iter().map(|p| name(&p.name)));
    }
    let last = time.len().saturating_sub(1);
    let row = |row: usize| {
        let k = row * last / ROWS;
        let mut cells = vec![Cell::from(time[k])];
        for one in told {
            let chaotic = matches!(one.outcome.behaviour, Behaviour::Chatters | Behaviour::Diverges);
            let word = one.outcome.behaviour.word();
            cells.extend(one.run.parameters.iter().map(|p| match case.parameters.get(&p.name) {
                _ if chaotic => Cell::from(word),
                Some(told) if !(told.lower..=told.upper).contains(&p.values[k]) => Cell::from("outside"),
                _ => Cell::from(p.values[k]),
            }));
        }
        cells
    };
    Table { title: "Estimates".to_owned(), columns, rows: (1..=ROWS).map(row).collect() }
}
