//! The declared part of a bound, followed through the estimation, against the powers of the scales and against runs over
//! flights in which a scale really is wrong.

use std::path::{Path, PathBuf};

use phugoid_evaluation::field::truth::{Split, Truth, find};
use phugoid_evaluation::field::{FieldOptions, run_drawn};
use phugoid_flight_data::record::Record;
use phugoid_identification::estimate::{EstimateOptions, estimate};
use phugoid_identification::estimation::Estimation;
use phugoid_identification::method::Method;
use phugoid_identification::model_file::{ModelFile, Propagation, Uncertainty};
use phugoid_identification::options::Likelihood;

fn flights() -> Vec<(Truth, ModelFile, Record)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/field");
    let flights = find(&folder, Split::Develop).unwrap().into_iter().filter(Truth::is_healthy);
    flights
        .map(|truth| {
            let model = ModelFile::find(&truth.folder.join(&truth.model).to_string_lossy()).unwrap();
            let record = model.open_record(truth.folder.join(&truth.record)).unwrap();
            (truth, model, record)
        })
        .collect()
}

fn run(model: &ModelFile, record: &Record, method: Method) -> Estimation {
    let options = EstimateOptions { method: Some(method), ..EstimateOptions::default() };
    estimate(record, model, &options, &mut |_| {}).unwrap()
}

const SIGMA: f64 = 0.01;

fn declared(scale: &str, propagation: Propagation) -> Uncertainty {
    let none = Uncertainty { propagation, ..Uncertainty::NONE };
    match scale {
        "airspeed" => Uncertainty { airspeed_scale: SIGMA, ..none },
        "flow angles" => Uncertainty { flow_angle_scale: SIGMA, ..none },
        "surfaces" => Uncertainty { surface_scale: SIGMA, ..none },
        "mass" => Uncertainty { mass: SIGMA, ..none },
        _ => Uncertainty { inertia: SIGMA, ..none },
    }
}

/// A filter that has settled, on a motion that the derivative makes by itself, does with a scale what the powers say.
/// Where it does not the powers are wrong, and the test after this one says so: they take the angle of attack of the vane
/// for the one that a derivative stands beside, and the filter has accelerometers and gyros as well, which say otherwise.
#[test]
fn followed_scales_agree_with_their_powers_where_the_derivative_alone_takes_them_up() {
    let mut compared = 0;
    for (truth, mut model, record) in flights() {
        for scale in ["airspeed", "flow angles", "surfaces", "mass", "inertia"] {
            let [followed, powers] = [Propagation::Recursion, Propagation::Powers].map(|propagation| {
                model.uncertainty = declared(scale, propagation);
                run(&model, &record, Method::Smpe)
            });
            for (a, b) in followed.parameters.iter().zip(&powers.parameters) {
                assert_eq!((a.value, a.std_error), (b.value, b.std_error));
                if !truth.at_end().get(&a.name).is_some_and(|p| p.counts()) {
                    continue;
                }
                let [part, power] = [a.systematic_std, b.systematic_std].map(|std| std / (SIGMA * a.value.abs()));
                println!("{} {scale} {}: {part:.3} and {power:.3}", truth.flight, a.name);
                compared += 1;
            }
        }
    }
    assert!(compared > 50, "{compared}");
}

/// What `phugoid field FOLDER --drawn-errors N --ranked M --method METHOD` does, for the sizes and the method of the
/// environment.
#[test]
#[ignore = "needs the field"]
fn drawn_errors_on_the_field() {
    let asked = |name: &str, usual: &str| std::env::var(name).unwrap_or_else(|_| usual.to_owned());
    let folder = PathBuf::from(std::env::var("PHUGOID_FIELD").unwrap());
    let split = if asked("PHUGOID_FIELD_SPLIT", "") == "look-once" { Split::LookOnce } else { Split::Develop };
    let method: Method = asked("PHUGOID_FIELD_METHOD", "smpe").parse().unwrap();
    let only: Vec<String> = std::env::var("PHUGOID_FIELD_ONLY").into_iter().collect();
    let options =
        FieldOptions { split, methods: vec![method], only, faults: 0, monitor: false, likelihood: Likelihood::Robust };
    let [per_row, ranked] = [("PHUGOID_FIELD_ROW", "10"), ("PHUGOID_FIELD_RANKED", "0")]
        .map(|(name, usual)| asked(name, usual).parse().unwrap());
    let study = run_drawn(&folder, &options, per_row, ranked, &|_| {}).unwrap();
    println!("method {method}");
    for s in &study.summaries {
        println!(
            "{:24} {:9} flights {:3} parameters {:4} covered {:.1} % claimed/actual {:.2} width {:.1} %",
            format!("{:?}", s.draw),
            format!("{:?}", s.budget),
            s.flights,
            s.parameters,
            100.0 * s.covered,
            s.claimed_over_actual,
            100.0 * s.width
        );
    }
    println!("{:?}", study.ranking);
    if let Ok(path) = std::env::var("PHUGOID_FIELD_OUT") {
        std::fs::write(path, serde_json::to_string(&study).unwrap()).unwrap();
    }
}
