//! The damped law with real sensors, over all damping that could make a difference.

use crate::laws::ThesisForm;
use rayon::prelude::*;

use super::input::{CYCLE_S, START_S};
use crate::aircraft_case::{
    AircraftCase, LawForm, LawSettings, Method, MethodRun, NamedMethod, Surface, fly, run_method,
};
use crate::plant_case::verdict::TOLERANCE;
use crate::result::Role;
use phugoid_evaluation::accuracy::StudyError;
use phugoid_evaluation::settling::settled_at;
use phugoid_evaluation::table::{Cell, Column, Table};

/// Powers of ten.
const DECADES: std::ops::RangeInclusive<i32> = -2..=8;
/// The last part of the record that is judged, s.
const LAST_S: f64 = 2.0;

/// What the damped law, told what the sensors give, makes of a case with each damping (`eta` of its own channel).
pub(super) fn sweep(case: &AircraftCase) -> Result<Table, StudyError> {
    let flight = fly(case)?;
    let run = |damping: f64| {
        let laws = case.unknowns().into_iter().map(|(parameter, told)| LawSettings {
            parameter,
            form: LawForm::Solved(ThesisForm::Damped),
            surface: Surface::Own,
            bounds: [told.lower, told.upper],
            start: told.start(),
            lambda: told.lambda,
            eta: damping,
        });
        let method = Method::Laws(laws.collect());
        run_method(case, &flight, &NamedMethod { name: "damped law".to_owned(), role: Role::Mended, method })
    };
    let decades: Vec<i32> = DECADES.collect();
    let rows = decades.into_par_iter().map(|decade| {
        let damping = 10.0_f64.powi(decade);
        Ok::<_, StudyError>(row(case, damping, &run(damping)?))
    });
    let rows: Vec<Vec<Cell>> = rows.collect::<Result<_, _>>()?;
    let of = |name: &str| {
        [
            Column::new(format!("{name}, mean of the last {LAST_S} s"), "% of truth"),
            Column::new(format!("{name}, scatter there"), "% of truth"),
            Column::new(format!("{name} within 5 % after"), "s"),
        ]
    };
    let columns = case.unknowns().into_iter().flat_map(|(name, _)| of(name));
    Ok(Table {
        title: format!(
            "The damped thesis law on the same noisy data, whatever its damping (seed of the file; the pitch acceleration, \
             which no sensor gives, is the difference of q). With too little it follows the noise, with too much it stays at \
             its start; a dash: not within 5 % to stay. One cycle is {CYCLE_S} s after {START_S} s"
        ),
        columns: std::iter::once(Column::new("damping", "–")).chain(columns).collect(),
        rows,
    })
}

fn row(case: &AircraftCase, damping: f64, run: &MethodRun) -> Vec<Cell> {
    let end = run.time_s.last().copied().unwrap_or(0.0);
    let from = run.time_s.partition_point(|t| *t < end - LAST_S);
    let cells = run.parameters.iter().flat_map(|parameter| {
        let truth = case.truth(&parameter.name);
        let last = parameter.values.get(from..).unwrap_or_default();
        let mean = last.iter().sum::<f64>() / last.len() as f64;
        let square = last.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / last.len() as f64;
        let settled = settled_at(&run.time_s, &parameter.values, truth, TOLERANCE).map(|t| t - START_S);
        [Cell::from(100.0 * mean / truth), Cell::from(100.0 * square.sqrt() / truth.abs()), Cell::from(settled)]
    });
    std::iter::once(damping.into()).chain(cells).collect()
}
