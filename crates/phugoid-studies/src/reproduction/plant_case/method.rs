//! Runs one method on the samples of a plant.

use phugoid_estimators::smpe::{ParameterPrior, Smpe, SmpeSettings};
use phugoid_estimators::thesis::{SurfaceChannel, SurfaceDerivative, ThesisForm, ThesisLaw, ThesisSettings};
use phugoid_estimators::{Estimator, Model};

use super::plant::Visit;
use super::simulate::{MAXIMUM_STEP_S, PlantRun};
use super::{Parameter, PlantCase};
use crate::accuracy::StudyError;

/// A method with its settings. Start values and bounds are those of the case.
#[derive(Clone, Debug, PartialEq)]
pub enum MethodSettings {
    /// The flagship, which is not given the derivative.
    Flagship {
        /// One-sigma noise that it is told, per state.
        noise_sd: Vec<f64>,
    },
    /// The one-parameter law, solved implicitly at every sample.
    Implicit {
        /// Which form of the law.
        form: ThesisForm,
        /// 1/s.
        lambda: f64,
        /// In units of the surface's rate per unit of the parameter.
        eta: f64,
    },
}

/// What a method did, sample by sample.
#[derive(Clone, Debug, PartialEq)]
pub struct MethodRun {
    /// Estimates, `[parameter][sample]`, at the times of the [`PlantRun`].
    pub estimates: Vec<Vec<f64>>,
    /// One-sigma errors claimed, likewise; none from a method that claims none.
    pub std_error: Option<Vec<Vec<f64>>>,
    /// States of the estimated model, `[state][sample]`.
    pub states: Vec<Vec<f64>>,
}

/// Runs a method on the samples of a run of the case.
///
/// # Errors
/// [`StudyError::Unsuitable`]: the method refuses its settings.
pub fn run_method(case: &PlantCase, run: &PlantRun, method: &MethodSettings) -> Result<MethodRun, StudyError> {
    case.plant.visit(Runner { case, run, method })
}

struct Runner<'a> {
    case: &'a PlantCase,
    run: &'a PlantRun,
    method: &'a MethodSettings,
}

impl Visit for Runner<'_> {
    type Output = Result<MethodRun, StudyError>;

    fn visit<M, const N: usize, const R: usize, const P: usize, const I: usize>(self, model: &M) -> Self::Output
    where
        M: Model<N, R, P, Input = [f64; I]> + Copy + Sync,
    {
        let Self { case, run, method } = self;
        let unknowns: Vec<Parameter> = case.unknowns().map(|(_, parameter)| parameter).collect();
        let refused = |error: &dyn std::fmt::Display| StudyError::Unsuitable(format!("{}: {error}", case.title));
        let mut record = Record::new(P, N, run.time_s.len());
        match method {
            MethodSettings::Flagship { noise_sd } => {
                let priors: Vec<ParameterPrior> =
                    unknowns.iter().map(|p| ParameterPrior::bounded(p.start, p.lower, p.upper)).collect();
                // It needs no derivative, so it is given none.
                let sigma: [f64; R] = std::array::from_fn(|i| noise_sd.get(i).copied().unwrap_or(f64::INFINITY));
                let mut settings = SmpeSettings::<N, R, P>::automatic(&priors, sigma, case.sample_time.si())
                    .map_err(|error| refused(&error))?;
                settings.maximum_step_s = MAXIMUM_STEP_S;
                // The record begins with the input: its first 0.2 s are not at rest, and are what is to be judged.
                settings.start_window_s = 0.0;
                let mut flagship = Smpe::new(*model, settings).map_err(|error| refused(&error))?;
                let mut claimed = vec![Vec::with_capacity(run.time_s.len()); P];
                for mut sample in run.samples::<I, R>() {
                    sample.outputs[N] = f64::NAN;
                    let estimate = flagship.update(&sample);
                    record.push(&estimate.parameters, flagship.state());
                    for (series, value) in claimed.iter_mut().zip(estimate.corrected_std_error) {
                        series.push(value);
                    }
                }
                record.std_error = Some(claimed);
            }
            MethodSettings::Implicit { form, lambda, eta } => {
                let p = unknowns[0];
                let channel =
                    SurfaceChannel { state: 0, output: 0, scale: 1.0, derivative: SurfaceDerivative::Output(N) };
                let mut start = [0.0; P];
                for (slot, parameter) in start.iter_mut().zip(&unknowns) {
                    *slot = parameter.start;
                }
                let mut settings = ThesisSettings::new(0, start, [p.lower, p.upper], [channel]);
                settings.form = *form;
                settings.lambda = *lambda;
                settings.eta = *eta;
                settings.maximum_step_s = MAXIMUM_STEP_S;
                let mut law = ThesisLaw::<_, N, R, P, 1>::new(*model, settings).map_err(|error| refused(&error))?;
                for sample in run.samples::<I, R>() {
                    let estimate = law.update(&sample);
                    record.push(&estimate.parameters, law.state());
                }
            }
        }
        Ok(record)
    }
}

type Record = MethodRun;

impl MethodRun {
    fn new(parameters: usize, states: usize, samples: usize) -> Self {
        Self {
            estimates: vec![Vec::with_capacity(samples); parameters],
            std_error: None,
            states: vec![Vec::with_capacity(samples); states],
        }
    }

    fn push(&mut self, parameters: &[f64], state: &[f64]) {
        for (series, value) in self.estimates.iter_mut().zip(parameters) {
            series.push(*value);
        }
        for (series, value) in self.states.iter_mut().zip(state) {
            series.push(*value);
        }
    }
}
