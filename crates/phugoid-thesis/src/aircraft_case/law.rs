//! The thesis's sliding laws on the F-16: one per increment, any number of them side by side.

use crate::laws::{Diagnostics, Evaluation, SurfaceChannel, SurfaceDerivative, ThesisForm, ThesisLaw, ThesisSettings};
use phugoid_estimators::discretization::InputHold;
use phugoid_estimators::{Estimator, Sample};
use phugoid_identification::longitudinal::{LongitudinalInput, STATES};

use super::case::PARAMETERS;
use super::method::{MethodRun, ParameterRun, STEP_S};
use super::rates::{OUTPUTS_WITH_RATES, WithRates};
use super::reference::Reference;
use crate::units::FOOT;
use phugoid_evaluation::accuracy::StudyError;

/// A sliding law for one increment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LawSettings {
    /// The increment, one of [`PARAMETERS`].
    pub parameter: &'static str,
    /// The form of the law that is evaluated.
    pub form: LawForm,
    /// The channels that make up its surface.
    pub surface: Surface,
    /// Lower and upper bound, per radian, of one sign.
    pub bounds: [f64; 2],
    /// Estimate before the first sample, per radian.
    pub start: f64,
    /// `lambda`, the rate at which the energy difference decays on the surface, 1/s.
    pub lambda: f64,
    /// `eta`, in units of `z` with the surface's channels.
    pub eta: f64,
}

/// How a law is evaluated.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LawForm {
    /// Exactly as printed, its sign and its lack of limits included.
    AsPrinted(Evaluation),
    /// Solved at every sample, with the sign from `s s' < 0` and within a quarter of the bounds' width outside them.
    Solved(ThesisForm),
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

/// Room for all of [`PARAMETERS`].
const ROOM: usize = PARAMETERS.len();

type RatesSample = Sample<LongitudinalInput, OUTPUTS_WITH_RATES>;

/// A law whose number of channels is of no concern.
trait Running {
    /// Takes a sample and gives the estimate.
    fn take(&mut self, sample: &RatesSample) -> f64;
    /// Tells it what another law has found.
    fn tell(&mut self, parameter: usize, value: f64);
    /// The estimated aircraft.
    fn aircraft(&self) -> [f64; STATES];
    /// The law from inside.
    fn inside(&self) -> Diagnostics;
}

struct On<const S: usize> {
    law: ThesisLaw<WithRates, STATES, OUTPUTS_WITH_RATES, ROOM, S>,
    index: usize,
}

impl<const S: usize> Running for On<S> {
    fn take(&mut self, sample: &RatesSample) -> f64 {
        self.law.update(sample).parameters[self.index]
    }

    fn tell(&mut self, parameter: usize, value: f64) {
        self.law.set_known(parameter, value);
    }

    fn aircraft(&self) -> [f64; STATES] {
        *self.law.state()
    }

    fn inside(&self) -> Diagnostics {
        *self.law.diagnostics()
    }
}

/// Runs laws side by side beside a flight, told the states of the reference aircraft and their rates as its sensors give
/// them. Each has the estimates of all others after every sample, so that the estimated aircraft of all of them are one.
///
/// # Errors
/// [`StudyError::Unsuitable`] where a law refuses its settings.
pub(super) fn run_laws(reference: &Reference, settings: &[LawSettings]) -> Result<MethodRun, StudyError> {
    let index_of = |name: &str| {
        let index = reference.names.iter().position(|own| own == name);
        index.ok_or_else(|| StudyError::Unsuitable(format!("law for `{name}`: the model does not have it")))
    };
    let indices: Vec<usize> = settings.iter().map(|law| index_of(law.parameter)).collect::<Result<_, _>>()?;
    let mut laws: Vec<Box<dyn Running>> =
        settings.iter().zip(&indices).map(|(law, index)| running(reference, law, *index)).collect::<Result<_, _>>()?;
    let samples = reference.time.len();
    let mut parameters: Vec<ParameterRun> = settings
        .iter()
        .map(|law| ParameterRun {
            name: law.parameter.to_owned(),
            values: Vec::with_capacity(samples),
            std_errors: None,
            inside: Some(Vec::with_capacity(samples)),
        })
        .collect();
    let mut states = Vec::with_capacity(samples);
    for k in 0..samples {
        let (measured, rates) = (reference.measured_states[k], reference.measured_rates[k]);
        let outputs = std::array::from_fn(|i| if i < STATES { measured[i] } else { rates[i - STATES] });
        let sample = RatesSample { time_s: reference.time[k], input: reference.inputs[k], outputs };
        let found: Vec<f64> = laws.iter_mut().map(|law| law.take(&sample)).collect();
        for (i, law) in laws.iter_mut().enumerate() {
            for (j, value) in found.iter().enumerate().filter(|(j, _)| *j != i) {
                law.tell(indices[j], *value);
            }
        }
        for ((parameter, law), value) in parameters.iter_mut().zip(&laws).zip(found) {
            parameter.values.push(value);
            if let Some(inside) = &mut parameter.inside {
                inside.push(law.inside());
            }
        }
        states.push(laws.first().map_or(measured, |law| law.aircraft()));
    }
    Ok(MethodRun { time_s: reference.time.clone(), parameters, states })
}

fn running(reference: &Reference, settings: &LawSettings, index: usize) -> Result<Box<dyn Running>, StudyError> {
    match *settings.surface.channels(settings.parameter).as_slice() {
        [one] => Ok(Box::new(law(reference, settings, index, [one])?)),
        [one, two] => Ok(Box::new(law(reference, settings, index, [one, two])?)),
        _ => Err(StudyError::Unsuitable(format!("no surface for `{}`", settings.parameter))),
    }
}

fn law<const S: usize>(
    reference: &Reference,
    settings: &LawSettings,
    index: usize,
    channels: [(usize, f64); S],
) -> Result<On<S>, StudyError> {
    let mut parameters = [0.0; ROOM];
    parameters.iter_mut().zip(&reference.starts).for_each(|(slot, start)| *slot = *start);
    parameters[index] = settings.start;
    let surface = channels.map(|(state, scale)| SurfaceChannel {
        state,
        output: state,
        scale,
        derivative: SurfaceDerivative::Output(STATES + state),
    });
    let common = ThesisSettings::<STATES, ROOM, S> {
        lambda: settings.lambda,
        eta: settings.eta,
        // The input knows itself what of it is held.
        input_hold: InputHold::Linear,
        maximum_step_s: STEP_S,
        ..ThesisSettings::new(index, parameters, settings.bounds, surface)
    };
    let settings_of_form = match settings.form {
        LawForm::AsPrinted(evaluation) => common.as_printed(evaluation),
        LawForm::Solved(form) => ThesisSettings { form, ..common },
    };
    let law = ThesisLaw::new(WithRates(reference.model.clone()), settings_of_form)
        .map_err(|error| StudyError::Unsuitable(format!("law for `{}`: {error}", settings.parameter)))?;
    Ok(On { law, index })
}
