//! The equations of motion: six degrees of freedom over a flat earth, written once for every aircraft and scalar.

use crate::aircraft::{AirData, Aircraft, Coefficients, Controls, State};
use crate::increments::{Increments, lift_drag_to_body};
use crate::rigid_body::{Angles, attitude_equations, force_equations};
use crate::scalar::Scalar;
use crate::wind::LocalWind;

/// What disturbs the flight. The default is nothing: still air and the database as it is.
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
}

/// Rates of the states of an aircraft from its state, controls and disturbance.
///
/// Force, moment, kinematic and navigation equations of Stevens & Lewis table 2.5-1 with the speed, angle of attack and
/// sideslip as states (their equation 2.5-29; thesis 2.14 to 2.23). Speed, angle of attack and sideslip of the state
/// belong to the velocity relative to the undisturbed air; the aerodynamics see the velocity relative to the gust. The
/// undisturbed air moves with the wind: it carries the aircraft over the ground, and where it changes with altitude the
/// aircraft is accelerated relative to it ([`wind`](crate::wind)), which no accelerometer feels.
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

    // Motion relative to the air.
    let local_air = aircraft.atmosphere().at(altitude);
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

    let turning = disturbance.gust_rates;
    let air_rates = if turning == [0.0; 3] { [p, q, r] } else { [p - turning[0], q - turning[1], r - turning[2]] };
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

    let propulsion = aircraft.propulsion(power, altitude, air.mach);
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
    let through_air = |felt: [T; 3]| match shear {
        None => felt,
        Some(shear) => [felt[0] + shear[0], felt[1] + shear[1], felt[2] + shear[2]],
    };
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
    let [phi_rate, theta_rate, psi_rate] = attitude_equations(&angles, [p, q, r]);

    // Moment equations.
    let [p_rate, q_rate, r_rate] = mass.angular_acceleration([p, q, r], moment);

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
    Motion { rates, air, specific_force, coefficients }
}

/// Acceleration of the aircraft relative to the air in body axes, m/s^2, because the air that it comes into moves
/// differently: `-W'(h) h'`. Sine and cosine of the heading; rate of climb in m/s.
fn shear_acceleration<T: Scalar>(
    wind: &LocalWind,
    angles: &Angles<T>,
    [sin_psi, cos_psi]: [T; 2],
    altitude_rate: T,
) -> [T; 3] {
    let &Angles { sin_phi, cos_phi, sin_theta, cos_theta, .. } = angles;
    let [north, east] = wind.shear.map(|shear| altitude_rate * -shear);
    // Along and across the heading, then to body axes.
    let along = north * cos_psi + east * sin_psi;
    let across = east * cos_psi - north * sin_psi;
    [along * cos_theta, along * sin_theta * sin_phi + across * cos_phi, along * sin_theta * cos_phi - across * sin_phi]
}
