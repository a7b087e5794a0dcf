//! The Sobol sequence, with the direction numbers of S. Joe and F. Y. Kuo (*SIAM Journal on Scientific Computing* 30, 2008,
//! file `new-joe-kuo-6.21201`).

/// Most dimensions that direction numbers are here for.
pub(super) const DIMENSIONS: usize = 21;

const BITS: u32 = 32;

/// Primitive polynomials and first direction numbers of the dimensions from the second on: coefficients without the first and
/// the last one, and m_1, m_2, ...
const JOE_KUO: [(u32, &[u32]); DIMENSIONS - 1] = [
    (0, &[1]),
    (1, &[1, 3]),
    (1, &[1, 3, 1]),
    (2, &[1, 1, 1]),
    (1, &[1, 1, 3, 3]),
    (4, &[1, 3, 5, 13]),
    (2, &[1, 1, 5, 5, 17]),
    (4, &[1, 1, 5, 5, 5]),
    (7, &[1, 1, 7, 11, 19]),
    (11, &[1, 1, 5, 1, 1]),
    (13, &[1, 1, 1, 3, 11]),
    (14, &[1, 3, 5, 5, 31]),
    (1, &[1, 3, 3, 9, 7, 49]),
    (13, &[1, 1, 1, 15, 21, 21]),
    (16, &[1, 3, 1, 13, 27, 49]),
    (19, &[1, 1, 1, 15, 7, 5]),
    (22, &[1, 3, 1, 15, 13, 25]),
    (25, &[1, 1, 5, 5, 19, 61]),
    (1, &[1, 3, 7, 11, 23, 15, 103]),
    (4, &[1, 3, 7, 13, 13, 15, 69]),
];

/// The point with this number in one dimension, from 0 on, both counted from zero; 0 to 1, 1 not included.
pub(super) fn point(number: u32, dimension: usize) -> f64 {
    let directions = directions(dimension);
    // The order of Gray codes, in which one direction changes from each point to the next.
    let gray = number ^ (number >> 1);
    let bits = (0..BITS).filter(|bit| gray >> bit & 1 == 1).fold(0, |sum, bit| sum ^ directions[bit as usize]);
    f64::from(bits) / 2.0_f64.powi(BITS as i32)
}

fn directions(dimension: usize) -> [u32; BITS as usize] {
    let mut v = [0_u32; BITS as usize];
    let Some((a, m)) = dimension.checked_sub(1).and_then(|place| JOE_KUO.get(place)) else {
        // The first dimension is the sequence of van der Corput.
        return std::array::from_fn(|bit| 1 << (BITS - 1 - bit as u32));
    };
    let s = m.len();
    for bit in 0..BITS as usize {
        v[bit] = match m.get(bit) {
            Some(m) => m << (BITS - 1 - bit as u32),
            None => {
                let mut next = v[bit - s] ^ (v[bit - s] >> s);
                for k in 1..s {
                    next ^= (a >> (s - 1 - k) & 1) * v[bit - k];
                }
                next
            }
        };
    }
    v
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `scipy.stats.qmc.Sobol(21, scramble=False).random(1024)`, points 777 and 1000.
    #[test]
    fn points_are_those_of_scipy() {
        let expected: [(u32, [f64; DIMENSIONS]); 2] = [
            (
                777,
                [
                    0.6923828125,
                    0.9365234375,
                    0.1630859375,
                    0.2744140625,
                    0.6357421875,
                    0.3564453125,
                    0.1904296875,
                    0.7626953125,
                    0.3486328125,
                    0.3232421875,
                    0.7451171875,
                    0.6962890625,
                    0.3837890625,
                    0.4736328125,
                    0.5693359375,
                    0.5146484375,
                    0.4033203125,
                    0.8642578125,
                    0.3701171875,
                    0.7529296875,
                    0.2373046875,
                ],
            ),
            (
                1000,
                [
                    0.2197265625,
                    0.0966796875,
                    0.5185546875,
                    0.6767578125,
                    0.2802734375,
                    0.9072265625,
                    0.0458984375,
                    0.8994140625,
                    0.5009765625,
                    0.0693359375,
                    0.0849609375,
                    0.2548828125,
                    0.1611328125,
                    0.3837890625,
                    0.1435546875,
                    0.3701171875,
                    0.7197265625,
                    0.3447265625,
                    0.9912109375,
                    0.7255859375,
                    0.5224609375,
                ],
            ),
        ];
        for (number, point_of_scipy) in expected {
            let ours: [f64; DIMENSIONS] = std::array::from_fn(|dimension| point(number, dimension));
            assert_eq!(ours, point_of_scipy);
        }
    }

    #[test]
    fn each_dimension_fills_every_interval_once() {
        for dimension in 0..DIMENSIONS {
            let mut hit = [0; 256];
            (0..256).for_each(|number| hit[(256.0 * point(number, dimension)) as usize] += 1);
            assert!(hit.iter().all(|count| *count == 1), "dimension {dimension}");
        }
    }
}
