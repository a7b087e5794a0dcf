//! The table of the readiness of the parameters: which of them can be used, and what would help for the others.

use std::fmt::Write as _;

use phugoid_identification::estimation::{Estimation, ParameterReadiness, Readiness};

use super::page::{END_OF_TABLE, table};
use crate::escape::escape;
use crate::ticks::fixed;

/// Every estimated parameter with verdict, reason and advice; empty for a method that gives no verdict.
pub(super) fn readiness(estimation: &Estimation) -> String {
    let rows: Vec<(&str, &ParameterReadiness)> = estimation
        .parameters
        .iter()
        .filter(|p| !p.nuisance)
        .filter_map(|p| Some((p.name.as_str(), p.readiness.as_ref()?)))
        .collect();
    if rows.is_empty() {
        return String::new();
    }
    let heads = [
        ("", "Parameter"),
        ("", "Verdict"),
        ("", "Why, and what would help"),
        ("n", "Ready<br>since (s)"),
        ("n", "Bound /<br>prior"),
        ("n", "The same,<br>others known"),
        ("n", "Inflation of<br>variance"),
        ("", "Correlated with"),
    ];
    let mut out = table(&heads);
    for (name, readiness) in rows {
        let class = match readiness.verdict {
            Readiness::Ready => " good",
            Readiness::Improving => " waiting",
            Readiness::NotIdentifiable | Readiness::Doubtful => " bad",
        };
        let why = match &readiness.advice {
            Some(advice) => format!("{}: {advice}", readiness.reason),
            None => readiness.reason.clone(),
        };
        let number = |value: f64, decimals: usize| match value {
            v if !v.is_finite() => "\u{2013}".to_owned(),
            v if v >= 1e4 => "&gt; 10000".to_owned(),
            v => fixed(v, decimals),
        };
        let partners: Vec<String> =
            readiness.correlated_with.iter().map(|(name, r)| format!("{} ({})", escape(name), fixed(*r, 2))).collect();
        let _ = writeln!(
            out,
            "<tr><th scope=\"row\">{}</th><td><span class=\"status{class}\">{}</span></td><td class=\"words\">{}</td>\
             <td class=\"n\">{}</td><td class=\"n\">{}</td><td class=\"n\">{}</td><td class=\"n\">{}</td><td>{}</td></tr>",
            escape(name),
            readiness.verdict.word().replace('_', " "),
            escape(&why),
            readiness.ready_since_s.map_or_else(|| "\u{2013}".to_owned(), |t| fixed(t, 2)),
            number(readiness.bound_over_prior, 3),
            number(readiness.excitation, 3),
            number(readiness.variance_inflation, 1),
            partners.join(", "),
        );
    }
    out.push_str(END_OF_TABLE);
    out.push_str(
        "<p class=\"note\">Bound / prior compares the corrected standard error with the prior standard deviation; the next \
         column is what it would be if all other parameters were known, so that excitation and collinearity can be told \
         apart. Variance inflation is the ratio of the two variances; beyond 10 and with a wide bound only a combination \
         of parameters is known.</p>\n",
    );
    out
}
