//! The result of `phugoid reproduce` as text.

use std::fmt::Write as _;

use phugoid_evaluation::table::{self, Cell};
use phugoid_report::NotRun;
use phugoid_thesis::group::group_of;
use phugoid_thesis::result::{Behaviour, Outcome, Reproduction, Requirement, Role};

use super::Written;
use crate::output::{Table, significant, wrapped};

/// One case with all details, or one or two rows for each of several; then the number of requirements that are met, and
/// the files that were written.
pub(super) fn text(reproductions: &[Reproduction], not_run: &[NotRun], written: &Written) -> String {
    let mut text = match reproductions {
        [] => String::new(),
        [only] => case(only),
        several => overview(several),
    };
    let missed: Vec<(&str, &Requirement)> = reproductions
        .iter()
        .flat_map(|r| r.requirements.iter().filter(|q| !q.met).map(|q| (r.id.as_str(), q)))
        .collect();
    let all: usize = reproductions.iter().map(|r| r.requirements.len()).sum();
    // Writing to a string cannot fail, here and below.
    let _ = match (all, missed.len()) {
        (0, _) => writeln!(text, "\nNothing was required."),
        (_, 0) => writeln!(text, "\nRequirements: all {all} met."),
        (_, missed) => writeln!(text, "\nRequirements: {} of {all} met, {missed} NOT met:", all - missed),
    };
    for (id, requirement) in &missed {
        let Requirement { what, limit, found, .. } = requirement;
        text.push_str(&wrapped(&format!("{id}: {}; required {limit}, found {found}", what.trim_end_matches('.'))));
    }
    for NotRun { id, reason } in not_run {
        let _ = writeln!(text, "\nNo result: {id}\n{}", wrapped(reason).trim_end());
    }
    let _ = writeln!(text, "\nReport with figures: {}", written.report.display());
    let _ = writeln!(text, "Numbers as CSV and JSON in {}", written.folder.display());
    if written.figures > 0 {
        let _ = writeln!(text, "{} figure files in {}", written.figures, written.folder.join("figures").display());
    }
    text
}

fn overview(reproductions: &[Reproduction]) -> String {
    let mut table = Table::with_words(&["case", "parameter", "published", "ours", "met", "printed law"], &[0, 1, 5]);
    for reproduction in reproductions {
        let ours = reproduction.outcomes.iter().find(|o| o.role == Role::Flagship);
        let parameters = ours.map_or(&[][..], |o| &o.parameters);
        let met = reproduction.requirements.iter().filter(|r| r.met).count();
        let met = match reproduction.requirements.len() {
            0 => "-".to_owned(),
            all => format!("{met}/{all}"),
        };
        for row in 0..parameters.len().max(1) {
            let parameter = parameters.get(row);
            let first = |text: String| if row == 0 { text } else { String::new() };
            table.row([
                first(reproduction.id.clone()),
                parameter.map_or_else(|| "-".to_owned(), |p| p.name.clone()),
                seconds(parameter.and_then(|p| p.published_s), "-"),
                parameter.map_or_else(|| "-".to_owned(), |p| seconds(p.converged_s, "never")),
                first(met.clone()),
                first(printed(&reproduction.outcomes)),
            ]);
        }
    }
    format!(
        "{}\nSeconds from the start of the record until the estimate stays within 5 % of the truth.\n",
        table.render()
    )
}

/// The outcome of the published laws: each by name, or only their numbers if there are many.
fn printed(outcomes: &[Outcome]) -> String {
    let laws: Vec<&Outcome> = outcomes.iter().filter(|o| o.role == Role::Published).collect();
    let told: Vec<String> = match laws.len() {
        0 => return "-".to_owned(),
        1..=3 => laws
            .iter()
            .map(|o| format!("{} ({})", o.behaviour.word(), o.method.trim_start_matches("printed law, ")))
            .collect(),
        _ => Behaviour::ALL
            .iter()
            .map(|behaviour| (behaviour.word(), laws.iter().filter(|o| o.behaviour == *behaviour).count()))
            .filter(|(_, count)| *count > 0)
            .map(|(word, count)| format!("{count} x {word}"))
            .collect(),
    };
    told.join(", ")
}

fn seconds(time: Option<f64>, without: &str) -> String {
    time.map_or_else(|| without.to_owned(), |s| format!("{} s", significant(s, 3)))
}

/// All details of one case, without its figures.
fn case(reproduction: &Reproduction) -> String {
    let mut text = format!("{}  {}\n", reproduction.id, reproduction.title);
    if !reproduction.place.is_empty() {
        let _ = writeln!(text, "{}", reproduction.place);
    }
    section(&mut text, "Published", &reproduction.published);
    section(&mut text, "Reconstructed", &reproduction.reconstruction);
    outcomes(&mut text, &reproduction.outcomes);
    for table in &reproduction.tables {
        let _ = write!(text, "\n{}\n{}", table.title, plain(table));
    }
    if !reproduction.requirements.is_empty() {
        text.push_str("\nRequired\n");
        for Requirement { what, limit, found, met } in &reproduction.requirements {
            let verdict = if *met { "met    " } else { "NOT MET" };
            text.push_str(&wrapped(&format!("{verdict}  {}: {limit}; found {found}", what.trim_end_matches('.'))));
        }
    }
    section(&mut text, "What differs, and why", &reproduction.difference);
    let group = group_of(&reproduction.id);
    let headings = group.theory.iter().map(|heading| format!("docs/theory.md, \"{heading}\""));
    let beside: Vec<String> = headings.chain(group.code.iter().map(|file| (*file).to_owned())).collect();
    section(&mut text, "Read beside it", &beside.join("; "));
    text
}

fn section(text: &mut String, heading: &str, words: &str) {
    if !words.trim().is_empty() {
        let _ = writeln!(text, "\n{heading}");
        words.split("\n\n").for_each(|paragraph| text.push_str(&wrapped(&paragraph.trim().replace('\n', " "))));
    }
}

fn outcomes(text: &mut String, outcomes: &[Outcome]) {
    if outcomes.is_empty() {
        return;
    }
    text.push_str("\nResult\n");
    let heads =
        ["method", "behaviour", "parameter", "truth", "start", "end", "error %", "2 sigma", "published", "found"];
    let mut table = Table::with_words(&heads, &[0, 1, 2]);
    for outcome in outcomes {
        let named = [outcome.method.clone(), outcome.behaviour.word().to_owned()];
        if outcome.parameters.is_empty() {
            table.row(named.clone());
        }
        for (row, p) in outcome.parameters.iter().enumerate() {
            let [method, behaviour] = if row == 0 { named.clone() } else { Default::default() };
            table.row([
                method,
                behaviour,
                p.name.clone(),
                significant(p.truth, 4),
                significant(p.start, 4),
                significant(p.end, 5),
                significant(100.0 * (p.end - p.truth) / p.truth.abs(), 2),
                p.std_error.map_or_else(|| "-".to_owned(), |s| significant(2.0 * s, 2)),
                seconds(p.published_s, "-"),
                seconds(p.converged_s, "never"),
            ]);
        }
    }
    text.push_str(&table.render());
    for outcome in outcomes.iter().filter(|o| !o.condition.is_empty()) {
        text.push_str(&wrapped(&format!("{}: {}", outcome.method, outcome.condition)));
    }
}

fn plain(content: &table::Table) -> String {
    let words = |column: usize| !content.rows.iter().any(|row| matches!(row.get(column), Some(Cell::Number(_))));
    let heads: Vec<String> = content
        .columns
        .iter()
        .map(|c| if c.unit.is_empty() { c.name.clone() } else { format!("{} ({})", c.name, c.unit) })
        .collect();
    let left: Vec<usize> = (0..heads.len()).filter(|k| words(*k)).collect();
    let mut table = Table::with_words(&heads.iter().map(String::as_str).collect::<Vec<_>>(), &left);
    for row in &content.rows {
        table.row(row.iter().map(|cell| match cell {
            Cell::Number(value) => significant(*value, 5),
            Cell::Text(words) => words.clone(),
        }));
    }
    table.render()
}
