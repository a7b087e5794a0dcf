//! What is settled of a record before a method takes it: whether its units can be right, and the noise of each output.

use phugoid_flight_data::plausibility::{self, Certainty, Doubt};
use phugoid_flight_data::record::Record;

use super::noise::{NoiseLevel, OwnSamples, measure_noise};
use super::prepared::{FEWEST_SAMPLES, Prepared};
use crate::core::error::EstimateError;
use crate::model_file::ModelFile;
use crate::motion::Motion;

/// What is doubtful about the units of the channels that the model uses.
///
/// # Errors
/// [`EstimateError::Units`] if one of them is certainly wrong.
pub(crate) fn doubts(record: &Record, model: &ModelFile) -> Result<Vec<Doubt>, EstimateError> {
    let used = model.channels_used();
    doubts_of(record, &|name| used.contains(&name))
}

/// What is doubtful about the units of the channels that are used.
///
/// # Errors
/// [`EstimateError::Units`] if one of them is certainly wrong.
pub(crate) fn doubts_of(record: &Record, is_used: &dyn Fn(&str) -> bool) -> Result<Vec<Doubt>, EstimateError> {
    let is_used = |name: &String| is_always_used(name) || is_used(name);
    let concerned = concerning(record, &is_used);
    // Where two contradict one another and one of them is not used, the other may well be right.
    let (refused, doubts): (Vec<Doubt>, Vec<Doubt>) =
        concerned.partition(|doubt| doubt.certainty == Certainty::Certain && doubt.channels.iter().all(is_used));
    if !refused.is_empty() {
        return Err(EstimateError::Units { units: refused.iter().map(Doubt::to_string).collect() });
    }
    Ok(doubts)
}

/// What is doubtful about the channels that the model uses, the certainly wrong ones among it.
pub(crate) fn all_doubts(record: &Record, model: &ModelFile) -> Vec<Doubt> {
    let used = model.channels_used();
    concerning(record, &|name| is_always_used(name) || used.contains(&name.as_str())).collect()
}

/// What is doubtful about a channel that is used.
fn concerning<'a>(record: &Record, is_used: &'a dyn Fn(&String) -> bool) -> impl Iterator<Item = Doubt> + use<'a> {
    plausibility::check(record).into_iter().filter(move |doubt| doubt.channels.iter().any(is_used))
}

fn is_always_used(name: &str) -> bool {
    name == "time"
}

/// One sigma of the noise per output: the model file's, else measured from the beginning of the record; of an
/// instrument that is slower than the record, from its own samples; of one whose steps are larger than its noise, from
/// these steps.
///
/// # Errors
/// [`EstimateError::Noise`] if it cannot be measured.
pub(crate) fn noise_levels<M: Motion<N, R>, const N: usize, const R: usize>(
    prepared: &Prepared<M, N, R>,
    model: &ModelFile,
) -> Result<[NoiseLevel; R], EstimateError> {
    let length = prepared.noise_samples();
    let mut levels = [NoiseLevel::NONE; R];
    for (row, output) in M::AXES.outputs().iter().enumerate().filter(|(_, o)| model.outputs[o.index()]) {
        let values: Vec<f64> = prepared.outputs.iter().map(|y| y[row]).collect();
        let found = match OwnSamples::of(&values) {
            // Of a slow instrument the first two seconds hold next to nothing: as many samples as of a fast one at least.
            Some(own) => own.noise(&values, FEWEST_SAMPLES.max(own.up_to(length))),
            None => measure_noise(&values[..length]),
        };
        let white = found.map_or(0.0, |found| found.std);
        levels[row] = match model.noise[output.index()] {
            Some(std) => NoiseLevel { std, measured: false, white },
            // A coarse recorder shows one value until the aircraft moves: its steps are seen in the whole record.
            None => match found.or_else(|| measure_noise(&values)) {
                Some(found) => NoiseLevel { std: found.std, measured: true, white: found.std },
                None => return Err(EstimateError::Noise(output.name().to_owned())),
            },
        };
    }
    Ok(levels)
}
