//! What records of real flights have and simulated ones have not: gaps, outliers, clock times, noise on every state. Each
//! test shows first what goes wrong where a batch method does not allow for it.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)] // tests and benches may

use phugoid_identification::batch::{
    BatchError, BatchFit, EquationErrorSettings, Manoeuvre, Noise, OptimiserSettings, ProcessNoise, Structure,
    equation_error, filter_error, output_error,
};
use phugoid_identification::options::Likelihood;

use crate::batch::{Data, SD, STABLE, STEP_S, fly, manoeuvre, structure, white};

fn estimated(_: usize) -> Noise {
    Noise::Estimated
}

/// Output error, or filter error with the small process noise of nearly calm air.
fn try_fit(method: &str, data: &Data, structure: &Structure<2, 3>) -> Result<BatchFit, BatchError> {
    let m: Manoeuvre<'_, 2, 3> = manoeuvre("flight", data);
    let settings = OptimiserSettings::default();
    match method {
        "output error" => output_error(&[m], structure, &settings),
        _ => {
            let process = ProcessNoise { density: [1e-6, 1e-8], estimated: true };
            filter_error(&[m], structure, &process, &settings)
        }
    }
}

fn fit(method: &str, data: &Data, structure: &Structure<2, 3>) -> BatchFit {
    try_fit(method, data, structure).unwrap_or_else(|error| panic!("{method}: {error}"))
}

/// The largest error of a parameter in standard errors.
fn furthest(fit: &BatchFit) -> f64 {
    let errors = fit.unknowns.iter().take(6).zip(STABLE).map(|(u, truth)| ((u.value - truth) / u.std_error).abs());
    errors.fold(0.0, f64::max)
}

/// Two doublets; between them 30 s, in which the aircraft was flown, are lost.
fn torn() -> Data {
    let [mut first, second] = [fly(250, 0.5, white(21)), fly(250, 1.0, white(22))];
    let begin = first.time[249] + 30.0;
    first.time.extend(second.time.iter().map(|t| begin + t));
    first.inputs.extend(second.inputs);
    first.outputs.extend(second.outputs);
    first
}

#[test]
fn a_gap_is_not_integrated_through() {
    let data = torn();
    for method in ["output error", "filter error"] {
        let anew = fit(method, &data, &Structure { maximum_gap_s: 0.5, ..structure(STABLE, estimated) });
        assert!(furthest(&anew) < 3.0, "{method}: {:?}", anew.parameters);
        for (i, std) in SD.iter().enumerate() {
            assert!((anew.noise_std[i] / std - 1.0).abs() < 0.15, "{method}: {:?}", anew.noise_std);
        }
    }
    // An initial state of its own, named by the time at which it holds.
    let anew = fit("output error", &data, &Structure { maximum_gap_s: 0.5, ..structure(STABLE, estimated) });
    let begin = data.time[250];
    let start = anew.unknown(&format!("initial w after the gap to {begin:.2} s")).expect("a start after the gap");
    assert!((start.value - 0.4).abs() < 3.0 * start.std_error, "{start:?}");
    // Integrated through, output error loses itself, or takes the lost motion for noise.
    match try_fit("output error", &data, &structure(STABLE, estimated)) {
        Err(error) => println!("through the gap: {error}"),
        Ok(through) => assert!(through.noise_std[0] > 2.0 * SD[0], "{:?}", through.noise_std),
    }
}

#[test]
fn half_a_percent_of_outliers_does_not_decide() {
    // Thirty sigmas, in one value of two hundred, of both signs.
    let spoil = |mut data: Data| {
        for (k, y) in data.outputs.iter_mut().enumerate() {
            for (i, value) in y.iter_mut().enumerate() {
                if (k * 3 + i) % 200 == 77 {
                    *value += 30.0 * SD[i] * if k % 2 == 0 { 1.0 } else { -1.0 };
                }
            }
        }
        data
    };
    for method in ["output error", "filter error"] {
        for seed in 31..34 {
            let clean = fit(method, &fly(500, 0.5, white(seed)), &structure(STABLE, estimated));
            let data = spoil(fly(500, 0.5, white(seed)));
            let plain = fit(method, &data, &structure(STABLE, estimated));
            let robust =
                fit(method, &data, &Structure { likelihood: Likelihood::Robust, ..structure(STABLE, estimated) });
            let widest = |fit: &BatchFit| {
                let wider = fit.unknowns.iter().zip(&clean.unknowns).take(6).map(|(a, b)| a.std_error / b.std_error);
                wider.fold(0.0, f64::max)
            };
            println!(
                "{method}, {seed}: {:.1} standard errors, {:.2} times as wide as without outliers; Gaussian {:.1}, {:.2}",
                furthest(&robust),
                widest(&robust),
                furthest(&plain),
                widest(&plain)
            );
            assert!(furthest(&robust) < 3.5 && widest(&robust) < 1.1, "{method}: {:?}", robust.parameters);
            assert!(widest(&plain) > 1.5, "{method}: the outliers do not count at all");
        }
    }
}

#[test]
fn clean_noise_loses_nothing_by_robustness() {
    let data = fly(500, 0.5, white(41));
    let plain = fit("output error", &data, &structure(STABLE, estimated));
    let robust =
        fit("output error", &data, &Structure { likelihood: Likelihood::Robust, ..structure(STABLE, estimated) });
    for (a, b) in plain.unknowns.iter().zip(&robust.unknowns) {
        assert!((a.value - b.value).abs() < 0.3 * a.std_error, "{}: {} {}", a.name, a.value, b.value);
        assert!((a.std_error / b.std_error - 1.0).abs() < 0.03, "{}: {} {}", a.name, a.std_error, b.std_error);
    }
}

/// Seconds since 1970 leave a quarter of a microsecond between two numbers, which moves no estimate visibly.
#[test]
fn the_origin_of_time_does_not_move_the_optimum() {
    let data = fly(500, 0.5, white(51));
    let mut since_1970 = fly(500, 0.5, white(51));
    since_1970.time.iter_mut().for_each(|t| *t += 1.7e9);
    for method in ["output error", "filter error"] {
        let [a, b] = [&data, &since_1970].map(|data| fit(method, data, &structure(STABLE, estimated)));
        for (a, b) in a.unknowns.iter().zip(&b.unknowns).take(6) {
            assert!((a.value - b.value).abs() < 0.02 * a.std_error, "{method}, {}: {} {}", a.name, a.value, b.value);
        }
    }
}

/// The windows of the differentiation are 0.4 s long, a large part of this motion's period of a second: what they round
/// off on one side of an equation they round off on the other.
#[test]
fn the_windows_of_equation_error_do_not_bias_a_quick_aircraft() {
    let settings = EquationErrorSettings::automatic(STEP_S);
    // An elevator that moves evenly between samples, as the integration of the right side takes it to.
    let data = fly(500, 0.5, |_| 0.0);
    let found = equation_error::<2, 3>(&[manoeuvre("exact", &data)], &structure([0.0; 6], estimated), &settings);
    let found = found.unwrap().fit;
    for (j, truth) in STABLE.iter().enumerate() {
        let error = found.parameters[j] / truth - 1.0;
        println!("relative error {error:+.4}");
        assert!(error.abs() < 0.01, "{}: {error}", found.unknowns[j].name);
    }
}
