//! The verdict on each parameter in words: whether its value can be used, why, and what input would help.

use phugoid_estimators::verdict::Reason;

use crate::core::estimation::ParameterReadiness;
use crate::judge::advice::{to_excite, to_separate};
use crate::methods::ColumnVerdict;
use crate::model_file::Parameter;

/// The verdict on one of the estimated `parameters`, which are in the order of the columns.
pub(crate) fn readiness(
    column: usize,
    found: &ColumnVerdict,
    parameters: &[&Parameter],
    extra_inputs: &[String],
) -> ParameterReadiness {
    let verdict = &found.verdict;
    let partners: Vec<(&Parameter, f64)> = verdict
        .partners
        .iter()
        .flatten()
        .filter_map(|partner| Some((*parameters.get(partner.column)?, partner.correlation)))
        .collect();
    let role = parameters.get(column).map(|p| &p.role);
    let advice = match (verdict.reason, partners.first(), role) {
        (Reason::Collinear, Some((partner, _)), Some(role)) => Some(to_separate(role, &partner.role)),
        (Reason::NotExcited | Reason::WideBound | Reason::Collinear, _, Some(role)) => to_excite(role, extra_inputs),
        _ => None,
    };
    let names = || partners.iter().map(|(p, _)| p.name.as_str()).collect::<Vec<_>>().join(" and ");
    ParameterReadiness {
        verdict: verdict.readiness,
        reason: reason_words(verdict.reason, &names()),
        advice,
        ready_since_s: found.ready_since_s,
        bound_over_prior: verdict.bound_over_prior,
        excitation: verdict.excitation,
        variance_inflation: verdict.variance_inflation,
        correlated_with: partners.iter().map(|(p, correlation)| (p.name.clone(), *correlation)).collect(),
    }
}

fn reason_words(reason: Reason, partners: &str) -> String {
    let words = match reason {
        Reason::Settled => "the bound is small and the estimate no longer moves",
        Reason::Moving => "it has moved further than its bound allowed",
        Reason::WideBound => "its bound is not small yet",
        Reason::NotExcited => "this input does not move its regressor",
        Reason::Collinear if partners.is_empty() => "only a combination with several others is known",
        Reason::Collinear => return format!("only a combination with {partners} is known"),
        Reason::NoBound => "this method gives no bound",
        Reason::ChangeInDoubt => "a sudden change is suspected",
        Reason::AtLimit => "it lies at one of its limits",
        Reason::ModelContradicted => "too many samples contradict the model",
        Reason::Diverged => "the estimator diverged",
    };
    words.to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model_file::ModelFile;
    use phugoid_estimators::verdict::{ParameterVerdict, Partner, Readiness};

    /// With the built-in F-16 model: columns dCm_alpha, dCm_q, dCL_alpha, dCD_alpha, dCm_elevator, biases.
    #[test]
    fn a_collinear_pair_is_named_with_what_would_separate_it() {
        let file = ModelFile::named("f16").unwrap();
        let parameters: Vec<&Parameter> = file.estimated().collect();
        let position = |name: &str| parameters.iter().position(|p| p.name == name).unwrap();
        let partner = Partner { column: position("dCm_elevator"), correlation: -0.97 };
        let verdict = ParameterVerdict {
            readiness: Readiness::NotIdentifiable,
            reason: Reason::Collinear,
            partners: [Some(partner), None],
            ..ParameterVerdict::default()
        };
        let found = ColumnVerdict { verdict, ready_since_s: None };
        let words = readiness(position("dCm_q"), &found, &parameters, &[]);
        assert_eq!(words.verdict, Readiness::NotIdentifiable);
        assert_eq!(words.reason, "only a combination with dCm_elevator is known");
        assert!(words.advice.unwrap().contains("follows the motion"));
        assert_eq!(words.correlated_with, [("dCm_elevator".to_owned(), -0.97)]);
    }
}
