//! Options of one estimation, and the largest number of parameters.

use std::collections::BTreeMap;

use phugoid_flight_data::record::Record;

use crate::core::axes::Axes;
pub use crate::core::method::Method;

/// Parameters, sensor biases included, that this build has room for at most.
pub const CAPACITY: usize = 48;

/// Parameters, sensor biases included, that this build has room for with these axes. The longitudinal motion alone has
/// a smaller room: what is not there costs neither time nor memory.
pub const fn capacity(axes: Axes) -> usize {
    match axes {
        Axes::Longitudinal => 24,
        Axes::LateralDirectional | Axes::All => CAPACITY,
    }
}

/// When terms that the model lacks are tried (`estimation::Offer`): one run over the record per candidate.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum OfferTerms {
    /// No further terms are tried. This is the default.
    #[default]
    Never,
    /// Where changes were adopted, parameters wander, or residuals are coloured.
    WithReason,
    /// In every flight in which anything moved.
    Always,
}

/// Settings of one estimation beside those of the model file. The default changes nothing of the model file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct EstimateOptions {
    /// Estimator; none: as the model file says.
    pub method: Option<Method>,
    /// Look for sudden changes of the parameters; none: as the model file says.
    pub change_detection: Option<bool>,
    /// Time from which times of convergence count, s, where the record is a part of one that began earlier; none: its own
    /// first sample.
    pub start_s: Option<f64>,
    /// Times (s, increasing) at which the parameters are known to change, from another source than the record: they are
    /// opened again before the first sample not earlier than each. Methods without change detection take no notice.
    pub known_changes_s: Vec<f64>,
    /// True values by parameter name, where the flight was simulated.
    pub truth: BTreeMap<String, f64>,
    /// Further records of the same aircraft; a batch method fits all together. A causal method takes none.
    pub further: Vec<Record>,
    /// A record that the estimated parameters are tried on, with a batch method.
    pub predict: Option<Record>,
    /// Whether terms that the model lacks are tried beside it; a causal method only.
    pub offer: OfferTerms,
}
