//! Which part of the aircraft is gone, from what its local model was and is.
//!
//! Each part makes some of the derivatives: nearly all of the pitch damping is the horizontal tail's, the weathercock stability and the
//! yaw damping are the vertical tail's, the roll damping the outer wing's (B. Etkin, L. D. Reid, *Dynamics of Flight*, 3rd ed., chapters
//! 2 and 5). When a fraction `s` of a part is lost, each derivative loses between `s` times a smallest and `s` times a largest part of
//! itself ([`Lost::signature`]). The part whose signature the changes fit best within their standard errors is named, if it fits at all
//! and no other fits nearly as well; else the answer is that it is none of these, or one of two.

use crate::interval::Estimate;
use crate::local::{ALPHA, BETA, LocalModel, P, Q, R};

/// Number of derivatives that are compared.
pub const DERIVATIVES: usize = 11;

/// A part of the aircraft.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "kebab-case"))]
pub enum Lost {
    /// The elevator: what it moves is gone, the tail is there.
    Elevator,
    /// The horizontal tail with its elevator.
    HorizontalTail,
    /// The rudder: what it moves is gone, the fin is there.
    Rudder,
    /// The vertical tail with its rudder.
    VerticalTail,
    /// The ailerons: what they move is gone, the wing is there.
    Ailerons,
    /// A part of the left wing: its tip, or a flap. Which of them, the derivatives tell too weakly to be named.
    LeftWing,
    /// A part of the right wing.
    RightWing,
    /// Nothing is gone: the centre of gravity is elsewhere.
    CentreOfGravity,
}

impl Lost {
    /// All, in the order of tables.
    pub const ALL: [Self; 8] = [
        Self::Elevator,
        Self::HorizontalTail,
        Self::Rudder,
        Self::VerticalTail,
        Self::Ailerons,
        Self::LeftWing,
        Self::RightWing,
        Self::CentreOfGravity,
    ];

    /// In words.
    pub const fn words(self) -> &'static str {
        match self {
            Self::Elevator => "elevator",
            Self::HorizontalTail => "horizontal tail",
            Self::Rudder => "rudder",
            Self::VerticalTail => "vertical tail",
            Self::Ailerons => "ailerons",
            Self::LeftWing => "left wing",
            Self::RightWing => "right wing",
            Self::CentreOfGravity => "centre of gravity",
        }
    }

    /// Smallest and largest part that each derivative loses when all of the part is lost, in the order of [`losses`]. Negative is a
    /// gain. A half of a tail makes half of it. Ranges are those of conventional aeroplanes with tails behind, whose stability in
    /// pitch and yaw is what the tail has beyond what wing and body lack.
    pub const fn signature(self) -> [[f64; 2]; DERIVATIVES] {
        const NO: [f64; 2] = [0.0, 0.0];
        // What the centre of gravity moves when something is lost at the tail or a tip.
        const ANY: [f64; 2] = [-0.6, 0.6];
        // CL_alpha, Cm_alpha, Cm_q, Cm_elevator, CY_beta, Cl_alpha/|Cl_p|, Cl_p, Cl_aileron, Cn_beta, Cn_r, Cn_rudder
        match self {
            Self::Elevator => [[0.0, 0.1], [-0.1, 0.4], [0.0, 0.45], [1.0, 1.0], NO, NO, NO, NO, NO, NO, NO],
            Self::HorizontalTail => {
                [[0.0, 0.35], [0.5, 4.0], [0.8, 1.3], [0.7, 1.2], NO, NO, NO, NO, NO, [-0.1, 0.1], [-0.1, 0.1]]
            }
            Self::Rudder => {
                [NO, [-0.1, 0.1], NO, [-0.1, 0.1], [0.0, 0.25], NO, NO, NO, [0.0, 0.35], [0.0, 0.45], [1.0, 1.0]]
            }
            Self::VerticalTail => {
                [NO, ANY, [-0.2, 0.2], [-0.2, 0.2], [0.3, 1.0], NO, [0.0, 0.1], NO, [0.8, 4.0], [0.6, 1.2], [0.8, 1.2]]
            }
            Self::Ailerons => [NO, NO, NO, NO, NO, NO, [0.0, 0.2], [1.0, 1.0], NO, NO, NO],
            Self::LeftWing => wing([-2.5, -0.4]),
            Self::RightWing => wing([0.4, 2.5]),
            // By a chord: what it does to the stability is not bounded.
            Self::CentreOfGravity => {
                [NO, [1.0, 1.0], [-0.2, 0.2], [-0.1, 0.1], NO, NO, NO, NO, [-0.1, 0.1], [-0.1, 0.1], [-0.1, 0.1]]
            }
        }
    }

    /// Largest fraction: a centre of gravity may take more than all of the stability.
    const fn largest(self) -> f64 {
        match self {
            Self::CentreOfGravity => 3.0,
            _ => 1.0,
        }
    }
}

/// The signature of a half wing with this roll by angle of attack. All of it makes half of the roll damping; what is lost within rolls
/// more by lift than it damps.
const fn wing(roll: [f64; 2]) -> [[f64; 2]; DERIVATIVES] {
    const LITTLE: [f64; 2] = [-0.2, 0.2];
    [[0.05, 1.5], [-1.0, 2.0], [-0.3, 0.3], LITTLE, LITTLE, roll, [0.5, 0.5], [0.0, 1.0], LITTLE, LITTLE, LITTLE]
}

/// What the changes of the derivatives look like.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Name {
    /// The part that is gone; none where nothing fits, or where nothing has changed.
    pub lost: Option<Lost>,
    /// Which fraction of it, 0 to 1.
    pub fraction: f64,
    /// Another part that fits nearly as well.
    pub or: Option<Lost>,
    /// Whether anything has changed at all.
    pub has_changed: bool,
    /// Squares of the differences from the best signature, in standard errors, summed.
    pub misfit: f64,
}

/// Parts that the derivatives have lost, and their standard errors: `CL_alpha, Cm_alpha, Cm_q, Cm_elevator, CY_beta, Cl_p, Cl_aileron,
/// Cn_beta, Cn_r, Cn_rudder` over themselves, and in the sixth place the change of `Cl_alpha` over the size of `Cl_p`: negative where
/// the left wing has lost lift. The dynamic pressure is taken out by the speeds; `span` in m. Not finite where a number is missing.
pub fn losses(before: &Estimate, after: &Estimate, span: f64) -> [[f64; 2]; DERIVATIVES] {
    let faster = after.model.speed / before.model.speed;
    let lost = |of: fn(&LocalModel) -> f64, pressure: f64| {
        let (was, is) = (of(&before.model) * pressure, of(&after.model));
        let kept = is / was;
        let was_error = kept * of(&before.std_error) * pressure / was;
        [1.0 - kept, libm::hypot(of(&after.std_error) / was, was_error)]
    };
    // A rate is made dimensionless with the speed, and the force coefficients turn the velocity of it.
    let (angle, rate) = (faster * faster, faster);
    let unit = (before.model.rates[0][P] * 2.0 * before.model.speed / span).abs();
    let rolled = [
        (after.model.rates[0][ALPHA] / angle - before.model.rates[0][ALPHA]) / unit,
        libm::hypot(after.std_error.rates[0][ALPHA] / angle, before.std_error.rates[0][ALPHA]) / unit,
    ];
    [
        lost(|m| m.alpha_by_alpha, rate),
        lost(|m| m.rates[1][ALPHA], angle),
        lost(|m| m.rates[1][Q], rate),
        lost(|m| m.surfaces[1][0], angle),
        lost(|m| m.beta_by_beta, rate),
        rolled,
        lost(|m| m.rates[0][P], rate),
        lost(|m| m.surfaces[0][1], angle),
        lost(|m| m.rates[2][BETA], angle),
        lost(|m| m.rates[2][R], rate),
        lost(|m| m.surfaces[2][2], angle),
    ]
}

/// What no signature and no estimate is better than, as a part of a derivative: interference, and a mass and inertia that the loss
/// has changed as well.
const ROUGH: f64 = 0.04;
/// The same of the roll by angle of attack, which a whole aeroplane does not have.
const ROUGH_ROLL: f64 = 0.02;
/// Smallest fraction of a part that is looked for.
const SMALLEST: f64 = 0.1;
/// Steps of the fraction.
const STEPS: usize = 60;
/// Most that the squares of the differences may be over their number, for a signature to fit, ...
const FITS: f64 = 2.0;
/// ... and by how much another one has to be worse, so that it is not named beside the best: it is then a hundred times less likely
/// (twice the logarithm of 100).
const APART: f64 = 9.21;
/// Square of the difference of a single derivative that is a change: four standard errors.
const CHANGED: f64 = 16.0;

/// Names the part that is gone.
///
/// ```
/// use phugoid_control::lost::{DERIVATIVES, Lost, name};
///
/// // Cm_alpha, Cm_q and Cm_elevator have lost half of themselves, the lift slope a twentieth; all within 5 %.
/// let mut losses = [[0.0, 0.05]; DERIVATIVES];
/// losses[0][0] = 0.05;
/// losses[1..4].iter_mut().for_each(|loss| loss[0] = 0.5);
/// let found = name(&losses);
/// assert_eq!((found.lost, found.or), (Some(Lost::HorizontalTail), None));
/// assert!((found.fraction - 0.5).abs() < 0.15);
/// ```
pub fn name(losses: &[[f64; 2]; DERIVATIVES]) -> Name {
    let rough = |place: usize| if place == 5 { ROUGH_ROLL } else { ROUGH };
    let used = || losses.iter().enumerate().filter(|(_, [loss, error])| loss.is_finite() && error.is_finite());
    let count = used().count() as f64;
    let has_changed =
        used().any(|(place, [loss, error])| loss * loss > CHANGED * (error * error + rough(place) * rough(place)));
    let nothing = Name { lost: None, fraction: 0.0, or: None, has_changed, misfit: f64::NAN };
    if !has_changed {
        return nothing;
    }
    let misfit = |part: Lost, fraction: f64| -> f64 {
        let signature = part.signature();
        let square = |(place, [loss, error]): (usize, &[f64; 2])| {
            let Some([low, high]) = signature.get(place) else { return 0.0 };
            let beyond = (loss - fraction * high).max(fraction * low - loss).max(0.0);
            beyond * beyond / (error * error + rough(place) * rough(place))
        };
        used().map(square).sum()
    };
    let best_of = |part: Lost| -> (f64, f64) {
        let mut best = (f64::INFINITY, 0.0);
        for step in 0..=STEPS {
            let fraction = SMALLEST + (part.largest() - SMALLEST) * step as f64 / STEPS as f64;
            let found = misfit(part, fraction);
            if found < best.0 {
                best = (found, fraction);
            }
        }
        best
    };
    let mut best: Option<(Lost, f64, f64)> = None;
    let mut second: Option<(Lost, f64)> = None;
    for part in Lost::ALL {
        let (found, fraction) = best_of(part);
        match best {
            Some((_, least, _)) if found >= least => {
                if second.is_none_or(|(_, other)| found < other) {
                    second = Some((part, found));
                }
            }
            _ => {
                second = best.map(|(part, least, _)| (part, least));
                best = Some((part, found, fraction));
            }
        }
    }
    let Some((part, least, fraction)) = best else { return nothing };
    if least > FITS * count {
        return Name { misfit: least, ..nothing };
    }
    let or = second.filter(|(_, other)| *other < least + APART).map(|(part, _)| part);
    Name { lost: Some(part), fraction: fraction.min(1.0), or, has_changed, misfit: least }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn with(changes: &[(usize, f64)]) -> Name {
        let mut losses = [[0.0, 0.02]; DERIVATIVES];
        for (place, loss) in changes {
            losses[*place][0] = *loss;
        }
        name(&losses)
    }

    /// The changes of NASA's transport T-2 (docs/transport.md): measured in a wind tunnel, not made from the signatures.
    #[test]
    fn measured_damage_of_a_transport_is_named() {
        let rudder = with(&[(4, 0.07), (8, 0.14), (9, 0.31), (10, 1.0), (1, -0.06)]);
        assert_eq!((rudder.lost, rudder.or), (Some(Lost::Rudder), None));
        let fin = with(&[(1, -0.33), (2, -0.08), (3, -0.1), (4, 0.6), (8, 1.37), (9, 0.88), (10, 1.0)]);
        assert_eq!((fin.lost, fin.or), (Some(Lost::VerticalTail), None));
        let flap = with(&[(0, 0.02), (1, 0.03), (5, -0.176), (6, 0.065), (7, 0.07)]);
        assert_eq!(flap.lost, Some(Lost::LeftWing));
        let tip = with(&[(0, 0.073), (1, 0.40), (5, -0.314), (6, 0.28), (7, 0.37)]);
        assert_eq!((tip.lost, tip.or), (Some(Lost::LeftWing), None));
        let elevator = with(&[(0, 0.02), (1, 0.07), (2, 0.18), (3, 0.46)]);
        assert_eq!((elevator.lost, elevator.or), (Some(Lost::Elevator), None));
        let stabiliser = with(&[(0, 0.05), (1, 0.46), (2, 0.55), (3, 0.46), (8, -0.04)]);
        assert_eq!((stabiliser.lost, stabiliser.or), (Some(Lost::HorizontalTail), None));
    }

    #[test]
    fn what_fits_nothing_is_not_named() {
        let quiet = with(&[(1, 0.1)]);
        assert!(!quiet.has_changed && quiet.lost.is_none());
        // Damping that grows belongs to no loss.
        let odd = with(&[(6, -0.8), (10, -0.9)]);
        assert!(odd.has_changed && odd.lost.is_none());
        let moved = with(&[(1, 1.4)]);
        assert_eq!(moved.lost, Some(Lost::CentreOfGravity));
        assert!(!name(&[[f64::NAN; 2]; DERIVATIVES]).has_changed);
    }

    #[test]
    fn two_that_cannot_be_told_apart_are_both_said() {
        // Only the rudder's own effect is known.
        let mut losses = [[0.0, f64::NAN]; DERIVATIVES];
        losses[10] = [1.0, 0.05];
        let found = name(&losses);
        assert!(found.lost.is_some() && found.or.is_some());
    }
}
