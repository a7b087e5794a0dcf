//! The time at which a failure began, from the likelihood of the innovations as a function of the onset.

use crate::bounded::at;

use super::starts::{STARTS, Starts};

/// The time of a change with its uncertainty, s.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Onset {
    /// Half of the likelihood lies before it.
    pub time_s: f64,
    /// 95 % of the likelihood lies between these, the gaps between the onsets looked for included.
    pub interval_s: [f64; 2],
    /// The interval reaches back to the oldest onset that was looked for: it may have begun earlier.
    pub or_earlier: bool,
}

/// The likelihood over the onset, normalised (a flat prior): median and the central 95 %. Each hypothesis' likelihood
/// is that of the whole flight, healthy until then and the size of the failure integrated out, flattened by the misfit
/// of the best one (a failure that is too large to be linear, or coloured noise, explains the innovations less well
/// than it should); between two hypotheses its logarithm is a straight line. A failure that began between two
/// hypotheses is explained by one of them only, and not always by the closer one: the interval reaches to the ends of
/// the gaps in which its quantiles lie. None without two hypotheses with finite likelihoods.
pub(super) fn onset<const N: usize, const P: usize>(starts: &Starts<N, P>) -> Option<Onset> {
    let mut time = [0.0; STARTS];
    let mut log = [0.0; STARTS];
    let mut count = 0;
    let mut largest = f64::NEG_INFINITY;
    let mut misfit = 1.0;
    for start in starts.iter() {
        let value = starts.whole(start);
        if value.is_finite() && count < STARTS {
            time[count] = start.time_s;
            log[count] = value;
            if value > largest {
                largest = value;
                misfit = starts.misfit(start).max(1.0);
            }
            count += 1;
        }
    }
    let count = count.min(STARTS);
    if count < 2 || !misfit.is_finite() {
        return None;
    }
    for log in &mut log[..count] {
        *log = (*log - largest) / misfit;
    }
    // Area below the exponential between neighbours.
    let mut total = 0.0;
    let mut cumulated = [0.0; STARTS];
    for k in 1..count {
        let (a, b) = (libm::exp(log[k - 1]), libm::exp(log[k]));
        let slope = log[k] - log[k - 1];
        let mean = if slope.abs() > 1e-6 { (b - a) / slope } else { 0.5 * (a + b) };
        total += mean * (time[k] - time[k - 1]);
        cumulated[k] = total;
    }
    if !(total > 0.0 && total.is_finite()) {
        return None;
    }
    let quantile = |fraction: f64| {
        let wanted = fraction * total;
        let k = (1..count - 1).find(|k| at(&cumulated, *k) >= wanted).unwrap_or(count - 1);
        let (a, slope) = (libm::exp(at(&log, k - 1)), at(&log, k) - at(&log, k - 1));
        let width = at(&time, k) - at(&time, k - 1);
        let part = (wanted - at(&cumulated, k - 1)) / width;
        // a (exp(slope u) - 1)/slope = part
        let u = if slope.abs() > 1e-6 { libm::log1p((part * slope / a).max(-1.0)) / slope } else { part / a };
        (k, at(&time, k - 1) + width * if u.is_finite() { u.clamp(0.0, 1.0) } else { 1.0 })
    };
    let interval_s = [at(&time, quantile(0.025).0 - 1), at(&time, quantile(0.975).0)];
    // The first hypothesis stands for all that came before it.
    let or_earlier = libm::exp(log[0]) * (time[1] - time[0]) > 0.025 * total;
    Some(Onset { time_s: quantile(0.5).1, interval_s, or_earlier })
}
