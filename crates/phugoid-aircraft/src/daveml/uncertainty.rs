//! Reads how uncertain a variable or a table is.

use super::document::{Bound, Distribution, Effect, Uncertainty};
use super::error::DavemlError;
use super::tree::{Element, Lines, elements, name};

/// An `uncertainty` element.
pub(super) fn uncertainty(lines: &Lines, node: Element<'_>) -> Result<Uncertainty, DavemlError> {
    lines.attribute(node, "effect")?;
    let effects = [
        ("additive", Effect::Additive),
        ("multiplicative", Effect::Multiplicative),
        ("percentage", Effect::Percentage),
        ("absolute", Effect::Absolute),
    ];
    let allowed = "additive, multiplicative, percentage, absolute";
    let effect = lines.choice(node, "effect", &effects, Effect::Additive, allowed)?;
    let mut children = elements(node);
    let distribution = children.next().ok_or_else(|| lines.missing(node, "normalPDF"))?;
    if let Some(second) = children.next() {
        return Err(lines.unknown(second));
    }
    let mut bounds = Vec::new();
    let (mut correlates_with, mut correlations) = (Vec::new(), Vec::new());
    for element in elements(distribution) {
        match name(element) {
            "bounds" => bounds.push(bound(lines, element)?),
            "correlatesWith" => correlates_with.push(lines.attribute(element, "varID")?.to_owned()),
            "correlation" => {
                let with = lines.attribute(element, "varID")?.to_owned();
                let text = lines.attribute(element, "corrCoef")?;
                correlations.push((with, lines.number(element, text, "the attribute `corrCoef`")?));
            }
            _ => return Err(lines.unknown(element)),
        }
    }
    if bounds.is_empty() {
        return Err(lines.missing(distribution, "bounds"));
    }
    let distribution = match name(distribution) {
        "normalPDF" => {
            let text = lines.attribute(distribution, "numSigmas")?;
            let place = "the attribute `numSigmas`";
            let sigmas = lines.number(distribution, text, place)?;
            if sigmas <= 0.0 {
                let (text, place) = (text.to_owned(), format!("{place}, which has to be positive,"));
                return Err(DavemlError::Number { text, place, line: lines.line(distribution) });
            }
            let bound = bounds.swap_remove(0);
            Distribution::Normal { sigmas, bound, correlates_with, correlations }
        }
        "uniformPDF" => Distribution::Uniform { bounds },
        _ => return Err(lines.unknown(distribution)),
    };
    Ok(Uncertainty { effect, distribution })
}

fn bound(lines: &Lines, node: Element<'_>) -> Result<Bound, DavemlError> {
    match elements(node).next() {
        None => lines.content_number(node).map(Bound::Value),
        Some(inside) => match name(inside) {
            "dataTable" => Ok(Bound::Table(lines.numbers(inside)?.into())),
            "variableDef" | "variableRef" => Ok(Bound::Variable(lines.attribute(inside, "varID")?.to_owned())),
            _ => Err(lines.unknown(inside)),
        },
    }
}
