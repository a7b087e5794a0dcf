//! Flight over the Earth: geodesy, conservation laws, symmetries, order of the integration.

use phugoid_flight_dynamics::aircraft::Controls;
use phugoid_flight_dynamics::atmosphere::Atmosphere;
use phugoid_flight_dynamics::f16::{F16, F16Options};
use phugoid_flight_dynamics::globe::attitude::{EulerAngles, Quaternion};
use phugoid_flight_dynamics::globe::coefficients::FlownAircraft;
use phugoid_flight_dynamics::globe::condition::{AirModel, Condition, GlobeState, InitialRates, Launch, Wind, World};
use phugoid_flight_dynamics::globe::flight::{FlightError, fly, motion};
use phugoid_flight_dynamics::globe::loads::{BluntBody, ForcesAndMoments, Loads};
use phugoid_flight_dynamics::globe::moving_air::InMovingAir;
use phugoid_flight_dynamics::globe::planet::{Geodetic, Planet};
use phugoid_flight_dynamics::globe::steady::{solve, unsteadiness};
use phugoid_flight_dynamics::globe::vector::{Vector, apply, apply_transposed, cross, dot, norm, subtract};
use phugoid_flight_dynamics::gust::AirMotion;
use phugoid_flight_dynamics::mass::MassProperties;
use phugoid_flight_dynamics::simulate::{Simulation, still_air};
use phugoid_flight_dynamics::trim::{TrimCondition, trim};

fn brick(drag: f64, damping: Vector) -> BluntBody {
    let inertia = [[0.002568, 0.0, 0.0], [0.0, 0.008421, 0.0], [0.0, 0.0, 0.009755]];
    let mass = MassProperties::from_tensor(2.268, inertia, 0.0).unwrap();
    BluntBody { mass, area: 0.020645, span: 0.1016, chord: 0.2032, drag, damping }
}

fn launch() -> Launch {
    Launch {
        place: Geodetic { latitude: 0.6, longitude: -2.1, altitude: 9_000.0 },
        velocity: [120.0, -80.0, -30.0],
        euler: EulerAngles { yaw: 2.0, pitch: 0.4, roll: -1.1 },
        rates: InitialRates::Inertial([0.2, 0.3, 0.5]),
    }
}

#[test]
fn places_come_back_from_their_positions() {
    for planet in [Planet::WGS84, Planet::sphere(6.371e6, 3.986e14, 7e-5)] {
        for latitude in [-90.0_f64, -89.999_999, -45.0, -1e-9, 0.0, 30.0, 60.0, 89.95, 90.0] {
            for longitude in [-180.0_f64, -75.0, 0.0, 1e-8, 179.999_999] {
                for altitude in [-5_000.0, 0.0, 3e3, 4e5, 4e7] {
                    let place =
                        Geodetic { latitude: latitude.to_radians(), longitude: longitude.to_radians(), altitude };
                    let position = planet.position(&place);
                    let back = planet.geodetic(position);
                    assert!(
                        (back.altitude - altitude).abs() < 2e-8 * (1.0 + altitude.abs() / 1e7),
                        "{place:?} {back:?}"
                    );
                    assert!((back.latitude - place.latitude).abs() < 1e-15, "{place:?} {back:?}");
                    let again = planet.position(&back);
                    assert!(norm(subtract(again, position)) < 2e-8, "{place:?} {back:?}");
                }
            }
        }
    }
    // Published point: EPSG guidance note 7-2, geocentric conversion example (WGS 84).
    let back = Planet::WGS84.geodetic([3_771_793.968, 140_253.342, 5_124_304.349]);
    assert!((back.latitude.to_degrees() - (53.0 + 48.0 / 60.0 + 33.82 / 3600.0)).abs() < 2e-8);
    assert!((back.longitude.to_degrees() - (2.0 + 7.0 / 60.0 + 46.38 / 3600.0)).abs() < 2e-8);
    assert!((back.altitude - 73.0).abs() < 2e-3);
}

#[test]
fn gravitation_is_minus_the_slope_of_the_potential() {
    let planet = Planet::WGS84;
    for position in [[7e6, 1e5, -2e6], [1e5, 2e5, 6.5e6], [-4e6, 5e6, 1e3]] {
        let field = planet.gravitation(position);
        for i in 0..3 {
            let (mut up, mut down) = (position, position);
            up[i] += 10.0;
            down[i] -= 10.0;
            let slope = (planet.potential(up) - planet.potential(down)) / 20.0;
            assert!((field[i] + slope).abs() < 1e-8, "{position:?} {i}: {} {slope}", field[i]);
        }
    }
    // Gravity as felt on the turning ellipsoid is normal to it, to what harmonics beyond the second leave.
    let place = Geodetic { latitude: 0.7, longitude: 0.3, altitude: 0.0 };
    let position = planet.position(&place);
    let spin = [0.0, 0.0, planet.rotation_rate()];
    let felt = subtract(planet.gravitation(position), cross(spin, cross(spin, position)));
    let [north, east, down] = apply(&planet.ned_from_earth(&place), felt);
    assert!(north.abs() < 3e-5 && east.abs() < 1e-9, "{north} {east}");
    // Somigliana's closed formula for normal gravity on WGS 84.
    let s2 = 0.7_f64.sin().powi(2);
    let normal = 9.780_325_335_9 * (1.0 + 0.001_931_852_652_41 * s2) / (1.0 - 0.006_694_379_990_14 * s2).sqrt();
    assert!((down - normal).abs() < 7e-5, "{down} {normal}");
}

#[test]
fn attitudes_come_back_from_their_matrices() {
    for yaw in [-3.0, -0.4, 0.0, 1.5, 3.1] {
        for pitch in [-1.57, -0.3, 0.0, 1.2, 1.55] {
            for roll in [-3.1, -1.0, 0.0, 0.2, 3.0] {
                let angles = EulerAngles { yaw, pitch, roll };
                let matrix = angles.matrix();
                let through = Quaternion::of_matrix(&matrix);
                let length: f64 = through.parts.iter().map(|x| x * x).sum();
                assert!((length - 1.0).abs() < 1e-14);
                let back = through.matrix();
                for r in 0..3 {
                    for c in 0..3 {
                        assert!((back[r][c] - matrix[r][c]).abs() < 1e-15 * 4.0);
                    }
                }
                let again = EulerAngles::of_matrix(&matrix);
                assert!((again.pitch - pitch).abs() < 1e-9, "{angles:?} {again:?}");
                let margin = 1e-15 / pitch.cos().abs().max(1e-9) + 1e-14;
                assert!((again.yaw - yaw).abs() < margin && (again.roll - roll).abs() < margin, "{angles:?} {again:?}");
            }
        }
    }
    let up = EulerAngles { yaw: 0.3, pitch: core::f64::consts::FRAC_PI_2, roll: 0.0 };
    assert!((EulerAngles::of_matrix(&up.matrix()).yaw - 0.3).abs() < 1e-9);
}

#[test]
fn free_flight_keeps_energy_and_momenta() {
    for planet in [Planet::WGS84, Planet::sphere(6.371e6, 3.986e14, 7.3e-5)] {
        let world = World { air: AirModel::Vacuum, ..World::new(planet) };
        let mut body = brick(0.1, [-1.0; 3]);
        let inertia = [0.002568, 0.008421, 0.009755];
        let start: GlobeState = launch().state(&planet, 0.0, []);
        let energy = |s: &GlobeState| 0.5 * dot(s.velocity, s.velocity) + planet.potential(s.position);
        // Both fields are symmetric about the axis, so that the momentum about it stays.
        let orbital = |s: &GlobeState| s.position[0] * s.velocity[1] - s.position[1] * s.velocity[0];
        let spin =
            |s: &GlobeState| apply_transposed(&s.attitude.matrix(), core::array::from_fn(|i| inertia[i] * s.rates[i]));
        let end = fly(&world, &mut body, start, 0.0, 30.0, 0.01, |_| ()).unwrap();
        assert!((energy(&end) / energy(&start) - 1.0).abs() < 1e-14, "{planet:?}");
        assert!((orbital(&end) / orbital(&start) - 1.0).abs() < 1e-14, "{planet:?}");
        let (before, after) = (spin(&start), spin(&end));
        assert!(norm(subtract(before, after)) < 1e-9 * norm(before), "{before:?} {after:?}");
    }
}

#[test]
fn the_error_of_a_step_falls_with_its_fourth_power() {
    let world = World::new(Planet::WGS84);
    let end = |step: f64| {
        let start: GlobeState = launch().state(&world.planet, 0.0, []);
        fly(&world, &mut brick(0.5, [-1.0; 3]), start, 0.0, 4.0, step, |_| ()).unwrap()
    };
    let exact = end(0.005);
    let error = |step: f64| {
        let there = end(step);
        norm(subtract(there.rates, exact.rates))
    };
    let ratio = error(0.2) / error(0.1);
    assert!((12.0..22.0).contains(&ratio), "{ratio}");
}

#[test]
fn what_rests_on_the_ground_feels_no_wind_and_turns_with_it() {
    let planet = Planet::WGS84;
    let still = Launch {
        velocity: [0.0; 3],
        rates: InitialRates::Earth([0.0; 3]),
        euler: EulerAngles { yaw: 1.0, pitch: 0.1, roll: 0.2 },
        ..launch()
    };
    let state: GlobeState = still.state(&planet, 500.0, []);
    let condition = Condition::of(&World::new(planet), 500.0, &state);
    assert!(condition.air.speed < 1e-9, "{}", condition.air.speed);
    assert!(norm(condition.rates_to_earth) < 1e-18);
    assert!((condition.place.longitude - still.place.longitude).abs() < 1e-14);
    assert!((condition.place.altitude - still.place.altitude).abs() < 1e-7);
    assert!((condition.euler.yaw - 1.0).abs() < 1e-13 && (condition.euler.roll - 0.2).abs() < 1e-13);
    let local = condition.rates_to_local(&planet);
    assert!(norm(local) < 1e-15, "{local:?}");
    // A wind of 10 m/s towards east comes from the west: a body that looks east has it from behind.
    let world = World { wind: Wind { at_zero: [0.0, 1.0, 0.0], gradient: [0.0, 1e-3, 0.0] }, ..World::new(planet) };
    let east = Launch { euler: EulerAngles { yaw: core::f64::consts::FRAC_PI_2, ..Default::default() }, ..still };
    let condition = Condition::<0>::of(&world, 0.0, &east.state(&planet, 0.0, []));
    assert!((condition.air_velocity[0] + 10.0).abs() < 1e-8, "{:?}", condition.air_velocity);
}

#[test]
fn flights_do_not_depend_on_longitude_nor_on_the_side_of_the_equator() {
    let world = World::new(Planet::WGS84);
    let fall = |launch: &Launch| {
        let mut last = None;
        let start: GlobeState = launch.state(&world.planet, 0.0, []);
        fly(&world, &mut brick(0.5, [-1.0; 3]), start, 0.0, 20.0, 0.02, |m| last = Some(m.condition)).unwrap();
        last.unwrap()
    };
    let here = fall(&launch());
    let mut elsewhere = launch();
    elsewhere.place.longitude += 1.7;
    let there = fall(&elsewhere);
    assert!((here.place.altitude - there.place.altitude).abs() < 1e-6);
    assert!(((there.place.longitude - here.place.longitude) - 1.7).abs() < 1e-13);
    // The mirror image in the equatorial plane: y stays, roll and yaw change sign, north becomes south.
    let mut mirrored = launch();
    mirrored.place.latitude *= -1.0;
    mirrored.velocity[0] *= -1.0;
    mirrored.euler = EulerAngles { yaw: core::f64::consts::PI - 2.0, pitch: 0.4, roll: 1.1 };
    mirrored.rates = InitialRates::Inertial([-0.2, 0.3, -0.5]);
    let there = fall(&mirrored);
    assert!((here.place.altitude - there.place.altitude).abs() < 1e-6);
    assert!((here.place.latitude + there.place.latitude).abs() < 1e-12);
    assert!((here.state.rates[0] + there.state.rates[0]).abs() < 1e-10);
    assert!((here.state.rates[1] - there.state.rates[1]).abs() < 1e-10);
}

#[test]
fn the_flat_earth_has_the_parabola_of_a_throw() {
    let world = World { air: AirModel::Vacuum, ..World::new(Planet::Flat { gravity: 9.8 }) };
    let throw = Launch { place: Geodetic { altitude: 100.0, ..Default::default() }, ..launch() };
    let start: GlobeState = throw.state(&world.planet, 0.0, []);
    let end = fly(&world, &mut brick(0.1, [0.0; 3]), start, 0.0, 3.0, 0.1, |_| ()).unwrap();
    let condition = Condition::of(&world, 3.0, &end);
    assert!((condition.place.altitude - (100.0 + 90.0 - 4.9 * 9.0)).abs() < 1e-9);
    assert!((condition.earth_position[0] - 360.0).abs() < 1e-9 && (condition.ground_velocity[1] + 80.0).abs() < 1e-9);
}

/// A wing whose lift and pitching moment depend on the rate of angle of attack, and a fin on that of sideslip.
struct Lagging {
    mass: MassProperties,
    by_alpha_rate: f64,
    by_beta_rate: f64,
}

impl Loads for Lagging {
    fn mass_properties(&mut self, _: &Condition) -> MassProperties {
        self.mass
    }

    fn loads(&mut self, c: &Condition) -> ForcesAndMoments {
        let pressure = c.air.dynamic_pressure;
        let lift = pressure * (4.0 * c.air.alpha + self.by_alpha_rate * c.angle_rates[0]);
        let side = pressure * (-0.5 * c.air.beta - self.by_beta_rate * c.angle_rates[1]);
        ForcesAndMoments { aerodynamic_force: [0.0, side, -lift], ..Default::default() }
    }

    fn uses_angle_rates(&self) -> bool {
        true
    }
}

#[test]
fn rates_of_the_flow_angles_are_those_of_the_motion() {
    let world =
        World { wind: Wind { at_zero: [3.0, -4.0, 0.5], gradient: [1e-3, 2e-3, 0.0] }, ..World::new(Planet::WGS84) };
    let mass = MassProperties::from_tensor(50.0, [[10.0, 0.0, 0.0], [0.0, 20.0, 0.0], [0.0, 0.0, 25.0]], 0.0).unwrap();
    // The second factor is so large that plain iteration would diverge.
    for (by_alpha_rate, by_beta_rate) in [(0.2, 0.1), (12.0, 9.0)] {
        let mut body = Lagging { mass, by_alpha_rate, by_beta_rate };
        let near = Launch { euler: EulerAngles { yaw: -0.588, pitch: 0.4, roll: 0.2 }, ..launch() };
        let start: GlobeState = near.state(&world.planet, 0.0, []);
        let first = motion(&world, &mut body, 0.0, &start);
        let step = 1e-3;
        let ends: Vec<_> = [-step, step]
            .iter()
            .map(|h| {
                // One Euler step either way: the difference of both is right to second order.
                let moved = GlobeState {
                    position: core::array::from_fn(|i| start.position[i] + h * start.velocity[i]),
                    velocity: core::array::from_fn(|i| start.velocity[i] + h * first.acceleration[i]),
                    attitude: Quaternion {
                        parts: core::array::from_fn(|i| {
                            start.attitude.parts[i] + h * start.attitude.rate(start.rates)[i]
                        }),
                    }
                    .normalised(),
                    ..start
                };
                Condition::of(&world, *h, &moved).air
            })
            .collect();
        let alpha_rate = (ends[1].alpha - ends[0].alpha) / (2.0 * step);
        let beta_rate = (ends[1].beta - ends[0].beta) / (2.0 * step);
        let [alpha, beta] = first.condition.angle_rates;
        assert!((alpha - alpha_rate).abs() < 1e-6, "{alpha} {alpha_rate}");
        assert!((beta - beta_rate).abs() < 1e-6, "{beta} {beta_rate}");
        let caused = first.condition.angle_rates_of(&world, first.specific_force);
        assert!((caused[0] - alpha).abs() + (caused[1] - beta).abs() < 1e-9, "{caused:?} {alpha} {beta}");
    }
}

/// A wing with an engine of its own state, whose thrust lags behind the lever.
struct Glider {
    mass: MassProperties,
    lever: f64,
    incidence: f64,
}

impl Loads<1> for Glider {
    fn mass_properties(&mut self, _: &Condition<1>) -> MassProperties {
        self.mass
    }

    fn loads(&mut self, c: &Condition<1>) -> ForcesAndMoments {
        let pressure = c.air.dynamic_pressure;
        let lift = pressure * 20.0 * 5.0 * c.air.alpha;
        let drag = pressure * 20.0 * 0.02;
        let moment = pressure * 20.0 * (self.incidence - 1.0 * c.air.alpha - 10.0 * c.rates_to_earth[1] / c.air.speed);
        ForcesAndMoments {
            aerodynamic_force: [-drag + lift * c.air.alpha.sin(), 0.0, -lift * c.air.alpha.cos()],
            aerodynamic_moment: [0.0, moment, 0.0],
            other_force: [c.state.internal[0], 0.0, 0.0],
            ..Default::default()
        }
    }

    fn internal_rates(&mut self, c: &Condition<1>) -> [f64; 1] {
        [self.lever - c.state.internal[0]]
    }
}

#[test]
fn a_trimmed_wing_flies_straight_and_level() {
    let world = World::new(Planet::WGS84);
    let mass = MassProperties::from_tensor(1500.0, [[2e3, 0.0, 0.0], [0.0, 3e3, 0.0], [0.0, 0.0, 4e3]], 0.0).unwrap();
    let mut wing = Glider { mass, lever: 0.0, incidence: 0.0 };
    // Along the equator, where east stays east.
    let level = |pitch: f64| Launch {
        place: Geodetic { altitude: 3000.0, ..Default::default() },
        velocity: [0.0, 80.0, 0.0],
        euler: EulerAngles { yaw: core::f64::consts::FRAC_PI_2, pitch, roll: 0.0 },
        rates: InitialRates::Local([0.0; 3]),
    };
    let [pitch, lever, incidence] = solve(
        |&[pitch, lever, incidence]: &[f64; 3]| {
            (wing.lever, wing.incidence) = (lever, incidence);
            let left = unsteadiness(&world, &mut wing, &level(pitch), [lever]);
            [left.along_right_down[0], left.along_right_down[2], left.angular_acceleration[1]]
        },
        [0.05, 500.0, 0.05],
        [1e-4, 1.0, 1e-4],
        1e-11,
    )
    .unwrap();
    (wing.lever, wing.incidence) = (lever, incidence);
    let start = level(pitch).state(&world.planet, 0.0, [lever]);
    let end = fly(&world, &mut wing, start, 0.0, 100.0, 0.1, |_| ()).unwrap();
    let condition = Condition::of(&world, 100.0, &end);
    assert!((condition.place.altitude - 3000.0).abs() < 1e-6, "{}", condition.place.altitude);
    assert!((condition.ground_velocity[1] - 80.0).abs() < 1e-7 && (condition.euler.pitch - pitch).abs() < 1e-9);
    // The engine follows its lever.
    wing.lever = lever + 100.0;
    let end = fly(&world, &mut wing, start, 0.0, 5.0, 0.01, |_| ()).unwrap();
    assert!((end.internal[0] - (lever + 100.0 * (1.0 - (-5.0_f64).exp()))).abs() < 1e-6);
    assert!(solve(|_: &[f64; 1]| [1.0], [0.0], [1.0], 1e-9).is_err());
    assert!(solve(|_: &[f64; 1]| [f64::NAN], [0.0], [1.0], 1e-9).is_err());
}

#[test]
fn unusable_intervals_and_loads_end_the_flight() {
    let world = World::new(Planet::WGS84);
    let start: GlobeState = launch().state(&world.planet, 0.0, []);
    for (duration, step) in [(1.0, 0.0), (1.0, -0.1), (-1.0, 0.1), (f64::NAN, 0.1), (1.0, f64::NAN), (1e9, 1e-9)] {
        let end = fly(&world, &mut brick(0.1, [0.0; 3]), start, 0.0, duration, step, |_| ());
        assert_eq!(end, Err(FlightError::Interval), "{duration} {step}");
    }
    let end = fly(&world, &mut brick(f64::NAN, [0.0; 3]), start, 0.0, 1.0, 0.1, |_| ());
    assert_eq!(end, Err(FlightError::NotFinite { time: 0.1 }));
    let mut times = Vec::new();
    fly(&world, &mut brick(0.1, [0.0; 3]), start, 2.0, 1.05, 0.1, |m| times.push(m.condition.time)).unwrap();
    assert_eq!(times.len(), 12);
    assert!((times[10] - 3.0).abs() < 1e-12 && times[11] == 3.05);
}

#[test]
fn a_steady_gust_is_a_wind() {
    let launch = Launch {
        place: Geodetic { altitude: 9_000.0, ..Default::default() },
        velocity: [0.0; 3],
        euler: EulerAngles::default(),
        // The body keeps its axes along local north, east and down.
        rates: InitialRates::Local([0.0; 3]),
    };
    let wind = World { wind: Wind { at_zero: [0.0, 6.0, 0.0], gradient: [0.0; 3] }, ..World::new(Planet::WGS84) };
    let still = World::new(Planet::WGS84);
    let start: GlobeState = launch.state(&still.planet, 0.0, []);
    let blown = fly(&wind, &mut brick(1.0, [0.0; 3]), start, 0.0, 10.0, 0.01, |_| ()).unwrap();
    let mut asked = Vec::new();
    let gust = |time: f64| {
        asked.push(time);
        AirMotion { velocity: [0.0, 6.0, 0.0], rates: [0.0; 3] }
    };
    let mut gusty = InMovingAir::new(brick(1.0, [0.0; 3]), gust);
    let carried = fly(&still, &mut gusty, start, 0.0, 10.0, 0.01, |_| ()).unwrap();
    assert_eq!(gusty.vehicle().drag, 1.0);
    let apart = norm(subtract(blown.position, carried.position));
    let moved = fly(&still, &mut brick(1.0, [0.0; 3]), start, 0.0, 10.0, 0.01, |_| ()).unwrap();
    let drifted = norm(subtract(blown.position, moved.position));
    assert!(drifted > 5.0 && apart < 1e-3 * drifted, "{drifted} {apart}");
    assert_eq!(asked.len(), 1001);
    // Air that turns with the body damps nothing.
    let condition = Condition::<0>::of(&still, 0.0, &start);
    let turned = condition.in_moving_air(&AirMotion { velocity: [0.0; 3], rates: condition.rates_to_earth });
    assert_eq!((turned.rates_to_earth, turned.air), ([0.0; 3], condition.air));
}

/// The equations over a flat earth in speed, flow angles and Euler angles, and those in Cartesian components and a quaternion:
/// two ways to the same flight.
#[test]
fn over_a_plane_it_flies_as_the_equations_for_a_flat_earth() {
    let aircraft = F16::new(F16Options { cg: 0.30, ..F16Options::default() }).unwrap();
    let steady = trim(&aircraft, &TrimCondition::steady(&aircraft, 205.74, 6096.0, 0.0, 0.0)).unwrap();
    let pulled = Controls { elevator: steady.controls().elevator - 0.02, aileron: 0.01, rudder: -0.01, throttle: 0.3 };
    let mut simulation = Simulation::new(&aircraft, steady.state(), steady.controls(), 10.0);
    simulation.use_actuators = false;
    let flat = simulation.run(|_| pulled, still_air).unwrap();
    let planet = Planet::Flat { gravity: phugoid_flight_dynamics::aircraft::Aircraft::gravity(&aircraft) };
    let world = World { air: AirModel::Simple(Atmosphere::Book), ..World::new(planet) };
    let state = steady.state();
    let launch = Launch {
        place: Geodetic { altitude: state.altitude, ..Default::default() },
        velocity: [state.speed, 0.0, 0.0],
        euler: EulerAngles { yaw: state.psi, pitch: state.theta, roll: state.phi },
        rates: InitialRates::Earth([state.p, state.q, state.r]),
    };
    let mut vehicle = FlownAircraft::new(&aircraft, |_| pulled);
    let mut row = 0;
    let start = launch.state(&planet, 0.0, [state.power]);
    fly(&world, &mut vehicle, start, 0.0, 10.0, 0.01, |motion| {
        let (ours, theirs) = (&motion.condition, &flat.samples[row].state);
        let close =
            |a: f64, b: f64, what: &str| assert!((a - b).abs() < 1e-6 + 1e-8 * b.abs(), "{row} {what}: {a} {b}");
        close(ours.air.speed, theirs.speed, "speed");
        close(ours.air.alpha, theirs.alpha, "alpha");
        close(ours.air.beta, theirs.beta, "beta");
        close(ours.euler.roll, theirs.phi, "phi");
        close(ours.euler.pitch, theirs.theta, "theta");
        close(ours.euler.yaw, theirs.psi, "psi");
        close(ours.rates_to_earth[1], theirs.q, "q");
        close(ours.place.altitude, theirs.altitude, "altitude");
        close(ours.state.internal[0], theirs.power, "power");
        row += 1;
    })
    .unwrap();
    assert_eq!(row, flat.samples.len());
}
