//! Flights of the Generic Transport Model in which damage happens.

use phugoid_aircraft::transport::{Damage, Transport, fly_damaged, moved_to};
use phugoid_flight_dynamics::aircraft::{Aircraft, Controls, State};
use phugoid_flight_dynamics::increments::{IncrementChange, IncrementSchedule, Increments};
use phugoid_flight_dynamics::motion::{Disturbance, motion};
use phugoid_flight_dynamics::simulate::{Simulation, TrajectorySample, still_air};
use phugoid_simulation::flight::fly_aircraft;
use phugoid_simulation::scenario::Scenario;

use crate::transport::{level, whole};

/// A flight of 4 s from trim with a doublet of the elevator at the beginning and damage at 2 s.
fn flight(whole: &Transport, damage: Damage) -> [Vec<TrajectorySample>; 2] {
    let start = level(whole).unwrap();
    let commands = |time: f64| {
        let step = if (0.5..1.0).contains(&time) { -0.01 } else { 0.0 };
        Controls { elevator: start.elevator_rad + step, ..start.controls() }
    };
    let simulation = Simulation::new(whole, start.state(), start.controls(), 4.0);
    let undamaged = simulation.run(commands, still_air).unwrap();
    let damaged = whole.damaged(damage).unwrap();
    let flown = fly_damaged(&simulation, &damaged, 2.0, commands, still_air).unwrap();
    [undamaged.samples, flown.samples]
}

#[test]
fn damage_in_flight_leaves_what_was_before_and_changes_what_comes() {
    let Some(whole) = whole() else { return };
    for damage in Damage::ALL {
        let [undamaged, flown] = flight(&whole, damage);
        assert_eq!(undamaged.len(), flown.len());
        assert!(undamaged.iter().zip(&flown).all(|(a, b)| a.time == b.time), "{damage}: other times");
        assert_eq!(undamaged[..200], flown[..200], "{damage}");
        let (before, after) = (&undamaged[200], &flown[200]);
        // The body moves on as it did.
        assert_eq!(
            [before.state.p, before.state.q, before.state.r, before.state.phi, before.state.power],
            [after.state.p, after.state.q, after.state.r, after.state.phi, after.state.power]
        );
        assert_eq!(before.surfaces, after.surfaces);
        let (a, b) = (&undamaged[400].state, &flown[400].state);
        println!(
            "{damage}: after 2 s phi {:.2} deg, theta {:.2} deg, beta {:.2} deg; whole {:.2} {:.2} {:.2}",
            b.phi.to_degrees(),
            b.theta.to_degrees(),
            b.beta.to_degrees(),
            a.phi.to_degrees(),
            a.theta.to_degrees(),
            a.beta.to_degrees()
        );
        let turn = flown[200].angular_acceleration;
        match damage {
            // The flight is the same but for the rounding of a state that is taken apart and put together.
            Damage::None => assert!((a.theta - b.theta).abs() < 1e-9 && (a.speed - b.speed).abs() < 1e-9),
            // The side that lost lift goes down.
            Damage::LeftWingTipOff | Damage::LeftOutboardFlapOff => {
                assert!(turn[0] < -0.5 && b.phi < a.phi - 0.3, "{damage}: {turn:?} {b:?}");
            }
            // Less tail than trimmed for, and a centre of gravity ahead: the nose goes down.
            Damage::LeftStabiliserOff => assert!(turn[1] < -0.1 && b.theta < a.theta - 0.02, "{turn:?} {b:?}"),
            // What little yaw there is grows without a tail.
            Damage::VerticalTailOff => assert!(b.beta.abs() > 10.0 * a.beta.abs(), "{b:?} {a:?}"),
            Damage::RudderOff | Damage::LeftElevatorOff => assert!((b.theta - a.theta).abs() > 1e-3, "{damage}"),
            _ => unreachable!(),
        }
    }
}

#[test]
fn a_vertical_tail_that_goes_lets_a_disturbance_in_yaw_grow() {
    let Some(whole) = whole() else { return };
    let start = level(&whole).unwrap();
    let initial = State { beta: start.beta_rad + 0.02, ..start.state() };
    let simulation = Simulation::new(&whole, initial, start.controls(), 3.0);
    let tailless = whole.damaged(Damage::VerticalTailOff).unwrap();
    let largest = |samples: &[TrajectorySample]| {
        samples.iter().skip(200).map(|sample| sample.state.beta.abs()).fold(0.0, f64::max)
    };
    let steady = simulation.run(|_| start.controls(), still_air).unwrap();
    let flown = fly_damaged(&simulation, &tailless, 0.0, |_| start.controls(), still_air).unwrap();
    assert!(largest(&steady.samples) < 0.02, "{}", largest(&steady.samples));
    assert!(largest(&flown.samples) > 0.3, "{}", largest(&flown.samples));
    // Beyond the end nothing happens.
    assert_eq!(fly_damaged(&simulation, &tailless, 9.0, |_| start.controls(), still_air).unwrap(), steady);
}

/// A flight that is cut in two without damage is the flight in one piece, changes of the increments included.
#[test]
fn a_flight_in_two_parts_keeps_its_times() {
    let Some(whole) = whole() else { return };
    let start = level(&whole).unwrap();
    let change = |time: f64, slope: f64| IncrementChange {
        time,
        increments: Increments { dCm_alpha: slope, ..Increments::NONE },
    };
    let changes = vec![change(f64::NEG_INFINITY, 0.0), change(0.5, 0.05), change(1.11, -0.1), change(1.83, 0.02)];
    let simulation = Simulation {
        increments: IncrementSchedule::new(changes).unwrap(),
        ..Simulation::new(&whole, start.state(), start.controls(), 2.5)
    };
    let commands = |time: f64| Controls {
        elevator: start.elevator_rad + if time >= 1.47 { 0.01 } else { 0.0 },
        ..start.controls()
    };
    let flight = simulation.run(commands, still_air).unwrap();
    for at in [0.29, 1.01, 1.11, 2.5] {
        let parts = fly_damaged(&simulation, &whole, at, commands, still_air).unwrap();
        assert_eq!(parts.samples.len(), flight.samples.len());
        for (a, b) in parts.samples.iter().zip(&flight.samples) {
            assert_eq!((a.time, a.commands), (b.time, b.commands), "{at}");
            let difference = (a.state.p - b.state.p).abs().max((a.state.q - b.state.q).abs());
            assert!(difference < 1e-9, "{at}: {difference:e} at {}", a.time);
        }
    }
    assert_eq!(fly_damaged(&simulation, &whole, f64::NAN, commands, still_air).unwrap(), flight);
}

/// A point of the body has the same velocity and the same place before and after.
#[test]
fn the_centre_of_gravity_moves_within_the_body() {
    let Some(whole) = whole() else { return };
    let damaged = whole.damaged(Damage::LeftStabiliserOff).unwrap();
    let state = State {
        speed: 41.0,
        alpha: 0.09,
        beta: -0.04,
        phi: 0.7,
        theta: 0.2,
        psi: -1.1,
        p: 0.8,
        q: -0.5,
        r: 0.3,
        north: 10.0,
        east: -5.0,
        altitude: 300.0,
        power: 30.0,
    };
    let there = moved_to(&whole, &damaged, &state);
    let (a, b) = (whole.centre_of_gravity(), damaged.centre_of_gravity());
    let way: [f64; 3] = std::array::from_fn(|i| b[i] - a[i]);
    assert!((way[0] - 0.553 * 0.0254).abs() < 1e-12 && way[1] > 0.0);
    let velocity = |s: &State| {
        let [sa, sb, ca, cb] = [s.alpha.sin(), s.beta.sin(), s.alpha.cos(), s.beta.cos()];
        [s.speed * ca * cb, s.speed * sb, s.speed * sa * cb]
    };
    let (u, v) = (velocity(&state), velocity(&there));
    let turning =
        [state.q * way[2] - state.r * way[1], state.r * way[0] - state.p * way[2], state.p * way[1] - state.q * way[0]];
    for i in 0..3 {
        assert!((v[i] - u[i] - turning[i]).abs() < 1e-12, "{i}");
    }
    let moved = [there.north - state.north, there.east - state.east, there.altitude - state.altitude];
    let square = |v: [f64; 3]| v.iter().map(|x| x * x).sum::<f64>();
    assert!((square(moved) - square(way)).abs() < 1e-12);
    // The rate of the position before and after is that of the two centres: their difference turns with the body.
    let rates = |aircraft: &Transport, state: &State| {
        let rates = motion(aircraft, state, &Controls::default(), &Disturbance::default()).rates;
        [rates.north, rates.east, rates.altitude]
    };
    let step = 1e-6;
    let turned = motion(&whole, &state, &Controls::default(), &Disturbance::default()).rates;
    let later = State {
        phi: state.phi + step * turned.phi,
        theta: state.theta + step * turned.theta,
        psi: state.psi + step * turned.psi,
        ..state
    };
    let after = moved_to(&whole, &damaged, &later);
    let (first, second) = (rates(&whole, &state), rates(&damaged, &there));
    for (i, now) in
        [after.north - later.north, after.east - later.east, after.altitude - later.altitude].iter().enumerate()
    {
        assert!(((now - moved[i]) / step - (second[i] - first[i])).abs() < 1e-6, "{i}");
    }
    assert_eq!(damaged.geometry().wing_area, whole.geometry().wing_area);
}

#[test]
fn a_scenario_is_flown_damaged() {
    let Some(whole) = whole() else { return };
    let scenario = Scenario::parse(
        r#"
name = "transport-doublet"
sample_rate = "100 Hz"
duration = "10 s"
[aircraft]
type = "f16" # not read
[condition]
speed = "40 m/s"
altitude = "300 m"
[[manoeuvre]]
type = "doublet"
surface = "elevator"
amplitude = "2 deg"
start = "1 s"
width = "0.4 s"
"#,
        "transport-doublet",
    )
    .unwrap();
    let aircraft = whole.damaged(Damage::LeftStabiliserOff).unwrap();
    let flight = fly_aircraft(&aircraft, &scenario, &|_| ()).unwrap();
    assert!(flight.held_until_s().is_infinite() && flight.trim.elevator_rad < -0.05);
    let q = &flight.truth.channel("q").unwrap().values;
    assert!(q.iter().fold(0.0_f64, |most, q| most.max(q.abs())) > 0.05);
}
