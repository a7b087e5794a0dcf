//! The Cramer-Rao bound of a plant case in its noise.

use phugoid_estimators::Model;

use super::format::PlantCase;
use super::plant::{ROOM, Visit};
use super::simulate::PlantRun;
use phugoid_evaluation::accuracy::StudyError;
use phugoid_evaluation::cramer_rao::{Between, Bound, Experiment, Knowledge};

/// Smallest standard error that any unbiased estimator can have from the measured states at each of the times `at` (s), with
/// unknown initial states and no prior; the noise is that of the run.
///
/// # Errors
/// [`StudyError`]: the run has no noise, or its motion is not finite.
pub fn bound(case: &PlantCase, run: &PlantRun, at: &[f64]) -> Result<Vec<Bound>, StudyError> {
    if run.noise_std <= 0.0 {
        return Err(StudyError::Unsuitable(format!("{}: without noise there is no bound", case.title)));
    }
    case.plant.visit(Bounded { case, run, at })
}

struct Bounded<'a> {
    case: &'a PlantCase,
    run: &'a PlantRun,
    at: &'a [f64],
}

impl Visit for Bounded<'_> {
    type Output = Result<Vec<Bound>, StudyError>;

    fn visit<M, const N: usize, const R: usize, const I: usize>(self, model: &M) -> Self::Output
    where
        M: Model<N, R, ROOM, Input = [f64; I]> + Copy + Sync,
    {
        let inputs: Vec<[f64; I]> = self.run.inputs.iter().map(|u| std::array::from_fn(|i| u[i])).collect();
        let mut parameters = [0.0; ROOM];
        for (slot, (_, parameter)) in parameters.iter_mut().zip(self.case.unknowns()) {
            *slot = parameter.truth;
        }
        let experiment = Experiment {
            initial_state: std::array::from_fn(|i| self.run.states[i][0]),
            parameters,
            time_s: &self.run.time_s,
            inputs: &inputs,
            between: Between::Held,
        };
        // The derivative is not used by what is compared with the bound.
        let noise = std::array::from_fn(|i| if i < N { self.run.noise_std } else { f64::INFINITY });
        Ok(experiment.bound(model, &Knowledge::<R, ROOM>::of_noise(noise), self.at)?)
    }
}
