//! Signatures of MAVLink 2 (<https://mavlink.io/en/guide/message_signing.html>).

use std::collections::HashMap;
use std::fmt;

use phugoid_flight_data::mavlink::frame::{self, Frame, SIGNATURE};
use sha2::{Digest, Sha256};

/// Flag of incompatibility: a signature follows the checksum.
const SIGNED: u8 = 0x01;
/// Bytes of a key.
const KEY: usize = 32;
/// A stream that begins with a timestamp older than this before the newest is refused, in units of 10 us: a minute.
const OLDEST: u64 = 6_000_000;
/// Streams whose timestamps are followed; frames of further ones are refused.
const MOST_STREAMS: usize = 1024;

/// The secret that signs. It is never shown.
#[derive(Clone, PartialEq, Eq)]
pub struct Key([u8; KEY]);

/// What is no key.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("a key of MAVLink has 32 bytes, or 64 hexadecimal digits; this has {0} bytes")]
pub struct KeyError(usize);

impl Key {
    /// The key in the bytes of a file: 32 bytes as they are, or 64 hexadecimal digits with white space around them.
    ///
    /// ```
    /// use phugoid_live::mavlink::Key;
    ///
    /// assert_eq!(Key::parse(&[0xAB; 32])?, Key::parse(b"abababababababababababababababababababababababababababababababab\n")?);
    /// assert!(Key::parse(b"secret").is_err());
    /// # Ok::<(), phugoid_live::mavlink::KeyError>(())
    /// ```
    ///
    /// # Errors
    /// [`KeyError`] for any other number of bytes, or other characters.
    pub fn parse(bytes: &[u8]) -> Result<Self, KeyError> {
        if let Ok(key) = bytes.try_into() {
            return Ok(Self(key));
        }
        let digit = |byte: &u8| char::from(*byte).to_digit(16).and_then(|digit| u8::try_from(digit).ok());
        let digits: Option<Vec<u8>> = bytes.trim_ascii().iter().map(digit).collect();
        let pairs = digits.filter(|digits| digits.len() == 2 * KEY).ok_or(KeyError(bytes.len()))?;
        let mut key = [0; KEY];
        for (byte, pair) in key.iter_mut().zip(pairs.chunks_exact(2)) {
            *byte = pair.iter().fold(0, |byte, digit| byte << 4 | digit);
        }
        Ok(Self(key))
    }

    /// The signature of a frame from its first byte to its checksum, for this link and timestamp (10 us since
    /// 2015-01-01 UTC, 48 bits).
    pub fn sign(&self, covered: &[u8], link: u8, timestamp: u64) -> [u8; SIGNATURE] {
        let mut signature = [0; SIGNATURE];
        let stamp = timestamp.to_le_bytes();
        let head = std::iter::once(&link).chain(stamp.iter().take(6));
        signature.iter_mut().zip(head).for_each(|(to, byte)| *to = *byte);
        let (head, code) = signature.split_at_mut(SIGNATURE - CODE);
        let hash = Sha256::new().chain_update(self.0).chain_update(covered).chain_update(&*head).finalize();
        code.iter_mut().zip(hash).for_each(|(to, byte)| *to = byte);
        signature
    }
}

/// Bytes of the hash that stand in a signature.
const CODE: usize = 6;

impl fmt::Debug for Key {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Key(secret)")
    }
}

/// Why a frame is not believed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Refusal {
    /// It has no signature.
    Unsigned,
    /// It was not signed with the key, or was changed.
    Wrong,
    /// It was signed with the key, and is as old as one that has come, or older: somebody may be sending it again.
    Old,
}

impl Refusal {
    /// What is wrong with a frame, in words.
    pub fn words(self) -> &'static str {
        match self {
            Self::Unsigned => "is not signed",
            Self::Wrong => "is not signed with the key",
            Self::Old => "is signed and not newer than those before it, as if it were sent once more",
        }
    }
}

/// Verifies frames with a key, and that each is newer than those of its stream before it.
///
/// ```
/// use phugoid_live::mavlink::frame::{self, Found};
/// use phugoid_live::mavlink::{Key, Refusal, Verifier};
///
/// let key = Key::parse(&[7; 32])?;
/// let mut verifier = Verifier::new(key.clone());
/// let signed = frame::encode_signed(0, 0, 1, 1, &[0; 9], &key, 0, 1000).expect("HEARTBEAT is known");
/// let Found::Frame(found, _) = frame::next(&signed) else { panic!("a frame is expected") };
/// assert_eq!(verifier.verify(&found), Ok(()));
/// assert_eq!(verifier.verify(&found), Err(Refusal::Old), "the same frame once more");
/// # Ok::<(), phugoid_live::mavlink::KeyError>(())
/// ```
#[derive(Debug)]
pub struct Verifier {
    key: Key,
    /// Timestamp of the newest frame of each stream, by link, system and component.
    streams: HashMap<(u8, u8, u8), u64>,
    newest: u64,
}

impl Verifier {
    /// A verifier that has seen no frame.
    pub fn new(key: Key) -> Self {
        Self { key, streams: HashMap::new(), newest: 0 }
    }

    /// Verifies a frame.
    ///
    /// # Errors
    /// [`Refusal`] says why it must not be used.
    pub fn verify(&mut self, frame: &Frame<'_>) -> Result<(), Refusal> {
        let signed = frame.signed.ok_or(Refusal::Unsigned)?;
        let (covered, signature) =
            signed.split_at_checked(signed.len().saturating_sub(SIGNATURE)).ok_or(Refusal::Unsigned)?;
        let [link, stamp @ ..] = signature else { return Err(Refusal::Unsigned) };
        let timestamp = stamp.iter().take(6).rev().fold(0, |stamp, byte| stamp << 8 | u64::from(*byte));
        let right = self.key.sign(covered, *link, timestamp);
        // Without a branch on the bytes, so that the time does not tell how many were right.
        let different = right.iter().zip(signature).fold(0, |different, (a, b)| different | (a ^ b));
        if std::hint::black_box(different) != 0 {
            return Err(Refusal::Wrong);
        }
        let stream = (*link, frame.system, frame.component);
        match self.streams.get(&stream) {
            Some(before) if timestamp <= *before => return Err(Refusal::Old),
            Some(_) => {}
            None if timestamp.saturating_add(OLDEST) < self.newest || self.streams.len() >= MOST_STREAMS => {
                return Err(Refusal::Old);
            }
            None => {}
        }
        self.streams.insert(stream, timestamp);
        self.newest = self.newest.max(timestamp);
        Ok(())
    }
}

/// A frame as [`frame::encode`] makes it, with a signature, for this number of the link and this
/// timestamp (10 us since 2015-01-01 UTC, 48 bits).
#[allow(clippy::too_many_arguments)] // the parts of a frame
pub fn encode_signed(
    id: u32,
    sequence: u8,
    system: u8,
    component: u8,
    payload: &[u8],
    key: &Key,
    link: u8,
    timestamp: u64,
) -> Option<Vec<u8>> {
    let mut frame = frame::encode_with_flags(SIGNED, id, sequence, system, component, payload)?;
    let signature = key.sign(&frame, link, timestamp);
    frame.extend_from_slice(&signature);
    Some(frame)
}

#[cfg(test)]
mod tests {
    use phugoid_flight_data::mavlink::frame::Found;

    use super::*;

    fn verify(verifier: &mut Verifier, bytes: &[u8]) -> Result<(), Refusal> {
        let Found::Frame(frame, length) = frame::next(bytes) else { panic!("{:?}", frame::next(bytes)) };
        assert_eq!(length, bytes.len());
        verifier.verify(&frame)
    }

    /// SHA-256 over key, frame, link and timestamp, as the specification says, computed by Python's hashlib.
    #[test]
    fn the_signature_is_that_of_the_specification() {
        let key = Key::parse(&std::array::from_fn::<u8, 32, _>(|k| k as u8)).unwrap();
        let signed = encode_signed(0, 5, 1, 1, &[0, 0, 0, 0, 2, 3, 81, 4, 3], &key, 3, 0x0102_0304_0506).unwrap();
        let hex: String = signed.iter().map(|byte| format!("{byte:02x}")).collect();
        assert_eq!(hex, EXPECTED);
    }

    const EXPECTED: &str = "fd090100050101000000000000000203510403724003060504030201c0ac35008dec";

    #[test]
    fn what_is_changed_unsigned_or_old_is_refused() {
        let key = Key::parse(&[9; 32]).unwrap();
        let signed = |link, system, timestamp| encode_signed(0, 0, system, 1, &[1; 9], &key, link, timestamp).unwrap();
        let mut verifier = Verifier::new(key.clone());
        assert_eq!(verify(&mut verifier, &signed(0, 1, 10_000_000)), Ok(()));
        assert_eq!(verify(&mut verifier, &signed(0, 1, 10_000_001)), Ok(()));
        for old in [10_000_001, 10_000_000, 0] {
            assert_eq!(verify(&mut verifier, &signed(0, 1, old)), Err(Refusal::Old));
        }
        // Another link and another system have timestamps of their own, which begin no more than a minute back.
        assert_eq!(verify(&mut verifier, &signed(1, 1, 4_000_001)), Ok(()));
        assert_eq!(verify(&mut verifier, &signed(0, 2, 4_000_000)), Err(Refusal::Old));
        assert_eq!(verify(&mut verifier, &frame::encode(0, 0, 1, 1, &[1; 9]).unwrap()), Err(Refusal::Unsigned));
        let foreign = Verifier::new(Key::parse(&[8; 32]).unwrap());
        assert_eq!(verify(&mut { foreign }, &signed(0, 1, 20_000_000)), Err(Refusal::Wrong));
        // Any bit of the signature.
        let bytes = signed(0, 1, 20_000_000);
        for index in bytes.len() - SIGNATURE..bytes.len() {
            let mut changed = bytes.clone();
            changed[index] ^= 1;
            assert_eq!(verify(&mut verifier, &changed), Err(Refusal::Wrong), "{index}");
        }
        assert_eq!(verify(&mut verifier, &bytes), Ok(()));
        assert!(format!("{key:?}") == "Key(secret)", "the key is not shown");
    }
}
