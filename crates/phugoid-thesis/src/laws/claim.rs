//! What a law says of itself: an estimate without a covariance.

use phugoid_estimators::{Estimate, ParameterStatus, Phase, Status};

/// An estimate whose unknown parameters have infinite standard errors. `unknowns`: index and verdict.
pub(super) fn without_covariance<const P: usize>(
    time_s: f64,
    theta: &[f64; P],
    count: usize,
    phase: Phase,
    unknowns: impl IntoIterator<Item = (usize, ParameterStatus)>,
) -> Estimate<P> {
    let mut estimate = Estimate {
        time_s,
        parameters: *theta,
        std_error: [0.0; P],
        corrected_std_error: [0.0; P],
        observability: [0.0; P],
        parameter_status: [ParameterStatus::NotExcited; P],
        status: Status { phase, ..Status::default() },
    };
    estimate.parameters[count.min(P)..].fill(0.0);
    for (j, status) in unknowns {
        estimate.std_error[j] = f64::INFINITY;
        estimate.corrected_std_error[j] = f64::INFINITY;
        estimate.parameter_status[j] = status;
    }
    estimate
}

/// Verdict on a parameter that is `excited` or not and should lie between its bounds.
pub(super) fn verdict(value: f64, [lower, upper]: [f64; 2], excited: bool) -> ParameterStatus {
    if !(lower..=upper).contains(&value) {
        ParameterStatus::AtLimit
    } else if excited {
        ParameterStatus::Improving
    } else {
        ParameterStatus::NotExcited
    }
}
