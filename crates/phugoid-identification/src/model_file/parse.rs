//! From TOML text to a checked [`ModelFile`].

use std::collections::BTreeMap;

use phugoid_flight_data::quantity::Dimension;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::expected::expected;
use super::section::{Section, Source as Text};
use super::{
    AirDensity, AircraftData, Base, ChannelMapping, EstimatorSettings, InputHold, ModelFile, ModelFileError, Parameter,
    ProcessNoise, RateSpeed, Reference, ReferenceValue, Role, Source, Thrust,
};
use crate::axes::Axes;
use crate::method::Method;
use crate::output::{CHANNELS as OUTPUT_CHANNELS, Output, STATE_CHANNELS};
use crate::term::{Coefficient, EXTRA_INPUTS, Term, Variable};

const TOP_KEYS: [&str; 15] = [
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
];
const MORE_TOP_KEYS: [&str; 3] = ["re_reaching", "expected", "estimator"];
const ESTIMATOR_KEYS: [&str; 7] = [
    "method",
    "reaching_limit",
    "rejection_scale",
    "prior_scale",
    "process_noise_scale",
    "adaptation_gain",
    "start_window",
];
const AIRCRAFT_KEYS: [&str; 16] = [
    "rotor_momentum",
    "mass",
    "ixx",
    "iyy",
    "izz",
    "ixz",
    "wing_area",
    "mean_chord",
    "wing_span",
    "cg",
    "thrust",
    "thrust_inclination",
    "thrust_arm",
    "air_density",
    "reference_speed",
    "gravity",
];
const PARAMETER_KEYS: [&str; 5] = ["start", "prior_std", "bounds", "change_std", "fixed"];
/// Half widths of the ranges of the increments of the F-16 study, per radian (docs/theory.md), used as bounds where the
/// file gives none.
const F16_RANGES: [(&str, f64); 5] =
    [("dCm_alpha", 0.5), ("dCm_q", 6.0), ("dCL_alpha", 1.5), ("dCD_alpha", 0.5), ("dCm_elevator", 0.4)];
/// Light Dryden turbulence (1.1 m/s) at the speed and altitude of the F-16 study, and a share of the angular rates' own, by
/// [`Output::index`]. Side gusts are as strong as vertical ones at that altitude.
const LIGHT_TURBULENCE: [f64; STATE_CHANNELS] = [10.0 * 0.3048 * 0.3048, 3.4e-5, 3.4e-5, 0.0, 0.0, 1e-6, 1e-6, 1e-6];
/// Prior one sigma of the offsets in the coefficients. Those of the lateral moments are the pitching moment's over the span.
const OFFSET_STD: [(Coefficient, f64); 6] = [
    (Coefficient::Lift, 0.025),
    (Coefficient::Drag, 0.01),
    (Coefficient::PitchingMoment, 0.01),
    (Coefficient::SideForce, 0.01),
    (Coefficient::RollingMoment, 0.004),
    (Coefficient::YawingMoment, 0.004),
];

pub(super) fn parse(file: &str, text: &str) -> Result<ModelFile, ModelFileError> {
    let source = Text { file, text };
    let document = DeTable::parse(text).map_err(|error| {
        let message = format!("not valid TOML: {}", error.message());
        source.error(error.span().unwrap_or(0..0), "", message)
    })?;
    let top = Section { source: &source, path: String::new(), table: document.get_ref(), span: 0..0 };
    top.allow("key", TOP_KEYS.iter().chain(&MORE_TOP_KEYS).copied())?;
    let axes = axes(&top)?;

    let base = match top.word("base", &["none", "f16"])? {
        Some("f16") => Base::F16,
        _ => Base::None,
    };
    let extra_inputs = extra_inputs(&top, axes)?;
    let aircraft = aircraft(&top, base, axes)?;
    let rate_speed = match top.word("rate_speed", &["actual", "reference"])? {
        Some("reference") => RateSpeed::Reference,
        _ => RateSpeed::Actual,
    };
    let input = match top.word("input", &["held", "interpolated"])? {
        Some("interpolated") => InputHold::Interpolated,
        _ => InputHold::Held,
    };
    let outputs = outputs(&top, axes)?;
    let parameters = parameters(&top, axes, base, &extra_inputs, &outputs)?;
    let model = ModelFile {
        source: file.to_owned(),
        name: top.string("name")?.unwrap_or(file).to_owned(),
        axes,
        base,
        rate_speed,
        channels: channels(&top, &extra_inputs)?,
        outputs,
        noise: noise(&top, &outputs)?,
        expected: expected(&top, &parameters)?,
        parameters,
        reference: reference(&top, base)?,
        process_noise: process_noise(&top, axes)?,
        estimator: estimator(&top)?,
        input,
        re_reaching: top.boolean("re_reaching")?.unwrap_or(true),
        aircraft,
        extra_inputs,
    };
    check_reference_speed(&top, &model)?;
    Ok(model)
}

fn axes(top: &Section) -> Result<Axes, ModelFileError> {
    let Some(list) = top.strings("axes")? else { return Err(top.missing("axes", "axes = [\"longitudinal\"]")) };
    let (mut longitudinal, mut lateral) = (false, false);
    for (axis, span) in list {
        match top.choose("axes", axis, span, &Axes::WORDS)? {
            "lateral" => lateral = true,
            _ => longitudinal = true,
        }
    }
    match (longitudinal, lateral) {
        (true, false) => Ok(Axes::Longitudinal),
        (false, true) => Ok(Axes::LateralDirectional),
        (true, true) => Ok(Axes::All),
        (false, false) => Err(top.error("axes", "no axes: expected axes = [\"longitudinal\"], [\"lateral\"] or both")),
    }
}

/// The words of a model file for its axes, as it writes them.
fn written(axes: Axes) -> String {
    format!("axes = [{}]", axes.words().iter().map(|w| format!("\"{w}\"")).collect::<Vec<_>>().join(", "))
}

fn check_reference_speed(top: &Section, model: &ModelFile) -> Result<(), ModelFileError> {
    let uses_v_hat = model.parameters.iter().any(|p| match &p.role {
        Role::Term(_, term) => term.factors().iter().any(|(i, _)| *i == Variable::Airspeed.index()),
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
        let known = || axes.variables().iter().map(|v| v.name()).chain(names.iter().map(String::as_str));
        if known().chain(["1"]).any(|n| n == name) {
            let message = format!("`{name}` is a variable already: extra inputs need names of their own");
            return Err(top.source.error(span, "inputs", message));
        }
        names.push(name.to_owned());
    }
    Ok(names)
}

/// A constant, or `{ channel = "name" }`.
fn source_of(section: &Section, key: &str, dimension: Dimension) -> Result<Option<Source>, ModelFileError> {
    match section.get(key).map(Spanned::get_ref) {
        Some(DeValue::Table(_)) => {
            let Some(inner) = section.section(key)? else { return Ok(None) };
            inner.allow("key", ["channel"].into_iter())?;
            let channel = inner.string("channel")?.ok_or_else(|| inner.missing("channel", "the name of a channel"))?;
            Ok(Some(Source::Channel(channel.to_owned())))
        }
        _ => Ok(section.number(key, dimension)?.map(Source::Constant)),
    }
}

fn required_source(section: &Section, key: &str, dimension: Dimension) -> Result<Source, ModelFileError> {
    let found = source_of(section, key, dimension)?;
    let found = found.ok_or_else(|| {
        section.missing(key, &format!("a quantity in {}, or {{ channel = \"{key}\" }}", dimension.si_unit()))
    })?;
    match found {
        Source::Constant(v) if v <= 0.0 => Err(section.error(key, format!("`{key}` is {v}: expected more than zero"))),
        other => Ok(other),
    }
}

fn aircraft(top: &Section, base: Base, axes: Axes) -> Result<AircraftData, ModelFileError> {
    let section = top.section("aircraft")?.ok_or_else(|| top.missing("aircraft", "a table [aircraft]"))?;
    section.allow("key", AIRCRAFT_KEYS.iter().copied())?;
    let text = |key: &str| section.get(key).and_then(|v| v.get_ref().as_str());
    let thrust = match text("thrust") {
        Some("trim") if base == Base::None => {
            return Err(section.error("thrust", "thrust = \"trim\" needs a database (base = \"f16\") to trim"));
        }
        Some("trim") => Thrust::Trim,
        // The lateral-directional motion takes the measured specific forces in its place.
        None if section.get("thrust").is_none() && !axes.has_longitudinal() => Thrust::Known(Source::Constant(0.0)),
        _ => Thrust::Known(source_of(&section, "thrust", Dimension::FORCE)?.ok_or_else(|| {
            section
                .missing("thrust", "a force (0 for a glider), { channel = \"thrust\" } or, with a database, \"trim\"")
        })?),
    };
    let air_density = match text("air_density") {
        Some("standard_atmosphere") => AirDensity::StandardAtmosphere,
        Some("book_atmosphere") => AirDensity::BookAtmosphere,
        Some(word) if word.starts_with(|c: char| c.is_ascii_alphabetic()) => {
            let words = ["standard_atmosphere", "book_atmosphere"];
            let span = section.get("air_density").map_or(section.span.clone(), Spanned::span);
            section.choose("air_density", word, span, &words)?;
            AirDensity::StandardAtmosphere
        }
        _ => AirDensity::Known(required_source(&section, "air_density", Dimension::DENSITY)?),
    };
    let cg = section.number("cg", Dimension::NUMBER)?;
    if base != Base::None && cg.is_none() {
        return Err(section.missing("cg", "the centre of gravity as a fraction of the mean chord, for the database"));
    }
    // What only the lateral axes need may be there for all: one description of the aircraft serves every file.
    let lateral = |key: &str, found: bool, expected: &str| {
        if found || !axes.has_lateral() {
            return Ok(());
        }
        Err(section.missing(key, &format!("{expected}, for the lateral axes ({})", written(axes))))
    };
    let wing_span = section.positive("wing_span", Dimension::LENGTH)?;
    lateral("wing_span", wing_span.is_some(), "the span in m or with a unit")?;
    let inertia = |key: &str| -> Result<Option<Source>, ModelFileError> {
        let found = source_of(&section, key, Dimension::INERTIA)?;
        if let Some(Source::Constant(v)) = found
            && v <= 0.0
            && key != "ixz"
        {
            return Err(section.error(key, format!("`{key}` is {v}: expected more than zero")));
        }
        let expected = format!("a quantity in kg*m^2, or {{ channel = \"{key}\" }}");
        lateral(key, found.is_some(), &expected)?;
        Ok(found)
    };
    let (ixx, izz, ixz) = (inertia("ixx")?, inertia("izz")?, inertia("ixz")?);
    if let (Some(Source::Constant(x)), Some(Source::Constant(z)), Some(Source::Constant(xz))) = (&ixx, &izz, &ixz)
        && xz * xz >= x * z
    {
        let message = format!("`ixz` is {xz}: its square must be below ixx izz = {}", x * z);
        return Err(section.error("ixz", message));
    }
    Ok(AircraftData {
        ixx,
        izz,
        ixz,
        wing_span,
        mass: required_source(&section, "mass", Dimension::MASS)?,
        iyy: required_source(&section, "iyy", Dimension::INERTIA)?,
        wing_area: section.required_positive("wing_area", Dimension::AREA)?,
        mean_chord: section.required_positive("mean_chord", Dimension::LENGTH)?,
        cg,
        thrust,
        thrust_inclination: section.number("thrust_inclination", Dimension::ANGLE)?.unwrap_or(0.0),
        thrust_arm: section.number("thrust_arm", Dimension::LENGTH)?.unwrap_or(0.0),
        air_density,
        rotor_momentum: section.number("rotor_momentum", Dimension::ANGULAR_MOMENTUM)?.unwrap_or(0.0),
        reference_speed: section.positive("reference_speed", Dimension::SPEED)?,
        gravity: section.positive("gravity", Dimension::ACCELERATION)?.unwrap_or(9.80665),
    })
}

/// Channels that a model can use; only these can be mapped.
pub(crate) const CHANNELS: [&str; 28] = [
    "time",
    "true_airspeed",
    "alpha",
    "beta",
    "phi",
    "theta",
    "p",
    "q",
    "r",
    "ax",
    "ay",
    "az",
    "pdot",
    "qdot",
    "rdot",
    "elevator",
    "aileron",
    "rudder",
    "thrust",
    "altitude",
    "air_density",
    "mass",
    "ixx",
    "iyy",
    "izz",
    "ixz",
    "dynamic_pressure",
    "throttle",
];

fn channels(top: &Section, extra: &[String]) -> Result<BTreeMap<String, ChannelMapping>, ModelFileError> {
    let Some(section) = top.section("channels")? else { return Ok(BTreeMap::new()) };
    section.allow("channel", CHANNELS.iter().copied().chain(extra.iter().map(String::as_str)))?;
    let mut channels = BTreeMap::new();
    for (key, _) in section.keys() {
        let mapping = match section.get(key).map(Spanned::get_ref) {
            Some(DeValue::Table(_)) => {
                let Some(inner) = section.section(key)? else { continue };
                inner.allow("key", ["header", "unit", "scale"].into_iter())?;
                let header =
                    inner.string("header")?.ok_or_else(|| inner.missing("header", "the header in your file"))?;
                ChannelMapping {
                    header: header.to_owned(),
                    unit: inner.string("unit")?.map(str::to_owned),
                    scale: inner.number("scale", Dimension::NUMBER)?.unwrap_or(1.0),
                }
            }
            _ => {
                let header = section.string(key)?.unwrap_or_default();
                ChannelMapping { header: header.to_owned(), unit: None, scale: 1.0 }
            }
        };
        channels.insert(key.to_owned(), mapping);
    }
    Ok(channels)
}

fn outputs(top: &Section, axes: Axes) -> Result<[bool; OUTPUT_CHANNELS], ModelFileError> {
    let mut outputs = [false; OUTPUT_CHANNELS];
    let Some(list) = top.strings("outputs")? else {
        // What the motion is usually measured by; angular accelerations only on request.
        for output in axes.outputs().iter().filter(|o| !o.is_angular_acceleration()) {
            outputs[output.index()] = true;
        }
        return Ok(outputs);
    };
    let names: Vec<&'static str> = axes.outputs().iter().map(|o| o.name()).collect();
    for (name, span) in list {
        if let Some(other) = Output::from_name(name)
            && axes.row(other).is_none()
        {
            let message = format!("`{name}` is no output of the {} motion: {}", axes.name(), other_axes(axes));
            return Err(top.source.error(span, "outputs", message));
        }
        let name = top.choose("outputs", name, span, &names)?;
        if let Some(output) = Output::from_name(name) {
            outputs[output.index()] = true;
        }
    }
    // The state is started from its own measurements; a flow angle, for which many aircraft have no vane, from nearly straight
    // and level flight.
    for state in axes.states() {
        let dispensable = matches!(state, Output::Alpha | Output::Beta);
        if !dispensable && !outputs[state.index()] {
            return Err(
                top.error("outputs", format!("`{}` must be measured: the model is started from it", state.name()))
            );
        }
    }
    Ok(outputs)
}

/// What to do about something that belongs to the other axes.
fn other_axes(axes: Axes) -> String {
    format!("write axes = [\"longitudinal\", \"lateral\"] for both (the file has {}), or take it out", written(axes))
}

fn noise(top: &Section, outputs: &[bool; OUTPUT_CHANNELS]) -> Result<[Option<f64>; OUTPUT_CHANNELS], ModelFileError> {
    let mut noise = [None; OUTPUT_CHANNELS];
    let Some(section) = top.section("noise")? else { return Ok(noise) };
    let measured: Vec<&str> = Output::ALL.iter().filter(|o| outputs[o.index()]).map(|o| o.name()).collect();
    section.allow("output", measured.iter().copied())?;
    for output in Output::ALL {
        let name = output.name();
        if section.get(name).and_then(|v| v.get_ref().as_str()) == Some("measured") {
            continue;
        }
        noise[output.index()] = section.positive(name, output.dimension())?;
    }
    Ok(noise)
}

fn process_noise(top: &Section, axes: Axes) -> Result<ProcessNoise, ModelFileError> {
    let Some(section) = top.section("process_noise")? else {
        return Ok(ProcessNoise { density: LIGHT_TURBULENCE, adaptive: true });
    };
    section.allow("key", axes.states().iter().map(|o| o.name()).chain(["adaptive"]))?;
    let mut density = [0.0; STATE_CHANNELS];
    for (slot, output) in density.iter_mut().zip(Output::ALL) {
        let dimension = match output {
            Output::TrueAirspeed => Dimension::SPEED_NOISE,
            Output::RollRate | Output::PitchRate | Output::YawRate => Dimension::ANGULAR_RATE_NOISE,
            _ => Dimension::ANGLE_NOISE,
        };
        *slot = section.number(output.name(), dimension)?.unwrap_or(0.0);
        if *slot < 0.0 {
            return Err(section.error(output.name(), format!("`{}` is negative", output.name())));
        }
    }
    Ok(ProcessNoise { density, adaptive: section.boolean("adaptive")?.unwrap_or(false) })
}

fn estimator(top: &Section) -> Result<EstimatorSettings, ModelFileError> {
    let Some(section) = top.section("estimator")? else { return Ok(EstimatorSettings::default()) };
    section.allow("key", ESTIMATOR_KEYS.iter().copied())?;
    let not_negative = |key: &str, dimension: Dimension| match section.number(key, dimension)? {
        Some(v) if v < 0.0 => Err(section.error(key, format!("`{key}` is {v}: expected zero or more"))),
        other => Ok(other),
    };
    let method = match section.string("method")? {
        Some(word) => word.parse::<Method>().map_err(|e| {
            let mut error = section.error("method", e.to_string());
            error.nearest = crate::words::nearest(word, Method::ALL.iter().map(|m| m.name())).map(Into::into);
            error
        })?,
        None => Method::default(),
    };
    Ok(EstimatorSettings {
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
                Err(section.error(key, "\"trim\" needs a database (base = \"f16\"): give a value or \"first_sample\""))
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

/// Refuses a flight variable that the motion cannot evaluate.
fn check_variables(term: &Term, axes: Axes) -> Result<(), String> {
    let rate = Variable::AlphaRate;
    if term.factors().iter().any(|(index, power)| *index == rate.index() && *power > 1) {
        return Err(format!("`{}` enters to the first power only: the motion depends on it in turn", rate.name()));
    }
    let variables = term.factors().iter().filter_map(|(index, _)| Variable::ALL.get(*index));
    let Some(foreign) = variables.into_iter().find(|v| !axes.variables().contains(v)) else { return Ok(()) };
    let name = foreign.name();
    Err(if *foreign == Variable::AlphaRate {
        format!(
            "`{name}` is a variable of the longitudinal motion alone: leave it out. The coefficient of `q_hat` is then the \
             effective derivative, that with respect to q and to the rate of alpha together"
        )
    } else {
        format!(
            "`{name}` is no variable of the {} motion: {}; a recorded channel of this name may stand under inputs",
            axes.name(),
            other_axes(axes)
        )
    })
}

fn parameters(
    top: &Section,
    axes: Axes,
    base: Base,
    extra: &[String],
    outputs: &[bool; OUTPUT_CHANNELS],
) -> Result<Vec<Parameter>, ModelFileError> {
    let coefficients =
        top.section("coefficients")?.ok_or_else(|| top.missing("coefficients", "a table [coefficients]"))?;
    coefficients.allow("coefficient", Coefficient::ALL.iter().map(|c| c.symbol()).chain(["offsets"]))?;

    // Name, role, dimension and where it was asked for, in the order of the file.
    let mut wanted = Vec::new();
    for (symbol, _) in coefficients.keys() {
        let Some(coefficient) = Coefficient::ALL.into_iter().find(|c| c.symbol() == symbol) else { continue };
        if !axes.coefficients().contains(&coefficient) {
            let message = format!("`{symbol}` is no coefficient of the {} motion: {}", axes.name(), other_axes(axes));
            return Err(coefficients.error(symbol, message));
        }
        for (text, span) in coefficients.strings(symbol)?.unwrap_or_default() {
            let path = format!("coefficients.{symbol}");
            let term = Term::parse(text, extra).map_err(|message| top.source.error(span.clone(), &path, message))?;
            check_variables(&term, axes).map_err(|message| top.source.error(span.clone(), &path, message))?;
            let name = term.parameter_name(coefficient, base != Base::None, extra);
            if wanted.iter().any(|(n, _)| *n == name) {
                return Err(top.source.error(span, &path, format!("term `{text}` is there twice")));
            }
            wanted.push((name, Role::Term(coefficient, term)));
        }
    }
    if wanted.is_empty() {
        return Err(coefficients.missing("CL", "at least one term, such as Cm = [\"alpha\", \"q_hat\"]"));
    }
    if coefficients.boolean("offsets")?.unwrap_or(false) {
        for coefficient in axes.coefficients().iter().copied() {
            // A coefficient with a constant term of its own needs no other one.
            let own = |r: &Role| matches!(r, Role::Term(c, term) if *c == coefficient && term.is_constant());
            if !wanted.iter().any(|(_, role)| own(role)) {
                wanted.push((format!("offset_{}", coefficient.symbol()), Role::Offset(coefficient)));
            }
        }
    }
    let names: Vec<String> = wanted.iter().map(|(name, _)| name.clone()).collect();
    let priors = top.section("parameters")?;
    if let Some(priors) = &priors {
        priors.allow("parameter", names.iter().map(String::as_str))?;
    }
    let mut parameters = Vec::with_capacity(wanted.len() + OUTPUT_CHANNELS);
    for (name, role) in wanted {
        let section = match &priors {
            Some(priors) => priors.section(&name)?,
            None => None,
        };
        parameters.push(parameter(name, role, section, priors.as_ref().unwrap_or(&coefficients), base)?);
    }
    if let Some(biases) = top.section("biases")? {
        let measured: Vec<&str> = Output::ALL.iter().filter(|o| outputs[o.index()]).map(|o| o.name()).collect();
        biases.allow("output", measured.iter().copied())?;
        for output in Output::ALL {
            if let Some(prior_std) = biases.positive(output.name(), output.dimension())? {
                parameters.push(Parameter {
                    name: format!("bias_{}", output.name()),
                    role: Role::Bias(output),
                    start: 0.0,
                    prior_std,
                    bounds: None,
                    change_std: None,
                    fixed: false,
                });
            }
        }
    }
    Ok(parameters)
}

fn parameter(
    name: String,
    role: Role,
    section: Option<Section>,
    parent: &Section,
    base: Base,
) -> Result<Parameter, ModelFileError> {
    let standard_range = F16_RANGES.iter().find(|(n, _)| base == Base::F16 && *n == name).map(|(_, r)| *r);
    let standard_std = match role {
        Role::Offset(c) => OFFSET_STD.iter().find(|(o, _)| *o == c).map(|(_, s)| *s),
        _ => None,
    };
    let (mut start, mut prior_std, mut bounds, mut change_std, mut fixed) = (None, None, None, None, false);
    if let Some(section) = &section {
        section.allow("key", PARAMETER_KEYS.iter().copied())?;
        start = section.number("start", Dimension::NUMBER)?;
        prior_std = section.positive("prior_std", Dimension::NUMBER)?;
        bounds = section.pair("bounds")?;
        change_std = section.positive("change_std", Dimension::NUMBER)?;
        fixed = section.boolean("fixed")?.unwrap_or(false);
    }
    let place = section.as_ref().unwrap_or(parent);
    let bounds = bounds.or(if prior_std.is_none() { standard_range.map(|r| [-r, r]) } else { None });
    // Bounds R wide on either side stand for a prior of R/2.
    let prior_std = prior_std.or(bounds.map(|[low, high]| (high - low) / 4.0)).or(standard_std);
    let start = match (start, base, &role) {
        (Some(start), ..) => start,
        (None, Base::None, Role::Term(..)) => {
            return Err(
                place.missing("start", &format!("the start value of `{name}`, e.g. [parameters.{name}] start = 0"))
            );
        }
        _ => 0.0,
    };
    let prior_std = match prior_std {
        Some(std) => std,
        None if fixed => 0.0,
        None => {
            let expected = format!("bounds = [lower, upper] or prior_std of `{name}` under [parameters.{name}]");
            return Err(place.missing("bounds", &expected));
        }
    };
    if let Some([low, high]) = bounds
        && !(low..=high).contains(&start)
    {
        return Err(place.error("start", format!("start {start} of `{name}` is outside its bounds [{low}, {high}]")));
    }
    Ok(Parameter { name, role, start, prior_std, bounds, change_std, fixed })
}
