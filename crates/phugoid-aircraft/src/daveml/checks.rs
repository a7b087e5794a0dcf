//! Compares a model with its own check data.

use super::document::Signal;
use super::model::Model;
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

fn check(model: &Model) -> CheckReport {
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

impl Model {
    /// Compares the model with its own check data. Values whose unit is of the same kind as that of the variable and
    /// another are converted.
    pub fn check(&self) -> CheckReport {
        check(self)
    }
}
