//! One running estimate: state, parameters, sensitivity and the two covariances, with prediction and correction.

use super::colour::Colour;
use super::columns::Columns;
use super::settings::{OutputInput, ReachingState, SmpeSettings};
use crate::discretization::{self, IntervalInput, Part};
use crate::kernels::{add_scaled, dot};
use crate::model::{LinearizedOutputs, Model};
use crate::ud::Ud;

/// Scaled variance below which a parameter is known better than half its prior.
const KNOWN: f64 = 0.25;

/// How one output row met its sliding surface.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum RowPhase {
    /// Not measured in this frame (or not usable).
    #[default]
    Missing,
    /// Inside the boundary layer: equivalent control.
    Sliding,
    /// Outside: bounded influence on the parameters, no covariance reduction.
    Reaching,
    /// Too far away for any parameter inside the bounds: not used.
    Rejected,
}

/// The rows of the last frame as the estimated model saw them *before* the frame corrected it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Innovations<const R: usize> {
    /// Predicted outputs (with the estimated biases), output units.
    pub predicted: [f64; R],
    /// Normalised surface `xi`: residual over its whole predicted standard deviation, parameters included. NaN where
    /// missing.
    pub normalised: [f64; R],
    /// Residual whitened by state and measurement noise alone, `e`. NaN where missing.
    pub whitened: [f64; R],
    /// `s (1 + v)`, predicted variance of the residual, output units squared. NaN where missing.
    pub variance: [f64; R],
    /// Phase per row.
    pub phase: [RowPhase; R],
}

impl<const R: usize> Innovations<R> {
    pub(crate) const EMPTY: Self = Self {
        predicted: [f64::NAN; R],
        normalised: [f64::NAN; R],
        whitened: [f64::NAN; R],
        variance: [f64::NAN; R],
        phase: [RowPhase::Missing; R],
    };
}

/// What an output row says about the parameters, before the row is used.
pub(crate) struct ScoredRow<'a> {
    /// Whitened sensitivity `psi`, columns scaled to the prior standard deviation.
    pub(crate) psi: &'a [f64],
    /// Normalised surface `xi`.
    pub(crate) xi: f64,
    /// `v = psi C psi^T`.
    pub(crate) v: f64,
    /// `nn = sqrt(1 + v)`.
    pub(crate) nn: f64,
}

#[derive(Clone, Copy, Debug)]
pub(crate) struct Slot<const N: usize, const P: usize> {
    pub(crate) x: [f64; N],
    pub(crate) theta: [f64; P],
    /// `U = dxhat/dtheta`, raw units.
    pub(crate) sensitivity: [[f64; P]; N],
    /// State covariance given the parameters.
    pub(crate) px: Ud<N>,
    /// Parameter covariance, columns scaled to the prior standard deviation.
    pub(crate) c: Ud<P>,
    /// `q_s`.
    pub(crate) noise_scale: f64,
    pub(crate) colour: Colour<P>,
    /// Was held at a limit after it had become known better than half its prior: the bounds exclude the data. It stays
    /// said, because what the other columns have made of it since is not to be trusted either.
    pub(crate) limited: [bool; P],
}

impl<const N: usize, const P: usize> Slot<N, P> {
    /// The prior, with a state still to be started.
    pub(crate) fn prior<const R: usize>(settings: &SmpeSettings<N, R, P>, columns: &Columns<N, R, P>) -> Self {
        Self {
            x: settings.initial_state,
            theta: columns.initial,
            sensitivity: [[0.0; P]; N],
            px: Ud::from_variances(&[0.0; N]),
            c: Ud::from_variances(&[1.0; P][..columns.count]),
            noise_scale: settings.process_noise.initial_scale,
            colour: Colour::new(),
            limited: [false; P],
        }
    }

    /// Starts the state from measurements alone: independent of the model's parameters, and wrong by the bias of the
    /// channel it was read from.
    pub(crate) fn start_state<const R: usize>(
        &mut self,
        x: [f64; N],
        variances: &[f64; N],
        measured: &[bool; N],
        columns: &Columns<N, R, P>,
    ) {
        self.x = x;
        self.px = Ud::from_variances(variances);
        self.sensitivity = [[0.0; P]; N];
        for state in 0..N {
            if let (true, Some(bias)) = (measured[state], columns.bias_of_state(state)) {
                self.sensitivity[state][bias] = -1.0;
                // The reading contains the bias as far as it is known already.
                self.x[state] -= self.theta[bias];
            }
        }
    }

    /// `x <- f(x, u, theta)`, `U <- A U + B`, `Px <- A Px A^T + q_s Qx h`. Changes nothing and gives `false` if the
    /// model's answer is not finite.
    pub(crate) fn predict<M, const R: usize>(
        &mut self,
        model: &M,
        settings: &SmpeSettings<N, R, P>,
        columns: &Columns<N, R, P>,
        input: &IntervalInput<M::Input>,
        interval_s: f64,
    ) -> bool
    where
        M: Model<N, R, P>,
    {
        let steps = discretization::sub_steps(interval_s, settings.maximum_step_s);
        let h = interval_s / steps as f64;
        let q = settings.process_noise.variance_per_s.map(|variance| variance * self.noise_scale * h);
        let mut x = self.x;
        let mut sensitivity = self.sensitivity;
        let mut px = self.px;
        let mut transition = [[0.0; N]; N];
        for k in 0..steps {
            let part = Part { from: k as f64 / steps as f64, to: (k + 1) as f64 / steps as f64 };
            x = discretization::step(
                model,
                &x,
                &self.theta,
                input,
                interval_s,
                part,
                columns.count,
                &mut sensitivity,
                &mut transition,
            );
            px.predict(&transition, &q);
        }
        // A sum is finite only if every term is.
        let checksum =
            x.iter().sum::<f64>() + sensitivity.iter().map(|row| row[..columns.count].iter().sum::<f64>()).sum::<f64>();
        if !checksum.is_finite() || !px.is_sound() {
            return false;
        }
        self.x = x;
        self.sensitivity = sensitivity;
        self.px = px;
        true
    }

    /// Corrects by every row that is there, in order. `observe` sees each row before it is used; `surface` receives
    /// `theta_LS - theta`, the parameter step that least squares would take on this frame's used rows.
    #[allow(clippy::too_many_arguments)]
    pub(crate) fn correct<M, const R: usize>(
        &mut self,
        model: &M,
        settings: &SmpeSettings<N, R, P>,
        columns: &Columns<N, R, P>,
        input: &M::Input,
        measured: &[f64; R],
        adapt_noise: bool,
        surface: &mut [f64; P],
        observe: impl FnMut(ScoredRow<'_>),
    ) -> Innovations<R>
    where
        M: Model<N, R, P>,
    {
        // The full capacity as a constant: its loops unroll.
        let p = columns.count;
        if p >= P {
            self.correct_of(P, model, settings, columns, input, measured, adapt_noise, surface, observe)
        } else {
            self.correct_of(p, model, settings, columns, input, measured, adapt_noise, surface, observe)
        }
    }

    #[inline(always)]
    #[allow(clippy::too_many_arguments)]
    fn correct_of<M, const R: usize>(
        &mut self,
        p: usize,
        model: &M,
        settings: &SmpeSettings<N, R, P>,
        columns: &Columns<N, R, P>,
        input: &M::Input,
        measured: &[f64; R],
        adapt_noise: bool,
        surface: &mut [f64; P],
        mut observe: impl FnMut(ScoredRow<'_>),
    ) -> Innovations<R>
    where
        M: Model<N, R, P>,
    {
        let own = columns.own.min(p);
        let (kappa, kappa2) = (settings.reaching_limit, settings.rejection_limit);
        let mut innovations = Innovations::EMPTY;
        let mut lin = LinearizedOutputs::<N, R, P>::ZERO;
        model.linearized_outputs(&self.x, &self.theta, input, &mut lin);

        let mut dx = [0.0; N];
        let mut dtheta = [0.0; P];
        let mut adaptation = 0.0;
        surface[..p].fill(0.0);
        for i in 0..R {
            let sigma = settings.noise_sd[i];
            let bias = columns.bias_of_output[i];
            let predicted = lin.outputs[i] + bias.map_or(0.0, |column| self.theta[column]);
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
                    add_scaled(&mut w[..p], factor, &self.sensitivity[k][..p]);
                }
            }

            // s = H Px H^T + sigma^2;  psi = w/sqrt(s);  e = residual/sqrt(s);  1 + v = 1 + psi C psi^T
            let r = sigma * sigma;
            let state_projection = self.px.project(h_row, r);
            let s = state_projection.variance;
            let inverse_root = 1.0 / libm::sqrt(s);
            let inverse_s = inverse_root * inverse_root;
            let mut psi = [0.0; P];
            for ((a, wj), sd) in psi[..p].iter_mut().zip(&w[..p]).zip(&columns.sd[..p]) {
                *a = wj * sd * inverse_root;
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
            observe(ScoredRow { psi: &psi[..p], xi, v: one_plus_v - 1.0, nn });
            innovations.whitened[i] = e;
            innovations.normalised[i] = xi;
            innovations.variance[i] = s * one_plus_v;

            let size = xi.abs();
            if size > kappa2 {
                innovations.phase[i] = RowPhase::Rejected;
                continue;
            }
            if adapt_noise && settings.process_noise.adapting_outputs[i] {
                adaptation += (xi * xi).min(9.0) - 1.0;
            }
            // Surface by equivalent control (sliding), or by the implicit sign outside the boundary layer (reaching).
            let (phi, ex, c_psi, p_h);
            if size <= kappa {
                innovations.phase[i] = RowPhase::Sliding;
                self.colour.add(&psi[..p], xi);
                phi = xi / nn;
                ex = e;
                p_h = self.px.update(&state_projection, r);
                c_psi = self.c.update(&projection, 1.0);
                for k in 0..N {
                    add_scaled(&mut self.sensitivity[k][..p], -p_h[k] * inverse_s, &w[..p]);
                }
            } else {
                innovations.phase[i] = RowPhase::Reaching;
                let sign = if xi > 0.0 { 1.0 } else { -1.0 };
                phi = kappa * sign / nn;
                // C stays, so this row moves C^-1 theta by exactly psi^T phi. While a lot is still to be learnt (v >= 1)
                // that is the way to the truth and not noise.
                if one_plus_v < 2.0 {
                    self.colour.add(&psi[..p], phi);
                }
                // U stays too, so the share of the state in the surface, 1/(1+v), has to be in e_x itself.
                ex = match settings.reaching_state {
                    ReachingState::Joint => phi,
                    ReachingState::Prototype => kappa * nn * sign,
                };
                p_h = self.px.cross_covariance(&state_projection);
                c_psi = self.c.cross_covariance(&projection);
            }
            // dtheta += C_old psi^T phi;  dx += K sqrt(s) ex + U C_old psi^T phi  (U after its own update)
            let full = xi / nn;
            let mut step = [0.0; P];
            for j in 0..p {
                let direction = columns.sd[j] * c_psi[j];
                step[j] = direction * phi;
                surface[j] += direction * full;
                dtheta[j] += step[j];
            }
            for k in 0..N {
                dx[k] += p_h[k] * inverse_root * ex + dot(&self.sensitivity[k][..p], &step[..p]);
            }
        }

        for k in 0..N {
            self.x[k] += dx[k];
        }
        for j in 0..p {
            let free = self.theta[j] + dtheta[j];
            self.theta[j] = free.clamp(columns.clip_low[j], columns.clip_high[j]);
            if self.theta[j] != free && self.c.column(j)[j] < KNOWN {
                self.limited[j] = true;
            }
        }
        if adaptation != 0.0 {
            let noise = &settings.process_noise;
            let [low, high] = noise.scale_limits;
            self.noise_scale = (self.noise_scale * libm::exp(noise.adaptation_gain * adaptation)).clamp(low, high);
        }
        innovations
    }

    /// True if state, parameters and covariances are finite and no variance is negative.
    pub(crate) fn is_sound(&self, columns: usize) -> bool {
        let sum = self.x.iter().sum::<f64>() + self.theta[..columns].iter().sum::<f64>();
        sum.is_finite() && self.px.is_sound() && self.c.is_sound()
    }
}

/// The input that the outputs see at the end of an interval.
pub(crate) fn output_input<I: Copy, const N: usize, const R: usize, const P: usize>(
    settings: &SmpeSettings<N, R, P>,
    previous: I,
    current: I,
) -> I {
    match settings.output_input {
        OutputInput::Current => current,
        OutputInput::Previous => previous,
    }
}
