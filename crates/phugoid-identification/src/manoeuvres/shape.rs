//! The shape of an input, from the times between its changes of sign and from how flat it is in between.

use phugoid_flight_data::statistics::{Rank, quantile};
use serde::{Deserialize, Serialize};

/// Shapes of inputs, told apart by the times between their changes of sign and by how flat they are.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Kind {
    /// The surface moves away and does not come back.
    Step,
    /// The surface moves to one side and comes back.
    Pulse,
    /// The surface moves to one side, for the same time to the other side, and back.
    Doublet,
    /// Steps of alternating sign, three, two, one and one units long.
    #[serde(rename = "3-2-1-1")]
    ThreeTwoOneOne,
    /// Several steps one after the other that are not a 3-2-1-1.
    MultiStep,
    /// An oscillation of one frequency.
    Sine,
    /// An oscillation of steadily rising or falling frequency.
    Sweep,
    /// Anything else: a multisine, a pilot's stick, a control loop at work.
    Other,
}

impl Kind {
    /// The shape in words, as reports show it.
    pub fn words(self) -> &'static str {
        match self {
            Self::Step => "step",
            Self::Pulse => "pulse",
            Self::Doublet => "doublet",
            Self::ThreeTwoOneOne => "3-2-1-1",
            Self::MultiStep => "multi-step",
            Self::Sine => "sine",
            Self::Sweep => "sweep",
            Self::Other => "other input (multisine, pilot or control loop)",
        }
    }
}

/// Below this part of the largest departure a surface counts as back where it was; above it, as held.
pub(crate) const BACK: f64 = 0.35;
/// A run is a step where eight tenths of the values between its edges are within this part of its level. A half period of
/// a sine, cut at [`BACK`], has twice as much.
const FLAT: f64 = 0.25;
/// Least part of the time that steps make up in an input of steps.
const MOSTLY: f64 = 0.6;

/// More steps than this count as the work of a pilot and not as a multi-step.
const MOST_STEPS: usize = 8;

/// A stretch on one side of the level before.
struct Run {
    positive: bool,
    from_s: f64,
    to_s: f64,
    values: Vec<f64>,
}

impl Run {
    fn seconds(&self) -> f64 {
        self.to_s - self.from_s
    }

    /// Whether it keeps one level between its edges.
    fn is_flat(&self) -> bool {
        let of = |part: f64| (part * self.values.len() as f64) as usize;
        let mut inside = self.values[of(0.2)..of(0.85).max(of(0.2) + 1).min(self.values.len())].to_vec();
        let mut at = |share: f64| quantile(&mut inside, share, Rank::Lower).unwrap_or(f64::NAN);
        let (low, level, high) = (at(0.1), at(0.5), at(0.9));
        high - low <= FLAT * level.abs()
    }
}

/// Whether the runs are steps: those that keep a level make up most of their time.
fn are_flat(runs: &[Run]) -> bool {
    let seconds = |flat: bool| runs.iter().filter(|run| !flat || run.is_flat()).map(Run::seconds).sum::<f64>();
    seconds(true) >= MOSTLY * seconds(false)
}

/// The kind of an input, given as departures from the level before it; the last second is that after it.
pub(crate) fn kind(time: &[f64], departures: &[f64]) -> Kind {
    let runs = runs(time, departures);
    let last = departures.last().copied().unwrap_or(0.0);
    let peak = departures.iter().fold(0.0, |most: f64, d| most.max(d.abs()));
    let seconds: Vec<f64> = runs.iter().map(Run::seconds).collect();
    let alternating = runs.windows(2).all(|pair| pair[0].positive != pair[1].positive);
    let flat = are_flat(&runs);
    match seconds.as_slice() {
        [] => Kind::Other,
        [_] if last.abs() > BACK * peak => Kind::Step,
        [_] => Kind::Pulse,
        [a, b] if alternating && (0.55..1.8).contains(&(a / b)) => Kind::Doublet,
        [_, _] => Kind::MultiStep,
        four @ [_, _, _, _] if alternating && is_3211(four) => Kind::ThreeTwoOneOne,
        [_, _, _] | [_, _, _, _] => {
            if flat {
                Kind::MultiStep
            } else {
                Kind::Other
            }
        }
        many if alternating => {
            periodic(many).unwrap_or(if flat && many.len() <= MOST_STEPS { Kind::MultiStep } else { Kind::Other })
        }
        many if flat && many.len() <= MOST_STEPS => Kind::MultiStep,
        _ => Kind::Other,
    }
}

fn is_3211(seconds: &[f64]) -> bool {
    let unit = seconds.iter().sum::<f64>() / 7.0;
    [3.0, 2.0, 1.0, 1.0]
        .iter()
        .zip(seconds)
        .all(|(units, s)| (s / unit - units).abs() < 0.4 * f64::max(1.0, 0.5 * units))
}

/// When a 3-2-1-1 is over, s, that begins an input of something else: its four runs are steps, and what follows is another
/// 3-2-1-1, or does not go on with steps one after the other.
pub(crate) fn end_of_3211(time: &[f64], departures: &[f64]) -> Option<f64> {
    let runs = runs(time, departures);
    let (first, rest) = runs.split_at_checked(4).filter(|(_, rest)| !rest.is_empty())?;
    let is_one = |runs: &[Run]| {
        let seconds: Vec<f64> = runs.iter().map(Run::seconds).collect();
        runs.iter().all(Run::is_flat)
            && runs.windows(2).all(|pair| pair[0].positive != pair[1].positive)
            && is_3211(&seconds)
    };
    let unit = first.iter().map(Run::seconds).sum::<f64>() / 7.0;
    let goes_on = runs[3..].windows(2).all(|pair| pair[1].is_flat() && pair[1].from_s - pair[0].to_s < 0.5 * unit);
    let another = rest.len() == 4 && is_one(rest);
    (is_one(first) && (another || !goes_on)).then_some(first[3].to_s)
}

/// A sine or a sweep, by the lengths of half periods. The first and the last may be cut.
fn periodic(seconds: &[f64]) -> Option<Kind> {
    let inner = seconds.get(1..seconds.len() - 1)?;
    let mean = inner.iter().sum::<f64>() / inner.len() as f64;
    let spread = (inner.iter().map(|s| (s - mean).powi(2)).sum::<f64>() / inner.len() as f64).sqrt();
    if inner.len() >= 3 && spread < 0.15 * mean {
        return Some(Kind::Sine);
    }
    let (low, high) = inner.iter().fold((f64::INFINITY, 0.0_f64), |(l, h), s| (l.min(*s), h.max(*s)));
    let pairs = |falls: bool| {
        let ordered = |pair: &&[f64]| if falls { pair[1] <= 1.1 * pair[0] } else { pair[1] >= 0.9 * pair[0] };
        inner.windows(2).filter(ordered).count() as f64 / (inner.len() - 1).max(1) as f64
    };
    let halves = inner.split_at(inner.len() / 2);
    let mean_of = |part: &[f64]| part.iter().sum::<f64>() / part.len().max(1) as f64;
    let trend = mean_of(halves.0) / mean_of(halves.1);
    let runs_one_way = (trend > 1.3 && pairs(true) >= 0.9) || (trend < 1.0 / 1.3 && pairs(false) >= 0.9);
    (inner.len() >= 4 && high > 1.8 * low && runs_one_way).then_some(Kind::Sweep)
}

fn runs(time: &[f64], departures: &[f64]) -> Vec<Run> {
    let peak = departures.iter().fold(0.0, |most: f64, d| most.max(d.abs()));
    let mut runs: Vec<Run> = Vec::new();
    let mut open = false;
    for (&t, &d) in time.iter().zip(departures) {
        let away = d.abs() > BACK * peak;
        match runs.last_mut() {
            Some(run) if open => {
                // It lasts until the sample at which it is over: a held position lasts as long.
                run.to_s = t;
                if away && run.positive == (d > 0.0) {
                    run.values.push(d);
                    continue;
                }
                open = false;
            }
            _ => {}
        }
        if away {
            runs.push(Run { positive: d > 0.0, from_s: t, to_s: t, values: vec![d] });
            open = true;
        }
    }
    // A run of less than a tenth of the longest is an overshoot and not a step.
    let longest = runs.iter().map(Run::seconds).fold(0.0, f64::max);
    runs.retain(|run| run.values.len() > 1 && run.seconds() > 0.05 * longest);
    runs
}

/// Frequency with most power per octave, Hz, of departures that began `seconds` before they ended.
pub(crate) fn frequency(time: &[f64], departures: &[f64], seconds: f64) -> Option<f64> {
    let (first, last) = (time.first()?, time.last()?);
    let step = (last - first) / (time.len().max(2) - 1) as f64;
    if seconds.is_nan() || seconds <= 0.0 || step <= 0.0 {
        return None;
    }
    // At most two thousand samples: frequencies above those are not looked for.
    let stride = time.len().div_ceil(2000);
    let (low, high) = (0.25 / seconds, 0.25 / (step * stride as f64));
    let octaves = (high / low).log2();
    if octaves.is_nan() || octaves <= 0.0 {
        return None;
    }
    let count = (8.0 * octaves).ceil().min(120.0) as usize;
    let power = |f: f64| {
        let (mut re, mut im) = (0.0, 0.0);
        for (t, d) in time.iter().zip(departures).step_by(stride) {
            let (sin, cos) = (std::f64::consts::TAU * f * (t - first)).sin_cos();
            re += d * cos;
            im += d * sin;
        }
        f * (re * re + im * im)
    };
    let at = |i: usize| low * (high / low).powf(i as f64 / count as f64);
    (0..=count).map(|i| (at(i), power(at(i)))).max_by(|a, b| a.1.total_cmp(&b.1)).map(|best| best.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    fn of(seconds: f64, shape: impl Fn(f64) -> f64) -> Kind {
        let time: Vec<f64> = (0..(seconds / 0.02) as usize).map(|k| 0.02 * k as f64).collect();
        let departures: Vec<f64> = time.iter().map(|t| shape(*t)).collect();
        kind(&time, &departures)
    }

    fn steps(t: f64, steps: &[(f64, f64)]) -> f64 {
        let mut end = 0.0;
        for (seconds, value) in steps {
            end += seconds;
            if t < end - 1e-9 {
                return *value;
            }
        }
        0.0
    }

    #[test]
    fn every_kind_is_told_apart() {
        for (expected, list, seconds) in [
            (Kind::Pulse, &[(1.0, 2.0)][..], 3.0),
            (Kind::Step, &[(9.0, 2.0)], 3.0),
            (Kind::Doublet, &[(1.0, 2.0), (1.0, -2.0)], 4.0),
            (Kind::Doublet, &[(1.0, 2.0), (1.3, -1.6)], 4.0),
            (Kind::ThreeTwoOneOne, &[(2.1, 1.0), (1.4, -1.0), (0.7, 1.0), (0.7, -1.0)], 8.0),
            // As the HFB-320 was flown.
            (Kind::ThreeTwoOneOne, &[(3.0, 0.0115), (2.2, -0.0115), (1.1, 0.0105), (0.9, -0.009)], 9.0),
            (Kind::MultiStep, &[(1.0, 1.0), (2.0, -1.0), (1.0, 1.0)], 6.0),
            (Kind::MultiStep, &[(2.0, 1.0), (1.0, -1.0), (1.0, 1.0)], 6.0),
        ] {
            assert_eq!(of(seconds, |t| steps(t, list)), expected, "{list:?}");
        }
        assert_eq!(of(20.0, |t| if t < 18.0 { (TAU * 0.5 * t).sin() } else { 0.0 }), Kind::Sine);
        // 0.2 to 2 Hz in 20 s.
        assert_eq!(of(21.0, |t| if t < 20.0 { (TAU * (0.2 * t + 0.045 * t * t)).sin() } else { 0.0 }), Kind::Sweep);
        let multisine = |t: f64| (1..9).map(|k| (TAU * 0.1 * f64::from(k) * t + 0.7 * f64::from(k * k)).cos()).sum();
        assert_eq!(of(20.0, multisine), Kind::Other);
    }

    #[test]
    fn the_frequency_of_a_sine_is_found() {
        let time: Vec<f64> = (0..1000).map(|k| 0.02 * f64::from(k)).collect();
        let departures: Vec<f64> = time.iter().map(|t| (TAU * 0.7 * t).sin()).collect();
        let found = frequency(&time, &departures, 20.0).unwrap();
        // Eight places per octave: within 5 %.
        assert!((found / 0.7 - 1.0).abs() < 0.05, "{found}");
    }
}
