//! The page of a comparison of methods.

use std::fmt::Write as _;

use phugoid_evaluation::arena::{Arena, Coverage, EntryResult, Findings, MethodResult};

use super::page::{self, END_OF_TABLE, Section, prose, table};
use crate::arena::{arena_figures, ratio};
use crate::escape::escape;
use crate::ticks::significant;

/// A comparison of methods as one HTML page without scripts and without links to other files. `command` is the command
/// that gives the same numbers again; the page shows it. Two calls with the same arguments give the same bytes.
pub fn arena_html(arena: &Arena, command: &str) -> String {
    let notes = [
        "Every flight is flown once, and every method sees the same samples and is told the same of the aircraft and its sensors."
            .to_owned(),
        format!("`{command}` gives these numbers again; only the times of computing differ."),
    ];
    let figures = arena_figures(arena).iter().map(|(name, figure)| page::figure(name, 3, figure)).collect();
    let mut sections = vec![
        Section::new("findings", "Where each method wins and loses", findings(arena)),
        Section::new("figures", "All scenarios at a glance", figures),
        Section::new("times", "Time of computing", times(arena)),
    ];
    for entry in &arena.entries {
        sections.push(Section::new(&format!("entry-{}", entry.id), &entry.title, scenario(entry)));
    }
    page::document("Methods compared", "Compared by Phugoid", &notes, &facts(arena), &sections)
}

/// The facts under the heading.
fn facts(arena: &Arena) -> String {
    let flown: f64 = arena.entries.iter().map(|e| e.duration_s * e.flights as f64).sum();
    page::facts(&[
        ("Scenarios", arena.entries.len().to_string()),
        ("Methods", arena.methods.len().to_string()),
        ("Flights per scenario", arena.seeds.to_string()),
        ("Flown", format!("{} min", significant(flown / 60.0, 3))),
    ])
}

/// The rule, and where each method wins and loses.
fn findings(arena: &Arena) -> String {
    let mut out = format!("<p class=\"note\">{}</p>\n<ul class=\"verdict\">\n", prose(&arena.findings.rule));
    // Writing into a String cannot fail, here and below.
    for sentence in &arena.findings.methods {
        let _ = writeln!(out, "<li>{}</li>", prose(sentence));
    }
    out.push_str("</ul>\n");
    if let Some(ours) = arena.methods.first() {
        let _ = writeln!(out, "<h3>Where <code>{}</code> loses</h3>", escape(ours));
        if arena.findings.ours_loses.is_empty() {
            let _ = writeln!(out, "<p>{}</p>", prose(&Findings::loses_nowhere(arena.seeds)));
        } else {
            out.push_str("<ul class=\"verdict\">\n");
            for sentence in &arena.findings.ours_loses {
                let _ = writeln!(out, "<li>{}</li>", prose(sentence));
            }
            out.push_str("</ul>\n");
        }
    }
    out
}

/// The table of the computing times: the median over the scenarios, by method.
fn times(arena: &Arena) -> String {
    let mut out =
        table(&[("", "Method"), ("n", "Per sample<br>(µs, median)"), ("n", "Over that of<br>the first method (–)")]);
    for (m, name) in arena.methods.iter().enumerate() {
        let of = |value: fn(&MethodResult) -> f64| {
            let mut values: Vec<f64> =
                arena.entries.iter().filter_map(|e| e.methods.get(m)).map(value).filter(|v| v.is_finite()).collect();
            values.sort_by(f64::total_cmp);
            values.get(values.len() / 2).copied().unwrap_or(f64::NAN)
        };
        let _ = writeln!(
            out,
            "<tr><th scope=\"row\">{}</th><td class=\"n\">{}</td><td class=\"n\">{}</td></tr>",
            escape(name),
            significant(of(|m| m.microseconds), 2),
            significant(of(|m| m.relative_time), 2)
        );
    }
    out.push_str(END_OF_TABLE);
    out.push_str(
        "<p class=\"note\">The whole pipeline around each method included, on the machine and beside the load of this run: for \
         information, not reproducible.</p>\n",
    );
    out
}

/// The tables of one scenario.
fn scenario(entry: &EntryResult) -> String {
    let mut out = format!("<p>{}</p>\n", prose(&entry.shows));
    let _ = writeln!(
        out,
        "<p class=\"note\">{} flights of {} s; times count from {} s, in cycles of {} s. Errors over the {}.</p>",
        entry.flights,
        significant(entry.duration_s, 3),
        significant(entry.counted_from_s, 3),
        significant(entry.cycle_s, 3),
        entry.unit.words()
    );
    let Some(first) = entry.methods.first() else { return out };
    let mut heads: Vec<(&str, String)> = vec![("", "Method".to_owned()), ("", "Parameter".to_owned())];
    for checkpoint in &first.checkpoints {
        let cycles = significant(checkpoint.cycles, 1);
        heads.push(("n", format!("RMSE / bound<br>{cycles} cyc. (–)")));
    }
    heads.push(("n", "Bias<br>at the last".to_owned()));
    heads.push(("n", "RMSE<br>at the last".to_owned()));
    for checkpoint in &first.checkpoints {
        heads.push(("n", format!("Covered<br>{} cyc. (%)", significant(checkpoint.cycles, 1))));
    }
    heads.push(("n", "Within 5 %<br>after (s)".to_owned()));
    heads.push(("n", "Never".to_owned()));
    out.push_str(&table(&heads));
    for method in &entry.methods {
        rows(&mut out, method, heads.len());
    }
    out.push_str(END_OF_TABLE);
    out.push_str(&declared(entry));
    out.push_str(&changes(entry));
    for method in entry.methods.iter().filter(|m| m.failed > 0) {
        let why = method.failure.as_deref().unwrap_or_default();
        let why = why.lines().next().unwrap_or_default();
        let _ = writeln!(
            out,
            "<p><span class=\"status bad\">{}</span> failed in {} of {} flights: {}</p>",
            escape(&method.method),
            method.failed,
            entry.flights,
            prose(why)
        );
    }
    out
}

/// The rows of one method in the table of a scenario.
fn rows(out: &mut String, method: &MethodResult, columns: usize) {
    let Some(last) = method.checkpoints.last().filter(|c| c.accuracy.is_some()) else {
        let _ = writeln!(
            out,
            "<tr class=\"first\"><th scope=\"row\">{}</th><td colspan=\"{}\">no estimate</td></tr>",
            escape(&method.method),
            columns - 1
        );
        return;
    };
    for (j, parameter) in last.parameters.iter().enumerate() {
        let head = if j == 0 {
            format!("<th scope=\"rowgroup\" rowspan=\"{}\">{}</th>", last.parameters.len(), escape(&method.method))
        } else {
            String::new()
        };
        let _ = write!(
            out,
            "<tr{}>{head}<td>{}</td>",
            if j == 0 { " class=\"first\"" } else { "" },
            escape(&parameter.name)
        );
        let number = |out: &mut String, words: String| {
            let _ = write!(out, "<td class=\"n\">{words}</td>");
        };
        for checkpoint in &method.checkpoints {
            number(out, checkpoint.parameters.get(j).map_or_else(|| "–".to_owned(), |p| ratio(p.rmse_over_unit)));
        }
        number(out, significant(parameter.bias, 2));
        number(out, significant(parameter.rmse, 2));
        for checkpoint in &method.checkpoints {
            let coverage = checkpoint.parameters.get(j).and_then(|p| p.coverage);
            number(
                out,
                coverage.map_or_else(
                    || "–".to_owned(),
                    |c| {
                        let [low, high] = c.interval;
                        let words = format!("{:.0} ({:.0}…{:.0})", 100.0 * c.fraction, 100.0 * low, 100.0 * high);
                        if high < 0.9 { format!("<span class=\"far\">{words}</span>") } else { words }
                    },
                ),
            );
        }
        let settled = method.settled.get(j);
        number(out, settled.and_then(|s| s.median_s).map_or_else(|| "–".to_owned(), |t| format!("{t:.2}")));
        number(out, settled.map_or_else(String::new, |s| s.never.to_string()));
        out.push_str("</tr>\n");
    }
}

/// The table of what declared errors do to the bounds, at the last checkpoint; empty where no such errors were put in.
fn declared(entry: &EntryResult) -> String {
    if !entry.silent {
        return String::new();
    }
    let heads = [
        ("", "Method"),
        ("n", "Covered,<br>declared (%)"),
        ("n", "Claimed over<br>actual (–)"),
        ("n", "Covered, nothing<br>declared (%)"),
        ("n", "Claimed over<br>actual (–)"),
    ];
    let mut out = format!("<h3>With and without declared errors</h3>\n{}", table(&heads));
    for method in &entry.methods {
        let Some(last) = method.checkpoints.last() else { continue };
        let percent = |c: Option<Coverage>| c.map_or_else(|| "–".to_owned(), |c| format!("{:.0}", 100.0 * c.fraction));
        let over = |value: Option<f64>| value.map_or_else(|| "–".to_owned(), ratio);
        let cells = [
            percent(last.coverage),
            over(last.claimed_over_actual),
            percent(last.undeclared_coverage),
            over(last.undeclared_over_actual),
        ];
        let cells = cells.map(|cell| format!("<td class=\"n\">{cell}</td>")).concat();
        let _ = writeln!(out, "<tr><th scope=\"row\">{}</th>{cells}</tr>", escape(&method.method));
    }
    out.push_str(END_OF_TABLE);
    out
}

/// The table of the changes that were found; empty if there was neither damage nor a false alarm.
fn changes(entry: &EntryResult) -> String {
    let seconds = |t: Option<f64>| t.map_or_else(|| "–".to_owned(), |t| format!("{t:.2}"));
    let any = |f: fn(&MethodResult) -> usize| entry.methods.iter().map(f).sum::<usize>() > 0;
    if !entry.damaged && !any(|m| m.detection.false_alarms.count) {
        return String::new();
    }
    let mut heads = vec![("", "Method")];
    if entry.damaged {
        heads.extend([
            ("n", "Damage<br>found"),
            ("n", "Doubt<br>after (s)"),
            ("n", "Adopted<br>after (s)"),
            ("n", "Further<br>changes"),
        ]);
    }
    heads.extend([("n", "False<br>alarms"), ("n", "per<br>10 min")]);
    let mut out = format!("<h3>Changes believed</h3>\n{}", table(&heads));
    for method in &entry.methods {
        let d = &method.detection;
        let _ = write!(out, "<tr><th scope=\"row\">{}</th>", escape(&method.method));
        if entry.damaged {
            let _ = write!(
                out,
                "<td class=\"n\">{} of {}</td><td class=\"n\">{}</td><td class=\"n\">{}</td><td class=\"n\">{}</td>",
                d.found,
                d.damaged,
                seconds(d.doubt_median_s),
                seconds(d.latency_median_s),
                d.further
            );
        }
        let _ = writeln!(
            out,
            "<td class=\"n\">{}</td><td class=\"n\">{}</td></tr>",
            d.false_alarms.count,
            significant(d.false_alarms.per_ten_minutes, 2)
        );
    }
    out.push_str(END_OF_TABLE);
    out
}
