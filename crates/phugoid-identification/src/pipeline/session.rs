//! A live estimation: sample by sample, with the code that runs over records.
//!
//! The same samples give the same numbers, bit for bit, however late they come. The first two seconds (at least forty
//! samples) are collected, because the noise levels and the reference point are taken from them; then they are worked
//! off at once, and from there on each sample gives its estimate as it comes.
//!
//! ```
//! use phugoid_identification::estimate::EstimateOptions;
//! use phugoid_identification::model_file::ModelFile;
//! use phugoid_identification::session::{Session, Step};
//! let model = ModelFile::named("f16")?;
//! let mut session = Session::new(&model, &EstimateOptions::default())?;
//! assert!(session.channels().iter().any(|name| name == "elevator"));
//! let nothing_measured = vec![f64::NAN; session.channels().len()];
//! assert!(matches!(session.update(0.0, &nothing_measured)?, Step::Waiting { .. }));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod course;
mod units;

use phugoid_estimators::{ChangeState, ParameterStatus, Phase};
use phugoid_flight_data::channels;
use phugoid_flight_data::record::{Channel, Quantity, Record};
use serde::{Deserialize, Serialize};

use crate::core::correlation::correlation;
use crate::core::error::EstimateError;
use crate::core::estimation::{Event, ParameterReadiness};
use crate::core::method::Method;
use crate::core::options::{EstimateOptions, capacity};
use crate::core::output::Output;
use crate::model_file::ModelFile;
use course::Course;
use units::UnitWatch;

/// What an estimation starts from: this long, s, ...
const START_S: f64 = 2.0;
/// ... and this many samples.
const START_SAMPLES: usize = 40;
/// Values of a measured output among them, so that its noise can be measured.
const START_VALUES: usize = 11;
/// An aircraft that is slower than this part of its reference speed counts as not flying.
const FLYING: f64 = 0.5;

/// One live estimation.
///
/// ```
/// use phugoid_flight_data::record::Record;
/// use phugoid_identification::estimate::{EstimateOptions, estimate};
/// use phugoid_identification::model_file::ModelFile;
/// use phugoid_identification::session::{Session, Step};
/// let (flight, model, options) =
///     (Record::open("examples/flight.csv")?, ModelFile::named("f16")?, EstimateOptions::default());
/// let mut session = Session::new(&model, &options)?;
/// for k in 0..flight.len() {
///     let value = |name: &String| flight.channel(name).map_or(f64::NAN, |channel| channel.values[k]);
///     let values: Vec<f64> = session.channels().iter().map(value).collect();
///     let step = session.update(flight.time[k], &values)?;
///     assert_eq!(matches!(step, Step::Waiting { .. }), k < 100, "the first two seconds are collected");
/// }
/// // The same number as from the whole record, to the last bit.
/// let position = session.layout().parameters.iter().position(|p| p.name == "dCm_alpha").ok_or("missing")?;
/// let live = &session.snapshot().ok_or("no estimate")?.parameters[position];
/// let whole = estimate(&flight, &model, &options, &mut |_| {})?;
/// assert_eq!(Some(live.value), whole.parameter("dCm_alpha").map(|p| p.value));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// It may be moved between threads. [`Session::update`] needs less than 512 KiB of the stack of the thread that calls it; the
/// estimator, which needs more while it is set up, is set up on a thread of its own.
pub struct Session {
    file: ModelFile,
    options: EstimateOptions,
    layout: Layout,
    channels: Vec<String>,
    /// The samples that are collected until the estimation begins; empty from then on.
    start: Record,
    course: Option<Box<dyn Course>>,
    snapshot: Option<Snapshot>,
    events: Vec<Event>,
    /// What the samples say of their units and signs.
    units: UnitWatch,
    /// Time of the last sample by the sender's clock, s.
    last_s: f64,
    /// What the estimator's time is ahead of the sender's, s; not 0 once the sender's clock has been set.
    ahead_s: f64,
}

/// What a session did with a sample.
#[derive(Clone, Debug, PartialEq)]
pub enum Step {
    /// The sample was kept: the estimation has not begun.
    Waiting {
        /// Time that has been collected so far, s.
        have_s: f64,
        /// Time that is needed before the estimation begins, s.
        need_s: f64,
        /// What else is missing, in words.
        reason: Option<String>,
    },
    /// The sample gave an estimate: read it with [`Session::snapshot`].
    Estimated,
    /// The sample was left out, for this reason.
    Refused(String),
}

/// Names and units of the entries of a [`Snapshot`].
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Layout {
    /// Model file or its built-in name.
    pub model: String,
    /// The method that runs; never a batch method.
    pub method: Method,
    /// Axes of the motion, as in a model file: `longitudinal`, `lateral`.
    pub axes: Vec<String>,
    /// The parameters that are estimated, in the order of the model file.
    pub parameters: Vec<ParameterLayout>,
    /// The measured outputs, in the order of the output vector.
    pub outputs: Vec<SignalLayout>,
    /// The known inputs that a snapshot shows, in the order of
    /// [`Axes::known_channels`](crate::axes::Axes::known_channels).
    pub inputs: Vec<SignalLayout>,
}

/// Name, unit and prior of one estimated parameter.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ParameterLayout {
    /// Name from the model file, e.g. `Cm_alpha`.
    pub name: String,
    /// Unit as printed: `per rad`, `-`; that of the sensor for a bias.
    pub unit: String,
    /// Start value from the model file, in `unit`.
    pub initial: f64,
    /// One sigma of what is known beforehand.
    pub prior_std: f64,
    /// True for sensor biases and offsets, which only support the others.
    pub nuisance: bool,
}

/// The name and the unit of one signal of a snapshot.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct SignalLayout {
    /// Canonical name of the channel, e.g. `alpha`.
    pub name: String,
    /// SI unit as printed, e.g. `rad`.
    pub unit: String,
}

/// Everything known after one sample. Arrays are in the order of the [`Layout`].
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Snapshot {
    /// Time of the sample, s.
    pub time_s: f64,
    /// How the estimator treated the sample.
    pub phase: Phase,
    /// State of the change detector; while a change is in doubt the bounds are widened.
    pub change: ChangeState,
    /// True once anything has moved; before that the parameters are those of the priors.
    pub moved: bool,
    /// Time at which the readiness of the parameters was computed last, s; `None` before the first motion.
    #[serde(default)]
    pub readiness_s: Option<f64>,
    /// The estimate of each parameter after this sample.
    pub parameters: Vec<LiveParameter>,
    /// Measured outputs, SI; NaN (in JSON `null`) where missing.
    pub outputs: Vec<f64>,
    /// What the estimated model predicted of them, before this sample corrected it.
    pub predicted: Vec<f64>,
    /// Residuals over their predicted standard deviation; NaN where missing.
    pub residuals: Vec<f64>,
    /// Known inputs as the model used them: the last value is held where one is missing, SI.
    pub inputs: Vec<f64>,
}

/// The estimate of one parameter after one sample.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct LiveParameter {
    /// Estimate, in the unit that the layout gives.
    pub value: f64,
    /// One-sigma error, corrected for the colour of the residuals; bounds are two of them.
    pub std_error: f64,
    /// The part of it that the declared uncertainties make, one sigma; zero where none are. A longer flight does not make it
    /// smaller.
    pub systematic_std: f64,
    /// How well the parameter is known.
    pub status: ParameterStatus,
    /// Whether the value can be used, why, and what input would help. Computed ten times a second; `None` before the
    /// first motion.
    pub readiness: Option<ParameterReadiness>,
}

impl Session {
    /// A session for this model and these options that has not seen a sample.
    ///
    /// # Errors
    /// [`EstimateError::NotCausal`] for a batch method, [`EstimateError::OneRecordOnly`] for records and true values
    /// among the options that only a recorded flight has; [`EstimateError::TooManyParameters`]; [`EstimateError::AllFixed`].
    pub fn new(file: &ModelFile, options: &EstimateOptions) -> Result<Self, EstimateError> {
        let method = options.method.unwrap_or(file.estimator.method);
        if method.is_batch() {
            return Err(EstimateError::NotCausal { method });
        }
        if options.predict.is_some() || !options.further.is_empty() {
            return Err(EstimateError::OneRecordOnly { method });
        }
        let (wanted, capacity) = (file.estimated().count(), capacity(file.axes));
        if wanted > capacity {
            return Err(EstimateError::TooManyParameters { wanted, capacity });
        }
        if wanted == 0 {
            return Err(EstimateError::AllFixed { model: file.source.clone() });
        }
        let mut channels: Vec<String> = Vec::new();
        for name in file.channels_used() {
            if !channels.iter().any(|known| known == name) {
                channels.push(name.to_owned());
            }
        }
        let start = Record {
            source: "the live samples".to_owned(),
            channels: channels.iter().map(|name| empty_channel(name)).collect(),
            ..Record::default()
        };
        let layout = Layout {
            model: file.source.clone(),
            method,
            axes: file.axes.words().iter().map(|word| (*word).to_owned()).collect(),
            parameters: file.estimated().map(parameter_layout).collect(),
            outputs: file.measured().map(|output| signal(output.name(), output.unit())).collect(),
            inputs: file.axes.known_channels().iter().map(|name| known_layout(name)).collect(),
        };
        Ok(Self {
            file: file.clone(),
            options: options.clone(),
            layout,
            channels,
            units: UnitWatch::new(&start),
            start,
            course: None,
            snapshot: None,
            events: Vec::new(),
            last_s: f64::NEG_INFINITY,
            ahead_s: 0.0,
        })
    }

    /// Canonical names of the channels whose values [`Session::update`] takes, in this order, SI.
    pub fn channels(&self) -> &[String] {
        &self.channels
    }

    /// Names and units of the entries of a snapshot, in their order.
    pub fn layout(&self) -> &Layout {
        &self.layout
    }

    /// Takes the values of one sample, in the order of [`Session::channels`], SI, NaN where one is missing: an input is
    /// then held at its last value, an output left out. A sample whose time does not increase is refused.
    ///
    /// # Errors
    /// What makes an estimation impossible: units that are certainly wrong, a model without a trim. The session stays
    /// as it was.
    pub fn update(&mut self, time_s: f64, values: &[f64]) -> Result<Step, EstimateError> {
        if values.len() != self.channels.len() {
            let (found, expected) = (values.len(), self.channels.join(", "));
            return Ok(Step::Refused(format!("{found} values, expected one for each of {expected}")));
        }
        if !time_s.is_finite() || time_s <= self.last_s {
            return Ok(Step::Refused(format!("the time {time_s} s does not come after {} s", self.last_s)));
        }
        self.last_s = time_s;
        if self.course.is_some() {
            self.step(time_s, values)?;
            return Ok(Step::Estimated);
        }
        self.collect(time_s, values)
    }

    /// To be called when the sender's clock has been set, as by a restart of the sender: the next sample has the time
    /// `time_s` by the new clock and came `pause_s` after the last one. What is known of the parameters is kept with its
    /// covariance as it is; the states start again from the measurements, as after a gap. Times of snapshots and events
    /// are those of the new clock from then on. Returns false if no estimation had begun; what was collected for its
    /// start is then dropped. A pause that is negative or NaN counts as the shortest one after which states start
    /// again; a time that is not finite changes nothing.
    ///
    /// ```
    /// use phugoid_identification::estimate::EstimateOptions;
    /// use phugoid_identification::model_file::ModelFile;
    /// use phugoid_identification::session::{Session, Step};
    /// let mut session = Session::new(&ModelFile::named("f16")?, &EstimateOptions::default())?;
    /// let nothing_measured = vec![f64::NAN; session.channels().len()];
    /// session.update(100.0, &nothing_measured)?;
    /// assert!(matches!(session.update(0.0, &nothing_measured)?, Step::Refused(_)));
    /// assert!(!session.resume(0.0, 3.0), "no estimation had begun");
    /// assert!(matches!(session.update(0.0, &nothing_measured)?, Step::Waiting { .. }));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn resume(&mut self, time_s: f64, pause_s: f64) -> bool {
        if !time_s.is_finite() {
            return self.course.is_some();
        }
        let shortest_s = self.course.as_ref().map(|course| 2.0 * course.maximum_gap_s());
        if let Some(shortest_s) = shortest_s {
            // `max` gives the other one for NaN.
            self.ahead_s += self.last_s + pause_s.max(shortest_s) - time_s;
        } else {
            self.slide(f64::INFINITY, 0);
        }
        self.units.begin_again();
        self.last_s = f64::NEG_INFINITY;
        shortest_s.is_some()
    }

    /// The state after the last sample that gave an estimate.
    pub fn snapshot(&self) -> Option<&Snapshot> {
        self.snapshot.as_ref()
    }

    /// Correlation of the parameters after the last sample, in the order of the layout: one on the diagonal, between -1 and 1 beside
    /// it, zero with a parameter of which the method claims no error. `None` before the first estimate. With the standard errors
    /// of the [`Snapshot`] it makes the covariance that a function of several parameters needs.
    pub fn correlation(&self) -> Option<Vec<Vec<f64>>> {
        self.snapshot.as_ref()?;
        Some(correlation(&self.course.as_ref()?.covariance()))
    }

    /// The events since the last call, in order of time: suspected and adopted changes, gaps, restarts.
    pub fn take_events(&mut self) -> Vec<Event> {
        std::mem::take(&mut self.events)
    }

    fn step(&mut self, time_s: f64, values: &[f64]) -> Result<(), EstimateError> {
        self.estimate(time_s, values)?;
        self.units.take(time_s, values, &self.file, &mut self.events);
        for parameter in self.snapshot.iter_mut().flat_map(|snapshot| &mut snapshot.parameters) {
            self.units.judge(parameter.readiness.as_mut());
        }
        Ok(())
    }

    fn estimate(&mut self, time_s: f64, values: &[f64]) -> Result<(), EstimateError> {
        let Some(course) = &mut self.course else { return Ok(()) };
        let snapshot = self.snapshot.get_or_insert_default();
        if self.ahead_s == 0.0 {
            return course.step(time_s, values, snapshot, &mut self.events);
        }
        let (its_s, before, readiness_s) = (time_s + self.ahead_s, self.events.len(), snapshot.readiness_s);
        // The sum need not give back the sender's time exactly.
        let sent = |its: f64| if its == its_s { time_s } else { its - self.ahead_s };
        let stepped = course.step(its_s, values, snapshot, &mut self.events);
        snapshot.time_s = sent(snapshot.time_s);
        if snapshot.readiness_s != readiness_s {
            snapshot.readiness_s = snapshot.readiness_s.map(sent);
        }
        for event in self.events.iter_mut().skip(before) {
            event.time_s = sent(event.time_s);
        }
        stepped
    }

    fn collect(&mut self, time_s: f64, values: &[f64]) -> Result<Step, EstimateError> {
        if let Some(reason) = self.not_flying(values) {
            // Samples from the ground must not decide the noise levels and the reference point.
            self.slide(f64::INFINITY, 0);
            return Ok(Step::Waiting { have_s: 0.0, need_s: START_S, reason: Some(reason) });
        }
        self.start.time.push(time_s);
        for (channel, value) in self.start.channels.iter_mut().zip(values) {
            channel.values.push(*value);
        }
        let have_s = time_s - self.start.time.first().copied().unwrap_or(time_s);
        // Rounding may make two seconds a little shorter.
        if have_s < START_S - 1e-6 || self.start.time.len() < START_SAMPLES {
            return Ok(Step::Waiting { have_s, need_s: START_S, reason: None });
        }
        match self.missing() {
            None => self.begin(),
            Some(reason) => Ok(self.wait_on(reason)),
        }
    }

    fn not_flying(&self, now: &[f64]) -> Option<String> {
        let reference = self.file.aircraft.reference_speed?;
        let speed = self.channels.iter().position(|name| name == "true_airspeed").and_then(|i| now.get(i))?;
        (*speed < FLYING * reference)
            .then(|| format!("not flying yet: airspeed {speed:.1} m/s, the model is of a flight at {reference:.1} m/s"))
    }

    /// Channels with too few values for a start, in words.
    fn missing(&self) -> Option<String> {
        let measured = |name: &str| self.file.measured().any(|output| output.name() == name);
        let lacking = |channel: &&Channel| {
            let present = channel.values.iter().filter(|value| value.is_finite()).count();
            present < if measured(&channel.name) { START_VALUES } else { 1 }
        };
        let names: Vec<&str> =
            self.start.channels.iter().filter(lacking).map(|channel| channel.name.as_str()).collect();
        (!names.is_empty()).then(|| format!("too few values of {} in the last {START_S} s", names.join(", ")))
    }

    /// Continues to collect, with the samples that are young enough to be used.
    fn wait_on(&mut self, reason: String) -> Step {
        self.slide(self.last_s - START_S - 1e-6, START_SAMPLES);
        Step::Waiting { have_s: START_S, need_s: START_S, reason: Some(reason) }
    }

    /// Drops samples from before `from_s`, but keeps `at_least` so many.
    fn slide(&mut self, from_s: f64, at_least: usize) {
        let old = self.start.time.partition_point(|time| *time < from_s);
        let out = old.min(self.start.time.len().saturating_sub(at_least));
        self.start.time.drain(..out);
        for channel in &mut self.start.channels {
            channel.values.drain(..out);
        }
    }

    fn begin(&mut self) -> Result<Step, EstimateError> {
        let (course, first) = match course::begin(&self.start, &self.file, &self.options, &self.channels) {
            Ok(course) => course,
            // Further samples may remove the cause.
            Err(
                error @ (EstimateError::Noise(_)
                | EstimateError::EmptyChannel(_)
                | EstimateError::EmptyInput(_)
                | EstimateError::TooShort { .. }),
            ) => {
                return Ok(self.wait_on(error.to_string()));
            }
            Err(error) => return Err(error),
        };
        self.course = Some(course);
        let start = std::mem::take(&mut self.start);
        for (k, time_s) in start.time.iter().enumerate().skip(first) {
            let values: Vec<f64> =
                start.channels.iter().map(|channel| channel.values.get(k).copied().unwrap_or(f64::NAN)).collect();
            self.step(*time_s, &values)?;
        }
        Ok(Step::Estimated)
    }
}

fn empty_channel(name: &str) -> Channel {
    let quantity = channels::by_name(name).map_or(Quantity::Number, |spec| spec.quantity);
    Channel { name: name.to_owned(), quantity, values: Vec::new() }
}

fn parameter_layout(parameter: &crate::model_file::Parameter) -> ParameterLayout {
    ParameterLayout {
        name: parameter.name.clone(),
        unit: parameter.unit(),
        initial: parameter.start,
        prior_std: parameter.prior_std,
        nuisance: parameter.is_nuisance(),
    }
}

fn signal(name: &str, unit: &str) -> SignalLayout {
    SignalLayout { name: name.to_owned(), unit: unit.to_owned() }
}

fn known_layout(name: &str) -> SignalLayout {
    signal(name, Output::from_name(name).map_or("rad", Output::unit))
}
