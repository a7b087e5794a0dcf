//! The four proof-of-concept plants, by name.

use crate::plants;
use phugoid_estimators::Model;
use serde::Deserialize;

use phugoid_simulation::quantity::Frequency;

/// One of the four proof-of-concept plants, with its constants.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
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
    pub fn parameters(&self) -> &'static [&'static str] {
        match self {
            Self::FirstOrder {} | Self::FirstOrderNonlinear { .. } => &["a"],
            Self::SecondOrder {} | Self::SecondOrderNonlinear {} => &["a1", "a2"],
        }
    }

    /// Names of the states; all are measured.
    pub fn states(&self) -> &'static [&'static str] {
        match self {
            Self::FirstOrder {} => &["x"],
            Self::FirstOrderNonlinear { .. } => &["x", "y"],
            Self::SecondOrder {} | Self::SecondOrderNonlinear {} => &["x", "x'"],
        }
    }

    /// Its equation, as printed in figures.
    pub fn equation(&self) -> &'static str {
        match self {
            Self::FirstOrder {} => "x' = -a x + u",
            Self::FirstOrderNonlinear { .. } => "x' = -a sin(y) x + B u, y' = C y x + sin(w t)",
            Self::SecondOrder {} => "x'' = -a2 x' - a1 x + u",
            Self::SecondOrderNonlinear {} => "x'' = -a2 x' - a1 x^2 + u",
        }
    }

    /// The known inputs at a time: `u`, and for the nonlinear plant of first order its forcing.
    pub(super) fn inputs(&self, u: f64, time_s: f64) -> Vec<f64> {
        match self {
            Self::FirstOrderNonlinear { forcing, .. } => {
                vec![u, (std::f64::consts::TAU * forcing.si() * time_s).sin()]
            }
            _ => vec![u],
        }
    }

    pub(crate) fn visit<V: Visit>(&self, visitor: V) -> V::Output {
        match *self {
            Self::FirstOrder {} => visitor.visit::<_, 1, 2, 1>(&plants::FirstOrder),
            Self::FirstOrderNonlinear { input_gain, coupling, .. } => {
                visitor.visit::<_, 2, 3, 2>(&plants::FirstOrderNonlinear { input_gain, coupling })
            }
            Self::SecondOrder {} => visitor.visit::<_, 2, 3, 1>(&plants::SecondOrder),
            Self::SecondOrderNonlinear {} => visitor.visit::<_, 2, 3, 1>(&plants::SecondOrderNonlinear),
        }
    }
}
