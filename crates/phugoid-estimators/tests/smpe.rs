//! The flagship on small plants: what it must find, and what must not upset it.

mod plants;

use phugoid_estimators::smpe::{ParameterPrior, ReReaching, Smpe, SmpeSettings};
use phugoid_estimators::{ChangeState, DetectorState, Estimate, Estimator, ParameterStatus, Phase, Sample};
use plants::*;

type Jet = Smpe<ShortPeriod, 2, 3, 8>;

fn jet_priors() -> [ParameterPrior; 4] {
    let around = |truth: f64, start: f64| ParameterPrior::bounded(start, truth - truth.abs(), truth + truth.abs());
    [around(JET_TRUTH[0], -0.35), around(JET_TRUTH[1], -10.0), around(JET_TRUTH[2], 6.5), around(JET_TRUTH[3], -0.8)]
}

fn jet_settings() -> SmpeSettings<2, 3, 8> {
    SmpeSettings::automatic(&jet_priors(), JET_NOISE, 0.01).expect("sound settings")
}

fn truth8() -> [f64; 8] {
    let mut theta = [0.0; 8];
    theta[..4].copy_from_slice(&JET_TRUTH[..4]);
    theta
}

fn run(estimator: &mut Jet, flight: &[Sample<[f64; 1], 3>]) -> Vec<Estimate<8>> {
    flight.iter().map(|sample| estimator.update(sample)).collect()
}

fn jet_flight(seed: u64, n: usize) -> Vec<Sample<[f64; 1], 3>> {
    fly(&JET, &regular(n, 0.01), [0.0; 2], |_| truth8(), |t| [elevator_3211(t)], JET_NOISE, &mut seeded(seed))
}

#[test]
fn finds_the_short_period_within_its_bounds() {
    // 2-sigma coverage over 60 seeded flights of 10 s: 240 verdicts, binomial 95 % has a standard deviation of 1.4 %.
    let mut inside = 0;
    for seed in 0..60 {
        let mut estimator = Jet::new(JET, jet_settings()).unwrap();
        let last = *run(&mut estimator, &jet_flight(seed, 1000)).last().unwrap();
        for j in 0..4 {
            let error = (last.parameters[j] - JET_TRUTH[j]).abs();
            assert!(error < 6.0 * last.corrected_std_error[j], "seed {seed} parameter {j}: {error}");
            assert_ne!(last.parameter_status[j], ParameterStatus::NotExcited);
            if error < 2.0 * last.corrected_std_error[j] {
                inside += 1;
            }
        }
    }
    let coverage = f64::from(inside) / 240.0;
    println!("2-sigma coverage {coverage}");
    assert!((0.90..=1.0).contains(&coverage), "{coverage}");
}
