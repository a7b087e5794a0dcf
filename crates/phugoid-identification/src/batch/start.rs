//! Where the search for the initial states starts.

use crate::core::options::CAPACITY;
use phugoid_estimators::{Input, Model};
use phugoid_flight_data::statistics::median;

use super::error::BatchError;
use super::problem::{Manoeuvre, Structure};

/// Number of values whose median starts an initial state.
const FIRST: usize = 5;

/// The initial state of each manoeuvre: as given, or each state at the median of the first values of its output.
pub(crate) fn initial_states<M, I, const N: usize, const R: usize>(
    manoeuvres: &[Manoeuvre<'_, M, I, N, R>],
    structure: &Structure<N, R>,
) -> Result<Vec<[f64; N]>, BatchError>
where
    M: Model<N, R, CAPACITY, Input = I>,
    I: Input,
{
    manoeuvres
        .iter()
        .map(|m| {
            if let Some(given) = m.initial_state {
                return Ok(given);
            }
            let mut initial = [0.0; N];
            for (i, value) in initial.iter_mut().enumerate() {
                let output = m.model.measuring_output(i);
                let first = output.and_then(|output| {
                    let values = m.outputs.iter().map(|y| y[output]).filter(|v| v.is_finite());
                    median(&mut values.take(FIRST).collect::<Vec<f64>>())
                });
                *value = first.ok_or_else(|| {
                    let state = &structure.states[i].name;
                    BatchError::BadInput(format!(
                        "{}: nothing measures the state {state}, so that its start has to be given",
                        m.name
                    ))
                })?;
            }
            Ok(initial)
        })
        .collect()
}
