//! The part of a session that runs the estimator, once the first samples are collected.

use phugoid_estimators::{Phase, Sample};
use phugoid_flight_data::record::Record;

use super::{LiveParameter, Snapshot};
use crate::core::axes::Axes;
use crate::core::error::EstimateError;
use crate::core::estimation::Event;
use crate::core::options::EstimateOptions;
use crate::core::stack::on_a_large_stack;
use crate::judge::readiness::readiness;
use crate::methods::{CausalRun, EveryRoom, Task, causal_run};
use crate::model_file::{InputHold, ModelFile};
use crate::models::lateral::LateralModel;
use crate::models::longitudinal::LongitudinalModel;
use crate::models::six::SixModel;
use crate::motion::Motion;
use crate::preparation::checks::{doubts, noise_levels};
use crate::preparation::intake::{Origin, model_input};
use crate::preparation::prepare::prepare_start;

/// A running method, behind one interface for all motions and sizes of the estimator.
pub(super) trait Course: Send {
    /// Takes the values of a sample, in the order of the session's channels, and brings the snapshot up to it. Times
    /// are those of the estimator, which increase even if the sender's clock is set back.
    ///
    /// # Errors
    /// [`EstimateError::Model`] if the settings are refused where the estimation starts anew with the first motion.
    fn step(
        &mut self,
        time_s: f64,
        values: &[f64],
        snapshot: &mut Snapshot,
        events: &mut Vec<Event>,
    ) -> Result<(), EstimateError>;

    /// After an interval without samples that is longer than this, s, the states start again from the measurements.
    fn maximum_gap_s(&self) -> f64;

    /// Covariance of the parameters as the method claims it, parameter units.
    fn covariance(&self) -> Vec<Vec<f64>>;
}

/// Sets the method up from the beginning of a flight; the second value is the number of samples at the beginning that
/// cannot be used because an input is missing.
pub(super) fn begin(
    start: &Record,
    file: &ModelFile,
    options: &EstimateOptions,
    channels: &[String],
) -> Result<(Box<dyn Course>, usize), EstimateError> {
    let longitudinal = |_: &mut dyn FnMut(f64)| begin_of::<LongitudinalModel, _, _>(start, file, options, channels);
    let lateral = |_: &mut dyn FnMut(f64)| begin_of::<LateralModel, _, _>(start, file, options, channels);
    let six = |_: &mut dyn FnMut(f64)| begin_of::<SixModel, _, _>(start, file, options, channels);
    match file.axes {
        Axes::Longitudinal => on_a_large_stack(&longitudinal, &mut |_| {}),
        Axes::LateralDirectional => on_a_large_stack(&lateral, &mut |_| {}),
        Axes::All => on_a_large_stack(&six, &mut |_| {}),
    }
}

fn begin_of<M, const N: usize, const R: usize>(
    start: &Record,
    file: &ModelFile,
    options: &EstimateOptions,
    channels: &[String],
) -> Result<(Box<dyn Course>, usize), EstimateError>
where
    M: EveryRoom<N, R>,
{
    let prepared = prepare_start::<M, N, R>(start, file)?;
    doubts(start, file)?;
    let noise = noise_levels(&prepared, file)?;
    let file = &*prepared.with_time_of_surfaces(file);
    let task = Task::new(&prepared, file, options, &noise);
    let position = |name: &str| channels.iter().position(|channel| channel == name);
    let known = prepared.known.iter().zip(&prepared.origins).map(|(signal, origin)| Input {
        name: signal.name.clone(),
        channel: origin.channel().and_then(position),
        origin: origin.clone(),
        held: f64::NAN,
        is_surface: Axes::SURFACES.contains(&signal.name.as_str()),
    });
    let axes_outputs = M::AXES.outputs();
    let course = Running::<M, N, R> {
        run: causal_run(&task)?,
        inputs: known.collect(),
        named: prepared.known.len() - file.extra_inputs.len(),
        shown: M::AXES.known_channels().len(),
        hold: prepared.hold,
        outputs: std::array::from_fn(|row| {
            let output = axes_outputs.get(row).filter(|output| file.outputs[output.index()]);
            output.and_then(|output| position(output.name()))
        }),
        file: file.clone(),
        worded_s: f64::NEG_INFINITY,
    };
    Ok((Box::new(course), prepared.first))
}

/// A known input as the samples give it.
struct Input {
    name: String,
    /// Position among the channels of the session; `None` for a constant.
    channel: Option<usize>,
    origin: Origin,
    /// The last finite value, which is used while none comes; NaN before the first.
    held: f64,
    is_surface: bool,
}

struct Running<M: Motion<N, R>, const N: usize, const R: usize> {
    run: Box<dyn CausalRun<M::KnownInput, R>>,
    inputs: Vec<Input>,
    /// Inputs with places of their own; the others are extra inputs.
    named: usize,
    /// Inputs that a snapshot shows.
    shown: usize,
    hold: InputHold,
    /// Channel of each output; none where it is not measured.
    outputs: [Option<usize>; R],
    file: ModelFile,
    /// Time of the verdicts that were last put into words, s.
    worded_s: f64,
}

impl<M: Motion<N, R>, const N: usize, const R: usize> Course for Running<M, N, R> {
    fn step(
        &mut self,
        time_s: f64,
        values: &[f64],
        snapshot: &mut Snapshot,
        events: &mut Vec<Event>,
    ) -> Result<(), EstimateError> {
        let of = |channel: Option<usize>| channel.and_then(|i| values.get(i)).copied().unwrap_or(f64::NAN);
        for input in &mut self.inputs {
            let value = input.origin.value(of(input.channel));
            if value.is_finite() {
                input.held = value;
            }
        }
        let inputs = self.inputs.iter().map(|input| (input.name.as_str(), input.held));
        let input = model_input::<M, N, R>(self.hold, self.named, inputs);
        let sample = Sample { time_s, input, outputs: self.outputs.map(of) };
        let mut surfaces = self.inputs.iter().filter(|input| input.is_surface).map(|input| input.held);
        self.run.step(&sample, &mut surfaces, events)?;
        self.show(&sample.outputs, snapshot);
        Ok(())
    }

    fn maximum_gap_s(&self) -> f64 {
        self.run.maximum_gap_s()
    }

    fn covariance(&self) -> Vec<Vec<f64>> {
        self.run.covariance()
    }
}

impl<M: Motion<N, R>, const N: usize, const R: usize> Running<M, N, R> {
    fn show(&mut self, outputs: &[f64; R], snapshot: &mut Snapshot) {
        let estimate = self.run.shown();
        snapshot.time_s = estimate.time_s;
        snapshot.phase = estimate.status.phase;
        snapshot.change = estimate.status.change;
        snapshot.moved = self.run.has_moved();
        snapshot.parameters.resize_with(estimate.parameters.len(), LiveParameter::default);
        for (j, parameter) in snapshot.parameters.iter_mut().enumerate() {
            parameter.value = estimate.parameters[j] + estimate.learnt_shift[j];
            parameter.std_error = estimate.corrected_std_error[j];
            parameter.systematic_std = estimate.systematic_std[j];
            parameter.status = estimate.parameter_status[j];
        }
        let innovations = self.run.innovations();
        let started = estimate.status.phase != Phase::Starting;
        let measured = || self.outputs.iter().enumerate().filter(|(_, channel)| channel.is_some()).map(|(row, _)| row);
        fill(&mut snapshot.outputs, measured().map(|row| outputs[row]));
        let predicted = |row: usize| if started { innovations.predicted[row] } else { f64::NAN };
        fill(&mut snapshot.predicted, measured().map(predicted));
        fill(&mut snapshot.residuals, measured().map(|row| innovations.normalised[row]));
        fill(&mut snapshot.inputs, self.inputs.iter().take(self.shown).map(|input| input.held));
        self.word_verdicts(snapshot);
    }

    /// Puts renewed verdicts into words.
    fn word_verdicts(&mut self, snapshot: &mut Snapshot) {
        let (renewed_s, verdicts) = self.run.latest_verdicts();
        if renewed_s <= self.worded_s {
            return;
        }
        self.worded_s = renewed_s;
        snapshot.readiness_s = Some(renewed_s);
        let estimated: Vec<_> = self.file.estimated().collect();
        for (j, (parameter, verdict)) in snapshot.parameters.iter_mut().zip(verdicts).enumerate() {
            parameter.readiness = Some(readiness(j, verdict, &estimated, &self.file.extra_inputs));
        }
    }
}

fn fill(slots: &mut Vec<f64>, values: impl Iterator<Item = f64>) {
    slots.clear();
    slots.extend(values);
}
