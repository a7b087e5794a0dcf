//! Whether the part of the motion that the surfaces made gives the same parameters as the whole motion
//! ([`batch::by_surfaces`](crate::batch::by_surfaces())).
//!
//! Gusts that turn the air bend the damping and the effect of the surfaces of every method that takes what an equation leaves over for white,
//! by half and more, and show in none of their bounds. What the surfaces made knows nothing of them, nor of the noise of the measured
//! states. Where both are right they differ by no more than their errors (J. A. Hausman, *Specification Tests in Econometrics*,
//! Econometrica 46, 1978); the errors are added, as in [`agreement`](super::agreement).

use crate::core::estimation::{EstimationStatus, FinalStatus, OtherValue, ParameterResult, ReasonCode, VerdictReason};
use crate::core::method::Method;
use crate::core::number::significant;
use crate::core::term::Variable;
use crate::judge::agreement::others_differ;
use crate::model_file::Role;

/// Standard errors of both that the values may be apart, so that the result is not doubtful: of every derivative, ...
const APART: f64 = 4.0;
/// ... and of those of a moment that something lasting is known to bend (`methods::BySurfaces::bent`).
const APART_WHERE_BENT: f64 = 2.0;
/// Claimed standard errors of the result, with what is declared, that they may be apart in either case. Of 208 healthy flights of JSBSim with gusts of a
/// point, or none, four are further apart, in two of which a number is off by more than three of its claimed errors; of 199 in air that turns 30 are,
/// and of the 13 of these that were silently wrong five are left (docs/field.md; these flights chose the limits).
const OUTSIDE: f64 = 2.0;

/// A parameter with its value from what the surfaces made.
struct Pair<'a> {
    parameter: usize,
    other: &'a OtherValue,
    /// The difference in the parameter's unit, and in standard errors of both.
    difference: f64,
    apart: f64,
}

/// Whether a parameter is compared. Constants of a filter are those of the end; and the airspeed follows its surfaces over tens of seconds, which the
/// lags do not hold.
pub(super) fn is_compared(role: &Role) -> bool {
    match role {
        Role::Term(_, term) => {
            !term.is_constant() && term.powers().all(|(factor, _)| factor != Variable::Airspeed.index())
        }
        Role::Offset(_) | Role::Bias(_) => false,
    }
}

/// The derivatives that the flight has told something of, the furthest apart first; `is_compared` says of which that may be asked.
fn pairs<'a>(
    parameters: &[ParameterResult],
    by_surfaces: &'a [OtherValue],
    is_compared: impl Fn(&str) -> bool,
) -> Vec<Pair<'a>> {
    let pair = |other: &'a OtherValue| {
        let parameter = parameters.iter().position(|p| p.name == other.name)?;
        let found = &parameters[parameter];
        let counts = matches!(found.status, FinalStatus::Converged | FinalStatus::Improving);
        if !counts || found.nuisance || !is_compared(&found.name) {
            return None;
        }
        // The surfaces do not know what the flight says of declared errors, and what is declared is the same for both.
        let difference = (found.value - found.learnt_shift - other.value).abs();
        let apart = difference / found.random_std().hypot(other.std_error);
        apart.is_finite().then_some(Pair { parameter, other, difference, apart })
    };
    let mut pairs: Vec<Pair<'a>> = by_surfaces.iter().filter_map(pair).collect();
    pairs.sort_by(|a, b| b.apart.total_cmp(&a.apart));
    pairs
}

/// The doubt about a result of which derivatives are others than those from what the surfaces made; none if all are the same.
pub(super) fn reason(
    method: Method,
    parameters: &[ParameterResult],
    by_surfaces: &[OtherValue],
    is_compared: impl Fn(&str) -> bool,
    is_bent: impl Fn(&str) -> bool,
) -> Option<VerdictReason> {
    let mut pairs = pairs(parameters, by_surfaces, is_compared);
    pairs.retain(|pair| {
        let limit = if is_bent(&pair.other.name) { APART_WHERE_BENT } else { APART };
        pair.apart > limit && pair.difference > OUTSIDE * parameters[pair.parameter].corrected_std_error
    });
    let first = pairs.first()?;
    let found = &parameters[first.parameter];
    let others = others_differ(pairs.len());
    Some(VerdictReason {
        code: ReasonCode::MethodsDisagree,
        status: EstimationStatus::Doubtful,
        concerns: pairs.iter().map(|pair| pair.other.name.clone()).collect(),
        sentence: format!(
            "{} is {} +- {} by {method}, and {} +- {} from the part of the motion that the surfaces made, {:.1} of their errors apart.{others} \
             Something that lasts moves the aircraft beside its surfaces and bends the one: gusts that turn the air, a missing \
             term, a change in flight, or noise of the measured states. A controller that moves the surfaces after it bends the other. Fly in calmer air, or with larger motions of the surfaces, \
             and compare with output-error, which these gusts bend least.",
            found.name,
            significant(found.value - found.learnt_shift, 4),
            significant(found.random_std(), 2),
            significant(first.other.value, 4),
            significant(first.other.std_error, 2),
            first.apart,
        ),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A derivative of 1.0 with these random and declared errors, and a value of it from what the surfaces made.
    fn of(random: f64, declared: f64, other: f64, other_std: f64) -> (Vec<ParameterResult>, Vec<OtherValue>) {
        let found = ParameterResult {
            std_error: random,
            corrected_std_error: random.hypot(declared),
            systematic_std: declared,
            ..ParameterResult::for_tests("Cl_p")
        };
        (vec![found], vec![OtherValue { name: "Cl_p".to_owned(), value: other, std_error: other_std }])
    }

    #[test]
    fn values_far_from_those_that_the_surfaces_made_are_doubtful() {
        let said = |(parameters, other): (Vec<ParameterResult>, Vec<OtherValue>), compared: bool, bent: bool| {
            reason(Method::Smpe, &parameters, &other, |_| compared, |_| bent)
        };
        let found = said(of(0.03, 0.0, 1.25, 0.04), true, false).expect("five errors apart");
        assert_eq!((found.code, found.status), (ReasonCode::MethodsDisagree, EstimationStatus::Doubtful));
        assert_eq!(found.concerns, ["Cl_p"]);
        assert!(found.sentence.starts_with("Cl_p is 1.000 +- 0.030 by smpe, and 1.250 +- 0.040 from the part"));
        assert!(said(of(0.03, 0.0, 1.19, 0.04), true, false).is_none(), "3.8 errors");
        assert!(said(of(0.03, 0.0, 1.19, 0.04), true, true).is_some(), "where a regression is bent");
        assert!(said(of(0.03, 0.0, 1.09, 0.04), true, true).is_none(), "1.8 errors");
        assert!(said(of(0.03, 0.2, 1.25, 0.04), true, true).is_none(), "within what the result claims");
        assert!(said(of(0.03, 0.0, 1.25, 0.04), false, true).is_none(), "a constant");
        assert!(said(of(0.03, 0.0, f64::NAN, 0.04), true, true).is_none());
        assert!(said(of(f64::NAN, 0.0, 1.25, 0.04), true, true).is_none());
    }
}
