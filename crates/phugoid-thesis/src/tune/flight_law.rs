//! The thesis's law on the F-16 cases with one unknown increment: what to expect, and one run.

use crate::laws::ThesisForm;
use phugoid_estimators::{LinearizedRates, Model};
use phugoid_identification::longitudinal::{LongitudinalModel, OUTPUTS, STATES};

use super::plant_law::{Point, summary};
use super::rule::Expected;
use crate::aircraft_case::{
    AircraftCase, LawForm, LawSettings, Method, MethodRun, NamedMethod, ParameterSettings, Reference, Surface, fly,
    model_file, run_method,
};
use crate::result::Role;
use phugoid_evaluation::accuracy::StudyError;
use phugoid_simulation::flight::Flight;

/// The one increment of a case.
///
/// # Errors
/// [`StudyError::Unsuitable`] where there are more.
pub(super) fn unknown(case: &AircraftCase, name: &str) -> Result<(&'static str, ParameterSettings), StudyError> {
    match case.unknowns()[..] {
        [one] => Ok(one),
        ref all => Err(StudyError::Unsuitable(format!(
            "{name}: the thesis's law carries one parameter, this case has {}",
            all.len()
        ))),
    }
}

/// Runs the law on the channel whose rate contains the increment.
pub(super) fn run(
    case: &AircraftCase,
    flight: &Flight,
    unknown: (&'static str, ParameterSettings),
    [lambda, eta]: [f64; 2],
    form: ThesisForm,
) -> Option<MethodRun> {
    let (parameter, told) = unknown;
    let law = LawSettings {
        parameter,
        form: LawForm::Solved(form),
        surface: Surface::Own,
        bounds: [told.lower, told.upper],
        start: told.start(),
        lambda,
        eta,
    };
    let method = NamedMethod { name: "thesis law".to_owned(), role: Role::Published, method: Method::Laws(vec![law]) };
    run_method(case, flight, &method).ok()
}

/// What to expect of a case: the flight with the start value for the truth.
pub(super) fn expected(
    case: &AircraftCase,
    unknown: (&'static str, ParameterSettings),
) -> Result<Expected, StudyError> {
    const ROOM: usize = 1;
    let (name, told) = unknown;
    let mut nominal = case.clone();
    if let Some(increment) = nominal.scenario.increments.longitudinal_mut(name) {
        *increment = told.start();
    }
    let reference = Reference::new(&fly(&nominal)?, &model_file(case)?)?;
    let [(state, scale)] = Surface::Own.channels(name)[..] else {
        return Err(StudyError::Unsuitable(format!("no surface for `{name}`")));
    };
    let half_width = 0.5 * (told.upper - told.lower);
    let mut points = Vec::with_capacity(reference.time.len());
    let mut out = LinearizedRates::<STATES, ROOM>::ZERO;
    let from = reference.input_starts_s.unwrap_or(0.0);
    for (k, x) in reference.states.iter().enumerate().filter(|(k, _)| reference.time[*k] >= from) {
        let model: &LongitudinalModel = &reference.model;
        let theta = [told.start()];
        Model::<STATES, OUTPUTS, ROOM>::linearized_rates(model, x, &theta, &reference.inputs[k], &mut out);
        points.push(Point {
            signal: x[state] / scale,
            rate: reference.rates[k][state] / scale,
            regressors: vec![out.regressors[state][0] / scale * half_width],
        });
    }
    let times = [1.0 / case.scenario.sample_rate.si(), case.scenario.duration.si() - from];
    Ok(summary(&points, times, 0.0, (told.start().abs() / half_width, half_width)))
}
