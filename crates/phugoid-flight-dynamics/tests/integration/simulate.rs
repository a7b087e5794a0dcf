//! Simulated flights: switching inputs, actuators, gusts, damage, and agreement with the adaptive integrator.
#![allow(clippy::unwrap_used, clippy::panic)] // helpers of tests are tests

use phugoid_flight_dynamics::aircraft::{Aircraft, Controls, STATES, State};
use phugoid_flight_dynamics::f16::{F16, F16Options};
use phugoid_flight_dynamics::gust::{BodyAxis, Gust};
use phugoid_flight_dynamics::increments::{IncrementChange, IncrementSchedule, Increments};
use phugoid_flight_dynamics::integrate::DormandPrince;
use phugoid_flight_dynamics::motion::{Disturbance, motion};
use phugoid_flight_dynamics::simulate::{CommandHold, Simulation, SimulationError, Trajectory, still_air};
use phugoid_flight_dynamics::trim::{Trim, TrimCondition, trim};

fn study_case() -> (F16, Trim) {
    let aircraft = F16::new(F16Options { cg: 0.30, ..F16Options::default() }).unwrap();
    let t = trim(&aircraft, &TrimCondition::level(675.0 * 0.3048, 20_000.0 * 0.3048)).unwrap();
    (aircraft, t)
}

/// A doublet of 1 deg from 0.5 to 1.5 s.
fn doublet(t: &Trim) -> impl Fn(f64) -> Controls + Copy {
    let trimmed = t.controls();
    move |time| {
        let sign = if (0.5..1.0).contains(&time) {
            1.0
        } else if (1.0..1.5).contains(&time) {
            -1.0
        } else {
            0.0
        };
        Controls { elevator: trimmed.elevator + sign * 1.0_f64.to_radians(), ..trimmed }
    }
}

fn largest_difference(a: &State, b: &State) -> f64 {
    let scale = [100.0, 0.1, 0.1, 0.1, 0.1, 0.1, 0.1, 0.1, 0.1, 1e3, 1e3, 1e3, 10.0];
    let (a, b) = (a.to_array(), b.to_array());
    (0..STATES).map(|i| (a[i] - b[i]).abs() / scale[i]).fold(0.0, f64::max)
}

#[test]
fn a_trimmed_aircraft_stays_trimmed_with_its_actuators() {
    let (aircraft, t) = study_case();
    let flight = Simulation::new(&aircraft, t.state(), t.controls(), 20.0).run(|_| t.controls(), still_air).unwrap();
    assert_eq!(flight.samples.len(), 2001);
    let last = flight.samples.last().unwrap();
    let start = State { north: 20.0 * t.speed_m_s, ..t.state() };
    assert!(largest_difference(&last.state, &start) < 1e-8, "{last:?}");
    assert!((last.specific_force[2] + t.load_factor * aircraft.gravity()).abs() < 1e-8);
}

#[test]
fn a_command_acts_from_its_own_sample_on() {
    let (aircraft, t) = study_case();
    let simulation = Simulation { use_actuators: false, ..Simulation::new(&aircraft, t.state(), t.controls(), 2.0) };
    let flight = simulation.run(doublet(&t), still_air).unwrap();
    let step = 1.0_f64.to_radians();
    for (k, sample) in flight.samples.iter().enumerate() {
        let expected = match k {
            50..100 => step,
            100..150 => -step,
            _ => 0.0,
        };
        assert!((sample.surfaces.elevator - t.elevator_rad - expected).abs() < 1e-15, "sample {k}");
        assert_eq!(sample.surfaces, sample.commands);
    }
    let [before, at, after] = [49, 50, 51].map(|k| flight.samples[k]);
    assert!(before.angular_acceleration[1].abs() < 1e-9 && at.state.q.abs() < 1e-11);
    // The moment jumps at once, the rate follows: q(0.51) = 0.01 q'(0.5+) to first order.
    assert!(at.angular_acceleration[1] < -0.1, "{at:?}");
    assert!((after.state.q / (0.01 * at.angular_acceleration[1]) - 1.0).abs() < 0.02, "{after:?}");
}

/// The same flight by the adaptive method, restarted at every switch.
fn adaptive(aircraft: &F16, t: &Trim, command: impl Fn(f64) -> Controls, end: f64) -> State {
    let solver = DormandPrince::<STATES>::with_tolerances(1e-12, 1e-12);
    let mut x = t.state().to_array();
    for interval in [0.0, 0.5, 1.0, 1.5, end].windows(2) {
        let controls = command(interval[0]);
        let rates = |_: f64, x: &[f64; STATES]| {
            motion(aircraft, &State::from_array(*x), &controls, &Disturbance::default()).rates.to_array()
        };
        x = solver.integrate(rates, interval[0], &x, interval[1]).unwrap();
    }
    State::from_array(x)
}

#[test]
fn a_doublet_agrees_with_the_adaptive_integrator() {
    let (aircraft, t) = study_case();
    let reference = adaptive(&aircraft, &t, doublet(&t), 5.0);
    let error = |substeps: usize| {
        let simulation =
            Simulation { use_actuators: false, substeps, ..Simulation::new(&aircraft, t.state(), t.controls(), 5.0) };
        let flight = simulation.run(doublet(&t), still_air).unwrap();
        largest_difference(&flight.samples.last().unwrap().state, &reference)
    };
    let errors = [1, 2, 4].map(error);
    println!("largest scaled difference with 1, 2, 4 steps per 10 ms: {errors:?}");
    // The tables have kinks, which cost the order of convergence but not the accuracy.
    assert!(errors[0] < 1e-9 && errors[2] < errors[0], "{errors:?}");
}

#[test]
fn the_recorded_accelerations_are_the_rates_of_the_recorded_states() {
    let (aircraft, t) = study_case();
    let simulation = Simulation { substeps: 4, ..Simulation::new(&aircraft, t.state(), t.controls(), 4.0) };
    let flight = simulation.run(doublet(&t), still_air).unwrap();
    let mut largest: f64 = 0.0;
    for w in flight.samples.windows(3) {
        // Away from the switches the central difference is good to (0.01 s)^2 q'''/6.
        let near_switch = [0.5, 1.0, 1.5].iter().any(|s: &f64| (w[1].time - s).abs() < 0.25);
        if !near_switch {
            let difference = (w[2].state.q - w[0].state.q) / 0.02;
            assert!((difference - w[1].angular_acceleration[1]).abs() < 1e-3, "{} s", w[1].time);
            largest = largest.max(difference.abs());
        }
    }
    assert!(largest > 0.05, "{largest}");
}

#[test]
fn surfaces_follow_their_actuators() {
    let (aircraft, t) = study_case();
    let simulation = Simulation { substeps: 10, ..Simulation::new(&aircraft, t.state(), t.controls(), 1.0) };
    let step = 0.02;
    let command = Controls { elevator: t.elevator_rad - step, ..t.controls() };
    let flight = simulation.run(|_| command, still_air).unwrap();
    let lag = aircraft.actuators.elevator.lag;
    for sample in &flight.samples {
        let expected = t.elevator_rad - step * (1.0 - (-sample.time / lag).exp());
        assert!((sample.surfaces.elevator - expected).abs() < 1e-8, "{} s", sample.time);
        assert_eq!(sample.commands.elevator, command.elevator);
    }
    // A command beyond the stop ends at the stop and goes there at the limited rate.
    let far = Controls { rudder: 3.0, ..t.controls() };
    let flight = simulation.run(|_| far, still_air).unwrap();
    let rudder = aircraft.actuators.rudder;
    assert!((flight.samples[10].surfaces.rudder - 0.1 * rudder.rate_limit).abs() < 1e-9);
    assert!(flight.samples.iter().all(|s| s.surfaces.rudder <= rudder.limit));
}

#[test]
fn held_commands_and_those_taken_at_every_step() {
    let (aircraft, t) = study_case();
    let sine = |time: f64| Controls { elevator: t.elevator_rad + 0.01 * (6.0 * time).sin(), ..t.controls() };
    let fly = |hold, substeps| {
        let base = Simulation::new(&aircraft, t.state(), t.controls(), 3.0);
        Simulation { use_actuators: false, hold, substeps, sample_time: 0.05, ..base }.run(sine, still_air).unwrap()
    };
    let end = |flight: &Trajectory| flight.samples.last().unwrap().state;
    let (held, often) = (fly(CommandHold::Sample, 50), fly(CommandHold::Step, 50));
    // Held samples lag by half a sample, 25 ms of a motion of some 0.05 rad/s.
    assert!((end(&held).q - end(&often).q).abs() > 1e-4);
    let finer = fly(CommandHold::Step, 500);
    assert!((end(&finer).q - end(&often).q).abs() < 3e-5);
}

#[test]
fn damage_begins_at_its_time() {
    let (aircraft, t) = study_case();
    let damage = Increments { dCm_alpha: -0.2, dCm_q: -2.0, dCL_alpha: 0.4, ..Increments::NONE };
    let damage = damage.about(t.alpha_rad, 0.0, t.elevator_rad);
    let change = |time| IncrementSchedule::new(vec![IncrementChange { time, increments: damage }]).unwrap();
    let fly = |increments| {
        let base = Simulation::new(&aircraft, t.state(), t.controls(), 3.0);
        Simulation { increments, ..base }.run(doublet(&t), still_air).unwrap()
    };
    let (healthy, damaged) = (fly(IncrementSchedule::default()), fly(change(0.8)));
    for (a, b) in healthy.samples.iter().zip(&damaged.samples) {
        // The state is the same up to the damage, the moments differ from it on.
        assert_eq!(a.state == b.state, a.time <= 0.8, "{} s", a.time);
        assert_eq!(a.coefficients == b.coefficients, a.time < 0.8, "{} s", a.time);
    }
}

#[test]
fn a_gust_changes_the_air_data_first() {
    let (aircraft, t) = study_case();
    let gust = Gust { axis: BodyAxis::X, amplitude: 6.0, duration: 1.0, delay: 0.5 };
    let flight = Simulation::new(&aircraft, t.state(), t.controls(), 1.0)
        .run(|_| t.controls(), |time| gust.velocity(time))
        .unwrap();
    for sample in &flight.samples {
        let [u, v, w] = gust.velocity(sample.time);
        assert_eq!([v, w], [0.0; 2]);
        let (sin, cos) = sample.state.alpha.sin_cos();
        let expected = (sample.state.speed * cos - u).hypot(sample.state.speed * sin);
        assert!((sample.air.speed - expected).abs() < 1e-9, "{} s", sample.time);
    }
    assert!(flight.samples[100].air.speed < t.speed_m_s - 2.5);
}

#[test]
fn a_pilot_can_hold_an_unstable_aircraft() {
    // At cg 0.35 and 502 ft/s the pitch motion diverges: double in 7.1 s.
    let aircraft = F16::new(F16Options::default()).unwrap();
    let t = trim(&aircraft, &TrimCondition::level(502.0 * 0.3048, 0.0)).unwrap();
    let start = State { theta: t.theta_rad + 1e-3, ..t.state() };
    let simulation = Simulation::new(&aircraft, start, t.controls(), 40.0);
    let off = |flight: &Trajectory| (flight.samples.last().unwrap().state.theta - t.theta_rad).abs();
    let alone = simulation.run(|_| t.controls(), still_air).unwrap();
    let pilot = |_: f64, x: &State| Controls {
        elevator: t.elevator_rad + 0.5 * (x.theta - t.theta_rad) + 0.3 * x.q,
        ..t.controls()
    };
    let held = simulation.run_closed_loop(pilot, still_air).unwrap();
    assert!(off(&alone) > 0.01 && off(&held) < 1e-4, "{} {}", off(&alone), off(&held));
}

#[test]
fn failures_name_time_and_state() {
    let (aircraft, t) = study_case();
    let simulation = Simulation::new(&aircraft, t.state(), t.controls(), 1.0);
    let broken = |time: f64| Controls { throttle: if time < 0.5 { t.throttle } else { f64::NAN }, ..t.controls() };
    match simulation.run(broken, still_air) {
        Err(SimulationError::NotFinite { state: "speed", time, last_speed }) => {
            assert_eq!(time, 0.51);
            assert!((last_speed - t.speed_m_s).abs() < 1e-6);
        }
        other => panic!("{other:?}"),
    }
    let none = Simulation { substeps: 0, ..simulation };
    assert!(matches!(none.run(|_| t.controls(), still_air), Err(SimulationError::InvalidTimes { substeps: 0, .. })));
}
