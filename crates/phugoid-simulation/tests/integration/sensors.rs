//! What the sensors make of a flight: where they are mounted, frames that are missing, sensors that cannot be.

use phugoid_simulation::flight::fly;
use phugoid_simulation::scenario::Scenario;

const CALM: &str = include_str!("../../../../scenarios/f16-calm.toml");

/// In symmetric flight: `az = az_cg - qdot x - q^2 z`, `ax = ax_cg + qdot z - q^2 x`, and a vane ahead of the centre of
/// gravity sees `alpha - q x/V` (small angles).
#[test]
fn sensors_ahead_feel_the_pitching() {
    let text = CALM.replace(
        "[sensors]",
        "[sensors]\naccelerometers = [\"2 m\", \"0 m\", \"0.5 m\"]\nvanes = [\"5 m\", \"0 m\", \"0 m\"]",
    );
    let text: String = text.lines().filter(|l| !l.contains("noise")).collect::<Vec<_>>().join("\n");
    let flight = fly(&Scenario::parse(&text, "x").unwrap()).unwrap();
    let truth = |name: &str| &flight.truth.channel(name).unwrap().values;
    let measured = |name: &str| &flight.measured.channel(name).unwrap().values;
    let mut largest = 0.0_f64;
    for k in 0..flight.truth.time.len() {
        let (q, q_dot, v) = (truth("q")[k], truth("qdot")[k], truth("true_airspeed")[k]);
        // The engine's rotor turns pitching into a little roll and yaw; their squares are left out here.
        assert!((measured("az")[k] - (truth("az")[k] - q_dot * 2.0 - q * q * 0.5)).abs() < 1e-4);
        assert!((measured("ax")[k] - (truth("ax")[k] + q_dot * 0.5 - q * q * 2.0)).abs() < 1e-4);
        // Second order in q x/V: at most 3 (0.1 rad/s 5 m/206 m/s)^2 and as much with alpha.
        assert!((measured("alpha")[k] - (truth("alpha")[k] - q * 5.0 / v)).abs() < 1e-4);
        largest = largest.max((measured("alpha")[k] - truth("alpha")[k]).abs());
    }
    assert!(largest > 5e-4, "the manoeuvre pitches by more than 0.02 rad/s: {largest}");
}

#[test]
fn a_sensor_that_cannot_be_is_named() {
    let text = CALM.replace("noise = \"0.1 deg\"", "noise = \"-0.1 deg\"");
    let message = fly(&Scenario::parse(&text, "calm").unwrap()).unwrap_err().to_string();
    assert!(message.contains("`sensors.alpha`: noise is -0.0017"), "{message}");
}

#[test]
fn dropped_frames_change_no_other_number() {
    let fly_with = |drops: &str| {
        let text = CALM.replace("[sensors]", &format!("[sensors]\ndrops = {drops}"));
        fly(&Scenario::parse(&text, "calm").unwrap()).unwrap().measured
    };
    let (all, some) = (fly_with("0.0"), fly_with("0.1"));
    let mut missing = 0;
    for (a, b) in all.channels.iter().zip(&some.channels) {
        for (x, y) in a.values.iter().zip(&b.values) {
            assert!(y.is_nan() || x == y, "{}", a.name);
            missing += usize::from(y.is_nan() && a.name == "alpha");
        }
    }
    // 10 % of 2001 frames, five standard deviations of 13.4.
    assert!((133..=268).contains(&missing), "{missing}");
    assert!(some.channel("elevator").unwrap().values.iter().all(|v| v.is_finite()));
    assert!(all.channel("qdot").is_none(), "not measured unless it is named");
}
