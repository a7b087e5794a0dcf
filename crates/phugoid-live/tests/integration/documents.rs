//! What the documents say: when it began, readiness where it was renewed, the true airspeed.
// What goes wrong in a helper fails the test.
#![allow(clippy::unwrap_used)]

use crate::telemetry;

use phugoid_identification::estimate::EstimateOptions;
use phugoid_identification::model_file::ModelFile;
use phugoid_live::arrival::{Arrival, Content};
use phugoid_live::document::DocumentKind;
use phugoid_live::engine::Engine;
use phugoid_live::receiver::ReceiverOptions;
use serde_json::Value;

const SAMPLES: u32 = 400;

fn engine() -> Engine {
    let model = ModelFile::named("f16").unwrap();
    Engine::new(&model, &EstimateOptions::default(), &ReceiverOptions::default(), "test").unwrap()
}

/// What is published of lines of text that come at once.
fn published(mut engine: Engine, text: String) -> Vec<(DocumentKind, Value)> {
    let mut documents = Vec::new();
    let mut publish = |kind: DocumentKind, text: &str| documents.push((kind, serde_json::from_str(text).unwrap()));
    engine.begin(&mut publish);
    let arrival = Arrival { arrival_ns: 1, wall_ns: 0, origin: 0, content: Content::Datagram(text.into_bytes()) };
    engine.take(&arrival, &|| 0, &mut publish);
    engine.end("test", &|| 0, &mut publish);
    documents
}

fn flight() -> String {
    telemetry::csv_header() + &telemetry::csv_rows(0..SAMPLES)
}

/// Estimates for pages with the readiness that stands, by those who keep the last of what they get.
fn whole(documents: &[(DocumentKind, Value)], only_shown: bool) -> Vec<Value> {
    let mut standing: Vec<Value> = Vec::new();
    let mut estimates = Vec::new();
    for (kind, document) in documents {
        let DocumentKind::Estimate { shown, readiness } = kind else { continue };
        if only_shown && !shown {
            continue;
        }
        let mut document = document.clone();
        let parameters = document["parameters"].as_array_mut().unwrap();
        standing.resize(parameters.len(), Value::Null);
        for (parameter, standing) in parameters.iter_mut().zip(&mut standing) {
            assert_eq!(parameter.get("readiness").is_some(), *readiness);
            match parameter.get("readiness") {
                Some(told) => *standing = told.clone(),
                None => parameter["readiness"] = standing.clone(),
            }
        }
        if *shown {
            estimates.push(document);
        }
    }
    estimates
}

#[test]
fn readiness_is_told_where_it_was_renewed_and_stands() {
    let every = published(engine().with_every_estimate(), flight());
    let shown = published(engine(), flight());
    let estimates = |documents: &[(DocumentKind, Value)], told: bool| {
        let of = |kind: &DocumentKind| matches!(kind, DocumentKind::Estimate { readiness, .. } if !told || *readiness);
        documents.iter().filter(|(kind, _)| of(kind)).count()
    };
    // Two seconds of estimates, of which pages get fifty a second; renewed ten times a second.
    assert_eq!((estimates(&every, false), estimates(&shown, false)), (200, 100));
    assert!((10..=25).contains(&estimates(&shown, true)), "{}", estimates(&shown, true));
    // Whoever gets every estimate, or of those only the ones for pages, knows the same.
    let expected = whole(&shown, true);
    assert!(expected.iter().any(|estimate| estimate["parameters"][0]["readiness"]["reason"].is_string()));
    assert!(whole(&every, false) == expected && whole(&every, true) == expected);
}

#[test]
fn the_first_document_says_when_it_began() {
    let began = published(engine().with_start(1_790_000_000_250_000_000), String::new());
    // `date -u -d @1790000000` says so.
    assert_eq!(began[0].1["started"], "2026-09-21T14:13:20.250Z");
    assert_eq!(published(engine(), String::new())[0].1["started"], Value::Null);
}

/// The flight with a calibrated airspeed in place of the true one, and further columns.
fn calibrated(names: &str, values: &str) -> String {
    let text = flight().replace("tas_m_s", "cas_m_s");
    let lines = text.lines().enumerate().map(|(k, line)| format!("{line}{}\n", if k == 0 { names } else { values }));
    lines.collect()
}

#[test]
fn a_calibrated_airspeed_becomes_the_true_one_with_the_density_of_the_air() {
    let speeds = |documents: &[(DocumentKind, Value)]| -> Vec<f64> {
        let outputs = documents[0].1["layout"]["outputs"].as_array().unwrap();
        let place = outputs.iter().position(|output| output["name"] == "true_airspeed").unwrap();
        let estimates = documents.iter().filter(|(kind, _)| matches!(kind, DocumentKind::Estimate { .. }));
        estimates.map(|(_, estimate)| estimate["outputs"][place].as_f64().unwrap()).collect()
    };
    let sent = speeds(&published(engine(), flight()));
    // Air in which V is 1.1 times the equivalent airspeed, by its density or by pressure and temperature (ISO 2533: 1.225 kg/m^3 at
    // sea level, R = 287.05287 J/(kg K)).
    let rho = 1.225 / 1.21;
    for (names, values) in [
        (",air_density_kg_m3", format!(",{rho}")),
        (",static_pressure_pa,temperature_k", format!(",{},270", rho * 287.052_87 * 270.0)),
    ] {
        let documents = published(engine(), calibrated(names, &values));
        let found = speeds(&documents);
        assert_eq!(found.len(), sent.len());
        // Rounding of the last bits alone.
        assert!(found.iter().zip(&sent).all(|(found, sent)| (found - 1.1 * sent).abs() < 1e-9 * sent), "{names}");
        let said = documents.iter().filter(|(_, document)| document["kind"] == "airspeed").count();
        assert_eq!(said, 1, "{names}");
    }
    // Without it there is no estimate, and it is said why and what it would cost.
    let documents = published(engine(), calibrated("", ""));
    assert!(speeds(&documents).is_empty());
    let told: Vec<String> = documents.iter().map(|(_, document)| document.to_string()).collect();
    assert!(told.iter().any(|text| text.contains("airspeed") && text.contains("35 %")), "{told:?}");
    assert!(told.iter().any(|text| text.contains("waiting") && text.contains("density of the air")), "{told:?}");
}
