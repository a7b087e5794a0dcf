//! An estimate from a corrected record, whose bounds know that the corrections are estimates themselves.

use nalgebra::DMatrix;
use phugoid_flight_data::channels;
use phugoid_flight_data::record::Record;

use super::correction::{CorrectionUncertainty, Corrections};
use super::unknowns::UNKNOWNS;
use crate::core::error::EstimateError;
use crate::core::estimation::Estimation;
use crate::core::options::{EstimateOptions, StructureSearch};
use crate::model_file::ModelFile;
use crate::pipeline::estimate::{estimate, with_offered};

/// No aeroplane has a vane or an accelerometer farther from its centre of gravity, m.
const LONGEST_M: f64 = 100.0;
/// No channel for which no search has a limit of its own is recorded later than this, or ahead by more, s.
const LONGEST_DELAY_S: f64 = 10.0;

/// Estimates the parameters of `model` from the record with the corrections taken out, and adds the errors of the
/// corrections to the bounds.
///
/// The covariance of the corrections is cut into independent parts (its Cholesky columns). For each part the record is
/// corrected by one sigma more and estimated once more, and the change of each parameter is one sigma of its error. So
/// an estimate with `k` corrected errors takes `k + 1` runs. Corrections without a covariance add nothing, and a sentence
/// of the verdict says so. `progress` is called with the fraction done, 0 to 1. Further records of the options are
/// corrected too; a record to predict is not touched.
///
/// ```
/// use phugoid_flight_data::record::Record;
/// use phugoid_identification::compatibility::{CompatibilityOptions, compatibility, estimate_corrected};
/// use phugoid_identification::estimate::EstimateOptions;
/// use phugoid_identification::model_file::ModelFile;
/// let mut flight = Record::open("examples/flight.csv")?;
/// for channel in flight.channels.iter_mut().filter(|channel| channel.name == "q") {
///     channel.values.iter_mut().for_each(|q| *q += 0.01); // rad/s
/// }
/// let found = compatibility(&flight, &CompatibilityOptions { groups: Vec::new(), ..CompatibilityOptions::default() })?;
/// let model = ModelFile::named("f16-model")?;
/// let estimation =
///     estimate_corrected(&flight, &found.corrections, &model, &EstimateOptions::default(), &mut |_| {})?;
/// let damping = estimation.parameter("dCm_q").ok_or("no such parameter")?;
/// assert!(damping.correction_std > 0.0 && damping.correction_std < damping.corrected_std_error);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`EstimateError`] of any of the runs; [`EstimateError::Model`] if the covariance is none, a correction is not a finite
/// number, a scale is -1 or less, or a channel is neither in the record nor known by that name.
pub fn estimate_corrected(
    record: &Record,
    corrections: &Corrections,
    model: &ModelFile,
    options: &EstimateOptions,
    progress: &mut dyn FnMut(f64),
) -> Result<Estimation, EstimateError> {
    let said = checked(corrections, record)?;
    let known = corrections.uncertainty.clone().unwrap_or_default();
    let parts = parts(&known)?;
    let runs = (parts.len() + 1) as f64;
    let with =
        |model: &ModelFile, corrections: &Corrections, options: EstimateOptions, progress: &mut dyn FnMut(f64)| {
            let further = options.further.iter().map(|record| corrections.apply(record)).collect();
            estimate(&corrections.apply(record), model, &EstimateOptions { further, ..options }, progress)
        };
    let mut estimation = with(model, corrections, options.clone(), &mut |done| progress(done / runs))?;
    // Terms that were taken in belong to the model from here on.
    let taken = estimation.offer.as_ref().filter(|offer| offer.taken).and_then(|offer| with_offered(model, offer));
    let model = taken.as_ref().unwrap_or(model);
    let mut changes: Vec<Vec<f64>> = Vec::with_capacity(parts.len());
    for (k, part) in parts.iter().enumerate() {
        let moved: Vec<(&str, f64)> =
            known.names.iter().zip(&known.values).zip(part).map(|((n, v), d)| (n.as_str(), v + d)).collect();
        let mut more = corrections.clone();
        more.set(&moved);
        let options = EstimateOptions { structure: StructureSearch::Never, predict: None, ..options.clone() };
        let again = with(model, &more, options, &mut |done| progress((k as f64 + 1.0 + done) / runs))?;
        let change = |name: &str, value: f64| again.parameter(name).map_or(f64::NAN, |p| p.value - value);
        changes.push(estimation.parameters.iter().map(|p| change(&p.name, p.value)).collect());
    }
    widen(&mut estimation, &changes);
    if corrections.uncertainty.is_none() && !corrections.is_empty() {
        estimation.verdict.push(
            "The corrections say nothing of their own errors: these are not in the bounds. Corrections that `phugoid \
             compatibility` writes say it."
                .to_owned(),
        );
    }
    estimation.verdict.extend(said);
    Ok(estimation)
}

/// The values that a correction of a channel can have: twice what a search for errors of sensors believes, since that has them in
/// another form. `None` for what no search looks for.
fn believable(kind: &str, channel: &str) -> Option<[f64; 2]> {
    let name = match (kind, channel) {
        ("delay", "phi" | "theta" | "psi") => "delay_attitude".to_owned(),
        _ => format!("{kind}_{channel}"),
    };
    let searched =
        UNKNOWNS.iter().find(|unknown| unknown.name == name).map(|unknown| unknown.possible.map(|limit| 2.0 * limit));
    searched.or_else(|| (kind == "delay").then_some([-LONGEST_DELAY_S, LONGEST_DELAY_S]))
}

/// Refuses corrections that cannot be meant, and says in a sentence each which of them change nothing in this record.
fn checked(corrections: &Corrections, record: &Record) -> Result<Vec<String>, EstimateError> {
    let refuse = |why: String| Err(EstimateError::Model(format!("in the corrections: {why}")));
    let mut absent = Vec::new();
    for (name, c) in &corrections.channels {
        for (key, value) in [("bias", c.bias), ("scale", c.scale), ("delay_s", c.delay_s)] {
            if !value.is_finite() {
                return refuse(format!("{key} of channel `{name}` is {value}, which is no finite number"));
            }
        }
        if c.scale <= -1.0 {
            return refuse(format!(
                "scale of channel `{name}` is {}: it is the relative error of the scale, 0.02 where a sensor shows 2 % too \
                 much, and -1 would be a sensor that shows nothing",
                c.scale
            ));
        }
        for (key, unknown, value) in
            [("bias", "bias", c.bias), ("scale", "scale", c.scale), ("delay_s", "delay", c.delay_s)]
        {
            if let Some([least, most]) =
                believable(unknown, name).filter(|[least, most]| value < *least || value > *most)
            {
                return refuse(format!(
                    "{key} of channel `{name}` is {value}, and no instrument in working order is off by that much: write a \
                     number from {least} to {most} (SI units, angles in radians), or take the channel out of the corrections"
                ));
            }
        }
        if record.channel(name).is_none() {
            if channels::by_name(name).is_none() {
                let meant = channels::nearest(name).map_or_else(String::new, |near| format!(" Is `{near}` meant?"));
                return refuse(format!(
                    "channel `{name}` is neither in the record nor a known channel.{meant} Channels in the record: {}",
                    record.channels.iter().map(|c| c.name.as_str()).collect::<Vec<_>>().join(", ")
                ));
            }
            absent.push(name.as_str());
        }
    }
    for (key, value) in corrections.places() {
        if !value.is_finite() {
            return refuse(format!("{key} is {value}, which is no finite number"));
        }
        if value.abs() > LONGEST_M {
            return refuse(format!(
                "{key} is {value} m, which is longer than any aeroplane: write the distance in metres, at most {LONGEST_M} m"
            ));
        }
    }
    let mut said = Vec::new();
    if corrections.is_empty() {
        said.push("The corrections hold no error of a sensor: the record was used as it is.".to_owned());
    }
    if !absent.is_empty() {
        said.push(format!("The corrections of {} were not used: the record has no such channel.", absent.join(", ")));
    }
    Ok(said)
}

/// Independent parts of one sigma each, in the order of the names.
fn parts(known: &CorrectionUncertainty) -> Result<Vec<Vec<f64>>, EstimateError> {
    let count = known.names.len();
    let failed = || {
        EstimateError::Model(
            "the covariance of the corrections is none: it has to be symmetric and positive, with a row, a column and a \
             value for each name"
                .to_owned(),
        )
    };
    let square = known.covariance.len() == count && known.covariance.iter().all(|row| row.len() == count);
    if !square || known.values.len() != count {
        return Err(failed());
    }
    let sigma: Vec<f64> = (0..count).map(|i| known.covariance[i][i].sqrt()).collect();
    if sigma.iter().any(|s| !(*s > 0.0 && s.is_finite())) {
        return Err(failed());
    }
    let correlation = DMatrix::from_fn(count, count, |i, j| known.covariance[i][j] / (sigma[i] * sigma[j]));
    let factor = correlation.cholesky().ok_or_else(failed)?.l();
    Ok((0..count).map(|j| (0..count).map(|i| sigma[i] * factor[(i, j)]).collect()).collect())
}

/// Adds the changes, one sigma each, to the bounds.
fn widen(estimation: &mut Estimation, changes: &[Vec<f64>]) {
    let mut most = Vec::new();
    let places: Vec<String> = estimation.parameters.iter().map(|p| p.name.clone()).collect();
    for (i, p) in estimation.parameters.iter_mut().enumerate() {
        let std = changes.iter().map(|change| change[i].powi(2)).sum::<f64>().sqrt();
        p.correction_std = std;
        if std > p.corrected_std_error && !p.nuisance {
            most.push(p.name.clone());
        }
        p.corrected_std_error = p.corrected_std_error.hypot(std);
        (p.lower, p.upper) = (p.value - p.bound(), p.value + p.bound());
    }
    for sum in &mut estimation.effective {
        let of = |name: &String| places.iter().position(|n| n == name);
        if let [Some(a), Some(b)] = sum.parts.each_ref().map(of) {
            let variance: f64 = changes.iter().map(|change| (change[a] + change[b]).powi(2)).sum();
            sum.std_error = sum.std_error.hypot(variance.sqrt());
        }
    }
    for total in &mut estimation.totals {
        if let Some(increment) = estimation.parameters.iter().find(|p| p.name == total.increment) {
            total.std_error = increment.corrected_std_error;
            total.increment_std_error = increment.corrected_std_error.hypot(total.database_std);
        }
    }
    if !most.is_empty() {
        estimation.verdict.push(format!(
            "The errors of the corrections are the larger part of the bounds of {}: calibrate the sensors, or correct by \
             more flights (`phugoid compatibility --with`).",
            most.join(", ")
        ));
    }
}
