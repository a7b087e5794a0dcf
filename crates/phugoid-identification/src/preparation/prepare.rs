//! Makes the arguments of the estimator of a model file and a record: the model, its inputs and the measured outputs.

use std::sync::Arc;

use phugoid_flight_data::printable::toml_string;
use phugoid_flight_data::record::Record;
use phugoid_flight_data::statistics::{median, median_step};
use phugoid_flight_dynamics::atmosphere::Atmosphere;
use phugoid_flight_dynamics::f16::{F16, F16Options};

use crate::core::axes::Axes;
use crate::core::error::{EstimateError, Lacking};
use crate::core::estimation::Signal;
use crate::core::output::Output;
use crate::model_file::{AirDensity, Base, InputHold, ModelFile, Reference, ReferenceValue, Role, Source, Thrust};
use crate::models::longitudinal::{Database, LongitudinalModel};
use crate::motion::{Motion, ReferencePoint};
use crate::preparation::database_part::{Condition, database_parts};
use crate::preparation::intake::{KnownInput, Origin, known_inputs, model_input};
use crate::preparation::noise::OwnSamples;
pub use crate::preparation::prepared::Prepared;
use crate::preparation::prepared::{speeds, surface_motion};
use crate::preparation::reaction::surfaces;
use crate::preparation::resample::earlier;
use crate::preparation::slow_surface::SlowSurface;
use crate::preparation::surface::{self, SurfaceNoise, WildValues};
use crate::preparation::timing::{OPEN, timing, unseen_std_s};
use crate::preparation::trim::{LevelTrim, TrimCondition, level_trim};

/// Says how often a surface moved while it was not sampled. The model takes it to move at the later sample, or evenly;
/// a step that came earlier biases the moment derivatives by more than their bounds.
fn unseen_moves(name: &str, time: &[f64], elevator: &[f64], seen: &[bool]) -> Option<String> {
    let step = median_step(time)?;
    let (low, high) = elevator.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(*v), h.max(*v)));
    let unseen = time
        .windows(2)
        .zip(elevator.windows(2))
        .zip(seen)
        .filter(|((t, e), before)| (!**before || t[1] - t[0] > 1.5 * step) && (e[1] - e[0]).abs() > 0.1 * (high - low))
        .count();
    (unseen > 0).then(|| {
        format!(
            "the {name} moved {unseen} times while samples were lost: when is not known, and the bounds do not allow \
             for it"
        )
    })
}

/// Says that a surface is slower than the record, and how it is taken between its own samples.
fn slowness(slow: &SlowSurface, is_straight: bool) -> String {
    let how = if is_straight { "it runs straight" } else { "it is held" };
    format!(
        "the {} has a sample every {:.0} ms, which is slower than the record: {how} between them",
        slow.name,
        1e3 * slow.step_s
    )
}

/// Leaves of an output that runs straight between the samples of a slower instrument these samples alone, and says so: what
/// stands between them was computed and not measured. A method that takes it for measurements believes that the instrument has
/// hardly any noise, and that the aircraft does not answer at once to what moves between the samples.
fn take_lines<const R: usize>(outputs: &mut [[f64; R]], row: usize, name: &str, time_s: &[f64]) -> Option<String> {
    let values: Vec<f64> = outputs.iter().map(|y| y[row]).collect();
    // What is held until the next sample steps in every row of its own.
    let own = OwnSamples::on_straight_lines(&values).filter(|_| OwnSamples::of(&values).is_none())?;
    let step_s = own.step_s(time_s)?;
    outputs.iter_mut().for_each(|y| y[row] = f64::NAN);
    own.rows().iter().for_each(|k| outputs[*k][row] = values[*k]);
    Some(format!(
        "{name} runs straight between samples every {:.0} ms: it is slower than the record, and what stands between these samples is \
         no measurement. They alone are used",
        1e3 * step_s
    ))
}

/// Says that single values were taken from a surface.
fn spikes(name: &str, count: usize) -> String {
    format!(
        "{count} single values of the recorded {name} stand alone far from both neighbours, and no surface moves so: each was put on \
         the straight line between them. Check the recorder"
    )
}

/// Says that a surface was smoothed.
fn smoothing(name: &str, noise: SurfaceNoise) -> Option<String> {
    if noise.stands_still() {
        return Some(format!(
            "the recorded {name} does not move beyond its noise of {:.2e} rad: it was taken to stand still",
            noise.std
        ));
    }
    (noise.left < noise.share).then(|| {
        format!(
            "the recorded {name} has white noise of {:.2e} rad, {:.1} % of its scatter, to which no aircraft answers: it was \
             smoothed, with {:.2} % left",
            noise.std,
            100.0 * noise.share,
            100.0 * noise.left
        )
    })
}

/// Builds the model and collects the signals: `prepare::<LongitudinalModel, _, _>(&record, &file)`. Noise on the positions
/// of the surfaces is smoothed away, with samples before and after, and a note says so. Where the file leaves it to the
/// record how they move between samples, that is decided, and a skew of theirs taken out; notes say so too.
///
/// # Errors
/// A file of other axes, a missing channel, a channel without any value, an impossible trim.
pub fn prepare<M: Motion<N, R>, const N: usize, const R: usize>(
    record: &Record,
    file: &ModelFile,
) -> Result<Prepared<M, N, R>, EstimateError> {
    let mut prepared = collect(record, file, Sight::Whole)?;
    if file.input == InputHold::Auto {
        let mut times = surfaces(&prepared, file);
        for time in &mut times {
            // Held, it is late by half of its own step.
            let slow = prepared.slow_surfaces.iter().find(|slow| slow.name == time.name);
            time.step_s = slow.map_or(time.step_s, |slow| slow.step_s);
        }
        let found = timing(&times, median_step(&prepared.time).unwrap_or(0.0));
        let is_told = !times.is_empty();
        let said = prepared.take_slow_surfaces(is_told, found.is_certain, found.hold);
        prepared.notes.extend(said);
        let hold = if is_told || !prepared.has_only_slow_surfaces() { found.hold } else { InputHold::Interpolated };
        for (name, late_s) in &found.late_s {
            for signal in prepared.known.iter_mut().filter(|signal| signal.name == *name) {
                signal.values = earlier(&prepared.time, &signal.values, *late_s);
            }
        }
        for (name, late_s) in &found.late_s {
            times.iter_mut().filter(|one| one.name == *name).for_each(|one| one.late_s -= late_s);
        }
        prepared.surface_times = Some(times);
        // Of surfaces that are all slower than the record, of which nothing else tells, what is open is that of their own samples.
        if is_told || !prepared.has_only_slow_surfaces() {
            prepared.surface_time_std_s = prepared.surface_time_std_s.max(found.open_std_s);
        }
        prepared.moved_s = found.late_s.iter().map(|(name, late_s)| ((*name).to_owned(), *late_s)).collect();
        prepared.hold = hold;
        prepared.inputs = model_inputs::<M, N, R>(&prepared.known, file, hold);
        prepared.surface_motion = surface_motion::<M, N, R>(&prepared.time, &prepared.inputs, file);
        if hold == found.hold {
            prepared.notes.extend(found.notes);
        }
    } else {
        prepared.surface_times = Some(surfaces(&prepared, file));
    }
    prepared.notes.extend(prepared.times_not_seen(file));
    Ok(prepared)
}

impl<M: Motion<N, R>, const N: usize, const R: usize> Prepared<M, N, R> {
    /// Holds the slow surfaces where they are to be held, and says how each is taken: as the record tells it, if it does; else
    /// those with nothing between their own samples run straight, and those whose samples are repeated are held as they are.
    fn take_slow_surfaces(&mut self, is_told: bool, is_certain: bool, hold: InputHold) -> Vec<String> {
        let mut said = Vec::new();
        for slow in &self.slow_surfaces {
            let is_straight = if is_told { hold == InputHold::Interpolated } else { slow.has_gaps };
            if !is_straight {
                let of_it = self.known.iter_mut().filter(|signal| signal.name == slow.name);
                of_it.for_each(|signal| signal.values = slow.held(&self.time));
            }
            said.push(slowness(slow, is_straight));
            if !is_certain {
                self.surface_time_std_s = self.surface_time_std_s.max(slow.undecided_std_s(is_straight));
            }
        }
        if !is_told && !self.slow_surfaces.is_empty() {
            said.push(NOT_SEEN_BETWEEN.to_owned());
        }
        said
    }

    /// What is said of the surfaces that move, and of which nothing tells when they were recorded.
    fn times_not_seen(&self, file: &ModelFile) -> Option<String> {
        let seen = self.surface_times.as_deref().unwrap_or_default();
        // Where none is seen the note on `input` says so.
        if file.input == InputHold::Auto && seen.is_empty() {
            return None;
        }
        let moves = |signal: &&Signal| signal.values.windows(2).any(|pair| pair[0] != pair[1]);
        let names: Vec<&str> = self.surfaces().filter(moves).map(|signal| signal.name.as_str()).collect();
        let names: Vec<&str> = names.into_iter().filter(|name| seen.iter().all(|one| one.name != *name)).collect();
        (!names.is_empty()).then(|| not_seen(&names))
    }
}

/// What is said of surfaces of which the record does not tell by when the aircraft reacts to them.
fn not_seen(names: &[&str]) -> String {
    format!(
        "whether the {} was recorded late is not checked: this record does not tell when the aircraft reacts to it (too short, too \
         little motion of its own, or no flow angle)",
        names.join(" or the ")
    )
}

/// What is said where nothing tells how a slow surface moved.
const NOT_SEEN_BETWEEN: &str = "the record does not tell how it moved between its samples: half of its step more or less is a \
                                part of the timing of surfaces, as an error that is declared. Record it faster, or say it in the model file with the line \
                                input = \"held\" (commands) or input = \"interpolated\" (positions)";

/// The input of the model at each sample, from the known inputs by name.
fn model_inputs<M: Motion<N, R>, const N: usize, const R: usize>(
    known: &[Signal],
    file: &ModelFile,
    hold: InputHold,
) -> Vec<M::KnownInput> {
    let named = known.len() - file.extra_inputs.len();
    let samples = known.first().map_or(0, |signal| signal.values.len());
    (0..samples)
        .map(|k| {
            let values = known.iter().map(|signal| (signal.name.as_str(), signal.values[k]));
            model_input::<M, N, R>(hold, named, values)
        })
        .collect()
}

/// As [`prepare`], for the first samples of a live session: later ones cannot be looked at, and surfaces stay as they
/// were recorded.
///
/// # Errors
/// Those of [`prepare`].
pub(crate) fn prepare_start<M: Motion<N, R>, const N: usize, const R: usize>(
    record: &Record,
    file: &ModelFile,
) -> Result<Prepared<M, N, R>, EstimateError> {
    collect(record, file, Sight::Past)
}

/// Which samples may be looked at for the value of a surface.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Sight {
    /// Those of the whole record: noise is smoothed away, and slow surfaces run straight to their next sample.
    Whole,
    /// Those before: surfaces stay as they were recorded, and are held until their next sample.
    Past,
}

impl Sight {
    /// Takes the noise from the positions of a surface (rad) at the times given (s), where that is possible, and says what it was.
    fn take_noise(self, time_s: &[f64], values: &mut [f64]) -> Option<SurfaceNoise> {
        match self {
            Self::Whole => surface::smooth(time_s, values),
            Self::Past => surface::noise_of(values),
        }
    }
}

fn collect<M: Motion<N, R>, const N: usize, const R: usize>(
    record: &Record,
    file: &ModelFile,
    sight: Sight,
) -> Result<Prepared<M, N, R>, EstimateError> {
    if file.axes != M::AXES {
        let (found, expected) = (file.axes.name(), M::AXES.name());
        let message = format!("{}: the file is of the {found} motion, expected the {expected} one", file.source);
        return Err(EstimateError::Model(message));
    }
    let lacking = file.channels_used().into_iter().filter(|name| record.channel(name).is_none());
    let lacking: Vec<&str> = lacking.collect();
    if let Some((first, rest)) = lacking.split_first() {
        return Err(missing(record, first, rest, without(file, &lacking), asked_by(file, first)));
    }
    let mut notes = file.notes.clone();
    let database = database(file)?;
    if M::AXES == Axes::All && database.by_alpha_rate(100.0, 1.0, 0.05, 0.0).is_some() {
        return Err(EstimateError::Model(format!(
            "{}: the coefficients of `base` follow the rate of the angle of attack, which the motion of all axes does not know: \
             estimate with axes = [\"longitudinal\"], and with axes = [\"lateral\"] beside it",
            file.source
        )));
    }
    let (inputs, trim) = known(record, file, &database)?;
    let mut known = Vec::with_capacity(inputs.len());
    for KnownInput { name, unit, origin } in &inputs {
        known.push(Signal { name: name.clone(), unit: unit.clone(), values: recorded(record, origin)? });
    }
    let mut measured: Vec<Option<&[f64]>> = Vec::with_capacity(R);
    for output in M::AXES.outputs() {
        let wanted = file.outputs[output.index()];
        measured.push(if wanted { Some(channel(record, output.name())?) } else { None });
    }

    // Everything known, nothing filled in from later samples: start where every input has a value.
    let complete = |k: usize| known.iter().all(|c| c.values[k].is_finite());
    let Some(first) = (0..record.time.len()).find(|&k| complete(k)) else {
        let culprit = known.iter().find(|c| !c.values.iter().any(|v| v.is_finite())).or(known.first());
        return Err(EstimateError::EmptyInput(culprit.map(|c| c.name.clone()).unwrap_or_default()));
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
    let time = record.time[first..].to_vec();
    let mut unseen = Vec::new();
    let mut surface_noise = Vec::new();
    let mut wild_values = Vec::new();
    let mut slow_surfaces = Vec::new();
    for signal in &mut known {
        signal.values.drain(..first);
        let is_surface = Axes::SURFACES.contains(&signal.name.as_str());
        let mut slow = is_surface.then(|| SlowSurface::of(&signal.name, &time, &signal.values)).flatten();
        // In flight nobody knows whether the next value comes back.
        if is_surface && slow.is_none() && sight == Sight::Whole {
            let count = surface::take_spikes(&time, &mut signal.values);
            notes.extend((count > 0).then(|| spikes(&signal.name, count)));
            wild_values.extend(WildValues::of(&signal.name, &time, &signal.values));
        }
        let noise = match &mut slow {
            Some(slow) => sight.take_noise(&slow.time_s, &mut slow.values),
            None if is_surface => sight.take_noise(&time, &mut signal.values),
            None => None,
        };
        if let Some(noise) = noise {
            notes.extend(smoothing(&signal.name, noise));
            surface_noise.push((signal.name.clone(), noise));
        }
        if let Some(slow) = slow {
            let is_straight = sight == Sight::Whole && file.input != InputHold::Held;
            signal.values = if is_straight { slow.straight(&time) } else { slow.held(&time) };
            // Where the record is to tell it, it is said afterwards.
            if sight == Sight::Past || file.input != InputHold::Auto {
                notes.push(slowness(&slow, is_straight));
            }
            slow_surfaces.push(slow);
            continue;
        }
        let seen: Vec<bool> = signal.values.iter().map(|value| value.is_finite()).collect();
        let held = hold(&mut signal.values);
        if held > 0 {
            notes.push(format!("input `{}` is missing in {held} samples: its last value was held there", signal.name));
        }
        if is_surface {
            unseen.extend(unseen_moves(&signal.name, &time, &signal.values, &seen));
        }
    }
    notes.extend(unseen);
    let origins = inputs.into_iter().map(|input| input.origin).collect();
    // What comes later decides it where the file does not: until then they are held, and so they stay in a live session.
    let hold = if file.input == InputHold::Interpolated { file.input } else { InputHold::Held };
    let inputs = model_inputs::<M, N, R>(&known, file, hold);
    let mut outputs: Vec<[f64; R]> = (first..record.time.len())
        .map(|k| std::array::from_fn(|i| measured.get(i).copied().flatten().map_or(f64::NAN, |values| values[k])))
        .collect();
    // In flight the next value of a line is not known, and so nobody draws one.
    if sight == Sight::Whole {
        for (row, output) in M::AXES.outputs().iter().enumerate() {
            notes.extend(take_lines(&mut outputs, row, output.name(), &time));
        }
    }
    for (row, output) in M::AXES.outputs().iter().enumerate() {
        if file.outputs[output.index()] && !outputs.iter().any(|y| y[row].is_finite()) {
            return Err(EstimateError::EmptyChannel(output.name().to_owned()));
        }
    }

    let of = |name: &str| known.iter().find(|signal| signal.name == name).map(|signal| signal.values.as_slice());
    let start = |name: &str| of(name).and_then(|values| values.first().copied());
    let surface = |wanted: ReferenceValue, trim: Option<f64>, name: &str| {
        // A surface that these axes do not use has no reference to look for.
        if of(name).is_none() { Ok(0.0) } else { reference_value(name, wanted, trim, || start(name)) }
    };
    let alpha = match M::AXES.row(Output::Alpha) {
        Some(row) => outputs.iter().map(|y| y[row]).collect(),
        None => of("alpha").unwrap_or_default().to_vec(),
    };
    let wanted = &file.reference;
    let reference = ReferencePoint {
        alpha: reference_value("alpha", wanted.alpha, trim.map(|t| t.alpha), || first_alpha(&alpha))?,
        elevator: surface(wanted.elevator, trim.map(|t| t.elevator), "elevator")?,
        aileron: surface(wanted.aileron, Some(0.0), "aileron")?,
        rudder: surface(wanted.rudder, Some(0.0), "rudder")?,
    };
    let speeds = speeds::<M, N, R>(&outputs, of(Output::TrueAirspeed.name()));
    let condition = Condition::of(file, speeds, of("air_density"));
    let (database_parts, lacking) = database_parts(file, &database, &reference, condition);
    notes.extend(lacking);
    let model = M::build(file, database, &reference);
    let is_slow = |name: &str| slow_surfaces.iter().any(|slow| slow.name == name);
    let mut surfaces = known.iter().filter(|signal| Axes::SURFACES.contains(&signal.name.as_str()));
    let is_open = file.input == InputHold::Auto && surfaces.any(|signal| !is_slow(&signal.name));
    let step_s = median_step(&time).unwrap_or(0.0);
    if is_open && sight == Sight::Past {
        notes.push(format!(
            "`input`: the surfaces are taken as held between samples, since later ones are not known yet, {OPEN}"
        ));
    }
    Ok(Prepared {
        model,
        surface_motion: surface_motion::<M, N, R>(&time, &inputs, file),
        time,
        inputs,
        outputs,
        known,
        origins,
        hold,
        moved_s: Vec::new(),
        surface_times: None,
        surface_time_std_s: match (sight, file.input) {
            (Sight::Past, InputHold::Auto | InputHold::Interpolated) => {
                let of_slow = slow_surfaces.iter().map(SlowSurface::held_std_s).fold(0.0, f64::max);
                // What comes later would tell how the others moved, and nobody knows it yet.
                if is_open { of_slow.max(unseen_std_s(step_s)) } else { of_slow }
            }
            _ => 0.0,
        },
        slow_surfaces,
        surface_noise,
        wild_values,
        reference,
        database_parts,
        first,
        notes,
    })
}

/// The longitudinal model of a file with a given reference point. For simulation and studies as well as for estimation.
pub fn build(file: &ModelFile, database: Database, alpha_reference: f64, elevator_reference: f64) -> LongitudinalModel {
    let reference =
        ReferencePoint { alpha: alpha_reference, elevator: elevator_reference, ..ReferencePoint::default() };
    LongitudinalModel::build(file, database, &reference)
}

/// The database of a model file.
///
/// # Errors
/// [`EstimateError::Model`] if it cannot be loaded.
pub fn database(file: &ModelFile) -> Result<Database, EstimateError> {
    Ok(match file.base {
        Base::None => Database::None,
        Base::F16 => {
            let standard = F16Options::default();
            let options = F16Options { cg: file.aircraft.cg.unwrap_or(standard.cg), ..standard };
            Database::F16(Box::new(F16::new(options).map_err(|e| EstimateError::Model(e.to_string()))?))
        }
        Base::Aircraft => {
            let known = file.known.as_ref().ok_or_else(|| {
                EstimateError::Model(format!("{}: the aircraft of `base` was not read with the file", file.source))
            })?;
            Database::Aircraft(Arc::clone(known.aircraft()))
        }
    })
}

/// The known inputs of the file, and the trim where the file asks for one.
fn known(
    record: &Record,
    file: &ModelFile,
    database: &Database,
) -> Result<(Vec<KnownInput>, Option<LevelTrim>), EstimateError> {
    let density = recorded(record, &Origin::of_density(file))?;
    let mass = recorded(record, &Origin::of_mass(file))?;
    let first = |values: &[f64]| values.iter().copied().find(|v| v.is_finite()).unwrap_or(f64::NAN);
    let trim = reference_trim(file, database, first(&density), first(&mass))?;
    Ok((known_inputs(file, trim.map(|trim| trim.thrust))?, trim))
}

/// A known input over the whole record.
fn recorded(record: &Record, origin: &Origin) -> Result<Vec<f64>, EstimateError> {
    Ok(match origin.channel() {
        Some(name) => channel(record, name)?.iter().map(|value| origin.value(*value)).collect(),
        None => vec![origin.value(f64::NAN); record.time.len()],
    })
}

/// The values of a channel of the record.
///
/// # Errors
/// [`EstimateError::MissingChannel`] with the nearest channel that is there; [`EstimateError::Model`] if it is not as
/// long as the time.
pub(crate) fn channel<'a>(record: &'a Record, name: &str) -> Result<&'a [f64], EstimateError> {
    match record.channel(name) {
        Some(channel) if channel.values.len() == record.time.len() => Ok(&channel.values),
        Some(channel) => Err(EstimateError::Model(format!(
            "{}: channel `{name}` has {} values for {} times: a record needs one value (NaN where missing) per time",
            record.source,
            channel.values.len(),
            record.time.len()
        ))),
        None => Err(missing(record, name, &[], None, None)),
    }
}

/// What to write in the model file where it can do without some of the lacking channels: outputs that are no states, and the
/// flow angles, for which many aircraft have no vane.
fn without(file: &ModelFile, lacking: &[&str]) -> Option<String> {
    let is_dispensable =
        |output: &Output| matches!(output, Output::Alpha | Output::Beta) || !file.axes.states().contains(output);
    let (left_out, kept): (Vec<Output>, Vec<Output>) =
        file.measured().partition(|output| lacking.contains(&output.name()) && is_dispensable(output));
    if left_out.is_empty() {
        return None;
    }
    let names = |outputs: &[Output], mark: &str| {
        outputs.iter().map(|output| format!("{mark}{}{mark}", output.name())).collect::<Vec<_>>().join(", ")
    };
    let is_named = |output: &&Output| {
        let bias = file.parameters.iter().any(|p| matches!(p.role, Role::Bias(of) if of == **output));
        bias || file.noise[output.index()].is_some()
    };
    let named: Vec<Output> = left_out.iter().filter(is_named).copied().collect();
    let also = match named.is_empty() {
        true => String::new(),
        false => format!(", and take {} out of [noise] and [biases]", names(&named, "`")),
    };
    let vane = left_out.iter().any(|output| matches!(output, Output::Alpha | Output::Beta));
    let why = if vane { ": without a vane the flow angles follow from the motion" } else { "" };
    Some(format!(
        "The model can do without {}{why}. Write this line in the model file, above its first [section]{also}: outputs = [{}].",
        names(&left_out, "`"),
        names(&kept, "\"")
    ))
}

/// The line of the model file that names the channel itself.
fn asked_by(file: &ModelFile, channel: &str) -> Option<String> {
    let aircraft = &file.aircraft;
    let density = match &aircraft.air_density {
        AirDensity::Known(source) => Some(source),
        AirDensity::StandardAtmosphere | AirDensity::BookAtmosphere => None,
    };
    let thrust = match &aircraft.thrust {
        Thrust::Known(source) => Some(source),
        Thrust::Trim => None,
    };
    let sources = [
        ("mass", Some(&aircraft.mass)),
        ("ixx", aircraft.ixx.as_ref()),
        ("iyy", Some(&aircraft.iyy)),
        ("izz", aircraft.izz.as_ref()),
        ("ixz", aircraft.ixz.as_ref()),
        ("air_density", density),
        ("thrust", thrust),
    ];
    let names_it = |source: &Option<&Source>| matches!(source, Some(Source::Channel(name)) if name == channel);
    let (key, _) = sources.into_iter().find(|(_, source)| names_it(source))?;
    let value = toml_string(channel);
    Some(format!("`{key} = {{ channel = {value} }}` under [aircraft] in the model file `{}`", file.source))
}

fn missing(
    record: &Record,
    name: &str,
    others: &[&str],
    dispensable: Option<String>,
    asked_by: Option<String>,
) -> EstimateError {
    let mut other_channels: Vec<String> =
        others.iter().filter(|other| **other != name).map(|other| (*other).to_owned()).collect();
    other_channels.dedup();
    // The reader of a log says for a missing channel where it was looked for and what to do.
    let about = |place: &str| place == name || place == "vehicle" || other_channels.iter().any(|other| other == place);
    let about_channels = record.quality.findings.iter().filter(|finding| about(&finding.place));
    let lacking = std::iter::once(name).chain(other_channels.iter().map(String::as_str));
    let columns = lacking.flat_map(|channel| record.columns_for(channel));
    let findings = columns
        .map(|column| column.to_string())
        .chain(about_channels.map(|finding| format!("{}: {}", finding.place, finding.message.replace('\n', "\n  "))))
        .collect();
    EstimateError::MissingChannel {
        record: record.source.clone(),
        channel: name.to_owned(),
        present: record.channels.iter().map(|c| c.name.clone()).collect(),
        nearest: record.similar_channel(name).map(str::to_owned),
        lacking: Box::new(Lacking { other_channels, findings, dispensable, asked_by }),
    }
}

/// The level trim of the database at the reference speed and altitude of the file, where the file asks for it. The density
/// (kg/m^3) counts where no altitude gives it; mass in kg.
pub(crate) fn reference_trim(
    file: &ModelFile,
    database: &Database,
    density: f64,
    mass: f64,
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
        _ => density,
    };
    let condition = TrimCondition {
        speed: aircraft.reference_speed.unwrap_or(f64::NAN),
        density,
        mass,
        gravity: aircraft.gravity,
        wing_area: aircraft.wing_area,
        mean_chord: aircraft.mean_chord,
        thrust_inclination: aircraft.thrust_inclination,
        thrust_arm: aircraft.thrust_arm,
    };
    level_trim(database, &condition).map(Some).map_err(EstimateError::Model)
}

fn reference_value(
    name: &str,
    wanted: ReferenceValue,
    trim: Option<f64>,
    first: impl Fn() -> Option<f64>,
) -> Result<f64, EstimateError> {
    let value = match wanted {
        ReferenceValue::Given(value) => Some(value),
        ReferenceValue::Trim => trim,
        ReferenceValue::FirstSample => first(),
    };
    value.ok_or_else(|| {
        EstimateError::Model(format!(
            "the reference point of the terms cannot be found: `{name}` of [reference] is to come from {}, and there is none. Give \
             it as a number: {name} = \"2 deg\"",
            match wanted {
                ReferenceValue::FirstSample => "the first sample of a recorded channel",
                _ => "the trim of a database",
            }
        ))
    })
}

/// Angle of attack at the start: the median of the first values, so that one outlier does not shift the reference.
fn first_alpha(alpha: &[f64]) -> Option<f64> {
    let mut first: Vec<f64> = alpha.iter().copied().filter(|v| v.is_finite()).take(5).collect();
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
