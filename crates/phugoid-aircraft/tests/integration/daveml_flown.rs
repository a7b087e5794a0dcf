//! Aircraft in DAVE-ML flown by the names of their variables alone, beside the check cases.

use phugoid_aircraft::check_case::trajectory::COLUMNS;
use phugoid_aircraft::check_case::{CheckCases, Trajectory};
use phugoid_aircraft::daveml::Model;
use phugoid_aircraft::vehicle::{DavemlVehicle, Schedule, VehicleError};
use phugoid_flight_dynamics::globe::condition::{InitialRates, Launch, World};
use phugoid_flight_dynamics::globe::flight::fly;
use phugoid_flight_dynamics::globe::steady::{solve, unsteadiness};

use crate::shared_data::shared_file;

fn models(files: &[&str]) -> Option<Vec<Model>> {
    files.iter().map(|file| Some(Model::open(shared_file(file)?).unwrap())).collect()
}

/// Largest difference of a column between a check case and the vehicle in its place.
fn differences(id: &str, vehicle: &mut DavemlVehicle, headings: &[&str], launched: Option<Launch>) -> Vec<f64> {
    let cases = CheckCases::read(&shared_file("nesc/cases.json").unwrap()).unwrap();
    let case = cases.case(id).unwrap();
    let expected = case.fly().unwrap();
    let mut flight = Trajectory::default();
    let mut count = 0;
    let start = launched.unwrap_or(case.launch).state(&case.world.planet, 0.0, []);
    fly(&case.world, vehicle, start, 0.0, case.duration, 0.01, |motion| {
        if count % 10 == 0 {
            flight.push(motion);
        }
        count += 1;
    })
    .unwrap();
    assert_eq!(flight.rows.len(), expected.rows.len());
    let difference = |heading: &&str| {
        let column = COLUMNS.iter().position(|name| name == heading).unwrap();
        let pairs = flight.rows.iter().zip(&expected.rows);
        pairs.map(|(a, b)| (a[column] - b[column]).abs()).fold(0.0, f64::max)
    };
    headings.iter().map(difference).collect()
}

#[test]
fn sphere_and_brick_from_their_files() {
    let sphere = ["nesc/models/cannonball_aero.dml", "nesc/models/cannonball_inertia.dml"];
    let brick = ["nesc/models/brick_aero.dml", "nesc/models/brick_inertia.dml"];
    let (Some(sphere), Some(brick)) = (models(&sphere), models(&brick)) else { return };
    let mut ball = DavemlVehicle::new(&sphere, &[]).unwrap();
    let worst = differences("08", &mut ball, &["altitudeMsl_ft", "longitude_deg", "aero_bodyForce_lbf_Z"], None);
    assert!(worst[0] < 1e-6 && worst[1] < 1e-12 && worst[2] < 1e-9, "{worst:?}");
    // The file states the lengths of the brick to five digits and a drag that the case does not have.
    let mut brick = DavemlVehicle::new(&brick, &[("totalCoefficientOfDrag", 0.0)]).unwrap();
    let worst = differences("03", &mut brick, &["altitudeMsl_ft", "bodyAngularRateWrtEi_deg_s_Roll"], None);
    assert!(worst[0] < 1e-6 && worst[1] < 1e-3, "{worst:?}");
}

#[test]
fn the_f16_from_its_files() {
    let folder = "checks/daveml_s119";
    let files = ["F16_control.dml", "F16_aero.dml", "F16_prop.dml", "F16_inertia.dml"].map(|f| format!("{folder}/{f}"));
    let Some(models) = models(&files.each_ref().map(String::as_str)) else { return };
    let pilot = [
        ("pilotControl_throttle", 0.0),
        ("pilotControl_long", 0.0),
        ("pilotControl_lat", 0.0),
        ("pilotControl_yaw", 0.0),
        ("stabilityAugmentationOn_disc", 0.0),
        ("autopilotOn_disc", 0.0),
        ("equivalentAirspeedCommand", 0.0),
        ("altitudeMslCommand", 0.0),
        ("lateralDeviationError", 0.0),
        ("trueBaseCourseCommand", 0.0),
        ("trimmedPilotControl_throttle", 0.0),
        ("trimmedPilotControl_long", 0.0),
        ("vrsPositionOfCM", 25.0),
    ];
    let mut aircraft = DavemlVehicle::new(&models, &pilot).unwrap();
    let case = CheckCases::read(&shared_file("nesc/cases.json").unwrap()).unwrap().case("11").unwrap();
    let world: World = case.world;
    let launch = |pitch: f64| {
        let mut launch = case.launch;
        (launch.euler.pitch, launch.rates) = (pitch, InitialRates::Local([0.0; 3]));
        launch
    };
    let [pitch, ..] = solve(
        |&[pitch, stick, throttle]: &[f64; 3]| {
            aircraft.set("trimmedPilotControl_throttle", throttle);
            aircraft.set("trimmedPilotControl_long", stick);
            let left = unsteadiness(&world, &mut aircraft, &launch(pitch), []);
            [left.along_right_down[0], left.along_right_down[2], left.angular_acceleration[1]]
        },
        [0.045, 0.13, 0.14],
        [1e-5; 3],
        1e-11,
    )
    .unwrap();
    let headings = ["altitudeMsl_ft", "eulerAngle_deg_Roll", "aero_bodyMoment_ftlbf_M"];
    let worst = differences("11", &mut aircraft, &headings, Some(launch(pitch)));
    assert!(worst[0] < 1e-4 && worst[1] < 1e-6 && worst[2] < 1e-4, "{worst:?}");

    // Names that nothing has, inputs that are left open, and what is missing.
    assert!(
        !aircraft.set("angleOfAttack", 1.0) && !aircraft.schedule("flaps", Schedule::new(vec![[0.0, 1.0]]).unwrap())
    );
    assert!(aircraft.schedule("pilotControl_long", Schedule::new(vec![[0.0, 0.0], [1.0, 0.1]]).unwrap()));
    let left = DavemlVehicle::new(&models, &pilot[1..]).err();
    assert_eq!(left, Some(VehicleError::Open { name: "pilotControl_throttle".to_owned() }));
    let left = DavemlVehicle::new(&models, &[("flaps", 1.0)]).err();
    assert_eq!(left, Some(VehicleError::NotSettable { name: "flaps".to_owned() }));
    let left = DavemlVehicle::new(&models[..3], &pilot[..12]).err();
    assert!(matches!(left, Some(VehicleError::Missing { .. })), "{left:?}");
}

#[test]
fn schedules_are_linear_between_rising_times() {
    for bad in [vec![], vec![[1.0, 0.0], [1.0, 2.0]], vec![[f64::NAN, 0.0]], vec![[2.0, 0.0], [1.0, 0.0]]] {
        assert_eq!(Schedule::new(bad), None);
    }
    let ramp = Schedule::new(vec![[0.0, 1.0], [2.0, -1.0], [4.0, 0.0]]).unwrap();
    let values = [-1.0, 0.0, 1.0, 2.0, 3.0, 4.0, 9.0].map(|t| ramp.at(t));
    assert_eq!(values, [1.0, 1.0, 0.0, -1.0, -0.5, 0.0, 0.0]);
    assert!(ramp.at(f64::NAN).is_nan());
}
