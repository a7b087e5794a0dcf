//! Output error in the frequency domain: maximum likelihood of a free simulation in a band.

use crate::core::options::Band;

use super::error::BatchError;
use super::filter_error::without_strays;
use super::in_band::{self, BandSummary, InBand};
use super::layout::Layout;
use super::optimise::OptimiserSettings;
use super::output_error::{diverged_or_unstable, unstable_note};
use super::problem::{Bias, Manoeuvre, Structure, with_outputs};
use super::relaxation::noise_floor;
use super::response::{Rows, response};
use super::result::{BatchFit, UnknownKind};
use super::spectrum::Spectrum;
use super::start::stretches;

/// Fits a free simulation to the measured outputs of all manoeuvres in a band of frequencies (Klein & Morelli, Aircraft
/// System Identification, chapter 7):
///
/// ```text
/// J = sum_i [ N_i ln s_i + 1/2 sum_f |F{ y_i - yhat_i }|^2 / s_i^2 ]
/// ```
///
/// The simulation is that of [`output_error()`](super::output_error()) with its exact sensitivities, and both are
/// transformed: the model may be nonlinear. `s_i` is the level of the residuals of an output in the band, at its optimum
/// for any parameters. What lies below the band, such as biases, drifts, slow gusts and a phugoid that the model lacks, and
/// what lies above it, such as noise and vibration, does not count.
///
/// Constants and initial states move an output in the band hardly or not at all. They are searched along, held by what is
/// below the band with one sigma of the size of the motion itself, so that the simulation stays near the flight. An unknown
/// whose variance comes for the larger part from there is one that the band does not determine: its standard errors are
/// infinite, and a note names the parameters among them.
///
/// # Errors
/// [`BatchError`]: inputs that contradict each other, a simulation that diverges, a band that the record is too short for,
/// unknowns of which the data determine only a combination, no convergence.
pub fn output_error_frequency<const N: usize, const R: usize>(
    manoeuvres: &[Manoeuvre<'_, N, R>],
    structure: &Structure<N, R>,
    band: Band,
    settings: &OptimiserSettings,
) -> Result<BatchFit, BatchError> {
    structure.check(manoeuvres)?;
    let (outputs, _) = without_strays(manoeuvres, structure);
    let manoeuvres = with_outputs(manoeuvres, &outputs);
    let manoeuvres = manoeuvres.as_slice();
    let BandSimulation { layout, spectrum, floor, motion } = BandSimulation::of(manoeuvres, structure, band)?;
    let simulate = |unknowns: &[f64]| -> Result<Vec<Rows<R>>, BatchError> {
        let run = |(index, m): (usize, &Manoeuvre<'_, N, R>)| {
            response(m, index, &layout, unknowns, structure.maximum_step_s)
                .map_err(|time_s| BatchError::Diverged { manoeuvre: m.name.to_owned(), time_s })
        };
        manoeuvres.iter().enumerate().map(run).collect()
    };
    let minimum = in_band::fit(&layout.places, layout.start(), &spectrum, Some(&motion), &floor, settings, simulate)
        .map_err(|e| diverged_or_unstable(e, manoeuvres, || simulate(&layout.start())))?;
    let mut fit = in_band::summarise(&BandSummary {
        method: "output-error-frequency",
        structure,
        manoeuvres,
        layout: &layout,
        spectrum: &spectrum,
        minimum: &minimum,
        measured: outputs.clone(),
    })?;
    let InBand { time, .. } = &minimum.evaluation.detail;
    fit.notes.extend(manoeuvres.iter().zip(time).filter_map(|(m, rows)| unstable_note(m.name, rows.growth)));
    let outside = not_in_band(&mut fit, &minimum.evaluation.detail.held);
    if !outside.is_empty() {
        fit.notes.push(format!(
            "not identifiable in the band, because only what lies below it tells of them: {}. They keep what the model file \
             says of them",
            outside.join(", ")
        ));
    }
    Ok(fit)
}

/// What a simulation is compared by in a band, and what is unknown in it.
pub(super) struct BandSimulation<const N: usize, const R: usize> {
    pub(super) layout: Layout<N>,
    pub(super) spectrum: Spectrum<R>,
    pub(super) floor: [f64; R],
    /// One sigma of what lies below the band, by output.
    pub(super) motion: [f64; R],
}

impl<const N: usize, const R: usize> BandSimulation<N, R> {
    /// Of manoeuvres without outliers.
    ///
    /// # Errors
    /// [`BatchError::BadInput`] for a band that is none, that the records are too short for, or where nothing measures a state.
    pub(super) fn of(
        manoeuvres: &[Manoeuvre<'_, N, R>],
        structure: &Structure<N, R>,
        band: Band,
    ) -> Result<Self, BatchError> {
        let band = band.check().map_err(|e| BatchError::BadInput(e.to_string()))?;
        let mut held = structure.clone();
        // A constant error has nothing in the band.
        held.outputs.iter_mut().for_each(|channel| channel.bias = Bias::None);
        let stretches = stretches(manoeuvres, structure)?;
        let spectrum: Spectrum<R> = Spectrum::new(
            band,
            manoeuvres.iter().map(|m| m.time_s),
            &stretches.iter().map(|all| all.iter().map(|s| [s.from, s.to]).collect()).collect::<Vec<_>>(),
            &manoeuvres.iter().map(|m| m.outputs).collect::<Vec<_>>(),
        );
        spectrum.check(band)?;
        let layout = Layout::new(&held, manoeuvres, stretches);
        Ok(Self { layout, spectrum, floor: noise_floor(manoeuvres), motion: motion(manoeuvres) })
    }
}

/// Makes the standard errors infinite of the unknowns whose variance `C` comes for the larger part from what holds the
/// simulation, `C M_held C`; gives the parameters among them.
fn not_in_band(fit: &mut BatchFit, held: &nalgebra::DMatrix<f64>) -> Vec<String> {
    let count = fit.unknowns.len();
    let covariance = nalgebra::DMatrix::from_fn(count, count, |i, j| fit.covariance[i][j]);
    let by_holding = &covariance * held * &covariance;
    let mut names = Vec::new();
    for (j, unknown) in fit.unknowns.iter_mut().enumerate() {
        if by_holding[(j, j)] > 0.5 * covariance[(j, j)] {
            (unknown.std_error, unknown.corrected_std_error) = (f64::INFINITY, f64::INFINITY);
            if matches!(unknown.kind, UnknownKind::Parameter { .. }) {
                names.push(unknown.name.clone());
            }
        }
    }
    names
}

/// How far each output moves in the manoeuvres: standard deviation about its mean; not below what would be noise of exact
/// data. NaN without values.
fn motion<const N: usize, const R: usize>(manoeuvres: &[Manoeuvre<'_, N, R>]) -> [f64; R] {
    let floor = noise_floor(manoeuvres);
    std::array::from_fn(|i| {
        let (mut squares, mut count) = (0.0, 0.0);
        for m in manoeuvres {
            let values: Vec<f64> = m.outputs.iter().map(|y| y[i]).filter(|v| v.is_finite()).collect();
            let mean = values.iter().sum::<f64>() / values.len().max(1) as f64;
            squares += values.iter().map(|v| (v - mean).powi(2)).sum::<f64>();
            count += values.len() as f64;
        }
        if count > 0.0 { (squares / count).sqrt().max(floor[i]) } else { f64::NAN }
    })
}
