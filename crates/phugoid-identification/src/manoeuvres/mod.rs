//! Manoeuvres in a flight: where a control surface was moved, whether the aircraft answered, and which derivatives can
//! be estimated from that.
//!
//! A surface's motion is measured against its own noise ([`crate::preparation::noise`]) and against what it does all
//! the time, so that the work of an autopilot or of a pilot in rough air is not taken for an input. Motions of surfaces
//! that are less than a settling time apart are one manoeuvre. Each is classified in words, asked whether the aircraft
//! was flying and answered, and put into regressions of the coefficients ([`Manoeuvre::coefficients`]), which say in
//! advance how well each derivative can be estimated and, if it cannot, why. Mass, inertia and size cancel in the ratio
//! of a derivative to its bound: no model of the aircraft is needed.
//!
//! ```
//! use phugoid_flight_data::csv::{self, CsvOptions};
//! use phugoid_identification::manoeuvres::{Settings, find};
//! let rows: String = (0..1000).map(|k| {
//!     let t = 0.02 * f64::from(k);
//!     let elevator = if (5.0..6.0).contains(&t) { 2.0 } else if (6.0..7.0).contains(&t) { -2.0 } else { 0.0 };
//!     format!("{t},{elevator},30\n")
//! }).collect();
//! let text = format!("time_s,elevator_deg,true_airspeed_m_s\n{rows}");
//! let record = csv::read(text.as_bytes(), "doublet.csv", &CsvOptions::default())?;
//! let found = find(&record, &Settings::default());
//! assert_eq!(found.manoeuvres.len(), 1);
//! assert_eq!(found.manoeuvres[0].inputs[0].kind.words(), "doublet");
//! // Nothing that could have answered was recorded.
//! assert!(!found.manoeuvres[0].useful);
//! # Ok::<(), csv::ReadError>(())
//! ```

mod activity;
mod answer;
mod equation;
mod feedback;
mod flying;
mod input;
mod record;
mod settings;
mod shape;
mod short_period;
mod stretches;
mod support;
mod unforced;

use phugoid_flight_data::record::Record;
use serde::{Deserialize, Serialize};

pub use answer::Response;
pub use equation::Inflation;
pub use input::SurfaceInput;
pub use settings::Settings;
pub use shape::Kind;
pub use short_period::ShortPeriod;
pub use support::{CoefficientSupport, Support};
pub use unforced::Unforced;

use crate::core::axes::{Axes, Group};
use record::Signals;

/// The result of [`find`]: manoeuvres, motion without input, and what stands in the way of finding more.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Found {
    /// Manoeuvres in the order of time; useful or not.
    pub manoeuvres: Vec<Manoeuvre>,
    /// Where the aircraft moved and no surface did: turbulence, or a free response.
    pub unforced: Vec<Unforced>,
    /// Why no manoeuvre was found or nothing can be estimated, and which channels are missing, one sentence each.
    pub reasons: Vec<String>,
}

/// One manoeuvre: one or several inputs, the answer of the aircraft, and what can be estimated from both.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Manoeuvre {
    /// Number of the manoeuvre, from 1; the program takes it as `phugoid estimate --segment`.
    pub number: usize,
    /// First time of the segment, s: the quiet lead before the first input, as far as there is one.
    pub from_s: f64,
    /// Last time of the segment, s, with the time to settle.
    pub to_s: f64,
    /// Quiet time before the first input, s, at most [`Settings::lead_s`].
    pub lead_s: f64,
    /// What each surface did, in the order in which they began.
    pub inputs: Vec<SurfaceInput>,
    /// How the aircraft answered, by channel.
    pub responses: Vec<Response>,
    /// The short period as the segment shows it, if it does.
    pub short_period: Option<ShortPeriod>,
    /// True if the aircraft was flying and answered, and at least one derivative can be estimated.
    pub useful: bool,
    /// Why the manoeuvre is not useful, and what limits it, one sentence each.
    pub remarks: Vec<String>,
    /// How well each derivative of the moved axes can be estimated from this segment.
    pub coefficients: Vec<CoefficientSupport>,
}

impl Manoeuvre {
    /// The inputs in words: `elevator 3-2-1-1`, `rudder doublet, aileron pulse`.
    pub fn words(&self) -> String {
        let each: Vec<String> = self.inputs.iter().map(|i| format!("{} {}", i.surface, i.kind.words())).collect();
        each.join(", ")
    }

    /// True if a surface of this group of axes was moved.
    pub fn moves(&self, group: Group) -> bool {
        self.inputs.iter().any(|input| Group::of_surface(&input.surface) == group)
    }
}

/// Looks for manoeuvres in a record. It never fails: what stands in the way is in [`Found::reasons`]. NaN values count
/// as missing.
pub fn find(record: &Record, settings: &Settings) -> Found {
    let signals = Signals::of(record);
    let mut reasons = signals.missing();
    let mut inputs: Vec<SurfaceInput> =
        Axes::SURFACES.iter().flat_map(|surface| activity::inputs(&signals, surface, settings)).collect();
    inputs.sort_by(|a, b| a.onset_s.total_cmp(&b.onset_s));
    let inputs = without_corrections(&signals, together(inputs, settings.settling_s), settings);
    let groups = together(inputs, settings.settling_s);
    let ends: Vec<(f64, f64)> = groups.iter().map(|inputs| span(inputs)).collect();
    let (first, last) = (record.time.first().copied().unwrap_or(0.0), record.time.last().copied().unwrap_or(0.0));
    let mut manoeuvres = Vec::with_capacity(groups.len());
    for (index, inputs) in groups.into_iter().enumerate() {
        let (onset, end) = ends[index];
        let before = index.checked_sub(1).and_then(|i| ends.get(i)).map_or(first, |e| e.1);
        let after = ends.get(index + 1).map_or(last, |e| e.0);
        let lead_s = (onset - before.max(first)).clamp(0.0, settings.lead_s);
        let (from_s, to_s) = (onset - lead_s, (end + settings.settling_s).min(after).min(last));
        let number = index + 1;
        manoeuvres.push(judge(&signals, settings, inputs, Segment { number, from_s, to_s, lead_s }));
    }
    let unforced = unforced::unforced(&signals, &ends, settings);
    if manoeuvres.is_empty() && signals.has_surface() {
        reasons.push("no surface moved visibly above its own noise".to_owned());
    }
    Found { manoeuvres, unforced, reasons }
}

#[derive(Clone, Copy)]
struct Segment {
    number: usize,
    from_s: f64,
    to_s: f64,
    lead_s: f64,
}

fn judge(signals: &Signals<'_>, settings: &Settings, inputs: Vec<SurfaceInput>, segment: Segment) -> Manoeuvre {
    let Segment { number, from_s, to_s, lead_s } = segment;
    let groups: Vec<Group> = [Group::Longitudinal, Group::Lateral]
        .into_iter()
        .filter(|group| inputs.iter().any(|i| Group::of_surface(&i.surface) == *group))
        .collect();
    let onset = inputs.first().map_or(from_s, |i| i.onset_s);
    let responses: Vec<Response> =
        groups.iter().flat_map(|group| answer::responses(signals, *group, onset, to_s)).collect();
    let mut remarks = Vec::new();
    let flying = flying::check(signals, from_s, to_s, settings.slowest_m_s);
    let mut useful = true;
    if let Err(reason) = &flying {
        remarks.push(reason.clone());
        useful = false;
    }
    let loudest = responses.iter().map(|r| r.signal_to_noise).fold(0.0, f64::max);
    if responses.is_empty() {
        remarks.push("no rate and no angle that could show an answer was recorded".to_owned());
        useful = false;
    } else if loudest < settings.signal_to_noise {
        remarks.push(format!(
            "the aircraft hardly answered: its largest motion is {loudest:.1} times the noise, wanted {}",
            settings.signal_to_noise
        ));
        useful = false;
    }
    if lead_s < 0.5 * settings.lead_s {
        remarks.push(format!("only {lead_s:.1} s quiet before it: the reference point is uncertain"));
    }
    let mut coefficients = Vec::new();
    let mut short = None;
    if flying.is_ok() {
        let window = signals.window(from_s, to_s);
        if window.shortened {
            remarks.push(format!("what it can tell is judged by its first {:.0} s", record::LONGEST_S));
        }
        for group in &groups {
            let judged = support::support(&window, *group);
            if *group == Group::Longitudinal {
                short = short_period::of(&judged);
            }
            coefficients.extend(judged.into_iter().map(|t| t.coefficient));
        }
        if useful && !coefficients.iter().any(|c| matches!(c.support, Support::Told | Support::Roughly)) {
            let why = coefficients.first().map_or_else(String::new, |c| format!(": {}", c.reason));
            remarks.push(format!("no derivative can be estimated from it{why}"));
            useful = false;
        }
    }
    if let Some(short) = &short {
        remarks.extend(inputs.iter().filter(|i| i.surface == "elevator").filter_map(|i| short.remark(i)));
    }
    Manoeuvre { number, from_s, to_s, lead_s, inputs, responses, short_period: short, useful, remarks, coefficients }
}

/// Leaves out small corrections by the pilot: a surface that moved together with another one, but whose effect does not
/// show in the moment that it makes. It belongs to the motion, but nothing can be estimated from it.
fn without_corrections(
    signals: &Signals<'_>,
    groups: Vec<Vec<SurfaceInput>>,
    settings: &Settings,
) -> Vec<SurfaceInput> {
    let mut kept = Vec::new();
    for group in groups {
        let shows = |input: &SurfaceInput| {
            let window = signals.window(input.onset_s - settings.lead_s, input.end_s + settings.settling_s);
            support::answers(&window, &input.surface)
        };
        let shown: Vec<bool> =
            if group.len() > 1 { group.iter().map(shows).collect() } else { vec![true; group.len()] };
        let any = shown.contains(&true);
        kept.extend(group.into_iter().zip(shown).filter(|(_, shown)| *shown || !any).map(|(input, _)| input));
    }
    kept
}

/// Inputs that overlap or are less than a settling time apart.
fn together(inputs: Vec<SurfaceInput>, settling_s: f64) -> Vec<Vec<SurfaceInput>> {
    let mut groups: Vec<Vec<SurfaceInput>> = Vec::new();
    for input in inputs {
        match groups.last_mut() {
            Some(group) if input.onset_s - span(group).1 < settling_s => group.push(input),
            _ => groups.push(vec![input]),
        }
    }
    groups
}

fn span(inputs: &[SurfaceInput]) -> (f64, f64) {
    inputs.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), i| (low.min(i.onset_s), high.max(i.end_s)))
}
