//! Spreads rows whose times were written with too few digits, so that several neighbours have the same one.
//!
//! A recorder at 10 Hz whose clock is written to the second gives groups of ten rows with equal times. If the rows are
//! evenly spaced by `h`, the first row `k` of a group with the time `S` is the first one that is not before `S`:
//!
//! ```text
//! S <= t0 + h k < S + h        for each time S that follows the one before it by one tick
//! ```
//!
//! These inequalities bound `h` to about one row in the whole record and `t0` to one row. Where they cannot be met to
//! within a row more, the rows are not evenly spaced and nothing is done here. Between gaps of the record `t0` may differ.

use crate::quality::QualityReport;
use crate::table::time_base::Table;
use crate::wording::Short;

/// Fewest changes of the time from one tick to the next, and fewest rows: below, `h` is known too badly.
const FEWEST_TICKS: usize = 4;
const FEWEST_ROWS: usize = 20;
/// Rows may be at the wrong side of a tick by so many steps more than an even spacing allows: recorders are not punctual.
const LATE_ROWS: f64 = 1.0;
/// Bisections of an interval that is at most the tick itself.
const BISECTIONS: usize = 60;

/// Rows without a gap: the first and the one past the last, and the first row of each new tick.
struct Run<'a> {
    rows: std::ops::Range<usize>,
    stamps: &'a [f64],
    ticks: Vec<usize>,
}

impl Run<'_> {
    fn stamp(&self, row: usize) -> f64 {
        self.stamps.get(row).copied().unwrap_or(f64::NAN)
    }

    /// Least and largest `S - h k` over the ticks; `None` without ticks.
    fn offsets(&self, step: f64) -> Option<(f64, f64)> {
        let offsets = self.ticks.iter().map(|&row| self.stamp(row) - step * row as f64);
        offsets.fold(None, |range, o| Some(range.map_or((o, o), |(low, high): (f64, f64)| (low.min(o), high.max(o)))))
    }

    /// Time of row 0 of the table if this run were continued to it: the middle of what is possible.
    fn origin(&self, step: f64, tick: f64) -> f64 {
        match self.offsets(step) {
            Some((low, high)) => 0.5 * (low + high + step),
            // All within one tick: in the middle of it.
            None => {
                let length = step * (self.rows.len() - 1) as f64;
                self.stamp(self.rows.start) + 0.5 * (tick - length) - step * self.rows.start as f64
            }
        }
    }
}

/// Puts rows at even steps where their times come in regular groups of equal ones, and says so in the report. `rows` are
/// the rows that are used; nothing is changed where their times are not of this kind.
pub(super) fn spread(table: &mut Table, rows: &[usize], report: &mut QualityReport) {
    let stamps: Vec<f64> = rows.iter().filter_map(|&row| table.time.get(row).copied()).collect();
    if stamps.len() < FEWEST_ROWS || stamps.windows(2).any(|pair| pair[1] < pair[0]) || !are_different(table, rows) {
        return;
    }
    let Some(tick) = tick(&stamps) else { return };
    let runs = runs(&stamps, tick);
    let Some((step, uncertainty)) = step(&runs, tick) else { return };
    let mut spread = Vec::with_capacity(stamps.len());
    for run in &runs {
        let origin = run.origin(step, tick);
        spread.extend(run.rows.clone().map(|row| origin + step * row as f64));
    }
    // The first and the last group of a run may be shorter, never longer.
    let off = |(time, stamp): (&f64, &f64)| {
        let late = (1.0 + LATE_ROWS) * step;
        *time < stamp - late || *time > stamp + tick + late
    };
    if spread.iter().zip(&stamps).any(off) || spread.windows(2).any(|pair| pair[1] <= pair[0]) {
        return;
    }
    for (&row, time) in rows.iter().zip(spread) {
        table.time[row] = time;
    }
    report.warn(
        "time",
        format!(
            "written to {} s alone, so that about {} rows have the same: they are taken as evenly spaced, {} s apart \
             (from {} s to {} s are possible). If the time from row to row is known, give it: --sample-time {}s",
            Short(tick),
            Short((10.0 * tick / step).round() / 10.0),
            Short(step),
            Short(step - uncertainty),
            Short(step + uncertainty),
            Short(step)
        ),
    );
}

/// Whether rows of equal time are samples of their own: at least half of them differ from the row before in a value that
/// both have. Others are written twice, or hold the values of different channels.
fn are_different(table: &Table, rows: &[usize]) -> bool {
    let (mut equal, mut different) = (0_usize, 0_usize);
    for pair in rows.windows(2).filter(|pair| table.time.get(pair[0]) == table.time.get(pair[1])) {
        equal += 1;
        let differs = |column: &Vec<f64>| match (column.get(pair[0]), column.get(pair[1])) {
            (Some(before), Some(after)) => before.is_finite() && after.is_finite() && before != after,
            _ => false,
        };
        different += usize::from(table.columns.iter().any(differs));
    }
    equal > 0 && 2 * different >= equal
}

/// The step in which the times are written, s: the most usual one between different times.
fn tick(stamps: &[f64]) -> Option<f64> {
    let mut steps: Vec<f64> = stamps.windows(2).map(|pair| pair[1] - pair[0]).filter(|step| *step > 0.0).collect();
    crate::statistics::median(&mut steps)
}

fn runs(stamps: &[f64], tick: f64) -> Vec<Run<'_>> {
    let mut runs: Vec<Run<'_>> = Vec::new();
    let mut before = f64::NAN;
    for (row, &stamp) in stamps.iter().enumerate() {
        match runs.last_mut() {
            Some(run) if stamp - before < 1.5 * tick => {
                run.rows.end = row + 1;
                if stamp > before {
                    run.ticks.push(row);
                }
            }
            _ => runs.push(Run { rows: row..row + 1, stamps, ticks: Vec::new() }),
        }
        before = stamp;
    }
    runs
}

/// The step from row to row and by how much it may be wrong, s; `None` where the rows are not evenly spaced or too few.
fn step(runs: &[Run<'_>], tick: f64) -> Option<(f64, f64)> {
    let ticks: usize = runs.iter().map(|run| run.ticks.len()).sum();
    if ticks < FEWEST_TICKS {
        return None;
    }
    // Convex in the step: the largest of straight lines less the smallest.
    let width = |step: f64| {
        let of = |run: &Run<'_>| run.offsets(step).map_or(0.0, |(low, high)| high - low);
        runs.iter().map(of).fold(0.0, f64::max)
    };
    let counts = runs.iter().flat_map(|run| run.ticks.windows(2).map(|pair| pair[1] - pair[0]));
    let (fewest, most) = counts.fold((usize::MAX, 0), |(low, high), n| (low.min(n), high.max(n)));
    if most < 2 {
        return None;
    }
    let (low, high) = (tick / (most + 1) as f64, tick / fewest.max(2).saturating_sub(1) as f64);
    let (mut from, mut to) = (low, high);
    for _ in 0..BISECTIONS {
        let (left, right) = (from + (to - from) / 3.0, to - (to - from) / 3.0);
        if width(left) <= width(right) { to = right } else { from = left }
    }
    let step = 0.5 * (from + to);
    let allowed = |step: f64| width(step) <= (1.0 + LATE_ROWS) * step;
    if !allowed(step) {
        return None;
    }
    let edge = |beyond: f64| {
        let (mut inside, mut outside) = (step, beyond);
        for _ in 0..BISECTIONS {
            let middle = 0.5 * (inside + outside);
            if allowed(middle) { inside = middle } else { outside = middle }
        }
        inside
    };
    Some((step, (step - edge(low)).max(edge(high) - step)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::wording::Counted;

    /// Rows at these times, written to the tick, with one channel that differs from row to row.
    fn written(times: &[f64], tick: f64) -> Table {
        Table {
            time: times.iter().map(|t| (t / tick + 1e-9).floor() * tick).collect(),
            counted: Counted::Lines,
            lines: (2..times.len() + 2).collect(),
            columns: vec![times.iter().map(|t| (3.0 * t).sin()).collect()],
        }
    }

    fn spread_of(table: &mut Table) -> QualityReport {
        let mut report = QualityReport::default();
        let rows: Vec<usize> = (0..table.time.len()).collect();
        spread(table, &rows, &mut report);
        report
    }

    fn even(rate_hz: f64, seconds: f64, from_s: f64) -> Vec<f64> {
        (0..(rate_hz * seconds) as usize).map(|k| from_s + k as f64 / rate_hz).collect()
    }

    /// Largest difference of the times from these, but for one shift of all.
    fn off(found: &[f64], times: &[f64]) -> f64 {
        let (low, high) = found
            .iter()
            .zip(times)
            .map(|(a, b)| a - b)
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), d| (low.min(d), high.max(d)));
        high - low
    }

    #[test]
    fn evenly_spaced_rows_are_found_to_within_a_row() {
        // Rates that fit into the tick and such that do not, a clock to the second, to a tenth, to the minute.
        for (rate_hz, tick) in [(10.0, 1.0), (12.5, 1.0), (50.0, 0.1), (128.0, 0.01), (4.0, 60.0), (9.97, 1.0)] {
            let times = even(rate_hz, (60.0_f64).max(8.0 * tick), 43_200.33);
            let mut table = written(&times, tick);
            let report = spread_of(&mut table);
            let worst = off(&table.time, &times);
            assert!(worst <= 1.0 / rate_hz, "{rate_hz} Hz: {worst} s");
            let [finding] = report.findings.as_slice() else { panic!("{rate_hz} Hz: {report}") };
            assert!(finding.message.contains("evenly spaced") && finding.message.contains("--sample-time"), "{report}");
        }
    }

    #[test]
    fn a_gap_is_kept() {
        let times: Vec<f64> = even(10.0, 60.0, 0.25).into_iter().filter(|t| !(21.3..26.2).contains(t)).collect();
        let mut table = written(&times, 1.0);
        spread_of(&mut table);
        assert!(off(&table.time, &times) < 0.2, "{}", off(&table.time, &times));
    }

    #[test]
    fn other_equal_times_stay() {
        let unchanged = |mut table: Table| {
            let before = table.time.clone();
            let report = spread_of(&mut table);
            assert!(table.time == before && report.findings.is_empty(), "{report}");
        };
        // Groups of twenty and of five: the recorder wrote faster and slower.
        let mut uneven = even(20.0, 10.0, 0.0);
        uneven.extend(even(5.0, 10.0, 10.0));
        unchanged(written(&uneven, 1.0));
        // Rows that were written twice, and rows that hold one channel each.
        let times = even(10.0, 60.0, 0.0);
        let mut twice = written(&times, 1.0);
        twice.columns[0] = twice.time.clone();
        unchanged(twice);
        let mut sparse = written(&times, 1.0);
        let odd = |value: &f64, wanted: usize, k: usize| if k % 2 == wanted { *value } else { f64::NAN };
        let values = sparse.columns[0].clone();
        sparse.columns = (0..2).map(|c| values.iter().enumerate().map(|(k, v)| odd(v, c, k)).collect()).collect();
        unchanged(sparse);
        // Full digits: nothing is equal.
        unchanged(written(&times, 1e-6));
    }
}
