//! The whole way from a record, or from samples as they come, to the result: the functions that users call.

mod base_tables;
pub mod estimate;
mod look_back;
pub mod monitor;
pub mod session;
