//! An aircraft of JSBSim as it begins.

use super::control::sensed::{STICKS, is_sensed};
use super::drive::engines_flown;
use crate::flown::error::FlownError;
use crate::flown::options::FlownOptions;
use crate::flown::surface::Surface;
use crate::jsbsim::{Aircraft, Evaluator};

/// Most names in a message.
const MOST_NAMED: usize = 24;
/// Metres in a foot.
const FOOT: f64 = 0.3048;

/// Properties by their indices, with values.
pub(super) type Values = Vec<(usize, f64)>;

/// An evaluator with the properties of the options, and those that only channels read, which are set when these take over.
///
/// # Errors
/// [`FlownError`]: a property that is not there, that has another source, or that nothing reads.
pub(super) fn started<'a>(
    aircraft: &'a Aircraft,
    surfaces: &[Surface; 3],
    options: &FlownOptions,
) -> Result<(Evaluator<'a>, Values), FlownError> {
    let mut evaluator = Evaluator::new(aircraft);
    let mut engaged = Values::new();
    evaluator.set("gear/gear-pos-norm", 0.0);
    evaluator.set("accelerations/gravity-ft_sec2", options.gravity / FOOT);
    for engine in 0..aircraft.engines().len() {
        // Propellers of constant speed at their fastest.
        evaluator.set(&format!("fcs/advance-pos-norm[{engine}]"), 1.0);
    }
    for (name, value) in &options.properties {
        if !value.is_finite() {
            return Err(FlownError::Number { what: "a property", value: *value, expected: "a finite number" });
        }
        let settable = || named(settable(aircraft, surfaces, options));
        let Some(index) = aircraft.property(name) else {
            return Err(FlownError::Property { name: name.clone(), settable: settable() });
        };
        if !is_for_channels(aircraft, options, index) {
            if let Some(why) = source_of(aircraft, surfaces, options, index) {
                return Err(FlownError::WithoutEffect { name: name.clone(), why, settable: settable() });
            }
            evaluator.set_index(index, *value);
        } else {
            engaged.push((index, *value));
        }
    }
    Ok((evaluator, engaged))
}

/// Whether a property begins otherwise than the files say, and stays so: gear and the levers of propellers.
pub(super) fn is_begun(name: &str) -> bool {
    name == "gear/gear-pos-norm" || name.starts_with("fcs/advance-pos-norm")
}

/// Whether a property is one that channels read and nobody else reads or makes, where channels run.
fn is_for_channels(aircraft: &Aircraft, options: &FlownOptions, index: usize) -> bool {
    let name = aircraft.properties().nth(index).unwrap_or_default();
    options.flight_control
        && aircraft.channels_read()[index]
        && !aircraft.is_computed(index)
        && !aircraft.is_written(index)
        && !is_stick(name)
        && !is_sensed(name)
        && !is_read(aircraft, options, index)
}

/// Whether a property is where the command of a surface goes.
fn is_stick(name: &str) -> bool {
    STICKS.contains(&name)
}

/// Whether aerodynamics, engines or masses read a property.
fn is_read(aircraft: &Aircraft, options: &FlownOptions, index: usize) -> bool {
    let name = aircraft.properties().nth(index).unwrap_or_default();
    let mut read = aircraft.aerodynamics_read();
    read.extend(aircraft.masses_read());
    if engines_flown(aircraft, options.thrust).is_some() {
        read.extend(aircraft.engines_read());
    }
    read.contains(&name) || aircraft.written_along(index).any(|other| read.contains(&other))
}

/// Why a property cannot be set, if that is so.
fn source_of(
    aircraft: &Aircraft,
    surfaces: &[Surface; 3],
    options: &FlownOptions,
    index: usize,
) -> Option<&'static str> {
    let engines = engines_flown(aircraft, options.thrust);
    if aircraft.is_computed(index) {
        return Some("its value is computed");
    }
    if surfaces.iter().any(|surface| surface.sets(index)) || linked_to_surface(aircraft, surfaces, index) {
        return Some("it follows the angle of a surface");
    }
    if engines.as_ref().is_some_and(|(throttles, _)| throttles.contains(&index)) {
        return Some("it follows the throttle");
    }
    if is_read(aircraft, options, index) || is_for_channels(aircraft, options, index) {
        return None;
    }
    let name = aircraft.properties().nth(index).unwrap_or_default();
    Some(match options.flight_control {
        false => "neither aerodynamics nor engines nor masses read it, and flight control does not run",
        true if is_stick(name) => "it follows the commands of the flight",
        true if is_sensed(name) => "it follows the motion",
        true if aircraft.is_written(index) => "a channel writes it",
        true => "neither aerodynamics nor engines nor masses nor channels read it",
    })
}

/// Whether setting a property would move what a surface moves.
fn linked_to_surface(aircraft: &Aircraft, surfaces: &[Surface; 3], index: usize) -> bool {
    let mut along = aircraft.written_along(index).filter_map(|name| aircraft.property(name));
    along.any(|other| surfaces.iter().any(|surface| surface.sets(other)))
}

/// Names of the properties that can be set.
fn settable<'a>(aircraft: &'a Aircraft, surfaces: &[Surface; 3], options: &FlownOptions) -> Vec<&'a str> {
    let names = aircraft.properties().enumerate();
    names.filter(|(index, _)| source_of(aircraft, surfaces, options, *index).is_none()).map(|(_, name)| name).collect()
}

/// Names in a row, the first of many.
fn named(mut names: Vec<&str>) -> String {
    // What the files describe, such as tanks, flaps and masses, goes before sizes that are mostly left alone.
    names.sort_by_key(|name| (name.starts_with("metrics/"), name.starts_with("atmosphere/"), *name));
    let more = names.len().saturating_sub(MOST_NAMED);
    let mut text = names.into_iter().take(MOST_NAMED).collect::<Vec<_>>().join(", ");
    if text.is_empty() {
        text.push_str("nothing");
    }
    if more > 0 {
        text.push_str(&format!(" and {more} more"));
    }
    text
}
