//! Re-opening: the exact Gaussian book-keeping of "these parameters have just jumped by N(0, diag d^2)".

use crate::bounded::{Places, at, unit};
use crate::dense::Cholesky;
use crate::smpe::separated::Separated;
use crate::supervisor::slot::Slot;

/// Opens the `tested` columns of a slot again. `change_over_prior` is `d_j` over the prior standard deviation; `std`
/// holds the prior standard deviations of the columns in use; `state_variance` is added to the variances of the states.
/// Gives `false`, with the slot in an unspecified but finite state, if the arithmetic fails.
///
/// With the joint covariance `[Px + U C U^T, U C; C U^T, C]`, a jump of the parameters alone gives `C' = C + Delta`,
/// ```text
/// U'  = U C C'^-1
/// Px' = Px + U_E (Delta_E^-1 + (C^-1)_EE)^-1 U_E^T + allowance diag(sigma^2)
/// ```
pub(crate) fn reopen<const N: usize, const P: usize>(
    slot: &mut Separated<N, P>,
    std: &[f64],
    tested: &[usize],
    change_over_prior: &[f64; P],
    state_variance: &[f64; N],
) -> bool {
    let p = std.len().min(P);
    let mut before = [[0.0; P]; P];
    slot.c.write_dense(&mut before);

    // G = Delta_E^-1 + (C^-1)_EE in scaled columns; a column whose d is zero now does not take part.
    let mut open = Places::<P>::NONE;
    for &column in tested {
        if at(change_over_prior, column) > 0.0 {
            open.push(column);
        }
    }
    let count = open.len();
    let mut g = [[0.0; P]; P];
    for i in 0..count {
        let column = open.column(i);
        let mut row = unit(column);
        slot.c.solve(&mut row);
        for j in 0..count {
            g[i][j] = row[open.column(j)];
        }
        g[i][i] += 1.0 / (change_over_prior[column] * change_over_prior[column]);
    }
    let Some(g) = Cholesky::new(&mut g, count) else { return false };

    // Px' : with G = L L^T and W = L^-1 U_E^T the increase is W^T W, one rank per open column.
    let mut w = [[0.0; N]; P];
    for state in 0..N {
        let mut row = [0.0; P];
        for i in 0..count {
            let column = open.column(i);
            row[i] = slot.sensitivity[state][column] * at(std, column);
        }
        g.solve_lower(&mut row);
        for i in 0..count {
            w[i][state] = row[i];
        }
    }
    for rank in &w[..count] {
        slot.px.add_rank_one(1.0, rank);
    }
    for state in 0..N {
        slot.px.add_rank_one(state_variance[state], &unit(state));
    }

    // C' = C + Delta, one rank per open column.
    for &column in open.as_slice() {
        let change = at(change_over_prior, column);
        slot.c.add_rank_one(change * change, &unit(column));
    }

    // U'^T = C'^-1 (C U^T), state by state, in scaled columns.
    for state in 0..N {
        let mut y = [0.0; P];
        for i in 0..p {
            y[i] = (0..p).map(|j| before[i][j] * slot.sensitivity[state][j] * std[j]).sum();
        }
        slot.c.solve(&mut y);
        for j in 0..p {
            slot.sensitivity[state][j] = if std[j] > 0.0 { y[j] / std[j] } else { slot.sensitivity[state][j] };
        }
    }
    slot.common.limited = [false; P];
    slot.common.colour.reopen(&before, &slot.c);
    Slot::is_sound(slot, p)
}

#[cfg(test)]
mod tests {
    use super::super::separated::Separated;
    use super::reopen;
    use crate::columns::Columns;
    use crate::settings::ChangePrior;
    use crate::supervisor::common::Common;
    use crate::ud::Ud;
    use rand::{RngExt, SeedableRng};
    use rand_pcg::Pcg64Mcg;

    const N: usize = 3;
    const R: usize = 2;
    const P: usize = 9;
    /// Columns in use: less than the capacity and no multiple of a block of the inner loops.
    const COLUMNS: usize = 7;
    const J: usize = N + COLUMNS;

    fn joint(slot: &Separated<N, P>, columns: &Columns<R, P>) -> [[f64; J]; J] {
        let (mut px, mut c) = ([[0.0; N]; N], [[0.0; P]; P]);
        slot.px.write_dense(&mut px);
        slot.c.write_dense(&mut c);
        // U C in raw units; the state block is Px + U C U^T.
        let raw = |i: usize, j: usize| columns.std[i] * c[i][j] * columns.std[j];
        let uc = |state: usize, j: usize| (0..COLUMNS).map(|i| slot.sensitivity[state][i] * raw(i, j)).sum::<f64>();
        core::array::from_fn(|a| {
            core::array::from_fn(|b| match (a < N, b < N) {
                (true, true) => px[a][b] + (0..COLUMNS).map(|j| uc(a, j) * slot.sensitivity[b][j]).sum::<f64>(),
                (true, false) => uc(a, b - N),
                (false, true) => uc(b, a - N),
                (false, false) => raw(a - N, b - N),
            })
        })
    }

    /// A jump of the tested parameters adds its variance to their block of the joint covariance and changes nothing
    /// else, but for the allowance on the measured states.
    #[test]
    fn the_joint_covariance_grows_by_the_jump_alone() {
        let mut rng = Pcg64Mcg::seed_from_u64(3);
        for _ in 0..50 {
            let mut uniform = || 2.0 * rng.random::<f64>() - 1.0;
            let mut columns = Columns::<R, P> {
                count: COLUMNS,
                own: 5,
                initial: [0.0; P],
                std: core::array::from_fn(|j| if j < COLUMNS { 10_f64.powf(2.0 * uniform()) } else { 0.0 }),
                clip_low: [f64::NEG_INFINITY; P],
                clip_high: [f64::INFINITY; P],
                change: [ChangePrior::None; P],
                bias_of_output: [Some(5), Some(6)],
            };
            // A fixed parameter among them.
            columns.std[1] = 0.0;
            let mut slot = Separated::<N, P> {
                common: Common {
                    x: [0.0; N],
                    theta: [0.0; P],
                    noise_scale: 1.0,
                    noise_information: 0.0,
                    colour: crate::supervisor::colour::Colour::new(),
                    limited: [true; P],
                },
                sensitivity: core::array::from_fn(|_| {
                    core::array::from_fn(|j| {
                        if j < COLUMNS && columns.std[j] > 0.0 { uniform() / columns.std[j] } else { 0.0 }
                    })
                }),
                px: Ud::from_variances(&[0.3, 0.02, 0.1]),
                c: Ud::from_variances(&[1.0; COLUMNS]),
            };
            slot.px.add_rank_one(0.2, &[uniform(), uniform(), uniform()]);
            for _ in 0..4 {
                let row: [f64; P] =
                    core::array::from_fn(|j| if j == 1 || j >= COLUMNS { 0.0 } else { 3.0 * uniform() });
                let projection = slot.c.project(&row, 1.0);
                slot.c.update(&projection, 1.0);
            }
            let tested = [0, 2, 4];
            let mut change = [0.0; P];
            change[0] = 0.5;
            change[2] = 0.0; // a relative change prior of a parameter that is zero just now
            change[4] = 2.0;
            let before = joint(&slot, &columns);
            assert!(reopen(
                &mut slot,
                &columns.std[..COLUMNS],
                &tested,
                &change,
                &[25.0 * 0.2 * 0.2, 0.0, 25.0 * 0.05 * 0.05]
            ));
            let after = joint(&slot, &columns);
            let mut expected = before;
            expected[0][0] += 25.0 * 0.2 * 0.2;
            expected[2][2] += 25.0 * 0.05 * 0.05;
            for j in tested {
                expected[N + j][N + j] += (change[j] * columns.std[j]).powi(2);
            }
            for a in 0..J {
                for b in 0..J {
                    let size = (expected[a][a] * expected[b][b]).sqrt();
                    let error = (after[a][b] - expected[a][b]).abs();
                    assert!(error <= 1e-10 * size, "{a} {b}: {} {}", after[a][b], expected[a][b]);
                }
            }
            assert!(!slot.common.limited.contains(&true));
        }
    }
}
