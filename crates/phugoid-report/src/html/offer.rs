//! The missing terms that the equations of motion ask for.

use std::fmt::Write as _;

use phugoid_identification::estimate::tried_by_the_method;
use phugoid_identification::estimation::{Estimation, ModelLine, Offer};

use super::page::{END_OF_TABLE, table};
use crate::escape::escape;
use crate::ticks::{fixed, significant};

/// The table of the terms that were tried, and, if one counts as missing, what it does to the parameters and the lines
/// for the model file; empty if nothing was tried.
pub(super) fn offer(estimation: &Estimation) -> String {
    let Some(offer) = &estimation.offer else { return String::new() };
    let criterion = &offer.criterion;
    let levels = offer.levels.iter().map(|level| {
        format!(
            "{} {} and {}",
            escape(&level.equation),
            significant(level.residual_std, 3),
            significant(level.noise_std, 3)
        )
    });
    let mut out = format!(
        "<p>Tried on the equations of motion: {} terms. One counts as missing from a partial F of {} on, if it alone makes \
         {} % of its coefficient's motion and explains {} % of what the noise of the sensors does not, and if the method \
         finds it too. Residuals, and what of them is noise of the sensors (one sigma, SI): {}.</p>\n",
        offer.tried,
        fixed(criterion.partial_f, 0),
        fixed(100.0 * criterion.share, 0),
        fixed(100.0 * criterion.excess, 0),
        levels.collect::<Vec<_>>().join(", ")
    );
    if let Some(sentence) = tried_by_the_method(offer) {
        let _ = writeln!(out, "<p>{}</p>", escape(&sentence));
    }
    if offer.terms.is_empty() {
        return out + "<p>There was none left to try.</p>\n";
    }
    out.push_str(&table(&[
        ("", "Parameter"),
        ("", "Term"),
        ("n", "Partial F"),
        ("n", "Share<br>(%)"),
        ("n", "Explains<br>(%)"),
        ("n", "In a<br>regression"),
        ("n", "Standard<br>error"),
        ("", "Missing"),
    ]));
    let dash = || "\u{2013}".to_owned();
    for term in &offer.terms {
        // A term that the method was run with is in no regression.
        let in_regression = |number: String| if term.share.is_some() { number } else { dash() };
        let (class, word) = if term.asked_for { (" bad", "yes") } else { ("", "no") };
        let _ = writeln!(
            out,
            "<tr><th scope=\"row\">{}</th><td>{}</td><td class=\"n\">{}</td><td class=\"n\">{}</td><td class=\"n\">{}</td>\
             <td class=\"n\">{}</td><td class=\"n\">{}</td><td><span class=\"status{class}\">{word}</span></td></tr>",
            escape(&term.parameter),
            escape(&term.term),
            in_regression(fixed(term.partial_f, 1)),
            term.share.map_or_else(dash, |share| fixed(100.0 * share, 1)),
            term.excess.map_or_else(dash, |excess| fixed(100.0 * excess, 1)),
            in_regression(significant(term.value, 4)),
            in_regression(significant(term.std_error, 3)),
        );
    }
    out.push_str(END_OF_TABLE);
    if offer.best().is_some() {
        out.push_str(&effects(offer));
    }
    out
}

/// What the missing terms do to the parameters, and the lines for the model file.
fn effects(offer: &Offer) -> String {
    let mut out = format!(
        "<p>{}</p>\n{}",
        if offer.taken { "What was taken in moved:" } else { "Taken in, the missing terms would move:" },
        table(&[
            ("", "Parameter"),
            ("n", "Without"),
            ("n", "Standard<br>error"),
            ("n", "With"),
            ("n", "Standard<br>error"),
        ])
    );
    for effect in &offer.effects {
        let or_dash =
            |value: Option<f64>, digits| value.map_or_else(|| "\u{2013}".to_owned(), |v| significant(v, digits));
        let _ = writeln!(
            out,
            "<tr><th scope=\"row\">{}</th><td class=\"n\">{}</td><td class=\"n\">{}</td><td class=\"n\">{}</td>\
             <td class=\"n\">{}</td></tr>",
            escape(&effect.parameter),
            or_dash(effect.before, 4),
            or_dash(effect.before_std, 3),
            significant(effect.after, 4),
            significant(effect.after_std, 3),
        );
    }
    out.push_str(END_OF_TABLE);
    let begin = if offer.taken {
        "The estimates are those of the model with these terms. To keep them, write into the model file"
    } else {
        "Nothing was changed. To take them in, write into the model file"
    };
    // Line by line: an escaped line end is a blank, and lines of TOML on one line are none.
    let lines: Vec<String> = lines(&offer.lines).lines().map(escape).collect();
    let _ = writeln!(out, "<p>{begin}</p>\n<div class=\"scroll\"><pre>{}</pre></div>", lines.join("\n"));
    out
}

/// The lines for the model file under the headings of their sections.
fn lines(lines: &[ModelLine]) -> String {
    let mut parts: Vec<String> = Vec::new();
    let mut section: Option<&str> = None;
    for line in lines {
        match parts.last_mut() {
            Some(part) if section == Some(line.section.as_str()) => {
                let _ = write!(part, "\n{}", line.line);
            }
            _ if line.section.is_empty() => parts.push(line.line.clone()),
            _ => parts.push(format!("[{}]\n{}", line.section, line.line)),
        }
        section = Some(&line.section);
    }
    parts.join("\n\n")
}
