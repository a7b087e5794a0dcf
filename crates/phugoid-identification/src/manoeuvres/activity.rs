//! Where a control surface moves.

use phugoid_flight_data::statistics::{Rank, median, median_step, quantile};

use super::feedback::{self, means};
use super::input::SurfaceInput;
use super::record::{Sampled, Signals};
use super::settings::Settings;
use super::stretches::{SMALLEST, View};

/// A surface counts as moved on purpose where its travel is this many times its usual travel.
const ABOVE_USUAL: f64 = 2.5;
/// Stretches stand out where their median travel is this many times the median travel outside.
const CONTRAST: f64 = 6.0;
/// Means are taken of the positions where so many sigmas as make a motion are more than this part of their range, ...
const NOISE_OF_RANGE: f64 = 0.25;
/// ... over this part of the window at most, ...
const MEAN_OF_WINDOW: f64 = 0.3;
/// ... where the range is so many times what makes a motion: means shall show the edges of an input to both sides, and not the
/// smaller work of a control loop.
const SMALL_INPUT: f64 = 1.5;
/// An input has to depart by this many times as far as the surface ordinarily wanders in the time that it takes ...
const WANDER: f64 = 4.0;
/// ... at most so many seconds, so long before and after it, and by at least so many pairs of samples ...
const WANDER_S: f64 = 2.0;
const AROUND_S: f64 = 30.0;
const PAIRS: usize = 50;
/// Part of the pairs that are nearer than the distance that is taken, and that distance over one sigma of a normal
/// distribution. Other inputs around may fill the rest.
const NEAR: f64 = 0.3;
const NEAR_SIGMAS: f64 = 0.385;
/// ... or to last for this part of the record.
const LARGE_PART: f64 = 0.25;

/// The motions of one surface.
pub(crate) fn inputs(signals: &Signals<'_>, surface: &str, settings: &Settings) -> Vec<SurfaceInput> {
    let Some(sampled) = &feedback::commanded(signals, surface) else { return Vec::new() };
    let (clean, noise) = smoothed(sampled, settings);
    let travel = travel(&sampled.time, &clean, settings.window_s);
    let threshold = SMALLEST.max(settings.sigmas * noise);
    // A control loop moves a surface all the time: the travel in the quietest quarter of the samples is not an input.
    let usual = quantile(&mut travel.clone(), 0.25, Rank::Lower).unwrap_or(0.0);
    let mut stretches = stretches(&travel, threshold.max(ABOVE_USUAL * usual));
    if usual * ABOVE_USUAL > threshold && !stands_out(&travel, &stretches) {
        // No stretch stands out of the usual travel: then the usual travel is the input.
        stretches = self::stretches(&travel, threshold);
    }
    let view = View { sampled, clean: &clean, settings, threshold };
    let stretches: Vec<(usize, usize)> = stretches.into_iter().map(|s| view.trimmed(s)).collect();
    let whole = sampled.time.last().zip(sampled.time.first()).map_or(0.0, |(last, first)| last - first);
    let stands = |input: &SurfaceInput| {
        let seconds = input.end_s - input.onset_s;
        let wander = wander(&sampled.time, &clean, input.onset_s, input.end_s);
        input.peak_rad.abs() >= WANDER * wander || seconds > LARGE_PART * whole
    };
    let parts: Vec<_> = view.joined(&stretches).into_iter().flat_map(|stretch| view.parts(stretch)).collect();
    let input = |k: usize| {
        let (before, after) = (k.checked_sub(1).map(|k| parts[k].1), parts.get(k + 1).map(|next| next.0));
        view.input(surface, parts[k], before, after)
    };
    (0..parts.len()).filter_map(input).filter(stands).collect()
}

/// The position without wild values and one sigma of its noise. Where ten sigmas are a large part of the range, as of a
/// potentiometer, means of neighbours are taken, as few as make them a small part.
fn smoothed(sampled: &Sampled, settings: &Settings) -> (Vec<f64>, f64) {
    let clean = medians(&sampled.values);
    let mut sorted = clean.clone();
    let at = |sorted: &mut Vec<f64>, part: f64| quantile(sorted, part, Rank::Lower).unwrap_or(f64::NAN);
    let range = at(&mut sorted, 0.99) - at(&mut sorted, 0.01);
    let wanted = (settings.sigmas * sampled.noise / (NOISE_OF_RANGE * range)).powi(2);
    let most = median_step(&sampled.time).map_or(1.0, |step| MEAN_OF_WINDOW * settings.window_s / step);
    let half = (0.5 * (wanted - 1.0)).ceil().min((0.5 * (most - 1.0)).floor());
    if half.is_nan() || half < 1.0 || range < SMALL_INPUT * settings.sigmas * sampled.noise {
        return (clean, sampled.noise);
    }
    (means(&clean, half as usize), sampled.noise / (2.0 * half + 1.0).sqrt())
}

/// Whether the typical travel within the stretches is several times that outside.
fn stands_out(travel: &[f64], stretches: &[(usize, usize)]) -> bool {
    let inside = |k: usize| stretches.iter().any(|(first, last)| (*first..=*last).contains(&k));
    let (mut within, mut without) = (Vec::new(), Vec::new());
    for (k, travel) in travel.iter().enumerate() {
        if inside(k) { within.push(*travel) } else { without.push(*travel) }
    }
    median(&mut within).zip(median(&mut without)).is_some_and(|(within, without)| within > CONTRAST * without)
}

/// How far a surface wanders around an input in the time that the input takes, rad: one sigma of values that are so far
/// apart. The work of a control loop or of a pilot shows in it. A trim that was changed does not, though it moves half
/// of the record away from the median of the whole.
fn wander(time: &[f64], values: &[f64], onset_s: f64, end_s: f64) -> f64 {
    let range = |from: f64, to: f64| time.partition_point(|t| *t < from)..time.partition_point(|t| *t < to);
    let sides = [range(onset_s - AROUND_S, onset_s), range(end_s + 1e-9, end_s + AROUND_S)];
    let mut apart = (end_s - onset_s).min(WANDER_S);
    loop {
        let mut distances = Vec::new();
        for side in &sides {
            let mut before = side.start;
            for k in side.clone() {
                while before + 1 < k && time[before + 1] <= time[k] - apart + 1e-9 {
                    before += 1;
                }
                if time[before] <= time[k] - apart + 1e-9 {
                    distances.push((values[k] - values[before]).abs());
                }
            }
        }
        // Where the record is too short for two samples so far apart, those nearer to each other have to do.
        if distances.len() >= PAIRS || apart < 0.1 {
            let near = quantile(&mut distances, NEAR, Rank::Lower).unwrap_or(0.0);
            return near / (NEAR_SIGMAS * std::f64::consts::SQRT_2);
        }
        apart *= 0.5;
    }
}

/// Running medians of three values: they remove a single outlier and keep an edge where it is.
pub(super) fn medians(values: &[f64]) -> Vec<f64> {
    let mut clean = values.to_vec();
    for (k, w) in values.windows(3).enumerate() {
        clean[k + 1] = w[0].max(w[1]).min(w[0].min(w[1]).max(w[2]));
    }
    clean
}

/// How far a signal travels (highest less lowest value) in the window that ends at each sample.
fn travel(time: &[f64], values: &[f64], window_s: f64) -> Vec<f64> {
    // Samples whose value is a running maximum, and a running minimum, of the window: each enters and leaves once.
    let (mut high, mut low) = (std::collections::VecDeque::new(), std::collections::VecDeque::new());
    let mut travel = Vec::with_capacity(values.len());
    for (k, (&t, &value)) in time.iter().zip(values).enumerate() {
        while high.back().is_some_and(|&j: &usize| values[j] <= value) {
            high.pop_back();
        }
        while low.back().is_some_and(|&j: &usize| values[j] >= value) {
            low.pop_back();
        }
        high.push_back(k);
        low.push_back(k);
        // Three samples at least.
        let old = |j: usize| time[j] < t - window_s - 1e-9 && j + 2 < k;
        while high.front().is_some_and(|&j| old(j)) {
            high.pop_front();
        }
        while low.front().is_some_and(|&j| old(j)) {
            low.pop_front();
        }
        let (most, least) = (high.front().map_or(value, |&j| values[j]), low.front().map_or(value, |&j| values[j]));
        travel.push(most - least);
    }
    travel
}

/// First and last sample of each stretch above a threshold.
fn stretches(travel: &[f64], threshold: f64) -> Vec<(usize, usize)> {
    let mut found: Vec<(usize, usize)> = Vec::new();
    for (k, _) in travel.iter().enumerate().filter(|(_, t)| **t > threshold) {
        match found.last_mut() {
            Some(last) if last.1 + 1 == k => last.1 = k,
            _ => found.push((k, k)),
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::super::shape;
    use super::*;

    use phugoid_flight_data::record::Record;
    use std::collections::BTreeMap;

    /// A minute at 50 Hz with noise of 0.03 deg on the elevator, of a linear congruential generator.
    fn recorded(elevator: impl Fn(f64) -> f64) -> Record {
        let mut seed = 1_u64;
        let mut noise = || {
            let mut sum = -6.0;
            for _ in 0..12 {
                seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                sum += (seed >> 11) as f64 / (1_u64 << 53) as f64;
            }
            5e-4 * sum
        };
        let time: Vec<f64> = (0..3000).map(|k| 0.02 * f64::from(k)).collect();
        let values = time.iter().map(|t| elevator(*t) + noise()).collect();
        Record::from_columns("a flight", [("time_s", time), ("elevator_rad", values)]).unwrap()
    }

    fn found(elevator: impl Fn(f64) -> f64) -> Vec<SurfaceInput> {
        inputs(&Signals::of(&recorded(elevator)), "elevator", &Settings::default())
    }

    /// One degree, seven units of 0.7 s from the beginning on.
    fn input_3211(t: f64) -> f64 {
        match t / 0.7 {
            u if (0.0..3.0).contains(&u) || (5.0..6.0).contains(&u) => 0.0175,
            u if (3.0..5.0).contains(&u) || (6.0..7.0).contains(&u) => -0.0175,
            _ => 0.0,
        }
    }

    #[test]
    fn a_trim_that_is_changed_hides_no_input() {
        let begins = [5.0, 18.0, 35.0, 48.0];
        let four = |t: f64| begins.iter().map(|begin| input_3211(t - begin)).sum::<f64>();
        // No change, a step, a ramp of two seconds and one of ten, by four degrees in the middle of the flight.
        let ramp = |t: f64, seconds: f64| 0.07 * ((t - 25.0) / seconds).clamp(0.0, 1.0);
        let shapes: BTreeMap<&str, Box<dyn Fn(f64) -> f64>> = BTreeMap::from([
            ("none", Box::new(|_| 0.0) as Box<dyn Fn(f64) -> f64>),
            ("step", Box::new(move |t| ramp(t, 0.1))),
            ("ramp", Box::new(move |t| ramp(t, 2.0))),
            ("slow ramp", Box::new(move |t| ramp(t, 9.0))),
        ]);
        for (name, trim) in shapes {
            let found = found(|t| four(t) + trim(t));
            for begin in begins {
                let near = |input: &&SurfaceInput| (input.onset_s - begin).abs() < 0.3;
                let input = found.iter().find(near).unwrap_or_else(|| panic!("{name}: none at {begin} s: {found:?}"));
                assert_eq!(input.kind, shape::Kind::ThreeTwoOneOne, "{name}: {input:?}");
            }
            assert!(found.len() <= begins.len() + 1, "{name}: beside the inputs only the trim: {found:?}");
        }
    }

    #[test]
    fn the_work_of_a_control_loop_is_no_input() {
        // A sum of waves without a period, of a quarter of a degree, throughout.
        let at_work = |t: f64| 0.0015 * ((2.9 * t).sin() + (4.1 * t + 1.0).sin() + (6.7 * t + 2.0).sin());
        let found = found(|t| at_work(t) + if (30.0..31.0).contains(&t) { 0.05 } else { 0.0 });
        let [only] = found.as_slice() else { panic!("{found:?}") };
        assert!((27.0..=30.1).contains(&only.onset_s) && only.peak_rad > 0.045, "{only:?}");
    }

    #[test]
    fn what_a_damper_does_hides_no_input() {
        // Gusts of three frequencies, and a damper that answers them with half of the elevator's own input.
        let q = |t: f64| 0.03 * ((1.9 * t).sin() + (3.1 * t + 1.0).sin() + (4.7 * t + 2.0).sin());
        let elevator = |t: f64| input_3211(t - 30.0) + 0.3 * q(t - 0.03);
        let mut record = recorded(elevator);
        let of = |record: &Record| inputs(&Signals::of(record), "elevator", &Settings::default());
        let alone = of(&record);
        assert!(!alone.iter().any(|i| i.kind == shape::Kind::ThreeTwoOneOne), "without q nobody knows: {alone:?}");
        let rates = record.time.iter().map(|t| q(*t)).collect();
        record
            .channels
            .extend(Record::from_columns("q", [("time_s", record.time.clone()), ("q_rad_s", rates)]).unwrap().channels);
        let found = of(&record);
        let [only] = found.as_slice() else { panic!("{found:?}") };
        assert!(only.kind == shape::Kind::ThreeTwoOneOne && (only.onset_s - 30.0).abs() < 0.1, "{only:?}");
        assert!((only.peak_rad.abs() - 0.0175).abs() < 0.004, "{only:?}");
    }

    /// A doublet of a second to each side from the beginning on, of one degree.
    fn doublet(t: f64) -> f64 {
        match t {
            t if (0.0..1.0).contains(&t) => 0.0175,
            t if (1.0..2.0).contains(&t) => -0.0175,
            _ => 0.0,
        }
    }

    #[test]
    fn a_trim_that_was_changed_before_an_input_is_no_part_of_it() {
        // Parts of the input, by a control loop after a damage.
        for part in [0.07, 0.2, 0.5] {
            let trim = |t: f64| if t > 28.0 { part * 0.0175 } else { 0.0 };
            let found = found(|t| trim(t) + doublet(t - 33.0) + input_3211(t - 42.0));
            let near = |at: f64| found.iter().find(|i| (i.onset_s - at).abs() < 0.3).map(|i| i.kind);
            assert_eq!(near(33.0), Some(shape::Kind::Doublet), "{part}: {found:?}");
            assert_eq!(near(42.0), Some(shape::Kind::ThreeTwoOneOne), "{part}: {found:?}");
        }
    }

    #[test]
    fn an_input_that_the_record_cuts_is_one() {
        // Steps of three seconds and more to both sides; the record ends during the last.
        let levels = [(50.0, 3.2, 0.0175), (53.2, 4.8, -0.0175), (58.0, 9.0, 0.0175)];
        let input = |t: f64| levels.iter().find(|l| (l.0..l.0 + l.1).contains(&t)).map_or(0.0, |l| l.2);
        let found = found(input);
        let [only] = found.as_slice() else { panic!("{found:?}") };
        assert!(only.kind == shape::Kind::MultiStep && (only.onset_s - 50.0).abs() < 0.1, "{only:?}");
    }

    #[test]
    fn what_follows_a_3211_without_a_rest_is_another_input() {
        let stick = |t: f64| if (0.0..9.0).contains(&t) { 0.006 * ((2.3 * t).sin() + (4.1 * t).sin()) } else { 0.0 };
        let found = found(|t| input_3211(t - 10.0) + stick(t - 15.2));
        let kinds: Vec<_> = found.iter().map(|i| (i.kind, (i.onset_s * 2.0).round() / 2.0)).collect();
        assert_eq!(kinds, [(shape::Kind::ThreeTwoOneOne, 10.0), (shape::Kind::Other, 15.5)], "{found:?}");
        // A longer sequence of steps that was designed as one stays one.
        let longer = |t: f64| if (4.9..5.6).contains(&t) { 0.0175 } else { input_3211(t) };
        assert_eq!(self::found(|t| longer(t - 10.0)).len(), 1);
    }

    #[test]
    fn an_input_of_a_few_sigmas_is_seen_through_the_noise_of_a_transducer() {
        // Noise of 0.12 deg, one sigma, under a doublet of one degree: its first edge is eight sigmas high.
        let mut record = recorded(|t| doublet(t - 30.0));
        let quiet = recorded(|_| 0.0);
        let scale = |values: &[f64], of: &[f64]| values.iter().zip(of).map(|(v, n)| v + 3.0 * n).collect();
        let noise = quiet.channels[0].values.clone();
        record.channels[0].values = scale(&record.channels[0].values, &noise);
        let found = inputs(&Signals::of(&record), "elevator", &Settings::default());
        let [only] = found.as_slice() else { panic!("{found:?}") };
        assert!(only.kind == shape::Kind::Doublet && (only.onset_s - 30.0).abs() < 0.15, "{only:?}");
        // The noise alone is no input.
        record.channels[0].values = noise.iter().map(|n| 4.0 * n).collect();
        assert_eq!(inputs(&Signals::of(&record), "elevator", &Settings::default()), []);
    }

    #[test]
    fn travel_is_that_of_the_window_and_a_wild_value_is_none() {
        let time: Vec<f64> = (0..12).map(|k| 0.1 * f64::from(k)).collect();
        let mut values = vec![0.0; 12];
        values[4] = 9.0;
        assert_eq!(medians(&values), vec![0.0; 12]);
        let step: Vec<f64> = (0..12).map(|k| if k < 6 { 0.0 } else { 1.0 }).collect();
        assert_eq!(medians(&step), step);
        // The window of 0.3 s shows the step in the samples 6 to 8: it holds the sample before it until then.
        let seen: Vec<usize> =
            travel(&time, &step, 0.3).iter().enumerate().filter(|t| *t.1 > 0.5).map(|t| t.0).collect();
        assert_eq!(seen, [6, 7, 8]);
        assert_eq!(stretches(&[0.0, 2.0, 2.0, 0.0, 3.0], 1.0), [(1, 2), (4, 4)]);
    }
}
