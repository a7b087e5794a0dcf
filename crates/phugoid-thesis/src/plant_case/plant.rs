//! The four proof-of-concept plants, by name, and those of a user's own.

use crate::plants::{self, OwnPlant};
use phugoid_estimators::Model;
use serde::Deserialize;

use phugoid_simulation::quantity::Frequency;

/// One of the four proof-of-concept plants, with its constants, or a plant of one's own.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(tag = "type", rename_all = "kebab-case", deny_unknown_fields)]
pub enum Plant {
    /// `x' = -a x + u`.
    FirstOrder {},
    /// `x' = -a sin(y) x + B u`, `y' = C y x + sin(w t)`.
    FirstOrderNonlinear {
        /// `B`, per unit of the input.
        input_gain: f64,
        /// `C`, per unit of `x` and second.
        coupling: f64,
        /// Frequency of the forcing `sin(w t)`.
        forcing: Frequency,
    },
    /// `x'' = -a2 x' - a1 x + u`.
    SecondOrder {},
    /// `x'' = -a2 x' - a1 x^2 + u`.
    SecondOrderNonlinear {},
    /// A plant given by formulas.
    Own(OwnPlant),
}

/// Room for parameters in the models of the plants: none has more than two.
pub(crate) const ROOM: usize = 2;

/// What is to be done with a plant, whatever its size.
pub(crate) trait Visit {
    /// What comes of it.
    type Output;

    /// Does it with a model of `N` states, `N` measured states and one derivative as outputs, one or two parameters
    /// and `I` known inputs.
    fn visit<M, const N: usize, const R: usize, const I: usize>(self, model: &M) -> Self::Output
    where
        M: Model<N, R, ROOM, Input = [f64; I]> + Copy + Sync;
}

impl Plant {
    /// Names of the unknown parameters, in the order of all results.
    pub fn parameters(&self) -> Vec<&str> {
        match self {
            Self::FirstOrder {} | Self::FirstOrderNonlinear { .. } => vec!["a"],
            Self::SecondOrder {} | Self::SecondOrderNonlinear {} => vec!["a1", "a2"],
            Self::Own(plant) => plant.parameters(),
        }
    }

    /// Names of the states.
    pub fn states(&self) -> Vec<&str> {
        match self {
            Self::FirstOrder {} => vec!["x"],
            Self::FirstOrderNonlinear { .. } => vec!["x", "y"],
            Self::SecondOrder {} | Self::SecondOrderNonlinear {} => vec!["x", "x'"],
            Self::Own(plant) => plant.states(),
        }
    }

    /// Its equation, as printed in figures.
    pub fn equation(&self) -> String {
        match self {
            Self::FirstOrder {} => "x' = -a x + u".into(),
            Self::FirstOrderNonlinear { .. } => "x' = -a sin(y) x + B u, y' = C y x + sin(w t)".into(),
            Self::SecondOrder {} => "x'' = -a2 x' - a1 x + u".into(),
            Self::SecondOrderNonlinear {} => "x'' = -a2 x' - a1 x^2 + u".into(),
            Self::Own(plant) => plant.equation(),
        }
    }

    /// States at the beginning of the record: at rest, unless the user says otherwise.
    pub fn start(&self) -> Vec<f64> {
        match self {
            Self::Own(plant) => plant.start(),
            _ => vec![0.0; self.states().len()],
        }
    }

    /// The state whose rate contains the unknown parameters and is measured; of several such states the last.
    pub fn carrier(&self) -> usize {
        match self {
            Self::FirstOrder {} | Self::FirstOrderNonlinear { .. } => 0,
            Self::SecondOrder {} | Self::SecondOrderNonlinear {} => 1,
            Self::Own(plant) => plant.carrier(),
        }
    }

    /// The output that is this state and nothing else; `None` where none is.
    pub fn measured(&self, state: usize) -> Option<usize> {
        match self {
            Self::Own(plant) => plant.measured(state),
            _ => Some(state),
        }
    }

    /// Number of measured outputs before the rate; at most the number of states, whose number it is in all plants of the thesis.
    pub fn outputs(&self) -> usize {
        match self {
            Self::Own(plant) => plant.outputs(),
            _ => self.states().len(),
        }
    }

    /// Whether output `i` is state `i`, as the laws need it.
    pub fn measures_all(&self) -> bool {
        match self {
            Self::Own(plant) => plant.measures_all(),
            _ => true,
        }
    }

    /// Why the printed laws cannot be run on it, as a sentence; `None` where they can.
    pub fn without_laws(&self) -> Option<String> {
        match self {
            Self::Own(plant) => plant.without_laws(),
            _ => None,
        }
    }

    /// The known inputs at a time: `u`, for the nonlinear plant of first order its forcing, for a plant of one's own the time.
    pub(super) fn inputs(&self, u: f64, time_s: f64) -> Vec<f64> {
        match self {
            Self::FirstOrderNonlinear { forcing, .. } => {
                vec![u, (std::f64::consts::TAU * forcing.si() * time_s).sin()]
            }
            Self::Own(_) => vec![u, time_s],
            _ => vec![u],
        }
    }

    pub(crate) fn visit<V: Visit>(&self, visitor: V) -> V::Output {
        match self {
            Self::FirstOrder {} => visitor.visit::<_, 1, 2, 1>(&plants::FirstOrder),
            Self::FirstOrderNonlinear { input_gain, coupling, .. } => {
                let (input_gain, coupling) = (*input_gain, *coupling);
                visitor.visit::<_, 2, 3, 2>(&plants::FirstOrderNonlinear { input_gain, coupling })
            }
            Self::SecondOrder {} => visitor.visit::<_, 2, 3, 1>(&plants::SecondOrder),
            Self::SecondOrderNonlinear {} => visitor.visit::<_, 2, 3, 1>(&plants::SecondOrderNonlinear),
            Self::Own(plant) => match plant.states().len() {
                ..=1 => visitor.visit::<_, 1, 2, 2>(&plant.model()),
                2 => visitor.visit::<_, 2, 3, 2>(&plant.model()),
                3 => visitor.visit::<_, 3, 4, 2>(&plant.model()),
                4.. => visitor.visit::<_, 4, 5, 2>(&plant.model()),
            },
        }
    }
}
