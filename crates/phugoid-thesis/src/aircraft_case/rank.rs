//! What one surface says of two coefficients.

use phugoid_estimators::{LinearizedRates, Model};
use phugoid_identification::longitudinal::STATES;

use super::case::AircraftCase;
use super::reference::Reference;
use phugoid_evaluation::table::{Cell, Column, Table};

const Q: usize = 3;
const ROOM: usize = super::case::PARAMETERS.len();

/// The surface over q asks for `z_alpha dCm_alpha + z_q dCm_q = const`: one row, whose second singular value is zero at every
/// instant. Rows at different instants point in different directions, so that the accumulated ones have rank two. None where
/// the case does not look for both.
pub(super) fn rank(case: &AircraftCase, reference: &Reference) -> Option<Table> {
    let index = |name: &str| reference.names.iter().position(|own| own == name);
    let (alpha, pitch) = (index("dCm_alpha")?, index("dCm_q")?);
    let mut theta = [0.0; ROOM];
    theta.iter_mut().zip(&reference.names).for_each(|(slot, name)| *slot = case.truth(name));
    // In units of the bounds' half widths, so that the two columns may be compared.
    let width = |name: &str| case.parameters.get(name).map_or(f64::NAN, |told| 0.5 * (told.upper - told.lower));
    let (width_alpha, width_pitch) = (width("dCm_alpha"), width("dCm_q"));
    let start = reference.input_starts_s?;
    let mut lin = LinearizedRates::<STATES, ROOM>::ZERO;
    let mut sums = [[0.0; 2]; 2];
    let mut rows = Vec::new();
    let mut next = start;
    for (k, &time) in reference.time.iter().enumerate() {
        let x = reference.states[k];
        reference.model.linearized_rates(&x, &theta, &reference.inputs[k], &mut lin);
        let z = [x[Q] * lin.regressors[Q][alpha] * width_alpha, x[Q] * lin.regressors[Q][pitch] * width_pitch];
        for i in 0..2 {
            for j in 0..2 {
                sums[i][j] += z[i] * z[j];
            }
        }
        if time + 1e-9 >= next + 0.5 {
            next += 0.5;
            let [largest, smallest] = eigenvalues(&sums);
            let condition = if smallest > 0.0 { (largest / smallest).sqrt() } else { f64::INFINITY };
            rows.push(vec![
                Cell::from(time),
                z[0].into(),
                z[1].into(),
                z[0].hypot(z[1]).into(),
                Cell::from(0.0),
                condition.into(),
            ]);
        }
        if rows.len() == 10 {
            break;
        }
    }
    let names = ["z of dCm_alpha", "z of dCm_q", "larger singular value", "smaller", "condition of all rows so far"];
    let columns = std::iter::once(Column::new("time", "s")).chain(names.map(|name| Column::new(name, ""))).collect();
    let title = "One surface, two coefficients: at every instant one row of rank one; only accumulated rows tell them apart \
                 (columns in half widths of the bounds)";
    Some(Table { title: title.to_owned(), columns, rows })
}

/// Eigenvalues of a symmetric matrix, larger first.
fn eigenvalues(m: &[[f64; 2]; 2]) -> [f64; 2] {
    let (mean, half) = (0.5 * (m[0][0] + m[1][1]), 0.5 * (m[0][0] - m[1][1]));
    let largest = mean + half.hypot(m[0][1]);
    // The product, not the difference: the smaller one may be far below rounding of the larger.
    let smallest = (m[0][0] * m[1][1] - m[0][1] * m[1][0]) / largest;
    [largest, smallest]
}
