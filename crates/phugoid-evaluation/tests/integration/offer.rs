//! Terms that the residuals ask for, on simulated flights of the F-16 and on one of another simulator.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)] // tests and benches may

use std::path::Path;

use phugoid_evaluation::monte_carlo::monte_carlo;
use phugoid_evaluation::published::{DAMAGE_MODEL, GUST_MODEL};
use phugoid_flight_data::record::Record;
use phugoid_identification::estimate::{EstimateOptions, Method, StructureSearch, estimate, with_offered};
use phugoid_identification::estimation::{
    Estimation, EstimationStatus, FinalStatus, Offer, OfferedTerm, ReasonCode, is_in_part,
};
use phugoid_identification::model_file::ModelFile;
use phugoid_simulation::flight::fly;
use phugoid_simulation::scenario::{Scenario, built_in};

/// A minute of a pilot's stick in the built-in F-16, with what is added to the scenario.
fn flight(added: &str, seed: u64) -> Scenario {
    let text = include_str!("../../../../scenarios/f16-damage.toml");
    let (start, rest) = text.split_once("# Until the damage").unwrap();
    let (_, sensors) = rest.split_once("# White noise").unwrap();
    let text = format!("{start}# White noise{sensors}\n{added}").replace("duration = \"20 s\"", "duration = \"60 s\"");
    Scenario { seed, ..Scenario::parse(&text, "pilot").unwrap() }
}

fn model(text: &str) -> ModelFile {
    ModelFile::parse("model", text).unwrap()
}

fn by(scenario: &Scenario, model: &ModelFile, method: Method, structure: StructureSearch) -> Estimation {
    let options = EstimateOptions { method: Some(method), structure, ..EstimateOptions::default() };
    estimate(&fly(scenario).unwrap().measured, model, &options, &mut |_| ()).unwrap_or_else(|e| panic!("{method}: {e}"))
}

fn with_offer(scenario: &Scenario, model: &ModelFile) -> Estimation {
    by(scenario, model, Method::Smpe, StructureSearch::Offer)
}

const SQUARED: &str = "[model_error]\nCm_alpha_squared = 0.5\n";
const LIGHT: &str = "[turbulence]\nintensity = \"light\"\n";
const DAMAGE: &str = "[[damage]]\nat = \"30 s\"\nincrements = { dCm_alpha = -0.2, dCm_q = -2.0, dCL_alpha = 0.4, \
                      dCD_alpha = 0.1, dCm_elevator = 0.15 }\n";

fn adopted(estimation: &Estimation) -> usize {
    estimation.events.iter().filter(|e| e.kind.word() == "adopted").count()
}

/// What was offered, in a line: of a test that fails.
fn in_words(offer: &Offer) -> String {
    let term = |t: &OfferedTerm| {
        let (name, value, std) = (&t.parameter, t.value, t.std_error);
        let (f, share, excess) =
            (t.partial_f, 100.0 * t.share.unwrap_or(f64::NAN), 100.0 * t.excess.unwrap_or(f64::NAN));
        format!(
            "\n  {name} F {f:.1} share {share:.2} % explains {excess:.1} % = {value:.4} +- {std:.4}, {}",
            t.asked_for
        )
    };
    let terms: String = offer.terms.iter().map(term).collect();
    format!("from {:.1}, {:?}{terms}", offer.criterion.partial_f, offer.levels)
}

/// What a user does: fly, read, take the term in, estimate again. The truth is within three claimed errors: of eight
/// normal ones one lies beyond in 2 % of such sets.
#[test]
fn a_moment_that_grows_with_alpha_squared_is_offered_and_explains_the_changes() {
    let runs = runs(8);
    let given = model(DAMAGE_MODEL);
    let flown = monte_carlo(
        runs,
        |run| -> Result<_, ()> {
            let scenario = flight(SQUARED, 700 + run as u64);
            let first = with_offer(&scenario, &given);
            let second = with_offer(&scenario, &with_offered(&given, first.offer.as_ref().unwrap()).unwrap());
            let auto = by(&scenario, &given, Method::Smpe, StructureSearch::Auto);
            Ok((first, second, auto))
        },
        || (),
    );
    let mut changes = 0;
    for (first, second, auto) in flown.unwrap() {
        let offer = first.offer.as_ref().unwrap();
        let words = in_words(offer);
        println!("{words}");
        let best = offer.best().unwrap();
        assert_eq!((best.coefficient.as_str(), best.term.as_str()), ("Cm", "alpha^2"), "{words}");
        let effect = offer.effects.iter().find(|e| e.parameter == "dCm_alpha2").unwrap();
        assert!((effect.after - 0.5).abs() < 3.0 * effect.after_std, "{words} {effect:?}");
        assert!(first.verdict.iter().any(|s| s.contains("ask for alpha^2 in Cm")), "{:?}", first.verdict);
        // The estimate itself is that of the model that was given.
        assert!(first.parameters.iter().all(|p| p.name != "dCm_alpha2"));
        changes += adopted(&first);
        assert_eq!(adopted(&second), 0, "{:?}", second.events);
        assert!(
            second.offer.as_ref().is_none_or(|o| o.best().is_none()),
            "{}",
            in_words(second.offer.as_ref().unwrap())
        );
        let found = second.parameters.iter().find(|p| p.name == "dCm_alpha2").unwrap();
        assert_eq!(found.status.word(), "converged");
        // Taken in by itself it is the same estimate.
        assert!(auto.offer.as_ref().unwrap().taken);
        assert_eq!(auto.parameters, second.parameters);
        assert!(auto.verdict.iter().any(|s| s.contains("The estimates are those of the model with that")));
    }
    println!("{runs} flights: {changes} changes adopted without the term, none with it");
    assert!(changes > 0);
}

/// A flight of JSBSim's `OV10`, whose pitching moment has a term of -8 by the rate of the angle of attack and whose model file has
/// none: offered with its value by both filters, and by nothing else. The `pc7`'s file lacks other terms.
#[test]
fn the_rate_of_the_angle_of_attack_is_offered_by_the_filters() {
    let field = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/field/develop/OV10");
    let record = phugoid_flight_data::reader::read_path(&field.join("calm-short.csv"), &Default::default()).unwrap();
    let text = std::fs::read_to_string(field.join("longitudinal.toml")).unwrap();
    let run = |text: &str, method: Method, structure: StructureSearch| {
        let options = EstimateOptions { method: Some(method), structure, ..EstimateOptions::default() };
        estimate(&record, &model(text), &options, &mut |_| ()).unwrap()
    };
    for method in [Method::Smpe, Method::Ekf] {
        let found = run(&text, method, StructureSearch::Offer);
        let offer = found.offer.as_ref().unwrap();
        let missing: Vec<&OfferedTerm> = offer.missing().collect();
        let [term] = missing[..] else { panic!("{}", in_words(offer)) };
        assert_eq!((term.coefficient.as_str(), term.term.as_str(), term.share), ("Cm", "alpha_dot_hat", None));
        assert!((term.value + 8.0).abs() < 3.0 * term.std_error, "{}", in_words(offer));
        assert!(found.parameters.iter().all(|p| p.name != "Cm_alpha_dot"));
        assert!(found.verdict.iter().any(|s| s.contains("ask for alpha_dot_hat in Cm")), "{:?}", found.verdict);
        // The lines are those of a model that has it, and then nothing is missing.
        let lines: Vec<&str> = offer.lines.iter().map(|line| line.line.as_str()).collect();
        let [coefficient, parameter] = lines[..] else { panic!("{lines:?}") };
        let own = text.lines().find(|line| line.starts_with("Cm = ")).unwrap();
        let with = format!("{}\n{parameter}\n", text.replace(own, coefficient));
        let second = run(&with, method, StructureSearch::Offer);
        assert!(second.offer.as_ref().is_none_or(|o| o.best().is_none()));
        let auto = run(&text, method, StructureSearch::Auto);
        assert!(auto.offer.as_ref().unwrap().taken);
        assert_eq!(auto.parameters, second.parameters);
    }
    // A method that is not asked; and a moment that lacks the pitch rate as well, of which both are offered.
    let offered = |found: Estimation, name: &str| found.offer.is_some_and(|o| o.missing().any(|t| t.term == name));
    assert!(!offered(run(&text, Method::EquationError, StructureSearch::Offer), "alpha_dot_hat"));
    let without = text.replace("Cm = [\"1\", \"alpha\", \"q_hat\"", "Cm = [\"1\", \"alpha\"");
    let without: String =
        without.lines().filter(|line| !line.starts_with("Cm_q ")).map(|line| format!("{line}\n")).collect();
    let found = run(&without, Method::Smpe, StructureSearch::Offer);
    assert!(offered(found.clone(), "q_hat") && offered(found, "alpha_dot_hat"));
}

/// Every method finds it, and says what it does to the other parameters.
#[test]
fn every_method_offers_the_missing_term() {
    let scenario = flight(SQUARED, 711);
    for method in [Method::Ekf, Method::Rls, Method::EquationError, Method::OutputError] {
        let estimation = by(&scenario, &model(DAMAGE_MODEL), method, StructureSearch::Offer);
        let offer = estimation.offer.as_ref().unwrap();
        let best = offer.best().unwrap_or_else(|| panic!("{method}: {}", in_words(offer)));
        assert_eq!((best.coefficient.as_str(), best.term.as_str()), ("Cm", "alpha^2"), "{method} {}", in_words(offer));
        for parameter in estimation.parameters.iter().filter(|p| !p.name.starts_with("bias")) {
            let effect = offer.effects.iter().find(|e| e.parameter == parameter.name).unwrap();
            assert_eq!(effect.before, Some(parameter.value), "{method} {}", parameter.name);
            assert!(effect.after.is_finite());
        }
    }
    // Without the term filter error finds no minimum of this flight: the reason names it, and with it there is one.
    let (record, file) = (fly(&scenario).unwrap().measured, model(DAMAGE_MODEL));
    let run = |structure| {
        let options = EstimateOptions { method: Some(Method::FilterError), structure, ..EstimateOptions::default() };
        estimate(&record, &file, &options, &mut |_| ())
    };
    let error = run(StructureSearch::Offer).unwrap_err().to_string();
    assert!(error.contains("no convergence") && error.contains("ask for alpha^2 in Cm"), "{error}");
    let found = run(StructureSearch::Auto).unwrap();
    let added = found.parameter("dCm_alpha2").unwrap();
    assert!((added.value - 0.5).abs() < 3.0 * added.corrected_std_error, "{added:?}");
}

/// With the right model nothing is offered: 20 flights in calm air, 20 in light turbulence with a model that knows of
/// it.
#[test]
fn a_right_model_is_offered_nothing() {
    let runs = runs(20);
    // The surface of these flights has no actuator: it is where the stick puts it.
    let held = GUST_MODEL.replace("input = \"interpolated\"", "input = \"held\"");
    assert_ne!(held, GUST_MODEL);
    for (name, added, text) in [("calm", "", DAMAGE_MODEL), ("light turbulence", LIGHT, held.as_str())] {
        let offers = offers(runs, added, text);
        let (tried, asked) = counts(&offers);
        let partial = offers.iter().flatten().flat_map(|o| &o.terms).map(|t| t.partial_f);
        let largest = partial.fold(f64::NEG_INFINITY, f64::max);
        println!("{name}: {runs} flights, tried in {tried}, offered in {asked}; the largest partial F {largest:.1}");
        assert_eq!(
            (tried, asked),
            (runs, 0),
            "{name}: {:?}",
            offers.iter().flatten().map(in_words).collect::<Vec<_>>()
        );
        assert!(offers.iter().flatten().all(|o| o.tried >= 20));
    }
}

/// Terms of the lateral motion are tried with the others.
#[test]
fn lateral_terms_are_tried_by_themselves_and_with_the_others() {
    for name in ["f16-lateral", "f16-six"] {
        let scenario = built_in(name).unwrap().unwrap();
        let model = ModelFile::named(name).unwrap();
        let estimation = with_offer(&scenario, &model);
        let offer = estimation.offer.unwrap();
        println!("{name}: {}", in_words(&offer));
        assert!(offer.tried >= 30, "{}", offer.tried);
        assert!(offer.best().is_none(), "{}", in_words(&offer));
    }
}

/// A real change is not taken for a missing term.
#[test]
fn damage_is_not_taken_for_a_missing_term() {
    let runs = runs(10);
    let offers = offers(runs, DAMAGE, DAMAGE_MODEL);
    let (tried, asked) = counts(&offers);
    println!("{runs} flights, terms tried in {tried}, offered in {asked}");
    assert_eq!(asked, 0, "{:?}", offers.iter().flatten().map(in_words).collect::<Vec<_>>());
}

/// What else can be wrong, for docs/methods.md:
/// `cargo test -p phugoid-evaluation --test integration offer:: -- --ignored --nocapture`.
#[test]
#[ignore = "a measurement"]
fn what_other_errors_of_the_model_look_like() {
    let both = format!("{LIGHT}{SQUARED}");
    for (name, added, text) in [
        ("alpha^2 in light turbulence", both.as_str(), GUST_MODEL),
        ("tables 10 % off", "[model_error]\ntables = { Cm = 1.1, CZ = 0.9, CX = 1.1 }\n", DAMAGE_MODEL),
        ("thrust 10 % too high", "[model_error]\nthrust = 0.1\n", DAMAGE_MODEL),
        ("turbulence that the model does not know", LIGHT, DAMAGE_MODEL),
        ("weak alpha^2, 0.1", "[model_error]\nCm_alpha_squared = 0.1\n", DAMAGE_MODEL),
        ("weak alpha^2, 0.05", "[model_error]\nCm_alpha_squared = 0.05\n", DAMAGE_MODEL),
        ("weak alpha^2, 0.02", "[model_error]\nCm_alpha_squared = 0.02\n", DAMAGE_MODEL),
    ] {
        let runs = runs(20);
        let offers = offers(runs, added, text);
        let (tried, asked) = counts(&offers);
        let mut best: Vec<String> =
            offers.iter().flatten().filter_map(Offer::best).map(|b| b.parameter.clone()).collect();
        best.sort();
        best.dedup();
        println!("{name}: {runs} flights, terms tried in {tried}, offered in {asked}: {best:?}");
        for offer in offers.iter().flatten().take(2) {
            println!("{}", in_words(offer));
        }
    }
}

fn offers(runs: usize, added: &str, text: &str) -> Vec<Option<Offer>> {
    let one = |run: usize| -> Result<_, ()> { Ok(with_offer(&flight(added, 700 + run as u64), &model(text)).offer) };
    monte_carlo(runs, one, || ()).unwrap()
}

/// Flights in which terms were tried, and in which one was offered.
fn counts(offers: &[Option<Offer>]) -> (usize, usize) {
    let asked = offers.iter().flatten().filter(|o| o.best().is_some()).count();
    (offers.iter().flatten().count(), asked)
}

/// Flights of a line; `RUNS` for more.
fn runs(standard: usize) -> usize {
    std::env::var("RUNS").ok().and_then(|text| text.parse().ok()).unwrap_or(standard)
}

/// A flight of JSBSim's `F80C` (`scripts/field/make.py`, strangers, `calm-short`), whose elevator makes half of the motion of its drag. A model without that
/// contradicts the flight and was refused as a whole; its lift and its pitching moment are right with and without the term.
#[test]
fn a_term_that_is_missing_in_the_drag_leaves_lift_and_moment_standing() {
    let tests = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/offer");
    let model = ModelFile::open(tests.join("f80c-longitudinal.toml")).unwrap();
    let record = Record::open(tests.join("f80c-calm-short.csv")).unwrap();
    let with = |structure| {
        let options = EstimateOptions { structure, ..EstimateOptions::default() };
        estimate(&record, &model, &options, &mut |_| ()).unwrap()
    };
    let alone = with(StructureSearch::Never);
    assert!(alone.reasons.iter().any(|reason| reason.code == ReasonCode::Contradiction), "{:?}", alone.verdict);
    assert!(alone.parameters.iter().all(|p| p.status != FinalStatus::Converged));

    let offered = with(StructureSearch::Offer);
    assert_eq!(offered.status, EstimationStatus::Doubtful, "{:?}", offered.verdict);
    assert!(is_in_part(&offered.reasons), "{:?}", offered.reasons);
    let concerns = &offered.reasons[0].concerns;
    assert!(["CD_0", "CD_alpha", "CD_alpha2"].iter().all(|name| concerns.iter().any(|c| c == name)), "{concerns:?}");
    for (name, truth) in [("CL_alpha", 2.864), ("Cm_alpha", -0.2645), ("Cm_q", -27.05), ("Cm_elevator", -0.5488)] {
        let p = offered.parameter(name).unwrap();
        assert_eq!(p.status, FinalStatus::Converged, "{p:?}");
        assert!((p.value - truth).abs() < 2.0 * p.corrected_std_error, "{p:?}");
        // The numbers stay those of the model as it was given.
        assert!((p.value - alone.parameter(name).unwrap().value).abs() < 1e-12);
    }
    assert!(offered.parameters.iter().all(|p| p.name.starts_with("CD_") <= (p.status != FinalStatus::Converged)));
    assert_eq!(with(StructureSearch::Auto).status, EstimationStatus::Sound);
}
