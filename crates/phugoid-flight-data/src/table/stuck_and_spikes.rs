//! Reports stuck channels and spikes. Values are never changed.

use crate::channels;
use crate::record::{Channel, Record};
use crate::statistics::{Rank, constant, quantile};
use crate::wording::{Short, plural};

/// Adds notes on constant channels, on stretches in which a channel is frozen, and on spikes.
pub(crate) fn check(record: &mut Record) {
    let mut stretches: Vec<((usize, usize), Vec<&str>)> = Vec::new();
    for channel in &record.channels {
        let spec = channels::by_name(&channel.name);
        if let Some(value) = constant(&channel.values) {
            if spec.is_some_and(|spec| spec.moves) && record.time.len() > 2 {
                record.quality.note(
                    &channel.name,
                    format!(
                        "is {} {} throughout: a sensor that is stuck or an input that was not moved",
                        Short(value),
                        channel.quantity.si_unit()
                    ),
                );
            }
            continue;
        }
        if spec.is_none() {
            continue;
        }
        for stretch in frozen(channel, &record.time, record.quality.sample_time_s) {
            match stretches.iter_mut().find(|(same, _)| *same == stretch) {
                Some((_, names)) => names.push(&channel.name),
                None => stretches.push((stretch, vec![&channel.name])),
            }
        }
        let spikes = spikes(&channel.values);
        if let Some(&first) = spikes.first() {
            let time = record.time.get(first).copied().unwrap_or_default();
            record.quality.note(
                &channel.name,
                format!(
                    "{} far outside the neighbouring values, the first at {} s; kept in the record; estimation judges those of measured motion, and takes those of a surface out where it can tell",
                    plural(spikes.len(), "single value"),
                    Short(time)
                ),
            );
            if let Some(entry) = record.quality.channels.iter_mut().find(|entry| entry.name == channel.name) {
                entry.spikes = spikes.len();
            }
        }
    }
    for ((start, end), names) in stretches {
        let (Some(from), Some(to)) = (record.time.get(start), record.time.get(end)) else { continue };
        record.quality.note(
            format!("{} s to {} s", Short(*from), Short(*to)),
            format!("{} did not move in these {} rows, but elsewhere; kept", names.join(", "), end - start + 1),
        );
    }
}

/// The first and last row of each stretch (at most three) in which a channel that otherwise changes from row to row
/// keeps its value for at least one second and ten rows.
fn frozen(channel: &Channel, time: &[f64], sample_time: f64) -> Vec<(usize, usize)> {
    let values = &channel.values;
    let pairs = values.windows(2).filter(|pair| !pair[0].is_nan() && !pair[1].is_nan());
    let (all, equal) =
        pairs.fold((0_usize, 0_usize), |(all, equal), pair| (all + 1, equal + usize::from(pair[0] == pair[1])));
    let mut runs = Vec::new();
    let mut start = 0;
    for row in 1..=values.len() {
        if row < values.len() && values[row] == values[start] {
            continue;
        }
        let last = row - 1;
        let long =
            time.get(last).zip(time.get(start)).is_some_and(|(end, begin)| end - begin >= 1.0 - 0.5 * sample_time);
        if last - start + 1 >= 10 && long {
            runs.push((start, last));
        }
        start = row;
    }
    let in_runs: usize = runs.iter().map(|(start, end)| end - start).sum();
    // A quantised or slowly sampled channel repeats values everywhere; it is not frozen.
    let moves_elsewhere = 10 * equal.saturating_sub(in_runs) < all.saturating_sub(in_runs);
    if !moves_elsewhere {
        return Vec::new();
    }
    runs.truncate(3);
    runs
}

/// The rows with a spike: a value above or below both neighbours, and further from both than six times the upper
/// quartile of all steps of the channel (ten standard deviations of white noise) and than 5 % of its range.
fn spikes(values: &[f64]) -> Vec<usize> {
    let present = || values.iter().copied().filter(|value| !value.is_nan());
    let count = present().count();
    if count < 20 {
        return Vec::new();
    }
    let steps =
        || present().zip(present().skip(1)).map(|(before, after)| (after - before).abs()).filter(|step| *step > 0.0);
    let largest = points(values).map(|(_, height)| height).fold(0.0, f64::max);
    // Most channels have none. How many steps are a sixth of the highest point or more tells it without any order of them:
    // if so many are, the upper quartile is one of them, and the bound is not below the highest point.
    let (all, large) =
        steps().fold((0_usize, 0), |(all, large), step| (all + 1, large + usize::from(6.0 * step >= largest)));
    let quartile = (0.75 * all.saturating_sub(1) as f64).round() as usize;
    if large >= all.saturating_sub(quartile) {
        return Vec::new();
    }
    let mut sorted: Vec<f64> = steps().collect();
    let upper_quarter = quantile(&mut sorted, 0.75, Rank::Nearest).unwrap_or(f64::NAN);
    if largest <= 6.0 * upper_quarter {
        return Vec::new();
    }
    sorted.clear();
    sorted.extend(present());
    let mut range = |fraction| quantile(&mut sorted, fraction, Rank::Nearest).unwrap_or(f64::NAN);
    let range = range(0.95) - range(0.05);
    let bound = (6.0 * upper_quarter).max(0.05 * range);
    points(values).filter(|(_, height)| *height > bound).map(|(row, _)| row).collect()
}

/// The rows whose value is above or below both neighbours, and by how much at the least. Missing values are passed over.
fn points(values: &[f64]) -> impl Iterator<Item = (usize, f64)> + '_ {
    let mut present = values.iter().copied().enumerate().filter(|(_, value)| !value.is_nan());
    let first = present.next();
    let mut last = first.zip(present.next());
    present.filter_map(move |(row, after)| {
        let ((_, before), (at, value)) = last?;
        last = Some(((at, value), (row, after)));
        let (from, to) = (value - before, value - after);
        (from * to > 0.0).then(|| (at, from.abs().min(to.abs())))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lone_outliers_are_spikes_and_steps_are_not() {
        let mut values: Vec<f64> = (0..200).map(|i| (0.05 * f64::from(i)).sin() + 1e-3 * f64::from(i % 7)).collect();
        values.iter_mut().skip(100).for_each(|value| *value += 3.0);
        assert_eq!(spikes(&values), [] as [usize; 0], "a step is no spike");
        values[50] += 1.0;
        values[150] -= 1.0;
        assert_eq!(spikes(&values), [50, 150]);
        values[50] = f64::NAN;
        assert_eq!(spikes(&values), [150]);
    }
}
