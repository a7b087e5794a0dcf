//! Drawing of the terminal view.

use std::time::Instant;

use ratatui::Frame;
use ratatui::layout::{Constraint, Layout, Rect};
use ratatui::style::{Color, Modifier, Style};
use ratatui::text::{Line, Span};
use ratatui::widgets::{Cell, Paragraph, Row, Table, Wrap};

use super::number::{count, display_unit, with_bound};
use super::state::{Parameter, State};

const KEYS: &str = "q leave   space pause   up/down scroll";

/// Draws the state as it is at the time `now`.
pub(super) fn draw(frame: &mut Frame, state: &State, now: Instant) {
    // While the view is paused, the state at the pause is shown and the head line says so.
    let shown = state.paused.as_deref().unwrap_or(state);
    let area = frame.area();
    // The table gets the room first. One line is left for events, and the table scrolls if it does not fit.
    let room = area.height.saturating_sub(6);
    let rows = (shown.layout.parameters.len() as u16).saturating_add(1).min(room.saturating_sub(1));
    let [head, message, table, link, events, keys] = Layout::vertical([
        Constraint::Length(1),
        Constraint::Length(1),
        Constraint::Length(rows),
        Constraint::Length(3),
        Constraint::Fill(1),
        Constraint::Length(1),
    ])
    .areas(area);
    header(frame, head, state, shown, now);
    frame.render_widget(Paragraph::new(notice(state, now)).style(Style::new().add_modifier(Modifier::BOLD)), message);
    parameters(frame, table, shown, state.first_row);
    frame.render_widget(Paragraph::new(link_lines(shown)), link);
    event_list(frame, events, shown);
    frame.render_widget(Paragraph::new(KEYS).style(Style::new().fg(Color::DarkGray)), keys);
}

fn header(frame: &mut Frame, area: Rect, state: &State, shown: &State, now: Instant) {
    let time = shown.estimate.as_ref().map_or_else(String::new, |e| format!(" {:.1} s", e.time_s));
    let (status, colour) = if state.end.is_some() {
        (format!("■ ended{time}"), Color::Reset)
    } else if state.paused.is_some() {
        (format!("‖ paused{time}"), Color::Blue)
    } else if state.stale(now).is_some() {
        (format!("△ old data{time}"), Color::Yellow)
    } else if state.estimate.is_some() {
        (format!("● live{time}"), Color::Green)
    } else {
        ("◌ waiting".to_owned(), Color::Blue)
    };
    let layout = &shown.layout;
    let who = match (shown.source.as_str(), layout.model.as_str()) {
        ("", _) => "Phugoid".to_owned(),
        (source, model) => format!("Phugoid  {source}, model {model}, method {}", layout.method),
    };
    let width = status.chars().count() as u16;
    let [left, right] = Layout::horizontal([Constraint::Min(0), Constraint::Length(width)]).spacing(1).areas(area);
    frame.render_widget(Paragraph::new(who).style(Style::new().add_modifier(Modifier::BOLD)), left);
    frame.render_widget(Paragraph::new(status).style(Style::new().fg(colour).add_modifier(Modifier::BOLD)), right);
}

/// The one sentence that is most important now; empty if all is well.
fn notice(state: &State, now: Instant) -> String {
    if let Some(error) = &state.unreadable {
        return format!("A document was not understood: {error}");
    }
    if let Some(reason) = &state.end {
        return format!("The stream has ended: {reason}. q leaves.");
    }
    if let Some(age) = state.stale(now) {
        return format!("No estimate for {age:.0} s.");
    }
    match (&state.estimate, &state.link) {
        (Some(estimate), _) if estimate.change == "in_doubt" => {
            "A change of the aircraft is suspected: bounds are widened until it is decided.".to_owned()
        }
        (Some(_), _) => String::new(),
        (None, Some(link)) => match &link.waiting {
            Some(waiting) => format!("Preparing the estimation: {waiting}."),
            None => format!("Waiting for measurements; {} messages so far.", count(link.received)),
        },
        (None, None) => "Waiting for measurements.".to_owned(),
    }
}

fn parameters(frame: &mut Frame, area: Rect, state: &State, first: usize) {
    let Some(estimate) = &state.estimate else { return };
    let layouts = &state.layout.parameters;
    let name = layouts.iter().map(|p| p.name.chars().count()).max().unwrap_or(0).max(9) as u16;
    let widths = [
        Constraint::Length(name),
        Constraint::Length(11),
        Constraint::Length(10),
        Constraint::Length(9),
        Constraint::Length(24),
        Constraint::Fill(1),
    ];
    let fixed: u16 = name + 11 + 10 + 9 + 24 + 5;
    let room = usize::from(area.width.saturating_sub(fixed));
    let rows =
        layouts.iter().zip(&estimate.parameters).zip(&state.sparklines).skip(first).map(|((layout, p), sparkline)| {
            let (factor, unit) = display_unit(&layout.unit);
            let value = p.value.unwrap_or(f64::NAN) * factor;
            let bound = 2.0 * p.std_error.unwrap_or(f64::NAN) * factor;
            let (value, bound) = with_bound(value, bound);
            let (words, style) = verdict(p);
            Row::new([
                Cell::from(Span::styled(layout.name.clone(), Style::new().add_modifier(Modifier::BOLD))),
                Cell::from(Line::from(value).right_aligned()),
                Cell::from(Line::from(format!("± {bound}")).right_aligned()),
                Cell::from(unit.to_owned()),
                Cell::from(Span::styled(words, style)),
                Cell::from(Span::styled(sparkline.line(room), Style::new().fg(Color::Blue))),
            ])
        });
    let header = [
        Line::from("parameter"),
        Line::from("estimate").right_aligned(),
        Line::from("2 sigma").right_aligned(),
        Line::from("unit"),
        Line::from("verdict"),
        Line::from("course"),
    ];
    let header = Row::new(header).style(Style::new().fg(Color::DarkGray));
    frame.render_widget(Table::new(rows, widths).header(header).column_spacing(1), area);
}

/// The verdict as symbol and words, and a colour with the same meaning.
fn verdict(parameter: &Parameter) -> (String, Style) {
    let needs_other = parameter.readiness.as_ref().is_some_and(|r| r.verdict == "not_identifiable");
    let doubtful = parameter.readiness.as_ref().is_some_and(|r| r.verdict == "doubtful");
    let (symbol, words, colour) = match parameter.status.as_str() {
        "at_limit" => ("⊣", "at the limit", Color::Magenta),
        _ if doubtful => ("?", "doubtful", Color::Red),
        "not_excited" => ("○", "not excited", Color::DarkGray),
        _ if needs_other => ("⊘", "needs another input", Color::DarkGray),
        "converged" => ("✓", "converged", Color::Green),
        "improving" => ("↗", "improving", Color::Blue),
        other => ("·", other, Color::Reset),
    };
    (format!("{symbol} {words}"), Style::new().fg(colour))
}

fn link_lines(state: &State) -> Vec<Line<'static>> {
    let Some(link) = &state.link else { return vec![Line::default(), Line::from("link  no report yet")] };
    let latency = match (link.latency_ms.p50, link.latency_ms.p99_9) {
        (Some(half), Some(most)) => format!("latency {half:.2} ms, 99.9 % below {most:.2} ms"),
        _ => "no estimate yet".to_owned(),
    };
    let recorded = match link.recorded_bytes {
        0 => String::new(),
        bytes => format!("; recorded {:.1} MB", bytes as f64 / 1e6),
    };
    let counts = [
        ("received", link.received),
        ("lost", link.lost),
        ("late", link.late),
        ("twice", link.duplicated),
        ("out of order", link.reordered),
        ("restarts", link.restarts),
    ];
    let counts = counts.map(|(name, number)| format!("{name} {}", count(number))).join(", ");
    vec![Line::default(), Line::from(format!("link  {counts}")), Line::from(format!("      {latency}{recorded}"))]
}

fn event_list(frame: &mut Frame, area: Rect, state: &State) {
    let lines: Vec<Line> = state
        .events
        .iter()
        .map(|event| {
            let time = event.time_s.map_or_else(|| "    link".to_owned(), |t| format!("{t:8.2} s"));
            Line::from(format!("{time}  {}: {}", event.kind.name().replace('_', " "), event.message))
        })
        .collect();
    let lines = if lines.is_empty() { vec![Line::from("no events yet")] } else { lines };
    frame.render_widget(Paragraph::new(lines).wrap(Wrap { trim: false }), area);
}

#[cfg(test)]
mod tests;
