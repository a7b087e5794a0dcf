//! The worst motion that gains leave within the bounds of an estimate.
//!
//! Gains are judged by how far the roots of the closed loop lie on the safe side of a damping line: of each root `s` the number
//! `Re s + 0.3 |Im s|`, in 1/s, which is negative for what decays with a damping ratio of 0.3 or more; the largest counts. Slow
//! roots that hardly grow (a spiral, which any pilot holds) do not count. The worst value within the bounds is that at the point of
//! the ellipsoid of two standard errors in which a linear expansion is largest, evaluated exactly there.

use crate::gains::Gains;
use crate::local::{AXES, LocalModel, STATES, SURFACES, VARIABLES};
use crate::qualities::{Category, Level, NUMBERS, Qualities, qualities};
use crate::roots::{Root, eigenvalues};

/// Damping ratio of the line that roots are measured from: level 1 of MIL-F-8785C for the short period asks for as much.
const DAMPING: f64 = 0.3;
/// Roots that are slower than this count less, rad/s.
const SLOW: f64 = 0.6;
/// A motion this far on the safe side is good enough, 1/s.
pub const SAFE: f64 = -0.5;
/// Standard errors of the interval.
const SIGMAS: f64 = 2.0;
/// Number of uncertain entries of a model.
pub const ENTRIES: usize = AXES * VARIABLES + AXES * SURFACES + 5;

/// A model with the standard errors of its entries.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Estimate {
    /// The model as estimated.
    pub model: LocalModel,
    /// One standard error of each entry, in the place of the entry; angle, speed and gravity are known and not read.
    pub std_error: LocalModel,
}

/// How far from the safe side of the damping line the motion is, 1/s; smaller is better, negative is safe.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Excess {
    /// Of the motion in angle of attack and pitch rate alone.
    pub pitch: f64,
    /// Of the motion in sideslip, bank angle, roll and yaw rate alone.
    pub lateral: f64,
    /// Of everything together.
    pub whole: f64,
}

impl Excess {
    /// The largest of the three.
    pub fn largest(&self) -> f64 {
        self.pitch.max(self.lateral).max(self.whole)
    }
}

/// How an aircraft moves with these gains; infinite where its roots cannot be computed.
pub fn excess(model: &LocalModel, gains: &Gains) -> Excess {
    let a = model.closed_loop(&gains.feedback());
    let part = |i: usize, j: usize| a[i][j];
    let pitch: [[f64; 2]; 2] = [[part(0, 0), part(0, 4)], [part(4, 0), part(4, 4)]];
    const LATERAL: [usize; 4] = [1, 2, 3, 5];
    let lateral: [[f64; 4]; 4] = LATERAL.map(|i| LATERAL.map(|j| part(i, j)));
    Excess { pitch: of_matrix(&pitch), lateral: of_matrix(&lateral), whole: of_matrix::<STATES>(&a) }
}

fn of_matrix<const N: usize>(a: &[[f64; N]; N]) -> f64 {
    match eigenvalues(a) {
        Some(roots) => roots.iter().map(of_root).fold(f64::NEG_INFINITY, f64::max),
        None => f64::INFINITY,
    }
}

fn of_root(root: &Root) -> f64 {
    // One for a root of zero, nothing from SLOW on; nothing for what grows faster than it doubles in seven seconds.
    let slowness = (1.0 - root.frequency() / SLOW).max(0.0);
    let tolerated = ((0.1 - root.real) / 0.1).clamp(0.0, 1.0);
    root.real + DAMPING * root.imaginary.abs() - 3.0 * slowness * tolerated
}

/// The worst motion with these gains within two standard errors of the estimate. Standard errors that are not finite make it
/// infinite: nothing is known then.
pub fn worst(estimate: &Estimate, gains: &Gains) -> Excess {
    let nominal = excess(&estimate.model, gains);
    let mut slopes = [[0.0; 3]; ENTRIES];
    for (entry, slope) in slopes.iter_mut().enumerate() {
        let std_error = at(&estimate.std_error, entry);
        if !std_error.is_finite() {
            return Excess { pitch: f64::INFINITY, lateral: f64::INFINITY, whole: f64::INFINITY };
        }
        if std_error == 0.0 {
            continue;
        }
        let moved = with(&estimate.model, entry, at(&estimate.model, entry) + std_error);
        let changed = excess(&moved, gains);
        *slope = [changed.pitch - nominal.pitch, changed.lateral - nominal.lateral, changed.whole - nominal.whole];
    }
    let reached = |part: usize| {
        let length = libm::sqrt(slopes.iter().map(|slope| slope[part] * slope[part]).sum::<f64>());
        if !(length > 0.0 && length.is_finite()) {
            return estimate.model;
        }
        let mut model = estimate.model;
        for (entry, slope) in slopes.iter().enumerate() {
            let step = SIGMAS * slope[part] / length * at(&estimate.std_error, entry);
            model = with(&model, entry, at(&model, entry) + step);
        }
        model
    };
    Excess {
        pitch: excess(&reached(0), gains).pitch.max(nominal.pitch),
        lateral: excess(&reached(1), gains).lateral.max(nominal.lateral),
        whole: excess(&reached(2), gains).whole.max(nominal.whole),
    }
}

/// Levels of flying qualities in pitch, and of Dutch roll, roll and spiral together, coupled or not.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Levels {
    /// Of the short period.
    pub pitch: Level,
    /// The worst of Dutch roll, roll and spiral.
    pub lateral: Level,
}

impl Levels {
    fn of(found: &Qualities) -> Self {
        Self { pitch: found.pitch_level(), lateral: found.lateral_level() }
    }

    fn worse_of(self, other: Self) -> Self {
        Self { pitch: self.pitch.max(other.pitch), lateral: self.lateral.max(other.lateral) }
    }
}

/// The worst levels with these gains within two standard errors of the estimate: of each number that levels are judged by (frequencies,
/// damping ratios, roll and spiral) both points of the ellipsoid in which its linear expansion is extreme, and each entry alone at either
/// end of its bound, because levels have steps that no expansion shows. Standard errors that are not finite make both worse than level
/// 3: nothing is known then.
pub fn worst_levels(estimate: &Estimate, gains: &Gains, category: Category) -> Levels {
    let feedback = gains.feedback();
    let of = |model: &LocalModel| qualities(&model.closed_loop(&feedback), model.load_factor_per_alpha(), category);
    let nominal = of(&estimate.model);
    let middle = nominal.numbers();
    let mut found = Levels::of(&nominal);
    let mut slopes = [[0.0; NUMBERS]; ENTRIES];
    for (entry, slope) in slopes.iter_mut().enumerate() {
        let std_error = at(&estimate.std_error, entry);
        if !std_error.is_finite() {
            return Levels { pitch: Level::Worse, lateral: Level::Worse };
        }
        if std_error == 0.0 {
            continue;
        }
        let moved = |steps: f64| of(&with(&estimate.model, entry, at(&estimate.model, entry) + steps * std_error));
        for steps in [-SIGMAS, SIGMAS] {
            found = found.worse_of(Levels::of(&moved(steps)));
        }
        for (slope, (there, here)) in slope.iter_mut().zip(moved(1.0).numbers().into_iter().zip(middle)) {
            // A mode that is missing here or there has no slope; its level is looked at above.
            let change = there - here;
            *slope = if change.is_finite() { change } else { 0.0 };
        }
    }
    for number in 0..NUMBERS {
        let length = libm::sqrt(slopes.iter().map(|slope| slope[number] * slope[number]).sum::<f64>());
        if !(length > 0.0 && length.is_finite()) {
            continue;
        }
        for sigmas in [-SIGMAS, SIGMAS] {
            let mut model = estimate.model;
            for (entry, slope) in slopes.iter().enumerate() {
                let step = sigmas * slope[number] / length * at(&estimate.std_error, entry);
                model = with(&model, entry, at(&model, entry) + step);
            }
            found = found.worse_of(Levels::of(&of(&model)));
        }
    }
    found
}

/// The worst motions within the bounds of an estimate with two sets of gains.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Comparison {
    before: Excess,
    after: Excess,
}

impl Comparison {
    /// The comparison of the gains `now` with the gains `new`: the dearest computation of a decision, done once.
    pub fn new(estimate: &Estimate, now: &Gains, new: &Gains) -> Self {
        Self { before: worst(estimate, now), after: worst(estimate, new) }
    }

    /// Whether the bounds support the change: somewhere the worst motion gets better by `gain` (1/s), and nowhere worse by half as
    /// much. Beyond half a second's decay on the safe side nothing is counted as better or worse.
    pub fn supports(&self, gain: f64) -> bool {
        let is_better = self.pairs().iter().any(|(before, after)| after.max(SAFE) < before.max(SAFE) - gain);
        is_better && self.allows(0.5 * gain)
    }

    /// Whether the bounds allow a change that is wanted for another reason than the worst motion: that does not get worse by more
    /// than `loss` (1/s) anywhere.
    pub fn allows(&self, loss: f64) -> bool {
        self.pairs().iter().all(|(before, after)| after.is_finite() && after.max(SAFE) <= before.max(SAFE) + loss)
    }

    fn pairs(&self) -> [(f64, f64); 3] {
        let (before, after) = (&self.before, &self.after);
        [(before.pitch, after.pitch), (before.lateral, after.lateral), (before.whole, after.whole)]
    }
}

/// Of several candidates the gains whose worst motion over all these models is best: fixed gains for everything that may happen.
/// `None` without a candidate that leaves a finite motion everywhere.
pub fn most_robust<'a>(
    models: impl Iterator<Item = &'a LocalModel> + Clone,
    candidates: impl Iterator<Item = Gains>,
) -> Option<Gains> {
    let mut best: Option<(f64, Gains)> = None;
    for gains in candidates {
        let worst = models.clone().map(|model| excess(model, &gains).largest()).fold(f64::NEG_INFINITY, f64::max);
        if worst.is_finite() && best.is_none_or(|(so_far, _)| worst < so_far) {
            best = Some((worst, gains));
        }
    }
    best.map(|(_, gains)| gains)
}

/// The entries of a model, one after another.
fn place(model: &mut LocalModel, entry: usize) -> Option<&mut f64> {
    const RATES: usize = AXES * VARIABLES;
    const ALL: usize = RATES + AXES * SURFACES;
    if entry < RATES {
        return model.rates.iter_mut().flatten().nth(entry);
    }
    if entry < ALL {
        return model.surfaces.iter_mut().flatten().nth(entry - RATES);
    }
    match entry - ALL {
        0 => Some(&mut model.alpha_by_alpha),
        1 => Some(&mut model.alpha_by_elevator),
        2 => Some(&mut model.beta_by_beta),
        3 => Some(&mut model.beta_by_rudder),
        4 => Some(&mut model.beta_by_aileron),
        _ => None,
    }
}

fn at(model: &LocalModel, entry: usize) -> f64 {
    let mut copy = *model;
    place(&mut copy, entry).map_or(0.0, |value| *value)
}

fn with(model: &LocalModel, entry: usize, value: f64) -> LocalModel {
    let mut copy = *model;
    if let Some(place) = place(&mut copy, entry) {
        *place = value;
    }
    copy
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gains::tests::fighter;
    use crate::target::Targets;

    fn known_to(part: f64) -> Estimate {
        let model = fighter();
        let mut std_error = LocalModel::default();
        for entry in 0..ENTRIES {
            std_error = with(&std_error, entry, part * at(&model, entry).abs());
        }
        Estimate { model, std_error }
    }

    #[test]
    fn the_worst_motion_is_worse_than_the_nominal_one_and_grows_with_the_bounds() {
        let gains = Gains::place(&fighter(), &Targets::default()).unwrap();
        let nominal = excess(&fighter(), &gains);
        let mut last = nominal.largest();
        assert!(last < -0.4, "{nominal:?}");
        for part in [0.02, 0.1, 0.3] {
            let worst = worst(&known_to(part), &gains).largest();
            assert!(worst > last, "{part}: {worst} {last}");
            last = worst;
        }
        let unknown = worst(&known_to(f64::INFINITY), &gains);
        assert_eq!(unknown.largest(), f64::INFINITY);
    }

    /// Level 1 at the estimate is level 1 within narrow bounds, less within wide ones, and no level where nothing is known; what is
    /// uncertain in pitch alone says nothing against roll and yaw.
    #[test]
    fn the_worst_level_falls_with_the_bounds() {
        let gains = Gains::place(&fighter(), &Targets::default()).unwrap();
        let levels = |estimate: &Estimate| worst_levels(estimate, &gains, Category::B);
        let narrow = levels(&known_to(0.01));
        assert_eq!(narrow, Levels { pitch: Level::One, lateral: Level::One });
        let wide = levels(&known_to(0.5));
        assert!(wide.pitch > Level::One && wide.lateral > Level::One, "{wide:?}");
        let mut in_pitch = known_to(0.0);
        in_pitch.std_error.rates[1] = [8.0, 0.0, 0.0, 1.0, 0.0];
        let found = levels(&in_pitch);
        assert!(found.pitch > Level::One && found.lateral == Level::One, "{found:?}");
        assert_eq!(levels(&known_to(f64::NAN)), Levels { pitch: Level::Worse, lateral: Level::Worse });
    }

    /// An aircraft that has lost stability and half of its elevator: new gains are supported once the bounds are small, and not
    /// before; the same gains are no improvement.
    #[test]
    fn a_change_of_gains_needs_bounds_that_support_it() {
        let before = Gains::place(&fighter(), &Targets::default()).unwrap();
        let mut damaged = fighter();
        damaged.rates[1][0] = 14.0;
        damaged.surfaces[1][0] = -5.5;
        let after = Gains::place(&damaged, &Targets::default()).unwrap();
        assert!(excess(&damaged, &before).pitch > excess(&damaged, &after).pitch + 1.0);
        let estimate = |part: f64| {
            let known = known_to(part);
            Estimate { model: damaged, ..known }
        };
        assert!(Comparison::new(&estimate(0.02), &before, &after).supports(0.1));
        assert!(!Comparison::new(&estimate(3.0), &before, &after).supports(0.1));
        assert!(!Comparison::new(&estimate(0.02), &after, &after).supports(0.1));
    }

    #[test]
    fn the_most_robust_gains_hold_all_models() {
        let mut weak = fighter();
        weak.surfaces.iter_mut().flatten().for_each(|b| *b *= 0.7);
        let models = [fighter(), weak];
        let candidates = models.iter().filter_map(|m| Gains::place(m, &Targets::default()));
        let robust = most_robust(models.iter(), candidates).unwrap();
        let left: [Excess; 2] = models.map(|model| excess(&model, &robust));
        assert!(left.iter().all(|excess| excess.largest() < 0.0), "{left:?}");
        assert!(most_robust(models.iter(), core::iter::empty()).is_none());
    }
}
