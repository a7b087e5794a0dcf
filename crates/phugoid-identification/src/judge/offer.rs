//! Terms that the residuals ask for.
//!
//! A term that the aircraft has and the model lacks is taken up by the others: their values then really change with the
//! flight condition, and a change detector finds changes that never happened. Here each candidate term is tried in a
//! model of its own, and offered where the flight is so much more probable with it that chance does not explain it. The
//! idea is that of modified stepwise regression (V. Klein, J. G. Batterson, P. C. Murphy, *Determination of Airplane
//! Model Structure From Flight Data by Using Modified Stepwise Regression*, NASA TP-1916, 1981), with the likelihood of
//! an estimator's innovations in place of the F statistic of a regression. docs/methods.md has the equations, and what
//! was measured.

mod amplitude;
mod candidate;

use phugoid_flight_data::record::Record;

use crate::core::error::EstimateError;
use crate::core::estimation::{Estimation, Event, EventKind, Offer, OfferedTerm};
use crate::core::method::Method;
use crate::core::options::{EstimateOptions, OfferTerms, capacity};
use crate::judge::contradiction::colour;
use crate::methods::{EveryRoom, Run, Task, run};
use crate::model_file::ModelFile;
use crate::preparation::prepare::prepare;
use amplitude::Amplitudes;
use candidate::{Candidate, candidates};

/// Nats that a term has to gain beyond the logarithm of the number of terms tried. If the model is right, the ratio of
/// the predictive densities has a mean of one, so that it exceeds `K e^10` for any of `K` terms in at most one flight
/// in 22 000 (Markov's inequality; J. Ville 1939). The limit is generous because no model is exactly right.
const ENOUGH: f64 = 10.0;

/// Standard errors that a term's estimate has to lie from zero: the correction for coloured residuals is in these
/// alone, and not in the densities.
const FAR_FROM_ZERO: f64 = 3.0;

/// Tries terms that the model lacks, if the estimation gives a reason to. The estimation itself is not changed.
///
/// # Errors
/// [`EstimateError`] as of the estimation itself.
pub(crate) fn offer<M: EveryRoom<N, R>, const N: usize, const R: usize>(
    record: &Record,
    task: &Task<M, N, R>,
    estimation: &Estimation,
    own: &Run<R>,
    progress: &mut dyn FnMut(f64),
) -> Result<Option<Offer>, EstimateError> {
    let file = task.file;
    let reasons = reasons(own, file);
    let wanted = match task.options.offer {
        OfferTerms::Never => false,
        OfferTerms::WithReason => !reasons.is_empty(),
        OfferTerms::Always => true,
    };
    if !wanted || task.method().is_batch() || !own.excited {
        return Ok(None);
    }
    // The estimator must have place for one more column.
    if file.estimated().count() >= capacity(file.axes) {
        return Ok(None);
    }
    let trials = Trials::<M, N, R>::new(record, task);
    let wanted = candidates(file, &estimation.parameters, &Amplitudes::of(task, own));
    let threshold = ENOUGH + (wanted.len().max(1) as f64).ln();
    let steps = (wanted.len() + 2) as f64;
    let steady = trials.run(file, false)?;
    progress(1.0 / steps);
    let changing = trials.run(file, true)?;
    let mut terms = Vec::with_capacity(wanted.len());
    for (done, candidate) in wanted.iter().enumerate() {
        progress((done + 2) as f64 / steps);
        terms.push(trials.try_term(candidate, [&steady, &changing], threshold)?);
    }
    terms
        .sort_by(|a, b| (b.asked_for, b.gain).partial_cmp(&(a.asked_for, a.gain)).unwrap_or(std::cmp::Ordering::Equal));
    progress(1.0);
    let method = trials.options.method.unwrap_or_default();
    Ok(Some(Offer { reasons, method, threshold, adopted_changes: adopted(&changing.events), terms }))
}

/// Signs in an estimation that the model may lack a term.
fn reasons<const R: usize>(run: &Run<R>, file: &ModelFile) -> Vec<String> {
    let mut reasons = Vec::new();
    let adopted = adopted(&run.events);
    if adopted > 0 {
        let times = if adopted == 1 { "once".to_owned() } else { format!("{adopted} times") };
        reasons.push(format!("the parameters were found changed {times}"));
    }
    if run.events.iter().any(|e| e.kind == EventKind::Insensitive) {
        reasons.push("the parameters wander without any change".to_owned());
    }
    let outputs = file.axes.outputs().iter().enumerate();
    let is_coloured = |row: usize| colour(run.residuals.iter().map(|at| at[row])).is_some();
    let coloured: Vec<&str> = outputs.filter(|(row, _)| is_coloured(*row)).map(|(_, o)| o.name()).collect();
    if !coloured.is_empty() {
        reasons.push(format!("the residuals of {} are coloured", coloured.join(", ")));
    }
    reasons
}

fn adopted(events: &[Event]) -> usize {
    events.iter().filter(|e| e.kind == EventKind::Adopted).count()
}

/// The runs on one record that are compared.
struct Trials<'a, M: EveryRoom<N, R>, const N: usize, const R: usize> {
    record: &'a Record,
    task: &'a Task<'a, M, N, R>,
    /// The options of the task with EKF or SMPE as the method: the innovations of these have a density.
    options: EstimateOptions,
}

impl<'a, M: EveryRoom<N, R>, const N: usize, const R: usize> Trials<'a, M, N, R> {
    fn new(record: &'a Record, task: &'a Task<'a, M, N, R>) -> Self {
        let method = if task.method() == Method::Ekf { Method::Ekf } else { Method::Smpe };
        Self { record, task, options: EstimateOptions { method: Some(method), ..task.options.clone() } }
    }

    fn run(&self, file: &ModelFile, change_detection: bool) -> Result<Run<R>, EstimateError> {
        let prepared = prepare::<M, N, R>(self.record, file)?;
        let options = EstimateOptions { change_detection: Some(change_detection), ..self.options.clone() };
        let task = Task { prepared: &prepared, file, options: &options, noise: self.task.noise, health: None };
        run(&task, &mut |_| ())
    }

    fn try_term(
        &self,
        candidate: &Candidate,
        [steady, changing]: [&Run<R>; 2],
        threshold: f64,
    ) -> Result<OfferedTerm, EstimateError> {
        let file = candidate.model(self.task.file);
        let with = self.run(&file, false)?;
        let gain = gain(&with, steady);
        let with_changes = if gain >= threshold { Some(self.run(&file, true)?) } else { None };
        let gain_with_changes = with_changes.as_ref().map(|with| self::gain(with, changing));
        let adopted_changes = with_changes.as_ref().map(|with| adopted(&with.events));
        // After a real change any further column gains something until it is adopted, and does not spare the adoption.
        let before = adopted(&changing.events);
        let spares_changes = adopted_changes.is_some_and(|after| before == 0 || after < before);
        let name = &candidate.parameter.name;
        let column = file.estimated().position(|p| p.name == *name).and_then(|column| with.columns.get(column));
        let (value, std_error) = column.map_or((f64::NAN, f64::NAN), |c| (c.value, c.corrected_std_error));
        Ok(OfferedTerm {
            coefficient: candidate.coefficient.symbol().to_owned(),
            term: candidate.term.text(&file.extra_inputs),
            parameter: name.clone(),
            gain,
            gain_with_changes,
            value,
            std_error,
            adopted_changes,
            remaining: with_changes.as_ref().map(|with| reasons(with, &file)).unwrap_or_default(),
            asked_for: gain_with_changes.is_some_and(|g| g >= threshold)
                && value.abs() >= FAR_FROM_ZERO * std_error
                && spares_changes,
            coefficient_line: candidate.coefficient_line(self.task.file),
            parameter_line: candidate.parameter_line(self.task.file),
        })
    }
}

/// Log density of the innovations with a term less that without it, nats, over the rows that both have.
fn gain<const R: usize>(with: &Run<R>, without: &Run<R>) -> f64 {
    let rows = with.log_density.iter().flatten().zip(without.log_density.iter().flatten());
    rows.map(|(a, b)| a - b).filter(|difference| difference.is_finite()).sum()
}

/// The sentence of the verdict about the terms tried.
pub(crate) fn sentence(offer: &Offer) -> String {
    match offer.best() {
        Some(best) => {
            let rest = match best.remaining.as_slice() {
                _ if offer.reasons.is_empty() => String::new(),
                [] => format!(" It explains all that gave a reason to look ({}).", offer.reasons.join("; ")),
                left => format!(
                    " It is not the whole truth, or stands for something else: with it {} still.",
                    left.join(", and ")
                ),
            };
            format!(
                "The residuals ask for {} in {}: {} = {} +- {} (one sigma), a gain of {:.0} nats where {:.1} are enough.{rest} \
                 The lines for the model file stand with the terms that were tried.",
                best.term,
                best.coefficient,
                best.parameter,
                number(best.value),
                number(best.std_error),
                best.gain,
                offer.threshold,
            )
        }
        None if offer.terms.is_empty() => {
            "No product of the model's variables is left to be tried as a missing term.".to_owned()
        }
        None => format!(
            "None of the {} products that were tried as a missing term ({}) explains the residuals.",
            offer.terms.len(),
            offer.terms.iter().map(|t| format!("{} in {}", t.term, t.coefficient)).collect::<Vec<_>>().join(", ")
        ),
    }
}

/// The number with four significant digits, as it stands in a model file.
fn number(value: f64) -> String {
    let exponent = if value == 0.0 || !value.is_finite() { 0 } else { value.abs().log10().floor() as i32 };
    format!("{value:.*}", (3 - exponent).clamp(0, 9) as usize)
}
