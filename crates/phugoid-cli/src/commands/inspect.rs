//! `phugoid inspect`.

use std::fmt::Write as _;
use std::path::PathBuf;

use phugoid_flight_data::log::survey::{Survey, TopicSurvey};
use phugoid_flight_data::quality::Severity;
use phugoid_flight_data::reader::{self, Surveyed};
use phugoid_identification::inspect::{Coherence, CoherenceCurve, Inspection, ModelSupport};
use phugoid_identification::manoeuvres::{Manoeuvre, Support};
use phugoid_identification::model_file::ModelFile;
use phugoid_report::{coherence_figures, write_named_figures};
use serde::Serialize;

use super::deleting::Deletions;
use super::estimate::model;
use super::result::paragraph;
use crate::arguments;
use crate::failure::Failure;
use crate::output::{Table, deliver, fixed, significant};
use crate::progress::Progress;

/// The contents of a file as a JSON document, in SI units.
#[derive(Serialize)]
struct Document<'a> {
    /// For a log: its topics as they were recorded.
    #[serde(skip_serializing_if = "Option::is_none")]
    log: Option<&'a Survey>,
    /// For a log that cannot be read as a flight: the reason.
    #[serde(skip_serializing_if = "Option::is_none")]
    no_flight: Option<&'a str>,
    #[serde(flatten)]
    inspection: Option<&'a Inspection>,
    /// Figures that were written.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    figures: Vec<PathBuf>,
}

pub(crate) fn run(arguments: &arguments::Inspect) -> Result<(), Failure> {
    let wanted = arguments.model.as_deref().map(model).transpose()?;
    let columns = wanted.as_ref().map(ModelFile::columns).unwrap_or_default();
    let deletions = Deletions::new(&arguments.deleting, &[&arguments.flight])?;
    let (survey, inspection, no_flight) = {
        let _progress = Progress::spinner("reading");
        let mut options = arguments.reading.options(&arguments.flight)?;
        options.table.columns = columns;
        let Surveyed { survey, record } = reader::survey_path(&arguments.flight, &options).map_err(Failure::input)?;
        match record {
            Ok(mut record) => {
                deletions.apply(&mut record, &arguments.flight, true)?;
                (survey, Some(phugoid::inspect(&record, wanted.as_ref())), None)
            }
            // A log without a flight in it is a result too.
            Err(why) => (survey, None, Some(why.to_string())),
        }
    };
    let figures = match (&arguments.figures, &inspection) {
        (Some(folder), Some(inspection)) => write_named_figures(folder, &coherence_figures(&inspection.coherence))
            .map_err(|e| Failure::writing_of("--figures", folder, e))?,
        _ => Vec::new(),
    };
    let document =
        Document { log: survey.as_ref(), no_flight: no_flight.as_deref(), inspection: inspection.as_ref(), figures };
    let delivery = &arguments.delivery;
    deliver(&document, delivery.json, delivery.out.as_deref(), || {
        let mut told = survey.as_ref().map(log_text).unwrap_or_default();
        paragraph(&mut told, "What stands in the way", no_flight.iter().cloned());
        if let Some(inspection) = &inspection {
            if !told.is_empty() {
                told.push_str("\nAs a flight: ");
            }
            told.push_str(&text(inspection, arguments.model.is_some()));
        }
        if let Some(folder) = arguments.figures.as_ref() {
            let _ = match document.figures.len() {
                0 => writeln!(told, "\nNo figure was written: there is no coherence to show"),
                count => writeln!(told, "\n{count} figure files in {}", folder.display()),
            };
        }
        told
    })
}

fn log_text(survey: &Survey) -> String {
    let mut table = Table::with_words(&["topic", "samples", "from", "to", "Hz", "gaps", "longest", "fields"], &[0]);
    let row = |topic: &TopicSurvey| {
        let instance = if topic.instance == 0 { String::new() } else { format!("#{}", topic.instance) };
        [
            format!("{}{instance}", topic.name),
            topic.samples.to_string(),
            format!("{} s", fixed(topic.first_s, 2)),
            format!("{} s", fixed(topic.last_s, 2)),
            if topic.step_s > 0.0 { rate(1.0 / topic.step_s) } else { "-".to_owned() },
            topic.gaps.to_string(),
            format!("{} s", significant(topic.longest_step_s, 2)),
            topic.fields.len().to_string(),
        ]
    };
    for topic in &survey.topics {
        table.row(row(topic));
    }
    let mut text = format!("{}\n{} topics\n\nTopics\n{}", survey.source, survey.topics.len(), table.render());
    let finding = |f: &phugoid_flight_data::quality::Finding| match f.place.as_str() {
        "" => f.message.clone(),
        place => format!("{place}: {}", f.message),
    };
    paragraph(&mut text, "Reading the log", survey.quality.findings.iter().map(finding));
    text
}

fn text(inspection: &Inspection, one_model: bool) -> String {
    let mut text = String::new();
    let span = inspection.span_s.map_or_else(String::new, |[from, to]| {
        format!(" from {} s to {} s, {} Hz", fixed(from, 2), fixed(to, 2), rate(1.0 / inspection.sample_time_s))
    });
    // Writing to a string cannot fail.
    let _ = writeln!(text, "{}\n{} samples{span}", inspection.source, inspection.samples);
    let _ = writeln!(text, "\nChannels");
    text.push_str(&channels(inspection));
    let gap = |g: &[f64; 2]| format!("no sample from {} s to {} s", fixed(g[0], 2), fixed(g[1], 2));
    paragraph(&mut text, "Gaps", inspection.gaps_s.iter().map(gap));
    let findings = inspection.quality.findings.iter().chain(&inspection.doubts).map(|f| {
        let kind = if f.severity == Severity::Warning { "warning: " } else { "" };
        if f.place.is_empty() { format!("{kind}{}", f.message) } else { format!("{kind}{}: {}", f.place, f.message) }
    });
    paragraph(&mut text, "Data quality", findings);
    let found = &inspection.found;
    if !found.manoeuvres.is_empty() {
        let _ = writeln!(text, "\nManoeuvres");
        text.push_str(&manoeuvres(&found.manoeuvres));
        let remarks = found.manoeuvres.iter().flat_map(|m| m.remarks.iter().map(move |r| format!("{}: {r}", m.number)));
        paragraph(&mut text, "Remarks", remarks);
    }
    let motion = |u: &phugoid_identification::manoeuvres::Unforced| {
        format!(
            "{} s to {} s: {}; rates {} times their noise",
            fixed(u.from_s, 2),
            fixed(u.to_s, 2),
            u.words,
            significant(u.signal_to_noise, 2)
        )
    };
    paragraph(&mut text, "Motion without input", found.unforced.iter().map(motion));
    match &inspection.support {
        Some(support) => text.push_str(&parameters(support)),
        None => text.push_str(&derivatives(inspection)),
    }
    text.push_str(&coherence(&inspection.coherence));
    paragraph(&mut text, "What stands in the way", found.reasons.iter().cloned());
    paragraph(&mut text, if one_model { "Model" } else { "Built-in models" }, needs(inspection));
    text
}

fn channels(inspection: &Inspection) -> String {
    let mut table = Table::with_words(
        &["channel", "from", "given in", "values", "Hz", "longest gap", "min", "median", "max", "noise", "unit"],
        &[0, 1, 2, 10],
    );
    let number = |value: Option<f64>| value.map_or_else(|| "-".to_owned(), |v| significant(v, 4));
    for channel in &inspection.channels {
        let given = match (channel.unit_given.as_str(), channel.unit_assumed) {
            ("", _) => "-".to_owned(),
            (unit, true) => format!("{unit}, assumed"),
            (unit, false) => unit.to_owned(),
        };
        let noise = channel.noise.map_or_else(
            || "still".to_owned(),
            |n| format!("{}{}", significant(n, 2), if channel.quantised { " (step)" } else { "" }),
        );
        table.row([
            channel.name.clone(),
            if channel.header.is_empty() { "-".to_owned() } else { channel.header.clone() },
            given,
            channel.values.to_string(),
            channel.rate_hz.map_or_else(|| "-".to_owned(), rate),
            channel.longest_gap_s.map_or_else(|| "-".to_owned(), |g| format!("{} s", significant(g, 2))),
            number(channel.minimum),
            number(channel.median),
            number(channel.maximum),
            noise,
            channel.unit.clone(),
        ]);
    }
    table.render()
}

fn rate(hz: f64) -> String {
    significant(hz, 3)
}

fn manoeuvres(list: &[Manoeuvre]) -> String {
    let mut table =
        Table::with_words(&["no.", "from", "to", "input", "peak", "loudest answer", "useful", "tells"], &[3, 5, 6, 7]);
    for manoeuvre in list {
        let loudest = manoeuvre.responses.iter().max_by(|a, b| a.signal_to_noise.total_cmp(&b.signal_to_noise));
        let peak = manoeuvre.inputs.iter().map(|i| format!("{} deg", significant(i.peak_rad.to_degrees(), 2)));
        let told = manoeuvre.coefficients.iter().filter(|c| c.support == Support::Told).count();
        let roughly = manoeuvre.coefficients.iter().filter(|c| c.support == Support::Roughly).count();
        table.row([
            manoeuvre.number.to_string(),
            format!("{} s", fixed(manoeuvre.from_s, 2)),
            format!("{} s", fixed(manoeuvre.to_s, 2)),
            manoeuvre.words(),
            peak.collect::<Vec<_>>().join(", "),
            loudest.map_or_else(
                || "-".to_owned(),
                |r| format!("{} {}x noise", r.channel, significant(r.signal_to_noise, 2)),
            ),
            if manoeuvre.useful { "yes" } else { "no" }.to_owned(),
            format!("{told}, {roughly} more roughly"),
        ]);
    }
    table.render() + "  Estimate from one of them with `phugoid estimate ... --segment N`.\n"
}

fn derivatives(inspection: &Inspection) -> String {
    if inspection.derivatives.is_empty() {
        return String::new();
    }
    let mut table = Table::with_words(&["derivative", "can be told", "best in", "why"], &[0, 1, 2, 3]);
    for derivative in &inspection.derivatives {
        table.row([
            derivative.coefficient.name.clone(),
            word(derivative.coefficient.support).to_owned(),
            format!("manoeuvre {}", derivative.manoeuvre),
            derivative.coefficient.reason.clone(),
        ]);
    }
    format!("\nDerivatives that the record could support, by regression with these terms alone\n{}", table.render())
}

fn word(support: Support) -> &'static str {
    match support {
        Support::Told => "yes",
        Support::Roughly => "roughly",
        Support::Small => "near zero",
        Support::No => "no",
    }
}

/// Table of the bounds (Cramer-Rao) that the record allows for the parameters of the model.
fn parameters(support: &ModelSupport) -> String {
    let mut names: Vec<&str> = Vec::new();
    for parameter in support.segments.iter().flat_map(|segment| &segment.parameters) {
        if !names.contains(&parameter.bound.name.as_str()) {
            names.push(&parameter.bound.name);
        }
    }
    let mut table = Table::with_words(
        &["parameter", "can be told", "best in", "2 sigma", "declared", "at best", "why"],
        &[0, 1, 2, 6],
    );
    let percent =
        |share: f64| if share < 100.0 { format!("{} %", significant(100.0 * share, 2)) } else { "-".to_owned() };
    for (segment, parameter) in names.iter().filter_map(|name| support.best(name)) {
        let numbers: Vec<String> = segment.manoeuvres.iter().map(usize::to_string).collect();
        table.row([
            parameter.bound.name.clone(),
            word(parameter.support).to_owned(),
            numbers.join(","),
            percent(parameter.expected),
            percent(parameter.declared),
            percent(parameter.at_best),
            parameter.reason.clone(),
        ]);
    }
    let mut text = String::new();
    if !names.is_empty() {
        text = format!(
            "\nParameters of {} that the record could support, by its Cramer-Rao bound\n{}  2 sigma: with the residuals that the \
             model leaves and what `[uncertainty]` declares; declared: that part, which a calibration makes smaller and another \
             manoeuvre hardly; at best: with the noise of the sensors alone.\n",
            support.model,
            table.render()
        );
    }
    let notes = support.segments.iter().flat_map(|segment| {
        let numbers: Vec<String> = segment.manoeuvres.iter().map(usize::to_string).collect();
        segment.notes.iter().map(move |note| format!("{}: {note}", numbers.join(",")))
    });
    paragraph(&mut text, "How the bounds were had", notes.chain(support.reasons.iter().cloned()));
    text
}

/// Table of the coherences that are above chance, and the pairs that are not.
fn coherence(pairs: &[Coherence]) -> String {
    /// Bands that are shown of one pair.
    const SHOWN: usize = 3;
    let mut table = Table::with_words(
        &["input", "output", "given", "Hz above chance", "peak", "at", "all together", "level", "averages", "band"],
        &[0, 1, 2, 3],
    );
    let hz = |value: f64| format!("{} Hz", significant(value, 2));
    let (mut shown, mut below) = (false, Vec::<(&str, Vec<&str>)>::new());
    let significant_curve = |pair: &&Coherence| pair.decisive().is_some_and(CoherenceCurve::is_significant);
    for pair in pairs.iter().filter(significant_curve) {
        let Some(curve) = pair.decisive() else { continue };
        let mut bands: Vec<String> = curve
            .bands_hz
            .iter()
            .take(SHOWN)
            .map(|[from, to]| {
                if from < to {
                    format!("{} to {}", significant(*from, 2), significant(*to, 2))
                } else {
                    significant(*from, 2)
                }
            })
            .collect();
        if curve.bands_hz.len() > SHOWN {
            bands.push("...".to_owned());
        }
        shown = true;
        table.row([
            pair.input.clone(),
            pair.output.clone(),
            if pair.given.is_empty() { "-".to_owned() } else { pair.given.join(", ") },
            bands.join(", "),
            fixed(curve.peak, 2),
            hz(curve.peak_hz),
            pair.multiple.as_ref().map_or_else(|| "-".to_owned(), |all| fixed(all.peak, 2)),
            fixed(curve.level, 2),
            pair.averages.to_string(),
            hz(pair.bandwidth_hz),
        ]);
    }
    for pair in pairs.iter().filter(|pair| pair.decisive().is_some() && !significant_curve(pair)) {
        match below.last_mut().filter(|(input, _)| *input == pair.input) {
            Some((_, outputs)) => outputs.push(&pair.output),
            None => below.push((&pair.input, vec![&pair.output])),
        }
    }
    let mut text = String::new();
    if shown {
        text = format!(
            "\nCoherence of inputs and outputs: the part of an output's spectrum that is linear in the input\n{}  Noise \
             alone exceeds the level at one frequency in twenty.{}\n",
            table.render(),
            if pairs.iter().any(|pair| pair.partial.is_some()) {
                " Given: after the effect of that surface is taken out of both."
            } else {
                ""
            }
        );
    }
    let not_above =
        below.iter().map(|(input, outputs)| format!("{input}: not above chance with {}", outputs.join(", ")));
    let why = pairs.iter().filter(|pair| !pair.reason.is_empty());
    let why = why.map(|pair| format!("{} and {}: {}", pair.input, pair.output, pair.reason));
    paragraph(&mut text, "Without coherence", not_above.chain(why));
    text
}

fn needs(inspection: &Inspection) -> impl Iterator<Item = String> {
    inspection.models.iter().map(|needs| {
        let mut lacks: Vec<String> = needs.missing.clone();
        lacks.extend(needs.empty.iter().map(|name| format!("{name} (there, but empty)")));
        if lacks.is_empty() {
            format!("{} ({}): every channel is there", needs.model, needs.aircraft)
        } else {
            format!("{} ({}): lacks {}", needs.model, needs.aircraft, lacks.join(", "))
        }
    })
}
