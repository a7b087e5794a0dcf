//! A finding of the checks as a reason of the verdict.

use crate::core::estimation::{EstimationStatus, ReasonCode, VerdictReason};

/// A reason of physics: doubtful, or refused where it is impossible.
pub(super) fn reason(impossible: bool, concerns: &[&str], sentence: String) -> VerdictReason {
    VerdictReason {
        code: ReasonCode::Physics,
        status: if impossible { EstimationStatus::Refused } else { EstimationStatus::Doubtful },
        concerns: concerns.iter().map(|name| (*name).to_owned()).collect(),
        sentence,
    }
}
