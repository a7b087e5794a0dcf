//! The thesis's sliding law for one increment on the F-16.

use phugoid_estimators::discretization::InputHold;
use phugoid_estimators::thesis::{
    Evaluation, SurfaceChannel, SurfaceDerivative, ThesisForm, ThesisLaw, ThesisSettings,
};
use phugoid_estimators::{Estimator, Sample};
use phugoid_identification::output::STATES;

use super::case::PARAMETERS;
use super::method::{MethodRun, ParameterRun, STEP_S};
use super::rates::{OUTPUTS_WITH_RATES, WithRates};
use super::reference::Reference;
use crate::accuracy::StudyError;

/// Foot, m.
const FOOT: f64 = 0.3048;

/// A sliding law for one increment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LawSettings {
    /// The increment, one of [`PARAMETERS`].
    pub parameter: &'static str,
    /// Form of the law.
    pub form: LawForm,
    /// Channels of its surface.
    pub surface: Surface,
    /// Lower and upper bound, per radian, of one sign.
    pub bounds: [f64; 2],
    /// Start value, per radian.
    pub start: f64,
    /// `lambda`, 1/s.
    pub lambda: f64,
    /// `eta`, in units of `z` with the surface's channels.
    pub eta: f64,
}

/// Which channels an energy surface has, and by what they are divided.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Surface {
    /// As printed: q (with p = r = 0) for the moment, alpha and V (with beta = 0) for lift and drag, in rad, rad/s and ft/s.
    Printed,
    /// The same channels, each divided by its typical size: 0.001 rad/s, 0.05 rad, 200 m/s.
    Scaled,
    /// Only the channel whose rate contains the coefficient, divided by its typical size.
    Own,
}

impl Surface {
    /// State (0 V, 1 alpha, 2 theta, 3 q) and scale (SI) of each channel.
    pub fn channels(self, parameter: &str) -> Vec<(usize, f64)> {
        const V: usize = 0;
        const ALPHA: usize = 1;
        const Q: usize = 3;
        let [v, alpha, q] = match self {
            Self::Printed => [FOOT, 1.0, 1.0],
            Self::Scaled | Self::Own => [200.0, 0.05, 1e-3],
        };
        match parameter {
            "dCm_alpha" | "dCm_q" => vec![(Q, q)],
            "dCD_alpha" if self == Self::Own => vec![(V, v)],
            "dCL_alpha" if self == Self::Own => vec![(ALPHA, alpha)],
            _ => vec![(ALPHA, alpha), (V, v)],
        }
    }
}

/// How the law is evaluated.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LawForm {
    /// Exactly as printed, its sign and its lack of limits included.
    AsPrinted(Evaluation),
    /// Solved at every sample, with the sign from `s s' < 0` and within a quarter of the bounds' width outside them.
    Solved(ThesisForm),
}

/// Runs a law beside a flight, told the states of the reference aircraft and their rates.
///
/// # Errors
/// [`StudyError::Unsuitable`] where the law refuses its settings.
pub(super) fn run_law(reference: &Reference, settings: &LawSettings) -> Result<MethodRun, StudyError> {
    match *settings.surface.channels(settings.parameter).as_slice() {
        [one] => run_on([one], reference, settings),
        [one, two] => run_on([one, two], reference, settings),
        _ => Err(StudyError::Unsuitable(format!("no surface for `{}`", settings.parameter))),
    }
}

/// Room for all of [`PARAMETERS`].
const ROOM: usize = PARAMETERS.len();

fn run_on<const S: usize>(
    channels: [(usize, f64); S],
    reference: &Reference,
    settings: &LawSettings,
) -> Result<MethodRun, StudyError> {
    let unsuitable = |what: String| StudyError::Unsuitable(format!("law for `{}`: {what}", settings.parameter));
    let model = WithRates(reference.model.clone());
    let index = reference.names.iter().position(|name| name == settings.parameter);
    let Some(index) = index else { return Err(unsuitable("the model does not have it".to_owned())) };
    let mut parameters = [0.0; ROOM];
    parameters.iter_mut().zip(&reference.starts).for_each(|(slot, start)| *slot = *start);
    parameters[index] = settings.start;
    let surface = channels.map(|(state, scale)| SurfaceChannel {
        state,
        output: state,
        scale,
        derivative: SurfaceDerivative::Output(STATES + state),
    });
    let mut law_settings = ThesisSettings::<STATES, ROOM, S>::new(index, parameters, settings.bounds, surface);
    law_settings.lambda = settings.lambda;
    law_settings.eta = settings.eta;
    law_settings.input_hold = InputHold::Linear;
    law_settings.maximum_step_s = STEP_S;
    law_settings = match settings.form {
        LawForm::AsPrinted(evaluation) => law_settings.as_printed(evaluation),
        LawForm::Solved(form) => ThesisSettings { form, ..law_settings },
    };
    let mut law: ThesisLaw<WithRates, STATES, OUTPUTS_WITH_RATES, ROOM, S> =
        ThesisLaw::new(model, law_settings).map_err(|error| unsuitable(error.to_string()))?;
    let samples = reference.time.len();
    let mut values = Vec::with_capacity(samples);
    let mut states = Vec::with_capacity(samples);
    let mut diagnostics = Vec::with_capacity(samples);
    for k in 0..samples {
        let (measured, rates) = (reference.states[k], reference.rates[k]);
        let outputs = std::array::from_fn(|i| if i < STATES { measured[i] } else { rates[i - STATES] });
        let estimate = law.update(&Sample { time_s: reference.time[k], input: reference.inputs[k], outputs });
        values.push(estimate.parameters[index]);
        states.push(*law.state());
        diagnostics.push(*law.diagnostics());
    }
    let parameters = vec![ParameterRun { name: settings.parameter.to_owned(), values, std_errors: None }];
    Ok(MethodRun { time_s: reference.time.clone(), parameters, states, law: Some(diagnostics) })
}
