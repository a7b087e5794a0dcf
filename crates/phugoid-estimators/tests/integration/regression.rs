//! Recursive least squares, Fourier regression and the teaching modes on a short period whose truth is known.

#![allow(clippy::unwrap_used)]

use crate::plants;

use phugoid_estimators::adaptive_model::AdaptiveModel;
use phugoid_estimators::fourier::FourierRegression;
use phugoid_estimators::implicit_sign::ImplicitSign;
use phugoid_estimators::regression::{MeasuredStates, Regression, Row};
use phugoid_estimators::rls::RecursiveLeastSquares;
use phugoid_estimators::settings::{
    EstimatorSettings, FourierSettings, ParameterPrior, RegressionSettings, SettingsError,
};
use phugoid_estimators::super_twisting::SuperTwisting;
use phugoid_estimators::{Estimate, Estimator, Inspect, ParameterStatus, Phase, Sample};
use plants::{JET, JET_NOISE, JET_TRUTH, ShortPeriod, elevator_3211, elevator_busy, fly, regular, seeded};

const P: usize = 4;
const TRUTH: [f64; P] = [JET_TRUTH[0], JET_TRUTH[1], JET_TRUTH[2], JET_TRUTH[3]];
const START: [f64; P] = [-0.9, -12.0, 4.0, -0.8];
const SD: [f64; P] = [0.5, 10.0, 2.0, 0.6];

type Flight = Vec<Sample<[f64; 1], 3>>;

fn common() -> EstimatorSettings<2, 3, P> {
    let priors: Vec<ParameterPrior> = (0..P).map(|j| ParameterPrior::absolute(START[j], SD[j])).collect();
    EstimatorSettings::automatic(&priors, JET_NOISE, 0.01).unwrap()
}

type Rows = Regression<ShortPeriod, MeasuredStates<2>, 2, 3, P>;

fn with(regression: RegressionSettings, fourier: FourierSettings) -> Result<Rows, SettingsError> {
    Regression::new(JET, states(), EstimatorSettings { regression, fourier, ..common() })
}

fn rows() -> Rows {
    with(settings(), FourierSettings::default()).unwrap()
}

fn settings() -> RegressionSettings {
    RegressionSettings::default()
}

fn states() -> MeasuredStates<2> {
    MeasuredStates::new::<_, 3, P>(&JET)
}

fn rls(settings: RegressionSettings) -> RecursiveLeastSquares<Rows, 3, P> {
    RecursiveLeastSquares::new(with(settings, FourierSettings::default()).unwrap())
}

fn fourier(settings: FourierSettings) -> FourierRegression<ShortPeriod, MeasuredStates<2>, 2, 3, P> {
    FourierRegression::new(with(RegressionSettings::default(), settings).unwrap()).unwrap()
}

fn flight(seconds: f64, noise: f64, seed: u64, input: fn(f64) -> f64) -> Flight {
    let times = regular((seconds * 100.0) as usize, 0.01);
    fly::<_, 2, 3, P>(
        &JET,
        &times,
        [0.0; 2],
        |_| TRUTH,
        |t| [input(t)],
        JET_NOISE.map(|std| noise * std),
        &mut seeded(seed),
    )
}

fn run(estimator: &mut impl Estimator<3, P, Input = [f64; 1]>, flight: &[Sample<[f64; 1], 3>]) -> Estimate<P> {
    flight.iter().map(|sample| estimator.update(sample)).last().unwrap()
}

/// Largest error over the prior's sigma.
fn worst(estimate: &Estimate<P>, truth: &[f64; P]) -> f64 {
    (0..P).map(|j| ((estimate.parameters[j] - truth[j]) / SD[j]).abs()).fold(0.0, f64::max)
}

/// Gauss elimination with pivoting: another way than the estimator's.
fn solve(mut a: [[f64; P]; P], mut b: [f64; P]) -> [f64; P] {
    for k in 0..P {
        let pivot = (k..P).max_by(|&i, &j| a[i][k].abs().total_cmp(&a[j][k].abs())).unwrap();
        a.swap(k, pivot);
        b.swap(k, pivot);
        for i in k + 1..P {
            let f = a[i][k] / a[k][k];
            for j in k..P {
                a[i][j] -= f * a[k][j];
            }
            b[i] -= f * b[k];
        }
    }
    for k in (0..P).rev() {
        b[k] = (b[k] - (k + 1..P).map(|j| a[k][j] * b[j]).sum::<f64>()) / a[k][k];
    }
    b
}

#[test]
fn batch_and_recursive_least_squares_agree() {
    let mut rls = rls(settings());
    // Columns over the prior's sigma, about its start values; the prior is a row each.
    let mut information: [[f64; P]; P] =
        core::array::from_fn(|i| core::array::from_fn(|j| if i == j { 1.0 } else { 0.0 }));
    let mut score = [0.0; P];
    let mut rows = 0;
    let mut compared = 0;
    for sample in flight(15.0, 1.0, 5, elevator_3211) {
        let estimate = rls.update_observed(&sample, |row: &Row<P>| {
            rows += 1;
            let psi: [f64; P] = core::array::from_fn(|j| row.w[j] * SD[j] / row.std);
            let left = (row.z - (0..P).map(|j| row.w[j] * START[j]).sum::<f64>()) / row.std;
            for i in 0..P {
                score[i] += psi[i] * left;
                for j in 0..P {
                    information[i][j] += psi[i] * psi[j];
                }
            }
        });
        let batch = solve(information, score);
        for j in 0..P {
            let recursive = (estimate.parameters[j] - START[j]) / SD[j];
            // Issue: 1e-9. Measured: below 1e-12.
            assert!((recursive - batch[j]).abs() < 1e-9, "{j} after {rows} rows: {recursive} {}", batch[j]);
        }
        let mut covariance = [[0.0; P]; P];
        rls.covariance(&mut covariance);
        for j in 0..P {
            let mut unit = [0.0; P];
            unit[j] = 1.0;
            let expected = solve(information, unit);
            for i in 0..P {
                assert!((covariance[i][j] / (SD[i] * SD[j]) - expected[i]).abs() < 1e-9);
            }
        }
        compared += 1;
    }
    // Two rows a frame (az and q) but for the start and the first interval.
    assert!(compared == 1500 && rows > 2900, "{compared} {rows}");
}

#[test]
fn without_noise_the_truth_is_found() {
    // What is left is that rates do not run quite straight between samples: of the order (omega h)^2/12 at 5 rad/s, 2e-4.
    let clean = flight(15.0, 0.0, 5, elevator_3211);
    let least_squares = run(&mut rls(settings()), &clean);
    assert!(worst(&least_squares, &TRUTH) < 5e-3, "{:?}", least_squares.parameters);
    let transformed = run(&mut fourier(FourierSettings::default()), &clean);
    assert!(worst(&transformed, &TRUTH) < 5e-3, "{:?}", transformed.parameters);
    let mut sign = ImplicitSign::new(rows(), 2.0).unwrap();
    assert_eq!(run(&mut sign, &clean).parameters, least_squares.parameters, "reached, it is least squares");
    let mut twisting = SuperTwisting::new(rows());
    let twisted = run(&mut twisting, &clean);
    assert!(worst(&twisted, &TRUTH) < 2e-2, "{:?}", twisted.parameters);
    assert!(twisted.std_error.iter().all(|std| std.is_infinite()));
}

/// The record ends in the middle of the motion.
#[test]
fn the_end_point_term_decides_in_the_middle_of_a_manoeuvre() {
    let record = flight(4.0, 0.0, 7, elevator_3211);
    let with = run(&mut fourier(FourierSettings::default()), &record);
    let without = run(&mut fourier(FourierSettings { end_point: false, ..FourierSettings::default() }), &record);
    let moment = |e: &Estimate<P>| [0, 1, 3].map(|j| ((e.parameters[j] - TRUTH[j]) / TRUTH[j]).abs());
    println!("with {:?}, without {:?}", moment(&with), moment(&without));
    for (right, wrong) in moment(&with).into_iter().zip(moment(&without)) {
        // With it 0.2 to 1.4 % (the prior still weighs at 4 s), without 20 to 42 %.
        assert!(right < 0.02 && wrong > 0.1, "{right} {wrong}");
    }
}

#[test]
fn bounds_hold() {
    const RUNS: u64 = 60;
    let mut covered = [[0.0; P]; 2];
    for seed in 0..RUNS {
        // A tenth of the noise on the angle of attack: smoothed as a state source would.
        let noise = [0.1 * JET_NOISE[0], JET_NOISE[1], JET_NOISE[2]];
        let times = regular(1500, 0.01);
        let mut rng = seeded(100 + seed);
        let record = fly::<_, 2, 3, P>(&JET, &times, [0.0; 2], |_| TRUTH, |t| [elevator_3211(t)], noise, &mut rng);
        let estimates = [run(&mut rls(settings()), &record), run(&mut fourier(FourierSettings::default()), &record)];
        for (estimate, covered) in estimates.iter().zip(&mut covered) {
            for j in 0..P {
                let inside = (estimate.parameters[j] - TRUTH[j]).abs() <= 2.0 * estimate.corrected_std_error[j];
                covered[j] += f64::from(u8::from(inside)) / RUNS as f64;
            }
        }
    }
    println!("{covered:?}");
    // 95.4 % less four standard errors of a fraction of 60 runs.
    for j in 0..P {
        assert!(covered[0][j] > 0.84 && covered[1][j] > 0.84, "{j}: {covered:?}");
    }
}

#[test]
fn forgetting_follows_a_change_and_does_not_wind_up() {
    let changed = [-0.3, -20.0, 4.0, -1.2];
    let times = regular(12_000, 0.01);
    let theta = |t: f64| if t < 10.0 { TRUTH } else { changed };
    // Busy for 30 s, then an hour's worth of nothing would follow; ninety seconds of it are enough to see it.
    let input = |t: f64| [if t < 30.0 { elevator_busy(t) } else { 0.0 }];
    // A tenth of the noise on the angle of attack: smoothed as a state source would. With all of it the lift slope would be drawn to
    // zero by the noise of its own regressor as soon as nothing moves.
    let noise = [0.1 * JET_NOISE[0], JET_NOISE[1], JET_NOISE[2]];
    let record = fly::<_, 2, 3, P>(&JET, &times, [0.0; 2], theta, input, noise, &mut seeded(3));
    let forgetting = RegressionSettings { forgetting_per_s: 0.3, ..settings() };
    let mut forgetful = rls(forgetting);
    let mut constant = rls(settings());
    let (busy, quiet) = record.split_at(3000);
    let followed = run(&mut forgetful, busy);
    let averaged = run(&mut constant, busy);
    assert!(worst(&followed, &changed) < 0.1, "{:?}", followed.parameters);
    assert!(worst(&averaged, &changed) > 0.1, "{:?}", averaged.parameters);
    // Ten seconds of decay, then nothing moves.
    let calmed = run(&mut forgetful, &quiet[..1000]);
    let rested = run(&mut forgetful, &quiet[1000..]);
    for j in 0..P {
        let (before, after) = (calmed.std_error[j], rested.std_error[j]);
        assert!(after <= before * 1.01, "{j}: {before} {after}");
        assert!((rested.parameters[j] - calmed.parameters[j]).abs() < 0.2 * SD[j], "{j}");
        assert!(followed.std_error[j] < 0.5 * SD[j]);
    }
}

/// Everything moves all the time, but one column is never excited: it must not grow beyond its prior.
#[test]
fn a_column_without_information_stays_at_its_prior() {
    let record = flight(60.0, 1.0, 4, elevator_busy);
    // Without elevator in the input of the model Cmde has no regressor.
    let blind: Flight = record.iter().map(|s| Sample { input: [0.0], ..*s }).collect();
    let mut forgetful = rls(RegressionSettings { forgetting_per_s: 1.0, ..settings() });
    let mut highest: f64 = 0.0;
    for sample in &blind {
        highest = highest.max(forgetful.update(sample).std_error[3] / SD[3]);
    }
    // To within lambda h p/2 = 2 %.
    assert!((0.9..1.03).contains(&highest), "{highest}");
}

/// Runs one estimator over a record with everything that can be wrong with one.
fn mistreat(estimator: &mut (impl Inspect<3, P> + Estimator<3, P, Input = [f64; 1]>), bounds: bool) {
    let mut record = flight(20.0, 1.0, 9, elevator_3211);
    for (k, sample) in record.iter_mut().enumerate() {
        match k % 50 {
            7 => sample.outputs = [f64::NAN; 3],
            13 => sample.outputs[1] = f64::NAN,
            19 => sample.outputs[2] += 20.0 * JET_NOISE[2],
            29 => sample.outputs[0] += 20.0 * JET_NOISE[0],
            37 => sample.outputs[1] -= 20.0 * JET_NOISE[1],
            _ => {}
        }
    }
    // A second is lost.
    record.drain(900..1000);
    let mut last = None;
    for (k, sample) in record.iter().enumerate() {
        if k % 100 == 40 {
            let before = last.unwrap();
            for time_s in [sample.time_s - 1.0, f64::NAN] {
                let refused: Estimate<P> = estimator.update(&Sample { time_s, ..*sample });
                assert_eq!(refused.status.phase, Phase::Rejected);
                assert_eq!(refused.parameters, before);
            }
        }
        let estimate = estimator.update(sample);
        assert!(estimate.parameters.iter().all(|v| v.is_finite()), "{k}");
        last = Some(estimate.parameters);
    }
    let estimate = estimator.update(&Sample { time_s: 20.01, input: [0.0], outputs: [f64::NAN; 3] });
    println!("{:?}", estimate.parameters);
    if bounds {
        assert!(worst(&estimate, &TRUTH) < 0.2, "{:?}", estimate.parameters);
        assert!(estimate.corrected_std_error.iter().all(|std| std.is_finite() && *std > 0.0));
        assert!(estimate.parameter_status.iter().all(|s| *s != ParameterStatus::NotExcited));
        assert!(estimator.restarts() > 0);
    }
    assert_eq!(estimator.column_count(), P);
}

#[test]
fn bad_records_are_survived() {
    mistreat(&mut rls(settings()), true);
    mistreat(&mut fourier(FourierSettings::default()), true);
    mistreat(&mut ImplicitSign::new(rows(), 2.0).unwrap(), true);
    mistreat(&mut SuperTwisting::new(rows()), false);
    mistreat(&mut AdaptiveModel::new(JET, &common()).unwrap(), false);
}

#[test]
fn outliers_cost_little_with_the_gate_and_much_without() {
    let mut record = flight(15.0, 1.0, 11, elevator_3211);
    let mut rng = seeded(77);
    for sample in &mut record {
        for (y, std) in sample.outputs.iter_mut().zip(JET_NOISE) {
            if plants::normal(&mut rng).abs() > 1.96 {
                *y += 20.0 * std * plants::normal(&mut rng).signum();
            }
        }
    }
    let clean = worst(&run(&mut rls(settings()), &flight(15.0, 1.0, 11, elevator_3211)), &TRUTH);
    let gated = worst(&run(&mut rls(settings()), &record), &TRUTH);
    let open =
        worst(&run(&mut rls(RegressionSettings { outlier_limit: f64::INFINITY, ..settings() }), &record), &TRUTH);
    println!("clean {clean}, gated {gated}, open {open}");
    assert!(gated < 3.0 * clean.max(0.01) && open > 2.0 * gated, "clean {clean}, gated {gated}, open {open}");
}

#[test]
fn impossible_settings_are_refused() {
    let refused = |settings| with(settings, FourierSettings::default()).err().unwrap().to_string();
    assert!(refused(RegressionSettings { filter_rate: 0.0, ..settings() }).contains("filter_rate"));
    assert!(refused(RegressionSettings { forgetting_per_s: -1.0, ..settings() }).contains("forgetting_per_s"));
    assert!(refused(RegressionSettings { outlier_limit: f64::NAN, ..settings() }).contains("outlier_limit"));
    let fourier =
        |settings| FourierRegression::new(with(self::settings(), settings).unwrap()).err().unwrap().to_string();
    assert!(fourier(FourierSettings { bins: 0, ..FourierSettings::default() }).contains("bins"));
    assert!(fourier(FourierSettings { band_hz: [0.1, 60.0], ..FourierSettings::default() }).contains("band_hz"));
}
