//! Access by index, limits and lists that cannot panic. Indices are right by construction, and the compiler cannot know
//! that of one that was kept in a field: an ordinary index would leave a call of the panic handler behind.
//! `scripts/check-no-panic.py` finds them.

/// The value at a place; zero beyond the room.
#[inline(always)]
pub(crate) fn at(values: &[f64], place: usize) -> f64 {
    values.get(place).copied().unwrap_or(0.0)
}

/// A unit vector; zero if the place is beyond the room.
#[inline(always)]
pub(crate) fn unit<const P: usize>(place: usize) -> [f64; P] {
    let mut unit = [0.0; P];
    if let Some(value) = unit.get_mut(place) {
        *value = 1.0;
    }
    unit
}

/// `f64::clamp` without its panic: a limit that is not a number limits nothing, and the upper one holds where the two
/// are in the wrong order.
#[inline(always)]
pub(crate) fn limited(value: f64, low: f64, high: f64) -> f64 {
    let mut value = value;
    if value < low {
        value = low;
    }
    if value > high {
        value = high;
    }
    value
}

/// Some of `P` columns, in order.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Places<const P: usize> {
    columns: [usize; P],
    count: usize,
}

impl<const P: usize> Places<P> {
    pub(crate) const NONE: Self = Self { columns: [0; P], count: 0 };

    /// Adds a column. Nothing happens with one beyond the room, or when all places are taken.
    pub(crate) fn push(&mut self, column: usize) {
        if let Some(place) = self.columns.get_mut(self.count).filter(|_| column < P) {
            *place = column;
            self.count += 1;
        }
    }

    /// Number of columns in the list, at most `P`.
    #[inline(always)]
    pub(crate) fn len(&self) -> usize {
        self.count.min(P)
    }

    /// The columns themselves.
    #[inline(always)]
    pub(crate) fn as_slice(&self) -> &[usize] {
        &self.columns[..self.len()]
    }

    /// The column at a place below [`Self::len`]. Every column of the list is below `P`: the least only tells the
    /// compiler.
    #[inline(always)]
    pub(crate) fn column(&self, place: usize) -> usize {
        self.columns.get(place).map_or(0, |column| (*column).min(P.saturating_sub(1)))
    }
}

#[cfg(test)]
mod tests {
    extern crate std;

    use super::{Places, at, limited, unit};
    use std::vec::Vec;

    #[test]
    fn limits_as_clamp_does_and_never_panics() {
        for value in [-3.0, -0.0, 0.0, 0.7, 5.0, f64::INFINITY, f64::NEG_INFINITY] {
            for (low, high) in [(-1.0, 1.0), (0.0, 0.0), (-0.0, 0.0), (f64::NEG_INFINITY, 2.0)] {
                assert_eq!(limited(value, low, high).to_bits(), value.clamp(low, high).to_bits());
            }
        }
        assert!(limited(f64::NAN, 0.0, 1.0).is_nan());
        assert_eq!(limited(3.0, f64::NAN, f64::NAN), 3.0);
        assert_eq!(limited(3.0, 2.0, 1.0), 1.0);
    }

    /// Every combination of values that are special to a comparison, limits in the wrong order too.
    #[test]
    fn every_special_value_is_limited_as_clamp_limits_it() {
        let tiny = f64::from_bits(1);
        let values =
            [f64::NEG_INFINITY, f64::MIN, -1.0, -tiny, -0.0, 0.0, tiny, 1.0, f64::MAX, f64::INFINITY, f64::NAN];
        for value in values {
            for low in values {
                for high in values {
                    let found = limited(value, low, high);
                    if low <= high {
                        let expected = value.clamp(low, high);
                        assert!(found.to_bits() == expected.to_bits() || (found.is_nan() && expected.is_nan()));
                    } else if low > high && !value.is_nan() {
                        assert_eq!(found, if value < low || value > high { high } else { value });
                    }
                }
            }
        }
    }

    /// Every list of up to five columns in every room of up to four, against a plain list.
    fn lists_agree<const P: usize>() {
        const LENGTH: u32 = if cfg!(miri) { 3 } else { 5 };
        const COLUMNS: usize = 6;
        for list in 0..COLUMNS.pow(LENGTH) {
            let (mut places, mut plain) = (Places::<P>::NONE, Vec::new());
            for k in 0..LENGTH {
                let column = list / COLUMNS.pow(k) % COLUMNS;
                places.push(column);
                if column < P && plain.len() < P {
                    plain.push(column);
                }
                assert_eq!((places.len(), places.as_slice()), (plain.len(), plain.as_slice()));
                for (place, column) in plain.iter().enumerate() {
                    assert_eq!(places.column(place), *column);
                }
                // Beyond the list: whatever it is, an index into a room of `P`.
                for place in plain.len()..P + 2 {
                    assert!(P == 0 || places.column(place) < P);
                }
            }
        }
    }

    #[test]
    fn every_short_list_in_every_small_room_agrees_with_a_plain_one() {
        lists_agree::<0>();
        lists_agree::<1>();
        lists_agree::<2>();
        lists_agree::<3>();
        lists_agree::<4>();
        let values = [1.0, 2.0, 3.0];
        for length in 0..=3 {
            for place in (0..5).chain([usize::MAX]) {
                let expected = if place < length { values[place] } else { 0.0 };
                assert_eq!(at(&values[..length], place), expected);
                assert_eq!(unit::<3>(place), core::array::from_fn(|i| if i == place { 1.0 } else { 0.0 }));
            }
        }
    }

    #[test]
    fn what_lies_beyond_the_room_is_nothing() {
        assert_eq!((at(&[1.0, 2.0], 1), at(&[1.0, 2.0], 2)), (2.0, 0.0));
        assert_eq!((unit::<2>(1), unit::<2>(2)), ([0.0, 1.0], [0.0; 2]));
        let mut places = Places::<2>::NONE;
        for column in [1, 7, 0, 1] {
            places.push(column);
        }
        assert_eq!((places.as_slice(), places.column(0), places.column(1)), (&[1, 0][..], 1, 0));
    }
}
