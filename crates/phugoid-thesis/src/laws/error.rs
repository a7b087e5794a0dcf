use core::fmt;

/// Why the law cannot be set up.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ThesisError {
    /// The unknown parameter is not one of the model's.
    Parameter {
        /// Index that was asked for, counted from 0.
        index: usize,
        /// Number of parameters that the model has.
        count: usize,
    },
    /// Bounds out of order, not finite, or of both signs for the printed form.
    Bounds {
        /// Lower bound that was given, in the parameter's unit.
        lower: f64,
        /// Upper bound that was given, in the parameter's unit.
        upper: f64,
    },
    /// A surface channel names a state or output that does not exist, has no positive scale, or mixes measured and
    /// integrated derivatives.
    Channel {
        /// Index of the first channel that is wrong, counted from 0.
        index: usize,
    },
    /// No output measures a state, and the law needs all of them.
    NotMeasured {
        /// Index of the state that is not measured, counted from 0.
        state: usize,
    },
    /// `lambda` or `eta` or a step is not a positive number.
    Setting {
        /// Name of the setting, as the field is called.
        name: &'static str,
        /// Value that was given; it may be NaN.
        value: f64,
    },
}

impl fmt::Display for ThesisError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Parameter { index, count } => {
                write!(f, "parameter {index} is asked for, the model has {count} (count from 0)")
            }
            Self::Bounds { lower, upper } => write!(
                f,
                "bounds {lower} to {upper}: need finite lower < upper, and for the printed form both of one sign (its \
                 gain contains sqrt(upper/lower))"
            ),
            Self::Channel { index } => write!(
                f,
                "surface channel {index}: state and output must exist, the scale be positive, and all channels have \
                 measured derivatives or none"
            ),
            Self::NotMeasured { state } => {
                write!(f, "no output measures state {state} (count from 0): the law needs every state measured")
            }
            Self::Setting { name, value } => write!(f, "setting {name} must be positive and finite, found {value}"),
        }
    }
}

impl core::error::Error for ThesisError {}
