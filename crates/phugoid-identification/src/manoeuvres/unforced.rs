//! Finds stretches in which the aircraft moved although no surface did.

use serde::{Deserialize, Serialize};

use super::answer::{SMALLEST, spread};
use super::record::Signals;
use super::settings::Settings;

/// A stretch without input in which the aircraft moved.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Unforced {
    /// Time at which the stretch begins, s.
    pub from_s: f64,
    /// Time at which the stretch ends, s.
    pub to_s: f64,
    /// Largest rms over noise of the rates in it.
    pub signal_to_noise: f64,
    /// What it may be: after an input a free response, or turbulence; before the first one turbulence, or free motion.
    pub words: String,
}

/// Rates whose rms is this many times their noise move: noise alone has one.
const VISIBLE: f64 = 2.0;
/// Shortest stretch that is reported, s.
const SHORTEST_S: f64 = 2.0;

/// Looks for motion of the rates between the inputs (first and last motion of each manoeuvre, s).
pub(crate) fn unforced(signals: &Signals<'_>, inputs: &[(f64, f64)], settings: &Settings) -> Vec<Unforced> {
    let time = &signals.record.time;
    let (Some(&first), Some(&last)) = (time.first(), time.last()) else { return Vec::new() };
    let starts = std::iter::once((first, false)).chain(inputs.iter().map(|i| (i.1 + settings.settling_s, true)));
    let ends = inputs.iter().map(|i| i.0).chain(std::iter::once(last));
    let of = |((from_s, after_input), to_s): ((f64, bool), f64)| {
        if to_s - from_s < SHORTEST_S {
            return None;
        }
        let loud = |name: &str| {
            let sampled = signals.channel(name)?;
            let values = sampled.between(from_s, to_s);
            (values.len() > 3).then(|| spread(values) / sampled.noise.max(SMALLEST))
        };
        let signal_to_noise = ["p", "q", "r"].into_iter().filter_map(loud).fold(0.0, f64::max);
        let words = if after_input { "free response, or turbulence" } else { "turbulence, or free motion" };
        (signal_to_noise >= VISIBLE).then(|| Unforced { from_s, to_s, signal_to_noise, words: words.to_owned() })
    };
    if !signals.has_surface() {
        // Without a recorded surface every motion might be an answer to one.
        return Vec::new();
    }
    starts.zip(ends).filter_map(of).collect()
}
