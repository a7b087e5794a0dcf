//! Equation error: least squares on the equations of motion themselves.

use crate::core::options::CAPACITY;
use phugoid_estimators::discretization::IntervalInput;
use phugoid_estimators::{LinearizedOutputs, LinearizedRates};

use super::believed;
use super::differentiate::{LocalCubics, half_window_s};
use super::error::BatchError;
use super::layout::Layout;
use super::loss::Loss;
use super::measured::{Measured, Outliers};
use super::optimise::{Minimum, OptimiserSettings};
use super::problem::{Bias, Manoeuvre, Noise, Structure};
use super::regression::{Equation, equations};
use super::regressor_noise;
use super::relaxation::{self, Fitted};
use super::response::Rows;
use super::result::{BatchFit, UnknownKind};
use super::start::Stretch;
use super::summary::{Summary, summarise};

/// Settings of [`equation_error`]: the differentiation of the measured states, and which equations and terms are used.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EquationErrorSettings {
    /// Samples this far to each side make one value of a state and its slope, s. It should be short against the motion
    /// (a tenth of the short period) and hold at least three samples.
    pub half_window_s: f64,
    /// Smooth both sides of the equations alike; otherwise measured accelerations and the states in the regressors are
    /// taken as they are, which is right for noise-free data only: noise in a regressor biases its derivative towards
    /// zero.
    pub smooth_regressors: bool,
    /// Use every equation that has a measured left side. Otherwise a state's rate is differentiated only where a
    /// parameter needs it: a measured acceleration is better than a numerical one.
    pub every_equation: bool,
    /// Partial F from which a term counts as needed. 4 is the 95 % point for white residuals; 20 allows for their
    /// colour.
    pub f_to_enter: f64,
}

impl EquationErrorSettings {
    /// For samples `sample_time_s` apart: windows of 0.2 s, at least three samples, to each side.
    pub fn automatic(sample_time_s: f64) -> Self {
        let half_window_s = half_window_s(sample_time_s);
        Self { half_window_s, smooth_regressors: true, every_equation: false, f_to_enter: 20.0 }
    }
}

/// The result of [`equation_error`]: the estimates, and how much each term of each equation explains.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct EquationErrorFit {
    /// Estimates with their covariance. The fitted outputs are the smoothed states and, from them, the other outputs;
    /// the residuals are those of the equations, in the place of the output that measures the state or the
    /// acceleration.
    pub fit: BatchFit,
    /// The equations, by groups that share parameters.
    pub equations: Vec<Equation>,
}

/// Solves the equations of motion for the parameters by weighted least squares, with measured states and differentiated
/// or measured rates (Klein & Morelli, Aircraft System Identification, chapter 5):
///
/// ```text
/// d/dt x_i (measured, smoothed) - f_i(x, u) = Phi_i(x, u) theta + e_i        a state's equation
/// y_i - h_i(x, 0, u)                        = D_i(x, u) theta + e_i          a measured acceleration
/// ```
///
/// Smoothing and differentiation round corners. The right side of a state's equation is therefore integrated and
/// differentiated in the same way, and both sides of a measured acceleration are smoothed in the same way, so that they
/// agree whatever the window, and however quick the aircraft. Samples of a state or acceleration that stand out of their
/// neighbours by eight sigmas of its noise are left out, unless the likelihood is Gaussian. Each equation has its own residual variance, found with the
/// parameters. States that no output measures, and equations whose left side is nowhere measured, are refused or left
/// out. Nothing is integrated and no start values are needed, so that it cannot diverge; its result can start the other
/// methods. Noise in the states biases it: with smoothed regressors the bias is found by adding more noise of the same
/// level, taken off, and the standard errors allow for what is uncertain of it (docs/methods.md, measured).
///
/// # Errors
/// [`BatchError`]: inputs that contradict each other, a state that is not measured, terms of which the data determine
/// only a combination.
pub fn equation_error<const N: usize, const R: usize>(
    manoeuvres: &[Manoeuvre<'_, N, R>],
    structure: &Structure<N, R>,
    settings: &EquationErrorSettings,
) -> Result<EquationErrorFit, BatchError> {
    let (layout, measured) = smoothed(manoeuvres, structure, settings)?;
    let (minimum, start) = believed::lowest(
        layout.start(),
        |start| regression(manoeuvres, &measured, settings, &layout, start, FINE),
        |fitted: &Fitted<R>| &fitted.rows,
    )?;
    let Fitted { rows, noise_std } = &minimum.evaluation.detail;
    let mut fit = summarise(&Summary {
        method: "equation-error",
        structure,
        manoeuvres,
        layout: &layout,
        minimum: &minimum,
        rows,
        noise_std,
    })?;
    if settings.smooth_regressors {
        let outputs: Vec<&[[f64; R]]> = measured.iter().map(|m| m.outputs.as_slice()).collect();
        let of_state = std::array::from_fn(|i| state_of::<N, R>(manoeuvres, i).is_some());
        let solve = |noisy: &[Vec<[f64; R]>]| {
            let with = |(index, outputs): (usize, &Vec<[f64; R]>)| measured[index].with(&manoeuvres[index], outputs);
            let noisy: Vec<Measured<N, R>> = noisy.iter().enumerate().map(with).collect();
            // Their difference is a fraction of a standard error or more, or of no interest.
            regression(manoeuvres, &noisy, settings, &layout, start.clone(), ROUGH).ok().map(|minimum| minimum.unknowns)
        };
        if let Some(bias) = regressor_noise::bias(&outputs, &of_state, &minimum.unknowns, &solve) {
            regressor_noise::correct(&mut fit, &bias);
        }
    }
    let name = |row: usize| match state_of::<N, R>(manoeuvres, row) {
        Some(state) => format!("d({})/dt", structure.states[state].name),
        None => structure.outputs[row].name.clone(),
    };
    let equations = equations(rows, noise_std, &layout.places, &minimum.unknowns, &fit, settings.f_to_enter, name);
    Ok(EquationErrorFit { fit, equations })
}

/// Residuals and regressors of all equations of each manoeuvre at given unknowns, and what these are.
///
/// # Errors
/// Those of [`equation_error`].
pub(super) fn rows_at<const N: usize, const R: usize>(
    manoeuvres: &[Manoeuvre<'_, N, R>],
    structure: &Structure<N, R>,
    settings: &EquationErrorSettings,
    unknowns: &[f64],
) -> Result<(Layout<N>, Vec<Rows<R>>), BatchError> {
    let (layout, measured) = smoothed(manoeuvres, structure, settings)?;
    let rows = rows_of(manoeuvres, &measured, &layout, unknowns, &[true; R]);
    Ok((layout, rows))
}

/// The same of the equations that the regression uses; NaN in the others.
///
/// # Errors
/// Those of [`equation_error`].
pub(super) fn needed_rows_at<const N: usize, const R: usize>(
    manoeuvres: &[Manoeuvre<'_, N, R>],
    structure: &Structure<N, R>,
    settings: &EquationErrorSettings,
    unknowns: &[f64],
) -> Result<(Layout<N>, Vec<Rows<R>>), BatchError> {
    let (layout, mut rows) = rows_at(manoeuvres, structure, settings, unknowns)?;
    let wanted = if settings.every_equation { [true; R] } else { needed(manoeuvres, &rows, &layout) };
    for residual in rows.iter_mut().flat_map(|rows| &mut rows.residuals) {
        (0..R).filter(|&i| !wanted[i]).for_each(|i| residual[i] = f64::NAN);
    }
    Ok((layout, rows))
}

/// The unknowns of the regression, and the smoothed states and outputs of each manoeuvre.
fn smoothed<const N: usize, const R: usize>(
    manoeuvres: &[Manoeuvre<'_, N, R>],
    structure: &Structure<N, R>,
    settings: &EquationErrorSettings,
) -> Result<(Layout<N>, Vec<Measured<N, R>>), BatchError> {
    structure.check(manoeuvres)?;
    let half = settings.half_window_s;
    if half.is_nan() || half <= 0.0 {
        return Err(BatchError::BadInput(format!("the half window is {half} s: it must be positive")));
    }
    let mut held = structure.clone();
    held.states.iter_mut().for_each(|s| s.free = false);
    for (i, channel) in held.outputs.iter_mut().enumerate() {
        // A constant error of a measured state does not appear in the equation of its rate.
        if state_of::<N, R>(manoeuvres, i).is_some() {
            channel.bias = Bias::None;
        }
    }
    let layout: Layout<N> = Layout::new(&held, manoeuvres, nothing_integrated(manoeuvres));
    let outliers = Outliers::of(structure.likelihood);
    let of = |m: &Manoeuvre<'_, N, R>| Measured::of(m, structure, half, settings.smooth_regressors, outliers);
    let measured = manoeuvres.iter().map(of).collect::<Result<Vec<_>, _>>()?;
    Ok((layout, measured))
}

/// Length of the last step of a regression, in standard errors: where its values are shown, and where only what noise does
/// to them is asked.
const FINE: f64 = 1e-6;
const ROUGH: f64 = 1e-2;

/// The weighted least squares themselves, from these values of the unknowns.
fn regression<const N: usize, const R: usize>(
    manoeuvres: &[Manoeuvre<'_, N, R>],
    measured: &[Measured<N, R>],
    settings: &EquationErrorSettings,
    layout: &Layout<N>,
    start: Vec<f64>,
    step_tolerance: f64,
) -> Result<Minimum<Fitted<R>>, BatchError> {
    let every: Vec<Rows<R>> = rows_of(manoeuvres, measured, layout, &layout.start(), &[true; R]);
    let wanted = if settings.every_equation { [true; R] } else { needed(manoeuvres, &every, layout) };
    let residuals = |unknowns: &[f64]| Ok(rows_of(manoeuvres, measured, layout, unknowns, &wanted));
    let floor = equation_floor(&every);
    // The equations are linear in the parameters: only the weights have to be iterated.
    let search = OptimiserSettings { step_tolerance, ..OptimiserSettings::default() };
    let noise = [Noise::Estimated; R];
    // What is left of an equation is what its terms lack, in the manoeuvres, and no outliers: to count it less there would
    // hide it.
    relaxation::fit(&layout.places, start, &noise, &floor, Loss::GAUSSIAN, &search, residuals)
}

/// The equations of one manoeuvre at given parameters, without solving them: residuals (left side minus right side, in
/// the place of the output that measures the state or the acceleration) and regressors (sensitivities, one column per
/// parameter in the order of the model). NaN where a window has no value.
///
/// # Errors
/// [`BatchError::BadInput`] where a state is not measured.
pub(crate) fn equations_at<const N: usize, const R: usize>(
    manoeuvre: &Manoeuvre<'_, N, R>,
    structure: &Structure<N, R>,
    settings: &EquationErrorSettings,
    parameters: &[f64],
) -> Result<Rows<R>, BatchError> {
    let held = structure.held_at(parameters);
    let manoeuvres = std::slice::from_ref(manoeuvre);
    let (half, smooth) = (settings.half_window_s, settings.smooth_regressors);
    let measured = [Measured::of(manoeuvre, &held, half, smooth, Outliers::LeftOut)?];
    let layout: Layout<N> = Layout::new(&held, manoeuvres, nothing_integrated(manoeuvres));
    let rows = rows_of(manoeuvres, &measured, &layout, &layout.start(), &[true; R]);
    rows.into_iter().next().ok_or_else(|| BatchError::BadInput("there is no manoeuvre".to_owned()))
}

/// The equations take the states as they were measured, and have no use for where an integration would start.
pub(super) fn nothing_integrated<const N: usize, const R: usize>(
    manoeuvres: &[Manoeuvre<'_, N, R>],
) -> Vec<Vec<Stretch<N>>> {
    let stretch = |m: &Manoeuvre<'_, N, R>| Stretch { from: 0, to: m.time_s.len(), state: [0.0; N] };
    manoeuvres.iter().map(|m| vec![stretch(m)]).collect()
}

/// The right side of the states' equations as the differentiation sees it.
struct RightSide<const N: usize> {
    /// By sample, 1/s of the state's unit; NaN where not known.
    rates: Vec<[f64; N]>,
    /// By state, then column, then sample; empty where a column is zero throughout.
    regressors: [Vec<Vec<f64>>; N],
}

/// Integrates the right side over the samples (trapezia, with the input that acted in each interval) and takes the
/// slope of that as it was taken of the measured state. Both sides have then been through the same window: what it
/// rounds off, such as the step in a rate that a step of a surface makes, it rounds off on both.
fn right_side<const N: usize, const R: usize>(
    m: &Manoeuvre<'_, N, R>,
    measured: &Measured<N, R>,
    theta: &[f64; CAPACITY],
    wanted: &[bool; N],
) -> RightSide<N> {
    let samples = m.time_s.len();
    let columns = m.plant.parameter_count().min(CAPACITY);
    let known = |k: usize| measured.is_known(k);
    let mut rates = vec![vec![0.0; samples]; N];
    let mut regressors = vec![vec![vec![0.0; samples]; columns]; N];
    let (mut before, mut after) = (LinearizedRates::<N, CAPACITY>::ZERO, LinearizedRates::<N, CAPACITY>::ZERO);
    for k in 1..samples {
        let whole = known(k - 1) && known(k);
        let h = m.time_s[k] - m.time_s[k - 1];
        if whole {
            let input = IntervalInput { from: m.instant(k - 1), to: m.instant(k), hold: m.hold };
            m.plant.linearized_rates(&measured.states[k - 1], theta, input.at(0.0), &mut before);
            m.plant.linearized_rates(&measured.states[k], theta, input.at(1.0), &mut after);
        }
        for i in 0..N {
            // An interval without states makes the windows that contain it useless.
            let part = |a: f64, b: f64| if whole { 0.5 * h * (a + b) } else { 0.0 };
            rates[i][k] = rates[i][k - 1] + part(before.rates[i], after.rates[i]);
            for j in 0..columns {
                regressors[i][j][k] = regressors[i][j][k - 1] + part(before.regressors[i][j], after.regressors[i][j]);
            }
        }
    }
    let mut side = RightSide {
        rates: vec![[f64::NAN; N]; samples],
        regressors: std::array::from_fn(|_| vec![Vec::new(); columns]),
    };
    for i in (0..N).filter(|&i| wanted[i]) {
        for (k, slope) in measured.cubics[i].slopes(&rates[i]).into_iter().enumerate() {
            side.rates[k][i] = slope;
        }
        for (slopes, integral) in side.regressors[i].iter_mut().zip(&regressors[i]) {
            if integral.iter().any(|v| *v != 0.0) {
                *slopes = measured.cubics[i].slopes(integral);
            }
        }
    }
    // True from the first to the last sample of each window that is whole.
    let reach = measured.cubics.iter().map(LocalCubics::reach).max().unwrap_or(0);
    let mut lost = vec![0_usize; samples + 1];
    for k in 0..samples {
        lost[k + 1] = lost[k] + usize::from(!known(k));
    }
    for k in 0..samples {
        let (from, to) = (k.saturating_sub(reach), (k + reach + 1).min(samples));
        if lost[to] > lost[from] {
            side.rates[k] = [f64::NAN; N];
        }
    }
    side
}

/// The state whose equation stands in the place of this output, if the output measures a state.
pub(super) fn state_of<const N: usize, const R: usize>(
    manoeuvres: &[Manoeuvre<'_, N, R>],
    output: usize,
) -> Option<usize> {
    (0..N).find(|&state| manoeuvres[0].plant.measuring_output(state) == Some(output))
}

/// Equations as rows: residual is left side minus right side, sensitivity the regressors.
pub(super) fn rows_of<const N: usize, const R: usize>(
    manoeuvres: &[Manoeuvre<'_, N, R>],
    measured: &[Measured<N, R>],
    layout: &Layout<N>,
    unknowns: &[f64],
    wanted: &[bool; R],
) -> Vec<Rows<R>> {
    let theta = layout.parameters(unknowns);
    let of = |(index, (m, measured)): (usize, (&Manoeuvre<'_, N, R>, &Measured<N, R>))| {
        let columns = layout.columns(index);
        let kinds: Vec<UnknownKind> = columns.iter().map(|&j| layout.places[j].kind).collect();
        let biases: [f64; R] = layout.biases(index, unknowns);
        let states: [Option<usize>; R] = std::array::from_fn(|i| state_of::<N, R>(manoeuvres, i));
        let wanted_states = std::array::from_fn(|state| (0..R).any(|i| wanted[i] && states[i] == Some(state)));
        let side = right_side(m, measured, &theta, &wanted_states);
        let samples = m.time_s.len();
        let width = columns.len();
        let mut rows = Rows {
            outputs: vec![[f64::NAN; R]; samples],
            residuals: vec![[f64::NAN; R]; samples],
            sensitivities: vec![0.0; samples * R * width],
            columns,
            loss: Loss::GAUSSIAN,
            growth: 1.0,
        };
        let mut lin = LinearizedOutputs::<N, R, CAPACITY>::ZERO;
        for k in (0..samples).filter(|&k| measured.smoothed[k].iter().all(|v| v.is_finite())) {
            m.plant.linearized_outputs(&measured.smoothed[k], &theta, m.instant(k), &mut lin);
            rows.outputs[k] = std::array::from_fn(|i| lin.outputs[i] + biases[i]);
        }
        let accelerations = accelerations(m, measured, &theta, &kinds);
        for i in (0..R).filter(|&i| wanted[i]) {
            for k in 0..samples {
                let from = (k * R + i) * width;
                let row = &mut rows.sensitivities[from..from + width];
                match states[i] {
                    Some(state) => {
                        let residual = measured.slopes[k][state] - side.rates[k][state];
                        if !(residual.is_finite() && rows.outputs[k][i].is_finite()) {
                            continue;
                        }
                        rows.residuals[k][i] = residual;
                        for (value, kind) in row.iter_mut().zip(&kinds) {
                            if let UnknownKind::Parameter { index } = *kind {
                                *value =
                                    side.regressors[state].get(index).and_then(|of| of.get(k)).copied().unwrap_or(0.0);
                            }
                        }
                    }
                    None => {
                        let residual = accelerations[i].residuals[k] - biases[i];
                        if !residual.is_finite() {
                            continue;
                        }
                        rows.residuals[k][i] = residual;
                        for ((value, kind), regressor) in row.iter_mut().zip(&kinds).zip(&accelerations[i].regressors) {
                            *value = match *kind {
                                UnknownKind::Bias { output, .. } => f64::from(output == i),
                                _ => regressor.get(k).copied().unwrap_or(0.0),
                            };
                        }
                    }
                }
            }
        }
        rows
    };
    manoeuvres.iter().zip(measured).enumerate().map(of).collect()
}

/// Both sides of the equation of one output that measures no state.
#[derive(Clone, Debug, Default)]
struct Acceleration {
    /// Measured minus modelled without the bias, by sample; NaN where not known.
    residuals: Vec<f64>,
    /// By column of the rows, then by sample; empty for a column that is no parameter.
    regressors: Vec<Vec<f64>>,
}

/// The equations of the outputs, both sides smoothed alike where the windows are there.
fn accelerations<const N: usize, const R: usize>(
    m: &Manoeuvre<'_, N, R>,
    measured: &Measured<N, R>,
    theta: &[f64; CAPACITY],
    kinds: &[UnknownKind],
) -> [Acceleration; R] {
    let samples = m.time_s.len();
    let empty = Acceleration {
        residuals: vec![f64::NAN; samples],
        regressors: kinds
            .iter()
            .map(|kind| if matches!(kind, UnknownKind::Parameter { .. }) { vec![0.0; samples] } else { Vec::new() })
            .collect(),
    };
    let mut found: [Acceleration; R] = std::array::from_fn(|_| empty.clone());
    let mut lin = LinearizedOutputs::<N, R, CAPACITY>::ZERO;
    for k in (0..samples).filter(|&k| measured.is_known(k)) {
        m.plant.linearized_outputs(&measured.states[k], theta, m.instant(k), &mut lin);
        for (i, equation) in found.iter_mut().enumerate() {
            equation.residuals[k] = measured.outputs[k][i] - lin.outputs[i];
            for (column, kind) in equation.regressors.iter_mut().zip(kinds) {
                if let UnknownKind::Parameter { index } = *kind {
                    column[k] = lin.parameter_jacobian[i][index];
                }
            }
        }
    }
    // The output of a state has no window, and its own equation elsewhere.
    for (equation, cubics) in found.iter_mut().zip(&measured.output_cubics) {
        let Some(cubics) = cubics else { continue };
        equation.residuals = cubics.values(&equation.residuals);
        for column in equation.regressors.iter_mut().filter(|column| !column.is_empty()) {
            *column = cubics.values(column);
        }
    }
    found
}

/// The equations to use: measured accelerations, and the rates of states that carry a parameter which no acceleration
/// sees.
pub(super) fn needed<const N: usize, const R: usize>(
    manoeuvres: &[Manoeuvre<'_, N, R>],
    every: &[Rows<R>],
    layout: &Layout<N>,
) -> [bool; R] {
    let moves = |output: usize, column: usize| {
        every.iter().any(|rows| {
            rows.columns
                .iter()
                .position(|&j| j == column)
                .is_some_and(|position| (0..rows.residuals.len()).any(|k| rows.sensitivity(k, output)[position] != 0.0))
        })
    };
    let acceleration = |i: usize| state_of::<N, R>(manoeuvres, i).is_none();
    let seen: Vec<bool> = (0..layout.places.len()).map(|j| (0..R).any(|i| acceleration(i) && moves(i, j))).collect();
    std::array::from_fn(|i| acceleration(i) || (0..seen.len()).any(|j| !seen[j] && moves(i, j)))
}

/// Smallest standard deviation of the residuals that is accepted for each equation: below it rounding decides.
pub(super) fn equation_floor<const R: usize>(every: &[Rows<R>]) -> [f64; R] {
    std::array::from_fn(|i| {
        let largest = every.iter().flat_map(|r| r.residuals.iter().map(move |e| e[i].abs())).fold(0.0, f64::max);
        if largest > 0.0 { 1e-9 * largest } else { f64::MIN_POSITIVE.sqrt() }
    })
}
