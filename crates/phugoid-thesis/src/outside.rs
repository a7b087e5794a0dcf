//! A truth that the estimators are told cannot be.

/// What a result says first where the truth lies outside the bounds; nothing where it lies within.
pub(super) fn truth_outside(name: &str, truth: f64, [lower, upper]: [f64; 2]) -> Option<String> {
    (!(lower..=upper).contains(&truth)).then(|| {
        format!(
            "The true {name} of {truth} lies outside the bounds {lower} to {upper} that the estimators are told: they rest at \
             or near a bound, and the errors that they claim hold for truths within the bounds only. "
        )
    })
}
