//! `phugoid fleet tell`.

use std::fmt::Write as _;

use phugoid_fleet::logs::LogRow;
use phugoid_fleet::row::Row;
use phugoid_fleet::statistics::tell::{Airframe, Course, Findings, Shape, tell};
use phugoid_fleet::store::Store;

use crate::arguments::fleet::{Asking, Tell};
use crate::failure::Failure;
use crate::output::{Table, deliver, significant};

/// More rows of means than this are left to `--json`.
const MOST_MEANS: usize = 200;

pub(super) fn run(arguments: &Tell) -> Result<(), Failure> {
    let findings = findings(&arguments.store, &arguments.asking)?;
    deliver(&findings, arguments.delivery.json, arguments.delivery.out.as_deref(), || text(&findings))
}

/// What the store in a folder tells.
pub(super) fn findings(folder: &std::path::Path, asking: &Asking) -> Result<Findings, Failure> {
    told(folder, asking).map(|(_, _, findings)| findings)
}

/// The rows and the logs of the store in a folder, and what they tell.
pub(super) fn told(folder: &std::path::Path, asking: &Asking) -> Result<(Vec<Row>, Vec<LogRow>, Findings), Failure> {
    let store = Store::open(folder)?;
    let (rows, logs) = (store.rows()?, store.logs()?);
    let findings = tell(&rows, &logs, &asking.question()).map_err(Failure::input)?;
    Ok((rows, logs, findings))
}

fn text(findings: &Findings) -> String {
    let mut text = format!("{}: {}\n", findings.set, findings.counts());
    if !findings.refused.is_empty() {
        let words: Vec<String> = findings.refused.iter().map(|(word, count)| format!("{word} {count}")).collect();
        let _ = writeln!(text, "Without numbers: {}", words.join(", "));
    }
    for note in &findings.notes {
        let _ = writeln!(text, "Note: {note}.");
    }
    let _ = writeln!(
        text,
        "Findings are called so at a rate of false ones of {} %.",
        significant(100.0 * findings.false_discoveries, 3)
    );
    let each = || findings.airframes.iter().flat_map(|a| a.courses.iter().map(move |course| (a, course)));
    if let Some(table) = unused(findings) {
        section(&mut text, "Flights without an estimate that can be used", Some(table));
    }
    section(&mut text, "Drifts and steps", changes(findings));
    section(&mut text, "Airframes apart from the others", outliers(findings));
    section(&mut text, "What explains these, all parameters of an airframe together", causes(findings));
    section(&mut text, "Flights that disagree with their own airframe", flights(each()));
    section(&mut text, "Flights within two claimed standard errors of the others", coverage(findings));
    match each().count() {
        count if count > MOST_MEANS => {
            let _ = writeln!(text, "\nMeans of {count} courses: phugoid fleet tell --json");
        }
        _ => section(&mut text, "Means over the flights", means(each())),
    }
    text
}

fn section(text: &mut String, title: &str, table: Option<String>) {
    let _ = write!(text, "\n{title}\n{}", table.unwrap_or_else(|| "  none\n".to_owned()));
}

fn unused(findings: &Findings) -> Option<String> {
    let mut table =
        Table::with_words(&["airframe", "flights", "of", "what", "reasons, and in how many flights"], &[0, 3, 4]);
    let with: Vec<&Airframe> = findings.airframes.iter().filter(|airframe| airframe.unused.logs > 0).collect();
    for airframe in &with {
        let own = &airframe.unused;
        table.row([
            airframe.name.clone(),
            own.logs.to_string(),
            own.of.to_string(),
            if own.is_apart { "more than the others: check its sensors".to_owned() } else { "-".to_owned() },
            own.words(),
        ]);
    }
    (!with.is_empty()).then(|| table.render())
}

fn changes(findings: &Findings) -> Option<String> {
    let unit = findings.over.unit();
    let mut table = Table::with_words(
        &["airframe", "parameter", "what", "size", "+- 2 sigma", "of the mean", "rate"],
        &[0, 1, 2, 3],
    );
    let mut any = false;
    for airframe in &findings.airframes {
        for course in &airframe.courses {
            let (what, change, per) = match (course.shape, course.drift, course.step) {
                (Shape::Drift, Some(drift), _) => ("drift".to_owned(), drift, format!(" per {unit}")),
                (Shape::Step, _, Some(step)) => (format!("step at {unit} {}", step.at), step, String::new()),
                _ => continue,
            };
            any = true;
            table.row([
                airframe.name.clone(),
                course.parameter.clone(),
                what,
                format!("{}{per}", significant(change.size, 3)),
                significant(2.0 * change.std_error, 3),
                format!("{} %", significant(100.0 * change.size / course.combined.value.abs(), 3)),
                significant(course.change_rate.unwrap_or(f64::NAN), 2),
            ]);
        }
    }
    any.then(|| table.render())
}

/// The causes of what courses do; none where nothing was found that several parameters could tell.
fn causes(findings: &Findings) -> Option<String> {
    let unit = findings.over.unit();
    let mut table = Table::with_words(&["airframe", "what", "explained by, +- 2 sigma", "p"], &[0, 1, 2]);
    let mut any = false;
    for (airframe, together) in findings.airframes.iter().flat_map(|a| a.together.iter().map(move |t| (a, t))) {
        for (line, p) in together.lines(unit) {
            any = true;
            let p = p.map_or_else(|| "-".to_owned(), |p| significant(p, 2));
            table.row([airframe.name.clone(), together.words(unit), line, p]);
        }
    }
    any.then(|| table.render())
}

fn outliers(findings: &Findings) -> Option<String> {
    let mut table = Table::with_words(&["airframe", "parameter", "distance", "sigmas", "rate"], &[0, 1]);
    let mut any = false;
    for airframe in &findings.airframes {
        for course in airframe.courses.iter().filter(|course| course.is_outlier) {
            let Some(apart) = course.apart else { continue };
            any = true;
            table.row([
                airframe.name.clone(),
                course.parameter.clone(),
                significant(apart.distance, 3),
                format!("{:+.1}", apart.sigmas),
                significant(course.apart_rate.unwrap_or(f64::NAN), 2),
            ]);
        }
        if let Some(whole) = airframe.whole.filter(|whole| whole.is_apart) {
            any = true;
            let together = format!("all {} together", whole.parameters);
            table.row([airframe.name.clone(), together, "-".to_owned(), "-".to_owned(), significant(whole.rate, 2)]);
        }
    }
    any.then(|| table.render())
}

fn flights<'a>(courses: impl Iterator<Item = (&'a Airframe, &'a Course)>) -> Option<String> {
    let mut table = Table::with_words(&["airframe", "parameter", "log", "segment", "estimate", "sigmas"], &[0, 1, 2]);
    let mut any = false;
    for (airframe, course) in courses {
        for point in course.points.iter().filter(|point| point.disagrees) {
            any = true;
            table.row([
                airframe.name.clone(),
                course.parameter.clone(),
                point.path.clone(),
                point.segment.to_string(),
                significant(point.value, 5),
                format!("{:+.1}", point.sigmas.unwrap_or(f64::NAN)),
            ]);
        }
    }
    any.then(|| table.render())
}

fn coverage(findings: &Findings) -> Option<String> {
    let mut table = Table::new(&["parameter", "within", "of", "part", "95 %"]);
    for c in &findings.coverage {
        table.row([
            c.parameter.clone(),
            c.within.to_string(),
            c.of.to_string(),
            format!("{:.1} %", 100.0 * c.within as f64 / c.of as f64),
            format!("{:.1} to {:.1} %", 100.0 * c.interval[0], 100.0 * c.interval[1]),
        ]);
    }
    (!findings.coverage.is_empty()).then(|| table.render())
}

fn means<'a>(courses: impl Iterator<Item = (&'a Airframe, &'a Course)>) -> Option<String> {
    let head = [
        "airframe",
        "parameter",
        "mean",
        "+- 2 sigma",
        "random",
        "airframe's",
        "fleet's",
        "scatter",
        "estimates",
        "left out",
    ];
    let mut table = Table::with_words(&head, &[0, 1]);
    let mut any = false;
    for (airframe, course) in courses {
        any = true;
        let c = &course.combined;
        let doubled = |std: f64| significant(2.0 * std, 3);
        table.row([
            airframe.name.clone(),
            course.parameter.clone(),
            significant(c.value, 5),
            doubled(c.std_error),
            doubled(c.random_std),
            doubled(c.airframe_std),
            doubled(c.fleet_std),
            significant(c.dispersion, 3),
            course.points.len().to_string(),
            course.left_out.to_string(),
        ]);
    }
    any.then(|| table.render())
}
