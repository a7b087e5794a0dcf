//! Flights over a planet in the states that sensors see, against those relative to the stars (`globe`); loops.

use phugoid_flight_dynamics::aircraft::{Aircraft as _, Controls, Propulsion, STATES, State};
use phugoid_flight_dynamics::atmosphere::Atmosphere;
use phugoid_flight_dynamics::earth::Earth;
use phugoid_flight_dynamics::f16::{F16, F16Options};
use phugoid_flight_dynamics::globe::attitude::EulerAngles;
use phugoid_flight_dynamics::globe::coefficients::FlownAircraft;
use phugoid_flight_dynamics::globe::condition::{AirModel, InitialRates, Launch, Wind, World};
use phugoid_flight_dynamics::globe::flight::fly;
use phugoid_flight_dynamics::globe::planet::{Geodetic, Planet};
use phugoid_flight_dynamics::modified::Modified;
use phugoid_flight_dynamics::scalar::Scalar;
use phugoid_flight_dynamics::simulate::{CommandHold, Instant, Stepper, TrajectorySample};
use phugoid_flight_dynamics::wind::{WindLevel, WindProfile};

/// The F-16 without its engine, whose thrust `globe` looks up at the geometric altitude.
struct Glider(F16);

impl Modified for Glider {
    type Unmodified = F16;

    fn unmodified(&self) -> &F16 {
        &self.0
    }

    fn propulsion<T: Scalar>(&self, _power: T, _altitude: T, _mach: T) -> Propulsion<T> {
        Propulsion { force: [T::from(0.0); 3], moment: [T::from(0.0); 3] }
    }
}

fn glider(atmosphere: Atmosphere) -> Glider {
    let mut aircraft = F16::new(F16Options { cg: 0.30, ..F16Options::default() }).unwrap();
    aircraft.atmosphere = atmosphere;
    Glider(aircraft)
}

/// Surfaces that stay where they are: what switches within a step would not be the same for both integrations.
const CONTROLS: Controls = Controls { throttle: 0.0, elevator: -0.05, aileron: 0.004, rudder: -0.01 };
/// Body rates against the planet at the start, rad/s.
const RATES: [f64; 3] = [0.4, 0.1, -0.06];

fn start() -> State {
    let mut state = State::from_array([0.0; STATES]);
    (state.speed, state.alpha, state.theta, state.psi) = (200.0, 0.045, 0.02, 0.8);
    (state.altitude, state.power) = (5000.0, 0.0);
    state
}

/// The flight of 20 s sample by sample, and the same in `globe`: the largest differences of speed (m/s), of angles (rad), of
/// rates (rad/s), of the place (m) and of the velocity over the ground (m/s).
fn apart(planet: Planet, latitude: f64, wind: Wind) -> [f64; 5] {
    let aircraft = glider(Atmosphere::Standard);
    let earth = Earth::new(planet, latitude, 1.2).unwrap();
    let levels = [0.0, 20_000.0].map(|altitude| {
        let [north, east, _] = wind.at(altitude);
        WindLevel { altitude, velocity: [north, east] }
    });
    let mut state = start();
    let mut stepper = Stepper::new(state, Controls::default(), 0.01, 4, CommandHold::Sample)
        .with_actuators(false)
        .with_wind(WindProfile::new(levels.to_vec()).unwrap())
        .over(Some(earth));
    let here = earth.under(&state);
    let heading = state.psi;
    let body = EulerAngles { yaw: heading, pitch: state.theta, roll: 0.0 }.matrix();
    let spin = phugoid_flight_dynamics::globe::vector::apply(&body, here.rotation);
    [state.p, state.q, state.r] = std::array::from_fn(|i| RATES[i] + spin[i]);
    stepper.set_state(&state);
    let velocity_in_body = [state.speed * state.alpha.cos(), 0.0, state.speed * state.alpha.sin()];
    let through_air = phugoid_flight_dynamics::globe::vector::apply_transposed(&body, velocity_in_body);
    let carried = wind.at(state.altitude);
    let launch = Launch {
        place: Geodetic { latitude, longitude: 1.2, altitude: state.altitude },
        velocity: std::array::from_fn(|i| through_air[i] + carried[i]),
        euler: EulerAngles { yaw: heading, pitch: state.theta, roll: 0.0 },
        rates: InitialRates::Earth(RATES),
    };
    let world = World { planet, air: AirModel::Standard1976, wind };
    let mut samples: Vec<TrajectorySample> = Vec::new();
    for _ in 0..=2000 {
        let now = Instant { commands: CONTROLS, ..Instant::default() };
        samples.push(stepper.sample(&aircraft, &now));
        stepper.hold(&aircraft, &now).unwrap();
    }
    let mut worst = [0.0_f64; 5];
    let mut step = 0;
    let mut vehicle = FlownAircraft::new(&aircraft, |_| CONTROLS);
    let begin = launch.state(&planet, 0.0, [state.power]);
    fly(&world, &mut vehicle, begin, 0.0, 20.0, 0.0025, |motion| {
        let k = step / 4;
        step += 1;
        if step % 4 != 1 {
            return;
        }
        let (ours, theirs) = (&samples[k], &motion.condition);
        let turn = |a: f64, b: f64| (a - b).sin().abs();
        let place = ours.place.unwrap();
        let [meridian, normal] = planet.curvature_radii(latitude);
        let differences = [
            (ours.state.speed - theirs.air.speed).abs(),
            [
                turn(ours.state.alpha, theirs.air.alpha),
                turn(ours.state.beta, theirs.air.beta),
                turn(ours.state.phi, theirs.euler.roll),
                turn(ours.state.theta, theirs.euler.pitch),
                turn(ours.state.psi, theirs.euler.yaw),
            ]
            .into_iter()
            .fold(0.0, f64::max),
            (0..3)
                .map(|i| ([ours.state.p, ours.state.q, ours.state.r][i] - theirs.state.rates[i]).abs())
                .fold(0.0, f64::max),
            [
                (place.altitude - theirs.place.altitude).abs(),
                meridian * (place.latitude - theirs.place.latitude).abs(),
                normal * latitude.cos() * (place.longitude - theirs.place.longitude).abs(),
            ]
            .into_iter()
            .fold(0.0, f64::max),
            (0..3).map(|i| (ours.ground_velocity[i] - theirs.ground_velocity[i]).abs()).fold(0.0, f64::max),
        ];
        for (worst, difference) in worst.iter_mut().zip(differences) {
            *worst = worst.max(difference);
        }
    })
    .unwrap();
    worst
}

/// A second formulation, integrated relative to the stars with a quaternion: with the same step.
#[test]
fn a_flight_over_a_planet_is_that_of_the_globe() {
    let wind = Wind { at_zero: [6.0, -14.0, 0.0], gradient: [0.002, -0.004, 0.0] };
    for (planet, latitude, wind) in [
        (Planet::WGS84, 0.9, wind),
        (Planet::WGS84, -1.5, Wind::default()),
        (Planet::WGS84, 0.0, wind),
        (Planet::sphere(6.371e6, 3.986_004_418e14, 0.0), 0.5, wind),
    ] {
        let [speed, angles, rates, place, ground] = apart(planet, latitude, wind);
        println!("{latitude}: {speed:.1e} m/s, {angles:.1e} rad, {rates:.1e} rad/s, {place:.1e} m, {ground:.1e} m/s");
        // Some ten times what rounding leaves: positions from the centre of the planet have 1e-9 m.
        assert!(speed < 5e-9 && angles < 5e-11 && rates < 5e-11 && place < 1e-6 && ground < 5e-9);
    }
}

/// A loop: the nose passes the vertical twice, where Euler angles fail and a quaternion does not.
#[test]
fn a_loop_is_flown_with_a_quaternion() {
    const PULL: Controls = Controls { throttle: 0.0, elevator: -0.12, aileron: 0.0, rudder: 0.0 };
    let aircraft = glider(Atmosphere::Book);
    let mut state = start();
    // A little to the side, so that the nose does not pass the vertical exactly.
    (state.speed, state.psi, state.phi, state.p) = (260.0, 0.0, 0.02, 0.01);
    let fresh = || Stepper::new(state, Controls::default(), 0.01, 4, CommandHold::Sample).with_actuators(false);
    let fly_through = |mut stepper: Stepper| -> Vec<TrajectorySample> {
        let now = Instant { commands: PULL, ..Instant::default() };
        let sample = |stepper: &mut Stepper| {
            let sample = stepper.sample(&aircraft, &now);
            stepper.hold(&aircraft, &now).map(|()| sample)
        };
        (0..2000).map_while(|_| sample(&mut stepper).ok()).collect()
    };
    let (kept, euler) = (fly_through(fresh().with_quaternion()), fly_through(fresh()));
    assert_eq!(kept[0].state, state);
    let steepest = kept.iter().fold(0.0, |most: f64, sample| most.max(sample.state.theta));
    let inverted = kept.iter().filter(|sample| sample.state.phi.abs() > 2.0).count();
    assert!(steepest > 1.4 && inverted > 200, "{steepest} {inverted}");
    // The same while the nose is low.
    for (a, b) in kept.iter().zip(&euler).take(200) {
        assert!((a.state.theta - b.state.theta).abs() < 1e-9 && (a.state.alpha - b.state.alpha).abs() < 1e-9);
    }
    let planet = Planet::Flat { gravity: aircraft.0.gravity() };
    let world = World { planet, air: AirModel::Simple(Atmosphere::Book), wind: Wind::default() };
    let body = EulerAngles { yaw: 0.0, pitch: state.theta, roll: state.phi };
    let forward = [state.speed * state.alpha.cos(), 0.0, state.speed * state.alpha.sin()];
    let launch = Launch {
        place: Geodetic { altitude: state.altitude, ..Geodetic::default() },
        velocity: phugoid_flight_dynamics::globe::vector::apply_transposed(&body.matrix(), forward),
        euler: body,
        rates: InitialRates::Inertial([state.p, 0.0, 0.0]),
    };
    let mut vehicle = FlownAircraft::new(&aircraft, |_| PULL);
    let (mut step, mut worst) = (0, [0.0_f64; 3]);
    fly(&world, &mut vehicle, launch.state(&planet, 0.0, [0.0]), 0.0, 19.0, 0.0025, |motion| {
        if step % 4 == 0 {
            let (ours, theirs) = (&kept[step / 4].state, &motion.condition);
            let attitude = EulerAngles { yaw: ours.psi, pitch: ours.theta, roll: ours.phi }.matrix();
            let other = theirs.euler.matrix();
            let differences = [
                (ours.speed - theirs.air.speed).abs(),
                (0..9).map(|i| (attitude[i / 3][i % 3] - other[i / 3][i % 3]).abs()).fold(0.0, f64::max),
                (ours.altitude - theirs.place.altitude).abs(),
            ];
            worst = std::array::from_fn(|i| worst[i].max(differences[i]));
        }
        step += 1;
    })
    .unwrap();
    println!("steepest {steepest:.3} rad; {worst:?} m/s, cosines, m");
    assert!(worst[0] < 1e-9 && worst[1] < 1e-11 && worst[2] < 1e-9, "{worst:?}");
}
