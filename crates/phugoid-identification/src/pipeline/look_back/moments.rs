//! The moment at which a record is best opened.

use super::{Again, CLOSEST_S, Tried};
use crate::core::error::EstimateError;
use crate::core::options::{KnownChange, Opens};
use crate::methods::{EveryRoom, Run};

/// So many moments are tried besides at which the record is predicted worst, over this time, s.
const ONSETS: usize = 2;
const DIP_S: f64 = 1.0;
/// The best moment is at first looked for to within this, s.
const COARSE_S: f64 = 0.2;
/// Of a change that is sharp the evidence has a peak of a few tenths of a second, which lies between these moments. Parameters that were
/// opened early are surprised by it as well: so often those moments close to the best one are tried at which prediction becomes worse the
/// most suddenly, the mean over this time after it against that before it, s.
const ROUNDS: usize = 3;
const SUDDEN_S: f64 = 0.3;
/// The best moment is looked for to within this in the end, s: a constant that is opened a fifth of a second late has been followed by the
/// derivatives meanwhile.
const FINE_S: f64 = 0.05;

/// The moments that were tried with the same parameters opened, and the best of them.
pub(super) struct Moments<'a, 'b, 'c, M: EveryRoom<N, R>, const N: usize, const R: usize> {
    again: &'a Again<'b, 'c, M, N, R>,
    known: &'a [KnownChange],
    opens: Opens,
    /// The times between which moments are tried, s.
    window: [f64; 2],
    tried_s: Vec<f64>,
    pub(super) best: Tried<R>,
}

impl<'a, 'b, 'c, M: EveryRoom<N, R>, const N: usize, const R: usize> Moments<'a, 'b, 'c, M, N, R> {
    pub(super) fn at(
        again: &'a Again<'b, 'c, M, N, R>,
        known: &'a [KnownChange],
        opens: Opens,
        window: [f64; 2],
        time_s: f64,
    ) -> Result<Self, EstimateError> {
        let best = again.at(known, KnownChange { time_s, opens })?;
        Ok(Self { again, known, opens, window, tried_s: vec![time_s], best })
    }

    pub(super) fn try_at(&mut self, time_s: f64) -> Result<(), EstimateError> {
        let is_known = self.tried_s.iter().any(|tried_s| (tried_s - time_s).abs() < 0.2 * FINE_S);
        if is_known || !(self.window[0]..self.window[1]).contains(&time_s) {
            return Ok(());
        }
        self.tried_s.push(time_s);
        let tried = self.again.at(self.known, KnownChange { time_s, opens: self.opens })?;
        if tried.evidence >= self.best.evidence {
            self.best = tried;
        }
        Ok(())
    }

    /// Tries the moments that are so far before and after the best one, and half as far, down to a distance.
    fn refine(&mut self, from_s: f64, down_to_s: f64) -> Result<(), EstimateError> {
        let mut beside_s = from_s;
        while beside_s > down_to_s {
            let middle_s = self.best.change.time_s;
            self.try_at(middle_s - beside_s)?;
            self.try_at(middle_s + beside_s)?;
            beside_s /= 2.0;
        }
        Ok(())
    }

    /// Looks for the best moment among those around the best that was tried so far, the others being so far apart.
    pub(super) fn narrow(&mut self, apart_s: f64, without: &Run<R>) -> Result<(), EstimateError> {
        self.refine(apart_s / 2.0, COARSE_S)?;
        for _ in 0..ROUNDS {
            let at_s = self.best.change.time_s;
            self.try_sudden(without)?;
            if self.best.change.time_s == at_s {
                break;
            }
            self.refine(2.0 * COARSE_S, COARSE_S / 2.0)?;
        }
        self.fine()
    }

    /// Tries the moments close to the best one at which prediction becomes worse the most suddenly: that of the best run, and of the one that
    /// is not opened.
    pub(super) fn try_sudden(&mut self, without: &Run<R>) -> Result<(), EstimateError> {
        let at_s = self.best.change.time_s;
        let near = [(at_s - CLOSEST_S).max(self.window[0]), (at_s + CLOSEST_S).min(self.window[1])];
        let time = &self.again.task.prepared.time;
        let sudden = [&self.best.run, without].map(|run| suddenly_worse(&nats(run), time, near));
        sudden.into_iter().flatten().try_for_each(|time_s| self.try_at(time_s))
    }

    /// Looks for the best moment close to the best that was tried so far.
    pub(super) fn fine(&mut self) -> Result<(), EstimateError> {
        self.refine(COARSE_S / 2.0, FINE_S / 2.0)
    }
}

/// What a run said of each sample before it saw it, nats.
pub(super) fn nats<const R: usize>(run: &Run<R>) -> Vec<f64> {
    run.log_density.iter().map(|row| row.iter().filter(|nats| nats.is_finite()).sum()).collect()
}

/// By sample; there is at least one.
fn mean(nats: &[f64]) -> f64 {
    nats.iter().sum::<f64>() / nats.len() as f64
}

/// The moments at which a run is predicted worst over [`DIP_S`], the worst first: where a constant changes, the best moment to open
/// it is a sharp one, because a constant that is opened a second too early is known again when it changes.
pub(super) fn onsets(nats: &[f64], time: &[f64], [from_s, to_s]: [f64; 2]) -> Vec<f64> {
    let mut dips: Vec<(f64, f64)> = Vec::new();
    for (sample, time_s) in time.iter().copied().enumerate().filter(|(_, t)| (from_s..to_s).contains(t)) {
        let end = time.partition_point(|t| *t < time_s + DIP_S).min(nats.len());
        if end > sample {
            // By sample, so that a gap does not hide one.
            dips.push((time_s, mean(&nats[sample..end])));
        }
    }
    dips.sort_by(|a, b| a.1.total_cmp(&b.1));
    let mut worst: Vec<f64> = Vec::new();
    for (time_s, _) in dips {
        if worst.len() == ONSETS {
            break;
        }
        if worst.iter().all(|other| (time_s - other).abs() >= CLOSEST_S) {
            worst.push(time_s);
        }
    }
    worst
}

/// The moment in a window at which prediction becomes worse the most suddenly: the mean over [`SUDDEN_S`] after it against that before it.
fn suddenly_worse(nats: &[f64], time: &[f64], [from_s, to_s]: [f64; 2]) -> Option<f64> {
    let place = |time_s: f64| time.partition_point(|t| *t < time_s).min(nats.len());
    let drop = |sample: usize| {
        let [from, to] = [-SUDDEN_S, SUDDEN_S].map(|beside_s| place(time[sample] + beside_s));
        (from < sample && sample < to).then(|| (time[sample], mean(&nats[from..sample]) - mean(&nats[sample..to])))
    };
    (place(from_s)..place(to_s)).filter_map(drop).max_by(|a, b| a.1.total_cmp(&b.1)).map(|(time_s, _)| time_s)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A minute at 50 Hz, predicted alike but for the times that are given, with what is less there.
    fn predicted(less: &[(f64, f64, f64)]) -> (Vec<f64>, Vec<f64>) {
        let time: Vec<f64> = (0..3000).map(|k| 0.02 * f64::from(k)).collect();
        let at =
            |t: &f64| 10.0 - less.iter().filter(|(from, to, _)| (*from..*to).contains(t)).map(|l| l.2).sum::<f64>();
        (time.iter().map(at).collect(), time)
    }

    #[test]
    fn the_worst_seconds_are_told_apart_and_those_outside_do_not_count() {
        let (nats, time) = predicted(&[(5.0, 8.0, 90.0), (20.0, 21.0, 40.0), (22.0, 23.0, 30.0), (40.0, 41.0, 20.0)]);
        let [first, second] = onsets(&nats, &time, [10.0, 50.0])[..] else { panic!() };
        assert!((first - 20.0).abs() < 1e-9 && (second - 40.0).abs() < 1e-9, "{first}, {second}");
    }

    #[test]
    fn where_prediction_begins_to_fail_is_found_though_it_is_worse_later() {
        let (nats, time) = predicted(&[(28.0, 31.0, 40.0), (29.5, 31.0, 20.0)]);
        assert!((suddenly_worse(&nats, &time, [26.0, 32.0]).unwrap() - 28.0).abs() < 1e-9);
        // Outside the window, and at the ends of the record, nothing is compared.
        assert!(suddenly_worse(&nats, &time, [28.5, 29.0]).unwrap() > 28.4);
        assert_eq!(suddenly_worse(&nats, &time, [70.0, 80.0]), None);
        assert_eq!(suddenly_worse(&[], &[], [0.0, 1.0]), None);
    }
}
