//! The Generic Transport Model: its tables against values that were computed elsewhere, symmetry, trims and linear models.

use std::path::PathBuf;

use phugoid_aircraft::transport::{Damage, RateModel, Transport, TransportError, TransportOptions};
use phugoid_flight_dynamics::aircraft::{AirData, Aircraft, Coefficients, Controls};
use phugoid_flight_dynamics::linearize::linearize;
use phugoid_flight_dynamics::modes::ModeName;
use phugoid_flight_dynamics::motion::{Disturbance, motion};
use phugoid_flight_dynamics::scalar::{Dual, Scalar};
use phugoid_flight_dynamics::trim::{Trim, TrimCondition, TrimError, trim};
use serde_json::Value;

use crate::jsbsim::text_of;
use crate::shared_data::shared_file;

/// True airspeed, m/s, and altitude, m, of the trims: 78 knots, a load factor of 1 at some 5 deg.
pub(crate) const SPEED: f64 = 40.0;
pub(crate) const ALTITUDE: f64 = 300.0;

/// The folder of the data.
pub(crate) fn folder() -> Option<PathBuf> {
    Some(shared_file("gtm/vehicle.json")?.parent()?.to_owned())
}

pub(crate) fn whole() -> Option<Transport> {
    Some(Transport::open(folder()?).unwrap())
}

pub(crate) fn level(aircraft: &Transport) -> Result<Trim, TrimError> {
    trim(aircraft, &TrimCondition::steady(aircraft, SPEED, ALTITUDE, 0.0, 0.0))
}

fn array<T: Copy>(c: &Coefficients<T>) -> [T; 6] {
    [c.cx, c.cy, c.cz, c.cl, c.cm, c.cn]
}

fn check_values() -> Option<Value> {
    Some(serde_json::from_str(&text_of(&shared_file("gtm/check_static.json")?)).unwrap())
}

/// Linear interpolation over the first two axes of a table at the indices `rest` of the others: an evaluation of its own.
fn interpolated(table: &Value, x: [f64; 2], rest: &[usize]) -> f64 {
    let shape: Vec<usize> = table["shape"].as_array().unwrap().iter().map(|n| n.as_u64().unwrap() as usize).collect();
    let place = |axis: usize| {
        let values: Vec<f64> =
            table["axes"][axis]["values"].as_array().unwrap().iter().map(|v| v.as_f64().unwrap()).collect();
        let cell = (1..values.len() - 1).rev().find(|i| values[*i] <= x[axis]).unwrap_or(0);
        (cell, (x[axis] - values[cell]) / (values[cell + 1] - values[cell]))
    };
    let ((i, u), (j, v)) = (place(0), place(1));
    let entry = |i: usize, j: usize| {
        let index = [i, j].iter().chain(rest).zip(&shape).fold(0, |index, (i, length)| index * length + i);
        table["data"][index].as_f64().unwrap()
    };
    (1.0 - u) * ((1.0 - v) * entry(i, j) + v * entry(i, j + 1))
        + u * ((1.0 - v) * entry(i + 1, j) + v * entry(i + 1, j + 1))
}

/// The values are written to nine digits and were computed before the tables were rounded to eight, which makes up to 4.4e-8;
/// the interpolation of this test, of the tables as they are, is met to rounding.
#[test]
fn every_check_value_is_met() {
    let (Some(whole), Some(values)) = (whole(), check_values()) else { return };
    let table = |name: &str| -> Value {
        serde_json::from_str(&text_of(&shared_file(&format!("gtm/tables/{name}.json")).unwrap())).unwrap()
    };
    let (basic, increment) = (table("basic"), table("damage_static_increment"));
    let fleet = Damage::ALL.map(|damage| whole.damaged(damage).unwrap());
    let points = values["points"].as_array().unwrap();
    assert!(points.len() >= 42);
    let (mut worst, mut worst_of_tables) = (0.0_f64, 0.0_f64);
    for point in points {
        let number = |key: &str| point[key].as_f64().unwrap();
        let case = point["damage_case"].as_u64().unwrap() as usize;
        let degrees = [number("alpha_deg"), number("beta_deg")];
        let [alpha, beta] = degrees.map(f64::to_radians);
        let found = fleet[case].static_coefficients_about_reference(alpha, beta, &Controls::default());
        for (k, (found, key)) in array(&found).into_iter().zip(["CX", "CY", "CZ", "Cl", "Cm", "Cn"]).enumerate() {
            worst = worst.max((found - number(key)).abs());
            assert!((found - number(key)).abs() < 6e-8, "{point} {key}: {found}");
            let damage = if case == 0 { 0.0 } else { interpolated(&increment, degrees, &[case - 1, k]) };
            let plain = interpolated(&basic, degrees, &[k]) + damage;
            worst_of_tables = worst_of_tables.max((found - plain).abs());
            assert!((found - plain).abs() < 1e-13, "{point} {key}: {found} {plain}");
        }
    }
    println!("{} points: {worst:.1e} from the values, {worst_of_tables:.1e} from the tables", points.len());
}

#[test]
fn slopes_are_those_of_the_list() {
    let (Some(whole), Some(values)) = (whole(), check_values()) else { return };
    let rows = values["slopes_per_rad"]["rows"].as_array().unwrap();
    assert_eq!(rows.len(), 28);
    for row in rows {
        let number = |key: &str| row[key].as_f64().unwrap();
        let case = row["damage_case"].as_u64().unwrap() as usize;
        let aircraft = whole.damaged(Damage::ALL[case]).unwrap();
        let at = |alpha: f64, beta: f64| {
            let (alpha, beta) = ((number("alpha_deg") + alpha).to_radians(), beta.to_radians());
            array(&aircraft.static_coefficients_about_reference(alpha, beta, &Controls::default()))
        };
        let [by_alpha, by_beta] = [(1.0, 0.0), (0.0, 4.0)].map(|(alpha, beta): (f64, f64)| {
            let (above, below) = (at(alpha, beta), at(-alpha, -beta));
            let step = 2.0 * alpha.max(beta).to_radians();
            [0, 1, 2, 3, 4, 5].map(|i| (above[i] - below[i]) / step)
        });
        let still = at(0.0, 0.0);
        for (found, key) in [
            (by_alpha[2], "CZ_alpha"),
            (by_alpha[4], "Cm_alpha"),
            (by_alpha[3], "Cl_alpha"),
            (by_beta[1], "CY_beta"),
            (by_beta[3], "Cl_beta"),
            (by_beta[5], "Cn_beta"),
            (still[3], "Cl_0"),
            (still[4], "Cm_0"),
            (still[5], "Cn_0"),
        ] {
            // Six decimals are written, of tables that were not yet rounded to eight digits.
            assert!((found - number(key)).abs() < 2e-6, "{row} {key}: {found}");
        }
    }
}

/// In mirrored flow the undamaged aircraft has mirrored forces, as far as the tables have: those of the basic aircraft are
/// symmetric in CY, Cl, Cn exactly, in CX, CZ, Cm to the digits of the fit, and forced oscillation is not symmetric itself.
#[test]
fn mirrored_flow_gives_mirrored_forces() {
    let Some(whole) = whole() else { return };
    let mut worst = [0.0_f64; 6];
    for alpha in [-2.0_f64, 1.0, 4.5, 9.0, 15.0, 25.0] {
        for beta in [-12.0_f64, -3.0, 0.0, 5.5] {
            for (aileron, rudder) in [(0.0, 0.0), (0.1, -0.2), (-0.3, 0.05)] {
                let side = |sign: f64| {
                    let controls =
                        Controls { throttle: 0.0, elevator: -0.1, aileron: sign * aileron, rudder: sign * rudder };
                    let beta = sign * beta.to_radians();
                    array(&whole.static_coefficients_about_reference(alpha.to_radians(), beta, &controls))
                };
                let (right, left) = (side(1.0), side(-1.0));
                for (i, sign) in [1.0, -1.0, 1.0, -1.0, 1.0, -1.0].into_iter().enumerate() {
                    worst[i] = worst[i].max((right[i] - sign * left[i]).abs());
                }
            }
        }
    }
    println!("{worst:?}");
    // The elevator is not symmetric in sideslip in the data: CX, CZ, Cm.
    for (i, most) in [0.005, 1e-12, 0.05, 1e-12, 0.1, 1e-12].into_iter().enumerate() {
        assert!(worst[i] < most, "{i}: {worst:?}");
    }
}

#[test]
fn signs_of_controls_are_those_of_the_equations() {
    let Some(whole) = whole() else { return };
    let at = |controls: Controls| array(&whole.static_coefficients_about_reference(0.07, 0.0, &controls));
    let still = at(Controls::default());
    let moved = |controls: Controls| {
        let there = at(controls);
        [0, 1, 2, 3, 4, 5].map(|i| there[i] - still[i])
    };
    assert!(moved(Controls { elevator: 0.1, ..Controls::default() })[4] < -0.1, "trailing edge down: nose down");
    assert!(moved(Controls { aileron: 0.1, ..Controls::default() })[3] < -0.005, "rolls to the left");
    let rudder = moved(Controls { rudder: 0.1, ..Controls::default() });
    assert!(rudder[5] < -0.01 && rudder[1] > 0.01, "trailing edge to the left: pushed right, yaws left");
    let set = |options: &TransportOptions| {
        let there = whole.with(options).unwrap();
        let there = array(&there.static_coefficients_about_reference(0.07, 0.0, &Controls::default()));
        [0, 1, 2, 3, 4, 5].map(|i| there[i] - still[i])
    };
    let standard = TransportOptions::default();
    assert!(set(&TransportOptions { stabiliser: -0.1, ..standard })[4] > 0.1, "leading edge down: nose up");
    assert!(set(&TransportOptions { flaps: 0.5, ..standard })[2] < -0.2, "flaps lift");
    assert!(set(&TransportOptions { gear_down: true, ..standard })[0] < -0.01, "the gear drags");
    let right = set(&TransportOptions { spoilers: [0.0, 0.5], ..standard });
    let left = set(&TransportOptions { spoilers: [0.5, 0.0], ..standard });
    assert!(right[2] > 0.05 && right[3] > 0.01 && left[3] < -0.01, "a spoiler lowers its wing");
}

/// Surfaces that are gone have no effect, and half an elevator half of it.
#[test]
fn missing_surfaces_do_nothing() {
    let Some(whole) = whole() else { return };
    let effect = |damage: Damage, controls: Controls| {
        let aircraft = whole.damaged(damage).unwrap();
        let at = |controls: &Controls| array(&aircraft.static_coefficients_about_reference(0.06, 0.03, controls));
        let (there, still) = (at(&controls), at(&Controls::default()));
        [0, 1, 2, 3, 4, 5].map(|i| there[i] - still[i])
    };
    let elevator = Controls { elevator: -0.15, ..Controls::default() };
    let aileron = Controls { aileron: 0.2, ..Controls::default() };
    let rudder = Controls { rudder: 0.2, ..Controls::default() };
    for damage in [Damage::RudderOff, Damage::VerticalTailOff] {
        assert_eq!(effect(damage, rudder), [0.0; 6]);
    }
    let of_all = effect(Damage::None, elevator);
    for damage in [Damage::LeftElevatorOff, Damage::LeftStabiliserOff] {
        let half = effect(damage, elevator);
        // What is left is to the right: its upwards deflection pushes the right side down.
        let mut expected = of_all.map(|value| 0.5 * value);
        expected[3] = 0.05 * expected[2];
        expected[5] = -0.05 * expected[0];
        assert!((0..6).all(|i| (half[i] - expected[i]).abs() < 1e-12), "{half:?} {of_all:?}");
        assert!(half[3] > 0.001, "{half:?}");
    }
    let (both, right) = (effect(Damage::None, aileron), effect(Damage::LeftWingTipOff, aileron));
    assert!(right[3] < 0.0 && right[3] > both[3], "{right:?} {both:?}");
    let flaps = |damage: Damage| {
        let options = TransportOptions { damage, flaps: 0.3, ..TransportOptions::default() };
        let (with, without) = (whole.with(&options).unwrap(), whole.damaged(damage).unwrap());
        let at = |aircraft: &Transport| aircraft.static_coefficients_about_reference(0.06, 0.03, &Controls::default());
        at(&with).cl - at(&without).cl
    };
    assert!(
        flaps(Damage::None).abs() < 1e-12 && flaps(Damage::LeftOutboardFlapOff) < -0.005,
        "rolls to the side that lost it"
    );
}

#[test]
fn moments_are_about_the_centre_of_gravity() {
    let Some(whole) = whole() else { return };
    let aircraft = whole.damaged(Damage::LeftWingTipOff).unwrap();
    let geometry = *aircraft.geometry();
    let air = AirData { speed: 40.0, alpha: 0.08, beta: 0.03, density: 1.2, dynamic_pressure: 960.0, mach: 0.12 };
    let controls = Controls { throttle: 0.5, elevator: -0.02, aileron: 0.1, rudder: 0.05 };
    let still = [0.0; 3];
    let about_cg = aircraft.coefficients(&air, still, &controls);
    let about_reference = aircraft.coefficients_about_reference(air.alpha, air.beta, still, &controls);
    // The reference point is at 25 % of the chord, on the centre line, 0.9401 ft above the datum.
    let [x, y, z] = aircraft.centre_of_gravity();
    let arm = [-(4.5462 + 0.25 * 0.9153) * 0.3048 - x, -y, -0.9401 * 0.3048 - z];
    let force = [about_cg.cx, about_cg.cy, about_cg.cz];
    let moment = [
        arm[1] * force[2] - arm[2] * force[1],
        arm[2] * force[0] - arm[0] * force[2],
        arm[0] * force[1] - arm[1] * force[0],
    ];
    assert!((about_cg.cl - about_reference.cl - moment[0] / geometry.span).abs() < 1e-12);
    assert!((about_cg.cm - about_reference.cm - moment[1] / geometry.mean_chord).abs() < 1e-12);
    assert!((about_cg.cn - about_reference.cn - moment[2] / geometry.span).abs() < 1e-12);
    // The wing tip that is left moves the centre to the right by 0.628 in; lift to the left of it rolls to the right.
    assert!((y - (-0.0118 + 0.628 / 12.0) * 0.3048).abs() < 1e-6, "{y}");
    assert!(about_cg.cl > about_reference.cl);
    // Two engines at 2 deg push up and forward; they hang below the centre of gravity, the nose comes up.
    let push = aircraft.propulsion(100.0, 0.0, 0.0);
    assert!((push.force[0] - 2.0 * 15.315_244 * 4.448_222 * 0.9988).abs() < 0.2, "{push:?}");
    // At speed the air that is taken in drags, 0.01 of dynamic pressure and wing area for each engine.
    let (fast, air) = (aircraft.propulsion(100.0, 500.0, 0.2), aircraft.atmosphere().at(500.0));
    let static_thrust = aircraft.propulsion(100.0, 500.0, 0.0).force[0];
    let speed = 0.2 * air.speed_of_sound;
    let ram = 2.0 * 0.01 * 0.5 * air.density * speed * speed * geometry.wing_area;
    assert!(((static_thrust - fast.force[0]) / (0.9988 * ram) - 1.0).abs() < 1e-3, "{fast:?} {ram}");
    assert!((static_thrust / push.force[0] - air.pressure / 101_325.0).abs() < 1e-6);
    assert_eq!(aircraft.propulsion(0.0, 500.0, 0.2).force, [0.0; 3]);
    assert!(push.force[2] < 0.0 && push.moment[1] > 0.0, "{push:?}");
    // The centre of gravity is to the right of the middle between the engines: the sum of both yaws to the right.
    let undamaged = whole.propulsion(100.0, 0.0, 0.0);
    assert!(push.moment[2] > undamaged.moment[2] + 1.0, "{push:?} {undamaged:?}");
}

#[test]
fn the_undamaged_aircraft_and_all_six_damages_fly_straight() {
    let Some(whole) = whole() else { return };
    for damage in Damage::ALL {
        let aircraft = whole.damaged(damage).unwrap();
        let t = level(&aircraft).unwrap_or_else(|error| panic!("{damage}: {error}"));
        if matches!(damage, Damage::RudderOff | Damage::VerticalTailOff) {
            // Without a rudder the bank angle takes what is left of the side force.
            let rates = motion(&aircraft, &t.state(), &t.controls(), &Disturbance::default()).rates.to_array();
            assert!(rates[..9].iter().all(|rate| rate.abs() < 1e-9), "{damage}: {rates:?}");
            assert!(t.phi_rad != 0.0 && t.phi_rad.abs() < 0.01 && t.rudder_rad == 0.0, "{damage}: {t:?}");
        } else {
            assert!(t.phi_rad.abs() < 1e-9, "{damage}: {t:?}");
        }
        println!("{damage}: {t:?}");
        assert!((0.06..0.13).contains(&t.alpha_rad) && (0.1..0.5).contains(&t.throttle), "{damage}: {t:?}");
        assert!((t.load_factor - 1.0).abs() < 0.02 && t.largest_residual < 1e-11, "{damage}: {t:?}");
        assert!(t.beta_rad.abs() < 0.01, "{damage}: {t:?}");
        match damage {
            // The aileron that is left lifts the side that lost its tip or its flap.
            Damage::LeftWingTipOff | Damage::LeftOutboardFlapOff => assert!(t.aileron_rad < -0.15, "{t:?}"),
            // The centre of gravity is ahead, and half the tail is to push the nose up.
            Damage::LeftStabiliserOff => assert!(t.elevator_rad < -0.05, "{t:?}"),
            _ => assert!(t.aileron_rad.abs() < 0.03, "{t:?}"),
        }
    }
    // Too fast for the engines.
    let fast = trim(&whole, &TrimCondition::steady(&whole, 150.0, ALTITUDE, 0.0, 0.0));
    assert!(fast.is_err(), "{fast:?}");
}

#[test]
fn modes_are_those_of_a_transport_and_without_its_tail_it_diverges() {
    let Some(whole) = whole() else { return };
    let t = level(&whole).unwrap();
    let model = linearize(&whole, &t.state(), &t.controls(), &Disturbance::default());
    let longitudinal = model.longitudinal().unwrap();
    let names: Vec<_> = longitudinal.modes.iter().map(|mode| mode.name).collect();
    assert_eq!(names, [ModeName::ShortPeriod, ModeName::Phugoid]);
    assert!(longitudinal.modes.iter().all(|mode| mode.eigenvalue_real < 0.0));
    let lateral = model.lateral().unwrap();
    assert!(lateral.modes.iter().any(|mode| mode.name == ModeName::DutchRoll && mode.eigenvalue_real < 0.0));

    let tailless = whole.damaged(Damage::VerticalTailOff).unwrap();
    let flight = level(&tailless).unwrap();
    let lateral = linearize(&tailless, &flight.state(), &flight.controls(), &Disturbance::default()).lateral().unwrap();
    // The yaw acceleration by sideslip is that of a vane put on backwards.
    assert!(lateral.a[3][0] < 0.0, "{:?}", lateral.a);
    let diverging = lateral.modes.iter().find(|mode| mode.name == ModeName::YawDivergence).expect("a divergence");
    assert!(diverging.eigenvalue_real > 1.0, "{diverging:?}");
}

/// Exact derivatives are those of differences, away from points of the tables; undamaged with rotation, and damaged.
#[test]
fn derivatives_are_those_of_differences() {
    let Some(whole) = whole() else { return };
    let x = [40.0, 0.0771, 0.0323, 0.61, 0.13, 0.17, -0.0432, 0.0631, -0.0871];
    fn at<T: Scalar>(aircraft: &Transport, x: [T; 9]) -> [T; 6] {
        let [speed, alpha, beta, p, q, r, elevator, aileron, rudder] = x;
        let (density, dynamic_pressure, mach) = (T::from(1.2), speed * speed * 0.6, T::from(0.12));
        let air = AirData { speed, alpha, beta, density, dynamic_pressure, mach };
        array(&aircraft.coefficients(&air, [p, q, r], &Controls { throttle: T::from(0.5), elevator, aileron, rudder }))
    }
    let all = TransportOptions {
        damage: Damage::LeftStabiliserOff,
        all_rate_increments: true,
        ..TransportOptions::default()
    };
    for aircraft in [whole.clone(), whole.damaged(Damage::LeftWingTipOff).unwrap(), whole.with(&all).unwrap()] {
        let exact = at(&aircraft, std::array::from_fn(|i| Dual::<9>::variable(x[i], i)));
        for i in 0..9 {
            let step = 1e-6 * x[i].abs();
            let moved = |by: f64| at(&aircraft, std::array::from_fn(|k| if k == i { x[k] + by } else { x[k] }));
            let (above, below) = (moved(step), moved(-step));
            for k in 0..6 {
                let difference = (above[k] - below[k]) / (2.0 * step);
                let found = exact[k].derivatives[i];
                assert!((found - difference).abs() < 1e-6 * found.abs().max(1.0), "{i} {k}: {found} {difference}");
            }
        }
    }
}

/// The rates that are measured in both ways agree in sign and size, and damage changes the damping that it takes away.
#[test]
fn damping_is_what_the_data_say() {
    let Some(whole) = whole() else { return };
    let roll = |options: TransportOptions, p: f64, r: f64| {
        let aircraft = whole.with(&options).unwrap();
        let at = |rates: [f64; 3]| {
            aircraft.coefficients_about_reference(4.0_f64.to_radians(), 0.0, rates, &Controls::default())
        };
        (at([p, 0.0, r]).cl - at([0.0; 3]).cl) / p
    };
    let standard = TransportOptions::default();
    let oscillating = TransportOptions { rates: RateModel::ForcedOscillation, ..standard };
    // Values of the tables at 4 deg: -0.36373 by forced oscillation; 0.02163/0.05 by rotation about the velocity.
    assert!((roll(oscillating, 0.02, 0.0) + 0.36373).abs() < 1e-5);
    let (sin, cos) = 4.0_f64.to_radians().sin_cos();
    assert!((roll(standard, 0.05 * cos, 0.05 * sin) * cos + 0.02163 / 0.05).abs() < 1e-3);
    // Alone, roll is an oscillation in both.
    assert_eq!(roll(standard, 0.02, 0.0), roll(oscillating, 0.02, 0.0));
    let tip = TransportOptions { damage: Damage::LeftWingTipOff, ..standard };
    assert!((roll(tip, 0.02, 0.0) + 0.7323 * 0.36373).abs() < 1e-5);
}

#[test]
fn options_out_of_range_are_named() {
    let Some(whole) = whole() else { return };
    let standard = TransportOptions::default();
    for (options, name) in [
        (TransportOptions { stabiliser: 0.2, ..standard }, "stabiliser"),
        (TransportOptions { flaps: -0.1, ..standard }, "flaps"),
        (TransportOptions { spoilers: [0.0, 2.0], ..standard }, "spoilers[1]"),
        (TransportOptions { fuel: f64::NAN, ..standard }, "fuel"),
        (TransportOptions { engine_lag: 0.0, ..standard }, "engine_lag"),
        (TransportOptions { gravity: f64::INFINITY, ..standard }, "gravity"),
    ] {
        match whole.with(&options) {
            Err(TransportError::Option { option, .. }) => assert_eq!(option, name),
            other => panic!("{name}: {other:?}"),
        }
    }
    let empty = whole.with(&TransportOptions { fuel: 0.0, gear_down: true, ..standard }).unwrap();
    let burnt = whole.mass_properties().mass() - empty.mass_properties().mass();
    assert!((burnt - 11.48 * 0.453_592_37).abs() < 1e-9, "{burnt}");
}
