//! What the equations of motion need to know of an aircraft, and the quantities they exchange with it.

use crate::atmosphere::Atmosphere;
use crate::scalar::Scalar;

/// Number of rigid-body and engine states.
pub const STATES: usize = 13;

/// Rigid-body and engine state of an aircraft over a flat earth. Also used for the rates (each per second).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct State<T = f64> {
    /// Speed of the centre of gravity relative to the undisturbed air, which moves with the wind, m/s (true airspeed without
    /// gusts).
    pub speed: T,
    /// Angle of attack, rad: between body x and the velocity in the plane of symmetry, positive nose up.
    pub alpha: T,
    /// Sideslip angle, rad, positive with the wind from the right.
    pub beta: T,
    /// Roll (bank) angle, rad, positive with the right wing down.
    pub phi: T,
    /// Pitch angle, rad: of body x above the horizon, positive nose up.
    pub theta: T,
    /// Heading, rad, from north to east.
    pub psi: T,
    /// Roll rate, body x axis, rad/s.
    pub p: T,
    /// Pitch rate, body y axis, rad/s.
    pub q: T,
    /// Yaw rate, body z axis, rad/s.
    pub r: T,
    /// Position north of the origin, m.
    pub north: T,
    /// Position east of the origin, m.
    pub east: T,
    /// Altitude above sea level, m, positive up.
    pub altitude: T,
    /// Engine power level, percent (the aircraft's own engine state).
    pub power: T,
}

impl<T: Copy> State<T> {
    /// The states in the order of the fields.
    pub fn to_array(self) -> [T; STATES] {
        [
            self.speed,
            self.alpha,
            self.beta,
            self.phi,
            self.theta,
            self.psi,
            self.p,
            self.q,
            self.r,
            self.north,
            self.east,
            self.altitude,
            self.power,
        ]
    }

    /// The state from an array in the order of the fields.
    pub fn from_array(a: [T; STATES]) -> Self {
        let [speed, alpha, beta, phi, theta, psi, p, q, r, north, east, altitude, power] = a;
        Self { speed, alpha, beta, phi, theta, psi, p, q, r, north, east, altitude, power }
    }
}

/// Throttle lever and surface positions.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Controls<T = f64> {
    /// Throttle lever, 0 to 1.
    pub throttle: T,
    /// Elevator, rad, positive trailing edge down (nose down).
    pub elevator: T,
    /// Aileron, rad, positive rolls to the left (F-16 convention of Stevens & Lewis).
    pub aileron: T,
    /// Rudder, rad, positive yaws to the left.
    pub rudder: T,
}

/// The aircraft's motion relative to the air around it (gusts included), and that air.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AirData<T = f64> {
    /// True airspeed relative to the moving air, m/s.
    pub speed: T,
    /// Angle of attack, rad: between body x and the velocity in the plane of symmetry, positive nose up.
    pub alpha: T,
    /// Sideslip angle relative to the moving air, rad, positive with the wind from the right.
    pub beta: T,
    /// Density of the air at the altitude of the aircraft, kg/m^3.
    pub density: T,
    /// Dynamic pressure `density * speed^2 / 2`, Pa.
    pub dynamic_pressure: T,
    /// Mach number: true airspeed over the speed of sound at this altitude.
    pub mach: T,
}

/// Nondimensional aerodynamic force and moment coefficients in body axes, moments about the centre of gravity.
/// Forces are made dimensional by `qbar S`; rolling and yawing moment by `qbar S b`, pitching moment by `qbar S cbar`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coefficients<T = f64> {
    /// Axial force, body x forward.
    pub cx: T,
    /// Side force, body y right.
    pub cy: T,
    /// Normal force, body z down.
    pub cz: T,
    /// Rolling moment about body x, positive right wing down; referred to the span.
    pub cl: T,
    /// Pitching moment about body y, positive nose up; referred to the mean chord.
    pub cm: T,
    /// Yawing moment about body z, positive nose right; referred to the span.
    pub cn: T,
}

impl<T: Scalar> Coefficients<T> {
    /// The moments about a centre of gravity that is further aft by `shift` mean chords: the forces act ahead of it.
    #[must_use]
    pub fn about(&self, shift: f64, geometry: &Geometry) -> Self {
        Self {
            cm: self.cm - self.cz * shift,
            cn: self.cn + self.cy * (shift * geometry.mean_chord / geometry.span),
            ..*self
        }
    }

    /// These with a slope times the variable that it is by.
    pub(crate) fn with(&self, slope: &Self, variable: T) -> Self {
        Self {
            cx: self.cx + slope.cx * variable,
            cy: self.cy + slope.cy * variable,
            cz: self.cz + slope.cz * variable,
            cl: self.cl + slope.cl * variable,
            cm: self.cm + slope.cm * variable,
            cn: self.cn + slope.cn * variable,
        }
    }
}

/// Force and moment of the propulsion system in body axes, about the centre of gravity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Propulsion<T = f64> {
    /// Force along body x, y and z, N.
    pub force: [T; 3],
    /// Moment about body x, y and z, N m.
    pub moment: [T; 3],
}

impl<T: Scalar> Propulsion<T> {
    /// The moment about a centre of gravity that is further aft by a length, m: the force acts ahead of it.
    #[must_use]
    pub fn about(&self, aft: f64) -> Self {
        let ([_, y, z], [roll, pitch, yaw]) = (self.force, self.moment);
        Self { moment: [roll, pitch - z * aft, yaw + y * aft], ..*self }
    }
}

impl Propulsion {
    /// Size of the force, N, negative where it pushes backwards along body x.
    pub fn thrust(&self) -> f64 {
        let [x, y, z] = self.force;
        (x * x + y * y + z * z).sqrt().copysign(x)
    }
}

/// The lengths and the area that make coefficients of forces and moments, and the centre of gravity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Geometry {
    /// Wing reference area `S`, m^2: forces are `qbar S` times their coefficient.
    pub wing_area: f64,
    /// Wing span `b`, m: the length of rolling and yawing moment, and of `p b/2V` and `r b/2V`.
    pub span: f64,
    /// Mean aerodynamic chord `cbar`, m: the length of the pitching moment, and of `q cbar/2V`.
    pub mean_chord: f64,
    /// Centre of gravity, fraction of the mean aerodynamic chord behind its leading edge.
    pub cg: f64,
    /// Moment reference point of the aerodynamic data, fraction of the mean aerodynamic chord.
    pub cg_reference: f64,
}

/// The range of flight that an aircraft's data are good for, `[lowest, highest]` each. Beyond it the coefficient functions and the
/// engine still give numbers, but those are extrapolated and describe no aircraft.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DataRange {
    /// Lowest and highest angle of attack, rad; a trim outside is refused.
    pub alpha: [f64; 2],
    /// Lowest and highest sideslip angle, rad.
    pub beta: [f64; 2],
    /// Lowest and highest elevator deflection, rad, positive trailing edge down.
    pub elevator: [f64; 2],
    /// Lowest and highest aileron deflection, rad.
    pub aileron: [f64; 2],
    /// Lowest and highest rudder deflection, rad.
    pub rudder: [f64; 2],
    /// Lowest and highest true airspeed, m/s; a trim outside is refused.
    pub speed: [f64; 2],
    /// Lowest and highest Mach number; a trim outside is refused.
    pub mach: [f64; 2],
    /// Lowest and highest altitude above sea level, m; a trim outside is refused.
    pub altitude: [f64; 2],
}

impl DataRange {
    /// The range that both cover.
    pub fn within(&self, other: &Self) -> Self {
        let both = |a: [f64; 2], b: [f64; 2]| [a[0].max(b[0]), a[1].min(b[1])];
        Self {
            alpha: both(self.alpha, other.alpha),
            beta: both(self.beta, other.beta),
            elevator: both(self.elevator, other.elevator),
            aileron: both(self.aileron, other.aileron),
            rudder: both(self.rudder, other.rudder),
            speed: both(self.speed, other.speed),
            mach: both(self.mach, other.mach),
            altitude: both(self.altitude, other.altitude),
        }
    }

    /// The range of an aircraft that says nothing about it: angles of attack from -20 to 50 deg, everything else unlimited.
    /// Databases that go further are rare, and an aircraft has equilibria beyond its data that mean nothing.
    pub const UNSTATED: Self = {
        const DEGREE: f64 = core::f64::consts::PI / 180.0;
        const ANY: [f64; 2] = [f64::NEG_INFINITY, f64::INFINITY];
        Self {
            alpha: [-20.0 * DEGREE, 50.0 * DEGREE],
            beta: ANY,
            elevator: ANY,
            aileron: ANY,
            rudder: ANY,
            speed: ANY,
            mach: ANY,
            altitude: ANY,
        }
    };
}

/// An aircraft: data and the functions that make forces of them. The equations of motion are written once against
/// this trait; another aircraft is another implementation, and no change to them.
pub trait Aircraft {
    /// Reference area and lengths, and the centre of gravity.
    fn geometry(&self) -> &Geometry;

    /// Mass, rotational inertia and the spinning rotor's momentum.
    fn mass_properties(&self) -> &crate::mass::MassProperties;

    /// Acceleration of gravity, m/s^2, the same at every altitude.
    fn gravity(&self) -> f64;

    /// The atmosphere that the aircraft's data assume.
    fn atmosphere(&self) -> Atmosphere;

    /// Aerodynamic coefficients from air data, body rates `[p, q, r]` in rad/s and surface positions.
    fn coefficients<T: Scalar>(&self, air: &AirData<T>, rates: [T; 3], controls: &Controls<T>) -> Coefficients<T>;

    /// Change of the [`coefficients`](Self::coefficients) with the rate of the angle of attack, per rad/s; `None`, as by
    /// default, for data that do not know that rate. The coefficients themselves are then those without it.
    ///
    /// The equations of motion add this, times the rate that they solve for, in closed form: the coefficients are linear in
    /// it. The rate is that of the state; how fast a gust changes is not in it.
    fn alpha_rate_coefficients<T: Scalar>(
        &self,
        _air: &AirData<T>,
        _rates: [T; 3],
        _controls: &Controls<T>,
    ) -> Option<Coefficients<T>> {
        None
    }

    /// Propulsion from the engine state (percent), altitude (m) and Mach number.
    fn propulsion<T: Scalar>(&self, power: T, altitude: T, mach: T) -> Propulsion<T>;

    /// What the slipstream of the propulsion adds to the [`coefficients`](Self::coefficients); `None`, as by default, for an
    /// aircraft that has none or whose data do not know it. `propulsion` is what the aircraft has at this moment.
    fn slipstream_coefficients<T: Scalar>(
        &self,
        _propulsion: &Propulsion<T>,
        _air: &AirData<T>,
        _rates: [T; 3],
        _controls: &Controls<T>,
    ) -> Option<Coefficients<T>> {
        None
    }

    /// Fuel that is burnt, kg/s, at an engine state (percent), altitude (m) and Mach number; zero, as by default, for an aircraft
    /// whose mass stays as it is.
    fn fuel_flow(&self, _power: f64, _altitude: f64, _mach: f64) -> f64 {
        0.0
    }

    /// The body of the aircraft when `fuel` kg are burnt; `None`, as by default, where the mass stays as it is. A trim and a linear
    /// model are those of the beginning, when nothing is burnt; a simulation asks at each of its samples.
    fn after_burning(&self, _fuel: f64) -> Option<crate::fuel::Burnt> {
        None
    }

    /// Rate of the engine state, percent per second, from the throttle lever (0 to 1) and the engine state.
    fn power_rate<T: Scalar>(&self, throttle: T, power: T) -> T;

    /// The engine state that a throttle lever position settles at, percent.
    fn steady_power<T: Scalar>(&self, throttle: T) -> T;

    /// The actuators that move the surfaces; a simulation without actuators and the linear models leave them out, the
    /// trim uses their limits.
    fn actuators(&self) -> &crate::actuator::Actuators;

    /// The stops of elevator, aileron and rudder: the lowest and the highest deflection of each, rad. A trim beyond them is refused.
    /// By default they are the limits of the [`actuators`](Self::actuators) to either side; an aircraft whose surface goes farther
    /// to one side than to the other has them here, and in the actuator the larger of the two.
    fn surface_stops(&self) -> [[f64; 2]; 3] {
        self.actuators().each().map(|actuator| [-actuator.limit, actuator.limit])
    }

    /// The range of flight that the data cover; a trim outside is refused.
    fn data_range(&self) -> DataRange {
        DataRange::UNSTATED
    }
}
