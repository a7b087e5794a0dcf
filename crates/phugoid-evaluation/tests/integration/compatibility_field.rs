//! Data compatibility on the field: does it converge, does it find errors that were put in, does it leave healthy records
//! alone, and do its corrections help?
//!
//! The studies read the field that `scripts/field/make.py` makes, so that they are run by hand:
//!
//! ```sh
//! PHUGOID_FIELD=target/field cargo test --release -p phugoid-evaluation --test integration -- \
//!     --ignored --nocapture compatibility_field
//! ```
//!
//! `PHUGOID_FIELD_SPLIT=look-once` takes the other part.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::time::Instant;

use phugoid_evaluation::field::truth::{Kind, Split, Truth, find};
use phugoid_evaluation::monte_carlo::monte_carlo;
use phugoid_flight_data::record::Record;
use phugoid_identification::compatibility::{
    Compatibility, CompatibilityOptions, Corrections, SensorVerdict, compatibility, estimate_corrected,
};
use phugoid_identification::estimate::EstimateOptions;
use phugoid_identification::estimation::EstimationStatus;
use phugoid_identification::method::Method;
use phugoid_identification::model_file::ModelFile;
use rand::{RngExt, SeedableRng};
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64Mcg;

/// A flight of the field, its first thirty seconds.
struct Flight {
    /// Seed of the errors that are put in.
    seed: u64,
    truth: Truth,
    model: ModelFile,
    record: Record,
}

fn flights() -> Vec<Flight> {
    let folder = PathBuf::from(std::env::var("PHUGOID_FIELD").unwrap());
    let split = match std::env::var("PHUGOID_FIELD_SPLIT").as_deref() {
        Ok("look-once") => Split::LookOnce,
        _ => Split::Develop,
    };
    find(&folder, split)
        .unwrap()
        .into_iter()
        .map(|truth| {
            let model = ModelFile::find(&truth.folder.join(&truth.model).to_string_lossy()).unwrap();
            let record = model.open_record(truth.folder.join(&truth.record)).unwrap();
            let start = record.time[0];
            let record = record.between(start, start + 30.0).unwrap();
            Flight { seed: 0, truth, model, record }
        })
        .collect()
}

/// The flights of a study with their seeds; `PHUGOID_FIELD_ONLY` takes some of them, with the same errors as among all.
fn chosen(wanted: impl Fn(&Flight) -> bool) -> Vec<Flight> {
    let only = std::env::var("PHUGOID_FIELD_ONLY").unwrap_or_default();
    let seeded = flights().into_iter().filter(wanted).zip(1000..).map(|(flight, seed)| Flight { seed, ..flight });
    seeded.filter(|flight| name(&flight.truth).contains(&only)).collect()
}

fn name(truth: &Truth) -> String {
    format!("{}/{}", truth.aircraft, truth.flight)
}

/// How often something happened, by kind.
#[derive(Default)]
struct Counts(BTreeMap<String, [usize; 3]>);

impl Counts {
    fn add(&mut self, kind: &str, counted: usize, happened: usize, further: usize) {
        let entry = self.0.entry(kind.to_owned()).or_default();
        entry[0] += counted;
        entry[1] += happened;
        entry[2] += further;
    }

    fn total(&self) -> [usize; 3] {
        self.0.values().fold([0; 3], |sum, v| [sum[0] + v[0], sum[1] + v[1], sum[2] + v[2]])
    }

    fn print(&self, title: &str, words: [&str; 3]) {
        println!("{title}: {}, {}, {}", words[0], words[1], words[2]);
        for (kind, [a, b, c]) in self.0.iter().chain([(&"all".to_owned(), &self.total())]) {
            let part = |x: &usize| 100.0 * *x as f64 / (*a).max(1) as f64;
            println!("  {kind:28} {a:5} {b:5} ({:5.1} %) {c:5} ({:5.1} %)", part(b), part(c));
        }
    }
}

/// Healthy flights: convergence, time, and what is found although it is not there.
#[test]
#[ignore = "needs the field"]
fn healthy_records_are_left_alone() {
    let flights = chosen(|_| true);
    let run = |k: usize| {
        let begin = Instant::now();
        let result = compatibility(&flights[k].record, &CompatibilityOptions::default());
        Ok::<_, std::convert::Infallible>((result, begin.elapsed().as_secs_f64()))
    };
    let results = monte_carlo(flights.len(), run, || ()).unwrap_or_else(|never| match never {});
    let (mut failed, mut slow, mut slowest) = (0, 0, 0.0_f64);
    let mut by_group = Counts::default();
    let mut by_unknown = Counts::default();
    for (flight, (result, seconds)) in flights.iter().zip(&results) {
        slowest = slowest.max(*seconds);
        slow += usize::from(*seconds > 2.0);
        let found = match result {
            Ok(found) => found,
            Err(error) => {
                failed += 1;
                println!("{}: {error}", name(&flight.truth));
                continue;
            }
        };
        if flight.truth.kind != Kind::Sound {
            continue;
        }
        for e in &found.errors {
            let significant = e.verdict == SensorVerdict::Significant;
            by_group.add(&flight.truth.group, 1, usize::from(significant), usize::from(e.offered));
            by_unknown.add(&e.name, 1, usize::from(significant), usize::from(e.offered));
            if significant && std::env::var("PHUGOID_FIELD_VERBOSE").is_ok() {
                println!(
                    "{}: {} {:.3e} +- {:.1e} ({:.1}), gain {:.1}{}",
                    name(&flight.truth),
                    e.name,
                    e.value,
                    e.std_error,
                    e.significance,
                    e.held_out_gain,
                    if e.offered { " OFFERED" } else { "" }
                );
            }
        }
    }
    let words = ["unknowns", "called significant", "offered as corrections"];
    by_group.print("By group", words);
    by_unknown.print("By unknown", words);
    let mut times: Vec<f64> = results.iter().map(|(_, s)| *s).collect();
    times.sort_by(f64::total_cmp);
    println!(
        "{} flights: {failed} failed; median {:.2} s, slowest {slowest:.2} s, {slow} beyond 2 s",
        flights.len(),
        times[times.len() / 2]
    );
    assert!(failed * 100 <= flights.len(), "{failed} of {}", flights.len());
}

/// Errors put into a record, by the name of the unknown.
fn spoil(record: &mut Record, random: &mut Pcg64Mcg, only: Option<&str>) -> Vec<(String, f64)> {
    const DEGREE: f64 = std::f64::consts::PI / 180.0;
    let mut errors = Vec::new();
    let mut normal = |std: f64| -> f64 {
        let z: f64 = StandardNormal.sample(random);
        std * z
    };
    let biases = [
        ("ax", 0.1),
        ("ay", 0.1),
        ("az", 0.1),
        ("p", 0.1 * DEGREE),
        ("q", 0.1 * DEGREE),
        ("r", 0.1 * DEGREE),
        ("true_airspeed", 1.0),
        ("alpha", 0.5 * DEGREE),
        ("beta", 0.5 * DEGREE),
        ("phi", 0.3 * DEGREE),
        ("theta", 0.3 * DEGREE),
    ];
    for (channel, std) in biases {
        errors.push((format!("bias_{channel}"), normal(std)));
    }
    for channel in ["true_airspeed", "alpha", "beta", "phi", "theta"] {
        errors.push((format!("scale_{channel}"), if random.random::<bool>() { 0.03 } else { -0.03 }));
    }
    for channel in ["true_airspeed", "alpha", "beta", "attitude"] {
        errors.push((format!("delay_{channel}"), random.random_range(0.01..0.04)));
    }
    if let Some(only) = only {
        errors.retain(|(n, _)| n == only);
    }
    let value = |name: String| errors.iter().find(|(n, _)| *n == name).map_or(0.0, |(_, v)| *v);
    let time = record.time.clone();
    for channel in &mut record.channels {
        let name = channel.name.clone();
        let delay = match name.as_str() {
            "phi" | "theta" => value("delay_attitude".to_owned()),
            _ => value(format!("delay_{name}")),
        };
        let (scale, bias) = (value(format!("scale_{name}")), value(format!("bias_{name}")));
        if delay != 0.0 {
            channel.values = delayed(&time, &channel.values, delay);
        }
        channel.values.iter_mut().for_each(|v| *v = (1.0 + scale) * *v + bias);
    }
    errors
}

/// The signal a time earlier, on straight lines between samples; the first values stay.
fn delayed(time: &[f64], values: &[f64], delay: f64) -> Vec<f64> {
    (0..time.len())
        .map(|k| {
            let wanted = time[k] - delay;
            let after = time.partition_point(|t| *t < wanted);
            let Some(before) = after.checked_sub(1) else { return values[k] };
            // Across a gap there is nothing to interpolate.
            if time[after] - time[before] > 0.1 {
                return f64::NAN;
            }
            let part = (wanted - time[before]) / (time[after] - time[before]);
            values[before] + part * (values[after] - values[before])
        })
        .collect()
}

/// Errors of all sensors at once, and one at a time: within two sigma, and called significant.
#[test]
#[ignore = "needs the field"]
fn errors_put_in_are_found() {
    let flights = chosen(|f| f.truth.kind == Kind::Sound);
    let run = |k: usize| {
        let mut random = Pcg64Mcg::seed_from_u64(flights[k].seed);
        let mut record = flights[k].record.clone();
        let errors = spoil(&mut record, &mut random, None);
        Ok::<_, std::convert::Infallible>((errors, compatibility(&record, &CompatibilityOptions::default())))
    };
    let results = monte_carlo(flights.len(), run, || ()).unwrap_or_else(|never| match never {});
    report(&flights, &results);
}

type Spoilt = (Vec<(String, f64)>, Result<Compatibility, phugoid_identification::error::EstimateError>);

fn report(flights: &[Flight], results: &[Spoilt]) {
    let (mut by_group, mut by_unknown) = (Counts::default(), Counts::default());
    let (mut failed, mut refused) = (0, 0);
    for (flight, (errors, result)) in flights.iter().zip(results) {
        let found = match result {
            Ok(found) => found,
            Err(error) => {
                failed += 1;
                println!("{}: {error}", name(&flight.truth));
                continue;
            }
        };
        for e in &found.errors {
            // A refusal claims nothing.
            if e.verdict == SensorVerdict::Refused {
                refused += 1;
                println!("{}: {} refused: {:?}", name(&flight.truth), e.name, e.reason);
                continue;
            }
            // Position and wind are not spoilt.
            let Some((_, truth)) = errors.iter().find(|(n, _)| *n == e.name) else { continue };
            let within = (e.value - truth).abs() <= 2.0 * e.std_error;
            let significant = e.verdict == SensorVerdict::Significant;
            by_group.add(&flight.truth.group, 1, usize::from(within), usize::from(significant));
            by_unknown.add(&e.name, 1, usize::from(within), usize::from(significant));
            if !within && std::env::var("PHUGOID_FIELD_VERBOSE").is_ok() {
                println!(
                    "{}: {} {:.3e} +- {:.1e}, truth {truth:.3e} ({:+.1})",
                    name(&flight.truth),
                    e.name,
                    e.value,
                    e.std_error,
                    (e.value - truth) / e.std_error,
                );
            }
        }
    }
    let words = ["errors put in", "within two sigma", "called significant"];
    by_group.print("By group", words);
    by_unknown.print("By unknown", words);
    println!("{failed} of {} flights failed; {refused} unknowns refused", flights.len());
    let [counted, within, _] = by_group.total();
    assert!(failed * 100 <= flights.len(), "{failed} of {}", flights.len());
    // Two sigma of normal errors are 95 %.
    assert!(within * 100 >= 93 * counted, "{within} of {counted}");
}

/// The method that estimates: `PHUGOID_FIELD_METHOD`, or equation error.
fn method() -> Method {
    std::env::var("PHUGOID_FIELD_METHOD").map_or(Method::EquationError, |name| name.parse().unwrap())
}

/// Median relative error of the derivatives that count, how many of them lie within two claimed sigmas, and what the
/// result says of itself.
fn estimated(
    flight: &Flight,
    record: &Record,
    corrections: &Corrections,
) -> Result<(f64, [usize; 2], EstimationStatus), phugoid_identification::error::EstimateError> {
    let options = EstimateOptions { method: Some(method()), ..EstimateOptions::default() };
    let estimation = estimate_corrected(record, corrections, &flight.model, &options, &mut |_| ())?;
    let mut errors = Vec::new();
    let mut covered = [0; 2];
    for (name, truth) in flight.truth.truth.parameters.iter().filter(|(_, p)| p.counts()) {
        let Some(found) = estimation.parameter(name) else { continue };
        let error = (found.value - truth.value).abs();
        errors.push(error / truth.value.abs());
        covered[0] += 1;
        covered[1] += usize::from(error <= 2.0 * found.corrected_std_error);
    }
    errors.sort_by(f64::total_cmp);
    Ok((errors.get(errors.len() / 2).copied().unwrap_or(f64::NAN), covered, estimation.status))
}

/// A batch method on healthy flights and on flights with errors of all sensors, with the offered corrections and without.
#[test]
#[ignore = "needs the field"]
fn corrections_do_not_worsen_an_estimate() {
    // Damage changes the aircraft within the thirty seconds: no estimate of one set of parameters is right then.
    let flights = chosen(|f| f.truth.kind == Kind::Sound && f.truth.is_healthy());
    for spoilt in [false, true] {
        let run = |k: usize| {
            let mut record = flights[k].record.clone();
            if spoilt {
                spoil(&mut record, &mut Pcg64Mcg::seed_from_u64(flights[k].seed), None);
            }
            let Ok(found) = compatibility(&record, &CompatibilityOptions::default()) else { return Ok(None) };
            let none = Corrections::default();
            let before = estimated(&flights[k], &record, &none);
            let after = estimated(&flights[k], &record, &found.corrections);
            let count = found.errors.iter().filter(|e| e.offered).count();
            Ok::<_, std::convert::Infallible>(before.ok().zip(after.ok()).map(|pair| (count, pair)))
        };
        let results = monte_carlo(flights.len(), run, || ()).unwrap_or_else(|never| match never {});
        let (mut corrected, mut better, mut worse) = (0, 0, 0);
        let (mut before_all, mut after_all, mut covered) = (Vec::new(), Vec::new(), [[0; 2]; 2]);
        for (flight, result) in flights.iter().zip(&results) {
            let Some((count, ((before, cb, was), (after, ca, is)))) = result else { continue };
            for i in 0..2 {
                covered[0][i] += cb[i];
                covered[1][i] += ca[i];
            }
            if before.is_nan() {
                continue;
            }
            before_all.push(*before);
            after_all.push(*after);
            corrected += usize::from(*count > 0);
            better += usize::from(*after < before - 0.001);
            worse += usize::from(*after > before + 0.001);
            if *after > before + 0.01 {
                println!(
                    "{}: {before:.4} -> {after:.4}, covered {} of {} -> {}, {was:?} -> {is:?} with {count} corrections",
                    name(&flight.truth),
                    cb[1],
                    cb[0],
                    ca[1],
                );
            }
        }
        before_all.sort_by(f64::total_cmp);
        after_all.sort_by(f64::total_cmp);
        let at = |v: &[f64], part: f64| v[((v.len() - 1) as f64 * part) as usize];
        println!(
            "{}: {} flights, {corrected} corrected, {better} better and {worse} worse by more than 0.1 points; \
             error {:.4} -> {:.4} (median), {:.4} -> {:.4} (90 %); covered {:.1} -> {:.1} %",
            if spoilt { "errors put in" } else { "healthy" },
            before_all.len(),
            at(&before_all, 0.5),
            at(&after_all, 0.5),
            at(&before_all, 0.9),
            at(&after_all, 0.9),
            100.0 * covered[0][1] as f64 / covered[0][0] as f64,
            100.0 * covered[1][1] as f64 / covered[1][0] as f64,
        );
        assert!(
            if spoilt { worse < better } else { worse * 100 <= before_all.len() },
            "{worse} worse, {better} better"
        );
    }
}
