//! What the messages hold.

use std::collections::BTreeMap;
use std::sync::OnceLock;

/// A message of the dialect.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Message {
    /// Number on the wire.
    pub id: u32,
    /// Name, such as `HIGHRES_IMU`.
    pub name: &'static str,
    /// Seed of the checksum, made of names and types: both sides have to mean the same message.
    pub crc_extra: u8,
    /// Fields in the order of the wire, extensions last.
    pub fields: Vec<Field>,
}

/// A field of a message.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Field {
    /// Name, such as `xacc`.
    pub name: &'static str,
    /// Type of a value, or of each element.
    pub kind: Kind,
    /// Elements; 0 for a single value.
    pub count: usize,
    /// Unit as MAVLink writes it (`cdeg`, `m/s/s`), empty if none.
    pub unit: &'static str,
    /// First byte in the payload.
    pub offset: usize,
}

/// Type of a value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Unsigned integer of this many bytes.
    Unsigned(usize),
    /// Signed integer of this many bytes.
    Signed(usize),
    /// IEEE 754, four bytes.
    Float,
    /// IEEE 754, eight bytes.
    Double,
    /// Text.
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

    /// Bytes of one value.
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
    /// The value of an element (0 for a single value) in the field's own unit; bytes that the sender cut off are zero (MAVLink
    /// 2 cuts zeros at the end). None for text, and for an element that there is not.
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

    /// The text of a field of characters, up to the first zero.
    pub fn text(&self, payload: &[u8]) -> Option<String> {
        if self.kind != Kind::Character {
            return None;
        }
        let bytes = payload.iter().skip(self.offset).take(self.count).take_while(|byte| **byte != 0);
        String::from_utf8(bytes.copied().collect()).ok()
    }
}

impl Message {
    /// The field of this name.
    pub fn field(&self, name: &str) -> Option<&Field> {
        self.fields.iter().find(|field| field.name == name)
    }

    /// Bytes of the payload with everything in it.
    pub fn length(&self) -> usize {
        self.fields.last().map_or(0, |field| field.offset + field.kind.size() * field.count.max(1))
    }
}

/// All messages, by number.
pub fn messages() -> &'static BTreeMap<u32, Message> {
    static MESSAGES: OnceLock<BTreeMap<u32, Message>> = OnceLock::new();
    MESSAGES.get_or_init(|| {
        let lines = include_str!("messages.txt").lines().filter(|line| !line.starts_with('#'));
        lines.filter_map(parse).map(|message| (message.id, message)).collect()
    })
}

/// The message of this name.
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
        let mut payload = vec![0; named.length()];
        payload[4..8].copy_from_slice(&1.5_f32.to_le_bytes());
        payload[8..13].copy_from_slice(b"alpha");
        assert_eq!(named.field("value").unwrap().value(&payload, 0), Some(1.5));
        assert_eq!(named.field("value").unwrap().value(&payload, 1), None);
        assert_eq!(named.field("name").unwrap().text(&payload).as_deref(), Some("alpha"));
    }
}
