//! From a model file and a record to what the estimator takes: the model, its inputs and the measured outputs.

use phugoid_flight_data::record::Record;
use phugoid_flight_dynamics::atmosphere::Atmosphere;
use phugoid_flight_dynamics::f16::{F16, F16Options};

use crate::axes::Axes;
use crate::error::EstimateError;
use crate::longitudinal::{Database, LongitudinalConstants, LongitudinalInput, LongitudinalModel, OUTPUTS, row};
use crate::model_file::{AirDensity, Base, InputHold, ModelFile, Reference, ReferenceValue, Role, Source, Thrust};
use crate::noise::median;
use crate::trim::{LevelTrim, TrimCondition, level_trim};
use crate::words::nearest;

/// Everything the estimator needs of one record.
#[derive(Clone, Debug)]
pub struct Prepared {
    /// The model with its constants filled in.
    pub model: LongitudinalModel,
    /// Time, s.
    pub time: Vec<f64>,
    /// Known input per sample.
    pub inputs: Vec<LongitudinalInput>,
    /// Measured outputs per sample; NaN where missing.
    pub outputs: Vec<[f64; OUTPUTS]>,
    /// Index in the record of the first sample used.
    pub first: usize,
    /// Sentences about what was filled in.
    pub notes: Vec<String>,
}

impl Prepared {
    /// Samples at the start of the record that noise levels are measured from: two seconds, at least 40 samples.
    pub fn noise_samples(&self) -> usize {
        let start = self.time.first().copied().unwrap_or(0.0);
        self.time.iter().take_while(|t| **t - start <= 2.0).count().max(40).min(self.time.len())
    }
}

/// Says how often the elevator moved while it was not sampled. The model takes it to move at the later sample, or evenly;
/// a step that came earlier biases the moment derivatives by more than their bounds.
fn unseen_moves(time: &[f64], elevator: &[f64], seen: &[bool]) -> Option<String> {
    let step = median(&mut time.windows(2).map(|pair| pair[1] - pair[0]).collect::<Vec<f64>>())?;
    let (low, high) = elevator.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(*v), h.max(*v)));
    let unseen = time
        .windows(2)
        .zip(elevator.windows(2))
        .zip(seen)
        .filter(|((t, e), before)| (!**before || t[1] - t[0] > 1.5 * step) && (e[1] - e[0]).abs() > 0.1 * (high - low))
        .count();
    (unseen > 0).then(|| {
        format!(
            "the elevator moved {unseen} times while samples were lost: when is not known, and the bounds do not allow \
             for it"
        )
    })
}

/// Builds the model and collects the signals.
///
/// # Errors
/// A missing channel, a channel without any value, an impossible trim.
pub fn prepare(record: &Record, file: &ModelFile) -> Result<Prepared, EstimateError> {
    if file.axes != Axes::Longitudinal {
        let axes = file.axes.name();
        return Err(EstimateError::Model(format!(
            "the {axes} motion cannot be estimated yet, only the longitudinal one"
        )));
    }
    let mut notes = Vec::new();
    let recorded = |source: &Source| match source {
        Source::Constant(value) => Ok(vec![*value; record.time.len()]),
        Source::Channel(name) => channel(record, name).map(<[f64]>::to_vec),
    };
    let aircraft = &file.aircraft;
    let database = match file.base {
        Base::None => Database::None,
        Base::F16 => {
            let options = F16Options { cg: aircraft.cg.unwrap_or(0.35), ..F16Options::default() };
            Database::F16(Box::new(F16::new(options).map_err(|e| EstimateError::Model(e.to_string()))?))
        }
    };
    let density = match &aircraft.air_density {
        AirDensity::Known(source) => recorded(source)?,
        AirDensity::StandardAtmosphere => densities(Atmosphere::Standard, channel(record, "altitude")?),
        AirDensity::BookAtmosphere => densities(Atmosphere::Book, channel(record, "altitude")?),
    };
    let (mass, iyy) = (recorded(&aircraft.mass)?, recorded(&aircraft.iyy)?);
    let trim = trim_of(file, &database, [&density, &mass])?;
    let thrust = match (&aircraft.thrust, trim) {
        (Thrust::Known(source), _) => recorded(source)?,
        (Thrust::Trim, Some(trim)) => vec![trim.thrust; record.time.len()],
        (Thrust::Trim, None) => return Err(EstimateError::Model("thrust = \"trim\" needs a database".to_owned())),
    };
    let mut columns = vec![channel(record, "elevator")?.to_vec(), density, thrust, mass, iyy];
    for name in &file.extra_inputs {
        columns.push(channel(record, name)?.to_vec());
    }
    let mut measured: Vec<Option<&[f64]>> = Vec::with_capacity(OUTPUTS);
    for output in Axes::Longitudinal.outputs() {
        let wanted = file.outputs[output.index()];
        measured.push(if wanted { Some(channel(record, output.name())?) } else { None });
    }

    // Everything known, nothing filled in from later samples: start where every input has a value.
    let complete = |k: usize| columns.iter().all(|c| c[k].is_finite());
    let Some(first) = (0..record.time.len()).find(|&k| complete(k)) else {
        let culprit = columns.iter().position(|c| !c.iter().any(|v| v.is_finite())).unwrap_or(0);
        return Err(EstimateError::EmptyChannel(input_name(culprit, &file.extra_inputs)));
    };
    if first > 0 {
        notes.push(format!(
            "the first {first} samples were left out: not every input has a value before {:.3} s",
            record.time[first]
        ));
    }
    let samples = record.time.len() - first;
    if samples < 20 {
        return Err(EstimateError::TooShort { samples });
    }
    let seen: Vec<bool> = columns[0][first..].iter().map(|value| value.is_finite()).collect();
    for (index, column) in columns.iter_mut().enumerate() {
        let held = hold(&mut column[first..]);
        if held > 0 {
            let name = input_name(index, &file.extra_inputs);
            notes.push(format!("input `{name}` is missing in {held} samples: its last value was held there"));
        }
    }
    notes.extend(unseen_moves(&record.time[first..], &columns[0][first..], &seen));
    let inputs: Vec<LongitudinalInput> = (first..record.time.len())
        .map(|k| LongitudinalInput {
            elevator: columns[0][k],
            air_density: columns[1][k],
            thrust: columns[2][k],
            mass: columns[3][k],
            iyy: columns[4][k],
            extra: std::array::from_fn(|i| columns.get(5 + i).map_or(0.0, |c| c[k])),
            controls_held: file.input == InputHold::Held,
        })
        .collect();
    let outputs: Vec<[f64; OUTPUTS]> = (first..record.time.len())
        .map(|k| std::array::from_fn(|i| measured[i].map_or(f64::NAN, |values| values[k])))
        .collect();
    for (row, output) in Axes::Longitudinal.outputs().iter().enumerate() {
        if file.outputs[output.index()] && !outputs.iter().any(|y| y[row].is_finite()) {
            return Err(EstimateError::EmptyChannel(output.name().to_owned()));
        }
    }

    let alpha = reference_value(file.reference.alpha, trim.map(|t| t.alpha), || first_alpha(&outputs))?;
    let elevator = reference_value(file.reference.elevator, trim.map(|t| t.elevator), || Some(inputs[0].elevator))?;
    let model = build(file, database, alpha, elevator);
    Ok(Prepared { model, time: record.time[first..].to_vec(), inputs, outputs, first, notes })
}

/// The model of a file with a given reference point: estimated terms become columns, fixed ones known terms.
/// For simulation and studies as well as for estimation.
pub fn build(file: &ModelFile, database: Database, alpha_reference: f64, elevator_reference: f64) -> LongitudinalModel {
    let aircraft = &file.aircraft;
    let reference_speed = aircraft.reference_speed.unwrap_or(1.0);
    let constants = LongitudinalConstants {
        wing_area: aircraft.wing_area,
        mean_chord: aircraft.mean_chord,
        gravity: aircraft.gravity,
        thrust_inclination: aircraft.thrust_inclination,
        thrust_arm: aircraft.thrust_arm,
        reference_speed,
        rate_speed: (file.rate_speed == crate::model_file::RateSpeed::Reference).then_some(reference_speed),
        alpha_reference,
        elevator_reference,
    };
    let (mut columns, mut known) = (Vec::new(), Vec::new());
    for parameter in &file.parameters {
        let (coefficient, term) = match &parameter.role {
            Role::Term(coefficient, term) => (*coefficient, term.clone()),
            Role::Offset(coefficient) => (*coefficient, crate::term::Term::default()),
            Role::Bias(_) => continue,
        };
        if parameter.fixed {
            known.push((coefficient, term, parameter.start));
        } else {
            columns.push((coefficient, term));
        }
    }
    LongitudinalModel::new(constants, database, columns, known)
}

/// The values of a channel of the record.
///
/// # Errors
/// [`EstimateError::MissingChannel`] with the nearest channel that is there; [`EstimateError::Model`] if it is not as long
/// as the time.
pub(crate) fn channel<'a>(record: &'a Record, name: &str) -> Result<&'a [f64], EstimateError> {
    match record.channel(name) {
        Some(channel) if channel.values.len() == record.time.len() => Ok(&channel.values),
        Some(channel) => Err(EstimateError::Model(format!(
            "{}: channel `{name}` has {} values for {} times: a record needs one value (NaN where missing) per time",
            record.source,
            channel.values.len(),
            record.time.len()
        ))),
        None => Err(missing(record, name)),
    }
}

fn missing(record: &Record, name: &str) -> EstimateError {
    EstimateError::MissingChannel {
        record: record.source.clone(),
        channel: name.to_owned(),
        present: record.channels.iter().map(|c| c.name.clone()).collect(),
        nearest: nearest(name, record.channels.iter().map(|c| c.name.as_str())).map(str::to_owned),
    }
}

fn densities(atmosphere: Atmosphere, altitude: &[f64]) -> Vec<f64> {
    altitude.iter().map(|h| atmosphere.at(*h).density).collect()
}

fn trim_of(
    file: &ModelFile,
    database: &Database,
    [density, mass]: [&[f64]; 2],
) -> Result<Option<LevelTrim>, EstimateError> {
    let Reference { alpha, elevator, altitude, .. } = file.reference;
    let wanted = file.aircraft.thrust == Thrust::Trim || [alpha, elevator].contains(&ReferenceValue::Trim);
    if !wanted || matches!(database, Database::None) {
        return Ok(None);
    }
    let aircraft = &file.aircraft;
    let density = match (&aircraft.air_density, altitude) {
        (AirDensity::BookAtmosphere, Some(h)) => Atmosphere::Book.at(h).density,
        (AirDensity::StandardAtmosphere, Some(h)) => Atmosphere::Standard.at(h).density,
        _ => density.iter().copied().find(|v| v.is_finite()).unwrap_or(f64::NAN),
    };
    let condition = TrimCondition {
        speed: aircraft.reference_speed.unwrap_or(f64::NAN),
        density,
        mass: mass.iter().copied().find(|v| v.is_finite()).unwrap_or(f64::NAN),
        gravity: aircraft.gravity,
        wing_area: aircraft.wing_area,
        mean_chord: aircraft.mean_chord,
        thrust_inclination: aircraft.thrust_inclination,
        thrust_arm: aircraft.thrust_arm,
    };
    level_trim(database, &condition).map(Some).map_err(EstimateError::Model)
}

fn reference_value(
    wanted: ReferenceValue,
    trim: Option<f64>,
    first: impl Fn() -> Option<f64>,
) -> Result<f64, EstimateError> {
    let value = match wanted {
        ReferenceValue::Given(value) => Some(value),
        ReferenceValue::Trim => trim,
        ReferenceValue::FirstSample => first(),
    };
    value.ok_or_else(|| EstimateError::Model("the reference point of the increments could not be found".to_owned()))
}

/// Angle of attack at the start: the median of the first values, so that one outlier does not shift the reference.
fn first_alpha(outputs: &[[f64; OUTPUTS]]) -> Option<f64> {
    let mut first: Vec<f64> = outputs.iter().map(|y| y[row::ALPHA]).filter(|v| v.is_finite()).take(5).collect();
    median(&mut first)
}

/// Fills missing values with the last one before; the first must be there. Gives the number filled.
fn hold(values: &mut [f64]) -> usize {
    let (mut last, mut held) = (f64::NAN, 0);
    for value in values {
        if value.is_finite() {
            last = *value;
        } else {
            *value = last;
            held += 1;
        }
    }
    held
}

/// Name of an input by its position among all.
fn input_name(index: usize, extra_inputs: &[String]) -> String {
    let fixed = ["elevator", "air_density", "thrust", "mass", "iyy"];
    let extra = || extra_inputs.get(index.wrapping_sub(fixed.len())).cloned();
    fixed.get(index).map(|n| (*n).to_owned()).or_else(extra).unwrap_or_default()
}
