//! NASA's check cases: spheres, the brick and the F-16 against every simulator that wrote a trajectory, and what follows
//! from physics for those without trajectories.

use std::path::PathBuf;

use phugoid_aircraft::check_case::compare::{Comparison, compare};
use phugoid_aircraft::check_case::trajectory::COLUMNS;
use phugoid_aircraft::check_case::{CheckCaseError, CheckCases, Trajectory};
use phugoid_flight_dynamics::globe::flight::Integration;

use crate::shared_data::shared_file;
use crate::simulators::simulators;

fn definitions() -> Option<(CheckCases, PathBuf)> {
    let file = shared_file("nesc/cases.json")?;
    let cases = CheckCases::read(&file).unwrap();
    Some((cases, file.parent()?.to_owned()))
}

fn column(flight: &Trajectory, heading: &str) -> Vec<f64> {
    let column = COLUMNS.iter().position(|name| *name == heading).unwrap();
    flight.rows.iter().map(|row| row[column]).collect()
}

fn first(flight: &Trajectory, heading: &str) -> f64 {
    column(flight, heading)[0]
}

fn last(flight: &Trajectory, heading: &str) -> f64 {
    *column(flight, heading).last().unwrap()
}

/// Quantities in which the flight is farther from a simulator than the simulators are from one another, and by which
/// factor at most. In case 11 simulator 04 flies 0.01 ft/s faster from the start.
const BEYOND: [(&str, &str, f64); 2] = [("11", "dynamicPressure_lbf_ft2", 1.06), ("13p3", "airDensity_slug_ft3", 1.08)];

fn agrees(id: &str) -> Option<Vec<Comparison>> {
    let (cases, folder) = definitions()?;
    let flight = cases.case(id).unwrap().fly().unwrap();
    let comparisons = compare(&flight, &simulators(&folder, id));
    assert!(comparisons.len() >= 25, "{id}: {}", comparisons.len());
    for c in &comparisons {
        let known = BEYOND.iter().find(|(case, heading, _)| (*case, *heading) == (id, c.heading));
        let mark = known.map_or(c.mark(), |(_, _, factor)| c.spread * factor);
        assert!(c.largest() <= mark, "{id} {}: {:e} > {mark:e} {:?}", c.heading, c.largest(), c.differences);
    }
    Some(comparisons)
}

fn closest(comparisons: &[Comparison], heading: &str) -> f64 {
    comparisons.iter().find(|c| c.heading == heading).unwrap().closest()
}

#[test]
fn spheres_and_brick_fall_as_in_the_simulators() {
    for (id, altitude) in [("01", 1e-6), ("02", 1e-6), ("06", 1e-4), ("07", 1e-4), ("09", 5e-3)] {
        let Some(comparisons) = agrees(id) else { return };
        // Far inside the spread there are simulators that solve the same equations to more digits.
        assert!(closest(&comparisons, "altitudeMsl_ft") < altitude, "{id}");
        if id == "02" {
            for angle in ["eulerAngle_deg_Yaw", "eulerAngle_deg_Pitch", "eulerAngle_deg_Roll"] {
                assert!(closest(&comparisons, angle) < 1e-8, "{angle}");
            }
        }
    }
}

#[test]
fn the_f16_flies_straight_as_in_the_simulators() {
    let Some(comparisons) = agrees("11") else { return };
    assert!(closest(&comparisons, "altitudeMsl_ft") < 2e-3);
    assert!(closest(&comparisons, "eulerAngle_deg_Roll") < 1e-5);
}

#[test]
fn the_f16_follows_its_autopilot_as_in_the_simulators() {
    for (id, altitude) in [("13p1", 2e-3), ("13p3", 0.04), ("15", 2e-3)] {
        let Some(comparisons) = agrees(id) else { return };
        assert!(closest(&comparisons, "altitudeMsl_ft") < altitude, "{id}");
    }
}

/// Why a step command is integrated as the simulators did it: the flight by Runge-Kutta is 5 ms behind that of simulator 05, half
/// a step, which is what Adams and Bashforth give to a step; by their formula both fly the same to a hundredth of that.
#[test]
fn half_a_step_is_what_the_integration_makes_of_a_step_command() {
    let Some((cases, folder)) = definitions() else { return };
    let case = cases.case("13p1").unwrap();
    let [runge_kutta, adams_bashforth] = [Integration::RungeKutta4, Integration::AdamsBashforth2].map(|integration| {
        let flight = case.fly_by(integration).unwrap();
        closest(&compare(&flight, &simulators(&folder, "13p1")), "altitudeMsl_ft")
    });
    assert!(adams_bashforth < 0.05 * runge_kutta, "{adams_bashforth} {runge_kutta}");
}

#[test]
fn our_spread_is_the_published_one() {
    let Some((cases, folder)) = definitions() else { return };
    let text = std::fs::read_to_string(folder.join("spread.json")).unwrap();
    let published: serde_json::Value = serde_json::from_str(&text).unwrap();
    for id in ["06", "15"] {
        let flight = cases.case(id).unwrap().fly().unwrap();
        for c in compare(&flight, &simulators(&folder, id)) {
            let entry = &published[format!("Atmos_{id}")][c.heading];
            let Some(spread) = entry["largest_difference"].as_f64() else { continue };
            let same = (c.spread - spread).abs() <= 1e-6 * spread + 1e-15;
            assert!(same, "{id} {}: {:e} {spread:e}", c.heading, c.spread);
        }
    }
}

#[test]
fn every_case_can_be_flown() {
    let Some((cases, _)) = definitions() else { return };
    let ids = cases.ids();
    assert_eq!(ids.len(), 18);
    for id in ids {
        let case = cases.case(&id).unwrap();
        let flight = case.fly().unwrap();
        assert_eq!(flight.rows.len(), (case.duration / case.output_interval).round() as usize + 1, "{id}");
        assert!(flight.rows.iter().flatten().all(|x| x.is_finite()), "{id}");
        let text = flight.to_csv();
        let back = phugoid_aircraft::check_case::compare::Recorded::parse("us", &text).unwrap();
        assert_eq!(back.rows.len(), flight.rows.len());
        assert_eq!(back.rows[1][..], flight.rows[1][..]);
    }
    assert!(matches!(cases.case("99"), Err(CheckCaseError::Unknown { .. })));
}

#[test]
fn the_brick_with_damping_stops_turning_and_falls_as_without() {
    let Some((cases, _)) = definitions() else { return };
    let damped = cases.case("03").unwrap().fly().unwrap();
    let free = cases.case("02").unwrap().fly().unwrap();
    for heading in ["altitudeMsl_ft", "longitude_deg", "feVelocity_ft_s_Z", "mach"] {
        let (a, b) = (column(&damped, heading), column(&free, heading));
        assert!(a.iter().zip(&b).all(|(a, b)| (a - b).abs() < 1e-7), "{heading}");
    }
    let rate = |flight: &Trajectory, row: usize| -> f64 {
        let axes =
            ["Roll", "Pitch", "Yaw"].map(|axis| column(flight, &format!("bodyAngularRateWrtEi_deg_s_{axis}"))[row]);
        axes.iter().map(|x| x * x).sum::<f64>().sqrt()
    };
    assert!(rate(&damped, 300) < 0.01, "{}", rate(&damped, 300));
    // What is left is damping relative to the air, which turns with the earth at 0.004178 deg/s.
    assert!(rate(&damped, 300) < 2.0 * 0.004178);
    // At the first rows the moment is half of rho V S b^2 C_lp p / 2.
    let moment = column(&damped, "aero_bodyMoment_ftlbf_L");
    let (density, roll) = (column(&damped, "airDensity_slug_ft3"), column(&damped, "bodyAngularRateWrtEi_deg_s_Roll"));
    let speed = column(&damped, "trueAirspeed_nmi_h");
    for row in [10, 50, 100] {
        let velocity = speed[row] * 1852.0 / 3600.0 / 0.3048;
        let expected = -0.25 * density[row] * velocity * 0.22222 / 9.0 * roll[row].to_radians();
        // The damping is relative to the air, which turns with the earth at 0.004178 deg/s.
        let turning = 0.0042 / roll[row].abs();
        assert!((moment[row] / expected - 1.0).abs() < turning, "{row}: {} {expected}", moment[row]);
    }
}

#[test]
fn spheres_over_a_round_earth() {
    let Some((cases, _)) = definitions() else { return };
    let fixed = cases.case("04").unwrap().fly().unwrap();
    let turning = cases.case("05").unwrap().fly().unwrap();
    // Without rotation it falls straight down and turns at the rates it was given.
    for heading in ["latitude_deg", "longitude_deg", "feVelocity_ft_s_X", "feVelocity_ft_s_Y"] {
        assert!(column(&fixed, heading).iter().all(|x| x.abs() < 1e-12), "{heading}");
    }
    assert!((last(&fixed, "bodyAngularRateWrtEi_deg_s_Yaw") - 30.0).abs() < 1e-9);
    // Gravitation of the inverse square.
    let gm = 398_600_441_800_000.0 / 0.3048_f64.powi(3);
    for flight in [&fixed, &turning] {
        let (altitude, gravity) = (column(flight, "altitudeMsl_ft"), column(flight, "localGravity_ft_s2"));
        for (h, g) in altitude.iter().zip(&gravity) {
            assert!((g - gm / (20_902_255.199 + h).powi(2)).abs() < 1e-11);
        }
    }
    // Centrifugal acceleration w^2 r holds the sphere up: most of what differs after a second, before there is drag.
    let late = |flight: &Trajectory| column(flight, "altitudeMsl_ft")[10];
    let lift = 0.5 * 7.292_115e-5_f64.powi(2) * (20_902_255.199 + 30_000.0);
    assert!(((late(&turning) - late(&fixed)) / lift - 1.0).abs() < 2e-3, "{} {lift}", late(&turning) - late(&fixed));
    // It lands east of where it was dropped, by w g t^3 / 3 without drag.
    let east = last(&turning, "longitude_deg").to_radians() * 20_902_255.0;
    let free = 7.292_115e-5 * 32.1 * 27_000.0 / 3.0;
    assert!(east > 0.8 * free && east < free, "{east} {free}");
}

#[test]
fn spheres_in_wind_and_thrown_north() {
    let Some((cases, _)) = definitions() else { return };
    let [still, steady, shear] = ["06", "07", "08"].map(|id| cases.case(id).unwrap().fly().unwrap());
    // At rest in a wind of 70 ft/s, later in one of 0.003 ft/s per foot of altitude.
    assert!((first(&shear, "trueAirspeed_nmi_h") * 1852.0 / 3600.0 / 0.3048 - 70.0).abs() < 1e-9);
    assert!((first(&steady, "trueAirspeed_nmi_h") * 1852.0 / 3600.0 / 0.3048 - 20.0).abs() < 1e-9);
    let east = |flight| last(flight, "longitude_deg");
    assert!(east(&still) < east(&steady) && east(&steady) < east(&shear));
    assert!((last(&still, "altitudeMsl_ft") - last(&shear, "altitudeMsl_ft")).abs() < 10.0);
    // Where the wind would be zero, at 6667 ft, the sphere does not arrive; it lags behind what it was blown to.
    let (north, east) = ["10", "09"].map(|id| cases.case(id).unwrap().fly().unwrap()).into();
    // Coriolis acceleration turns the one thrown north to the west on its way up and lifts the one thrown east.
    assert!(last(&north, "latitude_deg") > 0.06 && last(&north, "longitude_deg") < 0.0);
    assert!(last(&east, "altitudeMsl_ft") > last(&north, "altitudeMsl_ft"));
    assert!((first(&north, "bodyAngularRateWrtEi_deg_s_Roll") - 0.004_178_073).abs() < 1e-8);
}

#[test]
fn the_f16_flies_its_other_manoeuvres() {
    let Some((cases, _)) = definitions() else { return };
    let fly = |id: &str| cases.case(id).unwrap().fly().unwrap();
    // 12: trimmed at Mach 2; it keeps its altitude, angle and speed for three minutes.
    let fast = fly("12");
    assert!((first(&fast, "eulerAngle_deg_Pitch") + 0.74).abs() < 5e-3);
    let (low, high) = fast.range("altitudeMsl_ft").unwrap();
    assert!(high - low < 0.5 && (high - 30_013.0).abs() < 0.5, "{low} {high}");
    let (slow, quick) = fast.range("trueAirspeed_nmi_h").unwrap();
    assert!(quick - slow < 0.01, "{slow} {quick}");
    // 13.2: five knots of equivalent airspeed less.
    let slower = fly("13p2");
    let equivalent = |row: usize| {
        let (speed, density) = (column(&slower, "trueAirspeed_nmi_h"), column(&slower, "airDensity_slug_ft3"));
        speed[row] * (density[row] / 0.002_376_892).sqrt()
    };
    assert!((equivalent(40) - equivalent(200) - 5.0).abs() < 0.01, "{} {}", equivalent(40), equivalent(200));
    assert!((last(&slower, "altitudeMsl_ft") - 10_013.0).abs() < 5.0);
    // 13.4: two thousand feet to the right of the old course.
    let aside = fly("13p4");
    let (latitude, longitude) = (column(&aside, "latitude_deg"), column(&aside, "longitude_deg"));
    let right = |row: usize| {
        let north = (latitude[row] - latitude[0]).to_radians() * 20_879_000.0;
        let east = (longitude[row] - longitude[0]).to_radians() * 20_960_000.0 * 36.05_f64.to_radians().cos();
        (east - north) * 0.5_f64.sqrt()
    };
    assert!(right(190).abs() < 10.0, "{}", right(190));
    assert!((right(600) - 2000.0).abs() < 30.0, "{}", right(600));
    assert!((last(&aside, "eulerAngle_deg_Yaw") - 45.0).abs() < 0.5);
    // 16: three nautical miles from the crossing of equator and date line, and the tenth of a mile that holds the bank.
    let circle = fly("16");
    let (latitude, longitude) = (column(&circle, "latitude_deg"), column(&circle, "longitude_deg"));
    for row in [600, 900, 1200, 1800] {
        let east = (longitude[row] + 360.0).rem_euclid(360.0) - 180.0;
        let radius = latitude[row].hypot(east) * 60.0;
        assert!((radius - 3.0).abs() < 0.1, "{row}: {radius}");
    }
    let (low, high) = circle.range("longitude_deg").unwrap();
    assert!(low < -179.9 && high > 179.9);
}

#[test]
fn definitions_that_are_not_understood_are_refused() {
    let Some((_, folder)) = definitions() else { return };
    let text = std::fs::read_to_string(folder.join("cases.json")).unwrap();
    let temporary = std::env::temp_dir().join(format!("phugoid-check-cases-{}.json", std::process::id()));
    let changes = [
        ("20 ft/s towards east", "a breeze", "07"),
        ("20 ft/s towards east", "20 ft/s towards up", "07"),
        ("\"round, fixed\"", "\"round\"", "04"),
        ("\"1/r^2\"", "\"1/r^3\"", "04"),
        ("Cl_p = Cm_q = Cn_r = -1", "with feathers", "03"),
        ("\"sphere with CD = 0\"", "\"balloon\"", "01"),
        ("+100 ft altitude command at 5 s", "a loop", "13p1"),
        ("\"mass_slug\": 1.0", "\"mass_slug\": 0.0", "06"),
        ("\"US Standard 1976\"", "\"Venus\"", "06"),
        ("\"flattening\": \"1/298.257223563\"", "\"flattening\": \"1/0\"", "06"),
    ];
    for (old, new, id) in changes {
        assert!(text.contains(old), "{old}");
        std::fs::write(&temporary, text.replace(old, new)).unwrap();
        let cases = CheckCases::read(&temporary).unwrap();
        assert!(matches!(cases.case(id), Err(CheckCaseError::Definition { .. })), "{new}");
    }
    // Without its models there is no F-16.
    std::fs::write(&temporary, &text).unwrap();
    let without = CheckCases::read(&temporary).unwrap().case("11").unwrap().fly();
    assert!(matches!(without, Err(CheckCaseError::Model { .. })));
    std::fs::write(&temporary, "{").unwrap();
    assert!(matches!(CheckCases::read(&temporary), Err(CheckCaseError::Json { .. })));
    std::fs::remove_file(&temporary).unwrap();
    assert!(matches!(CheckCases::read(&temporary), Err(CheckCaseError::Read { .. })));
}
