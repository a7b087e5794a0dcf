//! Kalman filters over manoeuvres as functions of parameters, biases and variances, with their derivatives by differences.

use super::error::BatchError;
use super::filter::{Innovations, Tuning, filter};
use super::layout::{Layout, Place};
use super::loss::Loss;
use super::problem::{Manoeuvre, Noise, ProcessNoise, Structure};
use super::response::Rows;
use super::result::UnknownKind;
use super::start::stretches;
use crate::preparation::noise::measure_own_noise;

/// One sigma of the initial state over that of the sensor that measures it: the first samples decide.
const INITIAL_SD: f64 = 10.0;
/// One sigma of the logarithm of a variance about its start: a factor of ten in standard deviation. It only keeps a
/// variance that the data say nothing of from running away.
const LOG_VARIANCE_SD: f64 = 4.605_170_186;
/// Largest distance that the logarithm of a variance may move from its start.
const LOG_VARIANCE_RANGE: f64 = 18.0;
/// Step of the differences over the standard error that an unknown would have if all others were known.
const DIFFERENCE: f64 = 1e-3;
/// First relative step, as long as that is not known.
const FIRST_DIFFERENCE: f64 = 1e-5;

/// The Kalman filters of some manoeuvres, as functions of the unknowns.
pub(super) struct Filters<'a, const N: usize, const R: usize> {
    manoeuvres: &'a [Manoeuvre<'a, N, R>],
    /// The parameters, the biases, and the variances that are searched, by their logarithms.
    pub(super) layout: Layout<N>,
    /// One sigma of the initial states.
    initial_std: [f64; N],
    /// Variances of the measurement noise that is not searched.
    noise: [f64; R],
    /// Densities of the process noise that is not searched.
    process_noise: [f64; N],
    maximum_step_s: f64,
}

impl<'a, const N: usize, const R: usize> Filters<'a, N, R> {
    /// Over manoeuvres without outliers.
    ///
    /// # Errors
    /// [`BatchError::BadInput`] where the noise of an output is neither given nor measured, or nothing measures a state.
    pub(super) fn of(
        manoeuvres: &'a [Manoeuvre<'a, N, R>],
        structure: &Structure<N, R>,
        process_noise: &ProcessNoise<N>,
    ) -> Result<Self, BatchError> {
        let noise = first_noise(manoeuvres, structure)?;
        let initial_std = initial_std(manoeuvres, structure, &noise)?;
        let mut held = structure.clone();
        held.states.iter_mut().for_each(|s| s.free = false);
        let mut layout: Layout<N> = Layout::new(&held, manoeuvres, stretches(manoeuvres, structure)?);
        layout.places.extend(variances(structure, &noise, process_noise, &Structure::used(manoeuvres)));
        Ok(Self {
            manoeuvres,
            layout,
            initial_std,
            noise: noise.map(|std| std * std),
            process_noise: process_noise.density,
            maximum_step_s: structure.maximum_step_s,
        })
    }

    /// The same filters over other manoeuvres of the same kind.
    pub(super) fn over<'b>(&self, manoeuvres: &'b [Manoeuvre<'b, N, R>]) -> Filters<'b, N, R> {
        let Self { initial_std, noise, process_noise, maximum_step_s, .. } = *self;
        Filters { manoeuvres, layout: self.layout.clone(), initial_std, noise, process_noise, maximum_step_s }
    }

    /// What the filter of a manoeuvre holds fixed.
    pub(super) fn tuning(&self, index: usize, unknowns: &[f64]) -> Tuning<N, R> {
        let layout = &self.layout;
        let mut tuning = Tuning {
            parameters: layout.parameters(unknowns),
            biases: layout.biases(index, unknowns),
            stretches: layout.stretches(index, unknowns),
            initial_std: self.initial_std,
            noise: self.noise,
            process_noise: self.process_noise,
            maximum_step_s: self.maximum_step_s,
        };
        for (place, value) in layout.places.iter().zip(unknowns) {
            match place.kind {
                UnknownKind::Noise { output } => tuning.noise[output] = value.exp(),
                UnknownKind::ProcessNoise { state } => tuning.process_noise[state] = value.exp(),
                _ => {}
            }
        }
        tuning
    }

    fn run(&self, index: usize, unknowns: &[f64]) -> Result<Innovations<R>, BatchError> {
        let m = &self.manoeuvres[index];
        filter(m, &self.tuning(index, unknowns))
            .map_err(|time_s| BatchError::Diverged { manoeuvre: m.name.to_owned(), time_s })
    }

    /// The innovations of each manoeuvre.
    ///
    /// # Errors
    /// [`BatchError::Diverged`].
    pub(super) fn innovations(&self, unknowns: &[f64]) -> Result<Vec<Innovations<R>>, BatchError> {
        (0..self.manoeuvres.len()).map(|m| self.run(m, unknowns)).collect()
    }

    /// Steps of the differences as long as nothing is known of the information.
    pub(super) fn first_steps(&self) -> Vec<f64> {
        let first_step = |p: &Place| match p.kind {
            kind if kind.is_variance() => 1e-4,
            _ if p.start != 0.0 => FIRST_DIFFERENCE * p.start.abs(),
            _ if p.prior_std.is_finite() => FIRST_DIFFERENCE * p.prior_std,
            _ => FIRST_DIFFERENCE,
        };
        self.layout.places.iter().map(first_step).collect()
    }

    /// The rows of the innovations and of the logarithms of their variances, by manoeuvre, with derivatives by the wanted
    /// unknowns.
    ///
    /// # Errors
    /// [`BatchError::Diverged`].
    pub(super) fn rows(
        &self,
        centre: Vec<Innovations<R>>,
        unknowns: &[f64],
        steps: &[f64],
        wanted: impl Fn(usize) -> bool,
    ) -> Result<Vec<(Rows<R>, Rows<R>)>, BatchError> {
        let of = |(index, innovations)| {
            let mut columns = self.layout.columns(index);
            columns.retain(|j| wanted(*j));
            differences(innovations, columns, steps, unknowns, |z| self.run(index, z))
        };
        centre.into_iter().enumerate().map(of).collect()
    }
}

/// The step of the differences of an unknown that suits its information; none where the data say nothing of it.
pub(super) fn step_of(information: f64) -> Option<f64> {
    (information > 0.0).then(|| DIFFERENCE / information.sqrt())
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
