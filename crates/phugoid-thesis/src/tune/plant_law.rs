//! The thesis's law and the model-reference law on the proof-of-concept plants: what to expect, and one run.

use crate::laws::{SurfaceChannel, SurfaceDerivative, ThesisForm, ThesisLaw, ThesisSettings};
use crate::model_reference::{ModelReference, ModelReferenceForm, ModelReferenceSettings};
use phugoid_estimators::{Estimator, LinearizedRates, Model, Sample};

use super::rule::Expected;
use crate::plant_case::{Parameter, PlantCase, PlantRun, ROOM, Visit, simulate};
use phugoid_evaluation::accuracy::StudyError;
use phugoid_evaluation::statistics::median;

/// A law with its settings; bounds and start values are those of the case.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Law {
    /// The one-parameter law of the thesis, solved at every sample, with the measured derivative.
    Thesis { form: ThesisForm, lambda: f64, eta: f64 },
    /// The model-reference law in its state-error form, with projection onto the bounds; `normalised` divides the gain by
    /// `|Phi R|^2` about the mean square given.
    ModelReference { gain: f64, decay: f64, normalised: Option<f64> },
}

/// Estimates by parameter and sample; none if the law refuses its settings.
pub(super) fn run(case: &PlantCase, run: &PlantRun, law: Law) -> Option<Vec<Vec<f64>>> {
    case.plant.visit(Runner { case, run, law })
}

fn unknowns(case: &PlantCase) -> Vec<Parameter> {
    case.unknowns().map(|(_, parameter)| parameter).collect()
}

fn half_width(parameter: &Parameter) -> f64 {
    0.5 * (parameter.upper - parameter.lower)
}

struct Runner<'a> {
    case: &'a PlantCase,
    run: &'a PlantRun,
    law: Law,
}

impl Visit for Runner<'_> {
    type Output = Option<Vec<Vec<f64>>>;

    fn visit<M, const N: usize, const R: usize, const I: usize>(self, model: &M) -> Self::Output
    where
        M: Model<N, R, ROOM, Input = [f64; I]> + Copy + Sync,
    {
        let told = unknowns(self.case);
        let of = |get: fn(&Parameter) -> f64| -> [f64; ROOM] { std::array::from_fn(|j| told.get(j).map_or(0.0, get)) };
        let state = self.case.plant.carrier();
        // The output after the states is the derivative of that state.
        let derivative = SurfaceDerivative::Output(N);
        let channels = [SurfaceChannel { state, output: state, scale: 1.0, derivative }];
        let start = of(|p| p.start);
        match self.law {
            Law::Thesis { form, lambda, eta } => {
                let [p] = told[..] else { return None };
                let mut settings = ThesisSettings::<N, ROOM, 1>::new(0, start, [p.lower, p.upper], channels);
                (settings.form, settings.lambda, settings.eta) = (form, lambda, eta);
                self.estimates::<_, R, I>(ThesisLaw::new(*model, settings).ok()?)
            }
            Law::ModelReference { gain, decay, normalised } => {
                let form = ModelReferenceForm::StateError;
                let mut settings =
                    ModelReferenceSettings::<N, ROOM, 1>::new(form, gain, start, of(half_width), channels);
                (settings.lower, settings.upper) = (of(|p| p.lower), of(|p| p.upper));
                settings.error_decay = decay;
                if let Some(mean_square) = normalised {
                    // As strong as the plain law where the regressor is of its mean size.
                    (settings.gain, settings.normalisation) = (2.0 * mean_square * gain, Some(mean_square));
                }
                self.estimates::<_, R, I>(ModelReference::new(*model, settings).ok()?)
            }
        }
    }
}

impl Runner<'_> {
    fn estimates<E, const R: usize, const I: usize>(&self, mut estimator: E) -> Option<Vec<Vec<f64>>>
    where
        E: Estimator<R, ROOM, Input = [f64; I]>,
    {
        let run = self.run;
        let mut estimates = vec![Vec::with_capacity(run.time_s.len()); self.case.unknowns().count()];
        for (k, &time_s) in run.time_s.iter().enumerate() {
            let input = std::array::from_fn(|i| run.inputs[k][i]);
            let outputs = std::array::from_fn(|i| run.outputs[i][k]);
            let estimate = estimator.update(&Sample { time_s, input, outputs });
            for (series, value) in estimates.iter_mut().zip(estimate.parameters) {
                series.push(value);
            }
        }
        Some(estimates)
    }
}

/// What to expect of a case: its plant with the start values for the truth, under its input; and how large its regressor
/// gets if the truth is at the bounds.
pub(super) fn expected(case: &PlantCase) -> Result<Expected, StudyError> {
    let with = |truth: fn(&Parameter) -> f64| {
        let mut case = PlantCase { noise: None, ..case.clone() };
        for parameter in case.parameters.values_mut() {
            parameter.truth = truth(parameter);
        }
        simulate(&case)
    };
    let noise = case.noise.map_or(0.0, |noise| (noise.power / case.sample_time.si()).sqrt());
    let look = |run: &PlantRun| case.plant.visit(Look { case, run, noise });
    let mut expected = look(&with(|p| p.start)?);
    // At a bound the plant may escape before the end of the record: what it does then says nothing.
    for run in [with(|p| p.lower), with(|p| p.upper)].into_iter().flatten() {
        expected.largest_regressor = expected.largest_regressor.max(look(&run).largest_regressor);
    }
    Ok(expected)
}

struct Look<'a> {
    case: &'a PlantCase,
    run: &'a PlantRun,
    noise: f64,
}

impl Visit for Look<'_> {
    type Output = Expected;

    fn visit<M, const N: usize, const R: usize, const I: usize>(self, model: &M) -> Expected
    where
        M: Model<N, R, ROOM, Input = [f64; I]> + Copy + Sync,
    {
        let told = unknowns(self.case);
        let theta: [f64; ROOM] = std::array::from_fn(|j| told.get(j).map_or(0.0, |p| p.start));
        let state = self.case.plant.carrier();
        let mut points = Vec::with_capacity(self.run.time_s.len());
        let mut out = LinearizedRates::<N, ROOM>::ZERO;
        for k in 0..self.run.time_s.len() {
            let x: [f64; N] = std::array::from_fn(|i| self.run.states[i][k]);
            let u: [f64; I] = std::array::from_fn(|i| self.run.inputs[k][i]);
            model.linearized_rates(&x, &theta, &u, &mut out);
            points.push(Point {
                signal: x[state],
                rate: out.rates[state],
                regressors: told.iter().zip(out.regressors[state]).map(|(p, phi)| phi * half_width(p)).collect(),
            });
        }
        let smallest = told.iter().map(|p| (p.start.abs() / half_width(p), half_width(p)));
        let smallest = smallest.min_by(|a, b| a.0.total_cmp(&b.0)).unwrap_or((1.0, 1.0));
        summary(&points, [self.case.sample_time.si(), self.case.duration.si()], self.noise, smallest)
    }
}

/// A channel at one instant, divided by its scale.
pub(super) struct Point {
    pub(super) signal: f64,
    pub(super) rate: f64,
    /// Times the half widths of the bounds.
    pub(super) regressors: Vec<f64>,
}

/// Sums up what was looked at; `nominal` is the smallest nominal parameter as a fraction of its half width, and that.
pub(super) fn summary(
    points: &[Point],
    [sample_time_s, duration_s]: [f64; 2],
    noise: f64,
    (nominal, half_width): (f64, f64),
) -> Expected {
    let mean = |of: &dyn Fn(&Point) -> f64| points.iter().map(of).sum::<f64>() / points.len().max(1) as f64;
    let first = |p: &Point| p.regressors.first().copied().unwrap_or(0.0) / half_width;
    let mut slopes: Vec<f64> = points.iter().map(|p| (p.signal * first(p)).abs()).collect();
    slopes.sort_by(f64::total_cmp);
    let largest = slopes.last().copied().unwrap_or(0.0);
    let excited = &slopes[slopes.partition_point(|z| *z <= 1e-3 * largest)..];
    Expected {
        sample_time_s,
        duration_s,
        signal: mean(&|p| p.signal * p.signal).sqrt(),
        rate: mean(&|p| p.rate * p.rate).sqrt(),
        slope: if excited.is_empty() { 0.0 } else { median(excited.to_vec()) },
        regressor: mean(&|p| p.regressors.iter().map(|r| r * r).sum()).sqrt(),
        largest_regressor: points
            .iter()
            .map(|p| p.regressors.iter().map(|r| r * r).sum::<f64>())
            .fold(0.0, f64::max)
            .sqrt(),
        noise,
        nominal,
        half_width,
    }
}
