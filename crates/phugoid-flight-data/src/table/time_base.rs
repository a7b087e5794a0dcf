//! Makes strictly increasing times of the times in a file.

use crate::quality::QualityReport;
use crate::table::{TableError, coarse_times};
use crate::wording::{Counted, Lines, Short, plural};

/// The rows as read: a finite time, the number of the line or row in the file, and one value per channel.
pub(crate) struct Table {
    pub(crate) time: Vec<f64>,
    /// Whether `lines` holds line numbers or row numbers.
    pub(crate) counted: Counted,
    pub(crate) lines: Vec<usize>,
    pub(crate) columns: Vec<Vec<f64>>,
}

/// Number of rows that the clock has to run before and after a jump back for the jump to count as a restart of the
/// clock.
const RESTART_ROWS: usize = 10;

/// Rows at an end of the record are left out as wrong times where the gap before the rest is longer than this many times the rest.
/// A pause between two flights of one file may be long too, so that only fewer rows than a running clock needs
/// ([`RESTART_ROWS`]) are left out, and only where the rest has ten times as many.
const ABSURD_GAP: f64 = 100.0;
const REST_PER_ROW: usize = 10;

/// Number of restarts that are reported one by one.
const MAX_RESTARTS: usize = 20;

/// Advice for a time column that holds no time.
const OTHER_TIME: &str = "If another column is the time, map the channel 'time' to it";

/// Makes the times strictly increasing: takes the longest part between restarts of the clock, merges rows of equal
/// time, and leaves out the fewest rows that are not in order, and the rows at either end whose times are far from all others.
pub(crate) fn put_in_order(
    table: &mut Table,
    source: &str,
    time_header: &str,
    report: &mut QualityReport,
) -> Result<(), TableError> {
    let mut rows: Vec<usize> = longest_part(table, report);
    coarse_times::spread(table, &rows, report);
    merge_equal_times(table, &mut rows, report);
    let rising = longest_rising(&table.time, &rows);
    if 2 * rising.len() < rows.len() {
        // Counted over the whole table: if the clock seems to restart again and again, one part is not representative.
        let all: Vec<usize> = (0..table.time.len()).collect();
        let back: Vec<usize> = all.iter().rev().copied().collect();
        let falls = longest_rising(&table.time, &back).len() == all.len();
        return Err(TableError::TimeDoesNotRise {
            source_name: source.to_owned(),
            header: time_header.to_owned(),
            rising: longest_rising(&table.time, &all).len(),
            rows: all.len(),
            hint: if falls { "It falls from row to row: turn the order of the rows round" } else { OTHER_TIME },
        });
    }
    let mut left_out = Lines::of(table.counted);
    let mut kept = rising.iter().copied().peekable();
    for &row in &rows {
        if kept.next_if_eq(&row).is_none() {
            left_out.add(table.lines.get(row).copied().unwrap_or_default());
        }
    }
    if left_out.count() > 0 {
        report.warn(
            left_out.place(),
            format!(
                "{} left out: the time jumps back there or far ahead of the rows that follow",
                plural(left_out.count(), "row")
            ),
        );
    }
    let rising = without_absurd_ends(table, rising, report);
    if rising.len() < table.time.len() {
        let pick = |values: &Vec<f64>| rising.iter().filter_map(|&row| values.get(row).copied()).collect();
        table.time = pick(&table.time);
        for column in &mut table.columns {
            *column = pick(column);
        }
        table.lines = rising.iter().filter_map(|&row| table.lines.get(row).copied()).collect();
    }
    Ok(())
}

/// Leaves out the few rows at the ends whose times are absurdly far from those of all others: an epoch time in a record that
/// counts from zero, or a zero in one of epoch times. Between other rows such times are out of order; at the ends they are not.
fn without_absurd_ends(table: &Table, mut rows: Vec<usize>, report: &mut QualityReport) -> Vec<usize> {
    let at = |position: usize| rows.get(position).and_then(|&row| table.time.get(row)).copied();
    // How far the row at `position` is from the one before it.
    let gap = |position: usize| Some(at(position)? - at(position.checked_sub(1)?)?);
    // Both ends are judged together: wrong times at one end make the rest long for the other.
    let mut ends = (0, rows.len());
    for first in 0..RESTART_ROWS {
        for last in 0..RESTART_ROWS {
            let Some(end) = rows.len().checked_sub(last).filter(|end| *end > first) else { continue };
            let (out, rest) = (first + last, end - first);
            let (Some(from), Some(to)) = (at(first), at(end - 1)) else { continue };
            let is_absurd = |gap: Option<f64>| gap.is_none_or(|gap| gap > ABSURD_GAP * (to - from));
            let more = rest < ends.1 - ends.0 && rest >= REST_PER_ROW * out;
            if more && (first == 0 || is_absurd(gap(first))) && (last == 0 || is_absurd(gap(end))) {
                ends = (first, end);
            }
        }
    }
    let (first, end) = ends;
    if end - first == rows.len() {
        return rows;
    }
    let (from, to) = (at(first).unwrap_or(f64::NAN), at(end - 1).unwrap_or(f64::NAN));
    let far = [gap(first).filter(|_| first > 0), gap(end)].into_iter().flatten().fold(0.0, f64::max);
    let mut left_out = Lines::of(table.counted);
    for &row in rows.iter().take(first).chain(rows.iter().skip(end)) {
        left_out.add(table.lines.get(row).copied().unwrap_or_default());
    }
    report.warn(
        left_out.place(),
        format!(
            "{} left out: the time there is {} s away from all other rows, which last {} s in all. If the row is needed, correct \
             its time in the file",
            plural(left_out.count(), "row"),
            Short(far),
            Short(to - from)
        ),
    );
    rows.truncate(end);
    rows.drain(..first);
    rows
}

/// The rows of the longest part between two restarts of the clock; of equally long parts the first.
fn longest_part(table: &Table, report: &mut QualityReport) -> Vec<usize> {
    let time = &table.time;
    let mut starts = vec![0];
    let mut from = 0;
    for row in RESTART_ROWS..time.len().saturating_sub(RESTART_ROWS - 1) {
        let (Some(before), Some(after)) = (time.get(row - RESTART_ROWS..row), time.get(row..row + RESTART_ROWS)) else {
            continue;
        };
        let (last, first) = (before[RESTART_ROWS - 1], after[0]);
        let starts_again = row >= from + RESTART_ROWS
            && first < last
            && before.iter().all(|&earlier| earlier >= first)
            && after.iter().all(|&later| later < last);
        if starts_again {
            starts.push(row);
            from = row;
        }
    }
    let ends = starts.iter().skip(1).copied().chain([time.len()]);
    let parts: Vec<(usize, usize)> = starts.iter().copied().zip(ends).collect();
    let longest = parts.iter().copied().rev().max_by_key(|(start, end)| end - start).unwrap_or((0, time.len()));
    for pair in parts.windows(2).take(MAX_RESTARTS) {
        let &[(_, end), (start, _)] = pair else { continue };
        let line = table.lines.get(start).copied().unwrap_or_default();
        let (from, to) = (time.get(end - 1).copied().unwrap_or(f64::NAN), time.get(start).copied().unwrap_or(f64::NAN));
        report.warn(
            format!("{} {line}", table.counted.one()),
            format!(
                "the time falls by {} s and runs on from there: the clock was started again. Each start is a record of its own",
                Short(from - to)
            ),
        );
    }
    if parts.len() > 1 {
        let line = |row: usize| table.lines.get(row).copied().unwrap_or_default();
        let (start, end) = longest;
        let out = time.len() - (end - start);
        report.warn(
            format!("{} {} to {}", table.counted.several(), line(start), line(end - 1)),
            format!(
                "this longest of {} parts is used, {} outside it are left out; to use another part, cut the file at the \
                 {} named above",
                parts.len(),
                plural(out, "row"),
                table.counted.several()
            ),
        );
    }
    (longest.0..longest.1).collect()
}

/// Merges neighbouring rows of equal time into the first one, whose missing values are filled from the later ones.
fn merge_equal_times(table: &mut Table, rows: &mut Vec<usize>, report: &mut QualityReport) {
    let mut merged = Lines::of(table.counted);
    let (mut filled, mut differing) = (0_usize, 0_usize);
    let mut kept: Vec<usize> = Vec::with_capacity(rows.len());
    for &row in rows.iter() {
        let same = kept.last().copied().filter(|&last| table.time.get(last) == table.time.get(row));
        let Some(first) = same else {
            kept.push(row);
            continue;
        };
        merged.add(table.lines.get(row).copied().unwrap_or_default());
        for column in &mut table.columns {
            let later = column.get(row).copied().unwrap_or(f64::NAN);
            let Some(value) = column.get_mut(first) else { continue };
            if value.is_nan() && !later.is_nan() {
                *value = later;
                filled += 1;
            } else if !later.is_nan() && later != *value {
                differing += 1;
            }
        }
    }
    if merged.count() > 0 {
        let mut message = format!("{} with the time of the row before merged into it", plural(merged.count(), "row"));
        if filled > 0 {
            message += &format!("; {} missing there taken from the later row", plural(filled, "value"));
        }
        if differing > 0 {
            message += &format!("; {differing} of the values differ and the first is kept");
        }
        if differing > 0 && 2 * merged.count() > kept.len() {
            message += ". The time seems to be written with too few digits for the rate of the rows, and the rows are not \
                        evenly spaced: write more digits, or give the sample time (--sample-time 0.02s)";
        }
        report.warn(merged.place(), message);
    }
    *rows = kept;
}

/// The longest sequence among these rows whose times rise strictly; of two swapped rows the later one is left out.
pub(crate) fn longest_rising(time: &[f64], rows: &[usize]) -> Vec<usize> {
    let at = |position: usize| rows.get(position).and_then(|&row| time.get(row)).copied().unwrap_or(f64::NAN);
    if (1..rows.len()).all(|position| at(position - 1) < at(position)) {
        return rows.to_vec();
    }
    // Longest increasing subsequence by patience sorting, from the end: `tails[n]` is the first row of the sequence of
    // length n + 1 whose first time is the largest.
    let mut tails: Vec<usize> = Vec::new();
    let mut next = vec![usize::MAX; rows.len()];
    for position in (0..rows.len()).rev() {
        let length = tails.partition_point(|&tail| at(tail) > at(position));
        if let Some(successor) = length.checked_sub(1).and_then(|index| tails.get(index)) {
            next[position] = *successor;
        }
        match tails.get_mut(length) {
            Some(tail) => *tail = position,
            None => tails.push(position),
        }
    }
    let mut sequence = Vec::with_capacity(tails.len());
    let mut position = tails.last().copied();
    while let Some(current) = position {
        sequence.extend(rows.get(current));
        position = next.get(current).copied().filter(|&following| following != usize::MAX);
    }
    sequence
}

/// Reports gaps, missing rows and jitter of a strictly increasing time.
pub(crate) fn report_steps(time: &[f64], median: f64, gap_factor: f64, report: &mut QualityReport) {
    const MAX_SHOWN: usize = 10;
    if median <= 0.0 {
        return;
    }
    let (mut gaps, mut gap_time, mut single) = (0_usize, 0.0, 0_usize);
    let (mut shortest, mut longest) = (f64::INFINITY, 0.0_f64);
    for pair in time.windows(2) {
        let &[before, after] = pair else { continue };
        let step = after - before;
        if step > gap_factor * median {
            gaps += 1;
            gap_time += step - median;
            if gaps <= MAX_SHOWN {
                report.warn(
                    format!("{} s to {} s", Short(before), Short(after)),
                    format!(
                        "gap of {} s ({} sample times); nothing is filled in",
                        Short(step),
                        Short((step / median).round())
                    ),
                );
            }
            continue;
        }
        if step > 1.5 * median {
            single += 1;
        } else {
            shortest = shortest.min(step);
            longest = longest.max(step);
        }
    }
    if gaps > MAX_SHOWN {
        report.warn(
            "",
            format!("{gaps} gaps in all, {} s without data; the first {MAX_SHOWN} are listed", Short(gap_time)),
        );
    }
    if single > 0 {
        report
            .note("time", format!("{} longer than 1.5 sample times: single rows are missing", plural(single, "step")));
    }
    if longest - shortest > 0.1 * median {
        report.note(
            "time",
            format!(
                "irregular: steps from {} s to {} s about the median of {} s; used as they are",
                Short(shortest),
                Short(longest),
                Short(median)
            ),
        );
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table(time: &[f64]) -> Table {
        let lines = (0..time.len()).map(|row| row + 2).collect();
        Table {
            time: time.to_vec(),
            counted: Counted::Lines,
            lines,
            columns: vec![(0..time.len()).map(|row| row as f64).collect()],
        }
    }

    fn ordered(time: &[f64]) -> (Vec<f64>, QualityReport) {
        let mut table = table(time);
        let mut report = QualityReport::default();
        put_in_order(&mut table, "x", "time_s", &mut report).unwrap();
        assert_eq!(table.time.len(), table.columns[0].len());
        assert!(table.time.windows(2).all(|pair| pair[0] < pair[1]));
        (table.time, report)
    }

    #[test]
    fn swapped_rows_lose_the_one_that_goes_back() {
        let (time, report) = ordered(&[0.0, 1.0, 3.0, 2.0, 4.0]);
        assert_eq!(time, [0.0, 1.0, 3.0, 4.0]);
        assert_eq!(report.findings[0].place, "line 5");
    }

    #[test]
    fn a_wild_time_does_not_take_the_rest_with_it() {
        let (time, report) = ordered(&[0.0, 1.0, 1e9, 2.0, 3.0, 4.0]);
        assert_eq!(time, [0.0, 1.0, 2.0, 3.0, 4.0]);
        assert_eq!(report.findings[0].place, "line 4");
    }

    #[test]
    fn a_clock_that_starts_again_ends_the_record() {
        let mut time: Vec<f64> = (0..40).map(f64::from).collect();
        time.extend((0..25).map(f64::from));
        let (kept, report) = ordered(&time);
        assert_eq!(kept.len(), 40);
        assert!(report.findings[0].message.contains("started again"), "{report}");
        assert_eq!(report.findings[0].place, "line 42");
        assert_eq!(report.findings[1].place, "lines 2 to 41");
        // The longer part second: parts are never joined, even where the second runs past the end of the first.
        let mut time: Vec<f64> = (0..20).map(f64::from).collect();
        time.extend((0..50).map(f64::from));
        assert_eq!(ordered(&time).0.len(), 50);
    }

    #[test]
    fn three_starts_are_three_parts() {
        let mut time: Vec<f64> = Vec::new();
        for part in [15, 30, 20] {
            time.extend((0..part).map(f64::from));
        }
        let (kept, report) = ordered(&time);
        assert_eq!(kept.len(), 30);
        assert_eq!(report.findings.iter().filter(|f| f.message.contains("started again")).count(), 2);
    }

    #[test]
    fn a_column_that_is_no_time_is_refused() {
        let mut table = table(&[5.0, 4.0, 3.0, 2.0, 1.0, 0.0]);
        let error = put_in_order(&mut table, "x.csv", "t", &mut QualityReport::default()).unwrap_err();
        assert!(error.to_string().contains("rises in only 1 of 6"), "{error}");
    }

    /// Times at 50 Hz from this one on.
    fn running(from: f64, rows: usize) -> Vec<f64> {
        (0..rows).map(|row| from + 0.02 * row as f64).collect()
    }

    #[test]
    fn absurd_times_at_the_ends_are_left_out() {
        let record = running(0.0, 200);
        for wild in [1_796_076_432.0, 1e300, f64::MAX] {
            let (kept, report) = ordered(&[record.clone(), vec![wild]].concat());
            assert_eq!(kept, record, "{wild}");
            let [finding] = report.findings.as_slice() else { panic!("{report}") };
            assert_eq!(finding.place, "line 202");
            assert!(finding.message.contains("1 row left out") && finding.message.contains("away from"), "{report}");
        }
        // Before the rest, at both ends, and several that are far from one another too.
        let epoch = running(1_796_076_432.0, 200);
        for (before, after) in [
            (vec![0.0], vec![]),
            (vec![-f64::MAX], vec![f64::MAX]),
            (vec![0.0], vec![4e9]),
            (vec![0.0, 0.02, 0.04], vec![]),
            (vec![0.0], vec![1e12, 1e300]),
        ] {
            let (kept, report) = ordered(&[before.clone(), epoch.clone(), after.clone()].concat());
            assert_eq!(kept, epoch, "{before:?} {after:?}");
            assert_eq!(report.findings.len(), 1, "{report}");
        }
        // One more where the clock was started again, so that another part begins.
        let restarted = [running(0.0, 50), running(0.0, 200), vec![1e9]].concat();
        assert_eq!(ordered(&restarted).0, record);
    }

    #[test]
    fn a_true_gap_at_the_end_of_a_record_is_kept() {
        const DAY: f64 = 86_400.0;
        for second in [
            // A day and a month later the recorder ran again.
            running(DAY, 10),
            running(30.0 * DAY, 200),
            // Single rows behind a gap that a record may have.
            vec![300.0],
        ] {
            let time = [running(0.0, 200), second].concat();
            let (kept, report) = ordered(&time);
            assert_eq!(kept, time, "{report}");
            assert!(report.findings.is_empty(), "{report}");
            let turned: Vec<f64> = time.iter().rev().map(|time| -time).collect();
            assert_eq!(ordered(&turned).0, turned);
        }
        // Of so few rows nobody knows which of them are wrong.
        for time in [vec![0.0, 1.0, 1e9], [running(0.0, 9), vec![1e9]].concat(), vec![0.0, 1e9]] {
            assert_eq!(ordered(&time).0, time);
        }
    }

    #[test]
    fn gaps_are_measured_in_the_median() {
        let mut report = QualityReport::default();
        report_steps(&[0.0, 0.1, 0.2, 0.5, 0.6, 2.6, 2.7], 0.1, 3.5, &mut report);
        let gaps: Vec<_> = report.warnings().collect();
        assert_eq!(gaps.len(), 1);
        assert_eq!(gaps[0].place, "0.6 s to 2.6 s");
        assert!(gaps[0].message.contains("gap of 2 s (20 sample times)"), "{}", gaps[0].message);
        assert!(report.findings.iter().any(|f| f.message.contains("1 step longer")), "{report}");
    }
}
