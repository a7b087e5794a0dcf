//! `phugoid linearize`.

use std::fmt::Write as _;

use phugoid::{Linearization, linearize};
use phugoid_flight_dynamics::linearize::{LinearModel, SubModel};
use phugoid_flight_dynamics::modes::Mode;
use phugoid_flight_dynamics::trim::Trim;
use serde::Serialize;

use super::trim::{Described, aircraft, title, trimmed};
use crate::arguments;
use crate::failure::Failure;
use crate::output::{Table, deliver, significant};

#[derive(Serialize)]
struct Document<'a> {
    #[serde(flatten)]
    aircraft: &'a Described,
    trim: Trim,
    /// The whole linear model, with all states and inputs.
    #[serde(flatten)]
    model: LinearModel,
    /// Longitudinal modes, then lateral modes, in each group the fastest first.
    modes: Vec<&'a Mode>,
    longitudinal: &'a SubModel,
    lateral: &'a SubModel,
}

pub(crate) fn run(arguments: &arguments::Linearize) -> Result<(), Failure> {
    let condition = &arguments.condition;
    let (aircraft, described) = aircraft(&condition.aircraft)?;
    let trim = trimmed(&aircraft, condition)?;
    let Linearization { model, longitudinal, lateral } = linearize(&aircraft, &trim)?;
    let document = Document {
        aircraft: &described,
        trim,
        model,
        modes: longitudinal.modes.iter().chain(&lateral.modes).collect(),
        longitudinal: &longitudinal,
        lateral: &lateral,
    };
    let delivery = &arguments.delivery;
    deliver(&document, delivery.json, delivery.out.as_deref(), || text(&document))
}

fn text(document: &Document) -> String {
    let mut text = title(document.aircraft, &document.trim);
    let parts = [("Longitudinal", document.longitudinal), ("Lateral", document.lateral)];
    for (name, part) in parts.into_iter().filter(|(_, part)| !part.modes.is_empty()) {
        // Writing to a string cannot fail.
        let _ = writeln!(text, "\n{name}: x' = A x + B u, SI units and radians\n{}", matrices(part));
        text.push_str(&modes(&part.modes));
    }
    text.push_str(&document.aircraft.notes_text());
    text
}

/// Text of the matrices A and B side by side, with the names of rows and columns.
fn matrices(part: &SubModel) -> String {
    let header: Vec<&str> = std::iter::once("").chain(part.states).chain(["|"]).chain(part.inputs).collect();
    let mut table = Table::new(&header);
    for (i, name) in part.states.iter().enumerate() {
        // What is zero up to rounding is printed as zero.
        let number = |value: &f64| significant(if value.abs() < 1e-12 { 0.0 } else { *value }, 5);
        let cells = part.a[i].iter().map(number).chain(["|".to_owned()]).chain(part.b[i].iter().map(number));
        table.row(std::iter::once((*name).to_owned()).chain(cells));
    }
    table.render()
}

fn modes(modes: &[Mode]) -> String {
    let mut table =
        Table::new(&["mode", "eigenvalue 1/s", "frequency rad/s", "damping", "period s", "half s", "double s"]);
    for mode in modes {
        let optional = |value: Option<f64>| value.map_or_else(|| "-".to_owned(), |v| significant(v, 4));
        let eigenvalue = match mode.eigenvalue_imaginary {
            0.0 => significant(mode.eigenvalue_real, 5),
            imaginary => format!("{} +- {}i", significant(mode.eigenvalue_real, 5), significant(imaginary, 5)),
        };
        table.row([
            mode.name.to_string(),
            eigenvalue,
            significant(mode.natural_frequency_rad_s, 4),
            optional(mode.damping_ratio),
            optional(mode.period_s),
            optional(mode.time_to_half_s),
            optional(mode.time_to_double_s),
        ]);
    }
    table.render()
}
