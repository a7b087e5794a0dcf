//! The whole way from a record, or from samples as they come, to the result: the functions that users call.

pub mod estimate;
pub mod monitor;
pub mod session;
