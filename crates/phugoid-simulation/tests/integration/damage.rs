//! Damage and failures in flight: what they do, what the truth of an estimate is then, and how mistakes are told.
#![allow(clippy::unwrap_used)]

use phugoid_flight_dynamics::aircraft::Aircraft as _;
use phugoid_flight_dynamics::increments::Increments;
use phugoid_flight_dynamics::linearize::linearize;
use phugoid_flight_dynamics::motion::Disturbance;
use phugoid_simulation::course::Course;
use phugoid_simulation::flight::{fly, trimmed_aircraft};
use phugoid_simulation::quantity::Time;
use phugoid_simulation::scenario::Scenario;

const CALM: &str = include_str!("../../../../scenarios/f16-calm.toml");

fn with(more: &str) -> Scenario {
    let quiet = CALM.split("[increments]").next().unwrap();
    Scenario::parse(&format!("{quiet}\n{more}"), "test").unwrap()
}

fn refusal(more: &str) -> String {
    let quiet = CALM.split("[increments]").next().unwrap();
    Scenario::parse(&format!("{quiet}\n{more}"), "test").unwrap_err().to_string()
}

/// The increments that a damage amounts to make an undamaged aircraft move as the damaged one does, near the trim: the same
/// derivatives of every rate, but for couplings, which no increment has.
#[test]
fn what_damage_amounts_to_moves_the_aircraft_in_the_same_way() {
    let scenario = with(
        "[[damage]]\nat = \"0 s\"\nmass = 0.93\ninertia = [0.9, 0.95, 1.05]\ncg_shift = 0.02\n\
         effectiveness = { elevator = 0.6, aileron = 0.5, rudder = 0.3 }\nincrements = { dCm_q = 1.5, dCn_beta = -0.03 }\n\
         constants = { Cm = 0.01, Cl = -0.003, CL = -0.02 }\n",
    );
    let (aircraft, trim) = trimmed_aircraft(&scenario).unwrap();
    let damaged = Course::new(&scenario, aircraft.as_ref(), None, &trim).unwrap();
    let truth = fly(&scenario).unwrap().true_parameters;
    let mut increments = Increments::NONE.about(trim.alpha_rad, trim.q_rad_s, trim.elevator_rad);
    for (name, value) in &truth {
        if let Some(place) = increments.by_name_mut(name) {
            *place = *value;
        }
    }
    let (state, controls) = (trim.state(), trim.controls());
    let found = damaged.linear_model(&state, &controls);
    let disturbance = Disturbance { increments, ..Disturbance::default() };
    let expected = linearize(aircraft.as_ref(), &state, &controls, &disturbance);
    // Rates of sideslip and of roll, pitch and yaw rate by alpha, beta, p, q, r; the rotor's momentum keeps its size while the
    // inertia changes, which is the second-order part that is left out.
    for row in [2, 6, 7, 8] {
        for column in [2, 6, 8] {
            let (found, expected) = (found.a[row][column], expected.a[row][column]);
            assert!((found - expected).abs() < 2e-3 * (1.0 + expected.abs()), "{row} {column}: {found} {expected}");
        }
        for input in 1..4 {
            let (found, expected) = (found.b[row][input], expected.b[row][input]);
            assert!((found - expected).abs() < 1e-9 * (1.0 + expected.abs()), "{row} {input}: {found} {expected}");
        }
    }
    // Constants: the moment that is out of trim, over the known inertia.
    let geometry = aircraft.geometry();
    let air = aircraft.atmosphere().at(trim.altitude_m);
    let force = 0.5 * air.density * trim.speed_m_s.powi(2) * geometry.wing_area;
    let moment = [
        truth["dCl_0"] * force * geometry.span,
        truth["dCm_0"] * force * geometry.mean_chord,
        truth["dCn_0"] * force * geometry.span,
    ];
    let expected = aircraft.mass_properties().angular_acceleration([0.0; 3], moment);
    for (i, row) in [6, 7, 8].into_iter().enumerate() {
        assert!((found.rates[row] - expected[i]).abs() < 1e-3 * (1.0 + expected[i].abs()), "{row}");
    }
}

#[test]
fn damage_that_grows_is_half_there_half_way() {
    let scenario = with(
        "[[damage]]\nat = \"2 s\"\nover = \"4 s\"\neffectiveness = { elevator = 0.5 }\nconstants = { Cl = 0.002 }\n",
    );
    let half = scenario.effects_at(4.0);
    assert!((half.effectiveness[0] - 0.75).abs() < 1e-12 && (half.constants[4] - 0.001).abs() < 1e-15);
    // Without a flight and its trim nobody knows what a lost part of a surface amounts to: nothing is said of it.
    assert!(scenario.true_parameters_at(1.0).contains_key("dCm_elevator"));
    assert!(scenario.true_parameters().keys().all(|name| name.starts_with("bias_")));
    let flight = fly(&scenario).unwrap();
    let (before, during, after) =
        (flight.true_parameters_at(1.0), flight.true_parameters_at(4.0), flight.true_parameters_at(7.0));
    assert_eq!(before["dCl_0"], 0.0);
    assert!((during["dCl_0"] - 0.001).abs() < 1e-12 && (after["dCl_0"] - 0.002).abs() < 1e-12);
    assert!((during["dCm_elevator"] / after["dCm_elevator"] - 0.5).abs() < 1e-9);
    let roll = |flight: &phugoid_simulation::flight::Flight| flight.truth.channel("p").unwrap().values.clone();
    let (healthy, damaged) = (roll(&fly(&with("")).unwrap()), roll(&flight));
    assert_eq!(damaged[..=200], healthy[..=200]);
    assert!(damaged[400] > healthy[400] + 0.005, "right wing down");
}

#[test]
fn failed_surfaces_do_what_the_failure_says() {
    // Without an elevator this aircraft diverges in seconds: the flight ends before.
    let surface = |more: &str| {
        let mut scenario = with(more);
        scenario.duration = Time::from_si(4.0);
        let flight = fly(&scenario).unwrap();
        (
            flight.truth.channel("elevator").unwrap().values.clone(),
            flight.truth.channel("alpha").unwrap().values.clone(),
        )
    };
    let healthy = surface("").0;
    let (jammed, _) = surface("[[failure]]\nsurface = \"elevator\"\nat = \"2 s\"\nkind = \"jam\"\n");
    assert_eq!(jammed[..200], healthy[..200]);
    assert!(jammed[200..].iter().all(|u| *u == jammed[200]) && healthy[200..].iter().any(|u| *u != jammed[200]));
    let (floating, alpha) = surface("[[failure]]\nsurface = \"elevator\"\nat = \"2 s\"\nkind = \"float\"\n");
    assert!(floating[200..400].iter().zip(&alpha[200..400]).all(|(u, a)| (u + a).abs() < 0.02), "against the air");
    let (swinging, _) = surface(
        "[[failure]]\nsurface = \"elevator\"\nat = \"2 s\"\nkind = \"oscillation\"\namplitude = \"1 deg\"\nfrequency = \"1 Hz\"\n",
    );
    let largest = swinging[200..300].iter().zip(&healthy[200..300]).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!((largest - 1.0_f64.to_radians()).abs() < 1e-4, "{largest}");
}

#[test]
fn mistakes_are_told_with_the_key() {
    for (text, words) in [
        ("[[damage]]\nat = \"1 s\"\nconstants = { Cmm = 0.1 }\n", ["constants", "Cm"]),
        ("[[damage]]\nat = \"1 s\"\ncoupling = { Cm_alpha = 0.1 }\n", ["coupling", "Cm_alpha"]),
        ("[[damage]]\nat = \"1 s\"\neffectiveness = { elevator = 60 }\n", ["effectiveness.elevator", "0 to 1"]),
        ("[[damage]]\nat = \"1 s\"\nmass = -1\n", ["mass", "-1"]),
        ("[[damage]]\nat = \"1 s\"\nthrust = 2\n", ["thrust", "0 to 1"]),
        ("[[damage]]\nat = \"1 s\"\ncg_shift = 5\n", ["cg_shift", "fraction"]),
        ("[[failure]]\nsurface = \"rudder\"\nat = \"1 s\"\nkind = \"oscillation\"\n", ["rudder", "amplitude"]),
        (
            "[[failure]]\nsurface = \"rudder\"\nat = \"1 s\"\nkind = \"rate-limit\"\nrate_limit = \"5 deg/s\"\n",
            ["rate", "actuators"],
        ),
        (
            "[[failure]]\nsurface = \"rudder\"\nat = \"1 s\"\nkind = \"float\"\nposition = \"5 deg\"\n",
            ["position", "jam"],
        ),
        ("[[failure]]\nsurface = \"rudder\"\nat = \"-1 s\"\nkind = \"jam\"\n", ["rudder", "start"]),
        (
            "[[failure]]\nsurface = \"rudder\"\nat = \"1 s\"\nkind = \"delay\"\ndelay = \"20 s\"\n",
            ["rudder", "expected 1 s at most"],
        ),
    ] {
        let message = refusal(text);
        assert!(words.iter().all(|word| message.contains(word)), "{text}: {message}");
    }
}
