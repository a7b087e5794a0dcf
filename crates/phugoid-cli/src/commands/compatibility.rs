//! `phugoid compatibility`.

use phugoid_flight_data::output_file;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use phugoid::compatibility;
use phugoid_evaluation::chart::{Axis, Chart, Content, Curve, Meaning, Panel, Shape};
use phugoid_evaluation::table::{Cell, Column, Table};
use phugoid_flight_data::csv;
use phugoid_flight_data::reader::{ReadOptions, read_path};
use phugoid_flight_data::record::Record;
use phugoid_identification::compatibility::{
    Compatibility, CompatibilityOptions, Corrections, Group, InputSkew, Reconstructed, SensorVerdict, input_skew,
};
use phugoid_report::{StudyPage, StudySection, chart_figure, study_html, write_named_figures};
use serde::Serialize;

use super::deleting::Deletions;
use super::further;
use crate::arguments::{self, Further};
use crate::failure::Failure;
use crate::output::{self, json, print, significant};
use crate::progress::Progress;

#[derive(Serialize)]
struct Document<'a> {
    #[serde(flatten)]
    result: &'a Compatibility,
    elevator_skew: Option<&'a InputSkew>,
    corrections_json: PathBuf,
    corrected_csv: PathBuf,
    report: PathBuf,
    figures: Vec<PathBuf>,
}

pub(crate) fn run(arguments: &arguments::Compatibility) -> Result<(), Failure> {
    let model = arguments.model.as_deref().map(super::estimate::model).transpose()?;
    let options = arguments.reading.options(&arguments.flight)?;
    let with: Vec<Further> = arguments.with.iter().map(|word| Further::of(word)).collect();
    let paths: Vec<&Path> =
        std::iter::once(&arguments.flight).chain(with.iter().map(|w| &w.file)).map(PathBuf::as_path).collect();
    let deletions = Deletions::new(&arguments.deleting, &paths)?;
    let open = |flight: &Path, options: &ReadOptions| match &model {
        Some(model) => model.open_record_with(flight, options).map_err(Box::new),
        None => read_path(flight, options).map_err(Box::new),
    };
    let (record, further) = {
        let _progress = Progress::spinner("reading");
        let mut record = open(&arguments.flight, &options).map_err(Failure::input)?;
        deletions.apply(&mut record, &arguments.flight, true)?;
        let further = with.iter().map(|other| {
            let mut record = further::read("--with", other, &options, open)?;
            deletions.apply(&mut record, &other.file, false)?;
            Ok::<_, Failure>(record)
        });
        (record, further.collect::<Result<Vec<_>, _>>()?)
    };
    let mut groups = CompatibilityOptions::default().groups;
    groups.extend(arguments.estimate.iter().map(|name| match name {
        arguments::SensorGroup::InertialScales => Group::InertialScales,
        arguments::SensorGroup::VanePositions => Group::VanePositions,
        arguments::SensorGroup::AccelerometerPosition => Group::AccelerometerPosition,
        arguments::SensorGroup::Upwash => Group::Upwash,
    }));
    if ["north", "east", "psi", "altitude"].iter().all(|name| record.channel(name).is_some()) {
        groups.push(Group::Wind);
    }
    // The value that a model file has without saying so is none for the place of this flight.
    let standard = 9.80665;
    let options = CompatibilityOptions {
        groups,
        unknowns: (!arguments.unknowns.is_empty()).then(|| arguments.unknowns.clone()),
        without: arguments.without.clone(),
        held: arguments.hold.clone(),
        vanes_x: [arguments.alpha_vane.map_or(0.0, |x| x.si()), arguments.beta_vane.map_or(0.0, |x| x.si())],
        gravity: model.as_ref().map(|m| m.aircraft.gravity).filter(|g| *g != standard),
        flat_earth: arguments.flat_earth,
        further,
    };
    let progress = Progress::spinner("reconstructing");
    let mut result = compatibility(&record, &options)?;
    drop(progress);
    let skew = match (&model, arguments.elevator_skew) {
        (Some(model), true) => {
            let _progress = Progress::spinner("finding the delay of the elevator");
            Some(input_skew(&result.corrections.apply(&record), model, "elevator").map_err(Failure::input)?)
        }
        _ => None,
    };
    if let Some(skew) = skew.as_ref().filter(|s| s.delay_s.abs() > 2.0 * s.std_error_s) {
        result.corrections.add_skew(skew);
    }
    let mut corrected = result.corrections.apply(&record);
    if record.channel("alpha").is_none()
        && let Some(alpha) = result.channel("alpha")
    {
        corrected.channels.push(phugoid_flight_data::record::Channel {
            name: "alpha".to_owned(),
            quantity: phugoid_flight_data::record::Quantity::Angle,
            values: alpha.values.clone(),
        });
    }
    let out = &arguments.out;
    std::fs::create_dir_all(out).map_err(|e| Failure::writing(out, e))?;
    let corrected_csv = out.join("corrected.csv");
    csv::write_path(&corrected, &corrected_csv).map_err(|e| Failure::writing(&corrected_csv, e))?;
    let corrections_json = out.join("corrections.json");
    output_file::write(&corrections_json, json(&result.corrections)?)
        .map_err(|e| Failure::writing(&corrections_json, e))?;
    let charts = charts(&record, &result);
    let report = out.join("compatibility.html");
    let page = page(arguments, &result, skew.as_ref(), charts.clone());
    output_file::write(&report, study_html(&page)).map_err(|e| Failure::writing(&report, e))?;
    let figures = match &arguments.figures {
        Some(folder) => {
            let named: Vec<_> = charts.iter().map(|chart| (chart.name.clone(), chart_figure(chart))).collect();
            write_named_figures(folder, &named).map_err(|e| Failure::writing_of("--figures", folder, e))?
        }
        None => Vec::new(),
    };
    let document =
        Document { result: &result, elevator_skew: skew.as_ref(), corrections_json, corrected_csv, report, figures };
    if arguments.json { print(&json(&document)?) } else { print(&text(&document)) }
}

/// Reads the corrections that `phugoid compatibility` has written: an input error if the file cannot be read or is
/// wrong.
pub(crate) fn corrections(file: &std::path::Path) -> Result<Corrections, Failure> {
    let text = std::fs::read_to_string(file)
        .map_err(|e| Failure::input(format!("cannot read the corrections `{}`: {e}", file.display())))?;
    serde_json::from_str(&text).map_err(|e| {
        Failure::input(format!(
            "{}: {e}\nIt has to be a file of corrections as `phugoid compatibility` writes it.",
            file.display()
        ))
    })
}

/// Unit and factor for the output: angles are shown in degrees, everything else in SI units.
fn readable(unit: &str) -> (String, f64) {
    match unit.strip_prefix("rad") {
        Some(rest) => (format!("deg{rest}"), 1_f64.to_degrees()),
        None => (unit.to_owned(), 1.0),
    }
}

fn table(result: &Compatibility) -> Table {
    let rows = result.errors.iter().map(|e| {
        let (unit, scale) = readable(&e.unit);
        vec![
            Cell::from(e.name.as_str()),
            Cell::from(scale * e.value),
            Cell::from(scale * e.std_error),
            Cell::from(unit),
            Cell::from(100.0 * e.std_error / e.prior_std),
            Cell::from(if e.verdict == SensorVerdict::NotIdentifiable { f64::NAN } else { e.significance }),
            Cell::from(e.held_out_gain),
            Cell::from(if e.offered { "significant, corrected" } else { e.verdict.words() }),
        ]
    });
    Table {
        title: "Errors of the sensors".to_owned(),
        columns: vec![
            Column::new("Parameter", ""),
            Column::new("Value", ""),
            Column::new("Sigma", ""),
            Column::new("Unit", ""),
            Column::new("Sigma/prior", "%"),
            Column::new("Significance", ""),
            Column::new("Held-out gain", "nats"),
            Column::new("Verdict", ""),
        ],
        rows: rows.collect(),
    }
}

fn text(document: &Document) -> String {
    let result = document.result;
    let table = table(result);
    let names: Vec<String> = table
        .columns
        .iter()
        .map(
            |c| if c.unit.is_empty() { c.name.to_lowercase() } else { format!("{} {}", c.name.to_lowercase(), c.unit) },
        )
        .collect();
    let mut out = output::Table::with_words(&names.iter().map(String::as_str).collect::<Vec<_>>(), &[0, 3, 7]);
    for row in &table.rows {
        out.row(row.iter().map(|cell| match cell {
            Cell::Number(value) => significant(*value, 3),
            Cell::Text(words) => words.clone(),
        }));
    }
    let mut text = format!("{}\n\n{}", result.source, out.render());
    if let Some(skew) = document.elevator_skew {
        let _ = writeln!(text, "\n{}", skew_words(skew));
    }
    super::result::paragraph(&mut text, "Held, and corrected", held(result));
    super::result::paragraph(&mut text, "Not corrected", reasons(result));
    super::result::paragraph(&mut text, "Air and place", [air(result)].into_iter());
    super::result::paragraph(&mut text, "Notes", result.notes.iter().cloned());
    let _ = writeln!(
        text,
        "\nThe corrected errors are taken out of {}\nTo take them out of other flights: phugoid estimate FLIGHT.csv --correct {}\nReport: {}",
        document.corrected_csv.display(),
        document.corrections_json.display(),
        document.report.display()
    );
    text
}

/// The errors that were held at known values.
fn held(result: &Compatibility) -> impl Iterator<Item = String> + '_ {
    result.held.iter().map(|held| {
        let (unit, scale) = readable(&held.unit);
        let unit = if unit == "-" { String::new() } else { format!(" {unit}") };
        format!("{} at {}{unit}, not estimated", held.name, significant(scale * held.value, 4))
    })
}

/// Why errors are refused, or significant and yet not corrected.
fn reasons(result: &Compatibility) -> impl Iterator<Item = String> + '_ {
    result.errors.iter().filter_map(|e| e.reason.as_ref().map(|reason| format!("{}: {reason}", e.name)))
}

fn air(result: &Compatibility) -> String {
    let [gravity, sigma] = result.gravity;
    let [along, across, vertical] = result.gusts.map(|g| significant(g, 2));
    format!(
        "Gravity {gravity:.4} m/s^2, sigma {}. Gusts along body x, y, z: {along}, {across}, {vertical} m/s (one sigma).",
        significant(sigma, 2)
    )
}

fn skew_words(skew: &InputSkew) -> String {
    format!(
        "The {} is late by {} ms, sigma {} ms, by the model's own prediction of the motion.",
        skew.channel,
        significant(1e3 * skew.delay_s, 3),
        significant(1e3 * skew.std_error_s, 2)
    )
}

/// Figures of the measured and the reconstructed channels, with the standard error of the reconstruction.
fn charts(record: &Record, result: &Compatibility) -> Vec<Chart> {
    let x: Arc<[f64]> = result.time_s.clone().into();
    let curve = |label: &str, meaning: Meaning, shape: Shape| Curve {
        label: label.to_owned(),
        meaning,
        x: Arc::clone(&x),
        shape,
    };
    let panel = |c: &Reconstructed| {
        let (unit, scale) = readable(&c.unit);
        let scaled = |values: &[f64]| values.iter().map(|v| scale * v).collect::<Vec<f64>>();
        let edge = |sign: f64| c.values.iter().zip(&c.std_error).map(|(v, s)| scale * (v + sign * 2.0 * s)).collect();
        let band = Shape::Band { lower: edge(-1.0), upper: edge(1.0) };
        let mut curves = vec![curve("two standard errors", Meaning::Flagship, band)];
        if let Some(measured) = record.channel(&c.name) {
            curves.push(curve("measured", Meaning::Measured, Shape::Line(scaled(&measured.values))));
        }
        curves.push(curve(
            "reconstructed, without errors of the sensor",
            Meaning::Flagship,
            Shape::Line(scaled(&c.values)),
        ));
        Panel {
            y: Axis::new(c.name.replace('_', " "), unit),
            content: Content::Curves { curves, levels: Vec::new(), instants: Vec::new() },
        }
    };
    let panels: Vec<Panel> = result.reconstructed.iter().map(panel).collect();
    vec![Chart {
        name: "reconstruction".to_owned(),
        title: "Measured and reconstructed motion".to_owned(),
        caption: "What all sensors give together by kinematics alone, freed from the estimated errors, beside what was measured. \
                  Where the two part, the sensor has an error."
            .to_owned(),
        x: Axis::new("Time", "s"),
        columns: if panels.len() > 4 { 2 } else { 1 },
        panels,
    }]
}

fn page(
    arguments: &arguments::Compatibility,
    result: &Compatibility,
    skew: Option<&InputSkew>,
    charts: Vec<Chart>,
) -> StudyPage {
    let fit = Table {
        title: "Fit of the measured channels, errors of the sensors included".to_owned(),
        columns: vec![
            Column::new("Channel", ""),
            Column::new("RMS", "SI"),
            Column::new("Theil", ""),
            Column::new("Correlation of neighbours", ""),
        ],
        rows: result
            .fit
            .iter()
            .map(|f| vec![Cell::from(f.name.as_str()), Cell::from(f.rms), Cell::from(f.theil), Cell::from(f.lag_one)])
            .collect(),
    };
    let section = |anchor: &str, heading: &str| StudySection {
        anchor: anchor.to_owned(),
        heading: heading.to_owned(),
        ..StudySection::default()
    };
    StudyPage {
        title: "Data compatibility".to_owned(),
        by: "Checked by Phugoid".to_owned(),
        notes: vec![format!(
            "Measured = (1 + scale) true + bias, of accelerometers and gyroscopes true = (1 - scale) measured - bias. An error is \
             corrected if it is beyond three sigma and makes samples more likely that it was not fitted to (held-out gain). To \
             take these errors out of a flight: `phugoid estimate FLIGHT.csv --correct {}`.",
            arguments.out.join("corrections.json").display()
        )],
        facts: vec![("Record".to_owned(), result.source.clone())],
        sections: vec![
            StudySection {
                paragraphs: skew
                    .map(skew_words)
                    .into_iter()
                    .chain([air(result)])
                    .chain(held(result).map(|held| format!("Held, and corrected: {held}.")))
                    .chain(reasons(result))
                    .chain(result.notes.iter().cloned())
                    .collect(),
                tables: vec![table(result), fit],
                ..section("errors", "Errors of the sensors")
            },
            StudySection { charts, ..section("figures", "Figures") },
        ],
    }
}
