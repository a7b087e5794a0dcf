//! Aircraft in DAVE-ML over a flat earth: the F-16 of NASA against the built-in one with the same tables, and what is refused.

use std::path::PathBuf;

use phugoid_aircraft::flown::{AircraftFile, FlownError, FlownOptions, Thrust};
use phugoid_flight_dynamics::aircraft::{AirData, Aircraft, Controls, State};
use phugoid_flight_dynamics::f16::{F16, F16Options, F16Tables};
use phugoid_flight_dynamics::motion::{Disturbance, motion};
use phugoid_flight_dynamics::scalar::{Dual, Scalar};
use phugoid_flight_dynamics::trim::{TrimCondition, trim};
use phugoid_simulation::flight::fly;
use phugoid_simulation::scenario::Scenario;

use crate::shared_data::shared_file;

const FOLDER: &str = "checks/daveml_s119";

fn f16_files() -> Option<[PathBuf; 3]> {
    let file = |name: &str| shared_file(&format!("{FOLDER}/{name}"));
    Some([file("F16_aero.dml")?, file("F16_inertia.dml")?, file("F16_prop.dml")?])
}

/// The F-16 of NASA's files with its centre of gravity at 30 % of the mean chord.
fn f16() -> Option<AircraftFile> {
    let [aero, inertia, engine] = f16_files()?;
    let properties = vec![("vrsPositionOfCM".to_owned(), 30.0)];
    let options = FlownOptions { with: vec![engine, inertia], properties, ..FlownOptions::default() };
    Some(AircraftFile::open_with(aero, &options).unwrap())
}

fn write(name: &str, text: &str) -> PathBuf {
    let file = std::env::temp_dir().join(format!("phugoid-{}-{name}.dml", std::process::id()));
    std::fs::write(&file, text).unwrap();
    file
}

#[test]
fn coefficients_of_the_f16_in_daveml_are_those_of_the_built_in_one() {
    let Some(found) = f16() else { return };
    let known = F16::new(F16Options { tables: F16Tables::Morelli, cg: 0.30, ..F16Options::default() }).unwrap();
    assert!((found.mass_properties().mass() / known.mass_properties().mass() - 1.0).abs() < 1e-3);
    let mut worst: f64 = 0.0;
    for alpha in [-7.0, 2.5, 18.0, 33.0] {
        for (beta, elevator, aileron, rudder) in [(0.0, -2.0, 0.0, 0.0), (4.0, 7.0, 11.0, -13.0)] {
            let at = |degrees: f64| degrees.to_radians();
            let air = AirData {
                speed: 180.0,
                alpha: at(alpha),
                beta: at(beta),
                density: 0.9,
                dynamic_pressure: 0.5 * 0.9 * 180.0 * 180.0,
                mach: 0.55,
            };
            let controls = Controls { throttle: 0.2, elevator: at(elevator), aileron: at(aileron), rudder: at(rudder) };
            let [ours, theirs] = [
                found.coefficients(&air, [0.2, -0.1, 0.15], &controls),
                known.coefficients(&air, [0.2, -0.1, 0.15], &controls),
            ]
            .map(|c| [c.cx, c.cy, c.cz, c.cl, c.cm, c.cn]);
            for (a, b) in ours.iter().zip(theirs) {
                worst = worst.max((a - b).abs());
            }
        }
    }
    println!("largest difference of a coefficient {worst:.1e}");
    assert!(worst < 2e-5, "{worst:e}");
}

#[test]
fn derivatives_of_the_f16_in_daveml_are_those_of_its_values() {
    let Some(aircraft) = f16() else { return };
    // Between the points of every table.
    let centre = [170.0, 0.063, 0.021, 0.9, 0.5, 0.11, 0.07, -0.09, -0.034, 0.051, 0.023];
    fn of<T: Scalar>(aircraft: &AircraftFile, x: [T; 11]) -> [T; 6] {
        let [speed, alpha, beta, density, mach, p, q, r, elevator, aileron, rudder] = x;
        let dynamic_pressure = density * speed * speed * 0.5;
        let air = AirData { speed, alpha, beta, density, dynamic_pressure, mach };
        let controls = Controls { throttle: T::from(0.2), elevator, aileron, rudder };
        let c = aircraft.coefficients(&air, [p, q, r], &controls);
        [c.cx, c.cy, c.cz, c.cl, c.cm, c.cn]
    }
    let exact = of(&aircraft, std::array::from_fn(|i| Dual::<11>::variable(centre[i], i)));
    for i in 0..11 {
        let moved = |step: f64| {
            let mut x = centre;
            x[i] += step;
            of(&aircraft, x)
        };
        let (above, below) = (moved(1e-6), moved(-1e-6));
        for k in 0..6 {
            let slope = (above[k] - below[k]) / 2e-6;
            assert!((exact[k].derivatives[i] - slope).abs() < 1e-7, "{k} by {i}: {} {slope}", exact[k].derivatives[i]);
        }
    }
    // Thrust is that of the engine's file: 0.2 of the lever's way, by its own table and by its slope.
    let at = |power: f64| aircraft.propulsion(power, 1500.0, 0.4).force[0];
    let slope = aircraft.propulsion(Dual::<1>::variable(20.0, 0), Dual::from(1500.0), Dual::from(0.4)).force[0];
    let difference = (at(20.1) - at(19.9)) / 0.2;
    assert!((slope.derivatives[0] / difference - 1.0).abs() < 1e-9, "{} {difference}", slope.derivatives[0]);
    assert!((slope.value / at(20.0) - 1.0).abs() < 1e-13, "{} {}", slope.value, at(20.0));
}

#[test]
fn the_f16_in_daveml_trims_where_the_built_in_one_does() {
    let Some(found) = f16() else { return };
    let known = F16::new(F16Options { tables: F16Tables::Morelli, cg: 0.30, ..F16Options::default() }).unwrap();
    let (speed, altitude) = (502.0 * 0.3048, 0.0);
    let ours = trim(&found, &TrimCondition::steady(&found, speed, altitude, 0.0, 0.0)).unwrap();
    let theirs = trim(&known, &TrimCondition::steady(&known, speed, altitude, 0.0, 0.0)).unwrap();
    println!(
        "alpha {:.5} and {:.5} deg, elevator {:.5} and {:.5} deg, thrust {:.2} and {:.2} N",
        ours.alpha_rad.to_degrees(),
        theirs.alpha_rad.to_degrees(),
        ours.elevator_rad.to_degrees(),
        theirs.elevator_rad.to_degrees(),
        ours.thrust_n,
        theirs.thrust_n
    );
    // What is left is the air: that of the book is 0.02 % less dense at sea level, and its pound of mass is rounded.
    assert!((ours.alpha_rad - theirs.alpha_rad).to_degrees().abs() < 0.01);
    assert!((ours.elevator_rad - theirs.elevator_rad).to_degrees().abs() < 0.01);
    assert!((ours.thrust_n / theirs.thrust_n - 1.0).abs() < 2e-3);
    // It is steady by the equations of motion.
    let rates = motion(&found, &ours.state(), &ours.controls(), &Disturbance::default()).rates;
    assert!(rates.speed.abs() < 1e-8 && rates.alpha.abs() < 1e-9 && rates.q.abs() < 1e-8, "{rates:?}");
}

#[test]
fn the_order_of_files_does_not_matter_and_notes_say_what_is_assumed() {
    let Some([aero, inertia, engine]) = f16_files() else { return };
    let open = |first: &PathBuf, with: [&PathBuf; 2]| {
        let options = FlownOptions { with: with.map(Clone::clone).to_vec(), ..FlownOptions::default() };
        AircraftFile::open_with(first, &options).unwrap()
    };
    let (one, other) = (open(&aero, [&inertia, &engine]), open(&engine, [&inertia, &aero]));
    let state = State::from_array([150.0, 0.05, 0.01, 0.0, 0.05, 0.0, 0.1, 0.0, 0.0, 0.0, 0.0, 900.0, 20.0]);
    let controls = Controls { throttle: 0.2, elevator: -0.03, aileron: 0.0, rudder: 0.0 };
    let [a, b] = [&one, &other].map(|aircraft| motion(aircraft, &state, &controls, &Disturbance::default()).rates);
    assert_eq!(a.to_array(), b.to_array());
    assert!(one.notes().iter().any(|note| note.contains("vrsPositionOfCM stays at 35 pct")), "{:?}", one.notes());
    assert_eq!(one.centre_of_gravity(), None);
    let range = one.data_range();
    assert!((range.alpha[0].to_degrees() + 10.0).abs() < 1e-9 && (range.alpha[1].to_degrees() - 45.0).abs() < 1e-9);
    assert!((one.actuators().elevator.limit.to_degrees() - 24.0).abs() < 1e-9);
}

#[test]
fn what_a_flight_lacks_is_named_with_how_to_give_it() {
    let Some([aero, inertia, _]) = f16_files() else { return };
    let refused = |options: FlownOptions| AircraftFile::open_with(&aero, &options).unwrap_err();
    let error = refused(FlownOptions::default());
    let text = error.to_string();
    assert!(matches!(error, FlownError::Lacking { .. }));
    assert!(text.contains("totalMass (kg), bodyMomentOfInertia_Roll (kg m2)") && text.contains("--with"), "{text}");
    assert!(text.contains("F16_aero.dml") && text.contains("--property totalMass=9300"), "{text}");
    // The same numbers by hand, in SI, fly; without an engine half the weight pushes, or what is asked for.
    let numbers = [
        ("totalMass", 9298.6),
        ("bodyMomentOfInertia_Roll", 12875.0),
        ("bodyMomentOfInertia_Pitch", 75674.0),
        ("bodyMomentOfInertia_Yaw", 85552.0),
        ("bodyPositionOfCmWrtMrc_X", 0.05 * 11.32 * 0.3048),
    ];
    let properties: Vec<(String, f64)> = numbers.iter().map(|(name, value)| ((*name).to_owned(), *value)).collect();
    let options = FlownOptions { properties: properties.clone(), ..FlownOptions::default() };
    let aircraft = AircraftFile::open_with(&aero, &options).unwrap();
    assert!(aircraft.notes().iter().any(|note| note.contains("half the weight")), "{:?}", aircraft.notes());
    assert!(trim(&aircraft, &TrimCondition::steady(&aircraft, 153.0, 0.0, 0.0, 0.0)).is_ok());
    let pushed = FlownOptions { thrust: Thrust::AlongBodyX { largest_n: 60_000.0 }, ..options };
    let pushed = AircraftFile::open_with(&aero, &pushed).unwrap();
    assert_eq!(pushed.propulsion(50.0, 0.0, 0.3).force, [30_000.0, 0.0, 0.0]);
    // A name that no file has, a mass that cannot be, an aircraft of another kind.
    let misspelt = refused(FlownOptions { properties: vec![("totalMas".to_owned(), 1.0)], ..FlownOptions::default() });
    assert!(matches!(&misspelt, FlownError::Property { name, .. } if name == "totalMas"));
    let mut negative = properties;
    negative[0].1 = -1.0;
    let text = refused(FlownOptions { properties: negative, ..FlownOptions::default() }).to_string();
    assert!(text.contains("totalMass is -1 kg"), "{text}");
    let folder = aero.parent().unwrap();
    let text = AircraftFile::open(folder).unwrap_err().to_string();
    assert!(text.contains("the folder has models in DAVE-ML") && text.contains("--with"), "{text}");
    let error = AircraftFile::open(&inertia).unwrap_err().to_string();
    assert!(error.contains("aeroBodyForceCoefficient_X"), "{error}");
}

#[test]
fn an_input_that_nothing_gives_and_a_circle_are_refused_by_name() {
    let open = write(
        "open",
        r#"<DAVEfunc><variableDef name="flapSetting" varID="flap" units="deg"><isInput/></variableDef></DAVEfunc>"#,
    );
    let text = AircraftFile::open(&open).unwrap_err().to_string();
    assert!(text.contains("what flapSetting is") && text.contains("--property flapSetting=VALUE"), "{text}");
    let model = |own: &str, other: &str| {
        format!(
            r#"<DAVEfunc><fileHeader name="{own}"/><variableDef name="{other}" varID="x" units="nd"><isInput/></variableDef>
            <variableDef name="{own}" varID="y" units="nd"><calculation><math><apply><plus/><ci>x</ci><cn>1</cn></apply></math>
            </calculation><isOutput/></variableDef></DAVEfunc>"#
        )
    };
    let (one, other) = (write("one", &model("first", "second")), write("other", &model("second", "first")));
    let options = FlownOptions { with: vec![other], ..FlownOptions::default() };
    let error = AircraftFile::open_with(&one, &options).unwrap_err();
    assert!(matches!(error, FlownError::Circle { .. }), "{error}");
}

/// A model in lift and drag, radians and metres, whose elevator is positive with its trailing edge up and whose pitching moment
/// follows the rate of the angle of attack.
fn small() -> AircraftFile {
    let file = write(
        "small",
        r#"<DAVEfunc>
  <variableDef name="angleOfAttack" varID="a" units="rad"><isInput/></variableDef>
  <variableDef name="angleOfAttackRate" varID="adot" units="rad_s"><isInput/></variableDef>
  <variableDef name="trueAirspeed" varID="V" units="m_s"><isInput/></variableDef>
  <variableDef name="altitudeMsl" varID="h" units="km"><isInput/></variableDef>
  <variableDef name="elevatorDeflection" varID="de" units="deg" sign="TEU" minValue="-20" maxValue="25"><isInput/></variableDef>
  <variableDef name="referenceWingArea" varID="S" units="m2" initialValue="16"/>
  <variableDef name="referenceWingSpan" varID="b" units="m" initialValue="11"/>
  <variableDef name="referenceWingChord" varID="c" units="m" initialValue="1.5"/>
  <variableDef name="totalCoefficientOfLift" varID="CL" units="nd"><calculation><math><apply><plus/><cn>0.3</cn>
    <apply><times/><cn>5</cn><ci>a</ci></apply></apply></math></calculation><isOutput/></variableDef>
  <variableDef name="totalCoefficientOfDrag" varID="CD" units="nd"><calculation><math><apply><plus/><cn>0.03</cn>
    <apply><times/><cn>0.001</cn><ci>h</ci></apply></apply></math></calculation><isOutput/></variableDef>
  <variableDef name="aeroBodyMomentCoefficient_Pitch" varID="Cm" units="nd"><calculation><math><apply><plus/>
    <apply><times/><cn>-1</cn><ci>a</ci></apply><apply><times/><cn>0.01</cn><ci>de</ci></apply>
    <apply><divide/><apply><times/><cn>-4</cn><ci>adot</ci></apply><ci>V</ci></apply></apply></math></calculation>
    <isOutput/></variableDef>
</DAVEfunc>"#,
    );
    let numbers = [
        ("totalMass", 1000.0),
        ("bodyMomentOfInertia_Roll", 1200.0),
        ("bodyMomentOfInertia_Pitch", 1800.0),
        ("bodyMomentOfInertia_Yaw", 2600.0),
    ];
    let properties = numbers.map(|(name, value)| (name.to_owned(), value)).to_vec();
    AircraftFile::open_with(file, &FlownOptions { properties, ..FlownOptions::default() }).unwrap()
}

#[test]
fn lift_drag_height_signs_and_the_rate_of_the_angle_of_attack_are_read() {
    let aircraft = small();
    let density = aircraft.atmosphere().at(3000.0_f64).density;
    let air = AirData {
        speed: 50.0,
        alpha: 0.1,
        beta: 0.0,
        density,
        dynamic_pressure: 1250.0 * density,
        mach: 50.0 / aircraft.atmosphere().at(3000.0_f64).speed_of_sound,
    };
    let controls = Controls { throttle: 0.0, elevator: 0.02, aileron: 0.0, rudder: 0.0 };
    let c = aircraft.coefficients(&air, [0.0; 3], &controls);
    let (lift, drag) = (0.8, 0.033);
    let (s, cosine) = 0.1_f64.sin_cos();
    assert!((c.cx - (lift * s - drag * cosine)).abs() < 1e-9, "{}", c.cx);
    assert!((c.cz + lift * cosine + drag * s).abs() < 1e-9, "{}", c.cz);
    // 0.02 rad downwards are -1.146 deg of a positive upwards.
    assert!((c.cm - (-0.1 - 0.01 * 0.02_f64.to_degrees())).abs() < 1e-12, "{}", c.cm);
    assert_eq!((c.cy, c.cl, c.cn), (0.0, 0.0, 0.0));
    let slope = aircraft.alpha_rate_coefficients(&air, [0.0; 3], &controls).unwrap();
    assert!((slope.cm + 0.08).abs() < 1e-12 && slope.cz == 0.0, "{slope:?}");
    // The larger of the two ends, which upwards is down.
    assert!((aircraft.actuators().elevator.limit.to_degrees() - 25.0).abs() < 1e-9);
    for words in ["no side force", "know no rudder", "half the weight"] {
        assert!(aircraft.notes().iter().any(|note| note.contains(words)), "{words}: {:?}", aircraft.notes());
    }
}

#[test]
fn a_scenario_flies_an_aircraft_in_daveml() {
    let Some([aero, inertia, engine]) = f16_files() else { return };
    let text = format!(
        r#"
name = "F-16 in DAVE-ML"
duration = "10 s"
sample_rate = "50 Hz"
[aircraft]
file = {aero:?}
with = [{inertia:?}, {engine:?}]
properties = {{ vrsPositionOfCM = 30.0 }}
[condition]
altitude = "6096 m"
speed = "205.74 m/s"
[[manoeuvre]]
type = "doublet"
surface = "elevator"
start = "1 s"
amplitude = "2 deg"
width = "1 s"
"#
    );
    let scenario: Scenario = Scenario::parse(&text, "f16.toml").unwrap();
    let flight = fly(&scenario).unwrap();
    let q = &flight.truth.channel("q").unwrap().values;
    let largest = q.iter().fold(0.0_f64, |most, q| most.max(q.abs()));
    assert!(largest.to_degrees() > 1.0 && largest.to_degrees() < 30.0, "{}", largest.to_degrees());
}
