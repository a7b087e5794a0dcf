//! The methods that are compared, on the same samples.

use crate::laws::{SurfaceChannel, SurfaceDerivative, ThesisLaw, ThesisSettings};
use crate::model_reference::{ModelReference, ModelReferenceForm, ModelReferenceSettings};
use phugoid_estimators::discretization::InputHold;
use phugoid_estimators::{Estimator, Sample};
use phugoid_flight_data::record::Record;
use phugoid_identification::estimate::{EstimateOptions, estimate};
use phugoid_identification::longitudinal::{LongitudinalInput, LongitudinalModel, OUTPUTS, STATES, row};
use phugoid_identification::model_file::ModelFile;
use phugoid_identification::output::Output;
use phugoid_identification::prepare::{Prepared, prepare};

use super::case::{ComparisonCase, UNKNOWN};
use crate::plant_case::verdict::behaviour;
use crate::result::{Behaviour, Role};
use phugoid_evaluation::accuracy::StudyError;
use phugoid_evaluation::chart::Meaning;
use phugoid_evaluation::settling::settled_at;
use phugoid_simulation::flight::fly;
use phugoid_simulation::scenario::Scenario;

/// A method that takes part in the comparison.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Method {
    /// The estimator that this project recommends.
    Flagship,
    /// The thesis's sliding-mode law, damped and solved implicitly.
    Sliding,
    /// The model-reference estimator in one of its forms, divided by its gradient or not.
    ModelReference(ModelReferenceForm, Normalised),
}

/// Whether a law is divided by its gradient.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Normalised {
    /// The law is used as it is.
    No,
    /// Divided by `c + |gradient|^2`.
    Yes,
}

impl Method {
    /// All, in the order to be shown.
    pub const ALL: [Self; 8] = {
        use ModelReferenceForm::{EnergyGradient, Printed, StateError};
        [
            Self::Flagship,
            Self::Sliding,
            Self::ModelReference(Printed, Normalised::No),
            Self::ModelReference(Printed, Normalised::Yes),
            Self::ModelReference(EnergyGradient, Normalised::No),
            Self::ModelReference(EnergyGradient, Normalised::Yes),
            Self::ModelReference(StateError, Normalised::No),
            Self::ModelReference(StateError, Normalised::Yes),
        ]
    };

    /// The name of the method in tables and figures.
    pub fn name(self) -> &'static str {
        use ModelReferenceForm::{EnergyGradient, Printed, StateError};
        match self {
            Self::Flagship => "flagship",
            Self::Sliding => "sliding-mode law, damped, implicit",
            Self::ModelReference(Printed, Normalised::No) => "model reference as printed (3.3)",
            Self::ModelReference(Printed, Normalised::Yes) => "model reference (3.3), normalised",
            Self::ModelReference(EnergyGradient, Normalised::No) => "model reference, gradient of (3.1)",
            Self::ModelReference(EnergyGradient, Normalised::Yes) => "model reference, gradient of (3.1), normalised",
            Self::ModelReference(StateError, Normalised::No) => "model reference, state error",
            Self::ModelReference(StateError, Normalised::Yes) => "model reference, state error, normalised",
        }
    }

    /// What it is to the reader.
    pub fn role(self) -> Role {
        match self {
            Self::Flagship => Role::Flagship,
            Self::Sliding => Role::Mended,
            Self::ModelReference(ModelReferenceForm::Printed, Normalised::No) => Role::Published,
            Self::ModelReference(..) => Role::Comparison,
        }
    }

    /// True for what the thesis's equations 3.1 to 3.3 can be read as: the law as printed, and the gradient that they announce.
    /// Normalised forms and the state error are not in them.
    pub fn is_of_thesis(self) -> bool {
        use ModelReferenceForm::{EnergyGradient, Printed};
        matches!(self, Self::ModelReference(Printed | EnergyGradient, Normalised::No))
    }

    /// True for all forms of the model-reference estimator.
    pub fn is_model_reference(self) -> bool {
        matches!(self, Self::ModelReference(..))
    }

    /// How it is drawn: the flagship's colour, or the number of the method.
    pub fn meaning(self) -> Meaning {
        match Self::ALL.iter().position(|method| *method == self) {
            Some(index) if index > 0 => Meaning::Method(index - 1),
            _ => Meaning::Flagship,
        }
    }
}

/// The numbers of a law that are tuned.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gain {
    /// Model reference: `g`; sliding-mode law: `1/eta`.
    pub gain: f64,
    /// `c` of a normalised law.
    pub normalisation: f64,
}

/// One flight as the methods see it.
pub struct Flown {
    /// True value of the unknown increment, per radian.
    pub truth: f64,
    measured: Record,
    prepared: Prepared<LongitudinalModel, STATES, OUTPUTS>,
    /// Whether the pitch acceleration is measured.
    has_acceleration: bool,
}

/// The estimates of one method over a flight.
#[derive(Clone, Debug, PartialEq)]
pub struct Track {
    /// Times of the samples from the start of the record, s.
    pub time: Vec<f64>,
    /// Estimate after each sample, per radian.
    pub values: Vec<f64>,
    /// One sigma after each sample, if the method claims any.
    pub std_errors: Option<Vec<f64>>,
}

/// How good a track is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Score {
    /// Whether the estimate converges, stays biased, chatters or diverges.
    pub behaviour: Behaviour,
    /// When it came within 5 % to stay, s from the start of the record; none unless it [converges](Behaviour::Converges).
    pub converged_s: Option<f64>,
    /// Mean magnitude of the error over the last fifth of the record, per radian.
    pub late_error: f64,
    /// Error at the end, per radian.
    pub end_error: f64,
}

impl Flown {
    /// When the elevator first moves, s from the start of the record.
    pub fn input_starts_s(&self) -> f64 {
        let prepared = &self.prepared;
        let rest = prepared.inputs.first().map_or(f64::NAN, |input| input.elevator);
        let moved = prepared.inputs.iter().position(|input| (input.elevator - rest).abs() > 1e-12);
        moved.and_then(|k| prepared.time.get(k)).copied().unwrap_or(f64::NAN)
    }

    /// Time (s), elevator and measured pitch rate (rad, rad/s).
    pub fn signals(&self) -> (Vec<f64>, Vec<f64>, Vec<f64>) {
        let prepared = &self.prepared;
        let elevator = prepared.inputs.iter().map(|input| input.elevator).collect();
        let q = prepared.outputs.iter().map(|y| y[row::PITCH_RATE]).collect();
        (prepared.time.clone(), elevator, q)
    }
}

impl Track {
    /// Compares the estimates with the truth, both per radian; `bounds` are lower and upper bound of the unknown.
    pub fn score(&self, truth: f64, bounds: [f64; 2]) -> Score {
        let behaviour = behaviour(&self.time, &self.values, truth, bounds);
        let arrived = settled_at(&self.time, &self.values, truth, 0.05);
        let late = &self.values[self.values.len() * 4 / 5..];
        Score {
            behaviour,
            converged_s: arrived.filter(|_| behaviour == Behaviour::Converges),
            late_error: late.iter().map(|value| (value - truth).abs()).sum::<f64>() / late.len() as f64,
            end_error: self.values.last().map_or(f64::NAN, |value| value - truth),
        }
    }
}

/// What does not depend on the truth of a flight.
pub struct Setting<'a> {
    /// The comparison case with its flight and settings.
    pub case: &'a ComparisonCase,
    /// What the flagship is told.
    model: ModelFile,
    /// The same with the pitch acceleration among the outputs, for the laws.
    model_with_acceleration: ModelFile,
    /// Typical pitch rate, rad/s: root mean square over the first training flight.
    pub pitch_rate: f64,
}

impl<'a> Setting<'a> {
    /// Reads the model and flies the first training flight.
    ///
    /// # Errors
    /// [`StudyError`]: the model cannot be read, the scenario cannot be flown.
    pub fn new(case: &'a ComparisonCase) -> Result<Self, StudyError> {
        let model = case.model()?;
        let mut model_with_acceleration = model.clone();
        model_with_acceleration.outputs[Output::PitchAcceleration.index()] = true;
        let mut setting = Self { case, model, model_with_acceleration, pitch_rate: f64::NAN };
        let first = case.comparison.training.first().copied().unwrap_or(f64::NAN);
        let flown = setting.fly(first, case.scenario.seed)?;
        let q = flown.prepared.outputs.iter().map(|y| y[row::PITCH_RATE]).filter(|q| q.is_finite());
        let (sum, count) = q.fold((0.0, 0usize), |(sum, count), q| (sum + q * q, count + 1));
        setting.pitch_rate = (sum / count as f64).sqrt();
        if setting.pitch_rate.is_nan() || setting.pitch_rate <= 0.0 {
            return Err(StudyError::Unsuitable(format!(
                "{}: the aircraft does not pitch, there is nothing to learn `{UNKNOWN}` from",
                case.scenario.name
            )));
        }
        Ok(setting)
    }

    /// Flies the scenario with another truth and another seed of its sensors.
    ///
    /// # Errors
    /// [`StudyError`]: it cannot be flown.
    pub fn fly(&self, truth: f64, seed: u64) -> Result<Flown, StudyError> {
        let mut scenario = Scenario { seed, ..self.case.scenario.clone() };
        scenario.increments.dCm_q = truth;
        let flight = fly(&scenario)?;
        let has_acceleration = flight.measured.channel("qdot").is_some();
        let model = if has_acceleration { &self.model_with_acceleration } else { &self.model };
        let prepared = prepare::<LongitudinalModel, _, _>(&flight.measured, model)?;
        Ok(Flown { truth, measured: flight.measured, prepared, has_acceleration })
    }

    /// Runs a method over a flight.
    ///
    /// # Errors
    /// [`StudyError`]: it refuses its settings.
    pub fn run(&self, flown: &Flown, method: Method, gain: Gain) -> Result<Track, StudyError> {
        match method {
            Method::Flagship => self.flagship(flown),
            Method::Sliding => self.sliding(flown, gain),
            Method::ModelReference(form, normalised) => self.model_reference(flown, form, normalised, gain),
        }
    }

    fn flagship(&self, flown: &Flown) -> Result<Track, StudyError> {
        let estimation = estimate(&flown.measured, &self.model, &EstimateOptions::causal(), &mut |_| {})?;
        let found = estimation.history.parameters.into_iter().find(|parameter| parameter.name == UNKNOWN);
        let Some(found) = found else {
            return Err(StudyError::Unsuitable(format!("model `{}`: no `{UNKNOWN}`", self.model.source)));
        };
        Ok(Track { time: estimation.history.time_s, values: found.value, std_errors: Some(found.std_error) })
    }

    /// The sums over p, q, r of the laws: in wings-level flight with the elevator alone p and r stay at zero.
    fn channel(&self, flown: &Flown) -> SurfaceChannel {
        let q = row::PITCH_RATE;
        let derivative = match flown.has_acceleration {
            true => SurfaceDerivative::Output(row::PITCH_ACCELERATION),
            false => SurfaceDerivative::Integrated,
        };
        SurfaceChannel { state: q, output: q, scale: self.pitch_rate, derivative }
    }

    fn sliding(&self, flown: &Flown, gain: Gain) -> Result<Track, StudyError> {
        let told = &self.case.comparison;
        let channel = self.channel(flown);
        let mut settings = ThesisSettings::<STATES, 1, 1>::new(0, [told.start], told.bounds, [channel]);
        settings.lambda = told.lambda;
        settings.eta = gain.gain.recip();
        settings.input_hold = InputHold::Linear;
        settings.follow = std::array::from_fn(|state| state != channel.state);
        let law = ThesisLaw::<LongitudinalModel, STATES, OUTPUTS, 1, 1>::new(flown.prepared.model.clone(), settings);
        Ok(track(law.map_err(StudyError::unsuitable)?, &flown.prepared))
    }

    fn model_reference(
        &self,
        flown: &Flown,
        form: ModelReferenceForm,
        normalised: Normalised,
        gain: Gain,
    ) -> Result<Track, StudyError> {
        let told = &self.case.comparison;
        let mut settings = ModelReferenceSettings::<STATES, 1, 1>::new(
            form,
            gain.gain,
            [told.start],
            [self.case.half_width()],
            [self.channel(flown)],
        );
        settings.normalisation = (normalised == Normalised::Yes).then_some(gain.normalisation);
        settings.input_hold = InputHold::Linear;
        // As printed, the law knows no bounds.
        if (form, normalised) != (ModelReferenceForm::Printed, Normalised::No) {
            [settings.lower[0], settings.upper[0]] = told.bounds;
        }
        let law =
            ModelReference::<LongitudinalModel, STATES, OUTPUTS, 1, 1>::new(flown.prepared.model.clone(), settings);
        Ok(track(law.map_err(StudyError::unsuitable)?, &flown.prepared))
    }
}

/// Feeds the samples to an estimator of one parameter.
fn track(
    mut law: impl Estimator<OUTPUTS, 1, Input = LongitudinalInput>,
    prepared: &Prepared<LongitudinalModel, STATES, OUTPUTS>,
) -> Track {
    let samples = prepared.time.iter().zip(&prepared.inputs).zip(&prepared.outputs);
    let values = samples
        .map(|((&time_s, &input), &outputs)| law.update(&Sample { time_s, input, outputs }).parameters[0])
        .collect();
    Track { time: prepared.time.clone(), values, std_errors: None }
}
