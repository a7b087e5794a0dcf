//! A fair chance for the laws that have a gain: it is searched for on training flights, with a truth that is not the one
//! they are compared on.

use rayon::prelude::*;

use super::method::{Flown, Gain, Method, Normalised, Setting};
use phugoid_evaluation::accuracy::StudyError;

/// Coarse search: `10^(k/2)`.
const EXPONENTS: std::ops::RangeInclusive<i32> = -4..=12;
/// `c` of the normalised laws.
const NORMALISATIONS: [f64; 4] = [1e-4, 1e-2, 1.0, 1e2];
/// Then the gain alone by these factors, one after the other, as long as it helps.
const REFINEMENTS: [f64; 3] = [1.778_279_41, 1.333_521_43, 1.154_781_98];

/// A tuned gain with what it reached in training.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tuned {
    /// The gain with the best score on the training flights.
    pub gain: Gain,
    /// Its mean cost over the flights, s: the time to 5 %; if that is not reached the length of the record times
    /// one plus the late error as a part of the truth (at most 1).
    pub cost_s: f64,
}

/// The training flights of a comparison.
///
/// # Errors
/// [`StudyError`]: one of them cannot be flown.
pub fn training_flights(setting: &Setting<'_>) -> Result<Vec<Flown>, StudyError> {
    let seed = setting.case.scenario.seed;
    let training = &setting.case.comparison.training;
    training
        .par_iter()
        .enumerate()
        // Seeds of their own, away from those of the comparison.
        .map(|(k, truth)| setting.fly(*truth, seed.wrapping_add(0x7472_6169_6e00).wrapping_add(k as u64)))
        .collect()
}

/// Searches the gain of each method that has one for the smallest mean cost over some flights; the order is that of
/// [`Method::ALL`]. The flagship's is not used.
///
/// # Errors
/// [`StudyError`]: a law refuses its settings.
pub fn tune(setting: &Setting<'_>, flights: &[Flown]) -> Result<Vec<Tuned>, StudyError> {
    Method::ALL.par_iter().map(|method| best(setting, flights, *method)).collect()
}

fn best(setting: &Setting<'_>, flights: &[Flown], method: Method) -> Result<Tuned, StudyError> {
    let normalisations: &[f64] = match method {
        Method::Flagship => {
            return Ok(Tuned { gain: Gain { gain: f64::NAN, normalisation: f64::NAN }, cost_s: f64::NAN });
        }
        Method::ModelReference(_, Normalised::Yes) => &NORMALISATIONS,
        Method::ModelReference(_, Normalised::No) | Method::Sliding => &[f64::NAN],
    };
    let candidates: Vec<Gain> = normalisations
        .iter()
        .flat_map(|&normalisation| {
            EXPONENTS.map(move |k| Gain { gain: 10_f64.powf(0.5 * f64::from(k)), normalisation })
        })
        .collect();
    let tried: Vec<Tuned> =
        candidates.par_iter().map(|gain| attempt(setting, flights, method, *gain)).collect::<Result<_, _>>()?;
    // The first of equals: the smaller gain.
    let mut best = tried
        .into_iter()
        .reduce(|a, b| if b.cost_s < a.cost_s { b } else { a })
        .unwrap_or(Tuned { gain: Gain { gain: 1.0, normalisation: 1.0 }, cost_s: f64::INFINITY });
    for factor in REFINEMENTS {
        for factor in [factor, factor.recip()] {
            let gain = Gain { gain: best.gain.gain * factor, ..best.gain };
            let other = attempt(setting, flights, method, gain)?;
            if other.cost_s < best.cost_s {
                best = other;
            }
        }
    }
    Ok(best)
}

fn attempt(setting: &Setting<'_>, flights: &[Flown], method: Method, gain: Gain) -> Result<Tuned, StudyError> {
    let mut cost_s = 0.0;
    for flown in flights {
        let track = setting.run(flown, method, gain)?;
        let score = track.score(flown.truth, setting.case.comparison.bounds);
        let length = track.time.last().copied().unwrap_or(0.0);
        let late = (score.late_error / flown.truth.abs()).min(1.0);
        let late = if late.is_nan() { 1.0 } else { late };
        cost_s += score.converged_s.unwrap_or(length * (1.0 + late)) / flights.len() as f64;
    }
    Ok(Tuned { gain, cost_s })
}
