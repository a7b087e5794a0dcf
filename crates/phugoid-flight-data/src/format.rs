//! Recognises the format of a file by its first bytes, whatever its name.
//!
//! ```
//! use phugoid_flight_data::format::Format;
//! assert_eq!(Format::sniff(b"time_s,alpha_deg\n"), Format::Csv);
//! assert_eq!(Format::sniff(b"PK\x03\x04"), Format::Zip); // a workbook
//! let (format, reader) = Format::of(std::fs::File::open("examples/flight.ulg")?)?;
//! assert_eq!(format, Format::Ulog);
//! # drop(reader);
//! # Ok::<(), std::io::Error>(())
//! ```

use std::io::{self, Cursor, Read};

use crate::mavlink;

/// The first bytes of a ULog file.
pub(crate) const ULOG_MAGIC: [u8; 7] = [b'U', b'L', b'o', b'g', 0x01, 0x12, 0x35];
/// The first bytes of every message of a DataFlash log, and so of the file.
pub(crate) const DATAFLASH_MAGIC: [u8; 2] = [0xA3, 0x95];
/// The first bytes of an MCAP file.
pub(crate) const MCAP_MAGIC: [u8; 8] = *b"\x89MCAP0\r\n";

/// Where the first frame of a telemetry log begins: its stamp stands before it.
const TLOG_FRAME: usize = 8;

/// Number of bytes that are enough to recognise every format.
const SNIFFED: usize = 64;

/// A format that is recognised; not all of them can be read. [`Format::feature`] says which need a feature.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Format {
    /// A table as text with a header line, and everything that is not recognised as another format.
    Csv,
    /// A log of PX4 in the ULog format.
    Ulog,
    /// A binary ArduPilot DataFlash log (`.BIN`).
    DataFlash,
    /// An ArduPilot DataFlash log converted to text (`.log`); not read.
    DataFlashText,
    /// A telemetry log of a ground station (`.tlog`): frames of MAVLink, each after the time at which it came.
    Tlog,
    /// A log of PX4 as Flight Review 2 keeps it: a folder with a Parquet file for each topic; read with the feature `parquet`.
    FlightReview,
    /// MCAP, a container of messages; read with the feature `mcap`.
    Mcap,
    /// Apache Parquet, a table; read with the feature `parquet`.
    Parquet,
    /// Apache Arrow IPC file or stream, or Feather, a table; read with the feature `parquet`.
    Arrow,
    /// MATLAB file of level 5 (`save -v6`, `save -v7`); read with the feature `matlab`.
    Mat5,
    /// HDF5, which is also MATLAB 7.3; not read.
    Hdf5,
    /// A file compressed by gzip: a table as text in it is read with the feature `gzip`.
    Gzip,
    /// A zip archive: a workbook of Excel (`.xlsx`), read with the feature `excel`, or another one, which is refused.
    Zip,
    /// A table as text in UTF-16, known by its byte-order mark.
    Utf16,
}

impl Format {
    /// The format of a file with this beginning (64 bytes are enough). What is not recognised is taken as
    /// [`Format::Csv`], whose reader refuses binary data.
    pub fn sniff(start: &[u8]) -> Self {
        let is = |magic: &[u8]| start.starts_with(magic);
        match start {
            _ if is(&ULOG_MAGIC) => Format::Ulog,
            _ if is(&DATAFLASH_MAGIC) => Format::DataFlash,
            // The first byte of the time is zero for some thousand years to come, and text has no such byte.
            [0, ..] if mavlink::frame::length(start.get(TLOG_FRAME..).unwrap_or_default()).is_some() => Format::Tlog,
            _ if is(b"FMT, 128,") => Format::DataFlashText,
            _ if is(&MCAP_MAGIC) => Format::Mcap,
            _ if is(b"PAR1") => Format::Parquet,
            // A stream of Arrow IPC begins with the marker of its first message. Text has no such bytes.
            _ if is(b"ARROW1") || is(b"FEA1") || is(&[0xFF; 4]) => Format::Arrow,
            _ if is(b"MATLAB 5.0") => Format::Mat5,
            _ if is(b"\x89HDF") || is(b"MATLAB 7.3") => Format::Hdf5,
            _ if is(&[0x1F, 0x8B]) => Format::Gzip,
            _ if is(b"PK\x03\x04") => Format::Zip,
            _ if is(&[0xFF, 0xFE]) || is(&[0xFE, 0xFF]) => Format::Utf16,
            _ => Format::Csv,
        }
    }

    /// The format of what a reader gives, and a reader that gives the same bytes again from the beginning.
    ///
    /// # Errors
    /// The error of the reader, if it fails within the first bytes.
    pub fn of<R: Read>(mut reader: R) -> io::Result<(Self, impl Read)> {
        let mut start = Vec::with_capacity(SNIFFED);
        reader.by_ref().take(SNIFFED as u64).read_to_end(&mut start)?;
        Ok((Self::sniff(&start), Cursor::new(start).chain(reader)))
    }

    /// True if it is a log of an autopilot or a recorder (not a table) and this build reads it.
    pub(crate) fn is_log(self) -> bool {
        matches!(self, Format::Ulog | Format::DataFlash | Format::Tlog)
            || (cfg!(feature = "mcap") && self == Format::Mcap)
            || (cfg!(feature = "parquet") && self == Format::FlightReview)
    }

    /// The cargo feature that this format needs, of this crate and of the command line; `None` if it needs none or is
    /// never read.
    pub fn feature(self) -> Option<&'static str> {
        match self {
            Format::Mat5 => Some("matlab"),
            Format::Mcap => Some("mcap"),
            Format::Parquet | Format::Arrow | Format::FlightReview => Some("parquet"),
            Format::Zip => Some("excel"),
            Format::Gzip => Some("gzip"),
            _ => None,
        }
    }

    /// The format as a noun with its article, for messages: `a Parquet file`.
    pub fn in_words(self) -> &'static str {
        match self {
            Format::Csv => "a table as text (CSV)",
            Format::Ulog => "a PX4 log (ULog)",
            Format::DataFlash => "an ArduPilot DataFlash log",
            Format::DataFlashText => "an ArduPilot DataFlash log converted to text",
            Format::Tlog => "a MAVLink telemetry log (.tlog)",
            Format::FlightReview => "a folder of Flight Review (one Parquet file for each topic)",
            Format::Mcap => "an MCAP file",
            Format::Parquet => "a Parquet file",
            Format::Arrow => "an Arrow or Feather file",
            Format::Mat5 => "a MATLAB file",
            Format::Hdf5 => "an HDF5 or MATLAB 7.3 file",
            Format::Gzip => "compressed by gzip",
            Format::Zip => "a workbook (.xlsx) or another zip archive",
            Format::Utf16 => "a table as text in UTF-16",
        }
    }
}

/// What the user can do where the feature of a format is off.
pub(crate) fn build_with(feature: &str) -> String {
    format!("build it with this format: cargo install --path crates/phugoid-cli --features {feature} (or all-formats)")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn formats_are_known_by_their_first_bytes() {
        for (start, format) in [
            (&b"ULog\x01\x12\x35\x01"[..], Format::Ulog),
            (b"\xA3\x95\x80\x80\x59FMT", Format::DataFlash),
            (b"\0\x06\x28\x42\x11\x22\x33\x44\xFD\x09\x00\x00", Format::Tlog),
            (b"\0\x06\x28\x42\x11\x22\x33\x44\xFE\x09", Format::Tlog),
            (b"\0\x06\x28\x42\x11\x22\x33\x44\xFD\x09\x80", Format::Csv), // flags that nobody knows
            (b"PAR1....", Format::Parquet),
            (b"time_s,alpha_deg\n", Format::Csv),
            (b"", Format::Csv),
            (b"MATLAB 5.0 MAT-file", Format::Mat5),
            (b"\xFF\xFF\xFF\xFF\x10\x01\x00\x00", Format::Arrow),
        ] {
            assert_eq!(Format::sniff(start), format);
        }
    }
}
