//! Classes of aircraft, and what is typical of each: where an engineer does not know a number of his own yet.

/// A class of aircraft.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AircraftClass {
    /// A single-engined light aircraft.
    LightSingle,
    /// A transport or business jet.
    Transport,
    /// A glider or motor glider.
    Glider,
    /// An unmanned aircraft with fixed wings, below about 100 kg.
    Drone,
    /// A fighter or jet trainer.
    Fighter,
}

impl AircraftClass {
    /// All classes.
    pub const ALL: [Self; 5] = [Self::LightSingle, Self::Transport, Self::Glider, Self::Drone, Self::Fighter];

    /// The class as the command line writes it.
    pub fn word(self) -> &'static str {
        match self {
            Self::LightSingle => "light-single",
            Self::Transport => "transport",
            Self::Glider => "glider",
            Self::Drone => "drone",
            Self::Fighter => "fighter",
        }
    }

    pub(super) fn typical(self) -> Typical {
        match self {
            Self::LightSingle => LIGHT_SINGLE,
            Self::Transport => TRANSPORT,
            Self::Glider => GLIDER,
            Self::Drone => DRONE,
            Self::Fighter => FIGHTER,
        }
    }
}

/// What is typical of a class.
#[derive(Clone, Copy, Debug)]
pub(super) struct Typical {
    /// Length of the fuselage over the span.
    pub(super) length_over_span: f64,
    /// Dimensionless radii of gyration about x, y, z: twice the radius over span, length and the mean of the two.
    pub(super) radii: [f64; 3],
    /// Lift over drag in cruise.
    pub(super) lift_over_drag: f64,
    /// Start values of Cm_alpha, Cm_q and Cm_elevator, per radian.
    pub(super) pitch: [f64; 3],
    /// Smallest and largest mass, kg; others are asked about.
    pub(super) mass: [f64; 2],
    /// The class of the uncertainties of instruments and masses in a model file.
    pub(super) uncertainty: &'static str,
}

// Radii of gyration: D. P. Raymer, Aircraft Design: A Conceptual Approach, AIAA, chapter 16 (single-engined propeller
// aircraft, twin jet transport, jet fighter). Gliders and drones have the ones of light aircraft there, for want of a table.
// Start values: the means of the aircraft in appendix B of J. Roskam, Airplane Flight Dynamics, part I, rounded. Lengths over
// spans, lift over drag and masses are judgement.
const LIGHT_SINGLE: Typical = Typical {
    length_over_span: 0.75,
    radii: [0.25, 0.38, 0.39],
    lift_over_drag: 9.0,
    pitch: [-0.8, -12.0, -1.2],
    mass: [250.0, 3000.0],
    uncertainty: "unstated",
};
const TRANSPORT: Typical = Typical {
    length_over_span: 1.05,
    radii: [0.25, 0.38, 0.46],
    lift_over_drag: 14.0,
    pitch: [-1.0, -20.0, -1.3],
    mass: [3000.0, 600_000.0],
    uncertainty: "unstated",
};
const GLIDER: Typical = Typical {
    length_over_span: 0.45,
    radii: [0.25, 0.38, 0.39],
    lift_over_drag: 25.0,
    pitch: [-0.7, -12.0, -1.2],
    mass: [80.0, 1000.0],
    uncertainty: "unstated",
};
const DRONE: Typical = Typical {
    length_over_span: 0.6,
    radii: [0.25, 0.38, 0.39],
    lift_over_drag: 9.0,
    pitch: [-0.7, -10.0, -0.8],
    mass: [0.1, 150.0],
    uncertainty: "unmanned",
};
const FIGHTER: Typical = Typical {
    length_over_span: 1.5,
    radii: [0.23, 0.38, 0.52],
    lift_over_drag: 7.0,
    pitch: [-0.3, -5.0, -0.8],
    mass: [1500.0, 40_000.0],
    uncertainty: "unstated",
};
