//! The top of the page: which requirements are met, and a table with a row for each case.

use std::fmt::Write as _;

use phugoid_thesis::result::{Behaviour, Outcome, Reproduction, Role};

use super::super::page::{self, END_OF_TABLE, prose, table};
use super::case::behaviour;
use super::options::NotRun;
use super::parts::{grouped, link, met_of, status};
use crate::escape::escape;
use crate::ticks::significant;

/// Counts of cases, figures and requirements.
pub(super) fn facts(reproductions: &[Reproduction]) -> String {
    let requirements = || reproductions.iter().flat_map(|r| &r.requirements);
    let met = requirements().filter(|r| r.met).count();
    page::facts(&[
        ("Cases and studies", reproductions.len().to_string()),
        ("Figures", reproductions.iter().map(|r| r.charts.len()).sum::<usize>().to_string()),
        ("Requirements met", met.to_string()),
        ("Requirements not met", (requirements().count() - met).to_string()),
    ])
}

/// The requirements that are not met, the cases without a result, and the contents by group.
pub(super) fn summary(reproductions: &[Reproduction], not_run: &[NotRun]) -> String {
    let all = reproductions.iter().map(|r| r.requirements.len()).sum::<usize>();
    let missed: Vec<_> = reproductions
        .iter()
        .flat_map(|r| r.requirements.iter().filter(|q| !q.met).map(|q| (r.id.as_str(), q)))
        .collect();
    let mut out = String::new();
    // Writing into a String cannot fail, here and below.
    let _ = match (all, missed.len()) {
        (0, _) => writeln!(out, "<p class=\"lead\">Nothing was required of these cases.</p>"),
        (1, 0) => writeln!(out, "<p class=\"lead\">The one requirement is met.</p>"),
        (_, 0) => writeln!(out, "<p class=\"lead\">All {all} requirements are met.</p>"),
        (_, missed) => {
            writeln!(out, "<p class=\"lead\">{} of {all} requirements are met; {missed} not.</p>", all - missed)
        }
    };
    if !missed.is_empty() {
        out.push_str("<h3>Not met</h3>\n<ul class=\"verdict\">\n");
        for (id, requirement) in missed {
            let _ = writeln!(
                out,
                "<li>{}: {}. Required: {}; found: {}.</li>",
                link(id),
                prose(requirement.what.trim_end_matches('.')),
                prose(&requirement.limit),
                prose(&requirement.found)
            );
        }
        out.push_str("</ul>\n");
    }
    if !not_run.is_empty() {
        out.push_str("<h3>Without a result</h3>\n<ul class=\"verdict\">\n");
        for NotRun { id, reason } in not_run {
            let _ = writeln!(out, "<li>{} {}: {}</li>", status("bad", "failed"), escape(id), prose(reason));
        }
        out.push_str("</ul>\n");
    }
    out.push_str("<h3>Contents</h3>\n<ul class=\"contents\">\n");
    for (group, members) in grouped(reproductions) {
        let links: Vec<String> = members
            .iter()
            .map(|r| {
                let name = r.id.split_once('/').map_or(r.id.as_str(), |(_, name)| name);
                format!("<a href=\"#{}\">{}</a>", escape(&r.id), escape(name))
            })
            .collect();
        let _ = writeln!(
            out,
            "<li><a href=\"#{}\">{}</a>: {}</li>",
            escape(group.id),
            escape(group.title),
            links.join(", ")
        );
    }
    out.push_str("</ul>\n");
    out
}

/// The table of all cases: the published time, that of the recommended estimator, and the behaviour of the printed law.
pub(super) fn cases(reproductions: &[Reproduction]) -> String {
    let mut out = table(&[
        ("", "Case"),
        ("", "Parameter"),
        ("n", "Published<br>(s)"),
        ("n", "Ours<br>(s)"),
        ("", "The printed law"),
        ("", "Requirements<br>met"),
    ]);
    for reproduction in reproductions {
        let ours = reproduction.outcomes.iter().find(|o| o.role == Role::Flagship);
        let parameters = ours.map_or(&[][..], |o| &o.parameters);
        let rows = parameters.len().max(1);
        let span = if rows > 1 { format!(" rowspan=\"{rows}\"") } else { String::new() };
        for row in 0..rows {
            out.push_str("<tr>");
            if row == 0 {
                let _ = write!(
                    out,
                    "<td class=\"words\"{span}>{} {}</td>",
                    link(&reproduction.id),
                    escape(&reproduction.title)
                );
            }
            let parameter = parameters.get(row);
            let seconds = |s: Option<f64>| s.map_or_else(|| "–".to_owned(), |s| significant(s, 3));
            let _ = write!(
                out,
                "<td>{}</td><td class=\"n\">{}</td><td class=\"n\">{}</td>",
                parameter.map_or_else(|| "–".to_owned(), |p| escape(&p.name)),
                seconds(parameter.and_then(|p| p.published_s)),
                parameter.map_or_else(
                    || "–".to_owned(),
                    |p| p.converged_s.map_or_else(|| "never".to_owned(), |s| significant(s, 3))
                ),
            );
            if row == 0 {
                let _ = write!(
                    out,
                    "<td class=\"laws\"{span}>{}</td><td{span}>{}</td>",
                    printed(&reproduction.outcomes),
                    met_of(&reproduction.requirements)
                );
            }
            out.push_str("</tr>\n");
        }
    }
    out.push_str(END_OF_TABLE);
    out.push_str(
        "<p class=\"note\">Seconds from the start of the record until the estimate stays within 5 % of the truth; ours is \
         the recommended estimator.</p>\n",
    );
    out
}

/// The behaviour of the published laws: of each by name, or counted if there are more than four.
fn printed(outcomes: &[Outcome]) -> String {
    let laws: Vec<&Outcome> = outcomes.iter().filter(|o| o.role == Role::Published).collect();
    let words =
        |word: Behaviour, by: &str| format!("{} <span class=\"by-method\">{}</span>", behaviour(word), escape(by));
    let laws_in_words: Vec<String> = match laws.len() {
        0 => return "–".to_owned(),
        1..=4 => laws.iter().map(|o| words(o.behaviour, &o.method)).collect(),
        _ => Behaviour::ALL
            .iter()
            .map(|behaviour| (behaviour, laws.iter().filter(|o| o.behaviour == *behaviour).count()))
            .filter(|(_, count)| *count > 0)
            .map(|(behaviour, count)| words(*behaviour, &format!("{count} of {}", laws.len())))
            .collect(),
    };
    laws_in_words.join("<br>")
}
