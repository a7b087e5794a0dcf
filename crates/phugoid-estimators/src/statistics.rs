//! Order statistics of a few values, without allocation.

use crate::bounded::at;

/// Median of finite values; the mean of the middle two for an even count. Zero for none.
pub(crate) fn median(values: &mut [f64]) -> f64 {
    sort(values);
    let n = values.len();
    match n {
        0 => 0.0,
        _ if n % 2 == 1 => at(values, n / 2),
        _ => 0.5 * (at(values, n / 2 - 1) + at(values, n / 2)),
    }
}

/// Heap sort, in the order of `f64::total_cmp`. (The sort of the core library contains code that panics where an order
/// is none.)
fn sort(values: &mut [f64]) {
    for root in (0..values.len() / 2).rev() {
        sift_down(values, root);
    }
    let mut rest = values;
    while let Some((last, heap)) = rest.split_last_mut() {
        if let Some(largest) = heap.first_mut() {
            core::mem::swap(largest, last);
        }
        sift_down(heap, 0);
        rest = heap;
    }
}

/// Makes a heap of the values from `root` on, where those behind it are heaps already.
fn sift_down(values: &mut [f64], root: usize) {
    let mut parent = root;
    loop {
        let left = 2 * parent + 1;
        let (Some(own), Some(mut largest)) = (values.get(parent).copied(), values.get(left).copied()) else { return };
        let mut child = left;
        if let Some(right) = values.get(left + 1)
            && right.total_cmp(&largest).is_gt()
        {
            (child, largest) = (left + 1, *right);
        }
        if own.total_cmp(&largest).is_ge() {
            return;
        }
        for (place, value) in [(parent, largest), (child, own)] {
            if let Some(to) = values.get_mut(place) {
                *to = value;
            }
        }
        parent = child;
    }
}

#[cfg(test)]
mod tests {
    use super::{median, sort};
    use rand::{RngExt, SeedableRng};
    use rand_pcg::Pcg64Mcg;

    /// The same bits in the same order as the sort of the core library gives, for every length up to 70, with ties and
    /// both zeros.
    #[test]
    fn sorts_as_the_core_library_does() {
        let mut rng = Pcg64Mcg::seed_from_u64(5);
        // Miri takes a thousand times as long.
        let (longest, times) = if cfg!(miri) { (12, 2) } else { (70, 20) };
        for n in 0..longest {
            for _ in 0..times {
                let mut values = [0.0; 70];
                for value in &mut values[..n] {
                    let drawn: f64 = rng.random();
                    *value = if drawn < 0.1 {
                        -0.0
                    } else {
                        (10.0 * drawn - 5.0).trunc() * if drawn < 0.5 { 0.1 } else { 1.0 }
                    };
                }
                let mut expected = values;
                expected[..n].sort_unstable_by(f64::total_cmp);
                sort(&mut values[..n]);
                assert_eq!(values.map(f64::to_bits), expected.map(f64::to_bits));
            }
        }
    }

    #[test]
    fn the_median_is_the_middle_or_the_mean_of_the_middle_two() {
        assert_eq!(median(&mut []), 0.0);
        assert_eq!(median(&mut [3.0]), 3.0);
        assert_eq!(median(&mut [3.0, 1.0]), 2.0);
        assert_eq!(median(&mut [9.0, 1.0, 2.0]), 2.0);
        assert_eq!(median(&mut [9.0, 1.0, 2.0, 4.0]), 3.0);
    }
}
