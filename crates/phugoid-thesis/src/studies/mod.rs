//! The studies beside the cases: each file has its `ENTRIES`, which `entries` of the crate lists in the order of the report.

pub(crate) mod gust;
pub(crate) mod gust_flight;
pub(crate) mod health;
pub(crate) mod law_summary;
pub(crate) mod laws;
pub(crate) mod noise_levels;
pub(crate) mod pilot;
pub(crate) mod sensors;
pub(crate) mod trim;
pub(crate) mod tuning;
