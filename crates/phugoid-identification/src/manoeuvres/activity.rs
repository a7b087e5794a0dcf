//! Where a control surface moves.

use phugoid_flight_data::statistics::{Rank, median, quantile};

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
/// An input has to depart by this many standard deviations of the surface over the whole record ...
const WANDER: f64 = 4.0;
/// ... or to last for this part of the record.
const LARGE_PART: f64 = 0.25;

/// The motions of one surface.
pub(crate) fn inputs(signals: &Signals<'_>, surface: &str, settings: &Settings) -> Vec<SurfaceInput> {
    let Some(sampled) = signals.channel(surface) else { return Vec::new() };
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
    let wander = WANDER * wander(&clean);
    let whole = sampled.time.last().zip(sampled.time.first()).map_or(0.0, |(last, first)| last - first);
    let stands =
        |input: &SurfaceInput| input.peak_rad.abs() >= wander || input.end_s - input.onset_s > LARGE_PART * whole;
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

/// Median distance from the median, as one sigma of a normal distribution.
fn wander(values: &[f64]) -> f64 {
    let Some(middle) = median(&mut values.to_vec()) else { return 0.0 };
    1.4826 * median(&mut values.iter().map(|v| (v - middle).abs()).collect::<Vec<f64>>()).unwrap_or(0.0)
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
fn medians(values: &[f64]) -> Vec<f64> {
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
