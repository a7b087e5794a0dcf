//! Numbers that stand for "no value": loggers and databases write -9999, or the end of the range of an integer, where an
//! instrument gave nothing.

use crate::statistics::median;

/// Numbers that programs write for a missing value (NASA and NOAA tables, LAS files, netCDF's fill value, the ends of the integers of
/// 16 and 32 bits).
const MARKERS: [f64; 18] = [
    -999.0,
    -999.25,
    -9999.0,
    -99_999.0,
    -999_999.0,
    999.0,
    9999.0,
    99_999.0,
    999_999.0,
    -32_768.0,
    32_767.0,
    65_535.0,
    -2_147_483_648.0,
    2_147_483_647.0,
    4_294_967_295.0,
    9.969_209_968_386_869e36,
    1e20,
    -1e20,
];
/// A marker lies farther from the other values than so many times what these span.
const APART: f64 = 10.0;
/// Fewer other values show no range.
const FEWEST_OTHERS: usize = 20;

/// Takes the markers out of the values of a channel (NaN in their place), and gives the number that was one and how often; `None` if
/// there is none. `si` makes the value of the channel of a number in the file. A number is a marker only where no other value is
/// anywhere near it.
pub(super) fn take(values: &mut [f64], si: impl Fn(f64) -> f64) -> Option<(f64, usize)> {
    MARKERS.into_iter().find_map(|marker| {
        let marked = si(marker);
        let count = values.iter().filter(|value| **value == marked).count();
        if count == 0 || !is_apart(values, marked) {
            return None;
        }
        values.iter_mut().filter(|value| **value == marked).for_each(|value| *value = f64::NAN);
        Some((marker, count))
    })
}

/// Whether a value lies far from all others. One that is a few times as large as what the others reach may be one of them.
fn is_apart(values: &[f64], marked: f64) -> bool {
    let mut others: Vec<f64> = values.iter().copied().filter(|value| value.is_finite() && *value != marked).collect();
    if others.len() < FEWEST_OTHERS {
        return false;
    }
    let (low, high) = others.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(*v), h.max(*v)));
    let distance = if marked < low { low - marked } else { marked - high };
    let span = high - low;
    let size = median(&mut others).map_or(0.0, f64::abs);
    distance > APART * span && (distance > APART * size || marked < 0.0 && low > 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_marker_far_from_all_else_is_taken_and_a_value_that_could_be_one_stays() {
        let motion = |k: usize| 4.0 + (0.1 * k as f64).sin();
        let with = |marker: f64, scale: f64| -> Vec<f64> {
            (0..200).map(|k| if k % 40 == 7 { scale * marker } else { scale * motion(k) }).collect()
        };
        for (marker, scale) in [(-9999.0, 1.0), (-9999.0, 0.0175), (32_767.0, 1.0), (999.0, 0.0175)] {
            let mut values = with(marker, scale);
            assert_eq!(take(&mut values, |raw| scale * raw), Some((marker, 5)), "{marker}");
            assert_eq!(values.iter().filter(|v| v.is_nan()).count(), 5);
        }
        // Altitudes that pass 999, one that is -999 once among others as low, and a number that no program means.
        let mut climb: Vec<f64> = (0..200).map(|k| 900.0 + f64::from(k)).collect();
        let mut valley: Vec<f64> = (0..200).map(|k| f64::from(-k) * 20.0).collect();
        valley[50] = -999.0;
        for values in [&mut climb, &mut valley, &mut with(-1234.0, 1.0)] {
            let before = values.clone();
            assert_eq!(take(values, |raw| raw), None);
            assert_eq!(*values, before);
        }
        assert_eq!(take(&mut [1.0, 2.0, -9999.0], |raw| raw), None, "three values show no range");
    }
}
