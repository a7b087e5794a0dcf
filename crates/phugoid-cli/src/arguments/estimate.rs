//! `phugoid estimate`.

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use phugoid_identification::estimate::StructureSearch;
use phugoid_identification::method::Method;
use phugoid_identification::options::{Band, FlowAngles};

use super::help::examples_and_exit_codes;
use super::method::method;
use super::number::manoeuvres;
use super::reading::{Deleting, Moment, Reading, flight};

/// Estimates the coefficients of an aircraft from a recorded flight
#[derive(Debug, Args)]
#[command(after_help = examples_and_exit_codes(
    "  phugoid estimate flight.csv --model jet.toml
  phugoid estimate hfb320.csv --model hfb320 --out report --figures figures
  phugoid estimate flight.csv --model jet.toml --from 12s --to 40s --json > result.json
  phugoid estimate flight.csv --model f16 --truth f16-damage   a simulated flight and its truth
  phugoid estimate flight.csv --model jet.toml --segment 2     one manoeuvre of `phugoid inspect`
  phugoid estimate flight.csv --model jet.toml --delete 'alpha@12.3s..12.8s: bird strike'
  phugoid estimate flight.csv --model jet.toml --export jsbsim=aero.xml --export csv=estimates.csv
  phugoid estimate flight.csv --model jet.toml --write-model identified.toml
  phugoid estimate --list-models                   the model files that are built in"
))]
pub(crate) struct Estimate {
    /// The flight.
    #[arg(value_name = "FLIGHT", help = flight(), required_unless_present_any = ["list_models", "show_model", "show_uncertainty"])]
    pub(crate) flight: Option<PathBuf>,
    /// The aircraft: a model file, or the name of a built-in one
    #[arg(long, value_name = "AIRCRAFT.toml", required_unless_present_any = ["list_models", "show_model"])]
    pub(crate) model: Option<String>,
    /// Estimator [default: the one that the model file names, or smpe]
    #[arg(long, value_parser = method())]
    pub(crate) method: Option<Method>,
    /// Another flight of the same aircraft, fitted together with the first by a batch method; may be repeated. Of a file with
    /// several tables FILE:VARIABLE, such as flights.mat:second
    #[arg(long, value_name = "FLIGHT")]
    pub(crate) with: Vec<PathBuf>,
    /// A flight to test the result on: its outputs are predicted with the parameters that a batch method has estimated. FILE or
    /// FILE:VARIABLE, as with --with
    #[arg(long, value_name = "FLIGHT")]
    pub(crate) predict: Option<PathBuf>,
    /// Let a batch method take all noise for Gaussian, so that an outlier counts with the square of its residual. Without
    /// this a value counts the less the further from the model it is, or is left out where it stands alone
    #[arg(long)]
    pub(crate) gaussian: bool,
    /// Where output error has airspeed and the angles of attack and sideslip from. A simulation knows nothing of gusts: in
    /// turbulence its angles are not those that made the forces
    #[arg(long, value_enum, value_name = "SOURCE", default_value_t)]
    pub(crate) flow_angles: FlowAngleSource,
    /// Band of frequencies of a method in the frequency domain, Hz, such as 0.1:1.5 [default: from two periods in the
    /// flight to where the inputs or the answers end]
    #[arg(long, value_name = "LOW:HIGH")]
    pub(crate) band: Option<Band>,
    #[command(flatten)]
    pub(crate) reading: Reading,
    #[command(flatten)]
    pub(crate) deleting: Deleting,
    /// Do not look for sudden changes of the coefficients
    #[arg(long)]
    pub(crate) no_change_detection: bool,
    /// Look for sudden changes even where the model file says not to
    #[arg(long, conflicts_with = "no_change_detection")]
    pub(crate) change_detection: bool,
    /// Only what a live session would have known: do not begin again from the values of equation error, do not look at the
    /// whole record again for changes that were not found in flight, and hold no other method against the result
    #[arg(long)]
    pub(crate) causal_only: bool,
    /// What to do about terms that the equations of motion ask for and the model file lacks: offer them with their effect
    /// on every parameter (the default), never look for them, or estimate with them (auto)
    #[arg(long, value_enum)]
    pub(crate) structure: Option<Structure>,
    /// The former spelling of --structure never
    #[arg(long, hide = true, conflicts_with = "structure")]
    pub(crate) no_offer: bool,
    /// The former spelling of --structure offer
    #[arg(long, hide = true, conflicts_with_all = ["no_offer", "structure"])]
    pub(crate) offer: bool,
    /// Correct the flight, and those of --with, for these sensor errors first: a file that `phugoid compatibility` has
    /// written. Its errors become part of the bounds, at the price of one more run for each corrected error
    #[arg(long, value_name = "CORRECTIONS.json")]
    pub(crate) correct: Option<PathBuf>,
    /// Begin at this time of the record, for example 12s, or when its clock shows this time of day, for example 10:15:31
    #[arg(long, value_name = "TIME", allow_hyphen_values = true)]
    pub(crate) from: Option<Moment>,
    /// End at this time of the record, for example 40s or 10:15:59
    #[arg(long, value_name = "TIME", allow_hyphen_values = true)]
    pub(crate) to: Option<Moment>,
    /// Use only the manoeuvre that `phugoid inspect` lists under this number. A batch method takes several, for example
    /// 1,3, and fits them together
    #[arg(long, value_name = "NUMBER", allow_negative_numbers = true, value_parser = manoeuvres, value_delimiter = ',', conflicts_with_all = ["from", "to"])]
    pub(crate) segment: Vec<usize>,
    /// The truth to compare with, where the flight was simulated: the scenario (a file, or the name of a built-in one),
    /// or single values, for example `--truth dCm_alpha=-0.2 --truth dCm_q=-2`. The estimator does not see it
    #[arg(long, value_name = "SCENARIO|NAME=VALUE", value_parser = truth)]
    pub(crate) truth: Vec<Truth>,
    /// Also give the derivatives in these axes, with their covariance: `stability` (CL, CD; moments, p and r about the
    /// stability axes) or `body` (CX, CZ; moments and rates about the body axes). A model file has CL and CD in
    /// stability axes and everything else in body axes
    #[arg(long, value_enum, value_name = "AXES")]
    pub(crate) axes_form: Option<AxesForm>,
    /// Folder for the report
    #[arg(long, value_name = "DIR", default_value = "phugoid-report")]
    pub(crate) out: PathBuf,
    /// Write no report
    #[arg(long)]
    pub(crate) no_report: bool,
    /// Also write the figures to this folder, as SVG and PNG
    #[arg(long, value_name = "DIR")]
    pub(crate) figures: Option<PathBuf>,
    /// Print one JSON document instead of text
    #[arg(long)]
    pub(crate) json: bool,
    /// Also write the result in another form: `csv=FILE`, `json=FILE` and `parquet=FILE` (a build with `--features parquet`)
    /// write the estimates, `xlsx=FILE` (`--features excel`) all tables of the result as a workbook, `jsbsim=FILE` the model as a JSBSim `<aerodynamics>`
    /// section, `daveml=FILE` as a model in DAVE-ML with uncertainties and check data (`phugoid check FILE` evaluates it),
    /// `gazebo=FILE` the model as parameters of the advanced lift-drag plugin that PX4's simulations use. May be repeated
    #[arg(long, value_name = "FORM=FILE", value_parser = export)]
    pub(crate) export: Vec<Export>,
    /// Write the model file again, with the estimates as start values: an aircraft for `trim`, `simulate` and `design`
    #[arg(long, value_name = "FILE.toml")]
    pub(crate) write_model: Option<PathBuf>,
    /// Write the histories of all signals and parameters to this file: CSV, or Parquet if its name ends in .parquet.
    /// Without a name they become part of the JSON document
    #[arg(long, value_name = "FILE.csv", num_args = 0..=1)]
    pub(crate) history: Option<Option<PathBuf>>,
    /// List the built-in model files
    #[arg(long)]
    pub(crate) list_models: bool,
    /// Print the uncertainties of the model's constants and sensor scales that go into the bounds, and where each comes
    /// from
    #[arg(long, requires = "model", conflicts_with = "list_models")]
    pub(crate) show_uncertainty: bool,
    /// Print the text of a built-in model file, as a start for your own
    #[arg(long, value_name = "NAME", conflicts_with = "list_models")]
    pub(crate) show_model: Option<String>,
}

/// Axes into which the derivatives can be transformed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum AxesForm {
    /// CL, CD; moments, p and r about the stability axes
    Stability,
    /// CX, CZ; moments and rates about the body axes
    Body,
}

/// Where output error has the flow angles from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub(crate) enum FlowAngleSource {
    /// As measured where the air is not calm, without the noise that accelerations, rates and attitude tell from gusts,
    /// which is said; else simulated
    #[default]
    Auto,
    /// From the simulation, and fitted to the vanes: the best estimate in calm air
    Simulated,
    /// As measured, and not fitted
    Measured,
}

impl From<FlowAngleSource> for FlowAngles {
    fn from(source: FlowAngleSource) -> Self {
        match source {
            FlowAngleSource::Auto => Self::Auto,
            FlowAngleSource::Simulated => Self::Simulated,
            FlowAngleSource::Measured => Self::Measured,
        }
    }
}

/// What to do about terms that the model file lacks.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Structure {
    /// Offer them; the estimate stays that of the model file
    Offer,
    /// Do not look for them
    Never,
    /// Estimate with the terms that are found
    Auto,
}

impl Structure {
    pub(crate) fn search(self) -> StructureSearch {
        match self {
            Self::Offer => StructureSearch::Offer,
            Self::Never => StructureSearch::Never,
            Self::Auto => StructureSearch::Auto,
        }
    }
}

/// True values of a simulated flight, as the option `--truth` gives them.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Truth {
    /// The scenario that was flown: a file, or the name of a built-in one.
    Scenario(String),
    /// One parameter: its name in the model file, and its true value in SI units, derivatives per rad.
    Value(String, f64),
}

fn truth(text: &str) -> Result<Truth, String> {
    let Some((name, value)) = text.split_once('=') else { return Ok(Truth::Scenario(text.to_owned())) };
    match value.trim().parse::<f64>() {
        Ok(value) if value.is_finite() => Ok(Truth::Value(name.trim().to_owned(), value)),
        _ => Err(format!("`{}` is no number: write a value per radian (SI), as in dCm_alpha=-0.2", value.trim())),
    }
}

/// File formats of `--export`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum ExportForm {
    Csv,
    Json,
    Parquet,
    Xlsx,
    Jsbsim,
    Gazebo,
    Daveml,
}

/// One value of `--export`: a format, and the file to write.
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
        "xlsx" => ExportForm::Xlsx,
        "jsbsim" => ExportForm::Jsbsim,
        "gazebo" | "px4" => ExportForm::Gazebo,
        "daveml" => ExportForm::Daveml,
        other => {
            return Err(format!(
                "`{other}` is no form: write csv=, json=, parquet=, xlsx=, jsbsim=, daveml= or gazebo= and a file"
            ));
        }
    };
    if file.is_empty() {
        return Err("write a form and a file, as in jsbsim=aero.xml".to_owned());
    }
    Ok(Export { form, file: PathBuf::from(file) })
}
