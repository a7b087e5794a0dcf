//! Model reference by rule: the textbook's state-error law, normalised, with nothing to tune.
//!
//! Every measured state is a channel, scaled by its noise. With `R_j` twice the prior standard deviation, `k` the decay of the state
//! error, `g` the gain and `c` the normalisation,
//!
//! ```text
//! theta_j' = g R_j^2 sum_i Phi_ij e_i / (c + |Phi R|^2),      k = 2/s,   g = k * 1/s,   c = k^2
//! ```
//!
//! `k`: the short period of an aircraft is slower. `c`: a regressor counts from where a half range of a parameter moves the error by one
//! sigma of noise. `g`: an excited parameter then approaches the truth with a time constant of one second; the sampled law is
//! stable to `g h = 2 k`.
//!
//! **What it is:** a gradient law without memory of what it has learnt. It follows the noise as fast as the truth, parameters that are
//! excited together are told apart slowly, and it knows nothing of its error: **the standard errors are infinite.** It ignores the
//! accelerometers.
//!
//! ```
//! # mod lag { include!(concat!(env!("CARGO_MANIFEST_DIR"), "/doc/lag.rs")); }
//! use lag::{Lag, NOISE, flight};
//! use phugoid_estimators::Estimator;
//! use phugoid_estimators::adaptive_model::AdaptiveModel;
//! use phugoid_estimators::settings::{EstimatorSettings, ParameterPrior};
//!
//! let priors = [ParameterPrior::bounded(5.0, 1.0, 9.0), ParameterPrior::bounded(1.0, -4.0, 6.0)];
//! let settings = EstimatorSettings::automatic(&priors, [NOISE], 0.01)?;
//! let mut law = AdaptiveModel::new(Lag, &settings)?;
//! let mut parameters = [0.0; 2];
//! for sample in &flight(40.0, |_| 3.0) {
//!     parameters = law.update(sample).parameters;
//! }
//! assert!((parameters[0] - 3.0).abs() < 0.3 && (parameters[1] - 2.0).abs() < 0.3);
//! # Ok::<(), phugoid_estimators::settings::SettingsError>(())
//! ```

mod state_error;

use crate::bounded::at;
use crate::discretization::{self, Part};
use crate::estimate::{Estimate, Estimator, Inspect};
use crate::innovation::{Innovations, RowPhase};
use crate::model::{LinearizedOutputs, Model, Sample};
use crate::settings::{EstimatorSettings, SettingsError};
use state_error::{StateErrorLaw, StateErrorSettings};

/// Decay rate `k` of the state error, 1/s.
const ERROR_DECAY: f64 = 2.0;
/// Time constant of an excited parameter, s.
const ADAPTATION_TIME_S: f64 = 1.0;

/// The model-reference law tuned by rule, over all `N` states.
pub struct AdaptiveModel<M, const N: usize, const R: usize, const P: usize>
where
    M: Model<N, R, P>,
{
    model: M,
    law: StateErrorLaw<M::Input, N, P>,
    /// Output that measures each state directly.
    measuring: [usize; N],
    maximum_step_s: f64,
    noise_std: [f64; R],
    /// Of the parameters, then of the biases, which keep it.
    prior_std: [f64; P],
    columns: usize,
    /// The estimate that held before the last frame.
    theta: [f64; P],
    outputs: LinearizedOutputs<N, R, P>,
    innovations: Innovations<R>,
}

impl<M, const N: usize, const R: usize, const P: usize> AdaptiveModel<M, N, R, P>
where
    M: Model<N, R, P>,
{
    /// Sets it up from the priors, noise levels and timing of the flagship. Sensor biases have no place in it: their columns
    /// keep the prior.
    ///
    /// # Errors
    /// [`SettingsError::NoOutput`] if a state is not measured; what cannot be among the settings.
    pub fn new(model: M, settings: &EstimatorSettings<N, R, P>) -> Result<Self, SettingsError> {
        settings.check(model.parameter_count())?;
        let (mut measuring, mut scale) = ([0; N], [1.0; N]);
        for state in 0..N {
            let output = model.measuring_output(state).filter(|output| *output < R).ok_or(SettingsError::NoOutput)?;
            let noise_std = settings.noise_std[output];
            if !(noise_std > 0.0 && noise_std.is_finite()) {
                return Err(SettingsError::NoOutput);
            }
            (measuring[state], scale[state]) = (output, noise_std);
        }
        let count = model.parameter_count().min(P);
        let of = |j: usize, value: f64| if j < count { value } else { 0.0 };
        let mut prior_std = core::array::from_fn(|j| of(j, settings.priors[j].std));
        let ranges = prior_std.map(|std: f64| 2.0 * std);
        let mut columns = count;
        for output in settings.bias_columns() {
            if let Some(std) = prior_std.get_mut(columns) {
                *std = at(&settings.bias_std, output);
                columns += 1;
            }
        }
        let theta: [f64; P] = core::array::from_fn(|j| of(j, settings.priors[j].initial));
        let law = StateErrorSettings {
            parameters: theta,
            ranges,
            lower: core::array::from_fn(|j| settings.priors[j].lower),
            upper: core::array::from_fn(|j| settings.priors[j].upper),
            scale,
            gain: ERROR_DECAY / ADAPTATION_TIME_S,
            normalisation: ERROR_DECAY * ERROR_DECAY,
            error_decay: ERROR_DECAY,
            initial_state: settings.initial_state,
            input_hold: settings.input_hold,
            maximum_gap_s: settings.maximum_gap_s,
        };
        let impossible = SettingsError::Setting { name: "model reference", value: f64::NAN };
        let step_is_possible = settings.maximum_step_s > 0.0 && settings.maximum_step_s.is_finite();
        let law = StateErrorLaw::new(count, law).filter(|_| step_is_possible).ok_or(impossible)?;
        Ok(Self {
            model,
            law,
            measuring,
            maximum_step_s: settings.maximum_step_s,
            noise_std: settings.noise_std,
            prior_std,
            columns,
            theta,
            outputs: LinearizedOutputs::ZERO,
            innovations: Innovations::EMPTY,
        })
    }

    fn look(&mut self, sample: &Sample<M::Input, R>) {
        self.innovations = Innovations::EMPTY;
        self.model.linearized_outputs(&self.law.state(), &self.theta, &sample.input, &mut self.outputs);
        self.innovations.predicted = self.outputs.outputs;
        for i in 0..R {
            let residual = (sample.outputs[i] - self.outputs.outputs[i]) / self.noise_std[i];
            if residual.is_finite() {
                self.innovations.whitened[i] = residual;
                self.innovations.normalised[i] = residual;
                self.innovations.variance[i] = self.noise_std[i] * self.noise_std[i];
                self.innovations.phase[i] = RowPhase::Sliding;
            }
        }
    }
}

impl<M, const N: usize, const R: usize, const P: usize> Estimator<R, P> for AdaptiveModel<M, N, R, P>
where
    M: Model<N, R, P>,
{
    type Input = M::Input;

    fn update(&mut self, sample: &Sample<Self::Input, R>) -> Estimate<P> {
        let Self { model, maximum_step_s, law, measuring, .. } = self;
        let columns = law.count();
        let measured = core::array::from_fn(|state| at(&sample.outputs, measuring[state]));
        let mut estimate = law.update(sample.time_s, sample.input, &measured, |x, theta, input, interval_s| {
            let steps = discretization::sub_steps(interval_s, *maximum_step_s);
            let (mut x, mut sensitivity, mut transition) = (*x, [[0.0; P]; N], [[0.0; N]; N]);
            for k in 0..steps {
                let part = Part { from: k as f64 / steps as f64, to: (k + 1) as f64 / steps as f64 };
                let (into, by_state) = (&mut sensitivity, &mut transition);
                x = discretization::step(&*model, &x, theta, input, interval_s, part, columns, into, by_state);
            }
            (x, sensitivity)
        });
        for j in self.law.count()..self.columns.min(P) {
            estimate.std_error[j] = self.prior_std[j];
            estimate.corrected_std_error[j] = self.prior_std[j];
        }
        self.look(sample);
        self.theta = estimate.parameters;
        estimate
    }

    /// Infinite for the unknown parameters: the law knows no covariance.
    fn covariance(&self, out: &mut [[f64; P]; P]) {
        self.law.covariance(out);
        for j in self.law.count()..self.columns.min(P) {
            out[j][j] = self.prior_std[j] * self.prior_std[j];
        }
    }
}

impl<M, const N: usize, const R: usize, const P: usize> Inspect<R, P> for AdaptiveModel<M, N, R, P>
where
    M: Model<N, R, P>,
{
    fn column_count(&self) -> usize {
        self.columns
    }

    fn prior_std(&self) -> &[f64; P] {
        &self.prior_std
    }

    fn innovations(&self) -> &Innovations<R> {
        &self.innovations
    }
}
