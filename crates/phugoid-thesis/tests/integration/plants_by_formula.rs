//! What is simulated of the plants, the bound on it and the loop gain, against what can be written down.
//!
//! These tests stand here and not beside the code because a program of unit tests would compile every method for every plant once
//! more.

use phugoid_thesis::laws::{Evaluation, LawSign, ThesisForm};
use phugoid_thesis::plant_case::{Method, Noise, bound, published_case, run_method, simulate, slopes};

/// The bound is a standard deviation: ten times the power makes it the square root of ten times as large. More data make
/// it smaller.
#[test]
fn the_bound_grows_with_the_noise_and_shrinks_with_the_record() {
    let mut case = published_case("noise/3").unwrap();
    let quiet = bound(&case, &simulate(&case).unwrap(), &[0.5, 2.0]).unwrap();
    case.noise = case.noise.map(|noise| Noise { power: 10.0 * noise.power });
    let loud = bound(&case, &simulate(&case).unwrap(), &[0.5, 2.0]).unwrap();
    for j in 0..2 {
        assert!((loud[1].std_error[j] / quiet[1].std_error[j] - 10.0_f64.sqrt()).abs() < 1e-9);
        assert!(quiet[1].std_error[j] < quiet[0].std_error[j]);
    }
    case.noise = None;
    let message = bound(&case, &simulate(&case).unwrap(), &[1.0]).unwrap_err().to_string();
    assert!(message.contains("without noise"), "{message}");
}

/// `|z|/eta` is what decides a delayed loop: with an eta above every `|z|` the same law on the same samples stays near the
/// truth from where it starts, with a tenth of it it leaves every bound.
#[test]
fn the_loop_gain_tells_where_the_delay_may_be() {
    let mut case = published_case("first-order/1").unwrap();
    case.parameters.get_mut("a").unwrap().start = 3.01;
    let run = simulate(&case).unwrap();
    let largest = slopes(&case, &run)[0].iter().fold(0.0, |a: f64, z| a.max(z.abs()));
    // z = -x^2, and x ends at 1/3.
    assert!((largest - 1.0 / 9.0).abs() < 1e-4, "{largest}");
    let farthest = |eta: f64| {
        let method = Method::OneParameter {
            form: ThesisForm::Damped,
            evaluation: Evaluation::Delayed,
            sign: LawSign::FromSlope,
            lambda: 10.0,
            eta,
        };
        let result = run_method(&case, &run, &method).unwrap();
        result.estimates[0]
            .iter()
            .fold(0.0, |a: f64, v| if v.is_finite() { a.max((v - 3.0).abs()) } else { f64::INFINITY })
    };
    println!("{} {}", farthest(2.0 * largest), farthest(0.1 * largest));
    assert!(farthest(2.0 * largest) < 0.1);
    assert!(farthest(0.1 * largest) > 1.0);
}

/// `x' = -a x + u` from rest: `x = u/a (1 - exp(-a t))`, and `x'` with it.
#[test]
fn the_linear_plant_follows_its_closed_form() {
    let run = simulate(&published_case("first-order/1").unwrap()).unwrap();
    for (k, t) in run.time_s.iter().enumerate() {
        let expected = (1.0 - (-3.0 * t).exp()) / 3.0;
        assert!((run.states[0][k] - expected).abs() < 1e-12, "{t}");
        assert!((run.outputs[1][k] - (-3.0 * t).exp()).abs() < 1e-11, "{t}");
    }
}

/// Band-limited white noise: variance `power / sample_time`, white, on the states and not on the derivative.
#[test]
fn the_noise_has_the_power_asked_for() {
    let mut case = published_case("noise/1").unwrap();
    case.noise = Some(Noise { power: 4e-7 });
    let run = simulate(&case).unwrap();
    assert!((run.noise_std - 0.02).abs() < 1e-15);
    for i in 0..2 {
        let noise: Vec<f64> = run.outputs[i].iter().zip(&run.states[i]).map(|(y, x)| y - x).collect();
        let n = noise.len() as f64;
        let variance = noise.iter().map(|v| v * v).sum::<f64>() / n;
        let lag_one = noise.windows(2).map(|w| w[0] * w[1]).sum::<f64>() / n;
        // 4001 samples: standard errors of 2.2 % of the variance and 1.6 % of it for the lag; four of each.
        assert!((variance / 4e-4 - 1.0).abs() < 0.09, "{variance}");
        assert!((lag_one / 4e-4).abs() < 0.064, "{lag_one}");
    }
    case.noise = None;
    let exact = simulate(&case).unwrap();
    assert_eq!(exact.outputs[2], run.outputs[2]);
    assert_eq!(exact.outputs[0], exact.states[0]);
}
