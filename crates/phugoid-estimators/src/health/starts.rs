//! Hypotheses "it failed at this time", each with what the innovations have said since.

use super::evidence::{Information, log_add};

/// Most hypotheses at a time.
pub(super) const STARTS: usize = 48;
/// Closest two hypotheses, s.
const SPACING_S: f64 = 0.02;
/// Hypotheses of age `a` are kept about `a + RECENT_S` times a constant apart: the onset is wanted to a part of what is known
/// about it.
const RECENT_S: f64 = 0.3;

/// One hypothesis. Columns are those that are monitored, scaled to one sigma of a failure.
#[derive(Clone, Copy)]
pub(super) struct FailureStart<const N: usize, const P: usize> {
    pub(super) time_s: f64,
    /// Logarithm of the share of the flight that it stands for, h.
    pub(super) log_weight: f64,
    /// Effect of a failure since `time_s` on the state, `(x - x_hat)/d`.
    sensitivity: [[f64; P]; N],
    /// Effect on the nuisance columns (scaled to their prior) that the reference has learnt since.
    learnt: [[f64; P]; P],
    pub(super) information: Information<P>,
}

/// One output row of the reference.
pub(super) struct Row<'a, const N: usize, const P: usize> {
    /// `H` of the row.
    pub(super) by_state: &'a [f64; N],
    /// `D` of the row for the monitored columns, scaled.
    pub(super) by_failure: &'a [f64; P],
    /// `psi` of the nuisance columns.
    pub(super) by_nuisance: &'a [f64; P],
    /// `1/sqrt(s)`.
    pub(super) inverse_root: f64,
    /// `1/sqrt(1 + v)`.
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
    width: [f64; P],
    last_opened_s: f64,
}

impl<const N: usize, const P: usize> Starts<N, P> {
    /// `width`: half widths of the tolerances over one sigma of a failure.
    pub(super) fn new(monitored: usize, nuisance: usize, width: [f64; P]) -> Self {
        let empty = FailureStart {
            time_s: 0.0,
            log_weight: 0.0,
            sensitivity: [[0.0; P]; N],
            learnt: [[0.0; P]; P],
            information: Information::NONE,
        };
        Self {
            slots: [empty; STARTS],
            order: core::array::from_fn(|i| i),
            count: 0,
            monitored: monitored.min(P),
            nuisance: nuisance.min(P),
            width,
            last_opened_s: f64::NAN,
        }
    }

    /// All, oldest first.
    pub(super) fn iter(&self) -> impl Iterator<Item = &FailureStart<N, P>> {
        self.order[..self.count].iter().map(|slot| &self.slots[*slot])
    }

    /// The one at a place in the order of time.
    pub(super) fn get(&self, index: usize) -> Option<&FailureStart<N, P>> {
        self.order[..self.count].get(index).map(|slot| &self.slots[*slot])
    }

    pub(super) fn clear(&mut self) {
        self.count = 0;
        self.last_opened_s = f64::NAN;
    }

    /// A new hypothesis that begins with the frame at `time_s`, if the last one is old enough.
    pub(super) fn open(&mut self, time_s: f64, horizon_s: f64) {
        let since = time_s - self.last_opened_s;
        if since < SPACING_S - 1e-9 {
            return;
        }
        while self.count > 1 && time_s - self.slots[self.order[0]].time_s > horizon_s {
            self.remove(0);
        }
        if self.count == STARTS {
            self.thin(time_s);
        }
        let slot = self.order[self.count];
        let new = &mut self.slots[slot];
        new.time_s = time_s;
        // The evidence of all hypotheses together may grow by no more than the time that passes.
        new.log_weight = libm::log(if since.is_finite() { since } else { SPACING_S } / 3600.0);
        for row in &mut new.sensitivity {
            row[..self.monitored].fill(0.0);
        }
        for row in &mut new.learnt[..self.nuisance] {
            row[..self.monitored].fill(0.0);
        }
        (new.information.square, new.information.rows) = (0.0, 0.0);
        new.information.g[..self.monitored].fill(0.0);
        for row in &mut new.information.m[..self.monitored] {
            row[..self.monitored].fill(0.0);
        }
        self.count += 1;
        self.last_opened_s = time_s;
    }

    /// Drops the one whose neighbours are closest together for their age, and hands its evidence to one of them.
    fn thin(&mut self, time_s: f64) {
        let time = |place: usize| self.slots[self.order[place]].time_s;
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

    /// The evidence of a hypothesis that is dropped goes to the neighbour that can make more of it: from now on it grows as that
    /// one does, and its mean stays what it was. For a healthy deviation `d` it is `w F_i/L_i(d)`, `F` the likelihood of a
    /// failure and `L(d)` that of `d`, and becomes `w' F_j/L_j(d)`. So `w'` is `w F_i/F_j`, less what `L_i(d)/L_j(d)` can be at
    /// most within the tolerances.
    fn bequeath(&mut self, place: usize) {
        let n = self.monitored;
        let own = self.slots[self.order[place]];
        let failure = own.information.failure(n);
        let mut heir = (f64::NEG_INFINITY, place);
        for neighbour in [place.wrapping_sub(1), place + 1] {
            let Some(other) = self.get(neighbour) else { continue };
            let mut most = 0.0;
            for i in 0..n {
                most += (own.information.g[i] - other.information.g[i]).abs() * self.width[i];
                for j in 0..=i {
                    let part =
                        (own.information.m[i][j] - other.information.m[i][j]).abs() * self.width[i] * self.width[j];
                    most += if i == j { 0.5 * part } else { part };
                }
            }
            let log_weight = own.log_weight + failure - other.information.failure(n) - most;
            // What is not a number is nobody's: an alarm only becomes later.
            if log_weight.is_finite() && log_weight > heir.0 {
                heir = (log_weight, neighbour);
            }
        }
        if heir.1 != place && self.count > heir.1 {
            let other = &mut self.slots[self.order[heir.1]];
            other.log_weight = log_add(other.log_weight, heir.0);
        }
    }

    fn remove(&mut self, place: usize) {
        self.order[place..self.count].rotate_left(1);
        self.count -= 1;
    }

    /// The state was started again from measurements: no failure is in it yet.
    pub(super) fn forget_state(&mut self) {
        for slot in &self.order[..self.count] {
            for row in &mut self.slots[*slot].sensitivity {
                row[..self.monitored].fill(0.0);
            }
        }
    }

    /// `U <- A U + B`, with `B` of the monitored columns, scaled.
    pub(super) fn predict(&mut self, transition: &[[f64; N]; N], effect: &[[f64; P]; N]) {
        let n = self.monitored;
        for slot in &self.order[..self.count] {
            let start = &mut self.slots[*slot];
            let before = start.sensitivity;
            for i in 0..N {
                let row = &mut start.sensitivity[i][..n];
                row.copy_from_slice(&effect[i][..n]);
                for k in 0..N {
                    let factor = transition[i][k];
                    for (value, old) in row.iter_mut().zip(&before[k][..n]) {
                        *value += factor * old;
                    }
                }
            }
        }
    }

    /// Adds one output row to every hypothesis.
    pub(super) fn observe(&mut self, row: &Row<'_, N, P>) {
        let n = self.monitored;
        for slot in &self.order[..self.count] {
            let start = &mut self.slots[*slot];
            let mut w = [0.0; P];
            w[..n].copy_from_slice(&row.by_failure[..n]);
            for k in 0..N {
                let factor = row.by_state[k];
                if factor != 0.0 {
                    for (value, u) in w[..n].iter_mut().zip(&start.sensitivity[k][..n]) {
                        *value += factor * u;
                    }
                }
            }
            // What the nuisance columns have taken of it is missing in the innovation.
            let mut psi = [0.0; P];
            for (value, w) in psi[..n].iter_mut().zip(&w[..n]) {
                *value = row.inverse_root * w;
            }
            for f in 0..self.nuisance {
                let factor = row.by_nuisance[f];
                for (value, learnt) in psi[..n].iter_mut().zip(&start.learnt[f][..n]) {
                    *value -= factor * learnt;
                }
            }
            let information = &mut start.information;
            let scale = row.inverse_nn * row.weight;
            information.square += row.innovation * row.innovation;
            information.rows += 1.0;
            for i in 0..n {
                let a = psi[i] * scale;
                information.g[i] += a * row.innovation;
                let scaled = a * scale;
                for (value, other) in information.m[i][..=i].iter_mut().zip(&psi[..=i]) {
                    *value += scaled * other;
                }
            }
            if let Some((state_gain, nuisance_gain)) = &row.gains {
                for k in 0..N {
                    let factor = state_gain[k];
                    for (value, w) in start.sensitivity[k][..n].iter_mut().zip(&w[..n]) {
                        *value -= factor * w;
                    }
                }
                for f in 0..self.nuisance {
                    let factor = nuisance_gain[f];
                    for (value, psi) in start.learnt[f][..n].iter_mut().zip(&psi[..n]) {
                        *value += factor * psi;
                    }
                }
            }
        }
    }
}
