//! How strongly the aircraft answered an input: the motion of its rates and angles against their noise.

use serde::{Deserialize, Serialize};

use super::record::Signals;
use crate::core::axes::Group;

/// How strongly one channel answered.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Response {
    /// Canonical name of the channel, e.g. `q`.
    pub channel: String,
    /// Root mean square about its mean from the onset of the input to the end of the segment, SI.
    pub rms: f64,
    /// One sigma of its noise, SI, measured over the record.
    pub noise: f64,
    /// [`rms`](Self::rms) over [`noise`](Self::noise), with the noise taken as at least 1e-4 rad or rad/s.
    pub signal_to_noise: f64,
}

/// Rates (rad/s) and angles (rad) below this are rounding, whatever the noise of a simulation's channel.
pub(crate) const SMALLEST: f64 = 1e-4;

/// Rates and angles that a group of surfaces moves.
pub(crate) fn channels(group: Group) -> &'static [&'static str] {
    match group {
        Group::Longitudinal => &["q", "alpha", "theta"],
        Group::Lateral => &["p", "r", "beta", "phi"],
    }
}

/// The answers of the rates and angles that were recorded.
pub(crate) fn responses(signals: &Signals<'_>, group: Group, onset_s: f64, to_s: f64) -> Vec<Response> {
    let of = |name: &&str| {
        let sampled = signals.channel(name)?;
        let values = sampled.between(onset_s, to_s);
        if values.len() < 4 {
            return None;
        }
        let rms = spread(values);
        let signal_to_noise = rms / sampled.noise.max(SMALLEST);
        Some(Response { channel: (*name).to_owned(), rms, noise: sampled.noise, signal_to_noise })
    };
    channels(group).iter().filter_map(of).collect()
}

/// Root mean square about the mean.
pub(crate) fn spread(values: &[f64]) -> f64 {
    let n = values.len().max(1) as f64;
    let mean = values.iter().sum::<f64>() / n;
    (values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / n).sqrt()
}
