//! The printed laws over all plant cases: what becomes of them, and which condition decides it.

use std::sync::atomic::{AtomicUsize, Ordering};

use crate::entry::Entry;
use crate::plant_case;
use crate::result::Reproduction;
use crate::result::{Behaviour, Outcome, Requirement, Role};
use phugoid_evaluation::accuracy::StudyError;
use phugoid_evaluation::monte_carlo::monte_carlo;
use phugoid_evaluation::table::{Cell, Column, Table};

/// Entry of the summary.
pub(crate) const ENTRIES: &[Entry] =
    &[Entry { id: "laws/summary", title: "What becomes of the printed laws, and which condition decides it", run }];

const BEHAVIOURS: [Behaviour; 5] =
    [Behaviour::Converges, Behaviour::Unfinished, Behaviour::Biased, Behaviour::Chatters, Behaviour::Diverges];

fn run(id: &str, progress: &(dyn Fn(f64) + Sync)) -> Result<Reproduction, StudyError> {
    let cases = plant_case::ENTRIES;
    let done = AtomicUsize::new(0);
    // The same runs as those of the cases' own pages.
    let results = monte_carlo(
        cases.len(),
        |k| (cases[k].run)(cases[k].id, &|_| ()),
        || progress((done.fetch_add(1, Ordering::Relaxed) + 1) as f64 / cases.len() as f64),
    )?;
    let outcomes: Vec<(&str, &Outcome)> =
        results.iter().flat_map(|r| r.outcomes.iter().map(|outcome| (r.id.as_str(), outcome))).collect();
    let counts = counts(&outcomes);
    Ok(Reproduction {
        id: id.to_owned(),
        title: ENTRIES[0].title.to_owned(),
        place: "tables 4.1 to 4.6".to_owned(),
        published: "The estimates of all these cases converge.".to_owned(),
        reconstruction:
            "The settings of each case, most of which the text at hand has lost, are given on the page of the case; \
                         none was tuned until a law converged."
                .to_owned(),
        difference: DIFFERENCE.to_owned(),
        requirements: requirements(&outcomes),
        tables: vec![counts.clone(), laws(&outcomes), published_times(&outcomes)],
        golden: counts,
        ..Reproduction::default()
    })
}

const DIFFERENCE: &str = "Evaluated as a block diagram does, with a delay of one sample in its algebraic loop, the printed law \
    converges nowhere: the loop multiplies an error by |z|/eta per sample, far above 1 with the printed eta. Solved at every \
    sample, the law for one parameter works where its slope keeps its sign and the gain K leaves the loop a solution; eta moves \
    its rest by |theta| eta/lambda in the energy. The law for two parameters asks for a point on a line, and which one it takes is \
    decided by lambda1/lambda2: it has one equation for two unknowns at every instant. Whatever a published run used that is \
    lost here, it cannot have changed the rank.";

/// How often a method does what.
fn counts(outcomes: &[(&str, &Outcome)]) -> Table {
    let mut methods: Vec<&str> = Vec::new();
    for (_, outcome) in outcomes {
        if !methods.contains(&outcome.method.as_str()) {
            methods.push(&outcome.method);
        }
    }
    let rows = methods
        .into_iter()
        .map(|method| {
            let count = |behaviour| {
                outcomes.iter().filter(|(_, o)| o.method == method && o.behaviour == behaviour).count() as f64
            };
            std::iter::once(Cell::from(method)).chain(BEHAVIOURS.map(|b| Cell::from(count(b)))).collect()
        })
        .collect();
    Table {
        title: "Cases in which a method does what".to_owned(),
        columns: std::iter::once("method")
            .chain(BEHAVIOURS.map(Behaviour::word))
            .map(|name| Column::new(name, ""))
            .collect(),
        rows,
    }
}

/// Every law in every case, with the condition.
fn laws(outcomes: &[(&str, &Outcome)]) -> Table {
    Table {
        title: "The laws, case by case".to_owned(),
        columns: ["case", "law", "what becomes of it", "condition that decides it"]
            .map(|name| Column::new(name, ""))
            .to_vec(),
        rows: outcomes
            .iter()
            .filter(|(_, outcome)| matches!(outcome.role, Role::Published | Role::Mended))
            .map(|(id, outcome)| {
                vec![
                    Cell::from(*id),
                    Cell::from(outcome.method.as_str()),
                    Cell::from(outcome.behaviour.word()),
                    Cell::from(outcome.condition.as_str()),
                ]
            })
            .collect(),
    }
}

/// Published times beside those of the flagship and of the printed law, solved.
fn published_times(outcomes: &[(&str, &Outcome)]) -> Table {
    let time = |id: &str, method: &str, j: usize| {
        let outcome = outcomes.iter().find(|(of, o)| *of == id && o.method == method);
        outcome.and_then(|(_, o)| o.parameters.get(j)).and_then(|p| p.converged_s)
    };
    let flagship = outcomes.iter().filter(|(_, outcome)| outcome.role == Role::Flagship);
    Table {
        title: "Time to 5 %".to_owned(),
        columns: [
            ("case", ""),
            ("parameter", ""),
            ("published", "s"),
            ("flagship", "s"),
            ("printed law, implicit", "s"),
        ]
        .map(|(name, unit)| Column::new(name, unit))
        .to_vec(),
        rows: flagship
            .flat_map(|(id, outcome)| {
                outcome.parameters.iter().enumerate().map(move |(j, p)| {
                    vec![
                        Cell::from(*id),
                        Cell::from(p.name.as_str()),
                        Cell::from(p.published_s),
                        Cell::from(p.converged_s),
                        Cell::from(time(id, "printed law, implicit", j)),
                    ]
                })
            })
            .collect(),
    }
}

fn requirements(outcomes: &[(&str, &Outcome)]) -> Vec<Requirement> {
    let flagship: Vec<_> = outcomes.iter().filter(|(_, outcome)| outcome.role == Role::Flagship).collect();
    let in_time = flagship
        .iter()
        .filter(|(_, outcome)| {
            outcome.parameters.iter().all(|p| p.published_s.zip(p.converged_s).is_some_and(|(limit, t)| t <= limit))
        })
        .count();
    vec![Requirement {
        what: "flagship: every parameter of every case within 5 % no later than published".to_owned(),
        limit: format!("{} cases", flagship.len()),
        found: format!("{in_time} cases"),
        met: in_time == flagship.len(),
    }]
}
