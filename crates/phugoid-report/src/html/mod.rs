//! One page that holds the whole result and needs nothing beside it.

use std::fmt::Write as _;

use phugoid_identification::estimation::Estimation;

use crate::escape::escape;
use crate::figure::Figure;
use crate::figures::figures;
use crate::statistics::median_step;
use crate::ticks::significant;

mod tables;

const STYLE: &str = include_str!("style.css");

/// What a page says beyond the estimation itself.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct HtmlOptions {
    /// Heading; `Parameter estimation: SOURCE` where none.
    pub title: Option<String>,
    /// Paragraphs shown under the heading, e.g. what was flown and how to repeat it.
    pub notes: Vec<String>,
    /// Settings of the estimator as name and value, in the order to show them.
    pub settings: Vec<(String, String)>,
}

/// The estimation as one self-contained HTML page: no scripts, no links to anywhere else, figures inline. Two calls
/// with the same estimation and options give the same bytes.
pub fn html(estimation: &Estimation, options: &HtmlOptions) -> String {
    let title = options.title.clone().unwrap_or_else(|| match estimation.source.as_str() {
        "" => "Parameter estimation".to_owned(),
        // A path is too long for a heading; it stands below as a whole.
        source => format!("Parameter estimation: {}", source.rsplit(['/', '\\']).next().unwrap_or(source)),
    });
    let all = figures(estimation);
    let sections: Vec<(&str, &str, String)> = [
        ("summary", "Summary", summary(estimation)),
        ("parameters", "Parameters", tables::parameters(estimation)),
        ("correlation-section", "Correlation", correlation(estimation, &all)),
        ("figures", "Figures", drawn(&all, |name| name != "correlation")),
        ("fit", "Fit and noise", tables::fit(estimation)),
        ("quality", "Data quality", tables::quality(estimation)),
        ("events", "Events", tables::events(estimation)),
        ("method", "Method and settings", tables::method(estimation, options)),
    ]
    .into_iter()
    .filter(|(.., body)| !body.is_empty())
    .collect();

    let mut page = String::new();
    // Formatting into a String cannot fail.
    let _ = write!(
        page,
        "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width,initial-scale=1\">\n<title>{title}</title>\n\
         <style>\n{STYLE}</style>\n</head>\n<body>\n<main>\n<header>\n<h1>{title}</h1>\n\
         <p class=\"by\">Estimated by Phugoid</p>\n",
        title = escape(&title)
    );
    for note in &options.notes {
        let _ = writeln!(page, "<p>{}</p>", prose(note));
    }
    page.push_str(&facts(estimation));
    page.push_str("<nav aria-label=\"Sections\">");
    for (anchor, heading, _) in &sections {
        let _ = write!(page, "<a href=\"#{anchor}\">{heading}</a> ");
    }
    page.push_str("</nav>\n</header>\n");
    for (anchor, heading, body) in &sections {
        let _ = write!(page, "<section id=\"{anchor}\">\n<h2>{heading}</h2>\n{body}</section>\n");
    }
    page.push_str("</main>\n</body>\n</html>\n");
    page
}

fn facts(estimation: &Estimation) -> String {
    let time = &estimation.history.time_s;
    let mut facts: Vec<(&str, String)> = vec![
        ("Record", estimation.source.clone()),
        ("Model", estimation.model.clone()),
        ("Method", estimation.method.clone()),
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
    let mut out = String::from("<dl class=\"facts\">\n");
    for (name, value) in facts.iter().filter(|(_, value)| !value.is_empty()) {
        let _ = writeln!(out, "<div><dt>{name}</dt><dd>{}</dd></div>", breakable(value));
    }
    out.push_str("</dl>\n");
    out
}

/// Escaped text that may be broken after the slashes of a path.
fn breakable(text: &str) -> String {
    escape(text).replace('/', "/<wbr>")
}

/// `0.01000` as `0.01`: for numbers that are settings, not results.
fn trimmed(number: &str) -> &str {
    if number.contains('.') && !number.contains('·') {
        number.trim_end_matches('0').trim_end_matches('.')
    } else {
        number
    }
}

fn summary(estimation: &Estimation) -> String {
    let Some((first, rest)) = estimation.verdict.split_first() else { return counts(estimation) };
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

/// How many parameters have which status, for estimations without a verdict.
fn counts(estimation: &Estimation) -> String {
    let mut counts: Vec<(&str, usize)> = Vec::new();
    for parameter in estimation.parameters.iter().filter(|p| !p.nuisance && p.status != "fixed") {
        match counts.iter_mut().find(|(status, _)| *status == parameter.status) {
            Some((_, count)) => *count += 1,
            None => counts.push((&parameter.status, 1)),
        }
    }
    let list: Vec<String> =
        counts.iter().map(|(status, count)| format!("{count} {}", tables::status_words(status))).collect();
    if list.is_empty() { String::new() } else { format!("<p>Parameters: {}.</p>\n", escape(&list.join(", "))) }
}

/// Escaped text with `code` between backticks set as such.
fn prose(text: &str) -> String {
    if text.matches('`').count() % 2 == 1 {
        return escape(text);
    }
    text.split('`')
        .enumerate()
        .map(|(k, part)| if k % 2 == 1 { format!("<code>{}</code>", escape(part)) } else { escape(part) })
        .collect()
}

fn correlation(estimation: &Estimation, all: &[(String, Figure)]) -> String {
    let figure = drawn(all, |name| name == "correlation");
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

fn drawn(all: &[(String, Figure)], wanted: impl Fn(&str) -> bool) -> String {
    let mut out = String::new();
    for (name, figure) in all.iter().filter(|(name, _)| wanted(name)) {
        let _ = write!(
            out,
            "<figure id=\"{}\">\n<h3>{}</h3>\n<div class=\"scroll\">{}</div>\n<figcaption>{}</figcaption>\n</figure>\n",
            escape(name),
            escape(&figure.title),
            figure.to_inline_svg(),
            escape(&figure.caption)
        );
    }
    out
}
