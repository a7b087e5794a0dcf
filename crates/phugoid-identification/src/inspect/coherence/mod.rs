//! Spectral coherence of the surfaces that were moved and the outputs of the aircraft.
//!
//! The magnitude-squared coherence `|S_uy|^2 / (S_uu S_yy)` is the part of the spectrum of an output that is linear in an
//! input, from 0 to 1. It says in which band a record holds what an identification needs, before there is a model. Below 1
//! are noise, turbulence, motions that other inputs cause, and what is not linear (J. S. Bendat, A. G. Piersol, *Random
//! Data*, 4th ed., Wiley 2010, chapters 6 and 7).
//!
//! Where several surfaces move together the ordinary coherence misleads: a surface that does nothing is coherent with an
//! output because it moves with one that does something. Then the *partial* coherence counts: that of what is left of
//! both after the linear effect of the other surfaces is taken out (chapter 7.3 there).
//!
//! Spectra are averaged over sine tapers ([`multitaper`]) and over the manoeuvres in which the surface was moved. For given
//! inputs the probability that noise exceeds a value is exact where the noise of the output is normal and its spectrum
//! flat within the bandwidth, whatever the input is.
//!
//! What no coherence can tell: cause from effect. With a control loop that moves a surface by what a gyroscope measures,
//! the two are coherent without the aircraft's answer.

mod multitaper;

use phugoid_flight_data::record::Record;
use phugoid_flight_data::statistics::median_step;
use serde::{Deserialize, Serialize};

use crate::core::output::Output;
use crate::manoeuvres::Found;
use crate::preparation::resample::at_times;
use multitaper::{CrossSpectra, chance, level, tapers};

/// Highest frequency that is looked at, Hz: above the motions of an aircraft as a rigid body.
const HIGHEST_HZ: f64 = 10.0;
/// Steps of the signals in one period of that frequency.
const STEPS: f64 = 2.5;
/// Narrowest bandwidth, Hz, and the factor by which a wider one is tried.
const NARROWEST_HZ: f64 = 0.1;
const WIDER: f64 = 1.05;
/// Averages that are wanted beyond the number of inputs, and the fewest that are taken.
const WANTED: usize = 6;
const FEWEST: usize = 3;
/// Longest stretch that is transformed at once, s, and the time after which there are averages enough: the work goes with
/// the square of the one and with the other.
const LONGEST_S: f64 = 40.0;
const MOST_S: f64 = 600.0;
/// A channel has a gap where it has no value for more than so many of its own steps.
const GAP: f64 = 3.5;
/// Probability with which noise alone exceeds the level at one frequency.
const LEVEL: f64 = 0.05;

/// Coherence of one surface that was moved and one output.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Coherence {
    /// Channel of the surface.
    pub input: String,
    /// Channel of the output.
    pub output: String,
    /// Other surfaces that moved in the same manoeuvres, and whose linear effect is taken out in [`partial`](Self::partial).
    pub given: Vec<String>,
    /// Stretches that were used: first and last time, s. They end at gaps of a channel.
    pub stretches_s: Vec<[f64; 2]>,
    /// Number of independent complex averages of the spectra (tapers of all stretches); twice as many degrees of freedom.
    pub averages: usize,
    /// Width of the band over which a spectrum is averaged, Hz. Narrower features are not resolved.
    pub bandwidth_hz: f64,
    /// Frequencies of the values, Hz, half a bandwidth apart; from half a bandwidth to at most 10 Hz.
    pub frequencies_hz: Vec<f64>,
    /// Ordinary coherence of the two channels; `None` if there is none, for the [`reason`](Self::reason).
    pub ordinary: Option<CoherenceCurve>,
    /// Coherence of what is left of both after the linear effect of the other surfaces is taken out; `None` where no other
    /// surface moved, or where it moved so much alike that nothing is left.
    pub partial: Option<CoherenceCurve>,
    /// Part of the output's spectrum that is linear in all of these surfaces together; `None` where no other moved.
    pub multiple: Option<CoherenceCurve>,
    /// Why there is no coherence, or no partial one, and what to do; empty if there is what is wanted.
    pub reason: String,
}

/// A magnitude-squared coherence over frequency, with its level of significance.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CoherenceCurve {
    /// Estimates, 0 to 1, one for each of [`Coherence::frequencies_hz`]. They are too large on average by about
    /// `(1 - coherence)^2 / averages`.
    pub values: Vec<f64>,
    /// Level that noise alone exceeds at one frequency in twenty.
    pub level: f64,
    /// Bands above the level: first and last frequency, Hz. One frequency in twenty of an incoherent pair is above it.
    pub bands_hz: Vec<[f64; 2]>,
    /// The largest value.
    pub peak: f64,
    /// Frequency of the largest value, Hz.
    pub peak_hz: f64,
    /// Upper bound of the probability that noise alone has so large a value at any of the frequencies.
    pub chance: f64,
}

impl CoherenceCurve {
    /// Whether noise alone would have such a peak in less than one record of twenty.
    pub fn is_significant(&self) -> bool {
        self.chance < LEVEL
    }

    fn of(values: Vec<f64>, frequencies_hz: &[f64], inputs: usize, averages: usize) -> Option<Self> {
        let level = level(LEVEL, inputs, averages);
        let (at, peak) = values.iter().copied().enumerate().max_by(|a, b| a.1.total_cmp(&b.1))?;
        let mut bands: Vec<[f64; 2]> = Vec::new();
        let mut inside = false;
        for (value, frequency) in values.iter().zip(frequencies_hz) {
            let above = *value > level;
            match bands.last_mut().filter(|_| above && inside) {
                Some(band) => band[1] = *frequency,
                None if above => bands.push([*frequency, *frequency]),
                None => {}
            }
            inside = above;
        }
        let chance = (chance(peak, inputs, averages) * values.len() as f64).min(1.0);
        Some(Self { level, bands_hz: bands, peak, peak_hz: *frequencies_hz.get(at)?, chance, values })
    }
}

impl Coherence {
    /// The curve that counts: the partial one where other surfaces moved too, else the ordinary one. `None` if it could not
    /// be computed.
    pub fn decisive(&self) -> Option<&CoherenceCurve> {
        if self.given.is_empty() { self.ordinary.as_ref() } else { self.partial.as_ref() }
    }
}

/// The coherence of every surface that the manoeuvres of a record moved and every output that was recorded, surfaces and
/// outputs in the order of [`crate::axes::Axes::SURFACES`] and [`Output::ALL`].
///
/// For each surface the useful manoeuvres that move it are taken, or all that do where none is useful. Channels are
/// brought to the step of the slowest one, or to 0.04 s: means where they are faster, straight lines between samples
/// where they are slower. Missing values (NaN) are bridged up to 3.5 steps of their channel; at longer gaps a stretch
/// ends. The bandwidth is the narrowest, from 0.1 Hz, with six averages more than there are inputs; where three cannot be
/// had, [`Coherence::reason`] says so. Of manoeuvres that last longer than ten minutes together the first ten are taken.
///
/// ```
/// use phugoid_flight_data::record::Record;
/// use phugoid_identification::inspect::coherence;
/// use phugoid_identification::manoeuvres::{Settings, find};
/// let flight = Record::open("examples/flight.csv")?;
/// let found = coherence(&flight, &find(&flight, &Settings::default()));
/// let pitch = found.iter().find(|c| c.input == "elevator" && c.output == "q").ok_or("no pitch rate")?;
/// let curve = pitch.decisive().ok_or("too short")?;
/// assert!(curve.is_significant() && curve.peak > 0.9);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn coherence(record: &Record, found: &Found) -> Vec<Coherence> {
    let mut all = Vec::new();
    for input in crate::core::axes::Axes::SURFACES {
        let moving = |useful: bool| {
            found
                .manoeuvres
                .iter()
                .filter(|m| (m.useful || !useful) && m.inputs.iter().any(|i| i.surface == input))
                .collect::<Vec<_>>()
        };
        let manoeuvres = match moving(true) {
            useful if useful.is_empty() => moving(false),
            useful => useful,
        };
        if manoeuvres.is_empty() {
            continue;
        }
        let moved = |surface: &str| manoeuvres.iter().any(|m| m.inputs.iter().any(|i| i.surface == surface));
        let given: Vec<&str> =
            crate::core::axes::Axes::SURFACES.into_iter().filter(|s| *s != input && moved(s)).collect();
        let spans: Vec<[f64; 2]> = manoeuvres.iter().map(|m| [m.from_s, m.to_s]).collect();
        let outputs = Output::NAMES.into_iter().filter(|name| record.channel(name).is_some());
        all.extend(outputs.map(|output| pair(record, input, output, &given, &spans)));
    }
    all
}

/// The finite values of a channel, with its own median step.
struct Own {
    time: Vec<f64>,
    values: Vec<f64>,
    step_s: f64,
}

fn own(record: &Record, name: &str) -> Option<Own> {
    let channel = record.channel(name)?;
    let (time, values): (Vec<f64>, Vec<f64>) =
        record.time.iter().zip(&channel.values).filter(|(_, v)| v.is_finite()).map(|(t, v)| (*t, *v)).unzip();
    let step_s = median_step(&time).filter(|step| *step > 0.0)?;
    Some(Own { time, values, step_s })
}

fn pair(record: &Record, input: &str, output: &str, given: &[&str], spans: &[[f64; 2]]) -> Coherence {
    let mut result = Coherence {
        input: input.to_owned(),
        output: output.to_owned(),
        given: given.iter().map(|name| (*name).to_owned()).collect(),
        stretches_s: Vec::new(),
        averages: 0,
        bandwidth_hz: 0.0,
        frequencies_hz: Vec::new(),
        ordinary: None,
        partial: None,
        multiple: None,
        reason: String::new(),
    };
    let names: Vec<&str> = [input].into_iter().chain(given.iter().copied()).chain([output]).collect();
    let mut channels = Vec::with_capacity(names.len());
    for name in &names {
        match own(record, name) {
            Some(channel) => channels.push(channel),
            None => {
                result.reason = format!("{name} has fewer than two values");
                return result;
            }
        }
    }
    let slowest = channels.iter().map(|c| c.step_s).fold(0.0, f64::max);
    let step_s = slowest.max(1.0 / (STEPS * HIGHEST_HZ));
    let stretches = stretches(&channels, spans, step_s);
    let inputs = names.len() - 1;
    let highest_hz = HIGHEST_HZ.min(0.5 / step_s);
    let averages =
        |bandwidth: f64| stretches.iter().map(|s| tapers(s.signals[0].len(), step_s, bandwidth)).sum::<usize>();
    let mut bandwidth = NARROWEST_HZ;
    while averages(bandwidth) < inputs + WANTED && bandwidth * WIDER < highest_hz / 3.0 {
        bandwidth *= WIDER;
    }
    let mut used = stretches.iter().filter(|s| tapers(s.signals[0].len(), step_s, bandwidth) > 0).peekable();
    if averages(bandwidth) < inputs + FEWEST || used.peek().is_none() {
        let seconds: f64 = stretches.iter().map(|s| s.signals[0].len() as f64 * step_s).sum();
        result.reason = format!(
            "too short: {seconds:.1} s without gaps in {} give {} independent averages of the spectra, wanted {}; fly \
             the manoeuvre again or longer",
            names.join(", "),
            averages(bandwidth),
            inputs + FEWEST
        );
        return result;
    }
    // Tapers that reach over zero or half the rate mix a spectrum with its own mirror image.
    let last_hz = HIGHEST_HZ.min(0.5 / step_s - 0.5 * bandwidth);
    let count = ((last_hz - 0.5 * bandwidth) / (0.5 * bandwidth) + 1e-9).floor().max(0.0) as usize;
    let frequencies: Vec<f64> = (0..=count).map(|k| 0.5 * bandwidth * (k + 1) as f64).collect();
    let mut spectra = CrossSpectra::new(names.len(), frequencies.clone(), bandwidth);
    let mut moves = vec![false; names.len()];
    for stretch in used {
        for (moves, signal) in moves.iter_mut().zip(&stretch.signals) {
            *moves |= !is_still(signal);
        }
        spectra.add(&stretch.signals, step_s);
        result.stretches_s.push(stretch.span_s);
    }
    result.averages = spectra.averages();
    result.bandwidth_hz = bandwidth;
    if let Some((name, _)) = names.iter().zip(&moves).find(|(_, moves)| !**moves) {
        result.reason = format!("{name} keeps one value in this part of the record");
        return result;
    }
    let last = names.len() - 1;
    let others: Vec<usize> = (1..last).collect();
    let together: Vec<usize> = (0..last).collect();
    let averages = result.averages;
    let curve = |values: Option<Vec<f64>>, inputs: usize, averages: usize| {
        CoherenceCurve::of(values?, &frequencies, inputs, averages)
    };
    result.ordinary = curve(spectra.partial(0, last, &[]), 1, averages);
    if result.ordinary.is_none() {
        result.reason = format!("{input} or {output} has no power at some frequency");
    }
    if !others.is_empty() {
        result.partial = curve(spectra.partial(0, last, &others), 1, averages - others.len());
        result.multiple = curve(spectra.multiple(&together, last), inputs, averages);
        if result.partial.is_none() {
            result.reason = format!(
                "{input} moves exactly together with {}: their effects cannot be told apart. Move one after the other",
                given.join(", ")
            );
        }
    }
    result.frequencies_hz = frequencies;
    result
}

/// Signals of all channels on one grid, without gaps.
struct Stretch {
    span_s: [f64; 2],
    signals: Vec<Vec<f64>>,
}

fn stretches(channels: &[Own], spans: &[[f64; 2]], step_s: f64) -> Vec<Stretch> {
    let mut found: Vec<Stretch> = Vec::new();
    let mut total_s = 0.0;
    for [from, to] in spans {
        let starts = channels.iter().filter_map(|c| c.time.first());
        let ends = channels.iter().filter_map(|c| c.time.last());
        let (mut start, to) = (starts.fold(*from, |a, b| a.max(*b)), ends.fold(*to, |a, b| a.min(*b)));
        while start < to && total_s < MOST_S {
            // The first gap of any channel after the start ends the stretch, and its other side is the next start.
            let gap = channels
                .iter()
                .filter_map(|channel| {
                    let first = channel.time.partition_point(|t| *t <= start + 1e-9).saturating_sub(1);
                    let pairs = channel.time.get(first..)?.windows(2).take_while(|pair| pair[0] < to);
                    pairs.map(|pair| [pair[0], pair[1]]).find(|[a, b]| b - a > GAP * channel.step_s)
                })
                .min_by(|a, b| a[0].total_cmp(&b[0]));
            let end = gap.map_or(to, |gap| gap[0].min(to)).min(start + LONGEST_S);
            let count = ((end - start) / step_s + 1e-6).floor().max(0.0) as usize + 1;
            if end > start && count >= 8 {
                let times: Vec<f64> = (0..count).map(|k| start + k as f64 * step_s).collect();
                let signals = channels.iter().map(|channel| resampled(channel, &times, step_s)).collect();
                total_s += count as f64 * step_s;
                found.push(Stretch { span_s: [start, times.last().copied().unwrap_or(end)], signals });
            }
            start = match gap {
                Some([before, after]) if before <= end + 1e-9 => after,
                // A long stretch goes on where it was cut.
                _ => end.max(start + step_s),
            };
        }
    }
    found
}

/// A channel at these times: the mean of its values within half a step to each side where it has at least two, else on
/// the straight line between its samples.
fn resampled(channel: &Own, times: &[f64], step_s: f64) -> Vec<f64> {
    if channel.step_s > 0.75 * step_s {
        return at_times(times.iter().copied(), &channel.time, &channel.values);
    }
    let straight = at_times(times.iter().copied(), &channel.time, &channel.values);
    let mean = |(time, straight): (&f64, f64)| {
        let first = channel.time.partition_point(|t| *t < time - 0.5 * step_s - 1e-9);
        let end = channel.time.partition_point(|t| *t < time + 0.5 * step_s - 1e-9).max(first);
        let within = &channel.values[first..end];
        if within.len() < 2 { straight } else { within.iter().sum::<f64>() / within.len() as f64 }
    };
    times.iter().zip(straight).map(mean).collect()
}

/// Whether a signal keeps its value but for rounding.
fn is_still(signal: &[f64]) -> bool {
    let (low, high) = signal.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(*v), h.max(*v)));
    high - low <= 1e-12 * high.abs().max(low.abs())
}

#[cfg(test)]
mod testing {
    /// Reproducible standard normal numbers: Box and Muller's on a linear congruential generator.
    pub(super) struct Random(u64);

    impl Random {
        pub(super) fn new(seed: u64) -> Self {
            let mut random = Self(seed);
            for _ in 0..8 {
                random.uniform();
            }
            random
        }

        fn uniform(&mut self) -> f64 {
            self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            ((self.0 >> 11) as f64 + 0.5) / (1_u64 << 53) as f64
        }

        pub(super) fn normal(&mut self) -> f64 {
            (-2.0 * self.uniform().ln()).sqrt() * (std::f64::consts::TAU * self.uniform()).cos()
        }

        pub(super) fn normals(&mut self, count: usize) -> Vec<f64> {
            (0..count).map(|_| self.normal()).collect()
        }
    }
}

#[cfg(test)]
mod tests {
    use phugoid_flight_data::record::Record;

    use super::testing::Random;
    use super::*;
    use crate::manoeuvres::{Kind, Manoeuvre, SurfaceInput};

    fn moved(surfaces: &[&str], from_s: f64, to_s: f64) -> Found {
        let input = |surface: &&str| SurfaceInput {
            surface: (*surface).to_owned(),
            kind: Kind::Other,
            onset_s: from_s,
            end_s: to_s,
            peak_rad: 0.1,
            frequency_hz: None,
        };
        let manoeuvre = Manoeuvre {
            number: 1,
            from_s,
            to_s,
            lead_s: 0.0,
            inputs: surfaces.iter().map(input).collect(),
            responses: Vec::new(),
            short_period: None,
            useful: true,
            remarks: Vec::new(),
            coefficients: Vec::new(),
        };
        Found { manoeuvres: vec![manoeuvre], ..Found::default() }
    }

    /// Elevator of white noise, pitch rate with noise, and yaw rate of noise alone.
    fn record(samples: usize, step_s: f64, seed: u64) -> Record {
        let mut random = Random::new(seed);
        let elevator = random.normals(samples);
        let mut state = 0.0;
        let q = elevator
            .iter()
            .map(|u| {
                state = 0.8 * state + 0.2 * u;
                state + 0.02 * random.normal()
            })
            .collect();
        let time = (0..samples).map(|k| k as f64 * step_s).collect();
        let columns =
            [("time_s", time), ("elevator_rad", elevator), ("q_rad_s", q), ("r_rad_s", random.normals(samples))];
        Record::from_columns("white", columns).unwrap()
    }

    #[test]
    fn a_gap_and_missing_values_are_handled() {
        let mut record = record(1000, 0.04, 4);
        let found = moved(&["elevator"], 0.0, 40.0);
        let whole = &coherence(&record, &found)[0];
        assert_eq!((whole.output.as_str(), whole.stretches_s.len()), ("q", 1));
        // A single missing value is bridged, a gap of 2 s divides the stretch. Both leave the coherence high.
        record.channels[1].values[100] = f64::NAN;
        record.channels[1].values[500..550].fill(f64::NAN);
        let divided = &coherence(&record, &found)[0];
        assert_eq!(divided.stretches_s.len(), 2, "{:?}", divided.stretches_s);
        assert!((divided.stretches_s[0][1] - 19.96).abs() < 1e-9 && (divided.stretches_s[1][0] - 22.0).abs() < 1e-9);
        for pair in [whole, divided] {
            let curve = pair.decisive().unwrap();
            assert!(curve.peak > 0.95 && curve.chance < 1e-4, "{curve:?}");
            assert_eq!(curve.values.len(), pair.frequencies_hz.len());
            assert!(pair.frequencies_hz.iter().all(|f| *f <= 10.0));
        }
        // The yaw rate is noise.
        let yaw = coherence(&record, &found).into_iter().find(|c| c.output == "r").unwrap();
        assert!(!yaw.ordinary.as_ref().unwrap().is_significant(), "{yaw:?}");
    }

    #[test]
    fn a_slow_or_unequally_sampled_channel_is_compared_at_its_own_rate() {
        let mut slow = record(2000, 0.02, 9);
        // The pitch rate has a value at every fifth sample alone, the mean of what was.
        let values = slow.channels[1].values.clone();
        for (k, value) in slow.channels[1].values.iter_mut().enumerate() {
            let around = &values[k.saturating_sub(2)..(k + 3).min(values.len())];
            *value = if k % 5 == 0 { around.iter().sum::<f64>() / around.len() as f64 } else { f64::NAN };
        }
        // Times that tremble by a tenth of a step.
        let mut random = Random::new(1);
        slow.time.iter_mut().for_each(|t| *t += 0.002 * random.normal().clamp(-2.0, 2.0));
        let pair = &coherence(&slow, &moved(&["elevator"], 0.0, 40.0))[0];
        let curve = pair.decisive().unwrap();
        // Ten values a second: half the rate is 5 Hz.
        assert!(pair.frequencies_hz.last().is_some_and(|f| *f < 5.0), "{:?}", pair.frequencies_hz);
        // What the means leave of the white input above 5 Hz is folded down: at 1.5 Hz 0.03 of its power there, at 2.5 Hz a
        // quarter.
        assert!(curve.values.iter().zip(&pair.frequencies_hz).all(|(v, f)| *f > 1.5 || *v > 0.9), "{curve:?}");
    }

    #[test]
    fn what_is_too_short_or_stands_still_says_so() {
        let mut record = record(1000, 0.04, 6);
        let short = &coherence(&record, &moved(&["elevator"], 0.0, 0.9))[0];
        assert!(short.ordinary.is_none() && short.reason.contains("too short"), "{short:?}");
        record.channels[1].values.fill(0.1);
        let still = &coherence(&record, &moved(&["elevator"], 0.0, 40.0))[0];
        assert_eq!(still.reason, "q keeps one value in this part of the record");
        record.channels[1].values.fill(f64::NAN);
        let empty = &coherence(&record, &moved(&["elevator"], 0.0, 40.0))[0];
        assert_eq!(empty.reason, "q has fewer than two values");
    }

    /// In how many records of noise alone the peak is called significant: at most one in twenty.
    #[test]
    fn noise_has_a_significant_peak_in_less_than_one_record_of_twenty() {
        let runs = 400;
        let mut significant = 0;
        for seed in 0..runs {
            let record = record(300, 0.04, 100 + seed);
            let yaw =
                coherence(&record, &moved(&["elevator"], 0.0, 12.0)).into_iter().find(|c| c.output == "r").unwrap();
            significant += u32::from(yaw.ordinary.unwrap().is_significant());
        }
        // Three standard deviations above one in twenty; Bonferroni's bound is a little below it.
        let limit = 0.05 + 3.0 * (0.05 * 0.95 / runs as f64).sqrt();
        assert!(f64::from(significant) / (runs as f64) < limit, "{significant} of {runs}");
        assert!(significant > 0, "the bound is not so loose that it never holds");
    }
}
