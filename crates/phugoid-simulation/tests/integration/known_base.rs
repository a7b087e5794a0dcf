//! Increments to the aircraft of a file: what the base gives, what is refused, and how good the estimates are.

use std::path::{Path, PathBuf};

use phugoid_flight_dynamics::aircraft::Aircraft;
use phugoid_flight_dynamics::linearize::linearize;
use phugoid_flight_dynamics::motion::Disturbance;
use phugoid_flight_dynamics::trim::{TrimCondition, trim};
use phugoid_identification::estimate::{EstimateOptions, estimate};
use phugoid_identification::estimation::Estimation;
use phugoid_identification::method::Method;
use phugoid_identification::model_file::{Base, ModelFile};
use phugoid_simulation::aircraft::AnyAircraft;
use phugoid_simulation::flight::fly;
use phugoid_simulation::scenario::Scenario;

use crate::shared_data::shared_file;

/// Folder of the package of JSBSim, as the tests of `phugoid-aircraft` find it.
pub(super) fn package() -> Option<PathBuf> {
    if let Some(folder) = std::env::var_os("PHUGOID_JSBSIM") {
        return Some(PathBuf::from(folder));
    }
    let python = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../target/python/lib");
    let versions = std::fs::read_dir(&python).into_iter().flatten().flatten();
    let found = versions.map(|version| version.path().join("site-packages/jsbsim")).find(|path| path.is_dir());
    if found.is_none() {
        eprintln!("skipped: no package jsbsim (set PHUGOID_JSBSIM, or run scripts/python-tools.sh)");
    }
    found
}

/// Altitude (m) and speed (m/s) that an aircraft flies at.
struct Flown {
    name: &'static str,
    base: String,
    aircraft: String,
    at: [f64; 2],
    amplitude: &'static str,
}

fn jsbsim(name: &'static str, at: [f64; 2], amplitude: &'static str) -> Option<Flown> {
    let path = package()?.join("aircraft").join(name);
    Some(Flown { name, base: format!("base = {path:?}"), aircraft: format!("file = {path:?}"), at, amplitude })
}

impl Flown {
    fn model(&self) -> ModelFile {
        let [altitude, speed] = self.at;
        // A table stands behind the plain keys.
        let (before, after) =
            if self.base.starts_with('[') { ("", self.base.as_str()) } else { (self.base.as_str(), "") };
        let text = format!(
            r#"
axes = ["longitudinal"]
input = "held"
{before}
[aircraft]
thrust = {{ channel = "thrust" }}
air_density = "standard_atmosphere"
reference_speed = {speed}
[coefficients]
CL = ["alpha"]
CD = ["alpha"]
Cm = ["alpha", "q_hat"]
[reference]
altitude = {altitude}
[parameters]
dCm_alpha = {{ bounds = [-1, 1] }}
dCm_q = {{ bounds = [-15, 15] }}
dCL_alpha = {{ bounds = [-2, 2] }}
dCD_alpha = {{ bounds = [-0.5, 0.5] }}
{after}
"#
        );
        ModelFile::parse("increments.toml", &text).unwrap_or_else(|error| panic!("{error}"))
    }

    fn scenario(&self, increments: &str) -> Scenario {
        let [altitude, speed] = self.at;
        let text = format!(
            r#"
name = "{name}"
duration = "12 s"
sample_rate = "50 Hz"
[aircraft]
{aircraft}
[condition]
altitude = "{altitude} m"
speed = "{speed} m/s"
[[manoeuvre]]
type = "3-2-1-1"
surface = "elevator"
start = "0.5 s"
unit = "0.5 s"
amplitude = "{amplitude}"
[[manoeuvre]]
type = "3-2-1-1"
surface = "elevator"
start = "6 s"
unit = "0.4 s"
amplitude = "-{amplitude}"
[increments]
{increments}
[sensors]
true_airspeed = {{ noise = "1 ft/s" }}
alpha = {{ noise = "0.1 deg" }}
theta = {{ noise = "0.05 deg" }}
q = {{ noise = "0.1 deg/s" }}
ax = {{ noise = "0.01 g" }}
az = {{ noise = "0.01 g" }}
"#,
            name = self.name,
            aircraft = self.aircraft,
            amplitude = self.amplitude,
        );
        Scenario::parse(&text, "increments").unwrap_or_else(|error| panic!("{error}"))
    }
}

fn estimated(model: &ModelFile, scenario: &Scenario, method: Method) -> Estimation {
    let flight = fly(scenario).unwrap_or_else(|error| panic!("{}: {error}", scenario.name));
    estimate(
        &flight.measured,
        model,
        &EstimateOptions { method: Some(method), ..EstimateOptions::default() },
        &mut |_| (),
    )
    .unwrap()
}

const CHANGED: [(&str, f64); 4] = [("dCm_alpha", 0.15), ("dCm_q", 3.0), ("dCL_alpha", -0.4), ("dCD_alpha", 0.05)];

fn changed() -> String {
    written(&CHANGED)
}

fn written(increments: &[(&str, f64)]) -> String {
    increments.iter().map(|(name, value)| format!("{name} = {value:?}\n")).collect()
}

/// Of how many estimates the truth was within the bounds (two sigma), by parameter, over seeds.
fn covered(flown: &Flown, increments: &str, truth: impl Fn(&str) -> f64, seeds: u64) -> Vec<(String, u64, f64)> {
    let (model, scenario) = (flown.model(), flown.scenario(increments));
    let mut counts: Vec<(String, u64, f64)> = Vec::new();
    for seed in 1..=seeds {
        let scenario = Scenario { seed, ..scenario.clone() };
        let found = estimated(&model, &scenario, Method::Smpe);
        for parameter in found.parameters.iter().filter(|p| !p.nuisance) {
            let error = parameter.value - truth(&parameter.name);
            let inside = error.abs() <= 2.0 * parameter.corrected_std_error;
            let place = counts.iter().position(|(name, ..)| *name == parameter.name).unwrap_or_else(|| {
                counts.push((parameter.name.clone(), 0, 0.0));
                counts.len() - 1
            });
            counts[place].1 += u64::from(inside);
            counts[place].2 += error / seeds as f64;
        }
    }
    counts
}

fn truth_of(name: &str) -> f64 {
    value_of(&CHANGED, name)
}

fn value_of(increments: &[(&str, f64)], name: &str) -> f64 {
    increments.iter().find(|(other, _)| *other == name).map_or(0.0, |(_, value)| *value)
}

#[test]
fn a_base_gives_mass_inertia_and_sizes_and_refuses_others() {
    let Some(flown) = jsbsim("f15", [6096.0, 210.0], "1 deg") else { return };
    let model = flown.model();
    assert_eq!(model.base, Base::Aircraft);
    let known = model.known.as_ref().unwrap().aircraft();
    assert_eq!(model.aircraft.wing_area, known.geometry().wing_area);
    assert_eq!(model.aircraft.mean_chord, known.geometry().mean_chord);
    let parsed = |extra: &str| {
        let text = format!(
            "axes = [\"longitudinal\"]\n{}\n[aircraft]\nthrust = 0\nair_density = 0.6\nreference_speed = 200\n{extra}\n\
             [coefficients]\nCm = [\"alpha\"]\n[parameters]\ndCm_alpha = {{ bounds = [-1, 1] }}",
            flown.base
        );
        ModelFile::parse("increments.toml", &text).unwrap_err().to_string()
    };
    let text = parsed("wing_area = 3");
    assert!(text.contains("`wing_area` is 3, and the coefficients of `base` belong to"), "{text}");
    assert!(parsed("cg = 0.2").contains("`cg` is that of the aircraft of `base`"));
    for (base, words) in [
        ("base = \"no/such/folder\"", "the base cannot be read"),
        ("base = \"f-16\"", "did you mean `f16`?"),
        ("base = \"learjet\"", "or the path of an aircraft"),
        ("base = \"other.toml\"", "not another model file"),
        ("base = { with = [] }", "the path of an aircraft"),
    ] {
        let text = format!("axes = [\"longitudinal\"]\n{base}\n[aircraft]\nthrust = 0\n");
        let text = ModelFile::parse("increments.toml", &text).unwrap_err().to_string();
        assert!(text.starts_with("increments.toml:2:") && text.contains(words), "{text}");
    }
}

#[test]
fn without_increments_the_model_file_is_the_aircraft_of_its_base() {
    let Some(flown) = jsbsim("c182", [1524.0, 61.7], "1 deg") else { return };
    let [altitude, speed] = flown.at;
    let model = phugoid_identification::aircraft::ModelAircraft::new(&flown.model()).unwrap();
    let known = flown.model().known.unwrap();
    let condition = TrimCondition::steady(&model, speed, altitude, 0.0, 0.0);
    let (ours, theirs) = (trim(&model, &condition).unwrap(), trim(known.aircraft().as_ref(), &condition).unwrap());
    for (a, b) in
        [(ours.alpha_rad, theirs.alpha_rad), (ours.elevator_rad, theirs.elevator_rad), (ours.throttle, theirs.throttle)]
    {
        assert!((a - b).abs() < 1e-9, "{a} {b}");
    }
    let still = Disturbance::default();
    let linear = |at: &phugoid_flight_dynamics::trim::Trim| {
        (
            linearize(&model, &at.state(), &at.controls(), &still),
            linearize(known.aircraft().as_ref(), &at.state(), &at.controls(), &still),
        )
    };
    let (ours, theirs) = linear(&theirs);
    let longitudinal = ["speed", "alpha", "theta", "q"]
        .map(|wanted| ours.states.iter().position(|name| name.split('_').next() == Some(wanted)).unwrap());
    for i in longitudinal {
        for j in longitudinal {
            assert!((ours.a[i][j] - theirs.a[i][j]).abs() < 1e-7, "{i} {j}: {} {}", ours.a[i][j], theirs.a[i][j]);
        }
    }
}

#[test]
fn increments_of_an_aircraft_of_jsbsim_lie_within_their_bounds() {
    let Some(flown) = jsbsim("f15", [6096.0, 210.0], "1 deg") else { return };
    const SEEDS: u64 = 50;
    let counts = covered(&flown, &changed(), truth_of, SEEDS);
    println!("{}, changed: {counts:?}", flown.name);
    // 95 % of 50 are 47.5; fewer than 42 would have a chance of 0.3 % at a coverage of 95 %.
    for (name, inside, mean) in &counts {
        assert!(*inside >= 42, "{name}: {inside} of {SEEDS}, mean error {mean}");
    }
    let unchanged = covered(&flown, "", |_| 0.0, SEEDS);
    println!("{}, unchanged: {unchanged:?}", flown.name);
    for (name, inside, mean) in &unchanged {
        assert!(*inside >= 42, "{name}: {inside} of {SEEDS}, mean error {mean}");
    }
}

#[test]
fn without_noise_the_increments_are_those_flown_for_three_aircraft() {
    let flown = [
        jsbsim("f15", [6096.0, 210.0], "1 deg"),
        jsbsim("fokker100", [6096.0, 180.0], "1 deg"),
        jsbsim("c182", [1524.0, 61.7], "2 deg"),
    ];
    for flown in flown.into_iter().flatten() {
        for (increments, factor) in [(changed(), 1.0), (String::new(), 0.0)] {
            let scenario = flown.scenario(&increments);
            let quiet = Scenario { sensors: Default::default(), ..scenario };
            let found = estimated(&flown.model(), &quiet, Method::OutputError);
            for parameter in found.parameters.iter().filter(|p| !p.nuisance) {
                let error = parameter.value - factor * truth_of(&parameter.name);
                println!("{} {}: {:.6}, error {error:.1e}", flown.name, parameter.name, parameter.value);
                // The propeller rolls the c182, so that it flies with sideslip, which the longitudinal motion does not know.
                let most = match (flown.name, parameter.name.as_str()) {
                    ("c182", _) => 0.03,
                    (_, "dCm_q") => 3e-3,
                    _ => 2e-4,
                };
                assert!(error.abs() < most, "{} {}: {error:e}", flown.name, parameter.name);
            }
        }
    }
}

#[test]
fn a_base_in_daveml_takes_its_further_files() {
    let file = |name: &str| shared_file(&format!("checks/daveml_s119/{name}"));
    let (Some(aero), Some(inertia), Some(engine)) =
        (file("F16_aero.dml"), file("F16_inertia.dml"), file("F16_prop.dml"))
    else {
        return;
    };
    let flown = Flown {
        name: "F-16 in DAVE-ML",
        base: format!(
            "[base]\nfile = {aero:?}\nwith = [{inertia:?}, {engine:?}]\n[base.properties]\nvrsPositionOfCM = 30.0\n"
        ),
        aircraft: format!(
            "file = {aero:?}\nwith = [{inertia:?}, {engine:?}]\nproperties = {{ vrsPositionOfCM = 30.0 }}"
        ),
        at: [6096.0, 205.74],
        amplitude: "1 deg",
    };
    // With less stability it would fly no further than some seconds.
    let flown_with = [("dCm_alpha", -0.2), ("dCm_q", -2.0), ("dCL_alpha", 0.4), ("dCD_alpha", 0.1)];
    let found = estimated(&flown.model(), &flown.scenario(&written(&flown_with)), Method::Smpe);
    for parameter in found.parameters.iter().filter(|p| !p.nuisance) {
        let error = parameter.value - value_of(&flown_with, &parameter.name);
        println!("{}: {:.4} +- {:.4}", parameter.name, parameter.value, 2.0 * parameter.corrected_std_error);
        assert!(error.abs() < 3.0 * parameter.corrected_std_error, "{}: {error}", parameter.name);
    }
    let totals = found.totals.iter().find(|total| total.name == "Cm_q").unwrap();
    // The table of the damping, which is the same as that of the built-in aircraft.
    assert!((totals.database + 6.75).abs() < 0.1, "{}", totals.database);
    let any = AnyAircraft::open(&aero, &phugoid_aircraft::flown::FlownOptions::default());
    assert!(any.is_err());
}
