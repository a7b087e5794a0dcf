//! The estimated model that runs beside the plant.

use phugoid_estimators::discretization::{self, IntervalInput, Part};
use phugoid_estimators::{Model, Sample};

/// State after one interval and its derivatives by the first `columns` parameters.
pub(super) fn integrate<M, const N: usize, const R: usize, const P: usize>(
    model: &M,
    x: &[f64; N],
    theta: &[f64; P],
    input: &IntervalInput<M::Input>,
    interval_s: f64,
    maximum_step_s: f64,
    columns: usize,
) -> ([f64; N], [[f64; P]; N])
where
    M: Model<N, R, P>,
{
    let steps = discretization::sub_steps(interval_s, maximum_step_s);
    let mut x = *x;
    let mut by_parameter = [[0.0; P]; N];
    let mut transition = [[0.0; N]; N];
    for k in 0..steps {
        let part = Part { from: k as f64 / steps as f64, to: (k + 1) as f64 / steps as f64 };
        let sensitivity = &mut by_parameter;
        x = discretization::step(model, &x, theta, input, interval_s, part, columns, sensitivity, &mut transition);
    }
    (x, by_parameter)
}

/// The measured value of a state, if there is one in this sample.
pub(super) fn measured<M, const N: usize, const R: usize, const P: usize>(
    model: &M,
    state: usize,
    sample: &Sample<M::Input, R>,
) -> Option<f64>
where
    M: Model<N, R, P>,
{
    let output = model.measuring_output(state).filter(|&output| output < R)?;
    Some(sample.outputs[output]).filter(|y| y.is_finite())
}
