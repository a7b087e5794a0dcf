//! How fast an aircraft of JSBSim is read and flown over a flat earth. `scripts/jsbsim/speed.sh` calls it and sets its figures
//! against those of JSBSim itself.
//!
//! ```text
//! cargo run --release -p phugoid-aircraft --example flown_speed -- FOLDER SPEED ALTITUDE ERROR
//! ```
//!
//! FOLDER is that of the aircraft, SPEED in m/s, ALTITUDE in m, and ERROR the largest difference of an angle in rad that a step of
//! the integration may make in ten seconds. Prints one figure a line. Times are those of the fastest of several pieces, which a
//! busy machine disturbs least; nothing is taken from one evaluation to the next that would not be taken in a flight.

use std::error::Error;
use std::hint::black_box;
use std::time::Instant;

use phugoid_aircraft::flown::AircraftFile;
use phugoid_flight_dynamics::aircraft::{Aircraft, Controls, State};
use phugoid_flight_dynamics::integrate::rk4_step;
use phugoid_flight_dynamics::motion::{Disturbance, motion};
use phugoid_flight_dynamics::trim::{TrimCondition, trim};

/// Length of the flight, and time between its samples, s.
const DURATION_S: f64 = 10.0;
const SAMPLE_S: f64 = 0.5;
/// Steps that are tried in turn, as parts of the time between samples.
const PARTS: [usize; 12] = [1, 2, 3, 4, 5, 8, 10, 16, 20, 32, 60, 120];
/// Parts of the flight that the others are compared with: steps of 1 ms.
const FINE: usize = 500;
/// Pieces that are timed, of which the fastest counts, and the least length of each, s.
const PIECES: usize = 7;
const PIECE_S: f64 = 0.2;
/// Place of the angles of attack, sideslip, bank and pitch in a state.
const ANGLES: std::ops::Range<usize> = 1..5;

struct Flight<'a> {
    aircraft: &'a AircraftFile,
    start: [f64; 13],
    controls: Controls,
}

impl Flight<'_> {
    fn rates(&self, x: &[f64; 13]) -> [f64; 13] {
        let still = Disturbance::default();
        motion(self.aircraft, &State::from_array(*x), &self.controls, &still).rates.to_array()
    }

    fn step(&self, x: &[f64; 13], step_s: f64) -> [f64; 13] {
        rk4_step(|_, x| self.rates(x), 0.0, x, step_s)
    }

    /// The states at the samples, with so many steps between two of them.
    fn flown(&self, parts: usize) -> Vec<[f64; 13]> {
        let step_s = SAMPLE_S / parts as f64;
        let mut samples = vec![self.start];
        let mut x = self.start;
        while samples.len() as f64 * SAMPLE_S <= DURATION_S {
            for _ in 0..parts {
                x = self.step(&x, step_s);
            }
            samples.push(x);
        }
        samples
    }
}

/// The time of one call, s.
fn timed(mut call: impl FnMut(usize)) -> f64 {
    let mut fastest = f64::INFINITY;
    for _ in 0..PIECES {
        let (clock, mut calls) = (Instant::now(), 0_usize);
        while clock.elapsed().as_secs_f64() < PIECE_S {
            for _ in 0..100 {
                call(calls);
                calls += 1;
            }
        }
        fastest = fastest.min(clock.elapsed().as_secs_f64() / calls as f64);
    }
    fastest
}

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [folder, speed, altitude, error] = arguments.as_slice() else {
        return Err("expected FOLDER SPEED ALTITUDE ERROR".into());
    };
    let (speed, altitude, allowed): (f64, f64, f64) = (speed.parse()?, altitude.parse()?, error.parse()?);

    let mut load_s = f64::INFINITY;
    for _ in 0..10 {
        let clock = Instant::now();
        black_box(AircraftFile::open(folder)?);
        load_s = load_s.min(clock.elapsed().as_secs_f64());
    }
    let aircraft = AircraftFile::open(folder)?;
    let level = trim(&aircraft, &TrimCondition::steady(&aircraft, speed, altitude, 0.0, 0.0))?;
    let controls = Controls {
        throttle: level.throttle,
        elevator: level.elevator_rad,
        aileron: level.aileron_rad,
        rudder: level.rudder_rad,
    };
    // Out of trim, so that the short period, the Dutch roll and the roll are in the flight.
    let mut start = State::from_array([0.0; 13]);
    (start.speed, start.alpha, start.beta) = (speed, level.alpha_rad + 0.02, level.beta_rad + 0.02);
    (start.theta, start.phi, start.altitude) = (level.theta_rad + 0.02, 0.1, altitude);
    start.power = aircraft.steady_power(level.throttle);
    let flight = Flight { aircraft: &aircraft, start: start.to_array(), controls };

    let fine = flight.flown(FINE);
    let error_of = |parts: usize| {
        let pairs = flight.flown(parts).into_iter().zip(&fine);
        pairs.flat_map(|(x, y)| ANGLES.map(move |k| (x[k] - y[k]).abs())).fold(
            0.0,
            // What is not a number is no small error.
            |most: f64, difference| if difference <= most { most } else { difference },
        )
    };
    let found = PARTS.iter().map(|&parts| (parts, error_of(parts))).find(|(_, error)| *error <= allowed);
    let (parts, error) = found.ok_or("no step is short enough for the error that is allowed")?;

    // States along the flight, each with what the functions below are asked for.
    let mut x = flight.start;
    let states: Vec<[f64; 13]> = (0..1000)
        .map(|_| {
            x = flight.step(&x, 0.01);
            x
        })
        .collect();
    let still = Disturbance::default();
    let airs: Vec<_> =
        states.iter().map(|x| motion(&aircraft, &State::from_array(*x), &controls, &still).air).collect();
    let evaluation_s = timed(|k| {
        black_box(flight.rates(&states[k % states.len()]));
    });
    let aerodynamics_s = timed(|k| {
        let x = &states[k % states.len()];
        black_box(aircraft.coefficients(&airs[k % airs.len()], [x[6], x[7], x[8]], &controls));
    });
    let propulsion_s = timed(|k| {
        let x = &states[k % states.len()];
        black_box(aircraft.propulsion(x[12], x[11], airs[k % airs.len()].mach));
    });
    let mut x = flight.start;
    let step_s = timed(|k| {
        if k % 1000 == 0 {
            x = black_box(flight.start);
        }
        x = flight.step(&x, 0.01);
    });
    black_box(x);

    // The formula of Adams and Bashforth, with which JSBSim integrates: one evaluation in a step.
    let (mut x, mut before) = (flight.start, flight.rates(&flight.start));
    let one_evaluation_s = timed(|k| {
        if k % 1000 == 0 {
            x = black_box(flight.start);
        }
        let now = flight.rates(&x);
        x = std::array::from_fn(|i| x[i] + 0.01 * (1.5 * now[i] - 0.5 * before[i]));
        before = now;
    });
    black_box(x);

    println!("load_s {load_s:e}");
    println!("evaluation_s {evaluation_s:e}");
    println!("aerodynamics_s {aerodynamics_s:e}");
    println!("propulsion_s {propulsion_s:e}");
    println!("rk4_step_s {step_s:e}");
    println!("adams_bashforth_step_s {one_evaluation_s:e}");
    println!("step_at_equal_error_s {:e}", SAMPLE_S / parts as f64);
    println!("error_rad {error:e}");
    println!("flight_per_processor_second {:e}", SAMPLE_S / parts as f64 / step_s);
    Ok(())
}
