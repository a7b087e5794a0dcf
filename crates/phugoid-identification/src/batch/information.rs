//! The information matrix: steps of the search, covariance, and the combination of unknowns that a singular one names.

use nalgebra::{Cholesky, DMatrix, DVector, Dyn};

use super::error::BatchError;

/// Smallest eigenvalue of the information, scaled to a unit diagonal, that counts as regular: the sums that make it are
/// good to about 1e-15 times the root of the number of samples.
const REGULAR: f64 = 1e-12;

/// An unknown with less information than this counts as one that moves no output: a whole unit of it moves all outputs
/// together by less than 1e-12 standard deviations, as with a surface at the rounding error of zero.
const SILENT: f64 = 1e-24;

/// Scales that make the diagonal one; 1 for an unknown without any information.
fn scales(information: &DMatrix<f64>) -> DVector<f64> {
    information.diagonal().map(|d| if d > 0.0 { d.sqrt() } else { 1.0 })
}

fn scaled(information: &DMatrix<f64>, scale: &DVector<f64>) -> DMatrix<f64> {
    DMatrix::from_fn(scale.len(), scale.len(), |i, j| information[(i, j)] / (scale[i] * scale[j]))
}

/// Solves `(M + damping diag M) step = descent` for the unknowns not `frozen`; the others get no step.
/// None if that is singular to rounding.
pub(crate) fn solve(
    information: &DMatrix<f64>,
    descent: &DVector<f64>,
    damping: f64,
    frozen: &[bool],
) -> Option<DVector<f64>> {
    let free: Vec<usize> = (0..frozen.len()).filter(|&j| !frozen[j]).collect();
    let mut step = DVector::zeros(frozen.len());
    if free.is_empty() {
        return Some(step);
    }
    let part = DMatrix::from_fn(free.len(), free.len(), |i, j| information[(free[i], free[j])]);
    let scale = scales(&part);
    let mut part = scaled(&part, &scale);
    for j in 0..free.len() {
        // An unknown that moves no output gets no step.
        part[(j, j)] = if part[(j, j)] > 0.0 { part[(j, j)] + damping } else { 1.0 };
    }
    let factor: Cholesky<f64, Dyn> = Cholesky::new(part)?;
    let smallest = factor.l_dirty().diagonal().iter().fold(f64::INFINITY, |a, b| a.min(*b));
    if smallest.is_nan() || smallest * smallest < REGULAR {
        return None;
    }
    let right = DVector::from_fn(free.len(), |j, _| descent[free[j]] / scale[j]);
    let solution = factor.solve(&right);
    for (j, &unknown) in free.iter().enumerate() {
        step[unknown] = solution[j] / scale[j];
    }
    step.iter().all(|v| v.is_finite()).then_some(step)
}

/// The inverse of the information.
///
/// # Errors
/// [`BatchError::Singular`] with the combination of unknowns that the data do not see.
pub(crate) fn covariance(
    information: &DMatrix<f64>,
    name: impl Fn(usize) -> String,
) -> Result<DMatrix<f64>, BatchError> {
    inverse_of(information, &name)
}

/// Compiled once, however many callers name their unknowns: the decompositions and the sorting are large.
fn inverse_of(information: &DMatrix<f64>, name: &dyn Fn(usize) -> String) -> Result<DMatrix<f64>, BatchError> {
    let n = information.nrows();
    if n == 0 {
        return Ok(DMatrix::zeros(0, 0));
    }
    if let Some(silent) = (0..n).find(|&j| information[(j, j)].is_nan() || information[(j, j)] < SILENT) {
        return Err(BatchError::Singular { culprits: vec![(name(silent), 1.0)] });
    }
    let scale = scales(information);
    let unit = scaled(information, &scale);
    let eigen = unit.clone().symmetric_eigen();
    let weakest = eigen.eigenvalues.imin();
    let inverse = Cholesky::new(unit).filter(|_| eigen.eigenvalues[weakest] > REGULAR).map(|c| c.inverse());
    if let Some(inverse) = inverse {
        return Ok(DMatrix::from_fn(n, n, |i, j| inverse[(i, j)] / (scale[i] * scale[j])));
    }
    let direction = eigen.eigenvectors.column(weakest);
    let largest = direction.amax();
    let mut members: Vec<usize> = (0..n).filter(|&j| direction[j].abs() > 0.1 * largest).collect();
    members.sort_by(|a, b| direction[*b].abs().total_cmp(&direction[*a].abs()));
    // In the unknowns' own units, the strongest by one.
    let unit_step = members.first().map_or(1.0, |&j| direction[j] / scale[j]);
    let culprits = members.iter().take(5).map(|&j| (name(j), direction[j] / scale[j] / unit_step)).collect();
    Err(BatchError::Singular { culprits })
}
