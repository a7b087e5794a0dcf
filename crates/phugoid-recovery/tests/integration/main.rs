//! Flights in closed loop, as a user has them.
#![allow(clippy::unwrap_used)]

use phugoid_control::law::Form;
use phugoid_control::local::LocalModel;
use phugoid_control::qualities::Level;
use phugoid_identification::model_file::ModelFile;
use phugoid_recovery::draw::{Class, classes, damaged};
use phugoid_recovery::flight::{Control, Kind, RecoveryFlight, Settings, fly};
use phugoid_recovery::study::{damage, recovery};
use phugoid_simulation::flight::trimmed_aircraft;
use phugoid_simulation::scenario::Scenario;

fn model() -> ModelFile {
    ModelFile::named("f16-recovery-model").unwrap()
}

fn flown(settings: &Settings) -> RecoveryFlight {
    fly(&Scenario::named("f16-recovery").unwrap(), settings, &model()).unwrap()
}

/// The purpose: with the gains of the undamaged aircraft it is lost, with gains from its estimate it flies on as with those of the
/// truth, and what the pilot is told is right.
#[test]
fn an_aircraft_that_fixed_gains_lose_is_flown_on() {
    let with = |control: Control| flown(&Settings { control, ..Settings::default() });
    let (fixed, adaptive, oracle) = (with(Control::Fixed), with(Control::Adaptive), with(Control::Oracle));
    assert!(fixed.outcome.departed && !fixed.outcome.is_recovered());
    assert!(oracle.outcome.level_flight && oracle.outcome.level == Level::One);
    assert!(adaptive.outcome.level_flight, "{:?}", adaptive.events);
    assert_eq!(adaptive.outcome.level, Level::One, "{:?}", adaptive.outcome.qualities);
    let gains = adaptive.events.iter().find(|event| event.kind == Kind::NewGains && event.time_s >= 10.0).unwrap();
    // The damage doubles the angle of attack in less than a second.
    assert!(gains.time_s < 13.0, "{gains:?}");
    let left = adaptive.left.unwrap();
    assert_eq!(left.level, Some(adaptive.outcome.level));
    for (margin, truth) in left.margins.iter().zip(&adaptive.truly_left.margins) {
        assert!((margin.trim - truth.trim).abs() < 4.0 * margin.std_error, "{margin:?} {truth:?}");
        assert!(margin.at_least < margin.left && margin.left <= 1.0);
    }
}

#[test]
fn the_same_seed_gives_the_same_flight_and_the_incremental_form_flies_too() {
    let settings = Settings { control: Control::Robust, form: Form::Incremental, ..Settings::default() };
    let (one, other) = (flown(&settings), flown(&settings));
    assert_eq!(one.history, other.history);
    assert!(!one.outcome.departed, "{:?}", one.events);
}

#[test]
fn scenarios_that_cannot_be_flown_in_closed_loop_are_refused() {
    let constant = Scenario::named("f16-calm").unwrap();
    let message = fly(&constant, &Settings::default(), &model()).unwrap_err().to_string();
    assert!(message.contains("thrust = \"engine\""), "{message}");
    // What would be flown or estimated as something else than the user said.
    const TEXT: &str = include_str!("../../../../scenarios/f16-recovery.toml");
    let refused = |from: &str, to: &str, model: &str| {
        let scenario = Scenario::parse(&TEXT.replacen(from, to, 1), "test").unwrap();
        fly(&scenario, &Settings::default(), &ModelFile::named(model).unwrap()).unwrap_err().to_string()
    };
    for (from, to, model, words) in [
        ("[sensors]", "[sensors]\nvanes = [\"5 m\", \"0 m\", \"0 m\"]", "f16-recovery-model", "vanes"),
        ("seed = 1", "seed = 1", "hfb320", "`ixx` is missing"),
        ("cg = 0.30", "cg = 0.32", "f16-recovery-model", "centre of gravity is at 0.32"),
        ("tables = \"book\"", "tables = \"morelli\"", "f16-recovery-model", "tables of the book"),
        ("20000 ft", "22000 ft", "f16-recovery-model", "begins at 6706 m"),
        ("675 ft/s", "600 ft/s", "f16-recovery-model", "182.9 m/s"),
    ] {
        let message = refused(from, to, model);
        assert!(message.contains(words), "{words}: {message}");
    }
}

/// A small study: every damage has all four controls, the order is that of the seeds, and nothing is counted twice.
#[test]
fn a_study_counts_every_flight_once() {
    let base = Scenario::named("f16-recovery").unwrap();
    let damages = 4;
    let study = recovery(&base, &model(), &Settings::default(), damages, 77, &|| ()).unwrap();
    assert_eq!(study.flights.len(), damages * Control::ALL.len());
    let all: Vec<_> = study.rows.iter().filter(|row| row.class.is_none()).collect();
    assert!(all.iter().all(|row| row.flights == damages && row.recovered <= row.level_flight));
    let of_classes: usize = study.rows.iter().filter(|row| row.class.is_some()).map(|row| row.flights).sum();
    assert_eq!(of_classes, study.flights.len());
    let again = recovery(&base, &model(), &Settings::default(), damages, 77, &|| ()).unwrap();
    assert!(study.flights == again.flights, "the same seeds give the same flights");
    // One of them by itself, as `phugoid fly --damage` flies it.
    let scenario = damage(&base, 2, 77).unwrap();
    for short in study.flights.iter().filter(|short| short.seed == 79) {
        let settings = Settings { control: short.control, ..Settings::default() };
        let flight = fly(&scenario, &settings, &model()).unwrap();
        assert_eq!((&flight.scenario, flight.outcome.level), (&short.damage, short.level));
        assert_eq!(flight.outcome.departed, short.departed);
    }
    let counts: Vec<usize> = (0..10 * Class::ALL.len()).map(|k| classes(k, 77 + k as u64).len()).collect();
    assert!(counts.contains(&1) && counts.contains(&2) && counts.contains(&3));
}

/// An elevator that jams is lost with every gains, and where it stands then decides how it ends: gains that move it more in the air of
/// every day leave it farther from where level flight takes it. With the gains of the undamaged aircraft these are flown on (seeds of the
/// damages that robust gains from the start lost).
#[test]
fn a_jammed_elevator_is_no_worse_than_with_fixed_gains() {
    let base = Scenario::named("f16-recovery").unwrap();
    let (aircraft, trim) = trimmed_aircraft(&base).unwrap();
    for index in [314, 342] {
        let seed = 1000 + index as u64;
        let scenario = damaged(&base, aircraft.as_ref(), &trim, &classes(index, seed), seed);
        let with = |control: Control| fly(&scenario, &Settings { control, ..Settings::default() }, &model()).unwrap();
        let (fixed, robust, adaptive) = (with(Control::Fixed), with(Control::Robust), with(Control::Adaptive));
        assert!(fixed.outcome.is_recovered() && !robust.outcome.is_recovered());
        assert!(adaptive.outcome.is_recovered(), "{:?}", adaptive.events);
        // Nothing is left of it, and that is said.
        let margins = adaptive.left.unwrap().margins;
        assert!(!margins[0].is_used && margins[0].left == 0.0 && margins[1].is_used, "{margins:?}");
    }
}

/// Lift and drag over the last samples as they were, and what is said of them.
fn is_lift_and_drag_right(flight: &RecoveryFlight, samples: usize) {
    let performance = flight.performance.as_ref().unwrap();
    let mean = |values: &[f64]| {
        let last = &values[values.len() - samples..];
        last.iter().sum::<f64>() / last.len() as f64
    };
    let [lift, drag] = [0, 1].map(|k| mean(&flight.history.lift_drag[k]));
    for (found, truth) in
        [(&performance.lift, lift), (&performance.drag, drag), (&performance.glide_ratio, lift / drag)]
    {
        let (value, error) = (found.value.unwrap(), found.std_error.unwrap());
        // Rates lift as well, and are left out of what is said.
        assert!((value - truth).abs() < 3.0 * error.hypot(0.02 * truth), "{value} +- {error}: {truth}");
    }
    let slowest = performance.slowest_known_m_s.value.unwrap();
    assert!(slowest > 0.0 && slowest <= flight.history.speed.last().unwrap() * 1.02, "{performance:?}");
    assert!(performance.slowest_known_m_s.note.contains("not known beyond"), "{performance:?}");
}

#[test]
fn what_glide_and_stall_are_known_to_be() {
    is_lift_and_drag_right(&flown(&Settings::default()), 300);
    assert!(flown(&Settings { control: Control::Robust, ..Settings::default() }).performance.is_none());
}

/// The transport's folder; none, with a word, without the shared data.
fn transport() -> Option<std::path::PathBuf> {
    let folder = std::env::var_os("PHUGOID_SHARED_DATA").map_or_else(
        || std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data"),
        std::path::PathBuf::from,
    );
    let folder = folder.join("gtm");
    if !folder.join("vehicle.json").exists() {
        eprintln!("skipped: no tables in {} (set PHUGOID_SHARED_DATA)", folder.display());
        return None;
    }
    Some(folder.canonicalize().unwrap())
}

fn damaged_transport(folder: &std::path::Path, damage: &str) -> Scenario {
    let text = include_str!("../../examples/transport/scenario.toml")
        .replace("FOLDER", &folder.display().to_string())
        .replace("DAMAGE", damage);
    Scenario::parse(&text, "scenario.toml").unwrap()
}

/// Increments to the undamaged transport, in closed loop through the loss of half of its stabiliser. Skipped without its tables.
#[test]
fn increments_to_an_aircraft_of_a_file_are_flown() {
    let Some(folder) = transport() else { return };
    let scenario = damaged_transport(&folder, "left-stabiliser-off");
    let text = include_str!("increments.toml").replace("FOLDER", &folder.display().to_string());
    let model = ModelFile::parse("model.toml", &text).unwrap();
    let flight = fly(&scenario, &Settings::default(), &model).unwrap();
    assert!(flight.outcome.is_recovered(), "{:?} {:?}", flight.outcome, flight.events);
    let adopted = flight.events.iter().find(|event| event.kind == Kind::Adopted && event.time_s >= 15.0).unwrap();
    assert!(adopted.time_s < 20.0, "{}", adopted.time_s);
    let (found, truth) = (flight.estimate.unwrap(), flight.truth);
    let apart = |of: fn(&LocalModel) -> f64| ((of(&found.model) - of(&truth.model)) / of(&found.std_error)).abs();
    assert!(apart(|m| m.surfaces[1][0]) < 3.0 && apart(|m| m.rates[1][0]) < 3.0, "{found:?} {truth:?}");
    is_lift_and_drag_right(&flight, 120);
    // Increments to another aircraft, about another trim, and terms that the law does not know.
    let refused = |scenario: &Scenario, text: &str| {
        fly(scenario, &Settings::default(), &ModelFile::parse("model.toml", text).unwrap()).unwrap_err().to_string()
    };
    let message = refused(&Scenario::named("f16-recovery").unwrap(), &text);
    assert!(message.contains("another aircraft"), "{message}");
    let message = refused(&scenario, &text.replace("alpha = \"trim\"", "alpha = \"1 deg\""));
    assert!(message.contains("count alpha from 1.00 deg"), "{message}");
    let bent = text.replace("\"beta\", \"p_hat\"]", "\"beta\", \"p_hat\", \"alpha^2\"]");
    let message = refused(&scenario, &bent.replace("dCm_q =", "dCm_alpha2 = { prior_std = 1 }\ndCm_q ="));
    assert!(message.contains("`dCm_alpha2`"), "{message}");
}

/// NASA's transport of 5.5 % loses half of its stabiliser; only mass, inertia and wing are known of it. Skipped without its tables.
#[test]
fn a_transport_is_flown_on_with_a_model_of_its_own() {
    let Some(folder) = transport() else { return };
    let scenario = damaged_transport(&folder, "left-stabiliser-off");
    let text = include_str!("../../examples/transport/model.toml");
    let model = ModelFile::parse("model.toml", text).unwrap();
    let flight = fly(&scenario, &Settings::default(), &model).unwrap();
    assert!(flight.outcome.is_recovered(), "{:?} {:?}", flight.outcome, flight.events);
    let adopted = flight.events.iter().find(|event| event.kind == Kind::Adopted && event.time_s >= 15.0).unwrap();
    assert!(adopted.time_s < 20.0, "{}", adopted.time_s);
    assert!(flight.lost.is_some());
    assert_eq!(flight.explained, Some(true));
    // Of elevator, stability and damping in pitch half is left, and the weathercock stability is as it was; all within three standard
    // errors. Without the terms of the ailerons in Cm the stability is 4.3 of them from the truth.
    let (found, truth) = (flight.estimate.unwrap(), flight.truth);
    let apart = |of: fn(&LocalModel) -> f64| ((of(&found.model) - of(&truth.model)) / of(&found.std_error)).abs();
    assert!(apart(|m| m.surfaces[1][0]) < 3.0 && apart(|m| m.rates[2][1]) < 3.0, "{found:?} {truth:?}");
    assert!(apart(|m| m.rates[1][0]) < 3.0 && apart(|m| m.rates[1][3]) < 3.0, "{found:?} {truth:?}");
    is_lift_and_drag_right(&flight, 120);
    for (margin, truth) in flight.left.unwrap().margins.iter().zip(&flight.truly_left.margins) {
        assert!((margin.trim - truth.trim).abs() < 4.0 * margin.std_error, "{margin:?} {truth:?}");
    }
    // Terms that count from elsewhere are refused with the numbers to write.
    let far = ModelFile::parse("model.toml", &text.replace("alpha = \"3.74 deg\"", "alpha = \"0 deg\"")).unwrap();
    let refused = fly(&scenario, &Settings::default(), &far).unwrap_err().to_string();
    assert!(refused.contains("alpha = \"3.74 deg\""), "{refused}");
    // So are increments to another aircraft.
    let refused = fly(&scenario, &Settings::default(), &self::model()).unwrap_err().to_string();
    assert!(refused.contains("another aircraft"), "{refused}");
}

/// The scenario of the recovery with other damage or failures than its own.
fn with_damage(damage: &str, seed: u64) -> Scenario {
    let text = include_str!("../../../../scenarios/f16-recovery.toml");
    let (from, to) = (text.find("[[damage]]").unwrap(), text.find("# White noise").unwrap());
    let mut scenario = Scenario::parse(&format!("{}{damage}\n{}", &text[..from], &text[to..]), "test").unwrap();
    scenario.seed = seed;
    scenario
}

fn flown_with(damage: &str, seed: u64) -> RecoveryFlight {
    fly(&with_damage(damage, seed), &Settings::default(), &model()).unwrap()
}

/// Mass, lift and ice that change slowly are no jump that the estimator looks for, and moments tell little of them. What is said of lift,
/// drag and glide holds the truth or is refused, and what follows from slopes of an estimate that does not explain the measured forces
/// is refused.
#[test]
fn slow_damage_makes_no_narrow_bounds_that_are_wrong() {
    for (damage, seed) in [
        ("[[damage]]\nat = \"10 s\"\nover = \"30 s\"\nmass = 0.8", 2),
        ("[[damage]]\nat = \"10 s\"\nover = \"20 s\"\nconstants = { CL = -0.05 }", 2),
        (
            "[[damage]]\nat = \"10 s\"\nover = \"40 s\"\nincrements = { dCL_alpha = -1.0, dCD_alpha = 0.3, dCm_alpha = 0.1 }\n\
             constants = { CD = 0.02 }",
            1,
        ),
    ] {
        let flight = flown_with(damage, seed);
        let performance = flight.performance.as_ref().unwrap();
        let forces = performance.forces.unwrap();
        assert!(!forces.lift.explained || !forces.drag.explained, "{damage}: {forces:?}");
        let mean = |values: &[f64]| values[values.len() - 300..].iter().sum::<f64>() / 300.0;
        let [lift, drag] = [0, 1].map(|k| mean(&flight.history.lift_drag[k]));
        for (found, truth) in
            [(&performance.lift, lift), (&performance.drag, drag), (&performance.glide_ratio, lift / drag)]
        {
            if let Some((value, error)) = found.value.zip(found.std_error) {
                assert!((value - truth).abs() < 2.0 * error, "{damage}: {found:?} {truth}");
            }
        }
        if !forces.lift.explained {
            for found in [&performance.slowest_known_m_s, &performance.load_factor_known, &performance.approach_m_s] {
                assert!(found.value.is_none() && found.note.contains("measured lift"), "{damage}: {found:?}");
            }
            assert!(phugoid_recovery::page::forces_words(performance).unwrap().contains("lift (coefficient"));
        }
    }
}

/// Ailerons that jam a degree from the middle roll an aircraft over that has nothing else to roll with. The rudder holds the wings level by a
/// sideslip, and the text says so.
#[test]
fn without_ailerons_the_aircraft_is_flown_on_with_the_rudder() {
    let jam = "[[failure]]\nsurface = \"aileron\"\nkind = \"jam\"\nposition = \"1 deg\"\nat = \"10 s\"\n";
    let scenario = with_damage(jam, 3);
    let fly = |control| fly(&scenario, &Settings { control, ..Settings::default() }, &model()).unwrap();
    assert!(fly(Control::Fixed).outcome.departed);
    for control in [Control::Adaptive, Control::Oracle] {
        let flight = fly(control);
        assert!(flight.outcome.level_flight && flight.outcome.rolled_by_sideslip, "{:?}", flight.events);
        let words = phugoid_recovery::page::ended_words(&flight.outcome);
        assert!(words.contains("rolled only by the rudder, through sideslip"), "{words}");
    }
    let flight = fly(Control::Adaptive);
    assert!(flight.events.iter().any(|event| event.text.contains("the rudder rolls the aircraft")));
    let left = flight.left.unwrap();
    assert!(left.rolled_by_sideslip && left.level == Some(Level::Worse));
    let approach = flight.performance.unwrap().approach_m_s;
    assert!(approach.value.is_none() && approach.note.contains("rolled only by the rudder, because"), "{approach:?}");
}

/// A wing that has lost a part rolls the aircraft by its lift, more so as it banks and needs more. With the robust gains, whose roots are well
/// damped, it departs; gains that know of it are taken because they explain the motion and the others do not.
#[test]
fn a_wing_that_rolls_by_its_lift_is_held() {
    let base = Scenario::parse(include_str!("../../../../scenarios/f16-recovery.toml"), "test").unwrap();
    let scenario = damage(&base, 201, 9_900_000).unwrap();
    let fly = |control| fly(&scenario, &Settings { control, ..Settings::default() }, &model()).unwrap();
    assert!(fly(Control::Fixed).outcome.departed && fly(Control::Robust).outcome.departed);
    let adaptive = fly(Control::Adaptive);
    assert!(adaptive.outcome.is_recovered(), "{:?}", adaptive.events);
}

/// With elevator, aileron and rudder jammed nothing is controlled, and neither a level nor an approach speed says otherwise.
#[test]
fn without_its_surfaces_an_aircraft_has_no_level_and_no_approach_speed() {
    let jam = |surface: &str| format!("[[failure]]\nsurface = \"{surface}\"\nkind = \"jam\"\nat = \"10 s\"\n");
    let flight = flown_with(&["elevator", "aileron", "rudder"].map(jam).concat(), 1);
    assert!(flight.events.iter().filter(|event| event.text.contains("jammed")).count() == 3, "{:?}", flight.events);
    let left = flight.left.unwrap();
    assert_eq!((left.level, left.controlled), (Some(Level::Worse), [false; 3]));
    let words = phugoid_recovery::page::level_words(&left);
    assert!(words.contains("not controllable in pitch, roll and yaw"), "{words}");
    let performance = flight.performance.unwrap();
    for found in [&performance.control_speed_m_s, &performance.approach_m_s] {
        assert!(found.value.is_none() && !found.note.is_empty(), "{found:?}");
    }
    assert_eq!(flight.outcome.controlled, [false; 3]);
}

/// A rudder without effect moves and follows, and nothing is left of it.
#[test]
fn of_a_surface_without_effect_nothing_is_left() {
    let flight = flown_with("[[damage]]\nat = \"10 s\"\neffectiveness = { rudder = 0.0 }", 2);
    let (left, truth) = (flight.left.unwrap(), flight.truly_left);
    let rudder = left.margins[2];
    assert!(rudder.is_used && rudder.left < 0.2 && rudder.at_least < 0.05, "{rudder:?}");
    assert_eq!((truth.margins[2].has_effect, truth.margins[2].left), (false, 0.0));
    assert!(left.margins[0].left > 0.6 && left.margins[1].left > 0.6, "{:?}", left.margins);
}

/// A model that estimates four derivatives in pitch says nothing of roll and yaw, and without the effect of the elevator no level in pitch.
#[test]
fn a_model_says_no_level_of_what_it_does_not_estimate() {
    let model = ModelFile::named("f16-model").unwrap();
    let flight = fly(&Scenario::named("f16-recovery").unwrap(), &Settings::default(), &model).unwrap();
    let left = flight.left.unwrap();
    assert_eq!((left.level, left.told), (None, [false; 2]));
    let words = phugoid_recovery::page::level_words(&left);
    assert!(words.contains("nothing is said of them on any axis"), "{words}");
    // The whole model tells all, and its bounds allow no better level than the estimate.
    let whole = flown(&Settings::default()).left.unwrap();
    assert!(whole.level_within_bounds >= whole.level && whole.told == [true; 2], "{whole:?}");
}

/// What the scenario has after the end of the flight did not happen, and an aircraft that pays for its altitude with its speed is said to.
#[test]
fn the_story_is_of_what_was_flown() {
    let late = flown_with("[[damage]]\nat = \"100 s\"\nincrements = { dCm_alpha = 0.4 }", 1);
    assert!(late.events.iter().all(|event| event.kind != Kind::Damage), "{:?}", late.events);
    assert!(late.outcome.holds_energy);
    let words = phugoid_recovery::page::ended_words(&late.outcome);
    assert!(words.starts_with("in level flight, "), "{words}");
    let without_thrust = flown_with("[[damage]]\nat = \"10 s\"\nthrust = 0.0", 1);
    assert!(
        without_thrust.outcome.level_flight && !without_thrust.outcome.holds_energy,
        "{:?}",
        without_thrust.outcome
    );
    let words = phugoid_recovery::page::ended_words(&without_thrust.outcome);
    assert!(words.contains("losing 1.") && words.contains("m/s of speed each second"), "{words}");
}

/// An elevator with a play of 1.5 deg is used on, and the aircraft recovers as with fixed gains.
#[test]
fn play_in_the_elevator_does_not_lose_it() {
    let damage = "[[failure]]\nsurface = \"elevator\"\nkind = \"play\"\nplay = \"1.5 deg\"\nat = \"10 s\"";
    for seed in [3, 4] {
        let flight = flown_with(damage, seed);
        assert!(flight.outcome.is_recovered(), "{seed}: {:?} {:?}", flight.outcome, flight.events);
        assert!(flight.left.unwrap().margins[0].is_used, "{seed}: {:?}", flight.events);
    }
}
