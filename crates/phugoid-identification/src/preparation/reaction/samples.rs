//! Stretches of equally spaced samples of a record that has gaps.

/// Longest stretch, s: an offset and a drift of the moment hold over it whatever the model lacks.
const LONGEST_S: f64 = 16.0;
/// Shortest stretch, s: shorter ones go into their own offset and drift.
const SHORTEST_S: f64 = 2.0;
/// A step of so many median ones is a gap.
const GAP: f64 = 3.5;
/// So many samples are enough: a long flight is judged by those of its stretches in which the surface moves most.
const MOST_SAMPLES: usize = 24_000;

/// Times (s) of equally spaced samples within the parts of a record without gaps, in order. `moves` is what has to move,
/// by sample of the record.
pub(super) fn stretches(time_s: &[f64], step_s: f64, moves: &[f64]) -> Vec<Vec<f64>> {
    let mut found: Vec<(f64, Vec<f64>)> = Vec::new();
    let mut begin = 0;
    while begin < time_s.len() {
        let mut end = begin + 1;
        while end < time_s.len() && time_s[end] - time_s[end - 1] < GAP * step_s {
            end += 1;
        }
        let (from, length) = (time_s[begin], time_s[end - 1] - time_s[begin]);
        let parts = (length / LONGEST_S).ceil().max(1.0);
        for part in 0..parts as usize {
            let part = from + length * part as f64 / parts;
            let samples = (length / parts / step_s * (1.0 + 1e-9)).floor() as usize;
            if samples as f64 * step_s >= SHORTEST_S {
                let moved = motion(time_s, moves, part, part + length / parts);
                found.push((moved, (0..=samples).map(|k| part + k as f64 * step_s).collect()));
            }
        }
        begin = end;
    }
    let mut by_motion: Vec<usize> = (0..found.len()).collect();
    by_motion.sort_by(|a, b| found[*b].0.total_cmp(&found[*a].0));
    let mut samples = 0;
    by_motion.retain(|i| {
        let is_first = samples == 0;
        samples += found[*i].1.len();
        is_first || samples <= MOST_SAMPLES
    });
    by_motion.sort_unstable();
    by_motion.into_iter().map(|i| std::mem::take(&mut found[i].1)).collect()
}

/// The sum of the squares of the steps from one time (s) to another.
fn motion(time_s: &[f64], values: &[f64], from_s: f64, to_s: f64) -> f64 {
    let (from, to) = (time_s.partition_point(|t| *t < from_s), time_s.partition_point(|t| *t <= to_s));
    values[from..to].windows(2).map(|pair| (pair[1] - pair[0]).powi(2)).sum()
}

/// A channel that moves by less than this part of its largest value stands still: it is the step of single precision, in which recorders
/// keep a position (1e-9 rad at half a degree). What is left of a constant is rounding, which no aircraft reacts to.
const STILL: f64 = f32::EPSILON as f64;

/// Whether values of a channel move, of which `largest` is the largest magnitude.
pub(super) fn moves(values: &[f64], largest: f64) -> bool {
    let (least, most) =
        values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(least, most), v| (v.min(least), v.max(most)));
    most - least > STILL * largest
}

/// The largest magnitude of values.
pub(super) fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |most, v| v.abs().max(most))
}

/// The rate of a signal by sample, from its neighbours; zero where there are none.
pub(super) fn rate(time_s: &[f64], values: &[f64]) -> Vec<f64> {
    let last = values.len().saturating_sub(1);
    let at = |k: usize| {
        let (before, after) = (k.saturating_sub(1), (k + 1).min(last));
        let span = time_s[after] - time_s[before];
        if span > 0.0 { (values[after] - values[before]) / span } else { 0.0 }
    };
    (0..values.len()).map(at).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gaps_and_long_parts_are_cut_and_a_long_flight_is_judged_by_where_the_surface_moves() {
        let time: Vec<f64> = (0..2000).map(|k| 0.02 * f64::from(k) + if k < 500 { 0.0 } else { 5.0 }).collect();
        let moves = vec![0.0; 2000];
        let found = stretches(&time, 0.02, &moves);
        assert_eq!(found.iter().map(Vec::len).collect::<Vec<_>>(), [500, 750, 750]);
        assert!(found.iter().all(|one| *one.last().unwrap() <= 45.0));
        assert!(stretches(&time[..50], 0.02, &moves[..50]).is_empty());

        // An hour, and the surface moves after half of it.
        let time: Vec<f64> = (0..180_000).map(|k| 0.02 * f64::from(k)).collect();
        let moves: Vec<f64> =
            time.iter().map(|t| if (1795.0..1800.0).contains(t) { (3.0 * t).sin() } else { 0.0 }).collect();
        let found = stretches(&time, 0.02, &moves);
        assert!(found.iter().map(Vec::len).sum::<usize>() <= MOST_SAMPLES);
        assert!(found.iter().any(|one| (one[0]..*one.last().unwrap()).contains(&1797.0)));
    }

    #[test]
    fn the_rate_of_a_straight_line_is_its_slope() {
        assert_eq!(rate(&[0.0, 0.5, 1.0], &[1.0, 2.0, 3.0]), [2.0; 3]);
        assert_eq!(rate(&[0.0], &[1.0]), [0.0]);
    }
}
