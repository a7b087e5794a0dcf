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

/// Standard errors of both that the values may be apart, so that the result is not doubtful ...
const APART: f64 = 3.5;
/// ... and claimed standard errors of the result, with what is declared, that they may be apart. Of 208 flights of JSBSim without a change in
/// flight and with gusts of a point, or none, five are further apart in both, and in three of these a number is off by more than three of the claimed
/// errors (docs/field.md).
const OUTSIDE: f64 = 2.0;
/// Standard errors of both from which the difference belongs to the bound: one value of twenty that is right is as far apart by chance, and its bound is
/// wider than it had to be. With 2.5 twice as many flights in air that turns keep a number that is silently wrong (docs/field.md).
const BEYOND_CHANCE: f64 = 2.0;

/// A parameter with its value from what the surfaces made.
struct Pair<'a> {
    parameter: usize,
    other: &'a OtherValue,
    /// The difference in the parameter's unit, and in standard errors of both.
    difference: f64,
    apart: f64,
}

/// The derivatives that the flight has told something of, the furthest apart first. Constants are left out: those of a filter are the ones of the end.
fn pairs<'a>(
    parameters: &[ParameterResult],
    by_surfaces: &'a [OtherValue],
    is_constant: impl Fn(&str) -> bool,
) -> Vec<Pair<'a>> {
    let pair = |other: &'a OtherValue| {
        let parameter = parameters.iter().position(|p| p.name == other.name)?;
        let found = &parameters[parameter];
        let counts = matches!(found.status, FinalStatus::Converged | FinalStatus::Improving);
        if !counts || found.nuisance || is_constant(&found.name) {
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
    is_constant: impl Fn(&str) -> bool,
) -> Option<VerdictReason> {
    let mut pairs = pairs(parameters, by_surfaces, is_constant);
    pairs.retain(|pair| {
        pair.apart > APART && pair.difference > OUTSIDE * parameters[pair.parameter].corrected_std_error
    });
    let first = pairs.first()?;
    let found = &parameters[first.parameter];
    let others = match pairs.len() {
        1 => String::new(),
        2 => " One parameter more differs as much.".to_owned(),
        n => format!(" {} parameters more differ as much.", n - 1),
    };
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

/// Adds differences that are hardly by chance to the bounds of the derivatives, and every difference where `is_bent` says that something that lasts bends
/// the derivatives of a coefficient; and says of which.
pub(super) fn widen(
    parameters: &mut [ParameterResult],
    by_surfaces: &[OtherValue],
    is_constant: impl Fn(&str) -> bool,
    is_bent: impl Fn(&str) -> bool,
) -> Option<String> {
    let mut pairs = pairs(parameters, by_surfaces, is_constant);
    pairs.retain(|pair| pair.apart > BEYOND_CHANCE || is_bent(&pair.other.name));
    pairs.sort_by_key(|pair| pair.parameter);
    for pair in &pairs {
        let found = &mut parameters[pair.parameter];
        found.corrected_std_error = found.corrected_std_error.hypot(pair.difference);
        found.lower = found.value - found.bound();
        found.upper = found.value + found.bound();
    }
    let names: Vec<&str> = pairs.iter().map(|pair| pair.other.name.as_str()).collect();
    (!names.is_empty()).then(|| {
        format!(
            "The random part of the bounds of {} holds the difference to the values from the part of the motion that the surfaces \
             made: chance alone seldom makes it, and gusts that turn the air do.",
            names.join(", ")
        )
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
        let said = |(parameters, other): (Vec<ParameterResult>, Vec<OtherValue>), constant: bool| {
            reason(Method::Smpe, &parameters, &other, |_| constant)
        };
        let found = said(of(0.03, 0.0, 1.25, 0.04), false).expect("five errors apart");
        assert_eq!((found.code, found.status), (ReasonCode::MethodsDisagree, EstimationStatus::Doubtful));
        assert_eq!(found.concerns, ["Cl_p"]);
        assert!(found.sentence.starts_with("Cl_p is 1.000 +- 0.030 by smpe, and 1.250 +- 0.040 from the part"));
        assert!(said(of(0.03, 0.0, 1.17, 0.04), false).is_none(), "3.4 errors");
        assert!(said(of(0.03, 0.2, 1.25, 0.04), false).is_none(), "within what the result claims");
        assert!(said(of(0.03, 0.0, 1.25, 0.04), true).is_none(), "a constant");
        assert!(
            said(of(0.03, 0.0, f64::NAN, 0.04), false).is_none()
                && said(of(f64::NAN, 0.0, 1.25, 0.04), false).is_none()
        );
    }

    #[test]
    fn a_difference_beyond_chance_belongs_to_the_bound() {
        let (mut parameters, other) = of(0.03, 0.04, 1.11, 0.04);
        let sentence = widen(&mut parameters, &other, |_| false, |_| false).expect("2.2 errors apart");
        assert!(sentence.starts_with("The random part of the bounds of Cl_p holds"), "{sentence}");
        let found = &parameters[0];
        assert!((found.corrected_std_error - 0.05_f64.hypot(0.11)).abs() < 1e-12);
        assert!((found.random_std() - 0.03_f64.hypot(0.11)).abs() < 1e-12);
        assert!((found.upper - found.lower - 4.0 * found.corrected_std_error).abs() < 1e-12);
        let (mut parameters, other) = of(0.03, 0.04, 1.09, 0.04);
        assert_eq!(widen(&mut parameters, &other, |_| false, |_| false), None);
        assert!((parameters[0].corrected_std_error - 0.05).abs() < 1e-12);
        // A smaller one where something that lasts is known to bend the coefficient.
        assert!(widen(&mut parameters, &other, |_| false, |name| name == "Cl_p").is_some());
        assert!((parameters[0].corrected_std_error - 0.05_f64.hypot(0.09)).abs() < 1e-12);
    }
}
