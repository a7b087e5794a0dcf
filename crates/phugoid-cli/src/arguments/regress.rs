//! `phugoid regress`.

use std::path::PathBuf;

use clap::Args;
use phugoid_identification::regress::Criterion;
use phugoid_identification::term::Coefficient;

use super::delivery::Delivery;
use super::help::examples_and_exit_codes;
use super::number::{manoeuvre, positive};
use super::reading::{Deleting, Moment, Reading, flight};

/// Selects the terms of a coefficient from a recorded flight: multivariate orthogonal functions or modified stepwise
/// regression
///
/// The coefficient is computed from measured rates and accelerations. Candidate terms are taken in one after the other, and
/// the result is a polynomial with standard errors and the lines for a model file. Of the model file only masses, sizes,
/// thrust and channels are used, not its terms. Noise in the regressors draws the values towards zero: estimate with the
/// lines to get final values.
#[derive(Debug, Args)]
#[command(after_help = examples_and_exit_codes(
    "  phugoid regress flight.csv --model jet.toml --coefficient Cm
  phugoid regress flight.csv --model jet.toml --coefficient Cm --up-to 3 --criterion press
  phugoid regress flight.csv --model jet.toml --coefficient CD \\
                  --candidates 'alpha, alpha^2, |elevator|, alpha*elevator'
  phugoid regress flight.csv --model jet.toml --coefficient CL --segment 2 --json"
))]
pub(crate) struct Regress {
    /// The flight.
    #[arg(value_name = "FLIGHT", help = flight())]
    pub(crate) flight: PathBuf,
    /// The aircraft: a model file, or the name of a built-in one
    #[arg(long, value_name = "AIRCRAFT.toml")]
    pub(crate) model: String,
    /// The coefficient: CL, CD, Cm, CY, Cl or Cn
    #[arg(long, value_name = "COEFFICIENT", value_parser = coefficient)]
    pub(crate) coefficient: Coefficient,
    /// Candidate terms as a model file writes them, separated by commas [default: the first-order terms of the axes]
    #[arg(long, value_name = "TERMS", allow_hyphen_values = true)]
    pub(crate) candidates: Option<String>,
    /// All products of the plain candidates up to this power are candidates too [default: 2; with --candidates 1]
    #[arg(long, value_name = "POWER", allow_negative_numbers = true, value_parser = clap::value_parser!(u32).range(1..=9))]
    pub(crate) up_to: Option<u32>,
    /// What ends the selection: the smallest predicted square error (pse), the smallest mean square of residuals predicted
    /// without their own rows (press), or the partial F (f). Whichever it is, a term needs the F to remove at the end
    #[arg(long, default_value = "pse")]
    pub(crate) criterion: Criterion,
    /// Partial F, corrected for residuals that last, that a term needs to be taken in [default: the value that needless terms
    /// reach in one flight of a hundred]
    #[arg(long, value_name = "F", allow_negative_numbers = true, value_parser = positive)]
    pub(crate) f_to_enter: Option<f64>,
    /// Partial F that a term needs to stay [default: the F to enter]
    #[arg(long, value_name = "F", allow_negative_numbers = true, value_parser = positive)]
    pub(crate) f_to_remove: Option<f64>,
    /// Begin at this time of the record, for example 12s, or when its clock shows this time of day, for example 10:15:31
    #[arg(long, value_name = "TIME", allow_hyphen_values = true)]
    pub(crate) from: Option<Moment>,
    /// End at this time of the record, for example 40s or 10:15:59
    #[arg(long, value_name = "TIME", allow_hyphen_values = true)]
    pub(crate) to: Option<Moment>,
    /// Use only the manoeuvre that `phugoid inspect` lists under this number
    #[arg(long, value_name = "NUMBER", allow_negative_numbers = true, value_parser = manoeuvre, conflicts_with_all = ["from", "to"])]
    pub(crate) segment: Option<usize>,
    #[command(flatten)]
    pub(crate) reading: Reading,
    #[command(flatten)]
    pub(crate) deleting: Deleting,
    #[command(flatten)]
    pub(crate) delivery: Delivery,
}

fn coefficient(text: &str) -> Result<Coefficient, String> {
    Coefficient::from_symbol(text).ok_or_else(|| {
        let symbols: Vec<&str> = Coefficient::ALL.iter().map(|c| c.symbol()).collect();
        // `Cl` rolls and `CL` lifts: letters of the other case are no misspelling that can be guessed.
        format!("there is no coefficient `{text}`: write one of {}", symbols.join(", "))
    })
}
