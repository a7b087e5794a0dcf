//! What every slot carries, whatever form its covariance has.

use super::colour::Colour;
use super::columns::Columns;
use super::settings::SmpeSettings;

/// Scaled variance below which a parameter is known better than half its prior.
const KNOWN: f64 = 0.25;

#[derive(Clone, Copy, Debug)]
pub struct Common<const N: usize, const P: usize> {
    pub(crate) x: [f64; N],
    pub(crate) theta: [f64; P],
    /// `q_s`.
    pub(crate) noise_scale: f64,
    pub(crate) colour: Colour<P>,
    /// Was held at a limit after it had become known better than half its prior: the bounds exclude the data. It stays
    /// said, because what the other columns have made of it since is not to be trusted either.
    pub(crate) limited: [bool; P],
}

impl<const N: usize, const P: usize> Common<N, P> {
    /// The prior, with a state still to be started.
    pub(crate) fn prior<const R: usize>(settings: &SmpeSettings<N, R, P>, columns: &Columns<N, R, P>) -> Self {
        Self {
            x: settings.initial_state,
            theta: columns.initial,
            noise_scale: settings.process_noise.initial_scale,
            colour: Colour::new(),
            limited: [false; P],
        }
    }

    /// The state from measurements. A reading contains its channel's bias as far as it is known already.
    pub(crate) fn start_state<const R: usize>(
        &mut self,
        x: [f64; N],
        measured: &[bool; N],
        columns: &Columns<N, R, P>,
    ) {
        self.x = x;
        for state in 0..N {
            if let (true, Some(bias)) = (measured[state], columns.bias_of_state(state)) {
                self.x[state] -= self.theta[bias];
            }
        }
    }

    /// Takes the steps of a whole frame, parameters inside their limits, and adapts `q_s` by `adaptation`, the sum of
    /// `min(xi^2, 9) - 1`. `variance` gives the scaled variance of a column.
    #[inline(always)]
    pub(crate) fn take_step<const R: usize>(
        &mut self,
        settings: &SmpeSettings<N, R, P>,
        columns: &Columns<N, R, P>,
        dx: &[f64; N],
        dtheta: &[f64],
        adaptation: f64,
        variance: impl Fn(usize) -> f64,
    ) {
        for k in 0..N {
            self.x[k] += dx[k];
        }
        for (j, step) in dtheta.iter().enumerate() {
            let free = self.theta[j] + step;
            self.theta[j] = free.clamp(columns.clip_low[j], columns.clip_high[j]);
            if self.theta[j] != free && variance(j) < KNOWN {
                self.limited[j] = true;
            }
        }
        if adaptation != 0.0 {
            let noise = &settings.process_noise;
            let [low, high] = noise.scale_limits;
            self.noise_scale = (self.noise_scale * libm::exp(noise.adaptation_gain * adaptation)).clamp(low, high);
        }
    }

    /// True if state and parameters are finite.
    pub(crate) fn is_sound(&self, columns: usize) -> bool {
        let sum = self.x.iter().sum::<f64>() + self.theta[..columns].iter().sum::<f64>();
        sum.is_finite()
    }
}
