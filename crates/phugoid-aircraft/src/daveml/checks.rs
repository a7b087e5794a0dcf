//! Check data of a model: reading it, and comparing the model with it.

use super::document::{Signal, StaticShot};
use super::error::{DavemlError, brief};
use super::model::Model;
use super::tables::PASSED_OVER;
use super::tree::{Element, Lines, content, elements, label, name};
use super::units::converted;

/// What is allowed where check data state no tolerance, relative to the larger of the value and one.
pub const DEFAULT_TOLERANCE: f64 = 1e-6;

/// Which list of a static shot a signal is from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// An internal value, given to find mistakes with.
    Internal,
    /// An output, which decides.
    Output,
}

/// How a model compares with its own check data; made by [`Model::check`].
#[derive(Clone, Debug, PartialEq)]
pub struct CheckReport {
    /// One for each static shot, in the order of the file.
    pub shots: Vec<ShotReport>,
}

/// How a model compares with one static shot.
#[derive(Clone, Debug, PartialEq)]
pub struct ShotReport {
    /// Name of the shot.
    pub name: String,
    /// Its line, from 1.
    pub line: u32,
    /// Internal values and outputs.
    pub signals: Vec<SignalReport>,
}

/// One value of check data beside what the model gives.
#[derive(Clone, Debug, PartialEq)]
pub struct SignalReport {
    /// Identifier of the variable.
    pub id: String,
    /// Internal value or output.
    pub kind: Kind,
    /// What the check data say, in the unit of the variable.
    pub expected: f64,
    /// What the model gives, in the unit of the variable; NaN if it cannot be computed.
    pub found: f64,
    /// Largest difference that is allowed, in the unit of the variable.
    pub tolerance: f64,
    /// Whether the file states the tolerance; if not it is [`DEFAULT_TOLERANCE`].
    pub tolerance_stated: bool,
    /// Whether the difference is within the tolerance. NaN is not.
    pub passed: bool,
    /// Line of the signal, from 1.
    pub line: u32,
}

impl CheckReport {
    /// Whether every output of every shot is within its tolerance. True where there are no shots.
    pub fn passed(&self) -> bool {
        self.shots.iter().all(ShotReport::passed)
    }

    /// Number of shots of which every output is within its tolerance.
    pub fn shots_passed(&self) -> usize {
        self.shots.iter().filter(|shot| shot.passed()).count()
    }

    /// Every signal that is not within its tolerance, with its shot; internal values too.
    pub fn failures(&self) -> impl Iterator<Item = (&ShotReport, &SignalReport)> {
        let failed = |shot: &ShotReport| -> Vec<usize> {
            (0..shot.signals.len()).filter(|signal| !shot.signals[*signal].passed).collect()
        };
        self.shots.iter().flat_map(move |shot| failed(shot).into_iter().map(move |k| (shot, &shot.signals[k])))
    }
}

impl ShotReport {
    /// Whether every output is within its tolerance; internal values do not count.
    pub fn passed(&self) -> bool {
        self.signals.iter().all(|signal| signal.passed || signal.kind == Kind::Internal)
    }

    /// Whether every internal value is within its tolerance.
    pub fn internals_passed(&self) -> bool {
        self.signals.iter().all(|signal| signal.passed || signal.kind == Kind::Output)
    }
}

/// Compares a model with its check data.
pub(super) fn check(model: &Model) -> CheckReport {
    let mut evaluator = model.evaluator();
    let shots = model.shots().iter().map(|shot| {
        evaluator.reset();
        for input in &shot.inputs {
            let unit = &model.variables()[input.variable].units;
            evaluator.set(input.variable, converted(input.value, &input.units, unit));
        }
        evaluator.run();
        let internals = shot.internals.iter().map(|signal| (Kind::Internal, signal));
        let outputs = shot.outputs.iter().map(|signal| (Kind::Output, signal));
        let signals =
            internals.chain(outputs).map(|(kind, signal)| compare(model, kind, signal, evaluator.get(signal.variable)));
        ShotReport { name: shot.name.clone(), line: shot.line, signals: signals.collect() }
    });
    CheckReport { shots: shots.collect() }
}

fn compare(model: &Model, kind: Kind, signal: &Signal, found: f64) -> SignalReport {
    let variable = &model.variables()[signal.variable];
    let expected = converted(signal.value, &signal.units, &variable.units);
    // A tolerance is a difference: the zero of a scale of temperature does not count.
    let difference = |value| converted(value, &signal.units, &variable.units);
    let stated = signal.tolerance.map(|tolerance| (difference(tolerance) - difference(0.0)).abs());
    let tolerance = stated.unwrap_or(DEFAULT_TOLERANCE * expected.abs().max(1.0));
    SignalReport {
        id: variable.id.clone(),
        kind,
        expected,
        found,
        tolerance,
        tolerance_stated: stated.is_some(),
        passed: (found - expected).abs() <= tolerance,
        line: signal.line,
    }
}

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
