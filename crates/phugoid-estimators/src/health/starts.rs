//! Hypotheses "it failed at this time", each with what the innovations have said since.

use super::evidence::{Information, Limits, log_add};
use super::scatter::Scatter;
use super::settings::MonitorSettings;
use crate::kernels::{add_scaled, dot};

/// Most hypotheses at a time.
pub(super) const STARTS: usize = 48;
/// Shortest time between two hypotheses, s.
const SPACING_S: f64 = 0.02;
/// Hypotheses of age `a` are kept about `a + RECENT_S` times a constant apart: the onset is wanted to a part of what is
/// known about it.
const RECENT_S: f64 = 0.3;

/// How a deviation of the monitored columns shows in the reference. Columns are scaled to one sigma of a failure.
#[derive(Clone, Copy)]
struct Effect<const N: usize, const P: usize> {
    /// On the state, `(x - x_hat)/d`.
    sensitivity: [[f64; P]; N],
    /// On the nuisance columns (scaled to their prior) that the reference has learnt.
    learnt: [[f64; P]; P],
}

/// One hypothesis: the plant was healthy until `time_s` and has failed since.
#[derive(Clone, Copy)]
pub(super) struct FailureStart<const N: usize, const P: usize> {
    pub(super) time_s: f64,
    /// Logarithm of the share of the flight that it stands for, h.
    pub(super) log_weight: f64,
    /// How a change since `time_s` shows.
    effect: Effect<N, P>,
    /// What the innovations since then say of the change, if there is no healthy deviation beside it.
    information: Information<P>,
    /// `sum a^T a_healthy` of the change and the healthy deviation.
    cross: [[f64; P]; P],
    /// What the innovations before `time_s` say of the healthy deviation.
    before: Information<P>,
    /// The most likely healthy deviation before `time_s`.
    pub(super) healthy: [f64; P],
}

/// One output row of the reference.
pub(super) struct Row<'a, const N: usize, const P: usize> {
    /// `H` of the row: derivatives of the output by the states.
    pub(super) by_state: &'a [f64; N],
    /// `D` of the row for the monitored columns, scaled.
    pub(super) by_failure: &'a [f64; P],
    /// `psi` of the nuisance columns.
    pub(super) by_nuisance: &'a [f64; P],
    /// `1/sqrt(s)`, with `s` the variance of the row given the nuisance columns.
    pub(super) inverse_root: f64,
    /// `1/sqrt(1 + v)`, with `v` the share of the nuisance columns in that variance.
    pub(super) inverse_nn: f64,
    /// Normalised innovation times its weight, of bounded size.
    pub(super) innovation: f64,
    /// That weight, at most one.
    pub(super) weight: f64,
    /// `K` and `C psi^T/(1 + v)`, if the reference was corrected by the row.
    pub(super) gains: Option<([f64; N], [f64; P])>,
}

#[derive(Clone)]
pub(super) struct Starts<const N: usize, const P: usize> {
    slots: [FailureStart<N, P>; STARTS],
    /// Slots in use, oldest first.
    order: [usize; STARTS],
    count: usize,
    monitored: usize,
    nuisance: usize,
    limits: Limits<P>,
    /// Point about which deviations are counted, scaled; zero, the expected values, at first.
    centre: [f64; P],
    last_opened_s: f64,
    /// How a deviation shows that has been there since the start of the monitor.
    always: Effect<N, P>,
    /// What all innovations since the start of the monitor say of a healthy deviation.
    healthy: Information<P>,
    scatter: Scatter<P>,
    /// One over the scatter in use.
    temper: f64,
}

impl<const N: usize, const P: usize> Effect<N, P> {
    const NONE: Self = Self { sensitivity: [[0.0; P]; N], learnt: [[0.0; P]; P] };

    fn forget_state(&mut self, n: usize) {
        let n = n.min(P);
        for row in &mut self.sensitivity {
            row[..n].fill(0.0);
        }
    }

    /// `U <- A U + B`.
    fn predict(&mut self, transition: &[[f64; N]; N], effect: &[[f64; P]; N], n: usize) {
        let n = n.min(P);
        let before = self.sensitivity;
        for i in 0..N {
            let row = &mut self.sensitivity[i][..n];
            row.copy_from_slice(&effect[i][..n]);
            for k in 0..N {
                add_scaled(row, transition[i][k], &before[k][..n]);
            }
        }
    }

    /// How the deviation shows in a row, normalised and weighted; then the row's correction is taken into account.
    fn observe(&mut self, row: &Row<'_, N, P>, n: usize, nuisance: usize) -> [f64; P] {
        let (n, nuisance) = (n.min(P), nuisance.min(P));
        let mut w = [0.0; P];
        w[..n].copy_from_slice(&row.by_failure[..n]);
        for k in 0..N {
            if row.by_state[k] != 0.0 {
                add_scaled(&mut w[..n], row.by_state[k], &self.sensitivity[k][..n]);
            }
        }
        // What the nuisance columns have taken of it is missing in the innovation.
        let mut psi = [0.0; P];
        add_scaled(&mut psi[..n], row.inverse_root, &w[..n]);
        for f in 0..nuisance {
            add_scaled(&mut psi[..n], -row.by_nuisance[f], &self.learnt[f][..n]);
        }
        if let Some((state_gain, nuisance_gain)) = &row.gains {
            for k in 0..N {
                add_scaled(&mut self.sensitivity[k][..n], -state_gain[k], &w[..n]);
            }
            for f in 0..nuisance {
                add_scaled(&mut self.learnt[f][..n], nuisance_gain[f], &psi[..n]);
            }
        }
        let scale = row.inverse_nn * row.weight;
        psi.map(|value| value * scale)
    }
}

impl<const N: usize, const P: usize> FailureStart<N, P> {
    const EMPTY: Self = Self {
        time_s: 0.0,
        log_weight: 0.0,
        effect: Effect::NONE,
        information: Information::NONE,
        cross: [[0.0; P]; P],
        before: Information::NONE,
        healthy: [0.0; P],
    };

    /// On the change, beside the healthy deviation of before.
    pub(super) fn change(&self, len: usize) -> Information<P> {
        let len = len.min(P);
        let mut information = self.information;
        for i in 0..len {
            information.g[i] -= dot(&self.cross[i][..len], &self.healthy[..len]);
        }
        information
    }
}

impl<const N: usize, const P: usize> Starts<N, P> {
    /// `width`: half widths of the tolerances over one sigma of a failure.
    pub(super) fn new(monitored: usize, nuisance: usize, width: [f64; P], settings: &MonitorSettings) -> Self {
        Self {
            slots: [FailureStart::EMPTY; STARTS],
            order: core::array::from_fn(|i| i),
            count: 0,
            monitored: monitored.min(P),
            nuisance: nuisance.min(P),
            limits: Limits::symmetric(&width),
            centre: [0.0; P],
            last_opened_s: f64::NAN,
            always: Effect::NONE,
            healthy: Information::NONE,
            scatter: Scatter::new(settings.scatter, settings.scatter_weight),
            temper: 1.0 / settings.scatter.max(1.0),
        }
    }

    /// Number of monitored columns, at most `P`, which the compiler cannot know of a field.
    #[inline(always)]
    fn monitored(&self) -> usize {
        self.monitored.min(P)
    }

    /// Number of nuisance columns, at most `P`.
    #[inline(always)]
    fn nuisance(&self) -> usize {
        self.nuisance.min(P)
    }

    /// The slot of the hypothesis at a place in the order of time.
    #[inline(always)]
    fn slot(&self, place: usize) -> usize {
        self.order.get(place).map_or(0, |slot| (*slot).min(STARTS - 1))
    }

    /// What the scatter was in this flight, and the degrees of freedom that it comes from.
    pub(super) fn scatter(&self) -> [f64; 2] {
        self.scatter.seen()
    }

    /// Looks whether the innovations scatter more than they should; the evidence allows for it from now on.
    pub(super) fn look_at_scatter(&mut self, time_s: f64) {
        self.scatter.look(time_s, &self.healthy, &self.limits, self.monitored());
        self.temper = 1.0 / self.scatter.in_use();
    }

    /// What the innovations since a hypothesis began say of a change, with the scatter in use.
    pub(super) fn change(&self, start: &FailureStart<N, P>) -> Information<P> {
        start.change(self.monitored()).scaled(self.temper, self.monitored())
    }

    /// What the innovations say of a healthy deviation since a hypothesis began.
    fn healthy_since(&self, start: &FailureStart<N, P>) -> Information<P> {
        self.healthy.since(&start.before, self.monitored()).scaled(self.temper, self.monitored())
    }

    /// `ln F`: mean likelihood of a failure since `start` over that of no deviation at all, the healthy deviation of
    /// before taken for granted.
    fn failure(&self, start: &FailureStart<N, P>) -> f64 {
        let n = self.monitored();
        self.healthy_since(start).log_likelihood(&start.healthy, n) + self.change(start).failure(n)
    }

    /// `ln E`: the same over the best healthy deviation since then. Minus infinity where it is less than `least`.
    pub(super) fn evidence(&self, start: &FailureStart<N, P>, least: f64) -> f64 {
        let n = self.monitored();
        // What was healthy before explains no more than the best healthy deviation does.
        let most = self.change(start).failure(n);
        if most < least {
            return f64::NEG_INFINITY;
        }
        let since = self.healthy_since(start);
        let (best, _) = since.best_within(&self.limits, n);
        since.log_likelihood(&start.healthy, n) + most - best
    }

    /// Mean square of what the failure leaves of the innovations since then.
    pub(super) fn misfit(&self, start: &FailureStart<N, P>) -> f64 {
        let n = self.monitored();
        let since = self.healthy_since(start);
        let mut left = self.change(start);
        // What the healthy deviation explains is no misfit either.
        left.square = since.square - 2.0 * since.log_likelihood(&start.healthy, n);
        left.misfit(n)
    }

    /// Log likelihood of the whole flight with the failure at `start`.
    pub(super) fn whole(&self, start: &FailureStart<N, P>) -> f64 {
        start.before.log_likelihood(&start.healthy, self.monitored()) * self.temper + self.failure(start)
    }

    /// Between what deviations from the centre count as healthy.
    pub(super) fn limits(&self) -> &Limits<P> {
        &self.limits
    }

    /// Where deviations are counted from, from the expected values.
    pub(super) fn centre(&self) -> &[f64; P] {
        &self.centre
    }

    /// Counts deviations from the most likely healthy one on, so that what is linear in them need not reach far.
    /// Changes no likelihood. Gives the step of the centre, and what it does to the state and to the nuisance columns
    /// (scaled).
    pub(super) fn recentre(&mut self) -> ([f64; P], [f64; N], [f64; P]) {
        let n = self.monitored();
        let (_, step) = self.healthy.best_within(&self.limits, n);
        self.healthy.recentre(&step, n);
        self.scatter.recentre(&step, n);
        for slot in &self.order[..self.count.min(STARTS)] {
            let start = &mut self.slots[(*slot).min(STARTS - 1)];
            start.before.recentre(&step, n);
            for i in 0..n {
                start.information.g[i] -= dot(&start.cross[i][..n], &step[..n]);
                start.healthy[i] -= step[i];
            }
        }
        for i in 0..n {
            self.centre[i] += step[i];
            self.limits.low[i] -= step[i];
            self.limits.high[i] -= step[i];
        }
        let state = core::array::from_fn(|k| dot(&self.always.sensitivity[k][..n], &step[..n]));
        let mut nuisance = [0.0; P];
        for f in 0..self.nuisance() {
            nuisance[f] = -dot(&self.always.learnt[f][..n], &step[..n]);
        }
        (step, state, nuisance)
    }

    /// All hypotheses in use, the oldest one first.
    pub(super) fn iter(&self) -> impl DoubleEndedIterator<Item = &FailureStart<N, P>> {
        self.order[..self.count.min(STARTS)].iter().map(|slot| &self.slots[(*slot).min(STARTS - 1)])
    }

    /// The hypothesis at a place in the order of time; `None` if there are fewer.
    pub(super) fn get(&self, index: usize) -> Option<&FailureStart<N, P>> {
        self.order[..self.count.min(STARTS)].get(index).map(|slot| &self.slots[(*slot).min(STARTS - 1)])
    }

    pub(super) fn clear(&mut self) {
        self.count = 0;
        self.last_opened_s = f64::NAN;
        self.healthy = Information::NONE;
        self.scatter.begin_block();
    }

    /// A new hypothesis that begins with the frame at `time_s`, if the last one is old enough.
    pub(super) fn open(&mut self, time_s: f64, horizon_s: f64) {
        let since = time_s - self.last_opened_s;
        if since < SPACING_S - 1e-9 {
            return;
        }
        while self.count > 1 && time_s - self.slots[self.slot(0)].time_s > horizon_s {
            self.remove(0);
        }
        if self.count >= STARTS {
            self.thin(time_s);
        }
        let slot = self.slot(self.count);
        let new = &mut self.slots[slot];
        new.time_s = time_s;
        // The evidence of all hypotheses together may grow by no more than the time that passes.
        new.log_weight = libm::log(if since.is_finite() { since } else { SPACING_S } / 3600.0);
        new.effect = Effect::NONE;
        new.information = Information::NONE;
        new.cross = [[0.0; P]; P];
        new.before = self.healthy;
        (_, new.healthy) = self.healthy.best_within(&self.limits, self.monitored.min(P));
        self.count += 1;
        self.last_opened_s = time_s;
    }

    /// Drops the hypothesis whose neighbours are closest together for their age, and gives its evidence to one of them.
    fn thin(&mut self, time_s: f64) {
        let time = |place: usize| self.slots[self.slot(place)].time_s;
        let mut chosen = (f64::INFINITY, 1);
        for place in 1..self.count - 1 {
            let closeness = (time(place + 1) - time(place - 1)) / (time_s - time(place) + RECENT_S);
            if closeness < chosen.0 {
                chosen = (closeness, place);
            }
        }
        self.bequeath(chosen.1);
        self.remove(chosen.1);
    }

    /// Gives the evidence of a hypothesis that is about to be dropped to the neighbour whose weight grows most by it.
    /// From then on it grows as the neighbour's does, and its mean stays what it was. For a healthy deviation `d` it is
    /// `w F_i/L_i(d)`, `F` the likelihood of a failure and `L(d)` that of `d`, and becomes `w' F_j/L_j(d)`. So `w'` is
    /// `w F_i/F_j`, less what `L_i(d)/L_j(d)` can be at most within the tolerances.
    fn bequeath(&mut self, place: usize) {
        let n = self.monitored();
        let own = &self.slots[self.slot(place)];
        let failure = self.failure(own);
        let mut heir = (f64::NEG_INFINITY, place);
        for neighbour in [place.wrapping_sub(1), place + 1] {
            let Some(other) = self.get(neighbour) else { continue };
            let between = own.before.since(&other.before, n).scaled(self.temper, n);
            let mut most = 0.0;
            let reach = |i: usize| self.limits.high[i].abs().max(self.limits.low[i].abs());
            for i in 0..n {
                most += between.g[i].abs() * reach(i);
                for j in 0..=i {
                    let part = between.m[i][j].abs() * reach(i) * reach(j);
                    most += if i == j { 0.5 * part } else { part };
                }
            }
            let log_weight = own.log_weight + failure - self.failure(other) - most;
            // Evidence that cannot be computed is given to no neighbour. An alarm can only become later by that, never
            // more frequent.
            if log_weight.is_finite() && log_weight > heir.0 {
                heir = (log_weight, neighbour);
            }
        }
        if heir.1 != place {
            let slot = self.slot(heir.1);
            let other = &mut self.slots[slot];
            other.log_weight = log_add(other.log_weight, heir.0);
        }
    }

    fn remove(&mut self, place: usize) {
        let count = self.count.min(STARTS);
        if place < count {
            self.order[place..count].rotate_left(1);
            self.count = count - 1;
        }
    }

    /// The state was started again from measurements: no deviation is in it yet.
    pub(super) fn forget_state(&mut self) {
        self.always.forget_state(self.monitored());
        for slot in &self.order[..self.count.min(STARTS)] {
            self.slots[(*slot).min(STARTS - 1)].effect.forget_state(self.monitored());
        }
    }

    /// One interval: `U <- A U + B`, with `B` of the monitored columns, scaled.
    pub(super) fn predict(&mut self, transition: &[[f64; N]; N], effect: &[[f64; P]; N]) {
        self.always.predict(transition, effect, self.monitored());
        for slot in &self.order[..self.count.min(STARTS)] {
            self.slots[(*slot).min(STARTS - 1)].effect.predict(transition, effect, self.monitored());
        }
    }

    /// Adds one output row to every hypothesis.
    pub(super) fn observe(&mut self, row: &Row<'_, N, P>) {
        let (n, nuisance) = (self.monitored(), self.nuisance());
        let healthy = self.always.observe(row, n, nuisance);
        self.healthy.add(&healthy, row.innovation, n);
        self.scatter.add(&healthy, row.innovation, n);
        for slot in &self.order[..self.count.min(STARTS)] {
            let start = &mut self.slots[(*slot).min(STARTS - 1)];
            let change = start.effect.observe(row, n, nuisance);
            start.information.add(&change, row.innovation, n);
            for i in 0..n {
                add_scaled(&mut start.cross[i][..n], change[i], &healthy[..n]);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    extern crate std;

    use super::{Row, STARTS, Starts};
    use crate::health::settings::MonitorSettings;
    use std::vec::Vec;

    fn starts() -> Starts<1, 2> {
        Starts::new(2, 1, [0.5, 0.5], &MonitorSettings::default())
    }

    fn observe(starts: &mut Starts<1, 2>, innovation: f64) {
        starts.predict(&[[0.9]], &[[0.02, 0.0]]);
        starts.observe(&Row {
            by_state: &[1.0],
            by_failure: &[0.0, 0.3],
            by_nuisance: &[0.1, 0.0],
            inverse_root: 2.0,
            inverse_nn: 0.8,
            innovation,
            weight: 1.0,
            gains: Some(([0.2], [0.05, 0.0])),
        });
    }

    /// The order is one of all slots, each once, and those in use are in the order of time.
    fn check(starts: &Starts<1, 2>) {
        let mut slots = starts.order;
        slots.sort_unstable();
        assert!(slots.iter().enumerate().all(|(i, slot)| i == *slot), "{slots:?}");
        assert!(starts.count <= STARTS);
        let times: Vec<f64> = starts.iter().map(|start| start.time_s).collect();
        assert_eq!(times.len(), starts.count);
        assert!(times.windows(2).all(|pair| pair[0] < pair[1]), "{times:?}");
        for (place, time) in times.iter().enumerate() {
            assert_eq!(starts.get(place).map(|start| start.time_s), Some(*time));
        }
        assert!(starts.get(times.len()).is_none());
    }

    /// Far more hypotheses than there is room for: the newest is always there, the oldest is not older than the horizon
    /// by more than one spacing, those between are the sparser the older they are, and their evidence is handed on.
    #[test]
    fn hypotheses_are_thinned_and_stay_in_order() {
        let (horizon_s, frames) = (2.0, if cfg!(miri) { 52 } else { 400 });
        let (mut starts, mut most) = (starts(), 0);
        for k in 0..frames {
            let time_s = 0.02 * f64::from(k);
            starts.open(time_s, horizon_s);
            observe(&mut starts, if k % 3 == 0 { 0.5 } else { -0.2 });
            check(&starts);
            assert_eq!(starts.iter().next_back().map(|start| start.time_s), Some(time_s));
            let oldest = starts.iter().next().map(|start| start.time_s);
            assert!(oldest.is_some_and(|oldest| oldest >= time_s - horizon_s - 1e-9), "{oldest:?} {time_s}");
            most = most.max(starts.count);
        }
        assert_eq!(most, STARTS);
        let times: Vec<f64> = starts.iter().map(|start| start.time_s).collect();
        let last = times.len() - 1;
        let (oldest, newest) = (times[1] - times[0], times[last] - times[last - 1]);
        assert!(oldest > newest, "{times:?}");
        assert!(starts.iter().all(|start| start.log_weight.is_finite() && starts.whole(start).is_finite()));
        starts.recentre();
        starts.forget_state();
        starts.clear();
        check(&starts);
        assert_eq!(starts.count, 0);
        // Too soon after the last one none is opened.
        starts.open(1.0, horizon_s);
        starts.open(1.01, horizon_s);
        assert_eq!(starts.count, 1);
        check(&starts);
    }

    /// Any hypothesis may be removed, the others stay as they were.
    #[test]
    fn any_hypothesis_may_be_removed() {
        for place in 0..6 {
            let mut starts = starts();
            (0..5).for_each(|k| starts.open(f64::from(k), 100.0));
            let mut times: Vec<f64> = starts.iter().map(|start| start.time_s).collect();
            starts.remove(place);
            if place < times.len() {
                times.remove(place);
            }
            check(&starts);
            assert_eq!(starts.iter().map(|start| start.time_s).collect::<Vec<_>>(), times);
        }
    }
}
