//! Trim against the tables of Stevens, Lewis & Johnson, and its limits.
#![allow(clippy::unwrap_used, clippy::panic)] // helpers of tests are tests

use crate::reference;

use phugoid_flight_dynamics::aircraft::{Aircraft, STATES};
use phugoid_flight_dynamics::f16::{F16, F16Constants, F16Options};
use phugoid_flight_dynamics::increments::Increments;
use phugoid_flight_dynamics::integrate::DormandPrince;
use phugoid_flight_dynamics::motion::{Disturbance, motion};
use phugoid_flight_dynamics::simulate::{Simulation, still_air};
use phugoid_flight_dynamics::trim::{Trim, TrimCondition, TrimError, TrimStart, approach, trim};
use proptest::prelude::*;
use reference::{FOOT, POUND_FORCE, numbers, published};
use serde_json::Value;

fn f16(cg: f64, constants: F16Constants) -> F16 {
    F16::new(F16Options { cg, constants, ..F16Options::default() }).unwrap()
}

fn level(speed_ft_s: f64, altitude_ft: f64) -> TrimCondition {
    TrimCondition::level(speed_ft_s * FOOT, altitude_ft * FOOT)
}

/// One unit of the last digit that the reference file holds.
fn last_digit(printed: &Value) -> f64 {
    let text = printed.to_string();
    let decimals = text.split_once('.').map_or(0, |(_, fraction)| fraction.len());
    0.1_f64.powi(decimals as i32)
}

/// The table is printed with three digits, at most three of them decimals: half a unit of the last one.
fn half_a_unit(printed: f64) -> f64 {
    0.5 * 10.0_f64.powf(printed.abs().log10().floor() - 2.0).max(1e-3)
}

/// The book's table was computed with its rounded mass: with it every one of the 48 numbers is met to rounding.
#[test]
fn table_3_6_2_sixteen_speeds_at_sea_level() {
    let Some(published) = published() else { return };
    let aircraft = f16(0.35, F16Constants::BookRounded);
    let rows = published["trim_table_3_6_2"]["rows"].as_array().unwrap();
    assert_eq!(rows.len(), 16);
    for row in rows {
        let row = numbers(row);
        let t = trim(&aircraft, &level(row[0], 0.0)).unwrap();
        let found = [t.throttle, t.alpha_rad.to_degrees(), t.elevator_rad.to_degrees()];
        println!("{:5} ft/s: throttle, alpha, elevator (deg) {found:.4?}, printed {:?}", row[0], &row[1..]);
        for (found, &printed) in found.iter().zip(&row[1..]) {
            assert!((found - printed).abs() < half_a_unit(printed), "{} ft/s: {found} {printed}", row[0]);
        }
        assert!(t.trim_index < 1e-24 && t.largest_residual < 1e-11, "{t:?}");
    }
}

/// With weight over gravity for the mass, the two slowest rows move as the reference file says.
#[test]
fn the_exact_mass_moves_the_slowest_rows() {
    for (speed, expected) in [(130.0, 20.225), (140.0, -1.326)] {
        let t = trim(&f16(0.35, F16Constants::Exact), &level(speed, 0.0)).unwrap();
        assert!((t.elevator_rad.to_degrees() - expected).abs() < 5e-4, "{speed}: {}", t.elevator_rad.to_degrees());
    }
}

#[test]
fn table_3_6_3_three_centres_of_gravity_and_the_coordinated_turn() {
    let Some(published) = published() else { return };
    let columns = &published["trim_table_3_6_3"]["columns"];
    for name in ["nominal", "xcg030", "xcg038", "coordinated_turn_0p3rad_s"] {
        let column = &columns[name];
        let turn_rate = if name.starts_with("coordinated") { 0.3 } else { 0.0 };
        let aircraft = f16(column["xcg"].as_f64().unwrap(), F16Constants::BookRounded);
        let t = trim(&aircraft, &TrimCondition { turn_rate, ..level(502.0, 0.0) }).unwrap();
        for (field, value) in column.as_object().unwrap() {
            let found = match field.as_str() {
                "alpha" => t.alpha_rad,
                "beta" => t.beta_rad,
                "phi" => t.phi_rad,
                "theta" => t.theta_rad,
                "p" => t.p_rad_s,
                "q" => t.q_rad_s,
                "r" => t.r_rad_s,
                "throttle" => t.throttle,
                "el" => t.elevator_rad.to_degrees(),
                "ail" => t.aileron_rad.to_degrees(),
                "rdr" => t.rudder_rad.to_degrees(),
                _ => continue,
            };
            println!("{name:>26} {field:>8}: {found:.6} (printed {value})");
            // The book's minimiser leaves an aileron and rudder of up to 4.3e-6 deg in straight flight, where zero is
            // exact, and its aileron in the turn is off by 1.7e-5 deg.
            let tolerance = match field.as_str() {
                "ail" | "rdr" if turn_rate == 0.0 => 5e-6,
                "ail" => 2e-5,
                _ => 0.55 * last_digit(value),
            };
            assert!((found - value.as_f64().unwrap()).abs() < tolerance, "{name} {field}: {found} {value}");
        }
    }
}

fn example_turn(heading: f64) -> (F16, Trim) {
    let aircraft = f16(0.35, F16Constants::BookRounded);
    let condition = TrimCondition { turn_rate: 0.3, heading, ..level(502.0, 0.0) };
    let t = trim(&aircraft, &condition).unwrap();
    (aircraft, t)
}

#[test]
fn example_3_6_2_turn() {
    let Some(published) = published() else { return };
    let example = &published["example_3_6_2_turn"];
    let (x, u) = (numbers(&example["x"]), numbers(&example["u"]));
    let (_, t) = example_turn(x[5]);
    let found = [t.alpha_rad, t.beta_rad, t.phi_rad, t.theta_rad, t.psi_rad, t.p_rad_s, t.q_rad_s, t.r_rad_s];
    for (i, found) in found.into_iter().enumerate() {
        println!("x[{}] {found:.8} (printed {})", i + 1, x[i + 1]);
        assert!((found - x[i + 1]).abs() < 2e-5, "x[{}]: {found} {}", i + 1, x[i + 1]);
    }
    let degrees = f64::to_degrees;
    let controls =
        [t.throttle, degrees(t.elevator_rad), degrees(t.aileron_rad), degrees(t.rudder_rad), t.power_percent];
    for ((found, printed), tolerance) in
        controls.into_iter().zip([u[0], u[1], u[2], u[3], x[12]]).zip([2e-5, 2e-3, 2e-4, 2e-4, 5e-3])
    {
        println!("control {found:.7} (printed {printed})");
        assert!((found - printed).abs() < tolerance, "{found} {printed}");
    }
}

#[test]
fn example_3_6_6_three_minutes_of_the_turn() {
    let Some(published) = published() else { return };
    let example = &published["example_3_6_2_turn"];
    let (aircraft, t) = example_turn(numbers(&example["x"])[5]);
    let simulation = Simulation {
        use_actuators: false,
        sample_time: 10.0,
        substeps: 1000,
        ..Simulation::new(&aircraft, t.state(), t.controls(), 180.0)
    };
    let trajectory = simulation.run(|_| t.controls(), still_air).unwrap();
    let rows = example["trajectory_180s"]["rows"].as_array().unwrap();
    assert_eq!(trajectory.samples.len(), rows.len());
    let mut worst: f64 = 0.0;
    for (sample, row) in trajectory.samples.iter().zip(rows) {
        let row = numbers(row);
        assert_eq!(sample.time, row[0]);
        let (north, east) = (sample.state.north / FOOT, sample.state.east / FOOT);
        println!("{:4} s: {north:8.1} {east:8.1} ft (printed {} {})", row[0], row[1], row[2]);
        worst = worst.max((north - row[1]).abs()).max((east - row[2]).abs());
    }
    println!("worst {worst:.1} ft");
    assert!(worst < example["trajectory_180s"]["tolerance_ft"].as_f64().unwrap(), "{worst} ft");
}

/// The case of the thesis and of docs/theory.md, with exact constants.
#[test]
fn trim_of_the_estimation_studies() {
    let t = trim(&f16(0.30, F16Constants::Exact), &level(675.0, 20_000.0)).unwrap();
    let (alpha, elevator) = (t.alpha_rad.to_degrees(), t.elevator_rad.to_degrees());
    let thrust = t.thrust_n / POUND_FORCE;
    println!("alpha {alpha:.5} deg, elevator {elevator:.5} deg, thrust {thrust:.2} lbf");
    assert!((alpha - 2.38934).abs() < 5e-6, "{alpha}");
    assert!((elevator + 1.96254).abs() < 5e-6, "{elevator}");
    assert!((thrust - 2227.74).abs() < 5e-3, "{thrust}");
}

#[test]
fn refusals_say_how_much_was_needed() {
    let aircraft = f16(0.35, F16Constants::Exact);
    // A climb at 0.5 rad needs sin(0.5) of the weight besides the drag: not at 40,000 ft.
    let climb = TrimCondition { flight_path_angle: 0.5, ..level(500.0, 40_000.0) };
    match trim(&aircraft, &climb) {
        Err(TrimError::NotEnoughThrust { needed_n, available_n, .. }) => {
            let weight = aircraft.mass_properties.mass() * aircraft.gravity();
            assert!(needed_n > available_n && needed_n > 0.5_f64.sin() * weight, "{needed_n} {available_n} {weight}");
        }
        other => panic!("{other:?}"),
    }
    let dive = TrimCondition { flight_path_angle: -0.5, ..level(500.0, 10_000.0) };
    match trim(&aircraft, &dive) {
        Err(TrimError::TooMuchThrust { needed_n, idle_n, .. }) => assert!(needed_n < idle_n, "{needed_n} {idle_n}"),
        other => panic!("{other:?}"),
    }
    // Equilibria that exist are refused by a narrower range of data: 2.1 deg of angle of attack below it, 34.6 deg above
    // it, where the lift within the range does not carry the aircraft.
    let narrow = |speed| TrimCondition { alpha_range: [0.1, 0.35], ..level(speed, 0.0) };
    match trim(&aircraft, &narrow(502.0)) {
        Err(TrimError::OutsideData { alpha_rad, .. }) => assert!((alpha_rad - 0.0369).abs() < 1e-4, "{alpha_rad}"),
        other => panic!("{other:?}"),
    }
    match trim(&aircraft, &narrow(150.0)) {
        Err(TrimError::NotEnoughLift { available, alpha_rad, .. }) => {
            assert!(available < 1.0 && alpha_rad == 0.35, "{available} {alpha_rad}");
        }
        other => panic!("{other:?}"),
    }
    // A nose-heavy aircraft needs more elevator than there is.
    let heavy = Increments { dCm_alpha: -1.5, ..Increments::NONE };
    match trim(&aircraft, &TrimCondition { increments: heavy, ..level(180.0, 0.0) }) {
        Err(TrimError::SurfaceLimit { surface: "elevator", needed_rad, limit_rad, .. }) => {
            assert!(needed_rad < -limit_rad, "{needed_rad}");
        }
        other => panic!("{other:?}"),
    }
    // Below the stall: at 90 ft/s the dynamic pressure is half of that at 130 ft/s, the slowest speed of the book's table.
    match trim(&aircraft, &level(90.0, 0.0)) {
        Err(TrimError::NotEnoughLift { needed, available, .. }) => {
            assert!(needed == 1.0 && (0.5..1.0).contains(&available), "{available}");
        }
        other => panic!("{other:?}"),
    }
    let error = trim(&aircraft, &level(-5.0, 0.0)).unwrap_err();
    assert_eq!(error.to_string(), format!("trim: speed is {}, expected a positive number, m/s", -5.0 * FOOT));
    // Squares of such a speed are infinite: nothing that is computed with it means anything.
    for (speed, printed) in [(1e300, "1e300"), (20_000.0, "20000")] {
        let error = trim(&aircraft, &TrimCondition::level(speed, 0.0)).unwrap_err().to_string();
        let wanted =
            format!("trim: speed is {printed}, expected above 0 and at most 12000 m/s: check its number and its unit");
        assert_eq!(error, wanted);
    }
}

#[test]
fn every_condition_is_trimmed_or_refused_with_a_reason() {
    let (mut trimmed, mut refused) = (0, 0);
    for cg in [0.25, 0.30, 0.35] {
        let aircraft = f16(cg, F16Constants::Exact);
        for altitude in [0.0, 15e3, 30e3, 45e3] {
            for speed in (12..100).step_by(4).map(|k| 10.0 * f64::from(k)) {
                for (flight_path_angle, turn_rate) in [(0.0, 0.0), (0.1, 0.0), (-0.1, 0.0), (0.0, 0.1), (0.05, -0.2)] {
                    let condition = TrimCondition { flight_path_angle, turn_rate, ..level(speed, altitude) };
                    match trim(&aircraft, &condition) {
                        Ok(_) => trimmed += 1,
                        Err(TrimError::NoConvergence { .. } | TrimError::Condition { .. }) => {
                            panic!("cg {cg}, {altitude} ft, {condition:?}")
                        }
                        Err(_) => refused += 1,
                    }
                }
            }
        }
    }
    println!("{trimmed} trimmed, {refused} refused");
    assert!(trimmed > 700 && refused > 100, "{trimmed} {refused}");
}

#[test]
fn increments_are_part_of_the_trim() {
    let aircraft = f16(0.30, F16Constants::Exact);
    let turn = TrimCondition { turn_rate: 0.05, ..level(500.0, 10_000.0) };
    let nominal = trim(&aircraft, &turn).unwrap();
    // Half of the aileron's effect lost: nearly twice the aileron for the same turn at the same bank.
    let weak = Increments { dCl_aileron: 0.05, ..Increments::NONE };
    let weakened = trim(&aircraft, &TrimCondition { increments: weak, ..turn }).unwrap();
    assert!(weakened.aileron_rad.abs() > 1.2 * nominal.aileron_rad.abs(), "{weakened:?}");
    assert!((weakened.phi_rad - nominal.phi_rad).abs() < 1e-3);
    // Increments about the trim leave it alone.
    let about = Increments { dCm_alpha: -0.2, dCL_alpha: 0.4, dCD_alpha: 0.1, ..Increments::NONE };
    let about = about.about(nominal.alpha_rad, nominal.q_rad_s, nominal.elevator_rad);
    let same = trim(&aircraft, &TrimCondition { increments: about, ..turn }).unwrap();
    assert!((same.alpha_rad - nominal.alpha_rad).abs() < 1e-12, "{same:?}");
}

#[test]
fn serialised_names_carry_their_units() {
    let t = trim(&f16(0.35, F16Constants::Exact), &level(502.0, 0.0)).unwrap();
    let json = serde_json::to_value(t).unwrap();
    for name in ["alpha_rad", "elevator_rad", "thrust_n", "throttle", "power_percent", "trim_index", "q_rad_s"] {
        assert!(json[name].is_f64(), "{name}");
    }
    // Rates of straight flight are zero, not minus zero.
    for name in ["p_rad_s", "q_rad_s", "r_rad_s"] {
        assert_eq!(json[name].to_string(), "0.0", "{name}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, failure_persistence: None, ..ProptestConfig::default() })]
    /// A trim is a fixed point of the motion: flown for ten seconds by another integrator it does not move, apart from
    /// heading and position. Level flight, where the air does not change.
    #[test]
    fn a_level_trim_stays_where_it_is(
        speed in 400.0..800.0_f64, altitude in 0.0..25_000.0_f64, turn_rate in -0.08..0.08_f64, cg in 0.25..0.32_f64,
    ) {
        let aircraft = f16(cg, F16Constants::Exact);
        let t = trim(&aircraft, &TrimCondition { turn_rate, ..level(speed, altitude) }).unwrap();
        let controls = t.controls();
        let rates = |_: f64, x: &[f64; STATES]| {
            let state = phugoid_flight_dynamics::aircraft::State::from_array(*x);
            motion(&aircraft, &state, &controls, &Disturbance::default()).rates.to_array()
        };
        let start = t.state().to_array();
        let end = DormandPrince::with_tolerances(1e-9, 1e-9).integrate(rates, 0.0, &start, 10.0).unwrap();
        for i in [0, 1, 2, 3, 4, 6, 7, 8, 11, 12] {
            prop_assert!((end[i] - start[i]).abs() < 1e-6 * (1.0 + start[i].abs()), "state {i}: {} {}", start[i], end[i]);
        }
        prop_assert!((end[5] - start[5] - 10.0 * turn_rate).abs() < 1e-6);
        // What is felt in a coordinated level turn balances gravity and the turn: 1 g down and psi' V to the side.
        let [ax, ay, az] = motion(&aircraft, &t.state(), &controls, &Disturbance::default()).specific_force;
        prop_assert!((ax.hypot(az) - aircraft.gravity().hypot(turn_rate * t.speed_m_s)).abs() < 1e-8);
        prop_assert!(ay.abs() < 1e-9 && (t.load_factor * aircraft.gravity() + az).abs() < 1e-9);
    }

    /// A climb has the flight path asked for, and a left turn mirrors a right one but for the engine's rotor.
    #[test]
    fn climbs_and_turns_are_what_was_asked_for(path in -0.03..0.15_f64, turn_rate in -0.1..0.1_f64) {
        let aircraft = f16(0.30, F16Constants::Exact);
        let condition = TrimCondition { flight_path_angle: path, turn_rate, ..level(600.0, 5_000.0) };
        let t = trim(&aircraft, &condition).unwrap();
        let m = motion(&aircraft, &t.state(), &t.controls(), &Disturbance::default());
        prop_assert!((m.rates.altitude / t.speed_m_s - path.sin()).abs() < 1e-11);
        prop_assert!((m.rates.psi - turn_rate).abs() < 1e-12);
        prop_assert!(m.rates.phi.abs() < 1e-12 && m.rates.theta.abs() < 1e-12);
        prop_assert!(m.specific_force[1].abs() < 1e-9 && m.rates.power.abs() < 1e-9);
        prop_assert!(m.rates.speed.abs() < 1e-9 && m.rates.q.abs() < 1e-10);
    }
}

#[test]
fn where_there_is_no_air_there_is_no_trim() {
    let aircraft = F16::new(F16Options::default()).unwrap();
    for altitude_ft in [1e9, 200_000.0, -100_000.0] {
        let error = trim(&aircraft, &level(675.0, altitude_ft)).unwrap_err().to_string();
        assert!(error.contains("altitude") && error.contains("-1000 and 25000 m"), "{altitude_ft} ft: {error}");
    }
}

/// The index of the thesis falls from every start to the same trim; a start that is no number is refused.
#[test]
fn the_solver_shows_its_way_to_the_trim() {
    let aircraft = f16(0.30, F16Constants::Exact);
    let condition = level(675.0, 20_000.0);
    let wanted = trim(&aircraft, &condition).unwrap();
    let start = |alpha: f64, elevator: f64| TrimStart {
        alpha,
        beta: 0.05,
        phi: -0.2,
        theta: 0.3,
        throttle: 0.8,
        elevator,
        aileron: 0.1,
        rudder: -0.1,
    };
    for (alpha, elevator) in [(-0.05, 0.2), (0.3, -0.2), (0.1, 0.0)] {
        let steps = approach(&aircraft, &condition, &start(alpha, elevator)).unwrap();
        let (first, last) = (steps.first().unwrap(), steps.last().unwrap());
        assert_eq!((first.alpha_rad, first.elevator_rad), (alpha, elevator));
        assert!(first.trim_index > 1e-2 && last.trim_index < 1e-24, "{first:?} {last:?}");
        assert!((last.alpha_rad - wanted.alpha_rad).abs() < 1e-12, "{last:?}");
        assert!((last.elevator_rad - wanted.elevator_rad).abs() < 1e-12, "{last:?}");
    }
    let refused = approach(&aircraft, &condition, &start(f64::NAN, 0.0)).unwrap_err().to_string();
    assert!(refused.contains("start is NaN"), "{refused}");
}
