//! MAVLink 1 and 2: frames, messages, sequence numbers, and what of it becomes a channel.
//!
//! The messages are data (`messages.txt`, written from the protocol's own definitions), so that a profile or a model file can name
//! any field of any message, and nothing has to be compiled for it.

mod debug_messages;
pub mod definitions;
pub mod frame;
pub(crate) mod map;
pub use debug_messages::DebugMessages;
pub use map::MavlinkOptions;
pub mod sequence;
mod units;
