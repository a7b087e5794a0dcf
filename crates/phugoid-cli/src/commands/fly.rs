//! `phugoid fly`.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use phugoid_control::margin::Margin;
use phugoid_flight_data::output_file;
use phugoid_recovery::controller::NAMES;
use phugoid_recovery::flight::{Event, History, RecoveryError, RecoveryFlight, Settings, fly};
use phugoid_recovery::outcome::{Left, Outcome};
use phugoid_recovery::page::{
    NO_PERFORMANCE, UNEXPLAINED, condition_words, ended_words, forces_words, level_words, lost_words, no_margin, page,
    performance_rows,
};
use phugoid_recovery::performance::Performance;
use phugoid_recovery::study::damage;
use phugoid_report::study_html;
use serde::Serialize;

use super::estimate::model;
use super::recovery::FIRST_SEED;
use super::simulate::{failure as flight_failure, scenario};
use crate::arguments;
use crate::failure::Failure;
use crate::output::{Table, json, print, significant};
use crate::progress::Progress;

/// The result as a JSON document. SI and radians.
#[derive(Serialize)]
struct Document<'a> {
    scenario: &'a str,
    control: phugoid_recovery::flight::Control,
    events: &'a [Event],
    outcome: &'a Outcome,
    /// What the estimate says is left; null for a control without one.
    left: Option<Left>,
    /// Whether the last estimate explains how the aircraft turned in the last seconds; null for a control without one. Whether it explains
    /// lift and drag stands under `performance`, `forces`.
    explained: Option<bool>,
    /// What the aircraft can still do, by the last estimate; null for a control without one, and where too little was flown since the
    /// last change.
    performance: Option<&'a Performance>,
    /// What is left in truth.
    truly_left: &'a Left,
    /// Which part of the aircraft the adopted changes look like; null where none was adopted.
    lost: Option<phugoid_control::lost::Name>,
    page: PathBuf,
    #[serde(skip_serializing_if = "Option::is_none")]
    history: Option<&'a History>,
}

pub(crate) fn run(arguments: &arguments::Fly) -> Result<(), Failure> {
    let mut scenario = scenario(&arguments.scenario)?;
    match arguments.damage {
        Some(number) => {
            scenario = damage(&scenario, number, arguments.seed.unwrap_or(FIRST_SEED)).map_err(failure)?;
        }
        None => scenario.seed = arguments.seed.unwrap_or(scenario.seed),
    }
    let model = model(&arguments.model)?;
    let defaults = Settings::default();
    let settings = Settings {
        control: arguments.control.into(),
        form: arguments.form.into(),
        excitation: defaults.excitation.filter(|_| !arguments.no_excitation),
        method: arguments.method.or(defaults.method),
        ..defaults
    };
    let flight = {
        let _progress = Progress::spinner("flying");
        fly(&scenario, &settings, &model).map_err(failure)?
    };
    let out = &arguments.out;
    std::fs::create_dir_all(out).map_err(|e| Failure::writing(out, e))?;
    let place = out.join("flight.html");
    output_file::write(&place, study_html(&html(arguments, &flight))).map_err(|e| Failure::writing(&place, e))?;
    let document = Document {
        scenario: &flight.scenario,
        control: flight.control,
        events: &flight.events,
        outcome: &flight.outcome,
        left: flight.left,
        explained: flight.explained,
        performance: flight.performance.as_ref(),
        truly_left: &flight.truly_left,
        lost: flight.lost,
        page: place.clone(),
        history: arguments.history.then_some(&flight.history),
    };
    if arguments.json { print(&json(&document)?) } else { print(&text(&flight, &place)) }
}

fn html(arguments: &arguments::Fly, flight: &RecoveryFlight) -> phugoid_report::StudyPage {
    let sections = page(flight).into_iter().map(|section| phugoid_report::StudySection {
        anchor: section.anchor.to_owned(),
        heading: section.heading.to_owned(),
        paragraphs: section.paragraphs,
        tables: section.tables,
        charts: section.charts,
    });
    let which = match (arguments.damage, arguments.seed) {
        (Some(number), seed) => format!(" --damage {number} --seed {}", seed.unwrap_or(FIRST_SEED)),
        (None, Some(seed)) => format!(" --seed {seed}"),
        (None, None) => String::new(),
    };
    let facts = [("Control", flight.control.word().to_owned()), ("Ended", ended_words(&flight.outcome))];
    phugoid_report::StudyPage {
        title: flight.scenario.clone(),
        by: "Flown by Phugoid".to_owned(),
        notes: vec![format!(
            "Made with `phugoid fly {}{} --control {}`.",
            arguments.scenario,
            which,
            flight.control.word()
        )],
        facts: facts.into_iter().map(|(name, value)| (name.to_owned(), value)).collect(),
        sections: sections.collect(),
    }
}

/// An input error if the scenario or the model is wrong, else a task without an answer.
pub(super) fn failure(error: RecoveryError) -> Failure {
    match error {
        RecoveryError::Flight(error) => flight_failure(error),
        RecoveryError::Estimate(error) => error.into(),
        RecoveryError::NoGains => Failure::impossible(error),
        RecoveryError::Ledger(_) => Failure::Output(error.to_string()),
        other => Failure::input(other),
    }
}

fn text(flight: &RecoveryFlight, page: &Path) -> String {
    let mut text = format!("{}\nControl: {}\n\n", flight.scenario, flight.control.word());
    for event in &flight.events {
        let _ = writeln!(text, "{:8.2} s  {}", event.time_s, event.text);
    }
    let outcome = &flight.outcome;
    let _ = writeln!(
        text,
        "\nEnded {} (the true aircraft with the last gains, MIL-F-8785C class IV, category B).\n\
         Load factor {} to {} g, altitude lost {} m.",
        ended_words(outcome),
        significant(outcome.load_factor[0], 2),
        significant(outcome.load_factor[1], 2),
        significant(outcome.altitude_lost_m, 2)
    );
    if flight.explained == Some(false) {
        let _ = writeln!(text, "\n{UNEXPLAINED}");
    }
    if let Some(words) = flight.performance.as_ref().and_then(forces_words) {
        let _ = writeln!(text, "\n{words}");
    }
    if let Some(name) = &flight.lost {
        let _ = writeln!(text, "\n{}", lost_words(name));
    }
    if let Some(left) = &flight.left {
        let _ = writeln!(text, "\nWhat the estimate says is left: flying qualities {}", level_words(left));
        let degrees = |angle: f64| significant(angle.to_degrees(), 3);
        let mut table = Table::new(&["surface", "takes, deg", "+- 2 sigma", "left", "at least", "true"]);
        for ((name, margin), truth) in NAMES.iter().zip(&left.margins).zip(&flight.truly_left.margins) {
            let percent = |margin: &Margin, part: f64| {
                no_margin(margin).map_or_else(|| format!("{} %", significant(100.0 * part, 3)), str::to_owned)
            };
            table.row([
                (*name).to_owned(),
                degrees(margin.trim),
                degrees(2.0 * margin.std_error),
                percent(margin, margin.left),
                percent(margin, margin.at_least),
                percent(truth, truth.left),
            ]);
        }
        text.push_str(&table.render());
        let _ = writeln!(text, "{}\n", condition_words(left));
        match &flight.performance {
            Some(performance) => text.push_str(&performance_text(performance)),
            None => {
                let _ = writeln!(text, "{NO_PERFORMANCE}");
            }
        }
    }
    let _ = writeln!(text, "\nWritten: {}", page.display());
    text
}

fn performance_text(performance: &Performance) -> String {
    let mut table = Table::new(&["what it can still do", "value", "+- 2 sigma", "of what"]);
    for (name, value, unit, note) in performance_rows(performance) {
        let number = |number: f64| format!("{} {unit}", significant(number, 3)).trim_end().to_owned();
        let cells = value.map_or(["not known".to_owned(), String::new()], |value| value.map(number));
        let [value, bound] = cells;
        table.row([name.to_owned(), value, bound, note]);
    }
    table.render()
}
