//! How far an error of a constant moves the result of a batch method.
//!
//! A flight with a constant that is off by `c` shows `h(theta, c)`, and the method fits `h(theta, 0)` to it. With the
//! residuals `e(c)` of the flight against a model in which the constant is as it was in flight, the true parameters lie away
//! from the found ones by
//!
//! ```text
//! T c = sum of the steps M^-1 S^T W e(c)          output error: information M, sensitivities S, weights W of the residuals e(c)
//! T c = M(c)^-1 [ S(c)^T W e(c) - S^T W e ]       equation error, with c taken out of the measured states
//! ```
//!
//! with the constant off by one sigma. Output error goes on from its minimum with levels of the noise that are found anew: in a
//! long simulation a constant makes an output drift by many times its noise, which then counts for less. A first derivative
//! with the weights of the minimum claimed twenty times the value of a parameter on four of twenty foreign flights. Nothing of it changes the estimate. The causal filters have the same by a recursion
//! (`phugoid_estimators::supervisor::considered`).

use phugoid_estimators::{ConstantEffects, LinearizedOutputs, LinearizedRates, RegressorShift};

use super::equation_error::{EquationErrorSettings, rows_at};
use super::flown::{Flown, Instant};
use super::followed::Followed;
use super::information::solve;
use super::layout::Layout;
use super::likelihood::Evaluation;
use super::loss::Loss;
use super::problem::{Manoeuvre, Structure};
use super::relaxation::{levels, noise_floor};
use super::response::{Rows, response};
use super::result::{BatchFit, UnknownKind};
use super::start::stretches;
use crate::core::options::CAPACITY;
use crate::core::systematic::ROOM_FOR_CONSTANTS;

/// Errors of one parameter per unit of each constant, the true value less the found one.
pub(crate) type ByConstant = [f64; ROOM_FOR_CONSTANTS];

/// Most steps of output error with one constant, and the length of the last one over that of the first.
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
        let of = |row: &ByConstant| self.size * row.get(self.constant).copied().unwrap_or(0.0);
        (effects.rates.each_ref().map(of), effects.outputs.each_ref().map(of))
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
    /// Of a fit; none where its unknowns are not those of the layout.
    fn of<const N: usize>(fit: &BatchFit, layout: &Layout<N>) -> Option<Self> {
        let same = fit.unknowns.iter().map(|u| u.kind).eq(layout.places.iter().map(|p| p.kind));
        same.then(|| Self {
            unknowns: fit.unknowns.iter().map(|u| u.value).collect(),
            frozen: fit.unknowns.iter().map(|u| u.at_limit).collect(),
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
    let End { unknowns, frozen } = End::of(fit, &layout)?;
    let noise = structure.outputs.each_ref().map(|channel| channel.noise);
    let floor = noise_floor(manoeuvres);
    let loss = Loss::of(structure.likelihood);
    let mut by_parameter = vec![[0.0; ROOM_FOR_CONSTANTS]; structure.parameters.len()];
    let (plant, theta) = (manoeuvres.first()?.plant, layout.parameters(&unknowns));
    for (constant, size) in sizes.iter().copied().enumerate().filter(|(_, size)| *size > 0.0) {
        let plants = plants_of(manoeuvres, constant, size, false);
        let manoeuvres = displaced(manoeuvres, &plants);
        let mut moved = unknowns.clone();
        // Begun where the terms say that it lies: a zero of the vane of many times its noise would lead the steps elsewhere.
        for (column, value) in theta.iter().enumerate().take(plant.parameter_count()) {
            for shift in plant.regressor_shifts(column).iter().filter(|shift| shift.constant == constant) {
                let target = layout.places.iter().position(|p| p.kind == UnknownKind::Parameter { index: shift.of });
                if let Some(place) = target.filter(|place| !frozen[*place]) {
                    moved[place] += size * shift.per_unit * value;
                }
            }
        }
        let (mut first, mut before) = (f64::INFINITY, f64::INFINITY);
        for _ in 0..MOST_STEPS {
            let rows = manoeuvres
                .iter()
                .enumerate()
                .map(|(index, m)| response(m, index, &layout, &moved, structure.maximum_step_s))
                .collect::<Result<Vec<_>, _>>()
                .ok()?;
            let (noise_std, _) = levels(&noise, &rows, &floor, loss);
            let mut there = Evaluation::of_priors(&layout.places, &moved);
            rows.into_iter().for_each(|rows| there.add(&rows.whitened(&noise_std, loss)));
            let step = solve(&there.information, &there.descent, 0.0, &frozen)?;
            let length = step.dot(&(&there.information * &step)).sqrt();
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
        let by_unit = moved.iter().zip(&unknowns).map(|(moved, unknown)| (moved - unknown) / size);
        note(&mut by_parameter, &layout, constant, by_unit);
    }
    Some(by_parameter)
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
    let noise_std: [f64; R] = fit.noise_std.as_slice().try_into().ok()?;
    let unknowns: Vec<f64> = fit.unknowns.iter().map(|u| u.value).collect();
    let (layout, rows) = rows_at(manoeuvres, structure, settings, &unknowns).ok()?;
    let End { unknowns, frozen } = End::of(fit, &layout)?;
    let at = |rows: Vec<Rows<R>>| {
        let mut there = Evaluation::of_priors(&layout.places, &unknowns);
        rows.into_iter().for_each(|rows| there.add(&rows.whitened(&noise_std, Loss::GAUSSIAN)));
        there
    };
    let found = at(rows);
    let theta = layout.parameters(&unknowns);
    let mut by_parameter = vec![[0.0; ROOM_FOR_CONSTANTS]; structure.parameters.len()];
    for (constant, size) in sizes.iter().copied().enumerate().filter(|(_, size)| *size > 0.0) {
        let plants = plants_of(manoeuvres, constant, size, true);
        // The states are taken as measured, without what the constant adds to what is shown of them. Of the other outputs the
        // model knows itself what it adds.
        let cleared: Vec<Vec<[f64; R]>> =
            manoeuvres.iter().zip(&plants).map(|(m, plant)| cleared(m, plant, &theta)).collect();
        let with: Vec<Manoeuvre<'_, N, R>> = displaced(manoeuvres, &plants)
            .into_iter()
            .zip(&cleared)
            .map(|(m, outputs)| Manoeuvre { outputs, ..m })
            .collect();
        let with = at(rows_at(&with, structure, settings, &unknowns).ok()?.1);
        // The equations are linear in the parameters: with their regressors one step is all.
        let step = solve(&with.information, &(with.descent - &found.descent), 0.0, &frozen)?;
        note(&mut by_parameter, &layout, constant, step.iter().map(|step| step / size));
    }
    Some(by_parameter)
}

/// The measured outputs of a manoeuvre, those that measure a state without what the constant adds to them. Where a state is
/// not measured nothing is known of that, and they stay as they are.
fn cleared<const N: usize, const R: usize>(
    m: &Manoeuvre<'_, N, R>,
    plant: &Displaced<'_, N, R>,
    theta: &[f64; CAPACITY],
) -> Vec<[f64; R]> {
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
