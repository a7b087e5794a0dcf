//! Makes the result of a batch method of the minimum of its cost.

use nalgebra::DMatrix;

use super::colour::Colour;
use super::error::BatchError;
use super::fit::OutputFit;
use super::information::covariance;
use super::layout::Layout;
use super::likelihood::Evaluation;
use super::optimise::Minimum;
use super::problem::{Manoeuvre, Structure};
use super::response::Rows;
use super::result::{BatchFit, ManoeuvreFit, Unknown, UnknownKind};

/// Everything that the result of a batch method is computed from.
pub(crate) struct Summary<'a, T, const N: usize, const R: usize> {
    pub(crate) method: &'static str,
    pub(crate) structure: &'a Structure<N, R>,
    pub(crate) manoeuvres: &'a [Manoeuvre<'a, N, R>],
    pub(crate) layout: &'a Layout<N>,
    pub(crate) minimum: &'a Minimum<T>,
    /// Divided by one sigma, one per manoeuvre.
    pub(crate) rows: &'a [Rows<R>],
    pub(crate) noise_std: &'a [f64; R],
}

pub(crate) fn summarise<T, const N: usize, const R: usize>(s: &Summary<'_, T, N, R>) -> Result<BatchFit, BatchError> {
    let manoeuvres = s
        .manoeuvres
        .iter()
        .zip(s.rows)
        .enumerate()
        .map(|(index, (m, rows))| manoeuvre_fit(s, index, m, rows))
        .collect();
    let estimates = Estimates { method: s.method, structure: s.structure, layout: s.layout, minimum: s.minimum };
    assemble(&estimates, &spread(s), s.noise_std, manoeuvres)
}

/// The minimum and what was searched.
pub(crate) struct Estimates<'a, T, const N: usize, const R: usize> {
    pub(crate) method: &'static str,
    pub(crate) structure: &'a Structure<N, R>,
    pub(crate) layout: &'a Layout<N>,
    pub(crate) minimum: &'a Minimum<T>,
}

/// The estimates with their covariance, and with the standard errors `M^-1 spread M^-1` for what the residuals make of the
/// spread of the gradient.
pub(crate) fn assemble<T, const N: usize, const R: usize>(
    s: &Estimates<'_, T, N, R>,
    spread: &DMatrix<f64>,
    noise_std: &[f64; R],
    manoeuvres: Vec<ManoeuvreFit>,
) -> Result<BatchFit, BatchError> {
    let places = &s.layout.places;
    let n = places.len();
    let claimed = covariance(&s.minimum.evaluation.information, |j| places[j].name.clone())?;
    let corrected = &claimed * spread * &claimed;
    let scales: Vec<f64> = places.iter().zip(&s.minimum.unknowns).map(|(p, z)| natural(p.kind, *z).1).collect();
    let unknowns = places
        .iter()
        .enumerate()
        .map(|(j, place)| {
            let (value, scale) = natural(place.kind, s.minimum.unknowns[j]);
            let std_error = scale * claimed[(j, j)].sqrt();
            Unknown {
                kind: place.kind,
                name: place.name.clone(),
                value,
                std_error,
                corrected_std_error: std_error.max(scale * corrected[(j, j)].max(0.0).sqrt()),
                at_limit: s.minimum.at_limit[j],
            }
        })
        .collect();
    let count = s.structure.parameters.len();
    Ok(BatchFit {
        method: s.method.to_owned(),
        parameters: s.layout.parameters(&s.minimum.unknowns)[..count].to_vec(),
        unknowns,
        covariance: (0..n).map(|i| (0..n).map(|j| scales[i] * claimed[(i, j)] * scales[j]).collect()).collect(),
        noise_std: noise_std.to_vec(),
        process_noise: Vec::new(),
        band: None,
        iterations: s.minimum.iterations.clone(),
        manoeuvres,
        notes: s.minimum.short_of.map(short_of).into_iter().collect(),
    })
}

/// Says how far from the minimum a search ended.
fn short_of(step: f64) -> String {
    format!(
        "the search for the minimum ended where its next step would still be {step:.2} standard errors long: no step lowered \
         the cost any more, or the iterations were used up. The values may be off by that much of their standard errors"
    )
}

/// A searched value in the unit that is shown, with the derivative: variances are searched by their logarithms.
fn natural(kind: UnknownKind, searched: f64) -> (f64, f64) {
    match kind {
        UnknownKind::Noise { .. } => {
            let std = (0.5 * searched).exp();
            (std, 0.5 * std)
        }
        UnknownKind::ProcessNoise { .. } => (searched.exp(), searched.exp()),
        _ => (searched, 1.0),
    }
}

/// Coloured spread and the rest of the information: priors and variances are taken as they are.
fn spread<T, const N: usize, const R: usize>(s: &Summary<'_, T, N, R>) -> DMatrix<f64> {
    let n = s.layout.places.len();
    let mut white = Evaluation::nothing(n);
    s.rows.iter().for_each(|r| white.add(r));
    let rest = &s.minimum.evaluation.information - white.information;
    Colour::of(s.rows).spread(s.rows, n) + rest
}

fn manoeuvre_fit<T, const N: usize, const R: usize>(
    s: &Summary<'_, T, N, R>,
    index: usize,
    manoeuvre: &Manoeuvre<'_, N, R>,
    rows: &Rows<R>,
) -> ManoeuvreFit {
    let unknowns = &s.minimum.unknowns;
    // What a state follows is not fitted, and has no residuals.
    let fitted = |i: &usize| rows.residuals.iter().any(|e| e[*i].is_finite());
    let outputs = s.structure.outputs.iter().enumerate().filter(|(i, _)| fitted(i)).filter_map(|(i, channel)| {
        let measured: Vec<f64> = manoeuvre.outputs.iter().map(|y| y[i]).collect();
        let fitted: Vec<f64> = rows.outputs.iter().map(|y| y[i]).collect();
        OutputFit::of(&channel.name, &measured, &fitted)
    });
    ManoeuvreFit {
        name: manoeuvre.name.to_owned(),
        initial_state: s.layout.stretches(index, unknowns).first().map(|s| s.state.to_vec()).unwrap_or_default(),
        biases: s.layout.biases::<R>(index, unknowns).to_vec(),
        outputs: outputs.collect(),
        fitted: rows.outputs.iter().map(|y| y.to_vec()).collect(),
        residuals: rows.residuals.iter().map(|e| e.to_vec()).collect(),
    }
}
