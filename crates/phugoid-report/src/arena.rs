//! Figures of a comparison of methods: one row for each scenario, one column for each method.

use phugoid_evaluation::arena::{Arena, Checkpoint, Coverage, EntryResult, MethodResult, Unit};

use crate::figure::{Axis, Body, Cell, Figure, Grid, Panel};
use crate::ticks::compact;

/// A ratio of this size or more has the strongest orange.
const BAD_RATIO: f64 = 5.0;

/// The figures of a comparison, each with a name that can serve as file name: error over the bound after the last
/// checkpoint (`error`), coverage after each checkpoint (`coverage-0`, ...), if errors were put in that model files declare the coverage
/// after the last one by model files that declare nothing (`coverage-undeclared`), time until all parameters are within 5 %
/// (`settled`), and, if there was damage, the changes found (`changes`).
pub fn arena_figures(arena: &Arena) -> Vec<(String, Figure)> {
    let mut figures = vec![("error".to_owned(), error(arena))];
    let checkpoints = arena.entries.iter().flat_map(|e| &e.methods).map(|m| m.checkpoints.len()).max().unwrap_or(0);
    for k in 0..checkpoints {
        figures.push((format!("coverage-{k}"), coverage(arena, k)));
    }
    if arena.entries.iter().any(|e| e.silent) {
        figures.push(("coverage-undeclared".to_owned(), undeclared(arena, checkpoints.max(1) - 1)));
    }
    figures.push(("settled".to_owned(), settled(arena)));
    if arena.entries.iter().any(|e| e.damaged) {
        figures.push(("changes".to_owned(), changes(arena)));
    }
    figures
}

/// A figure with a cell for each of these scenarios and each method.
fn figure(
    arena: &Arena,
    title: String,
    caption: &str,
    entries: &[&EntryResult],
    cell: impl Fn(&EntryResult, &MethodResult) -> Cell,
) -> Figure {
    let grid = Grid {
        rows: entries.iter().map(|e| e.title.clone()).collect(),
        columns: arena.methods.clone(),
        cells: entries.iter().map(|e| e.methods.iter().map(|m| cell(e, m)).collect()).collect(),
    };
    let panel = Panel { y: Axis::default(), x: None, height: 0.0, body: Body::Grid(grid) };
    Figure { title, caption: caption.to_owned(), panels: vec![panel], ..Figure::default() }
}

fn all(arena: &Arena) -> Vec<&EntryResult> {
    arena.entries.iter().collect()
}

/// A cell without a value.
fn absent(words: &str) -> Cell {
    Cell { words: words.to_owned(), tone: f64::NAN, strong: false }
}

/// The cell of a method that failed in every flight; `None` for the others.
fn failed(method: &MethodResult) -> Option<Cell> {
    let empty = method.checkpoints.iter().all(|c| c.accuracy.is_none()) && method.failed > 0;
    empty.then(|| Cell { words: "failed".to_owned(), tone: -1.0, strong: false })
}

/// The duration until a checkpoint in words.
fn cycles(arena: &Arena, checkpoint: usize) -> String {
    let of = |m: &MethodResult| m.checkpoints.get(checkpoint).map(|c| c.cycles);
    let cycles = arena.entries.iter().flat_map(|e| &e.methods).find_map(of).unwrap_or(f64::NAN);
    if cycles == 1.0 { "one short-period cycle".to_owned() } else { format!("{} cycles", compact(cycles, 2)) }
}

fn error(arena: &Arena) -> Figure {
    let last = arena.entries.iter().flat_map(|e| &e.methods).map(|m| m.checkpoints.len()).max().unwrap_or(1).max(1) - 1;
    let title = format!("Root mean square error over the bound (–) after {}", cycles(arena, last));
    let caption = "Geometric mean over the parameters. 1 is the Cramer-Rao bound: what the best unbiased estimator can reach \
                   (* without gusts; † no bound exists, the unit is the prior's standard deviation). Bold: the smallest of the row. \
                   Orange: the more, the farther from the bound, or in the marked rows from the best.";
    let mut figure = figure(arena, title, caption, &all(arena), |entry, method| {
        let of = |m: &MethodResult| m.checkpoints.last().and_then(|c| c.accuracy);
        let Some(error) = of(method) else { return failed(method).unwrap_or_else(|| absent("–")) };
        let best = entry.methods.iter().filter_map(of).fold(f64::INFINITY, f64::min);
        let tone = match entry.unit {
            Unit::CramerRao if error <= 1.15 => 0.35,
            Unit::CramerRao => -((error / 1.15).ln() / BAD_RATIO.ln()).min(1.0),
            // The bound cannot be reached here, so the best method of the row is the reference.
            _ if error <= 1.15 * best => 0.35,
            _ => -((error / best / 1.15).ln() / BAD_RATIO.ln()).min(1.0),
        };
        Cell { words: ratio(error), tone, strong: error <= best }
    });
    if let Some(Panel { body: Body::Grid(grid), .. }) = figure.panels.first_mut() {
        for (row, entry) in grid.rows.iter_mut().zip(&arena.entries) {
            match entry.unit {
                Unit::CramerRao => {}
                Unit::CalmCramerRao => row.push_str(" *"),
                Unit::Prior => row.push_str(" †"),
            }
        }
    }
    figure
}

fn coverage(arena: &Arena, checkpoint: usize) -> Figure {
    let title = format!("Coverage of the claimed bounds (%) after {}", cycles(arena, checkpoint));
    let caption = "Parameters within two claimed standard errors of the truth; 95 is what they promise. Blue: 90 to 99 %, or not \
                   significantly outside of it. Orange: bounds that are too narrow. Plain: wider than they need be.";
    figure(arena, title, caption, &all(arena), |_, method| {
        covered(method, method.checkpoints.get(checkpoint).and_then(|c: &Checkpoint| c.coverage))
    })
}

fn undeclared(arena: &Arena, checkpoint: usize) -> Figure {
    let title = format!("Coverage (%) where [uncertainty] declares nothing, after {}", cycles(arena, checkpoint));
    let caption = "The same flights, with errors that leave no trace in residuals, and bounds of noise alone. What \
                   the bounds hold with these errors declared is in the figures before.";
    let silent: Vec<&EntryResult> = arena.entries.iter().filter(|e| e.silent).collect();
    figure(arena, title, caption, &silent, |_, method| {
        covered(method, method.checkpoints.get(checkpoint).and_then(|c: &Checkpoint| c.undeclared_coverage))
    })
}

/// The cell of a coverage.
fn covered(method: &MethodResult, coverage: Option<Coverage>) -> Cell {
    let Some(c) = coverage else {
        let silent = if method.without_bounds > 0 { absent("no bounds") } else { absent("–") };
        return failed(method).unwrap_or(silent);
    };
    let tone = match c.fraction {
        _ if c.interval[1] < 0.9 => -(0.15 + (0.9 - c.fraction) / 0.5).min(1.0),
        fraction if fraction > 0.99 && c.interval[0] > 0.99 => 0.0,
        _ => 0.35,
    };
    Cell { words: format!("{:.0}", 100.0 * c.fraction), tone, strong: false }
}

fn settled(arena: &Arena) -> Figure {
    let title = "Time until every parameter is within 5 % of the truth for good (s)".to_owned();
    let caption = "Median over the flights, from the first move of the stick or from the damage on; the slowest parameter decides. \
                   Bold: the soonest of the row. Orange: the more, the later than that. A dash: not within the flight, in half of \
                   the flights or more.";
    figure(arena, title, caption, &all(arena), |entry, method| {
        let soonest = entry.methods.iter().filter_map(|m| m.settled_median_s).fold(f64::INFINITY, f64::min);
        match method.settled_median_s {
            Some(time) => {
                let late = ((time.max(0.01) / soonest.max(0.01)).ln() / BAD_RATIO.ln()).min(1.0);
                let tone = if late < 0.06 { 0.35 } else { -late };
                Cell { words: format!("{time:.2}"), tone, strong: time <= soonest }
            }
            None => failed(method).unwrap_or_else(|| absent("–")),
        }
    })
}

fn changes(arena: &Arena) -> Figure {
    let damaged: Vec<&EntryResult> = arena.entries.iter().filter(|e| e.damaged).collect();
    let title = "Damage found: flights, and median time to adoption (s)".to_owned();
    let caption = "Adopted: the changed parameters have taken the place of the former ones. Orange: missed in some flights. A dash: \
                   a method that does not look for changes, or finds none.";
    figure(arena, title, caption, &damaged, |_, method| {
        let d = &method.detection;
        if d.found == 0 {
            return failed(method).unwrap_or_else(|| absent("–"));
        }
        let missed = 1.0 - d.found as f64 / d.damaged.max(1) as f64;
        let after = d.latency_median_s.map_or_else(String::new, |t| format!(": {t:.2}"));
        let tone = if missed > 0.0 { -(0.2 + missed).min(1.0) } else { 0.35 };
        Cell { words: format!("{}/{}{after}", d.found, d.damaged), tone, strong: false }
    })
}

/// A ratio with about three significant digits.
pub(crate) fn ratio(value: f64) -> String {
    match value {
        v if !v.is_finite() => "–".to_owned(),
        v if v < 9.995 => format!("{v:.2}"),
        v if v < 99.95 => format!("{v:.1}"),
        v if v < 9999.5 => format!("{v:.0}"),
        v => compact(v, 1),
    }
}
