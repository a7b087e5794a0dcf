//! Where a control surface moves.

use phugoid_flight_data::statistics::{Rank, median, quantile};

use super::feedback;
use super::input::SurfaceInput;
use super::record::{Sampled, Signals};
use super::settings::Settings;
use super::shape;

/// Smallest motion of a surface that counts, rad: rounding is not an input.
const SMALLEST: f64 = 1e-4;
/// A surface counts as moved on purpose where its travel is this many times its usual travel.
const ABOVE_USUAL: f64 = 2.5;
/// Stretches stand out where their median travel is this many times the median travel outside.
const CONTRAST: f64 = 6.0;
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
    let clean = medians(&sampled.values);
    let travel = travel(&sampled.time, &clean, settings.window_s);
    let threshold = SMALLEST.max(settings.sigmas * sampled.noise);
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
    view.joined(&stretches).into_iter().filter_map(|stretch| view.input(surface, stretch)).filter(stands).collect()
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

struct View<'a> {
    sampled: &'a Sampled,
    clean: &'a [f64],
    settings: &'a Settings,
    threshold: f64,
}

impl View<'_> {
    fn time(&self, k: usize) -> f64 {
        self.sampled.time.get(k).copied().unwrap_or(f64::NAN)
    }

    /// Median of the values from one time to another; the value at `k` if there are none.
    fn level(&self, from_s: f64, to_s: f64, k: usize) -> f64 {
        let range = self.sampled.range(from_s, to_s);
        median(&mut self.clean[range].to_vec()).unwrap_or(self.clean[k])
    }

    /// From the samples whose window shows motion to the motion itself: first sample that has left its level, and the
    /// one from which the surface stays at its new level.
    fn trimmed(&self, (first, last): (usize, usize)) -> (usize, usize) {
        let small = self.threshold / 3.0;
        let begin = self.time(first);
        let before = self.level(begin - self.settings.lead_s, begin - self.settings.window_s, first.saturating_sub(1));
        let mut onset = first;
        while onset > 0
            && begin - self.time(onset - 1) <= self.settings.window_s
            && (self.clean[onset - 1] - before).abs() > small
        {
            onset -= 1;
        }
        let finish = self.time(last);
        let after = self.level(finish, finish + self.settings.lead_s, last);
        let mut end = last;
        while end > onset && (self.clean[end - 1] - after).abs() <= small {
            end -= 1;
        }
        (onset, end)
    }

    /// Motions that are less than a settling time apart, and motions between which the surface was held away from where
    /// it had been before the first, as long as it comes back there.
    fn joined(&self, stretches: &[(usize, usize)]) -> Vec<(usize, usize)> {
        let mut joined = Vec::new();
        let mut index = 0;
        while index < stretches.len() {
            let count = self.held(&stretches[index..]).unwrap_or_else(|| self.close(&stretches[index..]));
            joined.push((stretches[index].0, stretches[index + count - 1].1));
            index += count;
        }
        joined
    }

    fn gap(&self, before: (usize, usize), next: (usize, usize)) -> f64 {
        self.time(next.0) - self.time(before.1)
    }

    /// How many of the first stretches follow one another within the settling time.
    fn close(&self, stretches: &[(usize, usize)]) -> usize {
        1 + stretches.windows(2).take_while(|pair| self.gap(pair[0], pair[1]) < self.settings.settling_s).count()
    }

    /// How many of the first stretches it takes until the surface is back for at least the settling time; none if it is
    /// not held in between, or does not come back.
    fn held(&self, stretches: &[(usize, usize)]) -> Option<usize> {
        let (onset, _) = *stretches.first()?;
        let base = self.base(onset);
        for (index, &(_, end)) in stretches.iter().enumerate() {
            let next = stretches.get(index + 1);
            let gap = next.map_or(f64::INFINITY, |next| self.gap(stretches[index], *next));
            let until = next.map_or(f64::INFINITY, |next| self.time(next.0) - 1e-6);
            let level = self.level(self.time(end), until.min(self.time(end) + self.settings.lead_s), end) - base;
            let back = level.abs() <= shape::BACK * self.peak(onset, end, base).abs();
            if back && gap >= self.settings.settling_s {
                return Some(index + 1);
            }
            if !back && gap > self.settings.held_s {
                return None;
            }
        }
        None
    }

    fn base(&self, onset: usize) -> f64 {
        let begin = self.time(onset);
        let step = self.time(onset) - self.time(onset.saturating_sub(1));
        self.level(begin - self.settings.lead_s, begin - 0.5 * step, onset.saturating_sub(1))
    }

    fn peak(&self, onset: usize, end: usize, base: f64) -> f64 {
        let departures = self.clean[onset..=end].iter().map(|v| v - base);
        departures.fold(0.0, |most: f64, d| if d.abs() > most.abs() { d } else { most })
    }

    fn input(&self, surface: &str, (onset, end): (usize, usize)) -> Option<SurfaceInput> {
        let base = self.base(onset);
        let peak = self.peak(onset, end, base);
        if peak.abs() < SMALLEST {
            return None;
        }
        let to = self.time(end) + self.settings.lead_s.min(self.settings.settling_s);
        let range = self.sampled.range(self.time(onset), to);
        let time = &self.sampled.time[range.clone()];
        let departures: Vec<f64> = self.clean[range].iter().map(|v| v - base).collect();
        Some(SurfaceInput {
            surface: surface.to_owned(),
            onset_s: self.time(onset),
            end_s: self.time(end),
            peak_rad: peak,
            kind: shape::kind(time, &departures),
            frequency_hz: shape::frequency(time, &departures, self.time(end) - self.time(onset)),
        })
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
