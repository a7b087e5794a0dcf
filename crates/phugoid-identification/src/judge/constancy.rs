//! Whether the terms of a model are the same before and after some time of the flight.
//!
//! A batch method, and a recursive regression at its end, has one value for the whole flight. Where the aircraft changes in between, that value is a mean of two
//! aircraft, and its residuals look much like those of turbulence. So the equations of motion are solved for the time
//! before and after each moment anew, and the two are compared (G. C. Chow, *Tests of Equality Between Sets of Coefficients
//! in Two Linear Regressions*, Econometrica 28, 1960; the time of the change is searched for, as in D. W. K. Andrews, *Tests
//! for Parameter Instability and Structural Change With Unknown Change Point*, Econometrica 61, 1993). The errors are found
//! by leaving out two seconds at a time, which allows for coloured residuals and for what rests on one manoeuvre alone.

use nalgebra::DVector;

use crate::core::estimation::{EstimationStatus, ReasonCode, VerdictReason};
use crate::core::number::significant;
use crate::judge::both_sides::{MATERIAL, is_alike, is_material, moves_on_both_sides};
use crate::judge::equations::{ByBlock, Equations};
use crate::judge::normal::Normal;

/// Blocks that are left out together: residuals further apart than that are hardly related.
const TOGETHER: usize = 2;
/// Fewest groups of blocks on either side.
const FEWEST: usize = 5;
/// Two-sided quantiles of Student's t for one in 100 000, by degrees of freedom: a flight asks some hundred times, with
/// several terms at many moments, of which neighbours have the same answer.
const STUDENT: [(f64, f64); 9] = [
    (4.0, 27.8),
    (5.0, 17.9),
    (6.0, 13.6),
    (8.0, 9.8),
    (10.0, 8.2),
    (15.0, 6.5),
    (20.0, 5.9),
    (30.0, 5.3),
    (60.0, 4.8),
];

/// A term that is not the same before and after.
#[derive(Clone, Debug, PartialEq)]
struct Change {
    column: usize,
    /// When, s on the clock of the record.
    time_s: f64,
    before: f64,
    after: f64,
    /// The difference over the limit of what chance makes of it: more than one.
    strength: f64,
}

/// The reason that a term changes in flight; none if the flight does not show it.
pub(super) fn reason(equations: &Equations) -> Option<VerdictReason> {
    let is_constant = |column: usize| equations.columns[column].term.is_constant();
    let times_s = equations.times_s();
    let mut found: Vec<Change> =
        equations.by_block().iter().flat_map(|equation| changes(equation, &times_s, &is_constant)).collect();
    found.sort_by(|a, b| b.strength.total_cmp(&a.strength));
    let first = found.first()?;
    let name = |change: &Change| equations.columns[change.column].name.clone();
    let said = |change: &Change| {
        let [before, after] = [change.before, change.after].map(|value| significant(value, 3));
        format!("{} {before} before {:.0} s and {after} after", name(change), change.time_s)
    };
    let all: Vec<String> = found.iter().map(said).collect();
    Some(VerdictReason {
        code: ReasonCode::NotConstant,
        status: EstimationStatus::Doubtful,
        concerns: found.iter().map(name).collect(),
        sentence: format!(
            "The aircraft is not the same throughout: by the equations of motion {}. One value for the whole flight is \
             neither. Estimate the parts by themselves (--to {:.0}s, --from {:.0}s), or with SMPE or the EKF, which look for \
             changes.",
            all.join("; "),
            first.time_s,
            first.time_s
        ),
    })
}

/// The values on one side, and their variances.
struct Side {
    value: DVector<f64>,
    variance: DVector<f64>,
    motion: DVector<f64>,
    groups: usize,
}

impl Side {
    /// Of `u` terms.
    fn of(u: usize, groups: &[Normal]) -> Option<Self> {
        let all = Normal::sum(u, groups);
        let value = all.solve()?;
        let n = groups.len() as f64;
        let mut variance = DVector::zeros(u);
        for group in groups {
            let off = all.plus(group, -1.0).solve()? - &value;
            variance += off.component_mul(&off) * ((n - 1.0) / n);
        }
        Some(Self { value, variance, motion: all.motion()?, groups: groups.len() })
    }
}

/// By how many standard errors chance makes two values differ.
fn limit(degrees: usize) -> f64 {
    let wanted = degrees as f64;
    let after = STUDENT.iter().position(|(degrees, _)| *degrees >= wanted);
    match after {
        Some(0) => STUDENT[0].1,
        // Nearly linear in the inverse of the degrees of freedom.
        Some(k) => {
            let ((low, high), (from, to)) = ((STUDENT[k - 1].0, STUDENT[k].0), (STUDENT[k - 1].1, STUDENT[k].1));
            from + (to - from) * (1.0 / low - 1.0 / wanted) / (1.0 / low - 1.0 / high)
        }
        None => STUDENT[STUDENT.len() - 1].1,
    }
}

/// The terms of one equation that change, each where it shows most. A constant changes where it does by more than a part of the
/// motion that the largest term makes: a trim that shifts under a control loop moves the surface, and one value for both sides
/// makes that surface look as if it did nothing.
fn changes(equation: &ByBlock, times_s: &[f64], is_constant: &dyn Fn(usize) -> bool) -> Vec<Change> {
    let groups = Normal::groups(equation, TOGETHER);
    let u = equation.used.len();
    // On both sides as in a manoeuvre.
    let moves = |j: usize, split: usize| moves_on_both_sides(&equation.moving[j], split * TOGETHER);
    let is_constant = |j: usize| is_constant(equation.used[j]);
    let mut strongest: Vec<Option<Change>> = vec![None; u];
    for split in FEWEST..groups.len().saturating_sub(FEWEST - 1) {
        let Some((before, after)) = Side::of(u, &groups[..split]).zip(Side::of(u, &groups[split..])) else { continue };
        let limit = limit(before.groups.min(after.groups) - 1);
        // Motion of the left side that one unit of a term makes on the side where it moves less.
        let unit = |j: usize| before.motion[j].min(after.motion[j]).sqrt();
        let made = |j: usize| before.value[j].abs().max(after.value[j].abs()) * unit(j);
        let largest = (0..u).filter(|j| !is_constant(*j)).map(made).fold(0.0, f64::max);
        let is_flown_alike = |j: usize| is_alike([before.motion[j], after.motion[j]]) && moves(j, split);
        // Where a term that makes much of the motion hardly moves on one side, its value there is too small, and the constant with it.
        let counts = |j: &usize| !is_constant(*j) && made(*j) >= MATERIAL * largest;
        let is_comparable = (0..u).filter(counts).all(is_flown_alike);
        let tells = |j: usize, from: f64, to: f64| {
            if is_constant(j) {
                is_comparable && largest > 0.0 && (to - from).abs() * unit(j) >= MATERIAL * largest
            } else {
                is_material(from, to) && is_flown_alike(j)
            }
        };
        for (j, strongest) in strongest.iter_mut().enumerate() {
            let (from, to) = (before.value[j], after.value[j]);
            let strength = (to - from).abs() / (limit * (before.variance[j] + after.variance[j]).sqrt());
            if tells(j, from, to) && strength > 1.0 && strongest.as_ref().is_none_or(|s| strength > s.strength) {
                *strongest = Some(Change {
                    column: equation.used[j],
                    time_s: times_s[split * TOGETHER],
                    before: from,
                    after: to,
                    strength,
                });
            }
        }
    }
    strongest.into_iter().flatten().collect()
}

#[cfg(test)]
mod tests {
    use nalgebra::DMatrix;

    use super::*;

    /// Forty seconds of `y = value x` with a scatter, `x` moving in every block or only in the first half.
    fn equation(value: impl Fn(usize) -> f64, moves: impl Fn(usize) -> f64) -> ByBlock {
        let mut seed = 1_u64;
        let mut scatter = || {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (seed >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
        };
        let at = 0.8;
        let mut sums = Vec::new();
        for block in 0..40 {
            let mut sum = DMatrix::zeros(2, 2);
            for k in 0..50 {
                let x = moves(block) * (0.3 * f64::from(k)).sin() + 0.01 * scatter();
                let residual = (value(block) - at) * x + 0.1 * scatter();
                let row = DVector::from_vec(vec![x, residual]);
                sum.ger(1.0, &row, &row, 1.0);
            }
            sums.push(sum);
        }
        let moving = vec![(0..40).map(|block| moves(block) > 0.5).collect()];
        ByBlock { used: vec![0], values: vec![at], sums, samples: vec![50.0; 40], moving }
    }

    fn times_s(start_s: f64) -> Vec<f64> {
        (0..40).map(|block| start_s + f64::from(block)).collect()
    }

    #[test]
    fn a_change_is_found_with_its_time_and_both_values() {
        let found =
            changes(&equation(|block| if block < 24 { 1.0 } else { 0.6 }, |_| 1.0), &times_s(100.0), &|_| false);
        let [change] = found.as_slice() else { panic!("{found:?}") };
        assert!((change.time_s - 124.0).abs() <= 2.0, "{change:?}");
        assert!((change.before - 1.0).abs() < 0.02 && (change.after - 0.6).abs() < 0.02, "{change:?}");
    }

    /// The same with a constant, which shifts after 24 s, and with it the place about which `x` moves, as under a control loop.
    fn shifted(shift: f64) -> ByBlock {
        let of_term = equation(|_| 1.0, |_| 1.0);
        let sums = of_term.sums.iter().enumerate().map(|(block, sum)| {
            let (at, constant) = if block < 24 { (0.0, 0.0) } else { (shift, -shift) };
            let samples = of_term.samples[block];
            // Of `x + at` in place of `x`, whose mean over a block is next to zero, and of a left side with the constant beside it.
            let (xx, xr, rr) = (sum[(0, 0)], sum[(0, 1)], sum[(1, 1)]);
            let r = 0.2 * at + constant;
            let row = [xx + samples * at * at, samples * at, xr + samples * at * r];
            let full =
                [[row[0], row[1], row[2]], [row[1], samples, samples * r], [row[2], samples * r, rr + samples * r * r]];
            DMatrix::from_fn(3, 3, |a, b| full[a][b])
        });
        let moving = vec![vec![true; 40], vec![false; 40]];
        ByBlock {
            used: vec![0, 1],
            values: vec![0.8, 0.0],
            sums: sums.collect(),
            moving,
            samples: of_term.samples.clone(),
        }
    }

    #[test]
    fn a_constant_changes_where_it_does_by_a_part_of_the_motion() {
        let of_constant = |column: usize| column == 1;
        let found = changes(&shifted(0.5), &times_s(0.0), &of_constant);
        let constant = found.iter().find(|change| change.column == 1).unwrap_or_else(|| panic!("{found:?}"));
        assert!((constant.time_s - 24.0).abs() <= 2.0, "{constant:?}");
        assert!(constant.before.abs() < 0.05 && (constant.after + 0.5).abs() < 0.05, "{constant:?}");
        assert_eq!(found.len(), 1, "{found:?}");
        // The motion is 0.7 in root mean square.
        assert_eq!(changes(&shifted(0.05), &times_s(0.0), &of_constant), []);
    }

    #[test]
    fn what_is_constant_and_what_hardly_moves_does_not_change() {
        assert_eq!(changes(&equation(|_| 1.0, |_| 1.0), &times_s(0.0), &|_| false), []);
        // Less than what missing terms do.
        assert_eq!(
            changes(&equation(|block| if block < 24 { 1.0 } else { 0.85 }, |_| 1.0), &times_s(0.0), &|_| false),
            []
        );
        // After half of the flight only noise moves the regressor.
        let quiet = equation(|block| if block < 20 { 1.0 } else { 0.2 }, |block| if block < 20 { 1.0 } else { 0.02 });
        assert_eq!(changes(&quiet, &times_s(0.0), &|_| false), []);
    }

    #[test]
    fn the_limit_falls_with_the_groups() {
        // Student's t, two-sided, one in 100 000.
        assert!((limit(4) - 27.8).abs() < 1e-9 && (limit(7) - 11.4).abs() < 0.4, "{}", limit(7));
        assert!(limit(1000) <= limit(61) && limit(61) <= limit(30));
    }
}
