//! The axes of the motion that is estimated, and the states, outputs, inputs and coefficients that belong to them.

use crate::core::output::Output;
use crate::core::term::{Coefficient, Variable};

/// The axes of the motion that is estimated.
///
/// ```
/// use phugoid_identification::axes::Axes;
/// use phugoid_identification::output::Output;
/// let states: Vec<&str> = Axes::Longitudinal.states().iter().map(|output| output.name()).collect();
/// assert_eq!(states, ["true_airspeed", "alpha", "theta", "q"]);
/// assert_eq!(Axes::Longitudinal.row(Output::Beta), None); // sideslip is not measured there
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Axes {
    /// Symmetric flight: the states are airspeed, angle of attack, pitch angle and pitch rate.
    Longitudinal,
    /// Sideslip, bank, roll and yaw, with the measured airspeed, angle of attack and pitch as known inputs.
    LateralDirectional,
    /// Both motions together, coupled, with eight states.
    All,
}

/// The two motions that all axes are made of, each excited by inputs of its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Group {
    /// The motion in the plane of symmetry: airspeed, angle of attack and pitch.
    Longitudinal,
    /// Sideslip, roll and yaw: the motion out of the plane of symmetry.
    Lateral,
}

impl Group {
    /// The group that a control surface (by the name of its channel) moves first.
    pub fn of_surface(name: &str) -> Self {
        if name == "elevator" { Self::Longitudinal } else { Self::Lateral }
    }

    /// The group that an output belongs to.
    pub fn of(output: Output) -> Self {
        if Axes::LateralDirectional.row(output).is_some() { Self::Lateral } else { Self::Longitudinal }
    }
}

impl Axes {
    /// The words of a model file: `axes = ["longitudinal", "lateral"]`.
    pub const WORDS: [&'static str; 2] = ["longitudinal", "lateral"];

    /// Canonical names of the channels of the control surfaces.
    pub const SURFACES: [&'static str; 3] = ["elevator", "aileron", "rudder"];

    /// The name of the motion for messages and reports, e.g. `lateral-directional`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Longitudinal => "longitudinal",
            Self::LateralDirectional => "lateral-directional",
            Self::All => "longitudinal and lateral-directional",
        }
    }

    /// The words of a model file for these axes.
    pub fn words(self) -> &'static [&'static str] {
        match self {
            Self::Longitudinal => &["longitudinal"],
            Self::LateralDirectional => &["lateral"],
            Self::All => &["longitudinal", "lateral"],
        }
    }

    /// Whether airspeed, angle of attack and pitch are states.
    pub fn has_longitudinal(self) -> bool {
        self != Self::LateralDirectional
    }

    /// Whether sideslip, bank, roll and yaw are states.
    pub fn has_lateral(self) -> bool {
        self != Self::Longitudinal
    }

    /// Outputs of the motion in the order of its output vector; the first ones are the states ([`Self::states`]).
    pub const fn outputs(self) -> &'static [Output] {
        use Output::{
            Alpha, Ax, Ay, Az, Beta, Phi, PitchAcceleration, PitchRate, RollAcceleration, RollRate, Theta,
            TrueAirspeed, YawAcceleration, YawRate,
        };
        match self {
            Self::Longitudinal => &[TrueAirspeed, Alpha, Theta, PitchRate, Ax, Az, PitchAcceleration],
            Self::LateralDirectional => &[Beta, Phi, RollRate, YawRate, Ay, RollAcceleration, YawAcceleration],
            Self::All => &Output::ALL,
        }
    }

    /// States of the motion in the order of its state vector. Each is the output of the same position.
    pub fn states(self) -> &'static [Output] {
        let states = if self == Self::All { crate::core::output::STATE_CHANNELS } else { 4 };
        self.outputs().get(..states).unwrap_or_default()
    }

    /// Position of an output in the output vector of the motion; `None` if the motion does not have this output.
    pub fn row(self, output: Output) -> Option<usize> {
        self.outputs().iter().position(|o| *o == output)
    }

    /// Channels that every estimation of these axes takes as known inputs: the surfaces, and for the
    /// lateral-directional motion alone the measured symmetric one.
    pub fn known_channels(self) -> &'static [&'static str] {
        match self {
            Self::Longitudinal => &["elevator"],
            Self::LateralDirectional => &["aileron", "rudder", "true_airspeed", "alpha", "theta", "q", "ax", "az"],
            Self::All => &["elevator", "aileron", "rudder"],
        }
    }

    /// Outputs in which a motion becomes visible first: flow angles and angular rates.
    pub fn responses(self) -> &'static [Output] {
        use Output::{Alpha, Beta, PitchRate, RollRate, YawRate};
        match self {
            Self::Longitudinal => &[Alpha, PitchRate],
            Self::LateralDirectional => &[Beta, RollRate, YawRate],
            Self::All => &[Alpha, Beta, RollRate, PitchRate, YawRate],
        }
    }

    /// In words: what has to move before anything can be estimated, and a manoeuvre that moves it.
    pub(crate) fn excitation_words(self) -> [&'static str; 2] {
        match self {
            Self::Longitudinal => {
                ["elevator, angle of attack and pitch rate", "an elevator input such as a 3-2-1-1 or a doublet"]
            }
            Self::LateralDirectional => {
                ["aileron, rudder, sideslip, roll and yaw rate", "a rudder doublet followed by an aileron doublet"]
            }
            Self::All => [
                "control surfaces, angle of attack, sideslip and body rates",
                "inputs to elevator, aileron and rudder, such as a 3-2-1-1 and doublets one after another",
            ],
        }
    }

    /// Force and moment coefficients whose terms the motion can estimate.
    pub fn coefficients(self) -> &'static [Coefficient] {
        match self {
            Self::Longitudinal => &Coefficient::ALL[..3],
            Self::LateralDirectional => &Coefficient::ALL[3..],
            Self::All => &Coefficient::ALL,
        }
    }

    /// Flight variables that the motion can evaluate, beside the extra inputs of the model file.
    pub fn variables(self) -> &'static [Variable] {
        use Variable::{Aileron, Airspeed, Alpha, AlphaRate, Beta, Elevator, PitchRate, RollRate, Rudder, YawRate};
        match self {
            Self::Longitudinal => &[Alpha, PitchRate, Airspeed, Elevator, AlphaRate],
            Self::LateralDirectional => &[Alpha, Beta, RollRate, PitchRate, YawRate, Airspeed, Aileron, Rudder],
            Self::All => &[Alpha, Beta, RollRate, PitchRate, YawRate, Airspeed, Elevator, Aileron, Rudder],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn outputs_keep_the_common_order_and_start_with_the_states() {
        for axes in [Axes::Longitudinal, Axes::LateralDirectional, Axes::All] {
            assert!(axes.outputs().windows(2).all(|pair| pair[0] < pair[1]));
            for (i, state) in axes.states().iter().enumerate() {
                assert_eq!(axes.row(*state), Some(i));
                assert!(state.index() < crate::core::output::STATE_CHANNELS);
            }
        }
        let both = [Axes::Longitudinal, Axes::LateralDirectional].map(Axes::outputs).concat();
        assert!(both.len() == Output::ALL.len() && Output::ALL.iter().all(|o| both.contains(o)));
        assert_eq!(Axes::LateralDirectional.row(Output::Ay), Some(4));
        assert_eq!(Axes::Longitudinal.row(Output::Beta), None);
    }
}
