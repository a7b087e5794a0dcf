//! The numbers of an aircraft case that are committed and compared.

use super::case::AircraftCase;
use super::judged::Judged;
use super::method::ParameterRun;
use crate::golden::instants;
use crate::result::Behaviour;
use phugoid_evaluation::table::{Cell, Column, Table};

/// Estimates at forty instants, evenly spread; of a law that chatters or diverges only the verdict, and of one that jumps only
/// that it is outside its bounds: how far is a matter of rounding.
pub(super) fn golden(case: &AircraftCase, time: &[f64], judged: &[Judged]) -> Table {
    let columns = judged.iter().flat_map(|one| {
        one.run.parameters.iter().map(|p| Column::new(format!("{}: {}", one.settings.name, p.name), "1/rad"))
    });
    instants(time, columns.collect(), |k| {
        let of = |one: &Judged| -> Vec<Cell> {
            let behaviour = one.outcome.behaviour;
            let chaotic = matches!(behaviour, Behaviour::Chatters | Behaviour::Diverges);
            let cell = |p: &ParameterRun| match case.parameters.get(&p.name) {
                _ if chaotic => behaviour.word().into(),
                Some(told) if !(told.lower..=told.upper).contains(&p.values[k]) => "outside".into(),
                _ => p.values[k].into(),
            };
            one.run.parameters.iter().map(cell).collect()
        };
        judged.iter().flat_map(of).collect()
    })
}
