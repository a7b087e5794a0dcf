//! MAVLink 1 and 2: frames, messages, sequence numbers, and which field of which message is which channel.
//!
//! The messages are data (`messages.txt`, written from the protocol's own definitions of the dialects `common` and
//! `ardupilotmega`). So a profile or a model file can name any field of any message, and nothing has to be compiled for
//! it.

mod debug_messages;
pub mod definitions;
pub mod frame;
pub(crate) mod map;
pub use debug_messages::DebugMessages;
pub use map::MavlinkOptions;
pub use signing::{Key, KeyError, Refusal, Verifier};
pub mod sequence;
mod signing;
mod units;
