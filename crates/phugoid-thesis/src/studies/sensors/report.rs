//! The study of a case in tables, figures and requirements.

use std::sync::Arc;

use super::input::{CYCLE_S, ELEVATOR_LIMIT_DEG, GOAL_PERCENT, LOAD_LIMIT, START_S, Sized};
use super::seeds::RUNS;
use super::study::{Arm, PUBLISHED, Study, records_needed};
use crate::aircraft_case::AircraftCase;
use crate::flight_charts::instant;
use crate::result::Reproduction;
use crate::result::{Outcome, Requirement, Role, in_seconds};
use phugoid_evaluation::chart::{Axis, Chart, Content, Curve, Level, Meaning, Panel, Shape};
use phugoid_evaluation::table::{Cell, Column, Table};
use phugoid_simulation::manoeuvre::Manoeuvre;

/// Of the runs, those in which everything must be found in one cycle.
const REQUIRED_RUNS: usize = 38;

/// Adds the study to what running the case gave.
pub(super) fn add(reproduction: &mut Reproduction, case: &AircraftCase, study: &Study) {
    let flagship = reproduction.outcomes.iter().find(|outcome| outcome.role == Role::Flagship).cloned();
    reproduction.requirements.extend(requirements(case, study, flagship.as_ref()));
    reproduction.tables.extend([bounds(study), inputs(study), runs(study)]);
    reproduction.charts.push(information(study));
}

fn requirements(case: &AircraftCase, study: &Study, flagship: Option<&Outcome>) -> Vec<Requirement> {
    let [thesis, _, _, own] = &study.arms;
    let settled = flagship.into_iter().flat_map(|outcome| &outcome.parameters);
    let own_seed = settled.map(|parameter| Requirement {
        what: format!("{} within 5 % to stay, counted from the start of the input, seed of the file", parameter.name),
        limit: format!("one cycle of the short period, {CYCLE_S} s"),
        found: in_seconds(parameter.converged_s.map(|t| t - START_S)),
        met: parameter.converged_s.is_some_and(|t| t - START_S <= CYCLE_S + 1e-9),
    });
    let silent = thesis.together.percent.iter().filter_map(|history| history.last().copied());
    let smallest = silent.fold(f64::INFINITY, f64::min);
    let rule = &study.sized[1];
    let amplitude = amplitude_deg(&case.scenario.manoeuvre);
    own_seed
        .chain([
            Requirement {
                what: format!("all of them within 5 % to stay after one cycle, runs of {RUNS} seeds"),
                limit: format!("{REQUIRED_RUNS} of {RUNS}"),
                found: format!(
                    "{} of {RUNS} ({:.1} expected from the Cramer-Rao bound)",
                    own.seeds.all_settled,
                    own.seeds.all_expected()
                ),
                met: own.seeds.all_settled >= REQUIRED_RUNS,
            },
            Requirement {
                what: "the thesis input says nothing of the published increments: smallest Cramer-Rao bound at the end of the \
                       record, all four unknown"
                    .into(),
                limit: "above 100 % of the truth".into(),
                found: format!("{smallest:.0} %"),
                met: smallest > 100.0,
            },
            Requirement {
                what: "the amplitude of the file is that of the rule".into(),
                limit: format!("{:.3} deg, to 1 %", rule.amplitude_deg),
                found: format!("{amplitude:.3} deg"),
                met: rule.reaches_goal && (amplitude / rule.amplitude_deg - 1.0).abs() < 0.01,
            },
        ])
        .collect()
}

/// Amplitude of the only manoeuvre; NaN if there are several or it has none.
fn amplitude_deg(manoeuvres: &[Manoeuvre]) -> f64 {
    match manoeuvres {
        [
            Manoeuvre::Doublet { amplitude, .. }
            | Manoeuvre::ThreeTwoOneOne { amplitude, .. }
            | Manoeuvre::Sine { amplitude, .. },
        ] => amplitude.si().to_degrees(),
        _ => f64::NAN,
    }
}

/// The bound one cycle after the start of the input.
fn after_a_cycle(arm: &Arm, percent: &[f64]) -> f64 {
    let k = arm.together.time_s.partition_point(|t| *t <= START_S + CYCLE_S + 1e-9).saturating_sub(1);
    percent.get(k).copied().unwrap_or(f64::NAN)
}

fn bounds(study: &Study) -> Table {
    let rows = study.arms.iter().flat_map(|arm| {
        study.names.iter().enumerate().map(move |(j, name)| {
            let together = &arm.together.percent[j];
            let cycle = after_a_cycle(arm, together);
            vec![
                arm.increments.into(),
                format!("{}, {:.3} deg", arm.input, arm.amplitude_deg).into(),
                (*name).into(),
                after_a_cycle(arm, &arm.alone.percent[j]).into(),
                cycle.into(),
                together.last().copied().into(),
                (CYCLE_S * records_needed(cycle)).into(),
                (arm.amplitude_deg * records_needed(cycle).sqrt()).into(),
            ]
        })
    });
    Table {
        title: format!(
            "Cramer-Rao bound one cycle ({CYCLE_S} s) after the start of the input, and what would bring it to \
             {GOAL_PERCENT:.2} %: a longer record, or a larger input (in proportion, without regard to any limit)"
        ),
        columns: vec![
            Column::new("increments", ""),
            Column::new("input", ""),
            Column::new("coefficient", ""),
            Column::new("it alone unknown", "% of truth"),
            Column::new("all four unknown", "% of truth"),
            Column::new("all four, end of record", "% of truth"),
            Column::new("record needed, input repeated", "s"),
            Column::new("or amplitude needed", "deg"),
        ],
        rows: rows.collect(),
    }
}

fn inputs(study: &Study) -> Table {
    let row = |increments: &str, sized: &Sized| -> Vec<Cell> {
        vec![
            increments.into(),
            sized.shape.words().into(),
            sized.amplitude_deg.into(),
            sized.load.into(),
            sized.percent.into(),
            if sized.reaches_goal { "yes" } else { "no: at its limit" }.into(),
        ]
    };
    Table {
        title: format!(
            "Sized inputs. Rule: of several shapes the smallest amplitude that brings the bound of the hardest coefficient to \
             {GOAL_PERCENT:.2} % in one cycle (5 % are then three standard errors), and of those the one that loads the \
             aircraft least; limits: {LOAD_LIMIT} g of load factor beside the trim, {ELEVATOR_LIMIT_DEG} deg of elevator, \
             angle of attack within the tables"
        ),
        columns: vec![
            Column::new("increments", ""),
            Column::new("shape", ""),
            Column::new("amplitude", "deg"),
            Column::new("largest change of load factor", "g"),
            Column::new("bound of the hardest", "% of truth"),
            Column::new("reaches the goal", ""),
        ],
        rows: vec![row("published", &study.sized[0]), row("of damage", &study.sized[1])],
    }
}

fn runs(study: &Study) -> Table {
    let mut rows: Vec<Vec<Cell>> = Vec::new();
    for arm in &study.arms {
        for increment in &arm.seeds.increments {
            rows.push(vec![
                arm.increments.into(),
                format!("{}, {:.3} deg", arm.input, arm.amplitude_deg).into(),
                increment.name.clone().into(),
                increment.bound_percent.into(),
                increment.rmse_percent.into(),
                (increment.settled as f64).into(),
                increment.expected().into(),
            ]);
        }
        if arm.seeds.increments.len() > 1 {
            rows.push(vec![
                arm.increments.into(),
                format!("{}, {:.3} deg", arm.input, arm.amplitude_deg).into(),
                "all".into(),
                f64::NAN.into(),
                f64::NAN.into(),
                (arm.seeds.all_settled as f64).into(),
                arm.seeds.all_expected().into(),
            ]);
        }
    }
    Table {
        title: format!(
            "What the flagship finds in one cycle, {RUNS} runs each with its own sensor noise. Bounds and start values of the \
             published increments are those of the file in proportion; the error of an estimate that stays at its start is \
             that of the start. Expected: normal errors of the size of the bound, independent of one another"
        ),
        columns: vec![
            Column::new("increments", ""),
            Column::new("input", ""),
            Column::new("coefficient", ""),
            Column::new("Cramer-Rao bound", "% of truth"),
            Column::new("root mean square error", "% of truth"),
            Column::new("within 5 % to stay", "runs"),
            Column::new("expected", "runs"),
        ],
        rows,
    }
}

/// One panel per size of increments and coefficient.
fn information(study: &Study) -> Chart {
    let mut panels = Vec::new();
    let [low, high] = decades(study);
    for (j, name) in study.names.iter().enumerate() {
        for pair in study.arms.chunks(2) {
            let curves = pair.iter().enumerate().flat_map(|(which, arm)| {
                let x: Arc<[f64]> = arm.together.time_s.as_slice().into();
                let curve = |label: &str, meaning, percent: &[f64]| Curve {
                    label: format!("{}, {label}", if which == 0 { "thesis input" } else { "sized input" }),
                    meaning,
                    x: x.clone(),
                    shape: Shape::Line(percent.iter().map(|p| p.log10()).collect()),
                };
                [
                    curve("alone", Meaning::Method(2 * which), &arm.alone.percent[j]),
                    curve("all four unknown", Meaning::Method(2 * which + 1), &arm.together.percent[j]),
                ]
            });
            let level = |label: &str, percent: f64| Level::new(label, percent.log10(), Meaning::Bound);
            let label = if pair[0].increments == "published" {
                format!("{name}, published {}", published_truth(name))
            } else {
                format!("{name}, of damage")
            };
            panels.push(Panel {
                y: Axis::new(label, "log₁₀ of %").with_range(low, high),
                content: Content::Curves {
                    curves: curves.collect(),
                    levels: vec![level("5 %", 5.0), level("goal", GOAL_PERCENT)],
                    instants: vec![instant("one cycle", START_S + CYCLE_S)],
                },
            });
        }
    }
    Chart {
        name: "information".into(),
        title: "What the flight can tell: Cramer-Rao bound over time".into(),
        caption: format!(
            "Smallest standard error of any unbiased estimator with the sensors of the file, in percent of the truth, as its \
             decimal logarithm (0 is 1 %, 2 is 100 %). Left the published increments, right those of damage. 5 % can be \
             relied upon where the bound is below {GOAL_PERCENT:.2} %."
        ),
        x: Axis::new("Time", "s"),
        panels,
        columns: 2,
    }
}

/// Decades of percent that hold all curves after the first tenths of a second, in which nothing is known yet.
fn decades(study: &Study) -> [f64; 2] {
    const HIGHEST: f64 = 6.0;
    let histories = study.arms.iter().flat_map(|arm| arm.alone.percent.iter().chain(&arm.together.percent));
    let finite = histories.flatten().map(|percent| percent.log10()).filter(|decade| decade.is_finite());
    let [low, high] = finite.fold([0.0_f64, 1.0], |[low, high], decade| [low.min(decade), high.max(decade)]);
    [low.floor(), high.ceil().min(HIGHEST)]
}

fn published_truth(name: &str) -> String {
    let index = super::information::INCREMENTS.iter().position(|known| *known == name);
    index.map_or_else(String::new, |k| PUBLISHED[k].to_string())
}
