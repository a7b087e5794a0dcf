//! `phugoid regress`.

use std::fmt::Write as _;

use phugoid_identification::regress::{Criterion, RegressOptions, StepwiseRegression, regress};

use super::deleting::Deletions;
use super::estimate::{between, model, segments};
use super::result::{first_line, paragraph, warnings};
use crate::arguments;
use crate::failure::Failure;
use crate::output::{Table, deliver, fixed, significant};
use crate::progress::Progress;

pub(crate) fn run(arguments: &arguments::Regress) -> Result<(), Failure> {
    let model = model(&arguments.model)?;
    let deletions = Deletions::new(&arguments.deleting, &[&arguments.flight])?;
    let options = RegressOptions {
        candidates: arguments.candidates.as_deref().map(listed),
        up_to: arguments.up_to,
        criterion: arguments.criterion,
        f_to_enter: arguments.f_to_enter,
        f_to_remove: arguments.f_to_remove,
        ..RegressOptions::new(arguments.coefficient)
    };
    let record = {
        let _progress = Progress::spinner("reading");
        let mut record = model
            .open_record_with(&arguments.flight, &arguments.reading.options(&arguments.flight)?)
            .map_err(Failure::input)?;
        deletions.apply(&mut record, &arguments.flight, true)?;
        match arguments.segment {
            Some(number) => segments(&record, None, &[number])?.0,
            None => between(record, arguments.from, arguments.to)?,
        }
    };
    let found = {
        let _progress = Progress::spinner("selecting");
        regress(&record, &model, &options)?
    };
    let delivery = &arguments.delivery;
    deliver(&found, delivery.json, delivery.out.as_deref(), || {
        let mut told = text(&found);
        paragraph(&mut told, "Data quality", warnings(&record.quality));
        told
    })
}

/// The terms of a list with commas; those within brackets belong to a term.
fn listed(text: &str) -> Vec<String> {
    let mut depth = 0_usize;
    let parts = text.split(|character| {
        match character {
            '(' => depth += 1,
            ')' => depth = depth.saturating_sub(1),
            _ => {}
        }
        character == ',' && depth == 0
    });
    parts.map(|term| term.trim().to_owned()).collect()
}

fn text(found: &StepwiseRegression) -> String {
    let by = match found.criterion {
        Criterion::Pse => "the smallest predicted square error",
        Criterion::Press => "the smallest PRESS",
        Criterion::F => "the partial F",
    };
    let mut text = first_line(&found.reasons);
    // Writing to a string cannot fail.
    let _ = write!(
        text,
        "{}\n{} of {} rows, model `{}`, {} candidates, ended by {by}; F to enter {}, to remove {}\n\n",
        found.source,
        found.coefficient,
        found.rows,
        found.model,
        found.candidates.len(),
        significant(found.f_to_enter, 3),
        significant(found.f_to_remove, 3)
    );
    let mut steps = Table::with_words(
        &["step", "term", "R^2 %", "gain %", "PSE^0.5", "PRESS^0.5", "partial F", "taken", "nearly as good"],
        &[1, 7, 8],
    );
    for (index, step) in found.steps.iter().enumerate() {
        steps.row([
            index.to_string(),
            step.term.clone(),
            fixed(100.0 * step.r_squared, 2),
            if index == 0 { "-".to_owned() } else { fixed(100.0 * step.gain, 2) },
            significant(step.pse.sqrt(), 4),
            significant(step.press.sqrt(), 4),
            step.partial_f.map_or_else(|| "-".to_owned(), |f| significant(f, 3)),
            if step.taken { "yes" } else { "no" }.to_owned(),
            step.alike.join(", "),
        ]);
    }
    text.push_str(&steps.render());
    let _ = writeln!(
        text,
        "\n{} explains {} %; residual {} (one sigma)",
        found.coefficient,
        fixed(100.0 * found.r_squared, 2),
        significant(found.residual_std, 3)
    );
    let mut terms = Table::with_words(&["parameter", "term", "value", "+- 2 sigma", "partial F"], &[0, 1]);
    for term in &found.terms {
        terms.row([
            term.parameter.clone(),
            term.term.clone(),
            significant(term.value, 5),
            significant(2.0 * term.std_error, 3),
            significant(term.partial_f, 3),
        ]);
    }
    text.push_str(&terms.render());
    text.push_str(
        "\nDerivatives per radian. Bounds are corrected for residuals that last; what noise in the\nregressors does to \
         the values is not in them: estimate with these lines for final values.\n",
    );
    paragraph(&mut text, "Verdict", found.reasons.iter().map(|reason| reason.sentence.clone()));
    paragraph(&mut text, "Left out", found.remarks.iter().cloned());
    let mut section = None;
    for line in &found.lines {
        if section != Some(line.section.as_str()) {
            section = Some(line.section.as_str());
            let _ = match line.section.as_str() {
                "" => writeln!(text, "\nFor the model file"),
                name => writeln!(text, "\n[{name}]"),
            };
        }
        let _ = writeln!(text, "{}", line.line);
    }
    text
}

#[cfg(test)]
mod tests {
    use super::listed;

    #[test]
    fn a_comma_within_brackets_parts_nothing() {
        assert_eq!(listed("alpha, max(alpha - 0.1, 0),q_hat"), ["alpha", "max(alpha - 0.1, 0)", "q_hat"]);
    }
}
