//! Coefficients along flights that JSBSim flew, where the recordings are there.

use std::path::PathBuf;

use phugoid_aircraft::jsbsim::{Aircraft, Evaluator, FlightCondition};

use super::{package, repository, text_of};

/// The folder of the recordings: `jsbsim` in that of `PHUGOID_SHARED_DATA`, or in `shared/data` beside the workspace.
fn recordings() -> Option<PathBuf> {
    let shared =
        std::env::var_os("PHUGOID_SHARED_DATA").map_or_else(|| repository().join("../shared/data"), PathBuf::from);
    let folder = shared.join("jsbsim");
    let there = folder.is_dir();
    if !there {
        eprintln!("skipped: no flights in {} (set PHUGOID_SHARED_DATA)", folder.display());
    }
    there.then_some(folder)
}

#[test]
fn coefficients_along_flights_are_those_of_jsbsim() {
    let (Some(package), Some(recordings)) = (package(), recordings()) else { return };
    for name in ["c182", "fokker100", "f15"] {
        let aircraft = Aircraft::open(package.join("aircraft").join(name)).unwrap();
        let known: serde_json::Value =
            serde_json::from_str(&text_of(&recordings.join(format!("{name}.json")))).unwrap();
        let number = |path: &str| known.pointer(path).and_then(serde_json::Value::as_f64).unwrap();
        let close = |a: f64, b: f64, what: &str| {
            assert!((a - b).abs() <= 2e-6 * b.abs().max(1e-3), "{name}: {what} is {a}, not {b}");
        };
        let mass = aircraft.mass_properties();
        close(mass.mass_kg, number("/mass_kg"), "mass");
        for (axis, part) in mass.centre_of_gravity_m.iter().enumerate() {
            close(part / 0.0254, number(&format!("/cg_structural_in/{axis}")), "centre");
        }
        let inertia = mass.inertia_kg_m2;
        for (path, value) in [
            ("Ixx", inertia[0][0]),
            ("Iyy", inertia[1][1]),
            ("Izz", inertia[2][2]),
            ("Ixy", -inertia[0][1]),
            ("Ixz", -inertia[0][2]),
            ("Iyz", -inertia[1][2]),
        ] {
            close(value, number(&format!("/inertia_kg_m2/{path}")), path);
        }
        for size in ["small", "large"] {
            let worst = along(&aircraft, &text_of(&recordings.join(format!("{name}_{size}.csv.gz"))));
            eprintln!("{name} {size}: largest difference of CX CY CZ Cl Cm Cn {worst:.1e}");
            assert!(worst < 1e-6, "{name} {size}: {worst}");
        }
    }
}

/// Largest difference of a coefficient along a flight.
fn along(aircraft: &Aircraft, text: &str) -> f64 {
    let mut lines = text.lines();
    let header: Vec<_> = lines.next().unwrap().split(',').collect();
    let mut evaluator = Evaluator::new(aircraft);
    evaluator.set("gear/gear-pos-norm", 0.0);
    let mut worst = 0.0_f64;
    for line in lines {
        let row: Vec<f64> = line.split(',').map(|word| word.parse().unwrap()).collect();
        let of = |name: &str| row[header.iter().position(|found| *found == name).unwrap()];
        let speed = of("tas_m_s");
        evaluator.set_flight(&FlightCondition {
            airspeed_m_s: speed,
            alpha_rad: of("alpha_rad"),
            beta_rad: of("beta_rad"),
            alphadot_rad_s: of("alphadot_rad_s"),
            betadot_rad_s: 0.0,
            rates_rad_s: [of("p_rad_s"), of("q_rad_s"), of("r_rad_s")],
            attitude_rad: [of("phi_rad"), of("theta_rad"), of("psi_rad")],
            height_m: of("altitude_m"),
            height_above_ground_m: of("altitude_m"),
            density_kg_m3: of("rho_kg_m3"),
            pressure_pa: 101_325.0,
            temperature_k: 288.15,
            sound_speed_m_s: speed / of("mach"),
        });
        evaluator.set("fcs/elevator-pos-rad", of("elevator_rad"));
        evaluator.set("fcs/left-aileron-pos-rad", of("aileron_rad"));
        evaluator.set("fcs/rudder-pos-rad", of("rudder_rad"));
        let found = evaluator.coefficients();
        for (value, name) in found.force.iter().chain(&found.moment).zip(["CX", "CY", "CZ", "Cl", "Cm", "Cn"]) {
            worst = worst.max((value - of(name)).abs());
        }
    }
    worst
}
