//! A plant's motion with its true parameters, and what is measured of it.

use phugoid_estimators::discretization::{InputHold, IntervalInput, simulate as integrate};
use phugoid_estimators::{LinearizedOutputs, Model, Sample};
use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64Mcg;

use super::format::PlantCase;
use super::plant::{Plant, ROOM, Visit};
use phugoid_evaluation::accuracy::StudyError;

/// Longest integration step of plants and estimated models, s: fourth order at the fastest plant (rate 25 1/s) leaves
/// 1e-8 of the state per step.
pub(super) const MAXIMUM_STEP_S: f64 = 2e-3;

/// A plant's motion, sample by sample. States and parameters are pure numbers.
#[derive(Clone, Debug, PartialEq)]
pub struct PlantRun {
    /// Times of the samples from the start of the record, s.
    pub time_s: Vec<f64>,
    /// Known inputs at each sample, held until the next.
    pub inputs: Vec<Vec<f64>>,
    /// True states without noise, indexed `[state][sample]`.
    pub states: Vec<Vec<f64>>,
    /// What is measured, `[output][sample]`: all states (of a plant of one's own its outputs, NaN where there are fewer than
    /// states), then the derivative of the last state that carries an unknown.
    pub outputs: Vec<Vec<f64>>,
    /// Standard deviation of the noise in each output but the derivative; the derivative is measured without noise, as it stands
    /// before the integrator in the thesis's diagram (reconstructed).
    pub noise_std: f64,
}

impl PlantRun {
    /// The samples that an estimator is given.
    pub(crate) fn samples<const I: usize, const R: usize>(&self) -> impl Iterator<Item = Sample<[f64; I], R>> + '_ {
        self.time_s.iter().enumerate().map(|(k, &time_s)| Sample {
            time_s,
            input: std::array::from_fn(|i| self.inputs[k][i]),
            outputs: std::array::from_fn(|i| self.outputs[i][k]),
        })
    }
}

/// Simulates a case from its start, at rest unless the plant says otherwise; the noise is drawn from the case's seed.
///
/// # Errors
/// [`StudyError::Unsuitable`]: the plant escapes before the end of the record, or its rates are no numbers.
pub fn simulate(case: &PlantCase) -> Result<PlantRun, StudyError> {
    let exact = case.plant.visit(Exact { case })?;
    Ok(with_noise(exact, case, case.seed))
}

/// The same motion with noise of another seed; `exact` is a run without noise.
pub(crate) fn with_noise(mut exact: PlantRun, case: &PlantCase, seed: u64) -> PlantRun {
    let Some(noise) = case.noise else { return exact };
    exact.noise_std = (noise.power / case.sample_time.si()).sqrt();
    let mut random = Pcg64Mcg::seed_from_u64(seed);
    for k in 0..exact.time_s.len() {
        for i in 0..case.plant.outputs() {
            let white: f64 = StandardNormal.sample(&mut random);
            exact.outputs[i][k] += exact.noise_std * white;
        }
    }
    exact
}

struct Exact<'a> {
    case: &'a PlantCase,
}

impl Visit for Exact<'_> {
    type Output = Result<PlantRun, StudyError>;

    fn visit<M, const N: usize, const R: usize, const I: usize>(self, model: &M) -> Self::Output
    where
        M: Model<N, R, ROOM, Input = [f64; I]> + Copy + Sync,
    {
        let case = self.case;
        let count = case.samples();
        let mut truth = [0.0; ROOM];
        for (slot, (_, parameter)) in truth.iter_mut().zip(case.unknowns()) {
            *slot = parameter.truth;
        }
        let input = |t: f64| -> [f64; I] {
            let inputs = case.plant.inputs(case.input.at(t), t);
            std::array::from_fn(|i| inputs[i])
        };
        let mut run = PlantRun {
            time_s: Vec::with_capacity(count),
            inputs: Vec::with_capacity(count),
            states: vec![Vec::with_capacity(count); N],
            outputs: vec![Vec::with_capacity(count); R],
            noise_std: 0.0,
        };
        let mut x = [0.0; N];
        x.iter_mut().zip(case.plant.start()).for_each(|(slot, start)| *slot = start);
        let mut out = LinearizedOutputs::<N, R, ROOM>::ZERO;
        for k in 0..count {
            let t = k as f64 * case.sample_time.si();
            if k > 0 {
                let before = (k - 1) as f64 * case.sample_time.si();
                let held = IntervalInput { from: input(before), to: input(t), hold: InputHold::Zero };
                x = integrate(model, &x, &truth, &held, t - before, MAXIMUM_STEP_S);
            }
            model.linearized_outputs(&x, &truth, &input(t), &mut out);
            // What lies between the outputs and the rate is not measured.
            let measured = || out.outputs.iter().take(case.plant.outputs()).chain(out.outputs.last());
            let all = || measured().chain(&x);
            if matches!(case.plant, Plant::Own(_)) && all().any(|value| value.is_nan()) {
                return Err(StudyError::Unsuitable(format!(
                    "{}: at {t:.3} s a rate or output of the plant is no number: a formula leaves the range in which it has a value \
                     (logarithm, root, power, division), or the plant escapes: end the record (`duration`) before, or make the input \
                     smaller",
                    case.title
                )));
            }
            if !all().all(|y| y.is_finite() && y.abs() < 1e9) {
                return Err(StudyError::Unsuitable(format!(
                    "{}: the plant escapes at {t:.3} s: end the record (`duration`) before, or make the input smaller",
                    case.title
                )));
            }
            run.time_s.push(t);
            run.inputs.push(input(t).to_vec());
            for (series, value) in run.states.iter_mut().zip(x) {
                series.push(value);
            }
            for (series, value) in run.outputs.iter_mut().zip(out.outputs) {
                series.push(value);
            }
        }
        Ok(run)
    }
}
