//! `phugoid design`.

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use phugoid_simulation::quantity::{Angle, AngularRate, Frequency, Time};

use super::help::examples_and_exit_codes;
use super::number::positive;

/// Designs a control input for system identification, and predicts how accurate the estimates from it can be
///
/// Pulse widths and frequency bands follow from the natural modes of the aircraft in the flight condition of the
/// scenario. The input is flown in simulation and made as large as the limits allow. The command writes the input as
/// CSV, a scenario that flies it, a table, an ArduPilot script, and a page with figures.
#[derive(Debug, Args)]
#[command(after_help = examples_and_exit_codes(
    "  phugoid design 3-2-1-1                                   elevator, F-16 of the scenario f16-calm
  phugoid design multisine --surface elevator,aileron,rudder --duration 30s
  phugoid design multisine --model f16 --predict           its bounds, and those of the others
  phugoid design sweep --from-frequency 0.1Hz --to-frequency 2Hz --amplitude 1deg
  phugoid simulate phugoid-design/scenario.toml            play it"
))]
pub(crate) struct Design {
    /// Kind of input
    #[arg(value_enum)]
    pub(crate) kind: InputKind,
    /// Control surfaces to move, separated by commas
    #[arg(long, value_enum, value_delimiter = ',', default_value = "elevator")]
    pub(crate) surface: Vec<SurfaceName>,
    /// Scenario that gives the aircraft, flight condition, sample rate and sensors: a file, or the name of a built-in
    /// one
    #[arg(long, default_value = "f16-calm")]
    pub(crate) scenario: String,
    /// Predict the Cramer-Rao bounds of the parameters of this model: a model file, or the name of a built-in one
    #[arg(long, value_name = "AIRCRAFT.toml")]
    pub(crate) model: Option<String>,
    /// Predict the bounds for every kind of input within the same limits, and rank the inputs
    #[arg(long, requires = "model")]
    pub(crate) predict: bool,
    /// Length of the record
    #[arg(long, allow_hyphen_values = true, value_name = "TIME", default_value = "20s")]
    pub(crate) duration: Time,
    /// Quiet time before the input
    #[arg(long, allow_hyphen_values = true, value_name = "TIME", default_value = "0.5s")]
    pub(crate) lead: Time,
    /// Lowest frequency of a sweep or multisine [default: 0.4 times the slowest mode]
    #[arg(long, allow_hyphen_values = true, value_name = "FREQUENCY", requires = "to_frequency")]
    pub(crate) from_frequency: Option<Frequency>,
    /// Highest frequency of a sweep or multisine [default: 2.5 times the fastest mode]
    #[arg(long, allow_hyphen_values = true, value_name = "FREQUENCY", requires = "from_frequency")]
    pub(crate) to_frequency: Option<Frequency>,
    /// Change the frequency of a sweep linearly in time, instead of with equal time per octave
    #[arg(long)]
    pub(crate) linear: bool,
    /// Peak deflections from trim, one per surface and separated by commas, instead of the largest that the limits
    /// allow
    #[arg(long, allow_hyphen_values = true, value_name = "ANGLE", value_delimiter = ',')]
    pub(crate) amplitude: Vec<Angle>,
    /// Largest deflection of each surface from trim
    #[arg(long, allow_hyphen_values = true, value_name = "ANGLE", default_value = "5deg")]
    pub(crate) deflection_limit: Angle,
    /// Largest rate of each surface: steps become ramps, and smooth inputs become smaller
    #[arg(long, allow_hyphen_values = true, value_name = "RATE", default_value = "60deg/s")]
    pub(crate) surface_rate_limit: AngularRate,
    /// Largest change of the angle of attack from trim
    #[arg(long, allow_hyphen_values = true, value_name = "ANGLE", default_value = "3deg")]
    pub(crate) alpha_limit: Angle,
    /// Largest change of the load factor from trim, in g
    #[arg(long, allow_hyphen_values = true, value_name = "NUMBER", default_value_t = 0.5, value_parser = positive)]
    pub(crate) load_factor_limit: f64,
    /// Largest change of the sideslip angle from trim
    #[arg(long, allow_hyphen_values = true, value_name = "ANGLE", default_value = "3deg")]
    pub(crate) beta_limit: Angle,
    /// Largest change of the bank angle from trim
    #[arg(long, allow_hyphen_values = true, value_name = "ANGLE", default_value = "30deg")]
    pub(crate) bank_limit: Angle,
    /// Folder for the files and the page
    #[arg(long, value_name = "DIR", default_value = "phugoid-design")]
    pub(crate) out: PathBuf,
    /// Also write the figures to this folder, as SVG and PNG
    #[arg(long, value_name = "DIR")]
    pub(crate) figures: Option<PathBuf>,
    /// Print one JSON document (SI units) instead of text
    #[arg(long)]
    pub(crate) json: bool,
}

/// Kinds of input that can be designed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum InputKind {
    /// Two opposite pulses, each as long as the natural mode requires
    Doublet,
    /// Alternating steps that last three, two, one and one time units
    #[value(name = "3-2-1-1")]
    ThreeTwoOneOne,
    /// Frequency sweep whose amplitude rises at the start and falls at the end
    Sweep,
    /// Sums of sines with phases that keep the peaks small, orthogonal between surfaces, so that all move at once
    Multisine,
}

/// Control surfaces that an input can move.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum SurfaceName {
    /// Positive with the trailing edge down
    Elevator,
    /// Positive with the trailing edge of the right aileron down: rolls to the left
    Aileron,
    /// Positive with the trailing edge to the left: yaws to the left
    Rudder,
}
