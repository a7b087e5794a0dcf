//! The tables of the page of an estimation.

use std::fmt::Write as _;

use phugoid_flight_data::quality::{QualityReport, Severity};
use phugoid_identification::estimation::{
    Estimation, FinalStatus, ParameterResult, TotalDerivative, UncertainQuantity,
};

use super::options::HtmlOptions;
use super::page::{END_OF_TABLE, head, prose, table, trimmed};
use crate::escape::escape;
use crate::figures::{event_kind, unit_of};
use crate::names::{DisplayUnit, display_unit, signal_label};
use crate::statistics::output_fits;
use crate::ticks::{fixed, significant};

/// Events that are listed; further ones are only counted.
const MOST_EVENTS: usize = 300;

/// The two tables of the parameters: the results, then what was known before and what the record added.
pub(super) fn parameters(estimation: &Estimation) -> String {
    if estimation.parameters.is_empty() {
        return String::new();
    }
    let truth = estimation.parameters.iter().any(|p| p.truth.is_some());
    let mut heads = vec![
        ("", "Parameter"),
        ("", "Unit"),
        ("n", "Value"),
        ("n", "Std. error<br>(corrected)"),
        ("n", "Error<br>(%)"),
        ("n", "2σ interval"),
    ];
    if truth {
        heads.extend([("n", "Truth"), ("n", "Off by<br>(σ)")]);
    }
    heads.extend([("", "Status"), ("n", "Converged<br>at (s)")]);
    let mut out = totals(estimation);
    out.push_str(&grouped(estimation, &heads, |p| result_row(estimation, p, truth)));
    out.push_str(
        "<p class=\"note\">The 2σ interval rests on the corrected standard error, which allows for coloured residuals. \
         Error is the corrected standard error in per cent of the value. Converged at: from then on, in seconds from \
         the start of the record, the estimate stays within 5 % of the truth where that is known, else of its final value.</p>\n",
    );
    if estimation.parameters.iter().any(|p| p.systematic_std > 0.0) {
        let heads = [
            ("", "Parameter"),
            ("", "Unit"),
            ("n", "Random<br>std. error"),
            ("n", "Systematic<br>std. error"),
            ("", "Share of the variance"),
            ("", "The systematic part comes from"),
        ];
        out.push_str("<h3>Random and systematic</h3>\n");
        out.push_str(&grouped(estimation, &heads, |p| systematic_row(estimation, p)));
        out.push_str(&bar_legend(estimation));
        out.push_str(
            "<p class=\"note\">The two make the standard error above, as the root of the sum of their squares. A longer or \
             livelier flight makes the random part smaller (GUM: type A). The systematic part follows from the declared \
             uncertainties of masses and scales (type B): only a calibration or a measurement on the ground makes it \
             smaller.</p>\n",
        );
    }
    let heads = [
        ("", "Parameter"),
        ("", "Unit"),
        ("n", "Start value"),
        ("n", "Prior std.<br>deviation"),
        ("n", "Bounds"),
        ("n", "Observability"),
        ("n", "Std. error<br>(claimed)"),
        ("n", "Corrected /<br>claimed"),
    ];
    out.push_str("<h3>What was known before, and what the record added</h3>\n");
    out.push_str(&grouped(estimation, &heads, |p| prior_row(estimation, p)));
    out.push_str(
        "<p class=\"note\">Observability is 1 − variance / prior variance: 1 means that the record decided the value, \
         0 that it says nothing and the prior still stands. The claimed standard error is the covariance's own; a \
         ratio well above 1 means coloured residuals.</p>\n",
    );
    out
}

/// The table of the derivatives that increments make with the slopes of their database; empty of a model without one.
fn totals(estimation: &Estimation) -> String {
    let Some(first) = estimation.totals.first() else { return String::new() };
    let heads = [
        ("", "Derivative"),
        ("", "Unit"),
        ("n", "Total"),
        ("n", "2σ"),
        ("n", "Database"),
        ("n", "Increment"),
        ("n", "2σ"),
        ("n", "Database over"),
        ("", "Status"),
    ];
    let degrees = |angle: f64| significant(angle.to_degrees(), 3);
    let mut out = format!(
        "<h3>Total derivatives at α = {}°, elevator {}°</h3>\n<div class=\"scroll\"><table class=\"parameters\">\n",
        degrees(first.reference_alpha),
        degrees(first.reference_elevator)
    );
    out.push_str(&head(&heads));
    out.push_str("<tbody>\n");
    for t in &estimation.totals {
        let unit = unit_of(estimation, &t.increment);
        let number = |value: f64, digits| significant(value * unit.factor, digits);
        let cells = [
            format!("<b>{}</b>", number(t.value, 4)),
            number(2.0 * t.std_error, 3),
            number(t.database, 4),
            number(t.value - t.database, 3),
            number(2.0 * t.increment_std_error, 3),
            range(t),
        ];
        let (name, unit) = (escape(&t.name), escape(&unit.text));
        let (cells, status) = (number_cells(&cells), status_cell(t.status));
        let _ = writeln!(out, "<tr><th scope=\"row\">{name}</th><td>{unit}</td>{cells}{status}</tr>");
    }
    out.push_str(
        "</tbody>\n</table></div>\n<p class=\"note\">Database is the secant of the table over what was flown, from the 2 % to the \
         98 % point. The bound of a total is for a database of the right shape. That of an increment holds how much the slope \
         of the database changes over that range: another range would have given another increment.</p>\n<h3>Parameters</h3>\n",
    );
    out
}

/// The range of a variable in the flight, in degrees where it is an angle.
fn range(total: &TotalDerivative) -> String {
    let ([from, to], unit) = total.printed_range();
    format!("{} … {}{}", significant(from, 3), significant(to, 3), if unit.is_empty() { "" } else { "°" })
}

/// The cell of a status, with its colour.
fn status_cell(status: FinalStatus) -> String {
    let class = match status {
        FinalStatus::Converged => " good",
        FinalStatus::Improving => " waiting",
        FinalStatus::NotExcited | FinalStatus::AtLimit | FinalStatus::InDoubt | FinalStatus::Unknown => " bad",
        FinalStatus::Fixed => "",
    };
    format!("<td><span class=\"status{class}\">{}</span></td>", escape(&status_words(status)))
}

/// A table of all parameters, with the nuisance parameters in a group of their own.
fn grouped(estimation: &Estimation, heads: &[(&str, &str)], row: impl Fn(&ParameterResult) -> String) -> String {
    let mut out = String::from("<div class=\"scroll\"><table class=\"parameters\">\n");
    out.push_str(&head(heads));
    for (nuisance, group) in [(false, ""), (true, "Offsets and sensor biases, estimated to support the others")] {
        let rows: Vec<String> = estimation.parameters.iter().filter(|p| p.nuisance == nuisance).map(&row).collect();
        if rows.is_empty() {
            continue;
        }
        out.push_str("<tbody>\n");
        if !group.is_empty() {
            let span = heads.len();
            let _ = writeln!(out, "<tr class=\"group\"><th colspan=\"{span}\" scope=\"rowgroup\">{group}</th></tr>");
        }
        out.push_str(&rows.concat());
        out.push_str("</tbody>\n");
    }
    out.push_str("</table></div>\n");
    out
}

/// The row of a parameter in the table of the results.
fn result_row(estimation: &Estimation, parameter: &ParameterResult, truth: bool) -> String {
    let unit = unit_of(estimation, &parameter.name);
    let number = |value: f64, digits| significant(value * unit.factor, digits);
    let sigma = parameter.corrected_std_error;
    let mut cells = vec![format!("<b>{}</b>", number(parameter.value, 4))];
    if parameter.status == FinalStatus::Fixed {
        cells.extend(["–", "–", "–"].map(str::to_owned));
    } else {
        cells.push(number(sigma, 3));
        cells.push(percent(sigma, parameter.value));
        cells.push(format!("{} … {}", number(parameter.lower, 4), number(parameter.upper, 4)));
    }
    if truth {
        cells.push(parameter.truth.map_or_else(dash, |t| number(t, 4)));
        cells.push(parameter.truth.map_or_else(dash, |t| off_by((parameter.value - t) / sigma)));
    }
    format!(
        "<tr>{}{}{}{}</tr>\n",
        first_cells(parameter, &unit),
        number_cells(&cells),
        status_cell(parameter.status),
        number_cells(&[parameter.converged_at_s.map_or_else(dash, |t| fixed(t, 2))])
    )
}

/// The row of a parameter in the table of random and systematic errors.
fn systematic_row(estimation: &Estimation, parameter: &ParameterResult) -> String {
    let unit = unit_of(estimation, &parameter.name);
    let number = |value: f64| {
        if value > 0.0 { significant(value * unit.factor, 3) } else { dash() }
    };
    let cells = [number(parameter.random_std()), number(parameter.systematic_std)];
    let words = parameter.contributors_in_words(UncertainQuantity::ALL.len());
    let words = if words.is_empty() { dash() } else { escape(&words) };
    let bar = variance_bar(parameter);
    format!(
        "<tr>{}{}<td>{bar}</td><td class=\"words\">{words}</td></tr>\n",
        first_cells(parameter, &unit),
        number_cells(&cells)
    )
}

/// A bar as long as the variance of a parameter, split into what is random, what each declared quantity and what an
/// applied correction of the record makes of it; nothing where there is no variance.
fn variance_bar(parameter: &ParameterResult) -> String {
    let whole = parameter.corrected_std_error.powi(2);
    if !(whole > 0.0 && whole.is_finite()) {
        return String::new();
    }
    let random = parameter.random_std().powi(2) / whole;
    let declared = parameter.systematic_std.powi(2) / whole;
    let parts = parameter.systematic_parts.iter().map(|p| (p.quantity.key(), p.quantity.name(), declared * p.share));
    let mut out = String::from("<div class=\"bar\">");
    let correction = ("correction", "correction of the record", parameter.correction_std.powi(2) / whole);
    for (key, name, share) in std::iter::once(("random", "random", random)).chain(parts).chain([correction]) {
        let percent = 100.0 * share;
        if percent >= 0.5 {
            let _ = write!(
                out,
                "<span class=\"part {key}\" style=\"width:{percent:.1}%\" title=\"{name} {percent:.0} % of the variance\"></span>"
            );
        }
    }
    out.push_str("</div>");
    out
}

/// What the colours of [`variance_bar`] mean: the random part, and each quantity that has a part anywhere.
fn bar_legend(estimation: &Estimation) -> String {
    let shown = |quantity: &UncertainQuantity| {
        let parts = estimation.parameters.iter().flat_map(|p| &p.systematic_parts);
        parts.filter(|part| part.quantity == *quantity).any(|part| part.share >= 0.005)
    };
    let quantities = UncertainQuantity::ALL.into_iter().filter(shown).map(|q| (q.key(), q.name()));
    let mut out = String::from("<p class=\"key\">");
    for (key, name) in std::iter::once(("random", "random")).chain(quantities) {
        let _ = write!(out, "<span><i class=\"part {key}\"></i>{name}</span> ");
    }
    out.push_str("</p>\n");
    out
}

/// The row of a parameter in the table of what was known before.
fn prior_row(estimation: &Estimation, parameter: &ParameterResult) -> String {
    let unit = unit_of(estimation, &parameter.name);
    let number = |value: f64, digits| significant(value * unit.factor, digits);
    let bounds = parameter.bounds.map_or_else(dash, |[low, high]| format!("{} … {}", number(low, 4), number(high, 4)));
    let decimals = |value: f64, decimals| if value.is_finite() { fixed(value, decimals) } else { dash() };
    let mut cells = vec![number(parameter.initial, 4)];
    if parameter.status == FinalStatus::Fixed {
        cells.extend([dash(), bounds, dash(), dash(), dash()]);
    } else {
        cells.extend([
            number(parameter.prior_std, 3),
            bounds,
            decimals(parameter.observability, 4),
            number(parameter.std_error, 3),
            decimals(parameter.corrected_std_error / parameter.std_error, 2),
        ]);
    }
    format!("<tr>{}{}</tr>\n", first_cells(parameter, &unit), number_cells(&cells))
}

/// The cells of name and unit.
fn first_cells(parameter: &ParameterResult, unit: &DisplayUnit) -> String {
    format!("<th scope=\"row\">{}</th><td>{}</td>", escape(&parameter.name), escape(&unit.text))
}

/// Cells of numbers; their content is markup, escaped already.
pub(super) fn number_cells(cells: &[String]) -> String {
    cells.iter().map(|cell| format!("<td class=\"n\">{cell}</td>")).collect()
}

fn dash() -> String {
    "–".to_owned()
}

/// A standard error in per cent of the value.
fn percent(sigma: f64, value: f64) -> String {
    let percent = 100.0 * sigma / value.abs();
    match percent {
        p if !p.is_finite() => "–".to_owned(),
        p if p > 1000.0 => "&gt; 1000".to_owned(),
        p => significant(p, 3),
    }
}

/// A deviation from the truth in standard errors; emphasised beyond 2.
fn off_by(sigmas: f64) -> String {
    if !sigmas.is_finite() {
        return "–".to_owned();
    }
    let text = format!("{}{}", if sigmas > 0.0 { "+" } else { "" }, fixed(sigmas, 1));
    if sigmas.abs() > 2.0 { format!("<span class=\"far\">{text}</span>") } else { text }
}

/// The status of a parameter in words, such as `not excited`.
pub(super) fn status_words(status: FinalStatus) -> String {
    match status {
        FinalStatus::AtLimit => "at its limit".to_owned(),
        other => other.word().replace('_', " "),
    }
}

/// The fit of each output compared with the noise that was assumed.
pub(super) fn fit(estimation: &Estimation) -> String {
    let fits = output_fits(estimation);
    if fits.is_empty() {
        return String::new();
    }
    let mut out = table(&[
        ("", "Output"),
        ("", "Unit"),
        ("n", "Noise used<br>(1σ)"),
        ("n", "Rms error, one<br>step ahead"),
        ("n", "Rms of whitened<br>residual"),
        ("n", "Within ±2σ<br>(%)"),
        ("n", "Autocorrelation<br>at one sample"),
        ("n", "Samples"),
    ]);
    for fit in fits {
        let unit = display_unit(&fit.unit);
        let _ = write!(
            out,
            "<tr><th scope=\"row\">{}</th><td>{}</td>",
            escape(&signal_label(&fit.name)),
            escape(&unit.text)
        );
        let plain = |value: f64, decimals| if value.is_finite() { fixed(value, decimals) } else { "–".to_owned() };
        for text in [
            fit.noise.map_or_else(|| "–".to_owned(), |n| significant(n * unit.factor, 3)),
            significant(fit.rms_error * unit.factor, 3),
            plain(fit.residual_rms, 2),
            plain(100.0 * fit.within_two_sigma, 1),
            plain(fit.lag_one, 2),
            fit.samples.to_string(),
        ] {
            let _ = write!(out, "<td class=\"n\">{text}</td>");
        }
        out.push_str("</tr>\n");
    }
    out.push_str(END_OF_TABLE);
    out.push_str(
        "<p class=\"note\">With the right model and noise the whitened residual has an rms of 1, 95.4 % of it lies \
         within ±2σ, and its autocorrelation is near 0. An rms well above 1 means that the noise is larger than \
         assumed or the model is wrong; a large autocorrelation speaks for the model.</p>\n",
    );
    out
}

/// What was found about the quality of the record when it was read.
pub(super) fn quality(estimation: &Estimation) -> String {
    let quality = &estimation.quality;
    if *quality == QualityReport::default() {
        return String::new();
    }
    let mut out = format!("<p>{} rows read, {} kept", quality.rows_read, quality.rows_kept);
    if quality.sample_time_s > 0.0 {
        let _ = write!(out, "; median sample time {} s", trimmed(&significant(quality.sample_time_s, 4)));
    }
    out.push_str(".</p>\n");
    if quality.findings.is_empty() {
        out.push_str("<p>Nothing had to be mended or left out.</p>\n");
    } else {
        out.push_str(&findings(quality));
    }
    out.push_str(&channels(quality));
    out
}

/// The table of the findings.
fn findings(quality: &QualityReport) -> String {
    let mut out = table(&[("", "Severity"), ("", "Where"), ("", "Finding")]);
    for finding in &quality.findings {
        let (class, word) = match finding.severity {
            Severity::Note => ("", "note"),
            Severity::Warning => (" waiting", "warning"),
        };
        let place = if finding.place.is_empty() { "whole record" } else { &finding.place };
        let _ = writeln!(
            out,
            "<tr><td><span class=\"status{class}\">{word}</span></td><td>{}</td><td class=\"words\">{}</td></tr>",
            escape(place),
            prose(&finding.message)
        );
    }
    out.push_str(END_OF_TABLE);
    out
}

/// The column and the unit of each channel, so that a wrong one can be seen.
fn channels(quality: &QualityReport) -> String {
    if quality.channels.is_empty() {
        return String::new();
    }
    let mut out = String::from("<h3>Channels read</h3>\n");
    out.push_str(&table(&[
        ("", "Channel"),
        ("", "Column in the file"),
        ("", "Unit in the file"),
        ("n", "Multiplied by"),
        ("n", "Values missing"),
        ("n", "Lone spikes"),
    ]));
    for channel in &quality.channels {
        let assumed = if channel.unit_assumed { " (assumed)" } else { "" };
        let _ = writeln!(
            out,
            "<tr><th scope=\"row\">{}</th><td>{}</td><td>{}{assumed}</td>{}</tr>",
            escape(&signal_label(&channel.name)),
            escape(&channel.header),
            escape(if channel.unit == "-" { "–" } else { &channel.unit }),
            number_cells(&[
                trimmed(&significant(channel.scale, 6)).to_owned(),
                channel.missing.to_string(),
                channel.spikes.to_string()
            ])
        );
    }
    out.push_str(END_OF_TABLE);
    out
}

/// The events of the estimation.
pub(super) fn events(estimation: &Estimation) -> String {
    if estimation.events.is_empty() {
        return String::new();
    }
    let mut out = table(&[("n", "Time (s)"), ("", "Event"), ("", "In words")]);
    for event in estimation.events.iter().take(MOST_EVENTS) {
        let _ = writeln!(
            out,
            "<tr><td class=\"n\">{}</td><td>{}</td><td class=\"words\">{}</td></tr>",
            if event.time_s.is_finite() { fixed(event.time_s, 2) } else { "–".to_owned() },
            escape(event_kind(event.kind).0),
            prose(&event.message)
        );
    }
    out.push_str(END_OF_TABLE);
    if let Some(more) = estimation.events.len().checked_sub(MOST_EVENTS).filter(|more| *more > 0) {
        let _ = writeln!(out, "<p class=\"note\">{more} later events are not listed.</p>");
    }
    out
}

/// The table of estimator, model and settings.
pub(super) fn method(estimation: &Estimation, options: &HtmlOptions) -> String {
    let mut rows: Vec<(&str, &str)> = vec![("Method", estimation.method.name()), ("Model", &estimation.model)];
    rows.extend(options.settings.iter().map(|(name, value)| (name.as_str(), value.as_str())));
    rows.retain(|(_, value)| !value.is_empty());
    if rows.is_empty() {
        return String::new();
    }
    let mut out = table(&[("", "Setting"), ("", "Value")]).replace("<table>", "<table class=\"narrow\">");
    for (name, value) in rows {
        let _ = writeln!(out, "<tr><th scope=\"row\">{}</th><td>{}</td></tr>", escape(name), escape(value));
    }
    out.push_str(END_OF_TABLE);
    out
}
