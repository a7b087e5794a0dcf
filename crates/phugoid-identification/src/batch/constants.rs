//! How far an error of a constant moves the result of a batch method.
//!
//! A flight with a constant that is off by `c` shows `h(theta, c)`, and the method fits `h(theta, 0)` to it. With the
//! residuals `e(c)` of the flight against a model in which the constant is as it was in flight, the true parameters lie away
//! from the found ones by
//!
//! ```text
//! T c = sum of the steps M^-1 S^T W e(c)          output error: information M, sensitivities S, weights W of the residuals e(c)
//! T c = sum of the steps M^-1 S^T W [e(c) - e]    filter error: the same of its innovations, M and S as they were found
//! T c = M(c)^-1 [ S(c)^T W e(c) - S^T W e ]       equation error, with c taken out of the measured states
//! ```
//!
//! with the constant off by one sigma, in the time domain and in a band of frequencies alike. Filter error keeps the levels that it has found: they hold what wrong constants of the
//! flight leave in its innovations. Output error goes on from its minimum with levels of the noise that are found anew: in a
//! long simulation a constant makes an output drift by many times its noise, which then counts for less. A first derivative
//! with the weights of the minimum claimed twenty times the value of a parameter on four of twenty foreign flights. Nothing of it changes the estimate. The causal filters have the same by a recursion
//! (`phugoid_estimators::supervisor::considered`).

use nalgebra::{DMatrix, DVector};
use phugoid_estimators::{ConstantEffects, LinearizedOutputs, LinearizedRates, RegressorShift};

use super::equation_error::{EquationErrorSettings, rows_at};
use super::equation_error_frequency::InBandEquations;
use super::filter_error::without_strays;
use super::filters::{Filters, step_of};
use super::flown::{Flown, Instant};
use super::followed::Followed;
use super::in_band;
use super::information::solve;
use super::layout::Layout;
use super::likelihood::Evaluation;
use super::loss::Loss;
use super::output_error_frequency::BandSimulation;
use super::problem::{Manoeuvre, Noise, ProcessNoise, Structure, with_outputs};
use super::relaxation::{levels, noise_floor};
use super::response::{Rows, response};
use super::result::{BatchFit, Unknown, UnknownKind};
use super::start::stretches;
use crate::core::options::{Band, CAPACITY};
use crate::core::systematic::ROOM_FOR_CONSTANTS;
use crate::motion::of_constant;

/// Errors of one parameter per unit of each constant, the true value less the found one.
pub(crate) type ByConstant = [f64; ROOM_FOR_CONSTANTS];

/// Most steps of output error and filter error with one constant, and the length of the last one over that of the first.
const MOST_STEPS: usize = 5;
const STEP_TOLERANCE: f64 = 0.05;
/// A step counts only where it is shorter than the one before by this factor: else the steps lead nowhere.
const LEAST_GAIN: f64 = 0.7;

/// A plant in which one constant is off: rates and outputs are those of [`Flown::constant_effects`] times its size more.
struct Displaced<'a, const N: usize, const R: usize> {
    plant: &'a dyn Flown<N, R>,
    constant: usize,
    size: f64,
    /// The outputs that measure a state show it without the constant.
    states_are_clear: bool,
}

impl<const N: usize, const R: usize> Displaced<'_, N, R> {
    fn effects(&self, x: &[f64; N], theta: &[f64; CAPACITY], at: Instant) -> ([f64; N], [f64; R]) {
        let mut effects = ConstantEffects::<N, R, ROOM_FOR_CONSTANTS>::ZERO;
        self.plant.constant_effects(x, theta, at, &mut effects);
        of_constant(&effects, self.constant, self.size)
    }
}

impl<const N: usize, const R: usize> Flown<N, R> for Displaced<'_, N, R> {
    fn samples(&self) -> usize {
        self.plant.samples()
    }

    fn parameter_count(&self) -> usize {
        self.plant.parameter_count()
    }

    fn measuring_output(&self, state: usize) -> Option<usize> {
        self.plant.measuring_output(state)
    }

    fn unmeasured_start(&self, state: usize) -> Option<f64> {
        self.plant.unmeasured_start(state)
    }

    fn linearized_rates(
        &self,
        x: &[f64; N],
        theta: &[f64; CAPACITY],
        at: Instant,
        out: &mut LinearizedRates<N, CAPACITY>,
    ) {
        self.plant.linearized_rates(x, theta, at, out);
        let (more, _) = self.effects(x, theta, at);
        out.rates.iter_mut().zip(more).for_each(|(rate, more)| *rate += more);
    }

    fn linearized_outputs(
        &self,
        x: &[f64; N],
        theta: &[f64; CAPACITY],
        at: Instant,
        out: &mut LinearizedOutputs<N, R, CAPACITY>,
    ) {
        self.plant.linearized_outputs(x, theta, at, out);
        let (_, mut more) = self.effects(x, theta, at);
        if self.states_are_clear {
            (0..N).filter_map(|state| self.plant.measuring_output(state)).for_each(|output| more[output] = 0.0);
        }
        out.outputs.iter_mut().zip(more).for_each(|(output, more)| *output += more);
    }

    fn constant_effects(
        &self,
        x: &[f64; N],
        theta: &[f64; CAPACITY],
        at: Instant,
        out: &mut ConstantEffects<N, R, ROOM_FOR_CONSTANTS>,
    ) {
        self.plant.constant_effects(x, theta, at, out);
    }

    fn regressor_shifts(&self, parameter: usize) -> &[RegressorShift] {
        self.plant.regressor_shifts(parameter)
    }
}

/// The plants of some manoeuvres with one constant off.
fn plants_of<'a, const N: usize, const R: usize>(
    manoeuvres: &[Manoeuvre<'a, N, R>],
    constant: usize,
    size: f64,
    states_are_clear: bool,
) -> Vec<Displaced<'a, N, R>> {
    manoeuvres.iter().map(|m| Displaced { plant: m.plant, constant, size, states_are_clear }).collect()
}

/// The manoeuvres flown by other plants.
fn displaced<'a, const N: usize, const R: usize>(
    manoeuvres: &[Manoeuvre<'a, N, R>],
    plants: &'a [Displaced<'a, N, R>],
) -> Vec<Manoeuvre<'a, N, R>> {
    manoeuvres.iter().zip(plants).map(|(m, plant)| Manoeuvre { plant, ..*m }).collect()
}

/// Where a search ended.
struct End {
    unknowns: Vec<f64>,
    /// Those that rest on a bound.
    frozen: Vec<bool>,
}

impl End {
    /// Of a fit; none where its unknowns, variances left out, are not those of the layout.
    fn of<const N: usize>(fit: &BatchFit, layout: &Layout<N>) -> Option<Self> {
        let of_fit: Vec<&Unknown> = fit.unknowns.iter().filter(|u| !u.kind.is_variance()).collect();
        let same = of_fit.iter().map(|u| u.kind).eq(layout.places.iter().map(|p| p.kind));
        same.then(|| Self {
            unknowns: of_fit.iter().map(|u| u.value).collect(),
            frozen: of_fit.iter().map(|u| u.at_limit).collect(),
        })
    }
}

/// Writes how far each parameter has moved per unit of a constant.
fn note<const N: usize>(
    by_parameter: &mut [ByConstant],
    layout: &Layout<N>,
    constant: usize,
    moved: impl Iterator<Item = f64>,
) {
    for (place, moved) in layout.places.iter().zip(moved) {
        if let UnknownKind::Parameter { index } = place.kind {
            by_parameter[index][constant] = moved;
        }
    }
}

/// What [`output_error()`](super::output_error()) makes of errors of the constants: one entry per parameter of the
/// structure. `sizes`: how far each constant is displaced to find out, one sigma; zero for one of which
/// nothing is asked. None where the result does not belong to the structure, or a step cannot be solved for.
pub(crate) fn output_error_constants<const N: usize, const R: usize>(
    manoeuvres: &[Manoeuvre<'_, N, R>],
    structure: &Structure<N, R>,
    fit: &BatchFit,
    sizes: &ByConstant,
) -> Option<Vec<ByConstant>> {
    let followed: Vec<Followed<N>> =
        manoeuvres.iter().filter_map(|m| Followed::of(m, structure).transpose()).collect::<Result<_, _>>().ok()?;
    let layout: Layout<N> =
        Layout::new(structure, manoeuvres, stretches(manoeuvres, structure).ok()?).following(followed);
    let end = End::of(fit, &layout)?;
    let noise = structure.outputs.each_ref().map(|channel| channel.noise);
    let floor = noise_floor(manoeuvres);
    let loss = Loss::of(structure.likelihood);
    by_steps(manoeuvres, structure, (&layout, &end), sizes, |with, moved| {
        let rows = simulated(with, &layout, moved, structure.maximum_step_s)?;
        let (noise_std, _) = levels(&noise, &rows, &floor, loss);
        let mut there = Evaluation::of_priors(&layout.places, moved);
        rows.into_iter().for_each(|rows| there.add(&rows.whitened(&noise_std, loss)));
        Some((there.information, there.descent))
    })
}

/// What a search makes of errors of the constants that goes on from its minimum. `at`: information and descent of manoeuvres with a
/// constant off, at some unknowns; none where they cannot be worked out.
fn by_steps<const N: usize, const R: usize>(
    manoeuvres: &[Manoeuvre<'_, N, R>],
    structure: &Structure<N, R>,
    (layout, end): (&Layout<N>, &End),
    sizes: &ByConstant,
    at: impl Fn(&[Manoeuvre<'_, N, R>], &[f64]) -> Option<(DMatrix<f64>, DVector<f64>)>,
) -> Option<Vec<ByConstant>> {
    let mut by_parameter = vec![[0.0; ROOM_FOR_CONSTANTS]; structure.parameters.len()];
    for (constant, size) in sizes.iter().copied().enumerate().filter(|(_, size)| *size > 0.0) {
        let plants = plants_of(manoeuvres, constant, size, false);
        let with = displaced(manoeuvres, &plants);
        let begin = begun(manoeuvres, layout, end, (constant, size))?;
        let moved = stepped(begin, &end.frozen, |moved| at(&with, moved))?;
        let by_unit = moved.iter().zip(&end.unknowns).map(|(moved, unknown)| (moved - unknown) / size);
        note(&mut by_parameter, layout, constant, by_unit);
    }
    Some(by_parameter)
}

/// Free simulations of some manoeuvres; none where one diverges.
fn simulated<const N: usize, const R: usize>(
    manoeuvres: &[Manoeuvre<'_, N, R>],
    layout: &Layout<N>,
    unknowns: &[f64],
    maximum_step_s: f64,
) -> Option<Vec<Rows<R>>> {
    let run = |(index, m)| response(m, index, layout, unknowns, maximum_step_s).ok();
    manoeuvres.iter().enumerate().map(run).collect()
}

/// The unknowns where the terms say that they lie with a constant off by a size: a zero of the vane of many times its noise would
/// lead steps from elsewhere astray. None where there is no manoeuvre.
fn begun<const N: usize, const R: usize>(
    manoeuvres: &[Manoeuvre<'_, N, R>],
    layout: &Layout<N>,
    end: &End,
    (constant, size): (usize, f64),
) -> Option<Vec<f64>> {
    let (plant, theta) = (manoeuvres.first()?.plant, layout.parameters(&end.unknowns));
    let mut begin = end.unknowns.clone();
    for (column, value) in theta.iter().enumerate().take(plant.parameter_count()) {
        for shift in plant.regressor_shifts(column).iter().filter(|shift| shift.constant == constant) {
            let target = layout.places.iter().position(|p| p.kind == UnknownKind::Parameter { index: shift.of });
            if let Some(place) = target.filter(|place| !end.frozen[*place]) {
                begin[place] += size * shift.per_unit * value;
            }
        }
    }
    Some(begin)
}

/// Where Gauss-Newton steps lead, as long as each is clearly shorter than the one before. `at`: the information and the descent
/// there; none where they cannot be worked out.
fn stepped(
    begin: Vec<f64>,
    frozen: &[bool],
    at: impl Fn(&[f64]) -> Option<(DMatrix<f64>, DVector<f64>)>,
) -> Option<Vec<f64>> {
    let mut moved = begin;
    let (mut first, mut before) = (f64::INFINITY, f64::INFINITY);
    for _ in 0..MOST_STEPS {
        let (information, descent) = at(&moved)?;
        let step = solve(&information, &descent, 0.0, frozen)?;
        let length = step.dot(&(&information * &step)).sqrt();
        // Steps that grow lead nowhere: what was found so far is nearer than what they would give.
        if length.is_nan() || length > LEAST_GAIN * before {
            break;
        }
        moved.iter_mut().zip(step.iter()).for_each(|(unknown, step)| *unknown += step);
        if first.is_infinite() {
            first = length;
        }
        if length <= STEP_TOLERANCE * first {
            break;
        }
        before = length;
    }
    Some(moved)
}

/// What [`filter_error()`](super::filter_error()) makes of errors of the constants, as [`output_error_constants`].
pub(crate) fn filter_error_constants<const N: usize, const R: usize>(
    manoeuvres: &[Manoeuvre<'_, N, R>],
    structure: &Structure<N, R>,
    fit: &BatchFit,
    sizes: &ByConstant,
) -> Option<Vec<ByConstant>> {
    let mut levelled = structure.clone();
    for (channel, std) in levelled.outputs.iter_mut().zip(&fit.noise_std).filter(|(_, std)| std.is_finite()) {
        channel.noise = Noise::Known(*std);
    }
    let density: [f64; N] = fit.process_noise.as_slice().try_into().ok()?;
    let (outputs, _) = without_strays(manoeuvres, structure);
    let manoeuvres = with_outputs(manoeuvres, &outputs);
    let filters = Filters::of(&manoeuvres, &levelled, &ProcessNoise { density, estimated: false }).ok()?;
    let layout = &filters.layout;
    let end = End::of(fit, layout)?;

    // The innovations and their derivatives as they were found, the second time with steps that suit the information.
    let mut steps = filters.first_steps();
    let linearized = |steps: &[f64]| {
        let rows = filters.rows(filters.innovations(&end.unknowns).ok()?, &end.unknowns, steps, |_| true).ok()?;
        let rows: Vec<Rows<R>> = rows.into_iter().map(|(mean, _)| mean).collect();
        let mut found = Evaluation::nothing(layout.places.len());
        rows.iter().for_each(|rows| found.add(rows));
        Some((rows, found))
    };
    let (_, rough) = linearized(&steps)?;
    for (j, step) in steps.iter_mut().enumerate() {
        *step = step_of(rough.information[(j, j)]).unwrap_or(*step);
    }
    let (rows, found) = linearized(&steps)?;
    let descent_found = Evaluation::of_priors(&layout.places, &end.unknowns).descent + &found.descent;

    by_steps(&manoeuvres, structure, (layout, &end), sizes, |with, moved| {
        let mut there = Evaluation::of_priors(&layout.places, moved);
        there.information += &found.information;
        there.descent -= &descent_found;
        for (innovations, rows) in filters.over(with).innovations(moved).ok()?.iter().zip(&rows) {
            for (k, (e, s)) in innovations.errors.iter().zip(&innovations.variances).enumerate() {
                for i in (0..R).filter(|&i| e[i].is_finite()) {
                    let whitened = e[i] / s[i].sqrt();
                    for (&column, sensitivity) in rows.columns.iter().zip(rows.sensitivity(k, i)) {
                        there.descent[column] += sensitivity * whitened;
                    }
                }
            }
        }
        Some((there.information, there.descent))
    })
}

/// What [`equation_error()`](super::equation_error()) makes of errors of the constants, as [`output_error_constants`]. What noise
/// in the regressors takes off an effect is left out: it is a small part of it.
pub(crate) fn equation_error_constants<const N: usize, const R: usize>(
    manoeuvres: &[Manoeuvre<'_, N, R>],
    structure: &Structure<N, R>,
    settings: &EquationErrorSettings,
    fit: &BatchFit,
    sizes: &ByConstant,
) -> Option<Vec<ByConstant>> {
    let unknowns: Vec<f64> = fit.unknowns.iter().map(|u| u.value).collect();
    let (layout, found) = rows_at(manoeuvres, structure, settings, &unknowns).ok()?;
    let end = End::of(fit, &layout)?;
    let rows = |with: &[Manoeuvre<'_, N, R>]| Some(rows_at(with, structure, settings, &end.unknowns).ok()?.1);
    regressed((manoeuvres, found), structure, fit, (&layout, &end), sizes, rows)
}

/// What a regression makes of errors of the constants. `found`: residuals and regressors of its equations where it ended; `rows`:
/// those of other manoeuvres there.
fn regressed<const N: usize, const R: usize>(
    (manoeuvres, found): (&[Manoeuvre<'_, N, R>], Vec<Rows<R>>),
    structure: &Structure<N, R>,
    fit: &BatchFit,
    (layout, end): (&Layout<N>, &End),
    sizes: &ByConstant,
    rows: impl Fn(&[Manoeuvre<'_, N, R>]) -> Option<Vec<Rows<R>>>,
) -> Option<Vec<ByConstant>> {
    let noise_std: [f64; R] = fit.noise_std.as_slice().try_into().ok()?;
    let at = |rows: Vec<Rows<R>>| {
        let mut there = Evaluation::of_priors(&layout.places, &end.unknowns);
        rows.into_iter().for_each(|rows| there.add(&rows.whitened(&noise_std, Loss::GAUSSIAN)));
        there
    };
    let found = at(found);
    let theta = layout.parameters(&end.unknowns);
    let mut by_parameter = vec![[0.0; ROOM_FOR_CONSTANTS]; structure.parameters.len()];
    for (constant, size) in sizes.iter().copied().enumerate().filter(|(_, size)| *size > 0.0) {
        let plants = plants_of(manoeuvres, constant, size, true);
        // The states are taken as measured, without what the constant adds to what is shown of them. Of the other outputs the
        // model knows itself what it adds.
        let cleared: Vec<Vec<[f64; R]>> = manoeuvres.iter().map(|m| cleared(m, (constant, size), &theta)).collect();
        let with = at(rows(&with_outputs(&displaced(manoeuvres, &plants), &cleared))?);
        // The equations are linear in the parameters: with their regressors one step is all.
        let step = solve(&with.information, &(with.descent - &found.descent), 0.0, &end.frozen)?;
        note(&mut by_parameter, layout, constant, step.iter().map(|step| step / size));
    }
    Some(by_parameter)
}

/// What [`output_error_frequency()`](super::output_error_frequency()) makes of errors of the constants, as [`output_error_constants`].
pub(crate) fn output_error_frequency_constants<const N: usize, const R: usize>(
    manoeuvres: &[Manoeuvre<'_, N, R>],
    structure: &Structure<N, R>,
    band: Band,
    fit: &BatchFit,
    sizes: &ByConstant,
) -> Option<Vec<ByConstant>> {
    let (outputs, _) = without_strays(manoeuvres, structure);
    let manoeuvres = with_outputs(manoeuvres, &outputs);
    let BandSimulation { layout, spectrum, floor, motion } = BandSimulation::of(&manoeuvres, structure, band).ok()?;
    let end = End::of(fit, &layout)?;
    by_steps(&manoeuvres, structure, (&layout, &end), sizes, |with, moved| {
        let time = simulated(with, &layout, moved, structure.maximum_step_s)?;
        let there = in_band::evaluate(&layout.places, moved, &spectrum, Some(&motion), &floor, time);
        Some((there.information, there.descent))
    })
}

/// What [`equation_error_frequency()`](super::equation_error_frequency()) makes of errors of the constants, as
/// [`equation_error_constants`].
pub(crate) fn equation_error_frequency_constants<const N: usize, const R: usize>(
    manoeuvres: &[Manoeuvre<'_, N, R>],
    structure: &Structure<N, R>,
    (band, settings): (Band, &EquationErrorSettings),
    fit: &BatchFit,
    sizes: &ByConstant,
) -> Option<Vec<ByConstant>> {
    let equations = InBandEquations::of(manoeuvres, structure, band, settings).ok()?;
    let end = End::of(fit, &equations.layout)?;
    let rows = |with: &[Manoeuvre<'_, N, R>]| equations.transformed(with, structure, settings, &end.unknowns).ok();
    regressed((manoeuvres, rows(manoeuvres)?), structure, fit, (&equations.layout, &end), sizes, rows)
}

/// The measured outputs of a manoeuvre, those that measure a state without what a constant that is off by a size adds to them. Where a
/// state is not measured nothing is known of that, and they stay as they are.
pub(crate) fn cleared<const N: usize, const R: usize>(
    m: &Manoeuvre<'_, N, R>,
    (constant, size): (usize, f64),
    theta: &[f64; CAPACITY],
) -> Vec<[f64; R]> {
    let plant = Displaced { plant: m.plant, constant, size, states_are_clear: false };
    let measuring: [Option<usize>; N] = std::array::from_fn(|i| m.plant.measuring_output(i));
    let each = |(k, outputs): (usize, &[f64; R])| {
        let x: [f64; N] = measuring.map(|output| output.map_or(f64::NAN, |output| outputs[output]));
        let mut outputs = *outputs;
        if x.iter().all(|value| value.is_finite()) {
            let (_, more) = plant.effects(&x, theta, m.instant(k));
            measuring.iter().flatten().for_each(|&output| outputs[output] -= more[output]);
        }
        outputs
    };
    m.outputs.iter().enumerate().map(each).collect()
}
