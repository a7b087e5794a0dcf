//! What an estimation says of itself, as counted in the field.

use phugoid_identification::error::EstimateError;
use phugoid_identification::estimation::{Estimation, FinalStatus};
use serde::Serialize;

/// What an estimation says of its own numbers, from the best to the worst.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Standing {
    /// Nothing speaks against the numbers that are called converged.
    Sound,
    /// Nothing speaks against them, but none has converged.
    Provisional,
    /// The user is told to settle something before using the numbers.
    Doubtful,
    /// No numbers, or the user is told not to use them.
    Refused,
}

/// The standing of an estimation, and why; and what it remarks without taking its numbers back.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Word {
    /// What it says of its own numbers.
    pub standing: Standing,
    /// Why it is not sound: words for counting.
    pub reasons: Vec<String>,
    /// Remarks beside the numbers, which leave them standing: words for counting.
    pub remarks: Vec<String>,
}

/// Sentences that take the numbers back, by how they begin.
const REFUSALS: [(&str, &str); 1] = [("The model contradicts this flight", "contradiction")];
/// Sentences that tell the user to look first.
const DOUBTS: [(&str, &str); 1] = [("Check the units", "units")];
/// Sentences beside numbers that stand.
const REMARKS: [(&str, &str); 6] = [
    ("Coloured residuals", "coloured"),
    ("Model error", "model error"),
    ("taken for outliers", "outliers"),
    ("The residuals ask for", "missing term"),
    ("The parameters changed in flight", "change"),
    ("of the noise", "noise"),
];

/// What an estimation says of itself. The only place where sentences are searched.
pub fn standing(estimation: &Estimation) -> Word {
    let said = |table: &[(&str, &str)]| -> Vec<String> {
        let is_said = |words: &str| estimation.verdict.iter().any(|sentence| sentence.contains(words));
        table.iter().filter(|(words, _)| is_said(words)).map(|(_, name)| (*name).to_owned()).collect()
    };
    let (mut refusals, mut doubts) = (said(&REFUSALS), said(&DOUBTS));
    let main = || estimation.parameters.iter().filter(|p| !p.nuisance && p.status != FinalStatus::Fixed);
    if main().any(|p| p.readiness.as_ref().is_some_and(|r| r.reason.contains("diverged"))) {
        refusals.push("diverged".to_owned());
    }
    if main().any(|p| p.status == FinalStatus::AtLimit) {
        doubts.push("at limit".to_owned());
    }
    let remarks = said(&REMARKS);
    let (standing, reasons) = if !refusals.is_empty() {
        (Standing::Refused, refusals)
    } else if !doubts.is_empty() {
        (Standing::Doubtful, doubts)
    } else if main().all(|p| p.status != FinalStatus::Converged) {
        (Standing::Provisional, vec!["not converged".to_owned()])
    } else {
        (Standing::Sound, Vec::new())
    };
    Word { standing, reasons, remarks }
}

/// The word for an estimation that was not made.
pub fn refusal(error: &EstimateError) -> Word {
    let reason = match error {
        EstimateError::MissingChannel { .. } | EstimateError::EmptyChannel(_) => "missing channel",
        EstimateError::TooShort { .. } => "too short",
        EstimateError::Units { .. } => "units",
        EstimateError::Noise(_) => "noise",
        EstimateError::NoExcitation { .. } => "no excitation",
        EstimateError::Batch(_) => "no fit",
        _ => "other",
    };
    Word { standing: Standing::Refused, reasons: vec![reason.to_owned()], remarks: Vec::new() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use phugoid_identification::estimation::ParameterResult;

    fn estimation(status: FinalStatus, sentence: &str) -> Estimation {
        let parameter = ParameterResult {
            name: "Cm_alpha".to_owned(),
            unit: "per rad".to_owned(),
            value: -0.5,
            std_error: 0.01,
            corrected_std_error: 0.01,
            systematic_std: 0.0,
            lower: -0.52,
            upper: -0.48,
            status,
            converged_at_s: None,
            observability: 1.0,
            initial: 0.0,
            prior_std: 1.0,
            bounds: None,
            truth: None,
            nuisance: false,
            readiness: None,
        };
        Estimation { parameters: vec![parameter], verdict: vec![sentence.to_owned()], ..Estimation::default() }
    }

    #[test]
    fn the_worst_word_counts() {
        let of = |status, sentence| standing(&estimation(status, sentence)).standing;
        assert_eq!(of(FinalStatus::Converged, "1 of 1 parameters have converged."), Standing::Sound);
        assert_eq!(of(FinalStatus::Improving, ""), Standing::Provisional);
        assert_eq!(of(FinalStatus::Converged, "Check the units: alpha."), Standing::Doubtful);
        assert_eq!(of(FinalStatus::AtLimit, ""), Standing::Doubtful);
        let contradicted = "The model contradicts this flight: more than six sigmas away are 7 % of alpha.";
        assert_eq!(of(FinalStatus::InDoubt, contradicted), Standing::Refused);
    }

    #[test]
    fn a_remark_leaves_the_numbers_standing() {
        let word = standing(&estimation(FinalStatus::Converged, "Coloured residuals (lag-one correlation): q (0.61)."));
        assert_eq!((word.standing, word.remarks), (Standing::Sound, vec!["coloured".to_owned()]));
    }
}
