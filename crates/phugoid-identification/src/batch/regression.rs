//! Which terms an equation needs: stepwise regression by partial F.

use nalgebra::{DMatrix, DVector};
use serde::{Deserialize, Serialize};

use super::layout::Place;
use super::response::Rows;
use super::result::BatchFit;

/// Equations that share parameters, solved together: the pitching moment alone, or lift and drag in two accelerations.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Equation {
    /// Left sides: a rate such as `d(q)/dt`, or a measured acceleration.
    pub left_sides: Vec<String>,
    /// Samples used, over all left sides.
    pub samples: usize,
    /// Share of the left sides' squares about their means that all terms together explain, each left side weighted by
    /// its residual variance. What is known of the left side (tables, fixed terms) is taken off before.
    pub r_squared: f64,
    /// Standard deviation of the residual of each left side, its unit.
    #[serde(alias = "residual_sd")]
    pub residual_std: Vec<f64>,
    /// Terms in the order in which stepwise regression takes them in: each time the one that helps most.
    pub terms: Vec<Term>,
}

/// One term of an equation, with the statistics that say whether the equation needs it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Term {
    /// Name of the parameter that multiplies the term.
    pub name: String,
    /// Estimate with all terms of the equation present, in the parameter's unit.
    pub value: f64,
    /// Its standard error, corrected for the colour of the residuals.
    pub corrected_std_error: f64,
    /// Partial F with all other terms present: how much worse the fit is without it.
    pub partial_f: f64,
    /// Partial F when it was taken in.
    pub f_when_entered: f64,
    /// R squared of the equation with this term and all terms before it.
    pub r_squared: f64,
    /// True if the partial F reaches [`EquationErrorSettings::f_to_enter`](super::EquationErrorSettings::f_to_enter):
    /// the equation needs the term.
    pub needed: bool,
}

/// The equations by groups that share parameters (Klein & Morelli, Aircraft System Identification, section 5.4:
/// forward selection by partial F, and the F of each term in the whole equation).
pub(crate) fn equations<const R: usize>(
    rows: &[Rows<R>],
    noise_std: &[f64; R],
    places: &[Place],
    unknowns: &[f64],
    fit: &BatchFit,
    f_to_enter: f64,
    name: impl Fn(usize) -> String,
) -> Vec<Equation> {
    let groups = groups(rows, places.len());
    groups
        .iter()
        .map(|(outputs, columns)| {
            let sums = Sums::of(rows, outputs, columns, unknowns);
            Equation {
                left_sides: outputs.iter().map(|&i| name(i)).collect(),
                samples: sums.count as usize,
                r_squared: sums.r_squared(&(0..columns.len()).collect::<Vec<_>>()),
                residual_std: outputs.iter().map(|&i| noise_std[i]).collect(),
                terms: terms(&sums, columns, fit, f_to_enter),
            }
        })
        .collect()
}

/// Outputs and columns of each group.
fn groups<const R: usize>(rows: &[Rows<R>], unknowns: usize) -> Vec<(Vec<usize>, Vec<usize>)> {
    let mut used = [const { Vec::new() }; R];
    for (i, columns) in used.iter_mut().enumerate() {
        let moves = |column: usize| {
            rows.iter().any(|r| {
                r.columns.iter().position(|&j| j == column).is_some_and(|at| {
                    (0..r.residuals.len()).any(|k| r.residuals[k][i].is_finite() && r.sensitivity(k, i)[at] != 0.0)
                })
            })
        };
        *columns = (0..unknowns).filter(|&j| moves(j)).collect();
    }
    let mut groups: Vec<(Vec<usize>, Vec<usize>)> = Vec::new();
    for (i, columns) in used.iter().enumerate().filter(|(_, c)| !c.is_empty()) {
        let (mut outputs, mut all) = (vec![i], columns.clone());
        groups.retain(|(others, theirs)| {
            let shares = theirs.iter().any(|j| all.contains(j));
            if shares {
                outputs.extend(others);
                all.extend(theirs);
            }
            !shares
        });
        outputs.sort_unstable();
        all.sort_unstable();
        all.dedup();
        groups.push((outputs, all));
    }
    groups.sort();
    groups
}

/// Sums of squares and products of one group, in units of each left side's residual.
struct Sums {
    normal: DMatrix<f64>,
    right: DVector<f64>,
    /// `sum z^2`, and the same about the mean of each left side.
    squares: f64,
    about_mean: f64,
    count: f64,
}

impl Sums {
    fn of<const R: usize>(rows: &[Rows<R>], outputs: &[usize], columns: &[usize], unknowns: &[f64]) -> Self {
        let p = columns.len();
        let mut sums =
            Self { normal: DMatrix::zeros(p, p), right: DVector::zeros(p), squares: 0.0, about_mean: 0.0, count: 0.0 };
        for &i in outputs {
            let (mut n, mut sum, mut squares) = (0.0, 0.0, 0.0);
            for r in rows {
                let places: Vec<Option<usize>> =
                    columns.iter().map(|column| r.columns.iter().position(|j| j == column)).collect();
                for (k, residuals) in r.residuals.iter().enumerate().filter(|(_, e)| e[i].is_finite()) {
                    let all = r.sensitivity(k, i);
                    let row = DVector::from_fn(p, |j, _| places[j].map_or(0.0, |at| all[at]));
                    let explained: f64 = columns.iter().zip(row.iter()).map(|(&j, s)| unknowns[j] * s).sum();
                    let z = residuals[i] + explained;
                    sums.normal.ger(1.0, &row, &row, 1.0);
                    sums.right.axpy(z, &row, 1.0);
                    (n, sum, squares) = (n + 1.0, sum + z, squares + z * z);
                }
            }
            sums.squares += squares;
            sums.about_mean += squares - sum * sum / f64::max(n, 1.0);
            sums.count += n;
        }
        sums
    }

    /// Sum of squared residuals with these terms only; `None` if the data do not determine all of them.
    fn unexplained(&self, terms: &[usize]) -> Option<f64> {
        if terms.is_empty() {
            return Some(self.squares);
        }
        let scale: Vec<f64> = terms.iter().map(|&j| self.normal[(j, j)].sqrt()).collect();
        let normal = DMatrix::from_fn(terms.len(), terms.len(), |a, b| {
            self.normal[(terms[a], terms[b])] / (scale[a] * scale[b])
        });
        let right = DVector::from_fn(terms.len(), |a, _| self.right[terms[a]] / scale[a]);
        let explained = right.dot(&normal.cholesky()?.solve(&right));
        Some((self.squares - explained).max(0.0))
    }

    fn r_squared(&self, terms: &[usize]) -> f64 {
        self.unexplained(terms).map_or(f64::NAN, |rest| 1.0 - rest / self.about_mean)
    }

    /// Partial F of one more term: the drop of the squared residual over the variance that is left.
    fn partial_f(&self, others: &[usize], term: usize) -> Option<f64> {
        let with: Vec<usize> = others.iter().copied().chain([term]).collect();
        let (before, after) = (self.unexplained(others)?, self.unexplained(&with)?);
        Some((before - after) / (after / (self.count - with.len() as f64).max(1.0)).max(f64::MIN_POSITIVE))
    }
}

fn terms(sums: &Sums, columns: &[usize], fit: &BatchFit, f_to_enter: f64) -> Vec<Term> {
    let p = columns.len();
    let mut entered: Vec<usize> = Vec::with_capacity(p);
    let mut terms = Vec::with_capacity(p);
    while entered.len() < p {
        let outside = (0..p).filter(|j| !entered.contains(j));
        let best = outside.filter_map(|j| Some((sums.partial_f(&entered, j)?, j))).max_by(|a, b| a.0.total_cmp(&b.0));
        let Some((f, j)) = best else { break };
        entered.push(j);
        let others: Vec<usize> = (0..p).filter(|&other| other != j).collect();
        let partial_f = sums.partial_f(&others, j).unwrap_or(f64::NAN);
        let unknown = &fit.unknowns[columns[j]];
        terms.push(Term {
            name: unknown.name.clone(),
            value: unknown.value,
            corrected_std_error: unknown.corrected_std_error,
            partial_f,
            f_when_entered: f,
            r_squared: sums.r_squared(&entered),
            needed: partial_f >= f_to_enter,
        });
    }
    terms
}
