//! The aircraft of a model file as a rigid body, and the reference point of its aerodynamic terms.

/// The aerodynamic database that the build-up is added to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Base {
    /// None: the build-up is the whole coefficient.
    None,
    /// The F-16 of Stevens & Lewis; the build-up is made of increments about the reference point.
    F16,
    /// An aircraft of a file, [`ModelFile::known`](super::ModelFile::known); the build-up is made of increments about the
    /// reference point.
    Aircraft,
}

/// Acceleration of gravity where nobody says it, m/s^2.
pub(super) const STANDARD_GRAVITY: f64 = 9.80665;

/// The speed that normalises the pitch rate, `q_hat = q cbar / (2 V)`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RateSpeed {
    /// The airspeed of the moment, as the state or the measurement gives it.
    Actual,
    /// The reference speed of the model file.
    Reference,
}

/// A quantity that is constant or recorded.
#[derive(Clone, Debug, PartialEq)]
pub enum Source {
    /// The same value during the whole flight, SI.
    Constant(f64),
    /// The channel with this canonical name.
    Channel(String),
}

/// Where the thrust comes from.
#[derive(Clone, Debug, PartialEq)]
pub enum Thrust {
    /// Constant (N), or recorded in a channel.
    Known(Source),
    /// Constant, from the trim at the reference point.
    Trim,
}

/// Where the air density comes from.
#[derive(Clone, Debug, PartialEq)]
pub enum AirDensity {
    /// Constant (kg/m^3), or recorded in a channel.
    Known(Source),
    /// International standard atmosphere 1976 at the `altitude` channel.
    StandardAtmosphere,
    /// The air-data model of Stevens & Lewis (appendix A) at the `altitude` channel.
    BookAtmosphere,
}

/// The aircraft as a rigid body.
#[derive(Clone, Debug, PartialEq)]
pub struct AircraftData {
    /// Mass of the aircraft, kg.
    pub mass: Source,
    /// Moment of inertia about the body x axis, kg m^2; there where the axes need it.
    pub ixx: Option<Source>,
    /// Moment of inertia about the body y axis, kg m^2.
    pub iyy: Source,
    /// Moment of inertia about the body z axis, kg m^2; there where the axes need it.
    pub izz: Option<Source>,
    /// Product of inertia, integral of x z dm, kg m^2; there where the axes need it.
    pub ixz: Option<Source>,
    /// Wing reference area `S`, m^2.
    pub wing_area: f64,
    /// Mean aerodynamic chord `cbar`, m.
    pub mean_chord: f64,
    /// Wing span, m; there where the axes need it.
    pub wing_span: Option<f64>,
    /// Centre of gravity behind the leading edge of the mean chord, fraction of it. Only databases need it.
    pub cg: Option<f64>,
    /// Thrust along the thrust line, N.
    pub thrust: Thrust,
    /// Angle of the thrust line above the body x axis, rad.
    pub thrust_inclination: f64,
    /// Pitching moment per newton of thrust, m: positive where the thrust line passes below the centre of gravity.
    pub thrust_arm: f64,
    /// Density of the air, kg/m^3.
    pub air_density: AirDensity,
    /// Angular momentum of spinning rotors along body x, kg m^2/s, positive clockwise seen from behind.
    pub rotor_momentum: f64,
    /// Reference speed `V0`, m/s; there where a term, `rate_speed` or a trim needs it.
    pub reference_speed: Option<f64>,
    /// Acceleration of gravity, m/s^2, positive.
    pub gravity: f64,
}

/// A component of the reference point about which increments are taken.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ReferenceValue {
    /// The value in the file, in SI units.
    Given(f64),
    /// From the level trim of the database at the reference speed and altitude.
    Trim,
    /// From the first sample of the record.
    FirstSample,
}

/// The reference point: terms are functions of `alpha - alpha_ref`, `elevator - elevator_ref`, and so on for aileron
/// and rudder; sideslip and rates count from zero.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reference {
    /// Angle of attack at which `alpha` counts as zero, rad.
    pub alpha: ReferenceValue,
    /// Elevator deflection at which `elevator` counts as zero, rad.
    pub elevator: ReferenceValue,
    /// Aileron deflection at which `aileron` counts as zero, rad.
    pub aileron: ReferenceValue,
    /// Rudder deflection at which `rudder` counts as zero, rad.
    pub rudder: ReferenceValue,
    /// Altitude at which the trim is computed, m; there where a trim is asked for.
    pub altitude: Option<f64>,
}
