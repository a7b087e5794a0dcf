//! The recording: everything that arrived, with its times, in a file that survives a kill at any moment.
//!
//! `docs/live.md` describes the format. Blocks follow one another: `PHGL`, length, CRC-32, body. A block that was not written to its
//! end, or is damaged, costs that block; what follows is found by the next `PHGL`.

mod block;
mod header;
mod read;
mod write;

pub use block::BlockKind;
pub use header::{Header, VERSION};
pub use read::{Damage, Reader, RecordingError};
pub use write::{Recorded, Recorder};
