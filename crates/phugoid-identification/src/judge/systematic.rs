//! Which parameters a longer flight does not improve, and what would.

use crate::core::estimation::{FinalStatus, ParameterResult, UncertainQuantity};
use crate::core::systematic::LearntQuantity;

/// What the flight itself says of declared errors, and whether it is used; `None` where it does not tell.
pub(crate) fn learnt(quantities: &[LearntQuantity], is_used: bool) -> Option<String> {
    if quantities.is_empty() {
        return None;
    }
    let all: Vec<String> = quantities.iter().map(LearntQuantity::in_words).collect();
    let used = if is_used {
        "values and bounds contain that"
    } else {
        "values and bounds do not contain that (learn = true under [uncertainty] takes it in)"
    };
    Some(format!("Of these errors the flight itself tells some, +- 2 sigma: {}; {used}.", all.join(", ")))
}

/// Names the parameters whose systematic part is larger than the random one, and the quantity that has the largest
/// share in them; `None` where there is no such parameter.
pub(crate) fn sentence(parameters: &[ParameterResult]) -> Option<String> {
    let limited: Vec<&ParameterResult> = parameters
        .iter()
        .filter(|p| !p.nuisance && p.status != FinalStatus::Fixed && p.systematic_std > p.random_std())
        .collect();
    let share = |quantity: UncertainQuantity| -> f64 {
        let parts = limited.iter().flat_map(|p| &p.systematic_parts);
        parts.filter(|part| part.quantity == quantity).map(|part| part.share).sum::<f64>() / limited.len() as f64
    };
    let shares = UncertainQuantity::ALL.map(|quantity| (quantity, share(quantity)));
    let (largest, part) = shares.into_iter().max_by(|a, b| a.1.total_cmp(&b.1)).filter(|(_, part)| *part > 0.0)?;
    let names: Vec<&str> = limited.iter().map(|p| p.name.as_str()).collect();
    Some(format!(
        "A longer flight will not make the bounds of {} much smaller: their systematic part is the larger one. What would \
         help most is {} ({:.0} % of the variance of that part).",
        names.join(", "),
        largest.remedy(),
        100.0 * part
    ))
}
