//! Laws that the equations of motion must obey whatever the aircraft, with an aircraft of the test's own beside the F-16.

#![allow(clippy::unwrap_used)] // in helpers of tests

use phugoid_flight_dynamics::actuator::{Actuator, Actuators};
use phugoid_flight_dynamics::aircraft::{AirData, Aircraft, Coefficients, Controls, Geometry, Propulsion, State};
use phugoid_flight_dynamics::atmosphere::Atmosphere;
use phugoid_flight_dynamics::f16::{F16, F16Options};
use phugoid_flight_dynamics::increments::Increments;
use phugoid_flight_dynamics::longitudinal::{LongitudinalLoads, LongitudinalState, longitudinal_motion};
use phugoid_flight_dynamics::mass::MassProperties;
use phugoid_flight_dynamics::motion::{Disturbance, motion};
use phugoid_flight_dynamics::scalar::Scalar;
use phugoid_flight_dynamics::wind::LocalWind;
use proptest::prelude::*;

/// A light propeller aircraft described by derivatives, in the standard atmosphere: nothing of the F-16 in it. Thrust
/// is inclined and off the centre of gravity; the inertia tensor has no plane of symmetry.
struct Trainer {
    geometry: Geometry,
    mass: MassProperties,
    actuators: Actuators,
    inertia: [[f64; 3]; 3],
    /// Direction of the thrust.
    thrust_line: [f64; 3],
    /// Moment per newton of thrust, m.
    thrust_arm: [f64; 3],
}

impl Trainer {
    fn new(inertia: [[f64; 3]; 3], thrust_line: [f64; 3], thrust_arm: [f64; 3]) -> Self {
        let surface = Actuator::new(0.4, 2.0, 0.05);
        Self {
            geometry: Geometry { wing_area: 16.2, span: 10.9, mean_chord: 1.49, cg: 0.26, cg_reference: 0.25 },
            mass: MassProperties::from_tensor(1043.0, inertia, 0.0).unwrap(),
            actuators: Actuators { elevator: surface, aileron: surface, rudder: surface },
            inertia,
            thrust_line,
            thrust_arm,
        }
    }

    fn symmetric() -> Self {
        let inertia = [[1285.0, 0.0, -60.0], [0.0, 1825.0, 0.0], [-60.0, 0.0, 2667.0]];
        Self::new(inertia, [1.0, 0.0, -0.05], [0.0, 0.12, 0.0])
    }

    fn lopsided() -> Self {
        let inertia = [[1285.0, 25.0, -60.0], [25.0, 1825.0, 14.0], [-60.0, 14.0, 2667.0]];
        Self::new(inertia, [1.0, 0.03, -0.05], [0.02, 0.12, -0.04])
    }
}

impl Aircraft for Trainer {
    fn geometry(&self) -> &Geometry {
        &self.geometry
    }
    fn mass_properties(&self) -> &MassProperties {
        &self.mass
    }
    fn gravity(&self) -> f64 {
        9.80665
    }
    fn atmosphere(&self) -> Atmosphere {
        Atmosphere::Standard
    }
    fn coefficients<T: Scalar>(&self, air: &AirData<T>, rates: [T; 3], controls: &Controls<T>) -> Coefficients<T> {
        let per_two_speeds = (air.speed * 2.0).recip();
        let p_hat = rates[0] * per_two_speeds * self.geometry.span;
        let q_hat = rates[1] * per_two_speeds * self.geometry.mean_chord;
        let r_hat = rates[2] * per_two_speeds * self.geometry.span;
        let Controls { elevator, aileron, rudder, .. } = *controls;
        let lift = air.alpha * 5.1 + 0.31 + q_hat * 3.9 + elevator * 0.43;
        let drag = lift * lift * 0.054 + 0.031;
        let (sine, cosine) = air.alpha.sin_cos();
        Coefficients {
            cx: lift * sine - drag * cosine,
            cz: -(lift * cosine) - drag * sine,
            cm: air.alpha * -0.89 - q_hat * 12.4 - elevator * 1.28 - 0.015,
            cy: air.beta * -0.31 + rudder * 0.187 + r_hat * 0.21 - p_hat * 0.037,
            cl: air.beta * -0.089 - p_hat * 0.47 + r_hat * 0.096 - aileron * 0.178 + rudder * 0.0147,
            cn: air.beta * 0.065 - p_hat * 0.03 - r_hat * 0.099 + aileron * 0.053 - rudder * 0.0657,
        }
    }
    fn propulsion<T: Scalar>(&self, power: T, altitude: T, mach: T) -> Propulsion<T> {
        let density = Atmosphere::Standard.at(altitude).density;
        let thrust = power * 28.0 * density * (mach * -1.5 + 1.0);
        Propulsion { force: self.thrust_line.map(|x| thrust * x), moment: self.thrust_arm.map(|x| thrust * x) }
    }
    fn power_rate<T: Scalar>(&self, throttle: T, power: T) -> T {
        (self.steady_power(throttle) - power) * 2.0
    }
    fn steady_power<T: Scalar>(&self, throttle: T) -> T {
        throttle * 100.0
    }
    fn actuators(&self) -> &Actuators {
        &self.actuators
    }
}

fn f16() -> F16 {
    F16::new(F16Options { cg: 0.30, ..F16Options::default() }).unwrap()
}

prop_compose! {
    fn any_state()(
        speed in 40.0..300.0, alpha in -0.2..0.8, beta in -0.5..0.5,
        phi in -3.0..3.0, theta in -1.4..1.4, psi in -3.1..3.1,
        p in -2.0..2.0, q in -1.0..1.0, r in -1.0..1.0,
        altitude in -100.0..15_000.0, power in 0.0..100.0,
    ) -> State {
        State { speed, alpha, beta, phi, theta, psi, p, q, r, north: 10.0, east: -20.0, altitude, power }
    }
}

prop_compose! {
    fn any_controls()(throttle in 0.0..1.0, elevator in -0.43..0.43, aileron in -0.37..0.37, rudder in -0.52..0.52)
        -> Controls {
        Controls { throttle, elevator, aileron, rudder }
    }
}

fn close(a: f64, b: f64, scale: f64) -> bool {
    (a - b).abs() <= 1e-12 * (scale + a.abs() + b.abs())
}

fn body_velocity(state: &State) -> [f64; 3] {
    let (sa, ca) = state.alpha.sin_cos();
    let (sb, cb) = state.beta.sin_cos();
    [state.speed * ca * cb, state.speed * sb, state.speed * sa * cb]
}

/// Newton's second law in body axes, `v' = f + g - w x v`, and the work of the forces, `V V' = f.v - g h'`.
fn newton_holds<A: Aircraft>(aircraft: &A, state: &State, controls: &Controls, gust: [f64; 3]) {
    let m = motion(aircraft, state, controls, &Disturbance { gust, ..Default::default() });
    let (g, f, rates) = (aircraft.gravity(), m.specific_force, m.rates);
    let [u, v, w] = body_velocity(state);
    let (p, q, r) = (state.p, state.q, state.r);
    let (sa, ca) = state.alpha.sin_cos();
    let (sb, cb) = state.beta.sin_cos();
    let (sf, cf) = state.phi.sin_cos();
    let (st, ct) = state.theta.sin_cos();
    let (dv, da, db) = (rates.speed, rates.alpha, rates.beta);
    let change = [
        dv * ca * cb - state.speed * (sa * cb * da + ca * sb * db),
        dv * sb + state.speed * cb * db,
        dv * sa * cb + state.speed * (ca * cb * da - sa * sb * db),
    ];
    let cause =
        [f[0] - g * st - (q * w - r * v), f[1] + g * sf * ct - (r * u - p * w), f[2] + g * cf * ct - (p * v - q * u)];
    for axis in 0..3 {
        assert!(close(change[axis], cause[axis], 1e3), "axis {axis}: {} {}", change[axis], cause[axis]);
    }
    let work = f[0] * u + f[1] * v + f[2] * w - g * rates.altitude;
    assert!(close(state.speed * dv, work, 1e5), "{} {work}", state.speed * dv);
    let ground = rates.north.hypot(rates.east).hypot(rates.altitude);
    assert!(close(ground, state.speed, 1e3), "speed over the ground {ground}, {}", state.speed);
}

proptest! {
    #![proptest_config(ProptestConfig { rng_seed: proptest::test_runner::RngSeed::Fixed(1), ..ProptestConfig::default() })]

    #[test]
    fn newtons_law_and_the_work_of_the_forces(
        state in any_state(), controls in any_controls(), gust in prop::array::uniform3(-20.0..20.0)
    ) {
        newton_holds(&f16(), &state, &controls, [0.0; 3]);
        newton_holds(&f16(), &state, &controls, gust);
        newton_holds(&Trainer::lopsided(), &state, &controls, gust);
    }

    /// Euler's law, `J w' + w x J w = M`, and the forces: both of what the aircraft itself says of its loads.
    #[test]
    fn loads_are_what_the_aircraft_says(state in any_state(), controls in any_controls()) {
        let aircraft = Trainer::lopsided();
        let m = motion(&aircraft, &state, &controls, &Disturbance::default());
        let c = aircraft.coefficients(&m.air, [state.p, state.q, state.r], &controls);
        let propulsion = aircraft.propulsion(state.power, state.altitude, m.air.mach);
        let Geometry { wing_area, span, mean_chord, .. } = *aircraft.geometry();
        let force = m.air.dynamic_pressure * wing_area;
        let w = [state.p, state.q, state.r];
        let dw = [m.rates.p, m.rates.q, m.rates.r];
        let apply = |x: [f64; 3]| aircraft.inertia.map(|row| row[0] * x[0] + row[1] * x[1] + row[2] * x[2]);
        let (momentum, change) = (apply(w), apply(dw));
        for (axis, (c_force, c_moment)) in [(c.cx, c.cl * span), (c.cy, c.cm * mean_chord), (c.cz, c.cn * span)]
            .into_iter()
            .enumerate()
        {
            let expected = (force * c_force + propulsion.force[axis]) / 1043.0;
            prop_assert!(close(m.specific_force[axis], expected, 10.0), "force {axis}");
            let (next, last) = ((axis + 1) % 3, (axis + 2) % 3);
            let left = change[axis] + w[next] * momentum[last] - w[last] * momentum[next];
            prop_assert!(close(left, force * c_moment + propulsion.moment[axis], 1e6), "moment {axis}");
        }
        prop_assert!(close(m.air.dynamic_pressure, 0.5 * m.air.density * state.speed * state.speed, 1.0));
    }

    /// Air that turns with the aircraft damps nothing: the coefficients are those of an aircraft that does not turn.
    #[test]
    fn turning_air_takes_the_damping_away(state in any_state(), controls in any_controls()) {
        let aircraft = f16();
        let increments = Increments { dCm_q: -2.0, dCl_p: 0.3, dCn_r: 0.1, ..Increments::NONE };
        let gust_rates = [state.p, state.q, state.r];
        let turning = motion(&aircraft, &state, &controls, &Disturbance { gust_rates, increments, ..Default::default() });
        let still = State { p: 0.0, q: 0.0, r: 0.0, ..state };
        let steady = motion(&aircraft, &still, &controls, &Disturbance { increments, ..Default::default() });
        prop_assert_eq!(turning.coefficients, steady.coefficients);
        prop_assert_eq!(turning.specific_force, steady.specific_force);
    }

    /// A gust acts through the relative velocity alone: the forces are those of flight through still air at that
    /// velocity, and the path over the ground is the one of the inertial velocity.
    #[test]
    fn gusts_act_through_the_relative_velocity(
        state in any_state(), controls in any_controls(), gust in prop::array::uniform3(-20.0..20.0)
    ) {
        let aircraft = f16();
        let gusty = motion(&aircraft, &state, &controls, &Disturbance { gust, ..Default::default() });
        let [u, v, w] = body_velocity(&state);
        let (u, v, w) = (u - gust[0], v - gust[1], w - gust[2]);
        let speed = (u * u + v * v + w * w).sqrt();
        let relative = State { speed, alpha: w.atan2(u), beta: (v / speed).asin(), ..state };
        let still = motion(&aircraft, &relative, &controls, &Disturbance::default());
        for axis in 0..3 {
            let (a, b) = (gusty.specific_force[axis], still.specific_force[axis]);
            prop_assert!((a - b).abs() < 1e-9 * (100.0 + a.abs()), "{axis}: {a} {b}");
        }
        prop_assert!((gusty.air.speed - speed).abs() < 1e-9 && (gusty.air.alpha - relative.alpha).abs() < 1e-12);
        let calm = motion(&aircraft, &state, &controls, &Disturbance::default());
        prop_assert!(close(gusty.rates.north, calm.rates.north, 100.0));
        prop_assert!(close(gusty.rates.altitude, calm.rates.altitude, 100.0));
    }

    /// Left and right exchanged: a symmetric aircraft without a spinning rotor flies the mirror image.
    #[test]
    fn a_symmetric_aircraft_flies_the_mirror_image(state in any_state(), controls in any_controls()) {
        let aircraft = Trainer::symmetric();
        let mirror = |s: State| State {
            beta: -s.beta, phi: -s.phi, psi: -s.psi, p: -s.p, r: -s.r, east: -s.east, ..s
        };
        let mirrored_controls = Controls { aileron: -controls.aileron, rudder: -controls.rudder, ..controls };
        let still = Disturbance::default();
        let right = mirror(motion(&aircraft, &state, &controls, &still).rates).to_array();
        let left = motion(&aircraft, &mirror(state), &mirrored_controls, &still).rates.to_array();
        for i in 0..13 {
            prop_assert!(close(right[i], left[i], 10.0), "{i}: {} {}", right[i], left[i]);
        }
    }

    /// The longitudinal equations are the 6-DOF ones in the plane of symmetry.
    #[test]
    fn longitudinal_equations_are_the_general_ones(
        speed in 40.0..300.0, alpha in -0.2..0.8, theta in -1.4..1.4, q in -1.0..1.0,
        altitude in 0.0..15_000.0, power in 0.0..100.0, elevator in -0.43..0.43,
    ) {
        let state = State {
            speed, alpha, beta: 0.0, phi: 0.0, theta, psi: 0.7, p: 0.0, q, r: 0.0, north: 0.0, east: 0.0, altitude, power
        };
        let controls = Controls { throttle: 0.3, elevator, aileron: 0.0, rudder: 0.0 };
        let aircraft = f16();
        let general = motion(&aircraft, &state, &controls, &Disturbance::default());
        let geometry = aircraft.geometry();
        let (cx, cz, cm) =
            aircraft.longitudinal_coefficients(alpha, q * geometry.mean_chord / (2.0 * speed), elevator);
        let force = general.air.dynamic_pressure * geometry.wing_area;
        let loads = LongitudinalLoads {
            force_x: force * cx + aircraft.thrust(power, altitude, general.air.mach),
            force_z: force * cz,
            pitching_moment: force * geometry.mean_chord * cm,
        };
        let mass = aircraft.mass_properties();
        let state = LongitudinalState { speed, alpha, theta, q };
        let plane = longitudinal_motion(&state, &loads, mass.mass(), mass.pitch_inertia(), aircraft.gravity());
        // Relative to the size of what is added up: gravity and specific force, their share per speed, q.
        let acceleration = aircraft.gravity() + plane.specific_force_x.abs() + plane.specific_force_z.abs();
        let pairs = [
            (plane.rates.speed, general.rates.speed, acceleration),
            (plane.rates.alpha, general.rates.alpha, acceleration / speed + q.abs()),
            (plane.rates.theta, general.rates.theta, q.abs()),
            (plane.rates.q, general.rates.q, force * geometry.mean_chord / mass.pitch_inertia()),
            (plane.specific_force_x, general.specific_force[0], acceleration),
            (plane.specific_force_z, general.specific_force[2], acceleration),
        ];
        for (i, (a, b, scale)) in pairs.into_iter().enumerate() {
            prop_assert!((a - b).abs() <= 1e-12 * scale, "{i}: {a} {b}");
        }
    }

    /// Increments change lift, drag and moments by exactly what they say, and nothing at their reference point.
    #[test]
    fn increments_change_what_they_name(
        state in any_state(), controls in any_controls(), d in prop::array::uniform9(-1.0..1.0)
    ) {
        let aircraft = f16();
        let increments = Increments {
            dCL_alpha: d[0], dCD_alpha: d[1], dCm_alpha: d[2], dCm_q: d[3], dCm_elevator: d[4], dCL_q: d[5],
            dCn_beta: d[6], dCl_p: d[7], dCY_rudder: d[8], ..Increments::NONE
        }
        .about(0.1, 0.05, -0.02);
        let wind = |c: &Coefficients| {
            let (s, o) = state.alpha.sin_cos();
            (c.cx * s - c.cz * o, -c.cx * o - c.cz * s)
        };
        let bare = motion(&aircraft, &state, &controls, &Disturbance::default()).coefficients;
        let with = motion(&aircraft, &state, &controls, &Disturbance { increments, ..Default::default() }).coefficients;
        let ((lift, drag), (bare_lift, bare_drag)) = (wind(&with), wind(&bare));
        let geometry = aircraft.geometry();
        let (alpha, elevator) = (state.alpha - 0.1, controls.elevator + 0.02);
        let q_hat = (state.q - 0.05) * geometry.mean_chord / (2.0 * state.speed);
        let p_hat = state.p * geometry.span / (2.0 * state.speed);
        prop_assert!(close(lift - bare_lift, d[0] * alpha + d[5] * q_hat, 10.0));
        prop_assert!(close(drag - bare_drag, d[1] * alpha, 10.0));
        prop_assert!(close(with.cm - bare.cm, d[2] * alpha + d[3] * q_hat + d[4] * elevator, 10.0));
        prop_assert!(close(with.cn - bare.cn, d[6] * state.beta, 10.0));
        prop_assert!(close(with.cl - bare.cl, d[7] * p_hat, 10.0));
        prop_assert!(close(with.cy - bare.cy, d[8] * controls.rudder, 10.0));

        // One group of increments without the other.
        let coefficients = |increments| {
            motion(&aircraft, &state, &controls, &Disturbance { increments, ..Default::default() }).coefficients
        };
        let longitudinal = Increments { dCn_beta: 0.0, dCl_p: 0.0, dCY_rudder: 0.0, ..increments };
        let lateral = Increments { dCn_beta: d[6], dCl_p: d[7], dCY_rudder: d[8], ..Increments::NONE };
        let (a, b) = (coefficients(longitudinal), coefficients(lateral));
        prop_assert_eq!(Coefficients { cy: bare.cy, cl: bare.cl, cn: bare.cn, ..with }, a);
        prop_assert_eq!(Coefficients { cx: bare.cx, cz: bare.cz, cm: bare.cm, ..with }, b);

        let at_reference = State { alpha: 0.1, beta: 0.0, p: 0.0, q: 0.05, r: 0.0, ..state };
        let neutral = Controls { elevator: -0.02, aileron: 0.0, rudder: 0.0, ..controls };
        let disturbed = Disturbance { increments, ..Default::default() };
        prop_assert_eq!(
            motion(&aircraft, &at_reference, &neutral, &disturbed).rates,
            motion(&aircraft, &at_reference, &neutral, &Disturbance::default()).rates
        );
    }
}

/// The trainer glides, climbs and turns by the same equations: level flight at the speed where lift carries its weight.
#[test]
fn another_aircraft_needs_no_other_equations() {
    let aircraft = Trainer::symmetric();
    let (speed, altitude) = (55.0, 1_000.0);
    let pressure = 0.5 * Atmosphere::Standard.at(altitude).density * speed * speed;
    // Lift equal to weight with the elevator that balances the moment, both by hand; drag equal to thrust.
    let (mut alpha, mut elevator, mut thrust) = (0.0_f64, 0.0, 0.0);
    for _ in 0..100 {
        let weight = 1043.0 * 9.80665 - thrust * (alpha.sin() + 0.05 * alpha.cos());
        alpha = (weight / (pressure * 16.2) - 0.31 - 0.43 * elevator) / 5.1;
        let lift = 5.1 * alpha + 0.31 + 0.43 * elevator;
        elevator = (-0.89 * alpha - 0.015 + 0.12 * thrust / (pressure * 16.2 * 1.49)) / 1.28;
        thrust = (0.031 + 0.054 * lift * lift) * pressure * 16.2 / (alpha.cos() - 0.05 * alpha.sin());
    }
    let mach = speed / Atmosphere::Standard.at(altitude).speed_of_sound;
    let power = thrust / (28.0 * Atmosphere::Standard.at(altitude).density * (1.0 - 1.5 * mach));
    let state = State {
        speed,
        alpha,
        beta: 0.0,
        phi: 0.0,
        theta: alpha,
        psi: 0.0,
        p: 0.0,
        q: 0.0,
        r: 0.0,
        north: 0.0,
        east: 0.0,
        altitude,
        power,
    };
    let controls = Controls { throttle: power / 100.0, elevator, aileron: 0.0, rudder: 0.0 };
    let rates = motion(&aircraft, &state, &controls, &Disturbance::default()).rates;
    assert!((0.0..100.0).contains(&power) && alpha.abs() < 0.2, "{power} {alpha}");
    for (name, rate) in [("speed", rates.speed), ("alpha", rates.alpha), ("q", rates.q), ("power", rates.power)] {
        assert!(rate.abs() < 1e-9, "{name}: {rate:e}");
    }
    assert!((rates.north - speed).abs() < 1e-9 && rates.altitude.abs() < 1e-9);
}

/// Newton's second law over the ground, which knows nothing of the wind: the velocity that the position changes with has
/// the rate `R f + g`, whatever the wind and its shear, for accelerometers that feel `f`.
fn newton_holds_over_the_ground<A: Aircraft>(aircraft: &A, state: &State, controls: &Controls, d: &Disturbance) {
    let at = |step: f64, rates: &State| {
        let (x, rates) = (state.to_array(), rates.to_array());
        let moved = State::from_array(std::array::from_fn(|i| x[i] + step * rates[i]));
        let rates = motion(aircraft, &moved, controls, d).rates;
        [rates.north, rates.east, -rates.altitude]
    };
    let now = motion(aircraft, state, controls, d);
    let step = 1e-4;
    let (before, after) = (at(-step, &now.rates), at(step, &now.rates));
    let (sf, cf) = state.phi.sin_cos();
    let (st, ct) = state.theta.sin_cos();
    let (sp, cp) = state.psi.sin_cos();
    let to_ground = [
        [ct * cp, sf * st * cp - cf * sp, cf * st * cp + sf * sp],
        [ct * sp, sf * st * sp + cf * cp, cf * st * sp - sf * cp],
        [-st, sf * ct, cf * ct],
    ];
    for i in 0..3 {
        let felt: f64 = (0..3).map(|j| to_ground[i][j] * now.specific_force[j]).sum();
        let expected = felt + if i == 2 { aircraft.gravity() } else { 0.0 };
        let rate = (after[i] - before[i]) / (2.0 * step);
        assert!((rate - expected).abs() < 1e-4 * (1.0 + expected.abs()), "{i}: {rate} {expected}");
    }
}

proptest! {
    #[test]
    fn the_ground_does_not_know_of_the_wind(
        angles in prop::array::uniform3(-0.8..0.8_f64), flow in (0.02..0.3_f64, -0.1..0.1_f64),
        rates in prop::array::uniform3(-0.5..0.5_f64), speed in 60.0..200.0_f64, altitude in 500.0..9000.0_f64,
        velocity in prop::array::uniform2(-30.0..30.0_f64), shear in prop::array::uniform2(-0.1..0.1_f64),
    ) {
        let x = [
            speed, flow.0, flow.1, angles[0], angles[1], angles[2], rates[0], rates[1], rates[2], 0.0, 0.0, altitude, 40.0,
        ];
        let state = State::from_array(x);
        let controls = Controls { throttle: 0.5, elevator: -0.05, aileron: 0.02, rudder: 0.03 };
        let disturbance = Disturbance { wind: LocalWind { altitude, velocity, shear }, ..Default::default() };
        let f16 = F16::new(F16Options::default()).unwrap();
        newton_holds_over_the_ground(&f16, &state, &controls, &disturbance);
        let inertia = [[1285.0, 0.0, 0.0], [0.0, 1825.0, 0.0], [0.0, 0.0, 2667.0]];
        newton_holds_over_the_ground(&Trainer::new(inertia, [1.0, 0.0, 0.0], [0.0; 3]), &state, &controls, &disturbance);
        // The same wind at all altitudes carries the aircraft along and does nothing else, not in the last bit.
        let carried = Disturbance { wind: LocalWind { altitude, velocity, shear: [0.0; 2] }, ..Default::default() };
        let (still, carried) = (
            motion(&f16, &state, &controls, &Disturbance::default()),
            motion(&f16, &state, &controls, &carried),
        );
        prop_assert_eq!(carried.rates.north, still.rates.north + velocity[0]);
        prop_assert_eq!(carried.rates.east, still.rates.east + velocity[1]);
        prop_assert_eq!(State { north: 0.0, east: 0.0, ..carried.rates }, State { north: 0.0, east: 0.0, ..still.rates });
        prop_assert_eq!((carried.air, carried.specific_force), (still.air, still.specific_force));
    }
}
