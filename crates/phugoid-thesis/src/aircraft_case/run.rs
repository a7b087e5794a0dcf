//! A case with all its methods.

use phugoid_estimators::{LinearizedRates, Model};
use phugoid_flight_dynamics::modes::{ModeName, longitudinal_modes};
use phugoid_identification::longitudinal::STATES;
use rayon::prelude::*;

use super::case::AircraftCase;
use super::charts::charts;
use super::condition::condition;
use super::flight::fly;
use super::golden::golden;
use super::judged::Judged;
use super::method::{MethodRun, NamedMethod, run_method};
use super::model::model_file;
use super::rank::rank;
use super::reference::Reference;
use crate::outside::truth_outside;
use crate::plant_case::verdict::{TOLERANCE, behaviour, worst};
use crate::result::Reproduction;
use crate::result::{Outcome, ParameterOutcome, Requirement, Role, in_seconds};
use phugoid_evaluation::accuracy::StudyError;
use phugoid_evaluation::settling::settled_at;

/// Largest roll and yaw rate, as a part of the pitch rate, that the sums over p, q, r may be reduced to q with: its square is
/// what is left out.
const LATERAL_PART: f64 = 0.05;

impl AircraftCase {
    /// Runs the case with all its methods; `id` is the name its result bears.
    ///
    /// # Errors
    /// [`StudyError`]: the scenario cannot be flown, or a method refuses its settings.
    pub fn run(&self, id: &str) -> Result<Reproduction, StudyError> {
        let flight = fly(self)?;
        let reference = Reference::new(&flight, &model_file(self)?)?;
        self.must_be_symmetric(&reference)?;
        let judged: Vec<Judged> = self
            .methods()?
            .into_par_iter()
            .map(|settings| {
                let run = run_method(self, &flight, &settings)?;
                let outcome = self.outcome(&reference, &settings, &run);
                Ok(Judged { settings, run, outcome })
            })
            .collect::<Result<_, StudyError>>()?;
        let outcomes: Vec<Outcome> = judged.iter().map(|one| one.outcome.clone()).collect();
        let [beta, p, r] = reference.lateral;
        let outside: String = self
            .unknowns()
            .into_iter()
            .filter_map(|(name, told)| truth_outside(name, self.truth(name), [told.lower, told.upper]))
            .collect();
        let difference = format!(
            "{outside}{} In the record of the 6-DOF flight sideslip reaches {:.1e} deg, roll rate {:.1e} deg/s and yaw rate {:.1e} \
             deg/s (the rotor's angular momentum couples pitch into yaw), so the sums over p, q, r and alpha, beta, V reduce \
             to those over q and over alpha and V.",
            self.published.difference.trim_end(),
            beta.to_degrees(),
            p.to_degrees(),
            r.to_degrees()
        );
        Ok(Reproduction {
            difference: difference.trim_start().to_owned(),
            requirements: self.requirements(&reference, &outcomes)?,
            tables: rank(self, &reference).into_iter().collect(),
            charts: charts(self, &flight, &reference, &judged),
            golden: golden(self, &reference.time, &judged),
            outcomes,
            ..self.published.reproduction(id, &self.title)
        })
    }

    /// The surfaces of the laws are those of symmetric flight.
    fn must_be_symmetric(&self, reference: &Reference) -> Result<(), StudyError> {
        let largest_q = reference.states.iter().fold(0.0, |largest: f64, x| largest.max(x[3].abs()));
        let [_, p, r] = reference.lateral;
        if p.max(r) <= LATERAL_PART * largest_q {
            return Ok(());
        }
        Err(StudyError::Unsuitable(format!(
            "{}: a case is a flight in the plane of symmetry, but roll rate reaches {:.2e} rad/s and yaw rate {:.2e} rad/s \
             beside a pitch rate of {largest_q:.2e} rad/s: move the elevator, and only the elevator",
            self.title, p, r
        )))
    }

    fn outcome(&self, reference: &Reference, method: &NamedMethod, run: &MethodRun) -> Outcome {
        let judged = run.parameters.iter().filter_map(|p| {
            let told = self.parameters.get(&p.name)?;
            Some(behaviour(&run.time_s, &p.values, self.truth(&p.name), [told.lower, told.upper]))
        });
        Outcome {
            method: method.name.clone(),
            role: method.role,
            behaviour: worst(judged),
            condition: condition(self, reference, method, run),
            parameters: run
                .parameters
                .iter()
                .map(|p| ParameterOutcome {
                    name: p.name.clone(),
                    truth: self.truth(&p.name),
                    start: self.parameters.get(&p.name).map_or(f64::NAN, |told| told.start()),
                    end: p.values.last().copied().unwrap_or(f64::NAN),
                    std_error: p.std_errors.as_ref().and_then(|errors| errors.last().copied()),
                    published_s: self.published.converged_s(&p.name),
                    converged_s: settled_at(&run.time_s, &p.values, self.truth(&p.name), TOLERANCE),
                })
                .collect(),
        }
    }

    /// The flagship within 5 % no later than published; of several increments all within one short-period cycle of the input.
    fn requirements(&self, reference: &Reference, outcomes: &[Outcome]) -> Result<Vec<Requirement>, StudyError> {
        let flagship: Vec<&ParameterOutcome> =
            outcomes.iter().filter(|o| o.role == Role::Flagship).flat_map(|o| &o.parameters).collect();
        let mut requirements: Vec<Requirement> = flagship
            .iter()
            .filter_map(|p| {
                let published = p.published_s?;
                Some(Requirement {
                    what: format!("flagship: {} within 5 % no later than published", p.name),
                    limit: format!("{published} s"),
                    found: in_seconds(p.converged_s),
                    met: p.converged_s.is_some_and(|t| t <= published + 1e-9),
                })
            })
            .collect();
        if let (Some(start), 2..) = (reference.input_starts_s, flagship.len()) {
            let cycle = short_period_s(reference)?;
            let last = flagship.iter().try_fold(0.0, |last: f64, p| Some(last.max(p.converged_s? - start)));
            requirements.push(Requirement {
                what: format!(
                    "flagship: all {} within 5 % in one short-period cycle after the input starts",
                    flagship.len()
                ),
                limit: format!("{cycle:.2} s"),
                found: in_seconds(last),
                met: last.is_some_and(|t| t <= cycle),
            });
        }
        Ok(requirements)
    }
}

/// Period of the short period at the start of the flight, s, without increments and with thrust held.
///
/// # Errors
/// [`StudyError::Unsuitable`] where the aircraft has none.
pub fn short_period_s(reference: &Reference) -> Result<f64, StudyError> {
    let none = || StudyError::Unsuitable("the aircraft has no short period".to_owned());
    let (Some(x), Some(input)) = (reference.states.first(), reference.inputs.first()) else { return Err(none()) };
    let mut lin = LinearizedRates::<STATES, { super::case::PARAMETERS.len() }>::ZERO;
    reference.model.linearized_rates(x, &[0.0; super::case::PARAMETERS.len()], input, &mut lin);
    let modes = longitudinal_modes(&lin.state_jacobian).map_err(StudyError::unsuitable)?;
    modes.iter().find(|mode| mode.name == ModeName::ShortPeriod).and_then(|mode| mode.period_s).ok_or_else(none)
}
