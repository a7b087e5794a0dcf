//! What is estimated at one moment, with what the declared constants have done to it: two moments share their errors, and a
//! difference has only what the errors do otherwise to the one than to the other.

/// Values of all columns at one moment.
#[derive(Clone, Debug, Default)]
pub(crate) struct Snapshot {
    /// Value and random part of the corrected standard error, by column.
    values: Vec<[f64; 2]>,
    /// Column by column, what one declared standard uncertainty of each constant does to the value. As many constants for each.
    declared: Vec<f64>,
}

impl Snapshot {
    /// Takes other values in place of its own, `declared` as they are written by the closure.
    pub(crate) fn take(&mut self, values: impl Iterator<Item = [f64; 2]>, declare: impl FnOnce(&mut Vec<f64>)) {
        self.values.clear();
        self.values.extend(values);
        self.declared.clear();
        declare(&mut self.declared);
    }

    /// Whether nothing was estimated yet.
    pub(crate) fn is_empty(&self) -> bool {
        self.values.is_empty()
    }

    fn declared(&self, column: usize) -> &[f64] {
        let width = self.declared.len() / self.values.len().max(1);
        self.declared.get(column * width..(column + 1) * width).unwrap_or_default()
    }

    /// The value of a column; none where there is no such column.
    pub(crate) fn value(&self, column: usize) -> Option<f64> {
        self.values.get(column).map(|[value, _]| *value)
    }

    /// The standard error of a column, with the declared part.
    pub(crate) fn std(&self, column: usize) -> Option<f64> {
        let [_, random] = self.values.get(column)?;
        Some(self.declared(column).iter().fold(*random, |sum, part| sum.hypot(*part)))
    }

    /// One sigma of the difference of a column at two moments: the random parts of both, and of the declared part the difference,
    ///
    /// ```text
    /// s1^2 + s2^2 + (T2 - T1) P (T2 - T1)^T
    /// ```
    pub(crate) fn difference_std(&self, other: &Self, column: usize) -> Option<f64> {
        let random = self.random_std(other, column)?;
        let declared = self.declared(column).iter().zip(other.declared(column)).map(|(before, after)| after - before);
        Some(declared.fold(random, f64::hypot))
    }

    /// The random part of that: what noise and turbulence leave open of the difference.
    pub(crate) fn random_std(&self, other: &Self, column: usize) -> Option<f64> {
        let ([_, before], [_, after]) = (self.values.get(column)?, other.values.get(column)?);
        Some(before.hypot(*after))
    }
}

#[cfg(test)]
mod tests {
    use super::Snapshot;

    fn snapshot(values: &[[f64; 2]], declared: &[f64]) -> Snapshot {
        let mut snapshot = Snapshot::default();
        snapshot.take(values.iter().copied(), |own| own.extend(declared));
        snapshot
    }

    #[test]
    fn what_both_moments_share_is_in_their_values_and_not_in_the_difference() {
        // The second column: 12 % of the value by one constant, the same 0.4 by another one.
        let before = snapshot(&[[2.0, 0.3], [1.0, 0.05]], &[0.0, 0.0, 0.12, 0.4]);
        let after = snapshot(&[[2.0, 0.4], [0.5, 0.05]], &[0.0, 0.0, 0.06, 0.4]);
        let close = |found: Option<f64>, expected: f64| assert!((found.unwrap() - expected).abs() < 1e-15, "{found:?}");
        close(before.std(0), 0.3);
        close(before.std(1), (0.05_f64.powi(2) + 0.12_f64.powi(2) + 0.16).sqrt());
        close(before.difference_std(&after, 0), 0.5);
        close(before.difference_std(&after, 1), (2.0 * 0.05_f64.powi(2) + 0.06_f64.powi(2)).sqrt());
        assert_eq!((before.value(1), before.value(2), before.std(2)), (Some(1.0), None, None));
        assert!(Snapshot::default().is_empty() && Snapshot::default().difference_std(&before, 0).is_none());
    }

    /// Without declared errors there is nothing but the random part.
    #[test]
    fn nothing_declared_is_nothing_shared() {
        let before = snapshot(&[[2.0, 0.3]], &[]);
        assert_eq!((before.std(0), before.difference_std(&before, 0)), (Some(0.3), Some(0.3_f64.hypot(0.3))));
    }
}
