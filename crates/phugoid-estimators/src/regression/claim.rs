//! The estimate of a regression method, made of parameters, variances and corrections.

use super::row_source::Frame;
use crate::estimate::{CONVERGED, EXCITED};
use crate::estimate::{Estimate, ParameterStatus, Phase, Status};

/// Parameters, scaled variances and their corrections, of which an [`Estimate`] is made.
pub(crate) struct Claim<'a, const P: usize> {
    pub(crate) time_s: f64,
    pub(crate) phase: Phase,
    pub(crate) theta: &'a [f64; P],
    /// Variances of the columns, as a part of their prior variances.
    pub(crate) variances: &'a [f64; P],
    /// Corrected variance over the claimed one, at least one.
    pub(crate) inflation: &'a [f64; P],
    /// Distance between the estimate shown and the one that the variances belong to, parameter units.
    pub(crate) distance: &'a [f64; P],
}

impl<const P: usize> Claim<'_, P> {
    pub(crate) fn estimate<const R: usize>(&self, frame: &Frame<R, P>) -> Estimate<P> {
        let columns = &frame.columns;
        let mut estimate = Estimate {
            time_s: self.time_s,
            parameters: *self.theta,
            std_error: [0.0; P],
            corrected_std_error: [0.0; P],
            observability: [0.0; P],
            parameter_status: [ParameterStatus::NotExcited; P],
            status: Status { phase: self.phase, ..Status::default() },
        };
        for j in 0..columns.count() {
            let std = columns.std[j];
            let variance = self.variances[j];
            let distance = self.distance[j] * self.distance[j];
            let corrected = libm::sqrt(std * std * variance * self.inflation[j] + distance);
            estimate.std_error[j] = libm::sqrt(std * std * variance + distance);
            estimate.corrected_std_error[j] = corrected;
            estimate.observability[j] = if std > 0.0 { (1.0 - variance).clamp(0.0, 1.0) } else { 0.0 };
            let theta = self.theta[j];
            let limited = j < columns.own() && {
                let prior = &frame.priors[j];
                theta - 2.0 * corrected > prior.upper
                    || theta + 2.0 * corrected < prior.lower
                    || prior.std > 0.0 && (theta <= columns.clip_low[j] || theta >= columns.clip_high[j])
            };
            estimate.parameter_status[j] = if estimate.observability[j] < EXCITED {
                ParameterStatus::NotExcited
            } else if limited {
                ParameterStatus::AtLimit
            } else if corrected <= CONVERGED * std {
                ParameterStatus::Converged
            } else {
                ParameterStatus::Improving
            };
        }
        estimate
    }
}
