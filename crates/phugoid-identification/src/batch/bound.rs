//! The Cramer-Rao bound: the smallest standard errors that an unbiased estimator can have on given data, with the
//! parameters held at given values.

use nalgebra::DMatrix;

use super::colour::Colour;
use super::error::BatchError;
use super::information::covariance;
use super::layout::Layout;
use super::likelihood::Evaluation;
use super::loss::Loss;
use super::optimise::OptimiserSettings;
use super::output_error::GROWTH;
use super::prediction::predict;
use super::problem::{Manoeuvre, Noise, Structure};
use super::relaxation::{levels, noise_floor};
use super::response::{Rows, response};
use super::result::UnknownKind;
use super::start::stretches;

/// The bound on the standard error of one unknown.
#[derive(Clone, Debug, PartialEq)]
pub struct Bounded {
    /// Which kind of unknown this is, with its position in the model or the manoeuvre.
    pub kind: UnknownKind,
    /// Name of the unknown as the user knows it, e.g. `Cm_alpha` or `bias of alpha`.
    pub name: String,
    /// Smallest standard error of an unbiased estimator, where the outputs have no other error than the noise of the
    /// structure.
    pub std_error: f64,
    /// The same with the residuals that the model leaves at these values in place of that noise, their colour allowed
    /// for.
    pub with_residuals: f64,
    /// The unknown whose error is most correlated with that of this one, and the correlation.
    pub closest: Option<(String, f64)>,
}

/// The bound of all free unknowns of a structure with its parameters at `parameters`, from the information `sum_k
/// S(k)^T R^-1 S(k)` of the outputs that were measured and of the priors (Klein & Morelli, Aircraft System
/// Identification, section 6.1; with priors H. L. Van Trees, 1968, section 2.4). The sensitivities `S` are those of a
/// free simulation with the recorded inputs, from the measured initial state. Where the structure does not give the
/// noise of an output, that of its residuals is used.
///
/// # Errors
/// [`BatchError`]: inputs that contradict each other, a simulation that diverges or is unstable, unknowns without prior
/// of which the data determine only a combination.
pub fn bound<const N: usize, const R: usize>(
    manoeuvres: &[Manoeuvre<'_, N, R>],
    structure: &Structure<N, R>,
    parameters: &[f64],
) -> Result<Vec<Bounded>, BatchError> {
    structure.check(manoeuvres)?;
    let mut at = structure.clone();
    for (parameter, value) in at.parameters.iter_mut().zip(parameters) {
        parameter.start = value.clamp(parameter.lower, parameter.upper);
    }
    // The start of the simulation is found with the parameters held, so that its residuals are those of the model.
    let search = OptimiserSettings::default();
    let held = predict::<N, R>(manoeuvres, &at, parameters, &search)?;
    let mut stretches = stretches(manoeuvres, &at)?;
    for unknown in &held.unknowns {
        if let UnknownKind::InitialState { state, manoeuvre, stretch } = unknown.kind {
            stretches[manoeuvre][stretch].state[state] = unknown.value;
        }
    }
    let layout: Layout<N> = Layout::new(&at, manoeuvres, stretches);
    let start = layout.start();
    let mut rows: Vec<Rows<R>> = Vec::with_capacity(manoeuvres.len());
    for (index, m) in manoeuvres.iter().enumerate() {
        let simulated = response(m, index, &layout, &start, structure.maximum_step_s)
            .map_err(|time_s| BatchError::Diverged { manoeuvre: m.name.to_owned(), time_s })?;
        if simulated.growth > GROWTH {
            return Err(BatchError::Unstable { manoeuvre: m.name.to_owned(), growth: simulated.growth });
        }
        rows.push(simulated);
    }
    let floor = noise_floor(manoeuvres);
    let loss = Loss::of(structure.likelihood);
    let (quiet, _) = levels(&structure.outputs.each_ref().map(|channel| channel.noise), &rows, &floor, loss);
    let (left, _) = levels(&[Noise::Estimated; R], &rows, &floor, loss);
    let name = |j: usize| layout.places[j].name.clone();
    let best = covariance(&information(&layout, &start, &rows, &quiet).0, name)?;
    let loud: [f64; R] = std::array::from_fn(|i| quiet[i].max(left[i]));
    let (information, data, whitened) = information(&layout, &start, &rows, &loud);
    let white = covariance(&information, name)?;
    let spread = Colour::of(&whitened).spread(&whitened, start.len());
    let coloured = &white * (spread + information - data) * &white;
    let places = layout.places.iter().enumerate().map(|(j, place)| {
        let others = (0..layout.places.len()).filter(|&i| i != j);
        let correlation = |i: usize| white[(i, j)] / (white[(i, i)] * white[(j, j)]).sqrt();
        let closest = others.max_by(|&a, &b| correlation(a).abs().total_cmp(&correlation(b).abs()));
        Bounded {
            kind: place.kind,
            name: place.name.clone(),
            std_error: best[(j, j)].sqrt(),
            with_residuals: coloured[(j, j)].max(white[(j, j)]).max(best[(j, j)]).sqrt(),
            closest: closest.map(|i| (layout.places[i].name.clone(), correlation(i))),
        }
    });
    Ok(places.collect())
}

/// The information with these noise levels, priors included; the part that comes from the data; and the rows divided by
/// the noise levels.
fn information<const N: usize, const R: usize>(
    layout: &Layout<N>,
    unknowns: &[f64],
    rows: &[Rows<R>],
    noise_std: &[f64; R],
) -> (DMatrix<f64>, DMatrix<f64>, Vec<Rows<R>>) {
    let whitened: Vec<Rows<R>> = rows.iter().map(|r| r.clone().whitened(noise_std, Loss::GAUSSIAN)).collect();
    let mut data = Evaluation::nothing(layout.places.len());
    whitened.iter().for_each(|r| data.add(r));
    let priors = Evaluation::of_priors(&layout.places, unknowns).information;
    (priors + &data.information, data.information, whitened)
}
