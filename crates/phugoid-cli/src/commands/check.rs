//! `phugoid check`.

use std::fmt::Write as _;

use phugoid_aircraft::daveml::{CheckReport, Kind, Model};
use phugoid_flight_data::printable;
use serde::Serialize;

use crate::arguments;
use crate::failure::Failure;
use crate::output::{Table, deliver, significant};

#[derive(Serialize)]
struct Document {
    models: Vec<Checked>,
}

/// A model and how it compares with its check data.
#[derive(Serialize)]
struct Checked {
    model: String,
    name: String,
    inputs: usize,
    outputs: usize,
    shots: usize,
    shots_passed: usize,
    failures: Vec<Difference>,
}

/// A value that is not within its tolerance, in the unit of its variable.
#[derive(Serialize)]
struct Difference {
    shot: String,
    line: u32,
    variable: String,
    output: bool,
    expected: f64,
    found: f64,
    tolerance: f64,
}

/// Checks the models; false if an output of one is not within its tolerance.
pub(crate) fn run(arguments: &arguments::Check) -> Result<bool, Failure> {
    let mut models = Vec::with_capacity(arguments.models.len());
    let mut passed = true;
    for file in &arguments.models {
        let model = Model::open(file).map_err(Failure::input)?;
        let report = model.check();
        passed &= report.passed();
        models.push(Checked {
            model: printable::path(file),
            name: printable::one_line(&model.header().name).into_owned(),
            inputs: model.inputs().len(),
            outputs: model.outputs().len(),
            shots: report.shots.len(),
            shots_passed: report.shots_passed(),
            failures: failures(&report),
        });
    }
    let (document, delivery) = (Document { models }, &arguments.delivery);
    deliver(&document, delivery.json, delivery.out.as_deref(), || text(&document))?;
    Ok(passed)
}

fn failures(report: &CheckReport) -> Vec<Difference> {
    let differences = report.failures().map(|(shot, signal)| Difference {
        shot: printable::one_line(&shot.name).into_owned(),
        line: signal.line,
        variable: printable::one_line(&signal.id).into_owned(),
        output: signal.kind == Kind::Output,
        expected: signal.expected,
        found: signal.found,
        tolerance: signal.tolerance,
    });
    differences.collect()
}

fn text(document: &Document) -> String {
    let mut table = Table::with_words(&["model", "inputs", "outputs", "shots", "passed"], &[0]);
    for checked in &document.models {
        table.row([
            checked.model.clone(),
            checked.inputs.to_string(),
            checked.outputs.to_string(),
            checked.shots.to_string(),
            match checked.shots {
                0 => "no check data".to_owned(),
                _ => checked.shots_passed.to_string(),
            },
        ]);
    }
    let mut text = table.render();
    for checked in document.models.iter().filter(|checked| !checked.failures.is_empty()) {
        let mut table =
            Table::with_words(&["shot", "line", "variable", "", "expected", "found", "tolerance"], &[0, 2, 3]);
        for failure in &checked.failures {
            table.row([
                failure.shot.clone(),
                failure.line.to_string(),
                failure.variable.clone(),
                if failure.output { "output" } else { "internal" }.to_owned(),
                significant(failure.expected, 8),
                significant(failure.found, 8),
                significant(failure.tolerance, 3),
            ]);
        }
        // Writing to a string cannot fail.
        let _ = write!(text, "\nNot within the tolerance: {}\n{}", checked.model, table.render());
    }
    text
}
