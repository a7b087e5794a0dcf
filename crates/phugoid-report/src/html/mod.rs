//! Pages that hold a whole result in one file.

use std::fmt::Write as _;

use phugoid_identification::estimation::{Estimation, FinalStatus, headline};

use crate::escape::escape;
use crate::figure::Figure;
use crate::figures::{CORRELATION, figures};
use crate::statistics::median_step;
use crate::ticks::significant;

mod arena;
mod batch;
mod changes;
mod offer;
mod options;
mod page;
mod readiness;
mod reproduction;
mod study;
mod tables;

pub use arena::arena_html;
pub use options::HtmlOptions;
use page::{Section, prose, trimmed};
pub use reproduction::{NotRun, ReproductionOptions, reproduction_html};
pub use study::{StudyPage, StudySection, study_html};

/// Zoom and pan of the figures over the time.
const ZOOM: &str = include_str!("zoom.js");

/// An estimation as one HTML page without links to other files; the figures are inside. Its one script, inside too, enlarges
/// parts of the time; the page is whole without it. Two calls with the same estimation and options give the same bytes.
///
/// ```
/// use phugoid_identification::estimation::Estimation;
/// use phugoid_report::{HtmlOptions, html};
///
/// let estimation = Estimation { source: "flights/dutch <roll>.csv".to_owned(), ..Estimation::default() };
/// let options = HtmlOptions { notes: vec!["Made with `phugoid estimate`.".to_owned()], ..HtmlOptions::default() };
/// let page = html(&estimation, &options);
/// assert!(page.contains("<h1>Parameter estimation: dutch &lt;roll&gt;.csv</h1>"));
/// assert!(page.contains("<code>phugoid estimate</code>"));
/// assert!(!page.contains("<script src") && !page.contains("<link"));
/// ```
pub fn html(estimation: &Estimation, options: &HtmlOptions) -> String {
    let title = options.title.clone().unwrap_or_else(|| match estimation.source.as_str() {
        "" => "Parameter estimation".to_owned(),
        // A whole path is too long for a heading; it stands below the heading.
        source => format!("Parameter estimation: {}", source.rsplit(['/', '\\']).next().unwrap_or(source)),
    });
    let all = figures(estimation);
    let sections = [
        Section::new("summary", "Summary", summary(estimation)),
        Section::new("parameters", "Parameters", tables::parameters(estimation)),
        Section::new("changes", "Changes adopted in flight", changes::changes(estimation)),
        Section::new("methods", "By other methods", changes::methods(estimation)),
        Section::new("readiness", "Readiness of the parameters", readiness::readiness(estimation)),
        Section::new("offer", "Terms that the residuals ask for", offer::offer(estimation)),
        Section::new("correlation-section", "Correlation", correlation(estimation, &all)),
        Section::new("figures", "Figures", drawn(&all, |name| name != CORRELATION)),
        Section::new("fit", "Fit and noise", tables::fit(estimation)),
        Section::new("batch", "Batch estimation", batch::batch(estimation)),
        Section::new("quality", "Data quality", tables::quality(estimation)),
        Section::new("events", "Events", tables::events(estimation)),
        Section::new("method", "Method and settings", tables::method(estimation, options)),
    ];
    let header = alarm(estimation) + &facts(estimation);
    page::with_script(page::document(&title, "Estimated by Phugoid", &options.notes, &header, &sections), ZOOM)
}

/// The headline of a refused or doubtful result, above everything else; empty for others.
fn alarm(estimation: &Estimation) -> String {
    let Some(first) = headline(&estimation.reasons) else { return String::new() };
    format!("<p class=\"alarm {}\" role=\"alert\">{}</p>\n", estimation.status, prose(&first))
}

/// The facts under the heading.
fn facts(estimation: &Estimation) -> String {
    let time = &estimation.history.time_s;
    let mut facts: Vec<(&str, String)> = vec![
        ("Record", estimation.source.clone()),
        ("Model", estimation.model.clone()),
        ("Method", estimation.method.name().to_owned()),
    ];
    if let (Some(first), Some(last)) = (time.first(), time.last()) {
        facts.push(("Duration", format!("{} s", significant(last - first, 4))));
        facts.push(("Samples", time.len().to_string()));
        let known = estimation.quality.sample_time_s;
        let step = if known > 0.0 { known } else { median_step(time) };
        if step > 0.0 {
            let rate = significant(1.0 / step, 4);
            facts.push(("Sample time", format!("{} s ({} Hz)", trimmed(&significant(step, 4)), trimmed(&rate))));
        }
    }
    page::facts(&facts)
}

/// The verdict, or else the number of parameters with each status.
fn summary(estimation: &Estimation) -> String {
    // The headline of a refused result stands at the top of the page already.
    let headline = headline(&estimation.reasons);
    let told = |sentence: &&String| headline.as_ref() != Some(*sentence);
    let verdict: Vec<&String> = estimation.verdict.iter().filter(told).collect();
    let Some((first, rest)) = verdict.split_first() else { return counts(estimation) };
    let mut out = format!("<p class=\"lead\">{}</p>\n", prose(first));
    if !rest.is_empty() {
        out.push_str("<ul class=\"verdict\">\n");
        for sentence in rest {
            let _ = writeln!(out, "<li>{}</li>", prose(sentence));
        }
        out.push_str("</ul>\n");
    }
    out
}

/// The number of parameters with each status, for estimations without a verdict.
fn counts(estimation: &Estimation) -> String {
    let mut counts: Vec<(FinalStatus, usize)> = Vec::new();
    for parameter in estimation.parameters.iter().filter(|p| !p.nuisance && p.status != FinalStatus::Fixed) {
        match counts.iter_mut().find(|(status, _)| *status == parameter.status) {
            Some((_, count)) => *count += 1,
            None => counts.push((parameter.status, 1)),
        }
    }
    let list: Vec<String> =
        counts.iter().map(|(status, count)| format!("{count} {}", tables::status_words(*status))).collect();
    if list.is_empty() { String::new() } else { format!("<p>Parameters: {}.</p>\n", escape(&list.join(", "))) }
}

/// The strongest correlations in words, and the figure.
fn correlation(estimation: &Estimation, all: &[(String, Figure)]) -> String {
    let figure = drawn(all, |name| name == CORRELATION);
    if figure.is_empty() {
        return figure;
    }
    let mut pairs: Vec<(f64, &str, &str)> = Vec::new();
    for (i, row) in estimation.correlation.iter().enumerate() {
        for (j, value) in row.iter().enumerate().take(i) {
            if let (Some(a), Some(b)) = (estimation.parameters.get(j), estimation.parameters.get(i))
                && value.abs() >= 0.9
            {
                pairs.push((*value, &a.name, &b.name));
            }
        }
    }
    pairs.sort_by(|a, b| b.0.abs().total_cmp(&a.0.abs()));
    let mut out = String::new();
    if pairs.is_empty() {
        out.push_str("<p>No two parameters are correlated beyond ±0.9.</p>\n");
    } else {
        let list: Vec<String> = pairs
            .iter()
            .map(|(r, a, b)| format!("{} and {} ({})", escape(a), escape(b), crate::ticks::fixed(*r, 3)))
            .collect();
        let _ = writeln!(out, "<p>Correlated beyond ±0.9: {}.</p>", list.join("; "));
    }
    out + &figure
}

/// The figures with these names as markup.
fn drawn(all: &[(String, Figure)], wanted: impl Fn(&str) -> bool) -> String {
    all.iter().filter(|(name, _)| wanted(name)).map(|(name, figure)| page::figure(name, 3, figure)).collect()
}
