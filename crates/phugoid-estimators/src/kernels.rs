//! Inner loops over the parameter columns, in blocks of four: run-time lengths of 5 or 11 are too short for the
//! compiler's own vectorisation to pay (its prologue costs more than the work).

/// Largest room for which the arithmetic is compiled a second time, for a room that is full: with the length as a
/// constant the loops unroll. Beyond it the loops are long enough to pay for their own overhead, and the second copy is
/// only size.
const UNROLLED: usize = 16;

/// True if `used` of `room` places are all of them and the copy for a full room is compiled.
#[inline(always)]
pub(crate) const fn is_full(used: usize, room: usize) -> bool {
    room <= UNROLLED && used >= room
}

/// `y += a x` over the shorter length.
#[inline(always)]
pub(crate) fn add_scaled(y: &mut [f64], a: f64, x: &[f64]) {
    // Equal lengths, or the blocks and the rests of the two would not belong together.
    let n = y.len().min(x.len());
    let (y, x) = (&mut y[..n], &x[..n]);
    let (y_blocks, y_rest) = y.as_chunks_mut::<4>();
    let (x_blocks, x_rest) = x.as_chunks::<4>();
    for (y, x) in y_blocks.iter_mut().zip(x_blocks) {
        for l in 0..4 {
            y[l] += a * x[l];
        }
    }
    for (y, x) in y_rest.iter_mut().zip(x_rest) {
        *y += a * x;
    }
}

/// [`add_scaled`] over the first `p` of `P` places. A full room has a loop of its own, with the length as a constant.
#[inline(always)]
pub(crate) fn add_scaled_in<const P: usize>(p: usize, y: &mut [f64; P], a: f64, x: &[f64; P]) {
    if p >= P { add_scaled(y, a, x) } else { add_scaled(&mut y[..p], a, &x[..p]) }
}

/// [`dot`] over the first `p` of `P` places, like [`add_scaled_in`].
#[inline(always)]
pub(crate) fn dot_in<const P: usize>(p: usize, x: &[f64; P], y: &[f64; P]) -> f64 {
    if p >= P { dot(x, y) } else { dot(&x[..p], &y[..p]) }
}

/// `sum x y` over the shorter length, in four partial sums.
#[inline(always)]
pub(crate) fn dot(x: &[f64], y: &[f64]) -> f64 {
    let n = x.len().min(y.len());
    let (x, y) = (&x[..n], &y[..n]);
    let (x_blocks, x_rest) = x.as_chunks::<4>();
    let (y_blocks, y_rest) = y.as_chunks::<4>();
    let mut rest = 0.0;
    for (x, y) in x_rest.iter().zip(y_rest) {
        rest += x * y;
    }
    if x_blocks.is_empty() {
        return rest;
    }
    let mut sums = [0.0; 4];
    for (x, y) in x_blocks.iter().zip(y_blocks) {
        for l in 0..4 {
            sums[l] += x[l] * y[l];
        }
    }
    (sums[0] + sums[2]) + (sums[1] + sums[3]) + rest
}

/// Bierman's inner loop, `u, b <- u + lambda b, b + g u`, over the shorter length.
#[inline(always)]
pub(crate) fn rotate(u: &mut [f64], b: &mut [f64], lambda: f64, g: f64) {
    let n = u.len().min(b.len());
    let (u, b) = (&mut u[..n], &mut b[..n]);
    let (u_blocks, u_rest) = u.as_chunks_mut::<4>();
    let (b_blocks, b_rest) = b.as_chunks_mut::<4>();
    for (u, b) in u_blocks.iter_mut().zip(b_blocks) {
        for l in 0..4 {
            let before = u[l];
            u[l] = before + lambda * b[l];
            b[l] += g * before;
        }
    }
    for (u, b) in u_rest.iter_mut().zip(b_rest) {
        let before = *u;
        *u = before + lambda * *b;
        *b += g * before;
    }
}

/// The transition over several parts of an interval: `product <- part product`, or `part` itself if it is the first.
pub(crate) fn chain<const N: usize>(product: &mut [[f64; N]; N], part: &[[f64; N]; N], first: bool) {
    if first {
        *product = *part;
        return;
    }
    let before = *product;
    for (row, part) in product.iter_mut().zip(part) {
        *row = [0.0; N];
        for (factor, from) in part.iter().zip(&before) {
            for (to, from) in row.iter_mut().zip(from) {
                *to += factor * from;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{add_scaled, dot, rotate};

    /// Every pair of lengths around the block size, against the loop one would write.
    #[test]
    fn any_two_lengths_agree_with_the_plain_loop() {
        let x: [f64; 13] = core::array::from_fn(|i| 1.0 + i as f64);
        let z: [f64; 13] = core::array::from_fn(|i| 0.5 - (i * i) as f64);
        for n in 0..13 {
            for m in 0..13 {
                let shorter = n.min(m);
                let mut y = z;
                add_scaled(&mut y[..n], 2.0, &x[..m]);
                let (mut u, mut b) = (x, z);
                rotate(&mut u[..n], &mut b[..m], 3.0, -2.0);
                for i in 0..13 {
                    let used = i < shorter;
                    assert_eq!(y[i], if used { z[i] + 2.0 * x[i] } else { z[i] });
                    assert_eq!(u[i], if used { x[i] + 3.0 * z[i] } else { x[i] });
                    assert_eq!(b[i], if used { z[i] - 2.0 * x[i] } else { z[i] });
                }
                // Whole numbers and halves: exact in any order.
                let plain: f64 = (0..shorter).map(|i| x[i] * z[i]).sum();
                assert_eq!(dot(&x[..n], &z[..m]), plain);
            }
        }
    }
}
