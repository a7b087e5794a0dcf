//! The key `axes`, and messages about what belongs to other axes.

use crate::core::axes::Axes;
use crate::model_file::error::ModelFileError;
use crate::model_file::section::Section;

/// The axes that the file asks for; at least one.
pub(super) fn axes(top: &Section) -> Result<Axes, ModelFileError> {
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
pub(super) fn written(axes: Axes) -> String {
    format!("axes = [{}]", axes.words().iter().map(|w| format!("\"{w}\"")).collect::<Vec<_>>().join(", "))
}

/// The advice in messages about a key or word that belongs to the other axes.
pub(super) fn other_axes(axes: Axes) -> String {
    format!("write axes = [\"longitudinal\", \"lateral\"] for both (the file has {}), or take it out", written(axes))
}
