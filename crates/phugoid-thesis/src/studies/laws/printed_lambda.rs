//! The lambda that tables 4.7 and 4.8 print, in each way in which it can be read.

use std::sync::atomic::{AtomicUsize, Ordering};

use super::draw::note;
use crate::aircraft_case::{AircraftCase, MethodRun, NamedMethod, fly, published_case, run_method};
use crate::plant_case::verdict::{TOLERANCE, behaviour};
use crate::result::{Behaviour, Reproduction, Requirement, Role};
use phugoid_evaluation::accuracy::StudyError;
use phugoid_evaluation::monte_carlo::monte_carlo;
use phugoid_evaluation::settling::settled_at;
use phugoid_evaluation::table::{Cell, Column, Table};

/// "lambda = 10 7" of table 4.7: two numbers, or an exponent with and without a lost sign. 1/s.
const ALPHA_READINGS: [(&str, f64); 4] = [("ours: 10", 10.0), ("7", 7.0), ("1e7", 1e7), ("1e-7", 1e-7)];
/// "lambda = 2 4" of table 4.8. 1/s.
const Q_READINGS: [(&str, f64); 6] =
    [("ours: 10", 10.0), ("2", 2.0), ("4", 4.0), ("2^4", 16.0), ("2e4", 2e4), ("2^-4", 0.0625)];
/// The cases of the two tables.
const CASES: [&str; 7] = ["dcm-alpha/1", "dcm-alpha/2", "dcm-alpha/3", "dcm-alpha/4", "dcm-q/1", "dcm-q/2", "dcm-q/3"];

/// What became of one law in one case with one reading.
struct Row {
    case: &'static str,
    reading: &'static str,
    lambda: f64,
    /// `lambda` times the time between samples.
    step: f64,
    laws: Vec<Law>,
}

struct Law {
    name: String,
    behaviour: Behaviour,
    settled_s: Option<f64>,
    /// Part of the samples from half a second after the first move of the elevator on at which the estimate is within 5 %.
    within: f64,
    /// Last estimate over the truth.
    end: f64,
}

/// `laws/printed-lambda`.
pub(super) fn run(id: &str, progress: &(dyn Fn(f64) + Sync)) -> Result<Reproduction, StudyError> {
    let runs: Vec<(&'static str, &'static str, f64)> = CASES
        .into_iter()
        .flat_map(|case| {
            let readings: &[(&str, f64)] = if case.starts_with("dcm-q") { &Q_READINGS } else { &ALPHA_READINGS };
            readings.iter().map(move |(reading, lambda)| (case, *reading, *lambda))
        })
        .collect();
    let done = AtomicUsize::new(0);
    let rows = monte_carlo(
        runs.len(),
        |k| {
            let (case, reading, lambda) = runs[k];
            one(case, reading, lambda)
        },
        || progress((done.fetch_add(1, Ordering::Relaxed) + 1) as f64 / runs.len() as f64),
    )?;
    let mut golden = Table::default();
    for row in &rows {
        for law in row.laws.iter().filter(|law| !matches!(law.behaviour, Behaviour::Chatters | Behaviour::Diverges)) {
            note(&mut golden, format!("{}, lambda {}, {}: end over truth", row.case, row.lambda, law.name), law.end);
        }
    }
    let all = |has: &dyn Fn(&Row, &Law) -> bool| {
        let judged = || rows.iter().flat_map(|row| row.laws.iter().map(move |law| (row, law)));
        judged().filter(|(row, law)| has(row, law)).map(|(_, law)| law).collect::<Vec<_>>()
    };
    let diverging = |laws: &[&Law]| laws.iter().filter(|law| law.behaviour == Behaviour::Diverges).count();
    let requirement = |what: &str, laws: &[&Law]| Requirement {
        what: what.to_owned(),
        limit: format!("{} runs", laws.len()),
        found: format!("{} runs", diverging(laws)),
        met: !laws.is_empty() && diverging(laws) == laws.len(),
    };
    let delayed = all(&|_, law| law.name.ends_with("one-sample delay"));
    let unstable = all(&|row, law| row.step >= 2.0 && law.name == "printed law, implicit");
    Ok(Reproduction {
        requirements: vec![
            requirement("printed law with a delay of one sample: diverges with every reading", &delayed),
            requirement("printed law solved at every sample: diverges with every reading of lambda h >= 2", &unstable),
        ],
        id: id.to_owned(),
        title: "The printed lambda of tables 4.7 and 4.8, in each reading".to_owned(),
        place: "tables 4.7 and 4.8".to_owned(),
        published: "Table 4.7 prints \"lambda = 10 7\" and table 4.8 \"lambda = 2 4\"; the estimates converge.".to_owned(),
        reconstruction: "Whether two numbers are printed or one with an exponent, and whether the exponent has lost a minus sign, \
                         cannot be told from the text at hand. Each reading is run on the flights of the cases with all else as \
                         in their files; ours is the lambda of the files."
            .to_owned(),
        difference: DIFFERENCE.to_owned(),
        tables: vec![table(&rows)],
        golden,
        ..Reproduction::default()
    })
}

const DIFFERENCE: &str = "With a delay of one sample in its loop the printed law diverges in every case with every reading. Solved at \
    every sample it is stable for lambda h < 2 (theory, section 10): at 100 Hz readings with a large exponent (1e7, 2e4) cannot have \
    been run, they would need samples every 0.2 us and 0.1 ms, and here they diverge in every case. Table 4.7: 7 and 10 do the same, \
    converge in all four cases and are within 5 % at 99 % of the samples; with 1e-7 nothing leads the estimate back after a crossing, \
    and it diverges. Table 4.8: 2, 4, 10 and 16 are within 5 % at 88 to 96 % of the samples of the sines (cases 1 and 2) and leave \
    them at every crossing; in case 3, the doublet, 10 and 16 converge after 18.8 s (18 s is published), 4 chatters, and 2 and 2^-4 \
    do not come back. So 2^4 fits table 4.8, and a lambda of some 10 1/s table 4.7; the text does not prove either. The damped law holds \
    lambda h at 0.5 or less, so that a large reading does it no harm.";

/// Flies a case and runs the laws of its file with another lambda.
fn one(id: &'static str, reading: &'static str, lambda: f64) -> Result<Row, StudyError> {
    let mut case: AircraftCase = published_case(id)?;
    case.parameters.values_mut().for_each(|told| told.lambda = lambda);
    let flight = fly(&case)?;
    let methods = case.methods()?;
    // The printed law, and of its mended forms the one that has no bias.
    let laws = methods.iter().filter(|method| method.role == Role::Published || method.name.starts_with("damped"));
    let laws = laws.map(|method| law(&case, method, &run_method(&case, &flight, method)?)).collect::<Result<_, _>>()?;
    let time = &flight.measured.time;
    let step = lambda * time.get(1).zip(time.first()).map_or(f64::NAN, |(second, first)| second - first);
    Ok(Row { case: id, reading, lambda, step, laws })
}

fn law(case: &AircraftCase, method: &NamedMethod, run: &MethodRun) -> Result<Law, StudyError> {
    let none = || StudyError::Unsuitable(format!("{}: the case has no coefficient to find", case.title));
    let found = run.parameters.first().ok_or_else(none)?;
    let told = case.parameters.get(&found.name).ok_or_else(none)?;
    let truth = case.truth(&found.name);
    // The elevator moves from 3 s on in all these cases.
    let judged = run.time_s.iter().zip(&found.values).filter(|(time, _)| **time >= 3.5);
    let (all, within) = judged.fold((0_usize, 0_usize), |(all, within), (_, value)| {
        (all + 1, within + usize::from((value / truth - 1.0).abs() <= TOLERANCE))
    });
    Ok(Law {
        name: method.name.clone(),
        behaviour: behaviour(&run.time_s, &found.values, truth, [told.lower, told.upper]),
        settled_s: settled_at(&run.time_s, &found.values, truth, TOLERANCE),
        within: within as f64 / all.max(1) as f64,
        end: found.values.last().map_or(f64::NAN, |value| value / truth),
    })
}

fn table(rows: &[Row]) -> Table {
    let columns = [
        ("case", ""),
        ("reading", ""),
        ("lambda", "1/s"),
        ("lambda h", ""),
        ("law", ""),
        ("what becomes of it", ""),
        ("within 5 % from", "s"),
        ("samples within 5 %", "%"),
        ("end over truth", ""),
    ];
    let lines = rows.iter().flat_map(|row| {
        row.laws.iter().map(|law| {
            vec![
                Cell::from(row.case),
                Cell::from(row.reading),
                Cell::from(row.lambda),
                Cell::from(row.step),
                Cell::from(law.name.as_str()),
                Cell::from(law.behaviour.word()),
                Cell::from(law.settled_s),
                Cell::from(100.0 * law.within),
                Cell::from(law.end),
            ]
        })
    });
    Table {
        title:
            "The laws with each reading of lambda (samples from half a second after the first move of the elevator on)"
                .to_owned(),
        columns: columns.map(|(name, unit)| Column::new(name, unit)).to_vec(),
        rows: lines.collect(),
    }
}
