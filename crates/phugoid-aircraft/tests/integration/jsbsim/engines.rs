//! Steady thrust of turboprops and piston engines, against JSBSim 1.3.3: its Python package ran each aircraft at a frozen state in
//! axial flow, without integration of the motion and with its fuel frozen, until the thrust no longer changed.

use phugoid_aircraft::flown::FlownJsbsim;
use phugoid_aircraft::jsbsim::{Aircraft, Evaluator, FlightCondition};
use phugoid_flight_dynamics::atmosphere::Atmosphere;
use phugoid_flight_dynamics::standard_atmosphere::geopotential_altitude;

use super::package;

const FOOT: f64 = 0.3048;
const KNOT: f64 = 1852.0 / 3600.0;
const POUND: f64 = 4.448_221_615_260_5;

/// Thrust of the first engine, pounds, with all engines at these levers.
fn thrust_lb(aircraft: &Aircraft, height_ft: f64, speed_kt: f64, throttle: f64, mixture: Option<f64>) -> f64 {
    let mut evaluator = Evaluator::new(aircraft);
    for engine in 0..aircraft.engines().len() {
        assert!(evaluator.set(&format!("fcs/throttle-pos-norm[{engine}]"), throttle));
        assert!(evaluator.set(&format!("fcs/advance-pos-norm[{engine}]"), 1.0));
        if let Some(mixture) = mixture {
            assert!(evaluator.set(&format!("fcs/mixture-pos-norm[{engine}]"), mixture));
        }
    }
    let height = height_ft * FOOT;
    let air = Atmosphere::Standard.at(geopotential_altitude(height));
    evaluator.set_flight(&FlightCondition::axial(speed_kt * KNOT, height, &air));
    let force = evaluator.propulsive_force_moment();
    assert!(force.force_n[0].is_finite());
    evaluator.get("propulsion/engine/thrust-lbs").unwrap()
}

#[test]
fn turboprops_push_as_in_jsbsim() {
    let Some(package) = package() else { return };
    for (name, speed_kt, known) in [
        ("DHC6", 130.0, [(0.05, 9.622_46), (0.341, 182.864), (0.526, 290.144), (0.9, 889.296), (1.0, 891.566)]),
        ("pc7", 150.0, [(0.05, -24.0928), (0.341, 134.634), (0.526, 232.483), (0.9, 633.741), (1.0, 840.646)]),
    ] {
        let aircraft = Aircraft::open(package.join("aircraft").join(name)).unwrap();
        for (throttle, expected) in known {
            let found = thrust_lb(&aircraft, 3000.0, speed_kt, throttle, None);
            println!("{name} {throttle}: {found:.3} lb, JSBSim {expected} lb");
            assert!((found - expected).abs() < 0.003 * 890.0, "{name} {throttle}: {found} {expected}");
        }
        let notes: Vec<_> = aircraft.omitted().iter().map(ToString::to_string).collect();
        assert!(
            notes.iter().any(|note| note.contains("the speed of the gas generator that the throttle sets")),
            "{notes:?}"
        );
        assert!(!notes.iter().any(|note| note.contains("rich")), "{notes:?}");
    }
}

#[test]
fn piston_engines_follow_their_mixture_as_in_jsbsim() {
    let Some(package) = package() else { return };
    for (name, height_ft, speed_kt, throttle, share, known) in [
        ("c182", 3000.0, 120.0, 0.7287, 0.002, [(1.0, 279.783), (0.85, 237.776), (0.7, 145.432)]),
        ("J3Cub", 3000.0, 65.0, 0.7, 0.002, [(1.0, 94.315), (0.85, 81.190), (0.7, 54.615)]),
        // Its supercharger is another matter: it gives less pressure here than in JSBSim.
        ("Boeing314", 3000.0, 130.0, 0.7, 0.05, [(1.0, 1846.989), (0.85, 1449.706), (0.7, 617.512)]),
    ] {
        let aircraft = Aircraft::open(package.join("aircraft").join(name)).unwrap();
        let full = known[0].1;
        for (mixture, expected) in known {
            let found = thrust_lb(&aircraft, height_ft, speed_kt, throttle, Some(mixture));
            println!("{name} {mixture}: {found:.3} lb, JSBSim {expected} lb");
            assert!((found - expected).abs() < share * full, "{name} {mixture}: {found} {expected}");
        }
        // The lever is at full rich unless it is set.
        let found = thrust_lb(&aircraft, height_ft, speed_kt, throttle, None);
        assert!((found - full).abs() < share * full, "{name}: {found} {full}");
    }
}

#[test]
fn a_propeller_that_is_taken_in_axial_flow_is_named() {
    let Some(package) = package() else { return };
    let aircraft = FlownJsbsim::open(package.join("aircraft/c182")).unwrap();
    let notes = aircraft.notes();
    assert!(notes.iter().any(|note| note.contains("engine 0") && note.contains("p_factor is left out")), "{notes:?}");
    assert!(notes.iter().any(|note| note.contains("fcs/mixture-pos-norm stays at 1.")), "{notes:?}");
    let newtons = thrust_lb(aircraft.aircraft(), 3000.0, 120.0, 0.7287, None) * POUND;
    assert!((newtons - 1244.5).abs() < 15.0, "{newtons}");
}
