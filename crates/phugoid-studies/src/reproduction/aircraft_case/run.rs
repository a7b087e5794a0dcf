//! A case with all its methods.

use rayon::prelude::*;

use super::case::AircraftCase;
use super::method::{MethodRun, MethodSettings, run_method};
use crate::accuracy::StudyError;
use crate::reproduction::Reproduction;
use crate::reproduction::plant_case::verdict::{TOLERANCE, behaviour, worst};
use crate::reproduction::result::{Outcome, ParameterOutcome, Requirement, Role};
use crate::settling::settled_at;

impl AircraftCase {
    /// Runs the case with all its methods; `id` is the name its result bears.
    ///
    /// # Errors
    /// [`StudyError`]: the scenario cannot be flown, or a method refuses its settings.
    pub fn run(&self, id: &str) -> Result<Reproduction, StudyError> {
        let flight = super::fly(self)?;
        let methods = self.methods()?;
        let runs: Vec<MethodRun> =
            methods.par_iter().map(|method| run_method(self, &flight, method)).collect::<Result<_, _>>()?;
        let outcomes: Vec<Outcome> = methods.iter().zip(&runs).map(|(method, run)| self.outcome(method, run)).collect();
        let requirements = self.requirements(&outcomes);
        Ok(Reproduction {
            id: id.to_owned(),
            title: self.title.clone(),
            place: self.published.place.clone(),
            published: self.published.statement.clone(),
            reconstruction: self.published.reconstruction.clone(),
            difference: self.published.difference.clone(),
            outcomes,
            requirements,
            ..Reproduction::default()
        })
    }

    /// The methods that the report shows, with the settings of the file.
    ///
    /// # Errors
    /// As [`super::model_file`].
    pub fn methods(&self) -> Result<Vec<MethodSettings>, StudyError> {
        Ok(vec![MethodSettings::flagship(self)?])
    }

    fn outcome(&self, method: &MethodSettings, run: &MethodRun) -> Outcome {
        let judged = run.parameters.iter().filter_map(|p| {
            let told = self.parameters.get(&p.name)?;
            Some(behaviour(&run.time_s, &p.values, self.truth(&p.name), [told.lower, told.upper]))
        });
        Outcome {
            method: method.name.clone(),
            role: method.role,
            behaviour: worst(judged),
            condition: String::new(),
            parameters: run
                .parameters
                .iter()
                .map(|p| ParameterOutcome {
                    name: p.name.clone(),
                    truth: self.truth(&p.name),
                    start: self.parameters.get(&p.name).map_or(f64::NAN, |told| told.start()),
                    end: p.values.last().copied().unwrap_or(f64::NAN),
                    std_error: p.std_errors.as_ref().and_then(|errors| errors.last().copied()),
                    published_s: self.published_s(&p.name),
                    converged_s: settled_at(&run.time_s, &p.values, self.truth(&p.name), TOLERANCE),
                })
                .collect(),
        }
    }

    /// The flagship within 5 % no later than published.
    fn requirements(&self, outcomes: &[Outcome]) -> Vec<Requirement> {
        let flagship = outcomes.iter().filter(|outcome| outcome.role == Role::Flagship);
        flagship
            .flat_map(|outcome| &outcome.parameters)
            .filter_map(|p| {
                let published = p.published_s?;
                Some(Requirement {
                    what: format!("flagship: {} within 5 % no later than published", p.name),
                    limit: format!("{published} s"),
                    found: p.converged_s.map_or_else(|| "never".to_owned(), |t| format!("{t:.2} s")),
                    met: p.converged_s.is_some_and(|t| t <= published + 1e-9),
                })
            })
            .collect()
    }
}
