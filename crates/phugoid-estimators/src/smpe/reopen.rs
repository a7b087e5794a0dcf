//! Re-opening: the exact Gaussian book-keeping of "these parameters have just jumped by N(0, diag d^2)".

use super::columns::Columns;
use super::slot::Slot;
use crate::dense::Cholesky;

/// State variance added, in measurement variances: pays for the state error gathered between change and trigger.
const STATE_ALLOWANCE: f64 = 25.0;

/// Opens the `tested` columns of a slot again. `change_over_prior` is `d_j` over the prior standard deviation.
/// Gives `false`, with the slot in an unspecified but finite state, if the arithmetic fails.
///
/// With the joint covariance `[Px + U C U^T, U C; C U^T, C]`, a jump of the parameters alone gives `C' = C + Delta`,
/// ```text
/// U'  = U C C'^-1
/// Px' = Px + U_E (Delta_E^-1 + (C^-1)_EE)^-1 U_E^T + 25 diag(sigma^2)
/// ```
pub(crate) fn reopen<const N: usize, const R: usize, const P: usize>(
    slot: &mut Slot<N, P>,
    columns: &Columns<N, R, P>,
    tested: &[usize],
    change_over_prior: &[f64; P],
    noise_sd: &[f64; R],
) -> bool {
    let p = columns.count.min(P);
    let mut before = [[0.0; P]; P];
    slot.c.write_dense(&mut before);

    // G = Delta_E^-1 + (C^-1)_EE in scaled columns; a column whose d is zero now does not take part.
    let mut open = [0; P];
    let mut count = 0;
    for &column in tested {
        if change_over_prior[column] > 0.0 {
            open[count] = column;
            count += 1;
        }
    }
    let open = &open[..count];
    let mut g = [[0.0; P]; P];
    for (i, &column) in open.iter().enumerate() {
        let mut unit = [0.0; P];
        unit[column] = 1.0;
        slot.c.solve(&mut unit);
        for (j, &other) in open.iter().enumerate() {
            g[i][j] = unit[other];
        }
        g[i][i] += 1.0 / (change_over_prior[column] * change_over_prior[column]);
    }
    let Some(g) = Cholesky::new(&mut g, count) else { return false };

    // Px' : with G = L L^T and W = L^-1 U_E^T the increase is W^T W, one rank per open column.
    let mut w = [[0.0; N]; P];
    for state in 0..N {
        let mut row = [0.0; P];
        for (i, &column) in open.iter().enumerate() {
            row[i] = slot.sensitivity[state][column] * columns.sd[column];
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
        if let Some(output) = columns.output_of_state[state] {
            let mut unit = [0.0; N];
            unit[state] = 1.0;
            slot.px.add_rank_one(STATE_ALLOWANCE * noise_sd[output] * noise_sd[output], &unit);
        }
    }

    // C' = C + Delta, one rank per open column.
    for &column in open {
        let mut unit = [0.0; P];
        unit[column] = 1.0;
        slot.c.add_rank_one(change_over_prior[column] * change_over_prior[column], &unit);
    }

    // U'^T = C'^-1 (C U^T), state by state, in scaled columns.
    for state in 0..N {
        let mut y = [0.0; P];
        for i in 0..p {
            y[i] = (0..p).map(|j| before[i][j] * slot.sensitivity[state][j] * columns.sd[j]).sum();
        }
        slot.c.solve(&mut y);
        for j in 0..p {
            slot.sensitivity[state][j] =
                if columns.sd[j] > 0.0 { y[j] / columns.sd[j] } else { slot.sensitivity[state][j] };
        }
    }
    slot.limited = [false; P];
    slot.colour.reopen(&before, &slot.c);
    slot.is_sound(p)
}
