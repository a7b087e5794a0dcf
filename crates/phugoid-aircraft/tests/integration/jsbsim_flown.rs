//! Flights that JSBSim flew, flown again over the same sphere from its files alone.

use phugoid_aircraft::jsbsim::{Aircraft, Evaluator};
use phugoid_aircraft::vehicle::{JsbsimVehicle, Schedule};
use phugoid_flight_dynamics::globe::attitude::EulerAngles;
use phugoid_flight_dynamics::globe::condition::{InitialRates, Launch, World};
use phugoid_flight_dynamics::globe::flight::fly;
use phugoid_flight_dynamics::globe::planet::{Geodetic, Planet};

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
