//! What an instance flies is what a scenario flies, and the rules of FMI about when what may be called.

use phugoid_flight_dynamics::aircraft::Controls;
use phugoid_flight_dynamics::increments::Increments;
use phugoid_fmu::{Instance, InstanceError, Interface, Resources, variables};
use phugoid_simulation::course::Course;
use phugoid_simulation::flight::trimmed_aircraft;
use phugoid_simulation::scenario::{Scenario, Thrust};

use crate::{Folder, description};

fn reference(name: &str) -> u32 {
    variables().iter().find(|variable| variable.name == name).unwrap_or_else(|| panic!("no `{name}`")).reference
}

/// The flight of the tests: the F-16 in still air with its engine, surfaces where they are put, and one increment.
fn scenario() -> Scenario {
    let mut scenario = Scenario::named("f16-calm").unwrap();
    (scenario.aircraft.thrust, scenario.aircraft.actuators) = (Thrust::Engine, false);
    scenario.increments = Increments { dCm_alpha: -0.1, ..Increments::NONE };
    scenario.gust.clear();
    scenario.turbulence = None;
    scenario
}

fn instance(interface: Interface) -> Instance {
    let scenario = scenario();
    let (_, trim) = trimmed_aircraft(&scenario).unwrap();
    let folder = Folder::with(&description(&trim, scenario.aircraft.cg.unwrap_or(0.35)));
    let resources = Resources::open(folder.path()).unwrap();
    assert_eq!(resources.token, "{token}");
    Instance::new(resources, interface)
}

/// Commands of the flight at a sample.
fn commands(trim: Controls, k: usize) -> Controls {
    let swing = 0.02 * (0.05 * k as f64).sin();
    Controls { elevator: trim.elevator + swing, aileron: 0.5 * swing, rudder: -0.3 * swing, throttle: 0.3 }
}

#[test]
fn co_simulation_is_the_flight_of_a_scenario_bit_by_bit() {
    let scenario = scenario();
    let (aircraft, trim) = trimmed_aircraft(&scenario).unwrap();
    let mut course = Course::new(&scenario, aircraft.as_ref(), None, &trim).unwrap();
    let mut fmu = instance(Interface::CoSimulation);
    fmu.set(reference("dCm_alpha"), -0.1).unwrap();
    fmu.enter_initialization(0.0).unwrap();
    fmu.exit_initialization().unwrap();
    let time = |k: usize| k as f64 * 0.01;
    for k in 0..300 {
        let now = commands(trim.controls(), k);
        for (name, value) in
            [("throttle", now.throttle), ("elevator", now.elevator), ("aileron", now.aileron), ("rudder", now.rudder)]
        {
            fmu.set(reference(name), value).unwrap();
        }
        let truth = course.sample(now);
        for (name, value) in
            [("true_airspeed", truth.air.speed), ("az", truth.specific_force[2]), ("thrust", truth.thrust())]
        {
            assert_eq!(fmu.get(reference(name)).unwrap(), value, "{name} at {k}");
        }
        course.advance(now).unwrap();
        fmu.do_step(time(k), 0.01).unwrap();
        assert_eq!(fmu.states(), course.state().to_array(), "after {k}");
    }
    assert!((fmu.point().state.alpha - trim.alpha_rad).abs() > 1e-3, "nothing has moved");
}

#[test]
fn model_exchange_gives_the_rates_of_the_same_flight() {
    let mut fmu = instance(Interface::ModelExchange);
    fmu.enter_initialization(0.0).unwrap();
    fmu.exit_initialization().unwrap();
    fmu.update_discrete_states().unwrap();
    fmu.enter_continuous_time_mode().unwrap();
    // In trim nothing moves but the aircraft over the ground.
    let rates = fmu.derivatives().unwrap();
    assert!(rates[..9].iter().all(|rate| rate.abs() < 1e-8), "{rates:?}");
    assert!((rates[9] - fmu.states()[0]).abs() < 1e-6);
    let mut states = fmu.states();
    states[1] += 0.01;
    fmu.set_states(&states).unwrap();
    let rates = fmu.derivatives().unwrap();
    assert_eq!(fmu.get(reference("der(state.q)")).unwrap(), rates[7]);
    assert_eq!(fmu.get(reference("qdot")).unwrap(), rates[7]);
    assert!(rates[7] != 0.0);
    // A tail wind takes speed from the air data, not from the state.
    fmu.set(reference("gust.x"), 5.0).unwrap();
    let (air, state) = (fmu.get(reference("true_airspeed")).unwrap(), fmu.get(reference("state.speed")).unwrap());
    assert!((state - air - 5.0).abs() < 0.01, "{state} {air}");
    fmu.terminate().unwrap();
    assert!(fmu.get(reference("alpha")).is_ok());
}

#[test]
fn what_makes_no_sense_is_refused_and_changes_nothing() {
    let mut fmu = instance(Interface::CoSimulation);
    let before = *fmu.point();
    for (name, value) in [
        ("elevator", f64::NAN),
        ("gust.z", f64::INFINITY),
        ("throttle", 1.0001),
        ("throttle", -0.1),
        ("integration_step", 0.0),
        ("state.speed", 0.0),
        ("alpha", 0.1),
        ("der(state.q)", 0.1),
        ("time", 1.0),
        ("dCm_alpha", f64::NAN),
    ] {
        let message = fmu.set(reference(name), value).unwrap_err().to_string();
        assert!(message.contains(&format!("`{name}`")), "{message}");
    }
    assert_eq!(fmu.set(9_999, 0.0), Err(InstanceError::Unknown(9_999)));
    assert!(fmu.enter_initialization(f64::NAN).is_err());
    assert_eq!(*fmu.point(), before);
    assert!(matches!(fmu.do_step(0.0, 0.01), Err(InstanceError::Mode { .. })));
    assert!(matches!(fmu.set_states(&[0.0; 13]), Err(InstanceError::Mode { .. })));
    fmu.enter_initialization(0.0).unwrap();
    fmu.exit_initialization().unwrap();
    assert!(matches!(fmu.set(reference("integration_step"), 0.001), Err(InstanceError::NotSettable { .. })));
    for size in [f64::NAN, 0.0, -0.01, f64::INFINITY] {
        assert!(fmu.do_step(0.0, size).is_err(), "{size}");
    }
    assert!(matches!(fmu.do_step(0.0, 1e7), Err(InstanceError::TooLong { .. })));
    assert!(matches!(fmu.do_step(1.0, 0.01), Err(InstanceError::Point { .. })));
    assert_eq!(*fmu.point(), before);
}

#[test]
fn a_flight_that_leaves_the_data_is_warned_of_once_and_one_that_diverges_is_an_error() {
    let mut fmu = instance(Interface::CoSimulation);
    fmu.enter_initialization(0.0).unwrap();
    fmu.exit_initialization().unwrap();
    assert!(fmu.warnings().is_empty());
    fmu.set(reference("elevator"), -1.0).unwrap();
    let warnings = fmu.warnings();
    assert!(warnings.len() == 1 && warnings[0].contains("`elevator` is -57.296 deg"), "{warnings:?}");
    assert!(fmu.warnings().is_empty());
    fmu.set(reference("elevator"), -1e6).unwrap();
    let mut steps = (0..10_000).map(|k| fmu.do_step(k as f64 * 0.01, 0.01));
    let error = steps.find_map(Result::err).expect("it has not diverged").to_string();
    assert!(error.contains("no longer finite"), "{error}");
}

#[test]
fn a_state_that_was_written_down_leads_to_the_same_flight() {
    let mut fmu = instance(Interface::CoSimulation);
    fmu.enter_initialization(0.0).unwrap();
    fmu.exit_initialization().unwrap();
    fmu.set(reference("elevator"), -0.05).unwrap();
    fmu.do_step(0.0, 0.1).unwrap();
    let written = fmu.written();
    assert_eq!(written.len(), Instance::WRITTEN);
    fmu.do_step(0.1, 0.1).unwrap();
    let after = *fmu.point();
    fmu.restore(&written).unwrap();
    fmu.do_step(0.1, 0.1).unwrap();
    assert_eq!(*fmu.point(), after);
    // Another instance, before its start, takes its mode from it too.
    let mut other = instance(Interface::CoSimulation);
    other.restore(&written).unwrap();
    other.do_step(0.1, 0.1).unwrap();
    assert_eq!(*other.point(), after);
    fmu.reset();
    assert!(fmu.do_step(0.0, 0.1).is_err());
    assert!(fmu.restore(&written[1..]).is_err() && Instance::check_written(&[]).is_err());
}
