//! Decides whether bytes are a message. ULog has no check sums: the length has to fit the kind of the message, and the
//! content the definitions.

use super::definitions::Definitions;
use super::format;

/// Number of bytes before the payload: its size and the kind of the message.
pub(super) const HEADER: usize = 3;
/// Largest size of a message with its header, bytes.
pub(super) const LONGEST: usize = HEADER + u16::MAX as usize;

const KINDS: &[u8] = b"DSFIPALCMQROB";
/// Names of topics longer than this, bytes, are taken as damage.
const LONGEST_NAME: usize = 256;
const SYNC: [u8; 8] = [0x2F, 0x73, 0x13, 0x20, 0x25, 0x0C, 0xBB, 0x12];

/// How certain it is that bytes are a message.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Trust {
    /// The bytes are no message.
    No,
    /// The bytes can be a message if what follows looks like one too.
    Weak,
    /// Size and content agree with the definitions.
    Strong,
}

/// Kind and payload of the message at the beginning of `bytes`; `None` if its end is not among them.
#[inline]
pub(super) fn split(bytes: &[u8]) -> Option<(u8, &[u8])> {
    let &[low, high, kind] = bytes.first_chunk::<HEADER>()?;
    let size = usize::from(u16::from_le_bytes([low, high]));
    Some((kind, bytes.get(HEADER..HEADER + size)?))
}

/// True if a message of a known kind can begin here, or if there are too few bytes to decide.
#[inline]
pub(super) fn may_begin(bytes: &[u8], definitions: &Definitions) -> bool {
    match (bytes.get(2), split(bytes)) {
        (Some(kind), Some((_, payload))) => KINDS.contains(kind) && trust(*kind, payload, definitions) != Trust::No,
        (Some(kind), None) => KINDS.contains(kind),
        (None, _) => true,
    }
}

/// How certain it is that this is a message.
#[inline]
pub(super) fn trust(kind: u8, payload: &[u8], definitions: &Definitions) -> Trust {
    let sure = |is: bool| if is { Trust::Strong } else { Trust::No };
    let weak = |may_be: bool| if may_be { Trust::Weak } else { Trust::No };
    match kind {
        b'D' => {
            let Some(id) = payload.first_chunk().map(|id| u16::from_le_bytes(*id)) else { return Trust::No };
            match definitions.sizes(id) {
                Some((least, most)) => sure((least + 2..=most + 2).contains(&payload.len())),
                None => Trust::Weak,
            }
        }
        b'S' => sure(payload == SYNC),
        b'O' => weak(payload.len() == 2),
        b'R' => weak(payload.len() == 2),
        b'L' => weak(payload.len() >= 9 && payload.first().is_some_and(|level| (b'0'..=b'7').contains(level))),
        b'C' => weak(payload.len() >= 11 && payload.first().is_some_and(|level| (b'0'..=b'7').contains(level))),
        b'A' => match payload
            .get(3..)
            .filter(|name| name.len() <= LONGEST_NAME)
            .and_then(|name| std::str::from_utf8(name).ok())
        {
            Some(name) if definitions.formats.knows(name) => Trust::Strong,
            Some(name) => weak(format::is_name(name)),
            None => Trust::No,
        },
        b'F' => {
            // Only as many bytes as a name can have, because this runs at every byte of a damaged part.
            let mut name = payload.iter().take(LONGEST_NAME).take_while(|&&byte| byte != b':').peekable();
            let all = name.peek().is_some() && name.all(|byte| format::is_name_byte(*byte));
            sure(all && payload.iter().take(LONGEST_NAME).any(|&byte| byte == b':'))
        }
        b'I' => key_trust(payload),
        b'P' => match key_and_value(payload) {
            Some((key, value)) => sure(value.len() == 4 && (key.starts_with("float ") || key.starts_with("int32_t "))),
            None => Trust::No,
        },
        b'M' | b'Q' => payload.get(1..).map_or(Trust::No, key_trust),
        b'B' => weak(payload.len() >= 40),
        kind => weak(kind.is_ascii_alphabetic() && !payload.is_empty()),
    }
}

/// The key (`type name`) and the bytes of the value of an information message or a parameter; `None` if there is no
/// valid key.
pub(super) fn key_and_value(payload: &[u8]) -> Option<(&str, &[u8])> {
    let length = usize::from(*payload.first()?);
    let key = std::str::from_utf8(payload.get(1..1 + length)?).ok()?;
    let is_key = key.is_ascii() && !key.bytes().any(|byte| byte.is_ascii_control()) && key.contains(' ');
    is_key.then_some((key, payload.get(1 + length..)?))
}

fn key_trust(payload: &[u8]) -> Trust {
    let Some((key, value)) = key_and_value(payload) else { return Trust::No };
    let type_name = key.split(' ').next().unwrap_or_default();
    let (type_name, elements) = match type_name.split_once('[') {
        Some((type_name, rest)) => (type_name, rest.trim_end_matches(']').parse::<usize>().ok()),
        None => (type_name, Some(1)),
    };
    match (format::kind(type_name), elements) {
        (Some((_, size)), Some(elements)) if size.checked_mul(elements) == Some(value.len()) => Trust::Strong,
        (Some(_), Some(_)) => Trust::Weak,
        _ => Trust::No,
    }
}
