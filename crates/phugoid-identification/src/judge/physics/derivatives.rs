//! Checks of the estimates: signs, lift slope, sizes, drag.

use std::f64::consts::PI;

use super::aircraft::Body;
use super::finding::reason;
use super::flown::Flown;
use crate::core::estimation::{EstimationStatus, FinalStatus, ParameterResult, ReasonCode, VerdictReason};
use crate::core::term::{Coefficient, Term, Variable};
use crate::methods::Task;
use crate::model_file::{Base, Role};
use crate::motion::Motion;

/// A check speaks where its limit lies so many standard errors away.
const SIGNIFICANT: f64 = 3.0;
/// Beyond this angle of attack, rad, the flow may be separated, and the signs of lift slope and roll damping with it.
const ATTACHED: f64 = 0.26;

/// One term of the build-up at its estimate, or at its fixed value.
struct Piece {
    coefficient: Coefficient,
    term: Term,
    name: String,
    value: f64,
    std_error: f64,
    random_std: f64,
    /// Row and column in the correlation matrix.
    place: usize,
    bounds: Option<[f64; 2]>,
}

/// A coefficient or one of its derivatives at the flown point, with the parameters that it is made of.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Derivative {
    pub(super) coefficient: Coefficient,
    /// None for the coefficient itself.
    pub(super) variable: Option<Variable>,
    /// Names of the parameters that it is made of, the one of the linear term first.
    pub(super) names: Vec<String>,
    pub(super) value: f64,
    pub(super) std_error: f64,
    /// The part of it that the model file does not declare.
    pub(super) random_std: f64,
    /// Bounds that the model file gives the linear term.
    pub(super) bounds: Option<[f64; 2]>,
}

/// The coefficients and their derivatives where the flight was flown; empty for increments to a database, whose sum
/// with the database is not known here.
#[derive(Default)]
pub(super) struct Derivatives(pub(super) Vec<Derivative>);

impl Derivatives {
    pub(super) fn of<M: Motion<N, R>, const N: usize, const R: usize>(
        task: &Task<M, N, R>,
        parameters: &[ParameterResult],
        correlation: &[Vec<f64>],
        flown: &Flown,
    ) -> Self {
        if task.file.base != Base::None {
            return Self::default();
        }
        let piece = |(place, result): (usize, &ParameterResult)| {
            let parameter = task.file.parameters.iter().find(|p| p.name == result.name)?;
            let Role::Term(coefficient, term) = &parameter.role else { return None };
            // What the flight does not determine is not held against it.
            if result.status == FinalStatus::NotExcited {
                return None;
            }
            Some(Piece {
                coefficient: *coefficient,
                term: term.clone(),
                name: result.name.clone(),
                value: result.value,
                std_error: result.corrected_std_error,
                random_std: result.random_std(),
                place,
                bounds: parameter.bounds,
            })
        };
        let pieces: Vec<Piece> = parameters.iter().enumerate().filter_map(piece).collect();
        let mut found = Vec::new();
        for coefficient in Coefficient::ALL {
            let own: Vec<&Piece> = pieces.iter().filter(|p| p.coefficient == coefficient).collect();
            for variable in Variable::OF_DERIVATIVES.into_iter().map(Some).chain([None]) {
                found.extend(derivative(&own, coefficient, variable, correlation, flown));
            }
        }
        Self(found)
    }

    pub(super) fn find(&self, coefficient: Coefficient, variable: Variable) -> Option<&Derivative> {
        self.0.iter().find(|d| d.coefficient == coefficient && d.variable == Some(variable))
    }
}

/// The sum over the terms of a coefficient, or of their derivatives, at the flown point. None where the linear term (of
/// a coefficient: its constant) is missing.
fn derivative(
    pieces: &[&Piece],
    coefficient: Coefficient,
    variable: Option<Variable>,
    correlation: &[Vec<f64>],
    flown: &Flown,
) -> Option<Derivative> {
    let linear = |term: &Term| match variable {
        Some(variable) => term.single() == Some(variable.index()),
        None => term.is_constant(),
    };
    let slope = |term: &Term| -> f64 {
        match variable {
            None => term.value(&flown.variables),
            Some(variable) => term.slope(variable.index(), &flown.variables),
        }
    };
    let first = pieces.iter().find(|p| linear(&p.term))?;
    let mut parts: Vec<(&Piece, f64)> =
        pieces.iter().map(|p| (*p, slope(&p.term))).filter(|(_, s)| *s != 0.0).collect();
    parts.sort_by_key(|(p, _)| !linear(&p.term));
    let r = |a: usize, b: usize| correlation.get(a).and_then(|row| row.get(b)).copied().unwrap_or(f64::from(a == b));
    let std = |of: &dyn Fn(&Piece) -> f64| {
        let pairs = parts.iter().flat_map(|a| parts.iter().map(move |b| (a, b)));
        let variance: f64 = pairs.map(|((a, sa), (b, sb))| sa * sb * r(a.place, b.place) * of(a) * of(b)).sum();
        variance.max(0.0).sqrt()
    };
    Some(Derivative {
        coefficient,
        variable,
        names: parts.iter().map(|(p, _)| p.name.clone()).collect(),
        value: parts.iter().map(|(p, s)| s * p.value).sum(),
        std_error: std(&|piece| piece.std_error),
        random_std: std(&|piece| piece.random_std),
        bounds: first.bounds,
    })
}

impl Derivative {
    /// Its name in the model file, and that of the other terms which it is made of here.
    pub(super) fn words(&self) -> String {
        match self.names.as_slice() {
            [] => String::new(),
            [one] => one.clone(),
            [one, rest @ ..] => format!("{one} (with {})", rest.join(", ")),
        }
    }

    pub(super) fn number(&self) -> String {
        format!("{:.3} +- {:.3}", self.value, 2.0 * self.std_error)
    }

    pub(super) fn concerns<'a>(&'a self, more: &[&'a str]) -> Vec<&'a str> {
        self.names.iter().map(String::as_str).chain(more.iter().copied()).collect()
    }

    /// Whether its size is above a limit by its random error alone. What the model file declares of a surface or of an inertia is a part of the
    /// derivative, and of one that is 60 times too large by a wrong unit it is 60 times too large as well.
    fn surely_larger(&self, limit: f64) -> bool {
        self.value.abs() - SIGNIFICANT * self.random_std > limit
    }

    pub(super) fn surely_above(&self, limit: f64) -> bool {
        self.value - SIGNIFICANT * self.std_error > limit
    }

    pub(super) fn surely_below(&self, limit: f64) -> bool {
        self.value + SIGNIFICANT * self.std_error < limit
    }
}

/// What a sign that no aeroplane has points to.
struct Sign {
    coefficient: Coefficient,
    variable: Variable,
    positive: bool,
    /// Smaller than this the sign may be the model's error.
    least: f64,
    /// Whether no aeroplane has it, with the flow attached; otherwise a convention or a layout can explain it.
    impossible: bool,
    concerns: &'static str,
    advice: &'static str,
}

/// Signs by the conventions of docs/units-and-signs.md. Damping and lift slope follow from lift that grows with the
/// angle of attack (B. Etkin, L. D. Reid, *Dynamics of Flight*, 3rd ed., 1996, chapter 5); those of the surfaces are
/// conventions.
const SIGNS: [Sign; 8] = [
    Sign {
        coefficient: Coefficient::Lift,
        variable: Variable::Alpha,
        positive: true,
        least: 0.1,
        impossible: true,
        concerns: "alpha",
        advice: "lift grows with the angle of attack: the sign of alpha or az is reversed; write `scale = -1` for it in \
                 [channels]",
    },
    Sign {
        coefficient: Coefficient::PitchingMoment,
        variable: Variable::PitchRate,
        positive: false,
        least: 0.5,
        impossible: true,
        concerns: "q",
        advice: "every aeroplane damps pitching: q or the elevator is late or reversed, or the manoeuvre does not \
                 separate the terms of Cm",
    },
    Sign {
        coefficient: Coefficient::PitchingMoment,
        variable: Variable::Elevator,
        positive: false,
        least: 0.03,
        impossible: false,
        concerns: "elevator",
        advice: "trailing edge down is positive and lowers the nose. Is this elevator positive trailing edge up? Write \
                 `scale = -1` in [channels]: `elevator = { header = \"...\", scale = -1 }`. If it is a canard, say so with \
                 bounds above zero",
    },
    Sign {
        coefficient: Coefficient::SideForce,
        variable: Variable::Beta,
        positive: false,
        least: 0.05,
        impossible: false,
        concerns: "beta",
        advice: "air from the right pushes to the left: the sign of beta or ay is reversed; write `scale = -1` for it in \
                 [channels]",
    },
    Sign {
        coefficient: Coefficient::RollingMoment,
        variable: Variable::RollRate,
        positive: false,
        least: 0.03,
        impossible: true,
        concerns: "p",
        advice: "every wing damps rolling below its stall: p or the aileron is late or reversed, or the manoeuvre does \
                 not separate the terms of Cl",
    },
    Sign {
        coefficient: Coefficient::RollingMoment,
        variable: Variable::Aileron,
        positive: false,
        least: 0.005,
        impossible: false,
        concerns: "aileron",
        advice: "the right aileron's trailing edge down is positive and rolls to the left. Is this aileron positive for \
                 rolling to the right? Write `scale = -1` in [channels]: `aileron = { header = \"...\", scale = -1 }`",
    },
    Sign {
        coefficient: Coefficient::YawingMoment,
        variable: Variable::YawRate,
        positive: false,
        least: 0.03,
        impossible: false,
        concerns: "r",
        advice: "every fin damps yawing: r or the rudder is late or reversed, or the manoeuvre does not separate the \
                 terms of Cn",
    },
    Sign {
        coefficient: Coefficient::YawingMoment,
        variable: Variable::Rudder,
        positive: false,
        least: 0.003,
        impossible: false,
        concerns: "rudder",
        advice: "trailing edge left is positive and yaws to the left. Is this rudder positive trailing edge right? Write \
                 `scale = -1` in [channels]: `rudder = { header = \"...\", scale = -1 }`",
    },
];

/// Whether a value (with one sigma) of a term that is one variable alone has a sign that does not hang on how a surface counts, and
/// that no aeroplane has.
pub(crate) fn is_mirrored(role: &Role, value: f64, std_error: f64) -> bool {
    let Role::Term(coefficient, term) = role else { return false };
    let is_surface = |v: Variable| matches!(v, Variable::Elevator | Variable::Aileron | Variable::Rudder);
    let of = |sign: &&Sign| {
        sign.coefficient == *coefficient && !is_surface(sign.variable) && term.single() == Some(sign.variable.index())
    };
    SIGNS.iter().find(of).is_some_and(|sign| {
        let wrong = if sign.positive { -value } else { value };
        wrong - SIGNIFICANT * std_error > sign.least
    })
}

/// Signs that aeroplanes do not have. Bounds of the model file on the other side of zero say that this one has it.
pub(super) fn signs(derivatives: &Derivatives, flown: &Flown) -> Vec<VerdictReason> {
    let attached = flown.largest_alpha.is_none_or(|alpha| alpha < ATTACHED);
    let wrong = |sign: &Sign| {
        let found = derivatives.find(sign.coefficient, sign.variable)?;
        let reversed = if sign.positive { found.surely_below(-sign.least) } else { found.surely_above(sign.least) };
        let declared = found.bounds.is_some_and(|[low, high]| if sign.positive { high <= 0.0 } else { low >= 0.0 });
        if !reversed || declared {
            return None;
        }
        let status = if sign.impossible && attached { EstimationStatus::Refused } else { EstimationStatus::Doubtful };
        Some(VerdictReason {
            code: ReasonCode::Sign,
            status,
            concerns: found.concerns(&[sign.concerns]).into_iter().map(str::to_owned).collect(),
            sentence: format!("{} is {}: {}.", found.words(), found.number(), sign.advice),
        })
    };
    SIGNS.iter().filter_map(wrong).collect()
}

/// Part of the lift slope of a straight wing that sweep, stall and gaps leave at least, and below which no wing is. With the true
/// values of 27 aircraft of another simulator it is 0.69 to 1.27, and 0.55 for one more; a damaged wing has less, and is no error of units.
const SLOPE_LEFT: [f64; 2] = [0.5, 0.25];
/// Lift slope over that of a thin airfoil which thickness and a large tail reach, and which nothing reaches.
const SLOPE_RIGHT: [f64; 2] = [1.2, 2.4];
/// Lift slope over that of the wing alone which body and tail add at most.
const WITH_TAIL: f64 = 1.4;
/// Up to this Mach number the rule of Prandtl and Glauert is used.
const SUBSONIC: f64 = 0.9;

/// The lift slope against what the aspect ratio allows: `2 pi A / (2 + sqrt(4 + (A beta)^2))` with `beta = sqrt(1 - M^2)`
/// (H. B. Helmbold 1942, with the rule of Prandtl and Glauert; J. D. Anderson, *Fundamentals of Aerodynamics*, sections
/// 5.3 and 11.4), and against `2 pi / beta` of a thin airfoil. Wrong units of speed, mass, area or density are a factor
/// on all coefficients, and show here.
pub(super) fn lift_slope(derivatives: &Derivatives, flown: &Flown, body: &Body) -> Option<VerdictReason> {
    let found = derivatives.find(Coefficient::Lift, Variable::Alpha)?;
    let mach = flown.mach.filter(|mach| *mach < SUBSONIC)?;
    let beta = (1.0 - mach * mach).sqrt();
    let thin = 2.0 * PI / beta;
    let helmbold = |ratio: f64| 2.0 * PI * ratio / (2.0 + (4.0 + (ratio * beta).powi(2)).sqrt());
    // Without a span, that of a wing as slender as any, and no limit above but that of the airfoil.
    let ratio = body.aspect_ratio().unwrap_or(1.5);
    let wing = helmbold(ratio);
    let largest = (SLOPE_RIGHT[0] * thin).min(body.aspect_ratio().map_or(f64::INFINITY, |a| WITH_TAIL * helmbold(a)));
    let concerns = found.concerns(&["[aircraft] wing_area", "[aircraft] mass", "true_airspeed", "alpha"]);
    let check = "Check mass, wing_area and wing_span under [aircraft], the units of true_airspeed, az and the air density, \
                 and the scale of alpha";
    // A negative one is a matter of signs.
    if found.value > 0.0 && found.surely_below(SLOPE_LEFT[0] * wing) {
        let sentence = format!(
            "{} is {} per rad, less than {} times the {wing:.2} of a straight wing of aspect ratio {ratio:.1}. {check}.",
            found.words(),
            found.number(),
            SLOPE_LEFT[0]
        );
        return Some(reason(found.surely_below(SLOPE_LEFT[1] * wing), &concerns, sentence));
    }
    found.surely_above(largest).then(|| {
        let sentence = format!(
            "{} is {} per rad, and a wing with body and tail has at most {largest:.2} at Mach {mach:.2}. {check}.",
            found.words(),
            found.number()
        );
        reason(found.surely_above(SLOPE_RIGHT[1] * thin), &concerns, sentence)
    })
}

/// Roll damping over that of the wing by lifting-line theory. With the true values of thirteen aircraft of another
/// simulator it is 0.68 to 1.31.
const ROLL_DAMPING: [f64; 2] = [0.45, 1.7];
/// Smaller aspect ratios are no lifting lines.
const LIFTING_LINE: f64 = 2.5;
/// `(1 + 3 taper) / (12 (1 + taper))` of a wing that tapers to a half.
const TAPERED: f64 = 0.139;

/// The roll damping against what the aspect ratio allows: `Cl_p = -2 pi A/(A + 4) (1 + 3 taper)/(12 (1 + taper))` per unit
/// of `p b/(2 V)`, by strips with the lift slope of an antisymmetric distribution (H. A. Pearson, R. T. Jones, NACA Report
/// 635, 1938). Wrong moments of inertia are a factor on all moments, and show here.
pub(super) fn roll_damping(derivatives: &Derivatives, flown: &Flown, body: &Body) -> Option<VerdictReason> {
    let found = derivatives.find(Coefficient::RollingMoment, Variable::RollRate)?;
    let ratio = body.aspect_ratio().filter(|ratio| *ratio >= LIFTING_LINE)?;
    let subsonic = flown.mach.is_some_and(|mach| mach < SUBSONIC);
    // A sign that no aeroplane has is another matter.
    if !subsonic || flown.largest_alpha.is_some_and(|alpha| alpha >= ATTACHED) || found.value >= 0.0 {
        return None;
    }
    let wing = -2.0 * PI * ratio / (ratio + 4.0) * TAPERED;
    let [least, most] = ROLL_DAMPING.map(|part| part * wing);
    (found.surely_above(least) || found.surely_below(most)).then(|| {
        reason(
            false,
            &found.concerns(&["[aircraft] ixx", "[aircraft] izz", "[aircraft] wing_span", "p"]),
            format!(
                "{} is {}, and a wing of aspect ratio {ratio:.1} has about {wing:.2}, {least:.2} to {most:.2} with everything \
                 that bodies, sweep and taper do. Check ixx, izz and wing_span under [aircraft], and the scale of p.",
                found.words(),
                found.number()
            ),
        )
    })
}

/// Largest arm of the side force that an aeroplane weathercocks with, spans: fins are at most about 0.7 behind, and
/// bodies take from the moment and add to the force. With the true values of eight aircraft of another simulator it is
/// 0.10 to 0.49. With a limit of 0.7 two of 138 side accelerations in g passed, 0.92 spans by numbers with bounds of a tenth.
const FIN_ARM: f64 = 0.6;

/// The yawing moment by sideslip against the side force by sideslip. A side acceleration in another unit or of another
/// scale is a factor on the force alone, and shows here where gusts hide it from the kinematics.
pub(super) fn fin_arm(derivatives: &Derivatives) -> Option<VerdictReason> {
    let moment = derivatives.find(Coefficient::YawingMoment, Variable::Beta)?;
    let force = derivatives.find(Coefficient::SideForce, Variable::Beta)?;
    // What the moment has beyond the longest arm, with the standard errors of both.
    let excess = moment.value + FIN_ARM * force.value;
    let std_error = moment.std_error.hypot(FIN_ARM * force.std_error);
    (excess > SIGNIFICANT * std_error).then(|| {
        let concerns: Vec<&str> =
            moment.names.iter().chain(&force.names).map(String::as_str).chain(["ay", "[aircraft] izz"]).collect();
        reason(
            false,
            &concerns,
            format!(
                "{} is {} and {} is {}: {}. Check the unit and the scale of ay (m/s^2 or g), whether it is ay, and mass, izz \
                 and wing_span under [aircraft].",
                moment.words(),
                moment.number(),
                force.words(),
                force.number(),
                if force.value < 0.0 {
                    let arm = moment.value / -force.value;
                    format!("the side force would act {arm:.2} spans behind the centre of gravity, beyond every fin")
                } else {
                    "there is no side force that could make this moment".to_owned()
                }
            ),
        )
    })
}

/// Largest arm of the elevator's force, roots of the wing area, if it were as large as the lift of the whole aircraft at the same angle. With
/// the true values of eighteen aircraft of another simulator it is 0.03 to 0.30 (a rocket plane with an all-moving tail); an elevator in
/// degrees that are called radians makes 57 times as much.
const ELEVATOR_ARM: f64 = 0.6;

/// The pitching moment by the elevator against the lift by the angle of attack: an elevator lifts less than the aircraft of which it is a part.
/// The size of the moment alone does not say so of an aircraft whose reference length is long.
pub(super) fn elevator_arm(derivatives: &Derivatives, body: &Body) -> Option<VerdictReason> {
    let moment = derivatives.find(Coefficient::PitchingMoment, Variable::Elevator)?;
    let lift = derivatives.find(Coefficient::Lift, Variable::Alpha)?;
    let longest_m = ELEVATOR_ARM * body.wing_area.sqrt();
    // What the moment has beyond the longest arm, over q S, with the standard errors of both.
    let excess = moment.value.abs() * body.mean_chord - longest_m * lift.value;
    let std_error = (moment.std_error * body.mean_chord).hypot(longest_m * lift.std_error);
    (lift.value > 0.0 && excess > SIGNIFICANT * std_error).then(|| {
        let concerns: Vec<&str> =
            moment.names.iter().map(String::as_str).chain(["elevator", "[aircraft] iyy", "[aircraft] mean_chord"]).collect();
        reason(
            false,
            &concerns,
            format!(
                "{} is {} and {} is {}: an elevator that lifted as much as the whole aircraft would have to act {:.0} m from the \
                 centre of gravity for that, and {longest_m:.0} m is the limit. Check the unit of `elevator` (deg or rad), \
                 iyy and the lengths under [aircraft].",
                moment.words(),
                moment.number(),
                lift.words(),
                lift.number(),
                moment.value.abs() * body.mean_chord / lift.value,
            ),
        )
    })
}

/// Part of the rolling moment that a product of inertia of the wrong sign adds to the yawing moment, from which it is looked
/// for: the yawing moments by roll rate and aileron are of that size by themselves.
const MIXED: f64 = 0.15;
/// The other sign has to leave at most this part of both.
const LEFT_BY_OTHER_SIGN: f64 = 1.0 / 3.0;

/// The sign of the product of inertia. Sources differ in it: the integral of x z, or the element of the inertia matrix.
/// From `N = izz r' - ixz p'` (with p' about L/ixx) a wrong sign adds `-2 ixz/ixx` times the rolling moment to the yawing
/// moment: to all its derivatives by the same factor, where an aeroplane yaws little by roll rate and aileron.
pub(super) fn product_of_inertia(derivatives: &Derivatives, body: &Body) -> Option<VerdictReason> {
    let factor = 2.0 * body.ixz? / body.ixx?;
    let mixed = |variable: Variable| -> Option<bool> {
        let yaw = derivatives.find(Coefficient::YawingMoment, variable)?;
        let roll = derivatives.find(Coefficient::RollingMoment, variable)?;
        let with_other_sign = yaw.value + factor * roll.value;
        let is_known = yaw.value.abs() > SIGNIFICANT * yaw.std_error && roll.value.abs() > SIGNIFICANT * roll.std_error;
        Some(is_known && with_other_sign.abs() < LEFT_BY_OTHER_SIGN * yaw.value.abs())
    };
    let by_both = mixed(Variable::RollRate)? && mixed(Variable::Aileron)?;
    (by_both && factor.abs() > MIXED).then(|| {
        reason(
            false,
            &["[aircraft] ixz", "Cn_p", "Cn_aileron"],
            format!(
                "The yawing moments by roll rate and aileron are both about {:.2} times the rolling moments, which is what \
                 a wrong sign of ixz adds to all derivatives of Cn. Check ixz under [aircraft]: the integral of x z, which \
                 is minus the element of the inertia matrix.",
                -factor
            ),
        )
    })
}

/// Smallest and largest sizes of derivatives: about half and twice the ranges that textbooks give over all aeroplanes
/// (J. Roskam, *Airplane Flight Dynamics and Automatic Flight Controls*, part I, chapter 4).
const SIZES: [(Coefficient, Variable, f64, f64); 14] = [
    (Coefficient::Lift, Variable::Elevator, 0.0, 3.0),
    (Coefficient::PitchingMoment, Variable::Alpha, 0.0, 6.0),
    (Coefficient::PitchingMoment, Variable::PitchRate, 0.0, 150.0),
    (Coefficient::PitchingMoment, Variable::Elevator, 0.08, 6.0),
    (Coefficient::SideForce, Variable::Beta, 0.08, 3.0),
    (Coefficient::RollingMoment, Variable::Beta, 0.0, 0.8),
    (Coefficient::RollingMoment, Variable::RollRate, 0.05, 1.5),
    (Coefficient::RollingMoment, Variable::YawRate, 0.0, 2.0),
    (Coefficient::RollingMoment, Variable::Aileron, 0.01, 0.8),
    (Coefficient::RollingMoment, Variable::Rudder, 0.0, 0.3),
    (Coefficient::YawingMoment, Variable::Beta, 0.0, 1.0),
    (Coefficient::YawingMoment, Variable::YawRate, 0.0, 3.0),
    (Coefficient::YawingMoment, Variable::Aileron, 0.0, 0.4),
    (Coefficient::YawingMoment, Variable::Rudder, 0.005, 0.6),
];

/// Derivatives of a size that no aeroplane has. Wrong units of a surface, of inertia or of a length show here.
pub(super) fn sizes(derivatives: &Derivatives) -> Vec<VerdictReason> {
    let wrong = |&(coefficient, variable, smallest, largest): &(Coefficient, Variable, f64, f64)| {
        let found = derivatives.find(coefficient, variable)?;
        let large = found.surely_larger(largest);
        let small = found.surely_below(smallest) && found.surely_above(-smallest);
        if !large && !small {
            return None;
        }
        let inertia = match coefficient {
            Coefficient::PitchingMoment => "[aircraft] iyy",
            Coefficient::RollingMoment => "[aircraft] ixx",
            Coefficient::YawingMoment => "[aircraft] izz",
            _ => "[aircraft] mass",
        };
        let key = inertia.trim_start_matches("[aircraft] ");
        Some(reason(
            false,
            &found.concerns(&[inertia, variable.name()]),
            format!(
                "{} is {}, {} than any aeroplane's ({} is the limit). Check the unit of `{}` (deg or rad), {key} and the \
                 lengths under [aircraft].",
                found.words(),
                found.number(),
                if large { "larger" } else { "smaller" },
                if large { largest } else { smallest },
                variable.name().trim_end_matches("_hat")
            ),
        ))
    };
    SIZES.iter().filter_map(wrong).collect()
}

/// The drag of the build-up at the flown point has to be above zero: an aeroplane that gains energy from the air at rest
/// does not exist.
pub(super) fn drag(derivatives: &Derivatives) -> Option<VerdictReason> {
    let found = derivatives.0.iter().find(|d| d.coefficient == Coefficient::Drag && d.variable.is_none())?;
    found.surely_below(0.0).then(|| {
        reason(
            true,
            &found.concerns(&["[aircraft] thrust", "ax"]),
            format!(
                "The drag coefficient of the estimates is {} where the flight was flown: below zero. Check thrust under \
                 [aircraft] (pounds read as newtons are 4.4 times too small), ax and its sign, and the offset of alpha.",
                found.number()
            ),
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn one(coefficient: Coefficient, variable: Variable, value: f64, std_error: f64) -> Derivative {
        let name = format!("{}_{}", coefficient.symbol(), variable.short_name());
        let random_std = std_error;
        Derivative {
            coefficient,
            variable: Some(variable),
            names: vec![name],
            value,
            std_error,
            random_std,
            bounds: None,
        }
    }

    /// Signs and sizes of JSBSim's c182, with the signs of the surfaces of docs/units-and-signs.md.
    fn sound() -> Derivatives {
        use Coefficient::{Lift, PitchingMoment, RollingMoment, SideForce, YawingMoment};
        use Variable::{Aileron, Alpha, Beta, Elevator, PitchRate, RollRate, Rudder, YawRate};
        Derivatives(vec![
            one(Lift, Alpha, 5.5, 0.05),
            one(Lift, Elevator, 0.43, 0.05),
            one(PitchingMoment, Alpha, -0.84, 0.02),
            one(PitchingMoment, PitchRate, -19.6, 1.0),
            one(PitchingMoment, Elevator, -0.62, 0.02),
            one(SideForce, Beta, -0.43, 0.02),
            one(RollingMoment, Beta, -0.11, 0.01),
            one(RollingMoment, RollRate, -0.49, 0.02),
            one(RollingMoment, Aileron, -0.15, 0.01),
            one(YawingMoment, Beta, 0.06, 0.005),
            one(YawingMoment, YawRate, -0.095, 0.01),
            one(YawingMoment, Rudder, -0.065, 0.003),
        ])
    }

    fn with(coefficient: Coefficient, variable: Variable, value: f64, std_error: f64) -> Derivatives {
        let mut all = sound();
        all.0.retain(|d| d.coefficient != coefficient || d.variable != Some(variable));
        all.0.push(one(coefficient, variable, value, std_error));
        all
    }

    const WING: Body = Body {
        mass: 1034.0,
        ixx: None,
        iyy: 1913.0,
        izz: None,
        ixz: None,
        wing_area: 16.17,
        mean_chord: 1.494,
        wing_span: Some(10.91),
    };

    fn flown() -> Flown {
        Flown { mach: Some(0.18), largest_alpha: Some(0.1), ..Flown::default() }
    }

    /// A lifting body whose chord is its length, 11.4 m: 55 times its elevator's moment is still one that other aeroplanes have.
    #[test]
    fn an_elevator_in_degrees_called_radians_has_an_arm_that_none_has() {
        let body = Body { wing_area: 30.7, mean_chord: 11.4, wing_span: Some(5.8), ..WING };
        let of = |moment: f64, std_error: f64| {
            Derivatives(vec![
                one(Coefficient::Lift, Variable::Alpha, 1.24, 0.09),
                one(Coefficient::PitchingMoment, Variable::Elevator, moment, std_error),
            ])
        };
        let found = elevator_arm(&of(-3.65, 0.32), &body).unwrap();
        assert_eq!(sizes(&of(-3.65, 0.32)), []);
        assert!(
            found.sentence.contains("34 m") && found.concerns.contains(&"elevator".to_owned()),
            "{}",
            found.sentence
        );
        // What is not known well says nothing, and the true value is none.
        assert_eq!(elevator_arm(&of(-3.65, 1.2), &body), None);
        assert_eq!(elevator_arm(&of(-0.066, 0.006), &body), None);
    }

    #[test]
    fn a_sound_aircraft_raises_nothing() {
        let (all, flown) = (sound(), flown());
        assert_eq!((signs(&all, &flown), sizes(&all)), (Vec::new(), Vec::new()));
        assert_eq!((lift_slope(&all, &flown, &WING), drag(&all)), (None, None));
        assert_eq!(elevator_arm(&all, &WING), None);
    }

    #[test]
    fn each_reversed_sign_is_named_with_its_line() {
        let reversed = [
            (Coefficient::Lift, Variable::Alpha, -5.5, "`scale = -1`", EstimationStatus::Refused),
            (Coefficient::PitchingMoment, Variable::PitchRate, 1.05, "damps pitching", EstimationStatus::Refused),
            (Coefficient::PitchingMoment, Variable::Elevator, 0.62, "elevator = { header", EstimationStatus::Doubtful),
            (Coefficient::SideForce, Variable::Beta, 0.43, "`scale = -1`", EstimationStatus::Doubtful),
            (Coefficient::RollingMoment, Variable::RollRate, 0.49, "damps rolling", EstimationStatus::Refused),
            (Coefficient::RollingMoment, Variable::Aileron, 0.15, "aileron = { header", EstimationStatus::Doubtful),
            (Coefficient::YawingMoment, Variable::YawRate, 0.095, "damps yawing", EstimationStatus::Doubtful),
            (Coefficient::YawingMoment, Variable::Rudder, 0.065, "rudder = { header", EstimationStatus::Doubtful),
        ];
        for (coefficient, variable, value, words, status) in reversed {
            let found = signs(&with(coefficient, variable, value, 0.01), &flown());
            let [only] = found.as_slice() else { panic!("{variable:?}: {found:?}") };
            assert_eq!((only.code, only.status), (ReasonCode::Sign, status), "{variable:?}");
            assert!(only.sentence.contains(words), "{}", only.sentence);
            // Two sigma are not enough.
            assert_eq!(signs(&with(coefficient, variable, value, 0.5 * value.abs()), &flown()), []);
        }
        // Beyond the stall a wing may do so.
        let stalled = Flown { largest_alpha: Some(0.5), ..flown() };
        let found = signs(&with(Coefficient::RollingMoment, Variable::RollRate, 0.49, 0.01), &stalled);
        assert_eq!(found[0].status, EstimationStatus::Doubtful);
    }

    #[test]
    fn bounds_above_zero_declare_a_canard() {
        let mut all = with(Coefficient::PitchingMoment, Variable::Elevator, 0.62, 0.01);
        all.0.last_mut().unwrap().bounds = Some([0.0, 2.0]);
        assert_eq!(signs(&all, &flown()), []);
    }

    #[test]
    fn the_lift_slope_is_held_against_the_aspect_ratio() {
        let slope = |value: f64, flown: &Flown, body: &Body| {
            lift_slope(&with(Coefficient::Lift, Variable::Alpha, value, 0.02), flown, body).map(|r| r.status)
        };
        // Knots read as metres per second, a mass in pounds, and both the other way.
        let (doubtful, refused) = (Some(EstimationStatus::Doubtful), Some(EstimationStatus::Refused));
        assert_eq!(slope(5.5 * 0.2646, &flown(), &WING), doubtful);
        assert_eq!(slope(5.5 * 0.1, &flown(), &WING), refused);
        assert_eq!(slope(5.5 * 2.2046, &flown(), &WING), doubtful);
        assert_eq!(slope(5.5 * 10.0, &flown(), &WING), refused);
        // A fighter of aspect ratio 3.75 with its mass in pounds.
        let fighter = Body { wing_span: Some(7.79), ..WING };
        assert_eq!((slope(2.86, &flown(), &fighter), slope(6.34, &flown(), &fighter)), (None, doubtful));
        // A delta of aspect ratio 2 has less than half of it, and a transport at Mach 0.8 more.
        let delta = Body { wing_span: Some(5.7), ..WING };
        assert_eq!(slope(2.3, &flown(), &delta), None);
        assert_eq!(slope(7.4, &Flown { mach: Some(0.8), ..flown() }, &WING), None);
        assert_eq!(slope(1.5, &flown(), &Body { wing_span: None, ..WING }), None);
        assert_eq!(slope(55.0, &Flown { mach: Some(1.5), ..flown() }, &WING), None);
    }

    #[test]
    fn the_roll_damping_is_held_against_the_aspect_ratio() {
        let damping = |value: f64, body: &Body| {
            roll_damping(&with(Coefficient::RollingMoment, Variable::RollRate, value, 0.01), &flown(), body)
        };
        // Aspect ratio 7.4: -0.57 by the formula; moments of inertia three times too large or too small.
        assert_eq!(damping(-0.49, &WING), None);
        assert!(damping(-0.49 * 3.0, &WING).unwrap().sentence.contains("ixx") && damping(-0.49 / 3.0, &WING).is_some());
        let delta = Body { wing_span: Some(5.7), ..WING };
        assert_eq!((damping(-0.15, &delta), damping(-0.15, &Body { wing_span: None, ..WING })), (None, None));
    }

    #[test]
    fn a_side_acceleration_in_g_shows_in_the_arm_of_the_fin() {
        let side = |value: f64| fin_arm(&with(Coefficient::SideForce, Variable::Beta, value, 0.002));
        assert_eq!(side(-0.43), None);
        let found = side(-0.43 / 9.80665).unwrap();
        assert!(found.sentence.contains("ay") && found.concerns.contains(&"CY_beta".to_owned()), "{}", found.sentence);
        // 0.92 spans by numbers of which each is known to 7 %, as a declared inertia and airspeed leave them.
        let mut barely = with(Coefficient::SideForce, Variable::Beta, -0.1065, 0.0059);
        barely.0.retain(|d| d.coefficient != Coefficient::YawingMoment || d.variable != Some(Variable::Beta));
        barely.0.push(one(Coefficient::YawingMoment, Variable::Beta, 0.0984, 0.0075));
        assert!(fin_arm(&barely).is_some());
        // Not known well enough to say so.
        assert_eq!(fin_arm(&with(Coefficient::SideForce, Variable::Beta, -0.044, 0.02)), None);
        // Another channel under the name of ay.
        assert!(side(0.001).unwrap().sentence.contains("no side force"));
    }

    /// The lateral derivatives and inertia of JSBSim's t6texan2, with both signs of its product of inertia.
    #[test]
    fn a_product_of_inertia_of_the_wrong_sign_is_named() {
        use Coefficient::{RollingMoment, YawingMoment};
        let found = |ixz: f64, p: f64, aileron: f64| {
            let all = Derivatives(vec![
                one(RollingMoment, Variable::RollRate, -0.52, 0.03),
                one(RollingMoment, Variable::Aileron, -0.30, 0.02),
                one(YawingMoment, Variable::RollRate, p, 0.015),
                one(YawingMoment, Variable::Aileron, aileron, 0.01),
            ]);
            product_of_inertia(&all, &Body { ixx: Some(5716.5), ixz: Some(ixz), ..WING })
        };
        assert!(found(-1355.8, -0.243, -0.141).unwrap().sentence.contains("Check ixz"));
        assert_eq!(found(1355.8, 0.0006, 0.0006), None);
        // The right sign, a product that is too small to matter, adverse yaw of its own.
        assert_eq!(found(1355.8, -0.243, -0.141), None);
        assert_eq!(found(-135.0, -0.024, -0.014), None);
        assert_eq!(found(-1355.8, -0.03, 0.02), None);
    }

    #[test]
    fn sizes_beyond_those_of_aeroplanes_name_the_surface_and_the_inertia() {
        // An elevator in degrees that was read as radians, and the other way round.
        let found = sizes(&with(Coefficient::PitchingMoment, Variable::Elevator, -0.62 / 57.3, 1e-4));
        assert!(found[0].sentence.contains("smaller") && found[0].concerns.contains(&"elevator".to_owned()));
        let found = sizes(&with(Coefficient::PitchingMoment, Variable::Elevator, -0.62 * 57.3, 0.5));
        assert!(found[0].sentence.contains("larger") && found[0].concerns.contains(&"[aircraft] iyy".to_owned()));
        assert_eq!(sizes(&with(Coefficient::PitchingMoment, Variable::Elevator, -7.0, 0.5)), []);
    }

    #[test]
    fn terms_are_summed_where_the_flight_was_flown() {
        let piece = |text: &str, value: f64, std_error: f64, place: usize| Piece {
            coefficient: Coefficient::Drag,
            term: Term::parse(text, &[]).unwrap(),
            name: format!("CD_{text}"),
            value,
            std_error,
            random_std: std_error,
            place,
            bounds: None,
        };
        let pieces = [piece("1", 0.02, 0.001, 0), piece("alpha", -0.6, 0.0, 1), piece("alpha^2", 1.0, 0.02, 2)];
        let own: Vec<&Piece> = pieces.iter().collect();
        let mut flown = flown();
        flown.variables[Variable::Alpha.index()] = 0.1;
        let correlation = vec![vec![1.0, 0.0, 0.5], vec![0.0, 1.0, 0.0], vec![0.5, 0.0, 1.0]];
        let cd = derivative(&own, Coefficient::Drag, None, &correlation, &flown).unwrap();
        // 0.02 - 0.06 + 0.01; the variance 1e-6 + (0.01 0.02)^2 + 2 0.5 0.001 0.01 0.02.
        assert!((cd.value + 0.03).abs() < 1e-12 && (cd.std_error.powi(2) - 1.24e-6).abs() < 1e-12, "{cd:?}");
        assert_eq!(drag(&Derivatives(vec![cd])).unwrap().status, EstimationStatus::Refused);
        let slope = derivative(&own, Coefficient::Drag, Some(Variable::Alpha), &correlation, &flown).unwrap();
        assert!((slope.value + 0.4).abs() < 1e-12 && slope.names == ["CD_alpha", "CD_alpha^2"], "{slope:?}");
        assert_eq!(derivative(&own, Coefficient::Drag, Some(Variable::Beta), &correlation, &flown), None);
    }
}
