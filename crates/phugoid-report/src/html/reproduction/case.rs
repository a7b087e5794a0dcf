//! The part of the page with everything about one case or study.

use std::fmt::Write as _;

use phugoid_evaluation::table::{Cell, Table};
use phugoid_thesis::result::{Behaviour, Outcome, ParameterOutcome, Reproduction};

use super::super::page::{self, END_OF_TABLE, prose, table};
use super::parts::{met_of, status};
use crate::chart::chart_figure;
use crate::escape::escape;
use crate::ticks::{compact, fixed, significant};

/// The article of a case.
pub(super) fn case(reproduction: &Reproduction) -> String {
    let mut out = String::new();
    // Writing into a String cannot fail, here and below.
    let _ = write!(
        out,
        "<article id=\"{id}\">\n<h3><code>{id}</code> {}</h3>\n",
        escape(&reproduction.title),
        id = escape(&reproduction.id)
    );
    if !reproduction.place.is_empty() {
        let _ = writeln!(out, "<p class=\"by\">{}</p>", prose(&reproduction.place));
    }
    out.push_str(&paragraphs("Published", &reproduction.published));
    out.push_str(&paragraphs("Reconstructed", &reproduction.reconstruction));
    out.push_str(&outcomes(&reproduction.outcomes));
    out.push_str(&requirements(reproduction));
    for table in &reproduction.tables {
        out.push_str(&plain_table(table));
    }
    for chart in &reproduction.charts {
        out.push_str(&page::figure(&format!("{}/{}", reproduction.id, chart.name), 4, &chart_figure(chart)));
    }
    out.push_str(&paragraphs("What differs, and why", &reproduction.difference));
    out.push_str("</article>\n");
    out
}

/// A heading and its paragraphs, which are separated by empty lines; empty without text.
fn paragraphs(heading: &str, text: &str) -> String {
    let parts: String =
        text.split("\n\n").filter(|p| !p.trim().is_empty()).map(|p| format!("<p>{}</p>\n", prose(p.trim()))).collect();
    if parts.is_empty() { parts } else { format!("<h4>{heading}</h4>\n{parts}") }
}

/// The behaviour of the estimates of a method as a word in colour.
pub(super) fn behaviour(behaviour: Behaviour) -> String {
    let class = match behaviour {
        Behaviour::Converges => "good",
        Behaviour::Biased | Behaviour::Unfinished => "waiting",
        Behaviour::Chatters | Behaviour::Diverges => "bad",
    };
    status(class, behaviour.word())
}

/// The table of the estimates of each method.
fn outcomes(outcomes: &[Outcome]) -> String {
    if outcomes.is_empty() {
        return String::new();
    }
    let heads = [
        ("", "Method"),
        ("", "Behaviour"),
        ("", "Parameter"),
        ("n", "Truth"),
        ("n", "Start"),
        ("n", "End"),
        ("n", "Error<br>(%)"),
        ("n", "Claimed<br>2σ"),
        ("n", "Published<br>(s)"),
        ("n", "Within 5 %<br>after (s)"),
    ];
    let mut out = format!("<h4>Result</h4>\n{}", table(&heads).replace("<table>", "<table class=\"outcomes\">"));
    for outcome in outcomes {
        let rows = outcome.parameters.len().max(1) + usize::from(!outcome.condition.is_empty());
        for row in 0..outcome.parameters.len().max(1) {
            out.push_str(if row == 0 { "<tr class=\"first\">" } else { "<tr>" });
            if row == 0 {
                let _ = write!(
                    out,
                    "<th scope=\"rowgroup\" rowspan=\"{rows}\">{}</th><td rowspan=\"{rows}\">{}</td>",
                    escape(&outcome.method),
                    behaviour(outcome.behaviour)
                );
            }
            out.push_str(&parameter_cells(outcome.parameters.get(row)));
            out.push_str("</tr>\n");
        }
        if !outcome.condition.is_empty() {
            let _ = writeln!(out, "<tr><td class=\"why\" colspan=\"8\">{}</td></tr>", prose(&outcome.condition));
        }
    }
    out.push_str(END_OF_TABLE);
    out
}

/// The cells of one parameter in that table.
fn parameter_cells(parameter: Option<&ParameterOutcome>) -> String {
    let Some(p) = parameter else { return "<td colspan=\"8\"></td>".to_owned() };
    let dash = || "–".to_owned();
    let error = 100.0 * (p.end - p.truth) / p.truth.abs();
    let percent = match error.abs() {
        size if !size.is_finite() => dash(),
        size if size > 1e4 => significant(error, 2),
        size if size >= 100.0 => fixed(error, 0),
        size if size >= 0.005 => fixed(error, 2),
        _ => compact_error(error),
    };
    let cells = [
        compact(p.truth, 4),
        compact(p.start, 4),
        format!("<b>{}</b>", significant(p.end, 4)),
        percent,
        p.std_error.map_or_else(dash, |s| significant(2.0 * s, 2)),
        p.published_s.map_or_else(dash, |s| significant(s, 3)),
        p.converged_s.map_or_else(|| "never".to_owned(), |s| significant(s, 3)),
    ];
    let numbers: String = cells.iter().map(|cell| format!("<td class=\"n\">{cell}</td>")).collect();
    format!("<td>{}</td>{numbers}", escape(&p.name))
}

/// A very small error with one digit, because further digits mean nothing.
fn compact_error(error: f64) -> String {
    if error == 0.0 { "0".to_owned() } else { significant(error, 1) }
}

/// The table of what was required and found.
fn requirements(reproduction: &Reproduction) -> String {
    if reproduction.requirements.is_empty() {
        return String::new();
    }
    let heads = [("", "Required"), ("", "Limit"), ("", "Found"), ("", "Met")];
    let mut out = format!("<h4>Requirements: {} met</h4>\n{}", met_of(&reproduction.requirements), table(&heads));
    for requirement in &reproduction.requirements {
        let _ = writeln!(
            out,
            "<tr><td class=\"words\">{}</td><td>{}</td><td>{}</td><td>{}</td></tr>",
            prose(&requirement.what),
            prose(&requirement.limit),
            prose(&requirement.found),
            if requirement.met { status("good", "met") } else { status("bad", "not met") }
        );
    }
    out.push_str(END_OF_TABLE);
    out
}

/// A table of a result as markup.
pub(in crate::html) fn plain_table(content: &Table) -> String {
    let number = |column: usize| content.rows.iter().any(|row| matches!(row.get(column), Some(Cell::Number(_))));
    let heads: Vec<(&str, String)> = content
        .columns
        .iter()
        .enumerate()
        .map(|(k, column)| {
            let unit = if column.unit.is_empty() { String::new() } else { format!("<br>({})", escape(&column.unit)) };
            (if number(k) { "n" } else { "" }, format!("{}{unit}", escape(&column.name)))
        })
        .collect();
    let mut out = format!("<h4>{}</h4>\n{}", escape(&content.title), table(&heads));
    if heads.len() <= 4 {
        out = out.replace("<table>", "<table class=\"narrow\">");
    }
    for row in &content.rows {
        out.push_str("<tr>");
        for (column, cell) in row.iter().enumerate() {
            let _ = match cell {
                Cell::Number(value) => write!(out, "<td class=\"n\">{}</td>", result(*value)),
                Cell::Text(words) => {
                    let class = if number(column) { " class=\"n\"" } else { "" };
                    write!(out, "<td{class}>{}</td>", prose(words))
                }
            };
        }
        out.push_str("</tr>\n");
    }
    out.push_str(END_OF_TABLE);
    out
}

/// A result with four digits; whole numbers without decimals.
fn result(value: f64) -> String {
    if value == value.round() && value.abs() < 1e6 { fixed(value, 0) } else { significant(value, 4) }
}
