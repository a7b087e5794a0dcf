//! Equation error in the frequency domain: least squares on the equations of motion in a band.

use crate::core::options::{Band, CAPACITY};
use phugoid_estimators::discretization::IntervalInput;
use phugoid_estimators::{LinearizedOutputs, LinearizedRates};

use super::believed;
use super::equation_error::{
    EquationErrorFit, EquationErrorSettings, equation_floor, needed, nothing_integrated, state_of,
};
use super::error::BatchError;
use super::in_band::{self, BandSummary, InBand};
use super::layout::Layout;
use super::loss::Loss;
use super::measured::{Measured, Outliers};
use super::optimise::OptimiserSettings;
use super::problem::{Bias, Manoeuvre, Structure};
use super::regression::equations;
use super::regressor_noise;
use super::response::Rows;
use super::result::UnknownKind;
use super::spectrum::Spectrum;
use super::start::between_gaps;

/// Length of the last step of a regression, in standard errors: where its values are shown, and where only what noise does
/// to them is asked.
const FINE: f64 = 1e-6;
const ROUGH: f64 = 1e-2;
/// Part of a regressor's square in the band below which it has none there: what rounding leaves of a constant.
const NOTHING: f64 = 1e-18;

/// Solves the equations of motion in a band of frequencies by weighted least squares (Klein & Morelli, Aircraft System
/// Identification, chapter 7; Morelli & Grauer, Journal of Aircraft 57, 2020):
///
/// ```text
/// F{ dx_i/dt } - F{ f_i(x, u) }   = F{ Phi_i(x, u) } theta + E_i        a state's equation
/// F{ y_i }     - F{ h_i(x, 0, u) } = F{ D_i(x, u) } theta + E_i         a measured acceleration
/// ```
///
/// with `F` the transform of sampled signals over the band, without constants, trends and what lies below. The rate of a
/// state is the difference of neighbouring samples over their interval, and its right side the mean over the interval of a
/// cubic through the rates about it, with the input that acted: in the band that is `j omega X` with the end-point term,
/// and no window rounds anything off. Regressors are formed from the samples, so that a model may be nonlinear in its
/// states. Each equation has one residual spectral density over the band, found with the parameters.
///
/// A parameter whose regressor has nothing in the band, such as a constant coefficient at constant dynamic pressure, is not
/// estimated: it is not among the unknowns, and a note names it. Biases of sensors are constants too. States have to be
/// measured, outliers are left out, and the bias by noise of the states is taken off, as in
/// [`equation_error()`](super::equation_error()).
///
/// # Errors
/// [`BatchError`]: inputs that contradict each other, a state that is not measured, a band that the record is too short
/// for, terms of which the band determines only a combination.
pub fn equation_error_frequency<const N: usize, const R: usize>(
    manoeuvres: &[Manoeuvre<'_, N, R>],
    structure: &Structure<N, R>,
    band: Band,
    settings: &EquationErrorSettings,
) -> Result<EquationErrorFit, BatchError> {
    let InBandEquations { layout, spectrum, measured, every, constants } =
        InBandEquations::of(manoeuvres, structure, band, settings)?;
    let rows = |measured: &[Measured<N, R>], unknowns: &[f64], wanted: &[bool; R]| {
        rows_of(manoeuvres, measured, &layout, unknowns, wanted, structure.maximum_gap_s)
    };
    let wanted = if settings.every_equation { [true; R] } else { needed(manoeuvres, &every, &layout) };
    let floor = equation_floor(&every);
    let solve = |measured: &[Measured<N, R>], start: Vec<f64>, step_tolerance: f64| {
        let search = OptimiserSettings { step_tolerance, ..OptimiserSettings::default() };
        let residuals = |unknowns: &[f64]| Ok(rows(measured, unknowns, &wanted));
        in_band::fit(&layout.places, start, &spectrum, None, &floor, &search, residuals)
    };
    let (minimum, start) =
        believed::lowest(layout.start(), |start| solve(&measured, start, FINE), |found: &InBand<R>| &found.rows)?;
    let is_state: [bool; R] = std::array::from_fn(|i| state_of::<N, R>(manoeuvres, i).is_some());
    // The equation of a state has no measured left side of its own.
    let left = |m: &Measured<N, R>| -> Vec<[f64; R]> {
        m.outputs.iter().map(|y| std::array::from_fn(|i| if is_state[i] { f64::NAN } else { y[i] })).collect()
    };
    let mut fit = in_band::summarise(&BandSummary {
        method: "equation-error-frequency",
        structure,
        manoeuvres,
        layout: &layout,
        spectrum: &spectrum,
        minimum: &minimum,
        measured: measured.iter().map(left).collect(),
    })?;
    let outputs: Vec<&[[f64; R]]> = measured.iter().map(|m| m.outputs.as_slice()).collect();
    let with_noise = |noisy: &[Vec<[f64; R]>]| {
        let with = |(index, outputs): (usize, &Vec<[f64; R]>)| measured[index].with(&manoeuvres[index], outputs);
        let noisy: Vec<Measured<N, R>> = noisy.iter().enumerate().map(with).collect();
        solve(&noisy, start.clone(), ROUGH).ok().map(|minimum| minimum.unknowns)
    };
    if let Some(bias) = regressor_noise::bias(&outputs, &is_state, &minimum.unknowns, &with_noise) {
        regressor_noise::correct(&mut fit, &bias);
    }
    if !constants.is_empty() {
        fit.notes.push(format!(
            "not identifiable in the band, because what they multiply does not move there: {}. They keep what the model \
             file says of them",
            constants.join(", ")
        ));
    }
    let name = |row: usize| match state_of::<N, R>(manoeuvres, row) {
        Some(state) => format!("d({})/dt", structure.states[state].name),
        None => structure.outputs[row].name.clone(),
    };
    let InBand { rows, noise_std, .. } = &minimum.evaluation.detail;
    let equations = equations(rows, noise_std, &layout.places, &minimum.unknowns, &fit, settings.f_to_enter, name);
    Ok(EquationErrorFit { fit, equations })
}

/// The equations of some manoeuvres in a band, and what is unknown in them.
pub(super) struct InBandEquations<const N: usize, const R: usize> {
    pub(super) layout: Layout<N>,
    spectrum: Spectrum<R>,
    measured: Vec<Measured<N, R>>,
    /// All equations at the start of the search, sample by sample.
    every: Vec<Rows<R>>,
    /// Names of the parameters that have no content in the band, which are no unknowns.
    constants: Vec<String>,
}

impl<const N: usize, const R: usize> InBandEquations<N, R> {
    /// # Errors
    /// Those of [`equation_error_frequency`], but for those of the search.
    pub(super) fn of(
        manoeuvres: &[Manoeuvre<'_, N, R>],
        structure: &Structure<N, R>,
        band: Band,
        settings: &EquationErrorSettings,
    ) -> Result<Self, BatchError> {
        structure.check(manoeuvres)?;
        let band = band.check().map_err(|e| BatchError::BadInput(e.to_string()))?;
        let mut held = structure.clone();
        held.states.iter_mut().for_each(|s| s.free = false);
        held.outputs.iter_mut().for_each(|channel| channel.bias = Bias::None);
        let measured = measured_in(manoeuvres, structure, settings)?;
        let all = |layout: &Layout<N>| {
            rows_of(manoeuvres, &measured, layout, &layout.start(), &[true; R], structure.maximum_gap_s)
        };
        let layout: Layout<N> = Layout::new(&held, manoeuvres, nothing_integrated(manoeuvres));
        let every = all(&layout);
        let spectrum = Spectrum::new(
            band,
            manoeuvres.iter().map(|m| m.time_s),
            &manoeuvres.iter().map(|m| between_gaps(m.time_s, structure.maximum_gap_s)).collect::<Vec<_>>(),
            &every.iter().map(|r| r.residuals.as_slice()).collect::<Vec<_>>(),
        );
        spectrum.check(band)?;
        // What has no content in the band is no unknown of the band.
        let lost = without_content(&every, &spectrum, layout.places.len());
        let mut constants = Vec::new();
        for (place, _) in layout.places.iter().zip(&lost).filter(|(_, lost)| **lost) {
            if let UnknownKind::Parameter { index } = place.kind {
                held.parameters[index].fixed = true;
                constants.push(place.name.clone());
            }
        }
        let layout: Layout<N> = Layout::new(&held, manoeuvres, nothing_integrated(manoeuvres));
        let every = all(&layout);
        Ok(Self { layout, spectrum, measured, every, constants })
    }

    /// Residuals and regressors of all equations in the band, of manoeuvres that are sampled as those of this were.
    ///
    /// # Errors
    /// [`BatchError::BadInput`] where a state is nowhere measured.
    pub(super) fn transformed(
        &self,
        manoeuvres: &[Manoeuvre<'_, N, R>],
        structure: &Structure<N, R>,
        settings: &EquationErrorSettings,
        unknowns: &[f64],
    ) -> Result<Vec<Rows<R>>, BatchError> {
        let measured = measured_in(manoeuvres, structure, settings)?;
        let every = rows_of(manoeuvres, &measured, &self.layout, unknowns, &[true; R], structure.maximum_gap_s);
        Ok(every.iter().enumerate().map(|(index, rows)| self.spectrum.transform(index, rows).band).collect())
    }
}

/// The states and their slopes, without outliers if the likelihood is robust, and nothing smoothed.
fn measured_in<const N: usize, const R: usize>(
    manoeuvres: &[Manoeuvre<'_, N, R>],
    structure: &Structure<N, R>,
    settings: &EquationErrorSettings,
) -> Result<Vec<Measured<N, R>>, BatchError> {
    let outliers = Outliers::of(structure.likelihood);
    let of = |m: &Manoeuvre<'_, N, R>| Measured::of(m, structure, settings.half_window_s, false, outliers);
    manoeuvres.iter().map(of).collect()
}

/// True for each column whose regressors vanish in the band, or everywhere.
fn without_content<const R: usize>(every: &[Rows<R>], spectrum: &Spectrum<R>, unknowns: usize) -> Vec<bool> {
    let (mut all, mut left) = (vec![0.0; unknowns], vec![0.0; unknowns]);
    let add = |sums: &mut [f64], rows: &Rows<R>| {
        for (k, residuals) in rows.residuals.iter().enumerate() {
            for (i, _) in residuals.iter().enumerate().filter(|(_, e)| e.is_finite()) {
                for (&column, s) in rows.columns.iter().zip(rows.sensitivity(k, i)) {
                    sums[column] += s * s;
                }
            }
        }
    };
    for (index, rows) in every.iter().enumerate() {
        add(&mut all, rows);
        add(&mut left, &spectrum.transform(index, rows).band);
    }
    // What moves nowhere at all is named by the information as with the other methods.
    all.iter().zip(left).map(|(all, left)| *all > 0.0 && left <= NOTHING * all).collect()
}

/// The right side of the states' equations as the mean over the interval that ends at each sample.
struct Means<const N: usize> {
    /// By sample; NaN where not known.
    rates: Vec<[f64; N]>,
    /// By sample, then state, then parameter.
    regressors: Vec<[[f64; CAPACITY]; N]>,
}

/// Trapezia with the input that acted within each interval, less a twelfth of the second difference of the rates: the
/// integral of the cubic through the four rates about the interval. The differences are taken within the intervals, so
/// that a step of the input from one to the next is none.
fn means<const N: usize, const R: usize>(
    m: &Manoeuvre<'_, N, R>,
    measured: &Measured<N, R>,
    theta: &[f64; CAPACITY],
    maximum_gap_s: f64,
) -> Means<N> {
    let samples = m.time_s.len();
    let nothing = LinearizedRates::<N, CAPACITY>::ZERO;
    let mut ends = vec![[nothing; 2]; samples];
    let interval = |k: usize| m.time_s[k] - m.time_s[k - 1];
    let known = |k: usize| {
        (1..samples).contains(&k) && measured.is_known(k - 1) && measured.is_known(k) && interval(k) <= maximum_gap_s
    };
    for k in (1..samples).filter(|&k| known(k)) {
        let input = IntervalInput { from: m.instant(k - 1), to: m.instant(k), hold: m.hold };
        let [before, after] = &mut ends[k];
        m.plant.linearized_rates(&measured.states[k - 1], theta, input.at(0.0), before);
        m.plant.linearized_rates(&measured.states[k], theta, input.at(1.0), after);
    }
    let mut means = Means { rates: vec![[f64::NAN; N]; samples], regressors: vec![[[0.0; CAPACITY]; N]; samples] };
    let columns = m.plant.parameter_count().min(CAPACITY);
    for k in (1..samples).filter(|&k| known(k)) {
        let alike = |other: usize| known(other) && (interval(other) / interval(k) - 1.0).abs() < ALIKE;
        let curved = alike(k - 1) && alike(k + 1);
        let mean = |of: &dyn Fn(&LinearizedRates<N, CAPACITY>) -> f64| {
            let change = |k: usize| of(&ends[k][1]) - of(&ends[k][0]);
            let trapezium = 0.5 * (of(&ends[k][0]) + of(&ends[k][1]));
            if curved { trapezium - (change(k + 1) - change(k - 1)) / 24.0 } else { trapezium }
        };
        for i in 0..N {
            means.rates[k][i] = mean(&|end| end.rates[i]);
            for j in 0..columns {
                means.regressors[k][i][j] = mean(&|end| end.regressors[i][j]);
            }
        }
    }
    means
}

/// Intervals that differ by less than this part of their length make one cubic.
const ALIKE: f64 = 0.1;

/// Equations as rows by sample: residual is left side minus right side, sensitivity the regressors.
fn rows_of<const N: usize, const R: usize>(
    manoeuvres: &[Manoeuvre<'_, N, R>],
    measured: &[Measured<N, R>],
    layout: &Layout<N>,
    unknowns: &[f64],
    wanted: &[bool; R],
    maximum_gap_s: f64,
) -> Vec<Rows<R>> {
    let theta = layout.parameters(unknowns);
    let states: [Option<usize>; R] = std::array::from_fn(|i| state_of::<N, R>(manoeuvres, i));
    let of = |(index, (m, measured)): (usize, (&Manoeuvre<'_, N, R>, &Measured<N, R>))| {
        let columns = layout.columns(index);
        let parameters: Vec<Option<usize>> = columns
            .iter()
            .map(|&j| match layout.places[j].kind {
                UnknownKind::Parameter { index } => Some(index),
                _ => None,
            })
            .collect();
        let (samples, width) = (m.time_s.len(), columns.len());
        let means = (0..R).any(|i| wanted[i] && states[i].is_some()).then(|| means(m, measured, &theta, maximum_gap_s));
        let mut rows = Rows {
            outputs: vec![[f64::NAN; R]; samples],
            residuals: vec![[f64::NAN; R]; samples],
            sensitivities: vec![0.0; samples * R * width],
            columns,
            loss: Loss::GAUSSIAN,
            growth: 1.0,
        };
        let mut lin = LinearizedOutputs::<N, R, CAPACITY>::ZERO;
        for k in (0..samples).filter(|&k| measured.is_known(k)) {
            m.plant.linearized_outputs(&measured.states[k], &theta, m.instant(k), &mut lin);
            rows.outputs[k] = lin.outputs;
            for i in (0..R).filter(|&i| wanted[i]) {
                let (residual, regressors) = match (states[i], &means) {
                    (None, _) => (measured.outputs[k][i] - lin.outputs[i], &lin.parameter_jacobian[i]),
                    (Some(state), Some(means)) if k > 0 => {
                        let rate = (measured.states[k][state] - measured.states[k - 1][state])
                            / (m.time_s[k] - m.time_s[k - 1]);
                        (rate - means.rates[k][state], &means.regressors[k][state])
                    }
                    (Some(_), _) => continue,
                };
                if !residual.is_finite() {
                    continue;
                }
                rows.residuals[k][i] = residual;
                let row = &mut rows.sensitivities[(k * R + i) * width..][..width];
                for (value, parameter) in row.iter_mut().zip(&parameters) {
                    *value = parameter.map_or(0.0, |j| regressors[j]);
                }
            }
        }
        rows
    };
    manoeuvres.iter().zip(measured).enumerate().map(of).collect()
}
