//! The figures of an estimation.

use phugoid_identification::estimation::Estimation;

use crate::figure::Figure;

mod coherence;
mod context;
mod correlation;
mod parameters;
mod planes;
mod residuals;
mod signals;
mod surfaces;

pub use coherence::coherence_figures;
use context::Context;
pub(crate) use context::{event_kind, unit_of};
pub(crate) use correlation::NAME as CORRELATION;
pub use signals::{TimeHistoryPanel, time_histories};

/// All figures of an estimation, each with a short name that serves as file name and anchor: `inputs`, `outputs`,
/// `parameters-1`, ..., `nuisance-1`, ..., `correlation`, `parameter-planes`, `surfaces-1`, ..., `residuals`,
/// `autocorrelation`, `prediction`. Figures for which the estimation has no data are left out, such as surfaces of an estimator
/// without surfaces.
///
/// ```
/// use phugoid_identification::estimation::{Estimation, History, Signal};
/// use phugoid_report::figures;
///
/// let elevator = Signal { name: "elevator".to_owned(), unit: "rad".to_owned(), values: vec![0.0, 0.1] };
/// let history = History { time_s: vec![0.0, 0.1], inputs: vec![elevator], ..History::default() };
/// let figures = figures(&Estimation { history, ..Estimation::default() });
/// assert_eq!(figures.iter().map(|(name, _)| name.as_str()).collect::<Vec<_>>(), ["inputs"]);
/// assert!(figures[0].1.to_svg().contains("Elevator δe, trailing edge down (deg)"));
/// ```
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
    figures.extend(signals::prediction(&context));
    figures
}
