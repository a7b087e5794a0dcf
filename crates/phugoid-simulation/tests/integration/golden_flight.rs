//! The simulated flight against the golden trace: another implementation's altitude history and measurements.

use crate::shared_data;

use phugoid_simulation::flight::fly;
use phugoid_simulation::scenario::built_in;
use shared_data::shared_file;

const FOOT: f64 = 0.3048;

/// `golden/calm_3211_p4.csv` records the true altitude to 1e-6 ft and measurements with the listed noise.
#[test]
fn the_calm_flight_is_the_golden_one() {
    let Some(path) = shared_file("golden/calm_3211_p4.csv") else { return };
    let text = std::fs::read_to_string(path).unwrap();
    let header: Vec<&str> = text.lines().next().unwrap().split(',').collect();
    let column = |name: &str| {
        let index = header.iter().position(|h| *h == name).unwrap();
        text.lines().skip(1).map(|l| l.split(',').nth(index).unwrap().parse().unwrap()).collect::<Vec<f64>>()
    };
    let scenario = built_in("f16-calm").unwrap().unwrap();
    let flight = fly(&scenario).unwrap();
    let truth = |name: &str| flight.truth.channel(name).unwrap().values.clone();

    // The tables have kinks, where RK4 loses its order: with 1, 2, 4 and 32 steps per sample the altitude at the end, after
    // 89 ft of descent, is -3.0e-4, -1.9e-4, -1.4e-4 and -1.3e-4 ft from the golden one (measured).
    let altitude = truth("altitude");
    for (k, golden) in column("altitude_ft").iter().enumerate() {
        assert!((altitude[k] / FOOT - golden).abs() < 5e-4, "altitude at sample {k}: {} {golden}", altitude[k] / FOOT);
    }
    for (k, golden) in column("elevator_deg").iter().enumerate() {
        assert!((truth("elevator")[k].to_degrees() - golden).abs() < 1e-8, "elevator at sample {k}");
    }
    // What is left of the golden measurements is their noise: rms within five standard errors of sigma, 1/sqrt(2 * 2000).
    let g = 32.17 * FOOT;
    for (name, channel, unit, sigma) in [
        ("tas_ft_s", "true_airspeed", FOOT, FOOT),
        ("alpha_rad", "alpha", 1.0, 0.1_f64.to_radians()),
        ("theta_rad", "theta", 1.0, 0.05_f64.to_radians()),
        ("q_rad_s", "q", 1.0, 0.1_f64.to_radians()),
        ("ax_ft_s2", "ax", FOOT, 0.01 * g),
        ("az_ft_s2", "az", FOOT, 0.01 * g),
    ] {
        let golden = column(name);
        let (truth, n) = (truth(channel), golden.len() as f64);
        let rms = (golden.iter().zip(&truth).map(|(y, x)| (y * unit - x).powi(2)).sum::<f64>() / n).sqrt();
        let mean = golden.iter().zip(&truth).map(|(y, x)| y * unit - x).sum::<f64>() / n;
        assert!((rms / sigma - 1.0).abs() < 5.0 / (2.0 * n).sqrt(), "{channel}: rms {rms}, sigma {sigma}");
        assert!(mean.abs() < 5.0 * sigma / n.sqrt(), "{channel}: mean error {mean}, sigma {sigma}");
    }
}

#[test]
fn every_built_in_scenario_flies_and_repeats() {
    for (name, _) in phugoid_simulation::scenario::BUILT_IN {
        let scenario = built_in(name).unwrap().unwrap();
        let flight = fly(&scenario).unwrap_or_else(|e| panic!("{name}: {e}"));
        assert_eq!(flight.measured.time.len(), scenario.samples());
        let again = fly(&scenario).unwrap();
        let bits = |f: &phugoid_simulation::flight::Flight| {
            f.measured.channels.iter().flat_map(|c| c.values.iter().map(|v| v.to_bits())).collect::<Vec<_>>()
        };
        assert_eq!(bits(&flight), bits(&again), "{name}");
    }
}
