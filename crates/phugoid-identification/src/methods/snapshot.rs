//! What is estimated at one moment, with what the declared constants have done to it: two moments share their errors, and a
//! difference has only what the errors do otherwise to the one than to the other.

use crate::core::systematic::{ROOM_FOR_CONSTANTS, UncertainQuantity};

/// Room for what declared errors do to a column: of methods that follow constants one number each; of others, by quantity, what goes with
/// the value and what does not.
const EFFECTS: usize = 2 * UncertainQuantity::ALL.len();
const _: () = assert!(ROOM_FOR_CONSTANTS <= EFFECTS);

/// A column of an estimate at one moment.
#[derive(Clone, Debug)]
pub(crate) struct Column {
    value: f64,
    /// The corrected standard error without what is declared.
    random_std: f64,
    /// What one declared standard uncertainty of each constant does to the value.
    effects: [f64; EFFECTS],
    /// What independent errors of the tables of the base of one standard uncertainty each do to it; empty until that was worked out.
    by_base: Vec<f64>,
}

impl Column {
    /// A column with these effects; those that there are not are zero.
    pub(crate) fn new(value: f64, random_std: f64, effects: &[f64]) -> Self {
        let mut column = Self { value, random_std, effects: [0.0; EFFECTS], by_base: Vec::new() };
        let count = effects.len().min(EFFECTS);
        column.effects[..count].copy_from_slice(&effects[..count]);
        column
    }
}

/// All columns at one moment.
#[derive(Clone, Debug, Default)]
pub(crate) struct Snapshot(Vec<Column>);

impl Snapshot {
    /// The columns of a moment.
    pub(crate) fn of(columns: impl Iterator<Item = Column>) -> Self {
        Self(columns.collect())
    }

    /// Takes other columns in place of its own.
    pub(crate) fn renew(&mut self, columns: impl Iterator<Item = Column>) {
        self.0.clear();
        self.0.extend(columns);
    }

    /// Says what independent errors of the tables of the base, of one standard uncertainty each, do to a column.
    pub(crate) fn set_by_base(&mut self, column: usize, effects: Vec<f64>) {
        if let Some(column) = self.0.get_mut(column) {
            column.by_base = effects;
        }
    }

    /// Whether nothing was estimated yet.
    pub(crate) fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// The value of a column; none where there is no such column.
    pub(crate) fn value(&self, column: usize) -> Option<f64> {
        self.0.get(column).map(|column| column.value)
    }

    /// The standard error of a column, with the declared part.
    pub(crate) fn std(&self, column: usize) -> Option<f64> {
        let Column { random_std, effects, by_base, .. } = self.0.get(column)?;
        Some(effects.iter().chain(by_base).fold(*random_std, |sum, effect| sum.hypot(*effect)))
    }

    /// One sigma of the difference of a column at two moments: the random parts of both, and of the declared part the difference,
    ///
    /// ```text
    /// s1^2 + s2^2 + (T2 - T1) P (T2 - T1)^T
    /// ```
    pub(crate) fn difference_std(&self, other: &Self, column: usize) -> Option<f64> {
        let (before, after) = (self.0.get(column)?, other.0.get(column)?);
        let differences = before.effects.iter().zip(&after.effects).map(|(before, after)| after - before);
        // Where one of the two has none, it is of a change that has no counterpart in the other runs.
        let by_base = before.by_base.iter().zip(&after.by_base).map(|(before, after)| after - before);
        Some(differences.chain(by_base).fold(self.random_std(other, column)?, f64::hypot))
    }

    /// The random part of that: what noise and turbulence leave open of the difference.
    pub(crate) fn random_std(&self, other: &Self, column: usize) -> Option<f64> {
        Some(self.0.get(column)?.random_std.hypot(other.0.get(column)?.random_std))
    }
}

#[cfg(test)]
mod tests {
    use super::{Column, Snapshot};

    fn snapshot<const K: usize>(columns: &[([f64; 2], [f64; K])]) -> Snapshot {
        Snapshot::of(columns.iter().map(|([value, std], effects)| Column::new(*value, *std, effects)))
    }

    #[test]
    fn what_both_moments_share_is_in_their_values_and_not_in_the_difference() {
        // The second column: 12 % of the value by one constant, the same 0.4 by another one.
        let before = snapshot(&[([2.0, 0.3], [0.0, 0.0]), ([1.0, 0.05], [0.12, 0.4])]);
        let after = snapshot(&[([2.0, 0.4], [0.0, 0.0]), ([0.5, 0.05], [0.06, 0.4])]);
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
        let before = snapshot(&[([2.0, 0.3], [])]);
        assert_eq!((before.std(0), before.difference_std(&before, 0)), (Some(0.3), Some(0.3_f64.hypot(0.3))));
    }
}
