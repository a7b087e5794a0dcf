//! The result of `phugoid compare` as text.

use std::fmt::Write as _;

use phugoid_evaluation::arena::{Arena, Checkpoint, EntryResult, Findings, MethodResult, ParameterScore, Unit};

use super::Written;
use crate::output::{Table, significant, wrapped};

pub(super) fn text(arena: &Arena, written: &Written) -> String {
    let mut text = format!(
        "{} scenarios, {} methods, {} flights each; every method sees the same samples\n",
        arena.entries.len(),
        arena.methods.len(),
        arena.seeds
    );
    for entry in &arena.entries {
        text.push('\n');
        text.push_str(&scenario(entry));
    }
    // Writing to a string cannot fail.
    let _ = write!(
        text,
        "\nerr: root mean square error after so many cycles over the Cramer-Rao bound (or what the heading says), geometric\n\
         mean over the parameters; worst: the parameter with the largest at the last. covered: percent of the parameters\n\
         within two claimed standard errors, in the same order. 5 %: when the slowest parameter is within 5 % of the truth\n\
         for good. found: flights in which the damage was adopted, and after what time. false: changes adopted where there\n\
         was none. time: of computing, over that of {}{}; not reproducible.\n\
         fail: flights without an estimate. -: never, or there is none.\n{}\n",
        arena.methods.first().map_or("", String::as_str),
        microseconds(arena),
        if arena.entries.iter().any(|e| e.silent) {
            "claimed: claimed standard errors over the errors, root mean squares, geometric mean over the parameters. without:\n\
             what is covered at the last of the same flights by a model file that declares no uncertainty.\n"
        } else {
            ""
        }
    );
    text.push_str("Where each method wins and loses\n");
    for sentence in &arena.findings.methods {
        text.push_str(&wrapped(sentence));
    }
    if let Some(ours) = arena.methods.first() {
        if arena.findings.ours_loses.is_empty() {
            text.push_str(&format!("\nWhere {ours} loses\n"));
            text.push_str(&wrapped(&Findings::loses_nowhere(arena.seeds)));
        } else {
            let _ = writeln!(text, "\nWhere {ours} loses");
            for sentence in &arena.findings.ours_loses {
                text.push_str(&wrapped(sentence));
            }
        }
    }
    let _ = writeln!(
        text,
        "\nReport: {}; every number of every flight: {}",
        written.report.display(),
        written.folder.join("comparison.csv").display()
    );
    text
}

/// Median computing time of the first method per sample, in brackets.
fn microseconds(arena: &Arena) -> String {
    let mut times: Vec<f64> = arena
        .entries
        .iter()
        .filter_map(|e| e.methods.first())
        .map(|m| m.microseconds)
        .filter(|t| t.is_finite())
        .collect();
    times.sort_by(f64::total_cmp);
    times.get(times.len() / 2).map_or_else(String::new, |t| format!(" ({} us per sample)", significant(*t, 2)))
}

fn scenario(entry: &EntryResult) -> String {
    let unit = match entry.unit {
        Unit::CramerRao => "",
        Unit::CalmCramerRao => "; error over the bound without gusts",
        Unit::Prior => "; error over the prior's deviation",
    };
    let mut text = format!("{} ({}{unit})\n", entry.title, entry.id);
    let cycles: Vec<String> = entry
        .methods
        .first()
        .map(|m| m.checkpoints.iter().map(|c| significant(c.cycles, 1)).collect())
        .unwrap_or_default();
    let mut heads = vec!["method".to_owned()];
    heads.extend(cycles.iter().map(|c| format!("err {c}")));
    heads.extend(["worst", "covered"].map(str::to_owned));
    if entry.silent {
        heads.extend(["claimed", "without"].map(str::to_owned));
    }
    heads.push("5 %, s".to_owned());
    if entry.damaged {
        heads.extend(["found", "in s"].map(str::to_owned));
    }
    heads.extend(["false", "time", "fail"].map(str::to_owned));
    let heads: Vec<&str> = heads.iter().map(String::as_str).collect();
    let mut table = Table::with_words(&heads, &[0, 1 + cycles.len()]);
    for method in &entry.methods {
        table.row(row(entry, method));
    }
    text.push_str(&table.render());
    for method in &entry.methods {
        if let Some(why) = &method.failure {
            text.push_str(&wrapped(&format!("{}: {}", method.method, why.lines().next().unwrap_or_default())));
        }
    }
    text
}

fn row(entry: &EntryResult, method: &MethodResult) -> Vec<String> {
    let seconds = |time: Option<f64>| time.map_or_else(|| "-".to_owned(), |t| format!("{t:.2}"));
    let mut cells = vec![method.method.clone()];
    cells.extend(method.checkpoints.iter().map(|c| c.accuracy.map_or_else(|| "-".to_owned(), ratio)));
    cells.push(
        method
            .checkpoints
            .last()
            .and_then(worst)
            .map_or_else(String::new, |p| format!("{} {}", p.name, ratio(p.rmse_over_unit))),
    );
    let covered = |c: &Checkpoint| c.coverage.map_or_else(|| "-".to_owned(), |c| format!("{:.0}", 100.0 * c.fraction));
    cells.push(method.checkpoints.iter().map(covered).collect::<Vec<_>>().join("/"));
    if entry.silent {
        let last = method.checkpoints.last();
        let over = |value: Option<f64>| value.map_or_else(|| "-".to_owned(), ratio);
        cells.push(over(last.and_then(|c| c.claimed_over_actual)));
        let fraction = last.and_then(|c| c.undeclared_coverage).map(|c| format!("{:.0}", 100.0 * c.fraction));
        cells.push(fraction.unwrap_or_else(|| "-".to_owned()));
    }
    let detection = &method.detection;
    cells.push(seconds(method.settled_median_s));
    if entry.damaged {
        cells.push(format!("{}/{}", detection.found, detection.damaged));
        cells.push(seconds(detection.latency_median_s));
    }
    cells.push(detection.false_alarms.count.to_string());
    cells.push(significant(method.relative_time, 2));
    cells.push(method.failed.to_string());
    cells
}

/// Name of the parameter with the largest error.
fn worst(checkpoint: &Checkpoint) -> Option<&ParameterScore> {
    let told = checkpoint.parameters.iter().filter(|p| p.rmse_over_unit.is_finite());
    told.max_by(|a, b| a.rmse_over_unit.total_cmp(&b.rmse_over_unit))
}

/// A ratio as text: the larger it is, the fewer decimals.
fn ratio(value: f64) -> String {
    match value {
        v if v < 9.995 => format!("{v:.2}"),
        v if v < 9999.5 => format!("{v:.0}"),
        v => format!("{v:.0e}"),
    }
}
