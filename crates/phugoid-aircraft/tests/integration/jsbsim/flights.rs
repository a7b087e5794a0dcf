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

/// Motion of the aircraft: velocity and rates in body axes, bank, pitch and heading, height.
type Motion = [f64; 10];

/// Radius of the earth of the recordings, m.
const EARTH_M: f64 = 20_925_646.0 * 0.3048;

fn flight_at(motion: &Motion, alphadot_rad_s: f64) -> FlightCondition {
    let [u, v, w, p, q, r, phi, theta, psi, height_m] = *motion;
    let geopotential = 6_356_766.0 * height_m / (6_356_766.0 + height_m);
    let temperature_k = 288.15 - 0.0065 * geopotential;
    let pressure_pa = 101_325.0 * (temperature_k / 288.15).powf(5.255_879_8);
    let airspeed_m_s = (u * u + v * v + w * w).sqrt();
    FlightCondition {
        airspeed_m_s,
        alpha_rad: w.atan2(u),
        beta_rad: (v / airspeed_m_s).asin(),
        alphadot_rad_s,
        betadot_rad_s: 0.0,
        rates_rad_s: [p, q, r],
        attitude_rad: [phi, theta, psi],
        height_m,
        height_above_ground_m: height_m,
        density_kg_m3: pressure_pa / (287.052_87 * temperature_k),
        pressure_pa,
        temperature_k,
        sound_speed_m_s: (1.4 * 287.052_87 * temperature_k).sqrt(),
    }
}

/// Rates of the motion, and of the angle of attack. That one is in the forces too: it is found by repetition.
fn rates(evaluator: &mut Evaluator<'_>, motion: &Motion, thrust_n: f64, alphadot: &mut f64) -> Motion {
    let [u, v, w, p, q, r, phi, theta, psi, height] = *motion;
    let mass = evaluator.mass_properties();
    let ((sphi, cphi), (stheta, ctheta), (spsi, cpsi)) = (phi.sin_cos(), theta.sin_cos(), psi.sin_cos());
    let (forward, side) = (u * ctheta + (v * sphi + w * cphi) * stheta, v * cphi - w * sphi);
    let (north, east) = (forward * cpsi - side * spsi, forward * spsi + side * cpsi);
    let radius = EARTH_M + height;
    // The ground falls away below.
    let gravity = 1.407_644_175_72e16 * 0.3048_f64.powi(3) / (radius * radius) - (north * north + east * east) / radius;
    let mut found = [0.0; 10];
    for _ in 0..4 {
        evaluator.set_flight(&flight_at(motion, *alphadot));
        let air = evaluator.aerodynamic_force_moment();
        let specific = air.force_n.map(|force| force / mass.mass_kg);
        found[0] = r * v - q * w - gravity * stheta + specific[0] + thrust_n / mass.mass_kg;
        found[1] = p * w - r * u + gravity * ctheta * sphi + specific[1];
        found[2] = q * u - p * v + gravity * ctheta * cphi + specific[2];
        *alphadot = (u * found[2] - w * found[0]) / (u * u + w * w);
        let momentum: [f64; 3] = std::array::from_fn(|k| (0..3).map(|j| mass.inertia_kg_m2[k][j] * [p, q, r][j]).sum());
        let torque = [
            air.moment_n_m[0] - (q * momentum[2] - r * momentum[1]),
            air.moment_n_m[1] - (r * momentum[0] - p * momentum[2]),
            air.moment_n_m[2] - (p * momentum[1] - q * momentum[0]),
        ];
        let turned = solved(&mass.inertia_kg_m2, torque);
        found[3..6].copy_from_slice(&turned);
    }
    // Attitude is against the level of the place, which turns with the flight over the earth.
    let [level_n, level_e] = [east / radius, -north / radius];
    let p = p - (ctheta * (cpsi * level_n + spsi * level_e));
    let q = q - ((sphi * stheta * cpsi - cphi * spsi) * level_n + (sphi * stheta * spsi + cphi * cpsi) * level_e);
    let r = r - ((cphi * stheta * cpsi + sphi * spsi) * level_n + (cphi * stheta * spsi - sphi * cpsi) * level_e);
    let turning = (q * sphi + r * cphi) / ctheta;
    found[6] = p + turning * stheta;
    found[7] = q * cphi - r * sphi;
    found[8] = turning;
    found[9] = u * stheta - (v * sphi + w * cphi) * ctheta;
    found
}

/// The solution of three linear equations.
fn solved(a: &[[f64; 3]; 3], b: [f64; 3]) -> [f64; 3] {
    let determinant = |m: &[[f64; 3]; 3]| {
        m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) - m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0])
            + m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0])
    };
    std::array::from_fn(|column| {
        let mut replaced = *a;
        for (row, value) in replaced.iter_mut().zip(b) {
            row[column] = value;
        }
        determinant(&replaced) / determinant(a)
    })
}

#[test]
fn flights_of_jsbsim_come_out_again() {
    let (Some(package), Some(recordings)) = (package(), recordings()) else { return };
    for (name, largest) in [("c182", [0.02, 2e-3]), ("fokker100", [0.1, 2e-3]), ("f15", [0.2, 5e-3])] {
        let aircraft = Aircraft::open(package.join("aircraft").join(name)).unwrap();
        let text = text_of(&recordings.join(format!("{name}_small.csv.gz")));
        let mut lines = text.lines();
        let header: Vec<_> = lines.next().unwrap().split(',').collect();
        let rows: Vec<Vec<f64>> =
            lines.map(|line| line.split(',').map(|word| word.parse().unwrap()).collect()).collect();
        let of = |row: &[f64], name: &str| row[header.iter().position(|found| *found == name).unwrap()];
        let mut evaluator = Evaluator::new(&aircraft);
        evaluator.set("gear/gear-pos-norm", 0.0);
        let first = &rows[0];
        let (speed, alpha, beta) = (of(first, "tas_m_s"), of(first, "alpha_rad"), of(first, "beta_rad"));
        let mut motion = [
            speed * alpha.cos() * beta.cos(),
            speed * beta.sin(),
            speed * alpha.sin() * beta.cos(),
            0.0,
            0.0,
            0.0,
            of(first, "phi_rad"),
            of(first, "theta_rad"),
            of(first, "psi_rad"),
            of(first, "altitude_m"),
        ];
        let mut alphadot = 0.0;
        let mut worst = [0.0_f64; 2];
        let (step, thrust) = (0.01, of(first, "thrust_x_n"));
        for pair in rows.windows(2) {
            let mut at = |motion: &Motion, share: f64| {
                for (property, column) in [
                    ("fcs/elevator-pos-rad", "elevator_rad"),
                    ("fcs/left-aileron-pos-rad", "aileron_rad"),
                    ("fcs/rudder-pos-rad", "rudder_rad"),
                ] {
                    evaluator.set(property, (1.0 - share) * of(&pair[0], column) + share * of(&pair[1], column));
                }
                rates(&mut evaluator, motion, thrust, &mut alphadot)
            };
            let plus = |motion: &Motion, rate: &Motion, time: f64| -> Motion {
                std::array::from_fn(|k| motion[k] + time * rate[k])
            };
            let k1 = at(&motion, 0.0);
            let k2 = at(&plus(&motion, &k1, 0.5 * step), 0.5);
            let k3 = at(&plus(&motion, &k2, 0.5 * step), 0.5);
            let k4 = at(&plus(&motion, &k3, step), 1.0);
            motion = std::array::from_fn(|k| motion[k] + step / 6.0 * (k1[k] + 2.0 * (k2[k] + k3[k]) + k4[k]));
            let now = flight_at(&motion, 0.0);
            worst[0] = worst[0].max((now.airspeed_m_s - of(&pair[1], "tas_m_s")).abs());
            let angles = [
                (now.alpha_rad, "alpha_rad"),
                (now.beta_rad, "beta_rad"),
                (motion[6], "phi_rad"),
                (motion[7], "theta_rad"),
            ];
            for (value, column) in angles {
                worst[1] = worst[1].max((value - of(&pair[1], column)).abs());
            }
        }
        eprintln!("{name}: after 30 s, at most {:.4} m/s and {:.1e} rad from JSBSim's flight", worst[0], worst[1]);
        assert!(worst[0] < largest[0] && worst[1] < largest[1], "{name}: {worst:?}");
    }
}
