//! Output error: maximum likelihood without process noise.

use super::error::BatchError;
use super::followed::Followed;
use super::layout::Layout;
use super::loss::Loss;
use super::optimise::OptimiserSettings;
use super::problem::{Manoeuvre, Structure};
use super::relaxation::{self, Fitted, noise_floor};
use super::response::{Rows, response};
use super::result::BatchFit;
use super::start::stretches;
use super::summary::{Summary, summarise};

/// Fits a free simulation to the measured outputs of all manoeuvres at once. After a gap it begins anew.
///
/// Minimises, over parameters, initial states and biases,
///
/// ```text
/// J = sum_i [ beta N_i/2 ln r_i + sum_k rho((y_i(k) - yhat_i(k)) / sqrt(r_i)) ]   ( + 1/2 sum (theta_j - start_j)^2 / prior_j^2 )
/// ```
///
/// with `rho(z) = z^2/2` and `beta = 1` for a [Gaussian](crate::options::Likelihood) likelihood, and a loss with
/// heavy tails for the robust one, which counts a residual beyond three sigmas the less the further away it is. The noise variances `r_i` are
/// given, or at their own optimum for any given parameters (`r_i = sum_k e_i(k)^2 / N_i` of the Gaussian one; the
/// relaxation of Klein & Morelli, section 6.1.1, and Jategaonkar, section 4.3; noise of different outputs is taken for
/// independent). A state that is [measured](super::InitialState::measured) is not integrated, and its output not fitted. Gauss-Newton with exact output sensitivities, safeguarded by Levenberg-Marquardt; it ends when the
/// next step is shorter than [`OptimiserSettings::step_tolerance`] standard errors.
///
/// ```
/// use phugoid_estimators::discretization::InputHold;
/// use phugoid_estimators::{LinearizedOutputs, LinearizedRates, Model};
/// use phugoid_identification::options::Likelihood;
/// use phugoid_identification::batch::{
///     BatchParameter, InitialState, Manoeuvre, Noise, OptimiserSettings, OutputChannel, Structure, WithInputs,
///     output_error,
/// };
///
/// /// `x' = a x + b u`, and `x` is measured: in any room for at least two parameters.
/// struct Lag;
///
/// impl<const P: usize> Model<1, 1, P> for Lag {
///     type Input = [f64; 1];
///     fn parameter_count(&self) -> usize {
///         2
///     }
///     fn rates(&self, x: &[f64; 1], theta: &[f64; P], u: &[f64; 1]) -> [f64; 1] {
///         [theta[0] * x[0] + theta[1] * u[0]]
///     }
///     fn linearized_rates(&self, x: &[f64; 1], theta: &[f64; P], u: &[f64; 1], out: &mut LinearizedRates<1, P>) {
///         *out = LinearizedRates::ZERO;
///         out.rates = self.rates(x, theta, u);
///         out.state_jacobian = [[theta[0]]];
///         out.regressors[0][..2].copy_from_slice(&[x[0], u[0]]);
///     }
///     fn linearized_outputs(&self, x: &[f64; 1], _: &[f64; P], _: &[f64; 1], out: &mut LinearizedOutputs<1, 1, P>) {
///         *out = LinearizedOutputs::ZERO;
///         out.outputs = *x;
///         out.state_jacobian = [[1.0]];
///     }
///     fn measuring_output(&self, _state: usize) -> Option<usize> {
///         Some(0)
///     }
/// }
///
/// // The answer to a step of one, with a = -2 and b = 4: x = 2 (1 - exp(-2 t)).
/// let time_s: Vec<f64> = (0..100).map(|k| 0.02 * f64::from(k)).collect();
/// let outputs: Vec<[f64; 1]> = time_s.iter().map(|t| [2.0 * (1.0 - (-2.0 * t).exp())]).collect();
/// let inputs = vec![[1.0]; 100];
/// let manoeuvre = Manoeuvre {
///     name: "step",
///     plant: &WithInputs { model: &Lag, inputs: &inputs },
///     first: 0,
///     time_s: &time_s,
///     hold: InputHold::Zero,
///     outputs: &outputs,
///     initial_state: None,
/// };
/// let structure = Structure {
///     parameters: vec![BatchParameter::free("a", -1.0), BatchParameter::free("b", 1.0)],
///     states: [InitialState::free("x")],
///     outputs: [OutputChannel::new("x", Noise::Known(0.01))],
///     maximum_step_s: 0.02,
///     maximum_gap_s: 0.5,
///     likelihood: Likelihood::Robust,
/// };
/// let fit = output_error(&[manoeuvre], &structure, &OptimiserSettings::default())?;
/// let a = fit.unknown("a").ok_or("not estimated")?;
/// assert!((a.value - (-2.0)).abs() < 1e-3 * 2.0, "{a:?}");
/// assert!(a.std_error > 0.0 && a.std_error < 0.1);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`BatchError`]: inputs that contradict each other, a simulation that diverges, unknowns of which the data determine
/// only a combination, no convergence.
pub fn output_error<const N: usize, const R: usize>(
    manoeuvres: &[Manoeuvre<'_, N, R>],
    structure: &Structure<N, R>,
    settings: &OptimiserSettings,
) -> Result<BatchFit, BatchError> {
    structure.check(manoeuvres)?;
    let followed: Vec<Followed<N>> =
        manoeuvres.iter().filter_map(|m| Followed::of(m, structure).transpose()).collect::<Result<_, _>>()?;
    let layout: Layout<N> = Layout::new(structure, manoeuvres, stretches(manoeuvres, structure)?).following(followed);
    let simulate = |unknowns: &[f64]| -> Result<Vec<Rows<R>>, BatchError> {
        let run = |(index, m): (usize, &Manoeuvre<'_, N, R>)| {
            response(m, index, &layout, unknowns, structure.maximum_step_s)
                .map_err(|time_s| BatchError::Diverged { manoeuvre: m.name.to_owned(), time_s })
        };
        manoeuvres.iter().enumerate().map(run).collect()
    };
    let noise = structure.outputs.each_ref().map(|channel| channel.noise);
    let floor = noise_floor(manoeuvres);
    let loss = Loss::of(structure.likelihood);
    let minimum = relaxation::fit(&layout.places, layout.start(), &noise, &floor, loss, settings, simulate)
        .map_err(|e| diverged_or_unstable(e, manoeuvres, || simulate(&layout.start())))?;
    let Fitted { rows, noise_std } = &minimum.evaluation.detail;
    let mut fit = summarise(&Summary {
        method: "output-error",
        structure,
        manoeuvres,
        layout: &layout,
        minimum: &minimum,
        rows,
        noise_std,
    })?;
    fit.notes.extend(manoeuvres.iter().zip(rows).filter_map(|(m, r)| unstable_note(m.name, r.growth)));
    Ok(fit)
}

/// The failure of a search, with the instability of the model named where that is why it found no minimum.
pub(super) fn diverged_or_unstable<const N: usize, const R: usize>(
    failure: BatchError,
    manoeuvres: &[Manoeuvre<'_, N, R>],
    start: impl FnOnce() -> Result<Vec<Rows<R>>, BatchError>,
) -> BatchError {
    let unstable = |rows: Vec<Rows<R>>| manoeuvres.iter().zip(rows).find(|(_, r)| r.growth > GROWTH);
    match (&failure, start().ok().and_then(unstable)) {
        (BatchError::NotConverged { .. }, Some((m, r))) => {
            BatchError::Unstable { manoeuvre: m.name.to_owned(), growth: r.growth }
        }
        _ => failure,
    }
}

/// What is said of a manoeuvre whose model is unstable; none if it is not.
pub(super) fn unstable_note(manoeuvre: &str, growth: f64) -> Option<String> {
    (growth > GROWTH).then(|| {
        format!(
            "{manoeuvre}: an error of the initial state grows {growth:.0} times during the manoeuvre: the model is unstable \
             with these parameters, and a free simulation hangs on its start. Filter error or equation error do not"
        )
    })
}

/// A model counts as unstable from this growth of an error of the initial state during the manoeuvre on.
pub(crate) const GROWTH: f64 = 100.0;
