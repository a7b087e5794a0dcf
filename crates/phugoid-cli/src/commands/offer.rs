//! Text about the terms that were tried because the model may lack them.

use std::fmt::Write as _;

use phugoid_identification::estimation::Offer;

use super::result::paragraph;
use crate::output::{Table, significant};

/// Why terms were tried, the result of each, and, if one is recommended, the lines for the model file.
pub(crate) fn text(offer: &Offer) -> String {
    let mut text = String::new();
    let why = format!(
        "Tried one at a time with {}{}. A term is asked for if it gains {:.1} nats of log likelihood, without change \
         detection and with it, lies three standard errors from zero, and leaves fewer adopted changes where there were any.",
        offer.method,
        because(offer),
        offer.threshold
    );
    paragraph(&mut text, "Terms that the residuals ask for", std::iter::once(why));
    if offer.terms.is_empty() {
        text.push_str("  There was none left to try.\n");
        return text;
    }
    let mut table = Table::new(&[
        "parameter",
        "term",
        "gain",
        "with detection",
        "estimate",
        "+- 2 sigma",
        "changes left",
        "asked for",
    ]);
    for term in &offer.terms {
        let dash = || "-".to_owned();
        table.row(vec![
            term.parameter.clone(),
            term.term.clone(),
            format!("{:.1}", term.gain),
            term.gain_with_changes.map_or_else(dash, |gain| format!("{gain:.1}")),
            significant(term.value, 4),
            significant(2.0 * term.std_error, 3),
            term.adopted_changes.map_or_else(dash, |left| format!("{left} of {}", offer.adopted_changes)),
            if term.asked_for { "yes" } else { "no" }.to_owned(),
        ]);
    }
    text.push_str(&table.render());
    if let Some(best) = offer.best() {
        // In lines of their own, to be copied.
        let _ = writeln!(
            text,
            "  Nothing was changed. To take {} in, write into the model file\n\n    [coefficients]\n    {}\n\n    \
             [parameters]\n    {}",
            best.term, best.coefficient_line, best.parameter_line
        );
    }
    text
}

/// The reasons why terms were tried, as part of a sentence; empty if they were tried without a reason.
fn because(offer: &Offer) -> String {
    if offer.reasons.is_empty() { String::new() } else { format!(", because {}", offer.reasons.join(", and ")) }
}
