//! Whether the residuals say that the model is wrong.

use crate::core::estimation::{EstimationStatus, ReasonCode, Signal, VerdictReason};

/// Share of an output's samples beyond six sigmas from which, if they also come in runs, the model is said to
/// contradict the flight. Sensors that throw single bad values do not make runs.
const CONTRADICTED: f64 = 0.05;
/// Lag-one correlation of clipped residuals from which they are called coloured.
const COLOURED: f64 = 0.4;

/// How the whitened residuals of one output are spread, once there are enough of them.
pub(crate) struct Spread {
    /// Number of samples that have a residual.
    pub(crate) present: usize,
    /// Number of residuals beyond six standard deviations.
    pub(crate) outliers: usize,
    /// Lag-one correlation, outliers clipped to three sigmas.
    colour: f64,
}

impl Spread {
    pub(crate) fn of(signal: &Signal) -> Option<Self> {
        Self::of_values(signal.values.iter().copied())
    }

    fn of_values(values: impl Iterator<Item = f64>) -> Option<Self> {
        let present: Vec<f64> = values.filter(|v| v.is_finite()).collect();
        if present.len() < 20 {
            return None;
        }
        let core: Vec<f64> = present.iter().map(|v| v.clamp(-3.0, 3.0)).collect();
        let power: f64 = core.iter().map(|v| v * v).sum();
        let lagged: f64 = core.windows(2).map(|w| w[0] * w[1]).sum();
        Some(Self {
            present: present.len(),
            outliers: present.iter().filter(|v| v.abs() > 6.0).count(),
            colour: if power > 0.0 { lagged / power } else { 0.0 },
        })
    }

    fn contradicts(&self) -> bool {
        self.outliers as f64 > CONTRADICTED * self.present as f64 && self.colour > COLOURED
    }
}

/// The lag-one correlation of an output's whitened residuals, if they are coloured.
pub(crate) fn colour(residuals: impl Iterator<Item = f64>) -> Option<f64> {
    Spread::of_values(residuals).map(|spread| spread.colour).filter(|colour| *colour > COLOURED)
}

/// The outputs that disagree with their predictions so often, and in runs, that it is the model that is wrong. The
/// contradicting samples were rejected, so that bounds from the remaining samples alone are too small.
pub(crate) fn reason(residuals: &[Signal]) -> Option<VerdictReason> {
    let found: Vec<(&Signal, Spread)> = residuals
        .iter()
        .filter_map(|signal| Spread::of(signal).filter(Spread::contradicts).map(|s| (signal, s)))
        .collect();
    if found.is_empty() {
        return None;
    }
    let named: Vec<String> = found
        .iter()
        .map(|(signal, s)| format!("{:.0} % of {}", 100.0 * s.outliers as f64 / s.present as f64, signal.name))
        .collect();
    Some(VerdictReason {
        code: ReasonCode::Contradiction,
        status: EstimationStatus::Refused,
        concerns: found.iter().map(|(signal, _)| signal.name.clone()).collect(),
        sentence: format!(
            "The model contradicts this flight: more than six sigmas away are {}. Look for a wrong unit, sign or time, a \
             delay or an offset of a sensor, a wrong mass or geometry, or noise levels that are too small.",
            named.join(", ")
        ),
    })
}
