//! What a scenario can add to a flight: turbulence, drift, what is drawn per seed, an aircraft that is not as its tables say.
#![allow(clippy::unwrap_used, clippy::panic)] // helpers of tests are tests

use phugoid_simulation::flight::{Flight, fly};
use phugoid_simulation::scenario::Scenario;

const CALM: &str = include_str!("../../../../scenarios/f16-calm.toml");

fn scenario(changes: &[(&str, &str)], added: &str) -> Scenario {
    let mut text = CALM.to_owned();
    for (from, to) in changes {
        assert!(text.contains(from), "{from}");
        text = text.replace(from, to);
    }
    Scenario::parse(&format!("{text}\n{added}"), "options.toml").unwrap_or_else(|e| panic!("{e}"))
}

fn refused(changes: &[(&str, &str)], added: &str) -> String {
    let text = changes.iter().fold(CALM.to_owned(), |text, (from, to)| text.replace(from, to));
    Scenario::parse(&format!("{text}\n{added}"), "options.toml").unwrap_err().to_string()
}

fn truth<'a>(flight: &'a Flight, name: &str) -> &'a [f64] {
    &flight.truth.channel(name).unwrap().values
}

fn rms(values: &[f64]) -> f64 {
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    (values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / values.len() as f64).sqrt()
}

/// Stick fixed, the aircraft meets the gusts: alpha moves by about w/V, and the load factor with it.
#[test]
fn turbulence_shakes_the_aircraft_as_much_as_its_intensity_says() {
    let rough = |table: &str, seed: &str| {
        let quiet = [
            ("amplitude = \"1.5 deg\"", "amplitude = \"0 deg\""),
            ("amplitude = \"-1.5 deg\"", "amplitude = \"0 deg\""),
            ("seed = 1 ", seed),
        ];
        fly(&scenario(&quiet, table)).unwrap()
    };
    let mean = |table: &str| {
        let flights = (0..12).map(|k| rms(truth(&rough(table, &format!("seed = {k} ")), "az")));
        flights.sum::<f64>() / 12.0
    };
    let light = mean("[turbulence]\nintensity = \"light\"");
    let moderate = mean("[turbulence]\nintensity = \"moderate\"");
    let same = mean("[turbulence]\nsigma = \"3.65 ft/s\"");
    // Figure 7 at 20,000 ft: 3.65 and 7.3 ft/s, the same fields twice as strong; the aircraft is nearly linear.
    assert!((moderate / light - 2.0).abs() < 0.05, "{light} {moderate}");
    assert!((same / light - 1.0).abs() < 1e-9, "{light} {same}");
    // Z_w/m: CL_alpha of about 4 per rad (tables and increment), qbar S/m = 49 m/s^2 at 206 m/s, gusts of 1.11 m/s, of
    // which the aircraft gives way to a part: at most 1.1 m/s^2, not less than a third of it.
    assert!((0.35..1.1).contains(&light), "{light} m/s^2");
    let turning = rough("[turbulence]\nintensity = \"light\"\nrates = true", "seed = 3 ");
    let straight = rough("[turbulence]\nintensity = \"light\"", "seed = 3 ");
    assert_ne!(truth(&turning, "q"), truth(&straight, "q"));
    assert!(rms(truth(&turning, "p")) > 1e-3, "roll gusts roll");
    // Measured angle of attack and airspeed are those of the moving air; the sensors have the noise of calm air.
    let calm = fly(&scenario(
        &[
            ("seed = 1 ", "seed = 3 "),
            ("amplitude = \"1.5 deg\"", "amplitude = \"0 deg\""),
            ("amplitude = \"-1.5 deg\"", "amplitude = \"0 deg\""),
        ],
        "",
    ))
    .unwrap();
    let noise = |flight: &Flight| -> Vec<f64> {
        let measured = &flight.measured.channel("theta").unwrap().values;
        measured.iter().zip(truth(flight, "theta")).map(|(m, t)| m - t).collect()
    };
    let (a, b) = (noise(&calm), noise(&straight));
    assert!(a.iter().zip(&b).all(|(a, b)| (a - b).abs() < 1e-12));
}

#[test]
fn a_drift_goes_evenly_from_what_was_to_what_holds_afterwards() {
    let drift = "[[damage]]\nat = \"6 s\"\nover = \"8 s\"\nincrements = { dCm_alpha = 0.2, dCL_alpha = 0.4 }";
    let s = scenario(&[], drift);
    assert_eq!(s.true_parameters_at(5.99)["dCm_alpha"], -0.2);
    assert!((s.true_parameters_at(10.0)["dCm_alpha"]).abs() < 1e-12, "half way");
    assert!((s.true_parameters_at(10.0)["dCm_q"] + 1.0).abs() < 1e-12, "what is not named goes to zero");
    assert_eq!(s.true_parameters()["dCm_alpha"], 0.2);
    // The flight is that of the sudden change before the drift, and no other flight after it.
    let (calm, drifting) = (fly(&scenario(&[], "")).unwrap(), fly(&s).unwrap());
    let sudden = fly(&scenario(&[], &drift.replace("over = \"8 s\"\n", ""))).unwrap();
    let q = |flight: &Flight, k: usize| truth(flight, "q")[k];
    assert_eq!(q(&calm, 600), q(&drifting, 600));
    assert!((q(&sudden, 1200) - q(&drifting, 1200)).abs() > 1e-4);
    let overlapping = refused(&[], &format!("{drift}\n[[damage]]\nat = \"9 s\"\nincrements = {{}}"));
    assert!(overlapping.contains("has to be over"), "{overlapping}");
}

#[test]
fn what_is_drawn_depends_on_the_seed_alone_and_stays_in_its_range() {
    let text = "[increment_ranges]\ndCm_alpha = [-0.4, -0.1]\ndCl_p = [0.0, 0.1]\n\n[[damage]]\nat = \"10 s\"\nincrements = { dCm_q = 1.0 }\nranges = { dCL_alpha = [-0.6, 0.6] }";
    let bias = [(
        "q = { noise = \"0.1 deg/s\" }",
        "q = { noise = \"0.1 deg/s\", bias = \"1 deg/s\", bias_spread = \"0.2 deg/s\" }",
    )];
    let of = |seed: u64| Scenario { seed, ..scenario(&bias, text) };
    let drawn = of(5).drawn();
    assert_eq!(drawn, of(5).drawn());
    assert_eq!(drawn, drawn.drawn(), "there is nothing left to draw");
    assert_eq!(drawn.true_parameters(), of(5).true_parameters());
    assert_ne!(drawn.true_parameters(), of(6).true_parameters());
    let degree = std::f64::consts::PI / 180.0;
    let (mut mean, mut square) = (0.0, 0.0);
    for seed in 0..400 {
        let truth = of(seed).drawn();
        assert!((-0.4..=-0.1).contains(&truth.increments.dCm_alpha) && truth.increments.dCm_q == -2.0);
        let after = truth.damage[0].increments;
        assert!((-0.6..=0.6).contains(&after.dCL_alpha) && after.dCm_q == 1.0 && after.dCm_alpha == 0.0);
        let error = truth.sensors.q.bias.si() / degree - 1.0;
        mean += error / 400.0;
        square += error * error / 400.0;
    }
    // 0.2 deg/s, known to 0.2/20 and to 1/sqrt(800); four of each.
    assert!(mean.abs() < 0.04 && (square.sqrt() / 0.2 - 1.0).abs() < 0.15, "{mean} {}", square.sqrt());
    let flight = fly(&of(5)).unwrap();
    assert_eq!(flight.true_parameters, drawn.true_parameters());
    let unknown = refused(&[], "[increment_ranges]\ndCm_alfa = [0, 1]");
    assert!(unknown.contains("did you mean `dCm_alpha`"), "{unknown}");
}

/// What the error amounts to: the derivatives of the difference, which a flight with these increments and right tables has
/// too, as long as it is small.
#[test]
fn an_error_of_the_tables_is_worth_increments() {
    let error = "[model_error]\ntables = { Cm = 1.1, CZ = 0.95 }\n";
    let flight = fly(&scenario(&[], error)).unwrap();
    let worth = &flight.error_increments;
    // At 2.4 deg the tables have Cm_q = -5.3 and CZ_q = -29, of which 0.35 - 0.30 of a chord is a moment: -6.7 about the
    // centre of gravity, and -3.6 for CZ_alpha; a tenth and a twentieth of them.
    assert!((-0.72..-0.62).contains(&worth["dCm_q"]), "{worth:?}");
    assert!((-0.25..-0.12).contains(&worth["dCL_alpha"]), "{worth:?}");
    assert!((flight.true_parameters["dCm_q"] + 2.0 - worth["dCm_q"]).abs() < 1e-12);
    assert_eq!(worth["dCY_beta"], 0.0);
    // Less lift by the tables: more angle of attack in trim.
    let nominal = fly(&scenario(&[], "")).unwrap();
    assert!(flight.trim.alpha_rad > nominal.trim.alpha_rad + 1e-3);
    assert!(nominal.error_increments.is_empty());
    let message = refused(&[], "[model_error]\ntables = { Cm = -1 }");
    assert!(message.contains("positive factor"), "{message}");
}

#[test]
fn a_quadratic_moment_changes_the_motion_and_not_the_trim() {
    let nominal = fly(&scenario(&[], "")).unwrap();
    let bent = fly(&scenario(&[], "[model_error]\nCm_alpha_squared = 0.5\n")).unwrap();
    assert!((bent.trim.alpha_rad - nominal.trim.alpha_rad).abs() < 1e-9);
    assert!(bent.error_increments.values().all(|v| v.abs() < 1e-12), "{:?}", bent.error_increments);
    let farthest =
        truth(&bent, "alpha").iter().zip(truth(&nominal, "alpha")).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(farthest > 1e-3, "{farthest}");
}

#[test]
fn recorded_thrust_and_surfaces_can_be_wrong() {
    let wrong = "[model_error]\nthrust = 0.1\nsurfaces = \"commanded\"\n";
    let flight = fly(&scenario(&[("actuators = false", "actuators = true")], wrong)).unwrap();
    let honest = fly(&scenario(&[("actuators = false", "actuators = true")], "")).unwrap();
    let measured = |flight: &Flight, name: &str| flight.measured.channel(name).unwrap().values.clone();
    let (a, b) = (measured(&flight, "thrust"), measured(&honest, "thrust"));
    assert!(a.iter().zip(&b).all(|(a, b)| (a / b - 1.1).abs() < 1e-12));
    assert_eq!(truth(&flight, "elevator"), truth(&honest, "elevator"), "the surface moves as before");
    assert_eq!(measured(&honest, "elevator"), truth(&honest, "elevator"));
    // The step of the command at 0.5 s is recorded at once; the surface needs 50 ms for most of it.
    let (recorded, real) = (measured(&flight, "elevator"), truth(&flight, "elevator"));
    assert!((recorded[50] - real[50]).abs() > 0.02 && (recorded[95] - real[95]).abs() < 1e-5);
    assert!(flight.measured.channel("elevator_command").is_none());
}

#[test]
fn turbulence_needs_one_statement_of_its_strength() {
    for table in ["[turbulence]\n", "[turbulence]\nintensity = \"light\"\nsigma = \"1 m/s\"\n"] {
        let message = refused(&[], table);
        assert!(message.contains("takes one of `intensity`"), "{message}");
    }
}

/// An amplitude in radians where degrees were meant: the message names the surface and where it was.
#[test]
fn a_flight_that_is_lost_names_the_surface() {
    let lost = |amplitude: &str| {
        let amplitude = format!("amplitude = \"{amplitude}\"");
        fly(&scenario(&[("amplitude = \"1.5 deg\"", &amplitude)], "")).unwrap_err().to_string()
    };
    for (amplitude, deflection) in [("1.5 rad", "84.0 deg"), ("80 deg", "78.0 deg")] {
        let message = lost(amplitude);
        let said = format!("the elevator was at {deflection} and the angle of attack");
        assert!(message.contains(&said) && message.contains("their units"), "{message}");
    }
}
