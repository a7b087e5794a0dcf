//! Reads the check data of a model.

use super::document::{Signal, StaticShot};
use super::error::{DavemlError, brief};
use super::model::Model;
use super::tree::{Element, Lines, PASSED_OVER, content, elements, label, name};

/// Reads the shots of a `checkData` element.
pub(super) fn read(
    lines: &Lines,
    node: Element<'_>,
    model: &Model,
    into: &mut Vec<StaticShot>,
) -> Result<(), DavemlError> {
    for element in elements(node) {
        match name(element) {
            "staticShot" => into.push(shot(lines, element, model)?),
            passed if PASSED_OVER.contains(&passed) => {}
            _ => return Err(lines.unknown(element)),
        }
    }
    Ok(())
}

fn shot(lines: &Lines, node: Element<'_>, model: &Model) -> Result<StaticShot, DavemlError> {
    let mut shot = StaticShot {
        name: label(node, "name"),
        inputs: Vec::new(),
        internals: Vec::new(),
        outputs: Vec::new(),
        line: lines.line(node),
    };
    for list in elements(node) {
        let into = match name(list) {
            "checkInputs" => &mut shot.inputs,
            "internalValues" => &mut shot.internals,
            "checkOutputs" => &mut shot.outputs,
            passed if PASSED_OVER.contains(&passed) => continue,
            _ => return Err(lines.unknown(list)),
        };
        for element in elements(list) {
            if name(element) != "signal" {
                return Err(lines.unknown(element));
            }
            let signal = signal(lines, element, model, name(list))?;
            if name(list) == "checkInputs" && !model.can_be_set(signal.variable) {
                let id = model.variables()[signal.variable].id.clone();
                return Err(DavemlError::NotAnInput { id, line: Some(signal.line) });
            }
            into.push(signal);
        }
    }
    Ok(shot)
}

fn signal(lines: &Lines, node: Element<'_>, model: &Model, list: &str) -> Result<Signal, DavemlError> {
    let line = lines.line(node);
    let (mut named, mut identified, mut units) = (None, None, String::new());
    let (mut value, mut tolerance) = (None, None);
    for element in elements(node) {
        let text = || content(element).split_whitespace().collect::<Vec<_>>().join(" ");
        match name(element) {
            "signalName" => named = Some(text()),
            "varID" | "signalID" => identified = Some(text()),
            "signalUnits" => units = text(),
            // A file of NASA has an empty second value.
            "signalValue" if value.is_some() && text().is_empty() => {}
            "signalValue" => value = Some(lines.content_number(element)?),
            "tol" => tolerance = Some(lines.content_number(element)?.abs()),
            "description" => {}
            _ => return Err(lines.unknown(element)),
        }
    }
    let value = value.ok_or_else(|| lines.missing(node, "signalValue"))?;
    let name = identified.clone().or(named).ok_or_else(|| lines.missing(node, "signalName"))?;
    let variable = match identified {
        Some(id) => model.position_of_id(&id),
        None => model.position_in(&name, list == "checkInputs"),
    };
    let variable = variable.ok_or_else(|| {
        let name = brief(&name);
        DavemlError::UnknownSignal { name, line: Some(line) }
    })?;
    Ok(Signal { name, units, value, tolerance, variable, line })
}
