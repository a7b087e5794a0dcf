//! Whether two methods give the same parameters from the same record.
//!
//! Output error takes all that is not noise of the sensors for motion that its model makes, so that gusts, a model that is
//! not quite right, and noise on a surface bend its parameters without a trace in its bounds. Equation error takes the states
//! as measured, and solves each equation by itself, so that a sensor that is late bends it, equally without a trace, and
//! output error with measured air data likewise. A filter weighs both. Where the model and the sensors are right all are
//! right, and differ by no more than their errors (after J. A. Hausman, *Specification Tests in Econometrics*, Econometrica
//! 46, 1978; the errors are added, because no method is efficient with coloured residuals, and they are taken without what
//! the model file declares, which is the same for all).

use crate::core::estimation::{
    EstimationStatus, FinalStatus, OtherValue, ParameterResult, ReasonCode, SecondAnswer, VerdictReason,
};
use crate::core::method::Method;
use crate::core::number::significant;

/// Standard errors that a method and equation error may be apart. Of 189 flights of JSBSim without a change (output error,
/// docs/field.md) eight are further apart, and in five of these a number is off by more than four of the errors that output
/// error claims.
const FROM_EQUATION_ERROR: f64 = 5.0;
/// Standard errors that equation error and the filter beside it may be apart. Of 214 flights of JSBSim without a change six are
/// further apart in the time domain, none of which is wrong. In a band 27 are, and in 22 of these a number is off by more than
/// three of its random errors (docs/field.md).
const FROM_FILTER: f64 = 4.5;

/// Standard errors that a filter and equation error beside it may be apart. Of 191 flights of JSBSim without a change that SMPE or
/// the EKF calls sound otherwise four and three are further apart, and they are three of the four in which a number is off by more
/// than four of the errors that the filter claims (docs/field.md). The HFB-320's C_m_q is 4.9 apart, and there the filter is the better one.
const OF_FILTER: f64 = 6.0;

/// Standard errors that a method and this one beside it may be apart.
fn limit(first: Method, second: Method) -> f64 {
    match second.is_equation_error() {
        true if first.is_batch() => FROM_EQUATION_ERROR,
        true => OF_FILTER,
        false => FROM_FILTER,
    }
}

/// What the user can do about it.
fn advice(first: Method, second: Method) -> &'static str {
    if second.is_equation_error() && first.is_batch() {
        "gusts, a missing term or noise on a surface bend them in different ways. Look at the residuals, try filter-error, or \
         use the values of equation-error where it gives no reason to doubt."
    } else if second.is_equation_error() {
        "a filter that met values far from those of its start, a missing term, gusts or a sensor that is late bend them in \
         different ways. Use the values of equation-error or output-error where they give no reason to doubt, or start the \
         filter from them (`start` in the model file); look for delays with `phugoid compatibility`."
    } else if matches!(first, Method::OutputError | Method::FilterError) {
        "a change of the aircraft in flight, which the one takes into one value for before and after it, a sensor that is late, a missing \
         term or gusts bend them in different ways, and either of the two may be the wrong one. Look for changes with smpe and for \
         delays with `phugoid compatibility`, and estimate the time before and after a change by itself."
    } else if first.is_recursive_regression() {
        "the regression weighs slow errors, of its smoothed states and of the model, more than a filter does. Use the values \
         of smpe or equation-error where they give no reason to doubt."
    } else {
        "a sensor that is late, above all the vane of the angle of attack, a missing term, a change of the aircraft in flight or \
         gusts bend them in different ways, and either of the two may be the wrong one. Look for delays with `phugoid compatibility` and for terms that the \
         equations ask for, and compare with filter-error."
    }
}

/// Whether derivatives are compared that are improving: of what a filter stands beside in the time domain.
fn is_asked_while_improving(first: Method, second: Method) -> bool {
    !second.is_equation_error() && matches!(first, Method::EquationError | Method::OutputError | Method::FilterError)
}

/// A parameter that is compared, by both methods.
struct Pair<'a> {
    found: &'a ParameterResult,
    /// Its value without what the flight says of declared errors.
    value: f64,
    random: f64,
    other: &'a OtherValue,
    /// The difference in standard errors.
    apart: f64,
}

/// The reason that the method beside this one gives other values; none if it does not, or gives none. Compared are parameters that
/// count as converged; where a filter stands beside a method in the time domain also derivatives that are improving.
pub(super) fn reason<'a>(
    method: Method,
    parameters: &'a [ParameterResult],
    answer: &'a SecondAnswer,
    is_constant: impl Fn(&str) -> bool,
) -> Option<VerdictReason> {
    // What a change in flight does to a regression makes its bounds wide as well, so that little of it counts as converged. The
    // constants of a filter are those of the last seconds, and of a regression those of the whole flight.
    let is_claimed = |found: &ParameterResult| match found.status {
        FinalStatus::Converged => true,
        FinalStatus::Improving => is_asked_while_improving(method, answer.method) && !is_constant(&found.name),
        _ => false,
    };
    let pair = |other: &'a OtherValue| {
        let found = parameters.iter().find(|p| p.name == other.name)?;
        // What is declared of systematic errors, and what corrections leave, is the same for both.
        let random = found.random_std();
        // The other method does not know what the flight says of declared errors.
        let value = found.value - found.learnt_shift;
        let apart = (value - other.value).abs() / random.hypot(other.std_error);
        let counts = !found.nuisance && is_claimed(found) && apart > limit(method, answer.method);
        counts.then_some(Pair { found, value, random, other, apart })
    };
    let mut pairs: Vec<Pair<'_>> = answer.values.iter().filter_map(pair).collect();
    pairs.sort_by(|a, b| b.apart.total_cmp(&a.apart));
    let Pair { found, value, random, other, apart } = pairs.first()?;
    let others = others_differ(pairs.len());
    Some(VerdictReason {
        code: ReasonCode::MethodsDisagree,
        status: EstimationStatus::Doubtful,
        concerns: pairs.iter().map(|pair| pair.found.name.clone()).collect(),
        sentence: format!(
            "{} is {} +- {} by {method} and {} +- {} by {}, {apart:.1} of their errors apart.{others} With a model and sensors \
             that are right they agree: {}",
            found.name,
            significant(*value, 4),
            significant(*random, 2),
            significant(other.value, 4),
            significant(other.std_error, 2),
            answer.method,
            advice(method, answer.method),
        ),
    })
}

/// How many parameters differ beside the one that is named, of `count` in all.
pub(super) fn others_differ(count: usize) -> String {
    match count {
        0 | 1 => String::new(),
        2 => " One parameter more differs as much.".to_owned(),
        n => format!(" {} parameters more differ as much.", n - 1),
    }
}

/// Standard errors that a value has to lie from zero, so that its sign is known.
const SIGN_KNOWN: f64 = 3.0;

/// Whether the method beside this one gives a parameter the sign that no aeroplane has, and this one does not: then it is no witness.
/// `is_mirrored` says whether a value of a parameter, with one sigma, has such a sign.
pub(super) fn is_mirror_image(
    parameters: &[ParameterResult],
    answer: &SecondAnswer,
    is_mirrored: impl Fn(&str, f64, f64) -> bool,
) -> bool {
    answer.values.iter().any(|other| {
        let own = parameters.iter().find(|p| p.name == other.name);
        is_mirrored(&other.name, other.value, other.std_error)
            && own.is_some_and(|own| !is_mirrored(&own.name, own.value, own.random_std()))
    })
}

/// A reason that speaks of a sign that no aeroplane has, said rightly where the method beside this one gives the parameter the sign that
/// aeroplanes have: a sign that is reversed in the record is so for both.
pub(super) fn of_sign(
    method: Method,
    parameters: &[ParameterResult],
    answer: Option<&SecondAnswer>,
    is_mirrored: impl Fn(&str, f64, f64) -> bool,
    reason: VerdictReason,
) -> VerdictReason {
    let of_parameter = |name: &String| {
        let own = parameters.iter().find(|p| p.name == *name)?;
        let other = answer?.values.iter().find(|v| v.name == *name)?;
        let differs = is_mirrored(name, own.value, own.random_std())
            && other.value * own.value < 0.0
            && other.value.abs() > SIGN_KNOWN * other.std_error;
        differs.then_some((own, other, answer?.method))
    };
    let found = (reason.code == ReasonCode::Sign).then(|| reason.concerns.iter().find_map(of_parameter)).flatten();
    let Some((own, other, second)) = found else { return reason };
    VerdictReason {
        concerns: vec![own.name.clone()],
        sentence: format!(
            "{} is {} +- {} by {method}, a sign that no aeroplane has, and {} +- {} by {second}. A sign that is reversed in the record \
             would be so for both: {method} ran into a solution with the opposite sign, as it can in gusts. Use filter-error, or the \
             values of {second} where it gives no reason to doubt.",
            own.name,
            significant(own.value, 4),
            significant(own.random_std(), 2),
            significant(other.value, 4),
            significant(other.std_error, 2),
        ),
        ..reason
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sign_that_the_method_alone_has_is_no_reversed_channel() {
        let own = |value: f64| ParameterResult { value, ..found(0.1, 0.0, false) };
        let mirrored = |_: &str, value: f64, _: f64| value < 0.0;
        let answer = |value: f64| SecondAnswer {
            method: Method::EquationError,
            values: vec![OtherValue { name: "CL_q".to_owned(), value, std_error: 0.2 }],
        };
        let said = |value: f64, other: f64| {
            let reason = VerdictReason {
                code: ReasonCode::Sign,
                status: EstimationStatus::Refused,
                concerns: vec!["CL_q".to_owned(), "alpha".to_owned()],
                sentence: "write `scale = -1`".to_owned(),
            };
            of_sign(Method::Smpe, &[own(value)], Some(&answer(other)), mirrored, reason)
        };
        let found = said(-2.0, 5.0);
        assert_eq!((found.status, found.concerns), (EstimationStatus::Refused, vec!["CL_q".to_owned()]));
        assert!(found.sentence.starts_with("CL_q is -2.000 +- 0.10 by smpe, a sign that no aeroplane has, and 5.000"));
        // Both have it, or the other one is not known.
        assert!([-3.0, 0.3].iter().all(|other| said(-2.0, *other).sentence.contains("scale = -1")));
        // The same, asked of equation error with the filter beside it.
        let is_image = |own_value: f64, other: f64| is_mirror_image(&[own(own_value)], &answer(other), mirrored);
        assert!(is_image(5.0, -2.0) && !is_image(-2.0, -2.0) && !is_image(5.0, 2.0));
    }

    /// A parameter of 1.0 by a method, with a random and a declared part of its error.
    fn found(random: f64, systematic: f64, nuisance: bool) -> ParameterResult {
        ParameterResult {
            std_error: random,
            corrected_std_error: random.hypot(systematic),
            systematic_std: systematic,
            nuisance,
            ..ParameterResult::for_tests("CL_q")
        }
    }

    /// What is said where another method gives this value.
    fn said(method: Method, found: ParameterResult, second: (Method, f64, f64)) -> Option<VerdictReason> {
        let value = |value, std_error| OtherValue { name: "CL_q".to_owned(), value, std_error };
        let (second, v, std) = second;
        reason(method, &[found], &SecondAnswer { method: second, values: vec![value(v, std)] }, |_| false)
    }

    /// Output error, with the value by equation error.
    fn asked(random: f64, systematic: f64, other: f64, other_std: f64, nuisance: bool) -> Option<VerdictReason> {
        let second = (Method::EquationError, other, other_std);
        said(Method::OutputError, found(random, systematic, nuisance), second)
    }

    #[test]
    fn two_methods_that_differ_by_more_than_their_errors_are_said() {
        let found = asked(0.03, 0.0, 1.3, 0.04, false).expect("six errors apart");
        assert_eq!((found.code, found.status), (ReasonCode::MethodsDisagree, EstimationStatus::Doubtful));
        assert!(
            found
                .sentence
                .starts_with("CL_q is 1.000 +- 0.030 by output-error and 1.300 +- 0.040 by equation-error, 6.0")
        );
        // Within five errors; of a bias of a sensor; and where there is no other value.
        assert!(asked(0.03, 0.0, 1.2, 0.04, false).is_none());
        assert!(asked(0.03, 0.0, 1.3, 0.04, true).is_none());
        assert!(asked(0.03, 0.0, f64::NAN, 0.04, false).is_none());
        // A declared scale is the same error of both, and does not make them agree.
        assert!(asked(0.03, 0.5, 1.3, 0.04, false).is_some());
    }

    #[test]
    fn a_derivative_that_is_improving_counts_where_a_change_in_flight_makes_its_bound_wide() {
        let improving = || ParameterResult { status: FinalStatus::Improving, ..found(0.03, 0.0, false) };
        let by = |method, is_constant: bool| {
            let values = vec![OtherValue { name: "CL_q".to_owned(), value: 1.3, std_error: 0.04 }];
            reason(method, &[improving()], &SecondAnswer { method: Method::Smpe, values }, |_| is_constant)
        };
        assert!(by(Method::EquationError, false).is_some());
        assert!(by(Method::EquationError, true).is_none());
        // In a band, and by methods with another one beside them, the difference of what is improving was not measured.
        assert!(by(Method::EquationErrorFrequency, false).is_none());
    }

    #[test]
    fn equation_error_is_held_against_the_filter_beside_it() {
        let by_filter =
            |value| said(Method::EquationErrorFrequency, found(0.03, 0.0, false), (Method::Smpe, value, 0.04));
        let reason = by_filter(1.24).expect("4.8 errors apart");
        assert_eq!((reason.code, reason.concerns.as_slice()), (ReasonCode::MethodsDisagree, &["CL_q".to_owned()][..]));
        assert!(
            reason.sentence.starts_with(
                "CL_q is 1.000 +- 0.030 by equation-error-frequency and 1.240 +- 0.040 by smpe, 4.8 of their errors apart."
            ),
            "{}",
            reason.sentence
        );
        // It is no advice to take the values that are in doubt.
        assert!(reason.sentence.contains("late") && !reason.sentence.contains("use the values of equation-error"));
        assert!(by_filter(1.22).is_none());
    }

    #[test]
    fn a_recursive_regression_is_held_against_the_filter_too() {
        let by_filter = |value| said(Method::Rls, found(0.03, 0.0, false), (Method::Smpe, value, 0.04));
        let reason = by_filter(1.24).expect("4.8 errors apart");
        assert!(
            reason.sentence.ends_with("Use the values of smpe or equation-error where they give no reason to doubt.")
        );
        assert!(by_filter(1.22).is_none());
    }
}
