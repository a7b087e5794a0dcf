//! `phugoid estimate`.

use phugoid_flight_data::output_file;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use phugoid::estimate_with_progress;
use phugoid_flight_data::csv;
use phugoid_flight_data::reader::ReadOptions;
use phugoid_flight_data::record::Record;
use phugoid_identification::compatibility::estimate_corrected;
use phugoid_identification::estimate::{EstimateOptions, StructureSearch, with_offered};
use phugoid_identification::estimation::{Estimation, UncertainQuantity};
use phugoid_identification::export::Identified;
use phugoid_identification::inspect::segment;
use phugoid_identification::manoeuvres::{Settings, find};
use phugoid_identification::method::Method;
use phugoid_identification::model_file::{BaseUncertainty, ModelFile, Uncertainty};
use phugoid_identification::options::Likelihood;
use phugoid_identification::parts::for_parts;
use phugoid_report::HtmlOptions;
use phugoid_simulation::scenario::nearest;
use serde::Serialize;

use super::axes_form::Turned;
use super::deleting::Deletions;
use super::export;
use super::further;
use super::result::{self, Document};
use super::simulate::scenario;
use crate::arguments::{self, FlowAngleSource, Further, Moment, Truth};
use crate::failure::{self, Failure};
use crate::output::{Table, json, print};
use crate::progress::Progress;

/// Estimates, or shows what the options ask for instead. The exit code is that of the result.
pub(crate) fn run(arguments: &arguments::Estimate) -> Result<ExitCode, Failure> {
    if let Some(name) = &arguments.show_model {
        return show_model(name).map(|()| ExitCode::SUCCESS);
    }
    if let (true, Some(wanted)) = (arguments.show_uncertainty, &arguments.model) {
        return show_uncertainty(&model(wanted)?.uncertainty).map(|()| ExitCode::SUCCESS);
    }
    let (false, Some(flight), Some(wanted)) = (arguments.list_models, &arguments.flight, &arguments.model) else {
        return list_models(arguments.json).map(|()| ExitCode::SUCCESS);
    };
    let history = History::new(arguments)?;
    let options = arguments.reading.options(flight)?;
    let with: Vec<Further> = arguments.with.iter().map(|word| Further::of(word)).collect();
    let predict = arguments.predict.as_deref().map(Further::of);
    let first = Further { file: flight.clone(), variable: options.table.variable.clone() };
    once_each(&first, &with, predict.as_ref())?;
    let (name, text) = ModelFile::find_text(wanted).map_err(Failure::input)?;
    let model = ModelFile::parse(&name, &text).map_err(Failure::input)?;
    export::check(&arguments.export, &model)?;
    if arguments.write_model.is_some() {
        export::with_values(&Identified::start(&model), &text)?;
    }
    let method = arguments.method.unwrap_or(model.estimator.method);
    check_options_of_methods(&[method], arguments.gaussian, arguments.flow_angles)?;
    let truth = truth(&arguments.truth, &model)?;
    let paths: Vec<&Path> =
        std::iter::once(&first).chain(&with).chain(&predict).map(|flight| flight.file.as_path()).collect();
    let deletions = Deletions::new(&arguments.deleting, &paths)?;
    let open = |path: &Path, options: &ReadOptions| model.open_record_with(path, options).map_err(Box::new);
    let beside = |option: &str, other: &Further| {
        let mut record = further::read(option, other, &options, open)?;
        deletions.apply(&mut record, &other.file, false)?;
        Ok::<_, Failure>(record)
    };
    let (record, further, predict) = {
        let _progress = Progress::spinner("reading");
        let mut record = open(flight, &options).map_err(Failure::input)?;
        deletions.apply(&mut record, flight, true)?;
        let further = with.iter().map(|other| beside("--with", other)).collect::<Result<Vec<_>, _>>()?;
        (record, further, predict.as_ref().map(|other| beside("--predict", other)).transpose()?)
    };
    // Times of convergence count from the start of the whole record.
    let start_s = record.time.first().copied();
    let corrections = arguments.correct.as_deref().map(super::compatibility::corrections).transpose()?;
    let is_part = !arguments.segment.is_empty() || arguments.from.is_some() || arguments.to.is_some();
    // The whole record tells more of its surfaces than a part of it. What another record holds is another matter, and corrections may
    // move a surface themselves: it would be moved twice.
    let asks_whole = is_part && further.is_empty() && predict.is_none() && corrections.is_none();
    let settled = if asks_whole { for_parts(&record, &model) } else { None };
    let (settled, model) = settled.map_or((None, model), |(record, model)| (Some(record), model));
    let (record, segments) = if arguments.segment.is_empty() {
        let record = settled.unwrap_or(record);
        (between(record, arguments.from, arguments.to)?, Vec::new())
    } else {
        // Manoeuvres keep the numbers of the record as it was recorded.
        segments(&record, settled.as_ref(), &arguments.segment)?
    };
    let further: Vec<Record> = segments.into_iter().chain(further).collect();
    let change_detection = match (arguments.change_detection, arguments.no_change_detection) {
        (true, _) => Some(true),
        (_, true) => Some(false),
        _ => None,
    };
    let structure = match (arguments.structure, arguments.no_offer) {
        (Some(structure), _) => structure.search(),
        (None, true) => StructureSearch::Never,
        (None, false) => StructureSearch::Offer,
    };
    let options = EstimateOptions {
        method: arguments.method,
        change_detection,
        causal_only: arguments.causal_only,
        start_s,
        truth,
        further,
        predict,
        structure,
        likelihood: if arguments.gaussian { Likelihood::Gaussian } else { Likelihood::Robust },
        flow_angles: arguments.flow_angles.into(),
        band: arguments.band,
        ..EstimateOptions::default()
    };
    let estimation = {
        let progress = Progress::new("estimating");
        let mut done = |done| progress.set(done);
        match &corrections {
            Some(corrections) => {
                estimate_corrected(&record, corrections, &model, &options, &mut done).map_err(phugoid::Error::from)?
            }
            None => estimate_with_progress(&record, &model, &options, &mut done)?,
        }
    };
    // With terms taken in, the model is another one for all that follows.
    let taken = estimation.offer.as_ref().filter(|offer| offer.taken);
    let model = taken.and_then(|offer| with_offered(&model, offer)).unwrap_or(model);
    let yes = |yes: bool| if yes { "yes" } else { "no" }.to_owned();
    let mut settings = vec![("estimator".to_owned(), estimation.method.name().to_owned())];
    if estimation.batch.is_none() {
        let looks = yes(change_detection.unwrap_or(model.change_detection));
        settings.push(("looks for sudden changes".to_owned(), looks));
        settings.push(("process noise learnt from the residuals".to_owned(), yes(model.process_noise.adaptive)));
    }
    let page = HtmlOptions { settings, ..HtmlOptions::default() };
    let presentation = Presentation {
        report: (!arguments.no_report).then_some(arguments.out.as_path()),
        page,
        figures: arguments.figures.as_deref(),
        history: &history,
        json: arguments.json,
        turned: arguments.axes_form.map(|form| Turned::of(&estimation, &model, form)),
    };
    presentation.present(&estimation)?;
    export::write(&arguments.export, &estimation, &model, arguments.json)?;
    if let Some(file) = &arguments.write_model {
        export::write_model(file, &text, &estimation, &model, arguments.json)?;
    }
    Ok(failure::of_result(&estimation))
}

/// Checks that an option about one kind of method is not given to methods that would not look at it.
///
/// # Errors
/// [`Failure::Input`]: nobody would see that the option has changed nothing.
pub(super) fn check_options_of_methods(
    methods: &[Method],
    gaussian: bool,
    flow_angles: FlowAngleSource,
) -> Result<(), Failure> {
    let names = |methods: &mut dyn Iterator<Item = Method>| methods.map(Method::name).collect::<Vec<_>>().join(", ");
    let refused = |option: &str, wanted: &str| {
        Err(Failure::input(format!(
            "{option} would change nothing: it is for {wanted}, and the method is {}. Name another one with --method, or leave \
             {option} out",
            names(&mut methods.iter().copied())
        )))
    };
    if gaussian && !methods.iter().any(|method| method.is_batch()) {
        let batch = names(&mut Method::ALL.iter().copied().filter(|method| method.is_batch()));
        return refused("--gaussian", &format!("the batch methods ({batch})"));
    }
    if flow_angles != FlowAngleSource::Auto && !methods.contains(&Method::OutputError) {
        return refused("--flow-angles", Method::OutputError.name());
    }
    Ok(())
}

/// Checks that no flight is given twice.
///
/// # Errors
/// [`Failure::Input`]: a flight that is fitted twice would halve the variances, and a flight that was fitted cannot test the fit.
fn once_each(first: &Further, with: &[Further], predict: Option<&Further>) -> Result<(), Failure> {
    let identity = |flight: &Further| {
        let variable = flight.variable.as_ref().or(first.variable.as_ref());
        (identity(&flight.file), variable.cloned())
    };
    let mut seen = vec![identity(first)];
    for further in with {
        let further_identity = identity(further);
        if seen.contains(&further_identity) {
            let file = further.file.display();
            return Err(Failure::input(format!(
                "--with {file}: this flight is fitted already; twice the same data would make the bounds too small. Name \
                 another flight, of a file with several tables --with {file}:VARIABLE, or leave --with out"
            )));
        }
        seen.push(further_identity);
    }
    match predict {
        Some(predict) if seen.contains(&identity(predict)) => Err(Failure::input(format!(
            "--predict {}: the parameters are fitted to this flight, so that it tests nothing. Name a flight that they \
             have not seen",
            predict.file.display()
        ))),
        _ => Ok(()),
    }
}

/// The canonical path of a file, so that two spellings of one path are equal; the given path if the file does not
/// exist.
fn identity(path: &Path) -> PathBuf {
    std::fs::canonicalize(path).unwrap_or_else(|_| path.to_owned())
}

/// Destination of the histories of signals and parameters: the option `--history`.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum History {
    /// They are not written.
    None,
    /// They become part of the JSON document.
    Document,
    /// They are written to this file: Parquet if its name ends in `.parquet`, else CSV.
    File(PathBuf),
}

impl History {
    /// Reads the option.
    ///
    /// # Errors
    /// [`Failure::Input`] for `--history` without a file name and without `--json`, and for Parquet in a build without
    /// it.
    fn new(arguments: &arguments::Estimate) -> Result<Self, Failure> {
        match &arguments.history {
            None => Ok(Self::None),
            Some(None) if arguments.json => Ok(Self::Document),
            Some(None) => {
                Err(Failure::input("--history needs a file (--history history.csv), or --json to put it there"))
            }
            Some(Some(file)) if is_parquet(file) && cfg!(not(feature = "parquet")) => {
                Err(Failure::no_parquet("--history", file, "name a .csv file"))
            }
            Some(Some(file)) => Ok(Self::File(file.clone())),
        }
    }
}

fn is_parquet(file: &Path) -> bool {
    file.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("parquet"))
}

#[cfg(feature = "parquet")]
fn write_history(record: &Record, file: &Path) -> Result<(), csv::WriteError> {
    match is_parquet(file) {
        true => phugoid_flight_data::parquet::write_path(record, file),
        false => csv::write_path(record, file),
    }
}

#[cfg(not(feature = "parquet"))]
fn write_history(record: &Record, file: &Path) -> Result<(), csv::WriteError> {
    csv::write_path(record, file)
}

/// Output options of an estimation.
pub(crate) struct Presentation<'a> {
    /// Folder of the report; none: no report is written.
    pub(crate) report: Option<&'a Path>,
    /// Further content of the report, such as the settings.
    pub(crate) page: HtmlOptions,
    /// Folder of the figures; none: they are not written as files.
    pub(crate) figures: Option<&'a Path>,
    /// Destination of the histories.
    pub(crate) history: &'a History,
    /// Print JSON instead of text.
    pub(crate) json: bool,
    /// The derivatives in the axes of `--axes-form`; none without this option.
    pub(crate) turned: Option<Turned>,
}

impl Presentation<'_> {
    /// Writes report and figures, and prints the result.
    pub(crate) fn present(&self, estimation: &Estimation) -> Result<(), Failure> {
        let progress = Progress::spinner("drawing");
        let report = self.report.map(|folder| self.write_report(estimation, folder)).transpose()?;
        let figures = match self.figures {
            Some(folder) => phugoid_report::write_figures(folder, estimation)
                .map_err(|e| Failure::writing_of("--figures", folder, e))?,
            None => Vec::new(),
        };
        if let History::File(file) = self.history {
            let record = estimation.history.record(&estimation.source);
            write_history(&record, file).map_err(|e| Failure::writing_of("--history", file, e))?;
        }
        drop(progress);
        if self.json {
            let mut document = Document::new(estimation, report, figures);
            document.history = (*self.history == History::Document).then_some(&estimation.history);
            document.turned = self.turned.as_ref();
            print(&json(&document)?)
        } else {
            let turned = self.turned.as_ref().map(Turned::text).unwrap_or_default();
            print(&(result::text(estimation, report.as_deref(), &figures) + &turned))
        }
    }

    fn write_report(&self, estimation: &Estimation, folder: &Path) -> Result<PathBuf, Failure> {
        let path = folder.join("report.html");
        let page = phugoid_report::html(estimation, &self.page);
        std::fs::create_dir_all(folder)
            .and_then(|()| output_file::write(&path, page))
            .map_err(|e| Failure::writing(&path, e))?;
        Ok(path)
    }
}

/// Reads a model file, or takes the built-in model of this name.
pub(crate) fn model(wanted: &str) -> Result<ModelFile, Failure> {
    ModelFile::find(wanted).map_err(Failure::input)
}

/// True values by parameter name. If several options name one parameter, the last one counts.
fn truth(words: &[Truth], model: &ModelFile) -> Result<BTreeMap<String, f64>, Failure> {
    let mut truth = BTreeMap::new();
    for word in words {
        match word {
            Truth::Scenario(wanted) => {
                let of_scenario = scenario(wanted)?.true_parameters();
                if !model.parameters.iter().any(|parameter| of_scenario.contains_key(&parameter.name)) {
                    return Err(no_truth(wanted, model, of_scenario.keys()));
                }
                truth.extend(of_scenario);
            }
            Truth::Value(name, value) => {
                let names = || model.parameters.iter().map(|p| p.name.as_str());
                if !names().any(|n| n == name) {
                    let hint = match nearest(name, names()) {
                        Some(near) => format!("did you mean `{near}`?"),
                        None => format!("it has {}", names().collect::<Vec<_>>().join(", ")),
                    };
                    return Err(Failure::input(format!("the model has no parameter `{name}` of --truth: {hint}")));
                }
                truth.insert(name.clone(), *value);
            }
        }
    }
    Ok(truth)
}

/// A scenario that says nothing about the parameters of a model is another flight, or that of another aircraft.
fn no_truth<'a>(wanted: &str, model: &ModelFile, of_scenario: impl Iterator<Item = &'a String>) -> Failure {
    let list = |mut names: Vec<&str>| {
        const SHOWN: usize = 6;
        let more = names.len() > SHOWN;
        names.truncate(SHOWN);
        names.join(", ") + if more { ", ..." } else { "" }
    };
    let of_model = list(model.parameters.iter().map(|parameter| parameter.name.as_str()).collect());
    Failure::input(format!(
        "--truth {wanted}: this scenario gives the true value of no parameter of the model `{}`, so that nothing could be \
         compared. The scenario has {}; the model has {of_model}. Name the scenario that was flown, or leave --truth out",
        model.source,
        list(of_scenario.map(String::as_str).collect())
    ))
}

/// The parts of the record with the manoeuvres of these numbers: the first one, and the others. They are cut out of `settled` where
/// there is one, the same record with its surfaces moved.
pub(super) fn segments(
    record: &Record,
    settled: Option<&Record>,
    numbers: &[usize],
) -> Result<(Record, Vec<Record>), Failure> {
    let found = find(record, &Settings::default());
    let record = settled.unwrap_or(record);
    let mut parts = Vec::with_capacity(numbers.len());
    for (index, number) in numbers.iter().enumerate() {
        if numbers[..index].contains(number) {
            return Err(Failure::input(format!("--segment names manoeuvre {number} twice: name each once")));
        }
        let [from, to] = segment(&found, *number).map_err(|why| Failure::input(format!("--segment: {why}")))?;
        let mut part = between(record.clone(), Some(Moment::Time(from)), Some(Moment::Time(to)))?;
        part.source = format!("{}, manoeuvre {number}", record.source);
        parts.push(part);
    }
    let mut parts = parts.into_iter();
    let first = parts.next().ok_or_else(|| Failure::input("--segment needs the number of a manoeuvre"))?;
    Ok((first, parts.collect()))
}

/// The part of a record from one time (s) to another, both included.
pub(super) fn between(record: Record, from: Option<Moment>, to: Option<Moment>) -> Result<Record, Failure> {
    if from.is_none() && to.is_none() {
        return Ok(record);
    }
    let from = from.map(|moment| moment.of(&record, "--from")).transpose()?;
    let to = to.map(|moment| moment.of(&record, "--to")).transpose()?;
    if let (Some(from), Some(to)) = (from, to)
        && to < from
    {
        return Err(Failure::input(format!("--from {from} s is after --to {to} s: the part ends before it begins")));
    }
    record.between(from.unwrap_or(f64::NEG_INFINITY), to.unwrap_or(f64::INFINITY)).ok_or_else(|| {
        let ends = record.time.first().zip(record.time.last());
        let span = ends.map_or_else(String::new, |(a, b)| format!(": the record runs from {a} s to {b} s"));
        Failure::input(format!("no sample lies between --from and --to{span}"))
    })
}

/// The declared uncertainties as a table.
fn show_uncertainty(uncertainty: &Uncertainty) -> Result<(), Failure> {
    let mut table = Table::new(&["key in [uncertainty]", "one sigma", "of", "because of"]);
    for quantity in UncertainQuantity::ALL {
        table.row(vec![
            quantity.key().to_owned(),
            match (quantity, uncertainty.base) {
                (UncertainQuantity::BaseTables, BaseUncertainty::Elements) => BaseUncertainty::IN_WORDS.to_owned(),
                _ => quantity.unit().in_words(uncertainty.of_quantity(quantity)),
            },
            quantity.name().to_owned(),
            uncertainty.origin_of(quantity).to_owned(),
        ]);
    }
    print(&table.render())
}

fn show_model(name: &str) -> Result<(), Failure> {
    print(ModelFile::text(name).map_err(Failure::input)?)
}

#[derive(Serialize)]
struct Listed {
    name: &'static str,
    description: String,
}

fn list_models(as_json: bool) -> Result<(), Failure> {
    let mut listed = Vec::new();
    for (name, text) in ModelFile::BUILT_IN {
        listed.push(Listed { name, description: ModelFile::parse(name, text).map_err(Failure::input)?.name });
    }
    if as_json {
        return print(&json(&listed)?);
    }
    let width = listed.iter().map(|l| l.name.len()).max().unwrap_or(0);
    print(&listed.iter().map(|l| format!("{:width$}  {}\n", l.name, l.description)).collect::<String>())
}
