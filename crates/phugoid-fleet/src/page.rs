//! What a fleet tells as one page: a row for each course with its sparkline, sortable, each point leading to its flight. The
//! page needs no network.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use crate::statistics::tell::{Course, Findings, Over, Point, Shape};

/// Size of a sparkline, pixels.
const WIDTH: f64 = 180.0;
const HEIGHT: f64 = 36.0;

/// On a narrow screen the tables are moved sideways by themselves, and the text stays as wide as the screen.
const STYLE: &str = "body{font:14px system-ui,sans-serif;margin:clamp(.7em,3vw,2em);color:#222}table{border-collapse:collapse}\
.wide{overflow-x:auto}code{overflow-wrap:anywhere}td.e{min-width:26em}tr[id] td{vertical-align:top}\
th,td{padding:.25em .7em;text-align:right;border-bottom:1px solid #ddd}th{cursor:pointer;background:#f4f4f4}\
td.w,th.w{text-align:left}td.w:first-child,td[data-v]{white-space:nowrap}tr.found td{background:#fff3e0}.bad{fill:#d32f2f}.ok{fill:#1565c0}\
svg{vertical-align:middle}:target{background:#ffff8d}.note{color:#666}";

/// Sorts a table by the column that is clicked: by the number in `data-v` where there is one, else by the text.
const SCRIPT: &str = "document.querySelectorAll('th').forEach(h=>h.addEventListener('click',()=>{\
const t=h.closest('table'),i=[...h.parentNode.children].indexOf(h),d=h.dataset.d=h.dataset.d==='1'?'-1':'1';\
const v=r=>{const c=r.children[i];return c.dataset.v!==undefined?parseFloat(c.dataset.v):c.textContent};\
const b=t.tBodies[0];[...b.rows].sort((a,c)=>{const x=v(a),y=v(c);return d*(typeof x==='number'?\
(isNaN(x)?1:isNaN(y)?-1:x-y):String(x).localeCompare(y))}).forEach(r=>b.append(r))}));";

/// Addresses of the reports of segments, by the hash of the log and the number of the segment.
pub type Reports = BTreeMap<(String, i64), String>;

/// The page, HTML. Numbers are in the units of the parameters. A point leads to the report of its segment where there is one, else to
/// the line of its flight.
pub fn html(findings: &Findings, reports: &Reports) -> String {
    let mut page = format!(
        "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\
         <meta name=\"viewport\" content=\"width=device-width,initial-scale=1\"><title>Fleet: {0}</title><style>{STYLE}</style></head>\n\
         <body><h1>Fleet: {0}</h1>\n<p class=\"note\">{1}; {2}, by Phugoid</p>\n\
         <p>Derivatives are per radian. Findings are called so at a rate of false ones of {3} %. Bars are two standard errors of a single flight, the band that \
         of the mean with all that the flights share. Click a head to sort, a point for its report, or where there is none for the line of its flight.</p>\n",
        escaped(&findings.set.model),
        findings.counts(),
        escaped(&findings.set.to_string()),
        100.0 * findings.false_discoveries,
    );
    for note in &findings.notes {
        let _ = writeln!(page, "<p><b>Note.</b> {}</p>", escaped(note));
    }
    unused(&mut page, findings);
    causes(&mut page, findings);
    let mut numbers = BTreeMap::new();
    for point in findings.airframes.iter().flat_map(|a| &a.courses).flat_map(|course| &course.points) {
        let next = numbers.len() + 1;
        numbers.entry(point.log_sha256.as_str()).or_insert(next);
    }
    page.push_str(
        "<h2>Courses</h2>\n<div class=\"wide\"><table><thead><tr><th class=\"w\">airframe</th><th class=\"w\">parameter</th><th>mean</th><th>+- 2 sigma</th>\
         <th>estimates</th><th class=\"w\">course</th><th class=\"w\">what</th><th>rate of false ones</th><th>from the others, sigmas</th>\
         <th>flights that disagree</th></tr></thead><tbody>\n",
    );
    for airframe in &findings.airframes {
        for course in &airframe.courses {
            let links = Links { numbers: &numbers, reports };
            row(&mut page, &airframe.name, course, findings.over, &links);
        }
    }
    let _ = write!(
        page,
        "</tbody></table></div>\n<h2>Flights</h2>\n<p>The report of a flight, with all plots: <code>phugoid estimate LOG --model MODEL.toml --method {}{}</code>, where \
         MODEL.toml is the file of the model {}.</p>\n<div class=\"wide\"><table><thead><tr><th>no.</th><th class=\"w\">airframe</th>\
         <th class=\"w\">log</th><th class=\"w\">estimates</th></tr></thead><tbody>\n",
        escaped(&findings.set.method),
        if findings.set.segments == "whole" { "" } else { " --segment NUMBER" },
        escaped(&findings.set.model),
    );
    flights(&mut page, findings, &Links { numbers: &numbers, reports });
    let _ = write!(page, "</tbody></table></div>\n<script>{SCRIPT}</script></body></html>\n");
    page
}

/// Where points lead.
struct Links<'a> {
    /// Number of the line of each log.
    numbers: &'a BTreeMap<&'a str, usize>,
    reports: &'a Reports,
}

impl Links<'_> {
    fn line(&self, point: &Point) -> usize {
        self.numbers.get(point.log_sha256.as_str()).copied().unwrap_or(0)
    }

    fn report(&self, point: &Point) -> Option<String> {
        self.reports.get(&(point.log_sha256.clone(), point.segment)).map(|report| address(report))
    }
}

/// Airframes with flights of which nothing can be used, which have no course or a shorter one.
fn unused(page: &mut String, findings: &Findings) {
    let with: Vec<_> = findings.airframes.iter().filter(|airframe| airframe.unused.logs > 0).collect();
    if with.is_empty() {
        return;
    }
    page.push_str(
        "<h2>Flights without an estimate that can be used</h2>\n<div class=\"wide\"><table><thead><tr><th class=\"w\">airframe</th><th>flights</th>\
         <th>of</th><th class=\"w\">reasons, and in how many flights</th><th class=\"w\">what</th></tr></thead><tbody>\n",
    );
    for airframe in with {
        let own = &airframe.unused;
        let (found, what) =
            if own.is_apart { (" class=\"found\"", "more than the others: check its sensors") } else { ("", "") };
        let _ = writeln!(
            page,
            "<tr{found}><td class=\"w\">{}</td><td>{}</td><td>{}</td><td class=\"w\">{}</td><td class=\"w\">{what}</td></tr>",
            escaped(&airframe.name),
            own.logs,
            own.of,
            escaped(&own.words())
        );
    }
    page.push_str("</tbody></table></div>\n");
}

/// What explains the drifts, the steps and the distances of the airframes.
fn causes(page: &mut String, findings: &Findings) {
    let unit = findings.over.unit();
    let mut lines = findings.airframes.iter().flat_map(|a| a.together.iter().map(move |t| (&a.name, t))).peekable();
    if lines.peek().is_none() {
        return;
    }
    page.push_str(
        "<h2>What explains the findings, all parameters of an airframe together</h2>\n<div class=\"wide\"><table><thead><tr><th class=\"w\">airframe</th>\
         <th class=\"w\">what</th><th class=\"w\">explained by, +- 2 sigma</th><th>p</th></tr></thead><tbody>\n",
    );
    for (airframe, together) in lines {
        for (line, p) in together.lines(unit) {
            let _ = writeln!(
                page,
                "<tr class=\"found\"><td class=\"w\">{}</td><td class=\"w\">{}</td><td class=\"w\">{}</td>{}</tr>",
                escaped(airframe),
                together.words(unit),
                escaped(&line),
                number(p.unwrap_or(f64::NAN))
            );
        }
    }
    page.push_str("</tbody></table></div>\n");
}

fn row(page: &mut String, airframe: &str, course: &Course, over: Over, links: &Links<'_>) {
    let unit = over.unit();
    let what = match (course.shape, course.drift, course.step) {
        (Shape::Drift, Some(drift), _) => {
            let part = 100.0 * drift.size / course.combined.value.abs();
            format!("drift {} per {unit} ({} %)", short(drift.size), short(part))
        }
        (Shape::Step, _, Some(step)) => format!("step {} at {unit} {}", short(step.size), short(step.at)),
        (Shape::TooFew, ..) => "too few".to_owned(),
        _ => "steady".to_owned(),
    };
    let disagree = course.points.iter().filter(|point| point.disagrees).count();
    let found = course.is_outlier || disagree > 0 || matches!(course.shape, Shape::Drift | Shape::Step);
    let apart = course.apart.map_or(f64::NAN, |apart| apart.sigmas);
    let rate = course.change_rate.unwrap_or(f64::NAN);
    let _ = writeln!(
        page,
        "<tr{}><td class=\"w\">{}</td><td class=\"w\">{}</td>{}{}{}<td class=\"w\" data-v=\"{}\">{}</td>\
         <td class=\"w\">{what}</td>{}{}{}</tr>",
        if found { " class=\"found\"" } else { "" },
        escaped(airframe),
        escaped(&course.parameter),
        number(course.combined.value),
        number(2.0 * course.combined.std_error),
        number(course.points.len() as f64),
        course.points.len(),
        sparkline(course, links),
        number(rate),
        number(apart),
        number(disagree as f64),
    );
}

fn sparkline(course: &Course, links: &Links<'_>) -> String {
    let of = |place: &dyn Fn(&Point) -> f64| course.points.iter().map(place).collect::<Vec<f64>>();
    let range = |values: &[f64]| {
        let (low, high) = values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(*v), h.max(*v)));
        if high > low { (low, high) } else { (low - 0.5, low + 0.5) }
    };
    let (first, last) = range(&of(&|p| p.at));
    let (mean, bound) = (course.combined.value, 2.0 * course.combined.std_error);
    let mut ends = [of(&|p| p.value - 2.0 * p.own_std), of(&|p| p.value + 2.0 * p.own_std)].concat();
    ends.extend([mean - bound, mean + bound]);
    let (low, high) = range(&ends);
    let x = |at: f64| 3.0 + (WIDTH - 6.0) * (at - first) / (last - first);
    let y = |value: f64| HEIGHT - 2.0 - (HEIGHT - 4.0) * (value - low) / (high - low);
    let mut svg = format!(
        "<svg width=\"{WIDTH}\" height=\"{HEIGHT}\"><rect x=\"0\" width=\"{WIDTH}\" y=\"{:.1}\" height=\"{:.1}\" \
         fill=\"#e3f2fd\"/><path d=\"M0 {:.1}H{WIDTH}\" stroke=\"#90caf9\"/>",
        y(mean + bound),
        y(mean - bound) - y(mean + bound),
        y(mean),
    );
    for point in &course.points {
        let _ = write!(
            svg,
            "<a href=\"{}\"><path d=\"M{2:.1} {3:.1}V{4:.1}\" stroke=\"#bbb\"/><circle class=\"{1}\" cx=\"{2:.1}\" \
             cy=\"{5:.1}\" r=\"2\"><title>{6}, segment {7}: {8} +- {9}</title></circle></a>",
            links.report(point).unwrap_or_else(|| format!("#f{}", links.line(point))),
            if point.disagrees { "bad" } else { "ok" },
            x(point.at),
            y(point.value - 2.0 * point.own_std),
            y(point.value + 2.0 * point.own_std),
            y(point.value),
            escaped(&point.path),
            point.segment,
            short(point.value),
            short(2.0 * point.std_error),
        );
    }
    svg + "</svg>"
}

fn flights(page: &mut String, findings: &Findings, links: &Links<'_>) {
    let mut logs: BTreeMap<usize, (&str, &Point, Vec<String>)> = BTreeMap::new();
    for airframe in &findings.airframes {
        for course in &airframe.courses {
            for point in &course.points {
                let (_, _, estimates) = logs.entry(links.line(point)).or_insert((&airframe.name, point, Vec::new()));
                let disagrees = if point.disagrees { ", disagrees" } else { "" };
                let segment = format!("segment {}", point.segment);
                let segment = match links.report(point) {
                    Some(report) => format!("<a href=\"{report}\">{segment}</a>"),
                    None => segment,
                };
                estimates.push(format!(
                    "{} {} +- {} ({segment}{disagrees})",
                    escaped(&course.parameter),
                    short(point.value),
                    short(2.0 * point.std_error),
                ));
            }
        }
    }
    for (number, (airframe, point, estimates)) in logs {
        let _ = writeln!(
            page,
            "<tr id=\"f{number}\"><td>{number}</td><td class=\"w\">{}</td><td class=\"w\"><a href=\"{1}\">{2}</a></td>\
             <td class=\"w e\">{3}</td></tr>",
            escaped(airframe),
            address(&point.path),
            escaped(&point.path),
            estimates.join("; "),
        );
    }
}

/// A path as the address of a link: every byte that means something in an address is written as `%` and its two digits (RFC 3986).
fn address(path: &str) -> String {
    let is_plain = |byte: u8| byte.is_ascii_alphanumeric() || b"-._~/".contains(&byte);
    // Of a colon before the first slash a browser would make the name of a protocol, and an address of an object store is one.
    let is_remote = path.contains("://");
    path.bytes().fold(String::new(), |mut address, byte| {
        if is_plain(byte) || (is_remote && byte == b':') {
            address.push(char::from(byte));
        } else {
            let _ = write!(address, "%{byte:02X}");
        }
        address
    })
}

/// A cell with a number, which sorts by its value. What is not finite is an empty cell.
fn number(value: f64) -> String {
    let text = if value.is_finite() { short(value) } else { String::new() };
    format!("<td data-v=\"{value}\">{text}</td>")
}

/// A number with four digits.
fn short(value: f64) -> String {
    match value.abs() {
        size if size == 0.0 || (1e-3..1e5).contains(&size) => {
            let before = if size > 0.0 { libm::floor(libm::log10(size)) as i32 } else { 0 };
            let text = format!("{value:.*}", (3 - before).max(0) as usize);
            match text.contains('.') {
                true => text.trim_end_matches('0').trim_end_matches('.').to_owned(),
                false => text,
            }
        }
        _ => format!("{value:.2e}"),
    }
}

/// Text without what HTML would take for a command.
fn escaped(text: &str) -> String {
    text.chars().fold(String::with_capacity(text.len()), |mut escaped, letter| {
        match letter {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '"' => escaped.push_str("&quot;"),
            '\'' => escaped.push_str("&#39;"),
            letter if letter.is_control() => escaped.push(' '),
            letter => escaped.push(letter),
        }
        escaped
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::logs::LogRow;
    use crate::row::Row;
    use crate::statistics::tell::{Question, tell};

    #[test]
    fn every_course_has_a_row_and_every_point_leads_to_its_flight() {
        let mut rows = Vec::new();
        let mut logs = Vec::new();
        for flight in 0..8_u8 {
            let hash = format!("{flight:064}");
            let value = if flight == 6 { -0.9 } else { -0.5 + 0.001 * f64::from(flight % 3) };
            rows.push(Row {
                kind: "log".to_owned(),
                source_sha256: Some(hash.clone()),
                model: "jet <b>".to_owned(),
                status: "sound".to_owned(),
                segment: Some(1),
                parameter: Some("Cm_alpha".to_owned()),
                parameter_status: Some("converged".to_owned()),
                value: Some(value),
                std_error: Some(0.02),
                random_std: Some(0.002),
                ..Row::default()
            });
            let path = format!("logs/a&b/{flight}.csv");
            logs.push(LogRow { log_sha256: hash, path, airframe: "a&b".to_owned(), ..LogRow::default() });
        }
        let findings = tell(&rows, &logs, &Question::default()).unwrap();
        let page = html(&findings, &Reports::new());
        assert_eq!(page.matches("<circle").count(), 8);
        assert_eq!(page.matches("class=\"bad\"").count(), 1);
        assert!((1..=8).all(|k| page.contains(&format!("href=\"#f{k}\"")) && page.contains(&format!("id=\"f{k}\""))));
        assert!(
            page.contains("a&amp;b")
                && page.contains("jet &lt;b&gt;")
                && !page.contains("<b>")
                && !page.contains("a&b/")
        );
        assert!(!page.contains("http"));
        // The point of a segment with a report leads there, and so does the line of its flight.
        let reports = Reports::from([((format!("{:064}", 3), 1), "fleet-reports/a&b.html".to_owned())]);
        let page = html(&findings, &reports);
        assert_eq!(page.matches("href=\"fleet-reports/a%26b.html\"").count(), 2);
        assert_eq!(page.matches("href=\"#f").count(), 7);
    }

    #[test]
    fn a_link_leads_to_the_file_whatever_its_name() {
        assert_eq!(address("logs/a b#1?x=100%.csv"), "logs/a%20b%231%3Fx%3D100%25.csv");
        assert_eq!(address("s3://bucket/\u{e9}.csv"), "s3://bucket/%C3%A9.csv");
    }

    #[test]
    fn numbers_are_short() {
        for (value, text) in
            [(-0.49858, "-0.4986"), (12.0, "12"), (0.0, "0"), (1.5e-7, "1.50e-7"), (1234.5, "1234"), (100.0, "100")]
        {
            assert_eq!(short(value), text);
        }
    }
}
