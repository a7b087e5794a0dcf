//! The figures that a flight-test engineer draws of an estimation.

use phugoid_identification::estimation::Estimation;

use crate::figure::Figure;

mod context;
mod correlation;
mod parameters;
mod planes;
mod residuals;
mod signals;
mod surfaces;

use context::Context;
pub(crate) use context::{event_kind, unit_of};
pub use signals::{TimeHistoryPanel, time_histories};

/// All figures of an estimation with short names that serve as file names and anchors (`inputs`, `outputs`,
/// `parameters-1`, `correlation`, `parameter-planes`, `surfaces-1`, `residuals`, `autocorrelation`). Figures for which
/// the estimation has no data are left out: an estimator without surfaces has no surface figure.
pub fn figures(estimation: &Estimation) -> Vec<(String, Figure)> {
    let context = Context::new(estimation);
    let mut figures = Vec::new();
    figures.extend(signals::inputs(&context));
    figures.extend(signals::outputs(&context));
    figures.extend(parameters::figures(&context));
    figures.extend(correlation::figure(&context));
    figures.extend(planes::figure(&context));
    figures.extend(surfaces::figures(&context));
    figures.extend(residuals::series(&context));
    figures.extend(residuals::autocorrelations(&context));
    figures
}
