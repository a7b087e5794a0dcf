//! The missing terms that were tried because the residuals gave a reason.

use std::fmt::Write as _;

use phugoid_identification::estimation::{Estimation, Offer};

use super::page::{END_OF_TABLE, table};
use crate::escape::escape;
use crate::ticks::{fixed, significant};

/// The table of the terms that were tried, and the lines for the model file if one of them is asked for; empty if
/// nothing was tried.
pub(super) fn offer(estimation: &Estimation) -> String {
    let Some(offer) = &estimation.offer else { return String::new() };
    let mut out = format!(
        "<p>Tried one at a time with {}{}. A term is asked for if it gains {} nats of log likelihood, without \
         change detection and with it, lies three standard errors from zero, and leaves fewer adopted changes where there \
         were any.</p>\n",
        escape(offer.method.name()),
        escape(&because(offer)),
        fixed(offer.threshold, 1)
    );
    if offer.terms.is_empty() {
        return out + "<p>There was none left to try.</p>\n";
    }
    out.push_str(&table(&[
        ("", "Parameter"),
        ("", "Term"),
        ("n", "Gain<br>(nats)"),
        ("n", "With change<br>detection"),
        ("n", "Estimate"),
        ("n", "Standard<br>error"),
        ("n", "Changes<br>left"),
        ("", "Asked for"),
    ]));
    for term in &offer.terms {
        let dash = || "\u{2013}".to_owned();
        let (class, word) = if term.asked_for { (" bad", "yes") } else { ("", "no") };
        let _ = writeln!(
            out,
            "<tr><th scope=\"row\">{}</th><td>{}</td><td class=\"n\">{}</td><td class=\"n\">{}</td><td class=\"n\">{}</td>\
             <td class=\"n\">{}</td><td class=\"n\">{}</td><td><span class=\"status{class}\">{word}</span></td></tr>",
            escape(&term.parameter),
            escape(&term.term),
            fixed(term.gain, 1),
            term.gain_with_changes.map_or_else(dash, |gain| fixed(gain, 1)),
            significant(term.value, 4),
            significant(term.std_error, 3),
            term.adopted_changes.map_or_else(dash, |left| format!("{left} of {}", offer.adopted_changes)),
        );
    }
    out.push_str(END_OF_TABLE);
    if let Some(best) = offer.best() {
        let _ = writeln!(
            out,
            "<p>Nothing was changed. To take {} in, write into the model file</p>\n<div class=\"scroll\"><pre>[coefficients]\n{}\n\n[parameters]\n{}</pre></div>",
            escape(&best.term),
            escape(&best.coefficient_line),
            escape(&best.parameter_line)
        );
    }
    out
}

/// The reasons for trying terms as a clause; empty if there were none.
fn because(offer: &Offer) -> String {
    if offer.reasons.is_empty() { String::new() } else { format!(", because {}", offer.reasons.join(", and ")) }
}
