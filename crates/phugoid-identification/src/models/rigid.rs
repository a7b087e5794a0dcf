//! What the lateral-directional and the six-coefficient model share: the rigid body, its aerodynamic build-up and the
//! known inputs that both need.

use phugoid_flight_dynamics::aircraft::{Coefficients, Controls};
use phugoid_flight_dynamics::increments::lift_drag_to_body;
use phugoid_flight_dynamics::mass::MassProperties;
use phugoid_flight_dynamics::scalar::Scalar;

use crate::core::term::{Coefficient, EXTRA_INPUTS, FACTORS, Term, Variable};
use crate::models::database::{Database, InAir};

/// Constants of the aircraft that the models of lateral-directional and of the whole motion need.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AircraftConstants {
    /// Wing reference area `S`, m^2.
    pub wing_area: f64,
    /// Mean aerodynamic chord `cbar`, m.
    pub mean_chord: f64,
    /// Wing span `b`, m.
    pub span: f64,
    /// Acceleration of gravity, m/s^2, positive.
    pub gravity: f64,
    /// Angle of the thrust line above body x, rad.
    pub thrust_inclination: f64,
    /// Pitching moment per newton of thrust, m, positive nose up.
    pub thrust_arm: f64,
    /// Angular momentum of spinning rotors along body x, kg m^2/s, positive clockwise seen from behind.
    pub rotor_momentum: f64,
    /// Speed that makes `v_hat = V / V0`, m/s.
    pub reference_speed: f64,
    /// Speed that normalises the rates of the terms, m/s; none: the actual speed.
    pub rate_speed: Option<f64>,
    /// Angle of attack at which the terms' `alpha` is zero, rad.
    pub alpha_reference: f64,
    /// Elevator at which the terms' `elevator` is zero, rad.
    pub elevator_reference: f64,
    /// Aileron at which the terms' `aileron` is zero, rad.
    pub aileron_reference: f64,
    /// Rudder at which the terms' `rudder` is zero, rad.
    pub rudder_reference: f64,
}

impl AircraftConstants {
    /// The same with quantities of the type of the equations: `[span / 2V, cbar / 2V]`, s, at a speed.
    #[inline(always)]
    fn rate_times<T: Scalar>(&self, speed: T) -> [T; 2] {
        let half = (speed * 2.0).recip();
        [half * self.span, half * self.mean_chord]
    }
}

/// Surface positions and the extra inputs of a model file.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Surfaces {
    /// Elevator, rad, positive trailing edge down.
    pub elevator: f64,
    /// Aileron, rad, in the sign of the database (F-16: positive rolls to the left).
    pub aileron: f64,
    /// Rudder, rad, in the sign of the database (F-16: positive yaws to the left).
    pub rudder: f64,
    /// The model file's extra inputs, in its order.
    pub extra: [f64; EXTRA_INPUTS],
    /// True if they are held until the next sample, as a digital command is; false if they run straight to it, as a
    /// recorded surface does.
    pub held: bool,
}

impl Surfaces {
    /// Elevator, aileron and rudder, rad.
    #[inline(always)]
    pub(crate) fn deflections<T: Scalar>(&self) -> [T; 3] {
        [self.elevator, self.aileron, self.rudder].map(T::from)
    }

    /// A fraction `s` of the way to `other`.
    #[inline]
    pub(crate) fn interpolate(&self, other: &Self, s: f64) -> Self {
        if self.held {
            return *self;
        }
        let between = |a: f64, b: f64| a + s * (b - a);
        Self {
            elevator: between(self.elevator, other.elevator),
            aileron: between(self.aileron, other.aileron),
            rudder: between(self.rudder, other.rudder),
            extra: std::array::from_fn(|i| between(self.extra[i], other.extra[i])),
            held: false,
        }
    }
}

/// Mass and inertia at one instant: an aircraft with the x-z plane as plane of symmetry.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MassInput {
    /// Mass of the aircraft, kg.
    pub mass: f64,
    /// Moment of inertia about body x, kg m^2.
    pub ixx: f64,
    /// Moment of inertia about body y, kg m^2.
    pub iyy: f64,
    /// Moment of inertia about body z, kg m^2.
    pub izz: f64,
    /// Product of inertia `integral x z dm`, kg m^2 (the tensor's element is `-ixz`).
    pub ixz: f64,
}

impl MassInput {
    /// A fraction `s` of the way to `other`.
    #[inline]
    pub(crate) fn interpolate(&self, other: &Self, s: f64) -> Self {
        let between = |a: f64, b: f64| a + s * (b - a);
        Self {
            mass: between(self.mass, other.mass),
            ixx: between(self.ixx, other.ixx),
            iyy: between(self.iyy, other.iyy),
            izz: between(self.izz, other.izz),
            ixz: between(self.ixz, other.ixz),
        }
    }

    /// The properties that turn moments into angular accelerations; `None` for an impossible mass or inertia.
    #[inline]
    pub fn properties(&self, rotor_momentum: f64) -> Option<MassProperties> {
        let Self { mass, ixx, iyy, izz, ixz } = *self;
        MassProperties::from_tensor(mass, [[ixx, 0.0, -ixz], [0.0, iyy, 0.0], [-ixz, 0.0, izz]], rotor_momentum)
    }
}

/// The motion relative to the air, on which the aerodynamic coefficients depend.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Air<T> {
    pub(crate) speed: T,
    pub(crate) alpha: T,
    pub(crate) beta: T,
    /// Body rates `[p, q, r]`, rad/s.
    pub(crate) rates: [T; 3],
    /// Density of the air, kg/m^3, which the database of an aircraft of a file asks for.
    pub(crate) density: T,
    /// Mach number, likewise; none: that of the standard atmosphere where it has this density.
    pub(crate) mach: Option<T>,
}

/// Aerodynamics: a database and a build-up of terms.
#[derive(Clone, Debug)]
pub(crate) struct Aerodynamics {
    pub(crate) constants: AircraftConstants,
    pub(crate) database: Database,
    /// Known terms with their values.
    pub(crate) known: Vec<(Coefficient, Term, f64)>,
    /// Estimated terms in the order of the parameter vector.
    pub(crate) columns: Vec<(Coefficient, Term)>,
}

impl Aerodynamics {
    /// The flight variables of the terms, in the order of [`Variable`], then the extra inputs. These models have no
    /// rate of the angle of attack: its variable is zero.
    #[inline(always)]
    pub(crate) fn variables<T: Scalar>(
        &self,
        air: &Air<T>,
        deflections: &[T; 3],
        extra: &[f64; EXTRA_INPUTS],
    ) -> [T; FACTORS] {
        let c = &self.constants;
        let [span_time, chord_time] = match c.rate_speed {
            Some(speed) => c.rate_times(T::from(speed)),
            None => c.rate_times(air.speed),
        };
        let mut v = [T::from(0.0); FACTORS];
        v[Variable::Alpha.index()] = air.alpha - c.alpha_reference;
        v[Variable::Beta.index()] = air.beta;
        v[Variable::RollRate.index()] = air.rates[0] * span_time;
        v[Variable::PitchRate.index()] = air.rates[1] * chord_time;
        v[Variable::YawRate.index()] = air.rates[2] * span_time;
        v[Variable::Airspeed.index()] = air.speed / c.reference_speed;
        let [elevator, aileron, rudder] = *deflections;
        v[Variable::Elevator.index()] = elevator - c.elevator_reference;
        v[Variable::Aileron.index()] = aileron - c.aileron_reference;
        v[Variable::Rudder.index()] = rudder - c.rudder_reference;
        for (slot, extra) in v[Variable::ALL.len()..].iter_mut().zip(extra) {
            *slot = T::from(*extra);
        }
        v
    }

    /// Sums of the known and the estimated terms, in the order of [`Coefficient`].
    #[inline(always)]
    fn sums<T: Scalar>(&self, theta: &[f64], variables: &[T; FACTORS]) -> [T; 6] {
        let mut total = [T::from(0.0); 6];
        let known = self.known.iter().map(|(coefficient, term, value)| (coefficient, term, value));
        let estimated = self.columns.iter().zip(theta).map(|((coefficient, term), value)| (coefficient, term, value));
        for (coefficient, term, value) in known.chain(estimated) {
            let sum = &mut total[*coefficient as usize];
            *sum = *sum + term.value(variables) * *value;
        }
        total
    }

    /// `CX, CY, CZ, Cl, Cm, Cn` in body axes about the centre of gravity, of the database and of the terms. Lift and
    /// drag terms are along the stability axes, perpendicular to and along the velocity in the plane of symmetry.
    #[inline(always)]
    pub(crate) fn coefficients<T: Scalar>(
        &self,
        theta: &[f64],
        air: &Air<T>,
        variables: &[T; FACTORS],
        deflections: &[T; 3],
        sin_alpha: T,
        cos_alpha: T,
    ) -> Coefficients<T> {
        let zero = T::from(0.0);
        let mut total = match &self.database {
            Database::None => Coefficients { cx: zero, cy: zero, cz: zero, cl: zero, cm: zero, cn: zero },
            Database::F16(aircraft) => {
                let [span_time, chord_time] = self.constants.rate_times(air.speed);
                let hats = [air.rates[0] * span_time, air.rates[1] * chord_time, air.rates[2] * span_time];
                let [elevator, aileron, rudder] = *deflections;
                let controls = Controls { throttle: zero, elevator, aileron, rudder };
                aircraft.coefficients_at(air.alpha, air.beta, hats, &controls)
            }
            Database::Aircraft(aircraft) => {
                let Air { speed, alpha, beta, rates, density, mach } = *air;
                InAir { speed, flow: [alpha, beta], density, mach, rates, deflections: *deflections }
                    .coefficients(aircraft.as_ref())
            }
        };
        let [lift, drag, pitch, side, roll, yaw] = self.sums(theta, variables);
        let [cx, cz] = lift_drag_to_body(lift, drag, sin_alpha, cos_alpha);
        total.cx = total.cx + cx;
        total.cy = total.cy + side;
        total.cz = total.cz + cz;
        total.cl = total.cl + roll;
        total.cm = total.cm + pitch;
        total.cn = total.cn + yaw;
        total
    }
}
