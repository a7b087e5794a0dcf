//! The separated form (Friedland): state covariance given the parameters, sensitivity, parameter covariance, both
//! covariances as `U D U^T`; with it the arithmetic of one sliding surface.

use super::reopen;
use crate::columns::Columns;
use crate::discretization::{self, IntervalInput, Part};
use crate::innovation::{Innovations, RowPhase, ScoredRow};
use crate::kernels::{add_scaled, add_scaled_in, chain, dot, dot_in, is_full};
use crate::levels::{Frame, Levels};
use crate::model::{LinearizedOutputs, Model};
use crate::settings::{EstimatorSettings, ReachingState, SettingsError};
use crate::supervisor::common::{Common, NoiseScore};
use crate::supervisor::faults::Watch;
use crate::supervisor::slot::{Followed, Follower, Slot, UsedRow};
use crate::ud::Ud;

#[derive(Clone, Copy, Debug)]
pub struct Separated<const N: usize, const P: usize> {
    pub(crate) common: Common<N, P>,
    /// `U = dxhat/dtheta`, raw units.
    pub(crate) sensitivity: [[f64; P]; N],
    /// State covariance given the parameters.
    pub(crate) px: Ud<N>,
    /// Parameter covariance, columns scaled to the prior standard deviation.
    pub(crate) c: Ud<P>,
}

impl<const N: usize, const P: usize> Slot<N, P> for Separated<N, P> {
    fn check<const R: usize>(_: &EstimatorSettings<N, R, P>) -> Result<(), SettingsError> {
        Ok(())
    }

    fn prior<const R: usize>(settings: &EstimatorSettings<N, R, P>, columns: &Columns<R, P>) -> Self {
        Self {
            common: Common::prior(settings, columns),
            sensitivity: [[0.0; P]; N],
            px: Ud::from_variances(&[0.0; N]),
            c: Ud::from_variances(&[1.0; P][..columns.count()]),
        }
    }

    /// Independent of the model's parameters, and wrong by the bias of the channel it was read from: `U = -1` there.
    fn start_state<const R: usize>(
        &mut self,
        x: [f64; N],
        variances: &[f64; N],
        read_from: &[Option<usize>; N],
        columns: &Columns<R, P>,
    ) {
        self.common.start_state(x, read_from, columns);
        self.px = Ud::from_variances(variances);
        self.sensitivity = [[0.0; P]; N];
        for state in 0..N {
            if let Some(bias) = columns.bias_of(read_from[state]) {
                self.sensitivity[state][bias] = -1.0;
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

    fn reopen<const R: usize>(
        &mut self,
        columns: &Columns<R, P>,
        tested: &[usize],
        change_over_prior: &[f64; P],
        state_variance: &[f64; N],
    ) -> bool {
        reopen::reopen(self, &columns.std[..columns.count()], tested, change_over_prior, state_variance)
    }

    fn gate<const R: usize>(settings: &EstimatorSettings<N, R, P>) -> f64 {
        settings.rejection_limit
    }

    fn common(&self) -> &Common<N, P> {
        &self.common
    }

    fn variances(&self) -> [f64; P] {
        self.c.variances()
    }

    fn write_covariance(&self, out: &mut [[f64; P]; P]) {
        self.c.write_dense(out);
    }

    fn close_colour_block(&mut self) {
        let Self { common, c, .. } = self;
        common.colour.close_block(c.len(), |j| c.column(j));
    }

    fn renew_colour(&mut self) {
        let Self { common, c, .. } = self;
        common.colour.renew(c.len(), |j| c.column(j));
    }

    /// No variance is negative, by construction, unless it is not a number.
    fn is_sound(&self, columns: usize) -> bool {
        self.common.is_sound(columns) && self.px.is_sound() && self.c.is_sound()
    }
}

impl<const N: usize, const P: usize> Followed<N, P> for Separated<N, P> {
    /// `x <- f(x, u, theta)`, `U <- A U + B`, `Px <- A Px A^T + q_s Qx h`. Changes nothing and gives `false` if the
    /// model's answer is not finite.
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
        let mut x = self.common.x;
        let mut sensitivity = self.sensitivity;
        let mut px = self.px;
        let mut part_transition = [[0.0; N]; N];
        for k in 0..steps {
            let part = Part { from: k as f64 / steps as f64, to: (k + 1) as f64 / steps as f64 };
            let before = F::ACTIVE.then_some((x, sensitivity));
            x = discretization::step(
                model,
                &x,
                &self.common.theta,
                input,
                interval_s,
                part,
                columns.count(),
                &mut sensitivity,
                &mut part_transition,
            );
            if let Some((x_before, mut b)) = before {
                // B = U' - A U
                let own = columns.own();
                let old = b;
                for (row, (new, a)) in b.iter_mut().zip(sensitivity.iter().zip(&part_transition)) {
                    *row = *new;
                    for (factor, old) in a.iter().zip(&old) {
                        add_scaled(&mut row[..own], -factor, &old[..own]);
                    }
                }
                follower.part([&x_before, &x], part, &part_transition, &b);
            }
            px.predict(&part_transition, &q);
            chain(transition, &part_transition, k == 0);
        }
        // A sum is finite only if every term is.
        let checksum = x.iter().sum::<f64>()
            + sensitivity.iter().map(|row| row[..columns.count()].iter().sum::<f64>()).sum::<f64>();
        if !checksum.is_finite() || !px.is_sound() {
            return false;
        }
        self.common.x = x;
        self.sensitivity = sensitivity;
        self.px = px;
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

impl<const N: usize, const P: usize> Separated<N, P> {
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
        let (kappa, kappa2) = (settings.reaching_limit, settings.rejection_limit);
        let bears = levels.bears();
        let mut innovations = Innovations::EMPTY;
        let mut lin = LinearizedOutputs::<N, R, P>::ZERO;
        model.linearized_outputs(&self.common.x, &self.common.theta, input, &mut lin);

        let mut dx = [0.0; N];
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
            let h_row = &lin.state_jacobian[i];
            let d_row = &lin.parameter_jacobian[i];

            // w = H U + D, and the residual with what the earlier rows of this frame have already moved.
            let mut w = [0.0; P];
            w[..own].copy_from_slice(&d_row[..own]);
            let mut residual = measured[i] - predicted;
            residual -= dot(&d_row[..own], &dtheta[..own]);
            if let Some(column) = bias {
                w[column] = 1.0;
                residual -= dtheta[column];
            }
            for k in 0..N {
                let factor = h_row[k];
                // Most rows measure one state: the zeros are worth a test.
                if factor != 0.0 {
                    residual -= factor * dx[k];
                    add_scaled_in(p, &mut w, factor, &self.sensitivity[k]);
                }
            }

            // s = H Px H^T + sigma^2;  psi = w/sqrt(s);  e = residual/sqrt(s);  1 + v = 1 + psi C psi^T
            let r = sigma * sigma;
            let state_projection = self.px.project(h_row, r);
            let s = state_projection.variance;
            let inverse_root = 1.0 / libm::sqrt(s);
            let inverse_s = inverse_root * inverse_root;
            let mut psi = [0.0; P];
            for ((a, wj), std) in psi[..p].iter_mut().zip(&w[..p]).zip(&columns.std[..p]) {
                *a = wj * std * inverse_root;
            }
            let e = residual * inverse_root;
            let projection = self.c.project(&psi, 1.0);
            let one_plus_v = projection.variance;
            let nn = libm::sqrt(one_plus_v);
            let xi = e / nn;
            // A variance that overflows would pass for a residual of zero and take the covariances with it.
            if !(xi.is_finite() && s > 0.0 && s.is_finite() && one_plus_v >= 1.0 && one_plus_v.is_finite()) {
                continue;
            }
            if let Some(watch) = &mut watch {
                watch.see(&ScoredRow { output: i, psi: &psi[..p], xi, v: one_plus_v - 1.0, nn });
            }
            innovations.whitened[i] = e;
            innovations.normalised[i] = xi;
            innovations.variance[i] = s * one_plus_v;

            if let Some(frame) = &mut frame {
                frame.see(i, h_row, measured[i] - predicted, s, one_plus_v, xi);
            }

            let size = xi.abs();
            if size > kappa2 && !bears[i] {
                innovations.phase[i] = RowPhase::Rejected;
                continue;
            }
            if adapt_noise {
                score.add(&settings.process_noise.adaptation, i, xi, (s - r) / (s * one_plus_v));
            }
            // Surface by equivalent control (sliding), or by the implicit sign outside the boundary layer (reaching).
            let (phi, ex, c_psi, p_h);
            if size <= kappa {
                innovations.phase[i] = RowPhase::Sliding;
                self.common.colour.add(&psi[..p], xi);
                phi = xi / nn;
                ex = e;
                p_h = self.px.update(&state_projection, r);
                c_psi = self.c.update(&projection, 1.0);
                for k in 0..N {
                    add_scaled_in(p, &mut self.sensitivity[k], -p_h[k] * inverse_s, &w);
                }
            } else {
                innovations.phase[i] = RowPhase::Reaching;
                let sign = if xi > 0.0 { 1.0 } else { -1.0 };
                phi = kappa * sign / nn;
                // C stays, so this row moves C^-1 theta by exactly psi^T phi. While a lot is still to be learnt (v >=
                // 1) that is the way to the truth and not noise.
                if one_plus_v < 2.0 {
                    self.common.colour.add(&psi[..p], phi);
                }
                // U stays too, so the share of the state in the surface, 1/(1+v), has to be in e_x itself.
                ex = match settings.reaching_state {
                    ReachingState::Joint => phi,
                    ReachingState::Prototype => kappa * nn * sign,
                };
                p_h = self.px.cross_covariance(&state_projection);
                c_psi = self.c.cross_covariance(&projection);
            }
            if F::ACTIVE && innovations.phase[i] == RowPhase::Sliding {
                let scale = inverse_root / one_plus_v;
                let mut gain = [0.0; P];
                for j in 0..p {
                    gain[j] = columns.std[j] * c_psi[j] * scale;
                }
                let mut state_gain = [0.0; N];
                for k in 0..N {
                    state_gain[k] = p_h[k] * inverse_s + dot_in(p, &self.sensitivity[k], &gain);
                }
                follower.row(&UsedRow {
                    output: i,
                    by_state: h_row,
                    by_parameter: &d_row[..own],
                    bias,
                    residual,
                    variance: s * one_plus_v,
                    state_gain,
                    parameter_gain: &gain[..p],
                });
            }
            // dtheta += C_old psi^T phi;  dx += K sqrt(s) ex + U C_old psi^T phi  (U after its own update)
            let full = xi / nn;
            let mut step = [0.0; P];
            for j in 0..p {
                let direction = columns.std[j] * c_psi[j];
                step[j] = direction * phi;
                surface[j] += direction * full;
                dtheta[j] += step[j];
            }
            for k in 0..N {
                dx[k] += p_h[k] * inverse_root * ex + dot_in(p, &self.sensitivity[k], &step);
            }
        }

        if let Some(frame) = frame {
            for k in 0..N {
                frame.step[k] = dot_in(p, &self.sensitivity[k], &dtheta) - dx[k];
            }
        }
        let Self { common, c, .. } = self;
        common.take_step(settings, columns, &dx, &dtheta[..p], &score, |j| c.column(j)[j]);
        innovations
    }
}
