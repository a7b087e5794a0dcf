//! Text about the terms that were tried because the model may lack them.

use std::fmt::Write as _;

use phugoid_identification::estimate::tried_by_the_method;
use phugoid_identification::estimation::{ModelLine, Offer};

use super::result::paragraph;
use crate::output::{Table, significant};

/// The missing terms beside the best of the others, what they do to each parameter, and the lines for the model file;
/// empty if no term counts as missing.
pub(crate) fn text(offer: &Offer) -> String {
    let mut text = String::new();
    if offer.best().is_none() {
        return text;
    }
    let criterion = &offer.criterion;
    let levels = offer.levels.iter().map(|level| {
        let (residual, noise) = (significant(level.residual_std, 3), significant(level.noise_std, 3));
        format!("{} {residual} and {noise}", level.equation)
    });
    let why = format!(
        "Tried on the equations of motion: {} terms. One counts as missing from a partial F of {:.0} on, if it alone makes \
         {:.0} % of its coefficient's motion and explains {:.0} % of what the noise of the sensors does not, and if the \
         method finds it too. Residuals, and what of them is noise of the sensors (one sigma, SI): {}.",
        offer.tried,
        criterion.partial_f,
        100.0 * criterion.share,
        100.0 * criterion.excess,
        levels.collect::<Vec<_>>().join(", ")
    );
    paragraph(
        &mut text,
        "Terms that the equations of motion ask for",
        std::iter::once(why).chain(tried_by_the_method(offer)),
    );
    let mut table = Table::new(&[
        "parameter",
        "term",
        "partial F",
        "share",
        "explains",
        "in a regression",
        "+- 2 sigma",
        "missing",
    ]);
    for term in &offer.terms {
        // A term that the method was run with is in no regression.
        let in_regression = |number: String| if term.share.is_some() { number } else { "-".to_owned() };
        table.row(vec![
            term.parameter.clone(),
            term.term.clone(),
            in_regression(format!("{:.1}", term.partial_f)),
            term.share.map_or_else(|| "-".to_owned(), |share| format!("{:.1} %", 100.0 * share)),
            term.excess.map_or_else(|| "-".to_owned(), |excess| format!("{:.1} %", 100.0 * excess)),
            in_regression(significant(term.value, 4)),
            in_regression(significant(2.0 * term.std_error, 3)),
            if term.asked_for { "yes" } else { "no" }.to_owned(),
        ]);
    }
    text.push_str(&table.render());
    text.push_str(if offer.taken { "\n  What was taken in moved\n" } else { "\n  Taken in, they would move\n" });
    let mut table = Table::new(&["parameter", "without", "+- 2 sigma", "with", "+- 2 sigma"]);
    for effect in &offer.effects {
        let dash = || "-".to_owned();
        table.row(vec![
            effect.parameter.clone(),
            effect.before.map_or_else(dash, |value| significant(value, 4)),
            effect.before_std.map_or_else(dash, |std| significant(2.0 * std, 3)),
            significant(effect.after, 4),
            significant(2.0 * effect.after_std, 3),
        ]);
    }
    text.push_str(&table.render());
    let begin = if offer.taken {
        "The estimates are those of the model with these terms. To keep them, write into the model file"
    } else {
        "Nothing was changed. To take them in, give --structure auto, or write into the model file"
    };
    let _ = writeln!(text, "  {begin}\n");
    // In lines of their own, to be copied.
    text.push_str(&lines(&offer.lines));
    text
}

/// The lines for the model file under the headings of their sections, indented.
fn lines(lines: &[ModelLine]) -> String {
    let mut text = String::new();
    let mut section = None;
    for line in lines {
        if section != Some(&line.section) {
            if section.is_some() {
                text.push('\n');
            }
            section = Some(&line.section);
            if !line.section.is_empty() {
                let _ = writeln!(text, "    [{}]", line.section);
            }
        }
        let _ = writeln!(text, "    {}", line.line);
    }
    text
}
