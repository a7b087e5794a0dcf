//! The columns of the regression: the model's parameters, then the sensor biases.

use crate::bounded::at;
use crate::settings::{ChangePrior, EstimatorSettings};

/// Layout and limits of the columns. Entries from `count` on are not in use.
#[derive(Clone, Copy, Debug)]
pub struct Columns<const R: usize, const P: usize> {
    /// Number of columns in use, parameters and biases, at most `P`.
    pub(crate) count: usize,
    /// Those of the model's own parameters.
    pub(crate) own: usize,
    /// Start values of the columns, parameter units; zero for biases.
    pub(crate) initial: [f64; P],
    /// Prior standard deviation, the unit of the scaled columns.
    pub(crate) std: [f64; P],
    /// Limits within which the estimates are held, parameter units.
    pub(crate) clip_low: [f64; P],
    pub(crate) clip_high: [f64; P],
    /// Size of a sudden change.
    pub(crate) change: [ChangePrior; P],
    /// Column of the bias of each output.
    pub(crate) bias_of_output: [Option<usize>; R],
}

impl<const R: usize, const P: usize> Columns<R, P> {
    /// Lays out the columns of a model with `parameters` parameters; `settings` have been checked against it.
    pub(crate) fn new<const N: usize>(settings: &EstimatorSettings<N, R, P>, parameters: usize) -> Self {
        let own = parameters.min(P);
        let mut columns = Self {
            count: own,
            own,
            initial: [0.0; P],
            std: [0.0; P],
            clip_low: [f64::NEG_INFINITY; P],
            clip_high: [f64::INFINITY; P],
            change: [ChangePrior::None; P],
            bias_of_output: [None; R],
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
            let column = columns.count;
            if let (Some(std), Some(bias)) = (columns.std.get_mut(column), columns.bias_of_output.get_mut(output)) {
                *std = at(&settings.bias_std, output);
                *bias = Some(column);
                columns.count += 1;
            }
        }
        columns
    }

    /// Number of columns in use. At most `P`, which the compiler cannot know of a field: loops up to it need no test of
    /// their index.
    #[inline(always)]
    pub(crate) fn count(&self) -> usize {
        self.count.min(P)
    }

    /// Number of the model's own columns, at most `P`.
    #[inline(always)]
    pub(crate) fn own(&self) -> usize {
        self.own.min(P)
    }

    /// The bias column of an output, if there is such an output and it has one. Below `P`.
    #[inline(always)]
    pub(crate) fn bias(&self, output: usize) -> Option<usize> {
        self.bias_of_output.get(output).copied().flatten().filter(|column| *column < P)
    }

    /// The same, if there is an output.
    #[inline(always)]
    pub(crate) fn bias_of(&self, output: Option<usize>) -> Option<usize> {
        output.and_then(|output| self.bias(output))
    }
}

#[cfg(test)]
mod tests {
    use super::Columns;
    use crate::settings::{EstimatorSettings, ParameterPrior};

    const OUTPUTS: usize = 3;

    /// Every number of parameters and every choice of biases that the settings accept: the biases follow the parameters
    /// in the order of the outputs, and nothing lies beyond the room.
    fn layouts<const P: usize>() {
        for parameters in 0..=P {
            for biased in 0..1_u32 << OUTPUTS {
                let priors = [ParameterPrior::bounded(5.0, 1.0, 9.0); P];
                let mut settings =
                    EstimatorSettings::<1, OUTPUTS, P>::automatic(&priors[..parameters], [0.1; OUTPUTS], 0.01).unwrap();
                let is_biased = |output: usize| biased >> output & 1 == 1;
                settings.bias_std =
                    core::array::from_fn(|output| if is_biased(output) { 0.5 + output as f64 } else { 0.0 });
                let columns = Columns::new(&settings, parameters);
                assert_eq!(columns.own(), parameters);
                let mut next = parameters;
                for output in 0..OUTPUTS {
                    let has_room = is_biased(output) && next < P;
                    assert_eq!(columns.bias(output), has_room.then_some(next));
                    assert_eq!(columns.bias_of(Some(output)), columns.bias(output));
                    if has_room {
                        assert_eq!(columns.std[next], 0.5 + output as f64);
                        assert_eq!(
                            (columns.clip_low[next], columns.clip_high[next]),
                            (f64::NEG_INFINITY, f64::INFINITY)
                        );
                        next += 1;
                    }
                }
                assert_eq!(columns.count(), next);
                assert!(columns.std[next..].iter().all(|std| *std == 0.0));
                assert!(columns.std[..parameters].iter().all(|std| *std == 2.0));
                assert_eq!((columns.bias(OUTPUTS), columns.bias_of(None)), (None, None));
            }
        }
    }

    #[test]
    fn every_layout_lies_within_its_room() {
        layouts::<1>();
        layouts::<2>();
        layouts::<3>();
        layouts::<5>();
    }
}
