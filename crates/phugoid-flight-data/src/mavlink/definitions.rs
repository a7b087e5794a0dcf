//! The messages of the dialects `common` and `ardupilotmega`: their numbers, fields, types and units.

use std::collections::BTreeMap;
use std::sync::OnceLock;

/// A message and its fields.
///
/// ```
/// use phugoid_flight_data::mavlink::definitions;
///
/// let attitude = definitions::by_name("ATTITUDE").expect("a message of the dialect `common`");
/// assert_eq!((attitude.id, attitude.length()), (30, 28));
/// let pitch = attitude.field("pitch").expect("a field of ATTITUDE");
/// assert_eq!(pitch.unit, "rad");
/// let mut payload = vec![0; attitude.length()];
/// payload[pitch.offset..pitch.offset + 4].copy_from_slice(&0.25_f32.to_le_bytes());
/// assert_eq!(pitch.value(&payload, 0), Some(0.25));
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Message {
    /// Number of the message, by which frames name it.
    pub id: u32,
    /// Name of the message, such as `HIGHRES_IMU`.
    pub name: &'static str,
    /// Last byte of the checksum (`CRC_EXTRA`), made from the names and types of the fields. It fails if sender and
    /// receiver have different definitions of the message.
    pub crc_extra: u8,
    /// Fields in the order in which they stand in the payload, extensions last.
    pub fields: Vec<Field>,
}

/// A field of a message.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Field {
    /// Name of the field, such as `xacc`.
    pub name: &'static str,
    /// Type of the value, or of each element of an array.
    pub kind: Kind,
    /// Number of elements of an array; 0 for a single value.
    pub count: usize,
    /// Unit as MAVLink writes it (`cdeg`, `m/s/s`), empty if none.
    pub unit: &'static str,
    /// Place of the first byte in the payload.
    pub offset: usize,
}

/// Type of the value of a field.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Unsigned integer of so many bytes, little-endian.
    Unsigned(usize),
    /// Signed integer of so many bytes, little-endian.
    Signed(usize),
    /// IEEE 754 number of four bytes.
    Float,
    /// IEEE 754 number of eight bytes.
    Double,
    /// One byte of a text.
    Character,
}

impl Kind {
    fn from_word(word: &str) -> Option<Self> {
        Some(match word {
            "u8" => Self::Unsigned(1),
            "u16" => Self::Unsigned(2),
            "u32" => Self::Unsigned(4),
            "u64" => Self::Unsigned(8),
            "i8" => Self::Signed(1),
            "i16" => Self::Signed(2),
            "i32" => Self::Signed(4),
            "i64" => Self::Signed(8),
            "f32" => Self::Float,
            "f64" => Self::Double,
            "char" => Self::Character,
            _ => return None,
        })
    }

    /// Size of one value, bytes.
    pub fn size(self) -> usize {
        match self {
            Self::Unsigned(bytes) | Self::Signed(bytes) => bytes,
            Self::Float => 4,
            Self::Double => 8,
            Self::Character => 1,
        }
    }
}

impl Field {
    /// The value of an element (0 for a single value) in the field's own unit, not converted. Bytes beyond the end of
    /// the payload count as zero, because MAVLink 2 cuts zeros at the end off. `None` for text and for an element that
    /// the field does not have. 64-bit integers beyond 2^53 are rounded.
    pub fn value(&self, payload: &[u8], element: usize) -> Option<f64> {
        if element >= self.count.max(1) {
            return None;
        }
        let size = self.kind.size();
        let start = self.offset + element * size;
        let mut bytes = [0_u8; 8];
        for (to, from) in bytes.iter_mut().take(size).zip(payload.iter().skip(start)) {
            *to = *from;
        }
        let unsigned = u64::from_le_bytes(bytes);
        Some(match self.kind {
            Kind::Unsigned(_) => unsigned as f64,
            Kind::Signed(size) => {
                let spare = 64 - 8 * size as u32;
                (((unsigned << spare) as i64) >> spare) as f64
            }
            Kind::Float => f64::from(f32::from_bits(unsigned as u32)),
            Kind::Double => f64::from_bits(unsigned),
            Kind::Character => return None,
        })
    }

    /// The text of a field of characters, up to the first zero byte; `None` for another type and for text that is not
    /// UTF-8.
    pub fn text(&self, payload: &[u8]) -> Option<String> {
        if self.kind != Kind::Character {
            return None;
        }
        let bytes = payload.iter().skip(self.offset).take(self.count).take_while(|byte| **byte != 0);
        String::from_utf8(bytes.copied().collect()).ok()
    }
}

impl Message {
    /// The field with this name; `None` if the message has none.
    pub fn field(&self, name: &str) -> Option<&Field> {
        self.fields.iter().find(|field| field.name == name)
    }

    /// Length of the whole payload with all extensions, bytes.
    pub fn length(&self) -> usize {
        self.fields.last().map_or(0, |field| field.offset + field.kind.size() * field.count.max(1))
    }
}

/// Number of the message `NAMED_VALUE_FLOAT`: a value under a name that the sender chooses.
pub const NAMED_VALUE_FLOAT: u32 = 251;

/// All messages by their numbers.
pub fn messages() -> &'static BTreeMap<u32, Message> {
    static MESSAGES: OnceLock<BTreeMap<u32, Message>> = OnceLock::new();
    MESSAGES.get_or_init(|| {
        let lines = include_str!("messages.txt").lines().filter(|line| !line.starts_with('#'));
        lines.filter_map(parse).map(|message| (message.id, message)).collect()
    })
}

/// The message with this name; `None` if neither dialect has it.
pub fn by_name(name: &str) -> Option<&'static Message> {
    messages().values().find(|message| message.name == name)
}

fn parse(line: &'static str) -> Option<Message> {
    let mut words = line.split(' ');
    let (id, name, crc_extra) = (words.next()?.parse().ok()?, words.next()?, words.next()?.parse().ok()?);
    let mut offset = 0;
    let mut fields = Vec::new();
    for word in words {
        let mut parts = word.splitn(4, ':');
        let (name, kind) = (parts.next()?, Kind::from_word(parts.next()?)?);
        let (count, unit) = (parts.next()?.parse().ok()?, parts.next()?);
        fields.push(Field { name, kind, count, unit, offset });
        offset += kind.size() * count.max(1);
    }
    Some(Message { id, name, crc_extra, fields })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_line_is_understood() {
        let lines = include_str!("messages.txt").lines().filter(|line| !line.starts_with('#')).count();
        assert_eq!(messages().len(), lines);
        assert!(lines > 300);
        // A payload has at most 255 bytes.
        assert!(messages().values().all(|message| message.length() <= 255));
    }

    #[test]
    fn values_of_every_type() {
        let position = by_name("GLOBAL_POSITION_INT").unwrap();
        let mut payload = vec![0; position.length()];
        payload[..4].copy_from_slice(&1234_u32.to_le_bytes());
        payload[20..22].copy_from_slice(&(-150_i16).to_le_bytes());
        assert_eq!(position.field("time_boot_ms").unwrap().value(&payload, 0), Some(1234.0));
        assert_eq!(position.field("vx").unwrap().value(&payload, 0), Some(-150.0));
        // Zeros at the end need not be sent.
        assert_eq!(position.field("vx").unwrap().value(&payload[..10], 0), Some(0.0));
        let named = by_name("NAMED_VALUE_FLOAT").unwrap();
        assert_eq!(named.id, NAMED_VALUE_FLOAT);
        let mut payload = vec![0; named.length()];
        payload[4..8].copy_from_slice(&1.5_f32.to_le_bytes());
        payload[8..13].copy_from_slice(b"alpha");
        assert_eq!(named.field("value").unwrap().value(&payload, 0), Some(1.5));
        assert_eq!(named.field("value").unwrap().value(&payload, 1), None);
        assert_eq!(named.field("name").unwrap().text(&payload).as_deref(), Some("alpha"));
    }
}
