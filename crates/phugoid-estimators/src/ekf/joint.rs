//! One joint covariance of state and parameters, and the arithmetic of one gated row.

use crate::bounded::at;
use crate::columns::Columns;
use crate::discretization::{self, IntervalInput, Part};
use crate::innovation::{Innovations, RowPhase, ScoredRow};
use crate::kernels::{add_scaled, chain, dot, is_full};
use crate::levels::{Frame, Levels};
use crate::model::{LinearizedOutputs, Model};
use crate::settings::{EstimatorSettings, SettingsError};
use crate::supervisor::common::{Common, NoiseScore};
use crate::supervisor::faults::Watch;
use crate::supervisor::slot::{Followed, Follower, Slot, UsedRow};
use crate::ud::Ud;

/// The joint covariance in blocks; columns of the parameters are scaled to their prior standard deviation.
#[derive(Clone, Copy, Debug)]
pub struct Joint<const N: usize, const P: usize> {
    common: Common<N, P>,
    covariance: Blocks<N, P>,
}

/// `[Pxx, Pxt; Ptx, Ptt]`: the lower triangle of the parameters and states in this order.
#[derive(Clone, Copy, Debug)]
struct Blocks<const N: usize, const P: usize> {
    columns: usize,
    /// State covariance `Pxx`, lower triangle, state units.
    xx: [[f64; N]; N],
    /// Row = state, column = parameter.
    xt: [[f64; P]; N],
    /// Parameter covariance `Ptt`, lower triangle, scaled columns.
    tt: [[f64; P]; P],
}

/// A vector over the joint state.
#[derive(Clone, Copy)]
struct Stacked<const N: usize, const P: usize> {
    x: [f64; N],
    t: [f64; P],
}

impl<const N: usize, const P: usize> Blocks<N, P> {
    /// Columns in use, at most `P`.
    #[inline(always)]
    fn columns(&self) -> usize {
        self.columns.min(P)
    }

    /// Column `j` of `Ptt`, of which the first `p` entries are filled.
    #[inline(always)]
    fn parameter_column(&self, p: usize, j: usize) -> [f64; P] {
        let mut out = [0.0; P];
        if j < P {
            out[..=j].copy_from_slice(&self.tt[j][..=j]);
            for i in j + 1..p.min(P) {
                out[i] = self.tt[i][j];
            }
        }
        out
    }

    /// Product `P a` of the joint covariance with a row.
    #[inline(never)]
    fn times(&self, p: usize, a: &Stacked<N, P>) -> Stacked<N, P> {
        if p >= P { self.times_of(P, a) } else { self.times_of(p.min(P), a) }
    }

    /// Most rows measure one state, or a state and a few parameters: the zeros are worth a test.
    #[inline(always)]
    fn times_of(&self, p: usize, a: &Stacked<N, P>) -> Stacked<N, P> {
        let mut out = Stacked { x: [0.0; N], t: [0.0; P] };
        for k in 0..N {
            let factor = a.x[k];
            if factor != 0.0 {
                add_scaled(&mut out.t[..p], factor, &self.xt[k][..p]);
                for l in 0..N {
                    out.x[l] += factor * if l <= k { self.xx[k][l] } else { self.xx[l][k] };
                }
            }
        }
        for j in 0..p {
            let factor = a.t[j];
            if factor != 0.0 {
                add_scaled(&mut out.t[..=j], factor, &self.tt[j][..=j]);
                for i in j + 1..p {
                    out.t[i] += factor * self.tt[i][j];
                }
                for k in 0..N {
                    out.x[k] += factor * self.xt[k][j];
                }
            }
        }
        out
    }

    /// Joseph's form for a scalar measurement, `P <- (I - K a) P (I - K a)^T + K r K^T`, as Bierman writes it (the
    /// stabilised Kalman update; G. J. Bierman, *Factorization Methods*, 1977, ch. III): `v = P a`, `K = v/s`,
    /// ```text
    /// Q = P - K v^T,   w = Q a,   P <- Q + K e^T + e K^T,   e = (r K - w)/2
    /// ```
    /// `e` is zero but for the rounding of `Q`, and takes it back.
    #[inline(never)]
    fn update(&mut self, p: usize, a: &Stacked<N, P>, v: &Stacked<N, P>, inverse_s: f64, r: f64) {
        if p >= P { self.update_of(P, a, v, inverse_s, r) } else { self.update_of(p, a, v, inverse_s, r) }
    }

    #[inline(always)]
    fn update_of(&mut self, p: usize, a: &Stacked<N, P>, v: &Stacked<N, P>, inverse_s: f64, r: f64) {
        let gain = Stacked { x: v.x.map(|value| value * inverse_s), t: v.t.map(|value| value * inverse_s) };
        for j in 0..p {
            add_scaled(&mut self.tt[j][..=j], -gain.t[j], &v.t[..=j]);
        }
        for k in 0..N {
            add_scaled(&mut self.xt[k][..p], -gain.x[k], &v.t[..p]);
            for l in 0..=k {
                self.xx[k][l] -= gain.x[k] * v.x[l];
            }
        }
        let w = self.times_of(p, a);
        let mut e = Stacked { x: [0.0; N], t: [0.0; P] };
        for (e, (w, gain)) in e.t[..p].iter_mut().zip(w.t[..p].iter().zip(&gain.t[..p])) {
            *e = 0.5 * (r * gain - w);
        }
        for k in 0..N {
            e.x[k] = 0.5 * (r * gain.x[k] - w.x[k]);
        }
        for j in 0..p {
            let row = &mut self.tt[j][..=j];
            add_scaled(row, gain.t[j], &e.t[..=j]);
            add_scaled(row, e.t[j], &gain.t[..=j]);
        }
        for k in 0..N {
            let row = &mut self.xt[k][..p];
            add_scaled(row, gain.x[k], &e.t[..p]);
            add_scaled(row, e.x[k], &gain.t[..p]);
            for l in 0..=k {
                self.xx[k][l] += gain.x[k] * e.x[l] + e.x[k] * gain.x[l];
            }
        }
    }

    /// `F P F^T + q`, with `F = [A, B; 0, I]`: `Pxt' = A Pxt + B Ptt`, `Pxx' = (A Pxx + B Ptx) A^T + Pxt' B^T + q`.
    /// `b` is scaled as the columns are; its entries from `own` on are zero.
    fn predict(&mut self, own: usize, a: &[[f64; N]; N], b: &[[f64; P]; N], q: &[f64; N]) {
        let (p, own) = (self.columns(), own.min(P));
        let mut xt = [[0.0; P]; N];
        let mut g = [[0.0; N]; N];
        for k in 0..N {
            let row = &mut xt[k];
            for i in 0..own {
                // Row i of the lower triangle gives to both sides of the diagonal.
                let factor = b[k][i];
                row[i] += dot(&self.tt[i][..=i], &b[k][..=i]);
                add_scaled(&mut row[..i], factor, &self.tt[i][..i]);
            }
            for i in own..p {
                row[i] = dot(&self.tt[i][..own], &b[k][..own]);
            }
            for l in 0..N {
                add_scaled(&mut row[..p], a[k][l], &self.xt[l][..p]);
                g[k][l] = dot(&b[k][..own], &self.xt[l][..own]);
                for m in 0..N {
                    g[k][l] += a[k][m] * if l <= m { self.xx[m][l] } else { self.xx[l][m] };
                }
            }
        }
        for k in 0..N {
            for l in 0..=k {
                self.xx[k][l] = dot(&xt[k][..own], &b[l][..own]);
                for m in 0..N {
                    self.xx[k][l] += g[k][m] * a[l][m];
                }
            }
            self.xx[k][k] += q[k];
        }
        self.xt = xt;
    }

    fn is_sound(&self) -> bool {
        let p = self.columns();
        // Zero times a number is zero only if it is finite.
        let mut check = 0.0;
        let mut least = 0.0_f64;
        for k in 0..N {
            check += self.xx[k][..=k].iter().map(|v| 0.0 * v).sum::<f64>();
            check += self.xt[k][..p].iter().map(|v| 0.0 * v).sum::<f64>();
            least = least.min(self.xx[k][k]);
        }
        for j in 0..p {
            check += self.tt[j][..=j].iter().map(|v| 0.0 * v).sum::<f64>();
            least = least.min(self.tt[j][j]);
        }
        check == 0.0 && least >= 0.0
    }
}

/// The same Gauss distribution seen from the parameters, `x | theta ~ N(x + U (theta - thetahat), Px)`: the
/// supervisor's detector and colour correction ask for the sensitivity of a row *given* the parameters. `U = Pxt
/// Ptt^-1` once per frame, then row by row.
struct Conditional<const N: usize, const P: usize> {
    sensitivity: [[f64; P]; N],
    px: [[f64; N]; N],
}

impl<const N: usize, const P: usize> Conditional<N, P> {
    #[inline(always)]
    fn new(p: usize, blocks: &Blocks<N, P>) -> Self {
        let factors = Ud::from_lower_triangle(&blocks.tt, p);
        let mut sensitivity = blocks.xt;
        let mut px = [[0.0; N]; N];
        for k in 0..N {
            factors.solve(&mut sensitivity[k]);
            for l in 0..=k {
                px[k][l] = blocks.xx[k][l] - dot(&sensitivity[k][..p], &blocks.xt[l][..p]);
                px[l][k] = px[k][l];
            }
        }
        Self { sensitivity, px }
    }

    /// `w = H U + D` over `w`, which holds `D`; gives `Px H^T` and `s = H Px H^T + r`, never below `r`.
    #[inline(always)]
    fn project(&self, p: usize, h: &[f64; N], r: f64, w: &mut [f64; P]) -> ([f64; N], f64) {
        let mut px_h = [0.0; N];
        let mut state = 0.0;
        for k in 0..N {
            if h[k] != 0.0 {
                add_scaled(&mut w[..p], h[k], &self.sensitivity[k][..p]);
                for l in 0..N {
                    px_h[l] += h[k] * self.px[k][l];
                }
            }
        }
        for k in 0..N {
            state += h[k] * px_h[k];
        }
        (px_h, r + state.max(0.0))
    }

    /// The row was used: `U <- U - (Px H^T/s) w`, `Px <- Px - Px H^T H Px/s`.
    #[inline(always)]
    fn update(&mut self, p: usize, px_h: &[f64; N], s: f64, w: &[f64; P]) {
        for k in 0..N {
            let gain = px_h[k] / s;
            add_scaled(&mut self.sensitivity[k][..p], -gain, &w[..p]);
            for l in 0..N {
                self.px[k][l] -= gain * px_h[l];
            }
        }
    }
}

impl<const N: usize, const P: usize> Slot<N, P> for Joint<N, P> {
    fn check<const R: usize>(settings: &EstimatorSettings<N, R, P>) -> Result<(), SettingsError> {
        settings.ekf.check()
    }

    fn prior<const R: usize>(settings: &EstimatorSettings<N, R, P>, columns: &Columns<R, P>) -> Self {
        let mut covariance =
            Blocks { columns: columns.count(), xx: [[0.0; N]; N], xt: [[0.0; P]; N], tt: [[0.0; P]; P] };
        for j in 0..columns.count() {
            covariance.tt[j][j] = if columns.std[j] > 0.0 { 1.0 } else { 0.0 };
        }
        Self { common: Common::prior(settings, columns), covariance }
    }

    /// The reading is noise and bias: `Pxt = -P_bt`, `Pxx = P_bb + diag variance`, with the row `b` of the bias.
    fn start_state<const R: usize>(
        &mut self,
        x: [f64; N],
        variances: &[f64; N],
        read_from: &[Option<usize>; N],
        columns: &Columns<R, P>,
    ) {
        self.common.start_state(x, read_from, columns);
        let p = columns.count();
        let Blocks { xx, xt, .. } = &mut self.covariance;
        *xx = [[0.0; N]; N];
        *xt = [[0.0; P]; N];
        for k in 0..N {
            self.covariance.xx[k][k] = variances[k].max(0.0);
            let Some(bias) = columns.bias_of(read_from[k]) else { continue };
            let row = self.covariance.parameter_column(p, bias);
            for j in 0..p {
                self.covariance.xt[k][j] = -row[j] * columns.std[bias];
            }
            for l in 0..=k {
                if let Some(other) = columns.bias_of(read_from[l]) {
                    self.covariance.xx[k][l] += row[other] * columns.std[bias] * columns.std[other];
                }
            }
        }
    }

    fn predict<M, const R: usize>(
        &mut self,
        model: &M,
        settings: &EstimatorSettings<N, R, P>,
        columns: &Columns<R, P>,
        levels: &Levels<N, R>,
        input: &IntervalInput<M::Input>,
        interval_s: f64,
        transition: &mut [[f64; N]; N],
    ) -> bool
    where
        M: Model<N, R, P>,
    {
        self.predict_followed(model, settings, columns, levels, input, interval_s, transition, &mut ())
    }

    fn correct<M, const R: usize>(
        &mut self,
        model: &M,
        settings: &EstimatorSettings<N, R, P>,
        columns: &Columns<R, P>,
        levels: &Levels<N, R>,
        input: &M::Input,
        measured: &[f64; R],
        adapt_noise: bool,
        surface: &mut [f64; P],
        watch: Option<Watch<'_, R, P>>,
        frame: Option<&mut Frame<N, R>>,
    ) -> Innovations<R>
    where
        M: Model<N, R, P>,
    {
        let own = &mut ();
        self.correct_followed(
            model,
            settings,
            columns,
            levels,
            input,
            measured,
            adapt_noise,
            surface,
            watch,
            frame,
            own,
        )
    }

    /// A jump of the parameters alone: `Ptt + Delta`, `Pxt` as it was, and an allowance for what the state has
    /// suffered.
    fn reopen<const R: usize>(
        &mut self,
        columns: &Columns<R, P>,
        tested: &[usize],
        change_over_prior: &[f64; P],
        state_variance: &[f64; N],
    ) -> bool {
        let p = columns.count();
        let mut before = [[0.0; P]; P];
        Slot::write_covariance(self, &mut before);
        for &column in tested {
            let change = at(change_over_prior, column);
            if let Some(variance) = self.covariance.tt.get_mut(column).and_then(|row| row.get_mut(column)) {
                *variance += change * change;
            }
        }
        for k in 0..N {
            self.covariance.xx[k][k] += state_variance[k];
        }
        self.common.limited = [false; P];
        self.common.colour.reopen(&before, &Ud::from_lower_triangle(&self.covariance.tt, p));
        Slot::is_sound(self, p)
    }

    fn gate<const R: usize>(settings: &EstimatorSettings<N, R, P>) -> f64 {
        settings.ekf.gate
    }

    fn common(&self) -> &Common<N, P> {
        &self.common
    }

    fn variances(&self) -> [f64; P] {
        core::array::from_fn(|j| if j < self.covariance.columns() { self.covariance.tt[j][j] } else { 0.0 })
    }

    fn write_covariance(&self, out: &mut [[f64; P]; P]) {
        let p = self.covariance.columns();
        for j in 0..p {
            out[j][..p].copy_from_slice(&self.covariance.parameter_column(p, j)[..p]);
        }
    }

    fn close_colour_block(&mut self) {
        let Self { common, covariance } = self;
        let p = covariance.columns();
        common.colour.close_block(p, |j| covariance.parameter_column(p, j));
    }

    fn renew_colour(&mut self) {
        let Self { common, covariance } = self;
        let p = covariance.columns();
        common.colour.renew(p, |j| covariance.parameter_column(p, j));
    }

    fn is_sound(&self, columns: usize) -> bool {
        self.common.is_sound(columns) && self.covariance.is_sound()
    }
}

impl<const N: usize, const P: usize> Followed<N, P> for Joint<N, P> {
    /// `x <- f(x, u, theta)` and `P <- F P F^T + diag(q_s Qx h, Qt h)`.
    fn predict_followed<M, F: Follower<N, P>, const R: usize>(
        &mut self,
        model: &M,
        settings: &EstimatorSettings<N, R, P>,
        columns: &Columns<R, P>,
        levels: &Levels<N, R>,
        input: &IntervalInput<M::Input>,
        interval_s: f64,
        transition: &mut [[f64; N]; N],
        follower: &mut F,
    ) -> bool
    where
        M: Model<N, R, P>,
    {
        let steps = discretization::sub_steps(interval_s, settings.maximum_step_s);
        let h = interval_s / steps as f64;
        let q = levels.process_noise(&settings.process_noise.variance_per_s, self.common.noise_scale, h);
        let own = columns.own();
        let mut x = self.common.x;
        let before = self.covariance;
        let mut part_transition = [[0.0; N]; N];
        for k in 0..steps {
            let part = Part { from: k as f64 / steps as f64, to: (k + 1) as f64 / steps as f64 };
            let mut b = [[0.0; P]; N];
            let theta = &self.common.theta;
            let x_before = x;
            x = discretization::step(model, &x, theta, input, interval_s, part, own, &mut b, &mut part_transition);
            if F::ACTIVE {
                follower.part([&x_before, &x], part, &part_transition, &b);
            }
            for row in &mut b {
                for (value, std) in row[..own].iter_mut().zip(&columns.std[..own]) {
                    *value *= std;
                }
            }
            self.covariance.predict(own, &part_transition, &b, &q);
            chain(transition, &part_transition, k == 0);
        }
        if !x.iter().sum::<f64>().is_finite() || !self.covariance.is_sound() {
            self.covariance = before;
            return false;
        }
        for j in 0..own {
            if columns.std[j] > 0.0 {
                let walk = settings.ekf.parameter_walk_per_s[j] * interval_s;
                self.covariance.tt[j][j] += walk / (columns.std[j] * columns.std[j]);
            }
        }
        self.common.x = x;
        true
    }

    #[allow(clippy::too_many_arguments)]
    fn correct_followed<M, F: Follower<N, P>, const R: usize>(
        &mut self,
        model: &M,
        settings: &EstimatorSettings<N, R, P>,
        columns: &Columns<R, P>,
        levels: &Levels<N, R>,
        input: &M::Input,
        measured: &[f64; R],
        adapt_noise: bool,
        surface: &mut [f64; P],
        watch: Option<Watch<'_, R, P>>,
        frame: Option<&mut Frame<N, R>>,
        follower: &mut F,
    ) -> Innovations<R>
    where
        M: Model<N, R, P>,
    {
        let p = columns.count();
        if is_full(p, P) {
            self.correct_of(
                P,
                model,
                settings,
                columns,
                levels,
                input,
                measured,
                adapt_noise,
                surface,
                watch,
                frame,
                follower,
            )
        } else {
            self.correct_of(
                p,
                model,
                settings,
                columns,
                levels,
                input,
                measured,
                adapt_noise,
                surface,
                watch,
                frame,
                follower,
            )
        }
    }
}

impl<const N: usize, const P: usize> Joint<N, P> {
    #[inline(always)]
    #[allow(clippy::too_many_arguments)]
    fn correct_of<M, F: Follower<N, P>, const R: usize>(
        &mut self,
        p: usize,
        model: &M,
        settings: &EstimatorSettings<N, R, P>,
        columns: &Columns<R, P>,
        levels: &Levels<N, R>,
        input: &M::Input,
        measured: &[f64; R],
        adapt_noise: bool,
        surface: &mut [f64; P],
        mut watch: Option<Watch<'_, R, P>>,
        mut frame: Option<&mut Frame<N, R>>,
        follower: &mut F,
    ) -> Innovations<R>
    where
        M: Model<N, R, P>,
    {
        let own = columns.own().min(p);
        let bears = levels.bears();
        let mut innovations = Innovations::EMPTY;
        let mut lin = LinearizedOutputs::<N, R, P>::ZERO;
        model.linearized_outputs(&self.common.x, &self.common.theta, input, &mut lin);
        let mut conditional = Conditional::new(p, &self.covariance);

        let mut dx = [0.0; N];
        // In scaled columns.
        let mut dtheta = [0.0; P];
        let mut score = NoiseScore::ZERO;
        surface[..p].fill(0.0);
        for i in 0..R {
            let sigma = levels.std[i];
            let bias = columns.bias(i);
            let predicted = lin.outputs[i] + bias.map_or(0.0, |column| self.common.theta[column]);
            innovations.predicted[i] = predicted;
            if !(measured[i].is_finite() && predicted.is_finite() && sigma.is_finite() && sigma > 0.0) {
                continue;
            }
            // The row over the joint state, and the residual with what the earlier rows of this frame have moved.
            let mut a = Stacked { x: lin.state_jacobian[i], t: [0.0; P] };
            for ((a, d), std) in a.t[..own].iter_mut().zip(&lin.parameter_jacobian[i]).zip(&columns.std) {
                *a = d * std;
            }
            if let Some(column) = bias {
                a.t[column] = columns.std[column];
            }
            let mut residual = measured[i] - predicted - dot(&a.t[..p], &dtheta[..p]);
            for k in 0..N {
                residual -= a.x[k] * dx[k];
            }

            // v = P a, variance = a P a + r; and the same row given the parameters: psi, s = variance/(1 + v).
            let r = sigma * sigma;
            let v = self.covariance.times(p, &a);
            let mut variance = r + dot(&a.t[..p], &v.t[..p]);
            for k in 0..N {
                variance += a.x[k] * v.x[k];
            }
            let mut w = a.t;
            let (px_h, s) = conditional.project(p, &a.x, r, &mut w);
            let one_plus_v = (variance / s).max(1.0);
            let root = libm::sqrt(s);
            let xi = residual / libm::sqrt(variance);
            // A variance that overflows would pass for a residual of zero and take the covariance with it.
            if !(xi.is_finite() && variance >= r && s.is_finite() && one_plus_v.is_finite()) {
                continue;
            }
            let mut psi = [0.0; P];
            for (psi, w) in psi[..p].iter_mut().zip(&w[..p]) {
                *psi = w / root;
            }
            if let Some(watch) = &mut watch {
                watch.see(&ScoredRow {
                    output: i,
                    psi: &psi[..p],
                    xi,
                    v: one_plus_v - 1.0,
                    nn: libm::sqrt(one_plus_v),
                });
            }
            innovations.whitened[i] = residual / root;
            innovations.normalised[i] = xi;
            innovations.variance[i] = variance;

            if let Some(frame) = &mut frame {
                frame.see(i, &a.x, measured[i] - predicted, s, one_plus_v, xi);
            }
            if xi.abs() > settings.ekf.gate {
                if !bears[i] {
                    innovations.phase[i] = RowPhase::Rejected;
                    continue;
                }
                // Again and again: bounded influence, and no covariance is reduced.
                innovations.phase[i] = RowPhase::Reaching;
                let step = settings.ekf.gate.copysign(xi) / libm::sqrt(variance);
                for j in 0..p {
                    surface[j] += columns.std[j] * v.t[j] * residual / variance;
                }
                add_scaled(&mut dtheta[..p], step, &v.t[..p]);
                for k in 0..N {
                    dx[k] += v.x[k] * step;
                }
                continue;
            }
            if adapt_noise {
                score.add(&settings.process_noise.adaptation, i, xi, (s - r) / variance);
            }
            innovations.phase[i] = RowPhase::Sliding;
            self.common.colour.add(&psi[..p], xi);
            let inverse_variance = 1.0 / variance;
            let step = residual * inverse_variance;
            if F::ACTIVE {
                let mut gain = [0.0; P];
                for j in 0..p {
                    gain[j] = columns.std[j] * v.t[j] * inverse_variance;
                }
                follower.row(&UsedRow {
                    output: i,
                    by_state: &a.x,
                    by_parameter: &lin.parameter_jacobian[i][..own],
                    bias,
                    residual,
                    variance,
                    state_gain: v.x.map(|value| value * inverse_variance),
                    parameter_gain: &gain[..p],
                });
            }
            for j in 0..p {
                surface[j] += columns.std[j] * v.t[j] * step;
            }
            add_scaled(&mut dtheta[..p], step, &v.t[..p]);
            for k in 0..N {
                dx[k] += v.x[k] * step;
            }
            self.covariance.update(p, &a, &v, inverse_variance, r);
            conditional.update(p, &px_h, s, &w);
        }

        let scaled = dtheta;
        for (step, std) in dtheta[..p].iter_mut().zip(&columns.std[..p]) {
            *step *= std;
        }
        if let Some(frame) = frame {
            for k in 0..N {
                frame.step[k] = dot(&conditional.sensitivity[k][..p], &scaled[..p]) - dx[k];
            }
        }
        let Self { common, covariance } = self;
        common.take_step(settings, columns, &dx, &dtheta[..p], &score, |j| covariance.tt[j][j]);
        innovations
    }
}
