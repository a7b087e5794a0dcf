//! One method on one flight of a case.

use crate::laws::{Diagnostics, Evaluation, ThesisForm};
use phugoid_estimators::discretization::{InputHold, IntervalInput, simulate};
use phugoid_identification::estimate::{EstimateOptions, estimate};
use phugoid_identification::longitudinal::STATES;
use phugoid_identification::model_file::ModelFile;

use super::case::{AircraftCase, ParameterSettings};
use super::law::{LawForm, LawSettings, Surface, run_laws};
use super::model::model_file;
use super::reference::Reference;
use crate::result::Role;
use phugoid_evaluation::accuracy::StudyError;
use phugoid_simulation::flight::Flight;

/// Longest integration step of the estimated aircraft, s: that of the reference at 100 Hz.
pub(super) const STEP_S: f64 = 0.005;

/// A method with its settings.
#[derive(Clone, Debug, PartialEq)]
pub struct NamedMethod {
    /// As printed, e.g. `printed law, implicit`.
    pub name: String,
    /// What it is to the reader.
    pub role: Role,
    /// The method with its settings.
    pub method: Method,
}

/// What estimates the increments of a flight.
#[derive(Clone, Debug, PartialEq)]
pub enum Method {
    /// The flagship with what it is told, see [`model_file`].
    Flagship(Box<ModelFile>),
    /// Sliding laws side by side, one per increment. Increments without a law stay at their start values.
    Laws(Vec<LawSettings>),
}

impl NamedMethod {
    /// The flagship as a case tells it.
    ///
    /// # Errors
    /// As [`model_file`].
    pub fn flagship(case: &AircraftCase) -> Result<Self, StudyError> {
        let method = Method::Flagship(Box::new(model_file(case)?));
        Ok(Self { name: "flagship".to_owned(), role: Role::Flagship, method })
    }
}

impl AircraftCase {
    /// The methods that the report shows, with the settings of the file: the flagship, the laws as printed, the printed law
    /// with its channels scaled, and its damped form.
    ///
    /// # Errors
    /// As [`model_file`].
    pub fn methods(&self) -> Result<Vec<NamedMethod>, StudyError> {
        type Eta = fn(&ParameterSettings) -> f64;
        const LAWS: [(&str, Role, LawForm, Surface, Eta); 4] = [
            (
                "printed law, one-sample delay",
                Role::Published,
                LawForm::AsPrinted(Evaluation::Delayed),
                Surface::Printed,
                |told| told.eta,
            ),
            (
                "printed law, implicit",
                Role::Published,
                LawForm::AsPrinted(Evaluation::Implicit),
                Surface::Printed,
                |told| told.eta,
            ),
            (
                "printed law, implicit, scaled, sign from the slope",
                Role::Mended,
                LawForm::Solved(ThesisForm::Printed),
                Surface::Scaled,
                |told| told.scaled_eta,
            ),
            (
                "damped law, implicit, own channel",
                Role::Mended,
                LawForm::Solved(ThesisForm::Damped),
                Surface::Own,
                |told| told.damping,
            ),
        ];
        let mut methods = vec![NamedMethod::flagship(self)?];
        for (name, role, form, surface, eta) in LAWS {
            let laws = self.unknowns().into_iter().map(|(parameter, told)| LawSettings {
                parameter,
                form,
                surface,
                bounds: [told.lower, told.upper],
                start: told.start(),
                lambda: told.lambda,
                eta: eta(&told),
            });
            methods.push(NamedMethod { name: name.to_owned(), role, method: Method::Laws(laws.collect()) });
        }
        Ok(methods)
    }
}

/// What a method said of one increment.
#[derive(Clone, Debug, PartialEq)]
pub struct ParameterRun {
    /// Name of the increment, for instance `dCm_alpha`.
    pub name: String,
    /// Estimate after each sample, per radian.
    pub values: Vec<f64>,
    /// One-sigma error that the method claims after each sample; none if it claims none.
    pub std_errors: Option<Vec<f64>>,
    /// Surface, reaching condition and gain after each sample, where it is a sliding law that found it. In units of the
    /// law's channels.
    pub inside: Option<Vec<Diagnostics>>,
}

/// What a method made of a flight.
#[derive(Clone, Debug, PartialEq)]
pub struct MethodRun {
    /// Times of the samples from the start of the record, s.
    pub time_s: Vec<f64>,
    /// The increments that were looked for, each with its estimates.
    pub parameters: Vec<ParameterRun>,
    /// The estimated aircraft, V, alpha, theta, q (SI), flying beside the reference from the same input with the current
    /// estimates, never corrected.
    pub states: Vec<[f64; STATES]>,
}

/// Runs a method on a flight of a case (or of a scenario that differs from the case's in its sensors, gusts or input).
///
/// # Errors
/// [`StudyError`]: a channel that the method needs is missing, or its settings are refused.
pub fn run_method(case: &AircraftCase, flight: &Flight, settings: &NamedMethod) -> Result<MethodRun, StudyError> {
    match &settings.method {
        Method::Flagship(model) => run_flagship(flight, model),
        Method::Laws(laws) => run_laws(&Reference::new(flight, &model_file(case)?)?, laws),
    }
}

fn run_flagship(flight: &Flight, model: &ModelFile) -> Result<MethodRun, StudyError> {
    let options = EstimateOptions { truth: flight.true_parameters.clone(), ..EstimateOptions::causal() };
    let history = estimate(&flight.measured, model, &options, &mut |_| {})?.history;
    let reference = Reference::new(flight, model)?;
    let parameters: Vec<ParameterRun> = history
        .parameters
        .into_iter()
        .filter(|parameter| reference.names.contains(&parameter.name))
        .map(|p| ParameterRun { name: p.name, values: p.value, std_errors: Some(p.std_error), inside: None })
        .collect();
    let values: Vec<&[f64]> = parameters.iter().map(|p| p.values.as_slice()).collect();
    let states = estimated_aircraft(&reference, &values);
    Ok(MethodRun { time_s: history.time_s, parameters, states })
}

/// The estimated aircraft: started with the reference, it flies from the same input with the estimates of each instant.
fn estimated_aircraft(reference: &Reference, estimates: &[&[f64]]) -> Vec<[f64; STATES]> {
    let Some(mut x) = reference.states.first().copied() else { return Vec::new() };
    let mut states = Vec::with_capacity(reference.time.len());
    states.push(x);
    for (k, (time, inputs)) in reference.time.windows(2).zip(reference.inputs.windows(2)).enumerate() {
        let theta: [f64; ROOM] = std::array::from_fn(|j| estimates.get(j).map_or(0.0, |values| values[k]));
        // The input knows itself what of it is held.
        let input = IntervalInput { from: inputs[0], to: inputs[1], hold: InputHold::Linear };
        x = simulate(&reference.model, &x, &theta, &input, time[1] - time[0], STEP_S);
        states.push(x);
    }
    states
}

/// Room for increments: the four of the thesis and the elevator's effectiveness.
const ROOM: usize = 5;
