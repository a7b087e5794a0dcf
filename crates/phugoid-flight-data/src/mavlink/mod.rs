//! MAVLink 1 and 2: frames, the messages of the dialects `common` and `ardupilotmega`, and their units.
//!
//! The messages are data (`messages.txt`, written from the protocol's own definitions). So a profile or a model file can
//! name any field of any message, and nothing has to be compiled for it. Logs of ground stations are read by
//! [`crate::log::tlog`], streams by the crate `phugoid-live`.

pub mod definitions;
pub mod frame;
pub mod units;

use definitions::{Field, Message};

/// The field with the time at which a message was sampled, by the clock of the vehicle; `None` if the message has none.
pub fn time_field(message: &Message) -> Option<&Field> {
    ["time_usec", "time_boot_ms"].iter().find_map(|name| message.field(name))
}
