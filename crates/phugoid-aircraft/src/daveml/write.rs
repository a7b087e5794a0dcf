//! An identified model as DAVE-ML, with its uncertainties and check data that it was evaluated for.

use std::collections::HashSet;
use std::fmt::Write as _;

use super::error::DavemlError;
use super::identified::{CheckPoint, Correlation, Expression, IdentifiedModel, Term};
use super::model::Model;
use crate::xml::escaped;

/// Tolerance of the check data that are written, relative to the larger of the value and one.
const TOLERANCE: f64 = 1e-9;
/// Deepest formula that is written; each level is a level of elements.
const MAX_FORMULA: usize = 60;

/// Why a model cannot be written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum WriteError {
    /// An identifier is no name in XML.
    #[error("`{0}` is no identifier: it needs a letter or _ first, then letters, digits, _, - or .")]
    Identifier(String),
    /// A name or identifier is used twice.
    #[error("`{0}` is there twice")]
    Repeated(String),
    /// A number is not finite, an uncertainty is negative or a correlation is beyond one.
    #[error("{what} of `{of}` is {value}")]
    Number {
        /// Which number.
        what: &'static str,
        /// Identifier of what has it.
        of: String,
        /// The number.
        value: f64,
    },
    /// A correlation is with something that has no uncertainty.
    #[error("a correlation names `{0}`, which is no term with an uncertainty")]
    Correlation(String),
    /// A check point does not give every input, or gives something else.
    #[error("the check point `{point}` gives no value of the input `{input}`, or one too many")]
    CheckPoint {
        /// Its name.
        point: String,
        /// The input.
        input: String,
    },
    /// A formula is nested deeper than 60 levels.
    #[error("the formula of `{0}` is nested too deep")]
    Deep(String),
    /// The file cannot be read back: a variable is not there, or variables need each other in a circle.
    #[error("the model contradicts itself: {0}")]
    Contradiction(#[from] DavemlError),
}

/// A text as an identifier: what has no place in one becomes `_`.
///
/// ```
/// assert_eq!(phugoid_aircraft::daveml::identifier("Cm alpha^2"), "Cm_alpha_2");
/// ```
pub fn identifier(text: &str) -> String {
    let letters = text.chars().map(|c| if c.is_ascii_alphanumeric() || matches!(c, '_' | '-' | '.') { c } else { '_' });
    let id: String = letters.collect();
    if id.starts_with(|c: char| c.is_ascii_alphabetic() || c == '_') { id } else { format!("_{id}") }
}

/// Writes a model. Numbers have all their digits; each uncertainty is a normal distribution with one sigma. What is
/// written was read back, and its check data are what came out.
///
/// # Errors
/// [`WriteError`]: identifiers, numbers, or variables that are not there.
pub fn write(model: &IdentifiedModel) -> Result<String, WriteError> {
    inspect(model)?;
    let body = body(model)?;
    let closed = |checks: &str| format!("{body}{checks}</DAVEfunc>\n");
    let read = Model::parse(&closed(""))?;
    let mut checks = String::new();
    for point in &model.check_points {
        checks.push_str(&shot(model, &read, point)?);
    }
    if checks.is_empty() {
        return Ok(closed(""));
    }
    Ok(closed(&format!("  <checkData>\n{checks}  </checkData>\n")))
}

fn named<'m>(name: &'m str, id: &'m str) -> &'m str {
    if name.trim().is_empty() { id } else { name }
}

fn inspect(model: &IdentifiedModel) -> Result<(), WriteError> {
    let mut ids: Vec<(&str, &str)> = Vec::new();
    ids.extend(model.constants.iter().map(|one| (one.id.as_str(), named(&one.name, &one.id))));
    ids.extend(model.inputs.iter().map(|one| (one.id.as_str(), named(&one.name, &one.id))));
    ids.extend(model.derived.iter().map(|one| (one.id.as_str(), named(&one.name, &one.id))));
    ids.extend(model.coefficients.iter().map(|one| (one.id.as_str(), named(&one.name, &one.id))));
    let terms = || model.coefficients.iter().flat_map(|coefficient| &coefficient.terms);
    ids.extend(terms().map(|term| (term.id.as_str(), term.id.as_str())));
    let mut seen = HashSet::new();
    let mut names = HashSet::new();
    for (id, name) in ids {
        if id.is_empty() || identifier(id) != id {
            return Err(WriteError::Identifier(id.to_owned()));
        }
        let name = name.split_whitespace().collect::<Vec<_>>().join(" ");
        if !seen.insert(id) {
            return Err(WriteError::Repeated(id.to_owned()));
        }
        if !names.insert(name.clone()) {
            return Err(WriteError::Repeated(name));
        }
    }
    let number = |what, of: &str, value: f64, sound: bool| match sound && value.is_finite() {
        true => Ok(()),
        false => Err(WriteError::Number { what, of: of.to_owned(), value }),
    };
    for constant in &model.constants {
        number("the value", &constant.id, constant.value, true)?;
    }
    for term in terms() {
        number("the value", &term.id, term.value, true)?;
        if let Some(uncertainty) = term.standard_uncertainty {
            number("the standard uncertainty", &term.id, uncertainty, uncertainty >= 0.0)?;
        }
    }
    let uncertain: HashSet<&str> =
        terms().filter(|term| term.standard_uncertainty.is_some()).map(|term| term.id.as_str()).collect();
    for Correlation { first, second, coefficient } in &model.correlations {
        number("the correlation", first, *coefficient, coefficient.abs() <= 1.0)?;
        for id in [first, second] {
            if !uncertain.contains(id.as_str()) || first == second {
                return Err(WriteError::Correlation(id.clone()));
            }
        }
    }
    Ok(())
}

/// Everything but check data and the end of the outermost element.
fn body(model: &IdentifiedModel) -> Result<String, WriteError> {
    let mut text = String::from(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<!DOCTYPE DAVEfunc PUBLIC \"-//AIAA//DTD for Flight Dynamic Models \
         - Functions 2.0//EN\" \"http://www.daveml.org/DTDs/2p0/DAVEfunc.dtd\">\n<DAVEfunc \
         xmlns=\"http://daveml.org/2010/DAVEML\">\n",
    );
    // Writing to a string cannot fail.
    let _ = write!(
        text,
        "  <fileHeader name=\"{}\">\n    <author name=\"{}\" org=\"{}\"/>\n    <creationDate date=\"{}\"/>\n",
        escaped(&model.name),
        escaped(&model.author),
        escaped(&model.organisation),
        escaped(&model.created)
    );
    describe(&mut text, "    ", &model.description);
    text.push_str("  </fileHeader>\n");
    for constant in &model.constants {
        let more = format!(" initialValue=\"{}\"", constant.value);
        open(&mut text, &constant.id, &constant.name, &constant.units, &more);
        describe(&mut text, "    ", &constant.description);
        text.push_str("  </variableDef>\n");
    }
    for input in &model.inputs {
        let sign = match input.sign.is_empty() {
            true => String::new(),
            false => format!(" sign=\"{}\"", escaped(&input.sign)),
        };
        open(&mut text, &input.id, &input.name, &input.units, &sign);
        describe(&mut text, "    ", &input.description);
        text.push_str("    <isInput/>\n");
        text.push_str(if input.standard { "    <isStdAIAA/>\n" } else { "" });
        text.push_str("  </variableDef>\n");
    }
    for derived in &model.derived {
        open(&mut text, &derived.id, &derived.name, &derived.units, "");
        text.push_str("    <calculation>\n      <math xmlns=\"http://www.w3.org/1998/Math/MathML\">\n");
        formula(&mut text, &derived.value, &derived.id, 0)?;
        text.push_str("      </math>\n    </calculation>\n  </variableDef>\n");
    }
    for coefficient in &model.coefficients {
        for term in &coefficient.terms {
            derivative(&mut text, model, term);
        }
    }
    for coefficient in &model.coefficients {
        open(&mut text, &coefficient.id, &coefficient.name, "nd", "");
        describe(&mut text, "    ", &coefficient.description);
        let products = coefficient.terms.iter().map(|term| {
            let ids = std::iter::once(&term.id).chain(&term.factors);
            Expression::Product(ids.cloned().map(Expression::Variable).collect())
        });
        text.push_str("    <calculation>\n      <math xmlns=\"http://www.w3.org/1998/Math/MathML\">\n");
        formula(&mut text, &Expression::Sum(products.collect()), &coefficient.id, 0)?;
        text.push_str("      </math>\n    </calculation>\n    <isOutput/>\n");
        text.push_str(if coefficient.standard { "    <isStdAIAA/>\n" } else { "" });
        text.push_str("  </variableDef>\n");
    }
    Ok(text)
}

/// The value of a term as a constant with its uncertainty.
fn derivative(text: &mut String, model: &IdentifiedModel, term: &Term) {
    let units = if term.units.is_empty() { "nd" } else { &term.units };
    open(text, &term.id, "", units, &format!(" initialValue=\"{}\"", term.value));
    if let Some(uncertainty) = term.standard_uncertainty {
        let _ = writeln!(
            text,
            "    <uncertainty effect=\"additive\">\n      <normalPDF numSigmas=\"1\">\n        \
             <bounds>{uncertainty}</bounds>"
        );
        // All `correlatesWith` come before the first `correlation`.
        for correlation in model.correlations.iter().filter(|correlation| correlation.first == term.id) {
            let _ = writeln!(text, "        <correlatesWith varID=\"{}\"/>", correlation.second);
        }
        for correlation in model.correlations.iter().filter(|correlation| correlation.second == term.id) {
            let (first, coefficient) = (&correlation.first, correlation.coefficient);
            let _ = writeln!(text, "        <correlation varID=\"{first}\" corrCoef=\"{coefficient}\"/>");
        }
        text.push_str("      </normalPDF>\n    </uncertainty>\n");
    }
    text.push_str("  </variableDef>\n");
}

fn open(text: &mut String, id: &str, name: &str, units: &str, more: &str) {
    let (name, units) = (escaped(named(name, id)), escaped(units));
    let _ = writeln!(text, "  <variableDef name=\"{name}\" varID=\"{id}\" units=\"{units}\"{more}>");
}

fn describe(text: &mut String, indent: &str, description: &str) {
    if !description.trim().is_empty() {
        let _ = writeln!(text, "{indent}<description>{}</description>", escaped(description));
    }
}

fn formula(text: &mut String, expression: &Expression, of: &str, depth: usize) -> Result<(), WriteError> {
    if depth > MAX_FORMULA {
        return Err(WriteError::Deep(of.to_owned()));
    }
    let indent = "  ".repeat(depth + 4);
    let apply = |text: &mut String, function: &str, operands: &[&Expression]| {
        let _ = writeln!(text, "{indent}<apply>\n{indent}  <{function}/>");
        for operand in operands {
            formula(text, operand, of, depth + 1)?;
        }
        let _ = writeln!(text, "{indent}</apply>");
        Ok(())
    };
    match expression {
        Expression::Number(number) if number.is_finite() => {
            let _ = writeln!(text, "{indent}<cn>{number}</cn>");
            Ok(())
        }
        Expression::Number(value) => {
            Err(WriteError::Number { what: "a number in the formula", of: of.to_owned(), value: *value })
        }
        Expression::Variable(id) => {
            let _ = writeln!(text, "{indent}<ci>{}</ci>", escaped(id));
            Ok(())
        }
        // The neutral element of an empty list, and what stands alone in one.
        Expression::Sum(all) | Expression::Product(all) | Expression::Largest(all) if all.len() < 2 => {
            match (all.first(), expression) {
                (Some(one), _) => formula(text, one, of, depth),
                (None, Expression::Sum(_)) => formula(text, &Expression::Number(0.0), of, depth),
                (None, Expression::Product(_)) => formula(text, &Expression::Number(1.0), of, depth),
                (None, _) => formula(text, &Expression::Number(f64::NEG_INFINITY), of, depth),
            }
        }
        Expression::Sum(all) => apply(text, "plus", &all.iter().collect::<Vec<_>>()),
        Expression::Product(all) => apply(text, "times", &all.iter().collect::<Vec<_>>()),
        Expression::Largest(all) => apply(text, "max", &all.iter().collect::<Vec<_>>()),
        Expression::Difference(first, second) => apply(text, "minus", &[first, second]),
        Expression::Quotient(first, second) => apply(text, "divide", &[first, second]),
        Expression::Magnitude(one) => apply(text, "abs", &[one]),
    }
}

/// A check case: the inputs of a point and what comes out for them.
fn shot(model: &IdentifiedModel, read: &Model, point: &CheckPoint) -> Result<String, WriteError> {
    let mut evaluator = read.evaluator();
    let mut text = format!("    <staticShot name=\"{}\">\n      <checkInputs>\n", escaped(&point.name));
    if let Some((other, _)) = point.inputs.iter().find(|(id, _)| !model.inputs.iter().any(|input| input.id == *id)) {
        return Err(WriteError::CheckPoint { point: point.name.clone(), input: other.clone() });
    }
    for input in &model.inputs {
        let mut given = point.inputs.iter().filter(|(id, _)| *id == input.id);
        let (Some((_, value)), None) = (given.next(), given.next()) else {
            return Err(WriteError::CheckPoint { point: point.name.clone(), input: input.id.clone() });
        };
        if !value.is_finite() {
            return Err(WriteError::Number { what: "the check input", of: input.id.clone(), value: *value });
        }
        evaluator.set(read.input_position(&input.id)?, *value);
        signal(&mut text, named(&input.name, &input.id), &input.units, *value, None);
    }
    text.push_str("      </checkInputs>\n");
    evaluator.run();
    let value = |id: &str| -> Result<f64, WriteError> {
        let value = evaluator.get(read.position(id)?);
        match value.is_finite() {
            true => Ok(value),
            false => Err(WriteError::Number { what: "the value at a check point", of: id.to_owned(), value }),
        }
    };
    if !model.derived.is_empty() {
        text.push_str("      <internalValues>\n");
        for derived in &model.derived {
            let value = value(&derived.id)?;
            let _ = writeln!(
                text,
                "        <signal>\n          <varID>{}</varID>\n          <signalValue>{value}</signalValue>\n        \
                 </signal>",
                derived.id
            );
        }
        text.push_str("      </internalValues>\n");
    }
    text.push_str("      <checkOutputs>\n");
    for coefficient in &model.coefficients {
        let value = value(&coefficient.id)?;
        signal(
            &mut text,
            named(&coefficient.name, &coefficient.id),
            "nd",
            value,
            Some(TOLERANCE * value.abs().max(1.0)),
        );
    }
    text.push_str("      </checkOutputs>\n    </staticShot>\n");
    Ok(text)
}

fn signal(text: &mut String, name: &str, units: &str, value: f64, tolerance: Option<f64>) {
    let _ = write!(
        text,
        "        <signal>\n          <signalName>{}</signalName>\n          <signalUnits>{}</signalUnits>\n          \
         <signalValue>{value}</signalValue>\n",
        escaped(name),
        escaped(units)
    );
    if let Some(tolerance) = tolerance {
        let _ = writeln!(text, "          <tol>{tolerance}</tol>");
    }
    text.push_str("        </signal>\n");
}
