//! The study of recoveries: `phugoid study recovery`.

use std::fmt::Write as _;

use phugoid_recovery::flight::Settings;
use phugoid_recovery::study::{RecoveryStudy, Row, recovery};

use super::fly::failure;
use super::runs::Runs;
use crate::arguments;
use crate::failure::Failure;
use crate::output::Table;

/// Seed of the first damage where none is given: for judging. The numbers in docs/control.md that were used to choose settings are of
/// seeds from 1000.
pub(super) const FIRST_SEED: u64 = 9_000_000;

pub(super) fn recovered(arguments: &arguments::Study) -> Result<RecoveryStudy, Failure> {
    let flown = arguments.scenario.as_deref().unwrap_or("f16-recovery");
    let told = arguments.model.as_deref().unwrap_or("f16-recovery-model");
    let (scenario, model) = (super::simulate::scenario(flown)?, super::estimate::model(told)?);
    let defaults = Settings::default();
    let settings = Settings { method: arguments.method.or(defaults.method), ..defaults };
    let damages = arguments.runs as usize;
    let runs = Runs { what: "flying", study: "recovery", count: damages, sources: vec![flown, told] };
    let ledger = runs.ledger(&arguments.keeping)?;
    let first_seed = arguments.seed.unwrap_or(FIRST_SEED);
    recovery(&scenario, &model, &settings, damages, first_seed, ledger.as_ref()).map_err(failure)
}

pub(super) fn recovery_text(study: &RecoveryStudy) -> String {
    let mut text = format!(
        "{}\n{} random damages, seeds from {}, each flown with four controls\n\n",
        study.scenario, study.damages, study.first_seed
    );
    let all = study.rows.iter().filter(|row| row.class.is_none());
    let mut table = Table::new(&[
        "control",
        "flights",
        "departed",
        "level flight",
        "with level 1",
        "with level 1 or 2",
        "saved",
        "made worse",
        "new gains after",
        "90 %",
        "before the damage",
    ]);
    for row in all.clone() {
        let seconds = |s: f64| if s.is_finite() { format!("{s:.1} s") } else { "-".to_owned() };
        table.row([
            row.control.word().to_owned(),
            row.flights.to_string(),
            row.departed.to_string(),
            row.level_flight.to_string(),
            row.level_one.to_string(),
            row.recovered.to_string(),
            row.saved.to_string(),
            row.made_worse.to_string(),
            seconds(row.latency_median_s),
            seconds(row.latency_90_percent_s),
            row.without_reason.to_string(),
        ]);
    }
    text.push_str(&table.render());
    text.push_str("  saved, made worse: level flight with level 1 or 2, against fixed gains in the same damage\n\n");
    text.push_str("Level flight with level 1 or 2, by what is damaged first\n");
    let mut table = Table::new(&["damage", "flights", "fixed", "robust", "adaptive", "oracle"]);
    let classes = study.rows.iter().filter(|row| row.class.is_some());
    let rows: Vec<&Row> = classes.collect();
    for of_class in rows.chunks(phugoid_recovery::flight::Control::ALL.len()) {
        let Some(first) = of_class.first() else { continue };
        let mut cells = vec![first.class.map_or("", |class| class.word()).to_owned(), first.flights.to_string()];
        cells.extend(of_class.iter().map(|row| row.recovered.to_string()));
        table.row(cells);
    }
    text.push_str(&table.render());
    if let Some(row) = all.clone().find(|row| row.with_estimate > 0) {
        let _ = writeln!(
            text,
            "\nAt the end the estimate gives the true level of flying qualities in {} of {} flights, a better one in {}.\n\
             The surface positions of steady flight lie within two standard errors in {} of {}.",
            row.level_right, row.with_estimate, row.level_too_good, row.margins_covered, row.margins
        );
    }
    text
}
