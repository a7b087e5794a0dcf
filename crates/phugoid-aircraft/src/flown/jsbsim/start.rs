//! An aircraft of JSBSim as it begins.

use crate::flown::error::FlownError;
use crate::flown::options::FlownOptions;
use crate::jsbsim::{Aircraft, Evaluator};

/// An evaluator with the properties of the options.
pub(super) fn started<'a>(aircraft: &'a Aircraft, options: &FlownOptions) -> Result<Evaluator<'a>, FlownError> {
    let mut evaluator = Evaluator::new(aircraft);
    evaluator.set("gear/gear-pos-norm", 0.0);
    for engine in 0..aircraft.engines().len() {
        // Propellers of constant speed at their fastest.
        evaluator.set(&format!("fcs/advance-pos-norm[{engine}]"), 1.0);
    }
    for (name, value) in &options.properties {
        if !value.is_finite() {
            return Err(FlownError::Number { what: "a property", value: *value, expected: "a finite number" });
        }
        if !evaluator.set(name, *value) {
            return Err(FlownError::Property { name: name.clone() });
        }
    }
    Ok(evaluator)
}
