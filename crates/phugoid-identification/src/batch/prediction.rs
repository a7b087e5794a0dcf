//! Prediction: the estimated parameters on a record that they have not seen.

use crate::core::options::CAPACITY;
use nalgebra::{DMatrix, DVector};
use phugoid_estimators::LinearizedOutputs;
use phugoid_estimators::discretization::step;

use super::error::BatchError;
use super::filter::predicted_covariance;
use super::flown::AsModel;
use super::layout::Layout;
use super::optimise::OptimiserSettings;
use super::output_error::output_error;
use super::problem::{Manoeuvre, Structure};
use super::response::{Rows, response};
use super::result::{BatchFit, UnknownKind};
use super::start::{Stretch, stretches};

/// Simulates other manoeuvres with `parameters` held (all of the model, in its order); only their initial states and
/// biases are fitted. The remaining residuals are what the model does not explain: [`super::OutputFit`] says how much
/// that is (Klein & Morelli, section 5.3; Jategaonkar, chapter 11).
///
/// # Errors
/// [`BatchError`], as [`output_error`].
pub fn predict<const N: usize, const R: usize>(
    manoeuvres: &[Manoeuvre<'_, N, R>],
    structure: &Structure<N, R>,
    parameters: &[f64],
    settings: &OptimiserSettings,
) -> Result<BatchFit, BatchError> {
    if parameters.len() != structure.parameters.len() {
        return Err(BatchError::BadInput(format!(
            "{} parameters were given for a prediction, the structure has {}",
            parameters.len(),
            structure.parameters.len()
        )));
    }
    let mut held = structure.clone();
    for (p, value) in held.parameters.iter_mut().zip(parameters) {
        (p.start, p.fixed) = (*value, true);
        (p.lower, p.upper) = (f64::NEG_INFINITY, f64::INFINITY);
    }
    output_error(manoeuvres, &held, settings)
}

/// One sigma of what will be measured about what [`predict`] gives, by manoeuvre, sample and output, in output units;
/// NaN outside of what was simulated.
///
/// ```text
/// s_i(k)^2 = r_i + h_i P(k) h_i^T + S~(k) C S~(k)^T + S_f(k) M_ff^-1 S_f(k)^T
/// S~ = S_theta - S_f M_ff^-1 M_f,theta
/// ```
///
/// with the variance `r` of the noise and the covariance `C` of the parameters as the estimation found them (corrected
/// for coloured residuals), the state covariance `P` that its process noise builds up in a free simulation, the
/// sensitivities `S_theta` to the parameters and `S_f` to what is fitted anew, the initial state and the biases, and
/// their information `M` on this record (Klein & Morelli, Aircraft System Identification, section 5.1.3, for a model
/// that is not linear and with unknowns that are fitted anew). Nothing in it was learnt from the outputs of the new
/// record but what is fitted anew: if the model and the bounds of the parameters are right, two sigma hold 95 % of it.
///
/// `estimated` is the fit of output error or filter error that the parameters come from; `predicted` what [`predict`]
/// gave for these manoeuvres and this structure.
///
/// # Errors
/// [`BatchError`]: the simulation diverges, or what is fitted anew cannot be told on the new record.
pub fn prediction_intervals<const N: usize, const R: usize>(
    manoeuvres: &[Manoeuvre<'_, N, R>],
    structure: &Structure<N, R>,
    estimated: &BatchFit,
    predicted: &BatchFit,
) -> Result<Vec<Vec<[f64; R]>>, BatchError> {
    let layout: Layout<N> = Layout::new(structure, manoeuvres, stretches(manoeuvres, structure)?);
    // Each unknown at its value, and its place among those that were estimated; none for what is fitted anew.
    let mut unknowns = Vec::with_capacity(layout.places.len());
    let mut origin = Vec::with_capacity(layout.places.len());
    for place in &layout.places {
        let among = |fit: &BatchFit| fit.unknowns.iter().position(|u| u.kind == place.kind);
        let (value, from) = match place.kind {
            UnknownKind::Parameter { index } => (estimated.parameters.get(index).copied(), among(estimated)),
            _ => (among(predicted).map(|i| predicted.unknowns[i].value), None),
        };
        unknowns.push(value.unwrap_or(place.start));
        origin.push(from);
    }
    let covariance = |a: usize, b: usize| -> f64 {
        let (Some(a), Some(b)) = (origin[a], origin[b]) else { return 0.0 };
        let widened = |i: usize| {
            let u = &estimated.unknowns[i];
            if u.std_error > 0.0 { u.corrected_std_error / u.std_error } else { 1.0 }
        };
        estimated.covariance[a][b] * widened(a) * widened(b)
    };
    let mut found = Vec::with_capacity(manoeuvres.len());
    for (index, m) in manoeuvres.iter().enumerate() {
        let diverged = |time_s| BatchError::Diverged { manoeuvre: m.name.to_owned(), time_s };
        let rows = response(m, index, &layout, &unknowns, structure.maximum_step_s).map_err(diverged)?;
        let is_parameter = |c: &usize| matches!(layout.places[rows.columns[*c]].kind, UnknownKind::Parameter { .. });
        let (by_parameter, anew): (Vec<usize>, Vec<usize>) = (0..rows.columns.len()).partition(is_parameter);
        let (inverse, follow) = anew_fitted(&rows, &layout, &by_parameter, &anew, &estimated.noise_std)?;
        let c = DMatrix::from_fn(by_parameter.len(), by_parameter.len(), |a, b| {
            covariance(rows.columns[by_parameter[a]], rows.columns[by_parameter[b]])
        });
        let parameters = layout.parameters(&unknowns);
        let density: [f64; N] = std::array::from_fn(|i| estimated.process_noise.get(i).copied().unwrap_or(0.0));
        let built_up =
            by_process_noise(m, &parameters, &layout.stretches(index, &unknowns), density, structure.maximum_step_s);
        let sigma = |k: usize, i: usize| {
            if !rows.outputs[k][i].is_finite() {
                return f64::NAN;
            }
            let all = rows.sensitivity(k, i);
            let fitted = DVector::from_iterator(anew.len(), anew.iter().map(|j| all[*j]));
            let direct = DVector::from_iterator(by_parameter.len(), by_parameter.iter().map(|j| all[*j]));
            let left = direct - follow.transpose() * &fitted;
            let noise = estimated.noise_std[i].powi(2);
            (noise + built_up[k][i] + left.dot(&(&c * &left)) + fitted.dot(&(&inverse * &fitted))).sqrt()
        };
        found.push((0..rows.outputs.len()).map(|k| std::array::from_fn(|i| sigma(k, i))).collect());
    }
    Ok(found)
}

/// `M_ff^-1` and `M_ff^-1 M_f,theta`: the errors of what is fitted anew, and how it follows the parameters.
fn anew_fitted<const N: usize, const R: usize>(
    rows: &Rows<R>,
    layout: &Layout<N>,
    by_parameter: &[usize],
    anew: &[usize],
    noise_std: &[f64],
) -> Result<(DMatrix<f64>, DMatrix<f64>), BatchError> {
    let mut own = DMatrix::<f64>::zeros(anew.len(), anew.len());
    let mut cross = DMatrix::<f64>::zeros(anew.len(), by_parameter.len());
    for (a, j) in anew.iter().enumerate() {
        let place = &layout.places[rows.columns[*j]];
        own[(a, a)] = place.prior_std.powi(-2);
    }
    for (k, residuals) in rows.residuals.iter().enumerate() {
        for i in (0..R).filter(|i| residuals[*i].is_finite() && noise_std[*i] > 0.0) {
            let weight = noise_std[i].powi(-2);
            let all = rows.sensitivity(k, i);
            for (a, ja) in anew.iter().enumerate() {
                for (b, jb) in anew.iter().enumerate() {
                    own[(a, b)] += weight * all[*ja] * all[*jb];
                }
                for (b, jb) in by_parameter.iter().enumerate() {
                    cross[(a, b)] += weight * all[*ja] * all[*jb];
                }
            }
        }
    }
    let name = |a: usize| layout.places[rows.columns[anew[a]]].name.clone();
    let inverse = super::information::covariance(&own, name)?;
    let follow = &inverse * cross;
    Ok((inverse, follow))
}

/// Variance of the outputs that process noise builds up in a free simulation from a known state, by sample.
fn by_process_noise<const N: usize, const R: usize>(
    manoeuvre: &Manoeuvre<'_, N, R>,
    parameters: &[f64; CAPACITY],
    stretches: &[Stretch<N>],
    density: [f64; N],
    maximum_step_s: f64,
) -> Vec<[f64; R]> {
    let plant = manoeuvre.plant;
    let mut variances = vec![[0.0; R]; manoeuvre.time_s.len()];
    if density.iter().all(|q| *q == 0.0) {
        return variances;
    }
    let mut lin = LinearizedOutputs::<N, R, CAPACITY>::ZERO;
    let (mut unused, mut transition) = ([[0.0; CAPACITY]; N], [[0.0; N]; N]);
    for stretch in stretches {
        let (mut x, mut covariance) = (stretch.state, [[0.0; N]; N]);
        for k in stretch.from..stretch.to {
            plant.linearized_outputs(&x, parameters, manoeuvre.instant(k), &mut lin);
            variances[k] = std::array::from_fn(|i| {
                let h = &lin.state_jacobian[i];
                (0..N).map(|a| h[a] * (0..N).map(|b| covariance[a][b] * h[b]).sum::<f64>()).sum()
            });
            if k + 1 == stretch.to {
                break;
            }
            let (input, interval_s, parts) = manoeuvre.interval(k, maximum_step_s);
            let steps = parts.len() as f64;
            for part in parts {
                x = step(&AsModel(plant), &x, parameters, &input, interval_s, part, 0, &mut unused, &mut transition);
                covariance = predicted_covariance(&covariance, &transition);
                for l in 0..N {
                    covariance[l][l] += density[l] * interval_s / steps;
                }
            }
        }
    }
    variances
}
