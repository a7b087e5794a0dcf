//! `phugoid design`.

use phugoid_flight_data::output_file;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use phugoid_design::fit::{Excursions, Fitted, Limits, fitted, with_amplitudes};
use phugoid_design::modes::ModeFrequencies;
use phugoid_design::predict::{Prediction, predict, ranked};
use phugoid_design::{Design, DesignError, Kind, Request, files, page, shape};
use phugoid_evaluation::table::{Cell, Table};
use phugoid_flight_data::csv;
use phugoid_report::{StudyPage, StudySection, chart_figure, study_html, write_named_figures};
use phugoid_simulation::manoeuvre::Surface;
use serde::Serialize;

use super::simulate::{scenario, text_of};
use crate::arguments::{self, InputKind, SurfaceName};
use crate::failure::Failure;
use crate::output::{self, json, print, significant};
use crate::progress::Progress;

#[derive(Serialize)]
struct Document<'a> {
    scenario: &'a str,
    modes: ModeFrequencies,
    limits: Limits,
    design: &'a Design,
    /// Peak deflections, rad, and peak rates, rad/s, in the order of the inputs.
    peaks: Vec<[f64; 2]>,
    limited_by: &'a [&'static str],
    excursions: Excursions,
    prediction: Option<&'a Prediction>,
    /// All kinds of input within the same limits, the one with the smallest bounds first.
    ranking: Vec<Ranked<'a>>,
    input_csv: PathBuf,
    scenario_toml: PathBuf,
    autopilot_table: PathBuf,
    ardupilot_script: PathBuf,
    report: PathBuf,
    figures: Vec<PathBuf>,
}

#[derive(Serialize)]
struct Ranked<'a> {
    kind: Kind,
    #[serde(flatten)]
    prediction: &'a Prediction,
}

pub(crate) fn run(arguments: &arguments::Design) -> Result<(), Failure> {
    let kind = match arguments.kind {
        InputKind::Doublet => Kind::Doublet,
        InputKind::ThreeTwoOneOne => Kind::ThreeTwoOneOne,
        InputKind::Sweep => Kind::Sweep,
        InputKind::Multisine => Kind::Multisine,
    };
    let base = scenario(&arguments.scenario)?;
    let model = arguments.model.as_deref().map(super::estimate::model).transpose()?;
    let request = request(arguments, base.sample_rate.si());
    let limits = Limits {
        deflection: arguments.deflection_limit.si(),
        surface_rate: arguments.surface_rate_limit.si(),
        alpha: arguments.alpha_limit.si(),
        load_factor: arguments.load_factor_limit,
        beta: arguments.beta_limit.si(),
        bank: arguments.bank_limit.si(),
    };
    let modes = ModeFrequencies::of_scenario(&base).map_err(failure)?;
    let make = |kind: Kind| -> Result<Fitted, DesignError> {
        let shape = shape(kind, &request, &modes)?;
        if arguments.amplitude.is_empty() {
            fitted(&shape, &base, &limits)
        } else {
            let amplitudes: Vec<f64> = arguments.amplitude.iter().map(|a| a.si()).collect();
            with_amplitudes(&shape, &base, &limits, &amplitudes)
        }
    };
    let progress = Progress::spinner("designing");
    let chosen = make(kind).map_err(failure)?;
    let prediction = model.as_ref().map(|model| predict(&chosen, model)).transpose().map_err(failure)?;
    let mut candidates = Vec::new();
    let mut left_out = Vec::new();
    if let (true, Some(model)) = (arguments.predict, &model) {
        for candidate in Kind::ALL {
            match make(candidate).and_then(|fitted| Ok((predict(&fitted, model)?, fitted))) {
                Ok((prediction, fitted)) => candidates.push((candidate, fitted, prediction)),
                // One that does not fit into the time is no reason to hide the others.
                Err(DesignError::Unsuitable(why)) => left_out.push(format!("{}: {why}", candidate.name())),
                Err(error) => return Err(failure(error)),
            }
        }
    }
    let candidates = ranked(candidates);
    drop(progress);

    let out = &arguments.out;
    std::fs::create_dir_all(out).map_err(|e| Failure::writing(out, e))?;
    let place = |name: &str| out.join(name);
    let write = |name: &str, text: &str| {
        let path = place(name);
        output_file::write(&path, text).map_err(|e| Failure::writing(&path, e)).map(|()| path)
    };
    let input_csv = place("input.csv");
    csv::write_path(&files::record(&chosen.design), &input_csv).map_err(|e| Failure::writing(&input_csv, e))?;
    let playing = files::scenario_text(&text_of(&arguments.scenario)?, &base.folder, &chosen.design, "input.csv");
    let playing = playing.map_err(failure)?;
    let scenario_toml = write("scenario.toml", &playing)?;
    let autopilot_table = write("autopilot.csv", &files::table(&chosen.design))?;
    let ardupilot_script = write("ardupilot.lua", &files::ardupilot_lua(&chosen.design))?;
    let charts = page::charts(&chosen, prediction.as_ref());
    let report =
        write("design.html", &study_html(&html(arguments, &base.name, &chosen, prediction.as_ref(), &candidates)))?;
    let figures = match &arguments.figures {
        Some(folder) => {
            let named: Vec<_> = charts.iter().map(|chart| (chart.name.clone(), chart_figure(chart))).collect();
            write_named_figures(folder, &named).map_err(|e| Failure::writing_of("--figures", folder, e))?
        }
        None => Vec::new(),
    };
    let h = 1.0 / chosen.design.sample_rate_hz;
    let document = Document {
        scenario: &base.name,
        modes,
        limits,
        design: &chosen.design,
        peaks: chosen.design.inputs.iter().map(|i| [i.peak(), i.peak_rate(h)]).collect(),
        limited_by: &chosen.limited_by,
        excursions: chosen.excursions,
        prediction: prediction.as_ref(),
        ranking: candidates.iter().map(|(kind, _, prediction)| Ranked { kind: *kind, prediction }).collect(),
        input_csv,
        scenario_toml,
        autopilot_table,
        ardupilot_script,
        report,
        figures,
    };
    if arguments.json {
        return print(&json(&document)?);
    }
    let mut text = format!("{} for {}\n\n", kind.name(), base.name);
    text.push_str(&plain(&page::surfaces(&chosen)));
    let _ = writeln!(text, "\n{}", moved(&chosen.excursions));
    if let Some(prediction) = &prediction {
        let _ = writeln!(text, "\nPredicted Cramer-Rao bound, model `{}`", prediction.model);
        text.push_str(&plain(&page::bounds(prediction)));
        if let Some((a, b, value)) = &prediction.worst_correlation {
            let _ = writeln!(text, "Told apart worst: {a} and {b}, correlation {}", significant(*value, 2));
        }
    }
    if !candidates.is_empty() {
        text.push_str("\nInputs at equal limits and equal time, best first (score: geometric mean of the columns)\n");
        text.push_str(&plain(&page::ranking(&candidates)));
    }
    for words in &left_out {
        let _ = writeln!(text, "Not compared: {words}");
    }
    let _ = writeln!(
        text,
        "\nInput:      {}\nTo play:    phugoid simulate {}\nAutopilots: {}, {} (read their first lines)\nReport:     {}",
        document.input_csv.display(),
        document.scenario_toml.display(),
        document.autopilot_table.display(),
        document.ardupilot_script.display(),
        document.report.display()
    );
    print(&text)
}

fn request(arguments: &arguments::Design, sample_rate_hz: f64) -> Request {
    let surface = |name: &SurfaceName| match name {
        SurfaceName::Elevator => Surface::Elevator,
        SurfaceName::Aileron => Surface::Aileron,
        SurfaceName::Rudder => Surface::Rudder,
    };
    Request {
        surfaces: arguments.surface.iter().map(surface).collect(),
        duration_s: arguments.duration.si(),
        lead_s: arguments.lead.si(),
        sample_rate_hz,
        band_hz: arguments.from_frequency.zip(arguments.to_frequency).map(|(low, high)| [low.si(), high.si()]),
        linear_sweep: arguments.linear,
    }
}

fn failure(error: DesignError) -> Failure {
    match error {
        DesignError::Flight(error) => super::simulate::failure(error),
        DesignError::Study(error) => super::study::failure(error),
        DesignError::Unsuitable(_) => Failure::impossible(error),
    }
}

/// A sentence with the largest deviations of the aircraft from trim.
fn moved(e: &Excursions) -> String {
    let degrees = |value: f64| significant(value.to_degrees(), 3);
    format!(
        "It moves the aircraft by {} deg of angle of attack, {} g, {} deg of sideslip and {} deg of bank.",
        degrees(e.alpha),
        significant(e.load_factor, 3),
        degrees(e.beta),
        degrees(e.bank)
    )
}

/// The aligned text of a table.
fn plain(table: &Table) -> String {
    let names = table.columns.iter().map(|c| match c.unit.as_str() {
        "" => c.name.to_lowercase(),
        unit => format!("{} {unit}", c.name.to_lowercase()),
    });
    // Names of parameters keep their capitals.
    let names: Vec<String> =
        names.zip(&table.columns).map(|(n, c)| if c.name.starts_with('σ') { c.name.clone() } else { n }).collect();
    let mut out = output::Table::new(&names.iter().map(String::as_str).collect::<Vec<_>>());
    for row in &table.rows {
        out.row(row.iter().map(|cell| match cell {
            Cell::Number(value) => significant(*value, 4),
            Cell::Text(words) => words.clone(),
        }));
    }
    out.render()
}

fn html(
    arguments: &arguments::Design,
    scenario: &str,
    chosen: &Fitted,
    prediction: Option<&Prediction>,
    candidates: &[(Kind, Fitted, Prediction)],
) -> StudyPage {
    let mut charts = page::charts(chosen, prediction);
    let after = charts.split_off(2);
    let mut sections = vec![StudySection {
        anchor: "input".to_owned(),
        heading: "Input".to_owned(),
        paragraphs: vec![moved(&chosen.excursions)],
        tables: vec![page::surfaces(chosen)],
        charts,
    }];
    if let Some(prediction) = prediction {
        let mut paragraphs = vec![
            "The smallest standard error that any unbiased estimator can have on this flight: calm air, white sensor noise, unknown \
             initial state, nothing known of the derivatives beforehand, sensor biases of the model file unknown within their \
             priors."
                .to_owned(),
        ];
        if let Some((a, b, value)) = &prediction.worst_correlation {
            paragraphs.push(format!("Told apart worst: {a} and {b}, correlation {}.", significant(*value, 2)));
        }
        let mut tables = vec![page::bounds(prediction)];
        if !candidates.is_empty() {
            tables.push(page::ranking(candidates));
        }
        sections.push(StudySection {
            anchor: "prediction".to_owned(),
            heading: "What it will tell".to_owned(),
            paragraphs,
            tables,
            charts: after,
        });
    }
    let facts = [
        ("Kind", chosen.design.kind.name().to_owned()),
        ("Scenario", scenario.to_owned()),
        ("Duration", format!("{} s", significant(arguments.duration.si(), 4))),
        ("Model", prediction.map(|p| p.model.clone()).unwrap_or_default()),
    ];
    StudyPage {
        title: format!("Input design: {}", chosen.design.kind.name()),
        by: "Designed by Phugoid".to_owned(),
        notes: vec![format!(
            "The amplitudes come from a simulation. Begin with a tenth of them on a real aircraft. To fly it in simulation: \
             `phugoid simulate {}`.",
            Path::new(&arguments.out).join("scenario.toml").display()
        )],
        facts: facts.into_iter().map(|(name, value)| (name.to_owned(), value)).collect(),
        sections,
    }
}
