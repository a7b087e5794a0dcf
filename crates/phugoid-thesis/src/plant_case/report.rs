//! A case with all its methods, as a result.

use crate::laws::{Evaluation, LawSign, ThesisForm};

use super::charts::charts;
use super::condition::condition;
use super::condition::slopes;
use super::format::PlantCase;
use super::golden::golden;
use super::judged::{Judged, NamedMethod};
use super::method::{Method, MethodRun, run_method};
use super::simulate::{PlantRun, simulate};
use super::verdict::{behaviour, worst};
use crate::outside::truth_outside;
use crate::result::Reproduction;
use crate::result::{Outcome, ParameterOutcome, Requirement, Role};
use phugoid_evaluation::accuracy::StudyError;
use phugoid_evaluation::settling::settled_at;

impl PlantCase {
    /// Runs the case with all its methods; `id` is the name its result bears.
    ///
    /// # Errors
    /// [`StudyError`]: the plant escapes, or a method refuses its settings.
    pub fn run(&self, id: &str) -> Result<Reproduction, StudyError> {
        let run = simulate(self)?;
        let mut judged = Vec::new();
        for method in self.methods(&run) {
            let result = run_method(self, &run, &method.settings)?;
            let outcome = self.outcome(&method, &run, &result);
            judged.push(Judged { method, result, outcome });
        }
        let outcomes: Vec<Outcome> = judged.iter().map(|t| t.outcome.clone()).collect();
        let requirements = self.requirements(&outcomes);
        let outside: String =
            self.unknowns().filter_map(|(name, p)| truth_outside(name, p.truth, [p.lower, p.upper])).collect();
        let without_laws = self.plant.without_laws().map(|why| why + " ").unwrap_or_default();
        Ok(Reproduction {
            difference: outside + &without_laws + &self.published.difference,
            outcomes,
            requirements,
            charts: charts(self, &run, &judged),
            golden: golden(self, &run, &judged),
            ..self.published.reproduction(id, &self.title)
        })
    }

    /// The methods that the report shows, with the settings of the file.
    fn methods(&self, run: &PlantRun) -> Vec<NamedMethod> {
        use {Evaluation::*, LawSign::*, ThesisForm::*};
        let mut methods = vec![NamedMethod { name: "flagship", role: Role::Flagship, settings: self.flagship(run) }];
        let unknowns: Vec<_> = self.unknowns().collect();
        let signs_differ = slopes(self, run).iter().flatten().any(|z| *z > 0.0);
        let has_laws = self.plant.without_laws().is_none();
        if let ([(_, p)], true) = (&unknowns[..], has_laws) {
            for (name, role, form, evaluation, sign) in [
                ("printed law, one-sample delay", Role::Published, Printed, Delayed, AsPrinted),
                ("printed law, implicit", Role::Published, Printed, Implicit, AsPrinted),
                ("printed law, implicit, sign from the slope", Role::Mended, Printed, Implicit, FromSlope),
                ("reduced law, implicit", Role::Mended, Reduced, Implicit, FromSlope),
                ("damped law, implicit", Role::Mended, Damped, Implicit, FromSlope),
            ] {
                if form == Printed && sign == FromSlope && !signs_differ {
                    continue;
                }
                let (lambda, eta) = (p.lambda, self.estimator.eta);
                let settings = Method::OneParameter { form, evaluation, sign, lambda, eta };
                methods.push(NamedMethod { name, role, settings });
            }
        }
        if let ([(_, first), (_, second)], true) = (&unknowns[..], has_laws) {
            let (lambda, eta) = ([first.lambda, second.lambda], self.estimator.eta);
            for (name, role, form, evaluation, sign) in [
                ("printed law, one-sample delay", Role::Published, Printed, Delayed, AsPrinted),
                ("printed law, implicit", Role::Published, Printed, Implicit, AsPrinted),
                ("printed law, implicit, sign from the slope", Role::Mended, Printed, Implicit, FromSlope),
            ] {
                if sign == FromSlope && !signs_differ {
                    continue;
                }
                let settings = Method::TwoParameter { form, evaluation, sign, lambda, eta };
                methods.push(NamedMethod { name, role, settings });
            }
        }
        if self.plant.measures_all() && (unknowns.len() == 2 || !has_laws) {
            methods.push(NamedMethod { name: "extended law", role: Role::Mended, settings: self.extended(run) });
        }
        methods
    }

    /// The flagship, told the true noise, or without noise a small fraction of each signal.
    pub fn flagship(&self, run: &PlantRun) -> Method {
        let outputs = run.outputs.iter().take(self.plant.outputs());
        let noise_std = outputs
            .map(|y| if run.noise_std > 0.0 { run.noise_std } else { self.estimator.assumed_noise * rms(y) })
            .collect();
        Method::Flagship { noise_std }
    }

    /// The extended law: the whole range in 0.1 s, states scaled by their size over the record.
    pub fn extended(&self, run: &PlantRun) -> Method {
        Method::Extended { scale: run.states.iter().map(|x| rms(x)).collect(), reaching_time_s: 0.1, floor: 0.0 }
    }

    fn outcome(&self, method: &NamedMethod, run: &PlantRun, result: &MethodRun) -> Outcome {
        let judged = self.unknowns().zip(&result.estimates);
        Outcome {
            method: method.name.to_owned(),
            role: method.role,
            behaviour: worst(
                judged.map(|((_, p), values)| behaviour(&run.time_s, values, p.truth, [p.lower, p.upper])),
            ),
            condition: condition(self, run, &method.settings, result),
            parameters: self
                .unknowns()
                .enumerate()
                .map(|(j, (name, p))| ParameterOutcome {
                    name: name.to_owned(),
                    truth: p.truth,
                    start: p.start,
                    end: result.estimates[j].last().copied().unwrap_or(f64::NAN),
                    std_error: result.std_error.as_ref().and_then(|s| s[j].last().copied()),
                    published_s: self.published.converged_s(name),
                    converged_s: settled_at(&run.time_s, &result.estimates[j], p.truth, super::verdict::TOLERANCE),
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
                    found: p.converged_s.map_or_else(|| "never".to_owned(), |t| format!("{t:.3} s")),
                    met: p.converged_s.is_some_and(|t| t <= published + 1e-9),
                })
            })
            .collect()
    }
}

fn rms(series: &[f64]) -> f64 {
    (series.iter().map(|x| x * x).sum::<f64>() / series.len() as f64).sqrt()
}
