//! The blocks of a recording.

use crate::arrival::{Arrival, Content};

/// The bytes with which every block begins.
pub(super) const MARK: [u8; 4] = *b"PHGL";
/// Size of mark, length and checksum, bytes.
pub(super) const HEAD: usize = 12;
/// Largest body, bytes. A datagram has at most 65,535 bytes; a header holds a model file.
pub(super) const LARGEST: usize = 4 << 20;
/// Size of kind, arrival, wall clock and origin, bytes.
const STAMPS: usize = 19;

/// What a block of a recording holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BlockKind {
    /// The header ([`super::Header`]) as JSON.
    Header,
    /// A sender appeared; the content is its name.
    Opened,
    /// A datagram as it was received.
    Datagram,
    /// Bytes of a stream as they were received.
    Piece,
    /// A sender is gone; the content is the reason.
    Closed,
    /// The reception ended normally, not by a kill.
    End,
    /// Arrivals are missing here; the content is their number, eight bytes, little-endian.
    Gap,
}

impl BlockKind {
    const ALL: [Self; 7] =
        [Self::Header, Self::Opened, Self::Datagram, Self::Piece, Self::Closed, Self::End, Self::Gap];

    /// The number of the kind in the file.
    pub fn code(self) -> u8 {
        match self {
            Self::Header => 0,
            Self::Opened => 1,
            Self::Datagram => 2,
            Self::Piece => 3,
            Self::Closed => 4,
            Self::End => 5,
            Self::Gap => 6,
        }
    }

    fn from_code(code: u8) -> Option<Self> {
        Self::ALL.into_iter().find(|kind| kind.code() == code)
    }
}

/// A block of the file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Block {
    pub(super) kind: BlockKind,
    pub(super) arrival_ns: u64,
    pub(super) wall_ns: u64,
    pub(super) origin: u16,
    pub(super) content: Vec<u8>,
}

impl Block {
    /// Kind and content of the block of an arrival.
    pub(super) fn of(arrival: &Arrival) -> (BlockKind, &[u8]) {
        match &arrival.content {
            Content::Opened(peer) => (BlockKind::Opened, peer.as_bytes()),
            Content::Datagram(bytes) => (BlockKind::Datagram, bytes),
            Content::Piece(bytes) => (BlockKind::Piece, bytes),
            Content::Closed(reason) => (BlockKind::Closed, reason.as_bytes()),
        }
    }

    /// The arrival that the block holds; `None` for the header, the end and a gap.
    pub(super) fn arrival(self) -> Option<Arrival> {
        let text = |bytes: Vec<u8>| String::from_utf8_lossy(&bytes).into_owned();
        let content = match self.kind {
            BlockKind::Opened => Content::Opened(text(self.content)),
            BlockKind::Datagram => Content::Datagram(self.content),
            BlockKind::Piece => Content::Piece(self.content),
            BlockKind::Closed => Content::Closed(text(self.content)),
            BlockKind::Header | BlockKind::End | BlockKind::Gap => return None,
        };
        Some(Arrival { arrival_ns: self.arrival_ns, wall_ns: self.wall_ns, origin: self.origin, content })
    }

    /// Reads the body of a block; `None` if it is too short or its kind is not known.
    pub(super) fn parse(body: &[u8]) -> Option<Self> {
        let (stamps, content) = body.split_at_checked(STAMPS)?;
        let number = |from: usize| stamps.get(from..from + 8)?.try_into().ok().map(u64::from_le_bytes);
        Some(Self {
            kind: BlockKind::from_code(*stamps.first()?)?,
            arrival_ns: number(1)?,
            wall_ns: number(9)?,
            origin: u16::from_le_bytes(stamps.get(17..19)?.try_into().ok()?),
            content: content.to_vec(),
        })
    }
}

/// Appends a block to a buffer. Content beyond [`LARGEST`] is cut off.
pub(super) fn append(
    buffer: &mut Vec<u8>,
    kind: BlockKind,
    [arrival_ns, wall_ns]: [u64; 2],
    origin: u16,
    content: &[u8],
) {
    let content = content.get(..content.len().min(LARGEST - STAMPS)).unwrap_or_default();
    let start = buffer.len();
    buffer.extend_from_slice(&MARK);
    buffer.extend_from_slice(&((STAMPS + content.len()) as u32).to_le_bytes());
    buffer.extend_from_slice(&[0; 4]);
    buffer.push(kind.code());
    buffer.extend_from_slice(&arrival_ns.to_le_bytes());
    buffer.extend_from_slice(&wall_ns.to_le_bytes());
    buffer.extend_from_slice(&origin.to_le_bytes());
    buffer.extend_from_slice(content);
    let checksum = crc32fast::hash(buffer.get(start + HEAD..).unwrap_or_default()).to_le_bytes();
    if let Some(place) = buffer.get_mut(start + 8..start + HEAD) {
        place.copy_from_slice(&checksum);
    }
}
