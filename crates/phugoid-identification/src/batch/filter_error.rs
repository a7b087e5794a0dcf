//! Filter error: maximum likelihood with process noise.

use crate::core::options::Likelihood;
use std::cell::RefCell;

use super::error::BatchError;
use super::filter::{Innovations, Tuning, filter};
use super::layout::{Layout, Place};
use super::likelihood::Evaluation;
use super::loss::Loss;
use super::optimise::{OptimiserSettings, minimise};
use super::problem::{Manoeuvre, Noise, Structure};
use super::response::Rows;
use super::result::{BatchFit, UnknownKind};
use super::start::stretches;
use super::summary::{Summary, summarise};
use crate::preparation::noise::{measure_own_noise, without_outliers};

/// What is known of the process noise: turbulence and model error that drive the states.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ProcessNoise<const N: usize> {
    /// Variance that each state gains per second, state units squared per second; 0 for a state without.
    pub density: [f64; N],
    /// True if the densities that are not zero are estimated with the parameters, from these on.
    pub estimated: bool,
}

/// One sigma of the initial state over that of the sensor that measures it: the first samples decide.
const INITIAL_SD: f64 = 10.0;
/// One sigma of the logarithm of a variance about its start: a factor of ten in standard deviation. It only keeps a
/// variance that the data say nothing of from running away.
const LOG_VARIANCE_SD: f64 = 4.605_170_186;
/// Largest distance that the logarithm of a variance may move from its start.
const LOG_VARIANCE_RANGE: f64 = 18.0;
/// Step of the differences over the standard error that an unknown would have if all others were known.
const DIFFERENCE: f64 = 1e-3;
/// Most steps that the search learns the curvature of the cost from.
const SECANTS: usize = 12;
/// First relative step, as long as that is not known.
const FIRST_DIFFERENCE: f64 = 1e-5;

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
    let (outputs, left_out) = match structure.likelihood {
        Likelihood::Gaussian => (manoeuvres.iter().map(|m| m.outputs.to_vec()).collect(), [0; R]),
        Likelihood::Robust => clean(manoeuvres),
    };
    let manoeuvres: Vec<Manoeuvre<'_, N, R>> =
        manoeuvres.iter().zip(&outputs).map(|(m, outputs)| Manoeuvre { outputs, ..*m }).collect();
    let manoeuvres = manoeuvres.as_slice();
    let used = Structure::used(manoeuvres);
    let noise = first_noise(manoeuvres, structure)?;
    let initial_std = initial_std(manoeuvres, structure, &noise)?;
    let mut held = structure.clone();
    held.states.iter_mut().for_each(|s| s.free = false);
    let mut layout: Layout<N> = Layout::new(&held, manoeuvres, stretches(manoeuvres, structure)?);
    layout.places.extend(variances(structure, &noise, process_noise, &used));

    let tuning = |index: usize, unknowns: &[f64]| -> Tuning<N, R> {
        let mut tuning = Tuning {
            parameters: layout.parameters(unknowns),
            biases: layout.biases(index, unknowns),
            stretches: layout.stretches(index, unknowns),
            initial_std,
            noise: noise.map(|std| std * std),
            process_noise: process_noise.density,
            maximum_step_s: structure.maximum_step_s,
        };
        for (place, value) in layout.places.iter().zip(unknowns) {
            match place.kind {
                UnknownKind::Noise { output } => tuning.noise[output] = value.exp(),
                UnknownKind::ProcessNoise { state } => tuning.process_noise[state] = value.exp(),
                _ => {}
            }
        }
        tuning
    };
    let run = |index: usize, unknowns: &[f64]| -> Result<Innovations<R>, BatchError> {
        let m = &manoeuvres[index];
        filter(m, &tuning(index, unknowns))
            .map_err(|time_s| BatchError::Diverged { manoeuvre: m.name.to_owned(), time_s })
    };
    let first_step = |p: &Place| match p.kind {
        UnknownKind::Noise { .. } | UnknownKind::ProcessNoise { .. } => 1e-4,
        _ if p.start != 0.0 => FIRST_DIFFERENCE * p.start.abs(),
        _ if p.prior_std.is_finite() => FIRST_DIFFERENCE * p.prior_std,
        _ => FIRST_DIFFERENCE,
    };
    let steps = RefCell::new(layout.places.iter().map(first_step).collect::<Vec<f64>>());
    let searched_first =
        |j: usize| matches!(layout.places[j].kind, UnknownKind::Noise { .. } | UnknownKind::ProcessNoise { .. });
    // With the variances alone, an evaluation costs a third.
    let evaluate = |unknowns: &[f64], below: f64, all: bool| -> Result<Option<Evaluation<Filtered<R>>>, BatchError> {
        let centre = (0..manoeuvres.len()).map(|m| run(m, unknowns)).collect::<Result<Vec<_>, _>>()?;
        let cost: f64 = centre.iter().map(Innovations::cost).sum();
        let mut evaluation = Evaluation::of_priors(&layout.places, unknowns);
        let total = evaluation.cost + cost;
        if total.is_nan() || total >= below {
            return Ok(None);
        }
        let priors = evaluation.information.diagonal();
        let mut rows = Vec::with_capacity(centre.len());
        for (index, innovations) in centre.into_iter().enumerate() {
            let mut columns = layout.columns(index);
            columns.retain(|j| all || searched_first(*j));
            let (mean, spread) = differences(innovations, columns, &steps.borrow(), unknowns, |z| run(index, z))?;
            evaluation.add(&mean);
            evaluation.add(&spread);
            rows.push(mean);
        }
        for (j, step) in steps.borrow_mut().iter_mut().enumerate() {
            let information = evaluation.information[(j, j)] - priors[j];
            if !searched_first(j) && information > 0.0 {
                *step = DIFFERENCE / information.sqrt();
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
    let found = tuning(0, &minimum.unknowns);
    let noise_std = std::array::from_fn(|i| if used[i] { found.noise[i].sqrt() } else { f64::NAN });
    let mut fit = summarise(&Summary {
        method: "filter-error",
        structure,
        manoeuvres,
        layout: &layout,
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

/// The outputs of each manoeuvre without outliers, and how many there were, by output.
pub(super) fn clean<const N: usize, const R: usize>(
    manoeuvres: &[Manoeuvre<'_, N, R>],
) -> (Vec<Vec<[f64; R]>>, [usize; R]) {
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

/// One sigma of each output to start from: as given, or measured from the records.
fn first_noise<const N: usize, const R: usize>(
    manoeuvres: &[Manoeuvre<'_, N, R>],
    structure: &Structure<N, R>,
) -> Result<[f64; R], BatchError> {
    let used = Structure::used(manoeuvres);
    let mut noise = [1.0; R];
    for (i, channel) in structure.outputs.iter().enumerate().filter(|(i, _)| used[*i]) {
        noise[i] = match channel.noise {
            Noise::Known(std) => std,
            Noise::Estimated => manoeuvres
                .iter()
                .find_map(|m| measure_own_noise(&m.outputs.iter().map(|y| y[i]).collect::<Vec<f64>>()))
                .map(|found| found.std)
                .ok_or_else(|| {
                    let name = &channel.name;
                    BatchError::BadInput(format!("the noise of {name} cannot be measured from the records: give it"))
                })?,
        };
    }
    Ok(noise)
}

fn initial_std<const N: usize, const R: usize>(
    manoeuvres: &[Manoeuvre<'_, N, R>],
    structure: &Structure<N, R>,
    noise: &[f64; R],
) -> Result<[f64; N], BatchError> {
    let mut initial_std = [0.0; N];
    for (i, std) in initial_std.iter_mut().enumerate().filter(|(i, _)| structure.states[*i].free) {
        let measured = manoeuvres.first().and_then(|m| m.plant.measuring_output(i)).map(|output| noise[output]);
        *std = INITIAL_SD
            * measured.ok_or_else(|| {
                let name = &structure.states[i].name;
                BatchError::BadInput(format!("nothing measures the state {name}: filter error needs its start, held"))
            })?;
    }
    Ok(initial_std)
}

/// Variances that are searched, by their logarithms.
fn variances<const N: usize, const R: usize>(
    structure: &Structure<N, R>,
    noise: &[f64; R],
    process_noise: &ProcessNoise<N>,
    used: &[bool; R],
) -> Vec<Place> {
    let place = |kind, name: String, variance: f64| Place {
        kind,
        name,
        start: variance.ln(),
        prior_std: LOG_VARIANCE_SD,
        lower: variance.ln() - LOG_VARIANCE_RANGE,
        upper: variance.ln() + LOG_VARIANCE_RANGE,
    };
    let outputs = structure.outputs.iter().enumerate().filter(|(i, c)| used[*i] && c.noise == Noise::Estimated);
    let states = structure.states.iter().enumerate();
    outputs
        .map(|(i, c)| place(UnknownKind::Noise { output: i }, format!("noise of {}", c.name), noise[i] * noise[i]))
        .chain(states.filter(|(i, _)| process_noise.estimated && process_noise.density[*i] > 0.0).map(|(i, s)| {
            let kind = UnknownKind::ProcessNoise { state: i };
            place(kind, format!("process noise of {}", s.name), process_noise.density[i])
        }))
        .collect()
}

/// Rows of the innovations and of the logarithms of their variances, with derivatives by forward differences. Both are
/// made so that `sum S^T nu` is minus the gradient of the cost and `sum S^T S` the information.
fn differences<const R: usize>(
    centre: Innovations<R>,
    columns: Vec<usize>,
    steps: &[f64],
    unknowns: &[f64],
    run: impl Fn(&[f64]) -> Result<Innovations<R>, BatchError>,
) -> Result<(Rows<R>, Rows<R>), BatchError> {
    let samples = centre.errors.len();
    let width = columns.len();
    let mut mean = vec![0.0; samples * R * width];
    let mut spread = vec![0.0; samples * R * width];
    let mut shifted = unknowns.to_vec();
    for (c, &j) in columns.iter().enumerate() {
        shifted[j] = unknowns[j] + steps[j];
        let above = run(&shifted)?;
        let apart = shifted[j] - unknowns[j];
        shifted[j] = unknowns[j];
        for k in 0..samples {
            for i in (0..R).filter(|&i| centre.errors[k][i].is_finite()) {
                let s = centre.variances[k][i];
                let at = (k * R + i) * width + c;
                mean[at] = -(above.errors[k][i] - centre.errors[k][i]) / (apart * s.sqrt());
                spread[at] = (above.variances[k][i] - s) / (apart * s * std::f64::consts::SQRT_2);
            }
        }
    }
    let each = |f: &dyn Fn(f64, f64) -> f64| -> Vec<[f64; R]> {
        let pairs = centre.errors.iter().zip(&centre.variances);
        pairs.map(|(e, s)| std::array::from_fn(|i| f(e[i], s[i]))).collect()
    };
    let whitened = each(&|e, s| e / s.sqrt());
    let surprise = each(&|e, s| (e * e / s - 1.0) / std::f64::consts::SQRT_2);
    let rows = |outputs, residuals, sensitivities| Rows {
        columns: columns.clone(),
        outputs,
        residuals,
        sensitivities,
        loss: Loss::GAUSSIAN,
        growth: 1.0,
    };
    Ok((rows(centre.predicted, whitened, mean), rows(Vec::new(), surprise, spread)))
}
