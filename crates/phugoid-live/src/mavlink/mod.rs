//! MAVLink 1 and 2: frames, messages, sequence numbers, and which field of which message is which channel.
//!
//! Frames and the definitions of messages are those of [`phugoid_flight_data::mavlink`], which reads logs of them too.

mod debug_messages;
pub(crate) mod map;
pub use debug_messages::DebugMessages;
pub use map::MavlinkOptions;
pub use phugoid_flight_data::mavlink::definitions;
pub use signing::{Key, KeyError, Refusal, Verifier};
pub mod sequence;
mod signing;

/// Frames in a stream of bytes, and signed ones.
pub mod frame {
    pub use phugoid_flight_data::mavlink::frame::*;

    pub use super::signing::encode_signed;
}
