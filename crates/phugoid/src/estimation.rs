//! Estimation of the parameters of a model from a recorded flight.

use phugoid_flight_data::record::Record;
use phugoid_identification::estimate::{self as library, EstimateOptions};
use phugoid_identification::estimation::Estimation;
use phugoid_identification::model_file::ModelFile;

use crate::Error;

/// Estimates the parameters of a model from a flight.
///
/// The default options take the estimator and the change detection that the model file names, and do not look for terms
/// that the model lacks ([`StructureSearch::Never`](crate::StructureSearch::Never)). `phugoid estimate` and Python's
/// `estimate` look for them and leave the estimates as they are ([`StructureSearch::Offer`](crate::StructureSearch::Offer)):
/// an offer is a remark beside the result ([`Estimation::offer`]). With
/// [`StructureSearch::Auto`](crate::StructureSearch::Auto) the estimates are those of the model with the missing terms,
/// which [`with_offered`](crate::with_offered) gives.
///
/// Derivatives are per radian, biases in the SI unit of their sensor; a bound is two standard errors, corrected for the
/// correlation of the residuals from sample to sample. Values that are NaN in the record count as not measured. It may
/// be called on any thread.
///
/// ```
/// use phugoid::{EstimateOptions, Method, Model, Record, estimate};
/// let record = Record::open("examples/flight.csv")?;
/// let model = Model::named("f16-model")?;
/// let result = estimate(&record, &model, &EstimateOptions { method: Some(Method::Ekf), ..Default::default() })?;
/// let cm_alpha = result.parameter("dCm_alpha").expect("the model has it");
/// assert!((cm_alpha.value + 0.2).abs() < 2.0 * cm_alpha.bound() && cm_alpha.bound() < 0.01); // the truth is -0.2
/// # Ok::<(), phugoid::Error>(())
/// ```
///
/// # Errors
/// [`Error::Estimate`]: a channel that the model needs is not in the record, too few samples, units that are certainly wrong,
/// more parameters than there is room for, or a batch method without a solution.
pub fn estimate(record: &Record, model: &ModelFile, options: &EstimateOptions) -> Result<Estimation, Error> {
    estimate_with_progress(record, model, options, &mut |_| {})
}

/// As [`estimate`]; `progress` is called on the caller's thread with the fraction done, from 0 to 1.
///
/// ```
/// use phugoid::{EstimateOptions, Model, Record, estimate_with_progress};
/// let (record, model) = (Record::open("examples/flight.csv")?, Model::named("f16-model")?);
/// let mut last = 0.0;
/// estimate_with_progress(&record, &model, &EstimateOptions::default(), &mut |done| last = done)?;
/// assert_eq!(last, 1.0);
/// # Ok::<(), phugoid::Error>(())
/// ```
///
/// # Errors
/// As [`estimate`].
pub fn estimate_with_progress(
    record: &Record,
    model: &ModelFile,
    options: &EstimateOptions,
    progress: &mut dyn FnMut(f64),
) -> Result<Estimation, Error> {
    Ok(library::estimate(record, model, options, progress)?)
}
