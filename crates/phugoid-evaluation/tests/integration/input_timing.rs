//! Whether surfaces were held between samples, ran straight, or were stamped late, is found from flights of another
//! simulator. The recorder of the field samples positions, so that straight lines are the truth there; a position that
//! is stamped half a sample late and then held is the same to the aircraft, so that held commands are made of positions
//! of half a sample later.

use std::path::Path;

use phugoid_evaluation::field::truth::{Split, Truth, find};
use phugoid_flight_data::record::Record;
use phugoid_identification::estimate::{EstimateOptions, estimate};
use phugoid_identification::estimation::{ReasonCode, UncertainQuantity};
use phugoid_identification::lateral::LateralModel;
use phugoid_identification::longitudinal::LongitudinalModel;
use phugoid_identification::model_file::{InputHold, ModelFile};
use phugoid_identification::parts::for_parts;
use phugoid_identification::prepare::prepare;
use phugoid_identification::six::SixModel;
use phugoid_simulation::flight::{fly, sense};
use phugoid_simulation::scenario::Scenario;

const SURFACES: [&str; 3] = ["elevator", "aileron", "rudder"];

/// A delay is found rightly if it is within so many samples, or so many seconds, of the truth: C_m_q changes by five per
/// cent with 5 ms (docs/theory.md).
const NEAR_SAMPLES: f64 = 0.3;
const NEAR_S: f64 = 0.005;

/// What was found of a flight: how the surfaces move, and which of them was stamped late, s.
type Found = (InputHold, Vec<(String, f64)>);

/// What was found, whether it is certain, and the sentence that says so.
fn decide(record: &Record, file: &ModelFile, lateral: bool) -> Option<(Found, bool, String)> {
    let (hold, moved, notes) = if lateral {
        let prepared = prepare::<LateralModel, _, _>(record, file).ok()?;
        (prepared.hold, prepared.moved_s, prepared.notes)
    } else {
        let prepared = prepare::<LongitudinalModel, _, _>(record, file).ok()?;
        (prepared.hold, prepared.moved_s, prepared.notes)
    };
    let note = notes.into_iter().find(|note| note.starts_with("`input`"))?;
    Some(((hold, moved), !note.contains("a part of the timing of surfaces"), note))
}

/// The record with its surfaces stamped so much later, s.
pub(crate) fn stamped_late(record: &Record, by_s: f64) -> Record {
    let mut late = record.clone();
    for channel in late.channels.iter_mut().filter(|c| SURFACES.contains(&c.name.as_str())) {
        let of = channel.values.clone();
        channel.values = record
            .time
            .iter()
            .map(|t| {
                let wanted = t - by_s;
                let after = record.time.partition_point(|s| *s < wanted).clamp(1, record.time.len() - 1);
                let (from, to) = (record.time[after - 1], record.time[after]);
                let part = ((wanted - from) / (to - from)).clamp(0.0, 1.0);
                of[after - 1] + part * (of[after] - of[after - 1])
            })
            .collect();
    }
    late
}

#[derive(Default, Debug, Clone, Copy)]
struct Count {
    right: usize,
    wrong: usize,
    /// Not certain, and right or wrong.
    open_right: usize,
    open_wrong: usize,
}

fn study(flights: &[Truth], show: bool) -> [(&'static str, Count); 4] {
    let mut counts = [
        ("straight", Count::default()),
        ("held", Count::default()),
        ("20 ms late", Count::default()),
        ("20 ms early", Count::default()),
    ];
    for truth in flights {
        let path = |name: &str| truth.folder.join(name);
        let mut file = ModelFile::find(&path(&truth.model).to_string_lossy()).unwrap();
        file.input = InputHold::Auto;
        let Ok(record) = file.open_record(path(&truth.record)) else { continue };
        let step = record.sample_time_s();
        for (case, late_s) in [0.0, -0.5 * step, 0.02, -0.02].into_iter().enumerate() {
            let stamped = if late_s == 0.0 { record.clone() } else { stamped_late(&record, late_s) };
            let Some(((hold, moved), decided, note)) = decide(&stamped, &file, truth.axes == "lateral") else {
                continue;
            };
            // What the estimator takes as the delay, half a sample for held ones included.
            let taken = |name: &str| {
                moved.iter().find(|m| m.0 == name).map_or(0.0, |m| m.1)
                    - if hold == InputHold::Held { 0.5 * step } else { 0.0 }
            };
            let names: &[&str] = if truth.axes == "lateral" { &SURFACES[1..] } else { &SURFACES[..1] };
            let limit = (NEAR_SAMPLES * step).max(NEAR_S);
            let right = names.iter().all(|name| (taken(name) - late_s).abs() <= limit);
            let count = &mut counts[case].1;
            *match (decided, right) {
                (true, true) => &mut count.right,
                (true, false) => &mut count.wrong,
                (false, true) => &mut count.open_right,
                (false, false) => &mut count.open_wrong,
            } += 1;
            if show {
                let taken: Vec<String> = names.iter().map(|name| format!("{:+.1}", 1e3 * taken(name))).collect();
                println!(
                    "{} {} {} step {:.0} ms, {:+.1} ms: {} {hold:?} taken {}: {}",
                    truth.aircraft,
                    truth.flight,
                    truth.group,
                    1e3 * step,
                    1e3 * late_s,
                    if decided { "decided" } else { "open" },
                    taken.join(" "),
                    note.split(". ").next().unwrap_or_default()
                );
            }
        }
    }
    counts
}

#[test]
fn how_surfaces_move_is_found_on_foreign_flights() {
    let flights = find(Path::new("tests/field"), Split::Develop).unwrap();
    let healthy: Vec<Truth> = flights.into_iter().filter(Truth::is_healthy).collect();
    for (case, count) in study(&healthy, true) {
        assert!(count.wrong == 0 && count.right > 0, "{case}: {count:?}");
    }
}

/// The whole field: `PHUGOID_FIELD=target/field cargo test --release -p phugoid-evaluation --test integration
/// input_timing -- --ignored --nocapture`, with `PHUGOID_FIELD_SPLIT=look-once` for the other part.
#[test]
#[ignore = "needs the field of scripts/field/make.py"]
fn how_surfaces_move_on_the_whole_field() {
    let folder = std::env::var("PHUGOID_FIELD").expect("PHUGOID_FIELD names the folder of scripts/field/make.py");
    let split = match std::env::var("PHUGOID_FIELD_SPLIT").as_deref() {
        Ok("look-once") => Split::LookOnce,
        _ => Split::Develop,
    };
    let (flights, others): (Vec<Truth>, Vec<Truth>) =
        find(Path::new(&folder), split).unwrap().into_iter().partition(Truth::is_healthy);
    for (case, count) in study(&others, true) {
        println!("with a change in flight or systematic errors, {case}: {count:?}");
    }
    for (case, count) in study(&flights, true) {
        println!("{case}: {count:?}");
        // How much is decided is what this is run for (docs/model-file.md); of that, 95 % has to be right.
        assert!(count.right >= 19 * count.wrong && count.right > 0, "{case}: {count:?}");
    }
}

/// The record with surfaces that have a sample of their own in every fourth row alone: with nothing in the rows between, or the
/// last one again.
fn recorded_slowly(record: &Record, repeated: bool) -> Record {
    let mut slow = record.clone();
    for channel in slow.channels.iter_mut().filter(|c| SURFACES.contains(&c.name.as_str())) {
        let of = channel.values.clone();
        let value = |row: usize| if repeated || row.is_multiple_of(4) { of[row - row % 4] } else { f64::NAN };
        channel.values = (0..of.len()).map(value).collect();
    }
    slow
}

/// An autopilot logs its rates at 50 Hz and its surfaces at 12.5 Hz. Held until the next sample they were late by 40 ms, and Cm_q
/// and Cm_elevator of these flights came out by a fifth too large with bounds of that size, called sound.
#[test]
fn surfaces_that_are_slower_than_the_record_run_straight_between_their_own_samples() {
    let flights = find(Path::new("tests/field"), Split::Develop).unwrap();
    let mut seen = 0;
    for flight in flights.iter().filter(|flight| flight.is_healthy() && flight.axes == "longitudinal") {
        let file = ModelFile { input: InputHold::Auto, ..ModelFile::open(flight.folder.join(&flight.model)).unwrap() };
        let record = Record::open(flight.folder.join(&flight.record)).unwrap();
        let step_s = record.time[4] - record.time[0];
        for repeated in [false, true] {
            let slow = recorded_slowly(&record, repeated);
            // Four times fewer samples tell less: what is certain is right.
            let ((hold, ..), is_certain, note) = decide(&slow, &file, false).unwrap();
            assert!(hold == InputHold::Interpolated || !is_certain, "{note}");
            // Each sample as of half of its step later: what a computer would have held.
            let held = recorded_slowly(&stamped_late(&record, -0.5 * step_s), repeated);
            let ((hold, ..), is_certain, note) = decide(&held, &file, false).unwrap();
            assert!(hold == InputHold::Held || !is_certain, "{note}");

            let file = ModelFile { input: InputHold::Interpolated, ..file.clone() };
            let found = estimate(&slow, &file, &EstimateOptions::default(), &mut |_| ()).unwrap();
            assert!(found.verdict.iter().any(|s| s.contains("slower than the record: it runs straight")));
            let counting = flight.at_end().iter().filter(|(_, truth)| truth.counts());
            for (parameter, truth) in counting.filter_map(|(name, truth)| Some((found.parameter(name)?, truth))) {
                let off = (parameter.value - truth.value).abs();
                let std = parameter.random_std().hypot(parameter.systematic_std).hypot(truth.structure_std);
                assert!(off < 2.0 * std, "{} {}: {parameter:?}, {truth:?}", flight.aircraft, flight.flight);
                seen += 1;
            }
        }
    }
    assert!(seen >= 20, "{seen}");
}

/// A manoeuvre so short that nothing tells how the surfaces moved: held is one way and straight lines another, half a sample apart,
/// and the bounds hold that beside what is declared of the timing of surfaces.
#[test]
fn what_a_short_record_does_not_tell_of_its_surfaces_is_in_the_bounds() {
    let flights = find(Path::new("tests/field"), Split::Develop).unwrap();
    let truth = flights.iter().find(|truth| truth.axes == "longitudinal" && truth.is_healthy()).unwrap();
    let mut file = ModelFile::find(&truth.folder.join(&truth.model).to_string_lossy()).unwrap();
    let whole = file.open_record(truth.folder.join(&truth.record)).unwrap();
    let short = (0..20_u8)
        .filter_map(|from| whole.between(f64::from(from), f64::from(from) + 3.0))
        .find(|part| {
            file.input = InputHold::Auto;
            let notes =
                prepare::<LongitudinalModel, _, _>(part, &file).map(|prepared| prepared.notes).unwrap_or_default();
            notes.iter().any(|note| note.contains("cannot be seen in this record"))
        })
        .expect("three seconds of a flight that tell nothing of it");
    let skew_of = |input: InputHold| {
        let file = ModelFile { input, ..file.clone() };
        let estimation = estimate(&short, &file, &EstimateOptions::default(), &mut |_| {}).unwrap();
        let parameter = estimation.parameters.iter().find(|p| p.name == "Cm_elevator").unwrap();
        let parts = parameter.systematic_parts.iter();
        parts.filter(|part| part.quantity == UncertainQuantity::SurfaceSkew).map(|part| part.effect).sum::<f64>()
    };
    let [open, said] = [InputHold::Auto, InputHold::Held].map(skew_of);
    let declared_s = file.uncertainty.surface_skew;
    let expected = declared_s.hypot(0.5 * short.sample_time_s() * 0.5_f64.sqrt()) / declared_s;
    assert!(expected > 1.2, "the flight is sampled too fast to show it: {expected}");
    assert!((open / said / expected - 1.0).abs() < 1e-9, "{} instead of {expected}", open / said);
    // The whole flight tells it, as it does of a flight whose surfaces were stamped late: there the surfaces are moved.
    file.input = InputHold::Auto;
    let (_, settled) = for_parts(&whole, &file).expect("the whole flight tells it");
    assert_eq!(settled.input, InputHold::Interpolated);
    let notes = prepare::<LongitudinalModel, _, _>(&short, &settled).unwrap().notes;
    assert!(notes.iter().any(|note| note.starts_with("by the whole record, `input`")), "{notes:?}");
    assert!(!notes.iter().any(|note| note.contains("a part of the timing of surfaces")), "{notes:?}");
    let late = stamped_late(&whole, 0.06);
    let (moved, _) = for_parts(&late, &file).expect("the whole flight tells that it is late");
    let of = |record: &Record| record.channel("elevator").unwrap().values.clone();
    let scatter = |one: &[f64], other: &[f64]| one.iter().zip(other).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt();
    let (before, after) = (scatter(&of(&whole), &of(&late)), scatter(&of(&whole), &of(&moved)));
    assert!(after < 0.2 * before, "{after} of {before}");
    // What the file says is not asked.
    file.input = InputHold::Held;
    assert!(for_parts(&whole, &file).is_none());
}

/// Aileron doublets of the F-16, and a rudder that nobody moves. The rudder's column of the rolling moment is zero, and the time of the
/// aileron was not found for it: the flight with a late aileron was refused without a word on the cause.
#[test]
fn a_late_aileron_is_found_where_the_rudder_is_never_moved() {
    let text = include_str!("../../../../scenarios/f16-lateral.toml").replace("4 deg\"", "0 deg\"");
    let scenario = Scenario::parse(&text, "f16-lateral").unwrap();
    let flown = sense(&fly(&scenario).unwrap().truth, &scenario, 1).unwrap();
    let rudder = &flown.channels.iter().find(|channel| channel.name == "rudder").unwrap().values;
    assert!(rudder.iter().all(|v| v.abs() < 1e-12), "nobody moves the rudder");
    let model = ModelFile::named("f16-lateral").unwrap();
    let late = stamped_late(&flown, 0.06);

    let file = ModelFile { input: InputHold::Auto, ..model.clone() };
    let prepared = prepare::<SixModel, _, _>(&flown, &file).unwrap();
    assert!(prepared.hold == InputHold::Held && prepared.moved_s.is_empty(), "{:?}", prepared.notes);
    // Commands were held: against straight lines between the samples they are half a sample of 10 ms earlier.
    let prepared = prepare::<SixModel, _, _>(&late, &file).unwrap();
    let [(name, late_s)] = &prepared.moved_s[..] else { panic!("{:?}", prepared.notes) };
    assert!(name == "aileron" && (late_s - 0.055).abs() < NEAR_S, "{:?}", prepared.notes);

    // Where the file says how surfaces move, nothing is moved, and the verdict names it.
    let found = estimate(&late, &model, &EstimateOptions::default(), &mut |_| ()).unwrap();
    let named = found.reasons.iter().find(|reason| reason.code == ReasonCode::SensorError).unwrap();
    assert!(named.concerns == ["aileron"] && named.sentence.contains("the aileron was recorded"), "{named:?}");

    // A record that is too short to see it says so.
    let file = ModelFile { input: InputHold::Held, ..model };
    let prepared = prepare::<SixModel, _, _>(&flown.between(4.0, 11.0).unwrap(), &file).unwrap();
    let note = "whether the aileron was recorded late is not checked";
    assert!(prepared.notes.iter().any(|said| said.starts_with(note)), "{:?}", prepared.notes);
}
