//! Columns of bounded size. If there are more samples than a picture can show, the least and greatest values of groups
//! are kept.

use super::finished::Columns;

/// Groups that are kept at most. That is more than a screen is wide, so zooming still shows more.
const MOST_GROUPS: usize = 16_384;

/// Which values of a group a column keeps.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kept {
    /// The least and the greatest value, one after the other: a curve.
    Line,
    /// The least value: the lower edge of a band.
    LowerEdge,
    /// The greatest value: the upper edge of a band.
    UpperEdge,
}

/// One sample, in the order of [`Columns`].
#[derive(Clone, Debug)]
pub(super) struct Row(Vec<f64>);

impl Row {
    /// A row from value and standard error of each parameter, from measured value, prediction and residual of each
    /// output, and from the inputs. A missing value is NaN.
    pub(super) fn new(
        parameters: impl Iterator<Item = [f64; 2]>,
        outputs: impl Iterator<Item = [f64; 3]>,
        inputs: impl Iterator<Item = f64>,
    ) -> Self {
        let bands = parameters.flat_map(|[value, sigma]| [value, value - 2.0 * sigma, value + 2.0 * sigma]);
        Self(bands.chain(outputs.flatten()).chain(inputs).collect())
    }
}

/// Collects rows in memory that does not grow with their number.
#[derive(Clone, Debug)]
pub(super) struct Thinned {
    kinds: Vec<Kept>,
    /// Number of samples per group.
    group: usize,
    time_s: Vec<f64>,
    low: Vec<Vec<f32>>,
    high: Vec<Vec<f32>>,
    /// Number of samples in the last group so far.
    filled: usize,
}

impl Thinned {
    /// Columns for a model with so many parameters, outputs and inputs.
    pub(super) fn new(parameters: usize, outputs: usize, inputs: usize) -> Self {
        let mut kinds = [Kept::Line, Kept::LowerEdge, Kept::UpperEdge].repeat(parameters);
        kinds.extend(std::iter::repeat_n(Kept::Line, 3 * outputs + inputs));
        let columns = vec![Vec::new(); kinds.len()];
        Self { kinds, group: 1, time_s: Vec::new(), low: columns.clone(), high: columns, filled: 0 }
    }

    /// Appends one sample. The times have to increase.
    pub(super) fn push(&mut self, time_s: f64, Row(row): &Row) {
        if self.filled == self.group || self.time_s.is_empty() {
            if self.time_s.len() == MOST_GROUPS {
                self.halve();
            }
            self.time_s.push(time_s);
            self.low.iter_mut().chain(&mut self.high).for_each(|column| column.push(f32::NAN));
            self.filled = 0;
        }
        self.filled += 1;
        for ((low, high), value) in self.low.iter_mut().zip(&mut self.high).zip(row) {
            // `min` and `max` of a number and NaN are the number, so NaN stays only if the whole group is NaN.
            if let (Some(low), Some(high)) = (low.last_mut(), high.last_mut()) {
                *low = low.min(*value as f32);
                *high = high.max(*value as f32);
            }
        }
    }

    /// Joins the groups in pairs, so that half as many are left.
    fn halve(&mut self) {
        let firsts = self.time_s.chunks(2).filter_map(|pair| pair.first().copied()).collect();
        self.time_s = firsts;
        for column in &mut self.low {
            *column = column.chunks(2).map(|pair| pair.iter().copied().fold(f32::NAN, f32::min)).collect();
        }
        for column in &mut self.high {
            *column = column.chunks(2).map(|pair| pair.iter().copied().fold(f32::NAN, f32::max)).collect();
        }
        self.group *= 2;
    }

    /// The columns. Single samples stay as they are; a group becomes two rows, at a quarter and three quarters of its
    /// time.
    pub(super) fn finish(self) -> Columns {
        let samples_per_group = self.group;
        if samples_per_group == 1 {
            return Columns { time_s: self.time_s, columns: self.low, samples_per_group };
        }
        let spans = self.time_s.windows(2).map(|pair| pair[1] - pair[0]);
        let last = spans.clone().next_back().unwrap_or(0.0) * self.filled as f64 / self.group as f64;
        let both = |(time, span): (&f64, f64)| [time + 0.25 * span, time + 0.75 * span];
        let time_s = self.time_s.iter().zip(spans.chain([last])).flat_map(both).collect();
        let columns = self.kinds.iter().zip(self.low.iter().zip(&self.high)).map(|(kind, (low, high))| {
            let rows = low.iter().zip(high).flat_map(|(low, high)| match kind {
                Kept::Line => [*low, *high],
                Kept::LowerEdge => [*low, *low],
                Kept::UpperEdge => [*high, *high],
            });
            rows.collect()
        });
        Columns { time_s, columns: columns.collect(), samples_per_group }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn few_samples_stay_as_they_are() {
        let mut thinned = Thinned::new(0, 0, 2);
        for k in 0..100 {
            thinned.push(f64::from(k), &Row(vec![f64::from(k), f64::NAN]));
        }
        let columns = thinned.finish();
        assert_eq!(columns.time_s.len(), 100);
        assert_eq!(columns.columns[0][17], 17.0);
        assert!(columns.columns[1].iter().all(|value| value.is_nan()));
    }

    #[test]
    fn a_single_peak_among_a_million_samples_survives() {
        let mut thinned = Thinned::new(1, 0, 1);
        for k in 0..1_000_000_u32 {
            let peak = if k == 654_321 { 7.5 } else { 0.0 };
            thinned.push(f64::from(k) * 0.01, &Row(vec![1.0, 0.5 - peak, 1.5 + peak, -peak]));
        }
        let columns = thinned.finish();
        let rows = columns.time_s.len();
        assert!(rows <= 2 * MOST_GROUPS && rows > MOST_GROUPS / 2, "{rows}");
        assert!(columns.time_s.is_sorted_by(|a, b| a < b));
        assert!(*columns.time_s.last().unwrap() <= 10_000.0);
        for (column, peak) in columns.columns.iter().zip([1.0, -7.0, 9.0, -7.5]) {
            assert_eq!(column.len(), rows);
            let place = column.iter().position(|value| *value == peak).unwrap();
            let time_s = columns.time_s[if column[0] == peak { 0 } else { place }];
            assert!(column[0] == peak || (time_s - 6543.21).abs() < 1.0, "{peak} at {time_s}");
        }
    }
}
