//! Counts what an Arrow schema takes before the library makes it. In the encoding of a schema two fields may share what
//! they consist of, so that a few bytes can stand for a great many fields.

use arrow_ipc::{Field, KeyValue, Message, Schema, root_as_message};

use crate::memory::{Account, Excess, many};

/// What a field takes besides its texts, bytes.
const BYTES_PER_FIELD: usize = 600;
/// What an entry of metadata takes besides its texts, bytes.
const BYTES_PER_ENTRY: usize = 150;

/// Counts all fields of a schema, those within fields too, with their names and metadata.
pub(super) fn check(schema: Schema<'_>, account: &Account) -> Result<(), Excess> {
    entries(schema.custom_metadata().into_iter().flatten(), account)?;
    fields(schema.fields().into_iter().flatten(), account)
}

fn fields<'a>(list: impl Iterator<Item = Field<'a>>, account: &Account) -> Result<(), Excess> {
    for field in list {
        account.take(many(1, BYTES_PER_FIELD + 2 * field.name().map_or(0, str::len)))?;
        entries(field.custom_metadata().into_iter().flatten(), account)?;
        // The library that checked the encoding allows no deep nesting.
        fields(field.children().into_iter().flatten().collect::<Vec<_>>().into_iter(), account)?;
    }
    Ok(())
}

fn entries<'a>(list: impl Iterator<Item = KeyValue<'a>>, account: &Account) -> Result<(), Excess> {
    for entry in list {
        let texts = entry.key().map_or(0, str::len) + entry.value().map_or(0, str::len);
        account.take(many(1, BYTES_PER_ENTRY + 2 * texts))?;
    }
    Ok(())
}

/// Counts a schema as Parquet keeps it: a message in the characters of base 64. What is no such text is left to the
/// library, which refuses it.
pub(super) fn check_text(text: &str, account: &Account) -> Result<(), Excess> {
    let _held = account.hold(many(2, text.len()))?;
    let Some(message) = decoded(text) else { return Ok(()) };
    let message = message.get(8..).filter(|_| message.starts_with(&[0xFF; 4])).unwrap_or(&message);
    let message: Option<Message<'_>> = root_as_message(message).ok();
    message.and_then(|message| message.header_as_schema()).map_or(Ok(()), |schema| check(schema, account))
}

/// The bytes that a text stands for (RFC 4648, section 4).
fn decoded(text: &str) -> Option<Vec<u8>> {
    let mut bytes = Vec::with_capacity(text.len() / 4 * 3);
    for four in text.trim_end_matches('=').as_bytes().chunks(4) {
        let mut word = 0_u32;
        for &character in four {
            let digit = match character {
                b'A'..=b'Z' => character - b'A',
                b'a'..=b'z' => character - b'a' + 26,
                b'0'..=b'9' => character - b'0' + 52,
                b'+' => 62,
                b'/' => 63,
                _ => return None,
            };
            word = word << 6 | u32::from(digit);
        }
        word <<= 6 * (4 - four.len() as u32);
        let [_, three @ ..] = word.to_be_bytes();
        bytes.extend(three.iter().take(four.len() * 6 / 8));
    }
    Some(bytes)
}

#[cfg(test)]
mod tests {
    use super::decoded;

    #[test]
    fn base_64() {
        // RFC 4648, section 10.
        for (text, bytes) in
            [("", ""), ("Zg==", "f"), ("Zm8=", "fo"), ("Zm9v", "foo"), ("Zm9vYg==", "foob"), ("Zm9vYmFy", "foobar")]
        {
            assert_eq!(decoded(text).as_deref(), Some(bytes.as_bytes()), "{text}");
        }
        assert_eq!(decoded("Zm9*"), None);
    }
}
