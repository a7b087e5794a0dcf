//! The measured outputs and their noise: `outputs`, `[noise]`, `[process_noise]`.

use super::axes::other_axes;
use crate::core::axes::Axes;
use crate::core::output::{CHANNELS as OUTPUT_CHANNELS, Output, STATE_CHANNELS};
use crate::model_file::Base;
use crate::model_file::error::ModelFileError;
use crate::model_file::section::Section;
use crate::model_file::settings::ProcessNoise;

/// Light Dryden turbulence (1.1 m/s) at the speed and altitude of the F-16 study, and a share of the angular rates'
/// own, by [`Output::index`]. Side gusts are as strong as vertical ones at that altitude.
pub(crate) const LIGHT_TURBULENCE: [f64; STATE_CHANNELS] =
    [10.0 * 0.3048 * 0.3048, 3.4e-5, 3.4e-5, 0.0, 0.0, 1e-6, 1e-6, 1e-6];

pub(super) fn outputs(top: &Section, axes: Axes) -> Result<[bool; OUTPUT_CHANNELS], ModelFileError> {
    let mut outputs = [false; OUTPUT_CHANNELS];
    let Some(list) = top.strings("outputs")? else {
        // The usual outputs of the motion; angular accelerations only on request, because few recorders have them.
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
    // The state is started from its own measurements; a flow angle, for which many aircraft have no vane, from nearly
    // straight and level flight.
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

pub(super) fn noise(
    top: &Section,
    outputs: &[bool; OUTPUT_CHANNELS],
) -> Result<[Option<f64>; OUTPUT_CHANNELS], ModelFileError> {
    let mut noise = [None; OUTPUT_CHANNELS];
    let Some(section) = top.section("noise")? else { return Ok(noise) };
    let measured: Vec<&str> = Output::ALL.iter().filter(|o| outputs[o.index()]).map(|o| o.name()).collect();
    section.allow("output", measured.iter().copied().chain(["learn"]))?;
    for output in Output::ALL {
        let name = output.name();
        if section.get(name).and_then(|v| v.get_ref().as_str()) == Some("measured") {
            continue;
        }
        noise[output.index()] = section.positive(name, output.dimension())?;
    }
    Ok(noise)
}

/// Whether noise levels are learnt in flight: as `learn` says, else where the noise of a measured output is not given.
/// Increments on a database keep what is given or measured: where a gust sets in suddenly, filters that have learnt calm
/// air take it for a change of the parameters (in at least 19 of 40 flights of a simulated F-16 in gusts).
pub(super) fn noise_learning(
    top: &Section,
    base: Base,
    outputs: &[bool; OUTPUT_CHANNELS],
    noise: &[Option<f64>; OUTPUT_CHANNELS],
) -> Result<bool, ModelFileError> {
    let stated = match top.section("noise")? {
        Some(section) => section.boolean("learn")?,
        None => None,
    };
    let unknown = outputs.iter().zip(noise).any(|(measured, given)| *measured && given.is_none());
    Ok(stated.unwrap_or(base == Base::None && unknown))
}

pub(super) fn process_noise(top: &Section, axes: Axes) -> Result<ProcessNoise, ModelFileError> {
    let Some(section) = top.section("process_noise")? else {
        return Ok(ProcessNoise { density: LIGHT_TURBULENCE, adaptive: true });
    };
    section.allow("key", axes.states().iter().map(|o| o.name()).chain(["adaptive"]))?;
    let mut density = [0.0; STATE_CHANNELS];
    for (slot, output) in density.iter_mut().zip(Output::ALL) {
        *slot = section.number(output.name(), output.density_dimension())?.unwrap_or(0.0);
        if *slot < 0.0 {
            return Err(section.error(output.name(), format!("`{}` is negative", output.name())));
        }
    }
    Ok(ProcessNoise { density, adaptive: section.boolean("adaptive")?.unwrap_or(false) })
}
