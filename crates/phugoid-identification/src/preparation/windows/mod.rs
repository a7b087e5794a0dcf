//! Regressions over short windows of a flight, from which constants and drifts are taken out: they need no model of the
//! aircraft, and show whether sensors agree and at what time vanes were recorded.

pub(crate) mod channels;
pub(crate) mod delay;
pub(crate) mod regression;

/// Standard errors from which a departure counts. The errors are those between windows, which turbulence and model
/// error widen too.
pub(crate) const SIGNIFICANT: f64 = 5.0;
/// Share of the motion that may be left unexplained: more of it is gusts, which the aircraft follows, so that the factors
/// are no longer those of the sensors.
pub(crate) const GUSTS: f64 = 0.1;
