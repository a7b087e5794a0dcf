//! From TOML text to a checked [`ModelFile`]: the file as a whole; what has many lines of its own is beside.

mod aircraft;
mod axes;
mod channels;
mod measurements;
mod parameters;

use phugoid_flight_data::printable::{is_command, toml_string};
use phugoid_flight_data::quantity::Dimension;
use toml::de::DeTable;

use self::aircraft::aircraft;
use self::axes::axes;
use self::channels::channels;
pub(crate) use self::measurements::LIGHT_TURBULENCE;
use self::measurements::{noise, noise_learning, outputs, process_noise};
use self::parameters::parameters;
use super::aircraft::{AirDensity, Base, RateSpeed, Reference, ReferenceValue, Source, Thrust};
use super::error::ModelFileError;
use super::expected::expected;
use super::file::ModelFile;
use super::known::base;
use super::parameter::Role;
use super::section::{Section, Source as Text};
use super::settings::{EstimatorTuning, InputHold};
use super::simulation::simulation;
use super::uncertainty::Uncertainty;
use crate::core::axes::Axes;
use crate::core::method::Method;
use crate::core::term::{EXTRA_INPUTS, Variable};

/// The name that `change_detection` had until version 0.1.
const FORMER_CHANGE_DETECTION: &str = "re_reaching";

const TOP_KEYS: [&str; 20] = [
    "name",
    "axes",
    "base",
    "rate_speed",
    "inputs",
    "input",
    "aircraft",
    "channels",
    "outputs",
    "noise",
    "coefficients",
    "parameters",
    "reference",
    "process_noise",
    "biases",
    "change_detection",
    "expected",
    "estimator",
    "uncertainty",
    "simulation",
];
const ESTIMATOR_KEYS: [&str; 7] = [
    "method",
    "reaching_limit",
    "rejection_scale",
    "prior_scale",
    "process_noise_scale",
    "adaptation_gain",
    "start_window",
];

impl ModelFile {
    /// Reads and checks a model file.
    ///
    /// ```
    /// use phugoid_identification::model_file::ModelFile;
    /// let text = ModelFile::text("f16")?.replace("wing_area", "wing_aera");
    /// let error = ModelFile::parse("mine.toml", &text).unwrap_err();
    /// assert_eq!((error.key.as_ref(), error.nearest.as_deref()), ("aircraft.wing_aera", Some("wing_area")));
    /// let shown = error.to_string();
    /// let expected = "mine.toml:12:1: unknown key `wing_aera` in [aircraft]: did you mean `wing_area`?";
    /// assert!(shown.starts_with(expected), "{shown}");
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// A `base` that is a path is read from there, relative to the folder of `file`.
    ///
    /// # Errors
    /// The first thing found wrong, with file, line, column, key and the nearest valid word.
    pub fn parse(file: &str, text: &str) -> Result<Self, ModelFileError> {
        parse(file, text)
    }
}

fn parse(file: &str, text: &str) -> Result<ModelFile, ModelFileError> {
    let source = Text { file, text };
    let document = DeTable::parse(text).map_err(|error| {
        let message = format!("not valid TOML: {}", error.message());
        source.error(error.span().unwrap_or(0..0), "", message)
    })?;
    let top = Section { source: &source, path: String::new(), table: document.get_ref(), span: 0..0 };
    let former = top.get(FORMER_CHANGE_DETECTION).is_some();
    top.allow_also("key", TOP_KEYS.iter().copied(), &[FORMER_CHANGE_DETECTION])?;
    let (change_detection, notes) = change_detection(&top, former)?;
    let axes = axes(&top)?;

    let (base, known) = base(&top)?;
    let extra_inputs = extra_inputs(&top, axes)?;
    let aircraft = aircraft(&top, base, known.as_ref(), axes)?;
    let rate_speed = match top.word("rate_speed", &["actual", "reference"])? {
        Some("reference") => RateSpeed::Reference,
        _ => RateSpeed::Actual,
    };
    let input = match top.word("input", &["auto", "held", "interpolated"])? {
        Some("interpolated") => InputHold::Interpolated,
        Some("auto") => InputHold::Auto,
        // The database is flown by simulations, which hold their commands.
        Some(_) => InputHold::Held,
        None if base == Base::F16 => InputHold::Held,
        None => InputHold::Auto,
    };
    let outputs = outputs(&top, axes)?;
    let parameters = parameters(&top, axes, base, &extra_inputs, &outputs)?;
    let levels = noise(&top, &outputs)?;
    let model = ModelFile {
        source: file.to_owned(),
        name: top.string("name")?.unwrap_or(file).to_owned(),
        axes,
        base,
        rate_speed,
        channels: channels(&top, &extra_inputs)?,
        outputs,
        noise: levels,
        noise_learning: noise_learning(&top, base, &outputs, &levels)?,
        uncertainty: Uncertainty::parse(&top, &aircraft.mass, known.is_some())?,
        known,
        expected: expected(&top, &parameters)?,
        simulation: simulation(&top, base, &aircraft, &parameters)?,
        parameters,
        reference: reference(&top, base)?,
        process_noise: process_noise(&top, axes)?,
        estimator: estimator(&top)?,
        input,
        change_detection,
        notes,
        aircraft,
        extra_inputs,
    };
    check_reference_speed(&top, &model)?;
    Ok(model)
}

/// Whether changes are looked for, and a note if the file says so with the former word.
fn change_detection(top: &Section, former: bool) -> Result<(bool, Vec<String>), ModelFileError> {
    if !former {
        return Ok((top.boolean("change_detection")?.unwrap_or(true), Vec::new()));
    }
    if top.get("change_detection").is_some() {
        let message = "`re_reaching` is the former name of `change_detection`: give one of the two";
        return Err(top.error(FORMER_CHANGE_DETECTION, message));
    }
    let note = format!("{}: `re_reaching` is called `change_detection` now; it was read as that", top.source.file);
    Ok((top.boolean(FORMER_CHANGE_DETECTION)?.unwrap_or(true), vec![note]))
}

fn check_reference_speed(top: &Section, model: &ModelFile) -> Result<(), ModelFileError> {
    let uses_v_hat = model.parameters.iter().any(|p| match &p.role {
        Role::Term(_, term) => term.powers().any(|(i, _)| i == Variable::Airspeed.index()),
        _ => false,
    });
    let needs_trim = model.aircraft.thrust == Thrust::Trim
        || [model.reference.alpha, model.reference.elevator].contains(&ReferenceValue::Trim);
    let needed_by = if uses_v_hat {
        "v_hat = V/V0"
    } else if model.rate_speed == RateSpeed::Reference {
        "rate_speed = \"reference\""
    } else if needs_trim {
        "the trim at the reference point"
    } else {
        return Ok(());
    };
    if model.aircraft.reference_speed.is_none() {
        let section = top.section("aircraft")?;
        return Err(section.as_ref().unwrap_or(top).missing("reference_speed", &format!("a speed, for {needed_by}")));
    }
    if needs_trim
        && model.reference.altitude.is_none()
        && !matches!(model.aircraft.air_density, AirDensity::Known(Source::Constant(_)))
    {
        let section = top.section("reference")?;
        return Err(section.as_ref().unwrap_or(top).missing("altitude", "the altitude of the trim"));
    }
    Ok(())
}

fn extra_inputs(top: &Section, axes: Axes) -> Result<Vec<String>, ModelFileError> {
    let mut names: Vec<String> = Vec::new();
    for (name, span) in top.strings("inputs")?.unwrap_or_default() {
        if names.len() == EXTRA_INPUTS {
            return Err(top.source.error(span, "inputs", format!("more than {EXTRA_INPUTS} extra inputs")));
        }
        // The name becomes a part of terms, of names of parameters and of headers.
        if name.trim() != name || name.is_empty() || name.contains(|c| is_command(c) || "\"\\,*^".contains(c)) {
            let shown = toml_string(name);
            let message = format!("{shown} is no name: a word without quotes, commas, `*`, `^` and control characters");
            return Err(top.source.error(span, "inputs", message));
        }
        let known = || axes.variables().iter().map(|v| v.name()).chain(names.iter().map(String::as_str));
        if known().chain(["1"]).any(|n| n == name) {
            let message = format!("`{name}` is a variable already: extra inputs need names of their own");
            return Err(top.source.error(span, "inputs", message));
        }
        names.push(name.to_owned());
    }
    Ok(names)
}

fn estimator(top: &Section) -> Result<EstimatorTuning, ModelFileError> {
    let Some(section) = top.section("estimator")? else { return Ok(EstimatorTuning::default()) };
    section.allow("key", ESTIMATOR_KEYS.iter().copied())?;
    let not_negative = |key: &str, dimension: Dimension| match section.number(key, dimension)? {
        Some(v) if v < 0.0 => Err(section.error(key, format!("`{key}` is {v}: expected zero or more"))),
        other => Ok(other),
    };
    let method = match section.string("method")? {
        Some(word) => word.parse::<Method>().map_err(|e| {
            let mut error = section.error("method", e.to_string());
            error.nearest = crate::core::words::nearest(word, Method::ALL.iter().map(|m| m.name())).map(Into::into);
            error
        })?,
        None => Method::default(),
    };
    Ok(EstimatorTuning {
        method,
        reaching_limit: section.positive("reaching_limit", Dimension::NUMBER)?,
        rejection_scale: section.positive("rejection_scale", Dimension::NUMBER)?.unwrap_or(1.0),
        prior_scale: section.positive("prior_scale", Dimension::NUMBER)?.unwrap_or(1.0),
        process_noise_scale: not_negative("process_noise_scale", Dimension::NUMBER)?.unwrap_or(1.0),
        adaptation_gain: not_negative("adaptation_gain", Dimension::NUMBER)?,
        start_window_s: not_negative("start_window", Dimension::TIME)?,
    })
}

fn reference(top: &Section, base: Base) -> Result<Reference, ModelFileError> {
    let standard = if base == Base::None { ReferenceValue::Given(0.0) } else { ReferenceValue::Trim };
    let Some(section) = top.section("reference")? else {
        let symmetric = ReferenceValue::Given(0.0);
        let (aileron, rudder) = (symmetric, symmetric);
        return Ok(Reference { alpha: standard, elevator: standard, aileron, rudder, altitude: None });
    };
    section.allow("key", ["alpha", "elevator", "aileron", "rudder", "altitude"].into_iter())?;
    let value = |key: &str| -> Result<ReferenceValue, ModelFileError> {
        match section.get(key).and_then(|v| v.get_ref().as_str()) {
            Some("trim") if base == Base::None => {
                Err(section.error(key, "\"trim\" needs a database (base = \"f16\", or the path of an aircraft): give a value or \"first_sample\""))
            }
            Some("trim") => Ok(ReferenceValue::Trim),
            Some("first_sample") => Ok(ReferenceValue::FirstSample),
            _ => Ok(section.number(key, Dimension::ANGLE)?.map_or(standard, ReferenceValue::Given)),
        }
    };
    // The trim of a database is symmetric.
    let lateral = |key: &str| match value(key)? {
        ReferenceValue::Trim => Ok(ReferenceValue::Given(0.0)),
        other => Ok(other),
    };
    Ok(Reference {
        alpha: value("alpha")?,
        elevator: value("elevator")?,
        aileron: lateral("aileron")?,
        rudder: lateral("rudder")?,
        altitude: section.number("altitude", Dimension::LENGTH)?,
    })
}
