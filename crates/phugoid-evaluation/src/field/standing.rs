//! What an estimation says of itself, as counted in the field.

use phugoid_identification::error::EstimateError;
use phugoid_identification::estimation::{Estimation, EstimationStatus};
use serde::Serialize;

/// What an estimation says of itself, and why; and what it remarks without taking its numbers back.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Word {
    /// What it says of its own numbers; refused if there are none.
    pub standing: EstimationStatus,
    /// Why it is not sound: the codes of its reasons, or why there are no numbers. Each once.
    pub reasons: Vec<String>,
    /// Remarks beside the numbers, which leave them standing: words for counting.
    pub remarks: Vec<String>,
    /// Whether it calls a change a trim shift.
    pub says_trim_shift: bool,
}

impl Word {
    /// The word where there are no numbers.
    pub(super) fn refused(reason: &str) -> Self {
        Self {
            standing: EstimationStatus::Refused,
            reasons: vec![reason.to_owned()],
            remarks: Vec::new(),
            says_trim_shift: false,
        }
    }
}

/// Sentences beside numbers that stand, by what they contain.
const REMARKS: [(&str, &str); 6] = [
    ("Coloured residuals", "coloured"),
    ("Model error", "model error"),
    ("taken for outliers", "outliers"),
    ("The residuals ask for", "missing term"),
    ("The parameters changed in flight", "change"),
    ("Check the wing", "wing"),
];
/// How the sentence about a change begins that moves constants only.
const TRIM_SHIFT: &str = "A constant force or moment (a trim shift) set in";

/// What an estimation says of itself. The only place where sentences are searched: remarks have no codes.
pub fn standing(estimation: &Estimation) -> Word {
    let is_said = |words: &str| estimation.verdict.iter().any(|sentence| sentence.contains(words));
    let remarks = REMARKS.iter().filter(|(words, _)| is_said(words)).map(|(_, name)| (*name).to_owned()).collect();
    let mut reasons: Vec<String> = Vec::new();
    for reason in &estimation.reasons {
        let code = reason.code.word().to_owned();
        if !reasons.contains(&code) {
            reasons.push(code);
        }
    }
    Word { standing: estimation.status, reasons, remarks, says_trim_shift: is_said(TRIM_SHIFT) }
}

/// The word for an estimation that was not made.
pub fn refusal(error: &EstimateError) -> Word {
    Word::refused(match error {
        EstimateError::MissingChannel { .. } | EstimateError::EmptyChannel(_) | EstimateError::EmptyInput(_) => {
            "missing channel"
        }
        EstimateError::TooShort { .. } => "too short",
        EstimateError::Units { .. } => "units",
        EstimateError::Noise(_) => "noise",
        EstimateError::NoExcitation { .. } => "no excitation",
        EstimateError::Batch(_) | EstimateError::LacksTerms { .. } => "no fit",
        _ => "other",
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use phugoid_identification::estimation::{ReasonCode, VerdictReason};

    #[test]
    fn the_status_and_its_reasons_are_those_of_the_estimation() {
        let reason = |code| VerdictReason {
            code,
            status: EstimationStatus::Doubtful,
            concerns: Vec::new(),
            sentence: String::new(),
        };
        let reasons = [ReasonCode::Sign, ReasonCode::Units, ReasonCode::Sign].map(reason).to_vec();
        let word = standing(&Estimation { status: EstimationStatus::Doubtful, reasons, ..Estimation::default() });
        assert_eq!((word.standing, word.reasons), (EstimationStatus::Doubtful, vec!["sign".into(), "units".into()]));
    }

    #[test]
    fn a_remark_leaves_the_numbers_standing() {
        let say =
            |sentence: &str| standing(&Estimation { verdict: vec![sentence.to_owned()], ..Estimation::default() });
        let word = say("Coloured residuals (lag-one correlation): q (0.61).");
        assert_eq!((word.standing, word.remarks), (EstimationStatus::Sound, vec!["coloured".to_owned()]));
        assert!(say("A constant force or moment (a trim shift) set in: found at 3.00 s.").says_trim_shift);
    }

    #[test]
    fn without_numbers_the_error_gives_the_reason() {
        let word = refusal(&EstimateError::TooShort { samples: 3 });
        assert_eq!((word.standing, word.reasons), (EstimationStatus::Refused, vec!["too short".to_owned()]));
    }
}
