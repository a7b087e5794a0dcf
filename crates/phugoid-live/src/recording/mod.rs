//! The recording: everything that arrived, with its times, in a file that can be read even if the program was killed
//! while it was written.
//!
//! `docs/live.md` describes the format. The file is a sequence of blocks: `PHGL`, length, CRC-32, body. If a block is
//! damaged or was not written to its end, only that block is lost; the reader goes on at the next `PHGL`.
//!
//! ```
//! use phugoid_live::arrival::{Arrival, Content};
//! use phugoid_live::recording::{Header, Reader, VERSION, write_whole};
//!
//! let header = Header { version: VERSION, source: "udp://127.0.0.1:14550".to_owned(), ..Header::default() };
//! let datagram = |arrival_ns, text: &str| Arrival {
//!     arrival_ns,
//!     wall_ns: 0,
//!     origin: 0,
//!     content: Content::Datagram(text.as_bytes().to_vec()),
//! };
//! let arrivals = [datagram(1, "time_s,alpha_deg"), datagram(2, "0.0,2.4")];
//! let mut file = Vec::new();
//! write_whole(&mut file, &header, &arrivals)?;
//!
//! // The last 40 bytes are lost, as after a kill: they were the end and a part of the second arrival.
//! file.truncate(file.len() - 40);
//! let mut reader = Reader::from_input(file.as_slice(), "example")?;
//! assert_eq!(reader.header(), &header);
//! assert_eq!(reader.next_arrival()?.as_ref(), Some(&arrivals[0]));
//! assert_eq!(reader.next_arrival()?, None);
//! assert!(reader.damage().cut_off_bytes > 0 && !reader.damage().ended);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod block;
mod header;
mod parts;
mod read;
mod write;

pub use block::BlockKind;
pub use header::{Header, VERSION};
pub use read::{Damage, Reader, RecordingError};
pub use write::{Recorded, Recorder, write_whole};
