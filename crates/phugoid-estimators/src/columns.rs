//! The columns of the regression: the model's parameters, then the sensor biases.

use crate::model::Model;
use crate::settings::{ChangePrior, EstimatorSettings};

#[derive(Clone, Copy, Debug)]
pub struct Columns<const N: usize, const R: usize, const P: usize> {
    /// Columns in use.
    pub(crate) count: usize,
    /// Those of the model's own parameters.
    pub(crate) own: usize,
    pub(crate) initial: [f64; P],
    /// Prior standard deviation, the unit of the scaled columns.
    pub(crate) std: [f64; P],
    pub(crate) clip_low: [f64; P],
    pub(crate) clip_high: [f64; P],
    pub(crate) change: [ChangePrior; P],
    pub(crate) bias_of_output: [Option<usize>; R],
    /// Output that measures each state directly and is used.
    pub(crate) output_of_state: [Option<usize>; N],
}

impl<const N: usize, const R: usize, const P: usize> Columns<N, R, P> {
    /// Lays out the columns; `settings` have been checked against the model.
    pub(crate) fn new<M: Model<N, R, P>>(model: &M, settings: &EstimatorSettings<N, R, P>) -> Self {
        let own = model.parameter_count().min(P);
        let mut columns = Self {
            count: own,
            own,
            initial: [0.0; P],
            std: [0.0; P],
            clip_low: [f64::NEG_INFINITY; P],
            clip_high: [f64::INFINITY; P],
            change: [ChangePrior::None; P],
            bias_of_output: [None; R],
            output_of_state: [None; N],
        };
        for (j, prior) in settings.priors[..own].iter().enumerate() {
            columns.initial[j] = prior.initial;
            columns.std[j] = prior.std;
            columns.change[j] = if prior.std > 0.0 { prior.change_std } else { ChangePrior::None };
            if prior.half_width().is_finite() {
                let centre = 0.5 * (prior.lower + prior.upper);
                let reach = settings.clip_factor * prior.half_width();
                columns.clip_low[j] = (centre - reach).min(prior.initial);
                columns.clip_high[j] = (centre + reach).max(prior.initial);
            } else {
                columns.clip_low[j] = prior.lower;
                columns.clip_high[j] = prior.upper;
            }
        }
        for output in settings.bias_columns() {
            if columns.count < P {
                columns.std[columns.count] = settings.bias_std[output];
                columns.bias_of_output[output] = Some(columns.count);
                columns.count += 1;
            }
        }
        for state in 0..N {
            columns.output_of_state[state] = model
                .measuring_output(state)
                .filter(|&output| output < R)
                .filter(|&output| settings.noise_std[output].is_finite() && settings.noise_std[output] > 0.0);
        }
        columns
    }

    /// The bias column of the output that measures a state.
    pub(crate) fn bias_of_state(&self, state: usize) -> Option<usize> {
        self.output_of_state[state].and_then(|output| self.bias_of_output[output])
    }
}
