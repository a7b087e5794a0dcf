//! A model file with identified values, as the exports to other programs need it.

use std::collections::BTreeMap;

use phugoid_aircraft::xml::escaped;
use phugoid_flight_data::statistics::median;

use crate::core::estimation::Estimation;
use crate::core::soundness::EstimationStatus;
use crate::core::term::{Coefficient, Term};
use crate::model_file::{Base, ModelFile, Parameter, ReferenceValue, Role};

/// Why a model cannot be written in the format of another program.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ExportError {
    /// The terms are increments to a database.
    #[error(
        "the model `{0}` holds increments to a database: {1} takes whole coefficients, and the database is no part of the \
         result. Estimate with a model file without `base`, whose terms are the whole coefficients"
    )]
    Increments(String, &'static str),
    /// The other format cannot express something in the model; the sentence says what.
    #[error("{0}")]
    NoPlace(String),
}

/// A model with its identified values.
#[derive(Clone, Debug, PartialEq)]
pub struct Identified<'a> {
    /// The model file whose terms are written.
    pub model: &'a ModelFile,
    /// Values by parameter name, per radian; a parameter that is missing here has its start value.
    pub values: BTreeMap<String, f64>,
    /// Standard errors by parameter name, per radian, random and systematic part together; one that is missing here was not
    /// estimated.
    pub std_errors: BTreeMap<String, f64>,
    /// Correlations of the errors of pairs of parameters, by their names.
    pub correlations: Vec<(String, String, f64)>,
    /// Angle of attack at which the terms' `alpha` is zero, rad.
    pub alpha_reference: f64,
    /// Angle of attack in the middle of the flight, rad: terms that the other format cannot express are approximated
    /// there.
    pub alpha_typical: f64,
    /// Elevator in the middle of the flight, rad; that of the reference where there was none.
    pub elevator_typical: f64,
    /// A sentence on where the values come from, for the head of the file.
    pub origin: String,
}

/// A model in the format of another program.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Exported {
    /// The text of the file.
    pub text: String,
    /// Notes for the user: what could not be expressed, what was approximated, and what the receiving model must have.
    pub notes: Vec<String>,
}

/// A term with its value.
pub(crate) struct Valued {
    pub(crate) name: String,
    pub(crate) term: Term,
    pub(crate) value: f64,
}

impl<'a> Identified<'a> {
    /// Takes the values of an estimation with this model file.
    pub fn new(model: &'a ModelFile, estimation: &Estimation) -> Self {
        let middle = |name: &str| {
            let signal =
                estimation.history.measured.iter().chain(&estimation.history.inputs).find(|s| s.name == name)?;
            median(&mut signal.values.iter().copied().filter(|v| v.is_finite()).collect::<Vec<f64>>())
        };
        Self {
            model,
            values: estimation.parameters.iter().map(|p| (p.name.clone(), p.value)).collect(),
            std_errors: estimation.parameters.iter().map(|p| (p.name.clone(), 0.25 * (p.upper - p.lower))).collect(),
            correlations: correlations(estimation),
            alpha_reference: estimation.alpha_reference,
            alpha_typical: middle("alpha").unwrap_or(estimation.alpha_reference),
            elevator_typical: middle("elevator").unwrap_or_else(|| given(model.reference.elevator)),
            origin: format!(
                "{}, model {}, estimator {}{}",
                estimation.source,
                estimation.model,
                estimation.method,
                match estimation.status {
                    EstimationStatus::Sound => "",
                    EstimationStatus::Provisional => ", PROVISIONAL: the flight does not settle these numbers",
                    EstimationStatus::Doubtful => ", DOUBTFUL: read the verdict before these numbers are used",
                    EstimationStatus::Refused => ", REFUSED: neither these numbers nor their bounds may be used",
                }
            ),
        }
    }

    /// Takes the start values of the model file.
    pub fn start(model: &'a ModelFile) -> Self {
        let alpha = given(model.reference.alpha);
        Self {
            model,
            values: BTreeMap::new(),
            std_errors: BTreeMap::new(),
            correlations: Vec::new(),
            alpha_reference: alpha,
            alpha_typical: alpha,
            elevator_typical: given(model.reference.elevator),
            origin: format!("start values of {}", model.source),
        }
    }

    /// # Errors
    /// Increments to a database.
    pub(super) fn absolute(&self, form: &'static str) -> Result<(), ExportError> {
        match self.model.base {
            Base::None => Ok(()),
            Base::F16 | Base::Aircraft => Err(ExportError::Increments(self.model.name.clone(), form)),
        }
    }

    /// The terms of a coefficient; an offset is a constant one.
    pub(crate) fn terms(&self, coefficient: Coefficient) -> Vec<Valued> {
        let of = |p: &Parameter| {
            let term = match &p.role {
                Role::Term(c, term) if *c == coefficient => term.clone(),
                Role::Offset(c) if *c == coefficient => Term::default(),
                _ => return None,
            };
            let value = self.values.get(&p.name).copied().unwrap_or(p.start);
            Some(Valued { name: p.name.clone(), term, value })
        };
        self.model.parameters.iter().filter_map(of).collect()
    }

    /// The deflection at which a surface's variable is zero, rad.
    ///
    /// # Errors
    /// It was taken from the record and is not in the result.
    pub(super) fn surface_reference(&self, surface: &str, value: ReferenceValue) -> Result<f64, ExportError> {
        match value {
            ReferenceValue::Given(value) => Ok(value),
            ReferenceValue::Trim | ReferenceValue::FirstSample => Err(ExportError::NoPlace(format!(
                "the reference of the {surface} was the first sample of the record, which the result does not hold: give it \
                 a value under [reference] in the model file"
            ))),
        }
    }
}

/// The correlations of all pairs of estimated parameters.
fn correlations(estimation: &Estimation) -> Vec<(String, String, f64)> {
    let parameters = &estimation.parameters;
    let mut pairs = Vec::new();
    for (i, (second, row)) in parameters.iter().zip(&estimation.correlation).enumerate() {
        for (first, value) in parameters.iter().zip(row).take(i) {
            if value.is_finite() && *value != 0.0 {
                pairs.push((first.name.clone(), second.name.clone(), *value));
            }
        }
    }
    pairs
}

/// The reference that the model file gives, rad; zero where it would come from a flight.
fn given(reference: ReferenceValue) -> f64 {
    match reference {
        ReferenceValue::Given(value) => value,
        ReferenceValue::Trim | ReferenceValue::FirstSample => 0.0,
    }
}

/// A text as it stands in a comment of XML, where two hyphens in a row would end the comment.
pub(super) fn in_comment(text: &str) -> String {
    // Of three hyphens the first replacement leaves two that stand together.
    escaped(text).replace("--", "- -").replace("--", "- -")
}

#[cfg(test)]
mod tests {
    use phugoid_aircraft::xml;

    use super::super::{gazebo, jsbsim};
    use super::*;

    /// A name may hold what XML has no place for: the files are well-formed all the same, and say the rest of the name.
    #[test]
    fn a_name_with_control_characters_gives_well_formed_files() {
        let mut model = ModelFile::named("hfb320").unwrap();
        model.name = "a \u{1b}[31m \u{0}<jet> & --- more\u{7}".to_owned();
        for write in [gazebo, jsbsim] {
            let text = write(&Identified::start(&model)).unwrap().text;
            let whole = format!("<file>{text}</file>");
            let document = xml::parse(&whole).unwrap_or_else(|error| panic!("{error}\n{text}"));
            let comments = document.root_element().descendants().filter(|node| node.is_comment());
            let said = comments.filter_map(|node| node.text()).any(|said| said.contains("- - - more"));
            assert!(said && !text.contains(|c: char| c.is_control() && c != '\n'), "{text}");
        }
    }
}
