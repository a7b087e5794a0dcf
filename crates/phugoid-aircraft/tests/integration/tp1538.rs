//! The F-16 of NASA TP-1538 from its tables: against an interpolation of its own, against the F-16 of the book, and in flight.

use std::path::PathBuf;

use phugoid_aircraft::flown::{AircraftFile, FlownError, FlownOptions, Thrust};
use phugoid_aircraft::tp1538::Tp1538;
use phugoid_flight_dynamics::aircraft::{AirData, Aircraft, Controls};
use phugoid_flight_dynamics::f16::{F16, F16Options};
use phugoid_flight_dynamics::linearize::linearize;
use phugoid_flight_dynamics::motion::Disturbance;
use phugoid_flight_dynamics::scalar::{Dual, Scalar};
use phugoid_flight_dynamics::trim::{TrimCondition, trim};
use phugoid_simulation::flight::fly;
use phugoid_simulation::scenario::Scenario;

use crate::shared_data::shared_file;

fn folder() -> Option<PathBuf> {
    Some(shared_file("f16/tp1538/tp1538_tables.json")?.parent()?.to_owned())
}

/// Angle of attack, sideslip, elevator, aileron, rudder (deg), p, q, r (rad/s), speed (m/s), Mach number, and CX, CY, CZ, Cl, Cm,
/// Cn about 30 % of the mean chord: the equations of the README beside the tables, in a program of their own.
const CHECKS: [([f64; 10], [f64; 6]); 5] = [
    (
        [3.0, 0.0, -2.0, 0.0, 0.0, 0.0, 0.0, 0.0, 150.0, 0.45],
        [-0.014674976290, -0.003460305230, -0.268605719100, -0.000221657300, 0.001315880485, 0.000031547785],
    ),
    (
        [-12.5, 4.0, 7.0, 11.0, -13.0, 0.2, -0.1, 0.15, 120.0, 0.4],
        [-0.024736150120, -0.085523377333, 0.823101232000, -0.032098623333, -0.080538866920, 0.027543232386],
    ),
    (
        [18.0, -7.0, -15.0, -5.0, 9.0, -0.3, 0.2, 0.1, 90.0, 0.3],
        [0.117455777707, 0.141772704000, -1.220874033067, 0.049677976000, 0.064947023253, -0.035682712749],
    ),
    (
        [37.0, 12.0, 13.0, 20.0, -30.0, 0.4, 0.3, -0.2, 70.0, 0.25],
        [0.098879556434, -0.225577152000, -2.429906761143, -0.051849667657, -0.307760975817, -0.005324097808],
    ),
    (
        [44.0, -25.0, 24.0, -18.0, 21.0, 0.1, -0.4, 0.3, 200.0, 0.8],
        [0.042038585109, 0.161200814800, -1.708866270933, 0.080236531440, -0.050460310311, -0.041999851039],
    ),
];

fn coefficients<T: Scalar>(aircraft: &Tp1538, x: [T; 10]) -> [T; 6] {
    let radians = |angle: T| angle * (std::f64::consts::PI / 180.0);
    let [alpha, beta, elevator, aileron, rudder, p, q, r, speed, mach] = x;
    let air = AirData {
        speed,
        alpha: radians(alpha),
        beta: radians(beta),
        density: T::from(1.0),
        dynamic_pressure: speed * speed * 0.5,
        mach,
    };
    let controls = Controls {
        throttle: T::from(0.2),
        elevator: radians(elevator),
        aileron: radians(aileron),
        rudder: radians(rudder),
    };
    let c = aircraft.coefficients(&air, [p, q, r], &controls);
    [c.cx, c.cy, c.cz, c.cl, c.cm, c.cn]
}

#[test]
fn coefficients_are_those_of_the_equations_beside_the_tables() {
    let Some(folder) = folder() else { return };
    let aircraft = Tp1538::open(folder, 0.30).unwrap();
    for (x, expected) in CHECKS {
        for (found, expected) in coefficients(&aircraft, x).iter().zip(expected) {
            assert!((found - expected).abs() < 2e-12, "{x:?}: {found} {expected}");
        }
    }
}

#[test]
fn derivatives_are_those_of_differences() {
    let Some(folder) = folder() else { return };
    let aircraft = Tp1538::open(folder, 0.30).unwrap();
    // Between the points of every table, and with the flap between its ends.
    let centre = [8.3, 3.1, -4.7, 6.0, -5.0, 0.1, -0.2, 0.15, 140.0, 0.42];
    let exact = coefficients(&aircraft, std::array::from_fn(|i| Dual::<10>::variable(centre[i], i)));
    for i in 0..10 {
        let moved = |step: f64| {
            let mut x = centre;
            x[i] += step;
            coefficients(&aircraft, x)
        };
        for (k, (above, below)) in moved(1e-5).iter().zip(moved(-1e-5)).enumerate() {
            let slope = (above - below) / 2e-5;
            assert!((exact[k].derivatives[i] - slope).abs() < 1e-8, "{k} by {i}: {} {slope}", exact[k].derivatives[i]);
        }
    }
}

#[test]
fn it_trims_near_the_f16_of_the_book_which_simplifies_it() {
    let Some(folder) = folder() else { return };
    let found = Tp1538::open(folder, 0.30).unwrap();
    let known = F16::new(F16Options { cg: 0.30, ..F16Options::default() }).unwrap();
    for (altitude, speed) in [(15_000.0, 500.0), (20_000.0, 675.0), (0.0, 502.0)] {
        let (altitude, speed) = (altitude * 0.3048, speed * 0.3048);
        let ours = trim(&found, &TrimCondition::steady(&found, speed, altitude, 0.0, 0.0)).unwrap();
        let theirs = trim(&known, &TrimCondition::steady(&known, speed, altitude, 0.0, 0.0)).unwrap();
        let flap = found.leading_edge_flap(ours.alpha_rad, ours.mach).to_degrees();
        println!(
            "{altitude:.0} m, {speed:.1} m/s: alpha {:.3} ({:.3}) deg, elevator {:.3} ({:.3}) deg, thrust {:.0} ({:.0}) N, flap \
             {flap:.2} deg",
            ours.alpha_rad.to_degrees(),
            theirs.alpha_rad.to_degrees(),
            ours.elevator_rad.to_degrees(),
            theirs.elevator_rad.to_degrees(),
            ours.thrust_n,
            theirs.thrust_n
        );
        assert!((ours.alpha_rad - theirs.alpha_rad).to_degrees().abs() < 0.5);
        assert!((ours.elevator_rad - theirs.elevator_rad).to_degrees().abs() < 1.5);
        assert!((ours.thrust_n / theirs.thrust_n - 1.0).abs() < 0.2);
        assert!((0.0..=25.0).contains(&flap));
        // Signs of the controls are those of the equations of motion.
        let model = linearize(&found, &ours.state(), &ours.controls(), &Disturbance::default());
        let row = |name: &str| model.states.iter().position(|state| state.split('_').next() == Some(name)).unwrap();
        let column = |name: &str| model.inputs.iter().position(|input| input.split('_').next() == Some(name)).unwrap();
        assert!(model.b[row("q")][column("elevator")] < 0.0);
        assert!(model.b[row("p")][column("aileron")] < 0.0);
        assert!(model.b[row("r")][column("rudder")] < 0.0);
    }
}

#[test]
fn it_flies_in_a_scenario_and_refuses_what_it_does_not_have() {
    let Some(folder) = folder() else { return };
    let text = format!(
        r#"
name = "F-16 of NASA TP-1538"
duration = "10 s"
sample_rate = "50 Hz"
[aircraft]
file = {folder:?}
properties = {{ cg = 0.30 }}
[condition]
altitude = "15000 ft"
speed = "500 ft/s"
[[manoeuvre]]
type = "doublet"
surface = "elevator"
start = "1 s"
amplitude = "1 deg"
width = "1 s"
"#
    );
    let flight = fly(&Scenario::parse(&text, "f16.toml").unwrap()).unwrap();
    let q = &flight.truth.channel("q").unwrap().values;
    let largest = q.iter().fold(0.0_f64, |most, q| most.max(q.abs())).to_degrees();
    assert!(largest > 0.5 && largest < 30.0, "{largest}");
    let opened = |options: FlownOptions| AircraftFile::open_with(&folder, &options);
    let property = |name: &str, value: f64| {
        opened(FlownOptions { properties: vec![(name.to_owned(), value)], ..FlownOptions::default() })
    };
    assert_eq!(property("cg", 0.25).unwrap().centre_of_gravity(), Some(0.25));
    assert!(matches!(property("flaps", 1.0), Err(FlownError::Property { .. })));
    assert!(property("cg", 30.0).unwrap_err().to_string().contains("fraction of the mean chord"));
    let pushed = FlownOptions { thrust: Thrust::AlongBodyX { largest_n: 1e5 }, ..FlownOptions::default() };
    assert!(opened(pushed).unwrap_err().to_string().contains("`largest_thrust` has no meaning"));
    // A table that is cut off is named.
    let broken = std::env::temp_dir().join(format!("phugoid-tp1538-{}", std::process::id()));
    std::fs::create_dir_all(&broken).unwrap();
    let file = folder.join("tp1538_tables.json");
    let mut tables: serde_json::Value = serde_json::from_slice(&std::fs::read(file).unwrap()).unwrap();
    tables["tables"]["Cy_r30"]["values"][3].as_array_mut().unwrap().pop();
    std::fs::write(broken.join("tp1538_tables.json"), tables.to_string()).unwrap();
    let text = AircraftFile::open(&broken).unwrap_err().to_string();
    assert!(text.contains("tables.Cy_r30.values[3]") && text.contains("has 18 entries, and the axis 19"), "{text}");
}
