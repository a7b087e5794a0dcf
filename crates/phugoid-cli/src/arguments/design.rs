//! `phugoid design`.

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use phugoid_simulation::quantity::{Angle, AngularRate, Frequency, Time};

use super::help::examples_and_exit_codes;

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

fn positive(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if value > 0.0 && value.is_finite() => Ok(value),
        _ => Err("write a positive number, as in 0.5".to_owned()),
    }
}
