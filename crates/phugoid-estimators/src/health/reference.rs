//! The reference: the model with the expected parameters, its state corrected by the measurements. As long as the
//! expectation holds its innovations are white with variance one; a failure shows in them as `a d`.

use super::assumptions::Whiteness;
use super::level::Levels;
use super::starts::{Row, Starts};
use crate::bounded::Places;
use crate::columns::Columns;
use crate::discretization::{self, IntervalInput, Part};
use crate::kernels::{add_scaled, dot};
use crate::model::{LinearizedOutputs, Model, Sample};
use crate::settings::EstimatorSettings;
use crate::supervisor::start::Start;
use crate::ud::Ud;

/// An innovation beyond this many sigmas counts with the weight that makes it this large. A failure is told from its
/// true course all the same, an outlier is worth eight nats at most, and the likelihood ratio of a normal number still
/// has a mean of at most one (the test below).
const LARGEST_INNOVATION: f64 = 4.0;

/// Weight of a normalised innovation, and of its row.
fn weight(innovation: f64) -> f64 {
    let size = innovation.abs();
    if size > LARGEST_INNOVATION { LARGEST_INNOVATION / size } else { 1.0 }
}

/// When more than half of the rows have been rejected in every frame for this long, s, the state is lost.
const LOST_STATE_S: f64 = 0.5;
/// ... and for at least this many frames.
const LOST_STATE_FRAMES: u32 = 5;

/// Columns by what the monitor does with them.
#[derive(Clone, Copy)]
pub(super) struct Parts<const P: usize> {
    /// Monitored columns.
    pub(super) monitored: Places<P>,
    /// One sigma of a failure of each, in that order.
    pub(super) failure_std: [f64; P],
    /// Which of them are constants.
    pub(super) constant: [bool; P],
    /// Columns that are estimated and not monitored (offsets, sensor biases).
    pub(super) nuisance: Places<P>,
}

pub(super) struct Reference<M, const N: usize, const R: usize, const P: usize>
where
    M: Model<N, R, P>,
{
    model: M,
    settings: EstimatorSettings<N, R, P>,
    columns: Columns<R, P>,
    output_of_state: [Option<usize>; N],
    parts: Parts<P>,
    x: [f64; N],
    /// Expected values; estimates of the nuisance columns.
    theta: [f64; P],
    /// `dx/dtheta` of the nuisance columns, raw units, in their order.
    sensitivity: [[f64; P]; N],
    px: Ud<N>,
    /// Covariance of the nuisance columns, scaled to their prior, in their order.
    c: Ud<P>,
    start: Start<M::Input, R>,
    running: bool,
    last_s: f64,
    last_input: Option<M::Input>,
    lost_since_s: f64,
    lost_frames: u32,
    whiteness: [Whiteness; R],
}

impl<M, const N: usize, const R: usize, const P: usize> Reference<M, N, R, P>
where
    M: Model<N, R, P>,
{
    /// `theta` has the expected values in the monitored columns.
    pub(super) fn new(
        model: M,
        settings: EstimatorSettings<N, R, P>,
        columns: Columns<R, P>,
        parts: Parts<P>,
        theta: [f64; P],
    ) -> Self {
        Self {
            output_of_state: settings.output_of_state(&model),
            model,
            x: settings.initial_state,
            theta,
            sensitivity: [[0.0; P]; N],
            px: Ud::from_variances(&[0.0; N]),
            c: Ud::from_variances(&[1.0; P][..parts.nuisance.len()]),
            start: Start::new(),
            running: false,
            last_s: f64::NEG_INFINITY,
            last_input: None,
            lost_since_s: 0.0,
            lost_frames: 0,
            whiteness: [Whiteness::NONE; R],
            settings,
            columns,
            parts,
        }
    }

    /// Takes a sample whose time has increased. `before_frame` may open a hypothesis at the time of the frame.
    pub(super) fn update(
        &mut self,
        sample: &Sample<M::Input, R>,
        noise_scales: &[f64; N],
        levels: &Levels<R>,
        starts: &mut Starts<N, P>,
        before_frame: impl FnOnce(&mut Starts<N, P>),
    ) {
        if !self.running {
            self.collect(sample, noise_scales, levels, starts);
            return;
        }
        let interval_s = sample.time_s - self.last_s;
        let predicted = interval_s <= self.settings.maximum_gap_s && self.predict(sample, noise_scales, starts);
        if !predicted {
            self.restart(sample, starts);
            return;
        }
        before_frame(starts);
        self.correct(sample, levels, starts);
        if self.is_lost(sample.time_s) || !self.is_sound() {
            self.restart(sample, starts);
        }
    }

    /// Uses these noise levels from now on, output units; those that are not finite and positive change nothing.
    pub(super) fn set_noise(&mut self, std: &[f64; R]) {
        for (to, from) in self.settings.noise_std.iter_mut().zip(std) {
            if from.is_finite() && *from > 0.0 {
                *to = *from;
            }
        }
    }

    /// Largest level and correlation of the innovations so far, and the fewest pairs.
    pub(super) fn seen(&self) -> [f64; 3] {
        Whiteness::worst(&self.whiteness)
    }

    /// True if the state of the reference has been started, so that frames give innovations.
    pub(super) fn is_running(&self) -> bool {
        self.running
    }

    /// Flies from now on with the most likely healthy parameters: the tolerance may be far wider than what is linear.
    /// In linear terms nothing changes.
    pub(super) fn recentre(&mut self, starts: &mut Starts<N, P>) {
        let (step, state, nuisance) = starts.recentre();
        for place in 0..self.parts.monitored.len() {
            self.theta[self.parts.monitored.column(place)] += step[place] * self.parts.failure_std[place];
        }
        for k in 0..N {
            self.x[k] += state[k];
        }
        for place in 0..self.parts.nuisance.len() {
            let column = self.parts.nuisance.column(place);
            let moved = nuisance[place] * self.columns.std[column];
            self.theta[column] += moved;
            for k in 0..N {
                self.x[k] += self.sensitivity[k][place] * moved;
            }
        }
    }

    fn collect(
        &mut self,
        sample: &Sample<M::Input, R>,
        noise_scales: &[f64; N],
        levels: &Levels<R>,
        starts: &mut Starts<N, P>,
    ) {
        self.start.push(sample);
        let Some(started) = self.start.state(&self.settings, &self.settings.noise_std, &self.output_of_state) else {
            return;
        };
        self.x = started.x;
        self.px = Ud::from_variances(&started.variances);
        self.sensitivity = [[0.0; P]; N];
        for state in 0..N {
            let Some(bias) = self.columns.bias_of(started.read_from[state]) else { continue };
            for place in 0..self.parts.nuisance.len() {
                if self.parts.nuisance.column(place) == bias {
                    self.sensitivity[state][place] = -1.0;
                    self.x[state] -= self.theta[bias];
                }
            }
        }
        let collected = core::mem::replace(&mut self.start, Start::new());
        let mut index = 0;
        self.last_input = None;
        while let Some(frame) = collected.frame(index) {
            let near = frame.time_s - self.last_s <= self.settings.maximum_gap_s;
            let sound = self.last_input.is_none() || (near && self.predict(&frame, noise_scales, starts));
            if !sound {
                // From this frame on, again.
                self.restart(&frame, starts);
                return;
            }
            self.last_s = frame.time_s;
            self.last_input = Some(frame.input);
            self.correct(&frame, levels, starts);
            index += 1;
        }
        self.running = true;
        self.lost_frames = 0;
    }

    /// The state is started again from measurements; what was learnt of the nuisance columns is kept.
    fn restart(&mut self, sample: &Sample<M::Input, R>, starts: &mut Starts<N, P>) {
        self.running = false;
        self.lost_frames = 0;
        self.start = Start::new();
        self.start.push(sample);
        if !self.c.is_sound() || !self.theta.iter().sum::<f64>().is_finite() {
            self.c = Ud::from_variances(&[1.0; P][..self.parts.nuisance.len()]);
            for place in 0..self.parts.nuisance.len() {
                let column = self.parts.nuisance.column(place);
                self.theta[column] = self.columns.initial[column];
            }
        }
        starts.forget_state();
    }

    fn is_sound(&self) -> bool {
        self.x.iter().chain(&self.theta).sum::<f64>().is_finite() && self.px.is_sound() && self.c.is_sound()
    }

    /// Whether the state no longer has to do with the measurements.
    fn is_lost(&mut self, time_s: f64) -> bool {
        if self.lost_frames == 0 {
            self.lost_since_s = time_s;
        }
        self.lost_frames >= LOST_STATE_FRAMES && time_s - self.lost_since_s >= LOST_STATE_S
    }

    /// One interval; false, and nothing done, if the model's answer is not finite.
    fn predict(&mut self, sample: &Sample<M::Input, R>, noise_scales: &[f64; N], starts: &mut Starts<N, P>) -> bool {
        let interval_s = sample.time_s - self.last_s;
        let Some(from) = self.last_input else { return false };
        let input = IntervalInput { from, to: sample.input, hold: self.settings.input_hold };
        let steps = discretization::sub_steps(interval_s, self.settings.maximum_step_s);
        let h = interval_s / steps as f64;
        let variance_per_s = self.settings.process_noise.variance_per_s;
        let q: [f64; N] = core::array::from_fn(|i| variance_per_s[i] * noise_scales[i] * h);
        let (n, f) = (self.parts.monitored.len(), self.parts.nuisance.len());
        let mut x = self.x;
        let mut px = self.px;
        let mut sensitivity = self.sensitivity;
        let mut transition = [[0.0; N]; N];
        // A and B of the whole interval, B for all columns.
        let mut whole: [[f64; N]; N] = core::array::from_fn(|i| core::array::from_fn(|j| f64::from(i == j)));
        let mut effect = [[0.0; P]; N];
        for k in 0..steps {
            let part = Part { from: k as f64 / steps as f64, to: (k + 1) as f64 / steps as f64 };
            x = discretization::step(
                &self.model,
                &x,
                &self.theta,
                &input,
                interval_s,
                part,
                self.columns.count(),
                &mut effect,
                &mut transition,
            );
            px.predict(&transition, &q);
            let before = whole;
            for i in 0..N {
                for j in 0..N {
                    whole[i][j] = (0..N).map(|l| transition[i][l] * before[l][j]).sum();
                }
            }
        }
        let mut nuisance_effect = [[0.0; P]; N];
        let mut failure_effect = [[0.0; P]; N];
        for i in 0..N {
            for place in 0..f {
                nuisance_effect[i][place] = effect[i][self.parts.nuisance.column(place)];
            }
            for place in 0..n {
                failure_effect[i][place] =
                    effect[i][self.parts.monitored.column(place)] * self.parts.failure_std[place];
            }
            let mut row = nuisance_effect[i];
            for k in 0..N {
                add_scaled(&mut row[..f], whole[i][k], &self.sensitivity[k][..f]);
            }
            sensitivity[i] = row;
        }
        let checksum = x.iter().sum::<f64>()
            + effect.iter().chain(&sensitivity).map(|row| row.iter().sum::<f64>()).sum::<f64>()
            + whole.iter().map(|row| row.iter().sum::<f64>()).sum::<f64>();
        if !checksum.is_finite() || !px.is_sound() {
            return false;
        }
        self.x = x;
        self.px = px;
        self.sensitivity = sensitivity;
        starts.predict(&whole, &failure_effect);
        self.last_s = sample.time_s;
        true
    }

    /// The frame at the present time, row by row as the estimator does it.
    fn correct(&mut self, sample: &Sample<M::Input, R>, levels: &Levels<R>, starts: &mut Starts<N, P>) {
        let previous = self.last_input.unwrap_or(sample.input);
        let input = self.settings.seen_input(previous, sample.input);
        self.last_input = Some(sample.input);
        let (n, f) = (self.parts.monitored.len(), self.parts.nuisance.len());
        let mut lin = LinearizedOutputs::<N, R, P>::ZERO;
        self.model.linearized_outputs(&self.x, &self.theta, &input, &mut lin);
        let mut dx = [0.0; N];
        let mut dnuisance = [0.0; P];
        let (mut rejected, mut present) = (0, 0);
        for i in 0..R {
            let sigma = self.settings.noise_std[i];
            let bias = self.columns.bias(i);
            let predicted = lin.outputs[i] + bias.map_or(0.0, |column| self.theta[column]);
            let last = self.whiteness[i];
            self.whiteness[i].skip();
            if !(sample.outputs[i].is_finite() && predicted.is_finite() && sigma.is_finite() && sigma > 0.0) {
                continue;
            }
            let h_row = &lin.state_jacobian[i];
            let mut by_failure = [0.0; P];
            for place in 0..n {
                let column = self.parts.monitored.column(place);
                by_failure[place] = if column < self.columns.own() {
                    lin.parameter_jacobian[i][column] * self.parts.failure_std[place]
                } else {
                    0.0
                };
            }
            let mut w = [0.0; P];
            for place in 0..f {
                let column = self.parts.nuisance.column(place);
                w[place] = if column < self.columns.own() {
                    lin.parameter_jacobian[i][column]
                } else {
                    f64::from(bias == Some(column))
                };
            }
            let mut residual = sample.outputs[i] - predicted - dot(&w[..f], &dnuisance[..f]);
            for k in 0..N {
                let factor = h_row[k];
                if factor != 0.0 {
                    residual -= factor * dx[k];
                    add_scaled(&mut w[..f], factor, &self.sensitivity[k][..f]);
                }
            }
            let r = sigma * sigma * levels.of(i);
            let state_projection = self.px.project(h_row, r);
            let s = state_projection.variance;
            let inverse_root = 1.0 / libm::sqrt(s);
            let mut psi = [0.0; P];
            for place in 0..f {
                psi[place] = w[place] * self.columns.std[self.parts.nuisance.column(place)] * inverse_root;
            }
            let projection = self.c.project(&psi, 1.0);
            let one_plus_v = projection.variance;
            let inverse_nn = 1.0 / libm::sqrt(one_plus_v);
            let xi = residual * inverse_root * inverse_nn;
            if !(xi.is_finite() && s > 0.0 && s.is_finite() && one_plus_v >= 1.0 && one_plus_v.is_finite()) {
                continue;
            }
            present += 1;
            self.whiteness[i] = last;
            self.whiteness[i].add(xi * weight(xi));
            let used = xi.abs() <= self.settings.rejection_limit;
            let mut gains = None;
            if used {
                let p_h = self.px.update(&state_projection, r);
                let c_psi = self.c.update(&projection, 1.0);
                let state_gain = p_h.map(|value| value / s);
                gains = Some((state_gain, c_psi.map(|value| value / one_plus_v)));
                let e = residual * inverse_root;
                let mut step = [0.0; P];
                for place in 0..f {
                    let std = self.columns.std[self.parts.nuisance.column(place)];
                    step[place] = std * c_psi[place] * e / one_plus_v;
                    dnuisance[place] += step[place];
                }
                for k in 0..N {
                    add_scaled(&mut self.sensitivity[k][..f], -state_gain[k], &w[..f]);
                    dx[k] += state_gain[k] * residual + dot(&self.sensitivity[k][..f], &step[..f]);
                }
            } else {
                rejected += 1;
            }
            starts.observe(&Row {
                by_state: h_row,
                by_failure: &by_failure,
                by_nuisance: &psi,
                inverse_root,
                inverse_nn,
                innovation: xi * weight(xi),
                weight: weight(xi),
                gains,
            });
        }
        for k in 0..N {
            self.x[k] += dx[k];
        }
        for place in 0..f {
            self.theta[self.parts.nuisance.column(place)] += dnuisance[place];
        }
        if 2 * rejected > present {
            self.lost_frames = self.lost_frames.saturating_add(1);
        } else if present > 0 {
            self.lost_frames = 0;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::weight;

    /// `E exp(c x m - (c m)^2/2)` with `x = c e`, `c = weight(e)`, over a normal `e`, by the midpoint rule.
    #[test]
    fn a_weighted_likelihood_ratio_has_a_mean_of_at_most_one() {
        for k in -300..=300_i32 {
            let effect = 0.05 * f64::from(k);
            let (n, reach) = (40_000, 20.0);
            let step = 2.0 * reach / f64::from(n);
            let mut mean = 0.0;
            for i in 0..n {
                let e = (f64::from(i) + 0.5) * step - reach;
                let c = weight(e);
                let exponent = c * c * e * effect - 0.5 * c * c * effect * effect - 0.5 * e * e;
                mean += libm::exp(exponent) * step / libm::sqrt(core::f64::consts::TAU);
            }
            assert!(mean <= 1.0 + 1e-9, "{effect}: {mean}");
        }
    }
}
