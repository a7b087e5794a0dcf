//! Frames in a stream of bytes (<https://mavlink.io/en/guide/serialization.html>).

use super::definitions;

/// First byte of a frame of MAVLink 1, ...
pub(crate) const START_1: u8 = 0xFE;
/// ... and of MAVLink 2.
pub(crate) const START_2: u8 = 0xFD;
/// Length of the signature at the end of a signed frame, bytes.
pub const SIGNATURE: usize = 13;
/// Incompatibility flag of MAVLink 2: a signature of 13 bytes follows the checksum.
const SIGNED: u8 = 0x01;

/// A frame whose checksum is right, or whose message is not known.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Frame<'a> {
    /// Number of the message; see [`definitions::messages`].
    pub id: u32,
    /// Counter of the frames that this component sends, modulo 256.
    pub sequence: u8,
    /// Number of the vehicle that sends (system ID).
    pub system: u8,
    /// Number of the part of the vehicle that sends (component ID).
    pub component: u8,
    /// The fields of the message; zeros at the end may be missing.
    pub payload: &'a [u8],
    /// False if the message is not in the dialects, so that its checksum cannot be verified.
    pub known: bool,
    /// The whole frame with its signature, if it is signed; `None` if it is not.
    pub signed: Option<&'a [u8]>,
}

/// What stands at the beginning of a buffer. The number is always that of the bytes that it takes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Found<'a> {
    /// A frame of this many bytes.
    Frame(Frame<'a>, usize),
    /// A known message of this many bytes with a wrong checksum. The next frame may begin inside it.
    BadChecksum(usize),
    /// This many bytes, at least one, that belong to no frame.
    Garbage(usize),
    /// Perhaps the beginning of a frame; more bytes are needed to know.
    Incomplete,
}

/// Looks at the beginning of a buffer.
///
/// ```
/// use phugoid_flight_data::mavlink::definitions::NAMED_VALUE_FLOAT;
/// use phugoid_flight_data::mavlink::frame::{self, Found};
///
/// let payload = [0, 0, 0, 0, 0, 0, 0xC0, 0x3F, b'q'];
/// let mut bytes = frame::encode(NAMED_VALUE_FLOAT, 7, 1, 1, &payload).expect("a known message");
/// let Found::Frame(found, length) = frame::next(&bytes) else { panic!("a frame is expected") };
/// assert_eq!((found.id, found.sequence, found.payload, length), (NAMED_VALUE_FLOAT, 7, &payload[..], bytes.len()));
/// bytes[12] ^= 1;
/// assert_eq!(frame::next(&bytes), Found::BadChecksum(bytes.len()));
/// ```
pub fn next(bytes: &[u8]) -> Found<'_> {
    let (header, trailer) = match bytes {
        [] => return Found::Incomplete,
        [START_1, ..] => (6, 2),
        [START_2] => return Found::Incomplete,
        [START_2, _] => return Found::Incomplete,
        // By the specification a frame with an unknown incompatibility flag has to be discarded.
        [START_2, _, flags, ..] if flags & !SIGNED != 0 => return Found::Garbage(1),
        [START_2, _, flags, ..] => (10, if flags & SIGNED == 0 { 2 } else { 2 + SIGNATURE }),
        _ => {
            let garbage = bytes.iter().position(|byte| [START_1, START_2].contains(byte)).unwrap_or(bytes.len());
            return Found::Garbage(garbage);
        }
    };
    let length = bytes.get(1).copied().map_or(255, usize::from);
    let whole = header + length + trailer;
    let Some(frame) = bytes.get(..whole) else { return Found::Incomplete };
    let at = |index: usize| frame.get(index).copied().unwrap_or_default();
    let (sequence, system, component, id) = match header {
        6 => (at(2), at(3), at(4), u32::from(at(5))),
        _ => (at(4), at(5), at(6), u32::from_le_bytes([at(7), at(8), at(9), 0])),
    };
    let payload = frame.get(header..header + length).unwrap_or_default();
    let signed = (trailer > 2).then_some(frame);
    let Some(message) = definitions::messages().get(&id) else {
        // The checksum cannot be verified without `CRC_EXTRA`, so the frame is accepted only if another one, or
        // nothing, follows it.
        let followed = bytes.get(whole).is_none_or(|byte| [START_1, START_2].contains(byte));
        let frame = Frame { id, sequence, system, component, payload, known: false, signed };
        return if followed { Found::Frame(frame, whole) } else { Found::Garbage(1) };
    };
    let covered = frame.get(1..header + length).unwrap_or_default();
    let sent = u16::from_le_bytes([at(header + length), at(header + length + 1)]);
    if checksum(covered, message.crc_extra) != sent {
        return Found::BadChecksum(whole);
    }
    Found::Frame(Frame { id, sequence, system, component, payload, known: true, signed }, whole)
}

/// Hands everything in a buffer to `out` in turn, up to what may be the beginning of a frame, and returns the number of
/// bytes that were used. The next call should begin after them, with more bytes. Of a frame with a wrong checksum only
/// one byte is used, because another frame may begin inside it.
///
/// ```
/// use phugoid_flight_data::mavlink::frame::{self, Found};
///
/// let mut bytes = b"noise".to_vec();
/// bytes.extend(frame::encode(0, 0, 1, 1, &[0; 9]).expect("HEARTBEAT is known"));
/// bytes.push(0xFD);
/// let mut messages = Vec::new();
/// let used = frame::split(&bytes, &mut |found| {
///     if let Found::Frame(frame, _) = found {
///         messages.push(frame.id);
///     }
/// });
/// assert_eq!((messages, used), (vec![0], bytes.len() - 1));
/// ```
pub fn split<'a>(bytes: &'a [u8], out: &mut dyn FnMut(Found<'a>)) -> usize {
    let mut at = 0;
    while let Some(rest) = bytes.get(at..) {
        let found = next(rest);
        at += match found {
            Found::Frame(_, length) | Found::Garbage(length) => length,
            Found::BadChecksum(_) => 1,
            Found::Incomplete => break,
        };
        out(found);
    }
    at
}

/// The checksum of a frame: CRC-16/MCRF4XX over the bytes between its first byte and its checksum, then over
/// `CRC_EXTRA` of its message.
///
/// ```
/// // The catalogue of parametrised CRC algorithms gives 0x6F91 for the nine bytes `123456789`.
/// assert_eq!(phugoid_flight_data::mavlink::frame::checksum(b"12345678", b'9'), 0x6F91);
/// ```
pub fn checksum(bytes: &[u8], extra: u8) -> u16 {
    bytes.iter().chain(std::iter::once(&extra)).fold(0xFFFF_u16, |crc, byte| {
        let mixed = byte ^ (crc as u8);
        let mixed = u16::from(mixed ^ (mixed << 4));
        (crc >> 8) ^ (mixed << 8) ^ (mixed << 3) ^ (mixed >> 4)
    })
}

/// A MAVLink 2 frame of a known message, without signature. Zeros at the end of the payload are cut off, as the
/// protocol requires. `None` if the message is not known or if more than 255 bytes of payload are left.
pub fn encode(id: u32, sequence: u8, system: u8, component: u8, payload: &[u8]) -> Option<Vec<u8>> {
    frame_of(id, [0, sequence, system, component], payload)
}

/// A frame as [`encode`] makes it, with these flags of incompatibility (1: a signature of [`SIGNATURE`] bytes will follow,
/// which the caller makes and appends).
pub fn encode_with_flags(
    flags: u8,
    id: u32,
    sequence: u8,
    system: u8,
    component: u8,
    payload: &[u8],
) -> Option<Vec<u8>> {
    frame_of(id, [flags, sequence, system, component], payload)
}

/// Length in bytes of the frame that begins here, as its header states it, whether or not its checksum is right. `None`
/// if no frame begins here, or too few bytes are given to know.
pub fn length(bytes: &[u8]) -> Option<usize> {
    match *bytes {
        [START_1, payload, ..] => Some(6 + usize::from(payload) + 2),
        [START_2, payload, flags, ..] if flags & !SIGNED == 0 => {
            Some(10 + usize::from(payload) + 2 + if flags & SIGNED == 0 { 0 } else { SIGNATURE })
        }
        _ => None,
    }
}

fn frame_of(id: u32, [flags, sequence, system, component]: [u8; 4], payload: &[u8]) -> Option<Vec<u8>> {
    let message = definitions::messages().get(&id)?;
    let used = payload.iter().rposition(|byte| *byte != 0).map_or(1, |last| last + 1).min(payload.len());
    let payload = payload.get(..used)?;
    let length = u8::try_from(payload.len()).ok()?;
    let [low, middle, high, _] = id.to_le_bytes();
    let mut frame = vec![START_2, length, flags, 0, sequence, system, component, low, middle, high];
    frame.extend_from_slice(payload);
    let crc = checksum(frame.get(1..)?, message.crc_extra);
    frame.extend_from_slice(&crc.to_le_bytes());
    Some(frame)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The check value of CRC-16/MCRF4XX over `123456789` is 0x6F91 (the catalogue of parametrised CRC algorithms).
    #[test]
    fn the_checksum_is_the_published_one() {
        assert_eq!(checksum(b"12345678", b'9'), 0x6F91);
    }

    #[test]
    fn what_is_written_is_read_and_damage_is_seen() {
        let payload = [7, 0, 0, 0, 0, 0, 192, 63, b'q', 0, 0, 0];
        let bytes = encode(251, 9, 1, 2, &payload).unwrap();
        let Found::Frame(frame, length) = next(&bytes) else { panic!() };
        assert_eq!((frame.id, frame.sequence, frame.system, frame.component), (251, 9, 1, 2));
        assert_eq!((frame.payload, length), (&payload[..9], bytes.len()));
        for index in 1..bytes.len() {
            let mut damaged = bytes.clone();
            damaged[index] ^= 0x10;
            let found = next(&damaged);
            assert!(!matches!(found, Found::Frame(Frame { known: true, .. }, _)), "byte {index}: {found:?}");
            assert_eq!(next(&bytes[..index]), Found::Incomplete);
        }
        assert_eq!(next(b"\0garbage\xFE"), Found::Garbage(8));
        assert_eq!(next(&[START_2, 9, 2, 0]), Found::Garbage(1));
    }
}
