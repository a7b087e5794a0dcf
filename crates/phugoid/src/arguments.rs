//! The command line.

#[cfg(feature = "live")]
pub(crate) mod address;
pub(crate) mod live;
mod view;

use std::path::PathBuf;

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use clap::{Args, Parser, Subcommand, ValueEnum};
use phugoid_identification::method::Method;
use phugoid_studies::quantity::{Angle, AngularRate, Frequency, Length, Speed, Time};

pub(crate) use view::View;

const EXIT_CODES: &str = "\
Exit codes:
  0  done
  1  the task has no answer (no such trim, nothing to estimate, a case that cannot be run)
  2  wrong command line
  3  an input (file, name, budget) is unknown, cannot be read or is wrong
  4  a result cannot be written
 10  `phugoid monitor`: the aircraft has diverged from what is expected";

/// Estimates an aircraft's aerodynamic coefficients from a flight, in real time or afterwards.
///
/// Without a command it flies the nonlinear F-16 with realistic sensors, estimates the aerodynamic increments that it
/// was given, sample by sample as an on-board computer would, and writes a report with figures.
#[derive(Debug, Parser)]
#[command(name = "phugoid", version, args_conflicts_with_subcommands = true, after_help = examples_and_exit_codes(
    "  phugoid                                          fly the F-16, estimate, write phugoid-report/
  phugoid --seed 7 --json                          another noise, the result as JSON
  phugoid estimate flight.csv --model jet.toml     your own flight
  phugoid trim --aircraft f16 --altitude 20000ft --speed 675ft/s --cg 0.30"
))]
pub(crate) struct Arguments {
    #[command(flatten)]
    pub(crate) demonstration: Demonstration,
    #[command(subcommand)]
    pub(crate) command: Option<Command>,
}

/// Examples and exit codes, as they stand below every help text.
fn examples_and_exit_codes(examples: &str) -> String {
    format!("Examples:\n{examples}\n\n{EXIT_CODES}")
}

#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    Trim(Trim),
    Linearize(Linearize),
    Simulate(Simulate),
    Inspect(Inspect),
    Estimate(Estimate),
    Monitor(Monitor),
    Study(Study),
    Compare(Compare),
    Reproduce(Reproduce),
    Tune(Tune),
    Design(Design),
    Compatibility(Compatibility),
    View(View),
    Live(live::Live),
}

/// The main job.
#[derive(Debug, Args)]
pub(crate) struct Demonstration {
    /// Seed of the sensor noise
    #[arg(long, value_name = "NUMBER")]
    pub(crate) seed: Option<u64>,
    /// Estimator
    #[arg(long, value_parser = method())]
    pub(crate) method: Option<Method>,
    /// Folder for the report [default: phugoid-report]
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
    /// Write the figures to this folder too, as SVG and PNG
    #[arg(long, value_name = "DIR")]
    pub(crate) figures: Option<PathBuf>,
    /// Print one JSON document instead of text
    #[arg(long)]
    pub(crate) json: bool,
}

/// Axes that derivatives are turned into.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum AxesForm {
    /// CL, CD; moments, p and r about the stability axes
    Stability,
    /// CX, CZ; moments and rates about the body axes
    Body,
}

/// Aircraft that are built in.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum AircraftName {
    /// F-16 of Stevens & Lewis
    F16,
}

/// Aerodynamic tables of the F-16.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum TablesName {
    /// Stevens, Lewis & Johnson, 3rd edition
    Book,
    /// Morelli's digitisation, as in NASA's DAVE-ML model
    Morelli,
}

/// A condition to trim in.
#[derive(Debug, Args)]
pub(crate) struct FlightCondition {
    /// Aircraft
    #[arg(long, value_enum, default_value = "f16")]
    pub(crate) aircraft: AircraftName,
    /// Aerodynamic tables
    #[arg(long, value_enum, default_value = "book")]
    pub(crate) tables: TablesName,
    /// Centre of gravity, fraction of the mean aerodynamic chord
    #[arg(long, default_value_t = 0.35, value_parser = fraction, allow_negative_numbers = true)]
    pub(crate) cg: f64,
    /// Altitude above sea level, as in 20000ft or 6096m
    #[arg(long, value_name = "LENGTH", allow_hyphen_values = true)]
    pub(crate) altitude: Length,
    /// True airspeed, as in 675ft/s, 400kt or 205.74m/s
    #[arg(long, value_name = "SPEED", allow_hyphen_values = true)]
    pub(crate) speed: Speed,
    /// Angle of climb, as in 3deg
    #[arg(long, value_name = "ANGLE", default_value = "0deg", allow_hyphen_values = true)]
    pub(crate) flight_path: Angle,
    /// Rate of turn about the vertical, positive to the right, as in 3deg/s
    #[arg(long, value_name = "RATE", default_value = "0deg/s", allow_hyphen_values = true)]
    pub(crate) turn_rate: AngularRate,
}

fn fraction(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if (0.0..=1.0).contains(&value) => Ok(value),
        Ok(_) => Err("a fraction of the mean chord lies between 0 and 1, as in 0.30".to_owned()),
        Err(_) => Err("write a fraction of the mean chord, as in 0.30".to_owned()),
    }
}

/// Where results go, for commands whose result is one document.
#[derive(Debug, Args)]
pub(crate) struct Delivery {
    /// Print one JSON document (SI units and radians) instead of text
    #[arg(long)]
    pub(crate) json: bool,
    /// Write the JSON document to this file too
    #[arg(long, value_name = "FILE")]
    pub(crate) out: Option<PathBuf>,
}

/// Finds the controls and attitude that hold an aircraft in steady flight
#[derive(Debug, Args)]
#[command(after_help = examples_and_exit_codes(
    "  phugoid trim --aircraft f16 --altitude 20000ft --speed 675ft/s --cg 0.30 --json
  phugoid trim --altitude 3000m --speed 180m/s --flight-path 5deg
  phugoid trim --altitude 0ft --speed 502ft/s --cg 0.30 --turn-rate 0.3rad/s"
))]
pub(crate) struct Trim {
    #[command(flatten)]
    pub(crate) condition: FlightCondition,
    #[command(flatten)]
    pub(crate) delivery: Delivery,
}

/// Linearises an aircraft about a trim, with its natural modes
#[derive(Debug, Args)]
#[command(after_help = examples_and_exit_codes(
    "  phugoid linearize --aircraft f16 --altitude 20000ft --speed 675ft/s --cg 0.30
  phugoid linearize --altitude 6096m --speed 400kt --json --out model.json"
))]
pub(crate) struct Linearize {
    #[command(flatten)]
    pub(crate) condition: FlightCondition,
    #[command(flatten)]
    pub(crate) delivery: Delivery,
}

/// Flies a scenario and writes what the sensors measured and what was true
#[derive(Debug, Args)]
#[command(after_help = examples_and_exit_codes(
    "  phugoid simulate f16-damage                      a built-in scenario (see `phugoid simulate --list`)
  phugoid simulate my-flight.toml --out flights    writes flights/measured.csv and flights/truth.csv
  phugoid simulate f16-calm --show > mine.toml     a scenario to start from"
))]
pub(crate) struct Simulate {
    /// Scenario file, or the name of a built-in one
    #[arg(value_name = "SCENARIO", required_unless_present = "list")]
    pub(crate) scenario: Option<String>,
    /// List the built-in scenarios
    #[arg(long)]
    pub(crate) list: bool,
    /// Print the text of the scenario instead of flying it
    #[arg(long, conflicts_with = "list")]
    pub(crate) show: bool,
    /// Seed of everything random, in place of the scenario's
    #[arg(long, value_name = "NUMBER")]
    pub(crate) seed: Option<u64>,
    /// Folder for measured.csv and truth.csv
    #[arg(long, value_name = "DIR", default_value = "phugoid-flight")]
    pub(crate) out: PathBuf,
    /// Write figures to this folder, as SVG and PNG
    #[arg(long, value_name = "DIR")]
    pub(crate) figures: Option<PathBuf>,
    /// Print one JSON document instead of text
    #[arg(long)]
    pub(crate) json: bool,
}

/// Says what a flight holds: channels, gaps, doubts, manoeuvres, and which derivatives they could tell
///
/// Nothing is estimated and no model is needed. Manoeuvres are numbered for `phugoid estimate --segment`. Where nothing can be estimated
/// it says why; that is a result, and the exit code stays 0.
#[derive(Debug, Args)]
#[command(after_help = examples_and_exit_codes(
    "  phugoid inspect flight.csv
  phugoid inspect flight.csv --model jet.toml      what the flight lacks for this model, read with its column names
  phugoid inspect yesterday.ulg                    topics and rates first, then the flight that they make
  phugoid inspect flight.csv --json --out flight.json"
))]
pub(crate) struct Inspect {
    /// The flight: a table (CSV with units in its headers), or a log of PX4 (ULog) or ArduPilot (DataFlash)
    #[arg(value_name = "FLIGHT")]
    pub(crate) flight: PathBuf,
    /// The aircraft: a model file, or the name of a built-in one; without it, all built-in ones are gone through
    #[arg(long, value_name = "AIRCRAFT.toml")]
    pub(crate) model: Option<String>,
    #[command(flatten)]
    pub(crate) delivery: Delivery,
}

/// The names of the estimators, with a line each in the help.
fn method() -> impl TypedValueParser<Value = Method> {
    let named = Method::ALL.iter().map(|method| PossibleValue::new(method.name()).help(method.description()));
    PossibleValuesParser::new(named).try_map(|name| name.parse::<Method>())
}

/// What is known to be true of a simulated flight.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Truth {
    /// The scenario that was flown.
    Scenario(String),
    /// One parameter by its name in the model file.
    Value(String, f64),
}

fn truth(text: &str) -> Result<Truth, String> {
    let Some((name, value)) = text.split_once('=') else { return Ok(Truth::Scenario(text.to_owned())) };
    match value.trim().parse::<f64>() {
        Ok(value) if value.is_finite() => Ok(Truth::Value(name.trim().to_owned(), value)),
        _ => Err(format!("`{}` is no number: write a value per radian (SI), as in dCm_alpha=-0.2", value.trim())),
    }
}

/// Forms that a result is exported in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum ExportForm {
    Csv,
    Json,
    Parquet,
    Jsbsim,
    Gazebo,
}

/// A form and the file for it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Export {
    pub(crate) form: ExportForm,
    pub(crate) file: PathBuf,
}

fn export(text: &str) -> Result<Export, String> {
    let (form, file) = text.split_once('=').unwrap_or((text, ""));
    let form = match form {
        "csv" => ExportForm::Csv,
        "json" => ExportForm::Json,
        "parquet" => ExportForm::Parquet,
        "jsbsim" => ExportForm::Jsbsim,
        "gazebo" | "px4" => ExportForm::Gazebo,
        other => {
            return Err(format!("`{other}` is no form: write csv=, json=, parquet=, jsbsim= or gazebo= and a file"));
        }
    };
    if file.is_empty() {
        return Err("write a form and a file, as in jsbsim=aero.xml".to_owned());
    }
    Ok(Export { form, file: PathBuf::from(file) })
}

/// Estimates the coefficients of an aircraft from a recorded flight
#[derive(Debug, Args)]
#[command(after_help = examples_and_exit_codes(
    "  phugoid estimate flight.csv --model jet.toml
  phugoid estimate hfb320.csv --model hfb320 --out report --figures figures
  phugoid estimate flight.csv --model jet.toml --from 12s --to 40s --json > result.json
  phugoid estimate flight.csv --model f16 --truth f16-damage       a simulated flight beside its truth
  phugoid estimate flight.csv --model jet.toml --segment 2         one manoeuvre of `phugoid inspect flight.csv`
  phugoid estimate flight.csv --model jet.toml --export jsbsim=aero.xml --export csv=estimates.csv
  phugoid estimate --list-models                   the model files that are built in"
))]
pub(crate) struct Estimate {
    /// The flight, a CSV file with units in its headers (alpha_deg, tas_kt, ...)
    #[arg(value_name = "FLIGHT.csv", required_unless_present_any = ["list_models", "show_model"])]
    pub(crate) flight: Option<PathBuf>,
    /// The aircraft: a model file, or the name of a built-in one
    #[arg(long, value_name = "AIRCRAFT.toml", required_unless_present_any = ["list_models", "show_model"])]
    pub(crate) model: Option<String>,
    /// Estimator; without it the model file's, or smpe
    #[arg(long, value_parser = method())]
    pub(crate) method: Option<Method>,
    /// Another flight of the same aircraft, fitted together with the first by a batch method; may be repeated
    #[arg(long, value_name = "FLIGHT.csv")]
    pub(crate) with: Vec<PathBuf>,
    /// A flight to try the result on: the parameters of a batch method are held, and its outputs predicted
    #[arg(long, value_name = "FLIGHT.csv")]
    pub(crate) predict: Option<PathBuf>,
    /// Do not look for sudden changes of the coefficients
    #[arg(long)]
    pub(crate) no_change_detection: bool,
    /// Look for sudden changes even where the model file says not to
    #[arg(long, conflicts_with = "no_change_detection")]
    pub(crate) change_detection: bool,
    /// Do not try terms that the model file lacks where residuals or adopted changes give a reason to
    #[arg(long)]
    pub(crate) no_offer: bool,
    /// Try them without a reason too
    #[arg(long, conflicts_with = "no_offer")]
    pub(crate) offer: bool,
    /// Take these errors of the sensors out of the flight first: a file that `phugoid compatibility` has written
    #[arg(long, value_name = "CORRECTIONS.json")]
    pub(crate) correct: Option<PathBuf>,
    /// Begin at this time of the record
    #[arg(long, value_name = "TIME", allow_hyphen_values = true)]
    pub(crate) from: Option<Time>,
    /// End at this time of the record
    #[arg(long, value_name = "TIME", allow_hyphen_values = true)]
    pub(crate) to: Option<Time>,
    /// Take this manoeuvre of `phugoid inspect` alone; several, as in 1,3, with a batch method, which fits them together
    #[arg(long, value_name = "NUMBER", value_delimiter = ',', conflicts_with_all = ["from", "to"])]
    pub(crate) segment: Vec<usize>,
    /// The truth to compare with, where the flight was simulated: the scenario (a file, or the name of a built-in one), or
    /// values one by one, as in `--truth dCm_alpha=-0.2 --truth dCm_q=-2`. The estimator does not see it
    #[arg(long, value_name = "SCENARIO|NAME=VALUE", value_parser = truth)]
    pub(crate) truth: Vec<Truth>,
    /// Give the derivatives in these axes too, with their covariance: `stability` (CL, CD; moments, p and r about the
    /// stability axes) or `body` (CX, CZ; moments and rates about the body axes). A model file has CL and CD in stability
    /// axes and all else in body axes
    #[arg(long, value_enum, value_name = "AXES")]
    pub(crate) axes_form: Option<AxesForm>,
    /// Folder for the report
    #[arg(long, value_name = "DIR", default_value = "phugoid-report")]
    pub(crate) out: PathBuf,
    /// Write no report
    #[arg(long)]
    pub(crate) no_report: bool,
    /// Write the figures to this folder too, as SVG and PNG
    #[arg(long, value_name = "DIR")]
    pub(crate) figures: Option<PathBuf>,
    /// Print one JSON document instead of text
    #[arg(long)]
    pub(crate) json: bool,
    /// Write the result in another form too, may be repeated: `csv=FILE`, `parquet=FILE` or `json=FILE` the estimates, `jsbsim=FILE` the model as a
    /// JSBSim `<aerodynamics>` section, `gazebo=FILE` as parameters of the advanced lift-drag plugin that PX4's simulations use
    #[arg(long, value_name = "FORM=FILE", value_parser = export)]
    pub(crate) export: Vec<Export>,
    /// Write the histories of all signals and parameters to this file (CSV, or Parquet if its name ends so); without a name they
    /// go into the JSON document
    #[arg(long, value_name = "FILE.csv", num_args = 0..=1)]
    pub(crate) history: Option<Option<PathBuf>>,
    /// List the built-in model files
    #[arg(long)]
    pub(crate) list_models: bool,
    /// Print a built-in model file, to start your own from
    #[arg(long, value_name = "NAME", conflicts_with = "list_models")]
    pub(crate) show_model: Option<String>,
}

/// Runs the cases of the thesis that this project grew from, and writes one report: published, reconstructed, found
#[derive(Debug, Args)]
#[command(after_help = examples_and_exit_codes(
    "  phugoid reproduce                                everything; writes phugoid-reproduction/report.html
  phugoid reproduce --list                         ids and titles
  phugoid reproduce second-order/3                 one case, told in full
  phugoid reproduce first-order noise/2 --json     a group and a case, as JSON
  phugoid reproduce my-case.toml --figures svg     a case file of your own

A requirement that is not met is a result, and told: the exit code stays 0. A case that cannot be run is a failure: the
others are still reported, and the exit code is 1."
))]
pub(crate) struct Reproduce {
    /// Cases: an id, a group of them, or a case file of your own [default: everything]
    #[arg(value_name = "ID|GROUP|FILE.toml", conflicts_with = "list")]
    pub(crate) cases: Vec<String>,
    /// List the ids with their titles
    #[arg(long)]
    pub(crate) list: bool,
    /// Folder for report.html, reproduction.json and a CSV per case
    #[arg(long, value_name = "DIR", default_value = "phugoid-reproduction")]
    pub(crate) out: PathBuf,
    /// Write the figures to the folder too, one file each
    #[arg(long, value_enum, value_name = "FORMAT")]
    pub(crate) figures: Option<PictureFormat>,
    /// Print one JSON document instead of text
    #[arg(long)]
    pub(crate) json: bool,
    /// Put the curves of all figures into the JSON document
    #[arg(long, requires = "json")]
    pub(crate) charts: bool,
}

/// Formats of figures.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum PictureFormat {
    /// Drawing, text as text
    Svg,
    /// Picture, 1920 px wide
    Png,
}

/// Watches a recorded flight for a divergence from the expected coefficients: a flag with a stated false-alarm rate, the onset
/// of the failure, and which coefficient
#[derive(Debug, Args)]
#[command(after_help = examples_and_exit_codes(
    "  phugoid simulate f16-failure --out flight
  phugoid monitor flight/measured.csv --model f16-health-model
  phugoid monitor flight.csv --model jet.toml --expected jet-expected.toml --false-alarms-per-hour 0.001
  phugoid monitor flight.csv --model jet.toml --json --out health"
))]
pub(crate) struct Monitor {
    /// The flight, a CSV file with units in its headers (alpha_deg, tas_kt, ...)
    #[arg(value_name = "FLIGHT.csv")]
    pub(crate) flight: PathBuf,
    /// The aircraft: a model file, or the name of a built-in one. Its table `expected` says what is healthy; without one its start
    /// values do, within a tenth
    #[arg(long, value_name = "AIRCRAFT.toml")]
    pub(crate) model: String,
    /// A file with the table `expected`, in place of the model file's
    #[arg(long, value_name = "EXPECTED.toml")]
    pub(crate) expected: Option<PathBuf>,
    /// False alarms per flight hour that are accepted [default: 0.01]
    #[arg(long, value_name = "NUMBER", value_parser = rate)]
    pub(crate) false_alarms_per_hour: Option<f64>,
    /// Folder for health.json, with all histories, and the report of the estimation
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
    /// Print one JSON document instead of text
    #[arg(long)]
    pub(crate) json: bool,
    /// Put the history of every sample into the JSON document
    #[arg(long, requires = "json")]
    pub(crate) history: bool,
}

fn rate(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if (1e-9..60.0).contains(&value) => Ok(value),
        Ok(_) => Err("a rate per flight hour lies between 1e-9 and 60, as in 0.01: one in a hundred hours".to_owned()),
        Err(_) => Err("write false alarms per flight hour, as in 0.01: one in a hundred hours".to_owned()),
    }
}

/// Runs every method on the same samples of the same flights, and says where each of them wins and loses
#[derive(Debug, Args)]
#[command(after_help = examples_and_exit_codes(
    "  phugoid compare                                    every scenario of the arena; writes phugoid-comparison/
  phugoid compare --quick                            four flights each, for a first look
  phugoid compare calm everything --seeds 100        two scenarios, told more exactly
  phugoid compare my.toml --model jet.toml --methods smpe,ekf
  phugoid compare --list                             what there is to fly and to compare

A method that fails is a result, and told: the exit code stays 0."
))]
pub(crate) struct Compare {
    /// Scenarios: entries of the arena, files like them, or scenarios of your own with --model [default: the whole arena]
    #[arg(value_name = "ENTRY|FILE.toml", conflicts_with = "list")]
    pub(crate) scenarios: Vec<String>,
    /// What the methods are told of the aircraft in scenarios without a model of their own: a model file, or a built-in one
    #[arg(long, value_name = "AIRCRAFT.toml")]
    pub(crate) model: Option<String>,
    /// Methods, separated by commas; the first one is the one compared with [default: all]
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    pub(crate) methods: Vec<String>,
    /// Flights per scenario, each with its own noise, gusts, pilot [default: 20]
    #[arg(long, value_name = "NUMBER", value_parser = clap::value_parser!(u32).range(1..=10_000))]
    pub(crate) seeds: Option<u32>,
    /// Four flights per scenario
    #[arg(long, conflicts_with = "seeds")]
    pub(crate) quick: bool,
    /// Period in which times are counted in scenarios of your own: the short period
    #[arg(long, value_name = "TIME", default_value = "4.17s")]
    pub(crate) cycle: Time,
    /// List the scenarios and methods
    #[arg(long)]
    pub(crate) list: bool,
    /// Folder for report.html, comparison.json and comparison.csv
    #[arg(long, value_name = "DIR", default_value = "phugoid-comparison")]
    pub(crate) out: PathBuf,
    /// Write the figures to the folder too, one file each
    #[arg(long, value_enum, value_name = "FORMAT")]
    pub(crate) figures: Option<PictureFormat>,
    /// Print one JSON document instead of text
    #[arg(long)]
    pub(crate) json: bool,
}

/// Measures the estimator on many simulated flights: against the Cramer-Rao bound, after damage
#[derive(Debug, Args)]
#[command(after_help = examples_and_exit_codes(
    "  phugoid study calm-air --runs 200        RMSE over Cramer-Rao bound, and coverage
  phugoid study lateral --runs 200         the same of the lateral-directional motion
  phugoid study six --runs 100             the same of all six coefficients together
  phugoid study thesis-size --json         0.05 deg doublet and sine without noise
  phugoid study damage --runs 100          is damage found, how soon, do the bounds hold?
  phugoid study health --runs 1000         false alarms, missed failures, onset
  phugoid study accuracy --scenario mine.toml --model mine-model.toml --at 5s --at 20s"
))]
pub(crate) struct Study {
    /// Which study
    #[arg(value_enum)]
    pub(crate) study: StudyName,
    /// Number of runs, each with its own noise
    #[arg(long, default_value_t = 200, value_parser = clap::value_parser!(u32).range(1..=100_000))]
    pub(crate) runs: u32,
    /// Scenario of the study `accuracy`: a file, or the name of a built-in one
    #[arg(long, required_if_eq("study", "accuracy"))]
    pub(crate) scenario: Option<String>,
    /// Model file of the study `accuracy`, or the name of a built-in one. It has to give the noise of its outputs
    #[arg(long, required_if_eq("study", "accuracy"))]
    pub(crate) model: Option<String>,
    /// Estimator of the studies `calm-air` and `accuracy`; without it the model file's, or smpe
    #[arg(long, value_parser = method())]
    pub(crate) method: Option<Method>,
    /// Times of the study `accuracy` at which the estimates are compared [default: the end]
    #[arg(long, allow_hyphen_values = true, value_name = "TIME")]
    pub(crate) at: Vec<Time>,
    #[command(flatten)]
    pub(crate) delivery: Delivery,
}

/// Studies that are built in.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum StudyName {
    /// F-16 in calm air with realistic sensors: accuracy against the Cramer-Rao bound
    CalmAir,
    /// The fifteen lateral-directional derivatives of the F-16 and three constants, from rudder and aileron doublets
    Lateral,
    /// All six coefficients of the F-16 at once, 24 derivatives, from all three surfaces
    Six,
    /// Inputs as small as the thesis used, without noise: time to converge
    ThesisSize,
    /// Five coefficients change at 10 s: detection and recovery
    Damage,
    /// Change detection: random damage found or missed, and false adoptions under errors of the model. RUNS damages and RUNS
    /// minutes of flight per line
    Detection,
    /// Health monitor: false alarms in healthy flights, and random failures with two sticks
    Health,
    /// Accuracy against the Cramer-Rao bound for a scenario and a model file of your own
    Accuracy,
}

/// Methods whose settings can be tuned.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum TunedMethod {
    /// Sliding-mode parameter estimator, on flights; writes an `estimator` section for model files
    Smpe,
    /// The thesis's sliding law, on cases with one unknown parameter
    ThesisLaw,
    /// The model-reference law (state-error form), on plants
    ModelReference,
}

/// Chooses the settings of an estimator: by rule, and by a search that is judged on runs it has not seen
///
/// The rule sets everything from bounds, noise, sample time and expected input. The search starts from the rule and lowers
/// the mean over all training runs of: the logarithm of the time until each estimate stays within 5 % of its truth (as a part
/// of the record), the logarithm of its final error (in units of 5 %), and, for estimators that claim bounds, a penalty on
/// bounds that are wide or do not hold the truth. Each scenario is run with several truths and noises.
#[derive(Debug, Args)]
#[command(after_help = examples_and_exit_codes(
    "  phugoid tune smpe                                    built-in flights; writes phugoid-tuned.toml
  phugoid tune thesis-law --rule-only                  what the rule says, and how good it is
  phugoid tune model-reference --scenario first-order/1 --hold-out second-order/2
  phugoid tune smpe --scenario mine.toml --model jet.toml --runs 8 --budget 500
  phugoid tune smpe --state tuning.state               stop it (Ctrl-C), run it again: it goes on"
))]
pub(crate) struct Tune {
    /// What is tuned
    #[arg(value_enum)]
    pub(crate) method: TunedMethod,
    /// Tune on this: a scenario or case file, or the name of a built-in one (f16-calm, first-order/1)
    /// [default: a few built-in ones]
    #[arg(long, value_name = "SCENARIO")]
    pub(crate) scenario: Vec<String>,
    /// Judge by this, which the search does not see: as --scenario. Its runs have other truths and noises in any case
    /// [default: built-in ones, or those of --scenario]
    #[arg(long, value_name = "SCENARIO")]
    pub(crate) hold_out: Vec<String>,
    /// What the estimator is told of the aircraft of scenario files: a model file, or the name of a built-in one
    #[arg(long, value_name = "AIRCRAFT.toml")]
    pub(crate) model: Option<String>,
    /// Runs of each scenario, each with its own truth and noise, for tuning and for judging
    #[arg(long, value_name = "NUMBER", default_value_t = 6, value_parser = clap::value_parser!(u32).range(1..=10_000))]
    pub(crate) runs: u32,
    /// Settings to try, the rule's included; a number of whole generations is tried
    #[arg(long, value_name = "EVALUATIONS", default_value_t = 180, value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    pub(crate) budget: u32,
    /// Seed of the search
    #[arg(long, value_name = "NUMBER", default_value_t = 1)]
    pub(crate) seed: u64,
    /// Keep the state of the search in this file, written after every generation, and go on from it if it is there
    #[arg(long, value_name = "FILE")]
    pub(crate) state: Option<PathBuf>,
    /// Say what the rule gives, and search nothing
    #[arg(long, conflicts_with_all = ["budget", "state", "seed"])]
    pub(crate) rule_only: bool,
    /// File for the settings
    #[arg(long, value_name = "FILE", default_value = "phugoid-tuned.toml")]
    pub(crate) out: PathBuf,
    /// Print one JSON document (SI units) instead of text
    #[arg(long)]
    pub(crate) json: bool,
}

/// Families of inputs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum InputKind {
    /// Up and down, as wide as the mode asks for
    Doublet,
    /// Steps of three, two, one and one units
    #[value(name = "3-2-1-1")]
    ThreeTwoOneOne,
    /// Frequency sweep with faded ends
    Sweep,
    /// Orthogonal phase-optimised multisines, all surfaces at once
    Multisine,
}

/// Surfaces.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum SurfaceName {
    /// Positive trailing edge down
    Elevator,
    /// Positive right trailing edge down
    Aileron,
    /// Positive trailing edge left
    Rudder,
}

/// Designs an input for system identification, and says what it will tell before anyone flies it
///
/// Widths and bands follow from the modes of the aircraft in the condition of the scenario. The input is flown in simulation and
/// made as large as the limits allow. Written are the input as CSV, a scenario that plays it, a table and an ArduPilot script,
/// and a page with figures.
#[derive(Debug, Args)]
#[command(after_help = examples_and_exit_codes(
    "  phugoid design 3-2-1-1                                   elevator, F-16 of the scenario f16-calm
  phugoid design multisine --surface elevator,aileron,rudder --duration 30s
  phugoid design multisine --model f16 --predict           what it tells, beside the other inputs at equal limits
  phugoid design sweep --from-frequency 0.1Hz --to-frequency 2Hz --amplitude 1deg
  phugoid simulate phugoid-design/scenario.toml            play it"
))]
pub(crate) struct Design {
    /// Kind of input
    #[arg(value_enum)]
    pub(crate) kind: InputKind,
    /// Surfaces to move, separated by commas
    #[arg(long, value_enum, value_delimiter = ',', default_value = "elevator")]
    pub(crate) surface: Vec<SurfaceName>,
    /// Aircraft, condition, sample rate and sensors: a scenario file, or the name of a built-in one
    #[arg(long, default_value = "f16-calm")]
    pub(crate) scenario: String,
    /// Predict the Cramer-Rao bound of the parameters of this model file, or built-in model
    #[arg(long, value_name = "AIRCRAFT.toml")]
    pub(crate) model: Option<String>,
    /// Predict the bound for every kind of input at equal limits, and rank them
    #[arg(long, requires = "model")]
    pub(crate) predict: bool,
    /// Length of the record
    #[arg(long, allow_hyphen_values = true, value_name = "TIME", default_value = "20s")]
    pub(crate) duration: Time,
    /// Quiet time before the input
    #[arg(long, allow_hyphen_values = true, value_name = "TIME", default_value = "0.5s")]
    pub(crate) lead: Time,
    /// Lowest frequency of sweep and multisine [default: 0.4 times the slowest mode]
    #[arg(long, allow_hyphen_values = true, value_name = "FREQUENCY", requires = "to_frequency")]
    pub(crate) from_frequency: Option<Frequency>,
    /// Highest frequency of sweep and multisine [default: 2.5 times the fastest mode]
    #[arg(long, allow_hyphen_values = true, value_name = "FREQUENCY", requires = "from_frequency")]
    pub(crate) to_frequency: Option<Frequency>,
    /// Let the frequency of a sweep run linearly instead of with equal time per octave
    #[arg(long)]
    pub(crate) linear: bool,
    /// Peak deflections from trim, one per surface, in place of what the limits allow
    #[arg(long, allow_hyphen_values = true, value_name = "ANGLE", value_delimiter = ',')]
    pub(crate) amplitude: Vec<Angle>,
    /// Limit on the deflection of each surface from trim
    #[arg(long, allow_hyphen_values = true, value_name = "ANGLE", default_value = "5deg")]
    pub(crate) deflection_limit: Angle,
    /// Limit on the rate of each surface: steps become ramps, smooth inputs smaller
    #[arg(long, allow_hyphen_values = true, value_name = "RATE", default_value = "60deg/s")]
    pub(crate) surface_rate_limit: AngularRate,
    /// Limit on the angle of attack from trim
    #[arg(long, allow_hyphen_values = true, value_name = "ANGLE", default_value = "3deg")]
    pub(crate) alpha_limit: Angle,
    /// Limit on the load factor from trim, in g
    #[arg(long, allow_hyphen_values = true, value_name = "NUMBER", default_value_t = 0.5, value_parser = positive)]
    pub(crate) load_factor_limit: f64,
    /// Limit on the sideslip from trim
    #[arg(long, allow_hyphen_values = true, value_name = "ANGLE", default_value = "3deg")]
    pub(crate) beta_limit: Angle,
    /// Limit on the bank from trim
    #[arg(long, allow_hyphen_values = true, value_name = "ANGLE", default_value = "30deg")]
    pub(crate) bank_limit: Angle,
    /// Folder for the files and the page
    #[arg(long, value_name = "DIR", default_value = "phugoid-design")]
    pub(crate) out: PathBuf,
    /// Write the figures to this folder too, as SVG and PNG
    #[arg(long, value_name = "DIR")]
    pub(crate) figures: Option<PathBuf>,
    /// Print one JSON document (SI units) instead of text
    #[arg(long)]
    pub(crate) json: bool,
}

fn positive(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if value > 0.0 && value.is_finite() => Ok(value),
        _ => Err("write a positive number, as in 0.5".to_owned()),
    }
}

/// Groups of sensor errors beside those that are always estimated.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum SensorGroup {
    /// Scale factors of accelerometers and rate gyroscopes
    InertialScales,
    /// Distances of the vanes ahead of the centre of gravity
    VanePositions,
    /// Position of the accelerometers
    AccelerometerPosition,
}

/// Checks a flight for kinematic consistency and estimates the errors of its sensors
///
/// Accelerometers and rate gyroscopes give airspeed, flow angles, attitude and altitude by kinematics alone, whatever the aircraft.
/// From the difference to what was measured follow biases, scale factors, delays and wind, each with its standard error, or that
/// the manoeuvre does not tell it. Written are the corrected record, the corrections, and a page with figures.
#[derive(Debug, Args)]
#[command(after_help = examples_and_exit_codes(
    "  phugoid compatibility flight.csv
  phugoid compatibility flight.csv --model jet.toml --elevator-skew
  phugoid compatibility flight.csv --alpha-vane 4.2m --estimate inertial-scales
  phugoid estimate flight.csv --model jet.toml --correct phugoid-compatibility/corrections.json"
))]
pub(crate) struct Compatibility {
    /// The flight, a CSV file with units in its headers
    #[arg(value_name = "FLIGHT.csv")]
    pub(crate) flight: PathBuf,
    /// Model file, or the name of a built-in one, for the names of the columns and the acceleration of gravity
    #[arg(long, value_name = "AIRCRAFT.toml")]
    pub(crate) model: Option<String>,
    /// Find the delay of the elevator against all else with the model of --model
    #[arg(long, requires = "model")]
    pub(crate) elevator_skew: bool,
    /// Distance of the vane of the angle of attack ahead of the centre of gravity
    #[arg(long, value_name = "LENGTH", allow_hyphen_values = true)]
    pub(crate) alpha_vane: Option<Length>,
    /// Distance of the vane of the sideslip ahead of the centre of gravity
    #[arg(long, value_name = "LENGTH", allow_hyphen_values = true)]
    pub(crate) beta_vane: Option<Length>,
    /// Estimate these too, separated by commas
    #[arg(long, value_enum, value_delimiter = ',', value_name = "GROUP")]
    pub(crate) estimate: Vec<SensorGroup>,
    /// Folder for the corrected record, the corrections and the page
    #[arg(long, value_name = "DIR", default_value = "phugoid-compatibility")]
    pub(crate) out: PathBuf,
    /// Write the figures to this folder too, as SVG and PNG
    #[arg(long, value_name = "DIR")]
    pub(crate) figures: Option<PathBuf>,
    /// Print one JSON document (SI units) instead of text
    #[arg(long)]
    pub(crate) json: bool,
}
