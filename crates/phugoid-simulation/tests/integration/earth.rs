//! Flights over a planet: they start in balance, gyros feel its rotation, and what cannot be is refused in words.

use phugoid_simulation::flight::{Flight, fly};
use phugoid_simulation::scenario::Scenario;

fn text(earth: &str, heading: f64) -> String {
    format!(
        "name = \"over a planet\"\nduration = \"20 s\"\nsample_rate = \"50 Hz\"\n\
         aircraft = {{ type = \"f16\", cg = 0.30, thrust = \"engine\" }}\n\
         condition = {{ altitude = \"6000 m\", speed = \"205 m/s\", heading = \"{heading} deg\" }}\n{earth}"
    )
}

fn flown(earth: &str, heading: f64) -> Flight {
    fly(&Scenario::parse(&text(earth, heading), "earth.toml").unwrap()).unwrap()
}

fn channel<'a>(flight: &'a Flight, name: &str) -> &'a [f64] {
    &flight.truth.channel(name).unwrap().values
}

fn range(values: &[f64]) -> f64 {
    let (low, high) = values.iter().fold((f64::MAX, f64::MIN), |(low, high), x| (low.min(*x), high.max(*x)));
    high - low
}

/// Without the gravity of the place, the curved path and the bank against Coriolis' acceleration it would start with 0.003 g and more.
#[test]
fn a_flight_starts_in_balance() {
    let mut felt = Vec::new();
    for heading in [0.0, 90.0, 200.0, 270.0] {
        let flight = flown("earth = { shape = \"wgs84\", latitude = \"52 deg\", longitude = \"10 deg\" }", heading);
        let angles = ["alpha", "beta", "phi"].map(|name| range(channel(&flight, name)));
        let (speed, altitude) = (range(channel(&flight, "true_airspeed")), range(channel(&flight, "altitude")));
        println!("{heading}: {angles:?} rad, {speed:.1e} m/s, {altitude:.1e} m");
        assert!(angles.iter().all(|angle| *angle < 2e-4) && speed < 0.02 && altitude < 0.3, "{heading}");
        felt.push(channel(&flight, "az")[0]);
        // Where it goes: 20 s of 205 m/s.
        let [north, east] = ["latitude", "longitude"].map(|name| {
            let values = channel(&flight, name);
            (values[values.len() - 1] - values[0]) * 6.38e6
        });
        let (sin, cos) = f64::to_radians(heading).sin_cos();
        assert!((north - 4100.0 * cos).abs() < 40.0 && (east * 0.6157 - 4100.0 * sin).abs() < 40.0, "{north} {east}");
    }
    // Eotvos: eastwards an aircraft is lighter than westwards, by 4 omega V cos(latitude).
    let lighter = felt[1] - felt[3];
    assert!((lighter / (4.0 * 7.292_115e-5 * 205.0 * 0.615_66) - 1.0).abs() < 0.01, "{lighter}");
}

/// 15 degrees an hour: what a gyro shows that stands still.
#[test]
fn gyros_feel_the_rotation_of_the_planet() {
    let rates = |earth: &str| {
        let flight = flown(earth, 0.0);
        ["p", "q", "r"].map(|name| channel(&flight, name)[0])
    };
    let turning = rates("earth = { shape = \"round\", latitude = \"30 deg\" }");
    let still = rates("earth = { shape = \"round\", latitude = \"30 deg\", rotating = false }");
    let spin = (0..3).map(|i| (turning[i] - still[i]).powi(2)).sum::<f64>().sqrt();
    assert!((spin / 7.292_115e-5 - 1.0).abs() < 1e-3, "{spin:e}");
    // Over a planet at rest the nose follows the horizon: V / (R + h).
    assert!((still[1] * (6_371_008.8 + 6000.0) / -205.0 - 1.0).abs() < 1e-3, "{still:?}");
}

#[test]
fn a_quaternion_flies_what_euler_angles_fly() {
    let doublet = "[[manoeuvre]]\ntype = \"doublet\"\nsurface = \"aileron\"\namplitude = \"1 deg\"\nstart = \"1 s\"\nwidth = \"1 s\"\n";
    let [euler, quaternion] = ["euler", "quaternion"].map(|word| {
        let text = text("", 30.0).replacen("aircraft", &format!("attitude = \"{word}\"\naircraft"), 1) + doublet;
        fly(&Scenario::parse(&text, "attitude.toml").unwrap()).unwrap()
    });
    for name in ["phi", "theta", "psi", "beta", "true_airspeed"] {
        let (a, b) = (channel(&euler, name), channel(&quaternion, name));
        let worst = a.iter().zip(b).fold(0.0, |most: f64, (a, b)| most.max((a - b).abs()));
        assert!(worst < 1e-8 && range(a) > 1e-3, "{name}: {worst:e}");
    }
}

#[test]
fn what_is_no_place_is_refused_by_its_key() {
    for (earth, says) in [
        ("earth = { shape = \"wgs84\", latitude = \"89.5 deg\" }", "`earth.latitude` is from -89 to 89 deg"),
        ("earth = { shape = \"wgs84\", latitude = \"nan deg\" }", "earth"),
        ("earth = { shape = \"wgs84\", latitude = \"50 deg\", longitude = \"800 deg\" }", "`earth.longitude`"),
        ("earth = { shape = \"disc\", latitude = \"50 deg\" }", "disc"),
        ("earth = { shape = \"round\" }", "latitude"),
        ("earth = { shape = \"round\", latitude = \"50 m\" }", "angle"),
    ] {
        let message = Scenario::parse(&text(earth, 0.0), "earth.toml").unwrap_err().to_string();
        assert!(message.starts_with("earth.toml") && message.contains(says), "{earth}: {message}");
    }
    let message = Scenario::parse(&text("", 3600.0), "earth.toml").unwrap_err().to_string();
    assert!(message.contains("`condition.heading`"), "{message}");
}
