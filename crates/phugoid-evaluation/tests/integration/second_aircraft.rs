//! From a scenario to the derivatives of an aircraft that is not the F-16, through the same functions.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)] // tests may

use crate::light_aircraft;

use light_aircraft::LightAircraft;
use phugoid_identification::estimate::{EstimateOptions, estimate};
use phugoid_identification::model_file::ModelFile;
use phugoid_simulation::flight::fly_aircraft;
use phugoid_simulation::scenario::Scenario;

/// `type` is a word that the reader asks for; the flight is that of the aircraft handed over.
const SCENARIO: &str = r#"
name = "light aircraft, two doublets"
duration = "20 s"
sample_rate = "50 Hz"
seed = 3

[aircraft]
type = "f16"
thrust = "engine"

[condition]
altitude = "0 ft"
speed = "176 ft/s"

[[manoeuvre]]
type = "3-2-1-1"
surface = "elevator"
start = "1 s"
unit = "0.4 s"
amplitude = "2 deg"

[[manoeuvre]]
type = "3-2-1-1"
surface = "elevator"
start = "10 s"
unit = "0.6 s"
amplitude = "-2 deg"

[sensors]
true_airspeed = { noise = "0.2 m/s" }
alpha = { noise = "0.1 deg" }
theta = { noise = "0.05 deg" }
q = { noise = "0.1 deg/s" }
ax = { noise = "0.005 g" }
az = { noise = "0.01 g" }
"#;

const MODEL: &str = r#"
name = "light aircraft"
axes = ["longitudinal"]
outputs = ["true_airspeed", "alpha", "theta", "q", "ax", "az"]

[aircraft]
mass = "2750 lb"
iyy = "3000 slug*ft^2"
wing_area = "184 ft^2"
mean_chord = "5.7 ft"
thrust = { channel = "thrust" }
air_density = "standard_atmosphere"

[coefficients]
CD = ["1", "alpha"]
CL = ["1", "alpha", "q_hat", "elevator"]
Cm = ["1", "alpha", "q_hat", "elevator"]

[parameters]
CD_0 = { start = 0.03, prior_std = 0.05 }
CD_alpha = { start = 0.2, prior_std = 0.5 }
CL_0 = { start = 0.3, prior_std = 0.5 }
CL_alpha = { start = 5.0, prior_std = 2.0 }
CL_q = { start = 0.0, prior_std = 10.0 }
CL_elevator = { start = 0.0, prior_std = 1.0 }
Cm_0 = { start = 0.0, prior_std = 0.1 }
Cm_alpha = { start = -0.5, prior_std = 0.5 }
Cm_q = { start = -10.0, prior_std = 10.0 }
Cm_elevator = { start = -1.0, prior_std = 0.5 }

[noise]
true_airspeed = 0.2
alpha = 0.001745
theta = 0.000873
q = 0.001745
ax = 0.049
az = 0.098
"#;

#[test]
fn its_derivatives_are_found_within_their_bounds() {
    let scenario = Scenario::parse(SCENARIO, "light.toml").unwrap();
    let aircraft = LightAircraft::new();
    let flight = fly_aircraft(&aircraft, &scenario, &|_| ()).unwrap();
    assert_eq!(flight.data_range.alpha, [-0.15, 0.25]);
    let model = ModelFile::parse("light-aircraft.toml", MODEL).unwrap();
    let estimation = estimate(&flight.measured, &model, &EstimateOptions::default(), &mut |_| {}).unwrap();
    let truth = [
        ("CL_0", light_aircraft::CL_0),
        ("CL_alpha", light_aircraft::CL_ALPHA),
        ("CD_0", light_aircraft::CD_0),
        ("Cm_alpha", light_aircraft::CM_ALPHA),
        ("Cm_q", light_aircraft::CM_Q),
        ("Cm_elevator", light_aircraft::CM_ELEVATOR),
    ];
    for (name, truth) in truth {
        let found = estimation.parameters.iter().find(|p| p.name == name).unwrap();
        let (error, std_error) = (found.value - truth, found.std_error);
        println!("{name}: {:.4} +- {std_error:.4}, true {truth}", found.value);
        assert!(error.abs() < 4.0 * std_error, "{name}: {} +- {std_error}, true {truth}", found.value);
        assert!(error.abs() < 0.1 * truth.abs(), "{name}: {}, true {truth}", found.value);
    }
}
