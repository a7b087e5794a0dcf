//! Checks of a record before an estimation: its contents, and whether its sensors agree with each other.

use phugoid_flight_data::record::Record;
use phugoid_identification::compatibility::{self as library, Compatibility, CompatibilityOptions};
use phugoid_identification::inspect::{Inspection, inspect as inspection, model_support};
use phugoid_identification::manoeuvres::Settings;
use phugoid_identification::model_file::ModelFile;

use crate::Error;

/// Lists what a flight contains: channels with their rates, gaps and noise, doubtful units and signs, manoeuvres, and
/// which derivatives can be estimated from them.
///
/// With a model, [`Inspection::support`] gives the bound that the flight could reach for each of its parameters
/// (Cramer-Rao); without one, [`Inspection::models`] says what the record lacks for every model that is built in.
/// Values are in SI units.
///
/// ```
/// use phugoid::{Model, Record, inspect};
/// let record = Record::open("examples/flight.csv")?;
/// let found = inspect(&record, Some(&Model::named("f16-model")?));
/// assert_eq!(found.found.manoeuvres[0].number, 1);
/// let support = found.support.expect("a model was given");
/// let (_, cm_alpha) = support.best("dCm_alpha").expect("the manoeuvre moves the aircraft");
/// assert!(cm_alpha.at_best < 0.01); // two standard errors as a part of the value
/// # Ok::<(), phugoid::Error>(())
/// ```
pub fn inspect(record: &Record, model: Option<&ModelFile>) -> Inspection {
    let settings = Settings::default();
    let Some(model) = model else {
        let built_in = ModelFile::BUILT_IN.iter().filter_map(|(name, text)| ModelFile::parse(name, text).ok());
        return inspection(record, &built_in.collect::<Vec<_>>(), &settings);
    };
    let mut found = inspection(record, std::slice::from_ref(model), &settings);
    found.support = Some(model_support(record, &found.found, model));
    found
}

/// Checks whether the sensors of a flight agree with the kinematics of a rigid body, and estimates their errors:
/// biases, scale factors, delays, each with its standard error, without any aerodynamics (Klein and Morelli, *Aircraft
/// System Identification*, chapter 10).
///
/// It needs the channels `true_airspeed`, `theta`, `q`, `ax` and `az`, and also uses `alpha` and the lateral channels
/// if the record has them. [`Compatibility::corrections`] removes the errors that are offered as corrections from a record.
///
/// ```
/// use phugoid::{CompatibilityOptions, Record, compatibility};
/// let record = Record::open("examples/flight.csv")?;
/// let found = compatibility(&record, &CompatibilityOptions::default())?;
/// let bias = found.error("bias_q").expect("the record has q"); // rad/s
/// assert!(bias.value.abs() < 3.0 * bias.std_error && bias.std_error < 1e-3);
/// let corrected = found.corrections.apply(&record);
/// assert_eq!(corrected.len(), record.len());
/// # Ok::<(), phugoid::Error>(())
/// ```
///
/// # Errors
/// [`Error::Estimate`]: a missing channel, too few samples, or unknowns that cannot be told apart.
pub fn compatibility(record: &Record, options: &CompatibilityOptions) -> Result<Compatibility, Error> {
    Ok(library::compatibility(record, options)?)
}
