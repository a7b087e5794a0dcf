//! Which corrections are offered: those that make samples more likely that they were not fitted to.

use nalgebra::{DMatrix, DVector};

use super::solve::{Solution, with_priors};

/// Parts of the flights, one of which is held out at a time; fewer where the flights are short, of two blocks at least.
const PARTS: usize = 6;
const FEWEST: usize = 3;

/// By how much each unknown makes the samples more likely that are held out, in natural logarithms of the likelihood
/// (nats): the flights are cut into six parts (a short one into fewer), all unknowns are fitted to all but one of them, with this unknown and without,
/// and both fits are judged by the sixth. Each part is held out once. NaN where there are too few blocks.
///
/// The likelihood of a part is taken as a parabola about the estimate, which it is within the errors of the estimate:
/// the innovations of the filter are linear in small changes of the unknowns.
pub(super) fn held_out_gains(solution: &Solution) -> Vec<f64> {
    let count = solution.columns.len();
    let count_of_parts = PARTS.min(solution.blocks.len() / 2);
    if count_of_parts < FEWEST {
        return vec![f64::NAN; count];
    }
    let estimate = DVector::from_column_slice(&solution.values);
    // Of each part: information, and score of zero.
    let mut parts = vec![(DMatrix::<f64>::zeros(count, count), DVector::<f64>::zeros(count)); count_of_parts];
    for (k, (information, score)) in solution.blocks.iter().enumerate() {
        let (m, r) = &mut parts[k * count_of_parts / solution.blocks.len()];
        *m += information;
        *r += score + information * &estimate;
    }
    for (m, r) in &mut parts {
        for i in (0..count).filter(|i| solution.columns[*i].considered) {
            m.row_mut(i).fill(0.0);
            m.column_mut(i).fill(0.0);
            r[i] = 0.0;
        }
    }
    let mut gains = vec![0.0; count];
    for held in 0..count_of_parts {
        let (mut m, mut r) = (DMatrix::<f64>::zeros(count, count), DVector::<f64>::zeros(count));
        for (_, part) in parts.iter().enumerate().filter(|(i, _)| *i != held) {
            m += &part.0;
            r += &part.1;
        }
        let Some(covariance) = with_priors(&solution.columns, &m) else { return vec![f64::NAN; count] };
        let with = &covariance * &r;
        let (m, r) = &parts[held];
        let loss = |c: &DVector<f64>| 0.5 * c.dot(&(m * c)) - r.dot(c);
        let full = loss(&with);
        for (j, gain) in gains.iter_mut().enumerate() {
            // The fit with this unknown held at zero, all others free.
            let without = &with - covariance.column(j) * (with[j] / covariance[(j, j)]);
            *gain += loss(&without) - full;
        }
    }
    gains
}
