//! `phugoid field`.

use std::fmt::Write as _;
use std::sync::atomic::{AtomicUsize, Ordering};

use phugoid_evaluation::field::drawn::{Budget, Draw, DrawnStudy};
use phugoid_evaluation::field::structure::{FINDABLE, NOT_THERE, StructureStudy};
use phugoid_evaluation::field::summary::{ChangeSummary, ConsistencySummary, GroupSummary, WatchSummary};
use phugoid_evaluation::field::truth::Kind;
use phugoid_evaluation::field::{FaultSummary, FieldOptions, FieldStudy, run as run_field, run_drawn, run_structure};
use phugoid_identification::method::Method;
use phugoid_identification::options::Likelihood;

use super::estimate::check_options_of_methods;
use crate::arguments;
use crate::failure::Failure;
use crate::output::{Table, deliver, significant};
use crate::progress::Progress;

pub(crate) fn run(arguments: &arguments::Field) -> Result<(), Failure> {
    let methods = if arguments.method.is_empty() { vec![Method::default()] } else { arguments.method.clone() };
    check_options_of_methods(&methods, arguments.gaussian, arguments.flow_angles)?;
    let options = FieldOptions {
        split: arguments.split.split(),
        methods,
        only: arguments.only.clone(),
        faults: arguments.faults as usize,
        monitor: !arguments.no_monitor,
        likelihood: if arguments.gaussian { Likelihood::Gaussian } else { Likelihood::Robust },
        flow_angles: arguments.flow_angles.into(),
        learning: arguments.learn,
        drawn: arguments.with_drawn,
    };
    let progress = Progress::new("estimating");
    let ready = AtomicUsize::new(0);
    let done = |all: usize| progress.set((1 + ready.fetch_add(1, Ordering::Relaxed)) as f64 / all as f64);
    let delivery = &arguments.delivery;
    if arguments.structure_study {
        let study = run_structure(&arguments.folder, &options, &done).map_err(Failure::input)?;
        drop(progress);
        return deliver(&study, delivery.json, delivery.out.as_deref(), || structure(&study));
    }
    if let Some(per_row) = arguments.drawn_errors {
        let ranked = arguments.ranked as usize;
        let study = run_drawn(&arguments.folder, &options, per_row as usize, ranked, &done).map_err(Failure::input)?;
        drop(progress);
        return deliver(&study, delivery.json, delivery.out.as_deref(), || drawn(&study));
    }
    let study = run_field(&arguments.folder, &options, &done).map_err(Failure::input)?;
    drop(progress);
    deliver(&study, delivery.json, delivery.out.as_deref(), || text(&study))
}

/// Whether the bounds hold the errors that were drawn.
fn drawn(study: &DrawnStudy) -> String {
    let head = ["errors", "declared part", "flights", "parameters", "covered", "claimed/actual", "+- 2 sigma"];
    let mut table = Table::with_words(&head, &[0, 1]);
    for s in &study.summaries {
        table.row([
            match s.draw {
                Draw::None => "none".to_owned(),
                Draw::All => "all".to_owned(),
                Draw::One(quantity) => quantity.to_string(),
            },
            match s.budget {
                Budget::None => "left out",
                Budget::Powers => "powers of scales",
                Budget::Followed => "followed",
                Budget::Half => "followed, half declared",
                Budget::Twice => "followed, twice declared",
            }
            .to_owned(),
            s.flights.to_string(),
            s.parameters.to_string(),
            format!("{:.1} %", 100.0 * s.covered),
            significant(s.claimed_over_actual, 3),
            format!("{:.1} %", 100.0 * s.width),
        ]);
    }
    let ranking = study.ranking.as_ref().map_or_else(String::new, |r| {
        format!(
            "\nLargest contributor named rightly for {} of {} parameters, or one that does at least four fifths as much for \
             {}.\nSystematic standard error by re-runs over the claimed one, quartiles: {}.\n",
            r.named_rightly,
            r.parameters,
            r.named_nearly,
            r.rerun_over_claimed.map(|q| significant(q, 3)).join(", "),
        )
    });
    format!("Errors drawn from the declared distributions, method {}\n{}{ranking}", study.method, table.render())
}

/// What was found of the missing terms.
fn structure(study: &StructureStudy) -> String {
    let mut table = Table::with_words(
        &[
            "missing",
            "method",
            "trials",
            "findable",
            "found",
            "or alike",
            "offered in",
            "falsely",
            "numbers",
            "covered before",
            "after",
        ],
        &[0, 1],
    );
    let percent = |part: f64| if part.is_nan() { "-".to_owned() } else { format!("{:.1} %", 100.0 * part) };
    for s in &study.summaries {
        table.row([
            s.name.clone(),
            s.method.to_string(),
            s.trials.to_string(),
            s.findable.to_string(),
            s.found.to_string(),
            s.found_alike.to_string(),
            s.any.to_string(),
            s.false_offers.to_string(),
            s.numbers.to_string(),
            percent(s.covered_before),
            percent(s.covered_after),
        ]);
    }
    format!(
        "{}Findable: the term alone makes {:.0} % of its coefficient's motion. Alike: one that adds the same to the model.\n\
         Falsely: a term that makes less than {:.0} %. Covered: of the other derivatives, in trials with an offer.\n",
        table.render(),
        100.0 * FINDABLE,
        100.0 * NOT_THERE
    )
}

fn text(study: &FieldStudy) -> String {
    let mut text = study.drawn.map_or_else(String::new, |seed| {
        format!("All errors that the model files declare are in every flight, drawn from seed {seed}.\n\n")
    });
    for (title, summaries) in
        [("All flights", &study.all), ("By group of flights", &study.groups), ("By aircraft", &study.aircraft)]
    {
        let _ = writeln!(text, "{title}\n{}", groups(summaries.iter()));
    }
    text.push_str(
        "Error: of the derivatives that the flight shows, as a part of the truth. Covered: truth within two claimed standard\n\
         errors; by random: by the part of them that is not declared in [uncertainty]. Silently wrong: called converged, without\n\
         a warning, and more than four standard errors from the truth; the number of flights in which that happens, and how many\n\
         of those have a remark at least.\n",
    );
    let reasons = reasons(&study.all);
    if !reasons.is_empty() {
        let _ = writeln!(text, "\nWhy results are not sound\n{reasons}");
    }
    if !study.consistency.is_empty() {
        let _ = writeln!(text, "\nConsistency of healthy flights\n{}", consistency(&study.consistency));
        text.push_str(
            "Squares: the median over the flights of the mean squared innovation, and the median squared error, both by what\n\
             is claimed: one where the claims are right. Rejected: longest time in which more than\n\
             four of five rows of one output were rejected.\n",
        );
    }
    let _ = writeln!(text, "\nSudden changes\n{}", changes(&study.changes));
    if !study.watched.is_empty() {
        let _ = writeln!(text, "Health monitor\n{}", watched(&study.watched));
    }
    if !study.faults.is_empty() {
        let _ = writeln!(text, "Flights with a physical error put in\n{}", faults(&study.faults));
    }
    text
}

const COLUMNS: [&str; 12] = [
    "flights",
    "refused",
    "doubtful",
    "numbers",
    "error",
    "90 %",
    "covered",
    "by random",
    "claimed",
    "silently wrong",
    "flights",
    "remarked",
];

/// The cells of one summary, without its name.
fn cells(s: &GroupSummary) -> Vec<String> {
    let percent = |part: f64| if part.is_nan() { "-".to_owned() } else { format!("{:.1} %", 100.0 * part) };
    vec![
        s.flights.to_string(),
        s.refused.to_string(),
        s.doubtful.to_string(),
        s.derivatives.to_string(),
        percent(s.error_median),
        percent(s.error_90_percent),
        percent(s.coverage),
        percent(s.coverage_random),
        percent(s.claimed),
        percent(s.silently_wrong),
        s.flights_silently_wrong.to_string(),
        s.of_those_remarked.to_string(),
    ]
}

fn groups<'a>(summaries: impl Iterator<Item = &'a GroupSummary>) -> String {
    let header: Vec<&str> = ["", "kind", "method"].into_iter().chain(COLUMNS).collect();
    let mut table = Table::with_words(&header, &[0, 1, 2]);
    for s in summaries {
        let kind = match s.kind {
            Kind::Sound => "sound",
            Kind::Faulty => "faulty",
        };
        table.row([s.name.clone(), kind.to_owned(), s.method.to_string()].into_iter().chain(cells(s)));
    }
    table.render()
}

fn reasons(summaries: &[GroupSummary]) -> String {
    let mut table = Table::with_words(&["kind", "method", "reason", "flights"], &[0, 1, 2]);
    let mut any = false;
    for s in summaries {
        for (reason, count) in &s.reasons {
            any = true;
            let kind = if s.kind == Kind::Sound { "sound" } else { "faulty" };
            table.row([kind.to_owned(), s.method.to_string(), reason.clone(), count.to_string()]);
        }
    }
    if any { table.render() } else { String::new() }
}

fn consistency(summaries: &[ConsistencySummary]) -> String {
    let mut table = Table::new(&[
        "method",
        "flights",
        "innovation squared",
        "error squared",
        "longest rejected",
        "over 1 s in flights",
    ]);
    let or_none = |value: f64| if value.is_nan() { "-".to_owned() } else { significant(value, 3) };
    for s in summaries {
        table.row([
            s.method.to_string(),
            s.flights.to_string(),
            or_none(s.innovation_squared),
            or_none(s.error_squared),
            format!("{} s", significant(s.longest_rejected_s, 3)),
            s.locked_out.to_string(),
        ]);
    }
    table.render()
}

fn changes(summaries: &[ChangeSummary]) -> String {
    let mut healthy =
        Table::new(&["method", "healthy flights", "hours", "adopted", "not taken back", "in flights", "worse after"]);
    let mut real = Table::with_words(
        &[
            "method",
            "change",
            "flights",
            "found",
            "of half or more",
            "missed, unwarned",
            "after",
            "early",
            "dated rightly",
            "within",
            "named rightly",
            "named wrongly",
        ],
        &[0, 1],
    );
    for s in summaries {
        healthy.row([
            s.method.to_string(),
            s.healthy_flights.to_string(),
            format!("{:.2}", s.healthy_hours),
            s.false_adoptions.to_string(),
            s.kept.to_string(),
            s.flights_with_kept.to_string(),
            s.harmed.to_string(),
        ]);
        for (name, found) in [("damage", &s.damages), ("trim shift", &s.trim_shifts)] {
            let seconds = |s: f64| if s.is_nan() { "-".to_owned() } else { format!("{} s", significant(s, 3)) };
            real.row([
                s.method.to_string(),
                name.to_owned(),
                found.flights.to_string(),
                found.found.to_string(),
                format!("{} of {}", found.of_half_found, found.of_half),
                found.missed_unwarned.to_string(),
                seconds(found.latency_median_s),
                found.early.to_string(),
                format!("{} of {}", found.dated_rightly, found.dated),
                seconds(found.interval_median_s),
                found.named_rightly.to_string(),
                found.named_wrongly.to_string(),
            ]);
        }
    }
    healthy.render() + "\n" + &real.render()
}

fn watched(summaries: &[WatchSummary]) -> String {
    let mut table = Table::new(&[
        "flights are",
        "number",
        "hours",
        "false alarms",
        "per hour",
        "95 %",
        "called healthy",
        "missed",
        "named rightly",
        "named wrongly",
        "not named",
    ]);
    for s in summaries {
        table.row([
            s.name.clone(),
            s.flights.to_string(),
            format!("{:.2}", s.hours),
            s.false_alarms.to_string(),
            significant(s.per_hour, 3),
            format!("{} to {}", significant(s.per_hour_interval[0], 3), significant(s.per_hour_interval[1], 3)),
            s.called_healthy.to_string(),
            s.missed.to_string(),
            s.named_rightly.to_string(),
            s.named_wrongly.to_string(),
            s.not_named.to_string(),
        ]);
    }
    table.render()
}

fn faults(summaries: &[FaultSummary]) -> String {
    let header: Vec<&str> = ["error"].into_iter().chain(COLUMNS).chain(["times the sound error"]).collect();
    let mut table = Table::new(&header);
    for s in summaries {
        let ratio = if s.error_ratio.is_nan() { "-".to_owned() } else { significant(s.error_ratio, 3) };
        table.row([s.summary.name.clone()].into_iter().chain(cells(&s.summary)).chain([ratio]));
    }
    table.render()
}
