//! Whether equation error gives the same parameters as a method that integrates the motion.
//!
//! Output error takes all that is not noise of the sensors for motion that its model makes, so that gusts, a model that is
//! not quite right, and noise on a surface bend its parameters without a trace in its bounds. Equation error takes the states
//! as measured, and errs for other reasons. Where the model is right both are right, and differ by no more than their errors
//! (after J. A. Hausman, *Specification Tests in Econometrics*, Econometrica 46, 1978; the errors are added, because neither
//! method is efficient with coloured residuals).

use crate::core::estimation::{
    BatchReport, EstimationStatus, FinalStatus, OtherValue, ParameterResult, ReasonCode, VerdictReason,
};
use crate::core::method::Method;
use crate::core::number::significant;

/// Standard errors that two methods may be apart. Of 189 flights of JSBSim without a change (output error, docs/field.md)
/// eight are further apart, and in five of these a number is off by more than four of the errors that output error claims.
const APART: f64 = 5.0;

/// A parameter that counts as converged, by both methods.
struct Pair<'a> {
    found: &'a ParameterResult,
    random: f64,
    other: &'a OtherValue,
    /// The difference in standard errors.
    apart: f64,
}

/// The reason that equation error gives other values; none if it does not, or gives none.
pub(super) fn reason<'a>(
    method: Method,
    parameters: &'a [ParameterResult],
    report: &'a BatchReport,
) -> Option<VerdictReason> {
    let pair = |other: &'a OtherValue| {
        let found = parameters.iter().find(|p| p.name == other.name)?;
        // What is declared of systematic errors is the same for both.
        let random = (found.corrected_std_error.powi(2) - found.systematic_std.powi(2)).max(0.0).sqrt();
        let apart = (found.value - other.value).abs() / random.hypot(other.std_error);
        let counts = !found.nuisance && found.status == FinalStatus::Converged && apart > APART;
        counts.then_some(Pair { found, random, other, apart })
    };
    let mut pairs: Vec<Pair<'_>> = report.by_equation_error.iter().filter_map(pair).collect();
    pairs.sort_by(|a, b| b.apart.total_cmp(&a.apart));
    let Pair { found, random, other, apart } = pairs.first()?;
    let others = match pairs.len() {
        1 => String::new(),
        2 => " One parameter more differs as much.".to_owned(),
        n => format!(" {} parameters more differ as much.", n - 1),
    };
    Some(VerdictReason {
        code: ReasonCode::MethodsDisagree,
        status: EstimationStatus::Doubtful,
        concerns: pairs.iter().map(|pair| pair.found.name.clone()).collect(),
        sentence: format!(
            "{} is {} +- {} by {method} and {} +- {} by equation error, {apart:.1} of their errors apart.{others} \
             With a model that is right they agree: gusts, a missing term or noise on a surface bend them in different ways. \
             Look at the residuals, try filter-error, or use the values of equation-error where it gives no reason to doubt.",
            found.name,
            significant(found.value, 4),
            significant(*random, 2),
            significant(other.value, 4),
            significant(other.std_error, 2),
        ),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A parameter of 1.0 by the method, with a random and a declared part of its error, and its value by equation error.
    fn asked(random: f64, systematic: f64, other: f64, other_std: f64, nuisance: bool) -> Option<VerdictReason> {
        let found = ParameterResult {
            name: "CL_q".to_owned(),
            unit: "-".to_owned(),
            value: 1.0,
            std_error: random,
            corrected_std_error: random.hypot(systematic),
            systematic_std: systematic,
            correction_std: 0.0,
            systematic_parts: Vec::new(),
            lower: 0.0,
            upper: 2.0,
            status: FinalStatus::Converged,
            converged_at_s: None,
            observability: 1.0,
            initial: 0.0,
            prior_std: 1.0,
            bounds: None,
            truth: None,
            nuisance,
            readiness: None,
        };
        let report = BatchReport {
            iterations: 3,
            cost: 0.0,
            noise_std: Vec::new(),
            unknowns: Vec::new(),
            manoeuvres: Vec::new(),
            equations: Vec::new(),
            by_equation_error: vec![OtherValue { name: "CL_q".to_owned(), value: other, std_error: other_std }],
            band: None,
            prediction: None,
            notes: Vec::new(),
        };
        reason(Method::OutputError, &[found], &report)
    }

    #[test]
    fn two_methods_that_differ_by_more_than_their_errors_are_said() {
        let found = asked(0.03, 0.0, 1.3, 0.04, false).expect("six errors apart");
        assert_eq!((found.code, found.status), (ReasonCode::MethodsDisagree, EstimationStatus::Doubtful));
        assert!(
            found
                .sentence
                .starts_with("CL_q is 1.000 +- 0.030 by output-error and 1.300 +- 0.040 by equation error, 6.0")
        );
        // Within five errors; of a bias of a sensor; and where there is no other value.
        assert!(asked(0.03, 0.0, 1.2, 0.04, false).is_none());
        assert!(asked(0.03, 0.0, 1.3, 0.04, true).is_none());
        assert!(asked(0.03, 0.0, f64::NAN, 0.04, false).is_none());
        // A declared scale is the same error of both, and does not make them agree.
        assert!(asked(0.03, 0.5, 1.3, 0.04, false).is_some());
    }
}
