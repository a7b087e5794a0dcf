//! Why models do not make a vehicle.

/// Why models do not make a vehicle.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum VehicleError {
    /// No model has an output of this name.
    #[error("no model has a variable named {name}")]
    Missing {
        /// Standard name of the variable.
        name: String,
    },
    /// An input is neither a quantity of the flight, nor an output of another model, nor given, and has no value of its own.
    #[error("the input {name} is no quantity of the flight that is known, no output of a model before, and not given")]
    Open {
        /// Name of the input.
        name: String,
    },
    /// No model has a variable of this name that can be set.
    #[error("no model has a variable named {name} that can be set")]
    NotSettable {
        /// Name that was given.
        name: String,
    },
    /// The unit of a variable is not known or of another kind than the quantity.
    #[error("{name}: the unit `{units}` does not suit it")]
    Unit {
        /// Name of the variable.
        name: String,
        /// Its unit.
        units: String,
    },
    /// Mass or inertia are not positive.
    #[error("mass or inertia are not positive")]
    Mass,
}
