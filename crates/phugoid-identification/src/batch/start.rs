//! Where the integration of a manoeuvre starts: at its first sample, and again after every gap.

use phugoid_flight_data::statistics::median;

use super::error::BatchError;
use super::problem::{Manoeuvre, Structure};

/// Number of values whose median starts a state. A stretch between gaps in which a state has fewer is left out.
const FIRST: usize = 5;

/// The samples of a manoeuvre between two gaps. Samples outside of all stretches are not used.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Stretch<const N: usize> {
    /// First sample.
    pub(crate) from: usize,
    /// First sample after it.
    pub(crate) to: usize,
    /// State at the first sample: held there, or where the search starts.
    pub(crate) state: [f64; N],
}

/// The stretches of each manoeuvre, with their initial states: as given for the first, or each state at the median of
/// the first values of its output.
pub(crate) fn stretches<const N: usize, const R: usize>(
    manoeuvres: &[Manoeuvre<'_, N, R>],
    structure: &Structure<N, R>,
) -> Result<Vec<Vec<Stretch<N>>>, BatchError> {
    manoeuvres.iter().map(|m| of_manoeuvre(m, structure)).collect()
}

/// The samples between two gaps: first, and first after it.
pub(super) fn between_gaps(time_s: &[f64], maximum_gap_s: f64) -> Vec<[usize; 2]> {
    let samples = time_s.len();
    let gaps = (1..samples).filter(|&k| time_s[k] - time_s[k - 1] > maximum_gap_s);
    let limits: Vec<usize> = std::iter::once(0).chain(gaps).chain([samples]).collect();
    limits.windows(2).map(|pair| [pair[0], pair[1]]).collect()
}

fn of_manoeuvre<const N: usize, const R: usize>(
    m: &Manoeuvre<'_, N, R>,
    structure: &Structure<N, R>,
) -> Result<Vec<Stretch<N>>, BatchError> {
    let pieces = between_gaps(m.time_s, structure.maximum_gap_s);
    let whole = pieces.len() == 1;
    let mut lacking = None;
    let mut found = Vec::new();
    for [from, to] in pieces {
        if let Some(state) = m.initial_state.filter(|_| from == 0) {
            found.push(Stretch { from, to, state });
            continue;
        }
        let first: [Option<f64>; N] = std::array::from_fn(|i| {
            let measured = m.plant.measuring_output(i);
            let is_measured = measured.is_some_and(|output| m.outputs.iter().any(|y| y[output].is_finite()));
            let Some(output) = measured.filter(|_| is_measured) else { return m.plant.unmeasured_start(i) };
            let values = m.outputs[from..to].iter().map(|y| y[output]).filter(|v| v.is_finite());
            let mut values: Vec<f64> = values.take(FIRST).collect();
            if whole || values.len() == FIRST { median(&mut values) } else { None }
        });
        match first.iter().position(Option::is_none) {
            Some(i) => lacking = lacking.or(Some(i)),
            None => found.push(Stretch { from, to, state: first.map(|value| value.unwrap_or(f64::NAN)) }),
        }
    }
    if found.is_empty() {
        let state = lacking.map_or("", |i| structure.states[i].name.as_str());
        let unless = if whole { "" } else { " in any stretch between two gaps" };
        return Err(BatchError::BadInput(format!(
            "{}: nothing measures the state {state}{unless}, so that its start has to be given",
            m.name
        )));
    }
    Ok(found)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::batch::{InitialState, Noise, OutputChannel, WithInputs};
    use crate::core::options::{CAPACITY, Likelihood};
    use phugoid_estimators::discretization::InputHold;
    use phugoid_estimators::{LinearizedOutputs, LinearizedRates, Model};

    /// `x' = 0`, and `x` is measured.
    struct Constant;

    impl Model<1, 1, CAPACITY> for Constant {
        type Input = [f64; 1];
        fn parameter_count(&self) -> usize {
            0
        }
        fn rates(&self, _: &[f64; 1], _: &[f64; CAPACITY], _: &[f64; 1]) -> [f64; 1] {
            [0.0]
        }
        fn linearized_rates(
            &self,
            _: &[f64; 1],
            _: &[f64; CAPACITY],
            _: &[f64; 1],
            out: &mut LinearizedRates<1, CAPACITY>,
        ) {
            *out = LinearizedRates::ZERO;
        }
        fn linearized_outputs(
            &self,
            x: &[f64; 1],
            _: &[f64; CAPACITY],
            _: &[f64; 1],
            out: &mut LinearizedOutputs<1, 1, CAPACITY>,
        ) {
            *out = LinearizedOutputs::ZERO;
            (out.outputs, out.state_jacobian) = (*x, [[1.0]]);
        }
        fn measuring_output(&self, _state: usize) -> Option<usize> {
            Some(0)
        }
    }

    fn structure() -> Structure<1, 1> {
        Structure {
            parameters: Vec::new(),
            states: [InitialState::free("x")],
            outputs: [OutputChannel::new("x", Noise::Estimated)],
            maximum_step_s: 0.02,
            maximum_gap_s: 0.5,
            likelihood: Likelihood::Robust,
        }
    }

    fn found(time_s: &[f64], outputs: &[[f64; 1]]) -> Result<Vec<Stretch<1>>, BatchError> {
        let inputs = vec![[0.0]; time_s.len()];
        let plant = WithInputs { model: &Constant, inputs: &inputs };
        let (name, hold, initial_state) = ("flight", InputHold::Linear, None);
        of_manoeuvre(&Manoeuvre { name, plant: &plant, first: 0, time_s, hold, outputs, initial_state }, &structure())
    }

    #[test]
    fn every_gap_begins_a_stretch_and_one_that_tells_too_little_is_left_out() {
        // Ten samples, a gap, three samples, a gap, ten samples.
        let time_s: Vec<f64> = (0..23).map(|k| 0.1 * f64::from(k) + if k < 10 { 0.0 } else { 30.0 }).collect();
        let time_s: Vec<f64> = time_s.iter().enumerate().map(|(k, t)| if k < 13 { *t } else { t + 1.0 }).collect();
        let mut outputs: Vec<[f64; 1]> = (0..23).map(|k| [f64::from(k)]).collect();
        outputs[13] = [f64::NAN];
        let stretches = found(&time_s, &outputs).unwrap();
        assert_eq!(
            stretches,
            [Stretch { from: 0, to: 10, state: [2.0] }, Stretch { from: 13, to: 23, state: [16.0] }],
            "the start is the median of the first five values that were measured"
        );
    }

    #[test]
    fn a_flight_without_gaps_starts_from_what_it_has() {
        let time_s = [0.0, 0.1, 0.2];
        assert_eq!(found(&time_s, &[[f64::NAN], [4.0], [f64::NAN]]).unwrap()[0].state, [4.0]);
        let refused = found(&time_s, &[[f64::NAN]; 3]).unwrap_err().to_string();
        assert!(refused.contains("nothing measures the state x"), "{refused}");
    }
}
