//! The equations of motion: six degrees of freedom over a flat earth, written once for every aircraft and scalar; with what a
//! planet adds to them where it is given.

use crate::aircraft::{AirData, Aircraft, Coefficients, Controls, State};
use crate::earth::LocalEarth;
use crate::increments::{Increments, lift_drag_to_body};
use crate::rigid_body::{Angles, attitude_equations, force_equations};
use crate::scalar::Scalar;
use crate::standard_atmosphere::geopotential_altitude;
use crate::wind::LocalWind;

/// What disturbs the flight. The default is nothing: still air over a plane, and the database as it is.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Disturbance {
    /// Steady wind: the motion of the undisturbed air over the ground.
    pub wind: LocalWind,
    /// Velocity of the air in body axes, m/s, relative to the undisturbed air.
    pub gust: [f64; 3],
    /// Rotation of the air about the body axes, rad/s: the aerodynamics see `p`, `q`, `r` less these.
    pub gust_rates: [f64; 3],
    /// Aerodynamic increments on top of the aircraft's database.
    pub increments: Increments,
    /// The planet under the aircraft; none: a plane at rest, with the gravity that the aircraft's data assume.
    pub earth: Option<LocalEarth>,
}

/// What the equations of motion give at one instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motion<T = f64> {
    /// Rates of all states, each in its own unit per second.
    pub rates: State<T>,
    /// Motion relative to the air, gusts included.
    pub air: AirData<T>,
    /// Specific force at the centre of gravity in body axes, m/s^2: what accelerometers there feel, gravity left out.
    pub specific_force: [T; 3],
    /// Aerodynamic coefficients with the increments, body axes, moments about the centre of gravity.
    pub coefficients: Coefficients<T>,
    /// Body rates relative to local north, east and down, rad/s: those of the attitude. Over a plane `p`, `q`, `r`.
    pub turning: [T; 3],
}

/// Rates of the states of an aircraft from its state, controls and disturbance.
///
/// Force, moment, kinematic and navigation equations of Stevens & Lewis table 2.5-1 with the speed, angle of attack and
/// sideslip as states (their equation 2.5-29; thesis 2.14 to 2.23). Speed, angle of attack and sideslip of the state
/// belong to the velocity relative to the undisturbed air; the aerodynamics see the velocity relative to the gust. The
/// undisturbed air moves with the wind: it carries the aircraft over the ground, and where it changes with altitude the
/// aircraft is accelerated relative to it ([`wind`](crate::wind)), which no accelerometer feels. Over a planet
/// ([`earth`](crate::earth)) `p`, `q`, `r` are relative to the stars and the altitude is geometric; derivatives by the position leave out
/// that the planet is another one elsewhere.
///
/// Singular, with results that are not finite, at zero speed, at 90 deg of pitch, and at 90 deg of sideslip.
///
/// ```
/// use phugoid_flight_dynamics::aircraft::{Controls, State};
/// use phugoid_flight_dynamics::f16::{F16, F16Options};
/// use phugoid_flight_dynamics::motion::{Disturbance, motion};
///
/// let aircraft = F16::new(F16Options { cg: 0.30, ..F16Options::default() })?;
/// // Level flight at 20,000 ft and 675 ft/s, with a degree more of up elevator than trim needs.
/// let mut state = State::from_array([0.0; 13]);
/// (state.speed, state.alpha, state.theta) = (205.74, 0.0417, 0.0417);
/// (state.altitude, state.power) = (6096.0, 10.0);
/// let controls = Controls { throttle: 0.154, elevator: -2.96_f64.to_radians(), aileron: 0.0, rudder: 0.0 };
/// let motion = motion(&aircraft, &state, &controls, &Disturbance::default());
/// assert!(motion.rates.q > 0.0); // the nose comes up
/// # Ok::<(), phugoid_flight_dynamics::f16::F16DataError>(())
/// ```
#[inline]
pub fn motion<T: Scalar, A: Aircraft>(
    aircraft: &A,
    state: &State<T>,
    controls: &Controls<T>,
    disturbance: &Disturbance,
) -> Motion<T> {
    let geometry = aircraft.geometry();
    let mass = aircraft.mass_properties();
    let gravity = aircraft.gravity();
    let &State { speed, alpha, beta, phi, theta, psi, p, q, r, altitude, power, .. } = state;

    let angles = Angles::of(alpha, beta, phi, theta);
    let Angles { sin_alpha, cos_alpha, sin_phi, cos_phi, sin_theta, cos_theta, .. } = angles;
    let (sin_psi, cos_psi) = psi.sin_cos();

    // Body-axis velocity relative to the undisturbed air.
    let velocity = angles.body_velocity(speed);
    let [u, v, w] = velocity;
    let climbing = v * sin_phi + w * cos_phi;
    let altitude_rate = u * sin_theta - climbing * cos_theta;
    let sheared = disturbance.wind.is_sheared();

    // Navigation equations: horizontal velocity along and across the heading, then turned to north and east.
    let along = u * cos_theta + climbing * sin_theta;
    let across = v * cos_phi - w * sin_phi;
    let north_rate = along * cos_psi - across * sin_psi;
    let east_rate = along * sin_psi + across * cos_psi;
    let (north_rate, east_rate) = if disturbance.wind == LocalWind::default() {
        (north_rate, east_rate)
    } else {
        let [north, east] = disturbance.wind.at(altitude);
        (north_rate + north, east_rate + east)
    };
    let planet = disturbance.earth.as_ref().map(|earth| {
        let wind = disturbance.wind.at(altitude);
        Planetary::new(earth, &angles, [sin_psi, cos_psi], velocity, [north_rate, east_rate], wind, gravity)
    });
    let (turning, map) = match &planet {
        None => ([p, q, r], None),
        Some(planet) => (planet.turning([p, q, r]), disturbance.earth.map(|earth| earth.map)),
    };

    // Motion relative to the air.
    let air_altitude = if planet.is_some() { geopotential_altitude(altitude) } else { altitude };
    let local_air = aircraft.atmosphere().at(air_altitude);
    let gust = disturbance.gust;
    let still = gust == [0.0; 3];
    let (air_speed, air_alpha, air_beta, air_sin, air_cos) = if still {
        (speed, alpha, beta, sin_alpha, cos_alpha)
    } else {
        let (ua, va, wa) = (u - gust[0], v - gust[1], w - gust[2]);
        let in_plane = ua * ua + wa * wa;
        let plane_speed = in_plane.sqrt();
        let total = (in_plane + va * va).sqrt();
        (total, wa.atan2(ua), va.atan2(plane_speed), wa / plane_speed, ua / plane_speed)
    };
    let air = AirData {
        speed: air_speed,
        alpha: air_alpha,
        beta: air_beta,
        density: local_air.density,
        dynamic_pressure: local_air.density * air_speed * air_speed * 0.5,
        mach: air_speed / local_air.speed_of_sound,
    };

    let gust_rates = disturbance.gust_rates;
    let to_earth = match &planet {
        None => [p, q, r],
        Some(planet) => [p - planet.rotation[0], q - planet.rotation[1], r - planet.rotation[2]],
    };
    let air_rates = if gust_rates == [0.0; 3] {
        to_earth
    } else {
        [to_earth[0] - gust_rates[0], to_earth[1] - gust_rates[1], to_earth[2] - gust_rates[2]]
    };
    let mut coefficients = aircraft.coefficients(&air, air_rates, controls);
    let increments = &disturbance.increments;
    if increments.is_longitudinal() {
        let chord_time = (air_speed * 2.0).recip() * geometry.mean_chord;
        let [lift, drag, pitch] = increments.longitudinal(air_alpha, chord_time, air_rates[1], controls.elevator);
        let [cx, cz] = lift_drag_to_body(lift, drag, air_sin, air_cos);
        coefficients.cx = coefficients.cx + cx;
        coefficients.cz = coefficients.cz + cz;
        coefficients.cm = coefficients.cm + pitch;
    }
    if increments.is_lateral() {
        let span_time = (air_speed * 2.0).recip() * geometry.span;
        let [side, roll, yaw] = increments.lateral(
            air_beta,
            air_rates[0] * span_time,
            air_rates[2] * span_time,
            controls.aileron,
            controls.rudder,
        );
        coefficients.cy = coefficients.cy + side;
        coefficients.cl = coefficients.cl + roll;
        coefficients.cn = coefficients.cn + yaw;
    }

    let propulsion = aircraft.propulsion(power, air_altitude, air.mach);
    if let Some(blown) = aircraft.slipstream_coefficients(&propulsion, &air, air_rates, controls) {
        coefficients = coefficients.with(&blown, T::from(1.0));
    }
    let force_scale = air.dynamic_pressure * geometry.wing_area;
    let acceleration_scale = force_scale * mass.inverse_mass();
    let specific_force_of = |coefficients: &Coefficients<T>| {
        [
            coefficients.cx * acceleration_scale + propulsion.force[0] * mass.inverse_mass(),
            coefficients.cy * acceleration_scale + propulsion.force[1] * mass.inverse_mass(),
            coefficients.cz * acceleration_scale + propulsion.force[2] * mass.inverse_mass(),
        ]
    };
    // What accelerates the aircraft relative to the air: in a shear the air does as well.
    let shear = sheared.then(|| shear_acceleration(&disturbance.wind, &angles, [sin_psi, cos_psi], altitude_rate));
    let plus = |a: [T; 3], b: Option<[T; 3]>| match b {
        None => a,
        Some(b) => [a[0] + b[0], a[1] + b[1], a[2] + b[2]],
    };
    let beside_plane = planet.as_ref().map(|planet| planet.acceleration);
    let through_air = |felt: [T; 3]| plus(plus(felt, shear), beside_plane);
    if let Some(slope) = aircraft.alpha_rate_coefficients(&air, air_rates, controls) {
        // alpha' = without + gain alpha': the forces are linear in the rate that they make.
        let without = through_air(specific_force_of(&coefficients));
        let [_, without, _] = force_equations(speed, &angles, velocity, [p, q, r], without, gravity);
        let gain = (cos_alpha * slope.cz - sin_alpha * slope.cx) * acceleration_scale / speed / angles.cos_beta;
        coefficients = coefficients.with(&slope, without / (T::from(1.0) - gain));
    }
    let specific_force = specific_force_of(&coefficients);
    let moment_scale = force_scale * geometry.span;
    let moment = [
        coefficients.cl * moment_scale + propulsion.moment[0],
        coefficients.cm * (force_scale * geometry.mean_chord) + propulsion.moment[1],
        coefficients.cn * moment_scale + propulsion.moment[2],
    ];

    let [speed_rate, alpha_rate, beta_rate] =
        force_equations(speed, &angles, velocity, [p, q, r], through_air(specific_force), gravity);
    let [phi_rate, theta_rate, psi_rate] = attitude_equations(&angles, turning);

    // Moment equations.
    let [p_rate, q_rate, r_rate] = mass.angular_acceleration([p, q, r], moment);

    let [north_rate, east_rate] = match map {
        None => [north_rate, east_rate],
        Some([north, east]) => [north_rate * north, east_rate * east],
    };
    let rates = State {
        speed: speed_rate,
        alpha: alpha_rate,
        beta: beta_rate,
        phi: phi_rate,
        theta: theta_rate,
        psi: psi_rate,
        p: p_rate,
        q: q_rate,
        r: r_rate,
        north: north_rate,
        east: east_rate,
        altitude: altitude_rate,
        power: aircraft.power_rate(controls.throttle, power),
    };
    Motion { rates, air, specific_force, coefficients, turning }
}

/// Acceleration of the aircraft relative to the air in body axes, m/s^2, because the air that it comes into moves
/// differently: `-W'(h) h'`. Sine and cosine of the heading; rate of climb in m/s.
fn shear_acceleration<T: Scalar>(
    wind: &LocalWind,
    angles: &Angles<T>,
    [sin_psi, cos_psi]: [T; 2],
    altitude_rate: T,
) -> [T; 3] {
    level_to_body(angles, [sin_psi, cos_psi], wind.shear.map(|shear| altitude_rate * -shear))
}

/// Body components of a vector with components towards north and east. Sine and cosine of the heading.
fn level_to_body<T: Scalar>(angles: &Angles<T>, [sin_psi, cos_psi]: [T; 2], [north, east]: [T; 2]) -> [T; 3] {
    let &Angles { sin_phi, cos_phi, sin_theta, cos_theta, .. } = angles;
    // Along and across the heading, then to body axes.
    let along = north * cos_psi + east * sin_psi;
    let across = east * cos_psi - north * sin_psi;
    [along * cos_theta, along * sin_theta * sin_phi + across * cos_phi, along * sin_theta * cos_phi - across * sin_phi]
}

/// Body components of a vector with components towards north, east and down. Sine and cosine of the heading.
fn to_body<T: Scalar>(angles: &Angles<T>, heading: [T; 2], [north, east, down]: [T; 3]) -> [T; 3] {
    let &Angles { sin_phi, cos_phi, sin_theta, cos_theta, .. } = angles;
    let [x, y, z] = level_to_body(angles, heading, [north, east]);
    [x - down * sin_theta, y + down * cos_theta * sin_phi, z + down * cos_theta * cos_phi]
}

fn cross<T: Scalar>(a: [T; 3], b: [T; 3]) -> [T; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// What a planet adds to the equations of a plane at rest ([`earth`](crate::earth)), body axes.
struct Planetary<T> {
    /// Rotation of the planet, rad/s.
    rotation: [T; 3],
    /// Rotation of the local axes, rad/s.
    local_axes: [T; 3],
    /// Acceleration relative to the air beside that over a plane with the aircraft's own gravity, m/s^2.
    acceleration: [T; 3],
}

impl<T: Scalar> Planetary<T> {
    /// Sine and cosine of the `heading`, the `velocity` relative to the undisturbed air in body axes (m/s), that over the ground
    /// and that of the wind towards north and east (m/s), and the gravity of the plane (m/s^2).
    fn new(
        earth: &LocalEarth,
        angles: &Angles<T>,
        heading: [T; 2],
        velocity: [T; 3],
        over_ground: [T; 2],
        [wind_north, wind_east]: [T; 2],
        plane_gravity: f64,
    ) -> Self {
        let body = |ned: [T; 3]| to_body(angles, heading, ned);
        let spin = earth.rotation.map(T::from);
        let carried = earth.transport_rate(over_ground);
        let local_axes = core::array::from_fn(|i| spin[i] + carried[i]);
        let rotation = body(spin);
        let coriolis = cross(rotation, velocity);
        let of_wind = cross(core::array::from_fn(|i| spin[i] + local_axes[i]), [wind_north, wind_east, T::from(0.0)]);
        let [north, east, down] = earth.gravity;
        let pulled = [T::from(north), T::from(east), T::from(down - plane_gravity)];
        let beside = body(core::array::from_fn(|i| pulled[i] - of_wind[i]));
        Self { rotation, local_axes: body(local_axes), acceleration: core::array::from_fn(|i| beside[i] - coriolis[i]) }
    }

    /// Body rates relative to the local axes, from those relative to the stars, rad/s.
    fn turning(&self, [p, q, r]: [T; 3]) -> [T; 3] {
        let [x, y, z] = self.local_axes;
        [p - x, q - y, r - z]
    }
}
