//! Filter error: maximum likelihood with process noise.

use std::cell::RefCell;

use super::error::BatchError;
use super::filter::Innovations;
use super::filters::{Filters, step_of};
use super::likelihood::Evaluation;
use super::optimise::{OptimiserSettings, minimise};
use super::problem::{Manoeuvre, ProcessNoise, Structure, with_outputs};
use super::response::Rows;
use super::result::BatchFit;
use super::summary::{Summary, summarise};
use crate::core::options::Likelihood;
use crate::preparation::noise::{measure_own_noise, without_outliers};

/// Most steps that the search learns the curvature of the cost from.
const SECANTS: usize = 12;

/// Fits the predictions of a Kalman filter to the measured outputs of all manoeuvres at once.
///
/// Minimises the negative log-likelihood of the innovations,
///
/// ```text
/// J = 1/2 sum_k sum_i [ e_i(k)^2 / s_i(k) + ln s_i(k) ]   ( + priors )
/// ```
///
/// With a [robust](crate::options::Likelihood) likelihood outliers are left out first: single values that stand out of the
/// median of the five around them, and of both neighbours, by eight sigmas of the channel's own noise; a note counts
/// them. (A loss with heavy tails, as output error has it, makes the likelihood of a filter rough: the search then ended
/// early on six of 53 foreign flights.) Minimised
/// over parameters, biases and, where they are to be estimated, the variances of measurement and process noise (by
/// their logarithms, so that every filter on the way has a valid, stabilising gain). The filter is time-varying; the
/// initial state is not searched but starts ten sensor sigmas wide and is found by the first samples. Fisher scoring
/// (Gupta & Mehra, IEEE Transactions on Automatic Control AC-19, 1974; Jategaonkar, Flight Vehicle System
/// Identification, chapter 5) with the safeguard of the other methods:
///
/// ```text
/// M_jk = sum [ (de/dz_j)(de/dz_k) / s + 1/2 (d ln s/dz_j)(d ln s/dz_k) ]
/// ```
///
/// The derivatives of the whole filter, its gain included, are forward differences with a step of a thousandth of a
/// standard error: their own error is some thousandths of what they decide.
///
/// # Errors
/// [`BatchError`]: inputs that contradict each other, a filter that diverges, unknowns of which the data determine only
/// a combination, no convergence.
pub fn filter_error<const N: usize, const R: usize>(
    manoeuvres: &[Manoeuvre<'_, N, R>],
    structure: &Structure<N, R>,
    process_noise: &ProcessNoise<N>,
    settings: &OptimiserSettings,
) -> Result<BatchFit, BatchError> {
    structure.check(manoeuvres)?;
    if let Some(i) = process_noise.density.iter().position(|q| !(q.is_finite() && *q >= 0.0)) {
        let (name, density) = (&structure.states[i].name, process_noise.density[i]);
        return Err(BatchError::BadInput(format!("the process noise of {name} is {density}: it must not be negative")));
    }
    if let Some(state) = structure.states.iter().find(|state| state.measured) {
        return Err(BatchError::BadInput(format!(
            "filter error cannot take the state {} as measured: its process noise is what allows for gusts",
            state.name
        )));
    }
    let (outputs, left_out) = without_strays(manoeuvres, structure);
    let manoeuvres = with_outputs(manoeuvres, &outputs);
    let filters = Filters::of(&manoeuvres, structure, process_noise)?;
    let (layout, manoeuvres) = (&filters.layout, manoeuvres.as_slice());
    let used = Structure::used(manoeuvres);
    let steps = RefCell::new(filters.first_steps());
    let searched_first = |j: usize| layout.places[j].kind.is_variance();
    // With the variances alone, an evaluation costs a third.
    let evaluate = |unknowns: &[f64], below: f64, all: bool| -> Result<Option<Evaluation<Filtered<R>>>, BatchError> {
        let centre = filters.innovations(unknowns)?;
        let cost: f64 = centre.iter().map(Innovations::cost).sum();
        let mut evaluation = Evaluation::of_priors(&layout.places, unknowns);
        let total = evaluation.cost + cost;
        if total.is_nan() || total >= below {
            return Ok(None);
        }
        let priors = evaluation.information.diagonal();
        let mut rows = Vec::with_capacity(centre.len());
        for (mean, spread) in filters.rows(centre, unknowns, &steps.borrow(), |j| all || searched_first(j))? {
            evaluation.add(&mean);
            evaluation.add(&spread);
            rows.push(mean);
        }
        for (j, step) in steps.borrow_mut().iter_mut().enumerate() {
            if !searched_first(j) {
                *step = step_of(evaluation.information[(j, j)] - priors[j]).unwrap_or(*step);
            }
        }
        Ok(Some(evaluation.with(cost, Filtered { rows })))
    };
    // The densities of the process noise may be decades away, and then each step changes them by a factor of e only.
    let diverged = || BatchError::Diverged { manoeuvre: manoeuvres[0].name.to_owned(), time_s: 0.0 };
    let mut start = layout.start();
    if layout.places.iter().enumerate().any(|(j, _)| searched_first(j)) {
        let first = evaluate(&start, f64::INFINITY, false)?.ok_or_else(diverged)?;
        let rough = OptimiserSettings { step_tolerance: 1.0, acceptable_step: f64::INFINITY, ..*settings };
        let search = |unknowns: &[f64], below: f64| evaluate(unknowns, below, false).ok().flatten();
        start = minimise(&layout.places, start, first, &rough, SECANTS, search)?.unknowns;
    }
    // Twice: the second time with steps that suit the information.
    evaluate(&start, f64::INFINITY, true)?;
    let first = evaluate(&start, f64::INFINITY, true)?.ok_or_else(diverged)?;
    let search = |unknowns: &[f64], below: f64| evaluate(unknowns, below, true).ok().flatten();
    let minimum = minimise(&layout.places, start, first, settings, SECANTS, search)?;
    let found = filters.tuning(0, &minimum.unknowns);
    let noise_std = std::array::from_fn(|i| if used[i] { found.noise[i].sqrt() } else { f64::NAN });
    let mut fit = summarise(&Summary {
        method: "filter-error",
        structure,
        manoeuvres,
        layout,
        minimum: &minimum,
        rows: &minimum.evaluation.detail.rows,
        noise_std: &noise_std,
    })?;
    fit.process_noise = found.process_noise.to_vec();
    let counts = structure.outputs.iter().zip(left_out).filter(|(_, count)| *count > 0);
    let counts: Vec<String> = counts.map(|(channel, count)| format!("{count} of {}", channel.name)).collect();
    if !counts.is_empty() {
        fit.notes.push(format!(
            "values that stand out of their neighbours by eight sigmas were left out: {}",
            counts.join(", ")
        ));
    }
    Ok(fit)
}

/// The outputs of each manoeuvre as a [robust](crate::options::Likelihood) likelihood takes them, and how many values of each
/// output were left out for that; with a Gaussian one as they are.
pub(super) fn without_strays<const N: usize, const R: usize>(
    manoeuvres: &[Manoeuvre<'_, N, R>],
    structure: &Structure<N, R>,
) -> (Vec<Vec<[f64; R]>>, [usize; R]) {
    match structure.likelihood {
        Likelihood::Gaussian => (manoeuvres.iter().map(|m| m.outputs.to_vec()).collect(), [0; R]),
        Likelihood::Robust => clean(manoeuvres),
    }
}

/// The outputs of each manoeuvre without outliers, and how many there were, by output.
fn clean<const N: usize, const R: usize>(manoeuvres: &[Manoeuvre<'_, N, R>]) -> (Vec<Vec<[f64; R]>>, [usize; R]) {
    let mut left_out = [0; R];
    let of = |m: &Manoeuvre<'_, N, R>| {
        let mut outputs = m.outputs.to_vec();
        for (i, count) in left_out.iter_mut().enumerate() {
            let values: Vec<f64> = m.outputs.iter().map(|y| y[i]).collect();
            let Some(noise) = measure_own_noise(&values) else { continue };
            for (y, value) in outputs.iter_mut().zip(without_outliers(&values, noise.std)) {
                *count += usize::from(y[i].is_finite() && value.is_nan());
                y[i] = value;
            }
        }
        outputs
    };
    (manoeuvres.iter().map(of).collect(), left_out)
}

struct Filtered<const R: usize> {
    rows: Vec<Rows<R>>,
}
