//! Flights that JSBSim flew, flown again over the same sphere from its files alone.

use phugoid_aircraft::jsbsim::{Aircraft, Evaluator};
use phugoid_aircraft::vehicle::{JsbsimVehicle, Schedule};
use phugoid_flight_dynamics::globe::attitude::EulerAngles;
use phugoid_flight_dynamics::globe::condition::{InitialRates, Launch, World};
use phugoid_flight_dynamics::globe::flight::fly;
use phugoid_flight_dynamics::globe::planet::{Geodetic, Planet};
use phugoid_flight_dynamics::globe::steady::{solve, unsteadiness};

use crate::jsbsim::{package, text_of};
use crate::shared_data::shared_file;

const FOOT: f64 = 0.3048;

/// A table with headings.
struct Record {
    headings: Vec<String>,
    rows: Vec<Vec<f64>>,
}

impl Record {
    fn parse(text: &str) -> Self {
        let mut lines = text.lines();
        let headings = lines.next().unwrap().split(',').map(str::to_owned).collect();
        let rows = lines.map(|line| line.split(',').map(|word| word.parse().unwrap()).collect()).collect();
        Self { headings, rows }
    }

    fn column(&self, heading: &str) -> Vec<f64> {
        let column = self.headings.iter().position(|found| found == heading).unwrap();
        self.rows.iter().map(|row| row[column]).collect()
    }
}

/// Columns that are compared.
const COMPARED: [&str; 9] =
    ["tas_m_s", "alpha_rad", "beta_rad", "p_rad_s", "q_rad_s", "r_rad_s", "phi_rad", "theta_rad", "altitude_m"];

#[test]
fn recorded_flights_are_flown_again() {
    let Some(package) = package() else { return };
    for name in ["c182", "fokker100", "f15"] {
        let Some(file) = shared_file(&format!("jsbsim/{name}.json")) else { return };
        let known: serde_json::Value = serde_json::from_str(&text_of(&file)).unwrap();
        let aircraft = Aircraft::open(package.join("aircraft").join(name)).unwrap();
        for size in ["small", "large"] {
            let record = Record::parse(&text_of(&file.with_file_name(format!("{name}_{size}.csv.gz"))));
            let worst = flown(&aircraft, &record);
            for (heading, difference) in COMPARED.iter().zip(worst) {
                // JSBSim with steps twice as long: its error of first order, of which about as much is left.
                let halved = &known["flights"][size]["largest_difference_to_the_run_with_0p0004_s"][heading];
                let halved = halved.as_f64().unwrap();
                println!("{name} {size} {heading}: {difference:.2e}, {:.2} of its error of step", difference / halved);
                assert!(difference < 3.0 * halved, "{name} {size} {heading}: {difference:e} {halved:e}");
            }
        }
    }
}

/// Largest differences of a flight again from the record.
fn flown(aircraft: &Aircraft, record: &Record) -> [f64; COMPARED.len()] {
    let mut evaluator = Evaluator::new(aircraft);
    evaluator.set("gear/gear-pos-norm", 0.0);
    let mut vehicle = JsbsimVehicle::new(evaluator).unwrap();
    let time = record.column("t_s");
    let first = |heading: &str| record.column(heading)[0];
    for (property, heading) in [
        ("fcs/elevator-pos-rad", "elevator_rad"),
        ("fcs/left-aileron-pos-rad", "aileron_rad"),
        ("fcs/rudder-pos-rad", "rudder_rad"),
    ] {
        let instants = time.iter().zip(record.column(heading)).map(|(t, x)| [*t, x]).collect();
        assert!(vehicle.schedule(property, Schedule::new(instants).unwrap()), "{property}");
    }
    vehicle.replace_engines([first("thrust_x_n"), 0.0, 0.0]);
    let planet = Planet::sphere(20_925_646.0 * FOOT, 1.407_644_175_72e16 * FOOT.powi(3), 0.0);
    let world = World::new(planet);
    let launch = Launch {
        place: Geodetic { altitude: first("altitude_m"), ..Geodetic::default() },
        velocity: [first("vn_m_s"), first("ve_m_s"), first("vd_m_s")],
        euler: EulerAngles { yaw: first("psi_rad"), pitch: first("theta_rad"), roll: first("phi_rad") },
        rates: InitialRates::Inertial([first("p_rad_s"), first("q_rad_s"), first("r_rad_s")]),
    };
    let columns = COMPARED.map(|heading| record.column(heading));
    let mut worst = [0.0_f64; COMPARED.len()];
    let mut row = 0;
    let start = launch.state(&planet, 0.0, []);
    fly(&world, &mut vehicle, start, 0.0, *time.last().unwrap(), 0.01, |motion| {
        let c = &motion.condition;
        let [p, q, r] = c.rates_to_earth;
        let ours = [c.air.speed, c.air.alpha, c.air.beta, p, q, r, c.euler.roll, c.euler.pitch, c.place.altitude];
        for ((most, ours), column) in worst.iter_mut().zip(ours).zip(&columns) {
            *most = most.max((ours - column[row]).abs());
        }
        row += 1;
    })
    .unwrap();
    assert_eq!(row, time.len());
    worst
}

/// Trim with all six unknowns: pitch angle, sideslip, elevator, aileron, rudder and thrust.
#[test]
fn trim_is_that_of_jsbsim() {
    let Some(package) = package() else { return };
    let planet = Planet::sphere(20_925_646.0 * FOOT, 1.407_644_175_72e16 * FOOT.powi(3), 0.0);
    let world = World::new(planet);
    for name in ["c182", "fokker100", "f15"] {
        let Some(file) = shared_file(&format!("jsbsim/{name}.json")) else { return };
        let known: serde_json::Value = serde_json::from_str(&text_of(&file)).unwrap();
        let trim = |key: &str| known["trim"][key].as_f64().unwrap();
        let aircraft = Aircraft::open(package.join("aircraft").join(name)).unwrap();
        let mut evaluator = Evaluator::new(&aircraft);
        evaluator.set("gear/gear-pos-norm", 0.0);
        let mut vehicle = JsbsimVehicle::new(evaluator).unwrap();
        let solution = solve(
            |&[pitch, sideslip, elevator, aileron, rudder, thrust]: &[f64; 6]| {
                for (property, value) in [
                    ("fcs/elevator-pos-rad", elevator),
                    ("fcs/left-aileron-pos-rad", aileron),
                    ("fcs/rudder-pos-rad", rudder),
                ] {
                    vehicle.evaluator().set(property, value);
                }
                vehicle.replace_engines([thrust, 0.0, 0.0]);
                let launch = Launch {
                    place: Geodetic { altitude: trim("alt_m"), ..Geodetic::default() },
                    velocity: [trim("V_m_s") * sideslip.cos(), trim("V_m_s") * sideslip.sin(), 0.0],
                    euler: EulerAngles { pitch, ..EulerAngles::default() },
                    rates: InitialRates::Local([0.0; 3]),
                };
                let left = unsteadiness(&world, &mut vehicle, &launch, []);
                let ([x, y, z], [l, m, n]) = (left.along_right_down, left.angular_acceleration);
                [x, y, z, l, m, n]
            },
            [0.02, 0.0, 0.0, 0.0, 0.0, 0.2 * trim("thrust_x_n")],
            [1e-6, 1e-6, 1e-6, 1e-6, 1e-6, 0.01],
            1e-9,
        )
        .unwrap();
        // JSBSim's trim has no rates at all; this one turns with the curvature, which takes V^2/R off the lift and adds
        // a pitch rate of V/R.
        let turning = trim("V_m_s") / (20_925_646.0 * FOOT);
        let slack = 2e-7 + 2.0 * trim("alpha_rad").abs() * trim("V_m_s") * turning / 9.8 + 10.0 * turning;
        let [pitch, sideslip, elevator, aileron, rudder, thrust] = solution;
        for (ours, key) in [
            (pitch, "theta_rad"),
            (sideslip, "beta_rad"),
            (elevator, "elevator_rad"),
            (aileron, "aileron_rad"),
            (rudder, "rudder_rad"),
        ] {
            assert!((ours - trim(key)).abs() < slack, "{name} {key}: {ours} {} {slack:e}", trim(key));
        }
        assert!((thrust / trim("thrust_x_n") - 1.0).abs() < 1e-3, "{name}: {thrust}");
    }
}

#[test]
fn flight_control_of_the_files_moves_the_surfaces() {
    let Some(package) = package() else { return };
    let aircraft = Aircraft::open(package.join("aircraft/c182")).unwrap();
    let world = World::new(Planet::WGS84);
    let launch = Launch {
        place: Geodetic { latitude: 0.7, longitude: 0.2, altitude: 1500.0 },
        velocity: [60.0, 0.0, 0.0],
        euler: EulerAngles { pitch: 0.02, ..EulerAngles::default() },
        rates: InitialRates::Local([0.0; 3]),
    };
    let pitch_rate = |command: f64| {
        let mut vehicle = JsbsimVehicle::new(Evaluator::new(&aircraft)).unwrap();
        vehicle.run_channels(0.01);
        assert!(vehicle.evaluator().set("fcs/elevator-cmd-norm", command));
        let start = launch.state(&world.planet, 0.0, []);
        let end = fly(&world, &mut vehicle, start, 0.0, 1.0, 0.01, |_| ()).unwrap();
        (end.rates[1], vehicle.evaluator().get("fcs/elevator-pos-rad").unwrap())
    };
    let ((up, up_surface), (down, down_surface)) = (pitch_rate(-0.2), pitch_rate(0.2));
    assert!(up_surface < 0.0 && down_surface > 0.0, "{up_surface} {down_surface}");
    assert!(up > down + 0.05, "{up} {down}");
}
