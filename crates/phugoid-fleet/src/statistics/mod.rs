//! What many flights tell together: means with bounds that know what flights share, drifts, steps, outliers.

pub mod cause;
pub mod course;
pub mod distribution;
pub mod false_discovery;
pub mod outlier;
pub mod sharing;
pub mod tell;
pub mod unused;
