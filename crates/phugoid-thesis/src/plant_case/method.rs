//! Runs one method on the samples of a plant.

use crate::laws::{
    Evaluation, ExtendedLaw, ExtendedSettings, LawSign, SurfaceChannel, SurfaceDerivative, ThesisForm, ThesisLaw,
    ThesisSettings, TwoParameterLaw, TwoParameterSettings,
};
use crate::plants::{SecondOrder, SecondOrderNonlinear};
use phugoid_estimators::settings::{EstimatorSettings, ParameterPrior};
use phugoid_estimators::smpe::Smpe;
use phugoid_estimators::{Estimator, Model, Phase};

use super::format::{Parameter, PlantCase};
use super::plant::{Plant, ROOM, Visit};
use super::simulate::{MAXIMUM_STEP_S, PlantRun};
use phugoid_evaluation::accuracy::StudyError;

/// A method with its settings. Start values and bounds are those of the case.
#[derive(Clone, Debug, PartialEq)]
pub enum Method {
    /// The flagship, which is not given the derivative.
    Flagship {
        /// One-sigma noise that it is told, per state.
        noise_std: Vec<f64>,
    },
    /// The one-parameter law, for the plants that have one. It is given the measured derivative.
    OneParameter {
        /// Which form of the law.
        form: ThesisForm,
        /// How its algebraic loop is closed.
        evaluation: Evaluation,
        /// As printed, or from the slope of the surface.
        sign: LawSign,
        /// `lambda`, 1/s; used as it is, whatever the sample time.
        lambda: f64,
        /// `eta`, in units of the surface's rate per unit of the parameter.
        eta: f64,
    },
    /// The two-parameter law over two surfaces, for the plants that have two. It is given the measured derivative.
    TwoParameter {
        /// Which form of the law.
        form: ThesisForm,
        /// How its algebraic loop is closed.
        evaluation: Evaluation,
        /// As printed, or from the slope of the surface.
        sign: LawSign,
        /// `lambda` of each surface, 1/s.
        lambda: [f64; 2],
        /// `eta`, in units of the surface's rate per unit of the parameter.
        eta: f64,
    },
    /// The repair: equations of many instants, without any derivative, until the surfaces have full rank.
    Extended {
        /// Typical size of each state.
        scale: Vec<f64>,
        /// Time in which the whole range from bound to bound is crossed, s.
        reaching_time_s: f64,
        /// Information below which a direction moves more slowly: what noise alone accumulates, scaled state units squared
        /// times seconds.
        floor: f64,
    },
}

/// What a method did, sample by sample.
#[derive(Clone, Debug, PartialEq)]
pub struct MethodRun {
    /// Estimates, `[parameter][sample]`, at the times of the [`PlantRun`].
    pub estimates: Vec<Vec<f64>>,
    /// One-sigma errors claimed, likewise; none from a method that claims none.
    pub std_error: Option<Vec<Vec<f64>>>,
    /// States of the estimated model, `[state][sample]`; empty for a method that has none.
    pub states: Vec<Vec<f64>>,
    /// The printed laws from inside, one per surface; empty for other methods.
    pub surfaces: Vec<Surface>,
    /// Largest and smallest singular value, per sample, of what the surfaces say of the parameters: of two-parameter law and
    /// extended law.
    pub information: Vec<[f64; 2]>,
    /// Samples at which an implicit law found no solution of its loop and kept the last estimate.
    pub unsolved: usize,
}

/// A surface of a printed law, sample by sample.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Surface {
    /// The surface `s` itself; zero when the law has reached it.
    pub surface: Vec<f64>,
    /// `s sdot + eta |s|`: the reaching condition holds where it is not positive.
    pub reaching: Vec<f64>,
    /// `K`, the gain from the bounds.
    pub gain: Vec<f64>,
    /// `E`, the energy difference of model and measurement; NaN for the two-parameter law, whose `s` is one.
    pub energy: Vec<f64>,
}

impl Surface {
    fn push(&mut self, surface: f64, reaching: f64, gain: f64, energy: f64) {
        self.surface.push(surface);
        self.reaching.push(reaching);
        self.gain.push(gain);
        self.energy.push(energy);
    }
}

/// Runs a method on the samples of a run of the case.
///
/// # Errors
/// [`StudyError::Unsuitable`]: the method refuses its settings.
pub fn run_method(case: &PlantCase, run: &PlantRun, method: &Method) -> Result<MethodRun, StudyError> {
    let runner = Runner { case, run, method };
    if let (Method::OneParameter { .. } | Method::TwoParameter { .. }, Some(why)) = (method, case.plant.without_laws())
    {
        return Err(runner.refused(&why));
    }
    match (method, &case.plant) {
        (Method::TwoParameter { .. }, Plant::SecondOrder {}) => runner.two_parameter(SecondOrder),
        (Method::TwoParameter { .. }, Plant::SecondOrderNonlinear {}) => runner.two_parameter(SecondOrderNonlinear),
        (Method::TwoParameter { .. }, Plant::Own(plant)) if plant.parameters().len() == 2 => {
            runner.two_parameter(plant.model())
        }
        _ => case.plant.visit(runner),
    }
}

/// Settings of the flagship on a case: bounds and start values from the file, no derivative, everything else by its rule.
///
/// # Errors
/// [`StudyError::Unsuitable`]: the flagship refuses them.
pub(crate) fn flagship_settings<const N: usize, const R: usize>(
    case: &PlantCase,
    noise_std: &[f64],
) -> Result<EstimatorSettings<N, R, ROOM>, StudyError> {
    let priors: Vec<ParameterPrior> =
        case.unknowns().map(|(_, p)| ParameterPrior::bounded(p.start, p.lower, p.upper)).collect();
    // It needs no derivative, so it is given none.
    let sigma: [f64; R] = std::array::from_fn(|i| noise_std.get(i).copied().unwrap_or(f64::INFINITY));
    let mut settings = EstimatorSettings::<N, R, ROOM>::automatic(&priors, sigma, case.sample_time.si())
        .map_err(|error| StudyError::Unsuitable(format!("{}: {error}", case.title)))?;
    settings.maximum_step_s = MAXIMUM_STEP_S;
    // The record begins with the input: its first 0.2 s are not at rest, and are what is to be judged.
    settings.start_window_s = 0.0;
    settings.start_trial_s = 0.0;
    // States that are not measured start where the file says, which is known.
    settings.initial_state.iter_mut().zip(case.plant.start()).for_each(|(slot, start)| *slot = start);
    Ok(settings)
}

struct Runner<'a> {
    case: &'a PlantCase,
    run: &'a PlantRun,
    method: &'a Method,
}

impl Runner<'_> {
    /// The refusal of a method's settings, with the title of the case before it.
    fn refused(&self, error: &dyn std::fmt::Display) -> StudyError {
        StudyError::Unsuitable(format!("{}: {error}", self.case.title))
    }

    /// Runs the two-parameter law, which exists for the plants of second order only.
    fn two_parameter<M, const I: usize>(self, model: M) -> Result<MethodRun, StudyError>
    where
        M: Model<2, 3, ROOM, Input = [f64; I]>,
    {
        let Method::TwoParameter { form, evaluation, sign, lambda, eta } = self.method else {
            return Err(self.refused(&"these are not the settings of the two-parameter law"));
        };
        let mut start = [0.0; ROOM];
        let mut bounds = [[0.0; 2]; ROOM];
        for (j, (_, parameter)) in self.case.unknowns().enumerate() {
            start[j] = parameter.start;
            bounds[j] = [parameter.lower, parameter.upper];
        }
        let mut settings = TwoParameterSettings::as_printed(start, bounds, *lambda, *eta, *evaluation);
        settings.form = *form;
        settings.sign = *sign;
        settings.margin = margin(*form);
        settings.maximum_step_s = MAXIMUM_STEP_S;
        let mut law = TwoParameterLaw::new(model, settings).map_err(|error| self.refused(&error))?;
        let mut record = MethodRun::new(ROOM, 2, self.run.time_s.len());
        record.surfaces = vec![Surface::default(); 2];
        for sample in self.run.samples::<I, 3>() {
            let estimate = law.update(&sample);
            record.push(&estimate.parameters, law.state());
            let d = law.diagnostics();
            for (i, surface) in record.surfaces.iter_mut().enumerate() {
                surface.push(d.surface[i], d.reaching[i], d.gain[i], f64::NAN);
            }
            record.information.push(d.information);
            record.unsolved += usize::from(estimate.status.phase == Phase::Rejected);
        }
        Ok(record)
    }
}

impl Visit for Runner<'_> {
    type Output = Result<MethodRun, StudyError>;

    fn visit<M, const N: usize, const R: usize, const I: usize>(self, model: &M) -> Self::Output
    where
        M: Model<N, R, ROOM, Input = [f64; I]> + Copy + Sync,
    {
        let Self { case, run, method } = self;
        let unknowns: Vec<Parameter> = case.unknowns().map(|(_, parameter)| parameter).collect();
        let refused = |error: &dyn std::fmt::Display| self.refused(error);
        let mut record = MethodRun::new(unknowns.len(), N, run.time_s.len());
        match method {
            Method::Flagship { noise_std } => {
                let settings = flagship_settings::<N, R>(case, noise_std)?;
                let mut flagship = Smpe::new(*model, settings).map_err(|error| refused(&error))?;
                let mut claimed = vec![Vec::with_capacity(run.time_s.len()); unknowns.len()];
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
            Method::OneParameter { form, evaluation, sign, lambda, eta } => {
                let [p] = unknowns[..] else {
                    return Err(refused(&"the one-parameter law carries one parameter, this plant has two"));
                };
                // "Adds the y terms to numerator and denominator": the rate of every other state contains no unknown.
                let carrier = case.plant.carrier();
                let channels: [SurfaceChannel; N] = std::array::from_fn(|state| {
                    let derivative =
                        if state == carrier { SurfaceDerivative::Output(N) } else { SurfaceDerivative::Known };
                    SurfaceChannel { state, output: state, scale: 1.0, derivative }
                });
                let mut start = [0.0; ROOM];
                start[0] = p.start;
                let mut settings = ThesisSettings::new(0, start, [p.lower, p.upper], channels);
                settings.form = *form;
                settings.evaluation = *evaluation;
                settings.sign = *sign;
                settings.lambda = *lambda;
                settings.maximum_lambda_h = f64::INFINITY;
                settings.eta = *eta;
                settings.margin = margin(*form);
                settings.maximum_step_s = MAXIMUM_STEP_S;
                let law = ThesisLaw::<_, N, R, ROOM, N>::new(*model, settings);
                let mut law = law.map_err(|error| refused(&error))?;
                record.surfaces = vec![Surface::default()];
                for sample in run.samples::<I, R>() {
                    let estimate = law.update(&sample);
                    record.push(&estimate.parameters, law.state());
                    let d = law.diagnostics();
                    record.surfaces[0].push(d.surface, d.reaching, d.gain, d.energy);
                    record.unsolved += usize::from(estimate.status.phase == Phase::Rejected);
                }
            }
            Method::TwoParameter { .. } => {
                return Err(refused(&"the two-parameter law carries two parameters, this plant has one"));
            }
            Method::Extended { scale, reaching_time_s, floor } => {
                let mut start = [0.0; ROOM];
                let mut bounds = [[0.0; 2]; ROOM];
                for (j, parameter) in unknowns.iter().enumerate() {
                    start[j] = parameter.start;
                    bounds[j] = [parameter.lower, parameter.upper];
                }
                let scale: [f64; N] = std::array::from_fn(|i| scale.get(i).copied().unwrap_or(f64::NAN));
                let mut settings = ExtendedSettings::new(start, bounds, scale);
                settings.reaching_time_s = *reaching_time_s;
                settings.floor = *floor;
                settings.maximum_gap_s = settings.maximum_gap_s.max(2.0 * case.sample_time.si());
                let mut law =
                    ExtendedLaw::<_, [f64; I], N, ROOM>::new(*model, settings).map_err(|error| refused(&error))?;
                record.states = Vec::new();
                for sample in run.samples::<I, R>() {
                    let estimate = law.update(&sample);
                    record.push(&estimate.parameters, &[]);
                    let range = |values: &[f64]| {
                        values.iter().fold([0.0_f64, f64::INFINITY], |[l, s], w| [l.max(w.abs()), s.min(w.abs())])
                    };
                    record.information.push(range(&law.eigenvalues()[..unknowns.len()]));
                }
            }
        }
        Ok(record)
    }
}

/// How far outside the bounds an implicit solution may lie, as a part of their width: the thesis has no such limit, the
/// mended forms have the library's.
fn margin(form: ThesisForm) -> f64 {
    match form {
        ThesisForm::Printed => f64::INFINITY,
        ThesisForm::Reduced | ThesisForm::Damped => 0.25,
    }
}

impl MethodRun {
    fn new(parameters: usize, states: usize, samples: usize) -> Self {
        Self {
            estimates: vec![Vec::with_capacity(samples); parameters],
            std_error: None,
            states: vec![Vec::with_capacity(samples); states],
            surfaces: Vec::new(),
            information: Vec::new(),
            unsolved: 0,
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
