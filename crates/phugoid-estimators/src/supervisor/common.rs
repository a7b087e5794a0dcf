//! The part of a running estimate that does not depend on the form of its covariance.

use crate::bounded::limited;
use crate::columns::Columns;
use crate::settings::{EstimatorSettings, NoiseAdaptation};
use crate::supervisor::colour::Colour;

/// Scaled variance below which a parameter is known better than half its prior.
const KNOWN: f64 = 0.25;

/// Information about `ln q_s` below which a step counts on no less: where the rows tell little of the process noise,
/// its scale stays nearly what it is and does not follow their noise. With 3 or 10 in its place detection in turbulence
/// misses more damage and believes more that never was (docs/theory.md).
const LEAST_INFORMATION: f64 = 30.0;

/// Slope and curvature of the likelihood of a frame's rows in the logarithm of the scale of the process noise.
pub(crate) struct NoiseScore {
    /// Slope of the log likelihood in `ln q_s`, or what stands for it.
    slope: f64,
    /// Expected curvature of the log likelihood in `ln q_s`.
    information: f64,
}

impl NoiseScore {
    pub(crate) const ZERO: Self = Self { slope: 0.0, information: 0.0 };

    /// Adds a used row. `share` is the part of the row's predicted variance that the state has, all of which is taken
    /// to grow with `q_s`: `d ln s/d ln q_s`. With it the slope is `share (xi^2 - 1)/2` and the information
    /// `share^2/2`; an outlier counts as three sigma.
    #[inline(always)]
    pub(crate) fn add<const R: usize>(&mut self, adaptation: &NoiseAdaptation<R>, output: usize, xi: f64, share: f64) {
        let excess = (xi * xi).min(9.0) - 1.0;
        match adaptation {
            NoiseAdaptation::Off => {}
            NoiseAdaptation::Score { .. } => {
                self.slope += 0.5 * share * excess;
                self.information += 0.5 * share * share;
            }
            NoiseAdaptation::Rows { outputs, .. } => {
                if outputs[output] {
                    self.slope += excess;
                }
            }
        }
    }
}

#[derive(Clone, Copy, Debug)]
pub struct Common<const N: usize, const P: usize> {
    pub(crate) x: [f64; N],
    pub(crate) theta: [f64; P],
    /// Adapted scale `q_s` of the process noise.
    pub(crate) noise_scale: f64,
    /// Information about `ln q_s` that has been gathered and not been forgotten.
    pub(crate) noise_information: f64,
    pub(crate) colour: Colour<P>,
    /// True for a column that was held at a limit after its standard error had become smaller than half the prior's:
    /// the data lie outside of the declared bounds. It stays true, because the other columns have been estimated with
    /// the wrong value since.
    pub(crate) limited: [bool; P],
}

impl<const N: usize, const P: usize> Common<N, P> {
    /// The prior, with a state still to be started.
    pub(crate) fn prior<const R: usize>(settings: &EstimatorSettings<N, R, P>, columns: &Columns<R, P>) -> Self {
        Self {
            x: settings.initial_state,
            theta: columns.initial,
            noise_scale: settings.process_noise.initial_scale,
            noise_information: 0.0,
            colour: Colour::new(),
            limited: [false; P],
        }
    }

    /// The state from measurements. A reading contains its channel's bias as far as it is known already.
    pub(crate) fn start_state<const R: usize>(
        &mut self,
        x: [f64; N],
        read_from: &[Option<usize>; N],
        columns: &Columns<R, P>,
    ) {
        self.x = x;
        for state in 0..N {
            if let Some(bias) = columns.bias_of(read_from[state]) {
                self.x[state] -= self.theta[bias];
            }
        }
    }

    /// Takes the steps of a whole frame, parameters inside their limits, and adapts `q_s` by what its rows say of it.
    /// `variance` gives the scaled variance of a column.
    #[inline(always)]
    pub(crate) fn take_step<const R: usize>(
        &mut self,
        settings: &EstimatorSettings<N, R, P>,
        columns: &Columns<R, P>,
        dx: &[f64; N],
        dtheta: &[f64],
        score: &NoiseScore,
        variance: impl Fn(usize) -> f64,
    ) {
        for k in 0..N {
            self.x[k] += dx[k];
        }
        for j in 0..dtheta.len().min(P) {
            let free = self.theta[j] + dtheta[j];
            self.theta[j] = limited(free, columns.clip_low[j], columns.clip_high[j]);
            if self.theta[j] != free && variance(j) < KNOWN {
                self.limited[j] = true;
            }
        }
        let noise = &settings.process_noise;
        let step = match noise.adaptation {
            NoiseAdaptation::Off => return,
            NoiseAdaptation::Score { forgetting } => {
                self.noise_information += score.information - forgetting * self.noise_information;
                score.slope / self.noise_information.max(LEAST_INFORMATION)
            }
            NoiseAdaptation::Rows { gain, .. } => gain * score.slope,
        };
        if step != 0.0 {
            let [low, high] = noise.scale_limits;
            self.noise_scale = limited(self.noise_scale * libm::exp(step), low, high);
        }
    }

    /// True if state, parameters and the colour correction are finite.
    pub(crate) fn is_sound(&self, columns: usize) -> bool {
        let sum = self.x.iter().sum::<f64>() + self.theta[..columns.min(P)].iter().sum::<f64>();
        sum.is_finite() && self.colour.is_sound(columns)
    }
}
