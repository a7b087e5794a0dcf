//! `phugoid simulate`.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::io::{self, Write as _};
use std::path::{Path, PathBuf};

use phugoid::simulate_with_progress;
use phugoid_flight_data::channels::by_name;
use phugoid_flight_data::csv;
use phugoid_flight_data::record::{Channel, Quantity};
use phugoid_flight_dynamics::trim::Trim;
use phugoid_identification::estimation::Signal;
use phugoid_report::{Figure, TimeHistoryPanel, time_histories, write_named_figures};
use phugoid_simulation::flight::{Flight, FlightError};
use phugoid_simulation::manoeuvre::Manoeuvre;
use phugoid_simulation::named::scenario_text;
use phugoid_simulation::scenario::{BUILT_IN, Scenario};
use serde::Serialize;

use crate::arguments;
use crate::destination;
use crate::failure::Failure;
use crate::output::{Table, json, notes_text, print, significant};
use crate::progress::Progress;

#[derive(Serialize)]
struct Document<'a> {
    scenario: &'a str,
    seed: u64,
    samples: usize,
    sample_time_s: f64,
    duration_s: f64,
    trim: &'a Trim,
    true_parameters: &'a BTreeMap<String, f64>,
    measured_channels: Vec<&'a str>,
    measured_csv: &'a Path,
    truth_csv: &'a Path,
    figures: Vec<PathBuf>,
    warnings: Vec<String>,
    /// What is left out of the file of the aircraft and what is assumed, and what its flight control found when it took over; empty for
    /// a built-in one.
    notes: Vec<String>,
}

pub(crate) fn run(arguments: &arguments::Simulate) -> Result<(), Failure> {
    let Some(wanted) = arguments.scenario.as_deref().filter(|_| !arguments.list) else {
        return list(arguments.json);
    };
    if arguments.show {
        return print(&text_of(wanted)?);
    }
    let mut scenario = scenario(wanted)?;
    for manoeuvre in &scenario.manoeuvre {
        if let Manoeuvre::Csv { file, .. } = manoeuvre {
            destination::check_further_input(&scenario.folder.join(file), &arguments.out, &destination::FLIGHT)?;
        }
    }
    scenario.seed = arguments.seed.unwrap_or(scenario.seed);
    let flight = {
        let progress = Progress::new("flying");
        simulate_with_progress(&scenario, &|done| progress.set(done))?
    };
    let writing = Progress::spinner("writing");

    std::fs::create_dir_all(&arguments.out).map_err(|e| Failure::writing(&arguments.out, e))?;
    let (measured, truth) = (arguments.out.join("measured.csv"), arguments.out.join("truth.csv"));
    for (record, path) in [(&flight.measured, &measured), (&flight.truth, &truth)] {
        csv::write_path(record, path).map_err(|e| Failure::writing(path, e))?;
    }
    let figures = match &arguments.figures {
        Some(folder) => write_named_figures(folder, &figures(&scenario, &flight))
            .map_err(|e| Failure::writing_of("--figures", folder, e))?,
        None => Vec::new(),
    };
    drop(writing);
    let mut notes = scenario.notes().map_err(Failure::input)?;
    if !flight.control_notes.is_empty() {
        // Those of the aircraft were said when it was opened.
        let _ = write!(io::stderr(), "{}", notes_text(&flight.control_notes));
        notes.extend(flight.control_notes.iter().cloned());
    }
    let document = Document {
        scenario: &scenario.name,
        seed: scenario.seed,
        samples: flight.measured.time.len(),
        sample_time_s: 1.0 / scenario.sample_rate.si(),
        duration_s: scenario.duration.si(),
        trim: &flight.trim,
        true_parameters: &flight.true_parameters,
        measured_channels: flight.measured.channels.iter().map(|c| c.name.as_str()).collect(),
        measured_csv: &measured,
        truth_csv: &truth,
        figures,
        warnings: warnings(&scenario, &flight)?,
        notes,
    };
    if arguments.json { print(&json(&document)?) } else { print(&text(&document, &flight)) }
}

/// Reads a scenario file, or takes the built-in scenario of this name. What is assumed of an aircraft from a file is said on
/// standard error, whatever is then done with it.
pub(crate) fn scenario(wanted: &str) -> Result<Scenario, Failure> {
    let scenario = Scenario::find(wanted).map_err(Failure::input)?;
    let notes = scenario.notes().map_err(Failure::input)?;
    // Nobody is left to tell when standard error is closed.
    let _ = write!(io::stderr(), "{}", notes_text(&notes));
    Ok(scenario)
}

/// The failure for a flight that cannot be simulated: an input error if the scenario is wrong, else a task without an
/// answer.
pub(crate) fn failure(error: FlightError) -> Failure {
    match error {
        FlightError::Scenario(_) => Failure::input(error),
        _ => Failure::impossible(error),
    }
}

pub(crate) fn text_of(wanted: &str) -> Result<String, Failure> {
    scenario_text(wanted).map_err(Failure::input)
}

#[derive(Serialize)]
struct Listed {
    name: &'static str,
    description: String,
}

fn list(as_json: bool) -> Result<(), Failure> {
    let mut listed = Vec::new();
    for (name, text) in BUILT_IN {
        let description = Scenario::parse(text, name).map_err(Failure::input)?.name;
        listed.push(Listed { name, description });
    }
    if as_json {
        return print(&json(&listed)?);
    }
    let width = listed.iter().map(|l| l.name.len()).max().unwrap_or(0);
    print(&listed.iter().map(|l| format!("{:width$}  {}\n", l.name, l.description)).collect::<String>())
}

fn text(document: &Document, flight: &Flight) -> String {
    let mut text = format!(
        "{}\n{} samples, {} s at {} Hz, seed {}\n\n",
        document.scenario,
        document.samples,
        significant(document.duration_s, 4),
        significant(1.0 / document.sample_time_s, 4),
        document.seed
    );
    let _ = writeln!(
        text,
        "Trim: alpha {:.4} deg, elevator {:.4} deg, thrust {:.1} N\n",
        document.trim.alpha_rad.to_degrees(),
        document.trim.elevator_rad.to_degrees(),
        document.trim.thrust_n
    );
    let mut table = Table::new(&["channel", "unit", "smallest", "largest", "missing"]);
    for channel in &flight.measured.channels {
        let (unit, scale) = human(channel.quantity);
        let finite = || channel.values.iter().copied().filter(|v| v.is_finite());
        table.row([
            channel.name.clone(),
            unit.to_owned(),
            significant(scale * finite().fold(f64::INFINITY, f64::min), 5),
            significant(scale * finite().fold(f64::NEG_INFINITY, f64::max), 5),
            (channel.values.len() - finite().count()).to_string(),
        ]);
    }
    text.push_str(&table.render());
    for warning in &document.warnings {
        let _ = writeln!(text, "\nWarning: {warning}");
    }
    let _ = writeln!(text, "\nMeasured: {}", document.measured_csv.display());
    let _ = writeln!(text, "Truth:    {}", document.truth_csv.display());
    if let Some(folder) = document.figures.first().and_then(|f| f.parent()) {
        let _ = writeln!(text, "Figures:  {}", folder.display());
    }
    text
}

/// What of a flight a person has to know: manoeuvres that were not flown, and where the data end.
fn warnings(scenario: &Scenario, flight: &Flight) -> Result<Vec<String>, Failure> {
    let mut warnings = scenario.manoeuvres_without_effect().map_err(Failure::input)?;
    warnings.extend(beyond_the_tables(flight));
    Ok(warnings)
}

/// Warnings for a flight that leaves the range of the aerodynamic tables, where they are extrapolated linearly and no
/// longer describe the aircraft, or that of the engine, or that has no fuel left.
fn beyond_the_tables(flight: &Flight) -> Vec<String> {
    let (truth, range) = (&flight.truth, &flight.data_range);
    let aerodynamic = ("the aerodynamic tables", "extrapolation");
    let of_engine = ("the tables of the engine", "as at their end");
    let ranges = [
        ("alpha", " deg", range.alpha, aerodynamic),
        ("beta", " deg", range.beta, aerodynamic),
        ("elevator", " deg", range.elevator, aerodynamic),
        ("aileron", " deg", range.aileron, aerodynamic),
        ("rudder", " deg", range.rudder, aerodynamic),
        ("true_airspeed", " m/s", range.speed, of_engine),
        ("mach", "", range.mach, of_engine),
        ("altitude", " m", range.altitude, of_engine),
    ];
    let first = |(name, unit, limits, (tables, then)): (&str, &str, [f64; 2], (&str, &str))| {
        let is_angle = unit == " deg";
        let shown = |value: f64| if is_angle { value.to_degrees() } else { value };
        // Limits are stated in degrees: what the conversion there and back adds is taken off again.
        let [low, high] = if is_angle { limits.map(|limit| (shown(limit) * 1e6).round() / 1e6) } else { limits };
        let slack = if is_angle { 1e-6 } else { 0.0 };
        let inside = |value: f64| (low - slack..=high + slack).contains(&shown(value));
        let values = &truth.channel(name)?.values;
        let k = values.iter().position(|value| value.is_finite() && !inside(*value))?;
        let time = truth.time.get(k)?;
        Some(format!("{name} leaves {tables} ({low} to {high}{unit}) at {time:.2} s; what follows is {then}"))
    };
    let mut warnings: Vec<String> = ranges.into_iter().filter_map(first).collect();
    if let Some(time) = flight.out_of_fuel_s {
        warnings.push(format!("the fuel is burnt at {time:.2} s; from then on there is no thrust"));
    }
    warnings
}

/// Unit in which a quantity is shown, and the factor from SI: degrees for angles, SI units for everything else.
fn human(quantity: Quantity) -> (&'static str, f64) {
    let degrees = 1.0_f64.to_degrees();
    match quantity {
        Quantity::Angle => ("deg", degrees),
        Quantity::AngularRate => ("deg/s", degrees),
        Quantity::AngularAcceleration => ("deg/s2", degrees),
        other => (other.si_unit(), 1.0),
    }
}

/// Channels that are drawn in the figure of the inputs. Lateral channels have a separate figure; all others are the
/// motion.
const INPUTS: &[&str] = &["elevator", "aileron", "rudder", "throttle", "thrust", "mass"];
const LATERAL: &[&str] = &["beta", "phi", "psi", "p", "r", "ay"];

/// Figures of the measured and true histories, with one panel for each channel that changes.
fn figures(scenario: &Scenario, flight: &Flight) -> Vec<(String, Figure)> {
    let signal = |name: &str, channel: &Channel| Signal {
        name: name.to_owned(),
        unit: channel.quantity.si_unit().to_owned(),
        values: channel.values.clone(),
    };
    let panel = |channel: &Channel| TimeHistoryPanel {
        label: by_name(&channel.name).map_or_else(|| channel.name.clone(), |known| known.description.to_owned()),
        unit: channel.quantity.si_unit().to_owned(),
        signals: std::iter::once(signal("measured", channel))
            .chain(flight.truth.channel(&channel.name).map(|truth| signal("true", truth)))
            .collect(),
    };
    let figure = |name: &str, title: &str, wanted: &dyn Fn(&str) -> bool| {
        let panels: Vec<TimeHistoryPanel> =
            flight.measured.channels.iter().filter(|c| wanted(&c.name) && moves(c)).map(panel).collect();
        let title = format!("{}: {title}", scenario.name);
        let caption = format!("Seed {}. What the sensors measured and what was true.", scenario.seed);
        let figure = time_histories(&title, &caption, &flight.measured.time, &panels);
        (!panels.is_empty()).then(|| (name.to_owned(), figure))
    };
    let input = |name: &str| INPUTS.contains(&name);
    let lateral = |name: &str| LATERAL.contains(&name);
    [
        figure("inputs", "inputs", &input),
        figure("longitudinal", "longitudinal motion", &|name| !input(name) && !lateral(name)),
        figure("lateral", "lateral motion", &lateral),
    ]
    .into_iter()
    .flatten()
    .collect()
}

/// Whether the values of a channel change at all.
fn moves(channel: &Channel) -> bool {
    let mut values = channel.values.iter().filter(|v| v.is_finite());
    values.next().is_some_and(|first| values.any(|v| v != first))
}
