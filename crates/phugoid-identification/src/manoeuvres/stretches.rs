//! From samples that show motion of a surface to inputs: where a motion begins and ends, which motions are one input, and
//! which are two.

use phugoid_flight_data::statistics::median;

use super::input::SurfaceInput;
use super::record::Sampled;
use super::settings::Settings;
use super::shape;

/// Smallest motion of a surface that counts, rad: rounding is not an input.
pub(super) const SMALLEST: f64 = 1e-4;

/// The position of one surface, as motions of it are looked for.
pub(super) struct View<'a> {
    pub(super) sampled: &'a Sampled,
    /// Without wild values.
    pub(super) clean: &'a [f64],
    pub(super) settings: &'a Settings,
    /// A motion travels further than this, rad.
    pub(super) threshold: f64,
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
    pub(super) fn trimmed(&self, (first, last): (usize, usize)) -> (usize, usize) {
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
    pub(super) fn joined(&self, stretches: &[(usize, usize)]) -> Vec<(usize, usize)> {
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
    /// not held in between, or does not come back. A surface that goes over to the other side without a rest is in the
    /// middle of an input, whether the record shows its end or not.
    fn held(&self, stretches: &[(usize, usize)]) -> Option<usize> {
        let (onset, _) = *stretches.first()?;
        let base = self.base(onset);
        // Where it was held first, and how many stretches follow one another by going over to the other side.
        let (mut first, mut level_before) = (None, 0.0_f64);
        let mut across = 1;
        for (index, &(_, end)) in stretches.iter().enumerate() {
            let next = stretches.get(index + 1);
            let gap = next.map_or(f64::INFINITY, |next| self.gap(stretches[index], *next));
            let until = next.map_or(f64::INFINITY, |next| self.time(next.0) - 1e-6);
            let level = self.level(self.time(end), until.min(self.time(end) + self.settings.lead_s), end) - base;
            if level * level_before < 0.0 && level.abs() > shape::BACK * level_before.abs() && across == index {
                across = index + 1;
            }
            // Back is where it came from, seen from where it was held: a large input after a small step ends at the step.
            let most = first.map_or_else(|| self.peak(onset, end, base).abs(), f64::abs);
            let back = level.abs() <= shape::BACK * most;
            if back && gap >= self.settings.settling_s {
                return Some(index + 1);
            }
            if !back && gap > self.settings.held_s {
                return (across > 1).then_some(across);
            }
            if !back && gap >= self.settings.settling_s {
                // Beside an input that is so much larger the surface has not moved: a trim that was changed before it.
                if next.is_some_and(|next| level.abs() <= shape::BACK * self.peak(next.0, next.1, base).abs()) {
                    return Some(index + 1);
                }
                first = first.or(Some(level));
            }
            level_before = level;
        }
        None
    }

    /// The position before a motion.
    fn base(&self, onset: usize) -> f64 {
        self.base_after(onset, None)
    }

    /// The position before a motion, of samples after another one that ends there.
    fn base_after(&self, onset: usize, other: Option<usize>) -> f64 {
        let begin = self.time(onset);
        let step = self.time(onset) - self.time(onset.saturating_sub(1));
        let from = other.map_or(f64::NEG_INFINITY, |end| self.time(end)).max(begin - self.settings.lead_s);
        self.level(from, begin - 0.5 * step, onset.saturating_sub(1))
    }

    fn peak(&self, onset: usize, end: usize, base: f64) -> f64 {
        let departures = self.clean[onset..=end].iter().map(|v| v - base);
        departures.fold(0.0, |most: f64, d| if d.abs() > most.abs() { d } else { most })
    }

    /// A 3-2-1-1 and what follows it without a rest, each for itself.
    pub(super) fn parts(&self, (onset, end): (usize, usize)) -> Vec<(usize, usize)> {
        let base = self.base(onset);
        let range = onset..(end + 1).min(self.clean.len());
        let departures: Vec<f64> = self.clean[range.clone()].iter().map(|v| v - base).collect();
        let Some(over_s) = shape::end_of_3211(&self.sampled.time[range], &departures) else {
            return vec![(onset, end)];
        };
        let over = self.sampled.time.partition_point(|t| *t < over_s).min(end);
        // What follows begins where it leaves the position between the two.
        let between = self.clean[over];
        let leaves = (over..end).find(|k| (self.clean[*k] - between).abs() > self.threshold);
        leaves
            .map_or_else(|| vec![(onset, end)], |next| vec![(onset, over), (next.saturating_sub(1).max(over + 1), end)])
    }

    /// A motion as an input, between the end of the one `before` and the onset of the one `after` it; `None` if it is no more
    /// than rounding.
    pub(super) fn input(
        &self,
        surface: &str,
        (onset, end): (usize, usize),
        before: Option<usize>,
        after: Option<usize>,
    ) -> Option<SurfaceInput> {
        let base = self.base_after(onset, before);
        let peak = self.peak(onset, end, base);
        if peak.abs() < SMALLEST {
            return None;
        }
        let rest = self.settings.lead_s.min(self.settings.settling_s);
        let to = (self.time(end) + rest).min(after.map_or(f64::INFINITY, |onset| self.time(onset) - 1e-6));
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
